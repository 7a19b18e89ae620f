//! What changes in the step that failed: a stage that begins, loads at their full value, releases, contacts that close, friction that begins, overlaps that are closed at once, bends of tables.

use super::case::DiagnosedRun;
use super::toml;
use stoss_solver::DecisionKind;

/// Difference of times, in parts of the step, below which they are the same.
const SAME_TIME: f64 = 1e-9;

/// Part of a length of a contact below which a gap is none.
const NO_GAP: f64 = 1e-9;

/// What is new in the step that failed, in the words of the scene; nothing if no step failed.
pub(super) fn changes(case: &DiagnosedRun<'_>) -> Vec<String> {
    if case.failure().is_none() {
        return Vec::new();
    }
    let mut list: Vec<String> = stage(case).into_iter().collect();
    let names: Vec<String> =
        case.simulation.loads_at_once().iter().map(|&l| format!("`{}`", case.model().loads[l].name)).collect();
    if !names.is_empty() {
        let acts = if names.len() == 1 { "acts" } else { "act" };
        list.push(format!("{} {acts} with the full value at once", names.join(", ")));
    }
    let released = case.simulation.decisions().iter().rev().take_while(|of| of.step > case.simulation.step());
    list.extend(released.filter(|of| of.kind == DecisionKind::Release).map(|of| of.reason.clone()));
    for (c, item) in case.contacts() {
        let state = ContactAtFailure::of(case, c);
        let label = item.label();
        if let Some(depth) = state.overlap {
            list.push(format!(
                "an overlap of up to {} in contact `{label}` is closed, in one step whatever its size",
                toml::plain(toml::short(depth))
            ));
        }
        if state.closes {
            list.push(format!("contact `{label}` closes"));
        }
        if state.begins && item.friction.is_some() {
            list.push(format!("friction of contact `{label}` begins to act"));
        }
    }
    list.extend(bends(case));
    list
}

/// State of a contact in the step that failed: whether it closes, begins or acts, and how deep it overlaps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ContactAtFailure {
    /// Whether it was open, and points of it closed in the last attempt.
    pub closes: bool,
    /// Whether it has no pressure yet, and points of it are closed or close.
    pub begins: bool,
    /// How deep closed points are inside the master before the first step.
    pub overlap: Option<f64>,
    /// Whether points of it are closed, or closed in the last attempt.
    pub acts: bool,
}

impl ContactAtFailure {
    pub(super) fn of(case: &DiagnosedRun<'_>, c: usize) -> Self {
        let simulation = case.simulation;
        let (Some(active), Some(pressures)) = (simulation.active().get(c), simulation.pressures().get(c)) else {
            return Self::default();
        };
        let is_closed = active.iter().any(|&active| active);
        let changed = |pair: usize| {
            let slots = case.failures().iter().flat_map(|failure| &failure.slots);
            slots.filter(|slot| slot.pair == pair).count() > 0
        };
        let changes = changed(c);
        let unloaded = pressures.iter().all(|&p| p <= 0.0);
        let deepest = || {
            let reports = simulation.contact_report(c).ok()?;
            let gaps = reports.iter().zip(active).filter(|(_, active)| **active).filter_map(|(report, _)| report.gap);
            let depth = -gaps.fold(0.0, f64::min);
            (depth > NO_GAP * case.model().contacts[c].term.length_scale()).then_some(depth)
        };
        Self {
            closes: !is_closed && changes,
            begins: unloaded && (is_closed || changes),
            overlap: if simulation.step() == 0 { deepest() } else { None },
            acts: is_closed || changes,
        }
    }
}

/// The stage that begins, with what it switches.
fn stage(case: &DiagnosedRun<'_>) -> Option<String> {
    let number = (case.simulation.stage() as usize).checked_sub(1).filter(|&number| number > 0)?;
    let (stages, clock) = (&case.scene.stages, case.simulation.clock());
    let (now, before) = (stages.get(number)?, stages.get(number - 1)?);
    if clock.part_done(clock.time()) > SAME_TIME {
        return None;
    }
    let quoted = |names: Vec<&String>| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let off = quoted(now.off.iter().filter(|name| !before.off.contains(name)).collect());
    let on = quoted(before.off.iter().filter(|name| !now.off.contains(name)).collect());
    let mut text = format!("stage `{}` begins", now.name);
    if !off.is_empty() {
        text += &format!(", without {off}");
    }
    if !on.is_empty() {
        text += &format!(", with {on}");
    }
    Some(text)
}

/// Tables of loads and prescribed motions whose slope changes at the start of the step.
fn bends(case: &DiagnosedRun<'_>) -> Vec<String> {
    let (time, step) = (case.simulation.state().time, case.step_size());
    let bends = |rows: &[Vec<f64>]| {
        rows.windows(3).any(|rows| {
            let slope = |a: &[f64], b: &[f64], k: usize| (b[k] - a[k]) / (b[0] - a[0]).max(f64::MIN_POSITIVE);
            let differ = |k: usize| {
                let (before, after) = (slope(&rows[0], &rows[1], k), slope(&rows[1], &rows[2], k));
                (before - after).abs() > SAME_TIME * (before.abs() + after.abs())
            };
            (rows[1][0] - time).abs() <= SAME_TIME * step && (1..rows[1].len()).any(differ)
        })
    };
    let loads = case.scene.loads.iter().enumerate().filter_map(|(l, load)| {
        let (kind, series) = load.kind()?;
        bends(&series.rows()).then(|| format!("the table of `load[{l}].{}` has a bend", kind.name()))
    });
    let motions = case.scene.prescriptions.iter().enumerate();
    let motions = motions.filter(|(_, item)| bends(&item.rows()));
    loads.chain(motions.map(|(p, _)| format!("the table of `prescribe[{p}]` has a bend"))).collect()
}
