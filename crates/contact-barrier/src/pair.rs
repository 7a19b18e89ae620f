//! The force of one pair: between two states with exactly the work of its energy, or at one state.

use crate::layer::LayerStep;
use crate::mollifier::EdgePair;
use crate::pattern::{Along, Ends, Pattern};
use crate::sensitivity::Sensitivity;
use crate::slip::{Pressed, SlipLine, Variation};
use crate::tangent::Tangent;
use crate::{EdgeMollifier, FrictionForce, Layer, PairFriction};
use nalgebra::{Matrix3, Vector3};
use stoss_geometry::{ClosestPair, PairKind, closest, combine};

/// A pair as a term of the energy: `V = w m psi(D)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairTerm {
    /// What the primitives are.
    pub kind: PairKind,
    /// Weight `w`, an area.
    pub weight: f64,
    /// The factor `m` of two edges; none for other kinds, and `m = 1`.
    pub mollifier: Option<EdgeMollifier>,
}

/// Energy and gradient of a pair, to be added to a residual; the force on point `i` is `-gradient[i]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairForce {
    /// Gradient, or discrete gradient, by the positions of the four points.
    pub gradient: [Vector3<f64>; 4],
    /// Energy at the (end) state.
    pub energy: f64,
    /// Energy that the damping of the layer takes in the step, `>= 0`; 0 at one state.
    pub dissipated: f64,
}

impl PairForce {
    const NONE: Self = Self { gradient: [Vector3::new(0.0, 0.0, 0.0); 4], energy: 0.0, dissipated: 0.0 };
}

/// Both forces of a pair in a step; the sum of the two gradients is to be added to a residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepForce {
    /// Force of the layer.
    pub barrier: PairForce,
    /// Friction.
    pub friction: FrictionForce,
}

impl StepForce {
    const NONE: Self = Self { barrier: PairForce::NONE, friction: FrictionForce::NONE };
}

impl PairTerm {
    /// Energy, gradient and, if asked for, second derivative (symmetric) of the pair at one state: statics and backward Euler.
    ///
    /// `x` are the points in the order of the kind. There is no damping. All is zero outside of the layer; inside, `D` must be positive.
    pub fn at_state(&self, layer: &Layer, x: &[Vector3<f64>; 4], tangent: Option<&mut Tangent>) -> PairForce {
        self.at_end(layer, x, x, None, tangent).barrier
    }

