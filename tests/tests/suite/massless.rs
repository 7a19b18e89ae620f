//! Contact surfaces without mass (theory/impacts#massless): moments of the mass, momenta and energy, rebounds that lose nothing, weight, history, refusals.

use crate::support::{problem_keys, simulation};
use stoss::fe_solid::{MassKind, Massless, SolidBody};
use stoss::materials::NeoHooke;
use stoss::mesh::Mesh;
use stoss::mesh::generate::Block;
use stoss::reference_element::CellKind;
use stoss::solver::Simulation;

const FLOOR: &str = "[[rigid]]\nname = \"floor\"\nshape = { kind = \"plane\", size = [10, 10] }\nfixed = true\n";

fn head(scheme: &str, end: f64, step: f64) -> String {
    format!(
        "[scene]\ntitle = \"massless\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = {step:?}\nintegrator = {{ scheme = \"{scheme}\" }}\n"
    )
}

fn contact(method: &str, more: &str) -> String {
    format!(
        "[[contact]]\nslave = \"bar.bottom\"\nmaster = \"floor.all\"\nmethod = \"{method}\"\nsurface_mass = \"none\"\n{more}"
    )
}

/// A block of `n` cubes with the length one, moduli and density one but for `young`.
fn block(n: [u32; 3], height: f64, young: f64, poisson: f64, more: &str) -> String {
    let [x, y] = [n[0], n[1]].map(|n_i| f64::from(n_i) / f64::from(n[2]));
    format!(
        "[[body]]\nname = \"bar\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [{x:?}, {y:?}, 1], divisions = {n:?} }}\nposition = [0, 0, {height:?}]\n\
         material = {{ law = \"saint-venant-kirchhoff\", young = {young:?}, poisson = {poisson:?} }}\ndensity = 1.0\n{more}"
    )
}

fn drop(method: &str, n: [u32; 3], courant: f64, phase: f64, speed: f64, scheme: &str, more: &str) -> String {
    let dt = courant / f64::from(n[2]);
    let velocity = format!("velocity = [0, 0, {:?}]\n{more}", -speed);
    head(scheme, 3.4 + 3.0 * dt, dt)
        + &block(n, speed * dt * (1.0 + phase), 1.0, 0.0, &velocity)
        + FLOOR
        + &contact(method, "")
}

/// Rebound, energy that is left, and the worst change of the energy and its losses in the run, beside the first.
fn rebound(text: &str) -> [f64; 3] {
    let mut simulation = simulation(text);
    let first = *simulation.balance();
    let mut worst = 0.0_f64;
    while !simulation.finished() {
        let now = simulation.advance().unwrap_or_else(|e| panic!("{e}")).balance;
        worst = worst.max((now.total() + now.closing_loss + now.impact_loss - first.total()).abs() / first.kinetic);
    }
    let now = *simulation.balance();
    assert_eq!((now.impacts, now.impact_loss), (0, 0.0));
    [-now.linear_momentum[2] / first.linear_momentum[2], now.total() / first.total(), worst]
}

