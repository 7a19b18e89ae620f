//! Mass- and stiffness-proportional damping of bodies in whole runs.

use crate::support::{drift, simulation};
use stoss::integrators::SCHEMES;
use stoss::solver::Simulation;

const ELEMENTS: usize = 8;
const YOUNG: f64 = 1000.0;
const DENSITY: f64 = 2.0;

fn scene(scheme: &str, end: f64, step: f64, rest: &str) -> String {
    format!(
        "[scene]\ntitle = \"damping\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = {step:?}\nmax_cuts = 0\n\
         integrator = {{ scheme = \"{scheme}\" }}\n{rest}"
    )
}

/// A bar of unit length along z that is held at `z = 0`, without lateral motion, under an initial velocity `speed z`.
fn bar(scheme: &str, end: f64, step: f64, speed: f64, damping: &str) -> String {
    let rest = format!(
        r#"
[[body]]
name = "bar"
mesh = {{ generator = "block", min = [0, 0, 0], max = [0.1, 0.1, 1], divisions = [1, 1, {ELEMENTS}] }}
material = {{ law = "saint-venant-kirchhoff", young = {YOUNG:?}, poisson = 0.0 }}
density = {DENSITY:?}
damping = {damping}
velocity_gradient = [[0, 0, 0], [0, 0, 0], [0, 0, {speed:?}]]
[[prescribe]]
set = "bar.all"
components = ["x", "y"]
fixed = true
[[prescribe]]
set = "bar.bottom"
components = ["z"]
fixed = true
"#
    );
    scene(scheme, end, step, &rest)
}

/// Angular frequency of the first mode `sin(pi z / 2)` of linear elements with consistent mass: `w^2 = 6 E / (rho h^2) (1 - cos(pi h / 2)) / (2 + cos(pi h / 2))`.
fn frequency() -> f64 {
    let h = 1.0 / ELEMENTS as f64;
    let cosine = (0.5 * std::f64::consts::PI * h).cos();
    (6.0 * YOUNG / (DENSITY * h * h) * (1.0 - cosine) / (2.0 + cosine)).sqrt()
}

/// Coordinate of the first mode, up to a factor: `phi . M u` with `M phi` in proportion to `phi`, half of it at the end.
fn first_mode(simulation: &Simulation, values: &[f64], reference: &[f64]) -> f64 {
    let x = &simulation.model().reference;
    (0..x.len() / 3)
        .filter(|node| x[3 * node] == 0.0 && x[3 * node + 1] == 0.0)
        .map(|node| {
            let (z, u) = (x[3 * node + 2], values[3 * node + 2] - reference[3 * node + 2]);
            let weight = if z == 1.0 { 0.5 } else { 1.0 };
            weight * (0.5 * std::f64::consts::PI * z).sin() * u
        })
        .sum()
}

/// The first mode decays as `e^(-zeta w t) sin(w sqrt(1 - zeta^2) t)` with `zeta = a / (2 w) + b w / 2`.
#[test]
fn first_mode_of_a_bar_decays_as_the_textbooks_say() {
    let w = frequency();
    let period = 2.0 * std::f64::consts::PI / w;
    for (scheme, ratios) in [
        ("energy-momentum", [0.1, 0.0]),
        ("energy-momentum", [0.0, 0.1]),
        ("energy-momentum", [0.05, 0.07]),
        ("trapezoidal", [0.05, 0.07]),
        ("generalised-alpha", [0.05, 0.07]),
    ] {
        let (a, b) = (2.0 * w * ratios[0], 2.0 / w * ratios[1]);
        let damping = format!("{{ mass = {a:?}, stiffness = {b:?} }}");
        let mut simulation = simulation(&bar(scheme, 2.0 * period, period / 150.0, 1e-6 * w, &damping));
        let zeta = ratios[0] + ratios[1];
        let damped = w * (1.0 - zeta * zeta).sqrt();
        let zero = vec![0.0; simulation.state().v.len()];
        let speed = first_mode(&simulation, &simulation.state().v, &zero);
        let mut worst = 0.0_f64;
        while !simulation.finished() {
            simulation.advance().unwrap();
            let t = simulation.state().time;
            let got = first_mode(&simulation, &simulation.state().q, &simulation.model().reference) * w / speed;
            let expected = (-zeta * w * t).exp() * (damped * t).sin() * w / damped;
            worst = worst.max((got - expected).abs());
        }
        assert!(worst < 2e-3, "{scheme} {ratios:?}: off by {worst:e}");
    }
}

