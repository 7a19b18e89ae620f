//! Contact elements with friction at random steps over a row of warped facets with gaps: tangents against differences, momenta, objectivity,
//! energies. The steps and their dense assembly are those of the tests.

#[path = "../../../../contact-nts/tests/common/mod.rs"]
mod common;

use std::sync::Arc;

use common::{ACTIVE, OPEN, assembled, assembled_with, path, resultants, second_step, standard};
use stoss_contact::friction::{Coulomb, Friction as Rough, Stick};
use stoss_contact_nts::{CoordinateAugmented, NodeToSurface, Reduction};
use stoss_tensor::{Tensor2, Vector3};
use stoss_term::{At, Auxiliary, GradientRule, StepConfiguration, Term, Unilateral, Work};

use super::super::check::{Bound, Check};
use super::super::derivatives::{self, Worst};
use super::super::states::Random;
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

const FACETS: u32 = 6;
const PENALTY: f64 = 40.0;
const PRESSURE: f64 = 3.0;
const BEFORE: f64 = 7.0;
const STEP: f64 = 0.1;
/// Random steps of each kind.
const STATES: usize = 24;

const RULES: [(&str, GradientRule); 3] = [
    ("end point", GradientRule::EndPoint),
    ("midpoint", GradientRule::Midpoint),
    ("energy-momentum", GradientRule::DiscreteGradient),
];
/// What the second step does, with a coefficient of friction for which it does so for certain.
const KINDS: [(&str, f64); 2] = [("stick", 1e3), ("slip", 0.02)];
/// Where the second step ends: least and largest slide.
const PLACES: [(&str, [f64; 2]); 3] =
    [("same facet", [0.05, 0.15]), ("next facet", [0.9, 1.1]), ("fifth facet", [3.9, 4.1])];

/// A random step, after another one in which the node closed.
struct Path {
    q: [Vec<f64>; 3],
    rule: GradientRule,
}

impl Path {
    fn new(random: &mut Random, rule: GradientRule, slide: [f64; 2]) -> Self {
        let size = 3 * (2 * (FACETS as usize + 1) + 4);
        let mut noise =
            |amplitude: f64| -> Vec<f64> { (0..size).map(|_| random.between(-amplitude, amplitude)).collect() };
        let noise = [noise(0.06), noise(0.05), noise(0.05)];
        let at = [random.between(0.4, 0.6), random.between(0.2, 0.4), random.between(0.1, 0.2)];
        let first = [random.between(-0.15, 0.15), random.between(-0.15, 0.15)];
        let second = [random.between(slide[0], slide[1]), random.between(0.05, 0.15), random.between(-0.25, -0.15)];
        let q = path(FACETS, [&noise[0], &noise[1], &noise[2]], at, first, second);
        Self { q, rule }
    }

    fn direct(&self, mu: f64) -> Outcome<NodeToSurface> {
        let friction = Rough::new(Arc::new(Coulomb::new(mu)?), PENALTY, Stick::Penalty)?;
        Ok(self.run(standard(FACETS).with_friction(friction)?))
    }

    /// The contact with stick by multipliers.
    fn exact(&self, mu: f64) -> Outcome<NodeToSurface> {
        let friction = Rough::new(Arc::new(Coulomb::new(mu)?), PENALTY, Stick::Multiplier)?;
        Ok(self.run(standard(FACETS).with_friction(friction)?))
    }

    fn augmented(&self, mu: f64, reduction: Reduction) -> Outcome<CoordinateAugmented> {
        let friction = Rough::new(Arc::new(Coulomb::new(mu)?), PENALTY, Stick::Penalty)?;
        Ok(self.run(CoordinateAugmented::new(standard(FACETS).with_friction(friction)?, reduction)))
    }

