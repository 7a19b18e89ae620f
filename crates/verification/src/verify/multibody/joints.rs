//! Mechanisms, bearings, redundant joints.

use super::build::{
    ABOUT_Z, AXES, add_body, add_constraint, add_gravity, add_joint, dynamic, dynamic_cutting, follow, order, place,
};
use super::{ENERGY, MOMENTUM, ORDER, check, noted};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::{apart, larger, norm};
use crate::workspace::Outcome;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use stoss_multibody::{
    CoordinateFriction, CoordinateOptions, DriveFunction, Equations, Frame, Joint, JointKind, RigidBody, RigidMass,
    Weights, analyse,
};
use stoss_reference_cases::multibody::mechanisms::{braked, slider};
use stoss_solver::{Model, Simulation};

/// Measures all cases of joints but those of redundancy.
pub fn measure(_quick: bool, findings: &mut Findings) -> Outcome<()> {
    slider_crank(findings)?;
    parallelogram(findings)?;
    bearing(findings)?;
    viscous(findings)?;
    motor(findings)?;
    limits(findings)
}

fn rod(mass: f64, centre: [f64; 3], inertia: f64) -> Outcome<RigidMass> {
    // About z: the sum of the first two values.
    Ok(RigidMass::new(mass, centre, [0.5 * inertia, 0.5 * inertia, 0.2 * inertia], AXES)?)
}

/// A drive from rest: `w t^2 / (2 T)` up to `T`, then `w (t - T/2)`.
fn ramp(spin: f64, rise: f64) -> impl Fn(f64) -> f64 + Send + Sync + Copy {
    move |t: f64| if t < rise { 0.5 * spin * t * t / rise } else { spin * (t - 0.5 * rise) }
}

/// Driven by a motor: the slider is where the closed form says after each step.
fn slider_crank(findings: &mut Findings) -> Outcome<()> {
    let case = "slider-crank";
    let (r, l) = (0.3, 1.0);
    let mut model = Model::default();
    let crank = add_body(&mut model, "crank", rod(1.0, [0.15, 0.0, 0.0], 0.02)?, [0.0; 3], [0.0; 3]);
    let conrod = add_body(&mut model, "rod", rod(0.6, [0.8, 0.0, 0.0], 0.06)?, [0.0; 3], [0.0; 3]);
    let block = add_body(&mut model, "slider", rod(0.5, [1.3, 0.0, 0.0], 0.01)?, [0.0; 3], [0.0; 3]);
    let drive = ramp(8.0, 0.5);
    let motor = CoordinateOptions { motor: Some(Arc::new(DriveFunction(drive))), ..Default::default() };
    let main = [&Frame::ground([0.0; 3], ABOUT_Z), &crank.frame([0.0; 3], ABOUT_Z)];
    add_joint(&mut model, "main", JointKind::Hinge, main, motor)?;
    let (big, small) = ([r, 0.0, 0.0], [r + l, 0.0, 0.0]);
    let none = CoordinateOptions::default;
    // A plane loop of hinges has redundant equations: the pins are a ball and a cardan joint.
    add_joint(&mut model, "big end", JointKind::Ball, [&crank.frame(big, AXES), &conrod.frame(big, AXES)], none())?;
    let pins = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    let sides = [&block.frame(small, pins), &conrod.frame(small, pins)];
    add_joint(&mut model, "small end", JointKind::Universal, sides, none())?;
    let guide = [&Frame::ground(small, AXES), &block.frame(small, AXES)];
    add_joint(&mut model, "guide", JointKind::Slider, guide, none())?;
    let mut simulation = dynamic(model, 0.005, 2.0)?;
    let mut worst = 0.0;
    let kept = follow(&mut simulation, |s, record| {
        let at = place(&s.state().q, block.first())[0];
        worst = larger(worst, (at - slider(r, l, drive(record.time))).abs());
    })?;
    let note = format!("{} steps, {} iterations at most", kept.steps, kept.iterations[0]);
    noted(findings, case, "distance of the slider from the closed form", worst / l, Bound::AtMost(1e-9), note);
    // The motor's work is in the balance.
    noted(
        findings,
        case,
        "energy less work of the motor",
        kept.energy,
        Bound::AtMost(1e-9),
        "J; kinetic energy up to some J",
    );
    Ok(())
}

