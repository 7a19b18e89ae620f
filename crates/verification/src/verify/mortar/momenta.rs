//! Resultant and moment of the contact forces at random configurations, for any gap.

use std::sync::Arc;

use stoss_contact::friction::{Coulomb, Friction, Stick};
use stoss_contact_mortar::{MortarContact, MortarOptions, MultiplierSpace, SlipMeasure};
use stoss_tensor::Vector3;
use stoss_tensor::nalgebra::Rotation3;
use stoss_term::{At, GradientRule, Local, Step, StepConfiguration, Term};

use super::super::Findings;
use super::super::check::{Bound, Check};
use super::super::states::Random;
use crate::workspace::Outcome;

const SLAVE: usize = 9;
const NODES: usize = 25;
const MU: f64 = 0.5;
const PENALTY: f64 = 40.0;
/// Least moment that counts as the known defect of the slip `direct` at a gap.
const DEFECT: f64 = 1e-3;

/// Name, configuration of the gradients, and the place at which its force has no moment: start, middle or end of the step.
const RULES: [(&str, GradientRule, f64); 4] = [
    ("start of the step", GradientRule::StartPoint, 0.0),
    ("end of the step", GradientRule::EndPoint, 1.0),
    ("midpoint", GradientRule::Midpoint, 0.5),
    ("energy-momentum", GradientRule::DiscreteGradient, 0.5),
];

fn sheet(n: u32, first: u32, up: bool) -> Vec<[u32; 4]> {
    let facets = (0..n * n).map(|f| {
        let a = first + f / n * (n + 1) + f % n;
        let [b, c, d] = [a + 1, a + n + 2, a + n + 1];
        if up { [a, b, c, d] } else { [a, d, c, b] }
    });
    facets.collect()
}

/// Two by two facets at a distance over three by three, turned and shifted so that they overlap in part.
fn base(gap: f64) -> Vec<f64> {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.3);
    let mut q = Vec::new();
    for k in 0..SLAVE {
        let x = turn * Vector3::new((k % 3) as f64 * 0.9, (k / 3) as f64 * 0.8, 0.0) + Vector3::new(0.55, 0.37, gap);
        q.extend(x.iter());
    }
    for k in 0..NODES - SLAVE {
        q.extend([(k % 4) as f64 * 0.7, (k / 4) as f64 * 0.72, 0.0]);
    }
    q
}

fn node(x: &[f64], k: usize) -> Vector3 {
    Vector3::new(x[3 * k], x[3 * k + 1], x[3 * k + 2])
}

/// Resultant and moment over the sum of the sizes of the forces and of their moments.
fn resultants(force: &[f64], x: &[f64]) -> [f64; 2] {
    let (mut sum, mut moment, mut size, mut arm) = (Vector3::zeros(), Vector3::zeros(), 0.0, 0.0);
    for k in 0..NODES {
        let (f, x) = (node(force, k), node(x, k));
        sum += f;
        moment += x.cross(&f);
        size += f.norm();
        arm += x.norm() * f.norm();
    }
    let relative = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
    [relative(sum.norm(), size), relative(moment.norm(), arm)]
}

/// Nodal forces of the step from `q_n` to `q` with these pressures at all slave nodes.
fn forces(
    method: &mut MortarContact,
    rule: GradientRule,
    [q_n, q]: [&[f64]; 2],
    pressures: &[f64],
) -> Outcome<Vec<f64>> {
    let active = [true; SLAVE];
    method.begin(&Step { reach: 0.5, ..Step::new(q_n, rule, 0.1) })?;
    method.renew(&At::end(q, &[], &active), true)?;
    let mut force = vec![0.0; 3 * NODES];
    let step = StepConfiguration { q_n, q_np1: q, rule };
    method.assemble(&step.at(pressures, &active), false, &mut |local: &Local| {
        for (a, &n) in local.nodes.iter().enumerate() {
            (0..3).for_each(|i| force[3 * n as usize + i] += local.residual[3 * a + i]);
        }
    })?;
    Ok(force)
}

/// Worst of many random pairs of surfaces, and the number of those with forces. From half a facet inside to half a facet apart.
fn worst(
    count: u32,
    (rule, place): (GradientRule, f64),
    prepare: impl Fn(MortarContact) -> Outcome<MortarContact>,
) -> Outcome<([f64; 2], u32)> {
    let mut random = Random(31);
    let (mut worst, mut loaded) = ([0.0_f64; 2], 0);
    for k in 0..count {
        let space = if k % 2 == 0 { MultiplierSpace::Standard } else { MultiplierSpace::Dual };
        let gap = random.between(-0.4, 0.4);
        let mut moved = || base(gap).iter().map(|x| x + random.between(-0.12, 0.12)).collect::<Vec<f64>>();
        let (q_n, q) = (moved(), moved());
        let options = MortarOptions { space, ..MortarOptions::default() };
        let (slave, master) = (sheet(2, 0, false), sheet(3, SLAVE as u32, true));
        let mut method = prepare(MortarContact::new("blocks", &slave, &master, &q_n, options)?)?;
        let pressures: Vec<f64> = (0..SLAVE).map(|_| random.between(0.3, 2.0)).collect();
        let force = forces(&mut method, rule, [&q_n, &q], &pressures)?;
        loaded += u32::from(force.iter().any(|f| *f != 0.0));
        let x: Vec<f64> = q_n.iter().zip(&q).map(|(a, b)| a + place * (b - a)).collect();
        for (worst, found) in worst.iter_mut().zip(resultants(&force, &x)) {
            *worst = if *worst > found || worst.is_nan() { *worst } else { found };
        }
    }
    Ok((worst, loaded))
}

/// Measures all rules with both multiplier spaces, without friction and with both measures of slip.
pub fn measure(findings: &mut Findings, quick: bool) -> Outcome<()> {
    let count = if quick { 100 } else { 5000 };
    let bound = Bound::AtMost(super::MOMENTUM);
    let mut rows = |scene: &str, ([force, moment], loaded): ([f64; 2], u32), moments: Bound| {
        let note = format!("{loaded} of {count} random pairs with forces, gaps from -0.4 to 0.4 of facets of 0.8");
        findings.checks.push(Check::new(scene, "resultant, by the forces", force, bound).noted(note));
        findings.checks.push(Check::new(scene, "moment, by the forces' moments", moment, moments));
    };
    for (name, rule, place) in RULES {
        let found = worst(count, (rule, place), Ok)?;
        rows(&format!("contact forces, {name}"), found, bound);
        if rule == GradientRule::StartPoint {
            continue;
        }
        // The force of the thesis acts at two places that are a gap apart.
        let defect = Bound::AtLeast(DEFECT);
        for (slip, measure, moments) in
            [("objective", SlipMeasure::Objective, bound), ("direct", SlipMeasure::Direct, defect)]
        {
            let rough = |method: MortarContact| -> Outcome<MortarContact> {
                let friction = Friction::new(Arc::new(Coulomb::new(MU)?), PENALTY, Stick::Penalty)?;
                Ok(method.with_friction(friction, measure)?)
            };
            let found = worst(count, (rule, place), rough)?;
            rows(&format!("friction, slip {slip}, {name}"), found, moments);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_couple_has_a_moment_and_no_resultant() {
        let mut force = vec![0.0; 3 * NODES];
        let mut x = vec![0.0; 3 * NODES];
        (force[0], force[3], x[1], x[4]) = (2.0, -2.0, 1.0, -1.0);
        assert_eq!(resultants(&force, &x), [0.0, 1.0]);
    }
}
