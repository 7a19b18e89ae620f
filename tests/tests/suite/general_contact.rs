//! General contact through scenes: nothing is named, nothing is inside anything, balances are exact.

use crate::support::{drift, problem_keys, simulation};
use std::path::Path;
use stoss::build::{Built, build};
use stoss::run::{RunOptions, run_scene};
use stoss::solver::Simulation;
use stoss::watch::Severity;

pub const MATERIAL: &str = "material = { law = \"neo-hooke\", young = 1.0, poisson = 0.3 }\ndensity = 1.0";

pub fn head(scheme: &str, step: f64, end: f64) -> String {
    format!(
        "[scene]\ntitle = \"general\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = {step:?}\nintegrator = {{ scheme = \"{scheme}\" }}\n"
    )
}

/// A cube of edge 1 about a place, turned.
pub fn cube(name: &str, at: [f64; 3], axis: [f64; 3], degrees: f64, velocity: [f64; 3], divisions: u32) -> String {
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
        let errors = build(&scene, Path::new(".")).err();
        errors.map(|e| e.to_string()).unwrap_or_default()
    };
    let two = |z: f64| {
        cube("a", [0.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2)
            + &cube("b", [0.2, 0.1, z], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 2)
    };
    let inside = problems(&(head("energy-momentum", 0.1, 1.0) + &two(0.9) + "[general_contact]\n"));
    assert!(inside.contains("`a` and `b` overlap") || inside.contains("`b` and `a` overlap"), "{inside}");
    let scheme = head("midpoint", 0.1, 1.0) + &two(1.5) + "[general_contact]\n";
    assert_eq!(problem_keys(&scheme), ["time.integrator.scheme"]);
    let stage = "[[stage]]\nname = \"fall\"\nkind = \"dynamic\"\nuntil = 1.0\nintegrator = { scheme = \"midpoint\" }\n";
    let stage = head("energy-momentum", 0.1, 1.0) + stage + &two(1.5) + "[general_contact]\n";
    assert_eq!(problem_keys(&stage), ["stage[0].integrator.scheme"]);
    // A plate of half a thickness cannot take part.
    let thin = two(1.5).replace("max = [0.5, 0.5, 0.5]", "max = [0.5, 0.5, -0.49]");
    let thin = problems(&(head("energy-momentum", 0.1, 1.0) + &thin + "[general_contact]\nthickness = 0.02\n"));
    assert!(thin.contains("that are not adjacent are only"), "{thin}");
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

/// Names of the contacts of a scene, and its warnings.
fn contacts_of(text: &str) -> (Vec<String>, Vec<String>) {
    let scene = stoss::scene::parse(text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    let built = build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}"));
    (built.contacts.into_iter().map(|contact| contact.name).collect(), built.warnings)
}

#[test]
fn it_is_the_default_where_no_pair_is_named() {
    let two = cube("a", [0.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 1)
        + &cube("b", [0.0, 0.0, 1.5], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 1);
    let free = |scheme: &str, more: &str| contacts_of(&(head(scheme, 0.1, 1.0) + &two + more));
    assert_eq!(free("energy-momentum", ""), (vec!["general".to_owned()], Vec::new()));
    assert_eq!(free("energy-momentum", "[general_contact]\nenabled = false\n"), (Vec::new(), Vec::new()));
    // A scheme that does not carry it: a warning, unless it is meant.
    let (contacts, warnings) = free("midpoint", "");
    assert!(contacts.is_empty());
    assert!(warnings.len() == 1 && warnings[0].contains("`a` and `b` have no contact"), "{warnings:?}");
    assert_eq!(free("midpoint", "[general_contact]\nenabled = false\n"), (Vec::new(), Vec::new()));
    // One body, and a named pair.
    let one = head("energy-momentum", 0.1, 1.0) + &cube("a", [0.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 1);
    assert_eq!(contacts_of(&one).0, Vec::<String>::new());
    let named = "[[contact]]\nmethod = \"nts\"\nslave = \"a.boundary\"\nmaster = \"b.boundary\"\n";
    assert_eq!(free("energy-momentum", named).0, ["a.boundary/b.boundary"]);
    assert_eq!(
        free("energy-momentum", &format!("{named}edges = \"general\"\n")).0,
        ["a.boundary/b.boundary", "general"]
    );
    // A joint between the two is enough to hold them.
    let joint = "[[joint]]\nname = \"j\"\nkind = \"ball\"\nbetween = [\"a.all\", \"b.all\"]\nat = [0, 0, 0.75]\n";
    assert_eq!(free("energy-momentum", joint).0, Vec::<String>::new());
    let meant = format!("{joint}[general_contact]\npairs = [{{ between = [\"b\", \"a\"] }}]\nself = false\n");
    assert_eq!(free("energy-momentum", &meant).0, ["general"]);
}

/// Bodies that start apart, by less than the thickness that the scene gives: they are reported, with gap and thickness.
#[test]
fn a_thickness_above_the_gap_is_told() {
    let warnings = |gap: f64, keys: &str| {
        let two = cube("a", [0.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 1)
            + &cube("b", [0.0, 0.0, 1.0 + gap], [0.0, 0.0, 1.0], 0.0, [0.0; 3], 1);
        contacts_of(&(head("energy-momentum", 0.1, 1.0) + &two + "[general_contact]\n" + keys)).1
    };
    let told = warnings(0.02, "thickness = 0.05\n");
    assert_eq!(told.len(), 1, "{told:?}");
    for part in ["`a` and `b` start 2.000e-2 apart", "the thickness 5.000e-2", "make `thickness` smaller than the gap"]
    {
        assert!(told[0].contains(part), "{told:?}");
    }
    for (gap, keys) in
        [(0.02, "thickness = 0.01\n"), (0.02, ""), (0.0, "thickness = 0.05\n"), (0.1, "thickness = 0.05\n")]
    {
        assert_eq!(warnings(gap, keys), Vec::<String>::new(), "{gap} {keys}");
    }
}

/// Facets around the rim of a tie meet those of the other side, and stay there.
#[test]
fn tied_bodies_are_not_in_contact_at_their_rims() {
    let block = |name: &str, min: [f64; 3], max: [f64; 3], n: u32| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = {min:?}, max = {max:?}, divisions = [{n}, {n}, {n}] }}\n{MATERIAL}\n"
        )
    };
    let text = head("energy-momentum", 0.1, 1.0)
        + &block("small", [0.2, 0.2, 1.0], [0.7, 0.7, 1.5], 2)
        // Its sides lean over: the angles at the rim close.
        + "velocity = [0.3, 0.0, -0.2]\n"
        + &block("large", [0.0; 3], [1.0; 3], 3)
        + "[[tie]]\nslave = \"small.bottom\"\nmaster = \"large.top\"\n";
    let course = run(&text);
    assert_eq!(course.touched, 0);
    assert!(ledger(&course.totals) < 1e-12);
}

