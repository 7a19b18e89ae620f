//! Whether densities, moduli, sizes and gravity are usual ones in the units that the scene says it has.

use crate::scene::{Dimension, Scene, Units};
use crate::solver::Model;

/// What a number is and the range in SI in which it is usual.
pub(crate) struct Range {
    pub noun: &'static str,
    dimension: Dimension,
    pub low: f64,
    pub high: f64,
    si: &'static str,
}

impl Range {
    /// Whether a value in SI is usual.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// Densities from foams to osmium.
pub(crate) const DENSITY: Range =
    Range { noun: "the density", dimension: Dimension::Density, low: 1.0, high: 25_000.0, si: "kg/m³" };
/// Moduli from gels to diamond.
pub(crate) const MODULUS: Range =
    Range { noun: "Young's modulus", dimension: Dimension::Stress, low: 1e3, high: 2e12, si: "Pa" };
/// Sizes from what a microscope shows to what a town is.
const SIZE: Range = Range { noun: "the size", dimension: Dimension::Length, low: 1e-6, high: 1e4, si: "m" };
/// Gravity from the moon's to Jupiter's.
const GRAVITY: Range =
    Range { noun: "the acceleration", dimension: Dimension::Acceleration, low: 1.0, high: 30.0, si: "m/s²" };

/// Warnings for numbers that are out of their usual range; none without `[scene] units`.
pub(super) fn warnings(scene: &Scene, model: &Model) -> Vec<String> {
    let Some(units) = scene.header.units else { return Vec::new() };
    let mut list = Vec::new();
    let mut look = |name: &str, value: f64, range: &Range| list.extend(warning(units, name, value, range));
    for (item, body) in scene.bodies.iter().zip(&model.bodies) {
        let name = format!("body `{}`", item.name);
        if let Some(density) = item.density.filter(|&density| density > 0.0) {
            look(&name, density, &DENSITY);
        }
        look(&name, body.solid.law().small_strain_moduli().young_modulus(), &MODULUS);
        let nodes = body.nodes.start as usize..body.nodes.end as usize;
        let extent = |i: usize| {
            let x = nodes.clone().map(|node| model.reference[3 * node + i]);
            let (low, high) = x.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            high - low
        };
        look(&name, extent(0).max(extent(1)).max(extent(2)), &SIZE);
    }
    for item in &scene.rigids {
        if let Some(density) = item.density.filter(|&density| density > 0.0) {
            look(&format!("rigid body `{}`", item.name), density, &DENSITY);
        }
    }
    if let Some(gravity) = &scene.gravity {
        let [x, y, z] = gravity.acceleration;
        look("[gravity]", x.hypot(y).hypot(z), &GRAVITY);
    }
    list
}

/// A warning for a value out of its range: its value in SI, and the systems in which the number would be a usual one.
fn warning(units: Units, name: &str, value: f64, range: &Range) -> Option<String> {
    let Range { noun, dimension, low, high, si } = range;
    let fits = |units: Units| range.contains(value * units.in_si(*dimension));
    if fits(units) || !value.is_finite() {
        return None;
    }
    let others: Vec<String> = Units::all().filter(|&other| fits(other)).map(|other| format!("\"{other}\"")).collect();
    let hint = if others.is_empty() {
        "it would be unusual in any system of units".to_owned()
    } else {
        format!("it would be usual with units = {}", others.join(" or "))
    };
    Some(format!(
        "{name}: {noun} {value:e} {} is {:.3e} {si}, and usual are {low:e} to {high:e} {si}; {hint}",
        units.label(*dimension),
        value * units.in_si(*dimension),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steel_in_wrong_units_is_told_with_the_right_ones() {
        // 7.85e-9 t/mm3 is steel.
        assert_eq!(warning(Units::MmTS, "body `a`", 7.85e-9, &DENSITY), None);
        let text = warning(Units::MKgS, "body `a`", 7.85e-9, &DENSITY).unwrap();
        assert!(text.contains("7.850e-9 kg/m³") && text.contains("units = \"mm-t-s\""), "{text}");
        let text = warning(Units::MmTS, "body `a`", 7850.0, &DENSITY).unwrap();
        assert!(text.contains("7.850e15 kg/m³") && text.contains("\"m-kg-s\""), "{text}");
        assert_eq!(warning(Units::MmTS, "body `a`", 210_000.0, &MODULUS), None);
        assert!(warning(Units::MmTS, "body `a`", 2.1e11, &MODULUS).unwrap().contains("\"m-kg-s\""));
        assert!(warning(Units::MKgS, "[gravity]", 9810.0, &GRAVITY).unwrap().contains("\"mm-t-s\""));
        assert!(warning(Units::MKgS, "[gravity]", 1e30, &GRAVITY).unwrap().contains("in any system"));
    }
}
