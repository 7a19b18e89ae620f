//! The force of one pair: between two states with exactly the work of its energy, or at one state.

use crate::layer::LayerStep;
use crate::mollifier::EdgePair;
use crate::sensitivity::Sensitivity;
use crate::slip::{Pressed, SlipLine, Variation};
use crate::tangent::Tangent;
use crate::{EdgeMollifier, Friction, FrictionForce, Layer};
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
    /// Of the layer.
    pub barrier: PairForce,
    /// Friction.
    pub friction: FrictionForce,
}

impl StepForce {
    const NONE: Self = Self { barrier: PairForce::NONE, friction: FrictionForce::NONE };
}

/// Relative to the squared distances: the part of `e_n`, `e_np1` that decides between the two patterns where both are zero.
const BALANCE: f64 = 1e-20;

/// Below this part of the squared distances `e_n + e_np1` is round-off, and the patterns are the same to half of the digits: the balance has no derivative.
const SAME_PATTERN: f64 = 1e-18;

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
        friction: Option<&Friction>,
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
            let dx = std::array::from_fn(|i| x[i] - x_n[i]);
            let pressed = Pressed { kind: self.kind, normal, weights: c, x: *x, dx };
            let variation = along.as_ref().map(|along| Variation {
                along,
                share: 1.0,
                normal: std::array::from_fn(|j| {
                    let by_scalar = d_gradient[j] * (m * curvature) + m_gradient[j] * slope;
                    let mut by_r = Matrix3::identity() * c[j];
                    for a in 0..along.count {
                        by_r += along.tangents[a] * along.moves[a][j].transpose();
                    }
                    (r * by_scalar.transpose() + by_r * (m * slope)) * (-2.0 * self.weight)
                }),
            });
            force.friction = pressed.friction(law, variation.as_ref().zip(tangent));
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
        friction: &Friction,
    ) -> Option<SlipLine> {
        let pair = closest(self.kind, x);
        if !layer.is_inside(pair.distance_squared) {
            return None;
        }
        let r = combine(&pair.weights, x);
        let [_, slope, _] = layer.evaluate(pair.distance_squared);
        let (m, _) = self.mollifier.map_or((1.0, None), |p| p.at_state(&EdgePair::new(x)));
        let normal = r * (-2.0 * self.weight * m * slope);
        let dx = std::array::from_fn(|i| x[i] - x_n[i]);
        Pressed { kind: self.kind, normal, weights: pair.weights, x: *x, dx }.along(friction, d)
    }
}

/// A pair at the start of a step: what its forces need of there.
#[derive(Clone, Copy, Debug)]
pub struct PairStart {
    term: PairTerm,
    layer: Layer,
    x: [Vector3<f64>; 4],
    closest: ClosestPair,
    r: Vector3<f64>,
    psi: f64,
    edges: Option<EdgePair>,
    energy: f64,
}

