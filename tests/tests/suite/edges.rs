//! Blocks that slide over concave and convex edges of a rigid master surface: what energy, penetration and friction do there.

use crate::support::simulation_in;
use stoss::solver::StepRecord;

/// A strip of hexahedra under the surface `z = profile(x)`, as an Abaqus input file with the surface `TOP`.
fn strip(profile: impl Fn(f64) -> f64, from: f64, count: usize) -> String {
    const Y: [f64; 4] = [-1.0, -0.3, 0.3, 1.0];
    const LENGTH: f64 = 0.5;
    let mut text = String::from("*NODE\n");
    let id = |i: usize, j: usize, k: usize| 1 + i + (count + 1) * (j + Y.len() * k);
    for k in 0..2 {
        for (j, y) in Y.iter().enumerate() {
            for i in 0..=count {
                let x = from + LENGTH * i as f64;
                text += &format!("{}, {x:?}, {y:?}, {:?}\n", id(i, j, k), profile(x) + k as f64 - 1.0);
            }
        }
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=ALL\n";
    for j in 0..Y.len() - 1 {
        for i in 0..count {
            let quad = |k| [id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k)];
            let nodes: Vec<String> = quad(0).iter().chain(&quad(1)).map(usize::to_string).collect();
            text += &format!("{}, {}\n", 1 + i + count * j, nodes.join(", "));
        }
    }
    text + "*SURFACE, NAME=TOP, TYPE=ELEMENT\nALL, S2\n"
}

/// What a run over the strip came to, energies over the largest kinetic energy.
struct Slid {
    /// Largest rise of kinetic, strain and potential energy in a step.
    gain: f64,
    /// Smallest gap.
    deepest: f64,
    /// Facets that nodes changed to.
    crossings: usize,
    /// Least dissipation of a step.
    least: f64,
    /// Least work of the friction in a step.
    least_work: f64,
    /// Largest pressure.
    pressure: f64,
}

struct Run<'a> {
    strip: &'a str,
    scheme: &'a str,
    step: f64,
    end: f64,
    position: [f64; 3],
    velocity: [f64; 3],
    divisions: [usize; 3],
    friction: &'a str,
}

const WEIGHT: f64 = 20.0;

fn slide(run: &Run<'_>) -> Slid {
    let Run { strip, scheme, step, end, position, velocity, divisions, friction } = run;
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("strip.inp"), strip).unwrap();
    let text = format!(
        r#"
[scene]
title = "edges"
kind = "dynamic"
[time]
end = {end:?}
step = {step:?}
integrator = {{ scheme = "{scheme}" }}
[[body]]
name = "strip"
mesh = {{ file = "strip.inp" }}
material = {{ law = "neo-hooke", young = 1e4, poisson = 0.3 }}
density = 1.0
[[body]]
name = "block"
mesh = {{ generator = "block", size = [0.4, 0.4, 0.4], divisions = {divisions:?} }}
position = {position:?}
velocity = {velocity:?}
material = {{ law = "neo-hooke", young = 1e4, poisson = 0.3 }}
density = 2.0
[[prescribe]]
set = "strip.all"
components = ["x", "y", "z"]
fixed = true
[[load]]
body = "block"
body_force = [0, 0, {}]
[[contact]]
method = "nts"
slave = "block.boundary"
master = "strip.TOP"
{friction}
"#,
        -WEIGHT
    );
    let mut s = simulation_in(&text, folder.path());
    let mut records: Vec<StepRecord> = vec![s.initial_record()];
    while !s.finished() {
        records.push(s.advance().unwrap());
    }
    let energy = |r: &StepRecord| r.balance.kinetic + r.balance.strain + r.balance.contact + r.balance.potential;
    let kinetic = records.iter().map(|r| r.balance.kinetic).fold(0.0, f64::max);
    let contact = || records.iter().filter_map(|r| r.contact.as_ref());
    Slid {
        gain: records.windows(2).map(|w| (energy(&w[1]) - energy(&w[0])) / kinetic).fold(f64::MIN, f64::max),
        deepest: contact().map(|c| c.min_gap).fold(0.0, f64::min),
        crossings: contact().map(|c| c.repaired).sum(),
        least: records
            .windows(2)
            .map(|w| (w[1].balance.dissipation - w[0].balance.dissipation) / kinetic)
            .fold(0.0, f64::min),
        least_work: records
            .windows(2)
            .map(|w| (w[1].balance.friction_work - w[0].balance.friction_work) / kinetic)
            .fold(0.0, f64::min),
        pressure: contact().map(|c| c.max_pressure).fold(0.0, f64::max),
    }
}

