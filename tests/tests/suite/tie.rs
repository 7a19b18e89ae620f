//! Mesh ties: patch tests, free flight, a cantilever against a matching mesh, treatments of a curved interface.

use crate::support::{drift, problem_keys, simulation};
use stoss::solver::Simulation;
use stoss_reference_cases::cantilever::{Field, cantilever, error, field};
use stoss_reference_cases::patch::tied_stack as stack;

const LAWS: [&str; 4] = [
    r#"{ law = "neo-hooke", young = 2250.0, poisson = 0.3 }"#,
    r#"{ law = "mooney-rivlin", c1 = 382.6923, c2 = 50.0, c = 549.0385 }"#,
    r#"{ law = "ogden", mu = [1290.4, 2.458, -20.483], alpha = [1.3, 5.0, -2.0], kappa = 1875.0, beta = 9.0 }"#,
    r#"{ law = "saint-venant-kirchhoff", young = 2250.0, poisson = 0.3 }"#,
];
const FORMS: [&str; 2] = ["constant", "frame-invariant"];
const MULTIPLIERS: [&str; 2] = ["standard", "dual"];
const INTERFACES: [&str; 3] = ["move", "keep", "close"];

fn run(simulation: &mut Simulation) {
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
}

fn size(s: &[f64]) -> f64 {
    s.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Largest difference of the Cauchy stress at a Gauss point from that at the first, over its norm.
fn spread(simulation: &Simulation) -> f64 {
    let q = &simulation.state().q;
    let states: Vec<_> = simulation
        .model()
        .bodies
        .iter()
        .flat_map(|body| body.solid.gauss_point_state(q).unwrap().into_iter().flatten())
        .collect();
    let first = states[0].cauchy;
    let difference = |s: &[f64; 6]| size(&std::array::from_fn::<_, 6, _>(|i| s[i] - first[i]));
    states.iter().map(|s| difference(&s.cauchy)).fold(0.0, f64::max) / size(&first)
}

#[test]
fn patch_test() {
    for slopes in [[0.0, 0.0], [0.35, -0.2]] {
        for (slave, master) in [("upper.bottom", "lower.top"), ("lower.top", "upper.bottom")] {
            for (l, law) in LAWS.into_iter().enumerate() {
                for form in FORMS {
                    // Both spaces with the first law, alternating with the others.
                    for (m, multipliers) in MULTIPLIERS.into_iter().enumerate().filter(|(m, _)| l == 0 || l % 2 == *m) {
                        let tie = format!(
                            "slave = \"{slave}\"\nmaster = \"{master}\"\nform = \"{form}\"\nmultipliers = \"{multipliers}\""
                        );
                        let mut simulation = simulation(&stack(law, slopes, &tie));
                        run(&mut simulation);
                        let spread = spread(&simulation);
                        assert!(spread < 1e-10, "{slopes:?} {slave} {law} {form} {multipliers} {m}: {spread:e}");
                        // It is the right one: lateral surfaces are free, the bodies are compressed to 3/4.
                        let state =
                            simulation.model().bodies[0].solid.gauss_point_state(&simulation.state().q).unwrap();
                        let point = &state[0][0];
                        assert!((point.deformation_gradient[2][2] - 0.75).abs() < 1e-10);
                        let s = &point.cauchy;
                        assert!(s[2] < -100.0 && size(&[s[0], s[1], s[3], s[4], s[5]]) < 1e-9 * size(s), "{s:?}");
                    }
                }
            }
        }
    }
}

/// A ball in a ball, glued, of different meshes on the common sphere, thrown and spinning.
fn flight(scheme: &str, tie: &str) -> String {
    let material = LAWS[0];
    format!(
        r#"
[scene]
title = "tied balls"
kind = "dynamic"
[time]
end = 0.16
step = 0.02
integrator = {{ scheme = "{scheme}" }}
[[body]]
name = "inner"
mesh = {{ generator = "hollow-ball", inner_diameter = 0.6, outer_diameter = 1.0, divisions = [2, 1] }}
material = {material}
density = 10.0
velocity = [1.0, 0.5, 0.0]
angular_velocity = [3.0, 0.0, 4.0]
[[body]]
name = "outer"
mesh = {{ generator = "hollow-ball", inner_diameter = 1.0, outer_diameter = 1.4, divisions = [3, 1] }}
material = {material}
density = 5.0
velocity = [1.0, 0.5, 0.0]
angular_velocity = [0.0, 2.0, 4.0]
[[tie]]
{tie}
"#
    )
}

#[test]
fn a_tied_pair_in_free_flight_keeps_momenta_and_energy() {
    for (slave, master) in [("inner.outer", "outer.inner"), ("outer.inner", "inner.outer")] {
        for form in FORMS {
            for interface in INTERFACES {
                let tie = format!(
                    "slave = \"{slave}\"\nmaster = \"{master}\"\nform = \"{form}\"\ninterface = \"{interface}\"\nreach = 0.2"
                );
                let mut simulation = simulation(&flight("energy-momentum", &tie));
                let (mut linear, mut angular, mut energy) = (Vec::new(), Vec::new(), Vec::new());
                // Closing the gap works on the bodies in the first step.
                if interface == "close" {
                    simulation.advance().unwrap();
                }
                let start = simulation.balance().strain;
                let mut strain = 0.0_f64;
                while !simulation.finished() {
                    let record = simulation.advance().unwrap();
                    linear.push(record.balance.linear_momentum);
                    angular.push(record.balance.angular_momentum);
                    energy.push([record.balance.total(), 0.0, 0.0]);
                    strain = strain.max(record.balance.strain);
                }
                let drifts = [drift(&linear), drift(&angular), drift(&energy)];
                let name = format!("{slave} {form} {interface}: {drifts:?}");
                assert!(drifts[0] < 1e-11 && drifts[2] < 1e-11, "{name}");
                // A gap that is kept by Cartesian components keeps its direction: the known defect.
                if form == "constant" && interface == "keep" {
                    assert!(drifts[1] > 1e-6, "{name}");
                } else {
                    assert!(drifts[1] < 1e-11, "{name}");
                }
                assert!(strain > 0.01 * energy[0][0], "the bodies deform: {strain} {start}");
            }
        }
    }
}

#[test]
fn the_midpoint_rule_keeps_momenta() {
    let tie = "slave = \"inner.outer\"\nmaster = \"outer.inner\"\nform = \"frame-invariant\"\ninterface = \"keep\"\nreach = 0.2";
    let mut simulation = simulation(&flight("midpoint", tie));
    let (mut linear, mut angular) = (Vec::new(), Vec::new());
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        linear.push(record.balance.linear_momentum);
        angular.push(record.balance.angular_momentum);
    }
    assert!(drift(&linear) < 1e-11 && drift(&angular) < 1e-11, "{:e} {:e}", drift(&linear), drift(&angular));
}

