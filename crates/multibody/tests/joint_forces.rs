//! Forces and tangents of joints against differences, resultants, moments and work, at random states.

use proptest::prelude::*;
use stoss_multibody::{
    CoordinateFriction, CoordinateOptions, CoordinateSpring, DriveFunction, JOINTS, Joint, JointFrame, JointKind,
    Pretension, RigidBody, RigidMass,
};
use stoss_term::{At, Bilateral, GradientRule, Local, StepConfiguration, StepContext, Term};

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const POINT: [f64; 3] = [0.4, -0.3, 0.2];
const LENGTH: f64 = 0.8;

fn bodies() -> [RigidBody; 2] {
    let mass = |centre, euler| RigidMass::new(2.0, centre, euler, AXES).unwrap();
    [
        RigidBody::new("a", 0, mass([0.1, 0.2, -0.3], [0.4, 0.3, 0.2])),
        RigidBody::new("b", 4, mass([1.0, -0.5, 0.6], [0.1, 0.5, 0.7])),
    ]
}

fn reference() -> Vec<f64> {
    bodies().iter().flat_map(|body| body.reference()).flatten().collect()
}

/// Axes that are none of the coordinate directions.
fn axes() -> [[f64; 3]; 3] {
    stoss_multibody::axes_along([0.3, -0.5, 0.8]).unwrap()
}

fn joint(kind: JointKind, ground: bool) -> Joint {
    let [a, b] = bodies();
    let side_a = if ground { JointFrame::ground(POINT, axes()) } else { a.frame(POINT, axes()) };
    let q = reference();
    let side_b = match kind {
        // The pin of b has the length that is asked for.
        JointKind::Distance { length } => b.frame(std::array::from_fn(|i| POINT[i] + length * axes()[1][i]), axes()),
        _ => b.frame(POINT, axes()),
    };
    Joint::new("joint", kind, &side_a, &side_b, LENGTH, &q).unwrap()
}

fn options(which: usize) -> CoordinateOptions {
    let mut options = CoordinateOptions::default();
    match which {
        0 => options.spring = Some(CoordinateSpring { stiffness: 3.0, rest: 0.3 }),
        1 => options.viscous = 0.7,
        2 => options.friction = Some(CoordinateFriction { bound: 0.4, coefficient: 0.3, radius: 0.2 }),
        3 => options.motor = Some(std::sync::Arc::new(DriveFunction(|t: f64| 0.1 + 2.0 * t))),
        4 => options.limits = Some([-0.05, 0.06]),
        // Not locked in the first step, which begins at 0, and locked in it.
        6 | 7 => {
            let force = std::sync::Arc::new(DriveFunction(|t: f64| 0.8 + 3.0 * t));
            options.pretension = Some(Pretension { force, lock: if which == 6 { 1.0 } else { 0.0 } });
        }
        _ => {
            options = CoordinateOptions { viscous: 0.4, ..self::options(0) };
            options.friction = self::options(2).friction;
            options.limits = Some([-0.1, 0.2]);
        }
    }
    options
}

fn begin(joint: &mut Joint, q_n: &[f64], rule: GradientRule) {
    joint.begin(&StepContext::new(q_n, rule, 0.05)).unwrap();
}

fn assemble(joint: &Joint, q: [&[f64]; 2], rule: GradientRule, multipliers: &[f64], tangent: bool) -> Local {
    let active = vec![true; joint.slot_count()];
    let mut made = Local::default();
    let step = StepConfiguration { q_n: q[0], q_np1: q[1], rule };
    joint.assemble(&step.at(multipliers, &active), tangent, &mut |local| made = local.clone()).unwrap();
    made
}

