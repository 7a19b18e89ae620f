//! Gaps of nothing, impacts at the wave speed, and steps that jump over everything.

use super::super::case::{CONTACT, Case, Oracle, Touch, Word};
use super::super::evidence::Evidence;
use super::super::scene::{Block, Matter, Scene};
use super::contrast::Fall;
use crate::workspace::Outcome;

/// Displacement that counts as none, on bodies of size 1.
const AT_REST: f64 = 1e-12;

/// Two blocks that touch, without stress and velocity: nothing may happen.
fn at_rest(combination: (&'static str, &'static str)) -> Case {
    let matter = Matter::new(1e3, 1.0);
    let fall = Fall { gap: 0.0, velocity: [0.0; 3], matter: [matter; 2], step: 0.002, steps: 20 };
    // Drifts are measured against a speed of 1.
    let scene = fall.scene(combination).scales(0.0, 1.0, 0.0);
    let error = |evidence: &Evidence| -> Outcome<f64> {
        Ok(evidence.displacement.iter().fold(0.0, |largest, u| u.abs().max(largest)))
    };
    let oracle = Oracle::Closed {
        about: "largest displacement",
        error: Box::new(error),
        bound: AT_REST,
        otherwise: Word::Drifts,
    };
    let energy = Some(scene.mass);
    let case = Case::contact("gap 0 at rest", combination, scene, Touch::UPPER).against(oracle);
    Case { energy, ..case }
}

/// A soft cube hits a stiffer block at a multiple of its own wave speed; steps of a fifth of the time that its waves take
/// through half of it, and as much shorter as it is faster.
fn fast(multiple: f64) -> Fall {
    let (soft, stiff) = (Matter::new(1e3, 1.0), Matter::new(4e3, 1.0));
    let speed = soft.wave_speed();
    let step = 0.1 / (speed * (1.0 + multiple));
    Fall { gap: 0.02, velocity: [0.0, 0.0, -multiple * speed], matter: [stiff, soft], step, steps: 30 }
}

/// The first step, without contact, ends far below the master: the slave would be through gap and master.
fn jump(family: &str, combination: (&'static str, &'static str), thickness: f64, speed: f64, touch: Touch) -> Case {
    let (slave, master) =
        if touch == Touch::UPPER { ("upper.bottom", "lower.top") } else { ("lower.top", "upper.bottom") };
    let matter = Matter::new(1e3, 1.0);
    let lower = Block { min: [-2.0, -2.0, -thickness], max: [2.0, 2.0, 0.0], divisions: [4, 4, 1] };
    let upper = Block { min: [-0.5, -0.5, 1.0], max: [0.5, 0.5, 2.0], divisions: [2, 2, 2] };
    let scene = Scene::new(Some(combination.0), 1.0, 4, 10)
        .block("lower", lower, matter, [0.0; 3])
        .block("upper", upper, matter, [0.0, 0.0, -speed])
        .contact(slave, master, combination.1);
    Case::contact(family, combination, scene, touch)
}

/// All of them.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (family, gap) in [("gap 1e-9", 1e-9), ("gap 0", 0.0)] {
        let matter = [Matter::new(1e3, 1.0); 2];
        cases.extend(Fall { gap, velocity: [0.05, 0.03, -1.0], matter, step: 0.002, steps: 30 }.cases(family));
    }
    cases.extend(CONTACT.map(at_rest));
    cases.extend(fast(1.0).cases("impact at 1 wave speed"));
    cases.extend(fast(10.0).cases("impact at 10 wave speeds"));
    for (family, thickness, speed, touch) in [
        ("jump over gap and master", 1.0, 3.0, Touch::UPPER),
        ("jump over gap and thin plate", 0.2, 5.0, Touch::UPPER),
        ("jump of the master over a coarse slave", 1.0, 3.0, Touch::LOWER),
    ] {
        cases.extend(CONTACT.map(|combination| jump(family, combination, thickness, speed, touch)));
    }
    cases
}
