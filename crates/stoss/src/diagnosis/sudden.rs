//! Loads that are applied in full at the start, which smaller steps do not divide.

use super::case::DiagnosedRun;
use super::elements::LOCKS;
use super::{Cause, Confidence, LikelyCause, Remedy, toml};
use stoss_fe_solid::Volumetric;
use stoss_solver::FailureKind;

/// Loads with their whole value in the step that failed, whatever its size.
pub(super) fn at_once(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    use FailureKind::{Cycling, InsideOut, InvertedElement, NotConverged, Unsettled};
    let loads = case.simulation.loads_at_once();
    if loads.is_empty() || !case.failed_by(&[InvertedElement, InsideOut, NotConverged, Cycling, Unsettled]) {
        return Vec::new();
    }
    let model = case.model();
    let place = case.place();
    let body = model.bodies.iter().find(|body| place.body.as_deref() == Some(body.solid.name()));
    // Where volume is kept by averages a first step that is too large does not converge at all.
    let ratio = body.map(|body| body.solid.law().small_strain_moduli().poisson_ratio());
    let is_mixed = body.is_some_and(|body| body.solid.options().volumetric == Volumetric::Mixed);
    let nearly = ratio.filter(|ratio| is_mixed && *ratio >= LOCKS);
    let names: Vec<String> = loads.iter().map(|&l| format!("`{}`", model.loads[l].name)).collect();
    let (start, end) = (case.simulation.state().time, case.stage_end());
    let mut remedies = Vec::new();
    for &l in loads {
        let key =
            case.scene.loads.get(l).and_then(|item| item.kind()).map(|(kind, series)| (kind.name(), series.rows()));
        match key {
            Some((key, rows)) if rows.len() == 1 => {
                let row = |time: f64, values: &[f64]| {
                    let all: Vec<String> = std::iter::once(&time).chain(values).map(|x| toml::number(*x)).collect();
                    format!("[{}]", all.join(", "))
                };
                let values = &rows[0][1..];
                let table = format!("{{ table = [{}, {}] }}", row(start, &vec![0.0; values.len()]), row(end, values));
                let why = "every step then adds a part of it, so that smaller steps help";
                remedies.push(Remedy::set(format!("load[{l}].{key}"), table, why));
            }
            Some((key, _)) => remedies.push(Remedy::words(format!("let the table of `load[{l}].{key}` begin with zero at t = {}", toml::plain(start)))),
            None => remedies.push(Remedy::words(
                "give gravity as the `acceleration` of a [[load]] on each body, as a table from zero, in place of [gravity]",
            )),
        }
    }
    let mut evidence = vec![format!(
        "{} attempts from t = {}, with step sizes down to {}, had the full load and failed",
        case.failures().len(),
        toml::plain(start),
        toml::plain(case.smallest_failed().unwrap_or(0.0))
    )];
    evidence.extend(nearly.map(|nu| {
        format!(
            "`{}` is nearly incompressible (Poisson's ratio {nu:.6}): Newton's method needs small load increments there",
            place.body.as_deref().unwrap_or_default()
        )
    }));
    vec![LikelyCause {
        cause: Cause::LoadAtOnce,
        confidence: if nearly.is_some() { Confidence::High } else { Confidence::Medium },
        place,
        sentence: format!(
            "{} {} applied in full at the start: the first step has the full load whatever its size, so that halving it does not help",
            names.join(", "),
            if names.len() == 1 { "is" } else { "are" }
        ),
        evidence,
        remedies,
    }]
}
