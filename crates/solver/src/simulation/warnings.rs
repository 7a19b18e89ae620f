//! Warnings about a completed step.

use super::Simulation;
use crate::problem::SMALLEST_RESOLVED_MOTION;
use crate::step::decision;
use crate::{Balance, Decision, DecisionKind, StepError};
use stoss_fe_solid::InsideOut;

/// Gain of energy by contact in one dynamic step that is reported, relative to the largest energy of the bodies so far.
const REPORTED_GAIN: f64 = 0.05;
/// Work of stabilisation that is reported at the end of its stage, relative to the largest energy of the bodies so far.
const REPORTED_STABILISATION: f64 = 0.01;
/// Start of that warning, by which a second one is avoided.
const CONTACT_ADDED: &str = "contact added";
/// Part of the factorisations that are done twice from which on they are reported, and how many have to be known.
const REPORTED_FALLBACKS: f64 = 0.5;
const KNOWN_FACTORISATIONS: u64 = 4;
/// Start of that warning.
const WITHOUT_PIVOTS: &str = "the multifrontal solver found no good pivots";
/// Start of the warning that the iteration left a step to the direct solver.
const HANDED_OVER: &str = "the linear equations are not solved by iteration";
/// Start of the warning that rows of contact depend on each other.
const DEPENDENT: &str = "rows of contact depend on each other";

/// A part in per cent, or as a multiple where it is large.
fn part_of(part: f64) -> String {
    if part < 10.0 { format!("{:.1} % of", 100.0 * part) } else { format!("{part:.0e} times") }
}

impl Simulation {
    /// Bodies that now have elements turned inside out and had none at the last step.
    pub(super) fn newly_inside_out(&self, now: &[Option<InsideOut>]) -> impl Iterator<Item = StepError> {
        let some = now.iter().any(Option::is_some);
        // The lengths were checked when the last step was accepted.
        let before = if some { self.inside_out(&self.state.q).unwrap_or_default() } else { Vec::new() };
        let new = move |(b, now): (usize, &Option<InsideOut>)| {
            let (Some(found), None) = (*now, before.get(b).copied().flatten()) else { return None };
            let solid = &self.model.bodies[b].solid;
            Some(StepError::InsideOut { body: solid.name().to_owned(), elements: solid.element_count(), found })
        };
        now.iter().enumerate().filter_map(new)
    }

    /// Warns of bodies that this step has turned inside out.
    pub(super) fn warn_inside_out(&mut self, now: &[Option<InsideOut>]) {
        let (step, time, dt) = (self.step + 1, self.state.time, self.clock.dt());
        let warn = |error: StepError| {
            let reason = format!("{error}; the result is doubtful from here on, try smaller steps or another mesh");
            decision(step, time, dt, DecisionKind::Warning, reason)
        };
        let warnings: Vec<_> = self.newly_inside_out(now).map(warn).collect();
        self.log.decisions.extend(warnings);
    }

    /// Warns at the end of a stage if its stabilisation has taken much energy.
    pub(super) fn warn_stabilisation(&mut self) {
        let Balance { largest_energy, stabilisation, .. } = self.ledger.balance;
        if self.system.present.stabilisation.is_none()
            || !self.clock.finished()
            || stabilisation.abs() <= REPORTED_STABILISATION * largest_energy
        {
            return;
        }
        let reason = format!(
            "stabilisation has dissipated {} the largest energy that the bodies had. Its force is zero at the end of the stage; but where surfaces slid, or where there are several equilibria, \
             the result depends on the path. Where bodies only closed gaps this is harmless; otherwise reduce the steps or the fraction of the stage, or support the bodies that move",
            part_of(stabilisation / largest_energy)
        );
        self.log.decisions.push(decision(self.step, self.state.time, self.clock.dt(), DecisionKind::Warning, reason));
    }

    /// Adds a warning to the records of the step that comes next, for what the caller found.
    pub fn warn(&mut self, reason: impl Into<String>) {
        let warning = decision(self.step + 1, self.state.time, self.clock.dt(), DecisionKind::Warning, reason);
        self.log.decisions.push(warning);
    }

