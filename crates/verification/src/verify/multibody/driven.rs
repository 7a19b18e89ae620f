//! A bolt, moments as loads, and blocks that are driven by a reference point; through scenes.

use super::build::order;
use super::scene::{probe, run};
use super::{check, noted};
use crate::verify::check::Bound;
use crate::verify::numbers::{apart, larger};
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;
use std::f64::consts::{PI, TAU};
use toml::Table;

/// Measures all cases of driven bodies.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    bolt(bench, findings)?;
    free_body(findings)?;
    roll_up(bench.quick, findings)?;
    pull(findings)?;
    torsion(bench.quick, findings)
}

/// What linear equations leave of forces and displacements that are exact otherwise, over their sizes.
const EXACT: f64 = 1e-9;

/// Force of a rod of length 1 of St Venant and Kirchhoff's material in uniaxial stress, `E A s (s^2 - 1) / 2` with the stretch `s`.
fn rod(stiffness: f64, stretch: f64) -> f64 {
    0.5 * stiffness * stretch * (stretch * stretch - 1.0)
}

/// Root between -0.5 and 0.5 of a function that increases.
fn root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (-0.5, 0.5);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Stiffnesses of bolt and member of the shipped scene, and its preload.
const BOLT: [f64; 3] = [200.0, 1000.0, 4.0];

/// Force of the bolt under a load that separates, and whether the member is clamped: rods in parallel with the opening of the cut at the lock, then the bolt alone.
fn clamped(load: f64) -> (f64, bool) {
    let [bolt, member, preload] = BOLT;
    let opening = root(|u| rod(member, 1.0 + u) + preload) - root(|e| rod(bolt, 1.0 + e) - preload);
    let together = root(|u| rod(bolt, 1.0 + u - opening) + rod(member, 1.0 + u) - load);
    if together > 0.0 { (load, false) } else { (rod(bolt, 1.0 + together - opening), true) }
}

/// A bolt and a clamped member as rods: preload, separation and closing by a load, and free oscillations afterwards.
fn bolt(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let case = "bolt";
    let scene = bench.scene("bolt")?;
    let [stiffness, member, preload] = BOLT;
    let (mut tightened, mut loaded, mut linear, mut openings) = (0.0, 0.0, 0.0, Vec::new());
    let (mut energies, mut open) = (Vec::new(), 0);
    run(&scene, "bolt", |simulation, probes, _| {
        let time = simulation.state().time;
        let force = probe(probes, "bolt", simulation)[2];
        if time <= 1.0 {
            tightened = larger(tightened, (force - preload * time).abs() / preload);
            return;
        }
        openings.push(probe(probes, "opening", simulation)[0]);
        if time <= 4.0 {
            let load = if time <= 3.0 { 3.0 * (time - 1.0) } else { 6.0 - 4.0 * (time - 3.0) };
            let (expected, is_clamped) = clamped(load);
            loaded = larger(loaded, (force - expected).abs() / preload);
            if is_clamped {
                let share = load * stiffness / (stiffness + member);
                linear = larger(linear, (force - preload - share).abs() / share.max(1e-3));
            } else {
                open += 1;
            }
        } else {
            energies.push(simulation.balance().total());
        }
    })?;
    let spread = |values: &[f64]| {
        let first = values.first().copied().unwrap_or(f64::NAN);
        values.iter().fold(0.0, |most, v| larger(most, (v - first).abs()))
    };
    check(findings, case, "force less the given one until the lock, over the preload", tightened, Bound::AtMost(EXACT));
    let note = format!("the member is free in {open} load steps");
    noted(findings, case, "force less that of rods in series, over the preload", loaded, Bound::AtMost(EXACT), note);
    // The tangent of a rod is E A (1 + 3 e) at the strain e.
    let strains = 3.0 * preload * (1.0 / stiffness + 1.0 / member);
    let note = "linear springs; bound: three times the strains of the preload";
    noted(
        findings,
        case,
        "force less F + P k_b / (k_b + k_m), over the share of P",
        linear,
        Bound::AtMost(strains),
        note,
    );
    let stays = spread(&openings) / openings.first().map_or(f64::NAN, |o| o.abs());
    check(findings, case, "change of the cut after the lock, over its closing", stays, Bound::AtMost(EXACT));
    let stored = 0.5 * preload * preload * (1.0 / stiffness + 1.0 / member);
    let drift = spread(&energies) / stored;
    noted(
        findings,
        case,
        "drift of energy after the lock",
        drift,
        Bound::AtMost(super::ENERGY),
        format!("{} steps", energies.len()),
    );
    Ok(())
}

