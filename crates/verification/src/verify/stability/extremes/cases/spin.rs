//! A stiff body that turns ten times, against the rigid body.

use std::f64::consts::PI;

use super::super::case::{Case, FREE, Oracle, Word};
use super::super::evidence::Evidence;
use super::super::scene::{Block, Matter, Scene};
use crate::workspace::Outcome;

/// Edges 1, 1, 2: moments of inertia `m (1 + 4)/12` about x and y, `m (1 + 1)/12` about z.
const BLOCK: Block = Block { min: [-0.5, -0.5, -1.0], max: [0.5, 0.5, 1.0], divisions: [1, 1, 2] };

/// Ratio of the moments of inertia about x and z.
const INERTIA: f64 = 2.5;

/// So stiff that the centrifugal forces change the moments of inertia by about 1e-5.
const MATTER: Matter = Matter { law: "neo-hooke", young: 1e7, poisson: 0.3, density: 1.0 };

const REVOLUTIONS: f64 = 10.0;

const STEPS: u32 = 600;

/// Angle by which a second-order scheme may be late: the midpoint rule turns a rigid body by `2 atan(omega dt / 2)` a step.
fn late(angle: f64) -> f64 {
    let step = angle / f64::from(STEPS);
    1.05 * f64::from(STEPS) * (step - 2.0 * (0.5 * step).atan())
}

fn scene(scheme: &'static str, omega: [f64; 3], end: f64) -> Scene {
    let speed = 1.3 * omega.iter().map(|w| w * w).sum::<f64>().sqrt();
    let motion = format!("angular_velocity = {omega:?}\n");
    Scene::new(Some(scheme), end / f64::from(STEPS), STEPS, 10)
        .frames(60)
        .moving("b", BLOCK, MATTER, &motion, speed)
        .probe("top", "b.top", "position")
        .probe("bottom", "b.bottom", "position")
        .also("\n[[probe]]\nname = \"corner\"\nbody = \"b\"\npoint = [0.5, 0.5, 1.0]\nquantity = \"position\"\n")
}

/// Ten revolutions about z: the corner is where it was.
fn axis(scheme: &'static str) -> Case {
    let omega = 2.0 * PI;
    let error = |evidence: &Evidence| -> Outcome<f64> {
        let (x, y) = (evidence.probe("corner.x")?, evidence.probe("corner.y")?);
        Ok((y.atan2(x) - 0.25 * PI).abs())
    };
    let about = "angle between the last and the first orientation; bound: phase error of the midpoint rule";
    let bound = late(2.0 * PI * REVOLUTIONS);
    let oracle = Oracle::Closed { about, error: Box::new(error), bound, otherwise: Word::Drifts };
    Case::new("ten revolutions about an axis", Some(scheme), scene(scheme, [0.0, 0.0, omega], REVOLUTIONS), oracle)
}

/// Ten precessions of the symmetric top, one each `2 pi I / |J|`: its axis is where it was.
fn top(scheme: &'static str) -> Case {
    let omega = [1.2 * PI, 0.0, 1.6 * PI];
    let momentum = (INERTIA * omega[0]).hypot(omega[2]);
    let end = REVOLUTIONS * 2.0 * PI * INERTIA / momentum;
    let error = |evidence: &Evidence| -> Outcome<f64> {
        let axis =
            ["x", "y", "z"].map(|c| Ok(evidence.probe(&format!("top.{c}"))? - evidence.probe(&format!("bottom.{c}"))?));
        let [x, y, z] = axis.map(|c: Outcome<f64>| c);
        let (x, y, z) = (x?, y?, z?);
        Ok(x.hypot(y).atan2(z))
    };
    let about = "angle between the last and the first axis; bound: phase error of the midpoint rule";
    // The axis precesses with |J|/I about J and is inclined to it.
    let inclined = INERTIA * omega[0] / momentum;
    let rate = 2.0 * PI * end;
    let oracle =
        Oracle::Closed { about, error: Box::new(error), bound: late(rate) * inclined, otherwise: Word::Drifts };
    Case::new("ten precessions of a top", Some(scheme), scene(scheme, omega, end), oracle)
}

/// All of them.
pub fn cases() -> Vec<Case> {
    FREE.map(axis).into_iter().chain(FREE.map(top)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_phase_error_is_of_third_order_a_step() {
        let step = 2.0 * PI * REVOLUTIONS / f64::from(STEPS);
        let leading = f64::from(STEPS) * step.powi(3) / 12.0;
        assert!((late(2.0 * PI * REVOLUTIONS) / leading / 1.05 - 1.0).abs() < 0.01);
    }
}
