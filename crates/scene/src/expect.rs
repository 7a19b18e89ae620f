//! `[expect]`: what a run should give.

use crate::names::named;
use crate::probe::{component_fits, probe_component, probe_of};
use crate::read::Table;
use crate::world::{World, time_in_run};
use crate::{Kind, ProbeComponent, Verdict};
use stoss_scene_derive::table;

named! {
    /// Outcome of a run.
    Outcome {
        /// The run reached its end.
        Completed = "completed",
        /// A step failed at the smallest step size.
        Failed = "failed",
    }
}

/// `[expect]`: expected results of a finished run, which `cargo xtask verify` checks in its files.
///
/// The drift of a quantity is the largest distance from its value at step 0, divided by its scale: the largest norm of the
/// quantity in the run unless a `*_scale` is given (needed where the quantity itself is zero, as the linear momentum of a body
/// that only spins). Energy is the column `total` of `balance.csv`.
#[table(context(World<'_>), check = expect)]
pub struct Expect {
    /// Expected outcome of the run (`summary.json`).
    pub outcome: Option<Outcome>,
    /// Expected verdict of the watch (`summary.json`); `sound` if left out.
    pub verdict: Option<Verdict>,
    /// Expected number of completed steps.
    #[key(read = |node| node.whole(1..=u64::MAX))]
    pub steps: Option<u64>,
    /// Upper bound of the number of cutbacks.
    #[key(read = |node| node.whole(0..=u64::MAX))]
    pub max_cuts: Option<u64>,
    /// Upper bound of the mean number of Newton iterations (linear solutions) in a step.
    #[key(dimension = Number, positive)]
    pub max_newton_mean: Option<f64>,
    /// Upper bound of the drift of the energy, relative to its scale.
    #[key(dimension = Number, positive)]
    pub energy_drift: Option<f64>,
    /// Lower bound of the drift of the energy, to show that a scheme does not conserve it.
    #[key(dimension = Number, positive)]
    pub energy_drift_at_least: Option<f64>,
    /// Upper bound of the change of the energy, relative to its scale, in a step in which no contact closes.
    #[key(dimension = Number, positive)]
    pub energy_change_without_closing: Option<f64>,
    /// Upper bound of the gain of energy, relative to its scale, in a step, to show that contact adds no energy.
    #[key(dimension = Number, positive)]
    pub energy_gain: Option<f64>,
    /// Scale of the energy, positive; its largest value in the run if left out.
    #[key(dimension = Energy, positive)]
    pub energy_scale: Option<f64>,
    /// Upper bound of the drift of the linear momentum, relative to its scale.
    #[key(dimension = Number, positive)]
    pub linear_momentum_drift: Option<f64>,
    /// Scale of the linear momentum, positive; its largest norm in the run if left out.
    #[key(dimension = Momentum, positive)]
    pub linear_momentum_scale: Option<f64>,
    /// Upper bound of the drift of the angular momentum, relative to its scale.
    #[key(dimension = Number, positive)]
    pub angular_momentum_drift: Option<f64>,
    /// Scale of the angular momentum, positive; its largest norm in the run if left out.
    #[key(dimension = AngularMomentum, positive)]
    pub angular_momentum_scale: Option<f64>,
    /// Interval of time in which the first step with a closed contact must end.
    pub first_contact: Option<Interval>,
    /// Whether any contact is closed at the end of the last step.
    pub contact_at_end: Option<bool>,
    /// Expected values of probes.
    #[key(name = "probe", default, skip, tables)]
    pub probes: Vec<ExpectedValue>,
}

/// An interval of time, both ends included.
#[table(check_all = interval)]
#[derive(Copy)]
pub struct Interval {
    /// Start of the interval, not negative.
    #[key(dimension = Time, example = "0.0", not_negative)]
    pub from: f64,
    /// End of the interval, not before `from`.
    #[key(dimension = Time, example = "1.0", not_negative)]
    pub to: f64,
}

/// `[[expect.probe]]`: expected value of a probe at the step whose time is nearest to `time`.
#[table(context(World<'_>), check = expected_value)]
pub struct ExpectedValue {
    /// Name of the probe.
    #[key(example = "\"tip\"", by = probe_of)]
    pub name: String,
    /// Time, in `[0, end]`.
    #[key(dimension = Time, example = "1.0", by = time_in_run)]
    pub time: f64,
    /// Component of a quantity with several values; not for a quantity with one value.
    #[key(with = |node, world, keys| probe_component(node, world, keys.name.as_deref()))]
    pub component: Option<ProbeComponent>,
    /// Expected value.
    #[key(dimension = "as the probe", example = "0.1")]
    pub value: f64,
    /// Largest absolute difference, positive.
    #[key(dimension = "as the probe", example = "1e-6", positive)]
    pub tolerance: f64,
}

/// Keys of `[expect]` that have a meaning only with inertia.
const DYNAMIC: [&str; 9] = [
    "energy_drift",
    "energy_drift_at_least",
    "energy_change_without_closing",
    "energy_gain",
    "energy_scale",
    "linear_momentum_drift",
    "linear_momentum_scale",
    "angular_momentum_drift",
    "angular_momentum_scale",
];

/// Keys of `[expect]` that have a meaning only with contact.
const CONTACT: [&str; 3] = ["energy_change_without_closing", "first_contact", "contact_at_end"];

fn expect(keys: &ExpectKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    let mut applies = Some(());
    if world.kind == Some(Kind::QuasiStatic) {
        for key in DYNAMIC.into_iter().filter(|&key| table.has(key)) {
            applies = table.fail(key, "a quasi-static scene conserves nothing", "remove it");
        }
    }
    if !world.has_contact {
        for key in CONTACT.into_iter().filter(|&key| table.has(key)) {
            let message = "the scene has no [[contact]], to which this belongs";
            applies = table.fail(key, message, "remove it or add a [[contact]]");
        }
    }
    if let (Some(Some(most)), Some(Some(least))) = (keys.energy_drift, keys.energy_drift_at_least)
        && least > most
    {
        let message = format!("contradicts `energy_drift` = {most:e}");
        return table.fail("energy_drift_at_least", message, "remove one of them");
    }
    applies
}

fn interval<C>(interval: &Interval, table: &Table<'_>, _: &C) -> Option<()> {
    let Interval { from, to } = interval;
    if from > to {
        return table.fail("to", format!("is before `from` = {from}"), "exchange the two times");
    }
    Some(())
}

fn expected_value(keys: &ExpectedValueKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    component_fits(table, world, keys.name.as_deref())
}
