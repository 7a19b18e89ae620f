//! Work and precision of the schemes that carry constraints.

use super::build::{ABOUT_Z, add_beam, add_gravity, add_joint, beam_frame, follow, place, with_scheme};
use super::rigid::{SPHERICAL, double, double_error, double_model, spherical_error, spherical_model, spherical_square};
use super::{check, noted};
use crate::plot::{self, Labels, Series};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::curve::timed;
use crate::verify::numbers::{apart, larger};
use crate::verify::report::{Grid, ReportSection};
use crate::workspace::Outcome;
use stoss_integrators::SCHEMES;
use stoss_multibody::{Beam, BeamAxis, CoordinateOptions, JointFrame, JointKind, Section as CrossSection};
use stoss_reference_cases::multibody::pendulums::spherical_pendulum;
use stoss_solver::Model;

/// A problem: its model, end, coarsest number of steps, and the error of end positions over a length of the problem.
struct Problem {
    name: &'static str,
    model: fn() -> Outcome<Model>,
    end: f64,
    coarsest: u32,
    error: Box<dyn Fn(&[f64]) -> f64>,
    /// What the errors are against, and its own error.
    reference: (&'static str, f64),
}

/// One run: step size, error, CPU seconds.
type Point = [f64; 3];

/// Measures error against work for all problems.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let levels = if quick { 3 } else { 7 };
    for problem in problems(quick)? {
        report(&problem, levels, quick, findings)?;
    }
    Ok(())
}

fn problems(quick: bool) -> Outcome<Vec<Problem>> {
    let data = double();
    let start = [1.2, 2.0, 0.0, 0.0];
    // With half of the steps, for their own errors.
    let [coarse, angles] = [2_000, 4_000].map(|steps| data.state(start, 1.0, steps));
    let of_angles = (0..2).map(|i| (coarse[i] - angles[i]).abs()).fold(0.0, larger);
    let [coarse, bob] = [2_000, 4_000].map(|steps| spherical_pendulum(SPHERICAL, spherical_square(), 1.0, steps));
    let of_bob = (0..3).map(|i| (coarse[i] - bob[i]).abs()).fold(0.0, larger);
    let (beam, own) = beam_reference(quick)?;
    let equations = "Runge and Kutta in minimal coordinates";
    Ok(vec![
        Problem {
            name: "spherical pendulum",
            model: spherical_model,
            end: 1.0,
            coarsest: 25,
            error: Box::new(move |q| spherical_error(q, &bob)),
            reference: (equations, of_bob),
        },
        Problem {
            name: "double pendulum",
            model: || Ok(double_model(&double(), [1.2, 2.0, 0.0, 0.0])?.0),
            end: 1.0,
            coarsest: 25,
            error: Box::new(move |q| double_error(q, &double(), &angles)),
            reference: (equations, of_angles),
        },
        Problem {
            name: "swinging beam",
            model: swinging,
            end: BEAM_END,
            coarsest: 25,
            error: Box::new(move |q| apart(place(q, tip()), beam)),
            reference: ("energy-momentum with 6400 steps (quick: 1600), extrapolated", own),
        },
    ])
}

const BEAM_END: f64 = 0.5;
const BEAM_NODES: u32 = 9;

fn tip() -> u32 {
    4 * (BEAM_NODES - 1)
}