#[test]
fn nothing_is_strained_at_the_start_unless_the_gap_is_closed() {
    for form in FORMS {
        for interface in INTERFACES {
            let tie = format!(
                "slave = \"inner.outer\"\nmaster = \"outer.inner\"\nform = \"{form}\"\ninterface = \"{interface}\"\nreach = 0.2"
            );
            let mut text = flight("energy-momentum", &tie);
            for line in [
                "velocity = [1.0, 0.5, 0.0]",
                "angular_velocity = [3.0, 0.0, 4.0]",
                "angular_velocity = [0.0, 2.0, 4.0]",
            ] {
                text = text.replace(line, "");
            }
            let mut simulation = simulation(&text);
            simulation.advance().unwrap();
            let strain = simulation.balance().strain;
            if interface == "close" {
                assert!(strain > 1e-3, "{form}: {strain:e}");
            } else {
                assert!(strain < 1e-20, "{form} {interface}: {strain:e}");
            }
        }
    }
}

fn solve(text: &str) -> Vec<Field> {
    let mut simulation = simulation(text);
    run(&mut simulation);
    let (x, q) = (&simulation.model().reference, &simulation.state().q);
    simulation.model().bodies.iter().map(|body| field(body.nodes.clone(), x, q)).collect()
}

#[test]
fn a_tied_cantilever_converges_as_the_matching_mesh() {
    let reference = solve(&cantilever(&[48], "")).remove(0);
    let levels = [1, 2, 4];
    let matching: Vec<f64> =
        levels.iter().map(|k| error(&solve(&cantilever(&[2 * k], "")), &[2 * k], &reference)).collect();
    for tie in [
        "slave = \"b1.left\"\nmaster = \"b0.right\"",
        "slave = \"b0.right\"\nmaster = \"b1.left\"\nmultipliers = \"dual\"\nform = \"frame-invariant\"",
    ] {
        let tied: Vec<f64> = levels
            .iter()
            .map(|k| {
                let parts = [2 * k, 3 * k];
                error(&solve(&cantilever(&parts, tie)), &parts, &reference)
            })
            .collect();
        let order = |e: &[f64], k: usize| (e[k] / e[k + 1]).log2();
        println!("{tie}: {tied:?} matching {matching:?}");
        println!(
            "orders {} {} matching {} {}",
            order(&tied, 0),
            order(&tied, 1),
            order(&matching, 0),
            order(&matching, 1)
        );
        assert!(order(&tied, 1) > 1.9, "{tied:?}");
        assert!((order(&tied, 1) - order(&matching, 1)).abs() < 0.1, "{tied:?} {matching:?}");
        // The other half is finer than the matching mesh, so the tie must not be worse.
        assert!(tied.iter().zip(&matching).all(|(t, m)| t < m), "{tied:?} {matching:?}");
    }
}

