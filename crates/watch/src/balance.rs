//! Momenta and energy against what scheme, loads, supports and contact together must conserve.

use crate::words::short_time;
use crate::{Finding, FindingKind, Severity};
use serde::{Deserialize, Serialize};

/// Part of the largest energy from which on a gain, where nothing excludes it, or a loss by closing gaps is doubtful.
const DOUBTFUL_CHANGE: f64 = 0.01;

/// Part of its scale by which angular momentum may change under a scheme that does not keep it.
const DOUBTFUL_TURN: f64 = 0.01;

/// Part of the largest energy that impacts would have added, from which on their steps are not resolved.
const DOUBTFUL_CAPPED: f64 = 0.001;

/// Part of the largest energy from which on a gain is wrong, whatever the scheme claims: the gain is then as large as all that the bodies would have without it, and a free system has doubled
/// its energy. Errors of schemes without such a defect are smaller by orders of magnitude, also with large steps.
const WRONG_GAIN: f64 = 0.5;

/// Judgement of what closing gaps cost, where nothing else is meant to take energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClosingJudgement {
    /// No judgement: the scheme takes energy itself.
    #[default]
    Unjudged,
    /// The scheme is of the second order: what is lost beyond its small errors is lost at closing gaps.
    Surfaces,
    /// Nodes of a string or a beam meet a surface. Their mass is consistent: what stops a node changes the motion of its neighbours at once, under every scheme.
    Lines,
}

/// Which momenta and energies a run, or a stage of it, must conserve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Promises {
    /// The components of linear momentum that are constant.
    pub linear: [bool; 3],
    /// Angular momentum is constant.
    pub angular: bool,
    /// Whether no load and no support acts on the bodies: angular momentum would be constant, though the scheme may not keep it.
    #[serde(default)]
    pub is_free: bool,
    /// Energy, with the work of loads and supports and the losses of contact and friction, is constant.
    pub energy: bool,
    /// Whether no load and no support does work that the balance of energy has only to the accuracy of the scheme.
    pub autonomous: bool,
    /// Contact never adds energy to the bodies.
    pub contact_gives_nothing: bool,
    /// Whether energy that closing gaps take is judged.
    #[serde(default)]
    pub closing: ClosingJudgement,
    /// Relative tolerance: round-off and what the Newton iteration leaves, as a part of the scale of each quantity.
    pub tolerance: f64,
}

/// Momenta and energies at the end of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BalanceState {
    /// Linear momentum (mass times velocity).
    pub linear: [f64; 3],
    /// Angular momentum about the origin.
    pub angular: [f64; 3],
    /// Kinetic plus strain energy.
    pub energy: f64,
    /// Kinetic, strain, potential, stored contact and dissipated energy, minus the external work.
    pub total: f64,
    /// Work that the normal contact forces have taken from the bodies since the start.
    pub closing_loss: f64,
    /// Energy that the law of impact has taken since the start.
    #[serde(default)]
    pub impact_loss: f64,
    /// The part of [`Self::impact_loss`] at contacts of deformable bodies.
    #[serde(default)]
    pub impact_deformable: f64,
    /// Energy that the law of impact would have added since the start.
    #[serde(default)]
    pub impact_capped: f64,
    /// The part of `total` that the damping of bodies has taken since the start. Its integral over a step has the error of the scheme.
    #[serde(default)]
    pub damping: f64,
}

/// A change of energy at its largest, and when that was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Change {
    energy: f64,
    step: u64,
    time: f64,
}

impl Change {
    /// Takes note of a change that the steps resolve: one above `floor`.
    fn note(&mut self, energy: f64, floor: f64, (step, time): (u64, f64)) {
        if energy > self.energy.max(floor) {
            *self = Self { energy, step, time };
        }
    }
}

/// Residual forces that the Newton iterations leave, in the norm over all nodes, and the mean mass of a node: together they bound the error of the energy that is not the fault
/// of a scheme. It matters where strains are so small that forces are not resolved relative to themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Resolution {
    /// Part of the force that does not depend on the step, a force.
    pub force: f64,
    /// Part that falls with the square of the step size: mass times length. A step of the size `h` leaves `force + inertia / h^2`.
    pub inertia: f64,
    /// Mean mass of a node.
    pub node_mass: f64,
}

