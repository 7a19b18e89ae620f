//! Sizes that do not go together: density and modulus, step and motion.

use super::case::Case;
use super::{Cause, Confidence, Finding, Remedy, Where, toml};
use crate::scene::Time;
use stoss_solver::FailureKind;

/// A common material: its name, Young's modulus and density in SI units, and by which part both may differ.
struct Known {
    name: &'static str,
    young: [f64; 2],
    density: [f64; 2],
}

/// Materials that are told by the digits of modulus and density, whatever the units.
const KNOWN: [Known; 3] = [
    Known { name: "steel", young: [1.95e11, 2.15e11], density: [7750.0, 7950.0] },
    Known { name: "aluminium", young: [6.8e10, 7.4e10], density: [2650.0, 2850.0] },
    Known { name: "titanium", young: [1.03e11, 1.16e11], density: [4400.0, 4550.0] },
];

/// Systems of units in use: what a pascal, a kilogram per cubic metre and a metre per square second are in them.
const SYSTEMS: [(&str, f64, f64, f64); 5] = [
    ("m, kg, s", 1.0, 1.0, 1.0),
    ("mm, t, s", 1e-6, 1e-12, 1e3),
    ("mm, kg, ms", 1e-9, 1e-9, 1e-3),
    ("mm, g, ms", 1e-6, 1e-6, 1e-3),
    ("cm, g, s", 10.0, 1e-3, 1e2),
];

/// Part of the time of a wave through a body below which a run is so short that nothing can move.
const SHORT_RUN: f64 = 0.02;

/// Gravity of the earth as people give it.
const EARTH: [f64; 2] = [9.7, 10.1];

fn within(value: f64, [low, high]: [f64; 2], unit: f64) -> bool {
    (low * unit * (1.0 - 1e-9)..=high * unit * (1.0 + 1e-9)).contains(&value)
}

/// The power of ten by which a value has the digits of an interval.
fn power(value: f64, [low, high]: [f64; 2]) -> Option<i32> {
    let power = (value / (low * high).sqrt()).log10().round() as i32;
    within(value, [low, high], 10f64.powi(power)).then_some(power)
}

/// A density that fits no modulus: of a material that its digits tell, or by a body that its own weight crushes.
pub(super) fn density(case: &Case<'_>) -> Vec<Finding> {
    let bodies = case.scene.bodies.iter().enumerate();
    bodies.filter_map(|(b, body)| by_digits(case, b, body).or_else(|| by_weight(case, b, body))).collect()
}

/// Modulus and density, and the time that a wave takes through the body.
fn moduli(case: &Case<'_>, b: usize, body: &crate::scene::Body) -> Option<(f64, f64, f64)> {
    let young = case.model().bodies.get(b)?.solid.law().small_strain_moduli().young_modulus();
    let density = body.density?;
    let (size, _) = case.sizes(b)?;
    Some((young, density, size / (young / density).sqrt()))
}

