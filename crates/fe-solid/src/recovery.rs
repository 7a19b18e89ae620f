//! Stresses for output: at Gauss points, and extrapolated to nodes. Not used by any force.

use crate::{
    Level, SolidBody, SolidError,
    element::{Failure, FailureKind, strain},
    kernel::{GAUSS_POINTS, NODES},
};
use stoss_continuum::{SymmetricTensor2, Tensor2};
use stoss_reference_element::hex8;

/// State of one Gauss point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussPointState {
    /// `F`, row: current direction, column: reference direction.
    pub deformation_gradient: [[f64; 3]; 3],
    /// Cauchy stress `F S F^T / J` in the order 11, 22, 33, 12, 23, 13.
    pub cauchy: [f64; 6],
    /// Strain energy per reference volume.
    pub energy: f64,
    /// Reference volume that belongs to the point.
    pub volume: f64,
}

/// Von Mises stress `sqrt(3/2 s:s)`, `s` the deviator, of a stress in the order 11, 22, 33, 12, 23, 13.
pub fn von_mises(stress: &[f64; 6]) -> f64 {
    stoss_continuum::von_mises(&SymmetricTensor2::from_voigt(*stress))
}

impl SolidBody {
    /// The state at the Gauss points of every element, in the order of the quadrature rule, at positions `q` of the model.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Constitutive`], [`SolidError::Length`].
    pub fn gauss_point_state(&self, q: &[f64]) -> Result<Vec<[GaussPointState; GAUSS_POINTS]>, SolidError> {
        self.check_length("the positions", q)?;
        (0..self.element_count())
            .map(|element| self.element_state(element, q).map_err(|failure| self.error(element, failure)))
            .collect()
    }

    /// Cauchy stress at the body's nodes: the trilinear function through the Gauss points of each element, evaluated at
    /// its nodes, then the mean over the elements at a node, weighted by their reference volumes. `out` has one entry for
    /// each node of the body (order 11, 22, 33, 12, 23, 13) and is overwritten; nodes without element get zero.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Constitutive`], [`SolidError::Length`].
    pub fn nodal_cauchy_stress(&self, q: &[f64], out: &mut [[f64; 6]]) -> Result<(), SolidError> {
        self.check_length("the positions", q)?;
        if out.len() != self.node_count() {
            return Err(SolidError::Length {
                name: self.name().to_string(),
                what: "the nodal stresses",
                found: out.len(),
                expected: self.node_count(),
            });
        }
        // Gauss points are the nodes of a hexahedron of half edge 1/sqrt(3), in the same order.
        let extrapolation: [[f64; GAUSS_POINTS]; NODES] =
            std::array::from_fn(|node| hex8::shape(hex8::VERTICES[node].map(|xi| xi * 3f64.sqrt())));
        out.fill([0.0; 6]);
        let mut volumes = vec![0.0; out.len()];
        for (element, nodes) in self.connectivity().iter().enumerate() {
            let state = self.element_state(element, q).map_err(|failure| self.error(element, failure))?;
            let volume: f64 = state.iter().map(|s| s.volume).sum();
            for (&node, weights) in nodes.iter().zip(&extrapolation) {
                let local = (node - self.node_offset()) as usize;
                volumes[local] += volume;
                for (weight, state) in weights.iter().zip(&state) {
                    for v in 0..6 {
                        out[local][v] += volume * weight * state.cauchy[v];
                    }
                }
            }
        }
        for (stress, volume) in out.iter_mut().zip(&volumes) {
            if *volume > 0.0 {
                for s in stress {
                    *s /= volume;
                }
            }
        }
        Ok(())
    }

    fn element_state(&self, element: usize, q: &[f64]) -> Result<[GaussPointState; GAUSS_POINTS], Failure> {
        let integration = self.integration(element);
        let q = self.gather(element, q);
        let mut out =
            [GaussPointState { deformation_gradient: [[0.0; 3]; 3], cauchy: [0.0; 6], energy: 0.0, volume: 0.0 };
                GAUSS_POINTS];
        for (g, state) in out.iter_mut().enumerate() {
            let (f, c) = strain(&q, integration, g, Level::End)?;
            let failure = |e| Failure { gauss_point: g, kind: FailureKind::Constitutive(e) };
            let s = self.law().stress(&c).map_err(failure)?;
            let cauchy = stoss_continuum::cauchy_stress(&Tensor2::from_fn(|i, a| f[i][a]), &s);
            *state = GaussPointState {
                deformation_gradient: f,
                cauchy: cauchy.to_voigt(),
                energy: self.law().energy(&c).map_err(failure)?,
                volume: integration.weights[g],
            };
        }
        Ok(out)
    }
}
