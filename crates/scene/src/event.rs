//! `[[event]]` and `[[stage]]`: changes in the course of a run.

use crate::general::MAX_STEPS;
use crate::probe::{component_fits, probe_component, probe_of};
use crate::read::{Node, Table, Value};
use crate::spelling::known;
use crate::world::{Action, GRAVITY, World, before_end, raw};
use crate::{Automatic, Integrator, Kind, ProbeComponent, Stabilise, Time};
use stoss_scene_derive::table;

/// `[[event]]`: the release of a joint, a spring or a prescribed motion, at a time or once a probe passes a value. Exactly one of `time` and `when`.
///
/// ```toml
/// [[event]]
/// name = "snap"
/// release = "hook"
/// when = { probe = "pull", component = "z", above = 100.0 }
/// ```
#[table(context(World<'_>), check = one_cause)]
pub struct Event {
    /// Unique name, for reports.
    #[key(example = "\"snap\"", name)]
    pub name: String,
    /// Name of the `[[joint]]`, `[[spring]]` or `[[prescribe]]` that is released by the event.
    #[key(example = "\"hook\"", with = released)]
    pub release: String,
    /// Time of the event, positive and at most the end of the run; a step ends there.
    #[key(dimension = Time, by = before_end)]
    pub time: Option<f64>,
    /// Condition on a probe: the event takes place at the end of the first step in which it is true.
    pub when: Option<EventCondition>,
}

/// Condition on the value of a probe; exactly one of `above` and `below`.
#[table(example = "{ probe = \"pull\", above = 10.0 }", context(World<'_>), check = one_bound)]
pub struct EventCondition {
    /// Name of the probe.
    #[key(example = "\"pull\"", by = probe_of)]
    pub probe: String,
    /// Component of a quantity with several values; not for a quantity with one value.
    #[key(with = |node, world, keys| probe_component(node, world, keys.probe.as_deref()))]
    pub component: Option<ProbeComponent>,
    /// True if the value is larger than this.
    #[key(dimension = "as the probe")]
    pub above: Option<f64>,
    /// True if the value is smaller than this.
    #[key(dimension = "as the probe")]
    pub below: Option<f64>,
}

/// `[[stage]]`: a part of the run with its own kind of analysis, step size and active conditions. Without stages the run is one stage of the kind of the scene.
///
/// ```toml
/// [[stage]]
/// name = "hang"
/// kind = "quasi-static"
/// until = 1.0
/// step = 0.1
///
/// [[stage]]
/// name = "swing"
/// kind = "dynamic"
/// until = 5.0
/// off = ["rope-end"]
/// ```
///
/// The stages follow each other; the last one ends with `[time] end`. A scene with a dynamic stage is of `kind = "dynamic"`. Initial velocities are those
/// at the start of the first dynamic stage.
#[table(context(Span<'_>))]
pub struct Stage {
    /// Unique name, for reports.
    #[key(example = "\"settle\"", name)]
    pub name: String,
    /// Quasi-static or dynamic. Probes of velocities show the motion of the last step over its time in a quasi-static stage.
    #[key(example = "\"quasi-static\"", with = stage_kind)]
    pub kind: Kind,
    /// Time at which the stage ends, later than the end of the stage before.
    #[key(dimension = Time, example = "1.0", with = until)]
    pub until: f64,
    /// Nominal step size; `[time] step` if left out.
    #[key(dimension = Time, with = step)]
    pub step: Option<f64>,
    /// Automatic choice of the increments of a quasi-static stage, of which `step` is the largest; off if left out.
    #[key(with = |node, span, keys| Automatic::below(node, keys.largest(span)))]
    pub automatic: Option<Automatic>,
    /// Viscous stabilisation of a quasi-static stage, which vanishes at its end; none if left out.
    pub stabilise: Option<Stabilise>,
    /// Time-stepping scheme of a dynamic stage; `[time] integrator` if left out.
    pub integrator: Option<Integrator>,
    /// Names of joints, springs, contacts, prescribed motions and loads that are switched off in this stage; `gravity` switches gravity off.
    #[key(default, skip, with = off)]
    pub off: Vec<String>,
}

