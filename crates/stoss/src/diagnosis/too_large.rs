//! A step or a load that is too large: the motion in a step against an element, the stress of a load against the modulus.

use super::case::DiagnosedRun;
use super::density::moduli;
use super::{Cause, Confidence, LikelyCause, Remedy, toml};
use crate::scene::Time;
use stoss_solver::{FailureKind, LoadKind};

/// Motion of a step, in edges of the elements, from which on it is too much for one.
const LARGE: f64 = 0.3;
/// Motion in the smallest step that was tried from which on the step is still the likely cause.
const STILL_LARGE: f64 = 0.1;
const MAYBE: f64 = 0.02;
/// Motion that a step may have.
const GOOD: f64 = 0.1;

/// A step in which bodies move by a good part of an element.
pub(super) fn step(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    use FailureKind::{Cycling, InsideOut, InvertedElement, NotConverged, Unsettled};
    let Some(failure) = case.failure() else { return Vec::new() };
    if !case.failed_by(&[InvertedElement, InsideOut, NotConverged, Cycling, Unsettled]) {
        return Vec::new();
    }
    // cannot fail: there is a last one.
    let first = &case.failures()[0];
    let Some((per_step, edge, text, body)) = travel(case, first.dt) else { return Vec::new() };
    let (nominal, smallest) = (per_step / edge, per_step / edge * failure.dt / first.dt);
    if nominal < LARGE || smallest < MAYBE {
        return Vec::new();
    }
    let time = &case.scene.time;
    let key = case.step_key();
    let present = case.step_size();
    let mut remedies = vec![Remedy::set(
        key.clone(),
        toml::number(toml::down(present * GOOD / nominal)),
        "a tenth of an element length per step",
    )];
    let is_automatic = case.is_automatic();
    if is_automatic {
        // The step is only the largest one there.
        remedies = vec![Remedy::words(
            "let `smallest` of `automatic` be smaller, so that the failing step may be divided further",
        )];
    }
    if !is_automatic && time.max_cuts < Time::DEFAULT_MAX_CUTS {
        let cuts = Time::DEFAULT_MAX_CUTS.to_string();
        remedies.push(Remedy::set("time.max_cuts", cuts, "the default: a failing step may be halved ten times"));
    }
    let mut evidence = vec![
        format!(
            "{text} by {per_step:.3e} in a step of size {:e}: {nominal:.2} element lengths of {edge:.3e}",
            first.dt
        ),
        format!("in the smallest step that was tried, {:e}, it still is {smallest:.2} element lengths", failure.dt),
    ];
    if let Some((young, density, _)) = case.scene.bodies.get(body).and_then(|item| moduli(case, body, item)) {
        let transit = edge / (young / density).sqrt();
        evidence.push(format!(
            "a wave takes {transit:.2e} to cross an element; the step is {:.1} times as long",
            first.dt / transit
        ));
    }
    let place = case.place();
    vec![LikelyCause {
        cause: Cause::StepTooLarge,
        confidence: if smallest >= STILL_LARGE { Confidence::High } else { Confidence::Medium },
        place,
        sentence: format!("`{key} = {present}` is too large: in one step {text} by {nominal:.2} element lengths"),
        evidence,
        remedies,
    }]
}

/// Part of Young's modulus from which on the stress of a load is large, and from which on no material of these laws withstands it.
const LARGE_STRESS: f64 = 0.3;
const CRUSHING: f64 = 1.0;

/// A load on a body whose stress is of the order of its modulus when the run stops.
pub(super) fn load(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    use FailureKind::{InsideOut, InvertedElement, NotConverged, Singular};
    let Some(failure) =
        case.failure().filter(|_| case.failed_by(&[InvertedElement, InsideOut, NotConverged, Singular]))
    else {
        return Vec::new();
    };
    let time = failure.time + failure.dt;
    let model = case.model();
    let mut list = Vec::new();
    for load in &model.loads {
        for (b, body) in model.bodies.iter().enumerate() {
            let Some(stress) = stress(case, load, b, time) else { continue };
            let young = body.solid.law().small_strain_moduli().young_modulus();
            let part = stress / young;
            if part < LARGE_STRESS || !part.is_finite() {
                continue;
            }
            let name = body.solid.name();
            let is_here = case.place().body.as_deref() == Some(name);
            list.push(LikelyCause {
                cause: Cause::LoadTooLarge,
                confidence: match (is_here, part >= CRUSHING) {
                    (true, true) => Confidence::High,
                    (true, false) | (false, true) => Confidence::Medium,
                    (false, false) => Confidence::Low,
                },
                place: case.place(),
                sentence: format!(
                    "at t = {1} the stress of the load `{0}` on `{name}` is {part:.1} times its Young's modulus: it crushes the body",
                    load.name,
                    toml::plain(time)
                ),
                evidence: vec![format!(
                    "the stress is {}, the modulus {}; a stress of a hundredth of the modulus is already a strain of about one per cent",
                    toml::plain(stress),
                    toml::plain(young)
                )],
                remedies: [format!("check the value of the load `{}` and its units against the modulus of `{name}`", load.name)]
                    .into_iter()
                    .chain(begins(load).then(|| "or raise it from zero by a table, and see in the frames which load the body withstands".to_owned()))
                    .map(Remedy::words)
                    .collect(),
            });
        }
    }
    list
}

