//! Frames and watch of a model with solids and rigid bodies, made by hand.

use super::means::Means;
use super::watch::{contact_bodies, judge_start};
use super::{Drawing, DrawnLine, DrawnPoint, DrawnSurface, OutputError, changed_by, frame, promises};
use crate::points::Points;
use crate::scene::{Field as SceneField, Scene, parse};
use std::path::Path;
use std::sync::Arc;
use stoss_fe_solid::{MassKind, SolidBody};
use stoss_integrators::EnergyMomentum;
use stoss_linalg::AutoSolver;
use stoss_materials::NeoHooke;
use stoss_mesh::Elements;
use stoss_mesh::generate::Block;
use stoss_mesh_io::{Field, VtuFrame, read_vtu, write_vtu_to};
use stoss_newton::NewtonOptions;
use stoss_solver::{Body, InsideOutTreatment, Model, Settings, Simulation, StepControl};
use stoss_term::{Term, Vectors};
use stoss_watch::{FindingKind, Severity};

fn write_frame(
    path: &Path,
    simulation: &Simulation,
    means: &Means,
    fields: Option<&[SceneField]>,
    drawing: &Drawing,
) -> Result<(), OutputError> {
    frame::with(simulation, means, fields, drawing, |frame| frame::store(path, frame))
}

/// Four vectors without forces: a place and three directions.
#[derive(Debug)]
struct Four {
    first: u32,
    grounded: bool,
}

impl Term for Four {
    fn name(&self) -> &str {
        "four"
    }
    fn conserves_linear_momentum(&self) -> bool {
        !self.grounded
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
    fn vectors(&self) -> Option<&dyn Vectors> {
        Some(self)
    }
}

impl Vectors for Four {
    fn own_vectors(&self) -> std::ops::Range<u32> {
        self.first..self.first + 4
    }
    fn is_direction(&self, vector: u32) -> bool {
        vector != self.first
    }
    fn mass(&self, visit: &mut dyn FnMut(u32, u32, f64)) {
        (self.first..self.first + 4).for_each(|vector| visit(vector, vector, 1.0));
    }
}

fn add_block(model: &mut Model, name: &str, min: [f64; 3], max: [f64; 3]) {
    let block = Block::new(min, max, [1, 1, 2]).generate().unwrap();
    let law = Arc::new(NeoHooke::from_young_poisson(1000.0, 0.3).unwrap());
    let first = model.node_count() as u32;
    model.bodies.push(Body {
        solid: SolidBody::new(name, &block, first, law).unwrap(),
        nodes: first..first + block.nodes.len() as u32,
        density: Some(1.0),
        mass_kind: MassKind::Consistent,
        massless: None,
        damping: Default::default(),
    });
    model.reference.extend(block.nodes.iter().flatten());
    // It stretches.
    model.velocity.extend(block.nodes.iter().flat_map(|x| [0.1 * x[0], 0.0, 0.0]));
}

/// A part with its place at `at`, and a square plate of embedded nodes around it, side 2; the number of the place.
fn add_plate(model: &mut Model, at: [f64; 3]) -> (u32, DrawnSurface) {
    let first = model.node_count() as u32;
    model.reference.extend(at.iter().chain([7.0, 0.0, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0, 7.0].iter()));
    for (k, [x, y]) in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].into_iter().enumerate() {
        model.reference.extend([at[0] + x, at[1] + y, at[2]]);
        model.embedding.add(first + 4 + k as u32, &[(first, 1.0), (first + 1, x / 7.0), (first + 2, y / 7.0)]);
    }
    model.velocity.resize(model.reference.len(), 0.0);
    model.parts.push(Box::new(Four { first, grounded: false }));
    let nodes = first + 4..first + 8;
    let facets = vec![[first + 4, first + 5, first + 6].into(), [first + 4, first + 6, first + 7].into()];
    (first, DrawnSurface { name: "plate".into(), nodes, facets, is_closed: false })
}

