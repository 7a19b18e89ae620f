//! Work and precision of finite-element bodies: free flight, cantilever, impacts without and with friction.

use crate::verify::curve::{Curve, Point, ProblemCurves, relative_distance, timed};
use crate::workspace::Outcome;
use std::path::Path;
use stoss_integrators::SCHEMES;
use stoss_reference_cases::blocks::falling;

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

/// The two blocks of theory/examples#two-elements, which slide on each other.
const FRICTION: &str = r#"
[[body]]
name = "upper"
mesh = { generator = "block", min = [-0.5, -1.0, 1.01], max = [0.5, 0.0, 2.01], divisions = [1, 1, 1] }
material = { law = "neo-hooke", lambda = 1298.1, mu = 865.3846 }
density = 1000.0
velocity = [0.0, 0.1, -0.04]
[[body]]
name = "lower"
material = { law = "neo-hooke", lambda = 1298.1, mu = 865.3846 }
density = 1000.0
[body.mesh]
generator = "hexahedron"
divisions = [1, 1, 1]
corners = [
    [-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.2, 1.0, 0.0], [-1.5, 1.5, 0.0],
    [-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.2, 1.0, 1.0], [-1.5, 1.5, 1.0],
]
"#;

/// Springs against penetration: the impact takes many steps, and all schemes tend to the same motion.
const SPRINGS: &str = r#"
[[contact]]
method = "nts"
slave = "upper.bottom"
master = "lower.top"
enforcement = { penalty = 1e4 }
friction = { law = "coulomb", mu = 0.5, penalty = 1e4 }
"#;

/// No penetration: what a node does that hits is decided by the scheme, even in the limit of small steps.
const MULTIPLIERS: &str = r#"
[[contact]]
method = "nts"
slave = "upper.bottom"
master = "lower.top"
friction = { law = "coulomb", mu = 0.5, stick = "multiplier" }
"#;

/// What is between the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Touch {
    Nothing,
    Frictionless,
    Friction,
}

struct Setup {
    name: &'static str,
    about: &'static str,
    bodies: String,
    /// Contact of the bodies, if they do not bring it.
    contact: &'static str,
    end: f64,
    /// Steps of the coarsest run.
    coarsest: u64,
    levels: u32,
    /// Steps of the reference over those of the finest run.
    finer: u64,
    touch: Touch,
    /// Scheme of the reference.
    reference: &'static str,
    /// What is compared; empty: every scheme that can.
    rough: &'static [Combination],
    /// Smallest error of the positions that the reference can tell.
    least_target: f64,
}

/// A scheme and the method of its contact.
#[derive(Clone, Copy, Debug)]
struct Combination {
    scheme: &'static str,
    method: &'static str,
}

impl Combination {
    fn name(self) -> String {
        match self.method {
            "nts" => self.scheme.to_owned(),
            method => format!("{} {method}", self.scheme),
        }
    }
}

const fn combination(scheme: &'static str, method: &'static str) -> Combination {
    Combination { scheme, method }
}

/// Schemes that admit friction with normal springs.
const ELASTIC: [Combination; 4] = [
    combination("energy-momentum", "nts"),
    combination("midpoint", "nts"),
    combination("backward-euler", "nts"),
    combination("generalised-alpha", "nts"),
];

/// Schemes and methods that admit friction with multipliers; generalised-alpha gains energy in such impacts.
const EXACT: [Combination; 6] = [
    combination("energy-momentum", "nts"),
    combination("midpoint", "nts"),
    combination("backward-euler", "nts"),
    combination("energy-momentum", "cat"),
    combination("midpoint", "cat"),
    combination("backward-euler", "cat"),
];

/// The five cases.
pub fn cases(quick: bool) -> Outcome<Vec<ProblemCurves>> {
    let fewer = u32::from(quick);
    let smooth = |name: &'static str, about: &'static str, bodies: &str| Setup {
        name,
        about,
        bodies: bodies.into(),
        contact: "",
        end: 0.016,
        coarsest: 4,
        levels: 8,
        finer: if quick { 4 } else { 8 },
        touch: Touch::Nothing,
        reference: "energy-momentum",
        rough: &[],
        least_target: 1e-4,
    };
    let setups = [
        smooth("free flight", "Spinning and stretching neo-Hooke bar of 4 hex8", FLIGHT),
        smooth("cantilever", "Clamped Mooney-Rivlin bar of 4 hex8, swung to one side", CANTILEVER),
        Setup {
            name: "impact",
            about: "Block on a larger block, frictionless; an impact is not smooth, so that no scheme keeps its order",
            bodies: falling([1.0, 1.0, -4.0]),
            contact: "",
            end: 0.02,
            coarsest: 10,
            levels: 9 - 3 * fewer,
            finer: 8,
            touch: Touch::Frictionless,
            reference: "energy-momentum",
            rough: &[],
            least_target: if quick { 1e-2 } else { 1e-3 },
        },
        Setup {
            name: "frictional impact",
            about: "The two blocks of the thesis slide on each other with mu = 0.5; normal springs, so that there is one limit",
            bodies: FRICTION.into(),
            contact: SPRINGS,
            end: 4.0,
            coarsest: 20,
            levels: 8 - 3 * fewer,
            finer: 4,
            touch: Touch::Friction,
            reference: "energy-momentum",
            rough: &ELASTIC,
            least_target: if quick { 1e-2 } else { 1e-3 },
        },
        Setup {
            name: "frictional impact, multipliers",
            about: "The same without penetration, direct and by coordinate augmentation (cat); nodes that hit come to rest with \
                    backward Euler and bounce with the others, also in the limit of small steps, so that their errors level off",
            bodies: FRICTION.into(),
            contact: MULTIPLIERS,
            end: 4.0,
            coarsest: 20,
            levels: 7 - 3 * fewer,
            finer: 4,
            touch: Touch::Friction,
            reference: "backward-euler",
            rough: &EXACT,
            // There is no common limit to measure smaller errors against.
            least_target: 1e-1,
        },
    ];
    setups.iter().map(case).collect()
}

