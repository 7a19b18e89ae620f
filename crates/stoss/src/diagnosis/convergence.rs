//! Iterations that come near a solution and do not meet the tolerance, or only slowly, and exact stick that is not found.

use super::case::DiagnosedRun;
use super::changes::ContactAtFailure;
use super::{Cause, Change, Confidence, LikelyCause, Remedy, Where, toml};
use crate::scene::{Contact, Friction, Stick, split_set};
use stoss_solver::FailureKind;

/// Last iterations that are looked at.
const LAST: usize = 5;

/// Relative residual from which on an iteration is near a solution.
const NEAR: f64 = 1e-6;

/// Ratio of residuals from one iteration to the next below which an iteration stands still, and above which it converges, slowly.
const STILL: f64 = 0.9;
const FAST: f64 = 0.2;

/// The scene's keys of contacts whose friction sticks exactly, by multipliers, and that act in the step that failed.
fn exact<'a>(case: &'a DiagnosedRun<'_>) -> Vec<(usize, &'a Contact, ContactAtFailure)> {
    let sticks = |friction: &Friction| friction.sticking().is_some_and(|of| of.stick() == Stick::Multiplier);
    let of = case.contacts().filter(|(_, item)| item.friction.as_ref().is_some_and(sticks));
    of.map(|(c, item)| (c, item, ContactAtFailure::of(case, c))).filter(|(.., closing)| closing.acts).collect()
}

/// Contacts with exact stick where no state of stick and slip was found.
pub(super) fn exact_stick(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    use FailureKind::{Cycling, InsideOut, InvertedElement, NotConverged, Unsettled};
    if !case.failed_by(&[NotConverged, Cycling, Unsettled, InvertedElement, InsideOut]) || stalls(case).is_some() {
        return Vec::new();
    }
    let contacts = exact(case);
    let Some((_, first, _)) = contacts.first() else { return Vec::new() };
    let place = case.place();
    let is_part = |item: &Contact| {
        let bodies = item.surfaces().map(|set| split_set(set).map_or(set, |(body, _)| body));
        place.pair.as_deref() == Some(&item.label()) || place.body.as_deref().is_some_and(|body| bodies.contains(&body))
    };
    let is_here = contacts.iter().any(|(_, item, _)| is_part(item));
    let labels: Vec<String> = contacts.iter().map(|(_, item, _)| format!("`{}`", item.label())).collect();
    let key = |c: usize| format!("contact[{c}].friction.stick");
    let changes: Vec<Change> =
        contacts.iter().map(|(c, ..)| Change::Set { key: key(*c), value: "\"penalty\"".to_owned() }).collect();
    let keys: Vec<String> = contacts.iter().map(|(c, ..)| format!("`{} = \"penalty\"`", key(*c))).collect();
    let mut evidence = vec![format!("friction of {} sticks exactly, by multipliers", labels.join(", "))];
    for (_, item, closing) in &contacts {
        if closing.begins {
            evidence.push(format!("in `{}` it has no traction yet from which the iteration could start", item.label()));
        }
        if let Some(depth) = closing.overlap {
            evidence.push(format!(
                "an overlap of up to {} in `{}` is closed in one step, however small it is",
                toml::plain(toml::short(depth)),
                item.label()
            ));
        }
    }
    let pair = place.pair.clone().or_else(|| Some(first.label()));
    let name = labels.join(", ");
    vec![LikelyCause {
        cause: Cause::ExactStick,
        // Where points open and close the set of those in contact is in question before their stick.
        confidence: if is_here && !case.failed_by(&[Cycling]) { Confidence::Medium } else { Confidence::Low },
        place: Where { pair, ..place },
        sentence: format!(
            "no state of stick and slip was found in {name}: points change between the two with every iteration, or have no equilibrium nearby with exact stick"
        ),
        evidence,
        remedies: vec![Remedy {
            text: format!(
                "set {} (a spring holds what sticks: it moves by its traction over the stiffness, by default ten times the modulus over an edge)",
                keys.join(" and ")
            ),
            changes,
        }],
    }]
}

