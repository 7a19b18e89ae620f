//! Elements of all kinds through scenes: contact and ties on their faces, conservation, what frames show.

use crate::support::{drift, simulation, simulation_in, two_blocks};
use std::path::Path;
use stoss::build::build;
use stoss::run::{RunOptions, run_scene};
use stoss::watch::Severity;

const NTS: &str = "method = \"nts\"\nfriction = { law = \"coulomb\", mu = 0.3 }";
const MORTAR: &str = "method = \"mortar\"\nfriction = { law = \"coulomb\", mu = 0.3 }";
const CELLS: [&str; 7] = ["hex8", "hex20", "hex27", "tet4", "tet10", "wedge6", "wedge15"];

/// Two blocks on each other with meshes that do not match, pressed together by a uniform pressure.
fn pressed(lower: &str, upper: &str, interface: &str) -> String {
    let fixed =
        |set: &str, axis: &str| format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{axis}\"]\nfixed = true\n");
    let body = |name: &str, cell: &str, z: [f64; 2], n: u32| {
        format!(
            "[[body]]\nname = \"{name}\"\ncell = \"{cell}\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
             mesh = {{ generator = \"block\", min = [0, 0, {:?}], max = [1, 1, {:?}], divisions = [{n}, {n}, 1] }}\n",
            z[0], z[1]
        )
    };
    format!(
        "[scene]\ntitle = \"patch\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n{}{}{interface}{}{}{}{}{}\
         [[load]]\nset = \"upper.top\"\npressure = {{ table = [[0.0, 0.0], [1.0, 200.0]] }}\n",
        body("lower", lower, [0.0, 1.0], 3),
        body("upper", upper, [1.0, 2.0], 2),
        fixed("lower.left", "x"),
        fixed("lower.front", "y"),
        fixed("lower.bottom", "z"),
        fixed("upper.left", "x"),
        fixed("upper.front", "y"),
    )
}

/// Cauchy stress of a free neo-Hooke block (E = 1000, nu = 0.3) under a dead pressure of 200: with the stretches `a` across and `b` along it
/// `mu (b - 1/b) + lambda ln(a^2 b)/b = -200`, `mu (a - 1/a) + lambda ln(a^2 b)/a = 0`, and the stress is `-200 / a^2`. By Newton's method with differences.
fn uniaxial_stress() -> f64 {
    let (mu, lambda) = (1000.0 / 2.6, 1000.0 * 0.3 / (1.3 * 0.4));
    let residual = |[a, b]: [f64; 2]| {
        let volume: f64 = lambda * (a * a * b).ln();
        [mu * (b - 1.0 / b) + volume / b + 200.0, mu * (a - 1.0 / a) + volume / a]
    };
    let mut x = [1.0, 1.0];
    for _ in 0..20 {
        let (r, h) = (residual(x), 1e-6);
        let by =
            [residual([x[0] + h, x[1]]), residual([x[0], x[1] + h])].map(|p| [(p[0] - r[0]) / h, (p[1] - r[1]) / h]);
        let det = by[0][0] * by[1][1] - by[1][0] * by[0][1];
        x[0] -= (r[0] * by[1][1] - by[1][0] * r[1]) / det;
        x[1] -= (by[0][0] * r[1] - r[0] * by[0][1]) / det;
    }
    -200.0 / (x[0] * x[0])
}

/// The nodal forces of a uniform pressure pass through the interface exactly, whatever the cells on both sides: the stress is uniform
/// (theory/mortar#faces).
#[test]
fn a_uniform_pressure_passes_between_any_cells() {
    let mortar = "[[contact]]\nmethod = \"mortar\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n";
    let dual =
        "[[contact]]\nmethod = \"mortar\"\nslave = \"lower.top\"\nmaster = \"upper.bottom\"\nmultipliers = \"dual\"\n";
    let tie = "[[tie]]\nslave = \"lower.top\"\nmaster = \"upper.bottom\"\n";
    for (lower, upper) in CELLS.iter().flat_map(|lower| CELLS.map(|upper| (*lower, upper))) {
        for (interface, bound) in [(mortar, 1e-10), (dual, 1e-10), (tie, 1e-10)] {
            let mut simulation = simulation(&pressed(lower, upper, interface));
            while !simulation.finished() {
                simulation.advance().unwrap_or_else(|e| panic!("{lower}, {upper}: {e}"));
            }
            let q = &simulation.state().q;
            let mut stresses = Vec::new();
            for body in &simulation.model().bodies {
                stresses
                    .extend(body.solid.gauss_point_state(q).unwrap().into_iter().flatten().map(|point| point.cauchy));
            }
            let first = stresses[0];
            assert!((first[2] / uniaxial_stress() - 1.0).abs() < 1e-7, "{lower}, {upper}: {first:?}");
            for stress in &stresses {
                let off = (0..6).map(|i| (stress[i] - first[i]).abs()).fold(0.0, f64::max);
                assert!(off < bound * first[2].abs(), "{lower}, {upper}, {interface}: {stress:?} {first:?}");
            }
        }
    }
}

/// Momenta and energy through contact with friction on triangular faces and on curved ones of quadratic cells. The ledger has friction and what
/// closing costs.
#[test]
fn cells_hit_and_slide_without_drift() {
    for cell in ["tet4", "wedge6", "tet10", "hex20", "hex27", "wedge15"] {
        for contact in [NTS, MORTAR, ""] {
            let text = two_blocks("energy-momentum", 0.1, 6.0, [0.0; 3], contact);
            let text = text.replace("[[body]]", &format!("[[body]]\ncell = \"{cell}\""));
            let general = contact.is_empty();
            let text = if general { text[..text.find("[[contact]]").unwrap()].to_owned() } else { text };
            let mut simulation = simulation(&text);
            let start = *simulation.balance();
            let (mut linear, mut angular) = (vec![start.linear_momentum], vec![start.angular_momentum]);
            let mut touched = false;
            while !simulation.finished() {
                let record = simulation.advance().unwrap_or_else(|e| panic!("{cell}, {contact}: {e}"));
                linear.push(record.balance.linear_momentum);
                angular.push(record.balance.angular_momentum);
                touched |= simulation.active().iter().flatten().any(|active| *active)
                    || record.contact.is_some_and(|contact| contact.bodies.iter().any(|pair| pair.active > 0));
            }
            assert!(touched, "{cell}, {contact}");
            assert!(
                drift(&linear) < 1e-12 && drift(&angular) < 1e-12,
                "{cell}, {contact}: {} {}",
                drift(&linear),
                drift(&angular)
            );
            let end = simulation.balance();
            let change = (end.total() + end.closing_loss + end.impact_loss) / start.total() - 1.0;
            assert!(change.abs() < 1e-11, "{cell}, {contact}: {change}");
        }
    }
}

/// Frames have the nodes of the meshes and no others; contact fields stand at nodes on edges, too; the watch finds nothing.
#[test]
fn frames_show_nodes_and_not_what_contact_sees() {
    let folder = tempfile::tempdir().unwrap();
    let interface = "[[contact]]\nmethod = \"mortar\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n";
    let text = pressed("hex20", "tet10", interface);
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, &text).unwrap();
    let simulation = simulation(&text);
    let model = simulation.model();
    let nodes: usize = model.bodies.iter().map(|body| body.nodes.len()).sum();
    assert!(model.node_count() > nodes && model.traces.len() == model.node_count() - nodes);
    let options = RunOptions { out: folder.path().join("out"), ..RunOptions::default() };
    let outcome = run_scene(&path, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(outcome.verdict.level, Severity::Sound);
    let frame = stoss::mesh_io::read_vtu(folder.path().join("out/frames/frame_000001.vtu")).unwrap();
    assert_eq!(frame.points.len(), nodes);
    let kinds: Vec<String> = frame.elements.kinds().iter().map(|kind| kind.to_string()).collect();
    assert_eq!(kinds, ["hex20", "tet10"]);
    let field = |name: &str| &frame.point_data[name].values;
    // Vertices in the middles of the lower body's faces come between the nodes of both bodies in the model, not in the frame.
    let lower = model.bodies[0].nodes.len();
    let (mut on_edges, mut corners) = (0, 0);
    for node in lower..nodes {
        let [x, y, z] = frame.points[node];
        if z == 1.0 {
            let pressure = field("contact_pressure")[node];
            assert!((pressure / -uniaxial_stress() - 1.0).abs() < 1e-6, "{x} {y}: {pressure}");
            let is_corner = [x, y].iter().all(|x: &f64| (2.0 * x).fract() == 0.0);
            if is_corner { corners += 1 } else { on_edges += 1 }
        }
    }
    assert_eq!((corners, on_edges), (9, 16));
}

/// A cantilever of one element in thickness, ten times as long as high, under a load at its tip that bends it little: deflections over those of
/// Timoshenko's beam, for each cell.
#[test]
fn cells_bend_as_they_should() {
    let tip = |keys: &str, across: u32| {
        let text = format!(
            "[scene]\ntitle = \"cantilever\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n\
             [[body]]\nname = \"beam\"\n{keys}mesh = {{ generator = \"block\", min = [0, 0, 0], max = [10, 1, 1], divisions = [5, 1, {across}] }}\n\
             material = {{ law = \"saint-venant-kirchhoff\", young = 1e6, poisson = 0.0 }}\n\
             [[prescribe]]\nset = \"beam.left\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
             [[load]]\nset = \"beam.right\"\ntotal_force = {{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, -1.0]] }}\n"
        );
        let mut simulation = simulation(&text);
        while !simulation.finished() {
            simulation.advance().unwrap();
        }
        let model = simulation.model();
        let at = |node: usize| &model.reference[3 * node..3 * node + 3];
        let nodes: Vec<usize> = (0..model.node_count()).filter(|&n| at(n)[0] == 10.0).collect();
        let sum: f64 = nodes.iter().map(|&n| simulation.state().q[3 * n + 2] - at(n)[2]).sum();
        // F l^3 / (3 E I) + F l / (5/6 G A)
        let exact = 1000.0 / (3.0 * 1e6 / 12.0) + 10.0 / (5.0 / 6.0 * 0.5e6);
        -sum / nodes.len() as f64 / exact
    };
    let cases: [(&str, [f64; 2]); 8] = [
        ("", [0.2, 0.4]),
        ("cell = \"tet4\"\n", [0.05, 0.3]),
        ("cell = \"hex20\"\n", [0.98, 1.0]),
        ("cell = \"hex20\"\nintegration = \"reduced\"\n", [0.98, 1.01]),
        ("cell = \"hex27\"\n", [0.98, 1.0]),
        ("cell = \"tet10\"\n", [0.98, 1.0]),
        ("cell = \"tet10\"\nintegration = \"reduced\"\n", [0.98, 1.02]),
        ("cell = \"wedge15\"\n", [0.98, 1.0]),
    ];
    for (keys, [low, high]) in cases {
        // A single row of hex20 with reduced integration has modes without stiffness.
        let found = tip(keys, if keys.contains("reduced") { 2 } else { 1 });
        println!("{keys:?}: {found:.4}");
        assert!((low..=high).contains(&found), "{keys}: {found}");
    }
}

/// What a body cannot be made of is refused at its key.
#[test]
fn cells_and_rules_that_do_not_fit_are_refused() {
    let refused = |keys: &str, law: &str| {
        let text = format!(
            "[scene]\ntitle = \"t\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n\
             [[body]]\nname = \"a\"\n{keys}\nmesh = {{ generator = \"ball\", radius = 1.0, divisions = [2, 2, 2] }}\n\
             material = {{ law = \"{law}\", young = 1e6, poisson = 0.3 }}\n"
        );
        let scene = stoss::scene::parse(&text, "test.toml").unwrap();
        build(&scene, Path::new(".")).err().map(|error| error.to_string()).unwrap_or_default()
    };
    assert!(refused("cell = \"wedge6\"", "neo-hooke").contains("body[0].cell"));
    let reduced = refused("integration = \"reduced\"", "neo-hooke");
    assert!(reduced.contains("body[0].integration") && reduced.contains("hex8 has no reduced"), "{reduced}");
    assert!(refused("volumetric = \"mixed\"", "saint-venant-kirchhoff").contains("body[0].volumetric"));
    assert_eq!(refused("volumetric = \"mixed\"\ncell = \"tet10\"\nintegration = \"reduced\"", "neo-hooke"), "");
}

/// Quadratic meshes that are tied may be closed at the start: nodes on edges move with their vertices.
#[test]
fn a_tie_closes_small_gaps_of_quadratic_faces() {
    let text = pressed("hex20", "tet10", "[[tie]]\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n")
        .replace("min = [0, 0, 1.0]", "min = [0, 0, 1.001]");
    let simulation = simulation_in(&text, Path::new("."));
    let model = simulation.model();
    for node in model.bodies[1].nodes.clone() {
        let z = model.reference[3 * node as usize + 2];
        assert!(z < 1.0005 && (z - 1.0).abs() < 1e-12 || z > 1.4, "{z}");
    }
}

/// Initial accelerations come from a solve with the mass, consistent or lumped: a body that turns while it falls has that of its centre, and each node what the centripetal stress gives
/// it; without stress all nodes fall with `g`.
#[test]
fn masses_of_all_cells_are_solved_with() {
    for cell in CELLS {
        for (mass, turn) in [("consistent", 0.0), ("lumped", 0.0), ("consistent", 3.0)] {
            let text = format!(
                "[scene]\ntitle = \"fall\"\nkind = \"dynamic\"\n[time]\nend = 0.2\nstep = 0.05\nintegrator = {{ scheme = \"newmark\" }}\n\
                 [gravity]\nacceleration = [0.0, 0.0, -10.0]\n\
                 [[body]]\nname = \"a\"\ncell = \"{cell}\"\nmass = \"{mass}\"\ndensity = 2.0\nmaterial = {{ law = \"neo-hooke\", young = 1e4, poisson = 0.3 }}\n\
                 mesh = {{ generator = \"block\", size = [1, 2, 1], divisions = [2, 2, 2], grading = [1.5, 1, 2] }}\nangular_velocity = [0.0, 0.0, {turn:?}]\n"
            );
            let mut simulation = simulation(&text);
            while !simulation.finished() {
                simulation.advance().unwrap_or_else(|e| panic!("{cell}, {mass}, {turn}: {e}"));
            }
            let (model, state) = (simulation.model(), simulation.state());
            let masses = model.bodies[0].solid.mass(1.0, stoss::fe_solid::MassKind::Consistent);
            let momentum = masses.linear_momentum(&state.v);
            // The volume is 2, and v = g t.
            assert!((momentum[2] + 2.0 * 10.0 * 0.2).abs() < 1e-10, "{cell}, {mass}: {momentum:?}");
            for (q, x) in state.q.chunks_exact(3).zip(model.reference.chunks_exact(3)).filter(|_| turn == 0.0) {
                assert!((q[2] - x[2] + 0.2).abs() < 1e-12, "{cell}, {mass}: {q:?} {x:?}");
            }
        }
    }
}

/// Tied quadratic meshes that bend: multipliers of vertices on the faces of deformable bodies are not regularised, as those between rigid bodies are, so that Newton's method ends
/// quadratically.
#[test]
fn iterations_with_ties_of_quadratic_faces_end_quadratically() {
    let body = |name: &str, cell: &str, z: [f64; 2]| {
        format!(
            "[[body]]\nname = \"{name}\"\ncell = \"{cell}\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
             mesh = {{ generator = \"block\", min = [0, 0, {:?}], max = [1, 1, {:?}], divisions = [2, 2, 2] }}\n",
            z[0], z[1]
        )
    };
    for (lower, upper) in [("hex20", "hex20"), ("tet10", "tet10"), ("hex27", "wedge15"), ("hex8", "hex20")] {
        let text = format!(
            "[scene]\ntitle = \"tie\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n[solver]\npolish = true\n{}{}\
             [[tie]]\nslave = \"b.bottom\"\nmaster = \"a.top\"\n\
             [[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
             [[load]]\nset = \"b.top\"\ntotal_force = {{ table = [[0.0, 0.0, 0.0, 0.0], [1.0, 20.0, 0.0, 0.0]] }}\n",
            body("a", lower, [0.0, 1.5]),
            body("b", upper, [1.5, 3.0]),
        );
        let mut simulation = simulation(&text);
        let record = simulation.advance().unwrap_or_else(|e| panic!("{lower}, {upper}: {e}"));
        let residuals: Vec<f64> = record.newton.iter().map(|row| row.residual).collect();
        let small = residuals.iter().position(|r| *r < 1e-3).unwrap_or(residuals.len());
        // From below 1e-3 to round-off: 1e-6, 1e-12; one more where the constant is not small.
        assert!(residuals.len() - small <= 4, "{lower}, {upper}: {residuals:?}");
        assert!(residuals.last().unwrap() < &1e-11, "{lower}, {upper}: {residuals:?}");
    }
}

/// Forces of contact and ties on quadratic bodies are at the nodes of their elements: their resultant is the load.
#[test]
fn contact_forces_on_quadratic_faces_are_those_of_their_bodies() {
    for interface in [
        "[[contact]]\nmethod = \"mortar\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n",
        "[[tie]]\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n",
    ] {
        for (lower, upper) in [("hex20", "tet10"), ("hex8", "hex27"), ("wedge15", "hex20")] {
            let mut simulation = simulation(&pressed(lower, upper, interface));
            while !simulation.finished() {
                simulation.advance().unwrap_or_else(|e| panic!("{lower}, {upper}: {e}"));
            }
            let force = |body: usize| -> f64 {
                let nodes = simulation.model().bodies[body].nodes.clone();
                nodes.map(|n| simulation.contact_force()[3 * n as usize + 2]).sum()
            };
            let top = force(1);
            assert!(top > 1.0 && (top + force(0)).abs() < 1e-9 * top, "{lower}, {upper}: {top} {}", force(0));
            let expected = 200.0;
            assert!((top - expected).abs() < 1e-8 * expected, "{lower}, {upper}: {top}");
        }
    }
}

/// A plate of these cells on springs of 2000 an area below it, 0.25 high, without lateral strain; `end` and `motion` make a run of it.
fn on_foundation(cell: &str, end: &str, body: &str, rest: &str) -> String {
    format!(
        "[scene]\ntitle = \"foundation\"\n{end}\n\
         [[body]]\nname = \"plate\"\ncell = \"{cell}\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.0 }}\n{body}\n\
         mesh = {{ generator = \"block\", size = [2.0, 1.0, 0.25], divisions = [3, 2, 1], grading = [2.0, 0.5, 1.0] }}\n\
         [[support]]\nset = \"plate.bottom\"\nstiffness = [300.0, 500.0, 2000.0]\ndamping = [0.0, 0.0, 0.0]\n{rest}"
    )
}

/// Springs per area are the integral of their energy over the facets: under a uniform load a plate of any cells sinks uniformly, the springs carry the load, and their energy is that of
/// the area.
#[test]
fn a_plate_on_a_foundation_sinks_uniformly() {
    // Dead loads along x and z: 150 and -100 an area of 2.
    let load = "[[load]]\nset = \"plate.bottom\"\ntraction = [150.0, 0.0, -100.0]\n";
    for cell in CELLS {
        let scene = on_foundation(cell, "kind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0", "", load);
        let mut simulation = simulation(&scene);
        simulation.advance().unwrap_or_else(|e| panic!("{cell}: {e}"));
        let (model, q) = (simulation.model(), &simulation.state().q);
        for (node, (x, y)) in q.chunks_exact(3).zip(model.reference.chunks_exact(3)).enumerate() {
            let moved: [f64; 3] = std::array::from_fn(|i| x[i] - y[i]);
            let exact = [150.0 / 300.0, 0.0, -100.0 / 2000.0];
            assert!((0..3).all(|i| (moved[i] - exact[i]).abs() < 1e-12), "{cell}: node {node} {moved:?}");
        }
        // 1/2 k u^2 A of both directions; the plate has none.
        let energy = 0.5 * 2.0 * (300.0 * 0.5 * 0.5 + 2000.0 * 0.05 * 0.05);
        assert!((simulation.balance().strain - energy).abs() < 1e-11 * energy, "{cell}");
    }
}

/// Under the energy-momentum scheme a plate of quadratic cells that swings on its springs keeps its energy.
#[test]
fn a_plate_that_swings_on_a_foundation_keeps_its_energy() {
    let end = "kind = \"dynamic\"\n[time]\nend = 0.6\nstep = 0.02\nintegrator = { scheme = \"energy-momentum\" }";
    for cell in ["hex20", "tet10", "wedge15"] {
        let body = "density = 10.0\nvelocity = [0.5, 0.0, -1.0]\nangular_velocity = [0.0, 2.0, 1.0]";
        let mut simulation = simulation(&on_foundation(cell, end, body, ""));
        let start = simulation.balance().total();
        let mut sprung = 0.0_f64;
        while !simulation.finished() {
            let record = simulation.advance().unwrap_or_else(|e| panic!("{cell}: {e}"));
            sprung = sprung.max(record.balance.strain);
            assert!((record.balance.total() - start).abs() < 1e-11 * start, "{cell}");
        }
        assert!(sprung > 0.3 * start, "{cell}: {sprung} of {start}");
    }
}
