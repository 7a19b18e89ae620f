//! What acts on the coordinate of a joint, against closed forms in whole runs.

use crate::common::{ABOUT_Z, AXES, add_body, add_constraint, add_weight, finish, rod, run, run_with};
use std::sync::Arc;
use stoss_multibody::{
    CoordinateFriction, CoordinateOptions, CoordinateSpring, DriveFunction, Joint, JointFrame, JointKind,
    PiecewiseLinear, RigidMass,
};
use stoss_reference_cases::multibody::mechanisms::braked;
use stoss_solver::{Model, Simulation};

/// A wheel of inertia `j` about z on an axle.
fn wheel(j: f64, spin: f64, turned: f64, options: CoordinateOptions) -> Model {
    let mut model = Model::default();
    let body = add_body(&mut model, "wheel", rod(1.0, [0.0; 3], j), [0.0; 3], [0.0, 0.0, spin]);
    let (s, c) = turned.sin_cos();
    // The ground's frame is behind by the angle at the start.
    let ground = JointFrame::ground([0.0; 3], [[0.0, 0.0, 1.0], [c, -s, 0.0], [s, c, 0.0]]);
    let axle = Joint::new("axle", JointKind::Hinge, &ground, &body.frame([0.0; 3], ABOUT_Z), 0.3, &model.reference);
    add_constraint(&mut model, "axle", axle.unwrap().with_options(options).unwrap());
    model
}

/// Angle of the first director of the wheel.
fn angle(simulation: &Simulation) -> f64 {
    let q = &simulation.state().q;
    q[4].atan2(q[3])
}

fn spin(simulation: &Simulation) -> f64 {
    simulation.balance().angular_momentum[2]
}

/// Torsion pendulum: `w = sqrt(k / J)`, measured by the zeros of the angle, at second order; energy at round-off.
#[test]
fn torsion_pendulum() {
    let (j, k) = (0.5, 8.0_f64);
    let period = std::f64::consts::TAU * (j / k).sqrt();
    let measured = |dt: f64| {
        let options =
            CoordinateOptions { spring: Some(CoordinateSpring { stiffness: k, rest: 0.0 }), ..Default::default() };
        let mut simulation = run(wheel(j, 0.0, 0.7, options), dt, 5.3 * period);
        let first = *simulation.balance();
        assert!((first.contact - 0.5 * k * 0.49).abs() < 1e-12, "{}", first.contact);
        let (mut crossings, mut before) = (Vec::new(), 0.7);
        while !simulation.finished() {
            let record = simulation.advance().unwrap();
            let now = angle(&simulation) + 0.7;
            if before > 0.0 && now <= 0.0 {
                crossings.push(record.time - dt * now / (now - before));
            }
            before = now;
            assert!((record.balance.total() / first.total() - 1.0).abs() < 1e-10);
            assert!(record.iterations <= 5);
        }
        (crossings[4] - crossings[0]) / 4.0
    };
    let errors = [0.02, 0.01].map(|dt| (measured(dt) / period - 1.0).abs());
    println!("period errors {errors:?}");
    // 1 + (w dt)^2 / 12.
    assert!(errors[1] < 1e-3 && (errors[0] / errors[1] - 4.0).abs() < 0.3, "{errors:?}");
}

