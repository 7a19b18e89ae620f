//! A string that falls slack.

use super::build::{add_constraint, add_gravity, add_vectors, dynamic, fix, follow, place};
use super::{ENERGY, noted};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::larger;
use crate::workspace::Outcome;
use stoss_multibody::{ConstraintSet, ElasticString, Embedded, Equation, PointMass, QuadraticsBuilder, StringMaterial};
use stoss_solver::Model;

const GRAVITY: f64 = 9.81;

/// Two points are one.
pub fn hook(a: &Embedded, b: &Embedded) -> ConstraintSet {
    let mut builder = QuadraticsBuilder::new();
    let gap = builder.form(&a.plus(-1.0, b));
    for axis in super::build::AXES {
        let axis = builder.form(&Embedded::ground(axis));
        builder.function(0.0, &[(1.0, gap, axis)]);
    }
    ConstraintSet::new("hook", 1.0, vec![Equation::each(builder.build())])
}

/// A bob at the end of a string from the origin to `end`.
fn with_bob(
    end: [f64; 3],
    velocity: [f64; 3],
    material: StringMaterial,
    stretch: f64,
    elements: usize,
) -> Outcome<(Model, u32)> {
    let nodes = ElasticString::straight_nodes([0.0; 3], end, elements, 2)?;
    let string = ElasticString::new("string", 0, 2, nodes, material, stretch)?;
    let last = string.node_count() - 1;
    let bob = PointMass::new("bob", last as u32 + 1, 1.0, 1.5)?;
    let mut model = Model::default();
    // The string moves as its end does, more and more from the support on.
    let shares = (0..=last).map(|i| velocity.map(|v| v * i as f64 / last as f64));
    add_vectors(&mut model, string.reference(), &shares.collect::<Vec<_>>());
    add_vectors(&mut model, &[string.reference()[last]], &[velocity]);
    fix(&mut model, &[0]);
    add_constraint(&mut model, "hook", hook(&string.point(last), &bob.position()));
    model.parts.push(Box::new(string));
    model.parts.push(Box::new(bob));
    add_gravity(&mut model, [0.0, 0.0, -GRAVITY]);
    Ok((model, last as u32 + 1))
}

/// A bob that is thrown up on a string without compression: it falls slack, and is caught again.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let case = "slack and taut";
    let material = StringMaterial { stiffness: 500.0, mass: 0.05, lumped: false, tension_only: true };
    let (model, bob) = with_bob([0.9, 0.0, -1.2], [0.5, 0.8, 4.5], material, 1.01, 4)?;
    let mut run = dynamic(model, 0.002, if quick { 1.6 } else { 6.0 })?;
    let first = *run.balance();
    let (mut nearest, mut strain, mut slack_steps) = (f64::INFINITY, 0.0, 0);
    let kept = follow(&mut run, |s, record| {
        let x = place(&s.state().q, bob);
        nearest = nearest.min((x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt());
        strain = larger(strain, record.balance.strain);
        slack_steps += u32::from(record.balance.strain < 1e-3 * first.kinetic);
    })?;
    let note = format!(
        "{} steps, {slack_steps} of them nearly without strain energy, nearest to the support {nearest:.2} of 1.5, strain energy up to {strain:.1}, {} iterations at most",
        kept.steps, kept.iterations[0]
    );
    noted(findings, case, "drift of the energy", kept.energy / first.kinetic, Bound::AtMost(ENERGY), note);
    noted(
        findings,
        case,
        "drift of angular momentum about the vertical",
        kept.angular[2] / first.angular_momentum[2].abs(),
        Bound::AtMost(super::MOMENTUM),
        "",
    );
    Ok(())
}
