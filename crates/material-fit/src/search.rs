//! The search for parameters.

use crate::family::{Parameters, Size};
use crate::least_squares::least_squares;
use crate::{Curve, Curves, Family, FitError, Mode, nominal_stress, stable_stretches};
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;

/// Bulk modulus during the search, in shear moduli; it has no part in the stresses.
const SOME_BULK: f64 = 1e3;

/// Parameters found for a law, and the deviations of the law with them.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Name of the law.
    pub name: &'static str,
    /// Parameters of the law, in the order of the catalogue; a list of several for one that is a list. Stresses are in the unit of the table.
    pub parameters: Vec<(&'static str, Vec<f64>)>,
    /// The law with them.
    pub law: Arc<dyn HyperelasticLaw>,
    /// Deviation of each curve: the root of the mean square of the deviations, over the largest stress of the curve.
    pub deviations: Vec<(Mode, f64)>,
}

impl Fit {
    /// Root of the mean square of the deviations of the curves.
    pub fn deviation(&self) -> f64 {
        (self.deviations.iter().map(|(_, d)| d * d).sum::<f64>() / self.deviations.len() as f64).sqrt()
    }

    /// Stretches in which a material is stable in a test, see [`stable_stretches`].
    pub fn stable(&self, mode: Mode) -> [f64; 2] {
        stable_stretches(&*self.law, mode)
    }
}

/// Deviations of the stresses of a curve, over its largest stress and the root of the number of its points: the sum of their squares is the mean square. `None` beyond the law.
fn deviations_of(law: &dyn HyperelasticLaw, curve: &Curve) -> Option<Vec<f64>> {
    let weight = 1.0 / (curve.largest_stress() * (curve.points.len() as f64).sqrt());
    let of_point = |&[stretch, stress]: &[f64; 2]| {
        nominal_stress(law, curve.mode, stretch).ok().map(|found| weight * (found - stress))
    };
    curve.points.iter().map(of_point).collect::<Option<Vec<f64>>>().filter(|all| all.iter().all(|d| d.is_finite()))
}

/// Shear modulus of the neo-Hookean material nearest to the curves, and how far they go.
fn size_of(curves: &Curves) -> Size {
    let (mut products, mut squares, mut largest_invariant) = (0.0, 0.0, 0.0f64);
    for curve in &curves.all {
        let weight = curve.largest_stress().powi(-2);
        for &[stretch, stress] in &curve.points {
            let [a, b, c] = curve.mode.stretches(stretch).map(|l| l * l);
            let unit = (a - c) / stretch;
            products += weight * unit * stress;
            squares += weight * unit * unit;
            largest_invariant = largest_invariant.max(a + b + c - 3.0);
        }
    }
    Size { shear: products / squares, largest_invariant }
}

/// The parameters of a law with the least squares of the deviations, all curves with the same weight.
///
/// # Errors
/// Fewer points than parameters, Poisson's ratio out of (0, 1/2), curves that the law cannot describe.
pub fn fit(curves: &Curves, family: &Family, poisson: f64) -> Result<Fit, FitError> {
    if !(poisson > 0.0 && poisson < 0.5) {
        return Err(FitError::Poisson { poisson });
    }
    let law = family.law;
    if curves.len() < family.unknowns {
        return Err(FitError::TooFew { law, parameters: family.unknowns, points: curves.len() });
    }
    let size = size_of(curves);
    let nothing = FitError::NoParameters { law };
    if size.shear.is_nan() || size.shear <= 0.0 {
        return Err(nothing);
    }
    let parameters = |x: &[f64]| (family.parameters)(x, SOME_BULK * size.shear);
    let deviations = |x: &[f64]| -> Option<Vec<f64>> {
        let law = family.law(&parameters(x)).ok()?;
        let mut all = Vec::new();
        for curve in &curves.all {
            all.extend(deviations_of(&*law, curve)?);
        }
        Some(all)
    };
    let found =
        (family.starts)(size, family.unknowns).into_iter().filter_map(|start| least_squares(&start, deviations));
    let Some((x, _)) = found.min_by(|a, b| a.1.total_cmp(&b.1)) else { return Err(nothing) };
    let shear = family.law(&parameters(&x)).map_err(|_| nothing.clone())?.small_strain_moduli().shear;
    let bulk = 2.0 * shear * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson));
    let parameters: Parameters = (family.parameters)(&x, bulk);
    let law = family.law(&parameters).map_err(|_| nothing)?;
    let deviation = |curve: &Curve| {
        let all = deviations_of(&*law, curve).unwrap_or_default();
        (curve.mode, all.iter().map(|d| d * d).sum::<f64>().sqrt())
    };
    let deviations = curves.all.iter().map(deviation).collect();
    Ok(Fit { name: family.law, parameters, law, deviations })
}
