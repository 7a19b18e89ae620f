//! The books of a step of a simulation.

use super::Simulation;
use super::impact::Impact;
use crate::books::{Books, Posting, is_measured, work_at, work_of};
use crate::iterate::Iterate;
use crate::{Balance, StepError};
use std::ops::Range;
use stoss_integrators::{ForceRule, Step, StepRule};
use stoss_linalg::vector;
use stoss_term::{At, MaterialWork, Term, Work};

/// Books before the velocities of the end are known.
#[derive(Debug)]
pub(super) struct Draft {
    books: Books,
    /// Stored energies of bodies and parts.
    energies: Vec<f64>,
    /// Work of the forces of inertia; NaN where it is not measured.
    inertia: f64,
}

impl Draft {
    /// What the materials of bodies took.
    pub fn dissipated_in_bodies(&self) -> f64 {
        self.books.bodies.iter().map(|body| body.dissipated).sum()
    }

    /// What materials of bodies with history stored and took.
    pub fn material(&self) -> MaterialWork {
        let mut sum = MaterialWork::default();
        self.books.bodies.iter().for_each(|body| sum += body.material);
        sum
    }

    /// The body that has the point which flows most, and how far, if that is more than `limit`.
    pub fn flows_beyond(&self, limit: f64) -> Option<(usize, f64)> {
        let increments = self.books.bodies.iter().map(|body| body.material.flow).enumerate();
        increments.filter(|(_, flow)| *flow > limit).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// What the dampers of parts took.
    pub fn dissipated_by_parts(&self) -> f64 {
        self.books.parts.iter().map(|part| part.dissipated).sum()
    }

    /// Work of drives of bodies and parts.
    pub fn driven(&self) -> f64 {
        self.books.bodies.iter().chain(&self.books.parts).map(|term| term.supplied).sum()
    }

    /// Strain energy of bodies and parts.
    pub fn strain(&self) -> f64 {
        self.energies.iter().fold(0.0, |sum, energy| sum + energy)
    }
}

impl Simulation {
    /// Stored energies of all bodies, then of all parts; zero for parts that are off.
    pub(super) fn energies(&self, q: &[f64]) -> Result<Vec<f64>, StepError> {
        let of = |(term, acts): (&dyn Term, bool)| if acts { term.energy(q) } else { Ok(0.0) };
        let energies = self.model.forces(&self.system.present.acting).map(of).collect();
        let mut energies: Vec<f64> = self.system.shares.agree(energies)?;
        self.system.shares.sum_all(&mut energies[..self.model.bodies.len()]);
        Ok(energies)
    }

    /// Whether dampers of bodies act.
    fn is_damped(&self) -> bool {
        self.system.present.has_damping && self.system.present.has_rates
    }