    /// [`PairTerm::at_state`] at the end `x` of a step from `x_n`, and friction that acts at the end; the tangent is that of the sum, not symmetric with friction.
    ///
    /// Friction has the normal force at the end, and the slip of the step seen from there: no resultant, no moment about `x`, and what it takes is not negative. A finite rotation of the whole pair is free of slip
    /// up to the square of its angle; in [`PairStart::step`] it is exactly.
    pub fn at_end(
        &self,
        layer: &Layer,
        x_n: &[Vector3<f64>; 4],
        x: &[Vector3<f64>; 4],
        friction: Option<&PairFriction<'_>>,
        mut tangent: Option<&mut Tangent>,
    ) -> StepForce {
        let pair = closest(self.kind, x);
        let mut force = StepForce::NONE;
        if !layer.is_inside(pair.distance_squared) {
            fill(tangent, |_, _| Matrix3::zeros());
            return force;
        }
        let (c, r) = (pair.weights, combine(&pair.weights, x));
        let [psi, slope, curvature] = layer.evaluate(pair.distance_squared);
        let (m, state) = self.mollifier.map_or((1.0, None), |p| p.at_state(&EdgePair::new(x)));
        let m_gradient = state.as_ref().map_or([Vector3::zeros(); 4], |s| s.gradient);
        let d_gradient = c.map(|c| r * (2.0 * c));
        force.barrier.energy = self.weight * m * psi;
        for i in 0..4 {
            force.barrier.gradient[i] = (d_gradient[i] * (m * slope) + m_gradient[i] * psi) * self.weight;
        }
        let along = tangent.is_some().then(|| Sensitivity::new(&pair, x, &r));
        if let Some(along) = &along {
            fill(tangent.as_deref_mut(), |i, j| {
                let mut second = Matrix3::identity() * (2.0 * c[i] * c[j]);
                for a in 0..along.count {
                    second +=
                        (along.tangents[a] * c[i] + r * along.directions[a][i]) * (along.moves[a][j] * 2.0).transpose();
                }
                let mut block = (d_gradient[i] * d_gradient[j].transpose() * curvature + second * slope) * m;
                if let Some(state) = &state {
                    block +=
                        (d_gradient[i] * m_gradient[j].transpose() + m_gradient[i] * d_gradient[j].transpose()) * slope;
                    block += state.hessian(i, j) * psi;
                }
                block * self.weight
            });
        }
        if let Some(law) = friction {
            let normal = r * (-2.0 * self.weight * m * slope);
            let dx: [Vector3<f64>; 4] = std::array::from_fn(|i| x[i] - x_n[i]);
            let pressed = Pressed { base: (self.kind, EACH), normal, weights: &c, x, dx: &dx };
            let varied = along.as_ref().map(|along| {
                let by_weights = by_points(|i, j| {
                    (0..along.count).map(|a| along.moves[a][j] * along.directions[a][i]).sum::<Vector3<f64>>()
                });
                let by_normal: [Matrix3<f64>; 4] = std::array::from_fn(|j| {
                    let by_scalar = d_gradient[j] * (m * curvature) + m_gradient[j] * slope;
                    let mut by_r = Matrix3::identity() * c[j];
                    for a in 0..along.count {
                        by_r += along.tangents[a] * along.moves[a][j].transpose();
                    }
                    (r * by_scalar.transpose() + by_r * (m * slope)) * (-2.0 * self.weight)
                });
                (by_weights, by_normal)
            });
            let variation = varied.as_ref().map(|(weights, normal)| Variation { share: 1.0, weights, normal });
            let tangent = tangent.map(|tangent| tangent.as_flattened_mut());
            let mut gradient = [Vector3::zeros(); 4];
            let slid = pressed.friction(law, &mut gradient, variation.as_ref().zip(tangent));
            force.friction = slid.of_pair(gradient);
        }
        force
    }
}

impl PairTerm {
    /// Friction of [`PairTerm::at_end`] along a motion of the points from `x` by `d`, with the normal force at `x`.
    pub(crate) fn slip_along(
        &self,
        layer: &Layer,
        [x_n, x, d]: [&[Vector3<f64>; 4]; 3],
        friction: &PairFriction<'_>,
    ) -> Option<SlipLine> {
        let pair = closest(self.kind, x);
        if !layer.is_inside(pair.distance_squared) {
            return None;
        }
        let r = combine(&pair.weights, x);
        let [_, slope, _] = layer.evaluate(pair.distance_squared);
        let (m, _) = self.mollifier.map_or((1.0, None), |p| p.at_state(&EdgePair::new(x)));
        let normal = r * (-2.0 * self.weight * m * slope);
        let dx: [Vector3<f64>; 4] = std::array::from_fn(|i| x[i] - x_n[i]);
        Pressed { base: (self.kind, EACH), normal, weights: &pair.weights, x, dx: &dx }.along(friction, d)
    }
}

/// A pair at the start of a step: what its forces need of there.
#[derive(Clone, Copy, Debug)]
pub struct PairStart {
    term: PairTerm,
    layer: Layer,
    x: [Vector3<f64>; 4],
    closest: ClosestPair,
    psi: f64,
    edges: Option<EdgePair>,
    energy: f64,
}

impl PairStart {
    /// The pair with its points at the start of the step; their distance must be positive.
    pub fn new(term: PairTerm, layer: Layer, x: &[Vector3<f64>; 4]) -> Self {
        let closest = closest(term.kind, x);
        let [psi, ..] = layer.evaluate(closest.distance_squared);
        let m = term.mollifier.map_or(1.0, |p| p.factor(x));
        let edges = term.mollifier.map(|_| EdgePair::new(x));
        Self { term, layer, x: *x, closest, psi, edges, energy: term.weight * m * psi }
    }

    /// Energy at the start of the step.
    pub fn energy(&self) -> f64 {
        self.energy
    }

    /// Closest weights and squared distance at the start.
    pub fn closest(&self) -> &ClosestPair {
        &self.closest
    }