fn flight(scheme: &str, end: f64, step: f64, damping: &str) -> String {
    let rest = format!(
        r#"
[[body]]
name = "bar"
mesh = {{ generator = "block", min = [0.3, -0.2, 0.0], max = [1.3, 0.8, 3.0], divisions = [1, 1, 3] }}
material = {{ law = "mooney-rivlin", c1 = 300.0, c2 = 150.0, c = 1000.0 }}
density = 0.1
{damping}
velocity = [1.0, 2.0, -0.5]
angular_velocity = [20.0, 3.0, 10.0]
velocity_gradient = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 15.0]]
"#
    );
    scene(scheme, end, step, &rest)
}

#[test]
fn stiffness_damping_of_a_body_in_flight_keeps_what_the_scheme_keeps() {
    for entry in SCHEMES {
        let claims = entry.with([]).unwrap().claims();
        let mut simulation = simulation(&flight(entry.name, 0.012, 0.0005, "damping = { stiffness = 2e-4 }"));
        let mut l = vec![simulation.balance().linear_momentum];
        let mut j = vec![simulation.balance().angular_momentum];
        let (first, mut energy, mut last) = (*simulation.balance(), 0.0_f64, 0.0);
        while !simulation.finished() {
            let record = simulation.advance().unwrap();
            assert!(record.newton.len() <= 6, "{}: {:?}", entry.name, record.newton);
            let balance = record.balance;
            l.push(balance.linear_momentum);
            j.push(balance.angular_momentum);
            energy = energy.max((balance.total() / first.total() - 1.0).abs());
            assert!(balance.damping >= last && balance.dissipation == balance.damping);
            last = balance.damping;
        }
        assert!(last > 0.005 * first.total(), "{}: {last:e}", entry.name);
        assert!(!claims.linear_momentum || drift(&l) < 1e-11, "{}: linear {:e}", entry.name, drift(&l));
        assert!(!claims.angular_momentum || drift(&j) < 1e-11, "{}: angular {:e}", entry.name, drift(&j));
        assert!(!claims.energy || energy < 1e-12, "{}: energy {energy:e}", entry.name);
    }
}

/// A rigid rotation has no viscous stress: a body that spins as fast as it likes, in its stretched shape of equilibrium, would lose nothing. Here the spin starts without that
/// stretch, and what is left after the vibrations have gone is the energy of the spin.
#[test]
fn what_is_left_of_a_damped_spin_is_a_rigid_spin() {
    let mut simulation = simulation(&flight("energy-momentum", 0.3, 0.005, "damping = { stiffness = 5e-3 }"));
    let before = *simulation.balance();
    let mut losses = vec![0.0];
    while !simulation.finished() {
        losses.push(simulation.advance().unwrap().balance.damping);
    }
    let after = simulation.balance();
    let (all, late) = (losses[losses.len() - 1], losses[losses.len() - 1] - losses[losses.len() - 11]);
    assert!(late < 0.05 * all, "{late:e} of {all:e}");
    assert!((after.total() - before.total()).abs() < 1e-11 * before.total());
    assert!(after.kinetic > 0.3 * before.kinetic);
}

/// `p_(n+1) = p_n (1 - a h / 2) / (1 + a h / 2)` with velocities whose mean is the increment over the step.
#[test]
fn mass_damping_takes_momentum_and_the_ledger_knows_what() {
    let (a, h) = (30.0, 0.001);
    let mut simulation = simulation(&flight("energy-momentum", 0.02, h, "damping = { mass = 30.0 }"));
    let (first, mut expected) = (*simulation.balance(), simulation.balance().linear_momentum);
    while !simulation.finished() {
        let balance = simulation.advance().unwrap().balance;
        for i in 0..3 {
            expected[i] *= (1.0 - 0.5 * a * h) / (1.0 + 0.5 * a * h);
            let error = (balance.linear_momentum[i] - expected[i]).abs();
            assert!(error < 1e-11 * first.linear_momentum[1].abs(), "{error:e}");
        }
        assert!((balance.total() / first.total() - 1.0).abs() < 1e-12);
    }
    assert!(simulation.balance().damping > 0.1 * first.total());
}