/// Two equal cranks and a coupler as long as the ground: where all are in line the mechanism may go on as a parallelogram or crossed.
fn parallelogram(findings: &mut Findings) -> Outcome<()> {
    let case = "parallelogram";
    let (r, l) = (0.3_f64, 1.0);
    // From a right angle through the line at pi; steps that hit it and steps that do not.
    let cases = [
        ("a step ends in line", 0.01, 0),
        ("a step ends in line, may be cut", 0.01, 6),
        ("no step ends in line", 0.0113, 0),
    ];
    for (name, step, cuts) in cases {
        let mut model = Model::default();
        let up = |x: f64| [x, r, 0.0];
        let first = add_body(&mut model, "first", rod(1.0, [0.0, 0.5 * r, 0.0], 0.02)?, [0.0; 3], [0.0; 3]);
        let coupler = add_body(&mut model, "coupler", rod(0.6, [0.5 * l, r, 0.0], 0.06)?, [0.0; 3], [0.0; 3]);
        let second = add_body(&mut model, "second", rod(1.0, [l, 0.5 * r, 0.0], 0.02)?, [0.0; 3], [0.0; 3]);
        let motor = move |t: f64| if t < 0.5 { 0.5 * PI * t * t } else { 0.5 * PI * (t - 0.25) };
        let drive = CoordinateOptions { motor: Some(Arc::new(DriveFunction(motor))), ..Default::default() };
        let none = CoordinateOptions::default;
        let main = [&Frame::ground([0.0; 3], ABOUT_Z), &first.frame([0.0; 3], ABOUT_Z)];
        add_joint(&mut model, "main", JointKind::Hinge, main, drive)?;
        let sides = [&first.frame(up(0.0), AXES), &coupler.frame(up(0.0), AXES)];
        add_joint(&mut model, "left", JointKind::Ball, sides, none())?;
        let pins = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
        let sides = [&second.frame(up(l), pins), &coupler.frame(up(l), pins)];
        add_joint(&mut model, "right", JointKind::Universal, sides, none())?;
        let bearing = [&Frame::ground([l, 0.0, 0.0], ABOUT_Z), &second.frame([l, 0.0, 0.0], ABOUT_Z)];
        add_joint(&mut model, "bearing", JointKind::Hinge, bearing, none())?;
        let mut simulation = dynamic_cutting(model, step, 2.4, cuts)?;
        let (mut violation, mut last, mut most) = (0.0, 0.0, 0);
        let stop = loop {
            if simulation.finished() {
                break None;
            }
            match simulation.advance() {
                Ok(record) => {
                    last = record.time;
                    most = most.max(record.iterations);
                    let q = &simulation.state().q;
                    // As a parallelogram both cranks have the same direction: the coupler keeps its own.
                    let turned = place(q, coupler.first() + 1);
                    let length = coupler.director_length();
                    violation = larger(violation, (turned[1] / length).abs());
                }
                Err(error) => break Some(error.to_string()),
            }
        };
        let line = 1.25;
        let note = match stop {
            Some(why) => format!("{name} (at t = {line}): stops at {last:.3}: {why}"),
            None if violation < 1e-6 => {
                format!("{name} (at t = {line}): goes on as a parallelogram, {most} iterations at most")
            }
            None => format!("{name} (at t = {line}): the coupler turns by {violation:.2e}, {most} iterations at most"),
        };
        noted(findings, case, "last time reached of 2.4 through the singular position", last, Bound::Unbounded, note);
    }
    Ok(())
}

/// A wheel of inertia `j` on an axle, and the axle's place.
fn wheel(j: f64, spin: f64, options: CoordinateOptions) -> Outcome<(Model, usize)> {
    let mut model = Model::default();
    let body = add_body(&mut model, "wheel", rod(1.0, [0.0; 3], j)?, [0.0; 3], [0.0, 0.0, spin]);
    let sides = [&Frame::ground([0.0; 3], ABOUT_Z), &body.frame([0.0; 3], ABOUT_Z)];
    let at = add_joint(&mut model, "axle", JointKind::Hinge, sides, options)?;
    Ok((model, at))
}

fn angle(simulation: &Simulation) -> f64 {
    let q = &simulation.state().q;
    q[4].atan2(q[3])
}

/// Turn between two angles, below half a turn.
fn turn(from: f64, to: f64) -> f64 {
    (to - from + PI).rem_euclid(TAU) - PI
}