impl PairStart {
    /// The pair with its points at the start of the step; their distance must be positive.
    pub fn new(term: PairTerm, layer: Layer, x: &[Vector3<f64>; 4]) -> Self {
        let closest = closest(term.kind, x);
        let r = combine(&closest.weights, x);
        let [psi, ..] = layer.evaluate(closest.distance_squared);
        let m = term.mollifier.map_or(1.0, |p| p.factor(x));
        let edges = term.mollifier.map(|_| EdgePair::new(x));
        Self { term, layer, x: *x, closest, r, psi, edges, energy: term.weight * m * psi }
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
        friction: Option<&Friction>,
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
        let patterns = Patterns::new(self, &end, x);
        let (m_mean, m_np1, varies) = match (&term.mollifier, &self.edges) {
            (Some(mollifier), Some(edges)) => {
                let between = mollifier.between(edges, &EdgePair::new(x));
                (0.5 * (between.m_n + between.m_np1), between.m_np1, between.varies)
            }
            _ => (1.0, 1.0, None),
        };
        let psi_mean = 0.5 * (self.psi + psi);
        let d_gradient: [Vector3<f64>; 4] = std::array::from_fn(|i| patterns.gradient(i));
        let m_gradient = varies.as_ref().map_or([Vector3::zeros(); 4], |v| v.gradient());
        let w = term.weight;
        let gradient = std::array::from_fn(|i| (d_gradient[i] * (m_mean * b) + m_gradient[i] * psi_mean) * w);
        let varied = tangent.is_some().then(|| {
            let along = Sensitivity::new(&end, x, &patterns.r);
            let theta_gradient = patterns.theta_gradient(self, &along, d_n + d);
            let by_d = patterns.c.map(|c| patterns.r * (2.0 * c));
            let by_scalar: [Vector3<f64>; 4] = std::array::from_fn(|j| {
                let by_b = by_d[j] * (m_mean * db);
                varies.as_ref().map_or(by_b, |v| by_b + v.m_np1_gradient[j] * (0.5 * b))
            });
            (along, theta_gradient, by_d, by_scalar)
        });
        if let Some((along, theta_gradient, by_d, by_scalar)) = &varied {
            fill(tangent.as_deref_mut(), |i, j| {
                let mut block = patterns.tangent(along, theta_gradient, i, j) * (m_mean * b);
                if let Some(varies) = &varies {
                    block += m_gradient[i] * (by_d[j] * (0.5 * slope)).transpose();
                    block += varies.gradient_tangent(i, j) * psi_mean;
                }
                (block + d_gradient[i] * by_scalar[j].transpose()) * w
            });
        }
        let barrier = PairForce { gradient, energy: w * m_np1 * psi, dissipated: w * m_mean * dissipated };
        let Some(law) = friction else { return StepForce { barrier, friction: FrictionForce::NONE } };
        let mean_r = patterns.mean_r();
        let pressed = Pressed {
            kind: term.kind,
            normal: mean_r * (-2.0 * w * m_mean * b),
            weights: std::array::from_fn(|i| 0.5 * (patterns.c_n[i] + patterns.c[i])),
            x: patterns.x_mid,
            dx: std::array::from_fn(|i| x[i] - self.x[i]),
        };
        let variation = varied.as_ref().map(|(along, theta_gradient, _, by_scalar)| Variation {
            along,
            share: 0.5,
            normal: std::array::from_fn(|j| {
                let by_r = patterns.mean_r_tangent(along, theta_gradient, j);
                (mean_r * by_scalar[j].transpose() + by_r * (m_mean * b)) * (-2.0 * w)
            }),
        });
        StepForce { barrier, friction: pressed.friction(law, variation.as_ref().zip(tangent)) }
    }

    /// The balance `theta` between the patterns of the start (0) and of the end (1), for tests of its bounds.
    #[cfg(test)]
    fn theta(&self, x: &[Vector3<f64>; 4]) -> f64 {
        Patterns::new(self, &closest(self.term.kind, x), x).theta
    }
}

/// The two patterns of forces: of the closest weights of the start and of those of the end, both in the middle of the step.
struct Patterns {
    /// Weights of the start and of the end.
    c_n: [f64; 4],
    c: [f64; 4],
    /// Their `sum c_i x_i` in the middle of the step.
    middle_n: Vector3<f64>,
    middle: Vector3<f64>,
    /// `sum c_i x_i` at the end with the weights of the end.
    r: Vector3<f64>,
    /// `sum (c - c_n)_i x_i` at the start and at the end.
    z_n: Vector3<f64>,
    z: Vector3<f64>,
    theta: f64,
    /// `e_n + e_np1` with the balance.
    sum: f64,
    x_mid: [Vector3<f64>; 4],
}

