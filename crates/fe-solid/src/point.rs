//! The state at a material point inside an element. Not used by any force.

use crate::{
    SolidBody, SolidError, TimeLevel,
    element::{Failure, FailureKind},
    kernel::{self, Matrix3},
    recovery,
};
use stoss_continuum::{SymmetricTensor2, Tensor2};
use stoss_reference_element::CellKind;

/// A point of the reference configuration, found once.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialPoint {
    /// The element in the body that holds it; of several the first.
    pub element: usize,
    /// Natural coordinates of the point in that element.
    pub natural: [f64; 3],
    /// `dN_I/dX_A` at the point, `[I][A]`.
    gradients: Vec<[f64; 3]>,
}

/// What the element's interpolation gives at a point. Symmetric tensors in the order 11, 22, 33, 12, 23, 13.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
/// How far the faces of a quadratic element may bulge out of the box around its nodes, in parts of the box.
const BULGE: f64 = 0.25;
/// Newton iterations of the inverse map; three are usual, and what does not converge is far outside.
const ITERATIONS: usize = 30;

impl SolidBody {
    /// The element that holds the point `x` of the reference configuration, by the inverse of the isoparametric map `X(xi) = sum_I N_I(xi) X_I`
    /// (Newton); `None` outside of the body. `reference`: positions of all nodes of the model.
    pub fn material_point(&self, reference: &[f64], x: [f64; 3]) -> Option<MaterialPoint> {
        self.material_point_near(reference, x, 0.0)
    }

    /// [`Self::material_point`]; where no element holds the point, the one of which it is least outside, by `beyond` in natural coordinates at most.
    ///
    /// Shape functions go on beyond the faces of an element with the sum one, so that such a point still moves with the body. Chords of curved faces lie a little outside of it.
    pub fn material_point_near(&self, reference: &[f64], x: [f64; 3], beyond: f64) -> Option<MaterialPoint> {
        let mut places = Vec::new();
        let mut nearest: Option<(f64, MaterialPoint)> = None;
        for (element, (kind, nodes)) in self.elements().cells().enumerate() {
            places.clear();
            places.extend(nodes.iter().map(|&node| -> [f64; 3] {
                let at = 3 * node as usize;
                [reference[at], reference[at + 1], reference[at + 2]]
            }));
            let room = if kind.is_quadratic() { BULGE } else { SLACK }.max(beyond);
            let near = (0..3).all(|i| {
                let (low, high) = places
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c[i]), high.max(c[i])));
                let slack = room * (high - low);
                low - slack <= x[i] && x[i] <= high + slack
            });
            let Some((natural, gradients)) = (if near { inverse_map(kind, &places, x) } else { None }) else {
                continue;
            };
            let excess = kind.table().family.excess(natural);
            let least = nearest.as_ref().map_or(beyond.max(SLACK), |(least, _)| *least);
            let point = || MaterialPoint { element, natural, gradients };
            if excess <= SLACK {
                return Some(point());
            }
            if excess < least {
                nearest = Some((excess, point()));
            }
        }
        nearest.map(|(_, point)| point)
    }

    /// The point `x` of the reference configuration as one of a certain element, of which it is outside by `beyond` in natural coordinates at most; `None` if it is farther.
    pub fn material_point_of(
        &self,
        element: usize,
        reference: &[f64],
        x: [f64; 3],
        beyond: f64,
    ) -> Option<MaterialPoint> {
        let kind = self.elements().kind(element);
        let at = |&node: &u32| -> [f64; 3] { std::array::from_fn(|i| reference[3 * node as usize + i]) };
        let places: Vec<[f64; 3]> = self.elements()[element].iter().map(at).collect();
        let (natural, gradients) = inverse_map(kind, &places, x)?;
        (kind.table().family.excess(natural) <= beyond).then_some(MaterialPoint { element, natural, gradients })
    }

    /// Deformation gradient, strain and stress at a material point, at positions `q` of the model. Zeros where another rank has the element, so that the sum over all ranks is the
    /// state.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::Constitutive`], [`SolidError::Length`]; the number of the Gauss point is then
    /// that of Gauss points, which is none.
    pub fn state_at(&self, point: &MaterialPoint, q: &[f64]) -> Result<PointState, SolidError> {
        self.check_length("the positions", q)?;
        let Some((cells, block, local)) = self.locate(point.element) else { return Ok(PointState::default()) };
        let mut f: Matrix3 = [[0.0; 3]; 3];
        for (&node, gradient) in self.elements()[point.element].iter().zip(&point.gradients) {
            for i in 0..3 {
                for a in 0..3 {
                    f[i][a] += q[3 * node as usize + i] * gradient[a];
                }
            }
        }
        let failure = |kind| self.error(point.element, Failure { gauss_point: block.rule().len(), kind });
        let determinant = kernel::determinant(&f);
        // `!(det > 0)` also catches a NaN.
        if !(determinant > 0.0 && determinant.is_finite()) {
            return Err(failure(FailureKind::Inverted { determinant, level: TimeLevel::End }));
        }
        let c = SymmetricTensor2::from_components(kernel::right_cauchy_green(&f));
        let material = self.material();
        if material.law.history().is_some() {
            // Between the Gauss points there is no state: their stresses are extrapolated, as for fields.
            let weights = recovery::extrapolation(cells.kind(), block.rule(), &[point.natural]);
            let mut cauchy = [0.0; 6];
            block
                .visit_points(material, cells.nodes(), local, q, &mut |at| {
                    let weight = weights[at.gauss_point];
                    let stress = recovery::point_state(&at)?.cauchy;
                    cauchy.iter_mut().zip(stress).for_each(|(sum, stress)| *sum += weight * stress);
                    Ok(())
                })
                .map_err(|failure| self.error(point.element, failure))?;
            let green_lagrange = stoss_continuum::green_lagrange(&c).to_components();
            return Ok(PointState { deformation_gradient: f, green_lagrange, cauchy });
        }
        let s = material.law.stress(&c).map_err(|error| failure(FailureKind::Constitutive(error)))?;
        // The averaged pressure, which is linear in the element.
        let mut pressure = 0.0;
        if material.volume.is_some() {
            let weights = recovery::extrapolation(cells.kind(), block.rule(), &[point.natural]);
            block
                .visit_points(material, cells.nodes(), local, q, &mut |at| {
                    pressure += weights[at.gauss_point] * at.pressure;
                    Ok(())
                })
                .map_err(|failure| self.error(point.element, failure))?;
        }
        let cauchy = stoss_continuum::cauchy_stress(&Tensor2::from_fn(|i, a| f[i][a]), &s).to_components();
        Ok(PointState {
            deformation_gradient: f,
            green_lagrange: stoss_continuum::green_lagrange(&c).to_components(),
            cauchy: recovery::with_pressure(cauchy, pressure),
        })
    }
}