    /// Books of a step whose equations were evaluated last at `iterate`, whose couplings did the work `of_pairs`.
    ///
    /// # Errors
    /// Where an energy is not defined at the end of the step.
    pub(super) fn draft(
        &mut self,
        iterate: &Iterate,
        of_pairs: &[Work],
        rule: &StepRule,
        dt: f64,
    ) -> Result<Draft, StepError> {
        if self.ledger.energies.is_empty() {
            self.ledger.energies = self.energies(&self.state.q)?;
        }
        let is_static = self.how.scheme.is_none();
        let measured = is_measured(rule);
        let remainder = |rest: f64| if measured { rest } else { f64::NAN };
        let works = &self.system.tally.works;
        let (mut books, mut energies) = (Books::default(), Vec::with_capacity(self.ledger.energies.len()));
        let at = iterate.force_at(&Step { state_n: &self.state, dt, rule: *rule });
        let bodies = self.model.bodies.len();
        let of = |(term, acts): (&dyn Term, bool)| if acts { term.work(&at) } else { Ok(Work::default()) };
        let of_forces = self.model.forces(&self.system.present.acting).map(of).collect();
        let mut of_forces: Vec<Work> = self.system.shares.agree(of_forces)?;
        self.system.shares.sum_work(&mut of_forces[..bodies]);
        for (f, Work { stored, dissipated, driven: supplied, material, .. }) in of_forces.into_iter().enumerate() {
            let mut work = works.forces[f];
            if let Some(body) = self.model.bodies.get(f).filter(|_| measured && self.is_damped()) {
                let damping = &self.system.buffers.damping;
                work += rule.damping_weight() * work_of(damping, body.components(), &self.state.q, &iterate.q);
            }
            let rest = remainder(work - (stored - self.ledger.energies[f]) - dissipated + supplied);
            energies.push(stored);
            let list = if f < bodies { &mut books.bodies } else { &mut books.parts };
            list.push(Posting { stored, dissipated, supplied, remainder: rest, material });
        }
        for (c, work) in of_pairs.iter().enumerate() {
            let (stored, dissipated, supplied) = (work.stored, work.dissipated, work.driven);
            let rest = remainder(works.couplings[c] - (stored - self.ledger.stored[c][0]) - dissipated + supplied);
            books.couplings.push(Posting { stored, dissipated, supplied, remainder: rest, ..Posting::default() });
        }
        let inertia = match measured {
            true => {
                let own = self.system.own.iter().flat_map(Range::clone);
                own.map(|c| self.system.buffers.inertia[c] * iterate.increment[c]).sum()
            }
            false => f64::NAN,
        };
        // In statics, where all forces are those of the end, by the trapezium rule.
        let ends: &[(f64, f64)] =
            if is_static { &[(0.0, 0.5), (1.0, 0.5)] } else { &[(rule.force.rule.load_fraction(), 1.0)] };
        for (load, &acts) in self.model.loads.iter().zip(&self.system.present.acting.loads) {
            let mut supplied = 0.0;
            for &(theta, part) in ends.iter().filter(|_| acts) {
                let rule = ForceRule::Configuration { theta };
                let at = At { time: self.state.time, ..At::force([&self.state.q, &iterate.q], rule, dt) };
                load.assemble(&at, false, &mut |local| {
                    supplied -= part * work_at(&local.nodes, &local.residual, at.q_n, at.q_np1);
                })?;
            }
            books.loads.push(Posting { supplied, ..Posting::default() });
        }
        Ok(Draft { books, energies, inertia })
    }

    /// The books of an accepted step. `way` and `jump` are the work of supports on the way, and what they add to the kinetic energy at the end, both without that of impacts; kinetic energies are those of
    /// `before` and of the present balance.
    pub(super) fn close_books(
        &mut self,
        draft: Draft,
        impact: &Impact,
        [way, jump]: [f64; 2],
        stabilised: f64,
        before: &Balance,
    ) -> Books {
        let Draft { mut books, energies, inertia } = draft;
        self.ledger.energies = energies;
        if self.is_damped() {
            let (buffers, dt) = (&self.system.buffers, self.clock.dt());
            for (posting, body) in books.bodies.iter_mut().zip(&self.model.bodies) {
                let of = body.components();
                let dissipated = dt * vector::dot(&buffers.damping[of.clone()], &buffers.rate[of]);
                posting.dissipated += dissipated;
                posting.remainder -= dissipated;
            }
        }
        let mut taken = 0.0;
        for (c, posting) in books.couplings.iter_mut().enumerate() {
            let of = |list: &[f64]| list.get(c).copied().unwrap_or(0.0);
            let (loss, closing, friction) = (of(&impact.losses), of(&impact.closings), of(&impact.friction));
            posting.dissipated += loss + friction;
            posting.remainder -= closing;
            taken += loss - closing + friction;
        }
        books.supports.supplied = way + jump + impact.external;
        books.stabilisation.dissipated = stabilised;
        books.inertia.stored = self.ledger.balance.kinetic;
        books.inertia.remainder =
            inertia - (self.ledger.balance.kinetic - before.kinetic) - taken + impact.external + jump;
        self.ledger.books.add(&books);
        books
    }
}