/// The slider of a cut bolt carries the pretension, and no contact of the faces that it pulls into each other: with nothing named, and where the bodies of the cut and of the nut are named as pairs.
#[test]
fn faces_that_a_joint_connects_are_not_in_contact() {
    const BOLT: &str = include_str!("../../../scenes/bolt.toml");
    let named = "[[contact]]\nmethod = \"mortar\"\nslave = \"member.top\"\nmaster = \"plate.all\"\n";
    // At the start nothing carries the plate, where the layer acts only when it is pressed together.
    let free = BOLT.replace(named, "").replace("until = 4.0", "until = 4.0\nstabilise = { fraction = 1e-3 }");
    let joined =
        "[general_contact]\npairs = [{ between = [\"shank\", \"head\"] }, { between = [\"plate\", \"head\"] }]\n";
    for text in [free.clone(), free.clone() + joined] {
        assert!(!text.contains("[[contact]]"));
        let scene = stoss::scene::parse(&text, "bolt.toml").unwrap_or_else(|e| panic!("{e}"));
        let Built { mut simulation, schedule, probes, .. } =
            build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        let mut looked = 0;
        while !simulation.finished() || schedule.advance(&mut simulation).unwrap() {
            simulation.advance().unwrap_or_else(|e| panic!("{e}\n{text}"));
            let value = |name: &str| probes.iter().find(|probe| probe.name == name).unwrap().value(&simulation);
            // Of the named pair: the preload, a sixth of the load on top of it while the plate is clamped, and the whole load without it.
            let expected = match simulation.state().time {
                1.0 => [4.0, 4.0],
                2.0 => [4.5295, 1.5295],
                3.0 => [6.0, 0.0],
                4.0 => [4.3530, 2.3530],
                _ => continue,
            };
            looked += 1;
            for (name, expected) in ["bolt", "clamp"].into_iter().zip(expected) {
                let force = value(name)[2];
                println!("{}: {name} {force} {expected}", simulation.state().time);
                assert!((force - expected).abs() < 0.03, "{}: {name} {force} {expected}", simulation.state().time);
            }
        }
        assert_eq!(looked, 4);
    }
}

