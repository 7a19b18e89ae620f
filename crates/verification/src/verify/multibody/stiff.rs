//! Extremes: masses, stiffnesses and step sizes over many decades.

use super::build::{AXES, add_body, add_constraint, add_joint, add_vectors, dynamic, fix};
use super::{ENERGY, MOMENTUM, noted};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::larger;
use crate::verify::report::{Grid, ReportSection};
use crate::workspace::Outcome;
use stoss_multibody::{
    CoordinateOptions, ElasticString, Embedded, JointKind, PointMass, RigidMass, Spring, SpringData, StringMaterial,
};
use stoss_solver::{Balance, Model, Simulation};

/// What became of a run.
struct Ended {
    /// Drifts of momenta, linear and angular together, and of the energy, over their sizes.
    drift: [f64; 2],
    steps: u64,
    iterations: u32,
    stop: Option<String>,
}

/// Size of momenta and energy: what the parts have, not what is left of their sum.
#[derive(Clone, Copy)]
struct Sizes {
    linear: f64,
    angular: f64,
    energy: f64,
}

fn run(mut simulation: Simulation, sizes: Sizes) -> Ended {
    let first = *simulation.balance();
    let mut ended = Ended { drift: [0.0; 2], steps: 0, iterations: 0, stop: None };
    let of = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, larger);
    while !simulation.finished() {
        match simulation.advance() {
            Ok(record) => {
                let now: Balance = record.balance;
                let linear = of(now.linear_momentum, first.linear_momentum) / sizes.linear;
                let angular = of(now.angular_momentum, first.angular_momentum) / sizes.angular;
                ended.drift[0] = larger(ended.drift[0], larger(linear, angular));
                ended.drift[1] = larger(ended.drift[1], (now.total() - first.total()).abs() / sizes.energy);
                ended.steps += 1;
                ended.iterations = ended.iterations.max(record.iterations);
            }
            Err(error) => {
                ended.stop = Some(error.to_string());
                break;
            }
        }
    }
    ended
}

/// Measures all stiff systems.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let steps = if quick { 20.0 } else { 200.0 };
    let mut rows = Vec::new();
    for ratio in [1.0, 1e2, 1e4, 1e6] {
        let (simulation, sizes) = joined(ratio, 0.01, steps)?;
        judge(
            findings,
            &mut rows,
            "two bodies on a ball joint",
            format!("mass ratio {ratio:.0e}"),
            run(simulation, sizes),
        );
    }
    for part in 0..5 {
        let dt = 1e-4 * 10f64.powi(part);
        let (simulation, sizes) = joined(10.0, dt, steps)?;
        judge(
            findings,
            &mut rows,
            "two bodies on a ball joint",
            format!("step {dt:.0e}, spins of 2 and 3"),
            run(simulation, sizes),
        );
    }
    for part in 0..9 {
        let stiffness = 10f64.powi(part);
        let (simulation, sizes) = masses(stiffness, 0.01, steps)?;
        judge(
            findings,
            &mut rows,
            "spring between two masses",
            format!("stiffness {stiffness:.0e}"),
            run(simulation, sizes),
        );
    }
    for part in 0..9 {
        let stiffness = 10f64.powi(part);
        let (simulation, sizes) = rope(stiffness, 0.005, steps)?;
        judge(findings, &mut rows, "rope that swings", format!("EA {stiffness:.0e}"), run(simulation, sizes));
    }
    for part in 0..5 {
        let dt = 1e-4 * 10f64.powi(part);
        let (simulation, sizes) = masses(1e4, dt, steps)?;
        judge(
            findings,
            &mut rows,
            "spring between two masses",
            format!("step {dt:.0e}, stiffness 1e4"),
            run(simulation, sizes),
        );
    }
    let head = ["case", "parameter", "steps", "iterations", "momenta", "energy", "verdict"].map(str::to_owned).to_vec();
    let caption =
        format!("{steps} steps of the energy-momentum scheme without cuts: exact, or a stop that is reported.");
    findings.sections.push(ReportSection {
        title: "multibody extremes".into(),
            reading: "Stiffness, mass and speed over many orders of magnitude at a fixed step. A run must keep momenta and energy to round-off, or stop with an error that names the reason; nothing else is accepted.".into(),
        figures: Vec::new(),
        tables: vec![Grid { caption, head, rows }],
    });
    Ok(())
}