    /// Discrete gradient `g` between the start and `x`, energy at `x`, and, if asked for, `dg/dx` (not symmetric); theory/barrier#eq-discrete-gradient, theory/barrier#eq-tangent.
    ///
    /// For any two states, across any change of the closest features: `sum g_i . (x_i - x_n,i)` is the change of the energy and what the damping of the layer takes, `sum g_i = 0`, `sum x_m,i x g_i = 0` about
    /// the mean positions `x_m`, all to round-off. Without damping, exchanging the states gives the same forces. A pair has to be taken as long as it is inside of the layer at *one* of the states.
    pub fn force(&self, x: &[Vector3<f64>; 4], tangent: Option<&mut Tangent>) -> PairForce {
        self.step(x, None, tangent).barrier
    }

    /// [`PairStart::force`] and friction between the start and `x`, and, if asked for, the derivative of the sum of their gradients; theory/barrier#friction.
    ///
    /// Friction has no resultant and no moment about the mean positions, it takes `sum g_i . (x_i - x_n,i) >= 0`, and a finite rigid motion of the whole pair has no slip, with a gap as well.
    /// Pairs of a vertex and an edge, and of two vertices, have no friction: their points cannot carry the moment of it. That of nearly parallel edges, and of triangles nearly without area, fades out.
    pub fn step(
        &self,
        x: &[Vector3<f64>; 4],
        friction: Option<&PairFriction<'_>>,
        mut tangent: Option<&mut Tangent>,
    ) -> StepForce {
        let Self { term, layer, .. } = self;
        let end = closest(term.kind, x);
        let (d_n, d) = (self.closest.distance_squared, end.distance_squared);
        if !layer.is_inside(d_n) && !layer.is_inside(d) {
            fill(tangent, |_, _| Matrix3::zeros());
            return StepForce::NONE;
        }
        let [psi, slope, _] = layer.evaluate(d);
        let LayerStep { b, slope: db, dissipated } = layer.step(d_n, d);
        let ends = Ends { c_n: &self.closest.weights, c: &end.weights, x_n: &self.x, x, distances: d_n + d };
        let pattern = Pattern::between(&ends);
        let c: [f64; 4] = std::array::from_fn(|i| pattern.weight(&ends, i));
        let (m_mean, m_np1, varies) = match (&term.mollifier, &self.edges) {
            (Some(mollifier), Some(edges)) => {
                let between = mollifier.between(edges, &EdgePair::new(x));
                (0.5 * (between.m_n + between.m_np1), between.m_np1, between.varies)
            }
            _ => (1.0, 1.0, None),
        };
        let psi_mean = 0.5 * (self.psi + psi);
        let d_gradient = c.map(|c| pattern.r * (2.0 * c));
        let m_gradient = varies.as_ref().map_or([Vector3::zeros(); 4], |v| v.gradient());
        let w = term.weight;
        let gradient = std::array::from_fn(|i| (d_gradient[i] * (m_mean * b) + m_gradient[i] * psi_mean) * w);
        let varied = tangent.is_some().then(|| {
            let of_end = Sensitivity::new(&end, x, &pattern.r_end);
            let directions: [[f64; 2]; 4] = std::array::from_fn(|i| of_end.directions.map(|b| b[i]));
            let moves: [[Vector3<f64>; 2]; 4] = std::array::from_fn(|j| of_end.moves.map(|m| m[j]));
            let along = Along { directions: &directions, moves: &moves };
            let (mut d_lambda, mut d_r) = ([Vector3::zeros(); 4], [Matrix3::zeros(); 4]);
            pattern.differentiate(&ends, &along, &mut d_lambda, &mut d_r);
            let d_c = by_points(|i, j| pattern.weight_gradient(&ends, &along, &d_lambda, i, j));
            let by_d = end.weights.map(|c| pattern.r_end * (2.0 * c));
            let by_scalar: [Vector3<f64>; 4] = std::array::from_fn(|j| {
                let by_b = by_d[j] * (m_mean * db);
                varies.as_ref().map_or(by_b, |v| by_b + v.m_np1_gradient[j] * (0.5 * b))
            });
            (d_c, d_r, by_d, by_scalar)
        });
        if let Some((d_c, d_r, by_d, by_scalar)) = &varied {
            fill(tangent.as_deref_mut(), |i, j| {
                let mut block = (pattern.r * d_c[4 * i + j].transpose() + d_r[j] * c[i]) * (2.0 * m_mean * b);
                if let Some(varies) = &varies {
                    block += m_gradient[i] * (by_d[j] * (0.5 * slope)).transpose();
                    block += varies.gradient_tangent(i, j) * psi_mean;
                }
                (block + d_gradient[i] * by_scalar[j].transpose()) * w
            });
        }
        let barrier = PairForce { gradient, energy: w * m_np1 * psi, dissipated: w * m_mean * dissipated };
        let Some(law) = friction else { return StepForce { barrier, friction: FrictionForce::NONE } };
        let middle: [Vector3<f64>; 4] = std::array::from_fn(|i| (self.x[i] + x[i]) * 0.5);
        let dx: [Vector3<f64>; 4] = std::array::from_fn(|i| x[i] - self.x[i]);
        let normal = pattern.r * (-2.0 * w * m_mean * b);
        let pressed = Pressed { base: (term.kind, EACH), normal, weights: &c, x: &middle, dx: &dx };
        let by_normal = varied.as_ref().map(|(_, d_r, _, by_scalar)| {
            let of = |j: usize| (pattern.r * by_scalar[j].transpose() + d_r[j] * (m_mean * b)) * (-2.0 * w);
            [0, 1, 2, 3].map(of)
        });
        let variation = varied.as_ref().zip(by_normal.as_ref());
        let variation = variation.map(|((weights, ..), normal)| Variation { share: 0.5, weights, normal });
        let tangent = tangent.map(|tangent| tangent.as_flattened_mut());
        let mut gradient = [Vector3::zeros(); 4];
        let slid = pressed.friction(law, &mut gradient, variation.as_ref().zip(tangent));
        StepForce { barrier, friction: slid.of_pair(gradient) }
    }

