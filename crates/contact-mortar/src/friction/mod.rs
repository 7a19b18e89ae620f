//! Friction of the slave nodes: slip and force as functions of gap vectors in `slip`, frames of the tractions in `frames`, one node in a step in `node`; here what a
//! surface keeps from step to step.

mod frames;
mod node;
mod slip;

pub(crate) use frames::MaterialFrames;
pub(crate) use node::{FrictionState, NodeFriction, Scratch};
pub use slip::SlipMeasure;

use stoss_contact::friction::{Friction, PointIteration};
use stoss_term::SlotFriction;

/// A node of which less than this part is covered at the start of a step of the end point.
pub(crate) const SLIVER: f64 = 0.05;

/// Friction of a whole surface.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceFriction {
    pub friction: Friction,
    pub measure: SlipMeasure,
    pub frames: MaterialFrames,
    pub step_size: f64,
    pub points: Vec<PointHistory>,
    /// Compliance of the stick of each node, in multiples of one over the stiffness.
    pub compliance: Vec<f64>,
    /// Whether all nodes have one, whatever else acts on them.
    pub is_compliant: bool,
    /// Nodes of which less than [`SLIVER`] is covered at the start of a step of the end point. Exact stick is replaced by a spring that forgets there: the
    /// slip of a sliver at the rim of the master is the motion of the rim, and a multiplier would need a traction out of all proportion to hold it.
    pub slivers: Vec<bool>,
}

/// History of one slot. Tractions have the components that they had at the start: the frame follows the slave's material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PointHistory {
    /// Traction at the end of the last accepted step.
    pub committed: [f64; 2],
    /// Path slid in this contact.
    pub slid: f64,
    /// Covered area that the committed traction belongs to.
    pub support: f64,
    /// Traction that the step starts with.
    pub start: [f64; 2],
    /// What the multipliers of [`stoss_contact::friction::Stick::Multiplier`] add to it.
    pub multiplier: [f64; 2],
    /// Iteration of the friction of this step.
    pub iteration: PointIteration,
    /// What the last accepted step came to.
    pub last: Option<SlotFriction>,
}
