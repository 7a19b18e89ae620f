//! Scenes on several ranks, which are threads here: all of them have the same bits, and one rank has those of a program without ranks.

use std::path::{Path, PathBuf};
use stoss::build::{OwnLaws, build_on};
use stoss::linalg::Threads;
use stoss::ranks::Ranks;
use stoss::run::{RunOptions, run_scene};
use stoss::scene::parse;
use stoss::solver::{Checkpoint, Simulation};

/// What a run came to: vectors by name, after so many steps.
type Outcome = Vec<(&'static str, Vec<f64>)>;

fn outcome(simulation: &Simulation) -> Outcome {
    let (state, balance) = (simulation.state(), simulation.balance());
    let momenta = [balance.linear_momentum, balance.angular_momentum].concat();
    let energies = vec![balance.kinetic, balance.strain, balance.contact, balance.dissipation, balance.external_work];
    let of_bodies = (0..simulation.model().bodies.len()).map(|body| simulation.body_balance(body));
    let of_bodies = of_bodies.flat_map(|of| [of.kinetic, of.strain].into_iter().chain(of.angular_momentum));
    vec![
        ("positions", state.q.clone()),
        ("velocities", state.v.clone()),
        ("forces of contact", simulation.contact_force().to_vec()),
        ("multipliers", simulation.pressures().concat()),
        ("momenta", momenta),
        ("energies", energies),
        ("bodies", of_bodies.collect()),
        ("total", vec![balance.total()]),
        ("steps", vec![simulation.step() as f64, state.time]),
    ]
}

fn run(text: &str, folder: &Path, steps: u64, ranks: &Ranks) -> Outcome {
    let scene = parse(text, "scene.toml").unwrap_or_else(|e| panic!("{e}"));
    let built = build_on(&scene, folder, &OwnLaws::default(), ranks).unwrap_or_else(|e| panic!("{e}"));
    let mut simulation = built.simulation;
    while simulation.step() < steps && !simulation.finished() {
        simulation.advance().unwrap_or_else(|e| panic!("{e}"));
    }
    outcome(&simulation)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// Largest difference; infinite if one is no number, or of lists that are not as long as each other.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let of = |(a, b): (&f64, &f64)| if (a - b).is_nan() { f64::INFINITY } else { (a - b).abs() };
    if a.len() == b.len() { a.iter().zip(b).map(of).fold(0.0, f64::max) } else { f64::INFINITY }
}

/// Asks for the same bits on all ranks, and on one rank for those of a run without ranks; else for the same values within `part` of the largest one. Momenta and totals that are zero but for round-off are
/// measured against energies and products of the others.
fn compare(name: &str, text: &str, folder: &Path, steps: u64, counts: &[usize], part: f64) -> Outcome {
    let plain = run(text, folder, steps, &Ranks::default());
    let speed = largest(&plain[1].1);
    let energy = plain[5].1.iter().map(|e| e.abs()).sum::<f64>();
    for &count in counts {
        let all = Threads::run(count, |communicator| run(text, folder, steps, &Ranks::gathered(communicator)));
        for (what, (of_ranks, of_plain)) in all[0].iter().zip(&plain).map(|(a, b)| (a.0, (&a.1, &b.1))) {
            for other in &all {
                let same = other.iter().find(|(other, _)| *other == what).is_some_and(|(_, values)| values == of_ranks);
                assert!(same, "{name}: {what} of the ranks differ, of {count}");
            }
            if count == 1 {
                assert_eq!(of_ranks, of_plain, "{name}: {what} on one rank");
                continue;
            }
            let scale = match what {
                "momenta" => largest(of_plain).max(if speed > 0.0 { energy / speed } else { 0.0 }),
                "total" | "energies" | "bodies" => energy.max(largest(of_plain)),
                _ => largest(of_plain),
            };
            let off = difference(of_ranks, of_plain);
            println!("{name} on {count}: {what} {off:.1e} of {scale:.1e}");
            assert!(off <= part * scale, "{name} on {count}: {what} {off:e} {scale:e}");
        }
    }
    plain
}

/// An impact in a step in which the blocks push each other.
fn compare_impact(name: &str, contact: &str, steps: u64, counts: &[usize]) {
    let plain = compare(name, &impact(contact), Path::new("."), steps, counts, 1e-9);
    assert!(largest(&plain[2].1) > 1e3, "{name} is in contact");
}

fn shipped(name: &str, steps: u64, counts: &[usize]) {
    let path = PathBuf::from(format!("../scenes/{name}.toml"));
    let text = std::fs::read_to_string(&path).unwrap();
    compare(name, &text, path.parent().unwrap(), steps, counts, 1e-9);
}

/// Impacts, a tie, a mechanism, pretension and rotation in stages, friction on rigid ground, a section.
#[test]
fn shipped_scenes_are_the_same_on_any_number_of_ranks() {
    shipped("bowl-mortar", 3, &[3]);
    shipped("tied-cantilever", 4, &[3]);
    shipped("trebuchet", 10, &[1, 2]);
    shipped("bolt", 3, &[2]);
    shipped("incline", 4, &[3]);
    shipped("rotating-indenter", 2, &[2]);
    shipped("o-ring", 2, &[2]);
}

/// A block that flies obliquely onto a larger one, from near to where it slides.
fn impact(contact: &str) -> String {
    let block = |name: &str, min: &str, max: &str, divisions: &str, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = {min}, max = {max}, divisions = {divisions} }}\n\
             material = {{ law = \"neo-hooke\", young = 1.0e6, poisson = 0.3 }}\ndensity = 1000.0\n{more}\n"
        )
    };
    "[scene]\ntitle = \"Impact\"\nkind = \"dynamic\"\n[time]\nend = 0.02\nstep = 0.001\nintegrator = { scheme = \"energy-momentum\" }\n"
        .to_owned()
        + &block("lower", "[0, 0, 0]", "[2, 2, 1]", "[4, 4, 2]", "")
        + &block("upper", "[0.3, 0.3, 1.004]", "[1.3, 1.3, 2.004]", "[3, 3, 2]", "velocity = [3.0, 2.0, -2.0]")
        + contact
}

