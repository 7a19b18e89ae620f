//! An elastic bar that hits a rigid wall along its axis.

use crate::{ConstraintForm, ModelProblem};
use nalgebra::DMatrix;
use stoss_integrators::State;

/// Linear bar of linear elements that flies towards the wall at `x = 0`; the first node is in front.
///
/// In closed form (one-dimensional waves): while it touches, the wall exerts `E A v/c`; a compression wave runs to the rear end
/// and back in [`Self::exact_duration`]; then the bar leaves, free of stress, with the opposite velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BouncingBar {
    /// Number of elements.
    pub elements: usize,
    /// `E A`, a force.
    pub stiffness: f64,
    /// Mass per length.
    pub line_density: f64,
    /// Length.
    pub length: f64,
    /// Speed towards the wall, positive.
    pub speed: f64,
    /// Initial distance from the wall.
    pub gap: f64,
    /// Constraint while closed.
    pub form: ConstraintForm,
}

impl BouncingBar {
    /// `E A = 1`, mass per length 1, length 1 (wave speed 1), speed 0.1, gap 0.05.
    pub fn new(elements: usize, form: ConstraintForm) -> Self {
        Self { elements: elements.max(1), stiffness: 1.0, line_density: 1.0, length: 1.0, speed: 0.1, gap: 0.05, form }
    }
    fn wave_speed(&self) -> f64 {
        (self.stiffness / self.line_density).sqrt()
    }
    /// `2 L/c`.
    pub fn exact_duration(&self) -> f64 {
        2.0 * self.length / self.wave_speed()
    }
    /// Displacement of the front node at a time: towards the wall, at rest there, and back.
    pub fn exact_front(&self, time: f64) -> f64 {
        let touch = self.gap / self.speed;
        let leave = touch + self.exact_duration();
        if time <= touch {
            self.gap - self.speed * time
        } else if time <= leave {
            0.0
        } else {
            self.speed * (time - leave)
        }
    }
    fn h(&self) -> f64 {
        self.length / self.elements as f64
    }
    /// Elongation of an element.
    fn elongation(&self, q: &[f64], e: usize) -> f64 {
        q[e + 1] - q[e] - self.h()
    }
}

impl ModelProblem for BouncingBar {
    fn name(&self) -> &str {
        "bouncing bar"
    }
    fn dimension(&self) -> usize {
        self.elements + 1
    }
    fn mass(&self) -> DMatrix<f64> {
        let (n, m) = (self.elements + 1, self.line_density * self.h() / 6.0);
        let mut out = DMatrix::zeros(n, n);
        for e in 0..self.elements {
            for (i, j, w) in [(e, e, 2.0), (e + 1, e + 1, 2.0), (e, e + 1, 1.0), (e + 1, e, 1.0)] {
                out[(i, j)] += w * m;
            }
        }
        out
    }
    fn initial_state(&self) -> State {
        let q = (0..=self.elements).map(|k| self.gap + k as f64 * self.h()).collect();
        State::new(q, vec![-self.speed; self.elements + 1])
    }
    fn potential(&self, q: &[f64]) -> f64 {
        let k = self.stiffness / self.h();
        (0..self.elements).map(|e| 0.5 * k * self.elongation(q, e).powi(2)).sum()
    }
    fn add_force(&self, q: &[f64], out: &mut [f64]) {
        let k = self.stiffness / self.h();
        for e in 0..self.elements {
            let f = k * self.elongation(q, e);
            out[e] -= f;
            out[e + 1] += f;
        }
    }
    fn add_stiffness(&self, _q: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        let k = factor * self.stiffness / self.h();
        for e in 0..self.elements {
            for (i, j, sign) in [(e, e, 1.0), (e + 1, e + 1, 1.0), (e, e + 1, -1.0), (e + 1, e, -1.0)] {
                out[(i, j)] += sign * k;
            }
        }
    }
    // The potential is quadratic: the force at the midpoint is its discrete gradient.
    fn add_discrete_force(&self, q_n: &[f64], q_np1: &[f64], out: &mut [f64]) {
        let mid: Vec<f64> = q_n.iter().zip(q_np1).map(|(a, b)| 0.5 * (a + b)).collect();
        self.add_force(&mid, out);
    }
    fn add_discrete_stiffness(&self, _q_n: &[f64], q_np1: &[f64], factor: f64, out: &mut DMatrix<f64>) {
        self.add_stiffness(q_np1, 0.5 * factor, out);
    }
    fn constraint_count(&self) -> usize {
        1
    }
    fn is_unilateral(&self) -> bool {
        true
    }
    fn constraint_form(&self) -> ConstraintForm {
        self.form
    }
    fn constraints(&self, q: &[f64], out: &mut [f64]) {
        out[0] = q[0];
    }
    fn jacobian(&self, _q: &[f64], out: &mut DMatrix<f64>) {
        out[(0, 0)] = 1.0;
    }
}
