//! The iterate of a step.

use crate::embedding::Followed;
use crate::terms::Line;
use stoss_integrators::{EndPoint, Step};
use stoss_term::At;

/// Iterate of a step.
#[derive(Debug, Clone)]
pub(crate) struct Iterate {
    /// Positions.
    pub q: Vec<f64>,
    /// What is added to the positions at the beginning of the step, see [`EndPoint`].
    pub increment: Vec<f64>,
    /// What carriers had, in both, when their nodes followed them.
    pub followed: [Followed; 2],
    pub pressures: Vec<Vec<f64>>,
    /// Further unknowns of the slots; empty for pairs without.
    pub auxiliaries: Vec<Vec<f64>>,
    pub active: Vec<Vec<bool>>,
}

impl Iterate {
    /// Puts a component to a place.
    pub fn place(&mut self, component: usize, position: f64, q_n: &[f64]) {
        self.q[component] = position;
        self.increment[component] = position - q_n[component];
    }

    /// Moves a component by its increment.
    pub fn displace(&mut self, component: usize, increment: f64, q_n: &[f64]) {
        self.increment[component] = increment;
        self.q[component] = q_n[component] + increment;
    }

    /// Puts everything to where it was at the beginning of the step.
    pub fn go_back(&mut self, q_n: &[f64], embedding: &crate::Embedding) {
        self.q.copy_from_slice(q_n);
        self.increment.fill(0.0);
        self.followed = [embedding.followed(&self.q), embedding.followed(&self.increment)];
    }

    /// Lets the embedded nodes follow the others.
    pub fn follow(&mut self, embedding: &crate::Embedding) {
        let [of_q, of_increment] = &mut self.followed;
        embedding.follow_changes(&mut self.q, of_q);
        embedding.follow_changes(&mut self.increment, of_increment);
    }

    /// What the constraints of a coupling are evaluated at in a step.
    pub fn at<'a>(&'a self, coupling: usize, step: &Step<'a>) -> At<'a> {
        let (rule, auxiliaries) = (step.rule.constraint.rule, &self.auxiliaries[coupling]);
        let (multipliers, active) = (&self.pressures[coupling], &self.active[coupling]);
        At {
            time: step.state_n.time,
            dt: step.dt,
            rates: step.rule.has_inertia(),
            auxiliaries,
            ..At::constraint([&step.state_n.q, &self.q], rule, multipliers, active)
        }
    }

    /// What the forces of a step are evaluated at.
    pub fn force_at<'a>(&'a self, step: &Step<'a>) -> At<'a> {
        let at = At::force([&step.state_n.q, &self.q], step.rule.force.rule, step.dt);
        At { time: step.state_n.time, rates: step.rule.has_inertia(), ..at }
    }

    /// What a term of a line is evaluated at in a step.
    pub fn at_line<'a>(&'a self, line: Line, step: &Step<'a>) -> At<'a> {
        match line {
            Line::Force => self.force_at(step),
            Line::Constraint(coupling) => self.at(coupling, step),
        }
    }

    pub fn end_point(&self) -> EndPoint<'_> {
        EndPoint { q: &self.q, increment: &self.increment }
    }
}