const PAIR: &str = "slave = \"upper.bottom\"\nmaster = \"lower.top\"\nfriction = { law = \"coulomb\", mu = 0.2 }\n";

#[test]
fn mortar_contact_with_friction() {
    compare_impact("mortar", &format!("[[contact]]\nmethod = \"mortar\"\n{PAIR}"), 14, &[1, 2, 3, 7]);
}

#[test]
fn node_to_surface_contact_with_friction() {
    compare_impact("node-to-surface", &format!("[[contact]]\nmethod = \"nts\"\n{PAIR}"), 14, &[1, 3]);
}

#[test]
fn general_contact_with_friction() {
    compare_impact("general contact", "[general_contact]\nfriction = 0.2\n", 6, &[1, 3]);
}

const CUBE: &str = r#"
[scene]
title = "Cube"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
[[body]]
name = "cube"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [3, 3, 3] }
material = { law = "neo-hooke", young = 1.0e3, poisson = 0.3 }
[[prescribe]]
set = "cube.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "cube.top"
components = ["x", "z"]
displacement = { table = [[0, 0, 0], [1, 0.2, -0.1]] }
"#;

/// Nodes of the surface without mass, which nodes of elements farther inside carry: of other ranks, too.
#[test]
fn masses_that_nodes_of_other_elements_carry() {
    let text = r#"
[scene]
title = "Drop"
kind = "dynamic"
[time]
end = 0.01
step = 0.001
integrator = { scheme = "energy-momentum" }
[[body]]
name = "b"
mesh = { generator = "block", min = [0, 0, 0.002], max = [1, 1, 2.002], divisions = [4, 4, 2] }
material = { law = "neo-hooke", young = 1e6, poisson = 0.3 }
density = 1000.0
velocity = [0, 0, -2]
[[rigid]]
name = "floor"
shape = { kind = "box", size = [4, 4, 1] }
position = [0.5, 0.5, -0.5]
fixed = true
[[contact]]
method = "mortar"
slave = "b.bottom"
master = "floor.all"
surface_mass = "none"
"#;
    compare("surface without mass", text, Path::new("."), 6, &[2, 3, 7], 1e-9);
}

