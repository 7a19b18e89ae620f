//! The force of a contact: the sum of terms, each with one balanced pattern of weights over all points of the contact, and one friction with the pattern that the sum has; theory/barrier#patch, theory/barrier#joint-friction.

use crate::Layer;
use crate::layer::LayerStep;
use crate::pattern::{Along, Ends, Pattern};
use crate::sensitivity::Sensitivity;
use crate::slip::{Friction, Pressed, Slid, SlipLine, Variation, add_block};
use nalgebra::{Matrix3, Vector3};
use stoss_geometry::{ClosestPair, PairKind};

/// A term: its weight with the sign of the piece, and where it is nearest at the start and at the end, each over four of the points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    pub weight: f64,
    pub slots_n: [usize; 4],
    pub start: ClosestPair,
    pub slots: [usize; 4],
    pub end: ClosestPair,
}

/// What a contact does in a step, but for its gradients.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Energy at the end.
    pub energy: f64,
    /// What the damping takes.
    pub dissipated: f64,
    pub slid: Option<Slid>,
}

/// The law of friction and the places of the four points whose spin is no slip.
pub(super) type Law<'a> = (&'a Friction, (PairKind, [usize; 4]));

/// The points of a contact, each once and the point itself first, and what its force is made of. It is used for one contact after the other.
#[derive(Debug, Default)]
pub(super) struct Joint {
    pub points: Vec<u32>,
    pub terms: Vec<Term>,
    pub x_n: Vec<Vector3<f64>>,
    pub x: Vec<Vector3<f64>>,
    /// Gradients of the barrier and of friction, to be added to a residual, and the derivative of their sum: `3 i + k` is component `k` of point `i`.
    pub barrier: Vec<Vector3<f64>>,
    pub friction: Vec<Vector3<f64>>,
    pub tangent: Vec<f64>,
    /// Where forces act, and the motion in the step.
    acting: Vec<Vector3<f64>>,
    moved: Vec<Vector3<f64>>,
    c_n: Vec<f64>,
    c: Vec<f64>,
    /// Weights of the common pattern, and its normal force.
    weights: Vec<f64>,
    normal: Vector3<f64>,
    directions: Vec<[f64; 2]>,
    moves: Vec<[Vector3<f64>; 2]>,
    d_lambda: Vec<Vector3<f64>>,
    d_r: Vec<Matrix3<f64>>,
    /// Derivatives of the sum of the factors `beta`, of `beta c` (of the common weights in the end) and of the normal force.
    d_beta: Vec<Vector3<f64>>,
    d_c: Vec<Vector3<f64>>,
    d_normal: Vec<Matrix3<f64>>,
}

fn refill<T: Clone>(list: &mut Vec<T>, count: usize, value: T) {
    list.clear();
    list.resize(count, value);
}

impl Joint {
    /// The place of a point in the list; at its end, if it is not there.
    pub fn slot(&mut self, point: u32) -> usize {
        self.points.iter().position(|p| *p == point).unwrap_or_else(|| {
            self.points.push(point);
            self.points.len() - 1
        })
    }

    /// Positions of the points at the start and at the iterate.
    pub fn place(&mut self, x_n: &[Vector3<f64>], x: &[Vector3<f64>]) {
        let Self { points, x_n: of_n, x: of, .. } = self;
        for (list, x) in [(of_n, x_n), (of, x)] {
            list.clear();
            list.extend(points.iter().map(|&p| x[p as usize]));
        }
    }

    /// The forces of the terms between both states, or, `at_end`, at the second one.
    pub fn act(&mut self, layer: &Layer, at_end: bool, friction: Option<Law<'_>>, wants_tangent: bool) -> Sums {
        let n = self.x.len();
        let share = if at_end { 1.0 } else { 0.5 };
        let varied = wants_tangent && friction.is_some();
        self.clear(at_end, wants_tangent, varied);
        let mut sums = Sums::default();
        let mut beta_sum = 0.0;
        let mut terms = std::mem::take(&mut self.terms);
        for term in &terms {
            let (d_n, d) = (term.start.distance_squared, term.end.distance_squared);
            let [psi, slope, curvature] = layer.evaluate(d);
            let of_layer = match at_end {
                true => LayerStep { b: slope, slope: curvature, dissipated: 0.0 },
                false => layer.step(d_n, d),
            };
            sums.energy += term.weight * psi;
            sums.dissipated += term.weight * of_layer.dissipated;
            if of_layer.b == 0.0 && of_layer.slope == 0.0 {
                continue;
            }
            beta_sum += self.add(term, &of_layer, at_end, wants_tangent, varied);
        }
        terms.clear();
        self.terms = terms;
        let Some((law, base)) = friction.filter(|_| beta_sum > 0.0) else { return sums };
        self.weights.iter_mut().for_each(|c| *c /= beta_sum);
        if varied {
            for i in 0..n {
                for j in 0..n {
                    let d = &mut self.d_c[i * n + j];
                    *d = (*d - self.d_beta[j] * self.weights[i]) / beta_sum;
                }
            }
        }
        let variation = Variation { share, weights: &self.d_c, normal: &self.d_normal };
        let pressed = Pressed { normal: self.normal, weights: &self.weights, x: &self.acting, dx: &self.moved, base };
        let tangent = varied.then_some((&variation, &mut self.tangent[..]));
        sums.slid = Some(pressed.friction(law, &mut self.friction, tangent));
        sums
    }

