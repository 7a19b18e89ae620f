//! Bodies in contact whose stiffness or density differ by a factor of a million.

use super::super::case::{CONTACT, Case, Oracle, Touch, Word};
use super::super::evidence::Evidence;
use super::super::scene::{Block, Matter, Scene};
use super::closed_forms::stack;
use super::solids::STATIC;
use crate::workspace::Outcome;

/// A block that falls on a larger one: gap, velocity, materials of the lower and the upper, step and number of steps.
#[derive(Clone, Copy, Debug)]
pub struct Fall {
    /// Gap at the start.
    pub gap: f64,
    /// Velocity of the upper block.
    pub velocity: [f64; 3],
    /// Materials of the lower and the upper block.
    pub matter: [Matter; 2],
    /// Step size.
    pub step: f64,
    /// Number of steps.
    pub steps: u32,
}

impl Fall {
    /// The scene: 2 x 2 x 1 below, a unit cube above. The meshes do not match.
    pub fn scene(&self, (scheme, constraint): (&str, &str)) -> Scene {
        let lower = Block { min: [-1.0, -1.0, -1.0], max: [1.0, 1.0, 0.0], divisions: [3, 3, 1] };
        let upper = Block { min: [-0.5, -0.5, self.gap], max: [0.5, 0.5, self.gap + 1.0], divisions: [2, 2, 2] };
        Scene::new(Some(scheme), self.step, self.steps, 10)
            .block("lower", lower, self.matter[0], [0.0; 3])
            .block("upper", upper, self.matter[1], self.velocity)
            .contact("upper.bottom", "lower.top", constraint)
    }

    /// Every combination; the upper block is the slave.
    pub fn cases(&self, family: &str) -> Vec<Case> {
        CONTACT.map(|combination| Case::contact(family, combination, self.scene(combination), Touch::UPPER)).into()
    }
}

/// Two blocks one upon the other, pressed together; Poisson's ratio is 0, so that nothing moves sideways.
fn pressed(family: &str, young: [f64; 2]) -> Case {
    let [lower, upper] = young.map(|young| Matter::new(young, 1.0).poisson(0.0));
    let block = |z: f64| Block { min: [0.0, 0.0, z], max: [1.0, 1.0, z + 1.0], divisions: [2, 2, 2] };
    let mut scene = Scene::new(None, 0.1, 10, 10)
        .block("lower", block(0.0), lower, [0.0; 3])
        .block("upper", block(1.0), upper, [0.0; 3])
        .contact("upper.bottom", "lower.top", "standard")
        .fixed("lower.bottom", &["z"])
        .pulled("upper.top", "z", -0.3);
    for body in ["lower", "upper"] {
        scene = scene.fixed(&format!("{body}.left"), &["x"]).fixed(&format!("{body}.front"), &["y"]);
    }
    let scene = scene.probe("f", "upper.top", "reaction").probe("joint", "upper.bottom", "displacement");
    let (stretch, stress) = stack(&lower, &upper, 1.7);
    let error = move |evidence: &Evidence| -> Outcome<f64> {
        let force = (evidence.probe("f.z")? / stress - 1.0).abs();
        Ok(force.max((evidence.probe("joint.z")? - (0.7 - stretch)).abs()))
    };
    let about = "force (relative) and displacement of the joint against two springs in series";
    let oracle = Oracle::Closed { about, error: Box::new(error), bound: STATIC, otherwise: Word::Drifts };
    Case { touch: Some(Touch::UPPER), ..Case::new(family, None, scene, oracle) }
}

/// All of them.
pub fn cases() -> Vec<Case> {
    let fall = |lower: Matter, upper: Matter| Fall {
        gap: 0.02,
        velocity: [0.05, 0.03, -1.0],
        matter: [lower, upper],
        step: 0.005,
        steps: 40,
    };
    let (soft, stiff, heavy) = (Matter::new(1e3, 1.0), Matter::new(1e9, 1.0), Matter::new(1e3, 1e6));
    let mut cases =
        vec![pressed("stiffness 1e6, stiff slave", [1e3, 1e9]), pressed("stiffness 1e6, soft slave", [1e9, 1e3])];
    cases.extend(fall(soft, stiff).cases("stiffness 1e6, stiff slave"));
    cases.extend(fall(stiff, soft).cases("stiffness 1e6, soft slave"));
    cases.extend(fall(heavy, soft).cases("density 1e6, light slave"));
    cases.extend(fall(soft, heavy).cases("density 1e6, heavy slave"));
    cases
}