/// A bearing with Coulomb friction stops at `t = J w0 / T` after half of `w0` times that, and stays there; all of its energy is dissipated but for what the step in
/// which it stops leaves.
#[test]
fn a_bearing_with_friction_stops() {
    let (j, w, bound) = (0.5, 6.0, 1.5);
    let options =
        CoordinateOptions { friction: Some(CoordinateFriction { bound, ..Default::default() }), ..Default::default() };
    // Not a whole number of steps.
    let mut simulation = run(wheel(j, w, 0.0, options), 0.0123, 3.0);
    let first = *simulation.balance();
    let (stops, way) = braked(j, w, bound);
    let (mut stopped, mut before, mut turned, mut dissipated) = (None, 0.0, 0.0, 0.0);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        let now = angle(&simulation);
        let change =
            (now - before + 9.0 * std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        turned += change;
        before = now;
        assert!((record.balance.total() / first.total() - 1.0).abs() < 1e-10);
        assert!(record.balance.dissipation >= dissipated);
        assert!(record.iterations <= 6, "{}", record.iterations);
        dissipated = record.balance.dissipation;
        if change.abs() < 1e-9 && stopped.is_none() {
            stopped = Some(record.time);
        }
        if let Some(time) = stopped {
            assert!(change.abs() < 1e-9, "it moves again at {}, after {time}: {change:e}", record.time);
        }
        if record.time < stops - 0.02 {
            // The impulse of a torque on directors is that of `(d/2) / tan(d/2)` times it for a turn `d` of a step; its work is exact.
            let d = w * 0.0123;
            assert!((spin(&simulation) - (j * w - bound * record.time)).abs() < d * d / 12.0 * bound * record.time);
            assert!((record.balance.dissipation - bound * turned).abs() < 1e-10);
        }
    }
    let time = stopped.unwrap();
    println!("stops at {time}, {stops}; {turned} {way}; left {:e}", simulation.balance().kinetic);
    assert!((time - stops).abs() < 2.0 * 0.0123);
    assert!((turned - way).abs() < 2e-3);
    assert!(simulation.balance().kinetic <= 0.5 * (0.5 * bound * 0.0123_f64).powi(2) / j);
}

/// Friction from the force of the bearing: a weight `m g` on a horizontal axle brakes with `mu r m g`.
#[test]
fn journal_friction_follows_the_force() {
    let (j, w, mu, r) = (0.5, 6.0, 0.3, 0.1);
    let options = CoordinateOptions {
        friction: Some(CoordinateFriction { bound: 0.0, coefficient: mu, radius: r }),
        ..Default::default()
    };
    let mut model = Model::default();
    let body = add_body(&mut model, "wheel", rod(2.0, [0.0; 3], j), [0.0; 3], [0.0, 0.0, w]);
    add_weight(&mut model, &[&body], [0.0, -9.81, 0.0]);
    let ground = JointFrame::ground([0.0; 3], ABOUT_Z);
    let axle = Joint::new("axle", JointKind::Hinge, &ground, &body.frame([0.0; 3], ABOUT_Z), 0.3, &model.reference);
    add_constraint(&mut model, "axle", axle.unwrap().with_options(options).unwrap());
    let mut simulation = run(model, 0.01, 2.0);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        let braked = mu * r * 2.0 * 9.81 * record.time;
        assert!((spin(&simulation) - (j * w - braked)).abs() < (w * 0.01_f64).powi(2) / 12.0 * braked);
    }
}

/// `J w' = -d w`: `w = w0 exp(-d t / J)`, at second order; what is lost is dissipated.
#[test]
fn viscous_decay() {
    let (j, w, d) = (0.5, 3.0, 0.4);
    let error = |dt: f64| {
        let mut simulation = run(wheel(j, w, 0.0, CoordinateOptions { viscous: d, ..Default::default() }), dt, 2.0);
        let first = *simulation.balance();
        finish(&mut simulation);
        assert!((simulation.balance().total() / first.total() - 1.0).abs() < 1e-10);
        (spin(&simulation) / j - w * (-d * 2.0 / j).exp()).abs()
    };
    let errors = [0.04, 0.02].map(error);
    println!("viscous {errors:?}");
    assert!((errors[0] / errors[1] - 4.0).abs() < 0.2 && errors[1] < 1e-3);
}

/// A motor spins a wheel up: its work is the change of the energy, its torque `J w'`.
#[test]
fn work_of_a_motor() {
    let (j, a) = (0.5, 1.7);
    let motor = DriveFunction(move |t: f64| 0.5 * a * t * t);
    let mut simulation =
        run(wheel(j, 0.0, 0.0, CoordinateOptions { motor: Some(Arc::new(motor)), ..Default::default() }), 0.01, 2.0);
    let first = *simulation.balance();
    finish(&mut simulation);
    let last = simulation.balance();
    let w = a * 2.0;
    println!("motor: {:e}, torque {}", last.external_work - 0.5 * j * w * w, 0.3 * simulation.pressures()[1][5]);
    assert!((last.total() - first.total()).abs() < 1e-10);
    assert!((last.external_work - (last.kinetic - first.kinetic)).abs() < 1e-10);
    // Directors are turned by 2 atan a step, so the spin is that of the angle at second order.
    assert!((last.external_work / (0.5 * j * w * w) - 1.0).abs() < 1e-3);
    assert!((0.3 * simulation.pressures()[1][5] / (j * a) - 1.0).abs() < 1e-2);
    let table = PiecewiseLinear(vec![(0.0, 0.0), (1.0, 2.0), (2.0, 2.0)]);
    use stoss_multibody::Drive;
    assert_eq!([-1.0, 0.0, 0.25, 1.0, 1.5, 9.0].map(|t| table.value(t)), [0.0, 0.0, 0.5, 2.0, 2.0, 2.0]);
}