/// Natural coordinates of a point and the gradients of the shape functions there, `[I][A]`. Also of points outside, as far as the map can be inverted there.
fn inverse_map(kind: CellKind, places: &[[f64; 3]], x: [f64; 3]) -> Option<([f64; 3], Vec<[f64; 3]>)> {
    let table = kind.table();
    // From a node on, so that round-off does not grow with the distance from the origin.
    let from_first = |x: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| x[i] - places[0][i]) };
    let (x, places): (_, Vec<[f64; 3]>) = (from_first(x), places.iter().map(|x| from_first(*x)).collect());
    let mut natural = table.family.centre();
    for _ in 0..ITERATIONS {
        let (shape, gradient) = ((table.shape)(natural), (table.shape_gradient)(natural));
        let jacobian: Matrix3 = std::array::from_fn(|i| {
            std::array::from_fn(|a| places.iter().zip(&gradient).map(|(x, dn)| x[i] * dn[a]).sum())
        });
        let determinant = kernel::determinant(&jacobian);
        if !(determinant.abs() > 0.0 && determinant.is_finite()) {
            return None;
        }
        let inverse = kernel::inverse(&jacobian, determinant);
        let off: [f64; 3] =
            std::array::from_fn(|i| x[i] - places.iter().zip(&shape).map(|(x, n)| n * x[i]).sum::<f64>());
        let step: [f64; 3] = std::array::from_fn(|a| (0..3).map(|i| inverse[a][i] * off[i]).sum());
        let size = step.iter().fold(0.0, |size: f64, s| size.max(s.abs()));
        for (xi, step) in natural.iter_mut().zip(step) {
            *xi += step;
        }
        if size < 1.0e-12 {
            let at_node = |dn: &[f64; 3]| std::array::from_fn(|i| (0..3).map(|a| dn[a] * inverse[a][i]).sum());
            return Some((natural, gradient[..places.len()].iter().map(at_node).collect()));
        }
    }
    None
}