/// A free body under a moment that is fixed in space: `J(t) = J_0 + m t`, and the work is the change of the energy.
fn free_body(findings: &mut Findings) -> Outcome<()> {
    let case = "moment on a free body";
    let (inertia, spin, moment) = ([0.3, 0.2, 0.4], [1.0, 2.0, -3.0], [0.4, -0.2, 0.3]);
    let scene: Table = format!(
        r#"
        scene = {{ title = "free body", kind = "dynamic" }}
        time = {{ end = 10.0, step = 0.05, integrator = {{ scheme = "energy-momentum" }} }}
        rigid = [{{ name = "body", mass = 2.0, inertia = {inertia:?}, angular_velocity = {spin:?} }}]
        load = [{{ set = "body.all", moment = {moment:?} }}]
        probe = [{{ name = "j", quantity = "angular_momentum", body = "body" }}]
        "#
    )
    .parse()?;
    let kinetic: f64 = (0..3).map(|i| 0.5 * inertia[i] * spin[i] * spin[i]).sum();
    let (mut momentum, mut energy, mut size, mut most) = (0.0, 0.0, 0.0, 0.0);
    run(&scene, "moment", |simulation, probes, _| {
        let time = simulation.state().time;
        let expected: [f64; 3] = std::array::from_fn(|i| inertia[i] * spin[i] + moment[i] * time);
        momentum = larger(momentum, apart(probe(probes, "j", simulation), expected));
        size = larger(size, expected.iter().map(|j| j * j).sum::<f64>().sqrt());
        energy = larger(energy, (simulation.balance().total() - kinetic).abs());
        most = larger(most, simulation.balance().kinetic);
    })?;
    check(findings, case, "angular momentum less J_0 + m t", momentum / size, Bound::AtMost(super::MOMENTUM));
    check(findings, case, "energy less work of the moment", energy / most, Bound::AtMost(super::ENERGY));
    Ok(())
}

/// A cantilever under `[[load]] moment = 2 pi EI / L` becomes a circle.
fn roll_up(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let case = "roll-up by a load";
    let (length, stiffness) = (10.0, 2.0);
    let moment = TAU * stiffness / length;
    let (mut gaps, mut reaction) = ([f64::NAN; 2], 0.0);
    for (gap, elements) in gaps.iter_mut().zip(if quick { [5, 10] } else { [10, 20] }) {
        let scene: Table = format!(
            r#"
            scene = {{ title = "roll-up", kind = "quasi-static" }}
            time = {{ end = 1.0, step = 0.05 }}
            load = [{{ set = "beam.end", moment = {{ table = [[0.0, 0, 0, 0], [1.0, 0, 0, {moment:?}]] }} }}]
            joint = [{{ name = "clamp", kind = "weld", between = ["ground", "beam.start"], at = [0, 0, 0] }}]
            probe = [
                {{ name = "end", quantity = "position", set = "beam.end" }},
                {{ name = "m", quantity = "joint_moment", joint = "clamp" }},
            ]
            [[beam]]
            name = "beam"
            points = [[0, 0, 0], [{length:?}, 0, 0]]
            elements = {elements}
            order = 2
            up = [0, 0, 1]
            section = {{ axial = 1e4, shear = [5e3, 5e3], bending = [{stiffness:?}, {stiffness:?}], torsion = 1.5 }}
            "#
        )
        .parse()?;
        run(&scene, "roll-up", |simulation, probes, _| {
            *gap = apart(probe(probes, "end", simulation), [0.0; 3]) / length;
            let time = simulation.state().time;
            reaction = larger(reaction, apart(probe(probes, "m", simulation), [0.0, 0.0, moment * time]) / moment);
        })?;
    }
    let note = format!("gap of the ends over the length {:.2e} and {:.2e}", gaps[0], gaps[1]);
    // The bound of the mesh for elements of order 2.
    noted(findings, case, "order in the mesh, elements of order 2", order(gaps), Bound::AtLeast(3.8), note);
    check(findings, case, "moment of the clamp less the load", reaction, Bound::AtMost(1e-8));
    Ok(())
}

