//! Chains of bodies on ball joints: cost against length, energy.

use super::build::{AXES, add_body, add_gravity, add_joint, dynamic_cutting, follow};
use super::{ENERGY, noted};
use crate::plot::{self, Labels, Series};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::larger;
use crate::verify::report::{Grid, ReportSection};
use crate::workspace::Outcome;
use cpu_time::ProcessTime;
use stoss_multibody::{CoordinateOptions, JointFrame, JointKind, RigidMass};
use stoss_solver::Model;

const LENGTHS: [usize; 4] = [10, 25, 50, 100];

/// A chain of `n` links of a total length of 10 from one support, or between two, in a zigzag at first.
fn model(n: usize, two: bool) -> Outcome<Model> {
    let l = 10.0 / n as f64;
    let node = |k: usize| {
        let x = k as f64 * l;
        if two { [0.8 * x, 0.0, 0.6 * l * (k % 2) as f64] } else { [x, 0.0, 0.0] }
    };
    let mut model = Model::default();
    let none = CoordinateOptions::default;
    let mut previous = None;
    for k in 0..n {
        let (a, b) = (node(k), node(k + 1));
        let along: [f64; 3] = std::array::from_fn(|i| (b[i] - a[i]) / l);
        let axes = [along, [0.0, 1.0, 0.0], [-along[2], 0.0, along[0]]];
        let centre = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
        let m = 5.0 / n as f64;
        let slim = m * l * l / 12.0;
        let mass = RigidMass::new(m, centre, [slim, 0.05 * slim, 0.05 * slim], axes)?;
        let link = add_body(&mut model, &format!("link {k}"), mass, centre, [0.0; 3]);
        let other = match &previous {
            None => JointFrame::ground(a, AXES),
            Some(body) => stoss_multibody::RigidBody::frame(body, a, AXES),
        };
        add_joint(&mut model, &format!("ball {k}"), JointKind::Ball, [&other, &link.frame(a, AXES)], none())?;
        previous = Some(link);
    }
    if let Some(last) = previous.filter(|_| two) {
        let end = node(n);
        let sides = [&last.frame(end, AXES), &JointFrame::ground(end, AXES)];
        add_joint(&mut model, "end", JointKind::Ball, sides, none())?;
    }
    add_gravity(&mut model, [0.0, 0.0, -9.81]);
    Ok(model)
}

/// Measures all chains.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let (dt, steps) = (0.005, if quick { 20.0 } else { 200.0 });
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for (name, two) in [("chain that swings", false), ("chain between two supports", true)] {
        let (mut seconds, mut energy) = (Vec::new(), 0.0);
        for n in LENGTHS {
            // A chain that goes taut whips its links: steps may be cut there.
            let mut simulation = dynamic_cutting(model(n, two)?, dt, dt * steps, 8)?;
            let start = ProcessTime::now();
            let kept = follow(&mut simulation, |_, _| {})?;
            let per_step = start.elapsed().as_secs_f64() / kept.steps as f64;
            // A weight of 5 and a length of 10.
            energy = larger(energy, kept.energy / (5.0 * 9.81 * 10.0));
            let iterations = f64::from(kept.iterations[1]) / kept.steps as f64;
            seconds.push((simulation.equations() as f64, per_step));
            rows.push(vec![
                name.into(),
                n.to_string(),
                simulation.equations().to_string(),
                format!("{per_step:.2e}"),
                format!("{iterations:.1}"),
                kept.steps.to_string(),
            ]);
        }
        noted(
            findings,
            name,
            "drift of the energy",
            energy,
            Bound::AtMost(ENERGY),
            format!("worst of {LENGTHS:?} links, {steps} steps"),
        );
        let ((n0, s0), (n1, s1)) = (seconds[0], seconds[seconds.len() - 1]);
        let exponent = (s1 / s0).ln() / (n1 / n0).ln();
        let note = format!("{s0:.1e} s an accepted step with {n0} equations, {s1:.1e} s with {n1}");
        noted(findings, name, "exponent of the cost of a step over the equations", exponent, Bound::Unbounded, note);
        lines.push(Series { name: name.into(), points: seconds });
    }
    let labels = Labels { title: "cost of a step", x: "equations", y: "CPU seconds a step" };
    let head = ["case", "links", "equations", "CPU s a step", "iterations a step", "steps"].map(str::to_owned).to_vec();
    findings.sections.push(ReportSection {
        title: "chains of ball joints".into(),
            reading: "CPU time of a step against the number of equations. A line of slope 1 means that the cost of a link does not grow with the length of the chain.".into(),
        figures: vec![plot::log_log(labels, &lines, None, &[1.0])],
        tables: vec![Grid { caption: format!("Chains of {LENGTHS:?} links, {steps} steps of {dt}."), head, rows }],
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Links of a chain between two supports are as long as they are heavy: 0.8 along, 0.6 up.
    #[test]
    fn chains_fit_their_joints() {
        for two in [false, true] {
            let made = model(10, two).unwrap();
            // Rigidity of ten bodies and their joints.
            assert_eq!(made.contacts.len(), 20 + usize::from(two));
            assert_eq!(made.node_count(), 40);
        }
    }
}