/// What is compared of a run.
struct Ended {
    /// Displacements.
    q: Vec<f64>,
    /// Energy that friction has dissipated.
    dissipated: f64,
    /// Linear solves.
    solves: u64,
}

/// A scene run in memory without step cuts.
fn run(setup: &Setup, Combination { scheme, method }: Combination, steps: u64) -> Result<Ended, String> {
    let dt = setup.end / steps as f64;
    let contact = setup.contact.replace("method = \"nts\"", &format!("method = \"{method}\""));
    let bodies = &setup.bodies;
    let text = format!(
        "[scene]\ntitle = \"{}\"\nkind = \"dynamic\"\n[time]\nend = {:?}\nstep = {dt:?}\nmax_cuts = 0\nintegrator = {{ scheme = \"{scheme}\" }}\n{bodies}{contact}",
        setup.name, setup.end
    );
    let scene = stoss_scene::parse(&text, setup.name).map_err(|error| error.to_string())?;
    let mut simulation = stoss::build::build(&scene, Path::new(".")).map_err(|error| error.to_string())?.simulation;
    let start = simulation.state().q.clone();
    while !simulation.finished() {
        simulation.advance().map_err(|error| error.to_string())?;
    }
    let q: Vec<f64> = simulation.state().q.iter().zip(&start).map(|(q, start)| q - start).collect();
    let dissipated = simulation.balance().dissipation;
    if q.iter().any(|x| !x.is_finite()) || !dissipated.is_finite() {
        return Err("displacements or energies are not finite".into());
    }
    Ok(Ended { q, dissipated, solves: simulation.solves() })
}

/// Every combination that can do the case.
fn combinations(setup: &Setup) -> Outcome<Vec<Combination>> {
    if !setup.rough.is_empty() {
        return Ok(setup.rough.into());
    }
    let mut all = Vec::new();
    for entry in SCHEMES {
        if setup.touch == Touch::Nothing || entry.with([])?.claims().constraints {
            all.push(combination(entry.name, "nts"));
        }
    }
    Ok(all)
}

fn case(setup: &Setup) -> Outcome<ProblemCurves> {
    let finest = setup.coarsest << (setup.levels - 1);
    let reference_steps = setup.finer * finest;
    let scheme = combination(setup.reference, "nts");
    let fine = |part: u64| run(setup, scheme, reference_steps / part);
    let (half, last) = (fine(2)?, fine(1)?);
    let smooth = setup.touch == Touch::Nothing;
    // Without contact the scheme is of second order, and two runs extrapolate; the difference to the extrapolation of coarser ones is the error.
    let extrapolate = |coarse: &[f64], fine: &[f64]| -> Vec<f64> {
        fine.iter().zip(coarse).map(|(f, c)| f + (f - c) / 3.0).collect()
    };
    let (reference, coarser) = if smooth {
        (extrapolate(&half.q, &last.q), extrapolate(&fine(4)?.q, &half.q))
    } else {
        (last.q.clone(), half.q)
    };
    let dissipated = (setup.touch == Touch::Friction).then_some(last.dissipated);
    let mut curves = Vec::new();
    for combination in combinations(setup)? {
        let order = stoss_integrators::scheme(combination.scheme)?.claims().order;
        let mut curve = Curve { scheme: combination.name(), ..Curve::default() };
        for level in 0..setup.levels {
            let steps = setup.coarsest << level;
            let dt = setup.end / steps as f64;
            match timed(|| run(setup, combination, steps)) {
                Ok((ended, seconds)) => {
                    let error = relative_distance(&ended.q, &reference);
                    let of_dissipation = dissipated.map(|exact| (ended.dissipated / exact - 1.0).abs());
                    // Every solve follows an evaluation, and every step ends with one.
                    let evaluations = ended.solves + steps;
                    curve.points.push(Point { dt, error, of_dissipation, seconds, evaluations });
                }
                Err(error) => curve.failures.push(format!("from {dt:.1e}: {error}")),
            }
        }
        curve.failures = curve.failures.pop().into_iter().collect();
        // All levels are run in quick mode too: the asymptotic range begins with the last ones.
        curve.checked_order = smooth.then_some(f64::from(order));
        curves.push(curve);
    }
    Ok(ProblemCurves {
        name: setup.name.into(),
        about: format!("{}, relative error of all displacements at T = {}", setup.about, setup.end),
        reference: format!(
            "{} with steps of {:.1e}{}",
            setup.reference,
            setup.end / reference_steps as f64,
            if smooth { ", extrapolated" } else { "" }
        ),
        reference_error: relative_distance(&coarser, &reference),
        dissipation_error: dissipated.map(|exact| (half.dissipated / exact - 1.0).abs()),
        least_target: setup.least_target,
        figure: None,
        curves,
    })
}