/// Elements that are turned inside out at the end of a step, and elements without a force on the way, are found by the ranks that have them: the same cuts on all, and one message.
#[test]
fn inverted_elements_of_one_rank_are_those_of_all() {
    compare_failure(&CUBE.replace("0.2, -0.1]", "0.0, -1.5]"), "elements are turned inside out");
    let loaded = std::fs::read_to_string("failing/load-too-large.toml").unwrap();
    compare_failure(&loaded, "is inverted at Gauss point");
}

/// Asks for the same end of a run that fails, in whose message `part` stands, on one rank and on more.
fn compare_failure(text: &str, part: &str) {
    let failed = |ranks: &Ranks| {
        let scene = parse(text, "scene.toml").unwrap();
        let mut simulation = build_on(&scene, Path::new("."), &OwnLaws::default(), ranks).unwrap().simulation;
        let error = loop {
            if let Err(error) = simulation.advance() {
                break error.to_string();
            }
        };
        let kinds: Vec<_> = simulation.failures().iter().map(|failure| (failure.kind, failure.dt)).collect();
        (error, simulation.decisions().len(), kinds, simulation.failures().iter().all(|f| f.place.element.is_some()))
    };
    let plain = failed(&Ranks::default());
    assert!(plain.0.contains(part) && plain.3 && !plain.2.is_empty(), "{plain:?}");
    for count in [2, 3] {
        let all = Threads::run(count, |communicator| failed(&Ranks::gathered(communicator)));
        assert!(all.iter().all(|of| *of == all[0]), "{all:?}");
        // Which element is the first or the worst may be another one.
        assert!(all[0].0.contains(part), "{}", all[0].0);
        assert_eq!((all[0].1, &all[0].2, all[0].3), (plain.1, &plain.2, plain.3));
    }
}

/// Ranks without elements, too.
#[test]
fn a_cube_on_more_ranks_than_it_has_elements() {
    compare("cube", CUBE, Path::new("."), 2, &[1, 2, 3, 7, 29], 1e-12);
}

/// Damping by mass and stiffness, a follower pressure, a centrifugal load, a mixed tet4 body, which is on one rank, a tie.
#[test]
fn damping_followers_and_indivisible_bodies() {
    let text = r#"
[scene]
title = "Mixture"
kind = "dynamic"
[time]
end = 0.12
step = 0.02
integrator = { scheme = "energy-momentum" }
[[body]]
name = "a"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [3, 3, 3] }
material = { law = "neo-hooke", young = 100.0, poisson = 0.3 }
density = 1.0
damping = { mass = 0.3, stiffness = 0.01 }
[[body]]
name = "b"
mesh = { generator = "block", min = [0, 0, 1], max = [1, 1, 2], divisions = [4, 4, 4] }
cell = "tet4"
volumetric = "mixed"
material = { law = "neo-hooke", young = 100.0, poisson = 0.4 }
density = 1.0
[[tie]]
slave = "b.bottom"
master = "a.top"
[[prescribe]]
set = "a.bottom"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "b.top"
follower_pressure = { table = [[0, 0], [0.2, 3.0]] }
[[load]]
body = "a"
angular_velocity = { table = [[0, 0], [0.1, 2.0]] }
axis = [0, 0, 1]
"#;
    compare("mixture", text, Path::new("."), 6, &[1, 2, 7], 1e-9);
}

