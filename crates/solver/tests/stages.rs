//! Stages and releases in whole runs.

mod ramps;
mod unstable;

use std::sync::Arc;
use stoss_contact_nts::{NodeToSurface, NodeToSurfaceOptions};
use stoss_fe_solid::{MassKind, SolidBody};
use stoss_integrators::{EnergyMomentum, GeneralisedAlpha, Midpoint, Scheme, Trapezoidal};
use stoss_linalg::AutoSolver;
use stoss_materials::NeoHooke;
use stoss_mesh::Mesh;
use stoss_mesh::generate::Block;
use stoss_multibody::{ConstraintSet, Embedded, Equation, QuadraticsBuilder, RigidBody, RigidMass};
use stoss_newton::NewtonOptions;
use stoss_solver::{
    Body, CouplingTerm, DecisionKind, FirstStage, InsideOutTreatment, Load, LoadKind, Model, Prescription, Release,
    Settings, Simulation, SimulationError, Stage, StepControl, Switches, Table,
};
use stoss_term::{At, Fault, GradientRule, Local, Potential, Term};

const GRAVITY: f64 = 10.0;
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn settings(scheme: Option<Box<dyn Scheme>>, step: f64, end: f64) -> Settings {
    Settings {
        control: StepControl { step, end, max_cuts: 0, grow_after: 4, automatic: None },
        scheme,
        newton: NewtonOptions { relative_tolerance: 1e-10, ..NewtonOptions::default() },
        inside_out: InsideOutTreatment::Refuse,
        max_plastic_increment: None,
        solver: Box::new(AutoSolver::new()),
    }
}

fn stage(scheme: Option<Box<dyn Scheme>>, step: f64, end: f64, off: Switches) -> Stage {
    let newton = NewtonOptions { relative_tolerance: 1e-10, ..NewtonOptions::default() };
    Stage { name: "next".into(), scheme, step, automatic: None, end, off, stabilise: None, newton }
}

fn later(off: Switches) -> FirstStage {
    FirstStage { off, later_dynamics: true, ..FirstStage::default() }
}

fn add_block(model: &mut Model, min: [f64; 3], max: [f64; 3], n: [usize; 3]) -> Mesh {
    let mesh = Block::new(min, max, n).generate().unwrap();
    let first = model.node_count() as u32;
    let law = Arc::new(NeoHooke::from_young_poisson(1000.0, 0.3).unwrap());
    model.bodies.push(Body {
        solid: SolidBody::new("block", &mesh, first, law).unwrap(),
        nodes: first..first + mesh.nodes.len() as u32,
        density: Some(2.0),
        mass_kind: MassKind::Consistent,
        massless: None,
        damping: Default::default(),
    });
    model.reference.extend(mesh.nodes.iter().flatten());
    model.velocity.extend(mesh.nodes.iter().flat_map(|_| [0.0; 3]));
    mesh
}

/// Downwards along z on all bodies: the row sums of the consistent mass.
fn add_gravity(model: &mut Model) {
    let mut pattern = Vec::new();
    for body in &model.bodies {
        let mass = body.solid.mass(2.0, body.mass_kind);
        let mut along = vec![0.0; model.reference.len()];
        let mut unit = vec![0.0; model.reference.len()];
        body.nodes.clone().for_each(|node| unit[3 * node as usize + 2] = 1.0);
        mass.multiply_add(1.0, &unit, &mut along);
        pattern.extend(body.nodes.clone().map(|node| (3 * node + 2, along[3 * node as usize + 2])));
    }
    let kind = LoadKind::Dead { patterns: vec![pattern] };
    model.loads.push(Load { name: "gravity".into(), kind, magnitude: Table::constant(&[-GRAVITY]) });
}

fn hold(model: &mut Model, nodes: Vec<u32>, displacement: Table) {
    model.prescriptions.push(Prescription {
        name: "support".into(),
        nodes,
        directions: Vec::new(),
        components: vec![0, 1, 2],
        displacement,
        rotation: None,
        ramp_until: None,
    });
}

/// A block that hangs from its top face.
fn hanging() -> Model {
    let mut model = Model::default();
    let mesh = add_block(&mut model, [0.0; 3], [1.0, 1.0, 2.0], [2, 2, 3]);
    add_gravity(&mut model);
    hold(&mut model, mesh.nodes_of("top").unwrap().to_vec(), Table::constant(&[0.0; 3]));
    model
}

