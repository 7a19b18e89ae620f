//! Work and precision of the soft and the stiff spring (theory/integrators#spring).

use crate::verify::curve::{Curve, Point, ProblemCurves, relative_distance, timed};
use crate::workspace::Outcome;
use stoss_integrators::{SCHEMES, Scheme, scheme};
use stoss_model_problems::{Effort, ModelError, SpringPendulum, simulate};

/// End of the runs.
const END: f64 = 0.1;

/// Runs of a scheme, each with twice the steps of the one before. Schemes of second order are in their asymptotic range after eight of them.
const LEVELS: u32 = 11;
const QUICK_LEVELS: u32 = 8;

/// Steps of the reference.
const REFERENCE_STEPS: u64 = 100_000;

fn end_position(problem: &SpringPendulum, scheme: &dyn Scheme, steps: u64) -> Result<(Vec<f64>, Effort), ModelError> {
    let mut q = Vec::new();
    let effort = simulate(problem, scheme, END / steps as f64, steps, |s| {
        if s.step == steps {
            q = s.q[..3].to_vec();
        }
    })?;
    Ok((q, effort))
}

/// Soft and stiff spring, all schemes.
pub fn cases(quick: bool) -> Outcome<Vec<ProblemCurves>> {
    [("soft spring", SpringPendulum::soft(), Some("6.5")), ("stiff spring", SpringPendulum::stiff(), None)]
        .into_iter()
        .map(|(name, problem, figure)| case(name, &problem, figure, quick))
        .collect()
}

fn case(name: &str, problem: &SpringPendulum, figure: Option<&str>, quick: bool) -> Outcome<ProblemCurves> {
    // Extrapolated from two runs of the midpoint rule; the difference to the extrapolation of coarser ones is its error.
    let midpoint = scheme("midpoint")?;
    let run = |steps| end_position(problem, midpoint.as_ref(), steps).map(|(q, _)| q);
    let (a, b, c) = (run(REFERENCE_STEPS / 4)?, run(REFERENCE_STEPS / 2)?, run(REFERENCE_STEPS)?);
    let extrapolate = |coarse: &[f64], fine: &[f64]| -> Vec<f64> {
        fine.iter().zip(coarse).map(|(f, c)| f + (f - c) / 3.0).collect()
    };
    let (coarser, reference) = (extrapolate(&a, &b), extrapolate(&b, &c));
    let soft = problem.stiffness <= 1e4;
    let mut curves = Vec::new();
    for entry in SCHEMES {
        let scheme = entry.with([])?;
        let mut curve = Curve { scheme: entry.name.into(), ..Curve::default() };
        let order = scheme.claims().order;
        // Checked where the asymptotic range is reached, which takes the finest levels for schemes of first order.
        curve.checked_order = soft.then_some(f64::from(order));
        let levels = if quick && order > 1 { QUICK_LEVELS } else { LEVELS };
        for level in 0..levels {
            let steps = 10u64 << level;
            let dt = END / steps as f64;
            match timed(|| end_position(problem, scheme.as_ref(), steps)) {
                Ok(((q, effort), seconds)) => {
                    let error = relative_distance(&q, &reference);
                    curve.points.push(Point {
                        dt,
                        error,
                        of_dissipation: None,
                        seconds,
                        evaluations: effort.evaluations,
                    });
                }
                Err(error) => curve.failures.push(format!("{dt:.1e}: {error}")),
            }
        }
        // One line is enough: failures at larger steps have the same reason.
        curve.failures = curve.failures.pop().map(|last| format!("from {last}")).into_iter().collect();
        curves.push(curve);
    }
    Ok(ProblemCurves {
        name: name.into(),
        about: format!("Spring pendulum, c = {:.0e}, relative error of the position at T = {END}", problem.stiffness),
        reference: format!("midpoint rule with steps of {:.0e}, extrapolated", END / REFERENCE_STEPS as f64),
        reference_error: relative_distance(&coarser, &reference),
        dissipation_error: None,
        least_target: 1e-4,
        figure: figure.map(str::to_owned),
        curves,
    })
}