/// Two rods that cross with their edges ahead: no node comes into a facet. Node-to-surface contact lets them pass; what it leaves to general contact does not.
#[test]
fn edges_of_a_named_contact_are_left_to_general_contact() {
    let rod = |name: &str, half: [f64; 3], axis: [f64; 3], z: f64, speed: f64| {
        let divisions = half.map(|h| if h > 0.5 { 5 } else { 1 });
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = {:?}, max = {half:?}, divisions = {divisions:?} }}\n{MATERIAL}\n\
             rotation = {{ axis = {axis:?}, degrees = 45.0 }}\nposition = [0.0, 0.0, {z:?}]\nvelocity = [0.0, 0.0, {speed:?}]\n",
            half.map(|h| -h)
        )
    };
    let scene = |edges: &str| {
        head("energy-momentum", 0.02, 1.2)
            + &rod("lower", [1.0, 0.2, 0.2], [1.0, 0.0, 0.0], 0.0, 0.15)
            + &rod("upper", [0.2, 1.0, 0.2], [0.0, 1.0, 0.0], 0.6, -0.15)
            + "[[contact]]\nmethod = \"nts\"\nslave = \"upper.boundary\"\nmaster = \"lower.boundary\"\n"
            + edges
    };
    let judged = |edges: &str| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, scene(edges)).unwrap();
        let options = RunOptions { out: folder.path().join("out"), ..RunOptions::default() };
        run_scene(&path, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}")).verdict
    };
    let passed = judged("");
    assert!(passed.level == Severity::Wrong && passed.to_string().contains("inside `lower`"), "{passed}");
    let stopped = judged("edges = \"general\"\n");
    assert_eq!(stopped.level, Severity::Sound, "{stopped}");
    let stopped = run(&scene("edges = \"general\"\n"));
    assert!(ledger(&stopped.totals) < 1e-11, "{:e}", ledger(&stopped.totals));
}

/// Two blocks with matching meshes that are pressed onto each other without friction.
fn pressed(gap: f64) -> String {
    let body = |name: &str, low: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [0.0, 0.0, {low:?}], max = [1.0, 1.0, {:?}], divisions = [3, 3, 2] }}\n\
             material = {{ law = \"neo-hooke\", young = 1.0, poisson = 0.0 }}\n",
            low + 1.0
        )
    };
    let hold = |set: &str, components: &str, to: &str| {
        format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [{components}]\n{to}\n")
    };
    "[scene]\ntitle = \"press\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.25\n".to_owned()
        + &body("a", 0.0)
        + &body("b", 1.0 + gap)
        + &hold("a.bottom", "\"x\", \"y\", \"z\"", "fixed = true")
        + &hold(
            "b.top",
            "\"x\", \"y\", \"z\"",
            &format!("displacement = {{ table = [[0, 0, 0, 0], [1, 0, 0, {:?}]] }}", -0.05 - gap),
        )
        + "[general_contact]\nthickness = 0.01\n"
}