/// Mass, centre and second moments are those of the body, whatever velocities the nodes without mass are given: kinetic energy and momenta of fields that are linear in the place.
#[test]
fn moments_of_the_mass_are_those_of_the_body() {
    for kind in CellKind::ALL {
        for divisions in [[2, 2, 2], [3, 2, 6], [1, 1, 8]] {
            let block = Block::new([0.3, -0.2, 0.1], [1.3, 0.5, 2.1], divisions).generate().unwrap();
            let mesh: Mesh = block.with_cells(kind).unwrap();
            let law = std::sync::Arc::new(NeoHooke::from_young_poisson(1.0, 0.3).unwrap());
            let body = SolidBody::new("a", &mesh, 0, law).unwrap();
            let bottom = mesh.nodes_of("bottom").unwrap();
            let massless = Massless::new(&body, MassKind::Consistent, bottom.iter().copied()).unwrap();
            let (own, other) = (body.mass(7.0, MassKind::Consistent), massless.mass(&body, 7.0, MassKind::Consistent));
            let q: Vec<f64> = mesh.nodes.iter().flatten().copied().collect();
            for seed in 0..4 {
                let random = |k: usize| ((12.9898 * (17 * seed + k) as f64).sin() * 43758.5453).fract();
                let v: Vec<f64> = (mesh.nodes.iter())
                    .flat_map(|x| {
                        (0..3).map(move |i| (0..3).map(|j| random(3 * i + j) * x[j]).sum::<f64>() + random(9 + i))
                    })
                    .collect();
                let mut elsewhere = v.clone();
                bottom.iter().for_each(|&node| elsewhere[3 * node as usize] += 5.0);
                let size = own.total() * 10.0;
                let off = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max) / size;
                let name = format!("{kind} {divisions:?} {:?}", massless.least_density());
                assert!((own.kinetic_energy(&v) - other.kinetic_energy(&elsewhere)).abs() < 1e-13 * size, "{name}");
                assert!(off(own.linear_momentum(&v), other.linear_momentum(&elsewhere)) < 1e-13, "{name}");
                assert!(off(own.angular_momentum(&q, &v), other.angular_momentum(&q, &elsewhere)) < 1e-13, "{name}");
            }
            let mut diagonal = vec![0.0; q.len()];
            other.add_diagonal(&mut diagonal);
            let has_mass = |node: usize| diagonal[3 * node] > 0.0;
            assert!((0..mesh.nodes.len()).all(|node| has_mass(node) != bottom.contains(&(node as u32))), "{kind}");
        }
    }
}

/// A body that tumbles in space, strained by its spin.
#[test]
fn momenta_and_energy_of_a_free_body_are_constant() {
    for cell in ["", "cell = \"hex20\"\n", "cell = \"tet10\"\n"] {
        for n in [[2, 2, 2], [2, 2, 6]] {
            let more = format!("velocity = [0.1, 0.2, 0.3]\nangular_velocity = [0.4, -0.7, 0.5]\n{cell}");
            let text = head("energy-momentum", 4.0, 0.05)
                + &block(n, 0.0, 1.0, 0.3, &more)
                + &FLOOR.replace("fixed", "position = [0, 0, -50]\nfixed")
                + &contact("nts", "");
            let mut simulation = simulation(&text);
            let (first, mut strain) = (*simulation.balance(), 0.0_f64);
            while !simulation.finished() {
                strain = strain.max(simulation.advance().unwrap().balance.strain);
            }
            let now = *simulation.balance();
            assert!(strain > 1e-4 * now.kinetic, "{cell}{n:?}: {strain:e}");
            let off = |a: [f64; 3], b: [f64; 3]| {
                let size = b.iter().map(|b| b * b).sum::<f64>().sqrt();
                (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max) / size
            };
            assert!(off(now.linear_momentum, first.linear_momentum) < 1e-12, "{cell}{n:?}");
            assert!(off(now.angular_momentum, first.angular_momentum) < 1e-12, "{cell}{n:?}");
            assert!((now.total() / first.total() - 1.0).abs() < 1e-12, "{cell}{n:?}: {now:?}");
        }
    }
}

/// No energy is lost, at any phase of the step, and the rebound is that of the mesh (1 without vibration).
#[test]
fn a_cube_rebounds_with_all_of_its_energy() {
    for method in ["nts", "mortar"] {
        let all: Vec<[f64; 3]> = (0..10)
            .map(|k| rebound(&drop(method, [2; 3], 0.3, (f64::from(k) + 0.5) / 10.0, 1e-4, "energy-momentum", "")))
            .collect();
        assert!(all.iter().all(|of| (of[1] - 1.0).abs() < 1e-10 && of[2] < 1e-10), "{method}: {all:?}");
        assert!(all.iter().all(|of| (of[0] - 0.997).abs() < 3e-3), "{method}: {all:?}");
        assert!(all.iter().all(|of| (of[0] - all[0][0]).abs() < 1e-6), "{method}: {all:?}");
    }
}