fn simulation(model: Model) -> Simulation {
    let settings = Settings {
        control: StepControl { step: 0.1, end: 1.0, max_cuts: 0, grow_after: 1, automatic: None },
        scheme: Some(Box::new(EnergyMomentum)),
        newton: NewtonOptions::default(),
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    };
    Simulation::new(model, settings).unwrap()
}

/// A block under a force on its top, free to get wider: the deformation is homogeneous, and known from where its corner is.
#[test]
fn fields_of_a_homogeneous_deformation_are_exact_at_every_node() {
    let (lambda, mu, force) = (600.0, 400.0, 300.0);
    let fixed = |set: &str, axis: &str| {
        format!("[[prescribe]]\nset = \"block.{set}\"\ncomponents = [\"{axis}\"]\nfixed = true\n")
    };
    let text = format!(
        r#"[scene]
title = "block"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 1, 2] }}
material = {{ law = "neo-hooke", lambda = {lambda}, mu = {mu} }}
[[load]]
set = "block.top"
total_force = {{ table = [[0, 0, 0, 0], [1, 0, 0, {force}]] }}
{}{}{}[output]
fields = ["displacement", "principal_stresses", "deformation_gradient", "green_lagrange_strain", "logarithmic_strain", "reaction"]
"#,
        fixed("left", "x"),
        fixed("front", "y"),
        fixed("bottom", "z")
    );
    let scene = parse(&text, "block.toml").unwrap();
    let mut simulation = crate::build::build(&scene, Path::new(".")).unwrap().simulation;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtu");
    let read = |simulation: &Simulation| {
        write_frame(&path, simulation, &Means::default(), scene.output.fields.as_deref(), &Drawing::default()).unwrap();
        read_vtu(&path).unwrap()
    };
    let start = read(&simulation);
    assert!(start.point_data["reaction"].values.iter().all(|&r| r == 0.0));
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
    let data = read(&simulation);
    let names: Vec<&str> = data.point_data.keys().map(String::as_str).collect();
    // No velocity and no Cauchy stress: they were not asked for.
    let asked = [
        "deformation_gradient",
        "displacement",
        "green_lagrange_strain",
        "logarithmic_strain",
        "principal_stresses",
        "reaction",
    ];
    assert_eq!(names, asked);
    let corner = data.points.iter().position(|x| *x == [1.0; 3]).unwrap();
    let u = &data.point_data["displacement"].values[3 * corner..3 * corner + 3];
    let (wide, long) = (1.0 + u[0], 1.0 + u[2]);
    assert!(long > 1.1 && wide < 0.99 && (u[0] - u[1]).abs() < 1e-9);
    let everywhere = |name: &str, expected: &[f64], bound: f64| {
        let values = &data.point_data[name].values;
        assert_eq!(values.len(), data.points.len() * expected.len());
        for row in values.chunks_exact(expected.len()) {
            assert!(
                row.iter().zip(expected).all(|(a, b)| (a - b).abs() < bound),
                "{name}: {row:?} against {expected:?}"
            );
        }
    };
    everywhere("deformation_gradient", &[wide, 0.0, 0.0, 0.0, wide, 0.0, 0.0, 0.0, long], 1e-9);
    let [e, f] = [wide, long].map(|stretch| (stretch * stretch - 1.0) / 2.0);
    everywhere("green_lagrange_strain", &[e, e, f, 0.0, 0.0, 0.0], 1e-9);
    everywhere("logarithmic_strain", &[wide.ln(), wide.ln(), long.ln(), 0.0, 0.0, 0.0], 1e-9);
    // The force over the current area, and the law's own stress.
    everywhere("principal_stresses", &[force / (wide * wide), 0.0, 0.0], 1e-6 * force);
    let j = wide * wide * long;
    let of_law = (mu * (long * long - 1.0) + lambda * j.ln()) / j;
    assert!((of_law - force / (wide * wide)).abs() < 1e-6 * force);
    let reaction = &data.point_data["reaction"].values;
    let sum: f64 = reaction.chunks_exact(3).map(|r| r[2]).sum();
    assert!((sum + force).abs() < 1e-8 * force, "{sum}");
    for (x, r) in data.points.iter().zip(reaction.chunks_exact(3)) {
        assert!((0..3).all(|i| x[i] == 0.0 || r[i] == 0.0), "{x:?}: {r:?}");
    }
}