/// Each torque along the coordinate is what its law says, and is a part of the moment about the axis.
#[test]
fn torques_of_the_coordinate_are_those_of_their_laws_and_parts_of_the_moment() {
    let options = CoordinateOptions {
        motor: options(3).motor,
        spring: Some(CoordinateSpring { stiffness: 3.0, rest: 0.3 }),
        viscous: 0.7,
        friction: Some(CoordinateFriction { bound: 0.4, ..CoordinateFriction::default() }),
        limits: Some([-0.05, 0.06]),
        ..CoordinateOptions::default()
    };
    let mut joint = joint(JointKind::Hinge, true).with_options(options).unwrap();
    let (q_n, angle, axis) = (reference(), 0.05, axes()[0]);
    // b turns about the axis through the point of the joint.
    let turn = |r: [f64; 3]| {
        let along = (0..3).map(|i| r[i] * axis[i]).sum::<f64>();
        let (c, s) = (f64::cos(angle), f64::sin(angle));
        let cross = |i: usize| axis[(i + 1) % 3] * r[(i + 2) % 3] - axis[(i + 2) % 3] * r[(i + 1) % 3];
        std::array::from_fn::<f64, 3, _>(|i| c * r[i] + s * cross(i) + (1.0 - c) * along * axis[i])
    };
    let mut q_np1 = q_n.clone();
    for vector in 4..8 {
        let origin = if vector == 4 { POINT } else { [0.0; 3] };
        let turned = turn(std::array::from_fn(|i| q_n[3 * vector + i] - origin[i]));
        (0..3).for_each(|i| q_np1[3 * vector + i] = origin[i] + turned[i]);
    }
    begin(&mut joint, &q_n, GradientRule::DiscreteGradient);
    let (mut multipliers, active) = (vec![0.0; joint.slot_count()], vec![true; joint.slot_count()]);
    let first = joint.kind().equations();
    multipliers[first..].copy_from_slice(&[0.2, -1.5, 0.9]);
    joint.commit(&At::end(&q_np1, &multipliers, &active));
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a}, not {b}");
    let check = |joint: &Joint| {
        let report = joint.joint(&q_np1, &multipliers).unwrap();
        let t = report.coordinates[0].torques;
        close(report.coordinates[0].value, angle);
        close(t.friction, -0.2 * LENGTH);
        close(t.viscous, -0.7 * angle / 0.05);
        close(t.spring, -3.0 * (angle - 0.3));
        close(t.motor, -1.5 * LENGTH);
        close(t.limit, -0.9 * LENGTH);
        let about_axis = (0..3).map(|i| report.moment[i] * axis[i]).sum::<f64>();
        close(about_axis, t.friction + t.viscous + t.spring + t.motor + t.limit);
    };
    check(&joint);
    // What the last step was is in the history.
    let mut other = joint.clone();
    begin(&mut other, &q_np1, GradientRule::DiscreteGradient);
    other.load_history(&joint.save_history()).unwrap();
    check(&other);
}

/// Multipliers of friction or of a limit that drive the motion give energy, and the work says so; what is within the tolerance of a stick gives none.
#[test]
fn friction_and_limits_that_give_energy_are_seen() {
    for (which, multiplier) in [(2, -0.3), (4, -0.3)] {
        let mut joint = joint(JointKind::Slider, true).with_options(options(which)).unwrap();
        let q_n = reference();
        begin(&mut joint, &q_n, GradientRule::DiscreteGradient);
        let active = vec![true; joint.slot_count()];
        let mut multipliers = vec![0.0; joint.slot_count()];
        multipliers[joint.kind().equations()] = multiplier;
        let after = |by: f64| {
            let mut q = q_n.clone();
            (0..3).for_each(|i| q[12 + i] += by * axes()[0][i]);
            q
        };
        let of = |by: f64| {
            let work = joint.work(&At::end(&after(by), &multipliers, &active)).unwrap();
            work.dissipated + work.closing.unwrap()
        };
        let change = joint.coordinate(0, &after(0.02)).unwrap();
        assert!((change - 0.02).abs() < 1e-12);
        for by in [0.02_f64, -0.02] {
            let expected = multiplier * change * by.signum();
            assert!((of(by) - expected).abs() < 1e-12, "{which}: {}, not {expected}", of(by));
        }
        assert!(of(1e-11) >= 0.0 && of(-1e-11) >= 0.0);
    }
}

