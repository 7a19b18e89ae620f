//! Every scheme on finite elements: its claims in free flight, and contact with those that carry it.

use crate::support::{drift, simulation};
use stoss::integrators::SCHEMES;
use stoss::solver::Simulation;

fn scene(scheme: &str, end: f64, step: f64, rest: &str) -> String {
    format!(
        r#"
[scene]
title = "schemes"
kind = "dynamic"
[time]
end = {end:?}
step = {step:?}
max_cuts = 0
integrator = {{ scheme = "{scheme}" }}
{rest}
"#
    )
}

const FLIGHT: &str = r#"
[[body]]
name = "bar"
mesh = { generator = "block", min = [0.3, -0.2, 0.0], max = [1.3, 0.8, 3.0], divisions = [1, 1, 3] }
material = { law = "mooney-rivlin", c1 = 300.0, c2 = 150.0, c = 1000.0 }
density = 0.1
velocity = [1.0, 2.0, -0.5]
angular_velocity = [20.0, 3.0, 10.0]
velocity_gradient = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 15.0]]
"#;

const IMPACT: &str = r#"
[[body]]
name = "lower"
mesh = { generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [2, 2, 1] }
material = { law = "neo-hooke", young = 1.0e4, poisson = 0.3 }
density = 10.0
[[body]]
name = "upper"
mesh = { generator = "block", min = [0.31, 0.42, 1.02], max = [1.31, 1.42, 2.02], divisions = [1, 1, 1] }
material = { law = "neo-hooke", young = 1.0e4, poisson = 0.3 }
density = 10.0
velocity = [1.0, 0.5, -4.0]
[[contact]]
method = "nts"
slave = "upper.bottom"
master = "lower.top"
constraint = "modified"
"#;

/// Drifts of linear momentum, angular momentum and energy over the whole run.
fn run(mut simulation: Simulation) -> [f64; 3] {
    let mut l = vec![simulation.balance().linear_momentum];
    let mut j = vec![simulation.balance().angular_momentum];
    let (start, mut energy) = (simulation.balance().total(), 0.0_f64);
    while !simulation.finished() {
        let balance = simulation.advance().unwrap_or_else(|error| panic!("{error}")).balance;
        l.push(balance.linear_momentum);
        j.push(balance.angular_momentum);
        energy = energy.max((balance.total() / start - 1.0).abs());
    }
    [drift(&l), drift(&j), energy]
}

#[test]
fn flight_conserves_what_is_claimed_and_nothing_else() {
    for entry in SCHEMES {
        let claims = entry.with([]).unwrap().claims();
        let [l, j, energy] = run(simulation(&scene(entry.name, 0.012, 0.0005, FLIGHT)));
        for (what, value, claimed) in [
            ("linear momentum", l, claims.linear_momentum),
            ("angular momentum", j, claims.angular_momentum),
            ("energy", energy, claims.energy),
        ] {
            if claimed {
                assert!(value < 1e-11, "{}: {what} drifts by {value:e}", entry.name);
            } else {
                assert!(value > 1e-7, "{}: {what} is conserved ({value:e}) although not claimed", entry.name);
            }
        }
    }
}

#[test]
fn impact_keeps_the_momenta_that_are_claimed() {
    for entry in SCHEMES {
        let claims = entry.with([]).unwrap().claims();
        if !claims.constraints {
            continue;
        }
        let [l, j, energy] = run(simulation(&scene(entry.name, 0.03, 0.0005, IMPACT)));
        assert!(l < 1e-11, "{}: linear momentum drifts by {l:e}", entry.name);
        if claims.angular_momentum {
            assert!(j < 1e-11, "{}: angular momentum drifts by {j:e}", entry.name);
        }
        if claims.energy {
            assert!(energy < 1e-11, "{}: energy drifts by {energy:e}", entry.name);
        }
    }
}

#[test]
fn explicit_steps_with_contact_are_refused_with_a_remedy() {
    let text = scene("forward-euler", 0.01, 0.001, IMPACT);
    let scene = stoss::scene::parse(&text, "test.toml").unwrap();
    let error = stoss::build::build(&scene, std::path::Path::new(".")).unwrap_err().to_string();
    assert!(error.contains("time.integrator.scheme") && error.contains("constraints"), "{error}");
}

/// A load that is switched on at once, with supports: the schemes agree as the step shrinks, those with history and updates of momenta
/// included.
#[test]
fn supported_and_loaded_bodies_agree_between_schemes() {
    let rest = r#"
[[body]]
name = "bar"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 3], divisions = [1, 1, 3] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
density = 1.0
[[prescribe]]
set = "bar.bottom"
components = ["x", "y", "z"]
displacement = { table = [[0.0, 0.0, 0.0, 0.0], [0.1, 0.05, 0.0, 0.0]] }
[[load]]
set = "bar.top"
traction = { table = [[0.0, 0.0, 20.0, 0.0], [0.1, 0.0, 30.0, 10.0]] }
"#;
    let end = |scheme: &str, step: f64| {
        let mut simulation = simulation(&scene(scheme, 0.1, step, rest));
        while !simulation.finished() {
            simulation.advance().unwrap_or_else(|error| panic!("{scheme}: {error}"));
        }
        let reference = simulation.model().reference.clone();
        simulation.state().q.iter().zip(&reference).map(|(q, x)| q - x).collect::<Vec<f64>>()
    };
    let reference = end("energy-momentum", 0.1 / 1024.0);
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    for entry in SCHEMES {
        let order = f64::from(entry.with([]).unwrap().claims().order);
        let error = |step: f64| {
            let u = end(entry.name, step);
            norm(&u.iter().zip(&reference).map(|(a, b)| a - b).collect::<Vec<_>>()) / norm(&reference)
        };
        let (coarse, fine) = (error(0.1 / 128.0), error(0.1 / 256.0));
        let observed = (coarse / fine).log2();
        assert!(fine < 2e-2, "{}: error {fine:e}", entry.name);
        assert!(observed > 0.8 * order, "{}: order {observed} with prescribed motion and loads", entry.name);
    }
}