/// A soft beam on a hinge that falls from the horizontal.
fn swinging() -> Outcome<Model> {
    let section =
        CrossSection { axial: 2e2, shear: [80.0; 2], bending: [0.5; 2], torsion: 0.5, mass: 1.0, rotary: [1e-2; 2] };
    let axis = BeamAxis::straight([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 4, 2)?;
    let beam = Beam::new("beam", 0, axis, section)?;
    let mut model = Model::default();
    add_beam(&mut model, &beam, &[]);
    let sides = [&JointFrame::ground([0.0; 3], ABOUT_Z), &beam_frame(&beam, 0, ABOUT_Z)];
    add_joint(&mut model, "hinge", JointKind::Hinge, sides, CoordinateOptions::default())?;
    add_gravity(&mut model, [0.0, -9.81, 0.0]);
    Ok(model)
}

fn beam_reference(quick: bool) -> Outcome<([f64; 3], f64)> {
    let at = |steps: u32| -> Outcome<[f64; 3]> {
        let mut simulation = super::build::dynamic(swinging()?, BEAM_END / f64::from(steps), BEAM_END)?;
        follow(&mut simulation, |_, _| {})?;
        Ok(place(&simulation.state().q, tip()))
    };
    let finest = if quick { 1600 } else { 6400 };
    let (a, b, c) = (at(finest / 4)?, at(finest / 2)?, at(finest)?);
    let extrapolate = |coarse: [f64; 3], fine: [f64; 3]| std::array::from_fn(|i| fine[i] + (fine[i] - coarse[i]) / 3.0);
    let (coarse, fine): ([f64; 3], [f64; 3]) = (extrapolate(a, b), extrapolate(b, c));
    Ok((fine, apart(coarse, fine)))
}

fn report(problem: &Problem, levels: u32, quick: bool, findings: &mut Findings) -> Outcome<()> {
    let (mut lines, mut rows) = (Vec::new(), Vec::new());
    let (reference, own) = problem.reference;
    noted(findings, problem.name, "error of the reference", own, Bound::AtMost(1e-5), reference);
    for entry in SCHEMES {
        let claims = entry.with([])?.claims();
        if !claims.constraints {
            continue;
        }
        let (mut points, mut failure): (Vec<Point>, String) = (Vec::new(), String::new());
        for level in 0..levels {
            let steps = problem.coarsest << level;
            let dt = problem.end / f64::from(steps);
            let run = || -> Outcome<f64> {
                let mut simulation = with_scheme((problem.model)()?, dt, problem.end, Some(entry.with([])?))?;
                follow(&mut simulation, |_, _| {})?;
                Ok((problem.error)(&simulation.state().q))
            };
            match timed(run) {
                Ok((error, seconds)) => points.push([dt, error, seconds]),
                Err(error) => failure = format!("{dt:.1e}: {error}"),
            }
        }
        // Errors below that say more about the reference.
        let told: Vec<Point> = points.iter().copied().filter(|p| p[1] > 100.0 * own).collect();
        let order = match told.as_slice() {
            [.., a, b] => (a[1] / b[1]).ln() / (a[0] / b[0]).ln(),
            _ => f64::NAN,
        };
        let note = points.iter().map(|p| format!("{:.1e}", p[1])).collect::<Vec<_>>().join(" ");
        let claim = f64::from(claims.order);
        // Of the two finest runs. The three steps of quick mode are too large for an order.
        let bound = if quick { Bound::Unbounded } else { Bound::AtLeast(claim - 0.1) };
        let quantity = format!("order of {}", entry.name);
        match points.is_empty() {
            true => noted(findings, problem.name, &quantity, f64::NAN, Bound::Unbounded, failure.clone()),
            false => noted(findings, problem.name, &quantity, order, bound, format!("errors {note}")),
        }
        rows.push(vec![
            entry.name.to_owned(),
            format!("{order:.2}"),
            points.iter().map(|p| format!("{:.1e}", p[1])).collect::<Vec<_>>().join(", "),
            points.iter().map(|p| format!("{:.1e}", p[2])).collect::<Vec<_>>().join(", "),
            failure,
        ]);
        lines.push((entry.name.to_owned(), points));
    }
    let cheapest = lines.iter().filter_map(|(name, p)| {
        let reached = p.iter().filter(|p| p[1] <= 1e-3).map(|p| p[2]).min_by(f64::total_cmp)?;
        Some((name.clone(), reached))
    });
    match cheapest.min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((name, seconds)) => noted(
            findings,
            problem.name,
            "CPU seconds of the cheapest run with an error below 1e-3",
            seconds,
            Bound::Unbounded,
            name,
        ),
        None => check(
            findings,
            problem.name,
            "CPU seconds of the cheapest run with an error below 1e-3",
            f64::NAN,
            Bound::Unbounded,
        ),
    }
    let series = |column: usize| -> Vec<Series> {
        let line = |(name, p): &(String, Vec<Point>)| Series {
            name: name.clone(),
            points: p.iter().map(|p| (p[column], p[1])).collect(),
        };
        lines.iter().map(line).collect()
    };
    let chart = |x: &str, column: usize, slopes: &[f64]| {
        plot::log_log(Labels { title: problem.name, x, y: "relative error" }, &series(column), Some(1e-13), slopes)
    };
    let head = ["scheme", "order", "errors", "CPU s", "failed"].map(str::to_owned).to_vec();
    findings.sections.push(ReportSection {
        title: format!("work and precision: {}", problem.name),
        reading: "Error of the end positions against CPU time, and against the step. The lower left is best; the slope against the step is the order of the scheme.".into(),
        figures: vec![chart("CPU seconds", 2, &[-1.0, -2.0]), chart("step size", 0, &[1.0, 2.0])],
        tables: vec![Grid {
            caption: format!("Error of the end positions at {}, against {reference}.", problem.end),
            head,
            rows,
        }],
    });
    Ok(())
}
