//! Pendulums and mechanisms in whole runs under the energy-momentum scheme.

use crate::common::{ABOUT_Z, AXES, add_body, add_constraint, add_weight, finish, rod, run};
use stoss_multibody::{Joint, JointFrame, JointKind, RigidMass};
use stoss_reference_cases::multibody::mechanisms::slider;
use stoss_solver::Model;

const GRAVITY: [f64; 3] = [0.0, -9.81, 0.0];

fn joint(model: &mut Model, name: &str, kind: JointKind, a: &JointFrame, b: &JointFrame) -> usize {
    let joint = Joint::new(name, kind, a, b, 0.5, &model.reference).unwrap();
    add_constraint(model, name, joint)
}

/// A double pendulum whose links turn about axes that are not parallel: energy at round-off over 1000 steps.
#[test]
fn double_pendulum_keeps_its_energy() {
    let mut model = Model::default();
    let upper = add_body(&mut model, "upper", rod(1.5, [0.5, 0.0, 0.0], 0.12), [0.0; 3], [0.0; 3]);
    let lower = add_body(&mut model, "lower", rod(0.8, [1.4, 0.0, 0.0], 0.08), [0.0; 3], [0.0; 3]);
    add_weight(&mut model, &[&upper, &lower], GRAVITY);
    joint(
        &mut model,
        "shoulder",
        JointKind::Hinge,
        &JointFrame::ground([0.0; 3], ABOUT_Z),
        &upper.frame([0.0; 3], ABOUT_Z),
    );
    let skew = stoss_multibody::axes_along([0.3, 0.2, 1.0]).unwrap();
    joint(
        &mut model,
        "elbow",
        JointKind::Hinge,
        &upper.frame([1.0, 0.0, 0.0], skew),
        &lower.frame([1.0, 0.0, 0.0], skew),
    );
    let mut simulation = run(model, 0.005, 5.0);
    let first = *simulation.balance();
    let (mut most, mut all, mut kinetic) = (0, 0, 0.0_f64);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        most = most.max(record.iterations);
        all += record.iterations;
        kinetic = kinetic.max(record.balance.kinetic);
    }
    let last = *simulation.balance();
    println!("double pendulum: energy {:e}, iterations {most} / {}", last.total() - first.total(), all as f64 / 1000.0);
    assert!(kinetic > 10.0, "{kinetic}");
    assert!((last.total() - first.total()).abs() < 1e-10, "{:e}", last.total() - first.total());
    assert!(most <= 5, "{most}");
}

/// Two bodies on a ball joint in free flight: all ten integrals.
#[test]
fn a_ball_joint_in_flight_keeps_everything() {
    let mut model = Model::default();
    let at = [0.5, 0.1, 0.0];
    let spin = [0.2, 2.0, 1.0];
    let velocity = |c: [f64; 3], w: [f64; 3]| {
        let r: [f64; 3] = std::array::from_fn(|i| c[i] - at[i]);
        [0.1 + w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]]
    };
    let (c1, c2, other) = ([0.0, 0.0, 0.0], [1.0, 0.2, 0.3], [-3.0, 0.5, 1.0]);
    let one = add_body(&mut model, "one", rod(1.0, c1, 0.2), velocity(c1, spin), spin);
    let two = add_body(&mut model, "two", rod(2.0, c2, 0.3), velocity(c2, other), other);
    joint(&mut model, "ball", JointKind::Ball, &one.frame(at, AXES), &two.frame(at, AXES));
    let mut simulation = run(model, 0.01, 10.0);
    let first = *simulation.balance();
    let (most, _) = finish(&mut simulation);
    let last = *simulation.balance();
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    println!(
        "ball: energy {:e}, momenta {:e} {:e}, {most} iterations",
        last.total() - first.total(),
        apart(first.linear_momentum, last.linear_momentum),
        apart(first.angular_momentum, last.angular_momentum)
    );
    assert!((last.total() / first.total() - 1.0).abs() < 1e-11);
    assert!(apart(first.linear_momentum, last.linear_momentum) < 1e-10);
    assert!(apart(first.angular_momentum, last.angular_momentum) < 1e-10);
    assert!(most <= 5, "{most}");
}