/// Into the bottom of a valley with slopes of 0.6: nodes that went over the edge keep a gap behind the surface for a while, are released there, and
/// come back; the surface does not throw them out.
#[test]
fn a_valley_gives_no_energy() {
    let valley = strip(|x| 0.6 * x.abs() - 1.0, -4.0, 16);
    for friction in [
        "",
        r#"friction = { law = "coulomb", mu = 0.3 }"#,
        r#"friction = { law = "coulomb", mu = 0.3, penalty = 1e4 }"#,
    ] {
        let slid = slide(&Run {
            strip: &valley,
            scheme: "energy-momentum",
            step: 0.02,
            end: 1.2,
            position: [-1.2, 0.03, 1.15 - 1.0],
            velocity: [1.0, 0.1, -0.6],
            divisions: [2, 1, 1],
            friction,
        });
        println!(
            "valley {friction}: gain {:.1e}, deepest {:.3}, crossings {}",
            slid.gain, slid.deepest, slid.crossings
        );
        assert!(slid.crossings > 0 && slid.gain < 1e-12 && slid.least >= -1e-14);
        assert!(slid.deepest > -0.08, "{}", slid.deepest);
    }
}

/// Along a floor into a wall with a slope of 4: the nodes go over the edge without work, so that others penetrate by the motion of a step or
/// two; no step is stopped by an active set that cycles.
#[test]
fn a_wall_stops_a_block() {
    let wall = strip(|x| 4.0 * x.max(0.0), -2.0, 6);
    for (scheme, gain) in [("energy-momentum", 1e-12), ("backward-euler", 2e-3)] {
        for step in [0.02, 0.005] {
            for mu in [0.0, 0.1, 0.3] {
                let friction = format!("friction = {{ law = \"coulomb\", mu = {mu:?} }}");
                let slid = slide(&Run {
                    strip: &wall,
                    scheme,
                    step,
                    end: 0.6,
                    position: [-1.0, 0.03, 0.2],
                    velocity: [4.0, 0.0, 0.0],
                    divisions: [2, 2, 1],
                    friction: &friction,
                });
                println!("wall {scheme} {step} {mu}: gain {:.1e}, deepest {:.3}", slid.gain, slid.deepest);
                assert!(slid.gain < gain && slid.least >= -1e-14, "{} {}", slid.gain, slid.least);
                assert!(slid.deepest > -2.0 * 4.0 * step, "{}", slid.deepest);
            }
        }
    }
}

/// Over a ridge and down its other side.
#[test]
fn a_ridge_gives_no_energy() {
    let ridge = strip(|x| -0.6 * x.abs(), -4.0, 16);
    for friction in ["", r#"friction = { law = "coulomb", mu = 0.3 }"#] {
        let slid = slide(&Run {
            strip: &ridge,
            scheme: "energy-momentum",
            step: 0.02,
            end: 1.0,
            position: [-1.0, 0.03, 0.05],
            velocity: [3.0, 0.1, 0.0],
            divisions: [2, 2, 1],
            friction,
        });
        println!("ridge {friction}: gain {:.1e}, deepest {:.3}, crossings {}", slid.gain, slid.deepest, slid.crossings);
        assert!(slid.gain < 1e-12 && slid.least >= -1e-14, "{} {}", slid.gain, slid.least);
    }
}

/// A block with more nodes and friction: nodes go up the wall while the middle of their path projects on the floor.
#[test]
fn pressures_at_a_wall_are_determined() {
    let wall = strip(|x| 4.0 * x.max(0.0), -4.0, 12);
    for mu in [0.25, 0.3, 0.31] {
        let slid = slide(&Run {
            strip: &wall,
            scheme: "energy-momentum",
            step: 0.01,
            end: 0.4,
            position: [-1.0, 0.03, 0.201],
            velocity: [4.0, 0.0, -0.1],
            divisions: [2, 2, 2],
            friction: &format!("friction = {{ law = \"coulomb\", mu = {mu} }}"),
        });
        println!("wall, mu {mu}: gain {:.1e}, pressure {:.1e}", slid.gain, slid.pressure);
        assert!(slid.gain < 1e-13 && slid.least == 0.0, "mu {mu}: gain {:e}, least {:e}", slid.gain, slid.least);
        assert!(slid.least_work > -1e-13, "mu {mu}: friction drives the block: {:e}", slid.least_work);
        assert!(slid.pressure < 1e4 && slid.crossings > 0, "mu {mu}: {:e}", slid.pressure);
    }
}
