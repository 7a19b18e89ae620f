//! General contact through scenes: nothing is named, nothing is inside anything, balances are exact.

use crate::support::{drift, simulation};
use std::path::Path;
use stoss::build::{Built, build};
use stoss::solver::Simulation;

const MATERIAL: &str = "material = { law = \"neo-hooke\", young = 1.0, poisson = 0.3 }\ndensity = 1.0";

fn head(scheme: &str, step: f64, end: f64) -> String {
    format!(
        "[scene]\ntitle = \"general\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = {step:?}\nintegrator = {{ scheme = \"{scheme}\" }}\n"
    )
}

/// A cube of edge 1 about a place, turned.
fn cube(name: &str, at: [f64; 3], axis: [f64; 3], degrees: f64, velocity: [f64; 3], divisions: u32) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [-0.5, -0.5, -0.5], max = [0.5, 0.5, 0.5], divisions = [{divisions}, {divisions}, {divisions}] }}\n\
         rotation = {{ axis = {axis:?}, degrees = {degrees:?} }}\nposition = {at:?}\n{MATERIAL}\nvelocity = {velocity:?}\n"
    )
}

struct Course {
    simulation: Simulation,
    momenta: Vec<[f64; 3]>,
    angular: Vec<[f64; 3]>,
    totals: Vec<f64>,
    /// Steps in which bodies acted on each other, with the largest force.
    touched: usize,
    dissipated: f64,
}

/// Runs to the end; cuts are part of the method.
fn run(text: &str) -> Course {
    let mut simulation = simulation(text);
    let start = *simulation.balance();
    let mut course = Course {
        momenta: vec![start.linear_momentum],
        angular: vec![start.angular_momentum],
        totals: vec![start.total()],
        touched: 0,
        dissipated: 0.0,
        simulation,
    };
    simulation = course.simulation;
    while !simulation.finished() {
        let record = simulation.advance().unwrap_or_else(|e| panic!("{e}\n{text}"));
        course.momenta.push(record.balance.linear_momentum);
        course.angular.push(record.balance.angular_momentum);
        course.totals.push(record.balance.total());
        course.dissipated = record.balance.dissipation;
        let contact = record.contact.unwrap();
        course.touched += usize::from(contact.bodies.iter().any(|pair| pair.active > 0));
        for pair in &contact.bodies {
            assert!(pair.distance > 0.0);
        }
    }
    course.simulation = simulation;
    course
}

/// Largest change of the ledger, relative to the energy at the start.
fn ledger(totals: &[f64]) -> f64 {
    totals.iter().map(|t| (t - totals[0]).abs()).fold(0.0, f64::max) / totals[0]
}

fn edge_on_edge(keys: &str, scheme: &str) -> Course {
    let text = head(scheme, 0.1, 5.0)
        + &cube("a", [0.0, 0.0, 0.75], [1.0, 0.0, 0.0], 45.0, [0.0, 0.0, -0.1], 2)
        + &cube("b", [0.1, 0.15, -0.75], [0.0, 1.0, 0.0], 45.0, [0.0, 0.0, 0.1], 2)
        + "[general_contact]\n"
        + keys;
    run(&text)
}

#[test]
fn edges_collide_with_exact_balances() {
    for keys in ["", "friction = 0.3\n", "damping = 0.2\n"] {
        let course = edge_on_edge(keys, "energy-momentum");
        assert!(course.touched > 10, "{keys}");
        assert!(ledger(&course.totals) < 1e-12, "{keys}: {:e}", ledger(&course.totals));
        assert!(drift(&course.angular) < 1e-12, "{keys}");
        assert_eq!(course.dissipated > 0.0, !keys.is_empty());
        // Two equal and opposite momenta of 0.1: no length to measure the sum with but that.
        let sum = course.momenta.iter().flatten().fold(0.0_f64, |m, p| m.max(p.abs()));
        assert!(sum < 1e-13, "{keys}: {sum:e}");
        // The upper one went back up.
        let z = |q: &[f64], body: usize| (0..27).map(|k| q[3 * (27 * body + k) + 2]).sum::<f64>() / 27.0;
        let q = &course.simulation.state().q;
        assert!(z(q, 0) > z(q, 1) + 1.0, "{keys}");
        // What the viscous layer takes is a loss of its own, not one of the constraints.
        assert!(course.simulation.balance().closing_loss.abs() < 1e-12 * course.totals[0], "{keys}");
    }
}