/// A conical pendulum: a body on a ball joint goes round at the angular velocity of its inclination, `w^2 J' cos a = m g l` with the inertia of a body that has none about
/// its rod; vertical momentum and energy stay.
#[test]
fn spherical_pendulum_keeps_energy_and_vertical_momentum() {
    let mut model = Model::default();
    let (l, a) = (0.7_f64, 0.5_f64);
    let centre = [l * a.sin(), -l * a.cos(), 0.0];
    let axes = [[a.cos(), a.sin(), 0.0], [-a.sin(), a.cos(), 0.0], [0.0, 0.0, 1.0]];
    let (m, e) = (1.3, 1e-3);
    let mass = RigidMass::new(m, centre, [e, e, e], axes).unwrap();
    // (m l^2) w^2 sin a cos a = m g l sin a; a ball's own inertia adds nothing to it, for J is isotropic there and its axis is fixed.
    let w = (9.81 / (l * a.cos())).sqrt();
    let body = add_body(&mut model, "bob", mass, [0.0, 0.0, -w * centre[0]], [0.0, w, 0.0]);
    add_weight(&mut model, &[&body], GRAVITY);
    joint(&mut model, "pivot", JointKind::Ball, &JointFrame::ground([0.0; 3], AXES), &body.frame([0.0; 3], AXES));
    let mut simulation = run(model, 0.002, 2.0);
    let first = *simulation.balance();
    let (most, _) = finish(&mut simulation);
    let last = *simulation.balance();
    assert!((last.total() - first.total()).abs() < 1e-11);
    assert!((last.angular_momentum[1] - first.angular_momentum[1]).abs() < 1e-11);
    assert!(most <= 5);
    // It keeps its height, and turns as fast as the midpoint rule lets it, second order in w dt.
    let q = &simulation.state().q;
    assert!((q[1] - centre[1]).abs() < 1e-4, "{}", q[1] - centre[1]);
    let angle = (-q[2]).atan2(q[0]);
    let expected = (2.0 * w + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    assert!((angle - expected).abs() < 1e-3, "{angle} {expected}");
}

/// A hinge that is spun for 50 turns.
#[test]
fn an_angle_is_followed_over_50_turns() {
    let mut model = Model::default();
    let w = std::f64::consts::TAU;
    let body = add_body(&mut model, "wheel", rod(1.0, [0.0; 3], 0.5), [0.0; 3], [0.0, 0.0, w]);
    let ground = JointFrame::ground([0.0; 3], ABOUT_Z);
    let at = joint(&mut model, "axle", JointKind::Hinge, &ground, &body.frame([0.0; 3], ABOUT_Z));
    let copy =
        Joint::new("copy", JointKind::Hinge, &ground, &body.frame([0.0; 3], ABOUT_Z), 0.5, &model.reference).unwrap();
    let mut simulation = run(model, 0.02, 50.0);
    let first = *simulation.balance();
    finish(&mut simulation);
    assert!((simulation.balance().total() / first.total() - 1.0).abs() < 1e-11);
    // The joint's own history, by way of the checkpoint.
    use stoss_term::Term;
    let checkpoint = simulation.checkpoint("t", Default::default());
    let mut copy = copy;
    // Couplings are the last terms.
    let first = checkpoint.histories.len() - simulation.model().contacts.len();
    copy.load_history(&checkpoint.histories[first + at]).unwrap();
    let angle = copy.coordinate(0, &simulation.state().q).unwrap();
    // Of a turn of the midpoint rule: 2 atan(w dt / 2) a step.
    let expected = 2500.0 * 2.0 * (w * 0.02 / 2.0).atan();
    assert!((angle - expected).abs() < 1e-8, "{angle} {expected}");
    assert!(angle > 49.0 * std::f64::consts::TAU);
}

/// Slider-crank: the position of the slider is that of the closed form, energy stays.
#[test]
fn slider_crank() {
    let mut model = Model::default();
    let (r, l, w) = (0.3, 1.0, 4.0);
    let crank = add_body(&mut model, "crank", rod(1.0, [0.15, 0.0, 0.0], 0.02), [0.0, 0.15 * w, 0.0], [0.0, 0.0, w]);
    // At the dead centre the rod turns by -r w / l about the slider, which does not move.
    let turn = -r * w / l;
    let conrod =
        add_body(&mut model, "rod", rod(0.6, [0.8, 0.0, 0.0], 0.06), [0.0, turn * (0.8 - 1.3), 0.0], [0.0, 0.0, turn]);
    let block = add_body(&mut model, "slider", rod(0.5, [1.3, 0.0, 0.0], 0.01), [0.0; 3], [0.0; 3]);
    joint(
        &mut model,
        "main",
        JointKind::Hinge,
        &JointFrame::ground([0.0; 3], ABOUT_Z),
        &crank.frame([0.0; 3], ABOUT_Z),
    );
    // A plane loop of hinges would have redundant equations: the pins are balls and a cardan joint.
    joint(
        &mut model,
        "big end",
        JointKind::Ball,
        &crank.frame([0.3, 0.0, 0.0], AXES),
        &conrod.frame([0.3, 0.0, 0.0], AXES),
    );
    let pins = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    let at = [1.3, 0.0, 0.0];
    joint(&mut model, "small end", JointKind::Universal, &block.frame(at, pins), &conrod.frame(at, pins));
    joint(
        &mut model,
        "guide",
        JointKind::Slider,
        &JointFrame::ground([1.3, 0.0, 0.0], AXES),
        &block.frame([1.3, 0.0, 0.0], AXES),
    );
    let mut simulation = run(model, 0.002, 2.0);
    let first = *simulation.balance();
    let mut most = 0;
    while !simulation.finished() {
        most = most.max(simulation.advance().unwrap().iterations);
        let q = &simulation.state().q;
        let expected = slider(r, l, q[1].atan2(q[0]));
        assert!((q[24] - expected).abs() < 1e-9, "{} {expected}", q[24]);
    }
    assert!((simulation.balance().total() / first.total() - 1.0).abs() < 1e-10);
    assert!(most <= 5);
}

/// A hub with ten hinges: more equations than the hub has components. The factorisation by fronts has its pivots.
#[test]
fn a_hub_with_ten_hinges() {
    for order in [false, true] {
        let mut model = Model::default();
        let hub = add_body(&mut model, "hub", rod(3.0, [0.0; 3], 0.8), [0.0; 3], [0.0, 0.0, 1.0]);
        let mut frames = Vec::new();
        for k in 0..10 {
            let angle = f64::from(k) * std::f64::consts::TAU / 10.0;
            let (at, out) = ([0.5 * angle.cos(), 0.5 * angle.sin(), 0.0], [0.9 * angle.cos(), 0.9 * angle.sin(), 0.0]);
            let blade = add_body(&mut model, "blade", rod(0.4, out, 0.02), [-out[1], out[0], 0.1], [0.0, 0.0, 1.0]);
            // Flapping: the hinge of a blade is along the rim, so only its centre's velocity out of the plane is not admissible; the spin makes up for it.
            let axes = stoss_multibody::axes_along([-angle.sin(), angle.cos(), 0.0]).unwrap();
            frames.push((hub.frame(at, axes), blade.frame(at, axes)));
        }
        // Admissible velocities: no flapping at the start.
        for (k, v) in model.velocity.iter_mut().enumerate() {
            if k % 12 == 2 {
                *v = 0.0;
            }
        }
        for (a, b) in &frames {
            let (a, b) = if order { (a, b) } else { (b, a) };
            joint(&mut model, "hinge", JointKind::Hinge, a, b);
        }
        let first_blade = 12;
        model.loads.push(stoss_solver::Load {
            name: "lift".into(),
            kind: stoss_solver::LoadKind::Dead { patterns: vec![vec![(first_blade + 2, 1.0), (2, -1.0)]] },
            magnitude: stoss_solver::Table::constant(&[0.3]),
        });
        let mut simulation = run(model, 0.01, 1.0);
        let first = *simulation.balance();
        let (most, _) = finish(&mut simulation);
        let statistics = simulation.solver_statistics();
        println!("hub: {most} iterations, {} equations, {statistics:?}", simulation.equations());
        assert_eq!(statistics.pivoting_fallbacks, 0);
        assert!((simulation.balance().total() / first.total() - 1.0).abs() < 1e-9);
        assert!(most <= 5);
    }
}

/// A chain of 30 links of which each carries three pendants and names itself as side a of all four joints, 20 equations on 12 components: the fronts have their pivots.
#[test]
fn a_chain_with_pendants() {
    let mut model = Model::default();
    let mut joints = Vec::new();
    let mut previous: Option<stoss_multibody::RigidBody> = None;
    for k in 0..30 {
        let x = f64::from(k);
        let link = add_body(&mut model, "link", rod(1.0, [x + 0.5, 0.0, 0.0], 0.1), [0.0; 3], [0.0; 3]);
        let frame = |x: f64, y: f64, body: &stoss_multibody::RigidBody| body.frame([x, y, 0.0], ABOUT_Z);
        for p in 0..3 {
            let at = x + 0.25 * f64::from(p + 1);
            let pendant = add_body(&mut model, "pendant", rod(0.2, [at, -0.3, 0.1], 0.01), [0.0; 3], [0.0; 3]);
            joints.push((frame(at, 0.0, &link), frame(at, 0.0, &pendant)));
        }
        if let Some(previous) = &previous {
            joints.push((frame(x, 0.0, &link), frame(x, 0.0, previous)));
        }
        previous = Some(link);
    }
    let weight = (0..model.node_count() as u32 / 4).map(|body| (12 * body + 1, -1.0)).collect();
    for (a, b) in &joints {
        joint(&mut model, "hinge", JointKind::Hinge, a, b);
    }
    model.loads.push(stoss_solver::Load {
        name: "weight".into(),
        kind: stoss_solver::LoadKind::Dead { patterns: vec![weight] },
        magnitude: stoss_solver::Table::constant(&[1.0]),
    });
    let mut simulation = run(model, 0.02, 0.2);
    let start = *simulation.balance();
    let (most, _) = finish(&mut simulation);
    let statistics = simulation.solver_statistics();
    println!("chain: {most} iterations, {} equations, {statistics:?}", simulation.equations());
    assert_eq!(statistics.pivoting_fallbacks, 0);
    assert!((simulation.balance().total() - start.total()).abs() < 1e-9);
}