/// Pressures at surface nodes are uniform up to what vertices and edges add, and times their areas they are the force.
#[test]
fn a_uniform_press_has_a_uniform_pressure_at_nodes() {
    for gap in [0.0, 0.02] {
        let mut simulation = simulation(&pressed(gap));
        let mut record = None;
        while !simulation.finished() {
            record = Some(simulation.advance().unwrap_or_else(|e| panic!("{e}")));
        }
        let contact = record.unwrap().contact.unwrap();
        let force = contact.bodies[0].force[2];
        assert!(force < -0.02, "{force}");
        for body in [0..48, 48..96] {
            let x = &simulation.model().reference;
            let at_interface = |node: u32| (x[3 * node as usize + 2] - 1.0).abs() < 0.03;
            let own = || contact.surface.iter().filter(|n| body.contains(&n.node));
            let nodes: Vec<_> = own().filter(|n| at_interface(n.node)).collect();
            assert_eq!(nodes.len(), 16);
            let area: f64 = nodes.iter().map(|n| n.area).sum();
            let sum: f64 = nodes.iter().map(|n| n.pressure * n.area).sum();
            let mean = sum / area;
            let spread = nodes.iter().map(|n| (n.pressure / mean - 1.0).abs()).fold(0.0, f64::max);
            let beside = own().filter(|n| !at_interface(n.node)).map(|n| n.pressure.abs() / mean).fold(0.0, f64::max);
            // Forces on nodes beside the interface, and tilted normals, are the rest.
            assert!((sum / -force - 1.0).abs() < 1e-4, "{gap}: {sum} {force}");
            assert!((area - 1.0).abs() < 1e-3, "{gap}: {area}");
            // Vertices and edges add 10 to 50 % at a given distance; here the bodies choose it.
            assert!(spread < 0.1 && beside < 1e-2, "{gap}: {spread} {beside}");
            assert!(nodes.iter().all(|n| n.distance > 0.0 && n.distance < 0.01 && n.friction == [0.0; 3]));
        }
    }
}