fn by_digits(case: &Case<'_>, b: usize, body: &crate::scene::Body) -> Option<Finding> {
    let (young, density, transit) = moduli(case, b, body)?;
    let known =
        KNOWN.iter().find(|known| power(young, known.young).is_some() && power(density, known.density).is_some())?;
    let gravity = case.scene.gravity.as_ref().map(|g| g.acceleration.iter().map(|a| a * a).sum::<f64>().sqrt());
    // Only that of the earth tells units.
    let gravity = gravity.filter(|&g| power(g, EARTH).is_some());
    let fits_gravity = |unit: f64| gravity.is_none_or(|g| within(g, EARTH, unit));
    let has_modulus = |pascal: f64| within(young, known.young, pascal);
    if SYSTEMS.iter().any(|&(_, pascal, kilogram, acceleration)| {
        has_modulus(pascal) && within(density, known.density, kilogram) && fits_gravity(acceleration)
    }) {
        return None;
    }
    let fitting: Vec<_> = SYSTEMS.iter().filter(|system| has_modulus(system.1) && fits_gravity(system.3)).collect();
    let digits = 10f64.powi(power(density, known.density)?);
    let offer = |&&(name, _, kilogram, _): &&(&str, f64, f64, f64)| {
        let value = toml::short(density / digits * kilogram);
        let factor = density / value;
        let by = if factor >= 1.0 {
            format!("{factor:.0e} times smaller")
        } else {
            format!("{:.0e} times larger", 1.0 / factor)
        };
        Remedy::set(
            format!("body[{b}].density"),
            toml::number(value),
            &format!("{by}: that of {} in {name}", known.name),
        )
    };
    let remedies: Vec<Remedy> = fitting.iter().map(offer).collect();
    // An odd power of ten is none of any units of length and time that are powers of ten.
    let speed = (young / density).sqrt();
    let si = (known.young[0] * known.young[1]).sqrt() / (known.density[0] * known.density[1]).sqrt();
    let is_odd = ((young / density / si).log10().round() as i64).rem_euclid(2) == 1;
    let end = case.scene.time.end;
    let short = end < SHORT_RUN * transit;
    let confidence = if is_odd || gravity.is_some() || short { Confidence::High } else { Confidence::Medium };
    let mut evidence = vec![format!(
        "modulus {young:e} and density {density:e} have the digits of {}, but they give a wave speed of {speed:.3e}: in no common system of units is that {:.0} m/s",
        known.name,
        si.sqrt()
    )];
    evidence.push(format!(
        "a wave takes {transit:.2e} to cross `{}`, and the run ends at {end:e}{}",
        body.name,
        if short { ", before anything can move" } else { "" }
    ));
    if let Some(g) = gravity.filter(|_| fitting.is_empty()) {
        evidence.push(format!("nor does gravity of {g} go with this modulus in any common system of units"));
    }
    Some(Finding {
        cause: Cause::Density,
        confidence,
        place: of_body(case, b, &format!("`{}`, `body[{b}].density`", body.name)),
        sentence: format!(
            "the density {density:e} of `{}` does not match its modulus {young:e}: the units are probably mixed",
            body.name
        ),
        evidence,
        remedies: if remedies.is_empty() {
            vec![Remedy::words(format!(
                "give `body[{b}].density`, the modulus and gravity in the same units, for instance mm, t, s"
            ))]
        } else {
            remedies
        },
    })
}

/// Weight against stiffness: `rho g L / E`.
fn by_weight(case: &Case<'_>, b: usize, body: &crate::scene::Body) -> Option<Finding> {
    let (young, density, _) = moduli(case, b, body)?;
    let gravity = case.scene.gravity.as_ref()?.acceleration;
    let g = gravity.iter().map(|a| a * a).sum::<f64>().sqrt();
    let (size, _) = case.sizes(b)?;
    let strain = density * g * size / young;
    if strain < 1.0 {
        return None;
    }
    let thousand = toml::short(density * 10f64.powi(-3 * ((strain.log10() + 1.0) / 3.0).ceil() as i32));
    Some(Finding {
        cause: Cause::Density,
        confidence: if case.is_bad() || strain > 100.0 { Confidence::High } else { Confidence::Medium },
        place: of_body(case, b, &format!("`{}`, `body[{b}].density`", body.name)),
        sentence: format!(
            "the weight of `{}` crushes it: density {density:e} and gravity {g} against modulus {young:e}",
            body.name
        ),
        evidence: vec![format!(
            "density x gravity x height / modulus, a strain, is {strain:.2e}; it should be far below one"
        )],
        remedies: vec![
            Remedy::set(
                format!("body[{b}].density"),
                toml::number(thousand),
                "if it was given in other units than the modulus",
            ),
            Remedy::words("or give modulus and gravity in the units of the density"),
        ],
    })
}