/// Coulomb friction stops a bearing at `J w / T`; what it took is the energy.
fn bearing(findings: &mut Findings) -> Outcome<()> {
    let case = "bearing with friction";
    let (j, w, bound, dt) = (0.5, 6.0, 1.5, 0.0123);
    let (time, way) = braked(j, w, bound);
    let friction = Some(CoordinateFriction { bound, ..Default::default() });
    let (model, _) = wheel(j, w, CoordinateOptions { friction, ..Default::default() })?;
    let mut simulation = dynamic(model, dt, 3.0)?;
    let energy = simulation.balance().kinetic;
    let (mut stopped, mut before, mut turned, mut crept) = (f64::NAN, 0.0, 0.0, 0.0);
    let kept = follow(&mut simulation, |s, record| {
        let change = turn(before, angle(s));
        (before, turned) = (angle(s), turned + change);
        if stopped.is_nan() && change.abs() < 1e-9 {
            stopped = record.time;
        }
        if !stopped.is_nan() {
            crept = larger(crept, change.abs());
        }
    })?;
    noted(
        findings,
        case,
        "time of the stop less J w / T",
        stopped - time,
        Bound::Near { value: 0.0, tolerance: 2.0 * dt },
        format!("stops at {stopped:.4}, steps of {dt}; seen a step late"),
    );
    noted(
        findings,
        case,
        "angle until it stops, relative error",
        (turned / way - 1.0).abs(),
        Bound::AtMost((w * dt).powi(2)),
        "order two in w dt",
    );
    check(findings, case, "largest turn of a step after the stop", crept, Bound::AtMost(1e-9));
    check(findings, case, "energy and dissipation", kept.energy / energy, Bound::AtMost(ENERGY));
    // The step of the stop leaves at most the spin that half of its torque would take.
    let left = 0.5 * (0.5 * bound * dt).powi(2) / j;
    check(
        findings,
        case,
        "kinetic energy that is left over what the step of the stop may leave",
        simulation.balance().kinetic / left,
        Bound::AtMost(1.0),
    );
    Ok(())
}

/// `J w' = -d w`.
fn viscous(findings: &mut Findings) -> Outcome<()> {
    let case = "viscous bearing";
    let (j, w, d, end) = (0.5, 3.0, 0.4, 2.0_f64);
    let error = |dt: f64| -> Outcome<(f64, f64)> {
        let (model, _) = wheel(j, w, CoordinateOptions { viscous: d, ..Default::default() })?;
        let mut simulation = dynamic(model, dt, end)?;
        let energy = simulation.balance().kinetic;
        let kept = follow(&mut simulation, |_, _| {})?;
        let spin = simulation.balance().angular_momentum[2] / j;
        Ok(((spin - w * (-d * end / j).exp()).abs() / w, kept.energy / energy))
    };
    let ((a, _), (b, energy)) = (error(0.02)?, error(0.01)?);
    noted(
        findings,
        case,
        "order of the spin",
        order([a, b]),
        Bound::AtLeast(ORDER),
        format!("errors {a:.2e}, {b:.2e} of w exp(-d t / J)"),
    );
    check(findings, case, "energy and dissipation", energy, Bound::AtMost(ENERGY));
    Ok(())
}

/// A motor's work is the change of the energy.
fn motor(findings: &mut Findings) -> Outcome<()> {
    let case = "motor";
    let (j, spin, rise, dt) = (0.5, 7.0, 0.5, 0.01);
    let drive = CoordinateOptions { motor: Some(Arc::new(DriveFunction(ramp(spin, rise)))), ..Default::default() };
    let (model, _) = wheel(j, 0.0, drive)?;
    let mut simulation = dynamic(model, dt, 2.0)?;
    let kept = follow(&mut simulation, |_, _| {})?;
    let last = *simulation.balance();
    let energy = 0.5 * j * spin * spin;
    check(findings, case, "work less change of the energy", kept.energy / energy, Bound::AtMost(ENERGY));
    // The midpoint rule turns by 2 atan(w dt / 2): its spin differs by (w dt)^2 / 12.
    noted(
        findings,
        case,
        "work over J w^2 / 2",
        last.external_work / energy,
        Bound::Near { value: 1.0, tolerance: (spin * dt).powi(2) },
        "order two in w dt",
    );
    Ok(())
}

/// A wheel runs against a limit: it does not pass, and nothing is gained.
fn limits(findings: &mut Findings) -> Outcome<()> {
    let case = "limits";
    let (model, _) = wheel(0.5, 2.0, CoordinateOptions { limits: Some([-1.0, 0.7]), ..Default::default() })?;
    let mut simulation = dynamic(model, 0.013, 3.0)?;
    let energy = simulation.balance().kinetic;
    let (mut beyond, mut kinetic, mut before) = (f64::NEG_INFINITY, energy, energy);
    let mut gained = 0.0;
    let kept = follow(&mut simulation, |s, record| {
        beyond = larger(beyond, larger(angle(s) - 0.7, -1.0 - angle(s)));
        kinetic = record.balance.kinetic;
        gained = larger(gained, kinetic - before);
        before = kinetic;
    })?;
    check(findings, case, "angle beyond the limits", beyond, Bound::AtMost(1e-9));
    check(findings, case, "largest gain of kinetic energy in a step", gained / energy, Bound::AtMost(ENERGY));
    check(findings, case, "energy and dissipation", kept.energy / energy, Bound::AtMost(ENERGY));
    check(findings, case, "kinetic energy at the end over that at the start", kinetic / energy, Bound::Unbounded);
    Ok(())
}