    /// The whole history turned and shifted, and the rotation.
    fn carried(&self, random: &mut Random) -> (Self, Tensor2) {
        let rotation: Tensor2 = random.rotation();
        let shift = Vector3::from_fn(|_, _| random.between(-2.0, 2.0));
        let q = self.q.each_ref().map(|q| moved(q, &rotation, shift));
        (Self { q, rule: self.rule }, rotation)
    }

    fn run<M: Term + Unilateral>(&self, method: M) -> M {
        second_step(method, &self.q, self.rule, STEP, BEFORE)
    }

    /// Positions at the end and the pressure.
    fn unknowns(&self) -> Vec<f64> {
        self.q[2].iter().copied().chain([PRESSURE]).collect()
    }

    /// Nodal forces of the contact, pressure and friction.
    fn forces(&self, m: &NodeToSurface) -> Vec<f64> {
        let mut residual = assembled(m, &self.q[1], &self.q[2], PRESSURE, self.rule, false).0;
        residual.pop();
        residual
    }

    /// Nodal forces of the friction alone.
    fn friction(&self, m: &NodeToSurface) -> Vec<f64> {
        let without = self.forces(&self.run(standard(FACETS)));
        self.forces(m).iter().zip(&without).map(|(a, b)| a - b).collect()
    }

    fn work(&self, m: &NodeToSurface, active: &[bool]) -> Outcome<Work> {
        Ok(m.work(&At::end(&self.q[2], &[PRESSURE, 0.0, 0.0, 0.0], active))?)
    }

    /// Auxiliaries at the foot, those of the first slot off it by `off`.
    fn start(&self, m: &CoordinateAugmented, q: &[f64], off: &[f64]) -> Outcome<Vec<f64>> {
        let mut values = vec![0.0; m.slot_count() * m.auxiliaries().len()];
        let step = StepConfiguration { q_n: &self.q[1], q_np1: q, rule: self.rule };
        m.start_auxiliaries(&step.at(&[PRESSURE, 0.0, 0.0, 0.0], &ACTIVE), &mut values)?;
        for (value, off) in values.iter_mut().zip(off).take(m.auxiliaries().len()) {
            *value += off;
        }
        Ok(values)
    }
}

/// Points or vectors, turned and shifted.
fn moved(values: &[f64], rotation: &Tensor2, shift: Vector3) -> Vec<f64> {
    let points = values.chunks_exact(3).map(|x| rotation * Vector3::from_column_slice(x) + shift);
    points.flat_map(|x| [x[0], x[1], x[2]]).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

/// Every row.
pub fn rows(checks: &mut Vec<Check>) -> Outcome<()> {
    direct(checks)?;
    multipliers(checks)?;
    augmented(checks)?;
    energies(checks)
}

/// Tangents, momenta and objectivity of the direct method.
fn direct(checks: &mut Vec<Check>) -> Outcome<()> {
    for (kind, mu) in KINDS {
        let (mut momenta, mut turned) = (Worst::default(), Worst::default());
        for (place, slide) in PLACES {
            let mut tangents = Worst::default();
            let mut random = Random(11);
            for _ in 0..STATES {
                for (name, rule) in RULES {
                    let path = Path::new(&mut random, rule, slide);
                    let m = path.direct(mu)?;
                    let x = path.unknowns();
                    let (_, tangent) = assembled(&m, &path.q[1], &path.q[2], PRESSURE, rule, true);
                    let mut force = |x: &[f64], out: &mut [f64]| {
                        let (q, p) = (&x[..x.len() - 1], x[x.len() - 1]);
                        out.copy_from_slice(&assembled(&m, &path.q[1], q, p, rule, false).0);
                    };
                    let worst = derivatives::force(&mut force, &x, &tangent)?;
                    tangents.see(worst.relative_error, || name.to_owned());
                    let forces = path.forces(&m);
                    let (sum, moment) = resultants(&forces, &path.q[1], &path.q[2], rule);
                    momenta.see(sum.max(moment) / largest(&forces), || format!("{place}, {name}"));
                    turned.see(objectivity(&path, &m, mu, &mut random)?, || format!("{place}, {name}"));
                }
            }
            checks.push(tangents.check("direct", &format!("{kind}, {place}: tangent against differences"), 1e-7));
        }
        checks.push(momenta.check(
            "direct",
            &format!("{kind}: resultant and moment of the forces, by the largest"),
            1e-12,
        ));
        checks.push(turned.check(
            "direct",
            &format!("{kind}: forces of a turned and shifted step, by the largest"),
            1e-11,
        ));
    }
    Ok(())
}

/// How far the forces of the whole history, turned and shifted, are from the turned forces.
fn objectivity(path: &Path, m: &NodeToSurface, mu: f64, random: &mut Random) -> Outcome<f64> {
    let (other, rotation) = path.carried(random);
    let expected = moved(&path.forces(m), &rotation, Vector3::zeros());
    let found = other.forces(&other.direct(mu)?);
    let difference = expected.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, larger);
    Ok(difference / largest(&expected))
}