fn impact(damping: [&str; 2], time: &str, constraint: &str) -> String {
    format!(
        r#"
[scene]
title = "impact"
kind = "dynamic"
[time]
{time}
[[body]]
name = "lower"
mesh = {{ generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [2, 2, 1] }}
material = {{ law = "neo-hooke", young = 1.0e4, poisson = 0.3 }}
density = 10.0
angular_velocity = [0.3, -0.2, 0.4]
{}
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [0.31, 0.42, 1.02], max = [1.31, 1.42, 2.02], divisions = [1, 1, 1] }}
material = {{ law = "ogden", mu = [6300.0, 12.0, -100.0], alpha = [1.3, 5.0, -2.0], kappa = 5000.0, beta = 9.0 }}
density = 10.0
velocity = [1.0, 0.5, -4.0]
{}
[[contact]]
method = "nts"
slave = "upper.bottom"
master = "lower.top"
constraint = "{constraint}"
"#,
        damping[0], damping[1]
    )
}

#[test]
fn the_ledger_of_a_damped_impact_is_exact() {
    let time = "end = 0.08\nstep = 0.002\nmax_cuts = 0\nintegrator = { scheme = \"energy-momentum\" }";
    let damping = ["damping = { mass = 2.0, stiffness = 1e-3 }", "damping = { stiffness = 4e-3 }"];
    let mut simulation = simulation(&impact(damping, time, "modified"));
    let first = simulation.balance().total();
    let (mut touched, mut worst) = (false, 0.0_f64);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        touched |= record.contact.unwrap().active > 0;
        worst = worst.max((record.balance.total() / first - 1.0).abs());
    }
    assert!(touched && simulation.balance().damping > 0.05 * first);
    assert!(worst < 1e-12, "{worst:e}");
}

/// In a stage of statics nothing has a rate: the same bits with and without damping; and a dynamic stage that follows is damped.
#[test]
fn statics_is_not_damped() {
    let time = "end = 1.2\nstep = 0.1\nintegrator = { scheme = \"energy-momentum\" }";
    let rest = r#"
[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [1, 1, 2] }
material = { law = "neo-hooke", young = 1.0e3, poisson = 0.3 }
density = 1.0
DAMPING
[[prescribe]]
set = "block.bottom"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "block.top"
traction = { table = [[0.0, 0.0, 0.0, 0.0], [1.0, 5.0, 0.0, 50.0]] }
name = "pull"
[[stage]]
name = "load"
kind = "quasi-static"
until = 1.0
[[stage]]
name = "free"
kind = "dynamic"
until = 1.2
step = 0.01
off = ["pull"]
"#;
    let text = |damping: &str| {
        format!("[scene]\ntitle = \"s\"\nkind = \"dynamic\"\n[time]\n{time}\n{}", rest.replace("DAMPING", damping))
    };
    let run = |damping: &str| {
        let scene = stoss::scene::parse(&text(damping), "test.toml").unwrap();
        let mut built = stoss::build::build(&scene, std::path::Path::new(".")).unwrap();
        let mut at_end_of_statics = Vec::new();
        loop {
            while !built.simulation.finished() {
                built.simulation.advance().unwrap();
            }
            if at_end_of_statics.is_empty() {
                at_end_of_statics.clone_from(&built.simulation.state().q);
                assert_eq!(built.simulation.balance().damping, 0.0);
            }
            if !built.schedule.advance(&mut built.simulation).unwrap() {
                return (at_end_of_statics, built.simulation.balance().damping);
            }
        }
    };
    let (damped, loss) = run("damping = { mass = 1.0, stiffness = 1e-3 }");
    let (plain, nothing) = run("");
    assert_eq!(damped, plain);
    assert!(loss > 0.0 && nothing == 0.0);
}
