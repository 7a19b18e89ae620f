//! Random scenes with nothing named: two to four blocks and balls of several stiffnesses, anyhow turned, fly into each other.
//!
//! They are those of the suite `random` in kind, but general contact is all that keeps bodies apart, and the bounds are its own.

use fastrand::Rng;

use super::judge::{LEDGER, figures, run};
use super::scene::{Body, Scene};
use crate::verify::check::{Bound, Check, number};
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;

/// Seeds in quick mode and in the full run.
const SEEDS: [u64; 2] = [5, 100];

/// Largest change of momenta.
const MOMENTA: f64 = 1e-11;

/// Part of the scenes that must come to their end, of those in which bodies close in by less than [`FAST`].
const FINISHED: f64 = 0.99;

/// Closing speed, in speeds of waves of the softest material there is, from which on an impact crushes coarse elements, whatever the contact does.
const FAST: f64 = 0.6;

/// Runs them.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let case = "random scenes";
    let first = bench.random.seed;
    let seeds = first..first + if bench.quick { SEEDS[0] } else { SEEDS[1] };
    // Runs and finished runs, slow and fast.
    let (mut runs, mut done, mut hits) = ([0.0; 2], [0.0; 2], 0.0);
    let (mut ledger, mut momenta, mut intersections) = ((0.0, 0), (0.0, 0), 0.0);
    let (mut stops, mut unexplained, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    for seed in seeds {
        let (scene, closing) = scene(seed);
        let kind = usize::from(closing > FAST);
        let launched = run(bench, &format!("random-{seed}"), &scene)?;
        runs[kind] += 1.0;
        if launched.run.ending.code == Some(3) {
            let sentence = launched.run.folder.join("diagnosis.json");
            let cause = std::fs::read_to_string(&sentence).ok().and_then(|text| {
                let diagnosis: serde_json::Value = serde_json::from_str(&text).ok()?;
                Some(diagnosis["findings"][0]["cause"].as_str()?.to_owned())
            });
            match cause {
                Some(cause) if cause != "unknown" => stops.push(format!("seed {seed}: {cause}")),
                _ => {
                    stops.push(format!("seed {seed}"));
                    unexplained.push(format!("seed {seed}"));
                }
            }
        } else if launched.run.succeeded() {
            done[kind] += 1.0;
        } else {
            wrong.push(format!("seed {seed}: {}", launched.log.lines().last().unwrap_or_default()));
            continue;
        }
        let found = figures(&launched.run, &scene)?;
        hits += f64::from(u8::from(found.distance.is_finite()));
        intersections += found.intersections;
        if found.intersections > 0.0 {
            wrong.push(format!("seed {seed}: {}", launched.run.reasons()));
        }
        let worse =
            |worst: (f64, u64), value: f64| if value > worst.0 || value.is_nan() { (value, seed) } else { worst };
        ledger = worse(ledger, found.ledger);
        momenta = worse(momenta, found.momenta);
    }
    let mut row = |quantity: &str, measured: f64, bound: Bound, note: String| {
        findings.checks.push(Check::new(case, quantity, measured, bound).noted(note));
    };
    row("scenes", runs[0] + runs[1], Bound::Unbounded, format!("{} with contact", number(hits)));
    row("intersections by the watch", intersections, Bound::AtMost(0.0), wrong.join("; "));
    row("neither finished nor stopped with a reason", wrong.len() as f64, Bound::AtMost(0.0), wrong.join("; "));
    let note = format!("{} scenes; all that stopped: {}", runs[0], stops.join("; "));
    row("closing speed below 0.6: part that finished", done[0] / runs[0], Bound::AtLeast(FINISHED), note);
    if runs[1] > 0.0 {
        let note = format!("{} scenes; elements are crushed", runs[1]);
        row("closing speed above 0.6: part that finished", done[1] / runs[1], Bound::Unbounded, note);
    }
    row("stops without diagnosis", unexplained.len() as f64, Bound::AtMost(0.0), unexplained.join("; "));
    row("energy and losses, change", ledger.0, Bound::AtMost(LEDGER), format!("seed {}", ledger.1));
    row("momenta, change", momenta.0, Bound::AtMost(MOMENTA), format!("seed {}", momenta.1));
    Ok(())
}

/// The scene of a seed, and the largest speed at which two of its bodies close in.
fn scene(seed: u64) -> (Scene, f64) {
    let mut random = Rng::with_seed(seed);
    let count = [2, 2, 3, 4][random.usize(..4)];
    let step = [0.05, 0.1, 0.2][random.usize(..3)];
    let friction = [0.0, 0.0, 0.3, 0.8][random.usize(..4)];
    let mut uniform = |low: f64, high: f64| low + (high - low) * random.f64();
    let mut scene = Scene::dynamic(step, 8.0).watched(1);
    let (mut slowest, mut fastest) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..count {
        let place = f64::from(k) - 0.5 * (f64::from(count) - 1.0);
        let name = format!("b{k}");
        let size = [0; 3].map(|_| uniform(0.5, 1.2));
        let divisions = [0; 3].map(|_| uniform(1.0, 4.0) as u32);
        let ball = "{ generator = \"hollow-ball\", inner_diameter = 0.6, outer_diameter = 1.1, divisions = [2, 1] }";
        let body = if uniform(0.0, 1.0) < 0.7 {
            Body::block(&name, size, divisions)
        } else {
            Body::generated(&name, ball, std::f64::consts::PI / 6.0 * (1.1_f64.powi(3) - 0.6_f64.powi(3)))
        };
        let axis = [0; 3].map(|_| uniform(-1.0, 1.0));
        let young = [1.0, 1.0, 10.0, 100.0][uniform(0.0, 4.0) as usize];
        let body = body.turned(axis, uniform(-180.0, 180.0)).young(young);
        let body = body.at([2.3 * place, uniform(-0.25, 0.25), uniform(-0.25, 0.25)]);
        let velocity = [-0.2 * place * uniform(0.8, 2.0), uniform(-0.08, 0.08), uniform(-0.08, 0.08)];
        (slowest, fastest) = (slowest.min(velocity[0]), fastest.max(velocity[0]));
        scene = scene.body(body.velocity(velocity));
    }
    (scene.general(&format!("friction = {friction:?}")), fastest - slowest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_the_same_scene_and_another_one_another() {
        for seed in 0..20 {
            assert_eq!(scene(seed).0.text, scene(seed).0.text);
            assert_ne!(scene(seed).0.text, scene(seed + 20).0.text);
            assert!(stoss_scene::parse(&scene(seed).0.text, "random").is_ok());
        }
    }
}
