//! Positions at which integrals and gaps are evaluated.

use nalgebra::Vector3;
use stoss_contact::{ContactSurface, position};
use stoss_reference_element::Nodal;

/// Positions of all nodes, as they are or made from two vectors where they are asked for: a step looks at few of many nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Positions<'a> {
    /// `q`.
    At(&'a [f64]),
    /// `(a + b) / 2`.
    Mean(&'a [f64], &'a [f64]),
    /// `q + s v`.
    Ahead(&'a [f64], f64, &'a [f64]),
}

impl<'a> From<&'a [f64]> for Positions<'a> {
    fn from(q: &'a [f64]) -> Self {
        Self::At(q)
    }
}

impl<'a> From<&'a Vec<f64>> for Positions<'a> {
    fn from(q: &'a Vec<f64>) -> Self {
        Self::At(q)
    }
}

impl Positions<'_> {
    /// Position of a node.
    pub fn of(self, node: u32) -> Vector3<f64> {
        let k = 3 * node as usize;
        match self {
            Self::At(q) => position(q, node),
            Self::Mean(a, b) => Vector3::from_fn(|i, _| 0.5 * (a[k + i] + b[k + i])),
            Self::Ahead(q, s, v) => Vector3::from_fn(|i, _| q[k + i] + s * v[k + i]),
        }
    }

    /// Corners of a facet.
    pub fn corners(self, surface: &ContactSurface, facet: u32) -> Nodal<Vector3<f64>> {
        surface.facets()[facet as usize].map(|node| self.of(node))
    }
}
