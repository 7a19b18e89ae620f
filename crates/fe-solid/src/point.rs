//! The state at a material point inside an element. Not used by any force.

use crate::{
    Level, SolidBody, SolidError,
    element::{Failure, FailureKind},
    kernel::{self, Gradients, NODES, NodalVectors},
};
use stoss_continuum::{SymmetricTensor2, Tensor2};
use stoss_reference_element::hex8;

/// A point of the reference configuration, found once.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialPoint {
    /// The element in the body that holds it; of several the first.
    pub element: usize,
    /// Its natural coordinates there.
    pub natural: [f64; 3],
    /// `dN_I/dX_A` at the point.
    gradients: Gradients,
}

/// What the element's interpolation gives at a point. Symmetric tensors in the order 11, 22, 33, 12, 23, 13.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState {
    /// `F`, row: current direction, column: reference direction.
    pub deformation_gradient: [[f64; 3]; 3],
    /// `E = (F^T F - 1) / 2`.
    pub green_lagrange: [f64; 6],
    /// `F S F^T / J`.
    pub cauchy: [f64; 6],
}

/// Natural coordinates so far beyond the element still belong to it: points on its boundary do, up to round-off.
const SLACK: f64 = 1.0e-6;
/// Newton iterations of the inverse map; three are usual, and what does not converge is far outside.
const ITERATIONS: usize = 30;

impl SolidBody {
    /// The element that holds the point `x` of the reference configuration, by the inverse of the isoparametric map `X(xi) = sum_I N_I(xi) X_I`
    /// (Newton); `None` outside of the body. `reference`: positions of all nodes of the model.
    pub fn material_point(&self, reference: &[f64], x: [f64; 3]) -> Option<MaterialPoint> {
        (0..self.element_count()).find_map(|element| {
            let corners = self.gather(element, reference);
            let near = (0..3).all(|i| {
                let (low, high) = corners[i]
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &c| (low.min(c), high.max(c)));
                let slack = SLACK * (high - low);
                low - slack <= x[i] && x[i] <= high + slack
            });
            let (natural, gradients) = if near { inverse_map(&corners, x)? } else { return None };
            natural.iter().all(|xi| xi.abs() <= 1.0 + SLACK).then_some(MaterialPoint { element, natural, gradients })
        })
    }

    /// Deformation gradient, strain and stress at a material point, at positions `q` of the model.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Constitutive`], [`SolidError::Length`]; the number of the Gauss point is then
    /// 8, which is none.
    pub fn state_at(&self, point: &MaterialPoint, q: &[f64]) -> Result<PointState, SolidError> {
        self.check_length("the positions", q)?;
        let f = kernel::deformation_gradient(&self.gather(point.element, q), &point.gradients);
        let failure = |kind| self.error(point.element, Failure { gauss_point: kernel::GAUSS_POINTS, kind });
        let determinant = kernel::determinant(&f);
        // `!(det > 0)` also catches a NaN.
        if !(determinant > 0.0 && determinant.is_finite()) {
            return Err(failure(FailureKind::Inverted { determinant, level: Level::End }));
        }
        let c = SymmetricTensor2::from_voigt(kernel::right_cauchy_green(&f));
        let s = self.law().stress(&c).map_err(|error| failure(FailureKind::Constitutive(error)))?;
        Ok(PointState {
            deformation_gradient: f,
            green_lagrange: stoss_continuum::green_lagrange(&c).to_voigt(),
            cauchy: stoss_continuum::cauchy_stress(&Tensor2::from_fn(|i, a| f[i][a]), &s).to_voigt(),
        })
    }
}