fn one_cause(_: &EventKeys, table: &Table<'_>, _: &World<'_>) -> Option<()> {
    match (table.has("time"), table.has("when")) {
        (true, true) => table.fail("when", "`time` is given too", "remove one of them"),
        (false, false) => table.missing("time", "time = 0.5` or `when = { probe = \"pull\", above = 10.0 }"),
        _ => Some(()),
    }
}

fn released(node: &Node<'_>, world: &World<'_>, _: &EventKeys) -> Option<String> {
    let name = node.text()?;
    match world.actions.iter().find(|(other, _)| *other == name) {
        Some((_, Action::Joint | Action::Spring | Action::Equation | Action::Prescribe)) => Some(name),
        Some((_, action)) => node.fail(
            format!("is {}: only joints, springs, equations and prescribed motions can be released", action.noun()),
            "name a [[joint]], a [[spring]] or a [[prescribe]] with a `name`",
        ),
        None if !world.actions_complete => Some(name),
        None => {
            let releasable: Vec<&str> = world
                .actions
                .iter()
                .filter(|(_, action)| {
                    matches!(action, Action::Joint | Action::Spring | Action::Equation | Action::Prescribe)
                })
                .map(|(name, _)| name.as_str())
                .collect();
            let message = format!("there is no joint, spring or prescribed motion `{name}`");
            if releasable.is_empty() {
                return node.fail(message, "add a [[joint]] or [[spring]], or give a [[prescribe]] this `name`");
            }
            node.fail(message, known(&name, releasable))
        }
    }
}

fn one_bound(keys: &EventConditionKeys, table: &Table<'_>, world: &World<'_>) -> Option<()> {
    let one = match (table.has("above"), table.has("below")) {
        (true, true) => table.fail("below", "`above` is given too", "write an [[event]] of its own for each"),
        (false, false) => table.missing("above", "above = 10.0"),
        _ => Some(()),
    };
    component_fits(table, world, keys.probe.as_deref()).and(one)
}

/// What a stage must know of the scene.
pub(crate) struct Span<'a> {
    world: &'a World<'a>,
    time: Option<&'a Time>,
    /// End of the stage before, if it is known.
    before: Option<f64>,
    /// Whether no stage follows.
    last: bool,
    has_gravity: bool,
}