fn of_body(case: &Case<'_>, b: usize, text: &str) -> Where {
    let solid = &case.model().bodies[b];
    let count = solid.nodes.len().max(1) as f64;
    let centre = std::array::from_fn(|i| solid.nodes.clone().map(|n| case.position(n)[i]).sum::<f64>() / count);
    Where {
        text: text.to_owned(),
        body: Some(solid.solid.name().to_owned()),
        position: Some(centre),
        ..Where::default()
    }
}

/// Motion of a step, in edges of the elements, from which on it is too much for one.
const LARGE: f64 = 0.3;
/// Motion in the smallest step that was tried from which on the step is still the likely cause.
const STILL_LARGE: f64 = 0.1;
const MAYBE: f64 = 0.02;
/// Motion that a step may have.
const GOOD: f64 = 0.1;

/// A step in which bodies move by a good part of an element.
pub(super) fn step(case: &Case<'_>) -> Vec<Finding> {
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
    let stage = case.scene.stages.get(case.simulation.stage().saturating_sub(1) as usize);
    let present = stage.and_then(|stage| stage.step).unwrap_or(time.step);
    let mut remedies = vec![Remedy::set(
        key.clone(),
        toml::number(toml::down(present * GOOD / nominal)),
        "a tenth of an element length per step",
    )];
    if time.max_cuts < Time::DEFAULT_MAX_CUTS {
        let cuts = Time::DEFAULT_MAX_CUTS.to_string();
        remedies.push(Remedy::set("time.max_cuts", cuts, "the default: a failing step may be halved ten times"));
    }
    let mut evidence = vec![
        format!(
            "{text} by {per_step:.3e} in a step of {:e}, which is {nominal:.2} element lengths (of {edge:.3e})",
            first.dt
        ),
        format!("the smallest step that was tried, {:e}, still is {smallest:.2} element lengths", failure.dt),
    ];
    if let Some((young, density, _)) = moduli_of(case, body) {
        let transit = edge / (young / density).sqrt();
        evidence.push(format!(
            "a wave takes {transit:.2e} to cross an element; the step is {:.1} times as long",
            first.dt / transit
        ));
    }
    let place = case.place();
    vec![Finding {
        cause: Cause::StepTooLarge,
        confidence: if smallest >= STILL_LARGE { Confidence::High } else { Confidence::Medium },
        place,
        sentence: format!("`{key} = {present}` is too large: in one step {text} by {nominal:.2} element lengths"),
        evidence,
        remedies,
    }]
}

fn moduli_of(case: &Case<'_>, b: usize) -> Option<(f64, f64, f64)> {
    moduli(case, b, case.scene.bodies.get(b)?)
}

/// The largest motion of a deformable body in a step of this size from now on: how far, the edge of its elements, in words, which body.
fn travel(case: &Case<'_>, dt: f64) -> Option<(f64, f64, String, usize)> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_are_told_by_their_digits() {
        let steel = &KNOWN[0];
        assert_eq!(power(2.1e5, steel.young), Some(-6));
        assert_eq!(power(7.85e-9, steel.density), Some(-12));
        assert_eq!((power(2.5e5, steel.young), power(1e3, steel.density)), (None, None));
    }

    /// The units of each system are of one kind: a wave is as fast in all of them, `E / rho` in length over time squared.
    #[test]
    fn systems_of_units_agree_with_themselves() {
        for (name, pascal, kilogram, acceleration) in SYSTEMS {
            let (length, time) = match name.split_once(", ").unwrap().0 {
                "m" => (1.0, 1.0),
                "cm" => (1e2, 1.0),
                _ => (1e3, if name.ends_with("ms") { 1e3 } else { 1.0 }),
            };
            let speed: f64 = pascal / kilogram;
            let square = f64::powi(length / time, 2);
            assert!((speed / square - 1.0).abs() < 1e-12, "{name}: {speed} {square}");
            let gravity = length / (time * time);
            assert!((acceleration / gravity - 1.0_f64).abs() < 1e-12, "{name}");
        }
    }
}
