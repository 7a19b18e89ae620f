//! The gap gradient of a slot, put together over the nodes of its element.

use crate::crossing::{MAX_NODES, component, spread};
use crate::kinematics::{Local, LocalMatrix};
use stoss_reference_element::Nodal;

/// Gap gradient and tangent of one slot; the tangent is empty if not asked for.
pub(crate) struct GapGradient {
    pub values: [f64; 3 * MAX_NODES],
    pub tangent: Vec<f64>,
}

impl Default for GapGradient {
    fn default() -> Self {
        Self { values: [0.0; 3 * MAX_NODES], tangent: Vec::new() }
    }
}

impl GapGradient {
    /// Zeros for `n` components.
    pub fn reset(&mut self, n: usize, want_tangent: bool) {
        self.values[..n].fill(0.0);
        self.tangent.clear();
        if want_tangent {
            self.tangent.resize(n * n, 0.0);
        }
    }

    /// Adds `factor * gradient` at the slave node and a facet's nodes.
    pub fn add_gradient(&mut self, gradient: &Local, facet: &Nodal<usize>, factor: f64) {
        for (node, part) in spread(facet).iter().zip(gradient.chunks_exact(3)) {
            for i in 0..3 {
                self.values[3 * node + i] += factor * part[i];
            }
        }
    }

    /// Adds a gradient, and `factor` times a tangent, at the slave node and a facet's nodes.
    pub fn set(
        &mut self,
        gradient: &Local,
        tangent: Option<&LocalMatrix>,
        facet: &Nodal<usize>,
        n: usize,
        factor: f64,
    ) {
        self.add_gradient(gradient, facet, 1.0);
        let nodes = spread(facet);
        for (i, row) in tangent.into_iter().flatten().enumerate() {
            for (j, k) in row.iter().enumerate() {
                self.tangent[component(&nodes, i) * n + component(&nodes, j)] += factor * k;
            }
        }
    }
}