/// A run that ends keeps what the scheme promises; one that stops is reported with its reason.
fn judge(findings: &mut Findings, rows: &mut Vec<Vec<String>>, case: &str, parameter: String, ended: Ended) {
    let exact = ended.drift[0] <= MOMENTUM && ended.drift[1] <= ENERGY;
    let verdict = match &ended.stop {
        None if exact => "exact".to_owned(),
        None => "drifts".to_owned(),
        Some(why) => format!("stops: {why}"),
    };
    let note = format!("{} steps, {} iterations at most", ended.steps, ended.iterations);
    if let Some(why) = &ended.stop {
        let reached = ended.steps as f64;
        noted(
            findings,
            case,
            &format!("{parameter}: steps until the stop that is reported"),
            reached,
            Bound::Unbounded,
            why.clone(),
        );
    }
    // Also the steps before a stop are exact.
    noted(
        findings,
        case,
        &format!("{parameter}: drift of momenta"),
        ended.drift[0],
        Bound::AtMost(MOMENTUM),
        note.clone(),
    );
    noted(findings, case, &format!("{parameter}: drift of the energy"), ended.drift[1], Bound::AtMost(ENERGY), note);
    rows.push(vec![
        case.into(),
        parameter,
        ended.steps.to_string(),
        ended.iterations.to_string(),
        format!("{:.1e}", ended.drift[0]),
        format!("{:.1e}", ended.drift[1]),
        verdict,
    ]);
}

/// A light body on a heavy one, both with a spin, in free flight.
fn joined(ratio: f64, dt: f64, steps: f64) -> Outcome<(Simulation, Sizes)> {
    let mut model = Model::default();
    let mass = |m: f64, centre| RigidMass::new(m, centre, [0.05 * m, 0.03 * m, 0.02 * m], AXES);
    let at = [0.5, 0.1, 0.0];
    let heavy = add_body(&mut model, "heavy", mass(ratio, [0.0; 3])?, at, [0.2, 2.0, 1.0]);
    let light = add_body(&mut model, "light", mass(1.0, [1.0, 0.2, 0.3])?, at, [-3.0, 0.5, 1.0]);
    let sides = [&heavy.frame(at, AXES), &light.frame(at, AXES)];
    add_joint(&mut model, "ball", JointKind::Ball, sides, CoordinateOptions::default())?;
    let simulation = dynamic(model, dt, dt * steps)?;
    let energy = simulation.balance().kinetic;
    // Speeds and lengths are about one.
    Ok((simulation, Sizes { linear: ratio, angular: ratio, energy }))
}

/// Two masses on a spring, which turn about each other and stretch it.
fn masses(stiffness: f64, dt: f64, steps: f64) -> Outcome<(Simulation, Sizes)> {
    let data = SpringData { stiffness, rest_length: 1.0, tension_only: false, damping: 0.0 };
    let spring = Spring::new("spring", [Embedded::vector(0), Embedded::vector(1)], data)?;
    let mut model = Model::default();
    add_vectors(&mut model, &[[0.0; 3], [1.02, 0.0, 0.0]], &[[0.1, -1.0, 0.0], [0.0, 1.0, 0.5]]);
    for (vector, mass) in [(0, 1.0), (1, 2.0)] {
        model.parts.push(Box::new(PointMass::new("mass", vector, mass, 1.0)?));
    }
    model.parts.push(Box::new(spring));
    let simulation = dynamic(model, dt, dt * steps)?;
    let energy = simulation.balance().kinetic + simulation.balance().strain;
    // Momenta are as large as the forces that made them: the spring's impulse of a vibration is sqrt(2 m E).
    let size = (2.0 * 2.0 * energy).sqrt();
    Ok((simulation, Sizes { linear: size, angular: size, energy }))
}

/// A rope from a support with a mass at its end that swings around; only the vertical angular momentum stays, and that is in the row of the energy's fellow.
fn rope(stiffness: f64, dt: f64, steps: f64) -> Outcome<(Simulation, Sizes)> {
    let nodes = ElasticString::straight_nodes([0.0; 3], [1.0, 0.0, 0.0], 4, 2)?;
    let material = StringMaterial { stiffness, mass: 0.1, lumped: false, tension_only: false };
    let string = ElasticString::new("rope", 0, 2, nodes, material, 1.0)?;
    let last = string.node_count() - 1;
    let velocity = string.rigid_velocity([0.0; 3], [0.0, -0.3, 1.0], [0.0; 3]);
    let mut model = Model::default();
    add_vectors(&mut model, string.reference(), &velocity);
    add_vectors(&mut model, &[string.reference()[last]], &[velocity[last]]);
    fix(&mut model, &[0]);
    let bob = PointMass::new("bob", last as u32 + 1, 1.0, 1.0)?;
    add_constraint(&mut model, "hook", super::strings::hook(&string.point(last), &bob.position()));
    model.parts.push(Box::new(string));
    model.parts.push(Box::new(bob));
    let simulation = dynamic(model, dt, dt * steps)?;
    let energy = simulation.balance().kinetic;
    // The support takes linear momentum; about it, at the origin, angular momentum stays.
    Ok((simulation, Sizes { linear: f64::INFINITY, angular: 1.0, energy }))
}