impl Resolution {
    /// Error of the energy in a step of this size, while the bodies have this energy: the force along the motion of all nodes, were all of the energy kinetic.
    fn of_step(&self, dt: f64, energy: f64) -> f64 {
        if dt <= 0.0 || self.node_mass <= 0.0 {
            return 0.0;
        }
        let speed = (2.0 * energy.max(0.0) / self.node_mass).sqrt();
        (self.force + self.inertia / (dt * dt)) * speed * dt
    }
}

/// Compares the momenta and energies of the steps of a run with [`Promises`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BalanceWatch {
    promises: Promises,
    /// Mass of all bodies, and the largest distance of a node from the origin.
    mass: f64,
    radius: f64,
    first: Option<BalanceState>,
    /// Largest linear momentum, angular momentum and energy so far.
    scales: [f64; 3],
    /// Lowest total energy, and largest loss by contact, so far.
    lowest: f64,
    largest_loss: f64,
    /// Largest drifts of linear momentum, angular momentum and energy so far, as far as they are promised to be constant.
    #[serde(default)]
    drifts: [f64; 3],
    #[serde(default)]
    resolution: Resolution,
    /// Time of the last state.
    #[serde(default)]
    time: f64,
    /// Sum of the squares of what steps do not resolve of the energy: their errors are independent.
    #[serde(default)]
    unresolved: f64,
    /// Largest energy so far that contact has given, that came from nowhere, and that closing gaps have taken.
    #[serde(default)]
    given: Change,
    #[serde(default)]
    grown: Change,
    #[serde(default)]
    closed: Change,
    /// Largest change so far of the angular momentum that the scheme does not keep; not an energy.
    #[serde(default)]
    turned: Change,
    /// What impacts of deformable bodies have taken, and what the law of impact was kept from adding.
    #[serde(default)]
    by_impacts: f64,
    #[serde(default)]
    capped: Change,
}

impl BalanceWatch {
    /// The watch for bodies of this `mass` whose nodes are at most `radius` from the origin. Energies below `smallest` are those of motions that are not
    /// resolved: what is at rest is measured against it.
    pub fn new(promises: Promises, mass: f64, radius: f64, smallest: f64) -> Self {
        // Finite, for files.
        let (lowest, largest_loss) = (f64::MAX, f64::MIN);
        Self {
            promises,
            mass,
            radius,
            first: None,
            scales: [0.0, 0.0, smallest],
            lowest,
            largest_loss,
            drifts: [0.0; 3],
            resolution: Resolution::default(),
            time: 0.0,
            unresolved: 0.0,
            given: Change::default(),
            grown: Change::default(),
            closed: Change::default(),
            turned: Change::default(),
            by_impacts: 0.0,
            capped: Change::default(),
        }
    }

    /// The watch for steps that resolve forces only to this; without it all are taken as exact.
    #[must_use]
    pub fn with_resolution(self, resolution: Resolution) -> Self {
        Self { resolution, ..self }
    }

