//! Strings and beams on rigid surfaces, by contact of their nodes.
//!
//! A string that turns by `alpha` before and by `beta` after the normal of a node in contact, its friction at the bound, has there
//! `T_2 cos beta - T_1 cos alpha = mu (T_1 sin alpha + T_2 sin beta)`, thus with `phi = atan mu` the ratio `T_2 / T_1 = cos(alpha - phi) / cos(beta + phi)`. Its logarithm is
//! `mu (alpha + beta) + (1 + mu^2) (beta^2 - alpha^2) / 2` and, of `alpha = beta = a / 2`, `mu (1 + mu^2) a^3 / 12`, up to terms of higher order. So the polygon of a string with nodes
//! `a` apart on a pulley with `N` facets, whose normals are off by `pi / N` at most, is as near to Euler's `exp(mu theta)` as [`polygon`] says.

use super::scene::{probe, run};
use super::{ENERGY, MOMENTUM, noted};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::verify::numbers::{apart, larger};
use crate::workspace::Outcome;
use std::f64::consts::PI;
use std::fmt::Write as _;
use toml::Table;

/// Force of the weight at the start of the string; the radius of the pulley is 1.
pub const WEIGHT: f64 = 10.0;
const STIFFNESS: f64 = 1000.0;
const FRICTION: f64 = 0.3;
/// Pieces of the string on half of the pulley.
const PIECES: usize = 36;

/// Measures all cases of pulleys.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let facets = if quick { 1500 } else { 3000 };
    frictionless(facets, findings)?;
    capstan(facets, findings)?;
    free_pulley(quick, findings)?;
    beam(facets, findings)
}

/// Largest relative error of the ratio of tensions over half a turn.
fn polygon(friction: f64, facets: usize) -> f64 {
    let (a, square) = (PI / PIECES as f64, 1.0 + friction * friction);
    let off = square * PI * PI / facets as f64;
    // The nodes at both ends are not in the middle of their angle.
    let ends = square * a * a / 4.0;
    off + ends + square * a * a / 12.0 * friction * PI
}

/// Corners of a string over the upper half of the pulley, and down by 1 on either side; elements as long as those on the pulley; length.
fn over_pulley(pieces: usize) -> (String, usize, f64) {
    let mut corners = vec![[-1.0, -1.0]];
    corners.extend((0..=pieces).map(|i| {
        let angle = PI * (1.0 - i as f64 / pieces as f64);
        [angle.cos(), angle.sin()]
    }));
    corners.push([1.0, -1.0]);
    let piece = 2.0 * (0.5 * PI / pieces as f64).sin();
    let mut text = String::new();
    for [x, y] in corners {
        let _ = write!(text, "[{x:?}, {y:?}, 0.03], ");
    }
    (text, pieces + 2 * (1.0 / piece).round() as usize, 2.0 + piece * pieces as f64)
}

/// A string with a weight, laid over a pulley that does not move; its other end is pulled down by `pull`, in statics.
fn laid(friction: f64, facets: usize, pull: f64) -> Outcome<Table> {
    let times =
        "scene = { title = \"String over a pulley\", kind = \"quasi-static\" }\ntime = { end = 1.0, step = 0.05 }\n";
    Ok((times.to_owned() + &laid_over(PIECES, friction, facets, pull)).parse()?)
}

/// The bodies, supports, contact and probes of such a string with so many pieces on the pulley.
pub fn laid_over(pieces: usize, friction: f64, facets: usize, pull: f64) -> String {
    let (points, elements, length) = over_pulley(pieces);
    // Half of nu - 1 / nu is the tension over the stiffness.
    let t = WEIGHT / STIFFNESS;
    let natural = length / (t + (1.0 + t * t).sqrt());
    let rough =
        if friction > 0.0 { format!("friction = {{ law = \"coulomb\", mu = {friction} }}") } else { String::new() };
    format!(
        r#"
        [[rigid]]
        name = "pulley"
        shape = {{ kind = "cylinder", radius = 1.0, length = 0.4, divisions = [{facets}, 2, 1] }}
        fixed = true
        [[string]]
        name = "rope"
        points = [{points}]
        elements = {elements}
        axial = {STIFFNESS}
        natural_length = {natural}
        [[prescribe]]
        set = "rope.all"
        components = ["z"]
        fixed = true
        [[prescribe]]
        set = "rope.end"
        components = ["y"]
        displacement = {{ table = [[0.0, 0.0], [1.0, {pull}]] }}
        [[load]]
        set = "rope.start"
        force = [0, {}, 0]
        [[contact]]
        method = "nts"
        slave = "rope.all"
        master = "pulley.side"
        {rough}
        [[probe]]
        name = "pull"
        body = "rope"
        point = [1.0, -1.0, 0.03]
        quantity = "reaction"
        [[probe]]
        name = "pulley"
        body = "pulley"
        quantity = "contact_force"
        "#,
        -WEIGHT
    )
}