/// A scene of solids alone has all nodes as points and all elements as cells, and nothing else.
#[test]
fn a_frame_of_solids_is_that_of_the_plain_writer() {
    let mut model = Model::default();
    add_block(&mut model, "one", [0.0; 3], [1.0; 3]);
    add_block(&mut model, "two", [0.0, 0.0, 1.5], [1.0, 1.0, 2.5]);
    let mut simulation = simulation(model);
    simulation.advance().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtu");
    write_frame(&path, &simulation, &Means::default(), None, &Drawing::default()).unwrap();
    let (model, state) = (simulation.model(), simulation.state());
    let displacement: Vec<f64> = state.q.iter().zip(&model.reference).map(|(q, x)| q - x).collect();
    let mut elements = Elements::new();
    model.bodies.iter().for_each(|b| elements.extend(b.solid.elements(), |node| node));
    let mut stress = vec![[0.0; 6]; model.node_count()];
    for body in &model.bodies {
        let nodes = body.nodes.start as usize..body.nodes.end as usize;
        stress[nodes].copy_from_slice(&body.solid.nodal_cauchy_stress(&state.q).unwrap().means());
    }
    let von_mises: Vec<f64> = stress.iter().map(stoss_fe_solid::von_mises).collect();
    assert!(von_mises.iter().all(|&x| x > 0.0));
    let field = |name, components, values| Field { name, components, values };
    let plain = VtuFrame {
        points: model.reference.as_chunks().0,
        elements: elements.blocks(),
        point_data: vec![
            field("displacement", 3, &displacement),
            field("velocity", 3, &state.v),
            field("cauchy_stress", 6, stress.as_flattened()),
            field("von_mises", 1, &von_mises),
        ],
        cell_data: vec![field("body", 1, &[0.0, 0.0, 1.0, 1.0])],
        time: Some(state.time),
        ..VtuFrame::default()
    };
    let mut text = Vec::new();
    write_vtu_to(&mut text, &plain).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), text);
}

/// Directions are left out, whatever stands behind them; bodies are counted on; stress is no number where there is none.
#[test]
fn a_frame_has_surfaces_lines_and_points() {
    let mut model = Model::default();
    let (_, plate) = add_plate(&mut model, [5.0, 0.0, 0.0]);
    add_block(&mut model, "block", [0.0; 3], [1.0; 3]);
    let (single, other) = add_plate(&mut model, [5.0, 0.0, 3.0]);
    let drawing = Drawing {
        surfaces: vec![plate],
        lines: vec![DrawnLine { name: "line".into(), nodes: other.nodes.clone().collect() }],
        points: vec![DrawnPoint { name: "point".into(), node: single }],
        ..Drawing::default()
    };
    let points = Points::of(&model);
    // Speeds and distances are those of points: directors are as long as seven.
    assert_eq!(points.largest(&model.reference), f64::sqrt(36.0 + 1.0 + 9.0));
    let simulation = simulation(model);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtu");
    write_frame(&path, &simulation, &Means::default(), None, &drawing).unwrap();
    let data = read_vtu(&path).unwrap();
    // One place and four corners, twelve nodes, one place and four corners.
    assert_eq!(data.points.len(), 22);
    assert!(data.points.iter().flatten().all(|x| x.abs() < 7.0));
    assert_eq!((data.points[0], data.points[17]), ([5.0, 0.0, 0.0], [5.0, 0.0, 3.0]));
    assert_eq!((data.facets.len(), &data.facets[1][..]), (2, &[1, 3, 4][..]));
    assert_eq!(data.elements.iter().flatten().min(), Some(&5));
    assert_eq!((data.lines, data.vertices), (vec![vec![18, 19, 20, 21]], vec![17]));
    assert_eq!(data.cell_data["body"].values, [0.0, 0.0, 1.0, 1.0, 2.0, 3.0]);
    let von_mises = &data.point_data["von_mises"].values;
    assert!((0..22).all(|k| von_mises[k].is_nan() != (5..17).contains(&k)), "{von_mises:?}");
    // A direction is no point of a drawing.
    let wrong = Drawing { points: vec![DrawnPoint { name: "d".into(), node: single + 1 }], ..Drawing::default() };
    assert!(write_frame(&path, &simulation, &Means::default(), None, &wrong).is_err());
}