/// Largest difference of the tangent to central differences, relative to its largest entry.
fn tangent_error(joint: &Joint, q_n: &[f64], q_np1: &[f64], rule: GradientRule, multipliers: &[f64]) -> f64 {
    let h = 1e-6;
    let made = assemble(joint, [q_n, q_np1], rule, multipliers, true);
    let (dim, n) = (made.dim(), 3 * made.nodes.len());
    let largest = made.tangent.iter().fold(1.0, |m: f64, t| m.max(t.abs()));
    let mut worst = 0.0_f64;
    for j in 0..dim {
        let side = |by: f64| {
            let (mut q, mut m) = (q_np1.to_vec(), multipliers.to_vec());
            if j < n {
                q[3 * made.nodes[j / 3] as usize + j % 3] += by;
            } else {
                m[made.slots[j - n] as usize] += by;
            }
            assemble(joint, [q_n, &q], rule, &m, false).residual
        };
        let (ahead, behind) = (side(h), side(-h));
        for i in 0..dim {
            worst = worst.max(((ahead[i] - behind[i]) / (2.0 * h) - made.tangent[i * dim + j]).abs());
        }
    }
    worst / largest
}

fn state() -> impl Strategy<Value = [Vec<f64>; 2]> {
    let part = || proptest::collection::vec(-1.0..1.0_f64, 24);
    (part(), part()).prop_map(|(a, b)| {
        let start: Vec<f64> = reference().iter().zip(&a).map(|(q, u)| q + 0.3 * u).collect();
        let end = start.iter().zip(&b).map(|(q, u)| q + 0.2 * u).collect();
        [start, end]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Tangents of all kinds under all rules.
    #[test]
    fn tangents_of_the_kinds([q_n, q_np1] in state(), m in proptest::collection::vec(-2.0..2.0_f64, 6), ground in any::<bool>()) {
        for kind in JOINTS.iter().map(|entry| entry.kind(0.7)) {
            for rule in GradientRule::ALL {
                let mut joint = joint(kind, ground);
                begin(&mut joint, &q_n, rule);
                let error = tangent_error(&joint, &q_n, &q_np1, rule, &m[..joint.slot_count()]);
                prop_assert!(error < 1e-8, "{kind:?} {rule:?} {error:e}");
            }
        }
    }

    /// Tangents of everything on a coordinate, at random multipliers: friction sticks and slides, limits are open and closed.
    #[test]
    fn tangents_of_the_options([q_n, q_np1] in state(), m in proptest::collection::vec(-1.0..1.0_f64, 10)) {
        for kind in [JointKind::Hinge, JointKind::Cylindrical, JointKind::Slider] {
            for which in 0..8 {
                for rule in GradientRule::ALL {
                    let mut joint = joint(kind, false).with_options(options(which)).unwrap();
                    begin(&mut joint, &q_n, rule);
                    let error = tangent_error(&joint, &q_n, &q_np1, rule, &m[..joint.slot_count()]);
                    prop_assert!(error < 1e-6, "{kind:?} option {which} {rule:?} {error:e}");
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Tangents with everything on two coordinates.
    #[test]
    fn tangents_of_two_coordinates([q_n, q_np1] in state(), m in proptest::collection::vec(-1.0..1.0_f64, 8)) {
        for kind in [JointKind::Cylindrical, JointKind::Universal] {
            for which in 0..6 {
                for rule in GradientRule::ALL {
                    let joint = joint(kind, false).with_options_of(1, options(which)).unwrap();
                    let mut joint = joint.with_options(options(5 - which)).unwrap();
                    begin(&mut joint, &q_n, rule);
                    let error = tangent_error(&joint, &q_n, &q_np1, rule, &m[..joint.slot_count()]);
                    prop_assert!(error < 1e-6, "{kind:?} option {which} {rule:?} {error:e}");
                }
            }
        }
    }

    /// As [`no_resultant_no_moment_and_exact_work`] with options on both coordinates, and the reported work is the same.
    #[test]
    fn work_of_two_coordinates_is_exact(
        about in proptest::array::uniform3(0.1..1.0_f64),
        turns in (-1.0..1.0_f64, -1.0..1.0_f64),
        own in (proptest::array::uniform2(-1.2..1.2_f64), proptest::array::uniform2(-1.2..1.2_f64)),
        shift in proptest::array::uniform3(-1.0..1.0_f64),
        m in proptest::collection::vec(0.0..2.0_f64, 8),
    ) {
        for kind in [JointKind::Cylindrical, JointKind::Universal] {
            let joint = joint(kind, false).with_options(options(5)).unwrap();
            let mut joint = joint.with_options_of(1, options(5)).unwrap();
            let q_n = moved(kind, about, turns.0, [0.0; 3], own.0);
            let q_np1 = moved(kind, about, turns.1, shift, own.1);
            let rule = GradientRule::DiscreteGradient;
            begin(&mut joint, &q_n, rule);
            prop_assert_eq!(joint.slot_count(), 8);
            let local = assemble(&joint, [&q_n, &q_np1], rule, &m, false);
            let (mut sum, mut moment, mut work) = ([0.0; 3], [0.0; 3], 0.0);
            for (k, &node) in local.nodes.iter().enumerate() {
                let at = 3 * node as usize;
                let f: [f64; 3] = std::array::from_fn(|i| local.residual[3 * k + i]);
                let turn = cross(std::array::from_fn(|i| 0.5 * (q_n[at + i] + q_np1[at + i])), f);
                for i in 0..3 {
                    sum[i] += if node % 4 == 0 { f[i] } else { 0.0 };
                    moment[i] += turn[i];
                    work += f[i] * (q_np1[at + i] - q_n[at + i]);
                }
            }
            for i in 0..3 {
                prop_assert!(sum[i].abs() < 1e-12 && moment[i].abs() < 1e-12, "{kind:?} {sum:?} {moment:?}");
            }
            let spring = |g: f64| 1.5 * (g - 0.3).powi(2);
            let mut expected = 0.0;
            for k in 0..2 {
                prop_assert!((joint.coordinate(k, &q_n).unwrap() - own.0[k]).abs() < 1e-13);
                prop_assert!((joint.coordinate(k, &q_np1).unwrap() - own.1[k]).abs() < 1e-13);
                let change = own.1[k] - own.0[k];
                let multipliers = m[4 + 2 * k] + m[5 + 2 * k];
                expected += spring(own.1[k]) - spring(own.0[k]);
                expected += (0.4 * change / 0.05 + joint.scale(k) * multipliers) * change;
            }
            prop_assert!((work - expected).abs() < 1e-11, "{kind:?} {work} {expected}");
            // The same of the reported work where nothing gives energy.
            let towards: Vec<f64> = (0..8).map(|s| if s < 4 { m[s] } else { m[s] * (own.1[(s - 4) / 2] - own.0[(s - 4) / 2]).signum() }).collect();
            let reported = joint.work(&At::end(&q_np1, &towards, &[true; 8])).unwrap();
            let local = assemble(&joint, [&q_n, &q_np1], rule, &towards, false);
            let mut work = 0.0;
            for (k, &node) in local.nodes.iter().enumerate() {
                let at = 3 * node as usize;
                work += (0..3).map(|i| local.residual[3 * k + i] * (q_np1[at + i] - q_n[at + i])).sum::<f64>();
            }
            let stored = joint.energy(&q_n).unwrap();
            prop_assert!((reported.stored - stored + reported.dissipated + reported.closing.unwrap() - work).abs() < 1e-11, "{kind:?}");
        }
    }
}

/// Both bodies move rigidly; b by the two coordinates of the joint in addition: along and about the axis, or about the pin of b and then about that of a.
fn moved(kind: JointKind, about: [f64; 3], whole: f64, shift: [f64; 3], own: [f64; 2]) -> Vec<f64> {
    let size = about.iter().map(|a| a * a).sum::<f64>().sqrt();
    let about = about.map(|a| a / size);
    let [first, second, _] = axes();
    let mut out = Vec::new();
    for (k, v) in reference().chunks_exact(3).enumerate() {
        let mut v = [v[0], v[1], v[2]];
        let direction = k % 4 != 0;
        if k >= 4 {
            let arm: [f64; 3] = std::array::from_fn(|i| if direction { v[i] } else { v[i] - POINT[i] });
            let turned = match kind {
                JointKind::Universal => rotate(first, own[0], rotate(second, own[1], arm)),
                _ => {
                    let turned = rotate(first, own[0], arm);
                    std::array::from_fn(|i| turned[i] + if direction { 0.0 } else { own[1] * first[i] })
                }
            };
            v = std::array::from_fn(|i| turned[i] + if direction { 0.0 } else { POINT[i] });
        }
        let v = rotate(about, whole, v);
        out.extend((0..3).map(|i| v[i] + if direction { 0.0 } else { shift[i] }));
    }
    out
}

/// Rotation about an axis by an angle (Rodrigues).
fn rotate(axis: [f64; 3], angle: f64, v: [f64; 3]) -> [f64; 3] {
    let (s, c) = angle.sin_cos();
    let cross = cross(axis, v);
    let along: f64 = (0..3).map(|i| axis[i] * v[i]).sum();
    std::array::from_fn(|i| c * v[i] + s * cross[i] + (1.0 - c) * along * axis[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Both bodies move rigidly by a rotation and a shift; b turns about the joint in addition, and slides along its axis: admissible for hinge or slider.
fn admissible(kind: JointKind, about: [f64; 3], whole: f64, shift: [f64; 3], own: f64) -> Vec<f64> {
    let size = about.iter().map(|a| a * a).sum::<f64>().sqrt();
    let about = about.map(|a| a / size);
    let axis = axes()[0];
    let q = reference();
    let mut out = Vec::new();
    for (k, v) in q.chunks_exact(3).enumerate() {
        let mut v = [v[0], v[1], v[2]];
        let direction = k % 4 != 0;
        if k >= 4 {
            let arm: [f64; 3] = std::array::from_fn(|i| if direction { v[i] } else { v[i] - POINT[i] });
            let moved = if kind == JointKind::Slider {
                std::array::from_fn(|i| arm[i] + if direction { 0.0 } else { own * axis[i] })
            } else {
                rotate(axis, own, arm)
            };
            v = std::array::from_fn(|i| moved[i] + if direction { 0.0 } else { POINT[i] });
        }
        let v = rotate(about, whole, v);
        out.extend((0..3).map(|i| v[i] + if direction { 0.0 } else { shift[i] }));
    }
    out
}

proptest! {
    /// Under the energy-momentum rule the internal forces of a joint have neither resultant nor moment about the midpoint, and what acts on the coordinate does its
    /// work times the change of the coordinate.
    #[test]
    fn no_resultant_no_moment_and_exact_work(
        about in proptest::array::uniform3(0.1..1.0_f64),
        turns in (-1.0..1.0_f64, -1.0..1.0_f64),
        own in (-1.2..1.2_f64, -1.2..1.2_f64),
        shift in proptest::array::uniform3(-1.0..1.0_f64),
        m in proptest::collection::vec(-2.0..2.0_f64, 10),
    ) {
        for kind in [JointKind::Hinge, JointKind::Slider, JointKind::Cylindrical] {
            let mut joint = joint(kind, false).with_options(options(5)).unwrap();
            let q_n = admissible(kind, about, turns.0, [0.0; 3], own.0);
            let q_np1 = admissible(kind, about, turns.1, shift, own.1);
            let rule = GradientRule::DiscreteGradient;
            begin(&mut joint, &q_n, rule);
            let multipliers = &m[..joint.slot_count()];
            let local = assemble(&joint, [&q_n, &q_np1], rule, multipliers, false);
            let (mut sum, mut moment, mut work) = ([0.0; 3], [0.0; 3], 0.0);
            let mut on_b = ([0.0; 3], [0.0; 3]);
            for (k, &node) in local.nodes.iter().enumerate() {
                let at = 3 * node as usize;
                let f: [f64; 3] = std::array::from_fn(|i| local.residual[3 * k + i]);
                let mid: [f64; 3] = std::array::from_fn(|i| 0.5 * (q_n[at + i] + q_np1[at + i]));
                let turn = cross(mid, f);
                for i in 0..3 {
                    sum[i] += if node % 4 == 0 { f[i] } else { 0.0 };
                    moment[i] += turn[i];
                    work += f[i] * (q_np1[at + i] - q_n[at + i]);
                    if node >= 4 {
                        on_b.0[i] -= if node == 4 { f[i] } else { 0.0 };
                        on_b.1[i] -= turn[i];
                    }
                }
            }
            for i in 0..3 {
                prop_assert!(sum[i].abs() < 1e-12 && moment[i].abs() < 1e-12, "{kind:?} {sum:?} {moment:?}");
            }
            let change = own.1 - own.0;
            let (spring, scale) = (|g: f64| 1.5 * (g - 0.3).powi(2), joint.scale(0));
            let torques = 0.4 * change / 0.05 + scale * (multipliers[multipliers.len() - 2] + multipliers[multipliers.len() - 1]);
            let expected = spring(own.1) - spring(own.0) + torques * change;
            prop_assert!((work - expected).abs() < 1e-11, "{kind:?} {work} {expected}");
            prop_assert!((joint.coordinate(0, &q_np1).unwrap() - own.1).abs() < 1e-13);
            // Force and moment on side b: those of the generalised forces on body b.
            let (force, about_point) = joint.force(&q_n, &q_np1, rule, multipliers);
            let point: [f64; 3] = {
                let p = bodies()[1].point(POINT);
                let (x, y) = (p.at(&q_n), p.at(&q_np1));
                std::array::from_fn(|i| 0.5 * (x[i] + y[i]))
            };
            let lever = cross(point, force);
            for i in 0..3 {
                prop_assert!((force[i] - on_b.0[i]).abs() < 1e-12);
                prop_assert!((about_point[i] + lever[i] - on_b.1[i]).abs() < 1e-11);
            }
        }
    }
}

/// Work in the reported is the work of the forces, and losses are never negative.
#[test]
fn work_of_the_ledger() {
    let mut joint = joint(JointKind::Hinge, false).with_options(options(5)).unwrap();
    let q = |own: f64| admissible(JointKind::Hinge, [1.0, 0.0, 0.0], 0.3, [0.0; 3], own);
    begin(&mut joint, &q(0.0), GradientRule::DiscreteGradient);
    let mut multipliers = vec![0.0; joint.slot_count()];
    multipliers[5] = 0.5;
    let active = vec![true; joint.slot_count()];
    let work = joint.work(&At::end(&q(0.1), &multipliers, &active)).unwrap();
    assert!((work.stored - 1.5 * 0.04).abs() < 1e-14);
    assert!((work.dissipated - (0.4 * 0.01 / 0.05 + LENGTH * 0.5 * 0.1)).abs() < 1e-14);
    assert!((joint.energy(&q(0.0)).unwrap() - 1.5 * 0.09).abs() < 1e-14);
    joint.commit(&At::end(&q(0.1), &multipliers, &active));
    // Released: the spring's energy is lost, once.
    begin(&mut joint, &q(0.1), GradientRule::DiscreteGradient);
    let released = vec![false; joint.slot_count()];
    let work = joint.work(&At::end(&q(0.2), &multipliers, &released)).unwrap();
    assert!((work.dissipated - 1.5 * 0.04).abs() < 1e-14 && work.stored == 0.0);
    joint.commit(&At::end(&q(0.2), &multipliers, &released));
    assert_eq!(joint.work(&At::end(&q(0.2), &multipliers, &released)).unwrap().dissipated, 0.0);
}

/// An angle is followed over turns, and its history comes back bit for bit.
#[test]
fn angles_are_followed_and_restored() {
    let mut first = joint(JointKind::Hinge, false);
    let q = |own: f64| admissible(JointKind::Hinge, [1.0, 0.0, 0.0], 0.3, [0.0; 3], own);
    let active = vec![true; 5];
    let mut angle = 0.0;
    for _ in 0..40 {
        begin(&mut first, &q(angle), GradientRule::DiscreteGradient);
        angle -= 1.3;
        first.commit(&At::end(&q(angle), &[0.3; 5], &active));
        assert!((first.coordinate(0, &q(angle)).unwrap() - angle).abs() < 1e-12);
    }
    let mut second = joint(JointKind::Hinge, false);
    second.load_history(&first.save_history()).unwrap();
    assert_eq!(second.save_history(), first.save_history());
    assert_eq!(
        second.coordinate(0, &q(angle + 0.1)).unwrap().to_bits(),
        first.coordinate(0, &q(angle + 0.1)).unwrap().to_bits()
    );
    assert!(second.load_history(&[0; 7]).is_err());
}

/// Frames that do not fit are refused with the distance; slots that are not active have nothing.
#[test]
fn misplaced_frames_are_refused() {
    let [a, b] = bodies();
    let q = reference();
    let frame = a.frame(POINT, axes());
    let make = |kind, other: &JointFrame| Joint::new("door", kind, &frame, other, LENGTH, &q);
    let shifted = b.frame([POINT[0] + 1e-3, POINT[1], POINT[2]], axes());
    assert!(make(JointKind::Ball, &shifted).unwrap_err().to_string().contains("the point of side b is 1.000"));
    let turned = b.frame(POINT, axes().map(|v| rotate(axes()[1], 1e-4, v)));
    assert!(make(JointKind::Hinge, &turned).unwrap_err().to_string().contains("an axis of side b is 9.99"));
    assert!(make(JointKind::Ball, &turned).is_ok());
    assert!(make(JointKind::Weld, &b.frame(POINT, axes().map(|v| rotate(axes()[0], 1e-4, v)))).is_err());
    assert!(make(JointKind::Hinge, &b.frame(POINT, axes().map(|v| rotate(axes()[0], 1e-4, v)))).is_ok());
    assert!(make(JointKind::Hinge, &frame.clone()).unwrap_err().to_string().contains("same frame"));
    let ground = JointFrame::ground(POINT, axes());
    assert!(Joint::new("door", JointKind::Ball, &ground, &JointFrame::ground(POINT, AXES), 1.0, &q).is_err());
    let ball = joint(JointKind::Ball, true);
    assert!(ball.clone().with_options(options(0)).is_err());
    let second = joint(JointKind::Hinge, true).with_options_of(1, options(0)).unwrap_err();
    assert!(second.to_string().contains("has no coordinate 2"));
    let mut visited = 0;
    ball.stencils(&[true, false, true], &mut |_, slots| {
        assert_eq!(slots, [0, 2]);
        visited += 1;
    });
    ball.stencils(&[false; 3], &mut |_, _| visited += 1);
    let step = StepConfiguration { q_n: &q, q_np1: &q, rule: GradientRule::Midpoint };
    ball.assemble(&step.at(&[1.0; 3], &[false; 3]), true, &mut |_| visited += 1).unwrap();
    assert_eq!(visited, 1);
}
