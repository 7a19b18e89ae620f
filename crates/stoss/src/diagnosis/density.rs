//! A density that does not fit the modulus.

use super::case::DiagnosedRun;
use super::{Cause, Confidence, LikelyCause, Remedy, Where, toml};
use crate::build::{DENSITY, MODULUS};
use crate::scene::{Dimension, Units};

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

/// A density that fits no modulus: of a material that is known by its digits, or of a body that its own weight crushes.
pub(super) fn density(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    let bodies = case.scene.bodies.iter().enumerate();
    let of = |(b, body)| match (by_digits(case, b, body), by_weight(case, b, body)) {
        (Some(digits), Some(weight)) => Some(LikelyCause {
            confidence: digits.confidence.max(weight.confidence),
            evidence: [digits.evidence, weight.evidence].concat(),
            ..digits
        }),
        (digits, weight) => digits.or(weight),
    };
    bodies.filter_map(of).collect()
}

/// Modulus and density, and the time that a wave takes through the body.
pub(super) fn moduli(case: &DiagnosedRun<'_>, b: usize, body: &crate::scene::Body) -> Option<(f64, f64, f64)> {
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

/// The finding on a density by its digits. Without units only what no system of units explains is reported, and never for certain; with units the numbers are
/// judged in SI.
fn by_digits(case: &DiagnosedRun<'_>, b: usize, body: &crate::scene::Body) -> Option<LikelyCause> {
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
                "in the units of the scene, {units}, {} {label} is {si} kg/m³; usual values are {low} to {high} kg/m³",
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
            // Only gravity of the earth says something about units.
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
                "modulus {} and density {} have the digits of {}, but the wave speed is {:.3e}, which is {:.0} m/s in no common system of units",
                toml::plain(young),
                toml::plain(density),
                known.name,
                (young / density).sqrt(),
                si.sqrt()
            ));
            if let Some(g) = gravity.filter(|_| remedies.is_empty()) {
                evidence.push(format!(
                    "gravity of {g} does not belong to this modulus in any common system of units either"
                ));
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
        let text = "or state the units, as `[scene] units = \"mm-t-s\"`: the numbers are then checked in them";
        remedies.push(Remedy::words(text));
    }
    Some(LikelyCause {
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
fn by_weight(case: &DiagnosedRun<'_>, b: usize, body: &crate::scene::Body) -> Option<LikelyCause> {
    let (young, density, _) = moduli(case, b, body)?;
    let gravity = case.scene.gravity.as_ref()?.acceleration;
    let g = gravity.iter().map(|a| a * a).sum::<f64>().sqrt();
    let (size, _) = case.sizes(b)?;
    let strain = density * g * size / young;
    if strain < 1.0 {
        return None;
    }
    let thousand = toml::short(density * 10f64.powi(-3 * ((strain.log10() + 1.0) / 3.0).ceil() as i32));
    Some(LikelyCause {
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
            "the strain density x gravity x height / modulus is {strain:.2e}; it should be far below one"
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

fn of_body(case: &DiagnosedRun<'_>, b: usize, text: &str) -> Where {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_are_known_by_their_digits() {
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
