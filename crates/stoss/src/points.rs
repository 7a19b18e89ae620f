//! Which of a model's vectors are points in space that are shown: all but directions and vertices of traces.

use crate::solver::Model;
use std::borrow::Cow;

/// The points of a model, in the order of its vectors. Frames and the watch count points: in a scene of solids alone those are the nodes.
#[derive(Clone, Debug)]
pub(crate) struct Points {
    nodes: Vec<u32>,
    /// Place of each vector among the points, [`NONE`] of a direction; of a vertex of a trace that of the node in whose place it is.
    places: Vec<u32>,
}

/// The place of what is not shown.
const NONE: u32 = u32::MAX;

impl Points {
    /// The points of a model.
    pub fn of(model: &Model) -> Self {
        let mut places = vec![0; model.node_count()];
        for part in &model.parts {
            for vector in part.own_vectors().filter(|&vector| part.is_direction(vector)) {
                places[vector as usize] = NONE;
            }
        }
        for &vertex in model.traces.keys() {
            places[vertex as usize] = NONE;
        }
        let mut nodes = Vec::with_capacity(places.len());
        for (node, place) in (0..).zip(&mut places) {
            if *place != NONE {
                *place = nodes.len() as u32;
                nodes.push(node);
            }
        }
        for (&vertex, shown) in &model.traces {
            places[vertex as usize] = shown.map_or(NONE, |node| places[node as usize]);
        }
        Self { nodes, places }
    }

    /// Place of a vector among the points; of what is not shown, and of a vector that does not exist, a number that is no point's.
    pub fn place(&self, node: u32) -> u32 {
        self.places.get(node as usize).copied().unwrap_or(NONE)
    }

    /// The vectors of all points, in their order.
    #[cfg(feature = "output")]
    pub fn into_nodes(self) -> Vec<u32> {
        self.nodes
    }

    /// The vector of a point.
    pub fn node(&self, place: u32) -> u32 {
        self.nodes[place as usize]
    }

    /// The rows of the points, of values with so many components a vector; no values stay none.
    pub fn of_all<'a>(&self, values: &'a [f64], components: usize) -> Cow<'a, [f64]> {
        if values.is_empty() || self.nodes.len() == self.places.len() {
            return Cow::Borrowed(values);
        }
        let row = |&node: &u32| &values[node as usize * components..(node as usize + 1) * components];
        self.nodes.iter().flat_map(row).copied().collect()
    }

    /// Largest length of a point's vector (position, velocity).
    pub fn largest(&self, vectors: &[f64]) -> f64 {
        let of = |x: &[f64]| x[0].hypot(x[1]).hypot(x[2]);
        self.of_all(vectors, 3).chunks_exact(3).map(of).fold(0.0, f64::max)
    }
}