/// The largest of the last residuals if they are small and all stand still.
fn stalls(case: &DiagnosedRun<'_>) -> Option<f64> {
    let last = last(case)?;
    let largest = last.iter().copied().fold(0.0, f64::max);
    let ratio = mean_ratio(&last);
    (largest <= NEAR && (STILL..1.0 / STILL).contains(&ratio)).then_some(largest)
}

/// The last residuals of the last attempt, if it made so many iterations.
fn last(case: &DiagnosedRun<'_>) -> Option<Vec<f64>> {
    let failure = case.failure().filter(|_| case.failed_by(&[FailureKind::NotConverged]))?;
    let all: Vec<f64> = failure.newton.iter().map(|row| row.residual).filter(|r| r.is_finite() && *r > 0.0).collect();
    (all.len() > LAST).then(|| all[all.len() - LAST..].to_vec())
}

fn mean_ratio(residuals: &[f64]) -> f64 {
    let (first, last) = (residuals[0], residuals[residuals.len() - 1]);
    (last / first).powf(1.0 / (residuals.len() - 1) as f64)
}

/// A residual that is small and falls no further, above the tolerance.
pub(super) fn tolerance(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    let Some(residual) = stalls(case) else { return Vec::new() };
    let tolerance = case.scene.solver.relative_tolerance.unwrap_or(crate::build::DEFAULT_TOLERANCE);
    let wider = 10f64.powi((2.0 * residual).log10().ceil() as i32);
    if wider <= tolerance {
        return Vec::new();
    }
    vec![LikelyCause {
        cause: Cause::ToleranceNotReached,
        confidence: Confidence::Medium,
        place: case.place(),
        sentence: format!(
            "the iteration stands still at a relative residual of {residual:.1e}, above the tolerance of {tolerance:e}: forces are in balance to this part of them, and round-off or a kink keeps the rest"
        ),
        evidence: vec![format!("the last {LAST} residuals are all of this size")],
        remedies: vec![Remedy::set(
            "solver.relative_tolerance",
            toml::number(wider),
            "forces are then in balance to this part; look at the reactions whether that is enough",
        )],
    }]
}

/// Residuals that fall by the same small factor in every iteration until there are no more.
pub(super) fn slowly(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    let Some(last) = last(case) else { return Vec::new() };
    let ratio = mean_ratio(&last);
    let steady = last.windows(2).all(|pair| (FAST..STILL).contains(&(pair[1] / pair[0])));
    if !steady {
        return Vec::new();
    }
    let place = case.place();
    let touches = |item: &Contact| {
        let bodies = item.surfaces().map(|set| split_set(set).map_or(set, |(body, _)| body));
        place.body.as_deref().is_some_and(|body| bodies.contains(&body))
    };
    let is_dynamic = case.simulation.plan().rule.has_inertia();
    let mortar = case
        .contacts()
        .find(|(c, item)| is_dynamic && item.method.integrates && touches(item) && ContactAtFailure::of(case, *c).acts);
    let mut remedies = Vec::new();
    if let Some((c, _)) = mortar {
        let why = "its tangent is exact in dynamics; that of mortar integrals that move in the step is not";
        remedies.push(Remedy::set(format!("contact[{c}].method"), "\"nts\"", why));
    }
    let limit =
        case.scene.solver.max_iterations.unwrap_or(stoss_newton::NewtonOptions::default().max_iterations) as usize;
    let tolerance = case.scene.solver.relative_tolerance.unwrap_or(crate::build::DEFAULT_TOLERANCE);
    let more = ((tolerance / last[LAST - 1]).ln() / ratio.ln()).ceil().max(1.0) as usize;
    let enough = 10 * (limit + 2 * more).div_ceil(10);
    remedies.push(Remedy::set(
        "solver.max_iterations",
        enough.to_string(),
        &format!("at this rate {more} more would do"),
    ));
    vec![LikelyCause {
        cause: Cause::SlowConvergence,
        confidence: Confidence::Medium,
        place,
        sentence: format!(
            "the iteration converges slowly: the residual falls by the factor {ratio:.2} in an iteration, and the limit of iterations comes first"
        ),
        evidence: vec![format!(
            "the last residuals are {}",
            last.iter().map(|r| format!("{r:.1e}")).collect::<Vec<_>>().join(", ")
        )],
        remedies,
    }]
}