/// A wheel runs against the limits of its angle: it does not pass, and no step gains energy.
#[test]
fn a_wheel_between_limits() {
    let options = CoordinateOptions { limits: Some([-1.0, 0.7]), ..Default::default() };
    let mut simulation = run(wheel(0.5, 2.0, 0.0, options), 0.013, 3.0);
    let energy = simulation.balance().kinetic;
    let (mut before, mut touched) = (energy, false);
    while !simulation.finished() {
        let balance = simulation.advance().unwrap().balance;
        let now = angle(&simulation);
        assert!((-1.0 - 1e-9..=0.7 + 1e-9).contains(&now), "{now}");
        assert!(balance.kinetic - before < 1e-10 * energy, "{} after {before}", balance.kinetic);
        let books = balance.total() + balance.closing_loss - energy;
        assert!(books.abs() < 1e-10 * energy, "{books:e}");
        (before, touched) = (balance.kinetic, touched || balance.closing_loss > 0.0);
    }
    assert!(touched);
}

/// A slider falls on its limit: it never passes it, energy is never gained, and what closing costs is the loss of closing gaps.
#[test]
fn a_slider_between_limits() {
    let mut model = Model::default();
    let body = add_body(&mut model, "block", rod(1.2, [0.0; 3], 0.1), [2.0, 0.0, 0.0], [0.0; 3]);
    add_weight(&mut model, &[&body], [0.0, 0.0, -9.81]);
    let options = CoordinateOptions { limits: Some([-0.2, 0.3]), ..Default::default() };
    let guide = Joint::new(
        "guide",
        JointKind::Slider,
        &JointFrame::ground([0.0; 3], AXES),
        &body.frame([0.0; 3], AXES),
        0.2,
        &model.reference,
    );
    let guide = guide.unwrap().with_options(options).unwrap();
    add_constraint(&mut model, "guide", guide);
    let mut simulation = run(model, 0.0173, 2.0);
    let first = *simulation.balance();
    let (mut lost, mut touched) = (0.0, 0);
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        let x = simulation.state().q[0];
        assert!((-0.2 - 1e-9..=0.3 + 1e-9).contains(&x), "{x}");
        assert!(
            ((record.balance.total() + record.balance.closing_loss) / first.total() - 1.0).abs() < 1e-9,
            "{:e}",
            record.balance.total() + record.balance.closing_loss - first.total()
        );
        assert!(record.balance.closing_loss >= lost && record.balance.dissipation == 0.0);
        let closing: f64 = record.closing.iter().sum();
        assert!((closing - (record.balance.closing_loss - lost)).abs() < 1e-12 * first.total(), "{closing:e}");
        assert!(record.iterations <= 6, "{}", record.iterations);
        touched += usize::from(record.balance.closing_loss > lost);
        lost = record.balance.closing_loss;
    }
    println!("limits: touched {touched}, lost {lost}");
    assert!(touched > 1);
}

