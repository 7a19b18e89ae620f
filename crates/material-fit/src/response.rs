//! What an incompressible material of a law does in a test.

use crate::Mode;
use stoss_continuum::{ConstitutiveError, HyperelasticLaw, SymmetricTensor2};

/// Size of a logarithmic strain for a difference of stresses.
const DIFFERENCE: f64 = 1e-5;

/// Steps of the logarithmic stretch between which stability is asked for.
const STEP: f64 = 0.005;

/// Stability is asked for up to this stretch, and down to its inverse.
const LARGEST_STRETCH: f64 = 10.0;

/// A determinant below this part of the product of what it is made of is round-off of the differences.
const ROUND_OFF: f64 = 1e-7;

/// Differences of the principal Kirchhoff stresses to the third one.
fn kirchhoff_differences(law: &dyn HyperelasticLaw, stretches: [f64; 3]) -> Result<[f64; 2], ConstitutiveError> {
    let c = stretches.map(|stretch| stretch * stretch);
    let stress = law.stress(&SymmetricTensor2::from_components([c[0], c[1], c[2], 0.0, 0.0, 0.0]))?.to_components();
    let kirchhoff: [f64; 3] = std::array::from_fn(|k| c[k] * stress[k]);
    Ok([kirchhoff[0] - kirchhoff[2], kirchhoff[1] - kirchhoff[2]])
}

/// Nominal stress in the direction that is pulled, with a pressure such that there is no stress across.
///
/// # Errors
/// Stretches beyond the law.
pub fn nominal_stress(law: &dyn HyperelasticLaw, mode: Mode, stretch: f64) -> Result<f64, ConstitutiveError> {
    Ok(kirchhoff_differences(law, mode.stretches(stretch))?[0] / stretch)
}

/// Whether stresses rise with strains in every direction of an incompressible motion: the second derivative of the energy by the logarithmic strains is positive definite (Drucker's condition).
fn is_stable(law: &dyn HyperelasticLaw, stretches: [f64; 3]) -> bool {
    let at = |direction: usize, size: f64| {
        let mut moved = stretches;
        moved[direction] *= size.exp();
        moved[2] *= (-size).exp();
        kirchhoff_differences(law, moved)
    };
    let column = |direction| -> Option<[f64; 2]> {
        let (ahead, behind) = (at(direction, DIFFERENCE).ok()?, at(direction, -DIFFERENCE).ok()?);
        Some(std::array::from_fn(|k| (ahead[k] - behind[k]) / (2.0 * DIFFERENCE)))
    };
    let (Some([a, b]), Some([c, d])) = (column(0), column(1)) else { return false };
    let off = 0.5 * (b + c);
    a > 0.0 && d > 0.0 && a * d - off * off > ROUND_OFF * a * d
}

/// The range of stretches around 1 in which a material of the law is stable (Drucker) in a test, at most from 1/10 to 10.
pub fn stable_stretches(law: &dyn HyperelasticLaw, mode: Mode) -> [f64; 2] {
    [-STEP, STEP].map(|step| {
        let count = (LARGEST_STRETCH.ln() / STEP).round() as i32;
        let stretch = |k: i32| (f64::from(k) * step).exp();
        let last = (0..=count).take_while(|&k| is_stable(law, mode.stretches(stretch(k)))).last();
        stretch(last.unwrap_or(0))
    })
}