/// What a run has written: positions, histories of materials, and the tables.
struct Written {
    checkpoint: Checkpoint,
    tables: Vec<(String, Vec<f64>)>,
}

/// Runs a scene in a folder on so many threads.
fn write(path: &Path, out: &Path, until: Option<f64>, resume: bool, count: usize) -> Written {
    let results = Threads::run(count, |communicator| {
        let ranks = Ranks::gathered(communicator);
        let options = RunOptions { out: out.to_path_buf(), until, resume, ranks, ..RunOptions::default() };
        run_scene(path, &options, &mut |_| {}).map(|summary| summary.to_string())
    });
    results.iter().for_each(|result| assert!(result.is_ok(), "{result:?}"));
    let checkpoint = Checkpoint::read(&out.join("checkpoint")).unwrap();
    let tables =
        ["balance.csv", "probes.csv", "contact.csv"].iter().filter(|name| out.join(name).exists()).map(|name| {
            let text = std::fs::read_to_string(out.join(name)).unwrap();
            let numbers =
                text.lines().skip(1).flat_map(|line| line.split(',').map(|field| field.parse().unwrap_or(0.0)));
            ((*name).to_owned(), numbers.collect())
        });
    Written { tables: tables.collect(), checkpoint }
}

/// A checkpoint of any number of ranks is one for any other: the ends are the same, with the states of the material.
fn compare_restarts(text: &str, half: f64, end: f64) {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    let whole = write(&scene, &folder.path().join("whole"), Some(end), false, 1);
    assert!(whole.checkpoint.ledger.balance.plastic_loss > 0.0, "points have flowed");
    let lengths = |of: &Written| of.checkpoint.histories.iter().map(Vec::len).collect::<Vec<_>>();
    for [first, second] in [[2, 1], [1, 3], [3, 2]] {
        let out = folder.path().join(format!("{first}-{second}"));
        write(&scene, &out, Some(half), false, first);
        let other = write(&scene, &out, Some(end), true, second);
        assert_eq!(lengths(&other), lengths(&whole));
        let numbers = |of: &Written| -> Vec<(String, Vec<f64>)> {
            // Those of the two bodies come first: states of Gauss points. Those of contact are no plain numbers.
            let states = of.checkpoint.histories[..2].iter().flat_map(|bytes| bytes.as_chunks().0);
            let states = states.map(|bytes| f64::from_le_bytes(*bytes)).collect();
            let own = [("positions", of.checkpoint.state.q.clone()), ("states", states)];
            own.into_iter().map(|(name, values)| (name.to_owned(), values)).chain(of.tables.iter().cloned()).collect()
        };
        for ((name, one), (_, two)) in numbers(&whole).iter().zip(&numbers(&other)) {
            let off = difference(one, two);
            println!("{first} to {second}: {name} {off:.1e} of {:.1e}", largest(one));
            assert!(!one.is_empty() && off <= 1e-9 * largest(one), "{first} to {second}: {name} {off:e}");
        }
    }
}

#[test]
fn a_run_goes_on_with_another_number_of_ranks() {
    let probes = "[[probe]]\nname = \"mises\"\nset = \"upper.bottom\"\nquantity = \"von_mises\"\nreduce = \"max\"\n\
                  [[probe]]\nname = \"stress\"\nbody = \"lower\"\npoint = [1.0, 1.0, 0.9]\nquantity = \"cauchy_stress\"\n";
    let soft = impact(&format!("[[contact]]\nmethod = \"mortar\"\n{PAIR}{probes}"));
    let yields = "law = \"hencky\", young = 1.0e6, poisson = 0.3, plasticity = { yield_stress = 1.0e4, hardening_modulus = 1.0e4 }";
    compare_restarts(&soft.replace("law = \"neo-hooke\", young = 1.0e6, poisson = 0.3", yields), 0.004, 0.008);
}
