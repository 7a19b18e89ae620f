//! A rigid wheel on a deformable track, pressed by its weight: it skids and then rolls, or rolls from the start.

use super::noted;
use crate::verify::check::Bound;
use crate::verify::numbers::larger;
use crate::verify::run::Run;
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;
use std::f64::consts::PI;

/// Mass, radius and half of `m R^2`, the inertia of a full cylinder about its axis.
const WHEEL: [f64; 3] = [0.133, 0.5, 0.5 * 0.133 * 0.25];
/// Gravity, friction coefficient and width of the track.
const GRAVITY: f64 = 10.0;
const FRICTION: f64 = 0.3;
const WIDTH: f64 = 0.3;
/// Young's modulus and Poisson's ratio of the track, which is in plane strain.
const TRACK: [f64; 2] = [1000.0, 0.4];
/// End of the static stage, and of the run.
const TIMES: [f64; 2] = [1.0, 1.6];
/// Time from which on means are taken: the skid ends 0.17 after the static stage.
const ROLLS: f64 = 1.2;

/// Half width of the contact and largest pressure of a rigid cylinder on a half space in plane strain (Johnson, *Contact mechanics*, section 4.2).
fn of_hertz() -> (f64, f64) {
    let load = WHEEL[0] * GRAVITY / WIDTH;
    let a = (4.0 * load * WHEEL[1] * (1.0 - TRACK[1] * TRACK[1]) / (PI * TRACK[0])).sqrt();
    (a, 2.0 * load / (PI * a))
}

/// Largest strain of the surface along the track under that pressure, `(1 + nu) (1 - 2 nu) p0 / E`. The wheel rolls off a surface that is shorter by no more than that: the creep.
fn creep() -> f64 {
    (1.0 + TRACK[1]) * (1.0 - 2.0 * TRACK[1]) * of_hertz().1 / TRACK[0]
}

/// The scene with `fineness` times 22 elements along the track and 64 facets around the wheel.
fn scene(fineness: usize, speed: f64, spin: f64) -> String {
    let [mass, radius, inertia] = WHEEL;
    let [young, poisson] = TRACK;
    let (static_end, end) = (TIMES[0], TIMES[1]);
    let (along, high, around, step) = (22 * fineness, 3 * fineness, 64 * fineness, 0.005 / fineness as f64);
    format!(
        r#"
        scene = {{ title = "Rigid wheel on a deformable track", kind = "dynamic" }}
        time = {{ end = {end:?}, step = {step:?}, integrator = {{ scheme = "energy-momentum" }} }}
        gravity = {{ acceleration = [0.0, 0.0, {down:?}] }}
        stage = [
            {{ name = "press", kind = "quasi-static", until = {static_end:?}, step = 0.25 }},
            {{ name = "roll", kind = "dynamic", until = {end:?}, off = ["guide"] }},
        ]
        joint = [{{ name = "guide", kind = "slider", between = ["ground", "wheel"], at = [0, 0, {radius:?}], axis = [0, 0, 1] }}]
        prescribe = [
            {{ set = "track.bottom", components = ["x", "y", "z"], fixed = true }},
            {{ set = "track.front", components = ["y"], fixed = true }},
            {{ set = "track.back", components = ["y"], fixed = true }},
        ]
        contact = [{{ method = "nts", slave = "track.top", master = "wheel.side", friction = {{ law = "coulomb", mu = {FRICTION:?} }} }}]
        probe = [
            {{ name = "v", body = "wheel", quantity = "velocity" }},
            {{ name = "w", body = "wheel", quantity = "angular_velocity" }},
            {{ name = "f", body = "wheel", quantity = "contact_force" }},
        ]
        output = {{ every = 1000 }}
        [[body]]
        name = "track"
        mesh = {{ generator = "block", min = [-0.2, -0.15, -0.3], max = [0.9, 0.15, 0.0], divisions = [{along}, 1, {high}] }}
        material = {{ law = "neo-hooke", young = {young:?}, poisson = {poisson:?} }}
        density = 1.0
        [[rigid]]
        name = "wheel"
        shape = {{ kind = "cylinder", radius = {radius:?}, length = 0.4, divisions = [{around}, 1, 1] }}
        rotation = {{ axis = [1, 0, 0], degrees = 90 }}
        position = [0, 0, {radius:?}]
        mass = {mass:?}
        inertia = [{inertia:?}, {inertia:?}, {inertia:?}]
        velocity = [{speed:?}, 0, 0]
        angular_velocity = [0, {spin:?}, 0]
        "#,
        down = -GRAVITY
    )
}

/// What a run shows.
#[derive(Default)]
struct Seen {
    /// Largest difference of impulse and change of momentum in a step, over the momentum.
    impulse: f64,
    /// Largest change of energy and closing loss in a step, over the kinetic energy at the start.
    energy: f64,
    /// Impulses of friction and pressure while it skids.
    skid: [f64; 2],
    /// Means of speed, circumferential speed and pressure while it rolls, with a weight that fades in and out, so that oscillations do not count.
    mean: [f64; 3],
}