const WEIGHTS: Weights = Weights { mass: 1.0, stiffness: 0.0 };

/// Adds the joints, compliant where equations follow from others; returns the place of the first, equations and rank.
fn add_redundant(model: &mut Model, bodies: &[&RigidBody], joints: &[Joint]) -> Outcome<(usize, [usize; 2])> {
    let rigidity: Vec<_> = bodies.iter().map(|body| body.constraints()).collect();
    let sets: Vec<&dyn Equations> =
        rigidity.iter().map(|r| r as &dyn Equations).chain(joints.iter().map(|j| j as &dyn Equations)).collect();
    let found = analyse(&sets, &model.reference, |_| true)?;
    let first = model.contacts.len();
    for (k, joint) in joints.iter().enumerate() {
        let mut joint = joint.clone();
        if found.involved.contains(&(k + bodies.len())) {
            joint.set_redundant(Some(WEIGHTS));
        }
        add_constraint(model, &format!("joint {k}"), joint);
    }
    Ok((first, [found.equations, found.rank]))
}

fn hinges(model: &Model, body: &RigidBody, axis: [[f64; 3]; 3], count: usize) -> Outcome<Vec<Joint>> {
    let one = |k: usize| -> Outcome<Joint> {
        let at: [f64; 3] = std::array::from_fn(|i| k as f64 * 0.7 * axis[0][i]);
        let (a, b) = (Frame::ground(at, axis), body.frame(at, axis));
        Ok(Joint::new(&format!("hinge {k}"), JointKind::Hinge, &a, &b, 0.5, &model.reference)?)
    };
    (0..count).map(one).collect()
}

/// Redundant joints: the motion is that with as many as are needed, resultants are exact.
pub fn redundancy(quick: bool, findings: &mut Findings) -> Outcome<()> {
    door(quick, findings)?;
    loop_of_hinges(quick, findings)?;
    welds(findings)
}

/// A door on three hinges along one axis moves as on one. Forces on the door have the resultant of the one hinge.
fn door(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let case = "door on three hinges";
    let axis = stoss_multibody::axes_along([0.3, -0.5, 1.0]).ok_or("no axes")?;
    let make = |count: usize| -> Outcome<(Simulation, Vec<Joint>, usize, [usize; 2])> {
        let mut model = Model::default();
        let mass = RigidMass::new(2.0, [0.4, 0.1, 1.0], [0.1, 0.03, 0.3], AXES)?;
        let body = add_body(&mut model, "door", mass, [0.0; 3], [0.0; 3]);
        let joints = hinges(&model, &body, axis, count)?;
        add_gravity(&mut model, [0.0, 0.0, -9.81]);
        let (first, ranks) = add_redundant(&mut model, &[&body], &joints)?;
        Ok((dynamic(model, 0.01, if quick { 1.0 } else { 4.0 })?, joints, first, ranks))
    };
    let (mut three, joints, first, [equations, rank]) = make(3)?;
    let (mut one, single, place_of_one, _) = make(1)?;
    check(
        findings,
        case,
        "redundant equations",
        (equations - rank) as f64,
        Bound::Near { value: 10.0, tolerance: 0.0 },
    );
    let (mut motion, mut resultant, mut start) = (0.0, 0.0, one.state().q.clone());
    let energy = three.balance().total();
    while !three.finished() {
        three.advance()?;
        one.advance()?;
        let (q3, q1) = (three.state().q.clone(), one.state().q.clone());
        motion = q3.iter().zip(&q1).map(|(a, b)| (a - b).abs()).fold(motion, larger);
        let rule = stoss_term::GradientRule::DiscreteGradient;
        let force =
            |s: &Simulation, joint: &Joint, c: usize| joint.force(&start, &s.state().q, rule, &s.pressures()[c]).0;
        let sum = joints.iter().enumerate().map(|(k, joint)| force(&three, joint, first + k));
        let sum = sum.fold([0.0; 3], |sum: [f64; 3], f| std::array::from_fn(|i| sum[i] + f[i]));
        resultant = larger(resultant, apart(sum, force(&one, &single[0], place_of_one)));
        start = q1;
    }
    check(findings, case, "motion less that on one hinge", motion, Bound::AtMost(1e-9));
    check(
        findings,
        case,
        "resultant less that of one hinge, over the weight",
        resultant / (2.0 * 9.81),
        Bound::AtMost(1e-7),
    );
    check(
        findings,
        case,
        "drift of the energy",
        (three.balance().total() - energy).abs() / (2.0 * 9.81),
        Bound::AtMost(ENERGY),
    );
    Ok(())
}

