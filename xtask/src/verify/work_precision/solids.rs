//! Work and precision of finite-element bodies: free flight, cantilever, frictionless impact.

use super::curve::{Case, Curve, Point, relative_distance, timed};
use crate::workspace::Outcome;
use std::path::Path;
use stoss_integrators::SCHEMES;

/// A bar that spins and stretches.
const FLIGHT: &str = r#"
[[body]]
name = "bar"
mesh = { generator = "block", size = [1.0, 1.0, 4.0], divisions = [1, 1, 4] }
material = { law = "neo-hooke", young = 2250.0, poisson = 0.3 }
density = 0.1
angular_velocity = [30.0, 0.0, 10.0]
velocity_gradient = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 20.0]]
"#;

/// A bar clamped at one end, with a transverse velocity.
const CANTILEVER: &str = r#"
[[body]]
name = "bar"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 4], divisions = [1, 1, 4] }
material = { law = "mooney-rivlin", c1 = 300.0, c2 = 150.0, c = 1000.0 }
density = 0.1
velocity_gradient = [[0.0, 0.0, 15.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
[[prescribe]]
set = "bar.bottom"
components = ["x", "y", "z"]
displacement = [0.0, 0.0, 0.0]
"#;

/// A block that hits a larger one.
const IMPACT: &str = r#"
[[body]]
name = "lower"
mesh = { generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [2, 2, 1] }
material = { law = "neo-hooke", young = 1.0e6, poisson = 0.3 }
density = 1000.0
[[body]]
name = "upper"
mesh = { generator = "block", min = [0.3, 0.4, 1.02], max = [1.3, 1.4, 2.02], divisions = [1, 1, 1] }
material = { law = "neo-hooke", young = 1.0e6, poisson = 0.3 }
density = 1000.0
velocity = [1.0, 1.0, -4.0]
[[contact]]
method = "nts"
slave = "upper.bottom"
master = "lower.top"
constraint = "standard"
"#;

struct Setup {
    name: &'static str,
    about: &'static str,
    bodies: &'static str,
    end: f64,
    /// Steps of the coarsest run.
    coarsest: u64,
    levels: u32,
    /// Steps of the reference over those of the finest run.
    finer: u64,
    contact: bool,
}

/// The three cases.
pub fn cases(quick: bool) -> Outcome<Vec<Case>> {
    let fewer = u32::from(quick);
    let setups = [
        Setup {
            name: "free flight",
            about: "Spinning and stretching neo-Hooke bar of 4 hex8",
            bodies: FLIGHT,
            end: 0.016,
            coarsest: 4,
            levels: 8 - 2 * fewer,
            finer: 8,
            contact: false,
        },
        Setup {
            name: "cantilever",
            about: "Clamped Mooney-Rivlin bar of 4 hex8, swung to one side",
            bodies: CANTILEVER,
            end: 0.016,
            coarsest: 4,
            levels: 8 - 2 * fewer,
            finer: 8,
            contact: false,
        },
        Setup {
            name: "impact",
            about: "Block on a larger block, frictionless; an impact is not smooth, so that no scheme keeps its order",
            bodies: IMPACT,
            end: 0.02,
            coarsest: 10,
            levels: 9 - 3 * fewer,
            finer: 8,
            contact: true,
        },
    ];
    setups.iter().map(case).collect()
}

/// Displacements at the end, and linear solves, of a scene run in memory without step cuts.
fn run(setup: &Setup, scheme: &str, steps: u64) -> Result<(Vec<f64>, u64), String> {
    let dt = setup.end / steps as f64;
    let text = format!(
        "[scene]\ntitle = \"{}\"\nkind = \"dynamic\"\n[time]\nend = {:?}\nstep = {dt:?}\nmax_cuts = 0\nintegrator = {{ scheme = \"{scheme}\" }}\n{}",
        setup.name, setup.end, setup.bodies
    );
    let scene = stoss_scene::parse(&text, setup.name).map_err(|error| error.to_string())?;
    let mut simulation = stoss::build::build(&scene, Path::new(".")).map_err(|error| error.to_string())?.simulation;
    let start = simulation.state().q.clone();
    while !simulation.finished() {
        simulation.advance().map_err(|error| error.to_string())?;
    }
    let q: Vec<f64> = simulation.state().q.iter().zip(&start).map(|(q, start)| q - start).collect();
    if q.iter().any(|x| !x.is_finite()) {
        return Err("displacements are not finite".into());
    }
    Ok((q, simulation.solves()))
}

fn case(setup: &Setup) -> Outcome<Case> {
    let finest = setup.coarsest << (setup.levels - 1);
    let reference_steps = setup.finer * finest;
    let fine = |part: u64| run(setup, "energy-momentum", reference_steps / part).map(|(q, _)| q);
    let (quarter, half, last) = (fine(4)?, fine(2)?, fine(1)?);
    // Without contact the scheme is of second order, and two runs extrapolate; the difference to the extrapolation of coarser ones is the error.
    let extrapolate = |coarse: &[f64], fine: &[f64]| -> Vec<f64> {
        fine.iter().zip(coarse).map(|(f, c)| f + (f - c) / 3.0).collect()
    };
    let (reference, coarser) =
        if setup.contact { (last, half) } else { (extrapolate(&half, &last), extrapolate(&quarter, &half)) };
    let mut curves = Vec::new();
    for entry in SCHEMES {
        let scheme = entry.with([])?;
        if setup.contact && !scheme.claims().constraints {
            continue;
        }
        let order = scheme.claims().order;
        let mut curve = Curve { scheme: entry.name.into(), ..Curve::default() };
        for level in 0..setup.levels {
            let steps = setup.coarsest << level;
            let dt = setup.end / steps as f64;
            match timed(|| run(setup, entry.name, steps)) {
                Ok(((q, solves), seconds)) => {
                    let error = relative_distance(&q, &reference);
                    // Every solve follows an evaluation, and every step ends with one.
                    curve.points.push(Point { dt, error, seconds, evaluations: solves + steps });
                }
                Err(error) => curve.failures.push(format!("from {dt:.1e}: {error}")),
            }
        }
        curve.failures = curve.failures.pop().into_iter().collect();
        // Where the asymptotic range is reached.
        let asymptotic = !setup.contact && setup.levels > 7;
        curve.checked_order = asymptotic.then_some(f64::from(order));
        curves.push(curve);
    }
    Ok(Case {
        name: setup.name.into(),
        about: format!("{}, relative error of all displacements at T = {}", setup.about, setup.end),
        reference: format!(
            "energy-momentum with steps of {:.1e}{}",
            setup.end / reference_steps as f64,
            if setup.contact { "" } else { ", extrapolated" }
        ),
        reference_error: relative_distance(&coarser, &reference),
        least_target: if !setup.contact {
            1e-4
        } else if setup.levels < 8 {
            1e-2
        } else {
            1e-3
        },
        figure: None,
        curves,
    })
}
