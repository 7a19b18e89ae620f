//! Sizes that do not go together: density and modulus, step and motion.

use super::case::Case;
use super::{Cause, Confidence, Finding, Remedy, Where, toml};
use crate::build::{DENSITY, MODULUS};
use crate::scene::{Dimension, Time, Units};
use stoss_solver::{FailureKind, LoadKind};

/// A common material: its name, Young's modulus and density in SI units, and by which part both may differ.
struct Known {
    name: &'static str,
    young: [f64; 2],
    density: [f64; 2],
}

/// Materials that are reported by the digits of modulus and density, whatever the units.
const KNOWN: [Known; 3] = [
    Known { name: "steel", young: [1.95e11, 2.15e11], density: [7750.0, 7950.0] },
    Known { name: "aluminium", young: [6.8e10, 7.4e10], density: [2650.0, 2850.0] },
    Known { name: "titanium", young: [1.03e11, 1.16e11], density: [4400.0, 4550.0] },
];

/// Part of the time of a wave through a body below which a run is so short that nothing can move.
const SHORT_RUN: f64 = 0.02;

/// Gravity of the earth in SI as people give it.
const EARTH: [f64; 2] = [9.7, 10.1];

fn within(value: f64, [low, high]: [f64; 2]) -> bool {
    (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(&value)
}

/// The power of ten by which a value has the digits of an interval.
fn power(value: f64, [low, high]: [f64; 2]) -> Option<i32> {
    let power = (value / (low * high).sqrt()).log10().round() as i32;
    within(value / 10f64.powi(power), [low, high]).then_some(power)
}

/// A density that fits no modulus: of a material that its digits tell, or by a body that its own weight crushes.
pub(super) fn density(case: &Case<'_>) -> Vec<Finding> {
    let bodies = case.scene.bodies.iter().enumerate();
    let of = |(b, body)| match (by_digits(case, b, body), by_weight(case, b, body)) {
        (Some(digits), Some(weight)) => Some(Finding {
            confidence: digits.confidence.max(weight.confidence),
            evidence: [digits.evidence, weight.evidence].concat(),
            ..digits
        }),
        (digits, weight) => digits.or(weight),
    };
    bodies.filter_map(of).collect()
}

/// Modulus and density, and the time that a wave takes through the body.
fn moduli(case: &Case<'_>, b: usize, body: &crate::scene::Body) -> Option<(f64, f64, f64)> {
    let young = case.model().bodies.get(b)?.solid.law().small_strain_moduli().young_modulus();
    let density = body.density?;
    let (size, _) = case.sizes(b)?;
    Some((young, density, size / (young / density).sqrt()))
}

/// Modulus, density and, of a scene with gravity of the earth, that, in some units.
#[derive(Clone, Copy)]
struct Data {
    young: f64,
    density: f64,
    gravity: Option<f64>,
}

impl Data {
    /// The material and the power of ten by which its density differs from that of the material, by the digits of both in SI.
    fn of_known(young: f64, density: f64) -> Option<(&'static Known, i32)> {
        KNOWN.iter().find_map(|known| power(young, known.young).and(Some((known, power(density, known.density)?))))
    }

    /// Whether modulus and gravity are those of the material in these units.
    fn has_modulus(&self, known: &Known, units: Units) -> bool {
        within(self.young * units.in_si(Dimension::Stress), known.young)
            && self.gravity.is_none_or(|g| within(g * units.in_si(Dimension::Acceleration), EARTH))
    }

    /// Whether these are common data in some system of units.
    fn fits_any(&self) -> bool {
        let fits = |units: Units, known: &Known| {
            self.has_modulus(known, units) && within(self.density * units.in_si(Dimension::Density), known.density)
        };
        Units::all().any(|units| KNOWN.iter().any(|known| fits(units, known)))
    }
}

/// Without units only what no system of units explains is reported, and never for certain; with units the numbers are judged in SI.
fn by_digits(case: &Case<'_>, b: usize, body: &crate::scene::Body) -> Option<Finding> {
    let (young, density, transit) = moduli(case, b, body)?;
    let gravity = case.scene.gravity.as_ref().map(|g| g.acceleration.iter().map(|a| a * a).sum::<f64>().sqrt());
    let end = case.scene.time.end;
    let short = end < SHORT_RUN * transit;
    let mut evidence = Vec::new();
    let mut remedies = Vec::new();
    let confidence = match case.scene.header.units {
        Some(units) => {
            let [pascal, kilogram] = [Dimension::Stress, Dimension::Density].map(|d| units.in_si(d));
            let is_usual = DENSITY.contains(density * kilogram);
            let known = Data::of_known(young * pascal, density * kilogram)
                .filter(|(known, power)| *power != 0 && within(young * pascal, known.young));
            if density <= 0.0 || (is_usual && known.is_none()) || !MODULUS.contains(young * pascal) {
                // An unusual modulus has a warning of its own, and says nothing of the density.
                return None;
            }
            let label = units.label(Dimension::Density);
            let [si, low, high] = [density * kilogram, DENSITY.low, DENSITY.high].map(toml::plain);
            evidence.push(format!(
                "in the units of the scene, {units}, {} {label} are {si} kg/m³; usual are {low} to {high} kg/m³",
                toml::plain(density)
            ));
            if let Some((known, power)) = known {
                let right = toml::short(density / 10f64.powi(power));
                evidence.push(format!(
                    "the modulus {} {} is that of {}",
                    toml::plain(young),
                    units.label(Dimension::Stress),
                    known.name
                ));
                remedies.push(of_material(b, density, right, known, units));
            }
            if is_usual { Confidence::Medium } else { Confidence::High }
        }
        None => {
            // Only gravity of the earth tells units.
            let gravity = gravity.filter(|&g| power(g, EARTH).is_some());
            let data = Data { young, density, gravity };
            let (known, power) = Data::of_known(young, density).filter(|_| !data.fits_any())?;
            for units in Units::all().filter(|&units| data.has_modulus(known, units)) {
                let right = density / 10f64.powi(power) / units.in_si(Dimension::Density);
                remedies.push(of_material(b, density, toml::short(right), known, units));
            }
            // Those that change least first.
            remedies.sort_by(|a, b| a.0.abs().round().total_cmp(&b.0.abs().round()));
            let si = (known.young[0] * known.young[1]).sqrt() / (known.density[0] * known.density[1]).sqrt();
            evidence.push(format!(
                "modulus {} and density {} have the digits of {}, but they give a wave speed of {:.3e}: in no common system of units is that {:.0} m/s",
                toml::plain(young),
                toml::plain(density),
                known.name,
                (young / density).sqrt(),
                si.sqrt()
            ));
            if let Some(g) = gravity.filter(|_| remedies.is_empty()) {
                evidence.push(format!("nor does gravity of {g} go with this modulus in any common system of units"));
            }
            // An odd power of ten is none of any units of length and time that are powers of ten.
            let is_odd = ((young / density / si).log10().round() as i64).rem_euclid(2) == 1;
            if is_odd || gravity.is_some() || short { Confidence::Medium } else { Confidence::Low }
        }
    };
    evidence.push(format!(
        "a wave takes {transit:.2e} to cross `{}`, and the run ends at {}{}",
        body.name,
        toml::plain(end),
        if short { ", before anything can move" } else { "" }
    ));
    let mut remedies: Vec<Remedy> = remedies.into_iter().map(|(_, remedy)| remedy).collect();
    if remedies.is_empty() {
        remedies.push(Remedy::words(format!(
            "give `body[{b}].density`, the modulus and gravity in the same units, for instance mm, t, s"
        )));
    }
    if case.scene.header.units.is_none() {
        let text = "or say the units, as `[scene] units = \"mm-t-s\"`: then the numbers are checked in them";
        remedies.push(Remedy::words(text));
    }
    Some(Finding {
        cause: Cause::Density,
        confidence,
        place: of_body(case, b, &format!("`{}`, `body[{b}].density`", body.name)),
        sentence: format!(
            "the density {} of `{}` does not match its modulus {}: the units are probably mixed",
            toml::plain(density),
            body.name,
            toml::plain(young)
        ),
        evidence,
        remedies,
    })
}

/// Offers the density of a material; first the power of ten by which it is larger.
fn of_material(b: usize, density: f64, right: f64, known: &Known, units: Units) -> (f64, Remedy) {
    let factor = right / density;
    let by = match factor >= 1.0 {
        true => format!("{factor:.0e} times larger"),
        false => format!("{:.0e} times smaller", 1.0 / factor),
    };
    let why = format!("{by}: that of {} in {units}", known.name);
    (factor.log10(), Remedy::set(format!("body[{b}].density"), toml::number(right), &why))
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
            "the weight of `{}` crushes it: density {} and gravity {} against modulus {}",
            body.name,
            toml::plain(density),
            toml::plain(g),
            toml::plain(young)
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
    let present = case.step_size();
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

/// Part of Young's modulus from which on the stress of a load is large, and from which on no material of these laws bears it.
const LARGE_STRESS: f64 = 0.3;
const CRUSHING: f64 = 1.0;

/// A load on a body whose stress is of the order of its modulus when the run stops.
pub(super) fn load(case: &Case<'_>) -> Vec<Finding> {
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
            list.push(Finding {
                cause: Cause::LoadTooLarge,
                confidence: match (is_here, part >= CRUSHING) {
                    (true, true) => Confidence::High,
                    (true, false) | (false, true) => Confidence::Medium,
                    (false, false) => Confidence::Low,
                },
                place: case.place(),
                sentence: format!(
                    "the load `{}` on `{name}` is {part:.1} times its Young's modulus at t = {}: it crushes the body",
                    load.name,
                    toml::plain(time)
                ),
                evidence: vec![format!(
                    "a stress of {} against a modulus of {}; a hundredth of the modulus is a strain of one per cent already",
                    toml::plain(stress),
                    toml::plain(young)
                )],
                remedies: vec![
                    Remedy::words(format!("check the value of the load `{}` and its units against the modulus of `{name}`", load.name)),
                    Remedy::words("or raise it from zero by a table, and see in the frames up to which value the body bears it"),
                ],
            });
        }
    }
    list
}

/// Size of the stress of a load in a body at a time: a pressure, or the resultant over the mean cross-section across it. Bending, which is more, is not seen.
fn stress(case: &Case<'_>, load: &stoss_solver::Load, b: usize, time: f64) -> Option<f64> {
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

    /// Right data of each material in each system of units are none that are mixed up; a thousand times the density is.
    #[test]
    fn right_data_fit_in_every_system_of_units() {
        let middle = |[low, high]: [f64; 2]| (low * high).sqrt();
        for units in Units::all() {
            for known in &KNOWN {
                let density = middle(known.density) / units.in_si(Dimension::Density);
                let young = middle(known.young) / units.in_si(Dimension::Stress);
                let earth = middle(EARTH) / units.in_si(Dimension::Acceleration);
                for gravity in [None, Some(earth)] {
                    assert!(Data { young, density, gravity }.fits_any(), "{} {units}", known.name);
                    let density = 1e3 * density;
                    assert!(!Data { young, density, gravity }.fits_any(), "{} {units}", known.name);
                }
            }
        }
    }
}