    /// The part of the end in the balanced pattern, for tests of its bounds.
    #[cfg(test)]
    fn lambda(&self, x: &[Vector3<f64>; 4]) -> f64 {
        let end = closest(self.term.kind, x);
        let distances = self.closest.distance_squared + end.distance_squared;
        let ends = Ends { c_n: &self.closest.weights, c: &end.weights, x_n: &self.x, x, distances };
        Pattern::between(&ends).lambda
    }
}

/// The places of the four points of a pair in its own list.
const EACH: [usize; 4] = [0, 1, 2, 3];

/// Entries of two points, those of the second one together.
fn by_points<T: Copy>(of: impl Fn(usize, usize) -> T) -> [T; 16] {
    std::array::from_fn(|k| of(k / 4, k % 4))
}

/// Fills a tangent, if there is one, by its blocks of two points.
fn fill(tangent: Option<&mut Tangent>, block: impl Fn(usize, usize) -> Matrix3<f64>) {
    if let Some(tangent) = tangent {
        for i in 0..4 {
            for j in 0..4 {
                let block = block(i, j);
                for k in 0..3 {
                    for l in 0..3 {
                        tangent[3 * i + k][3 * j + l] = block[(k, l)];
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points() -> impl Strategy<Value = [Vector3<f64>; 4]> {
        proptest::array::uniform4(proptest::array::uniform3(-1.0..1.0f64).prop_map(Vector3::from))
    }

    proptest! {
        #[test]
        fn the_balance_is_between_zero_and_one_and_turns_around_with_time(x_n in points(), noise in points(), exponent in -16.0..0.5f64) {
            let x: [_; 4] = std::array::from_fn(|i| x_n[i] + noise[i] * 10f64.powf(exponent));
            for kind in [PairKind::VertexTriangle, PairKind::EdgeEdge, PairKind::VertexEdge, PairKind::VertexVertex] {
                let term = PairTerm { kind, weight: 1.0, mollifier: None };
                let at = |x| PairStart::new(term, Layer::new(1.0, 1.0), x);
                let (forth, back) = (at(&x_n).lambda(&x), at(&x).lambda(&x_n));
                prop_assert!((0.0..=1.0).contains(&forth));
                prop_assert!((forth + back - 1.0).abs() < 1e-12, "{} {}", forth, back);
            }
        }
    }
}