pub fn try_build(text: &str) -> Result<Built, String> {
    let scene = stoss::scene::parse(text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    build(&scene, Path::new(".")).map_err(|e| e.to_string())
}

/// Columns of the rows of `general.csv` of this step, numbers alone.
fn row(folder: &Path, step: u64) -> Vec<f64> {
    let text = std::fs::read_to_string(folder.join("out/general.csv")).unwrap();
    let line = text.lines().find(|line| line.starts_with(&format!("{step},"))).unwrap_or_else(|| panic!("{text}"));
    line.split(',').filter_map(|cell| cell.parse().ok()).collect()
}

/// The layer rings under a block that gravity pulls on suddenly: the mean of the force from frame to frame is its weight, and that of frames is the same.
#[test]
fn means_between_frames_are_the_weight() {
    let text = head("energy-momentum", 0.1, 20.0)
        + "[gravity]\nacceleration = [0.0, 0.0, -0.002]\n"
        + &STACK.replace("MATERIAL", MATERIAL).replace("[3, 3, 2]", "[2, 2, 2]")
        + "[[prescribe]]\nset = \"a.all\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n[general_contact]\n[output]\nevery = 100\n\
           [[probe]]\nname = \"p\"\nbody = \"b\"\nquantity = \"linear_momentum\"\n";
    let run = |folder: &Path, until: Option<f64>, resume: bool| {
        let path = folder.join("scene.toml");
        std::fs::write(&path, &text).unwrap();
        let options = RunOptions { out: folder.join("out"), until, resume, ..RunOptions::default() };
        run_scene(&path, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
    };
    let whole = tempfile::tempdir().unwrap();
    run(whole.path(), None, false);
    let probes = std::fs::read_to_string(whole.path().join("out/probes.csv")).unwrap();
    let momentum: Vec<f64> = probes.lines().skip(1).map(|l| l.split(',').nth(4).unwrap().parse().unwrap()).collect();
    for step in [100, 200] {
        let row = row(whole.path(), step);
        // Behind step and time: active, distance, pressure, area, force, moment, work, mean force.
        assert_eq!(row.len(), 16);
        let mean = row[15];
        let expected = -(0.002 + (momentum[step as usize] - momentum[step as usize - 100]) / 10.0);
        assert!((mean / expected - 1.0).abs() < 1e-8, "{mean:e} {expected:e}");
        assert!((mean / -0.002 - 1.0).abs() < 0.15, "{mean:e}");
        // Mean pressures of the frame times the areas of the nodes.
        let frame = whole.path().join(format!("out/frames/frame_{step:06}.vtu"));
        let frame = stoss::mesh_io::read_vtu(&frame).unwrap();
        let pressure = &frame.point_data["contact_pressure"].values;
        let gap = &frame.point_data["gap"].values;
        let mut sum = 0.0;
        for (k, x) in frame.points.iter().enumerate().skip(27).filter(|(_, x)| x[2] == 1.0) {
            let share = |x: f64| if x.abs() == 0.5 { 0.25 } else { 0.5 };
            sum += pressure[k] * share(x[0]) * share(x[1]);
            assert!(gap[k].is_finite());
        }
        assert!((sum / -mean - 1.0).abs() < 0.02, "{sum:e} {mean:e}");
        assert!(!frame.point_data.contains_key("friction_traction") && !frame.point_data.contains_key("slip"));
    }
    // In single steps it is far from that.
    let all = std::fs::read_to_string(whole.path().join("out/general.csv")).unwrap();
    let forces = all.lines().skip(1).filter_map(|line| line.split(',').nth(10)?.parse::<f64>().ok());
    assert!(forces.fold(0.0_f64, |worst, force| worst.max((force / -0.002 - 1.0).abs())) > 0.3);
    // A run that was interrupted between two frames has the same.
    let broken = tempfile::tempdir().unwrap();
    run(broken.path(), Some(13.0), false);
    run(broken.path(), None, true);
    let [one, other] = [&whole, &broken].map(|f| std::fs::read(f.path().join("out/general.csv")).unwrap());
    assert!(one == other);
    let [one, other] = [&whole, &broken].map(|f| std::fs::read(f.path().join("out/frames/frame_000200.vtu")).unwrap());
    assert!(one == other);
}

/// Rigid bodies that touch: surfaces inside them, no force at the start, the weight on average, an exact balance.
#[test]
fn rigid_bodies_that_touch_start_without_force() {
    let solid = "[[body]]\nname = \"box\"\nmesh = { generator = \"block\", min = [-0.2, -0.2, 0.0], max = [0.2, 0.2, 0.2], divisions = [2, 2, 1] }\n\
         material = { law = \"neo-hooke\", young = 1e6, poisson = 0.3 }\ndensity = 1000.0\n";
    let rigid = "[[rigid]]\nname = \"box\"\nshape = { kind = \"box\", size = [0.4, 0.4, 0.2], divisions = [2, 2, 1] }\nposition = [0.0, 0.0, 0.1]\ndensity = 1000.0\n";
    let floor = "[[rigid]]\nname = \"floor\"\nshape = { kind = \"box\", size = [2.0, 2.0, 0.2] }\nfixed = true\nposition = [0.0, 0.0, -0.1]\n";
    let contact = "[general_contact]\nthickness = 0.008\npairs = [{ between = [\"floor\", \"box\"], modulus = 1e6 }]\n";
    for body in [rigid, solid] {
        let text = head("energy-momentum", 0.0025, 0.5)
            + "[gravity]\nacceleration = [0.0, 0.0, -10.0]\n"
            + floor
            + body
            + contact;
        let mut simulation = simulation(&text);
        assert!(simulation.balance().contact < 1e-20);
        let start = simulation.balance().total();
        let (mut impulse, mut kinetic, mut worst, mut nearest) = (0.0, 0.0_f64, 0.0_f64, f64::INFINITY);
        while !simulation.finished() {
            let record = simulation.advance().unwrap();
            let bodies = &record.contact.as_ref().unwrap().bodies;
            impulse += bodies.iter().map(|pair| pair.force[2].abs()).sum::<f64>() * record.dt;
            nearest = bodies.iter().map(|pair| pair.distance).fold(nearest, f64::min);
            kinetic = kinetic.max(record.balance.kinetic);
            worst = worst.max((record.balance.total() - start).abs());
        }
        assert!(worst < 1e-9 * kinetic, "{worst:e} of {kinetic:e}");
        assert!((impulse / 160.0 - 1.0).abs() < 0.05, "{impulse}");
        assert!((0.004..0.008).contains(&nearest), "{nearest}");
    }
    // Too thin for that.
    let thin = rigid.replace("0.4, 0.2], divisions", "0.4, 0.0035], divisions").replace("0.1]", "0.00175]");
    let error = try_build(&(head("energy-momentum", 0.0025, 0.5) + floor + &thin + contact)).unwrap_err();
    assert!(error.contains("too thin"), "{error}");
}