/// Whether a load is there from the start of the run.
fn begins(load: &stoss_solver::Load) -> bool {
    (0..load.magnitude.columns()).any(|column| load.magnitude.value(0.0, column) != 0.0)
}

/// Size of the stress of a load in a body at a time: a pressure, or the resultant over the mean cross-section across it. Bending, which is more, is not seen.
fn stress(case: &DiagnosedRun<'_>, load: &stoss_solver::Load, b: usize, time: f64) -> Option<f64> {
    let body = &case.model().bodies[b];
    let value = |column: usize| load.magnitude.value(time, column);
    match &load.kind {
        LoadKind::FollowerPressure { facets } => {
            let acts = facets.iter().flat_map(|face| face.iter()).any(|node| body.nodes.contains(node));
            acts.then(|| value(0).abs())
        }
        LoadKind::Dead { patterns } => {
            let mut force = [0.0; 3];
            for (column, pattern) in patterns.iter().enumerate() {
                for &(component, unit) in pattern.iter().filter(|(component, _)| body.nodes.contains(&(component / 3)))
                {
                    force[component as usize % 3] += value(column) * unit;
                }
            }
            let size = force.iter().map(|f| f * f).sum::<f64>().sqrt();
            let along =
                |node: u32| (0..3).map(|i| case.model().reference[3 * node as usize + i] * force[i] / size).sum();
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) = body.nodes.clone().map(along).fold(ends, |(l, h), x: f64| (l.min(x), h.max(x)));
            (size > 0.0).then(|| size * (high - low) / body.solid.volume())
        }
        _ => None,
    }
}

/// The largest motion of a deformable body in a step of this size from now on: how far, the edge of its elements, in words, which body.
fn travel(case: &DiagnosedRun<'_>, dt: f64) -> Option<(f64, f64, String, usize)> {
    let model = case.model();
    let state = case.simulation.state();
    let length = |a: [f64; 3]| a.iter().map(|a| a * a).sum::<f64>().sqrt();
    let mut best: Option<(f64, f64, String, usize)> = None;
    for (b, body) in model.bodies.iter().enumerate() {
        let Some((_, edge)) = case.sizes(b) else { continue };
        let mut offer = |far: f64, text: String| {
            if best.as_ref().is_none_or(|(other, edge_of, ..)| far / edge > other / edge_of) {
                best = Some((far, edge, text, b));
            }
        };
        if case.simulation.plan().rule.has_inertia() {
            let speed = |node: u32| length(std::array::from_fn(|i| state.v[3 * node as usize + i]));
            let far = dt * body.nodes.clone().map(speed).fold(0.0, f64::max);
            offer(far, format!("`{}` moves", body.solid.name()));
        }
        for prescription in &model.prescriptions {
            let own = prescription.nodes.iter().filter(|node| body.nodes.contains(node));
            let reference = |node: u32| std::array::from_fn(|i| model.reference[3 * node as usize + i]);
            let moved = |&node: &u32| {
                let at = |time: f64, column: usize| prescription.position(node, reference(node), time, column);
                let along = |column: usize| at(state.time + dt, column) - at(state.time, column);
                (0..prescription.components.len()).map(|column| along(column).powi(2)).sum::<f64>().sqrt()
            };
            let far = own.map(moved).fold(0.0, f64::max);
            offer(far, format!("`{}` is moved by the prescription of `{}`", body.solid.name(), prescription.name));
        }
    }
    best
}