fn run(simulation: &mut Simulation) {
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// What hangs in equilibrium goes on hanging, whatever the scheme; also what is pressed against something.
#[test]
fn equilibrium_stays_at_rest() {
    let schemes: [fn() -> Box<dyn Scheme>; 4] = [
        || Box::new(EnergyMomentum),
        || Box::new(Midpoint),
        || Box::new(GeneralisedAlpha::chung_hulbert(0.7)),
        || Box::new(Trapezoidal),
    ];
    for scheme in schemes {
        let mut simulation =
            Simulation::staged(hanging(), settings(None, 1.0, 1.0), later(Switches::default())).unwrap();
        run(&mut simulation);
        let hung = simulation.state().q.clone();
        assert!(distance(&hung, &simulation.model().reference) > 0.01);
        let total = simulation.balance().total();
        assert_eq!(simulation.balance().kinetic, 0.0);
        simulation.begin_stage(stage(Some(scheme()), 0.05, 3.0, Switches::default())).unwrap();
        assert_eq!(simulation.balance().total(), total);
        run(&mut simulation);
        assert_eq!(simulation.state().time, 3.0);
        let moved = distance(&hung, &simulation.state().q);
        assert!(moved < 1e-12, "{} {moved:e}", scheme().name());
        assert!((simulation.balance().total() - total).abs() < 1e-12 * total.abs().max(1.0));
    }
}

/// A block that lies on another one, first in statics.
#[test]
fn contact_carries_over_from_statics() {
    for kind in 0..2 {
        let mut model = Model::default();
        // No slave node on an edge, where which facet is its own is a matter of round-off.
        let lower = add_block(&mut model, [-0.5, -0.5, -1.0], [1.5, 1.5, 0.0], [3, 3, 1]);
        let count = model.node_count() as u32;
        let upper = add_block(&mut model, [0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2, 2, 2]);
        add_gravity(&mut model);
        hold(&mut model, lower.nodes_of("bottom").unwrap().to_vec(), Table::constant(&[0.0; 3]));
        // Contact leaves two translations and a rotation.
        model.prescriptions.push(Prescription {
            name: "support".into(),
            nodes: upper.nodes_of("top").unwrap().iter().map(|n| n + count).collect(),
            directions: Vec::new(),
            components: vec![0, 1],
            displacement: Table::constant(&[0.0; 2]),
            rotation: None,
            ramp_until: None,
        });
        let facets = |mesh: &Mesh, set: &str, first: u32| -> Vec<[u32; 4]> {
            mesh.facets_of(set).unwrap().iter().map(|f| [0, 1, 2, 3].map(|k: usize| f.nodes[k] + first)).collect()
        };
        let (slave, master) = (facets(&upper, "bottom", count), facets(&lower, "top", 0));
        let method =
            NodeToSurface::new("floor", &slave, &master, &model.reference, NodeToSurfaceOptions::default()).unwrap();
        let pair = CouplingTerm {
            name: "floor".into(),
            acts: true,
            term: Box::new(method),
            complementarity: 2000.0,
            restitution: None,
        };
        model.contacts.push(pair);
        let mut simulation = Simulation::staged(model, settings(None, 1.0, 1.0), later(Switches::default())).unwrap();
        run(&mut simulation);
        let (q, active) = (simulation.state().q.clone(), simulation.active().to_vec());
        assert!(active[0].iter().all(|&a| a));
        let scheme: Box<dyn Scheme> =
            if kind == 0 { Box::new(EnergyMomentum) } else { Box::new(GeneralisedAlpha::chung_hulbert(0.7)) };
        simulation.begin_stage(stage(Some(scheme), 0.05, 2.0, Switches::default())).unwrap();
        run(&mut simulation);
        let moved = distance(&q, &simulation.state().q);
        assert!(moved < 1e-11, "{moved:e}");
        assert_eq!(simulation.active(), active);
        // And a contact that is switched off lets the block fall: its centre of mass by g t^2 / 2.
        let off = Switches { contacts: vec![0], ..Switches::default() };
        simulation.begin_stage(stage(Some(Box::new(EnergyMomentum)), 0.05, 2.5, off)).unwrap();
        let total = simulation.balance().total();
        let momentum = |s: &Simulation| s.body_balance(1).linear_momentum[2];
        let before = momentum(&simulation);
        run(&mut simulation);
        let gained = momentum(&simulation) - before;
        assert!((gained + 2.0 * GRAVITY * 0.5).abs() < 1e-9, "{gained}");
        assert!((simulation.balance().total() - total).abs() < 1e-10);
    }
}

/// The support goes, and the block falls: its momentum is that of gravity, its energy stays.
#[test]
fn released_support_is_a_free_fall() {
    let mut simulation = Simulation::staged(hanging(), settings(None, 1.0, 1.0), later(Switches::default())).unwrap();
    run(&mut simulation);
    simulation.begin_stage(stage(Some(Box::new(EnergyMomentum)), 0.01, 2.0, Switches::default())).unwrap();
    let free = simulation.equations();
    for _ in 0..3 {
        simulation.advance().unwrap();
    }
    let total = simulation.balance().total();
    let start = simulation.state().time;
    simulation.release(Release::Prescription(0), Some("cut")).unwrap();
    simulation.release(Release::Prescription(0), None).unwrap();
    assert_eq!(simulation.balance().total(), total);
    assert_eq!(simulation.equations(), free + 27);
    let record = simulation.advance().unwrap();
    let kinds: Vec<_> = record.decisions.iter().map(|d| d.kind).collect();
    assert_eq!((record.stage, kinds), (2, vec![DecisionKind::Release]));
    assert_eq!(record.decisions[0].reason, "event cut: prescribed motion support no longer acts");
    run(&mut simulation);
    let balance = *simulation.balance();
    let fallen = 2.0 - start;
    assert!((balance.linear_momentum[2] + simulation.total_mass() * GRAVITY * fallen).abs() < 1e-10);
    assert!((balance.total() - total).abs() < 1e-11 * balance.kinetic, "{:e}", balance.total() - total);
    assert!(simulation.reactions().iter().all(|&r| r == 0.0));
}

/// Loads that are switched, and velocities that are dropped, leave the total as it is.
#[test]
fn the_energy_balance_has_no_jump() {
    let off = Switches { loads: vec![0], ..Switches::default() };
    let mut model = hanging();
    model.velocity.iter_mut().skip(2).step_by(3).for_each(|v| *v = 0.5);
    let mut simulation = Simulation::new(model, settings(Some(Box::new(EnergyMomentum)), 0.05, 0.5)).unwrap();
    run(&mut simulation);
    let check = |simulation: &mut Simulation, next: Stage| {
        let before = *simulation.balance();
        simulation.begin_stage(next).unwrap();
        let after = *simulation.balance();
        assert!((after.total() - before.total()).abs() < 1e-14 * (1.0 + before.kinetic + before.potential.abs()));
        (before, after)
    };
    let (before, after) = check(&mut simulation, stage(Some(Box::new(EnergyMomentum)), 0.05, 1.0, off.clone()));
    assert!(before.potential != 0.0 && after.potential == 0.0);
    assert_eq!(after.external_work, -before.potential);
    assert_eq!(after.kinetic, before.kinetic);
    let total = after.total();
    run(&mut simulation);
    assert!((simulation.balance().total() - total).abs() < 1e-11);
    let (before, after) = check(&mut simulation, stage(None, 0.5, 2.0, off));
    assert_eq!((after.kinetic, after.dissipation), (0.0, before.kinetic));
    run(&mut simulation);
    assert_eq!(simulation.balance().kinetic, 0.0);
    // Nothing pulls any more: the reference configuration.
    assert!(distance(&simulation.state().q, &simulation.model().reference) < 1e-9);
    // Velocities of the model, but for the support.
    let (before, after) = check(&mut simulation, stage(Some(Box::new(EnergyMomentum)), 0.05, 2.5, Switches::default()));
    assert!(after.kinetic > 0.0 && before.kinetic == 0.0);
    assert_eq!(simulation.stage(), 4);
}

/// Prescriptions: components are free while they are off, follow their table afterwards, and do not jump.
#[test]
fn prescriptions_come_back() {
    let mut model = hanging();
    let mesh = Block::new([0.0; 3], [1.0, 1.0, 2.0], [2, 2, 3]).generate().unwrap();
    let rows = [vec![0.0, 0.0], vec![1.0, 0.0], vec![2.0, 0.1], vec![10.0, 8.1]];
    model.prescriptions.push(Prescription {
        name: "support".into(),
        nodes: mesh.nodes_of("bottom").unwrap().to_vec(),
        directions: Vec::new(),
        components: vec![2],
        displacement: Table::from_rows(&rows, 1).unwrap(),
        rotation: None,
        ramp_until: None,
    });
    let bottom = mesh.nodes_of("bottom").unwrap()[0] as usize;
    let off = Switches { prescriptions: vec![1], ..Switches::default() };
    let first = FirstStage { off: off.clone(), ..FirstStage::default() };
    let mut simulation = Simulation::staged(model, settings(None, 1.0, 1.0), first).unwrap();
    run(&mut simulation);
    assert!(simulation.state().q[3 * bottom + 2] < -0.01);
    simulation.begin_stage(stage(None, 0.5, 2.0, Switches::default())).unwrap();
    run(&mut simulation);
    assert!((simulation.state().q[3 * bottom + 2] - 0.1).abs() < 1e-15);
    assert!(simulation.reactions()[3 * bottom + 2] != 0.0);
    simulation.begin_stage(stage(None, 3.0, 5.0, off)).unwrap();
    assert_eq!(simulation.reactions()[3 * bottom + 2], 0.0);
    run(&mut simulation);
    let (q, equations, balance) = (simulation.state().q.clone(), simulation.equations(), *simulation.balance());
    // Now the table says 3.1, and an edge is shorter than one.
    let error = simulation.begin_stage(stage(None, 1.0, 6.0, Switches::default())).unwrap_err();
    assert!(matches!(&error, SimulationError::Jump { what, .. } if what == "prescribed motion support"), "{error}");
    // Nothing of the failed attempt is left.
    assert_eq!((simulation.state().q.clone(), simulation.equations(), *simulation.balance()), (q, equations, balance));
    assert_eq!(simulation.stage(), 3);
    assert!(simulation.finished());
    let error = simulation.begin_stage(stage(Some(Box::new(EnergyMomentum)), 1.0, 6.0, Switches::default()));
    assert!(matches!(error, Err(SimulationError::Stage { .. })));
    for wrong in [stage(None, 1.0, 5.0, Switches::default()), stage(None, 0.0, 6.0, Switches::default())] {
        assert!(matches!(simulation.begin_stage(wrong), Err(SimulationError::Stage { .. })));
    }
    let nothing = Switches { loads: vec![7], ..Switches::default() };
    assert!(matches!(simulation.begin_stage(stage(None, 1.0, 6.0, nothing)), Err(SimulationError::Stage { .. })));
    assert!(matches!(simulation.release(Release::Constraint(0), None), Err(SimulationError::Release(_))));
    assert!(matches!(simulation.release(Release::Prescription(2), None), Err(SimulationError::Release(_))));
}

/// A rigid body with a pin through the origin; gravity along -z.
fn pendulum(mass: RigidMass, spin: [f64; 3]) -> (Model, RigidBody) {
    let body = RigidBody::new("body", 0, mass);
    let mut model = Model::default();
    model.reference.extend(body.reference().iter().flatten());
    let c = body.mass().centre;
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    model.velocity.extend(body.velocity(cross(spin, c), spin).iter().flatten());
    let mut pin = QuadraticsBuilder::new();
    let point = pin.form(&body.point([0.0; 3]));
    for axis in AXES {
        let ground = pin.form(&Embedded { constant: axis, terms: Vec::new() });
        pin.function(0.0, &[(1.0, point, ground)]);
    }
    let pin = ConstraintSet::new("pin", 1.0, vec![Equation::each(pin.build())]);
    let couplings = [("rigidity", body.constraints()), ("pin", pin)];
    for (name, constraints) in couplings {
        model.contacts.push(CouplingTerm::new(name, constraints, 1.0));
    }
    let kind = LoadKind::Dead { patterns: vec![vec![(2, body.mass().mass)]] };
    model.loads.push(Load { name: "gravity".into(), kind, magnitude: Table::constant(&[-GRAVITY]) });
    model.parts.push(Box::new(body.clone()));
    (model, body)
}

/// Euler tensor of a body whose moment of inertia about y through the centre is `euler[0] + euler[2]`.
fn bob() -> RigidMass {
    RigidMass::new(2.0, [0.8, 0.0, 0.0], [0.10, 0.05, 0.02], AXES).unwrap()
}

/// The pin goes: the centre flies along its parabola, and the energy stays.
#[test]
fn released_pin_is_a_parabola() {
    let schemes: [Box<dyn Scheme>; 3] =
        [Box::new(EnergyMomentum), Box::new(Midpoint), Box::new(GeneralisedAlpha::chung_hulbert(0.7))];
    for scheme in schemes {
        // The third one keeps no energy, and is exact on the parabola only if the acceleration is made again.
        let conserves = scheme.name() != "generalised-alpha";
        let (model, _) = pendulum(bob(), [0.3, 2.0, -0.4]);
        let mut simulation = Simulation::new(model, settings(Some(scheme), 0.01, 2.0)).unwrap();
        for _ in 0..60 {
            simulation.advance().unwrap();
        }
        let (first, t0) = (simulation.state().clone(), simulation.state().time);
        let energy = *simulation.balance();
        assert!(simulation.pressures()[1].iter().any(|p| p.abs() > 1.0));
        simulation.release(Release::Constraint(1), None).unwrap();
        assert_eq!(simulation.balance().total(), energy.total());
        run(&mut simulation);
        let t = simulation.state().time - t0;
        for i in 0..3 {
            let fall = if i == 2 { 0.5 * GRAVITY * t * t } else { 0.0 };
            let expected = first.q[i] + first.v[i] * t - fall;
            assert!((simulation.state().q[i] - expected).abs() < 1e-11, "{i}");
        }
        let drift = simulation.balance().total() - energy.total();
        // Constraints of a rigid body are quadratic: the midpoint rule keeps the energy, too.
        assert!(!conserves || drift.abs() < 1e-10 * energy.kinetic.max(1.0), "{drift:e}");
    }
}

/// `a = alpha x c + omega x (omega x c)`, `alpha = m g c / I` about y for a spin about y.
#[test]
fn acceleration_of_a_pendulum_at_the_start() {
    // Without the second value the second director has no mass, and only the constraints know its acceleration.
    for (spin, second) in [(0.0, 0.05), (3.0, 0.05), (3.0, 0.0)] {
        let mass = RigidMass::new(2.0, [0.8, 0.0, 0.0], [0.10, second, 0.02], AXES).unwrap();
        let (model, body) = pendulum(mass, [0.0, spin, 0.0]);
        let scheme = Box::new(GeneralisedAlpha::chung_hulbert(0.7));
        let simulation = Simulation::new(model, settings(Some(scheme), 0.01, 1.0)).unwrap();
        let a = &simulation.state().a;
        let c = 0.8;
        let inertia = 0.10 + 0.02 + 2.0 * c * c;
        // The moment of -m g e_z at c e_x about y is +m g c.
        let alpha = 2.0 * GRAVITY * c / inertia;
        let l = body.director_length();
        // omega x x = alpha e_y x x: (z, 0, -x); omega x (omega x x) = -spin^2 (x, 0, z).
        let of = |x: [f64; 3]| [alpha * x[2] - spin * spin * x[0], 0.0, -alpha * x[0] - spin * spin * x[2]];
        let expected = [of([c, 0.0, 0.0]), of([l, 0.0, 0.0]), of([0.0, l, 0.0]), of([0.0, 0.0, l])];
        let error = distance(a, expected.as_flattened());
        assert!(error < 1e-10, "{spin} {error:e} {a:?} {expected:?}");
        // The pin holds what gravity and inertia leave: F = m (a_c + g e_z).
        let pin: [f64; 3] = std::array::from_fn(|i| 2.0 * (expected[0][i] + if i == 2 { GRAVITY } else { 0.0 }));
        let error = distance(&simulation.pressures()[1], &pin);
        assert!(error < 1e-9, "{error:e} {:?} {pin:?}", simulation.pressures()[1]);
    }
}

/// Angle of the pendulum about y by a Runge-Kutta method of fourth order with small steps: `theta'' = m g c cos(theta) / I`.
fn reference_angle(spin: f64, end: f64) -> f64 {
    let (c, inertia) = (0.8, 0.10 + 0.02 + 2.0 * 0.8 * 0.8);
    let rate = |y: [f64; 2]| [y[1], 2.0 * GRAVITY * c / inertia * y[0].cos()];
    let (n, mut y) = (20_000, [0.0, spin]);
    let h = end / f64::from(n);
    let add = |y: [f64; 2], s: f64, k: [f64; 2]| [y[0] + s * k[0], y[1] + s * k[1]];
    for _ in 0..n {
        let k1 = rate(y);
        let k2 = rate(add(y, 0.5 * h, k1));
        let k3 = rate(add(y, 0.5 * h, k2));
        let k4 = rate(add(y, h, k3));
        for i in 0..2 {
            y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    y[0]
}

/// Error of the centre at time 1.
fn pendulum_error(scheme: Box<dyn Scheme>, step: f64) -> f64 {
    let (model, _) = pendulum(bob(), [0.0, 1.5, 0.0]);
    let mut simulation = Simulation::new(model, settings(Some(scheme), step, 1.0)).unwrap();
    run(&mut simulation);
    let angle = reference_angle(1.5, 1.0);
    let q = &simulation.state().q;
    (q[0] - 0.8 * angle.cos()).hypot(q[2] + 0.8 * angle.sin())
}

#[test]
fn schemes_are_of_second_order_on_a_pendulum() {
    let schemes: [fn() -> Box<dyn Scheme>; 5] = [
        || Box::new(EnergyMomentum),
        || Box::new(GeneralisedAlpha::chung_hulbert(0.7)),
        || Box::new(GeneralisedAlpha::hht(0.8)),
        || Box::new(Trapezoidal),
        || Box::new(stoss_integrators::VariationalMidpoint { alpha: 0.5 }),
    ];
    for scheme in schemes {
        let errors = [0.0025, 0.00125, 0.000625].map(|step| pendulum_error(scheme(), step));
        let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        assert!(orders.iter().all(|order| *order > 1.85), "{} {errors:?} {orders:?}", scheme().name());
    }
}

/// A run in one go against one that stops in the middle of the second stage, after a release, and goes on in a new simulation: the same bits.
#[test]
fn checkpoints_know_stage_and_releases() {
    let model = || {
        let (mut model, _) = pendulum(bob(), [0.0, 1.0, 0.3]);
        let mesh = add_block(&mut model, [5.0, 0.0, 0.0], [6.0, 1.0, 2.0], [1, 2, 2]);
        let first = model.bodies[0].nodes.start;
        add_gravity(&mut model);
        hold(&mut model, mesh.nodes_of("top").unwrap().iter().map(|n| n + first).collect(), Table::constant(&[0.0; 3]));
        hold(
            &mut model,
            mesh.nodes_of("bottom").unwrap().iter().map(|n| n + first).collect(),
            Table::constant(&[0.0; 3]),
        );
        model
    };
    let start = || {
        let off = Switches { loads: vec![1], ..Switches::default() };
        let scheme = Some(Box::new(EnergyMomentum) as Box<dyn Scheme>);
        Simulation::staged(model(), settings(scheme, 0.02, 0.1), later(off)).unwrap()
    };
    let off = Switches { prescriptions: vec![1], ..Switches::default() };
    let second = || stage(Some(Box::new(GeneralisedAlpha::chung_hulbert(0.8))), 0.01, 0.5, off.clone());
    let to_release = |simulation: &mut Simulation| {
        run(simulation);
        simulation.begin_stage(second()).unwrap();
        (0..10).for_each(|_| drop(simulation.advance().unwrap()));
        simulation.release(Release::Constraint(1), None).unwrap();
    };
    let same = |a: &Simulation, b: &Simulation| {
        assert_eq!(a.state(), b.state());
        assert_eq!(a.balance(), b.balance());
        assert_eq!(a.pressures(), b.pressures());
        assert_eq!(a.decisions(), b.decisions());
        assert_eq!((a.stage(), a.step()), (b.stage(), b.step()));
    };
    let mut whole = start();
    to_release(&mut whole);
    run(&mut whole);
    let third = || stage(Some(Box::new(EnergyMomentum)), 0.01, 0.6, Switches::default());
    for after in [0, 7] {
        let mut stopped = start();
        to_release(&mut stopped);
        (0..after).for_each(|_| drop(stopped.advance().unwrap()));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint");
        stopped.checkpoint("tag", Default::default()).write(&path).unwrap();
        drop(stopped);
        let read = || stoss_solver::Checkpoint::read(&path).unwrap();
        let mut resumed = start();
        assert_eq!((read().stage.number, read().stage.released), (2, vec![Release::Constraint(1)]));
        assert!(matches!(resumed.restore(read(), "tag"), Err(SimulationError::Checkpoint(_))));
        let other = Stage { off: Switches::default(), ..second() };
        assert!(matches!(resumed.restore_in(other, read(), "tag"), Err(SimulationError::Checkpoint(_))));
        resumed.restore_in(second(), read(), "tag").unwrap();
        run(&mut resumed);
        same(&whole, &resumed);
        // The support that was off comes back; the pin does not.
        resumed.begin_stage(third()).unwrap();
        run(&mut resumed);
        let mut going_on = start();
        to_release(&mut going_on);
        run(&mut going_on);
        going_on.begin_stage(third()).unwrap();
        run(&mut going_on);
        same(&going_on, &resumed);
        assert!(resumed.pressures()[1].iter().all(|&p| p == 0.0));
    }
}

/// Velocities of the variational midpoint scheme leave the constraint by a part of first order, positions do not (see its documentation). Where something has no
/// mass momenta say nothing of its velocity, and the scheme is refused.
#[test]
fn variational_midpoint_under_constraints() {
    use stoss_integrators::VariationalMidpoint;
    let pin_speed = |step: f64| {
        let (model, body) = pendulum(bob(), [0.0, 1.5, 0.0]);
        let mut simulation =
            Simulation::new(model, settings(Some(Box::new(VariationalMidpoint::default())), step, 0.5)).unwrap();
        run(&mut simulation);
        let point = body.point([0.0; 3]);
        let at = |x: &[f64]| {
            let sum = |i: usize| point.terms.iter().map(|&(v, w)| w * x[3 * v as usize + i]).sum::<f64>();
            sum(0).hypot(sum(1)).hypot(sum(2))
        };
        assert!(at(&simulation.state().q) < 1e-12);
        at(&simulation.state().v)
    };
    let ratio = pin_speed(0.002) / pin_speed(0.001);
    assert!((ratio - 2.0).abs() < 0.02, "{ratio}");
    let plate = RigidMass::new(2.0, [0.8, 0.0, 0.0], [0.10, 0.0, 0.02], AXES).unwrap();
    let (model, _) = pendulum(plate, [0.0; 3]);
    let refused = Simulation::new(model, settings(Some(Box::new(VariationalMidpoint::default())), 0.01, 1.0));
    assert!(matches!(refused, Err(SimulationError::Model(reason)) if reason.contains("coordinates without mass")));
}

/// A spring from a node to a point of the ground, as a potential.
#[derive(Debug)]
struct Spring {
    node: u32,
    anchor: [f64; 3],
    stiffness: f64,
}

impl Term for Spring {
    fn name(&self) -> &str {
        "spring"
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        visit(&[self.node], &[]);
    }
    fn assemble(&self, step: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        let Some(rule) = step.rule.constraint() else { return Ok(()) };
        let theta = if rule == GradientRule::EndPoint { 1.0 } else { 0.5 };
        let mut local = Local { nodes: vec![self.node], ..Local::default() };
        local.reset(want_tangent);
        for i in 0..3 {
            let at = 3 * self.node as usize + i;
            let q = (1.0 - theta) * step.q_n[at] + theta * step.q_np1[at];
            local.residual[i] = self.stiffness * (q - self.anchor[i]);
            if want_tangent {
                local.tangent[4 * i] = theta * self.stiffness;
            }
        }
        visit(&local);
        Ok(())
    }
    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        let first = 3 * self.node as usize;
        let square: f64 = (0..3).map(|i| (q[first + i] - self.anchor[i]).powi(2)).sum();
        Ok(0.5 * self.stiffness * square)
    }
    fn potential(&self) -> Option<&dyn Potential> {
        Some(self)
    }
    fn potential_mut(&mut self) -> Option<&mut dyn Potential> {
        Some(self)
    }
}

impl Potential for Spring {}

/// The centre of a rigid body on a spring: it hangs, swings as `cos(omega t)`, and flies on when the spring is switched off.
#[test]
fn potentials_are_switched_with_their_energy() {
    let body = RigidBody::new("body", 0, RigidMass::new(2.0, [0.0; 3], [0.1, 0.2, 0.3], AXES).unwrap());
    let mut model = Model::default();
    model.reference.extend(body.reference().iter().flatten());
    model.velocity.extend([0.0; 12]);
    let stiffness = 50.0;
    let spring = Spring { node: 0, anchor: [0.3, 0.0, 0.0], stiffness };
    model.contacts.push(CouplingTerm::new("rigidity", body.constraints(), 1.0));
    model.contacts.push(CouplingTerm::new("spring", spring, 1.0));
    model.parts.push(Box::new(body));
    let off = || Switches { contacts: vec![1], ..Switches::default() };
    let dynamics = || -> Option<Box<dyn Scheme>> { Some(Box::new(EnergyMomentum)) };
    let mut simulation = Simulation::staged(model, settings(dynamics(), 0.05, 0.1), later(off())).unwrap();
    run(&mut simulation);
    assert_eq!((simulation.balance().total(), simulation.state().q[0]), (0.0, 0.0));
    // On: its energy is work from outside.
    let scheme: Option<Box<dyn Scheme>> = Some(Box::new(GeneralisedAlpha::chung_hulbert(1.0)));
    simulation.begin_stage(stage(scheme, 0.001, 0.3, Switches::default())).unwrap();
    assert_eq!(simulation.balance().contact, 0.5 * stiffness * 0.09);
    assert_eq!(simulation.balance().external_work, simulation.balance().contact);
    // a = k x / m.
    assert!((simulation.state().a[0] - stiffness * 0.3 / 2.0).abs() < 1e-12);
    run(&mut simulation);
    let omega = (stiffness / 2.0_f64).sqrt();
    assert!((simulation.state().q[0] - 0.3 * (1.0 - (omega * 0.2).cos())).abs() < 1e-5);
    // The method keeps the energy of linear systems; now the next scheme does.
    let total = simulation.balance().total();
    simulation.begin_stage(stage(dynamics(), 0.01, 0.5, off())).unwrap();
    let balance = *simulation.balance();
    assert_eq!(balance.contact, 0.0);
    assert!((balance.total() - total).abs() < 1e-15);
    let (x, v) = (simulation.state().q[0], simulation.state().v[0]);
    run(&mut simulation);
    assert!((simulation.state().q[0] - x - 0.2 * v).abs() < 1e-13);
    assert!((simulation.balance().total() - total).abs() < 1e-13);
}

/// A contact that is off while the body is in the air, and on when it arrives.
#[test]
fn contact_comes_back() {
    let mut model = Model::default();
    let lower = add_block(&mut model, [-0.5, -0.5, -1.0], [1.5, 1.5, 0.0], [3, 3, 1]);
    let count = model.node_count() as u32;
    let upper = add_block(&mut model, [0.0, 0.0, 0.1], [1.0, 1.0, 1.1], [2, 2, 1]);
    model.velocity[3 * count as usize..].iter_mut().skip(2).step_by(3).for_each(|v| *v = -1.0);
    hold(&mut model, lower.nodes_of("bottom").unwrap().to_vec(), Table::constant(&[0.0; 3]));
    let facets = |mesh: &Mesh, set: &str, first: u32| -> Vec<[u32; 4]> {
        mesh.facets_of(set).unwrap().iter().map(|f| [0, 1, 2, 3].map(|k: usize| f.nodes[k] + first)).collect()
    };
    let (slave, master) = (facets(&upper, "bottom", count), facets(&lower, "top", 0));
    let method =
        NodeToSurface::new("floor", &slave, &master, &model.reference, NodeToSurfaceOptions::default()).unwrap();
    model.contacts.push(CouplingTerm::new("floor", method, 2000.0));
    let scheme = || -> Option<Box<dyn Scheme>> { Some(Box::new(EnergyMomentum)) };
    let off = Switches { contacts: vec![0], ..Switches::default() };
    let mut simulation = Simulation::staged(model, settings(scheme(), 0.01, 0.05), later(off)).unwrap();
    let record = simulation.advance().unwrap();
    // A row of zeros.
    let contact = record.contact.unwrap();
    assert_eq!((contact.active, contact.force_on_slave, contact.pairs.len()), (0, [0.0; 3], 1));
    run(&mut simulation);
    assert!(simulation.contact_report(0).unwrap().is_empty());
    simulation.begin_stage(stage(scheme(), 0.01, 0.4, Switches::default())).unwrap();
    let total = simulation.balance().total();
    let mut closed = 0;
    while !simulation.finished() {
        let contact = simulation.advance().unwrap().contact.unwrap();
        closed = closed.max(contact.active);
        assert!(contact.min_gap > -1e-10);
    }
    assert_eq!(closed, 9);
    assert!(simulation.body_balance(1).linear_momentum[2] > 0.0, "it bounced");
    let balance = simulation.balance();
    assert!((balance.total() + balance.closing_loss - total).abs() < 1e-9);
}

/// A pin that is switched on far from where it has to be is refused, and nothing has changed; near to it, it pulls.
#[test]
fn a_pin_comes_back_only_where_it_belongs() {
    let fallen = |end: f64| {
        let (model, _) = pendulum(bob(), [0.0; 3]);
        let off = Switches { contacts: vec![1], ..Switches::default() };
        let scheme = Some(Box::new(EnergyMomentum) as Box<dyn Scheme>);
        let mut simulation = Simulation::staged(model, settings(scheme, 0.01, end), later(off)).unwrap();
        run(&mut simulation);
        simulation
    };
    // After 5 m of fall; the length of the pin is 1.
    let mut simulation = fallen(1.0);
    let (state, balance) = (simulation.state().clone(), *simulation.balance());
    let error = simulation.begin_stage(stage(None, 1.0, 2.0, Switches::default())).unwrap_err();
    assert!(matches!(&error, SimulationError::Jump { what, .. } if what == "constraint pin"), "{error}");
    assert_eq!((simulation.state(), simulation.balance(), simulation.stage()), (&state, &balance, 1));
    assert!(simulation.active()[1].iter().all(|&active| !active));
    let scheme = Some(Box::new(EnergyMomentum) as Box<dyn Scheme>);
    let off = Switches { contacts: vec![1], ..Switches::default() };
    simulation.begin_stage(stage(scheme, 0.01, 1.2, off)).unwrap();
    run(&mut simulation);
    assert!((simulation.state().q[2] + 0.5 * GRAVITY * 1.44).abs() < 1e-11);
    // After 5 cm.
    let mut simulation = fallen(0.1);
    let scheme = Some(Box::new(EnergyMomentum) as Box<dyn Scheme>);
    simulation.begin_stage(stage(scheme, 0.01, 0.11, Switches::default())).unwrap();
    assert!(simulation.active()[1].iter().all(|&active| active));
    run(&mut simulation);
    let rows = RigidBody::new("body", 0, bob()).point([0.0; 3]);
    let height: f64 = rows.terms.iter().map(|&(v, w)| w * simulation.state().q[3 * v as usize + 2]).sum();
    assert!(height.abs() < 1e-12);
}