/// Skidding from 1.5 without spin, and rolling from 1.0.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let fineness = if bench.quick { 1 } else { 2 };
    for (name, speed, spin) in [("rolls", 1.0, 2.0), ("skids, then rolls", 1.5, 0.0)] {
        let case = format!("rigid wheel on a track, {name}");
        let table = scene(fineness, speed, spin).parse()?;
        let run =
            bench.run_variant(&format!("wheel-{}-{fineness}", if spin > 0.0 { "rolls" } else { "skids" }), &table)?;
        findings.checks.push(run.completed(0));
        let seen = look(&run, speed, spin)?;
        let weight = WHEEL[0] * GRAVITY;
        let verdict = run.verdict()?;
        let wrong = if verdict == "wrong" { 1.0 } else { 0.0 };
        noted(findings, &case, "wrong by the watch", wrong, Bound::Near { value: 0.0, tolerance: 0.0 }, verdict);
        let mut row = |quantity: &str, value, bound, note: String| noted(findings, &case, quantity, value, bound, note);
        row(
            "impulse of the contact and weight less the change of momentum in a step",
            seen.impulse,
            Bound::AtMost(1e-11),
            String::new(),
        );
        row(
            "largest change of energy, friction's work and closing loss counted, in a step",
            seen.energy,
            Bound::AtMost(super::ENERGY),
            String::new(),
        );
        let [v, rim, pressure] = seen.mean;
        let near_one = |tolerance| Bound::Near { value: 1.0, tolerance };
        let (a, p0) = of_hertz();
        let note = format!("bound: (1 + nu) (1 - 2 nu) p0 / E with a = {a:.4}, p0 = {p0:.1} of Hertz");
        row("speed over that of the rim, v / (omega R)", v / rim, near_one(creep()), note.clone());
        // Without spin, m v R + J omega about a point of the track stays: v = v_0 / (1 + J / m R^2).
        row("speed over the closed form, 1 or 2 v_0 / 3", v, near_one(creep()), note);
        row("pressure over the weight", pressure / weight, near_one(0.01), String::new());
        if spin == 0.0 {
            let [friction, normal] = seen.skid;
            row(
                "friction over pressure while it skids, over mu",
                -friction / normal / FRICTION,
                near_one(0.01),
                String::new(),
            );
        }
    }
    Ok(())
}

fn look(run: &Run, speed: f64, spin: f64) -> Outcome<Seen> {
    let [mass, radius, inertia] = WHEEL;
    let (probes, balance) = (run.table("probes.csv")?, run.table("balance.csv")?);
    let column = |name| probes.column(name);
    let (time, wy) = (column("time")?, column("w.y")?);
    let (vx, vz, fx, fz) = (column("v.x")?, column("v.z")?, column("f.x")?, column("f.z")?);
    let energy = (balance.column("total")?.iter().zip(balance.column("closing_loss")?)).map(|(e, l)| e + l);
    let energy: Vec<f64> = energy.collect();
    let first = time.iter().position(|t| *t > TIMES[0] + 1e-9).ok_or("no step of the dynamic stage")?;
    if energy.len() != time.len() || first == 0 {
        return Err("tables of the wheel do not have the same rows".into());
    }
    let kinetic = 0.5 * (mass * speed * speed + inertia * spin * spin);
    let skid_end = TIMES[0] + 0.8 * speed / (3.0 * FRICTION * GRAVITY);
    let (mut seen, mut total, mut before) = (Seen::default(), 0.0, [speed, 0.0]);
    for n in first..time.len() {
        let dt = time[n] - time[n - 1];
        let defect =
            [mass * (vx[n] - before[0]) - fx[n] * dt, mass * (vz[n] - before[1]) - (fz[n] - mass * GRAVITY) * dt];
        seen.impulse = larger(seen.impulse, defect[0].abs().max(defect[1].abs()) / (mass * speed));
        before = [vx[n], vz[n]];
        if n > first {
            seen.energy = larger(seen.energy, (energy[n] - energy[n - 1]).abs() / kinetic);
        }
        if time[n] < skid_end {
            seen.skid = [seen.skid[0] + fx[n] * dt, seen.skid[1] + fz[n] * dt];
        }
        if time[n] > ROLLS {
            let weight = dt * (PI * (time[n] - ROLLS) / (TIMES[1] - ROLLS)).sin().powi(2);
            total += weight;
            for (mean, value) in seen.mean.iter_mut().zip([vx[n], wy[n] * radius, fz[n]]) {
                *mean += weight * value;
            }
        }
    }
    seen.mean = seen.mean.map(|mean| mean / total);
    Ok(seen)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pressure `p0 sqrt(1 - x^2 / a^2)` carries the weight, and `p0 = E* a / 2 R`.
    #[test]
    fn closed_form_carries_the_weight() {
        let (a, p0) = of_hertz();
        assert!((0.5 * PI * a * p0 * WIDTH / (WHEEL[0] * GRAVITY) - 1.0).abs() < 1e-12);
        let modulus = TRACK[0] / (1.0 - TRACK[1] * TRACK[1]);
        assert!((p0 / (modulus * a / (2.0 * WHEEL[1])) - 1.0).abs() < 1e-12);
    }
}