#[test]
fn a_surface_that_is_held_wholly_cannot_be_the_slave() {
    let tie = "slave = \"upper.bottom\"\nmaster = \"lower.top\"";
    let text = stack(LAWS[0], [0.0; 2], tie).replace(
        "set = \"upper.top\"\ncomponents = [\"z\"]",
        "set = \"upper.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]",
    );
    let text = text.replace("[[0, 0], [1, -0.5]]", "[[0, 0, 0, 0], [1, 0, 0, -0.1]]");
    let text = text.replace("[[prescribe]]\nset = \"upper.left\"\ncomponents = [\"x\"]\nfixed = true\n", "");
    let text = text.replace("[[prescribe]]\nset = \"upper.front\"\ncomponents = [\"y\"]\nfixed = true\n", "");
    let scene = stoss::scene::parse(&text, "test.toml").unwrap();
    let error = stoss::build::build(&scene, std::path::Path::new(".")).unwrap_err().to_string();
    assert!(error.contains("tie[0]") && error.contains("exchange slave and master"), "{error}");
    // The other way round it is the motion of a rigid platen.
    let exchanged = text.replace(tie, "slave = \"lower.top\"\nmaster = \"upper.bottom\"");
    let mut simulation = simulation(&exchanged);
    run(&mut simulation);
    let (x, q) = (&simulation.model().reference, &simulation.state().q);
    let nodes = simulation.model().bodies[0].nodes.clone().map(|n| 3 * n as usize);
    let top: Vec<usize> = nodes.filter(|k| x[k + 2] == 1.0).collect();
    assert_eq!(top.len(), 25);
    assert!(top.iter().all(|&k| (q[k + 2] - 0.9).abs() < 1e-12));
}

/// A slave that reaches over its master by a third is tied for two thirds, and that is said; a whole one says nothing.
#[test]
fn a_tie_of_a_part_of_the_slave_is_told() {
    let scene = |width: f64| {
        let body = |name: &str, from: f64, to: f64, width: f64| {
            format!(
                "[[body]]\nname = \"{name}\"\ndensity = 1.0\nmaterial = {{ law = \"neo-hooke\", young = 1.0, poisson = 0.3 }}\n\
                 mesh = {{ generator = \"block\", min = [0, 0, {from}], max = [{width}, 1, {to}], divisions = [2, 2, 2] }}\n"
            )
        };
        format!(
            "[scene]\ntitle = \"tie\"\nkind = \"dynamic\"\n[time]\nend = 1.0\nstep = 0.1\n\
             integrator = {{ scheme = \"energy-momentum\" }}\n{}{}[[tie]]\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n",
            body("lower", 0.0, 1.0, 2.0),
            body("upper", 1.0, 2.0, width)
        )
    };
    let warnings = |width: f64| {
        let scene = stoss::scene::parse(&scene(width), "test.toml").unwrap();
        stoss::build::build(&scene, std::path::Path::new(".")).unwrap().warnings
    };
    assert_eq!(warnings(1.5), Vec::<String>::new());
    let told = warnings(3.0);
    assert!(told.len() == 1 && told[0].contains("66.7 % of the slave surface"), "{told:?}");
}

