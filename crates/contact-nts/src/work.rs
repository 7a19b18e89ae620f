//! Where the gap gradient of a slot is put together.

use crate::crossing::MAX_NODES;
use crate::kinematics::{LOCAL, Local, LocalMatrix};

/// Gap gradient and tangent of one slot; the tangent is empty if not asked for.
pub(crate) struct Work {
    pub gradient: [f64; 3 * MAX_NODES],
    pub tangent: Vec<f64>,
}

impl Work {
    pub fn new() -> Self {
        Self { gradient: [0.0; 3 * MAX_NODES], tangent: Vec::new() }
    }

    /// Zeros for `n` components.
    pub fn reset(&mut self, n: usize, want_tangent: bool) {
        self.gradient[..n].fill(0.0);
        self.tangent.clear();
        if want_tangent {
            self.tangent.resize(n * n, 0.0);
        }
    }

    /// Adds `factor * gradient` at the slave node and a facet's nodes.
    pub fn add_gradient(&mut self, gradient: &Local, facet: &[usize; 4], factor: f64) {
        for (node, part) in std::iter::once(&0).chain(facet).zip(gradient.chunks_exact(3)) {
            for i in 0..3 {
                self.gradient[3 * node + i] += factor * part[i];
            }
        }
    }

    /// A gradient, and `factor` times a tangent, at the slave node and the end facet's nodes.
    pub fn set(&mut self, gradient: &Local, tangent: Option<&LocalMatrix>, n: usize, factor: f64) {
        self.gradient[..LOCAL].copy_from_slice(gradient);
        for (i, row) in tangent.into_iter().flatten().enumerate() {
            for (j, k) in row.iter().enumerate() {
                self.tangent[i * n + j] = factor * k;
            }
        }
    }
}
