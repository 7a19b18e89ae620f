//! Mechanisms.

use super::build::{ABOUT_Z, AXES, add_body, add_joint, dynamic_cutting, place};
use super::noted;
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::larger;
use crate::workspace::Outcome;
use std::f64::consts::PI;
use std::sync::Arc;
use stoss_multibody::{CoordinateOptions, DriveFunction, JointFrame, JointKind, RigidMass};
use stoss_solver::Model;

fn rod(mass: f64, centre: [f64; 3], inertia: f64) -> Outcome<RigidMass> {
    // About z: the sum of the first two values.
    Ok(RigidMass::new(mass, centre, [0.5 * inertia, 0.5 * inertia, 0.2 * inertia], AXES)?)
}

/// Two equal cranks and a coupler as long as the ground: where all are in line the mechanism may go on as a parallelogram or crossed.
pub fn measure(findings: &mut Findings) -> Outcome<()> {
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
        let main = [&JointFrame::ground([0.0; 3], ABOUT_Z), &first.frame([0.0; 3], ABOUT_Z)];
        add_joint(&mut model, "main", JointKind::Hinge, main, drive)?;
        let sides = [&first.frame(up(0.0), AXES), &coupler.frame(up(0.0), AXES)];
        add_joint(&mut model, "left", JointKind::Ball, sides, none())?;
        let pins = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
        let sides = [&second.frame(up(l), pins), &coupler.frame(up(l), pins)];
        add_joint(&mut model, "right", JointKind::Universal, sides, none())?;
        let bearing = [&JointFrame::ground([l, 0.0, 0.0], ABOUT_Z), &second.frame([l, 0.0, 0.0], ABOUT_Z)];
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