/// The direct method with stick by multipliers: tangents, momenta, objectivity at any traction; no work where a point sticks.
fn multipliers(checks: &mut Vec<Check>) -> Outcome<()> {
    let (mut work, mut power, mut dissipated) = (Worst::default(), Worst::default(), 0.0_f64);
    for (kind, mu) in KINDS {
        let (mut tangents, mut momenta, mut turned_forces) = (Worst::default(), Worst::default(), Worst::default());
        let mut random = Random(14);
        for _ in 0..STATES {
            for ((place, slide), (name, rule)) in PLACES.iter().flat_map(|place| RULES.map(|rule| (place, rule))) {
                let path = Path::new(&mut random, rule, *slide);
                let multiplier = [random.between(-0.5, 0.5), random.between(-0.5, 0.5)];
                let m = path.exact(mu)?;
                let mut values = vec![0.0; m.slot_count() * m.auxiliaries().len()];
                values[..2].copy_from_slice(&multiplier);
                let x: Vec<f64> = path.unknowns().into_iter().chain(multiplier).collect();
                let (residual, tangent) = assembled_with(&m, &path.q[1], rule, &x, &values, true);
                let mut force = |x: &[f64], out: &mut [f64]| {
                    out.copy_from_slice(&assembled_with(&m, &path.q[1], rule, x, &values, false).0);
                };
                let at = || format!("{place}, {name}");
                tangents.see(derivatives::force(&mut force, &x, &tangent)?.relative_error, at);
                let forces = &residual[..path.q[2].len()];
                let (sum, moment) = resultants(forces, &path.q[1], &path.q[2], rule);
                momenta.see(sum.max(moment) / largest(forces), at);
                let (other, rotation) = path.carried(&mut random);
                let x: Vec<f64> = other.unknowns().into_iter().chain(multiplier).collect();
                let found = assembled_with(&other.exact(mu)?, &other.q[1], rule, &x, &values, false).0;
                let expected = moved(forces, &rotation, Vector3::zeros());
                let off = expected.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, larger);
                turned_forces.see(off / largest(&expected), at);
                if kind == "stick" {
                    // A second step that turns the whole: no slip.
                    let rigid = turned(path, &mut random);
                    let mut m = rigid.exact(mu)?;
                    m.renew(
                        &At::end(&rigid.q[2], &[PRESSURE, 0.0, 0.0, 0.0], &ACTIVE).with_auxiliaries(&values),
                        false,
                    )?;
                    let done = rigid.work(&m, &ACTIVE)?;
                    let traction = multiplier[0].hypot(multiplier[1]);
                    work.see(done.friction_work.abs() / traction, at);
                    dissipated = larger(dissipated, larger(done.dissipated.abs(), done.stored));
                    if rule == GradientRule::DiscreteGradient {
                        let x: Vec<f64> = rigid.unknowns().into_iter().chain(multiplier).collect();
                        let with = assembled_with(&m, &rigid.q[1], rule, &x, &values, false).0;
                        let without = rigid.forces(&rigid.run(standard(FACETS)));
                        let motion = rigid.q[2].iter().zip(&rigid.q[1]).map(|(a, b)| a - b);
                        let forces = with.iter().zip(&without).map(|(a, b)| a - b);
                        power.see(forces.zip(motion).map(|(f, u)| f * u).sum::<f64>().abs() / traction, at);
                    }
                }
            }
        }
        let row = |what: &str| format!("{kind} by multipliers: {what}");
        checks.push(tangents.check("direct", &row("tangent against differences"), 1e-7));
        checks.push(momenta.check("direct", &row("resultant and moment of the forces, by the largest"), 1e-12));
        checks.push(turned_forces.check("direct", &row("forces of a turned and shifted step, by the largest"), 1e-11));
    }
    checks.push(work.check("direct", "stick by multipliers in a turn of the whole: work by the traction", 1e-13));
    checks.push(power.check("direct", "the same, energy-momentum: work on all nodes by the traction", 1e-12));
    let quantity = "stick by multipliers: energy stored or dissipated";
    checks.push(Check::new("direct", quantity, dissipated, Bound::AtMost(0.0)));
    Ok(())
}

