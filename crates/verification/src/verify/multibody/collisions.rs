//! Two bodies and a wall, all impacts elastic: if the outer body has `100^k` times the mass of the inner one, as many impacts follow as `pi` has in its first `k + 1` digits (G. Galperin,
//! *Playing pool with pi*, 2003). In coordinates `sqrt(m) x` the bodies are one point that is reflected in a wedge with the angle `atan(10^-k)`.

use super::scene::{probe, run};
use super::{ENERGY, check};
use crate::verify::Findings;
use crate::verify::check::Bound;
use crate::workspace::Outcome;
use std::f64::consts::PI;
use std::fmt::Write as _;
use toml::Table;

/// The outer body reaches the wall at this time if nothing is in its way; it starts with the speed 1.
const TURN: f64 = 0.55;
/// Nodes of the faces that meet.
const NODES: u64 = 4;

/// Counts the impacts.
pub fn measure(quick: bool, findings: &mut Findings) -> Outcome<()> {
    (0..if quick { 2 } else { 3 }).try_for_each(|k| case(k, findings))
}

/// Number of impacts and velocities after them by elementary impacts of two points.
fn elementary(ratio: f64) -> (u64, [f64; 2]) {
    let (mut inner, mut outer, mut count) = (0.0, -1.0, 0);
    loop {
        if outer < inner {
            let mean = (inner + ratio * outer) / (1.0 + ratio);
            (inner, outer) = (2.0 * mean - inner, 2.0 * mean - outer);
        } else if inner < 0.0 {
            inner = -inner;
        } else {
            return (count, [inner, outer]);
        }
        count += 1;
    }
}

/// Stages whose steps are short against the time between impacts, which is `2 s^2` at the time `s` from the turn, and `2 10^-2k` there.
fn stages(k: i32) -> String {
    let shortest = TURN * 0.1_f64.powi(k);
    let mut far = vec![TURN];
    while far[far.len() - 1] > shortest {
        far.push(0.5 * far[far.len() - 1]);
    }
    let mut text = String::new();
    let step = |s: f64| 0.5 * s * s;
    let mut count = 0;
    let mut stage = |until: f64, step: f64| {
        count += 1;
        let _ =
            write!(text, "{{ name = \"stage-{count}\", kind = \"dynamic\", until = {until:?}, step = {step:?} }}, ");
    };
    let nearest = far[far.len() - 1];
    far[1..].iter().for_each(|&s| stage(TURN - s, step(s)));
    stage(TURN + nearest, step(nearest));
    far[..far.len() - 1].iter().rev().for_each(|&s| stage(TURN + s, step(0.5 * s)));
    stage(4.0, 0.1);
    text
}

fn scene(k: i32) -> Outcome<Table> {
    let (ratio, stages) = (100.0_f64.powi(k), stages(k));
    let text = format!(
        r#"
        scene = {{ title = "Impacts that count the digits of pi", kind = "dynamic" }}
        time = {{ end = 4.0, step = 0.1, integrator = {{ scheme = "energy-momentum" }} }}
        stage = [{stages}]
        rigid = [
            {{ name = "wall", shape = {{ kind = "box", size = [0.2, 1, 1] }}, position = [-0.1, 0, 0], fixed = true }},
            {{ name = "inner", shape = {{ kind = "box", size = [0.2, 0.5, 0.5] }}, position = [0.6, 0, 0], density = 20.0 }},
            {{ name = "outer", shape = {{ kind = "box", size = [0.5, 0.5, 0.5] }}, position = [1.0, 0, 0], density = {density:?}, velocity = [-1, 0, 0] }},
        ]
        contact = [
            {{ slave = "inner.left", master = "wall.right", method = "nts", restitution = 1.0 }},
            {{ slave = "outer.left", master = "inner.right", method = "nts", restitution = 1.0 }},
        ]
        probe = [
            {{ name = "inner", quantity = "velocity", body = "inner" }},
            {{ name = "outer", quantity = "velocity", body = "outer" }},
        ]
        "#,
        density = 8.0 * ratio
    );
    Ok(text.parse()?)
}

fn case(k: i32, findings: &mut Findings) -> Outcome<()> {
    let ratio = 100.0_f64.powi(k);
    let (expected, velocities) = elementary(ratio);
    let digits = (PI / 0.1_f64.powi(k).atan()).ceil() - 1.0;
    let mut last = [0.0; 2];
    let simulation = run(&scene(k)?, "pi", |simulation, probes, _| {
        last = ["inner", "outer"].map(|name| probe(probes, name, simulation)[0]);
    })?;
    let balance = simulation.balance();
    let name = format!("impacts of masses 1 and {ratio}");
    let count = balance.impacts as f64 / NODES as f64;
    let exact = Bound::Near { value: digits, tolerance: 0.0 };
    check(findings, &name, format!("impacts; elementary ones are {expected}"), count, exact);
    let off = (last[0] - velocities[0]).abs().max((last[1] - velocities[1]).abs());
    check(findings, &name, "velocities after the last one against elementary impacts", off, Bound::AtMost(ENERGY));
    let energy = 0.5 * ratio;
    check(findings, &name, "energy, change", (balance.total() - energy).abs() / energy, Bound::AtMost(ENERGY));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elementary_impacts_count_pi() {
        assert_eq!([0, 1, 2, 3].map(|k| elementary(100.0_f64.powi(k)).0), [3, 31, 314, 3141]);
        // Equal masses exchange their velocities: the outer one leaves as it came.
        assert_eq!(elementary(1.0).1, [0.0, 1.0]);
    }
}