/// Exact: 1. Values of an implementation of its own with dense algebra.
#[test]
fn bars_rebound() {
    for (n, expected) in [(6, 0.968), (8, 0.988), (10, 0.993)] {
        let [rebound, energy, _] = rebound(&drop("nts", [1, 1, n], 0.3, 0.4, 1e-4, "energy-momentum", ""));
        assert!((rebound - expected).abs() < 3e-3 && (energy - 1.0).abs() < 1e-10, "{n}: {rebound} {energy}");
    }
}

#[test]
fn other_cells_rebound_with_all_of_their_energy() {
    for cell in ["hex20", "hex27", "tet4", "tet10"] {
        let more = format!("cell = \"{cell}\"\n");
        let [rebound, energy, worst] = rebound(&drop("mortar", [3; 3], 0.3, 0.4, 1e-4, "energy-momentum", &more));
        assert!((energy - 1.0).abs() < 1e-10 && worst < 1e-10 && rebound > 0.6, "{cell}: {rebound} {energy}");
    }
}

/// A block slides and stops after `v / (mu g)`, and all of its energy is heat: with its mass the surface loses a part of it where nodes close again and again.
#[test]
fn a_block_slides_to_rest() {
    for method in ["nts", "mortar"] {
        let text = head("energy-momentum", 0.6, 0.005)
            + "[gravity]\nacceleration = [0, 0, -9.81]\n[[body]]\nname = \"bar\"\nmesh = { generator = \"block\", min = [0, 0, 0], max = [1, 1, 0.5], divisions = [4, 4, 2] }\n\
               material = { law = \"saint-venant-kirchhoff\", young = 1e4, poisson = 0.3 }\ndensity = 1.0\nvelocity = [1, 0, 0]\n"
            + FLOOR
            + &contact(method, "friction = { law = \"coulomb\", mu = 0.3 }\n");
        let mut simulation = simulation(&text);
        let (mut stop, mut half) = (f64::NAN, f64::NAN);
        while !simulation.finished() {
            let record = simulation.advance().unwrap();
            let speed = record.balance.linear_momentum[0] / 0.5;
            half = if (record.time - 0.2).abs() < 1e-9 { speed } else { half };
            stop = if stop.is_nan() && speed < 0.01 { record.time } else { stop };
        }
        let now = *simulation.balance();
        assert!((half - (1.0 - 0.3 * 9.81 * 0.2)).abs() < 1e-3, "{method}: {half}");
        assert!((stop - 1.0 / (0.3 * 9.81)).abs() < 0.005, "{method}: {stop}");
        assert!((now.dissipation / 0.25 - 1.0).abs() < 5e-3 && now.closing_loss.abs() < 1e-10, "{method}: {now:?}");
    }
}

#[test]
fn a_body_falls_without_strain() {
    for load in ["[gravity]\nacceleration = [0, 0, -1]\n", "[[load]]\nbody = \"bar\"\nacceleration = [0, 0, -1]\n"] {
        for mass in ["", "mass = \"lumped\"\n", "damping = { mass = 0.3 }\n"] {
            let text = head("energy-momentum", 1.0, 0.05)
                + &block([2, 2, 4], 50.0, 10.0, 0.3, mass)
                + FLOOR
                + &contact("nts", "")
                + load;
            let mut simulation = simulation(&text);
            while !simulation.finished() {
                simulation.advance().unwrap();
            }
            let now = *simulation.balance();
            assert!(now.kinetic > 0.09 && now.strain < 1e-22, "{load}{mass}: {now:?}");
        }
    }
}

/// Rest under gravity: the floor carries the weight, and held gaps settle.
#[test]
fn a_body_comes_to_rest_on_a_floor() {
    for method in ["nts", "mortar"] {
        let more = "damping = { stiffness = 0.02 }\n";
        let text = head("energy-momentum", 4.0, 0.01)
            + &block([2, 2, 4], 0.003, 1000.0, 0.3, more)
            + FLOOR
            + &contact(method, "settle = 20\n")
            + "[gravity]\nacceleration = [0, 0, -1]\n";
        let mut simulation = simulation(&text);
        while !simulation.finished() {
            simulation.advance().unwrap();
        }
        let force: f64 = simulation.contact_force().chunks_exact(3).map(|f| f[2].max(0.0)).sum();
        let low = simulation.state().q[..3 * 45].chunks_exact(3).map(|x| x[2]).fold(f64::MAX, f64::min);
        assert!((force / 0.25 - 1.0).abs() < 1e-3 && low.abs() < 1e-6, "{method}: {force} {low:e}");
    }
}