/// Tangents and momenta of coordinate augmentation, off the foot where the coordinates are unknowns, and the direct method at the end point.
fn augmented(checks: &mut Vec<Check>) -> Outcome<()> {
    let reductions = [("none", Reduction::None), ("first", Reduction::First), ("second", Reduction::Second)];
    for (kind, mu) in KINDS {
        let (mut momenta, mut same) = (Worst::default(), Worst::default());
        for (reduction_name, reduction) in reductions {
            let mut tangents = Worst::default();
            let mut random = Random(12);
            for count in 0..STATES {
                for ((place, slide), (name, rule)) in PLACES.iter().zip(RULES.iter().cycle().skip(count)) {
                    // It has no energy-momentum rule of its own.
                    let rule = if *rule == GradientRule::DiscreteGradient { GradientRule::Midpoint } else { *rule };
                    let path = Path::new(&mut random, rule, *slide);
                    let m = path.augmented(mu, reduction)?;
                    let condensed = reduction == Reduction::Second;
                    let off: [f64; 4] =
                        std::array::from_fn(|_| if condensed { 0.0 } else { random.between(-0.2, 0.2) });
                    let start = path.start(&m, &path.q[2], &off)?;
                    let mut x = path.unknowns();
                    let dofs = path.q[2].len();
                    x.extend(&start[..Auxiliary::equations(m.auxiliaries())]);
                    let (residual, tangent) = assembled_with(&m, &path.q[1], rule, &x, &start, true);
                    let mut force = |x: &[f64], out: &mut [f64]| {
                        // The condensed coordinates follow the foot.
                        let moved = if condensed { path.start(&m, &x[..dofs], &off).ok() } else { None };
                        let auxiliaries = moved.as_ref().unwrap_or(&start);
                        out.copy_from_slice(&assembled_with(&m, &path.q[1], rule, x, auxiliaries, false).0);
                    };
                    let worst = derivatives::force(&mut force, &x, &tangent)?;
                    tangents.see(worst.relative_error, || format!("{place}, {name}"));
                    let forces = &residual[..dofs];
                    let (sum, moment) = resultants(forces, &path.q[1], &path.q[2], rule);
                    momenta.see(sum.max(moment) / largest(forces), || {
                        format!("reduction {reduction_name}, {place}, {name}")
                    });
                    if condensed && rule == GradientRule::EndPoint {
                        let expected = path.forces(&path.direct(mu)?);
                        let difference = expected.iter().zip(forces).map(|(a, b)| (a - b).abs()).fold(0.0, larger);
                        same.see(difference / largest(&expected), || (*place).to_owned());
                    }
                }
            }
            let quantity = format!("{kind}, reduction {reduction_name}: tangent against differences");
            checks.push(tangents.check("cat", &quantity, 1e-7));
        }
        checks.push(momenta.check(
            "cat",
            &format!("{kind}: resultant and moment of the forces, by the largest"),
            1e-12,
        ));
        checks.push(same.check("cat", &format!("{kind}: forces against the direct ones at the end point"), 1e-10));
    }
    Ok(())
}