/// Measures a string without friction: both ends pull alike, the pulley takes `2 T sin(theta / 2)`, and a length of the string presses with `T / R`.
fn frictionless(facets: usize, findings: &mut Findings) -> Outcome<()> {
    let case = "string round a pulley, no friction";
    let (mut ratio, mut resultant, mut pressure) = (0.0, 0.0, 0.0);
    run(&laid(0.0, facets, -0.2)?, "pulley", |simulation, probes, _| {
        ratio = larger(ratio, (probe(probes, "pull", simulation)[1] / -WEIGHT - 1.0).abs());
        let force = probe(probes, "pulley", simulation);
        resultant = larger(resultant, (force[0].hypot(force[1]) / (2.0 * WEIGHT) - 1.0).abs());
        // The node nearest to the top, with half of the pieces beside it.
        let (q, nodes) = (&simulation.state().q, simulation.model().parts[1].own_vectors());
        let at = |node: u32| super::build::place(q, node);
        let inner = nodes.start + 1..nodes.end - 1;
        let Some(top) = inner.max_by(|&i, &j| at(i)[1].total_cmp(&at(j)[1])) else { return };
        let apart = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let length = 0.5 * (apart(at(top - 1), at(top)) + apart(at(top), at(top + 1)));
        let force = super::build::place(simulation.contact_force(), top);
        pressure = larger(pressure, (force[0].hypot(force[1]) / length / WEIGHT - 1.0).abs());
    })?;
    let bound = Bound::AtMost(polygon(0.0, facets));
    let note = format!("{facets} facets, nodes 5 degrees apart; bound pi theta / N and the nodes at the ends");
    noted(findings, case, "error of the tensions' ratio 1", ratio, bound, note);
    noted(findings, case, "error of the resultant 2 T sin(theta / 2)", resultant, bound, "half a turn");
    noted(findings, case, "error of the pressure T / R", pressure, bound, "force per present length of the string");
    Ok(())
}

/// Euler's ratio `exp(mu theta)` where the string slides, pulled one way and the other.
fn capstan(facets: usize, findings: &mut Findings) -> Outcome<()> {
    for (way, pull) in [("pulled", -0.2_f64), ("let down", 0.2)] {
        let exact = (-pull.signum() * FRICTION * PI).exp();
        let (mut error, mut first, mut last) = (0.0, f64::NAN, f64::NAN);
        run(&laid(FRICTION, facets, pull)?, "capstan", |simulation, probes, record| {
            last = probe(probes, "pull", simulation)[1] / -WEIGHT;
            if record.step == 1 {
                first = last;
            }
            if record.time > 0.5 {
                error = larger(error, (last / exact - 1.0).abs());
            }
        })?;
        let note = format!(
            "mu = {FRICTION}, half a turn, {facets} facets: exp(mu theta) = {exact:.4}, found {last:.4} at the end, {first:.4} after the first step; bound of the polygon"
        );
        let bound = Bound::AtMost(polygon(FRICTION, facets));
        noted(findings, &format!("capstan, {way}"), "error of the tensions' ratio", error, bound, note);
    }
    Ok(())
}

/// Two masses on a string over a pulley that flies and turns: nothing else acts.
fn thrown(rule: &str, end: f64) -> Outcome<Table> {
    let (points, elements, length) = over_pulley(12);
    Ok(format!(
        r#"
        scene = {{ title = "String on a free pulley", kind = "dynamic" }}
        time = {{ end = {end:?}, step = 0.002, integrator = {{ scheme = "energy-momentum" }} }}
        [[rigid]]
        name = "pulley"
        shape = {{ kind = "cylinder", radius = 1.0, length = 0.4, divisions = [48, 2, 1] }}
        mass = 2.0
        euler = [0.5, 0.5, 0.1]
        velocity = [0.1, 1.0, 0.05]
        angular_velocity = [0.0, 0.1, 0.5]
        [[string]]
        name = "rope"
        points = [{points}]
        elements = {elements}
        axial = {STIFFNESS}
        mass = 0.1
        natural_length = {length}
        [[mass]]
        name = "a"
        at = [-1.0, -1.0, 0.03]
        mass = 1.0
        [[mass]]
        name = "b"
        at = [1.0, -1.0, 0.03]
        mass = 1.5
        [[joint]]
        name = "ja"
        kind = "ball"
        between = ["a", "rope.start"]
        at = [-1.0, -1.0, 0.03]
        [[joint]]
        name = "jb"
        kind = "ball"
        between = ["b", "rope.end"]
        at = [1.0, -1.0, 0.03]
        [[contact]]
        method = "nts"
        slave = "rope.all"
        master = "pulley.side"
        {rule}
        "#
    )
    .parse()?)
}