/// A block on rollers whose top is welded to a rigid body that is drawn up; force of the joint, force of the rollers, moment of the joint.
fn pulled(coupling: &str, poisson: f64, lift: f64) -> Outcome<[[f64; 3]; 3]> {
    let scene: Table = format!(
        r#"
        scene = {{ title = "driven block", kind = "quasi-static" }}
        time = {{ end = 1.0, step = 0.25 }}
        body = [{{ name = "block", mesh = {{ generator = "block", min = [-0.5, -1, 0], max = [0.5, 1, 3], divisions = [2, 3, 4] }}, material = {{ law = "saint-venant-kirchhoff", young = 1000.0, poisson = {poisson:?} }} }}]
        rigid = [{{ name = "handle" }}]
        joint = [{{ name = "grip", kind = "weld", between = ["handle", "block.top"], at = [0, 0, 3], coupling = "{coupling}" }}]
        prescribe = [
            {{ set = "block.bottom", components = ["z"], fixed = true }},
            {{ rigid = "handle", components = ["z"], displacement = {{ table = [[0.0, 0.0], [1.0, {lift:?}]] }} }},
        ]
        probe = [
            {{ name = "force", quantity = "joint_force", joint = "grip" }},
            {{ name = "support", quantity = "reaction", set = "block.bottom" }},
            {{ name = "moment", quantity = "joint_moment", joint = "grip" }},
        ]
        "#
    )
    .parse()?;
    let mut found = [[f64::NAN; 3]; 3];
    run(&scene, "driven block", |simulation, probes, _| {
        found = ["force", "support", "moment"].map(|name| probe(probes, name, simulation));
    })?;
    Ok(found)
}

/// A prescribed handle pulls a block by a reference point. In the mean the top may contract, and stress is uniaxial and uniform, whatever Poisson's ratio; held as a rigid
/// plane it is so without contraction, and stiffer with it.
fn pull(findings: &mut Findings) -> Outcome<()> {
    let case = "driven reference point, pull";
    // Height 3, section 2, stretch 1.1.
    let expected = rod(2.0 * 1000.0, 1.1);
    let mut stiffer = f64::NAN;
    for (coupling, poisson) in [("distributing", 0.3), ("kinematic", 0.0), ("kinematic", 0.3)] {
        let [force, support, moment] = pulled(coupling, poisson, 0.3)?;
        // On the handle, the first side, acts the block's pull.
        let quantity = format!("{coupling}, ratio {poisson}: force less that of uniaxial stress, over it");
        if (coupling, poisson) == ("kinematic", 0.3) {
            stiffer = -force[2] / expected - 1.0;
        } else {
            check(findings, case, quantity, (-force[2] / expected - 1.0).abs(), Bound::AtMost(EXACT));
        }
        let sum = apart(force, support).max(moment.iter().fold(0.0, |most, m| larger(most, m.abs()))) / expected;
        let quantity = format!("{coupling}, ratio {poisson}: force less the sum of reactions, and moment, over it");
        check(findings, case, quantity, sum, Bound::AtMost(EXACT));
    }
    let note = "the top cannot contract";
    noted(findings, case, "kinematic, ratio 0.3: more force than uniaxial stress", stiffer, Bound::AtLeast(1e-3), note);
    Ok(())
}