/// Dissipation, the balance of the energy-momentum rule, and steps in which the whole turns as a rigid body.
fn energies(checks: &mut Vec<Check>) -> Outcome<()> {
    let (mut least, mut count) = (f64::INFINITY, 0);
    let (mut balance, mut rigid, mut power) = (Worst::default(), Worst::default(), Worst::default());
    let mut random = Random(13);
    for _ in 0..STATES {
        for (place, slide) in PLACES {
            for (name, rule) in RULES {
                let path = Path::new(&mut random, rule, slide);
                let m = path.direct(random.between(0.0, 2.0))?;
                let (work, released) = (path.work(&m, &ACTIVE)?, path.work(&m, &OPEN)?);
                let sum = work.stored + released.dissipated + work.friction_work.abs();
                least = least.min(work.dissipated / sum.max(f64::MIN_POSITIVE)).min(released.dissipated);
                count += 1;
                if rule == GradientRule::DiscreteGradient {
                    // What the released spring loses is what it held.
                    let done = work_of(&path, &m);
                    let rest = done + work.stored - released.dissipated + work.dissipated;
                    balance.see(rest.abs() / (done.abs() + work.stored), || place.to_owned());
                }
                let rigid_step = turned(path, &mut random);
                let m = rigid_step.direct(KINDS[0].1)?;
                let (work, before) = (rigid_step.work(&m, &ACTIVE)?, rigid_step.work(&m, &OPEN)?.dissipated);
                let scale = before.max(1.0);
                let lost = work.dissipated.abs().max((work.stored - before).abs()) / scale;
                rigid.see(lost, || format!("{place}, {name}"));
                if rule == GradientRule::DiscreteGradient {
                    power.see(work_of(&rigid_step, &m).abs() / scale, || place.to_owned());
                }
            }
        }
    }
    let least = Check::new("direct", "least dissipation of a step, by its energies", least, Bound::AtLeast(-1e-15));
    checks.push(least.noted(format!("{count} states")));
    checks.push(balance.check("direct", "energy-momentum: work against stored and dissipated energy", 1e-12));
    checks.push(rigid.check(
        "direct",
        "stick in a turn of the whole: energy stored or dissipated, by that in the spring",
        1e-11,
    ));
    checks.push(power.check(
        "direct",
        "stick in a turn of the whole, energy-momentum: work, by that in the spring",
        1e-11,
    ));
    Ok(())
}

/// Work of the friction on the motion of the nodes.
fn work_of(path: &Path, m: &NodeToSurface) -> f64 {
    let motion = path.q[2].iter().zip(&path.q[1]).map(|(a, b)| a - b);
    // The residual is the force with the sign turned round.
    -path.friction(m).iter().zip(motion).map(|(f, u)| f * u).sum::<f64>()
}

/// The path with a second step that only turns and shifts.
fn turned(mut path: Path, random: &mut Random) -> Path {
    let angle = Vector3::from_fn(|_, _| random.between(-0.6, 0.6));
    let rotation = stoss_tensor::nalgebra::Rotation3::new(angle).into_inner();
    let shift = Vector3::from_fn(|_, _| random.between(-2.0, 2.0));
    let points = path.q[1].chunks_exact(3).map(|x| rotation * Vector3::from_column_slice(x) + shift);
    path.q[2] = points.flat_map(|x| [x[0], x[1], x[2]]).collect();
    path
}