#[test]
fn backward_euler_loses_energy_and_keeps_momentum() {
    let course = edge_on_edge("", "backward-euler");
    let last = course.totals.last().unwrap() / course.totals[0];
    assert!((0.5..0.95).contains(&last), "{last}");
    let sum = course.momenta.iter().flatten().fold(0.0_f64, |m, p| m.max(p.abs()));
    assert!(sum < 1e-13, "{sum:e}");
}

#[test]
fn random_impacts_of_three_bodies() {
    let mut random = fastrand_like(11);
    let mut touched = 0;
    for case in 0..6 {
        let mut text = head("energy-momentum", 0.1, 4.0);
        for (k, name) in ["a", "b", "c"].into_iter().enumerate() {
            let mut around = || 2.0 * random() - 1.0;
            let axis = [around(), around(), around() + 0.1];
            let at = [1.9 * k as f64 - 1.9, 0.3 * around(), 0.3 * around()];
            let velocity = [0.15 * (1.0 - k as f64), 0.03 * around(), 0.03 * around()];
            text += &cube(name, at, axis, 180.0 * around(), velocity, 1 + case % 2);
        }
        text += &format!("[general_contact]\nfriction = {:?}\n", [0.0, 0.4][case as usize / 2 % 2]);
        let course = run(&text);
        touched += course.touched;
        assert!(ledger(&course.totals) < 1e-10, "{case}: {:e}", ledger(&course.totals));
        assert!(drift(&course.angular) < 1e-11, "{case}: {:e}", drift(&course.angular));
        let scale = 0.15;
        let change = |p: &[f64; 3]| (0..3).map(|i| (p[i] - course.momenta[0][i]).abs()).fold(0.0, f64::max);
        let worst = course.momenta.iter().map(change).fold(0.0, f64::max);
        assert!(worst < 1e-12 * scale, "{case}: {worst:e}");
    }
    assert!(touched > 20, "{touched}");
}

/// Numbers between 0 and 1, the same ones everywhere.
fn fastrand_like(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

const STACK: &str = "[[body]]\nname = \"a\"\nmesh = { generator = \"block\", min = [-0.5, -0.5, 0.0], max = [0.5, 0.5, 1.0], divisions = [2, 2, 2] }\nMATERIAL\n\
    [[body]]\nname = \"b\"\nmesh = { generator = \"block\", min = [-0.5, -0.5, 1.0], max = [0.5, 0.5, 2.0], divisions = [3, 3, 2] }\nMATERIAL\n";

/// Blocks that touch: no force at the start, their weight on average, and the balance of the fall is exact.
#[test]
fn a_stack_that_touches_stands() {
    let text = head("energy-momentum", 0.1, 8.0)
        + "[gravity]\nacceleration = [0.0, 0.0, -0.002]\n"
        + &STACK.replace("MATERIAL", MATERIAL)
        + "[[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n[general_contact]\nfriction = 0.2\nslip_velocity = 1e-4\n";
    let mut simulation = simulation(&text);
    assert!(simulation.balance().contact < 1e-30);
    let start = simulation.balance().total();
    let (mut impulse, mut kinetic, mut worst, mut most) = (0.0, 0.0_f64, 0.0_f64, 0.0_f64);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        let bodies = &record.contact.as_ref().unwrap().bodies;
        impulse += bodies.iter().map(|pair| pair.force[2]).sum::<f64>() * record.dt;
        kinetic = kinetic.max(record.balance.kinetic);
        worst = worst.max((record.balance.total() - start).abs());
        most = most.max(bodies.iter().map(|pair| pair.area).fold(0.0, f64::max));
    }
    assert!(worst < 1e-11 * kinetic, "{worst:e} of {kinetic:e}");
    assert!((most - 1.0).abs() < 1e-3, "{most}");
    // Impulse on the lower block: the weight of the upper one times the time, but for the momentum that this one has at the end.
    assert!((impulse / (-0.002 * 8.0) - 1.0).abs() < 0.1, "{impulse:e}");
}

