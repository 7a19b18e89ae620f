//! Checks of generator parameters.

use crate::error::parameter;
use crate::{MAX_ELEMENTS, MeshError};

/// A length that must be positive and finite.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), MeshError> {
    if value.is_finite() && value > 0.0 { Ok(()) } else { Err(parameter(name, value, "must be positive and finite")) }
}

/// Coordinates that must be finite.
pub(crate) fn finite(name: &'static str, value: &[f64]) -> Result<(), MeshError> {
    if value.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(parameter(name, value, "must be finite")) }
}

/// Numbers of elements, each at least `least`, whose product times `factor` is at most [`MAX_ELEMENTS`].
pub(crate) fn divisions(values: &[usize], least: &[usize], factor: usize) -> Result<(), MeshError> {
    if let Some(i) = (0..values.len()).find(|&i| values[i] < least[i]) {
        let remedy = format!("entry {} must be at least {}", i + 1, least[i]);
        return Err(parameter("divisions", values, remedy));
    }
    match values.iter().try_fold(factor, |p, &n| p.checked_mul(n)) {
        Some(count) if count <= MAX_ELEMENTS => Ok(()),
        _ => Err(MeshError::TooLarge { divisions: format!("{values:?}"), limit: MAX_ELEMENTS }),
    }
}

/// Gradings must be positive, and 1 where there is a single element.
pub(crate) fn grading(values: [f64; 3], divisions: [usize; 3]) -> Result<(), MeshError> {
    for i in 0..3 {
        let g = values[i];
        if !(g.is_finite() && (1e-6..=1e6).contains(&g)) {
            return Err(parameter("grading", values, format!("entry {} must lie between 1e-6 and 1e6", i + 1)));
        }
        if divisions[i] == 1 && g != 1.0 {
            return Err(parameter("grading", values, format!("entry {} must be 1 where there is one element", i + 1)));
        }
    }
    Ok(())
}

/// A number of divisions that must be at least `least`.
pub(crate) fn at_least(name: &'static str, value: u32, least: u32) -> Result<(), MeshError> {
    if value >= least { Ok(()) } else { Err(parameter(name, value, format!("must be at least {least}"))) }
}

/// A number of facets that must be at most [`MAX_ELEMENTS`].
pub(crate) fn facet_count(divisions: &dyn std::fmt::Debug, count: u128) -> Result<(), MeshError> {
    if count <= MAX_ELEMENTS as u128 {
        Ok(())
    } else {
        Err(MeshError::TooLarge { divisions: format!("{divisions:?}"), limit: MAX_ELEMENTS })
    }
}