/// A motor in a hinge at a reference point twists a cylinder of the radius 1 and the length 4 that is clamped at the other end: torque over `G pi R^4 / 2 theta / L`, less 1, and the torque less the
/// moment of the reactions, over it.
fn twisted(coupling: &str, elements: usize) -> Outcome<[f64; 2]> {
    let (young, poisson, degrees) = (1000.0, 0.25, 0.1);
    let scene: Table = format!(
        r#"
        scene = {{ title = "twisted cylinder", kind = "quasi-static" }}
        time = {{ end = 1.0, step = 0.5 }}
        body = [{{ name = "bar", mesh = {{ generator = "cylinder", radius = 1.0, length = 4.0, divisions = [{elements}, {elements}, {elements}, {along}] }}, material = {{ law = "saint-venant-kirchhoff", young = {young:?}, poisson = {poisson:?} }} }}]
        joint = [{{ name = "motor", kind = "hinge", between = ["ground", "bar.back"], at = [0, 4, 0], axis = [0, 1, 0], coupling = "{coupling}", motor = {{ angle = {{ table = [[0.0, 0.0], [1.0, {degrees:?}]] }} }} }}]
        prescribe = [{{ set = "bar.front", components = ["x", "y", "z"], fixed = true }}]
        probe = [
            {{ name = "torque", quantity = "joint_moment", joint = "motor" }},
            {{ name = "force", quantity = "joint_force", joint = "motor" }},
            {{ name = "support", quantity = "reaction_moment", set = "bar.front" }},
        ]
        "#,
        along = 2 * elements,
    )
    .parse()?;
    let (shear, angle) = (young / (2.0 * (1.0 + poisson)), f64::to_radians(degrees));
    let expected = shear * 0.5 * PI * angle / 4.0;
    let mut found = [f64::NAN; 2];
    run(&scene, "twisted cylinder", |simulation, probes, _| {
        let [torque, force, support] = ["torque", "force", "support"].map(|name| probe(probes, name, simulation));
        // About the origin of what the bar does to the ground, at (0, 4, 0).
        let about: [f64; 3] = [torque[0] + 4.0 * force[2], torque[1], torque[2] - 4.0 * force[0]];
        // The bar is in balance: what ground gets at the joint, the supports give.
        found = [-torque[1] / expected - 1.0, apart(about, support) / expected];
    })?;
    Ok(found)
}

/// Torsion of a cylinder, in which sections stay plane: both couplings tend to the same torque.
fn torsion(quick: bool, findings: &mut Findings) -> Outcome<()> {
    let case = "driven reference point, torsion";
    let meshes = if quick { [2, 4] } else { [3, 6] };
    for coupling in ["kinematic", "distributing"] {
        let [coarse, fine] = [twisted(coupling, meshes[0])?, twisted(coupling, meshes[1])?];
        let note = format!(
            "{:.2e} with {} elements over the radius of the core, {:.2e} with {}",
            coarse[0], meshes[0], fine[0], meshes[1]
        );
        let quantity = format!("{coupling}: order of the torque in the mesh");
        noted(
            findings,
            case,
            &quantity,
            order([coarse[0].abs(), fine[0].abs()]),
            Bound::AtLeast(super::ORDER - 0.2),
            note,
        );
        let quantity = format!("{coupling}: error of the torque");
        check(findings, case, quantity, fine[0].abs(), Bound::AtMost(if quick { 0.05 } else { 0.02 }));
        let quantity = format!("{coupling}: torque less the moment of the reactions, over it");
        check(findings, case, quantity, larger(coarse[1], fine[1]), Bound::AtMost(EXACT));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The force of a bolt: before separation near `F + P k_b / (k_b + k_m)`, and without a load the preload; after it the load.
    #[test]
    fn bolts_by_hand() {
        let (force, is_clamped) = clamped(0.0);
        assert!((force - 4.0).abs() < 1e-12 && is_clamped);
        let (force, is_clamped) = clamped(1.2);
        assert!((force - 4.2).abs() < 0.02 && is_clamped);
        assert_eq!(clamped(6.0), (6.0, false));
        // 0.5 * 2 * 1.1 * 0.21.
        assert!((rod(2.0, 1.1) - 0.231).abs() < 1e-15);
    }
}