fn free_pulley(quick: bool, findings: &mut Findings) -> Outcome<()> {
    for (what, rule) in
        [("no friction", "constraint = \"modified\""), ("friction", "friction = { law = \"coulomb\", mu = 0.2 }")]
    {
        let case = format!("string on a free pulley, {what}");
        let (mut first, mut touching, mut lost) = (None, 0, 0.0);
        let mut drift = [0.0; 3];
        run(&thrown(rule, if quick { 0.2 } else { 0.4 })?, "free-pulley", |_, _, record| {
            let b = record.balance;
            // What closing gaps cost is reported, and no dissipation.
            let now = (b.linear_momentum, b.angular_momentum, b.total() + b.closing_loss + b.impact_loss);
            let start = first.get_or_insert(now);
            drift[0] = larger(drift[0], apart(now.0, start.0));
            drift[1] = larger(drift[1], apart(now.1, start.1));
            drift[2] = larger(drift[2], (now.2 - start.2).abs() / start.2);
            touching = touching.max(record.contact.as_ref().map_or(0, |contact| contact.active));
            lost = b.dissipation;
        })?;
        let note = format!("nodes that touch: {touching} at most; friction took {lost:.3} of the energy 1.14");
        noted(
            findings,
            &case,
            "drift of linear momentum over its size 2",
            drift[0] / 2.0,
            Bound::AtMost(MOMENTUM),
            note,
        );
        noted(
            findings,
            &case,
            "drift of angular momentum over its size 0.5",
            drift[1] / 0.5,
            Bound::AtMost(MOMENTUM),
            "",
        );
        noted(findings, &case, "drift of the ledger with what closing gaps cost", drift[2], Bound::AtMost(ENERGY), "");
        noted(findings, &case, "nodes in contact", touching as f64, Bound::AtLeast(5.0), "");
    }
    Ok(())
}

/// A cantilever whose end lies on a cylinder that rises by `d`: `F = d / (L^3 / 3 EI + L / GA)`.
fn beam(facets: usize, findings: &mut Findings) -> Outcome<()> {
    let (bending, shear, rise) = (2.0, 500.0, 1e-4);
    let scene = format!(
        r#"
        scene = {{ title = "Beam on a cylinder", kind = "quasi-static" }}
        time = {{ end = 1.0, step = 0.5 }}
        [[beam]]
        name = "beam"
        points = [[0, 0, 0], [1, 0, 0]]
        elements = 8
        order = 2
        up = [0, 1, 0]
        section = {{ axial = 1000.0, shear = [{shear:?}, {shear:?}], bending = [{bending:?}, {bending:?}], torsion = 1.0 }}
        [[rigid]]
        name = "roll"
        shape = {{ kind = "cylinder", radius = 0.5, length = 0.4, divisions = [{facets}, 2, 1] }}
        position = [1, -0.5, 0]
        [[prescribe]]
        rigid = "roll"
        components = ["y"]
        displacement = {{ table = [[0.0, 0.0], [1.0, {rise:e}]] }}
        [[joint]]
        name = "wall"
        kind = "weld"
        between = ["ground", "beam.start"]
        at = [0, 0, 0]
        [[contact]]
        method = "nts"
        between = ["beam.all", "roll.side"]
        [[probe]]
        name = "roll"
        body = "roll"
        quantity = "contact_force"
        "#
    );
    let mut force = f64::NAN;
    run(&scene.parse()?, "beam-roll", |simulation, probes, _| force = -probe(probes, "roll", simulation)[1])?;
    let exact = rise / (1.0 / (3.0 * bending) + 1.0 / shear);
    let note = format!("F = {exact:.6e}, found {force:.6e}; the facet at the top is inclined by pi / N at most");
    // Terms of second order: the slope at the end is 3 d / (2 L).
    let bound = Bound::AtMost(PI / facets as f64 + 10.0 * rise);
    noted(findings, "beam on a cylinder", "error of the force at the end", (force / exact - 1.0).abs(), bound, note);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bound is that of the ratio of a node: both against differences.
    #[test]
    fn ratio_of_a_node() {
        let phi = FRICTION.atan();
        let ratio = |alpha: f64, beta: f64| ((alpha - phi).cos() / (beta + phi).cos()).ln();
        let square = 1.0 + FRICTION * FRICTION;
        let a = 0.04;
        assert!((ratio(a / 2.0, a / 2.0) - FRICTION * a - FRICTION * square * a.powi(3) / 12.0).abs() < 1e-8);
        assert!((ratio(0.0, a) - FRICTION * a - square * a * a / 2.0).abs() < FRICTION * a.powi(3));
    }

    #[test]
    fn the_cases_hold() {
        let mut findings = Findings::default();
        measure(true, &mut findings).unwrap();
        for check in &findings.checks {
            println!("{check:?}");
            assert!(check.holds(), "{check:?}");
        }
        assert!(findings.checks.len() > 10);
    }
}