    /// Friction of the last [`Self::act`] along a motion of the points by `d`.
    pub fn along(&self, (law, base): Law<'_>, d: &[Vector3<f64>]) -> Option<SlipLine> {
        Pressed { normal: self.normal, weights: &self.weights, x: &self.acting, dx: &self.moved, base }.along(law, d)
    }

    fn clear(&mut self, at_end: bool, wants_tangent: bool, varied: bool) {
        let Self { x_n, x, acting, moved, .. } = self;
        let n = x.len();
        acting.clear();
        moved.clear();
        moved.extend(x.iter().zip(&*x_n).map(|(x, x_n)| x - x_n));
        match at_end {
            true => acting.extend_from_slice(x),
            false => acting.extend(x.iter().zip(&*x_n).map(|(x, x_n)| (x + x_n) * 0.5)),
        }
        let none = Vector3::zeros();
        refill(&mut self.barrier, n, none);
        refill(&mut self.friction, n, none);
        refill(&mut self.weights, n, 0.0);
        self.normal = none;
        if wants_tangent {
            refill(&mut self.tangent, 9 * n * n, 0.0);
            refill(&mut self.d_lambda, n, none);
            refill(&mut self.d_r, n, Matrix3::zeros());
        }
        if varied {
            refill(&mut self.d_beta, n, none);
            refill(&mut self.d_c, n * n, none);
            refill(&mut self.d_normal, n, Matrix3::zeros());
        }
    }

    /// Adds the force of a term; returns its part in the sum of the factors `beta = -2 w b`.
    fn add(&mut self, term: &Term, layer: &LayerStep, at_end: bool, wants_tangent: bool, varied: bool) -> f64 {
        let n = self.x.len();
        let Self { x_n, x, c_n, c, .. } = self;
        refill(c_n, n, 0.0);
        refill(c, n, 0.0);
        for i in 0..4 {
            c_n[term.slots_n[i]] += term.start.weights[i];
            c[term.slots[i]] += term.end.weights[i];
        }
        let distances = term.start.distance_squared + term.end.distance_squared;
        let ends = Ends { c_n, c, x_n, x, distances };
        let pattern = if at_end { Pattern::at_end(&ends) } else { Pattern::between(&ends) };
        let factor = 2.0 * term.weight * layer.b;
        for i in 0..n {
            let weight = pattern.weight(&ends, i);
            self.barrier[i] += pattern.r * (factor * weight);
            self.weights[i] -= factor * weight;
        }
        self.normal -= pattern.r * factor;
        if !wants_tangent {
            return -factor;
        }
        let of_end = Sensitivity::new(&term.end, &term.slots.map(|i| x[i]), &pattern.r_end);
        refill(&mut self.directions, n, [0.0; 2]);
        refill(&mut self.moves, n, [Vector3::zeros(); 2]);
        for a in 0..of_end.count {
            for (k, &slot) in term.slots.iter().enumerate() {
                self.directions[slot][a] += of_end.directions[a][k];
                self.moves[slot][a] += of_end.moves[a][k];
            }
        }
        let along = Along { directions: &self.directions, moves: &self.moves };
        pattern.differentiate(&ends, &along, &mut self.d_lambda, &mut self.d_r);
        for j in 0..n {
            let by_b = pattern.r_end * (4.0 * term.weight * layer.slope * ends.c[j]);
            for i in 0..n {
                let weight = pattern.weight(&ends, i);
                let dc = pattern.weight_gradient(&ends, &along, &self.d_lambda, i, j);
                let block = pattern.r * (by_b * weight + dc * factor).transpose() + self.d_r[j] * (factor * weight);
                add_block(&mut self.tangent, n, [i, j], &block);
                if varied {
                    self.d_c[i * n + j] -= dc * factor + by_b * weight;
                }
            }
            if varied {
                self.d_beta[j] -= by_b;
                self.d_normal[j] -= self.d_r[j] * factor + pattern.r * by_b.transpose();
            }
        }
        -factor
    }
}

#[cfg(test)]
#[path = "joint_tests.rs"]
mod tests;