    /// Warns once in a run that a step needed the compliance of rows (theory/constraints#compliance): of pressures that are determined only together each may be another one.
    pub(super) fn warn_dependent(&mut self) {
        let Some(cause) = self.system.rows.dependent.take() else { return };
        let reported = |d: &Decision| d.kind == DecisionKind::Warning && d.reason.starts_with(DEPENDENT);
        if !self.log.decisions.iter().any(reported) {
            self.warn(format!(
                "{DEPENDENT}; without compliance {cause}. Of the pressures that fit those nearest to the last ones are taken: single ones mean little there"
            ));
        }
    }

    /// Warns once in a run that many matrices are factorised twice.
    pub(super) fn warn_fallbacks(&mut self) {
        let count = self.system.solver.statistics();
        let (all, twice) = (count.factorisations, count.pivoting_fallbacks);
        let reported = |d: &Decision| d.kind == DecisionKind::Warning && d.reason.starts_with(WITHOUT_PIVOTS);
        if all < KNOWN_FACTORISATIONS
            || (twice as f64) < REPORTED_FALLBACKS * all as f64
            || self.log.decisions.iter().any(reported)
        {
            return;
        }
        let reason = format!(
            "{WITHOUT_PIVOTS} in {twice} of {all} matrices, as happens with multipliers of mortar contact and of friction: each was factorised again with pivots from whole columns. Results are \
             as accurate, but large models take several times as long and more memory. `linear = \"faer\"` in [solver] leaves the first attempt out; `method = \"nts\"`, or friction \
             with `stick = \"penalty\"`, may do without. This warning is given once in a run"
        );
        self.log.decisions.push(decision(self.step, self.state.time, self.clock.dt(), DecisionKind::Warning, reason));
    }

    /// Warns once in a run that the iterative solver left systems to the direct one.
    pub(super) fn warn_handed_over(&mut self) {
        let Some(reason) = self.system.solver.take_reason() else { return };
        let reported = |d: &Decision| d.kind == DecisionKind::Warning && d.reason.starts_with(HANDED_OVER);
        if self.log.decisions.iter().any(reported) {
            return;
        }
        let reason = format!(
            "{HANDED_OVER} but by factorisation until the end of this step, which takes more time and memory: {reason}. Every step tries again; `linear = \"multifrontal\"` in [solver] leaves the \
             attempts out. This warning is given once in a run, the number of such steps is in `linear_solver_counts` of the summary"
        );
        self.log.decisions.push(decision(self.step, self.state.time, self.clock.dt(), DecisionKind::Warning, reason));
    }

    /// Warns once in a run that contact added energy: its forces did this `work` in the step, more than its springs released. That can happen at edges,
    /// or where closed nodes penetrate, under every scheme that does not conserve energy.
    pub(super) fn warn_contact_gain(&mut self, work: f64, before: &Balance) {
        let now = &self.ledger.balance;
        let gain = work + now.contact - before.contact;
        let energy = now.largest_energy;
        let length = self.model.contacts.iter().map(|pair| pair.term.length_scale()).fold(0.0, f64::max);
        // Energy of motions that are not resolved.
        let nothing = SMALLEST_RESOLVED_MOTION * SMALLEST_RESOLVED_MOTION * self.system.scales.force * length;
        let reported = |d: &Decision| d.kind == DecisionKind::Warning && d.reason.starts_with(CONTACT_ADDED);
        if gain <= REPORTED_GAIN * energy || gain <= nothing || self.log.decisions.iter().any(reported) {
            return;
        }
        let reason = format!(
            "{CONTACT_ADDED} {:.0} % of the largest energy so far to that of the bodies in this step; the motion is doubtful from here on. `energy-momentum` with mortar contact or with the \
             modified constraint cannot add energy; smaller steps, or exchanging slave and master, may help. This warning is given once in a run",
            100.0 * gain / energy
        );
        self.log.decisions.push(decision(self.step, self.state.time, self.clock.dt(), DecisionKind::Warning, reason));
    }
}