/// Natural coordinates of a point and the gradients of the shape functions there.
fn inverse_map(corners: &NodalVectors, x: [f64; 3]) -> Option<([f64; 3], Gradients)> {
    let mut natural = [0.0; 3];
    for _ in 0..ITERATIONS {
        let (shape, gradient) = (hex8::shape(natural), hex8::shape_gradient(natural));
        let by_direction: Gradients = std::array::from_fn(|a| std::array::from_fn(|node| gradient[node][a]));
        let jacobian = kernel::deformation_gradient(corners, &by_direction);
        let determinant = kernel::determinant(&jacobian);
        if !(determinant.abs() > 0.0 && determinant.is_finite()) {
            return None;
        }
        let inverse = kernel::inverse(&jacobian, determinant);
        let off: [f64; 3] =
            std::array::from_fn(|i| x[i] - (0..NODES).map(|node| shape[node] * corners[i][node]).sum::<f64>());
        let step: [f64; 3] = std::array::from_fn(|a| (0..3).map(|i| inverse[a][i] * off[i]).sum());
        let size = step.iter().fold(0.0, |size: f64, s| size.max(s.abs()));
        for (xi, step) in natural.iter_mut().zip(step) {
            *xi += step;
        }
        if size < 1.0e-12 {
            let gradients = std::array::from_fn(|i| {
                std::array::from_fn(|node| (0..3).map(|a| gradient[node][a] * inverse[a][i]).sum())
            });
            return Some((natural, gradients));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use stoss_materials::NeoHooke;
    use stoss_mesh::generate::Hexahedron;

    /// Points of a distorted block with known natural coordinates, and a displacement that is trilinear in one element: the deformation gradient against
    /// central differences of the interpolation.
    #[test]
    fn points_are_found_and_their_gradient_is_that_of_the_interpolation() {
        let corners = [
            [0.0, 0.0, 0.0],
            [2.0, 0.1, -0.1],
            [2.2, 1.5, 0.2],
            [-0.2, 1.2, 0.1],
            [0.1, 0.2, 1.0],
            [1.9, -0.1, 1.3],
            [2.4, 1.4, 1.1],
            [0.2, 1.1, 0.9],
        ];
        let mesh = Hexahedron { corners, divisions: [1, 1, 1], grading: [1.0; 3] }.generate().unwrap();
        let law = Arc::new(NeoHooke::from_young_poisson(1.0, 0.3).unwrap());
        let body = SolidBody::new("block", &mesh, 0, law).unwrap();
        let reference: Vec<f64> = mesh.nodes.iter().flatten().copied().collect();
        let element = mesh.elements[0];
        let interpolate = |values: &[f64], xi: [f64; 3]| -> [f64; 3] {
            let shape = hex8::shape(xi);
            std::array::from_fn(|i| (0..8).map(|k| shape[k] * values[3 * element[k] as usize + i]).sum())
        };
        let q: Vec<f64> = reference.iter().enumerate().map(|(i, x)| 1.1 * x + 0.02 * (i as f64).sin()).collect();
        for natural in [[0.3, -0.4, 0.7], [1.0, 1.0, 1.0], [-1.0, 0.0, 0.2], [0.0, 0.0, 0.0]] {
            let x = interpolate(&reference, natural);
            let point = body.material_point(&reference, x).unwrap();
            assert!((0..3).all(|i| (point.natural[i] - natural[i]).abs() < 1e-9), "{point:?}");
            let state = body.state_at(&point, &q).unwrap();
            // F (dX/dxi) = dq/dxi
            let h = 1e-5;
            for a in 0..3 {
                let along = |values: &[f64]| -> [f64; 3] {
                    let at = |s: f64| {
                        interpolate(values, std::array::from_fn(|k| natural[k] + if k == a { s } else { 0.0 }))
                    };
                    let (plus, minus) = (at(h), at(-h));
                    std::array::from_fn(|i| (plus[i] - minus[i]) / (2.0 * h))
                };
                let (dx, dq) = (along(&reference), along(&q));
                for i in 0..3 {
                    let product: f64 = (0..3).map(|k| state.deformation_gradient[i][k] * dx[k]).sum();
                    assert!((product - dq[i]).abs() < 1e-9);
                }
            }
        }
        assert_eq!(body.material_point(&reference, [3.0, 0.5, 0.5]), None);
        assert_eq!(body.material_point(&reference, [-0.15, 0.1, 0.5]), None);
    }
}
