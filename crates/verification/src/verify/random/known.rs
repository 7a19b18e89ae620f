//! What is known of a random scene, and what its generators share.

use fastrand::Rng;

/// Largest number of steps of a scene.
pub const STEPS: u32 = 60;

/// What must come out of a scene, beside what holds of any.
#[derive(Clone, Debug, Default)]
pub struct Known {
    /// All that moving bodies touch is rigid and flat, with a normal along z.
    pub flat: bool,
    /// Body and motion are their own mirror images in the planes x = 0 and y = 0.
    pub mirrored: bool,
    /// Whether nothing moves.
    pub rest: bool,
    /// Speeds with which a rigid body comes, and with which it goes back by its restitution.
    pub rebound: Option<[f64; 2]>,
    /// Force on the part `tool` at the end.
    pub force: Option<f64>,
    /// Way of a tool beyond the gap.
    pub travel: Option<f64>,
}

/// Uniform between two numbers.
pub fn uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.f64()
}
