//! Strings.

use super::build::{add_constraint, add_gravity, add_vectors, dynamic, fix, follow, place, quasi_static_searching};
use super::{ENERGY, noted, order_in_mesh};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::larger;
use crate::workspace::Outcome;
use stoss_multibody::{ConstraintSet, ElasticString, Embedded, Equation, PointMass, QuadraticsBuilder, StringMaterial};
use stoss_reference_cases::multibody::elliptic::quarter_period;
use stoss_reference_cases::multibody::lines::catenary;
use stoss_solver::Model;

const GRAVITY: f64 = 9.81;

/// Measures all cases of strings.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    hanging(findings)?;
    pendulum(findings)?;
    slack(quick, findings)
}

/// An elastic string between two supports of the same height.
fn hanging(findings: &mut Findings) -> Outcome<()> {
    let case = "catenary";
    let (length, weight, horizontal, stiffness) = (3.0, 2.0, 1.4, 40.0);
    let (span, sag) = catenary(length, weight, horizontal, stiffness);
    let error = |order: usize, elements: usize| -> Outcome<f64> {
        // From a parabola that is a little too flat.
        let n = order * elements;
        let node = |i: usize| {
            let t = 2.0 * i as f64 / n as f64 - 1.0;
            [0.5 * span * t, 0.0, 0.9 * sag * (t * t - 1.0)]
        };
        let nodes: Vec<[f64; 3]> = (0..=n).map(node).collect();
        let material = StringMaterial { stiffness, mass: 1.0, lumped: false, tension_only: false };
        let unstretched = ElasticString::new("string", 0, order, nodes.clone(), material, 1.0)?;
        let string = ElasticString::new("string", 0, order, nodes, material, unstretched.natural_length() / length)?;
        let mut model = Model::default();
        add_vectors(&mut model, string.reference(), &[]);
        fix(&mut model, &[0, n as u32]);
        let middle = string.node_vector(n / 2);
        model.parts.push(Box::new(string));
        add_gravity(&mut model, [0.0, 0.0, -weight]);
        let mut run = quasi_static_searching(model, 1.0, 1.0)?;
        run.advance()?;
        Ok((place(&run.state().q, middle)[2] / -sag - 1.0).abs())
    };
    for (of, [coarse, fine]) in [(1, [16, 32]), (2, [8, 16]), (3, [4, 8])] {
        let off = ("relative error of the sag", [error(of, coarse)?, error(of, fine)?]);
        // As of beams: order 2 of elements of order 1, 4 of those above.
        let least = if of == 1 { 1.9 } else { 3.8 };
        order_in_mesh(findings, case, of, off, [coarse, fine], least);
    }
    Ok(())
}

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

/// A bob on a light, stiff string: the period of a pendulum, `4 K(sin^2(a/2)) sqrt(L / g)`.
fn pendulum(findings: &mut Findings) -> Outcome<()> {
    let case = "string pendulum";
    let (length, amplitude) = (1.5, 1.0_f64);
    let (s, c) = amplitude.sin_cos();
    let material = StringMaterial { stiffness: 1e5, mass: 1e-4, lumped: false, tension_only: false };
    let e = GRAVITY * c / material.stiffness;
    let exact = 4.0 * quarter_period((0.5 * amplitude).sin().powi(2)) * (length / GRAVITY).sqrt();
    let period = |steps: f64| -> Outcome<(f64, f64)> {
        let stretch = e + (1.0 + e * e).sqrt();
        let (model, bob) = with_bob([length * s, 0.0, -length * c], [0.0; 3], material, stretch, 2)?;
        let mut run = dynamic(model, exact / steps, 1.3 * exact)?;
        let (mut crossings, mut before) = (Vec::new(), (0.0, length * s));
        let kept = follow(&mut run, |simulation, record| {
            let now = (record.time, place(&simulation.state().q, bob)[0]);
            if before.1 * now.1 < 0.0 {
                crossings.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
            }
            before = now;
        })?;
        let [a, b, ..] = crossings[..] else { return Err("the pendulum does not swing twice".into()) };
        Ok((2.0 * (b - a), kept.energy / (GRAVITY * length)))
    };
    let ((coarse, _), (fine, energy)) = (period(100.0)?, period(200.0)?);
    let errors = [coarse, fine].map(|p| (p / exact - 1.0).abs());
    let note = format!("relative errors {:.2e}, {:.2e} with 100 and 200 steps a period", errors[0], errors[1]);
    // EA is 1e4 times the weight: the string is longer by 1e-4.
    noted(findings, case, "relative error of the period", errors[1], Bound::AtMost(1e-3), note);
    noted(findings, case, "drift of the energy", energy, Bound::AtMost(ENERGY), "");
    Ok(())
}

/// A bob that is thrown up on a string without compression: it falls slack, and is caught again.
fn slack(quick: bool, findings: &mut Findings) -> Outcome<()> {
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