impl Patterns {
    fn new(start: &PairStart, end: &ClosestPair, x: &[Vector3<f64>; 4]) -> Self {
        let (c_n, c) = (start.closest.weights, end.weights);
        let shift = std::array::from_fn(|i| c[i] - c_n[i]);
        let (z_n, z) = (combine(&shift, &start.x), combine(&shift, x));
        let r = combine(&c, x);
        // |r + z|^2 - |r|^2; the linear terms are not negative by the condition of the minimum.
        let e_n = z_n.norm_squared() + (2.0 * z_n.dot(&start.r)).max(0.0);
        let e = z.norm_squared() + (-2.0 * z.dot(&r)).max(0.0);
        let balance = BALANCE * (start.closest.distance_squared + end.distance_squared) + f64::MIN_POSITIVE;
        let sum = e_n + e + 2.0 * balance;
        Self {
            c_n,
            c,
            middle_n: (start.r + r - z) * 0.5,
            middle: (r + start.r + z_n) * 0.5,
            r,
            z_n,
            z,
            theta: (e + balance) / sum,
            sum,
            x_mid: std::array::from_fn(|i| (start.x[i] + x[i]) * 0.5),
        }
    }

    /// Discrete gradient of the squared distance at point `i`.
    fn gradient(&self, i: usize) -> Vector3<f64> {
        (self.middle_n * ((1.0 - self.theta) * self.c_n[i]) + self.middle * (self.theta * self.c[i])) * 2.0
    }

    /// `(1 - theta) r(c_n; q_m) + theta r(c; q_m)`.
    fn mean_r(&self) -> Vector3<f64> {
        self.middle_n * (1.0 - self.theta) + self.middle * self.theta
    }

    /// Its derivative with respect to point `j` at the end.
    fn mean_r_tangent(&self, along: &Sensitivity, theta_gradient: &[Vector3<f64>; 4], j: usize) -> Matrix3<f64> {
        let Self { c_n, c, theta, .. } = self;
        let mut block = Matrix3::identity() * (0.5 * ((1.0 - theta) * c_n[j] + theta * c[j]));
        block += (self.middle - self.middle_n) * theta_gradient[j].transpose();
        for a in 0..along.count {
            let along_mid = combine(&along.directions[a], &self.x_mid);
            block += along_mid * (along.moves[a][j] * *theta).transpose();
        }
        block
    }

    /// `dtheta/dx_j`.
    fn theta_gradient(&self, start: &PairStart, along: &Sensitivity, distances: f64) -> [Vector3<f64>; 4] {
        if self.sum <= SAME_PATTERN * distances {
            return [Vector3::zeros(); 4];
        }
        let at_start = start.r + self.z_n;
        let slopes: [f64; 2] = std::array::from_fn(|a| 2.0 * at_start.dot(&combine(&along.directions[a], &start.x)));
        std::array::from_fn(|j| {
            let e = (self.z * self.c_n[j] + self.r * (self.c[j] - self.c_n[j])) * -2.0;
            let e_n: Vector3<f64> = (0..along.count).map(|a| along.moves[a][j] * slopes[a]).sum();
            (e * (1.0 - self.theta) - e_n * self.theta) / self.sum
        })
    }

    /// Derivative of the discrete gradient at point `i` with respect to point `j` at the end.
    fn tangent(&self, along: &Sensitivity, theta_gradient: &[Vector3<f64>; 4], i: usize, j: usize) -> Matrix3<f64> {
        let Self { c_n, c, theta, .. } = self;
        let mut block = Matrix3::identity() * ((1.0 - theta) * c_n[i] * c_n[j] + theta * c[i] * c[j]);
        block += (self.middle * c[i] - self.middle_n * c_n[i]) * (theta_gradient[j] * 2.0).transpose();
        for a in 0..along.count {
            let along_mid = combine(&along.directions[a], &self.x_mid);
            let change = self.middle * along.directions[a][i] + along_mid * c[i];
            block += change * (along.moves[a][j] * (2.0 * theta)).transpose();
        }
        block
    }
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
                let (forth, back) = (at(&x_n).theta(&x), at(&x).theta(&x_n));
                prop_assert!((0.0..=1.0).contains(&forth));
                prop_assert!((forth + back - 1.0).abs() < 1e-12, "{} {}", forth, back);
            }
        }
    }
}
