//! Stresses and strains for output: at Gauss points, and extrapolated to nodes. Not used by any force.

use crate::{
    Level, SolidBody, SolidError,
    element::{Failure, FailureKind, strain},
    kernel::{GAUSS_POINTS, NODES},
};
use stoss_continuum::{ConstitutiveError, SymmetricTensor2, Tensor2};
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

/// Principal stresses of a stress in the order 11, 22, 33, 12, 23, 13, the largest first.
pub fn principal_stresses(stress: &[f64; 6]) -> [f64; 3] {
    stoss_continuum::principal_values(&SymmetricTensor2::from_voigt(*stress))
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
        self.nodal_mean(q, out, |f, c| Ok(stoss_continuum::cauchy_stress(f, &self.law().stress(c)?).to_voigt()))
    }

    /// Deformation gradient `F` at the body's nodes, made as [`Self::nodal_cauchy_stress`]. Order 11, 12, 13, 21, ..., 33: the first
    /// index is the current direction, the second the reference direction. The mean of elements that turn differently is shorter
    /// than each: strains at nodes are means of strains, and not the strain of this mean.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Length`].
    pub fn nodal_deformation_gradient(&self, q: &[f64], out: &mut [[f64; 9]]) -> Result<(), SolidError> {
        self.nodal_mean(q, out, |f, _| Ok(std::array::from_fn(|k| f[(k / 3, k % 3)])))
    }

    /// Green-Lagrange strain `E = (F^T F - 1)/2` at the body's nodes, made and ordered as [`Self::nodal_cauchy_stress`]; shears are tensor
    /// components, half of the engineering ones.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Length`].
    pub fn nodal_green_lagrange_strain(&self, q: &[f64], out: &mut [[f64; 6]]) -> Result<(), SolidError> {
        self.nodal_mean(q, out, |_, c| Ok(stoss_continuum::green_lagrange(c).to_voigt()))
    }

    /// Logarithmic (Hencky) strain `ln V = ln(F F^T)/2` in the current directions at the body's nodes, made and ordered as
    /// [`Self::nodal_cauchy_stress`]; shears are tensor components.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Length`].
    pub fn nodal_logarithmic_strain(&self, q: &[f64], out: &mut [[f64; 6]]) -> Result<(), SolidError> {
        self.nodal_mean(q, out, |f, _| Ok(stoss_continuum::logarithmic_strain(f).to_voigt()))
    }

    /// The mean at the body's nodes of what `value` makes of `F` and `C` at the Gauss points, see [`Self::nodal_cauchy_stress`].
    fn nodal_mean<const N: usize>(
        &self,
        q: &[f64],
        out: &mut [[f64; N]],
        value: impl Fn(&Tensor2, &SymmetricTensor2) -> Result<[f64; N], ConstitutiveError>,
    ) -> Result<(), SolidError> {
        self.check_length("the positions", q)?;
        if out.len() != self.node_count() {
            return Err(SolidError::Length {
                name: self.name().to_string(),
                what: "the nodal values",
                found: out.len(),
                expected: self.node_count(),
            });
        }
        // Gauss points are the nodes of a hexahedron of half edge 1/sqrt(3), in the same order.
        let extrapolation: [[f64; GAUSS_POINTS]; NODES] =
            std::array::from_fn(|node| hex8::shape(hex8::VERTICES[node].map(|xi| xi * 3f64.sqrt())));
        out.fill([0.0; N]);
        let mut volumes = vec![0.0; out.len()];
        for (element, nodes) in self.connectivity().iter().enumerate() {
            let integration = self.integration(element);
            let q = self.gather(element, q);
            let mut values = [[0.0; N]; GAUSS_POINTS];
            for (g, at_point) in values.iter_mut().enumerate() {
                let of_point = strain(&q, integration, g, Level::End).and_then(|(f, c)| {
                    let failure = |e| Failure { gauss_point: g, kind: FailureKind::Constitutive(e) };
                    value(&Tensor2::from_fn(|i, a| f[i][a]), &c).map_err(failure)
                });
                *at_point = of_point.map_err(|failure| self.error(element, failure))?;
            }
            let volume: f64 = integration.weights.iter().sum();
            for (&node, weights) in nodes.iter().zip(&extrapolation) {
                let local = (node - self.node_offset()) as usize;
                volumes[local] += volume;
                for (weight, values) in weights.iter().zip(&values) {
                    for (out, value) in out[local].iter_mut().zip(values) {
                        *out += volume * weight * value;
                    }
                }
            }
        }
        for (values, volume) in out.iter_mut().zip(&volumes) {
            if *volume > 0.0 {
                for value in values {
                    *value /= volume;
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