/// All stages: they must follow each other to the end of the run.
pub(crate) fn stages(
    tables: &[Option<Table<'_>>],
    world: &World<'_>,
    time: Option<&Time>,
    has_gravity: bool,
) -> Vec<Option<Stage>> {
    let mut before = Some(0.0);
    let mut stages = Vec::new();
    for (i, table) in tables.iter().enumerate() {
        let Some(table) = table else {
            before = None;
            stages.push(None);
            continue;
        };
        let span = Span { world, time, before, last: i + 1 == tables.len(), has_gravity };
        let keys = StageKeys::read(table, &span);
        let fits = keys.fit(table, &span);
        table.finish();
        before = keys.until;
        stages.push(fits.and_then(|()| keys.build()));
    }
    let all_static = stages.iter().all(|stage| stage.as_ref().is_some_and(|stage| stage.kind == Kind::QuasiStatic));
    if world.kind == Some(Kind::Dynamic)
        && all_static
        && let Some(Some(table)) = tables.first()
    {
        let message = "a dynamic scene needs a dynamic stage";
        stages[0] =
            table.fail("kind", message, "make one of the stages dynamic, or set [scene] kind = \"quasi-static\"");
    }
    stages
}

fn stage_kind(node: &Node<'_>, span: &Span<'_>, _: &StageKeys) -> Option<Kind> {
    let kind = Kind::read(node, span)?;
    if kind == Kind::Dynamic && span.world.kind == Some(Kind::QuasiStatic) {
        return node.fail("a quasi-static scene has no inertia", "set [scene] kind = \"dynamic\"");
    }
    Some(kind)
}

fn until(node: &Node<'_>, span: &Span<'_>, _: &StageKeys) -> Option<f64> {
    let until = node.positive()?;
    if let Some(before) = span.before
        && until <= before
    {
        return node.fail(format!("is not after the end of the stage before, {before}"), "sort the stages by time");
    }
    match span.world.end {
        Some(end) if until > end => {
            node.fail(format!("is after the end of the run, {end}"), "choose an earlier time, or a later [time] end")
        }
        Some(end) if span.last && until != end => node.fail(
            format!("the last stage must end with the run, at {end}"),
            "choose this time, add a stage, or change [time] end",
        ),
        _ => Some(until),
    }
}

fn step(node: &Node<'_>, span: &Span<'_>, keys: &StageKeys) -> Option<f64> {
    let step = node.positive()?;
    match keys.length(span) {
        Some(length) if step > length * (1.0 + 1e-12) => {
            node.fail(format!("must not exceed the length of the stage, {length}"), "choose a smaller step")
        }
        Some(length) if length / step > MAX_STEPS => {
            node.fail(format!("gives {:.1e} steps", length / step), "choose a larger step")
        }
        _ => Some(step),
    }
}

impl StageKeys {
    /// Duration of the stage, if it is known.
    fn length(&self, span: &Span<'_>) -> Option<f64> {
        self.until.zip(span.before).map(|(until, before)| until - before)
    }

    /// Largest increment, if it is known.
    fn largest(&self, span: &Span<'_>) -> Option<f64> {
        self.step?.or(span.time.map(|time| time.step))
    }

    /// Reports keys that do not fit each other.
    fn fit(&self, table: &Table<'_>, span: &Span<'_>) -> Option<()> {
        let step = match (self.length(span), span.time) {
            (Some(length), Some(time)) if !table.has("step") && time.step > length * (1.0 + 1e-12) => {
                let other = time.step;
                let message = format!("is needed: that of [time], {other}, exceeds the length of the stage, {length}");
                table.fail("step", message, "add it, or choose a smaller one in [time]")
            }
            _ => Some(()),
        };
        let mut of_kind = Some(());
        let (message, keys): (_, &[&str]) = match self.kind {
            Some(Kind::QuasiStatic) => ("a static stage has no integrator", &["integrator"]),
            Some(Kind::Dynamic) => ("is for quasi-static stages", &["automatic", "stabilise"]),
            None => return step,
        };
        for key in keys.iter().copied().filter(|key| table.has(key)) {
            of_kind = table.fail(key, message, "remove it");
        }
        step.and(of_kind)
    }
}

/// Whether there are stages, and each is static or has an integrator of its own.
pub(crate) fn have_own_schemes(stages: &[Option<Table<'_>>]) -> bool {
    let is_static = |table: &Table<'_>| raw(table, "kind").is_some_and(|kind| kind == Kind::QuasiStatic.name());
    let has_own = |table: &Table<'_>| table.has("integrator") || is_static(table);
    !stages.is_empty() && stages.iter().flatten().all(has_own)
}

fn off(node: &Node<'_>, span: &Span<'_>, _: &StageKeys) -> Option<Vec<String>> {
    let Span { world, has_gravity, .. } = *span;
    let names = node.list(|n| {
        let name = n.text()?;
        if name == GRAVITY {
            if has_gravity {
                return Some(name);
            }
            return n.fail("the scene has no gravity", "remove it, or add [gravity]");
        }
        match world.actions.iter().find(|(other, _)| *other == name) {
            Some((_, action @ Action::Tie)) => n.fail(format!("is {}, which always acts", action.noun()), "remove it"),
            Some(_) => Some(name),
            None if !world.actions_complete => Some(name),
            None => {
                let names: Vec<&str> = world
                    .actions
                    .iter()
                    .filter(|(_, action)| !matches!(action, Action::Tie))
                    .map(|(name, _)| name.as_str())
                    .chain(has_gravity.then_some(GRAVITY))
                    .collect();
                let message = format!("there is no joint, spring, contact, prescribed motion or load `{name}`");
                if names.is_empty() {
                    return n.fail(message, "give it this `name`");
                }
                n.fail(message, known(&name, names))
            }
        }
    })?;
    if let Some(i) = (1..names.len()).find(|&i| names[..i].contains(&names[i])) {
        return node.fail(format!("names `{}` twice", names[i]), "name everything at most once");
    }
    Some(names)
}
