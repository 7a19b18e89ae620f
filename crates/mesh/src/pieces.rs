//! Pieces of a mesh of which no two have a node in common.

use std::collections::HashMap;

use crate::Mesh;

/// The first node of a piece. Each node points at one of its piece, the first one at itself; what is passed on the way points nearer afterwards.
fn first_node(parent: &mut [u32], mut node: u32) -> u32 {
    while parent[node as usize] != node {
        parent[node as usize] = parent[parent[node as usize] as usize];
        node = parent[node as usize];
    }
    node
}

impl Mesh {
    /// Number of pieces of which no two have a node in common.
    pub fn pieces(&self) -> usize {
        let all: Vec<u32> = (0..self.elements.len() as u32).collect();
        self.piece_of_elements(&all).into_iter().max().map_or(0, |last| last + 1)
    }

    /// Number of the piece, among these elements, that each of them is in; pieces are numbered from 0 in the order of their first elements.
    ///
    /// # Panics
    /// If an element does not exist; this is a programming error.
    pub fn piece_of_elements(&self, elements: &[u32]) -> Vec<usize> {
        let mut parent: Vec<u32> = (0..self.nodes.len() as u32).collect();
        for &e in elements {
            let nodes = &self.elements[e as usize];
            for &node in &nodes[1..] {
                let (a, b) = (first_node(&mut parent, nodes[0]), first_node(&mut parent, node));
                parent[a.max(b) as usize] = a.min(b);
            }
        }
        let mut numbers = HashMap::new();
        let number = |&e: &u32| {
            let first = first_node(&mut parent, self.elements[e as usize][0]);
            let next = numbers.len();
            *numbers.entry(first).or_insert(next)
        };
        elements.iter().map(number).collect()
    }
}