/// A plate in a block is found, and named; one that lies on the block is sound.
#[test]
fn the_watch_looks_at_surfaces() {
    let scene = scene();
    for (height, level) in [(1.0, Severity::Sound), (0.6, Severity::Wrong)] {
        let mut model = Model::default();
        let (_, plate) = add_plate(&mut model, [0.3, 0.4, height]);
        add_block(&mut model, "block", [0.0; 3], [1.0; 3]);
        let drawing = Drawing { surfaces: vec![plate], ..Drawing::default() };
        let verdict = judge_start(&simulation(model), &scene, &drawing).unwrap();
        assert_eq!(verdict.level, level, "{verdict}");
        if level == Severity::Wrong {
            let worst = &verdict.reasons[0];
            assert_eq!(worst.kind, FindingKind::Penetration);
            assert!(worst.sentence.contains("`block`") && worst.sentence.contains("`plate`"), "{}", worst.sentence);
        }
    }
    assert_eq!(contact_bodies(&scene, &Drawing::default()), Vec::new());
}

/// What a part takes to the ground is no promise, and no drift.
#[test]
fn a_part_on_the_ground_changes_momenta() {
    let scene = scene();
    for grounded in [false, true] {
        let mut model = Model::default();
        add_block(&mut model, "block", [0.0; 3], [1.0; 3]);
        let first = model.node_count() as u32;
        model.reference.extend([0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        model.velocity.resize(model.reference.len(), 0.0);
        model.parts.push(Box::new(Four { first, grounded }));
        let simulation = simulation(model);
        let scheme = scene.time.integrator.as_ref().unwrap().make().unwrap();
        let promised = promises(&scene, &simulation, Some(&*scheme)).unwrap();
        assert_eq!((promised.linear, promised.angular), ([!grounded; 3], !grounded));
        assert!(promised.energy && promised.autonomous);
        assert_eq!(changed_by(&scene, simulation.model()).map(|reason| reason.is_some()), [grounded, grounded, false]);
    }
}

/// Mass-proportional damping takes momentum; stiffness-proportional damping does not. Both are in the ledger.
#[test]
fn damping_of_the_mass_changes_momenta() {
    let scene = scene();
    for (mass, stiffness) in [(0.0, 0.1), (0.1, 0.0), (0.1, 0.1)] {
        let mut model = Model::default();
        add_block(&mut model, "block", [0.0; 3], [1.0; 3]);
        model.bodies[0].damping = stoss_solver::Damping { mass, stiffness };
        let simulation = simulation(model);
        let scheme = scene.time.integrator.as_ref().unwrap().make().unwrap();
        let promised = promises(&scene, &simulation, Some(&*scheme)).unwrap();
        let slowed = mass > 0.0;
        assert_eq!((promised.linear, promised.angular), ([!slowed; 3], !slowed));
        assert!(promised.energy);
        assert_eq!(changed_by(&scene, simulation.model()).map(|reason| reason.is_some()), [slowed, slowed, false]);
    }
}

fn scene() -> Scene {
    let text = r#"
        [scene]
        title = "block"
        kind = "dynamic"
        [time]
        end = 1.0
        step = 0.1
        integrator = { scheme = "energy-momentum" }
        [[body]]
        name = "block"
        mesh = { generator = "block", size = [1.0, 1.0, 1.0], divisions = [1, 1, 2] }
        material = { law = "ogden", mu = [6300.0, 12.0, -100.0], alpha = [1.3, 5.0, -2.0], kappa = 2000.0, beta = 9.0 }
        density = 1.0
    "#;
    parse(text, "block.toml").unwrap()
}