/// Statics: a spring against a weight on an arm; friction on the increments holds what it can, and viscous friction has no effect.
#[test]
fn statics() {
    let turned = |friction: f64, viscous: f64| {
        let mut model = Model::default();
        let body = add_body(&mut model, "arm", rod(1.0, [0.4, 0.0, 0.0], 0.1), [0.0; 3], [0.0; 3]);
        let at = 3 * body.centre().terms[0].0 + 1;
        model.loads.push(stoss_solver::Load {
            name: "weight".into(),
            kind: stoss_solver::LoadKind::Dead { patterns: vec![vec![(at, -3.0)]] },
            magnitude: stoss_solver::Table::from_rows(&[vec![0.0, 0.0], vec![1.0, 1.0]], 1).unwrap(),
        });
        let options = CoordinateOptions {
            spring: Some(CoordinateSpring { stiffness: 2.0, rest: 0.0 }),
            viscous,
            friction: (friction > 0.0).then_some(CoordinateFriction { bound: friction, ..Default::default() }),
            ..Default::default()
        };
        let ground = JointFrame::ground([0.0; 3], ABOUT_Z);
        let hinge =
            Joint::new("hinge", JointKind::Hinge, &ground, &body.frame([0.0; 3], ABOUT_Z), 0.4, &model.reference);
        add_constraint(&mut model, "hinge", hinge.unwrap().with_options(options).unwrap());
        let mut simulation = run_with(model, 0.1, 1.0, None);
        finish(&mut simulation);
        angle(&simulation)
    };
    // k g + friction = P a cos g, downwards.
    let residual = |g: f64, friction: f64| 2.0 * -g + friction - 3.0 * 0.4 * g.cos();
    let free = turned(0.0, 0.0);
    assert!(residual(free, 0.0).abs() < 1e-9, "{free}");
    assert_eq!(free, turned(0.0, 5.0));
    assert!(residual(turned(0.5, 0.0), 0.5).abs() < 1e-9);
    assert!(turned(1.3, 0.0).abs() < 1e-9);
}

/// A hinge with mass far from the axis at a rough state of all options: the total energy of the balance stays.
#[test]
fn everything_at_once_is_balanced() {
    let mut model = Model::default();
    let mass = RigidMass::new(1.0, [0.4, 0.1, 0.0], [0.02, 0.05, 0.01], AXES).unwrap();
    let body = add_body(&mut model, "arm", mass, [0.0; 3], [0.0; 3]);
    add_weight(&mut model, &[&body], [0.0, -9.81, 0.0]);
    let options = CoordinateOptions {
        spring: Some(CoordinateSpring { stiffness: 0.5, rest: 0.2 }),
        viscous: 0.05,
        friction: Some(CoordinateFriction { bound: 0.1, coefficient: 0.2, radius: 0.05 }),
        limits: Some([-2.2, 0.4]),
        ..Default::default()
    };
    let hinge = Joint::new(
        "hinge",
        JointKind::Hinge,
        &JointFrame::ground([0.0; 3], ABOUT_Z),
        &body.frame([0.0; 3], ABOUT_Z),
        0.4,
        &model.reference,
    );
    add_constraint(&mut model, "hinge", hinge.unwrap().with_options(options).unwrap());
    let mut simulation = run(model, 0.01, 4.0);
    let first = *simulation.balance();
    let mut most = 0;
    while !simulation.finished() {
        let record = simulation.advance().unwrap();
        most = most.max(record.iterations);
        let sum = record.balance.total() + record.balance.closing_loss;
        assert!((sum - first.total()).abs() < 1e-9, "{:e}", sum - first.total());
    }
    println!("everything: {most} iterations, dissipated {}", simulation.balance().dissipation);
    assert!(simulation.balance().dissipation > 0.5);
}

/// A run that is resumed from a checkpoint has the bits of the whole one: turns and the friction's reaction are history.
#[test]
fn a_resumed_run_has_the_same_bits() {
    let model = || {
        let options = CoordinateOptions {
            spring: Some(CoordinateSpring { stiffness: 0.5, rest: 0.2 }),
            friction: Some(CoordinateFriction { bound: 0.1, coefficient: 0.2, radius: 0.05 }),
            ..Default::default()
        };
        wheel(0.5, 9.0, 0.0, options)
    };
    let mut whole = run(model(), 0.02, 2.0);
    let mut checkpoint = None;
    while !whole.finished() {
        whole.advance().unwrap();
        if whole.step() == 60 {
            checkpoint = Some(whole.checkpoint("run", Default::default()));
        }
    }
    let mut resumed = run(model(), 0.02, 2.0);
    resumed.restore(checkpoint.unwrap(), "run").unwrap();
    finish(&mut resumed);
    let bits = |s: &Simulation| s.state().q.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&whole), bits(&resumed));
    assert_eq!(whole.pressures(), resumed.pressures());
    assert_eq!(whole.balance().dissipation.to_bits(), resumed.balance().dissipation.to_bits());
}
