//! Reads `[gravity]`, `[[event]]` and `[[stage]]`.

use super::general::{MAX_STEPS, automatic, integrator, stabilise};
use super::node::{Node, known};
use super::results::{component_fits, probe_of};
use super::table::Table;
use super::world::{Action, GRAVITY, World};
use crate::{Event, EventCondition, Gravity, Kind, Stage, Time};
use toml::de::DeValue;

pub(super) fn gravity(node: &Node<'_>) -> Option<Gravity> {
    let table = node.table_like("{ acceleration = [0, 0, -9.81] }")?;
    let acceleration = table.required("acceleration", "acceleration = [0, 0, -9.81]", Node::direction);
    table.finish();
    Some(Gravity { acceleration: acceleration? })
}

pub(super) fn event(table: &Table<'_>, world: &World<'_>) -> Option<Event> {
    let name = table.required("name", "name = \"snap\"", Node::name);
    let release = table.required("release", "release = \"hook\"", |n| released(n, world));
    let time = table.optional("time", |n| {
        let time = n.positive()?;
        match world.end {
            Some(end) if time > end => {
                n.fail(format!("is after the end of the run, {end}"), "choose a time in the run")
            }
            _ => Some(time),
        }
    });
    let when = table.optional("when", |n| condition(n, world));
    let one = match (table.has("time"), table.has("when")) {
        (true, true) => table.fail("when", "`time` is given too", "remove one of them"),
        (false, false) => table.missing("time", "time = 0.5` or `when = { probe = \"pull\", above = 10.0 }"),
        _ => Some(()),
    };
    table.finish();
    one?;
    Some(Event { name: name?, release: release?, time: time?, when: when? })
}

fn released(node: &Node<'_>, world: &World<'_>) -> Option<String> {
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

fn condition(node: &Node<'_>, world: &World<'_>) -> Option<EventCondition> {
    let table = node.table_like("{ probe = \"pull\", above = 10.0 }")?;
    let probe = table.required("probe", "probe = \"pull\"", |n| probe_of(n, world));
    let component = component_fits(&table, probe.as_deref(), world);
    let above = table.optional("above", Node::number);
    let below = table.optional("below", Node::number);
    let one = match (table.has("above"), table.has("below")) {
        (true, true) => table.fail("below", "`above` is given too", "write an [[event]] of its own for each"),
        (false, false) => table.missing("above", "above = 10.0"),
        _ => Some(()),
    };
    table.finish();
    one?;
    Some(EventCondition { probe: probe?, component: component?, above: above?, below: below? })
}

/// All stages: they must follow each other to the end of the run.
pub(super) fn stages(
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
        let last = i + 1 == tables.len();
        let (stage, until) = stage(table, world, time, before, last, has_gravity);
        before = until;
        stages.push(stage);
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

/// The stage, and its end, if it is known. `before`: the end of the stage before.
fn stage(
    table: &Table<'_>,
    world: &World<'_>,
    time: Option<&Time>,
    before: Option<f64>,
    last: bool,
    has_gravity: bool,
) -> (Option<Stage>, Option<f64>) {
    let name = table.required("name", "name = \"settle\"", Node::name);
    let kind = table.required("kind", "kind = \"quasi-static\"", |n| {
        let kind = n.choice(Kind::NAMES, Kind::from_name)?;
        if kind == Kind::Dynamic && world.kind == Some(Kind::QuasiStatic) {
            return n.fail("a quasi-static scene has no inertia", "set [scene] kind = \"dynamic\"");
        }
        Some(kind)
    });
    let until = table.required("until", "until = 1.0", |n| {
        let until = n.positive()?;
        if let Some(before) = before
            && until <= before
        {
            return n.fail(format!("is not after the end of the stage before, {before}"), "sort the stages by time");
        }
        match world.end {
            Some(end) if until > end => {
                n.fail(format!("is after the end of the run, {end}"), "choose an earlier time, or a later [time] end")
            }
            Some(end) if last && until != end => n.fail(
                format!("the last stage must end with the run, at {end}"),
                "choose this time, add a stage, or change [time] end",
            ),
            _ => Some(until),
        }
    });
    let length = until.zip(before).map(|(until, before)| until - before);
    let step = table.optional("step", |n| {
        let step = n.positive()?;
        match length {
            Some(length) if step > length * (1.0 + 1e-12) => {
                n.fail(format!("must not exceed the length of the stage, {length}"), "choose a smaller step")
            }
            Some(length) if length / step > MAX_STEPS => {
                n.fail(format!("gives {:.1e} steps", length / step), "choose a larger step")
            }
            _ => Some(step),
        }
    });
    let default_fits = match (length, time) {
        (Some(length), Some(time)) if !table.has("step") && time.step > length * (1.0 + 1e-12) => {
            let message =
                format!("is needed: that of [time], {}, exceeds the length of the stage, {length}", time.step);
            table.fail("step", message, "add it, or choose a smaller one in [time]")
        }
        _ => Some(()),
    };
    let integrator = table.optional("integrator", |n| {
        if kind == Some(Kind::QuasiStatic) {
            return n.fail("a static stage has no integrator", "remove it");
        }
        integrator(n)
    });
    let statics = |n: &Node<'_>| match kind {
        Some(Kind::Dynamic) => n.fail("is for quasi-static stages", "remove it"),
        _ => Some(()),
    };
    let largest = step.and_then(|step| step.or(time.map(|time| time.step)));
    let automatic = table.optional("automatic", |n| statics(n).and_then(|()| automatic(n, largest)));
    let stabilise = table.optional("stabilise", |n| statics(n).and_then(|()| stabilise(n)));
    let off = table.default("off", Vec::new(), |n| off(n, world, has_gravity));
    table.finish();
    let stage = (|| {
        default_fits?;
        Some(Stage {
            name: name?,
            kind: kind?,
            until: until?,
            step: step?,
            automatic: automatic?,
            stabilise: stabilise?,
            integrator: integrator?,
            off: off?,
        })
    })();
    (stage, until)
}

/// Whether there are stages, and each is static or has an integrator of its own.
pub(super) fn have_own_schemes(stages: &[Option<Table<'_>>]) -> bool {
    let is_static = |table: &Table<'_>| {
        let is_word = |kind: Node<'_>| matches!(kind.value, DeValue::String(word) if word == Kind::QuasiStatic.name());
        table.get("kind").is_some_and(is_word)
    };
    let has_own = |table: &Table<'_>| table.has("integrator") || is_static(table);
    !stages.is_empty() && stages.iter().flatten().all(has_own)
}

fn off(node: &Node<'_>, world: &World<'_>, has_gravity: bool) -> Option<Vec<String>> {
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
