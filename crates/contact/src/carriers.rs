//! Vectors that carry all nodes of a surface, as centre and directors of a rigid body do.

use crate::position;
use nalgebra::Vector3;

/// Most carriers of a surface.
const MOST: usize = 4;

/// Relative round-off of positions.
const ROUND_OFF: f64 = 1e-14;

/// Vectors `q_k` that give the positions of all nodes of a surface, `x_a = sum_k w_ak q_k` with constant weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Carriers {
    nodes: Vec<u32>,
    /// Smallest and largest weight of each.
    weights: Vec<[f64; 2]>,
}

impl Carriers {
    /// `of`: carriers and weights of a node. `None` if a node is not carried, or if there are too many carriers for a surface that moves as a whole.
    pub(crate) fn new<'a>(nodes: &[u32], of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) -> Option<Self> {
        let mut carriers = Self { nodes: Vec::new(), weights: Vec::new() };
        for &node in nodes {
            for &(carrier, _) in of(node)? {
                if !carriers.nodes.contains(&carrier) {
                    carriers.nodes.push(carrier);
                }
            }
            if carriers.nodes.len() > MOST {
                return None;
            }
        }
        for &carrier in &carriers.nodes {
            let weight = |node: u32| of(node).and_then(|of| of.iter().find(|c| c.0 == carrier)).map_or(0.0, |c| c.1);
            let ends = |[low, high]: [f64; 2], w: f64| [low.min(w), high.max(w)];
            carriers.weights.push(nodes.iter().map(|&n| weight(n)).fold([f64::INFINITY, f64::NEG_INFINITY], ends));
        }
        Some(carriers)
    }

    pub(crate) fn values(&self, q: &[f64]) -> Vec<Vector3<f64>> {
        self.nodes.iter().map(|&node| position(q, node)).collect()
    }

    /// The motion since the carriers had the values `from`: a translation, and how far a node is at most from where that takes it. Zero if the carriers
    /// have not moved.
    pub(crate) fn motion(&self, from: &[Vector3<f64>], q: &[f64]) -> (Vector3<f64>, f64) {
        let moved = |k: usize| position(q, self.nodes[k]) - from[k];
        if (0..self.nodes.len()).all(|k| moved(k) == Vector3::zeros()) {
            return (Vector3::zeros(), 0.0);
        }
        // The motion is linear in the weights: it is largest in a corner of the box of the weights.
        let (mut shift, mut size) = (Vector3::zeros(), 0.0);
        for (k, [low, high]) in self.weights.iter().enumerate() {
            shift += moved(k) * (0.5 * (low + high));
            size += position(q, self.nodes[k]).norm() * low.abs().max(high.abs());
        }
        let corner = |corner: usize| -> f64 {
            let arm = |(k, [low, high]): (usize, &[f64; 2])| {
                moved(k) * (0.5 * if corner >> k & 1 == 0 { low - high } else { high - low })
            };
            self.weights.iter().enumerate().map(arm).sum::<Vector3<f64>>().norm()
        };
        (shift, (0..1 << self.weights.len()).map(corner).fold(0.0, f64::max) + ROUND_OFF * size)
    }
}