    /// Name and size, a part of its scale, of the largest drift so far of what is promised to be constant; none without such a promise.
    pub fn worst_drift(&self) -> Option<(&'static str, f64)> {
        let Promises { linear, angular, energy, .. } = self.promises;
        let promised = [linear.contains(&true), angular, energy];
        let names = ["linear momentum", "angular momentum", "energy"];
        let drifts = names.into_iter().zip(self.drifts).zip(promised).filter(|(_, promised)| *promised);
        drifts.map(|(drift, _)| drift).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Findings of a step: what of [`Promises`] it violates. The first call is the start, with which all others are compared. What is judged beside the largest energy of the run
    /// is in [`Self::standing`].
    pub fn observe(&mut self, step: u64, time: f64, state: &BalanceState) -> Vec<Finding> {
        let Promises { linear, angular, is_free, energy, autonomous, contact_gives_nothing, closing, tolerance } =
            self.promises;
        let size = |x: &[f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        // The momentum that the bodies would have if all moved in the same direction.
        let momentum = (2.0 * self.mass * state.energy.max(0.0)).sqrt();
        let now = [size(&state.linear).max(momentum), size(&state.angular).max(momentum * self.radius), state.energy];
        for (scale, now) in self.scales.iter_mut().zip(now) {
            *scale = scale.max(now);
        }
        if self.first.is_some() {
            self.unresolved += self.resolution.of_step(time - self.time, state.energy).powi(2);
        }
        self.time = time;
        let floor = self.unresolved.sqrt();
        let first = *self.first.get_or_insert(*state);
        let mut found = Vec::new();
        let mut add = |level, kind, what: String, figure: f64| {
            let sentence = format!("at t = {} {what}", short_time(time));
            found.push(Finding::new(level, kind, (step, time), sentence, figure));
        };
        let part = |change: f64, scale: f64| if scale > 0.0 { change / scale } else { 0.0 };
        let exceeds = |part: f64, limit: f64| part > limit || part.is_nan();
        let is_resolved = |change: f64| change > floor || change.is_nan();
        for i in (0..3).filter(|&i| linear[i]) {
            let drift = part((state.linear[i] - first.linear[i]).abs(), self.scales[0]);
            self.drifts[0] = self.drifts[0].max(drift);
            if exceeds(drift, tolerance) {
                let what =
                    format!("the linear momentum along {} has changed by {drift:.1e} of its scale", ["x", "y", "z"][i]);
                add(Severity::Wrong, FindingKind::Balance, what + ", though nothing acts along it", drift);
            }
        }
        let change: [f64; 3] = std::array::from_fn(|i| state.angular[i] - first.angular[i]);
        if is_free && !angular {
            self.turned.note(size(&change), 0.0, (step, time));
        }
        if angular {
            let drift = part(size(&change), self.scales[1]);
            self.drifts[1] = self.drifts[1].max(drift);
            if exceeds(drift, tolerance) {
                let what = format!("the angular momentum has changed by {drift:.1e} of its scale");
                add(
                    Severity::Wrong,
                    FindingKind::Balance,
                    what + ", though nothing acts on the bodies and the scheme conserves it",
                    drift,
                );
            }
        }
        let closed = state.total + state.closing_loss + state.impact_loss;
        if energy {
            let off = (closed - first.total - first.closing_loss - first.impact_loss).abs();
            let drift = part(off, self.scales[2]);
            self.drifts[2] = self.drifts[2].max(drift);
            if exceeds(drift, tolerance) && is_resolved(off) {
                let what = format!("the balance of energy is off by {drift:.1e} of the energy");
                add(Severity::Wrong, FindingKind::Balance, what + ", though the scheme conserves it", drift);
            }
        }
        let given_back = self.largest_loss - state.closing_loss;
        let gain = part(given_back, self.scales[2]);
        self.largest_loss = self.largest_loss.max(state.closing_loss);
        if contact_gives_nothing && exceeds(gain, tolerance) && is_resolved(given_back) {
            let given = format!("contact has added {:.1} % to the energy of the bodies", 100.0 * gain);
            add(Severity::Wrong, FindingKind::Balance, given + ", though the constraint excludes that", gain);
        }
        let grown = state.total - state.damping - self.lowest;
        self.lowest = self.lowest.min(state.total - state.damping);
        if autonomous && !energy && grown.is_nan() {
            let what = "the energy is not a number".to_owned();
            add(Severity::Wrong, FindingKind::EnergyGain, what, f64::NAN);
        }
        let now = (step, time);
        if !contact_gives_nothing {
            self.given.note(given_back, floor, now);
        }
        if autonomous && !energy {
            self.grown.note(grown, floor, now);
        }
        if closing != ClosingJudgement::Unjudged {
            let by_impacts = state.impact_deformable - first.impact_deformable;
            self.by_impacts = self.by_impacts.max(by_impacts);
            self.closed.note(state.closing_loss - first.closing_loss + by_impacts, floor, now);
        }
        self.capped.note(state.impact_capped - first.impact_capped, floor, now);
        found
    }

    /// The finding that angular momentum, on which nothing acts, has changed under a scheme that does not keep it.
    fn lost_turn(&self) -> Option<Finding> {
        let Change { energy: change, step, time } = self.turned;
        let part = change / self.scales[1];
        let sentence = format!(
            "at t = {} the angular momentum had changed by {:.1} % of its scale, though nothing acts on the bodies: the scheme does not keep it. Take `energy-momentum`, or smaller steps",
            short_time(time),
            100.0 * part
        );
        let finding = Finding::new(Severity::Doubtful, FindingKind::Balance, (step, time), sentence, part);
        (part > DOUBTFUL_TURN).then_some(finding)
    }

    /// Findings about changes of the energy beside the largest energy so far: what contact has added, what has come from no load or support, what closing gaps have taken (most of
    /// it in the contact `closed_by`). They may become less as the run goes on.
    pub fn standing(&self, closed_by: Option<&str>) -> Vec<Finding> {
        let mut found = Vec::new();
        let largest = self.scales[2];
        let mut add = |change: &Change, kind, say: &dyn Fn(f64, Severity) -> String| {
            let part = if largest > 0.0 { change.energy / largest } else { 0.0 };
            let limit = if kind == FindingKind::Impact { DOUBTFUL_CAPPED } else { DOUBTFUL_CHANGE };
            if part > limit {
                let is_wrong = kind == FindingKind::EnergyGain && part > WRONG_GAIN;
                let level = if is_wrong { Severity::Wrong } else { Severity::Doubtful };
                let sentence = format!("at t = {} {}", short_time(change.time), say(100.0 * part, level));
                found.push(Finding::new(level, kind, (change.step, change.time), sentence, part));
            }
        };
        add(&self.given, FindingKind::EnergyGain, &|percent, _| {
            format!(
                "contact had added {percent:.1} % of the largest energy of the run to the bodies. Where they overlap at the start, closing the overlap in one step does that: let them only touch, or close \
                 it in a static stage before. Else `energy-momentum` with mortar contact or the modified constraint adds nothing, and smaller steps add less"
            )
        });
        add(&self.grown, FindingKind::EnergyGain, &|percent, level| match level {
            Severity::Wrong => {
                format!(
                    "{percent:.0} % of the largest energy of the run was supplied by no load or support: it is an error of the time stepping"
                )
            }
            _ => format!(
                "the energy had grown by {percent:.1} % of the largest energy of the run; the scheme does not exclude that"
            ),
        });
        let place = closed_by.map(|name| format!(", most of it in {name}")).unwrap_or_default();
        add(&self.closed, FindingKind::ClosingLoss, &|percent, _| match self.promises.closing {
            ClosingJudgement::Lines => format!(
                "closing gaps had taken {percent:.1} % of the largest energy of the run{place}. The mass of the line is consistent: what stops a node on the surface jerks its neighbours, and what \
                 is still in the air does not move freely. Smaller elements and steps do not change that; write `mass_matrix = \"lumped\"` for a string, or use elements of a solid for a beam"
            ),
            _ if self.by_impacts > 0.5 * self.closed.energy => format!(
                "impacts had taken {percent:.1} % of the largest energy of the run{place}: the energy of the nodes of deformable bodies that meet a surface, which is a number of the mesh. It does not depend on the step; \
                 halve the elements at the surface and see what of the result changes"
            ),
            _ => format!(
                "closing gaps had taken {percent:.1} % of the largest energy of the run{place}, and how much depends on where in the step a gap closes: the motion after an impact is uncertain by as much. \
                 The law of impact (`closing = \"impact\"`, a scheme with the mean velocity) takes the same at every phase; smaller steps and finer surfaces take less, general contact or the penalty method take nothing"
            ),
        });
        add(&self.capped, FindingKind::Impact, &|percent, _| {
            format!(
                "the law of impact would have added {percent:.1} % of the largest energy of the run, and was kept from it: the steps are too long for the impacts"
            )
        });
        found.extend(self.lost_turn());
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn promises() -> Promises {
        Promises {
            linear: [true; 3],
            angular: true,
            is_free: true,
            energy: true,
            autonomous: true,
            contact_gives_nothing: true,
            closing: ClosingJudgement::Unjudged,
            tolerance: 1e-7,
        }
    }

    fn start() -> BalanceState {
        let (linear, angular) = ([1.0, 0.0, -2.0], [0.5, 0.1, 0.0]);
        BalanceState { linear, angular, energy: 3.0, total: 2.0, ..BalanceState::default() }
    }

    /// Levels of what a run of these states after the start breaks.
    fn levels(promises: Promises, states: &[BalanceState]) -> Vec<Severity> {
        let mut watch = BalanceWatch::new(promises, 1.0, 1.0, 0.0);
        assert_eq!(watch.observe(0, 0.0, &start()), []);
        let steps = states.iter().zip(1..);
        let mut found: Vec<Finding> = steps.flat_map(|(s, step)| watch.observe(step, 0.1 * step as f64, s)).collect();
        found.extend(watch.standing(None));
        found.into_iter().map(|finding| finding.level).collect()
    }

    /// Levels of what a second step breaks.
    fn second(promises: Promises, change: impl Fn(&mut BalanceState)) -> Vec<Severity> {
        let mut state = start();
        change(&mut state);
        levels(promises, &[state])
    }

    #[test]
    fn round_off_losses_and_exchange_of_energy_break_nothing() {
        assert_eq!(second(promises(), |_| {}), []);
        assert_eq!(second(promises(), |s| s.linear[0] += 1e-9), []);
        assert_eq!(second(promises(), |s| (s.total, s.closing_loss) = (1.5, 0.5)), []);
        assert_eq!(second(promises(), |s| s.energy = 1.0), []);
    }

    #[test]
    fn what_breaks_a_promise_is_wrong() {
        let wrong = [Severity::Wrong];
        assert_eq!(second(promises(), |s| s.linear[1] += 1e-5), wrong);
        assert_eq!(second(promises(), |s| s.angular[2] -= 1e-5), wrong);
        assert_eq!(second(promises(), |s| s.total -= 1e-5), wrong);
        assert_eq!(second(promises(), |s| s.total += 1e-5), wrong);
        assert_eq!(second(promises(), |s| (s.total, s.closing_loss) = (2.1, -0.1)), wrong);
        assert_eq!(second(promises(), |s| s.linear[2] = f64::NAN), wrong);
    }

    #[test]
    fn a_turn_that_the_scheme_does_not_keep_is_doubtful() {
        let unkept = Promises { angular: false, ..promises() };
        assert_eq!(second(unkept, |s| s.angular[2] += 0.1), [Severity::Doubtful]);
        assert_eq!(second(unkept, |s| s.angular[2] += 0.005), []);
        assert_eq!(second(Promises { is_free: false, ..unkept }, |s| s.angular[2] += 0.1), []);
    }

    #[test]
    fn the_worst_drift_is_kept_and_is_one_of_what_is_promised() {
        let mut watch = BalanceWatch::new(Promises { angular: false, ..promises() }, 1.0, 1.0, 0.0);
        for total in [2.0, 2.3, 2.1] {
            watch.observe(0, 0.0, &BalanceState { total, angular: [total; 3], ..start() });
        }
        let (name, drift) = watch.worst_drift().unwrap();
        assert!(name == "energy" && (drift - 0.1).abs() < 1e-12, "{name} {drift}");
        let none = Promises { linear: [false; 3], angular: false, energy: false, ..promises() };
        assert_eq!(BalanceWatch::new(none, 1.0, 1.0, 0.0).worst_drift(), None);
    }

    #[test]
    fn what_is_not_promised_may_change() {
        let none =
            Promises { linear: [true, false, true], angular: false, is_free: false, energy: false, ..promises() };
        assert_eq!(second(none, |s| (s.linear[1], s.angular[0]) = (3.0, 3.0)), []);
        assert_eq!(second(none, |s| s.total -= 0.5), []);
    }

    #[test]
    fn a_gain_that_is_not_excluded_is_doubtful() {
        let loose = Promises { energy: false, contact_gives_nothing: false, ..promises() };
        assert_eq!(second(loose, |s| s.total += 0.02), []);
        assert_eq!(second(loose, |s| s.total += 0.1), [Severity::Doubtful]);
        let driven = Promises { autonomous: false, ..loose };
        assert_eq!(second(driven, |s| s.total += 0.1), []);
        assert_eq!(second(driven, |s| s.closing_loss -= 0.1), [Severity::Doubtful]);
    }

    #[test]
    fn energy_that_doubles_without_work_is_wrong_whatever_the_scheme_claims() {
        let loose = Promises { energy: false, contact_gives_nothing: false, ..promises() };
        let grown = |by: f64| move |s: &mut BalanceState| (s.energy, s.total) = (s.energy + by, s.total + by);
        assert_eq!(second(loose, grown(2.9)), [Severity::Doubtful]);
        assert_eq!(second(loose, grown(3.1)), [Severity::Wrong]);
        assert_eq!(second(loose, grown(26.0 * 3.0)), [Severity::Wrong]);
        assert_eq!(second(loose, grown(f64::NAN)), [Severity::Wrong]);
        // What falls has its energy from the potential, and a support that moves may do work between the ends of steps.
        assert_eq!(second(loose, |s| s.energy = 100.0), []);
        assert_eq!(second(Promises { autonomous: false, ..loose }, grown(78.0)), []);
        // What is at rest is measured against motions that are not resolved.
        let mut watch = BalanceWatch::new(loose, 1.0, 1.0, 1.0);
        let small = |energy: f64| BalanceState { energy, total: energy, ..BalanceState::default() };
        assert_eq!(watch.observe(0, 0.0, &small(0.0)), []);
        assert_eq!(watch.observe(1, 0.1, &small(1e-3)), []);
        assert_eq!(watch.standing(None), []);
        // A residual force of 1e-6 does more work in a step of 0.1 on a node of mass one than bodies at rest have, and so says nothing.
        let resolution = Resolution { force: 1e-6, inertia: 0.0, node_mass: 1.0 };
        let mut watch = BalanceWatch::new(loose, 1.0, 1.0, 0.0).with_resolution(resolution);
        (0..3).for_each(|step| assert_eq!(watch.observe(step, 0.1 * step as f64, &small(1e-25 * step as f64)), []));
        assert_eq!(watch.standing(None), []);
    }

    #[test]
    fn energy_that_contact_makes_from_nothing_is_wrong() {
        let loose = Promises { contact_gives_nothing: false, ..promises() };
        let pushed =
            |by: f64| move |s: &mut BalanceState| (s.energy, s.total, s.closing_loss) = (3.0 + by, 2.0 + by, -by);
        assert_eq!(second(loose, pushed(0.02)), []);
        assert_eq!(second(loose, pushed(2.9)), [Severity::Doubtful]);
        assert_eq!(second(loose, pushed(3.1)), [Severity::Wrong]);
        // Beside the largest energy of the run, also where it comes later.
        let states = [1.0, 400.0].map(|energy| BalanceState { energy, total: 3.0, closing_loss: -1.0, ..start() });
        assert_eq!(levels(loose, &states), []);
    }

    #[test]
    fn what_closing_gaps_take_is_doubtful_where_it_is_judged() {
        let lossy = Promises { closing: ClosingJudgement::Surfaces, ..promises() };
        let lost = |part: f64| move |s: &mut BalanceState| (s.total, s.closing_loss) = (2.0 - 3.0 * part, 3.0 * part);
        assert_eq!(second(lossy, lost(0.0099)), []);
        assert_eq!(second(lossy, lost(0.0101)), [Severity::Doubtful]);
        assert_eq!(second(promises(), lost(0.5)), []);
        let mut watch = BalanceWatch::new(Promises { closing: ClosingJudgement::Lines, ..lossy }, 1.0, 1.0, 0.0);
        watch.observe(0, 0.0, &start());
        watch.observe(1, 0.1, &BalanceState { total: 1.4, closing_loss: 0.6, ..start() });
        let [Finding { kind: FindingKind::ClosingLoss, sentence, .. }] = &watch.standing(Some("floor"))[..] else {
            panic!("no loss")
        };
        assert!(["20.0 %", "t = 0.1", "most of it in floor", "lumped"].iter().all(|word| sentence.contains(word)));
    }

    /// What the law of impact takes from deformable bodies is doubtful, from rigid ones it is not; what it was kept from adding is.
    #[test]
    fn what_impacts_take_is_doubtful_of_deformable_bodies() {
        let lossy = Promises { closing: ClosingJudgement::Surfaces, ..promises() };
        let lost = |part: f64, deformable: f64| {
            move |s: &mut BalanceState| {
                (s.total, s.impact_loss, s.impact_deformable) = (2.0 - 3.0 * part, 3.0 * part, 3.0 * deformable);
            }
        };
        assert_eq!(second(lossy, lost(0.5, 0.0099)), []);
        assert_eq!(second(lossy, lost(0.5, 0.0101)), [Severity::Doubtful]);
        assert_eq!(second(lossy, |s: &mut BalanceState| s.impact_capped = 0.0029), []);
        assert_eq!(second(lossy, |s: &mut BalanceState| s.impact_capped = 0.0031), [Severity::Doubtful]);
        let mut watch = BalanceWatch::new(lossy, 1.0, 1.0, 0.0);
        watch.observe(0, 0.0, &start());
        watch.observe(1, 0.1, &BalanceState { total: 1.4, impact_loss: 0.6, impact_deformable: 0.6, ..start() });
        let found = watch.standing(None);
        assert!(found[0].kind == FindingKind::ClosingLoss && found[0].sentence.contains("a number of the mesh"));
    }

    /// The work of dampers in a step is no energy that came from nowhere, whatever their integral says; without them it is.
    #[test]
    fn errors_of_what_damping_takes_are_no_gain() {
        let loose = Promises { energy: false, ..promises() };
        let damped = BalanceState { energy: 1.0, total: 2.5, damping: 2.0, ..start() };
        assert_eq!(levels(loose, &[damped]), []);
        assert_eq!(levels(loose, &[BalanceState { damping: 0.0, ..damped }]), [Severity::Doubtful]);
    }

    /// A step of size 0.1 with an energy of 3 and nodes of mass 6 moves them by 0.1 in the norm.
    #[test]
    fn what_steps_do_not_resolve_is_no_fault() {
        let off = |resolution: Resolution, by: f64| {
            let mut watch = BalanceWatch::new(promises(), 1.0, 1.0, 0.0).with_resolution(resolution);
            assert_eq!(watch.observe(0, 0.0, &start()), []);
            let state = BalanceState { total: 2.0 + by, ..start() };
            watch.observe(1, 0.1, &state).len()
        };
        let force = Resolution { force: 1e-3, inertia: 0.0, node_mass: 6.0 };
        let inertia = Resolution { force: 0.0, inertia: 1e-5, node_mass: 6.0 };
        for resolution in [force, inertia] {
            assert_eq!([0.9e-4, 1.1e-4, -1.1e-4, f64::NAN].map(|by| off(resolution, by)), [0, 1, 1, 1]);
        }
        assert_eq!(off(Resolution::default(), 0.9e-4), 1);
        // Four steps leave twice as much as one.
        let mut watch = BalanceWatch::new(promises(), 1.0, 1.0, 0.0).with_resolution(force);
        (0..4).for_each(|step| assert_eq!(watch.observe(step, 0.1 * step as f64, &start()), []));
        let with = |by: f64| watch.clone().observe(4, 0.4, &BalanceState { total: 2.0 + by, ..start() }).len();
        assert_eq!([1.9e-4, 2.1e-4].map(with), [0, 1]);
    }

    #[test]
    fn a_gain_counts_from_the_lowest_state() {
        let loose = Promises { energy: false, ..promises() };
        let mut watch = BalanceWatch::new(loose, 1.0, 1.0, 0.0);
        for (step, total, found) in [(0, 2.0, 0), (1, 1.0, 0), (2, 1.2, 1)] {
            assert_eq!(watch.observe(step, 0.1, &BalanceState { total, ..start() }), []);
            assert_eq!(watch.standing(None).len(), found, "step {step}");
        }
    }
}