/// A chain of ties, the first one on a surface of which the second one moves nodes: nothing is stressed without a load, in any order.
#[test]
fn ties_that_move_each_others_nodes_are_at_rest() {
    let tie = |slave: &str, master: &str| format!("[[tie]]\nslave = \"{slave}\"\nmaster = \"{master}\"\n");
    let (first, second) = (tie("low.top", "middle.bottom"), tie("middle.right", "side.left"));
    for ties in [format!("{first}{second}"), format!("{second}{first}")] {
        let mut s = simulation(&format!(
            r#"
[scene]
title = "chain"
kind = "quasi-static"
[time]
end = 1.0
step = 1.0
[[body]]
name = "low"
mesh = {{ generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [3, 3, 2] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "middle"
mesh = {{ generator = "block", min = [0, 0, 1], max = [2, 2, 2], divisions = [4, 4, 3] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "side"
mesh = {{ generator = "block", min = [2.06, 0, 1], max = [3, 2, 2], divisions = [2, 3, 2] }}
rotation = {{ axis = [0, 0, 1], degrees = 3 }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
{ties}
[[prescribe]]
set = "low.bottom"
components = ["x", "y", "z"]
fixed = true
"#
        ));
        run(&mut s);
        assert!(s.balance().strain < 1e-20, "{:e}\n{ties}", s.balance().strain);
    }
}

/// A block that is tied at one side and pressed on another body by its lower side: the nodes of the common edge have the rows of the tie only.
#[test]
fn an_edge_of_a_tie_and_a_contact_is_regular() {
    for multipliers in MULTIPLIERS {
        let mut s = simulation(&format!(
            r#"
[scene]
title = "corner"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "low"
mesh = {{ generator = "block", min = [0, 0, 0], max = [3, 2, 1], divisions = [3, 2, 1] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "wall"
mesh = {{ generator = "block", min = [-1, 0, 1], max = [0, 2, 2], divisions = [2, 2, 2] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [0, 0, 1], max = [1.5, 2, 2], divisions = [3, 3, 3] }}
material = {{ law = "neo-hooke", young = 1000.0, poisson = 0.3 }}
[[tie]]
slave = "upper.left"
master = "wall.right"
[[contact]]
method = "mortar"
multipliers = "{multipliers}"
slave = "upper.bottom"
master = "low.top"
[[prescribe]]
set = "low.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "wall.left"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "upper.top"
pressure = {{ table = [[0, 0], [1, 60]] }}
"#
        ));
        let mut force = [0.0; 3];
        while !s.finished() {
            force = s.advance().unwrap().contact.unwrap().force_on_slave;
        }
        assert!(s.decisions().is_empty(), "{multipliers}: {:?}", s.decisions());
        // That of the contact without what the tie holds: the load is shared between both.
        let all: f64 = (0..s.model().node_count()).map(|n| s.reactions()[3 * n + 2]).sum();
        let wall: f64 = s.model().bodies[1].nodes.clone().map(|n| s.reactions()[3 * n as usize + 2]).sum();
        assert!(wall > 1.0 && (force[2] - (all - wall)).abs() < 1e-9 * all, "{multipliers}: {force:?} {all} {wall}");
    }
}

/// A tie holds its surfaces at each other: a contact between them is refused, whichever is the slave; one between others is not.
#[test]
fn a_contact_between_tied_surfaces_is_refused() {
    let tie = "slave = \"upper.bottom\"\nmaster = \"lower.top\"";
    let contact = |slave: &str, master: &str| {
        format!(
            "{}\n[[contact]]\nmethod = \"mortar\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n",
            stack(LAWS[0], [0.0, 0.0], tie)
        )
    };
    for (slave, master) in [("upper.bottom", "lower.top"), ("lower.top", "upper.bottom")] {
        assert_eq!(problem_keys(&contact(slave, master)), ["contact[0]"]);
    }
    simulation(&contact("upper.left", "lower.top"));
}
