//! The TRAIT [`Term`] of whatever adds to the equations of a step: beams, springs, loads, joints, ties, contact. What it is told ([`StepContext`], [`At`]), what it hands out ([`Local`]), what it
//! says of itself ([`Work`], reports).
//!
//! A contribution is a [`Local`]: rows and columns of the vectors and multipliers that it joins. Nobody who implements a term sees a matrix, an iteration or a file, and nobody who solves a step knows a
//! kind of term.
//!
//! # How to add a term
//! Implement [`Term`]: a name, a length, `stencils`, `assemble`, and `energy` or `work`. `docs/how-to-add/term.md` has the steps, with an example.
//!
#![doc = include_str!("../README.md")]

mod at;
mod bilateral;
pub mod check;
mod directors;
mod fault;
mod local;
mod partition;
mod potential;
mod reference_gap;
mod report;
mod share;
mod step;
mod term;
mod unilateral;
mod vectors;

pub use at::{At, Rule, StepConfiguration};
pub use bilateral::{Bilateral, SlotKind};
pub use directors::angular_velocity;
pub use fault::{Fault, Undefined};
pub use local::{Auxiliary, Local, multipliers_of};
pub use partition::bisect;
pub use potential::{BodyPair, Potential, SurfaceForce, SurfaceNode};
pub use reference_gap::{ClosingFriction, Overlap, ReferenceGap, ReferenceGapOptions};
pub use report::{
    Coverage, JointCoordinate, JointReport, JointTorques, MaterialWork, SlotFriction, SlotReport, SupportedNode, Work,
};
pub use share::Share;
pub use step::{HeldNodes, Hold, StepContext};
pub use stoss_integrators::{ForceRule, GradientRule};
pub use term::Term;
pub use unilateral::Unilateral;
pub use vectors::Vectors;