#[test]
fn resumed_runs_have_the_same_bits() {
    let text = drop("mortar", [2, 2, 6], 0.3, 0.3, 1e-2, "energy-momentum", "");
    let mut straight = simulation(&text);
    let mut checkpoint = None;
    while !straight.finished() {
        straight.advance().unwrap();
        if checkpoint.is_none() && straight.active()[0].contains(&true) {
            checkpoint = Some(straight.checkpoint("t", Default::default()));
        }
    }
    let mut resumed: Simulation = simulation(&text);
    resumed.restore(checkpoint.unwrap(), "t").unwrap();
    while !resumed.finished() {
        resumed.advance().unwrap();
    }
    assert!(straight.state().q == resumed.state().q && straight.state().v == resumed.state().v);
    assert_eq!(straight.balance(), resumed.balance());
}

/// Schemes that ask for no acceleration: the midpoint rule keeps the energy nearly, backward Euler loses some and leaves nothing of the mass of the nodes behind.
#[test]
fn schemes_that_ask_for_no_mass_of_every_node() {
    for (scheme, least) in [("midpoint", 0.999), ("backward-euler", 0.5)] {
        let [rebound, energy, _] = rebound(&drop("nts", [2, 2, 8], 0.1, 0.3, 1e-3, scheme, ""));
        assert!(rebound > 0.7 && energy > least && energy < 1.0 + 1e-3, "{scheme}: {rebound} {energy}");
    }
}

#[test]
fn what_cannot_be_had_is_refused() {
    let with = |n, scheme: &str, method: &str, more: &str| {
        problem_keys(&(head(scheme, 1.0, 0.1) + &block(n, 0.1, 1.0, 0.0, "") + FLOOR + &contact(method, more)))
    };
    const KEY: [&str; 1] = ["contact[0].surface_mass"];
    // A single element across.
    assert_eq!(with([2, 2, 1], "energy-momentum", "nts", ""), KEY);
    // Schemes that need the mass of every node.
    for scheme in ["newmark", "trapezoidal", "variational-midpoint"] {
        assert_eq!(with([2, 2, 2], scheme, "nts", ""), KEY, "{scheme}");
    }
    assert_eq!(with([2, 2, 2], "energy-momentum", "cat", ""), KEY);
    // There is no impact.
    assert_eq!(with([2, 2, 2], "energy-momentum", "nts", "restitution = 0.5\n"), ["contact[0].restitution"]);
    assert_eq!(with([2, 2, 2], "energy-momentum", "nts", "closing = \"impact\"\n"), ["contact[0].closing"]);
    // All faces of two elements in each direction: a single node is left.
    let all = head("energy-momentum", 1.0, 0.1) + &block([2, 2, 2], 0.1, 1.0, 0.0, "") + FLOOR;
    assert_eq!(problem_keys(&(all + &contact("nts", "").replace("bar.bottom", "bar.boundary"))), KEY);
    // No side is deformable.
    let rigid = FLOOR.replace("floor", "bar").replace("plane\", size = [10, 10]", "box\", size = [1, 1, 1]");
    let rigid = rigid.replace("fixed = true", "density = 1.0");
    assert_eq!(problem_keys(&(head("energy-momentum", 1.0, 0.1) + &rigid + FLOOR + &contact("nts", ""))), KEY);
}

/// Few elements behind the surface: the rebound may be off, which is said.
#[test]
fn few_elements_behind_the_surface_are_warned_of() {
    let warned = |n| {
        let text = drop("nts", n, 0.3, 0.3, 1e-4, "energy-momentum", "");
        let scene = stoss::scene::parse(&text, "test.toml").unwrap();
        let built = stoss::build::build(&scene, std::path::Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        built.warnings.iter().any(|warning| warning.contains("without mass"))
    };
    assert!(warned([2, 2, 5]) && !warned([2, 2, 6]));
}
