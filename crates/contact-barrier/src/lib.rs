//! Barrier contact: forces of pairs of primitives whose work is, over any step, exactly the change of their energy.
//!
//! Each pair of a vertex and a triangle, or of two edges, has the potential `V = w m psi(D)` of its squared distance `D`
//! (`docs/theory/barrier.md`). There is no slave and no master, no slot and no active set. This crate has what one pair does:
//!
//! * [`Layer`]: the barrier `psi`, its derivatives and its divided difference;
//! * [`Parallel`]: the factor `m` that fades pairs of nearly parallel edges out;
//! * [`PairStart`], [`PairForce`]: the force of a pair between two states, or at one, with tangent;
//! * [`Friction`], [`FrictionForce`]: friction of a pair in a step.
//!
//! It is not a contact method: which pairs there are, their weights, and the collision detection that keeps iterates from passing through each other are the caller's
//! (`stoss-geometry` finds candidates and safe fractions).
//!
//! Signs: a `gradient` is that of an energy, to be added to a residual; the force on the nodes is minus it.

mod layer;
mod pair;
mod parallel;
mod sensitivity;
mod slip;

pub use layer::Layer;
pub use pair::{PairForce, PairStart, PairTerm, StepForce, Tangent};
pub use parallel::Parallel;
pub use slip::{Friction, FrictionForce};
