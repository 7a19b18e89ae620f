//! `*TRANSFORM`: the axes of supports and forces at nodes.

use std::collections::BTreeMap;

use stoss_mesh_io::deck::{Axes, Deck};

use crate::sets::Lookup;

/// A direction of unit length; nothing for the component of space.
pub(crate) type Direction = Option<[f64; 3]>;

/// Entries of directions below this are zero, and directions that differ by less are the same.
const ROUND_OFF: f64 = 1e-9;

/// Axes of the nodes that have some of their own.
pub(crate) struct LocalAxes {
    /// The three axes of each node; nothing for those that are not known.
    of_node: BTreeMap<u32, [Direction; 3]>,
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// The vector of unit length along `a`; entries that are round-off are zero.
fn unit(a: [f64; 3]) -> [f64; 3] {
    let scaled = |a: [f64; 3]| {
        let length = dot(a, a).sqrt();
        a.map(|x| x / length)
    };
    scaled(scaled(a).map(|x| if x.abs() < ROUND_OFF { 0.0 } else { x }))
}

/// The three axes at a place; on the line of cylindrical ones only that along it.
fn at(axes: &Axes, place: [f64; 3]) -> [Direction; 3] {
    let (first, third) = match *axes {
        Axes::Rectangular { a, b } => (unit(a), unit(cross(a, b))),
        Axes::Cylindrical { a, b } => {
            let along = unit(minus(b, a));
            let from = minus(place, a);
            let away = minus(from, along.map(|x| x * dot(from, along)));
            if dot(away, away) <= ROUND_OFF.powi(2) * dot(from, from) {
                return [None, None, Some(along)];
            }
            (unit(away), along)
        }
    };
    [first, unit(cross(third, first)), third].map(Some)
}

impl LocalAxes {
    /// The local axes of a deck; of two for one node the later one counts.
    pub fn new(deck: &Deck, lookup: &Lookup<'_>, nodes: &[[f64; 3]]) -> Self {
        let mut of_node = BTreeMap::new();
        for local in &deck.local_axes {
            for node in lookup.node_set(&local.nodes).unwrap_or_default().members {
                of_node.insert(node, local.axes.as_ref().map_or([None; 3], |axes| at(axes, nodes[node as usize])));
            }
        }
        Self { of_node }
    }

    /// Whether a node has axes of its own, and that of some of the components is not known.
    pub fn are_unknown(&self, node: u32, components: [bool; 3]) -> bool {
        self.of_node.get(&node).is_some_and(|axes| (0..3).any(|i| components[i] && axes[i].is_none()))
    }

    /// Whether a node has axes of its own.
    pub fn has(&self, node: u32) -> bool {
        self.of_node.contains_key(&node)
    }

    /// The direction of a component at a node.
    pub fn direction(&self, node: u32, component: usize) -> Direction {
        self.of_node.get(&node).and_then(|axes| axes[component])
    }

    /// Nodes by the direction of a component: those along the components of space first, then in the order of their first nodes.
    pub fn by_direction(&self, nodes: &[u32], component: usize) -> Vec<(Direction, Vec<u32>)> {
        let key = |direction: Direction| direction.map(|d| d.map(|x| (x / ROUND_OFF).round() as i64));
        let mut index = BTreeMap::new();
        let mut all: Vec<(Direction, Vec<u32>)> = Vec::new();
        for &node in nodes {
            let direction = self.direction(node, component);
            let k = *index.entry(key(direction)).or_insert(all.len());
            match all.get_mut(k) {
                Some((_, own)) => own.push(node),
                None => all.push((direction, vec![node])),
            }
        }
        all.sort_by_key(|(direction, _)| direction.is_some());
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_both_kinds() {
        let close = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| {
            a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-15)
        };
        let r = 0.5_f64.sqrt();
        // The second point lies in the plane of the first two axes, and need not be across the first.
        let rectangular = Axes::Rectangular { a: [1.0, 1.0, 0.0], b: [0.0, 3.0, 0.0] };
        assert!(close(at(&rectangular, [9.0; 3]).map(Option::unwrap), [[r, r, 0.0], [-r, r, 0.0], [0.0, 0.0, 1.0]]));
        // About a line along z through (1, 0, 0).
        let cylindrical = Axes::Cylindrical { a: [1.0, 0.0, 5.0], b: [1.0, 0.0, 7.0] };
        assert_eq!(at(&cylindrical, [1.0, 2.0, 0.0]), [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(Some));
        assert_eq!(at(&cylindrical, [1.0, 0.0, 3.0]), [None, None, Some([0.0, 0.0, 1.0])]);
    }
}