fn press(contact: &str) -> f64 {
    let text = "[scene]\ntitle = \"press\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.25\n".to_owned()
        + &STACK.replace("MATERIAL", "material = { law = \"neo-hooke\", young = 1.0, poisson = 0.3 }")
        + "[[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
           [[prescribe]]\nset = \"b.top\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = { table = [[0, 0, 0, 0], [1, 0, 0, -0.2]] }\n"
        + contact;
    let mut simulation = simulation(&text);
    while !simulation.finished() {
        simulation.advance().unwrap_or_else(|e| panic!("{e}"));
    }
    (0..27).map(|node| simulation.reactions()[3 * node + 2]).sum()
}

/// The force of a press against mortar contact; inset surfaces make the blocks stiffer by the thickness over the height, a per cent.
#[test]
fn the_force_of_a_press_is_that_of_mortar_contact() {
    let named = press("[[contact]]\nmethod = \"mortar\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n");
    for (keys, bound) in [("", 0.03), ("thickness = 0.004\n", 0.012)] {
        let general = press(&format!("[general_contact]\n{keys}"));
        assert!((general / named - 1.0).abs() < bound, "{keys}: {general} {named}");
    }
}

#[test]
fn scenes_that_cannot_start_are_refused() {
    let problems = |text: &str| {
        let scene = stoss::scene::parse(text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
        let errors = stoss::build::build(&scene, Path::new(".")).err();
        errors.map(|e| e.to_string()).unwrap_or_default()
    };
    let two = |z: f64| {
        cube("a", [0.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2)
            + &cube("b", [0.2, 0.1, z], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2)
    };
    let inside = problems(&(head("energy-momentum", 0.1, 1.0) + &two(0.9) + "[general_contact]\n"));
    assert!(
        inside.contains("`a` and `b` lie in each other") || inside.contains("`b` and `a` lie in each other"),
        "{inside}"
    );
    let scheme = problems(&(head("midpoint", 0.1, 1.0) + &two(1.5) + "[general_contact]\n"));
    assert!(scheme.contains("has no general contact") && scheme.contains("energy-momentum"), "{scheme}");
    let stage = "[[stage]]\nname = \"fall\"\nkind = \"dynamic\"\nuntil = 1.0\nintegrator = { scheme = \"midpoint\" }\n";
    let stage = problems(&(head("energy-momentum", 0.1, 1.0) + stage + &two(1.5) + "[general_contact]\n"));
    assert!(stage.contains("stage[0].integrator.scheme") && stage.contains("has no general contact"), "{stage}");
    let speed = problems(&(head("energy-momentum", 0.1, 1.0) + &two(1.5) + "[general_contact]\nfriction = 0.2\n"));
    assert!(speed.contains("slip_velocity"), "{speed}");
    // A plate of half a thickness cannot take part.
    let thin = two(1.5).replace("max = [0.5, 0.5, 0.5]", "max = [0.5, 0.5, -0.49]");
    let thin = problems(&(head("energy-momentum", 0.1, 1.0) + &thin + "[general_contact]\nthickness = 0.02\n"));
    assert!(thin.contains("that are no neighbours are only"), "{thin}");
    // Bodies that touch and are left out, or named, are none of its business.
    let named = problems(&(head("energy-momentum", 0.1, 1.0) + &two(0.9) + "[general_contact]\nexclude = [\"b\"]\n"));
    assert_eq!(named, "");
}

/// A static run to its end, with the linear solutions of each step. No equilibrium is unstable.
fn statics(text: &str) -> (Simulation, Vec<u32>) {
    let mut simulation = simulation(text);
    let mut iterations = Vec::new();
    while !simulation.finished() {
        let record = simulation.advance().unwrap_or_else(|e| panic!("{e}\n{text}"));
        iterations.push(record.iterations);
        assert_eq!(record.unstable, 0, "step {}", record.step);
    }
    (simulation, iterations)
}

/// A faceted ball is pressed into a block and drawn along: nodes go over edges and vertices of facets, where the tangent is indefinite.
fn drawn_ball(friction: f64) -> (Simulation, Vec<u32>) {
    let text = "[scene]\ntitle = \"punch\"\nkind = \"quasi-static\"\n[time]\nend = 2.0\nstep = 0.1\n\
        [[body]]\nname = \"block\"\nmesh = { generator = \"block\", min = [-1, -1, -1], max = [1.5, 1, 0], divisions = [7, 5, 3] }\n\
        material = { law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }\n\
        [[rigid]]\nname = \"ball\"\nshape = { kind = \"sphere\", radius = 0.8, divisions = 4 }\nposition = [0, 0, 0.8]\n\
        [[prescribe]]\nset = \"block.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
        [[prescribe]]\nrigid = \"ball\"\nrotation = { axis = [0, 0, 1], degrees = 0, about = [0, 0, 0] }\n\
        translation = { table = [[0, 0, 0, 0], [1, 0, 0, -0.15], [2, 0.3, 0, -0.15]] }\n"
        .to_owned()
        + &format!("[general_contact]\nfriction = {friction:?}\n");
    statics(&text)
}

#[test]
fn a_ball_is_drawn_through_a_block_in_statics() {
    for friction in [0.0, 0.3] {
        let (simulation, iterations) = drawn_ball(friction);
        println!("friction {friction}: {iterations:?}");
        // No cut, and no step that crawls.
        assert_eq!(simulation.step(), 20);
        assert!(iterations.iter().max() < Some(&40), "{iterations:?}");
        // Shifted tangents are factorised and not solved with.
        let counts = simulation.solver_statistics();
        assert_eq!(counts.symmetric > counts.solves, friction == 0.0, "{counts:?}");
    }
}

/// Meshes that do not match, without friction: the first equilibrium that is found has nodes over nodes, from where the energy falls sideways.
#[test]
fn a_press_leaves_the_saddle_point() {
    let text = "[scene]\ntitle = \"press\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.2\n".to_owned()
        + &STACK.replace("MATERIAL", "material = { law = \"neo-hooke\", young = 1.0, poisson = 0.3 }")
        + "[[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
           [[prescribe]]\nset = \"b.top\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = { table = [[0, 0, 0, 0], [1, 0, 0, -0.2]] }\n\
           [general_contact]\n";
    let (_, iterations) = statics(&text);
    println!("{iterations:?}");
    assert!(iterations.iter().sum::<u32>() < 50, "{iterations:?}");
    assert!(iterations[2..].iter().all(|count| *count <= 6), "{iterations:?}");
}

/// Three blocks on a plate, held by contact alone: stabilised statics find their equilibrium, and released they stay there.
#[test]
fn a_stack_settles_and_stays() {
    for contact in ["[general_contact]\n", "[general_contact]\nfriction = 0.3\nslip_velocity = 1e-4\n"] {
        let block = |name: &str, bottom: u32, n: u32| {
            format!(
                "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [-0.5, -0.5, {bottom}], max = [0.5, 0.5, {}], divisions = [{n}, {n}, {n}] }}\n{MATERIAL}\n",
                bottom + 1
            )
        };
        let text = head("energy-momentum", 0.1, 6.0)
            + "[[stage]]\nname = \"settle\"\nkind = \"quasi-static\"\nuntil = 1.0\nstabilise = { fraction = 1e-3 }\n\
               [[stage]]\nname = \"rest\"\nkind = \"dynamic\"\nuntil = 6.0\n[gravity]\nacceleration = [0.0, 0.0, -0.002]\n\
               [[body]]\nname = \"plate\"\nmesh = { generator = \"block\", min = [-1, -1, -0.5], max = [1, 1, 0], divisions = [4, 4, 1] }\n"
            + MATERIAL
            + "\n"
            + &block("one", 0, 2)
            + &block("two", 1, 3)
            + &block("three", 2, 2)
            + "[[prescribe]]\nset = \"plate.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n"
            + contact;
        let scene = stoss::scene::parse(&text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
        let Built { mut simulation, schedule, .. } = build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        let carried = |record: &stoss::solver::StepRecord| {
            let bodies = &record.contact.as_ref().unwrap().bodies;
            // On the plate, the first body.
            bodies.iter().filter(|pair| pair.bodies[0] == 0).map(|pair| -pair.force[2]).sum::<f64>() / 0.006
        };
        let mut worst = 0.0_f64;
        while !simulation.finished() || schedule.advance(&mut simulation).unwrap() {
            let record = simulation.advance().unwrap_or_else(|e| panic!("{e}\n{text}"));
            if record.time > 0.95 {
                worst = worst.max((carried(&record) - 1.0).abs());
            }
        }
        assert_eq!(simulation.state().time, 6.0);
        println!("{contact}: {worst:e}");
        assert!(worst < if contact.contains("friction") { 5e-3 } else { 1e-9 }, "{contact}: {worst:e}");
    }
}