/// A plane loop of four links on parallel hinges, free in space: three redundant equations.
fn loop_of_hinges(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let case = "four links on parallel hinges";
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.2, 0.8, 0.0], [0.1, 0.9, 0.0]];
    let mut model = Model::default();
    let mut bodies = Vec::new();
    for k in 0..4 {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        let centre: [f64; 3] = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
        bodies.push(add_body(
            &mut model,
            &format!("link {k}"),
            rod(1.0, centre, 0.1)?,
            [0.3, 0.2, 1.0],
            [0.3, 0.2, 1.0],
        ));
    }
    let joints: Vec<Joint> = (0..4)
        .map(|k| {
            let (at, next) = (corners[(k + 1) % 4], &bodies[(k + 1) % 4]);
            let (a, b) = (bodies[k].frame(at, ABOUT_Z), next.frame(at, ABOUT_Z));
            Ok(Joint::new(&format!("pin {k}"), JointKind::Hinge, &a, &b, 0.5, &model.reference)?)
        })
        .collect::<Outcome<_>>()?;
    let all: Vec<&RigidBody> = bodies.iter().collect();
    let (_, [equations, rank]) = add_redundant(&mut model, &all, &joints)?;
    check(findings, case, "redundant equations", (equations - rank) as f64, Bound::Near { value: 3.0, tolerance: 0.0 });
    let mut simulation = dynamic(model, 0.01, if quick { 2.0 } else { 10.0 })?;
    let first = *simulation.balance();
    let kept = follow(&mut simulation, |_, _| {})?;
    let [linear, angular] = [kept.linear, kept.angular].map(|k| k.iter().copied().fold(0.0, larger));
    check(findings, case, "drift of linear momentum", linear / norm(first.linear_momentum), Bound::AtMost(MOMENTUM));
    check(findings, case, "drift of angular momentum", angular / norm(first.angular_momentum), Bound::AtMost(MOMENTUM));
    check(findings, case, "drift of the energy", kept.energy / first.kinetic, Bound::AtMost(ENERGY));
    Ok(())
}

/// A weight on 18 welds, 102 redundant equations, at rest: multipliers of least norm are equal shares, `m g / 18`, where all welds are in one place.
fn welds(findings: &mut Findings) -> Outcome<()> {
    let case = "18 welds in one place";
    let count = 18;
    let mut model = Model::default();
    let body = add_body(&mut model, "weight", rod(2.0, [0.0; 3], 0.3)?, [0.0; 3], [0.0; 3]);
    add_gravity(&mut model, [0.0, 0.0, -9.81]);
    let make = |k: usize| -> Outcome<Joint> {
        let (a, b) = (Frame::ground([0.0; 3], AXES), body.frame([0.0; 3], AXES));
        Ok(Joint::new(&format!("weld {k}"), JointKind::Weld, &a, &b, 0.5, &model.reference)?)
    };
    let joints: Vec<Joint> = (0..count).map(make).collect::<Outcome<_>>()?;
    let (first, [equations, rank]) = add_redundant(&mut model, &[&body], &joints)?;
    check(
        findings,
        case,
        "redundant equations",
        (equations - rank) as f64,
        Bound::Near { value: 102.0, tolerance: 0.0 },
    );
    let mut simulation = dynamic(model, 0.01, 0.2)?;
    follow(&mut simulation, |_, _| {})?;
    let shares: Vec<f64> = (0..count).map(|k| simulation.pressures()[first + k][2]).collect();
    let weight = 2.0 * 9.81;
    let sum: f64 = shares.iter().sum();
    let spread = shares.iter().map(|s| (s.abs() * count as f64 / weight - 1.0).abs()).fold(0.0, larger);
    check(findings, case, "resultant over the weight, less one", (sum.abs() / weight - 1.0).abs(), Bound::AtMost(1e-9));
    check(findings, case, "shares less m g / 18, relative (least norm)", spread, Bound::AtMost(1e-6));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_and_ramps() {
        assert!((turn(3.0, -3.0) - (TAU - 6.0)).abs() < 1e-14);
        let drive = ramp(4.0, 2.0);
        assert_eq!((drive(0.0), drive(2.0), drive(3.0)), (0.0, 4.0, 8.0));
    }
}
