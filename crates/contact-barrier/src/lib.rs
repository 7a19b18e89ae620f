//! Barrier contact: forces of pairs of primitives whose work is, over any step, exactly the change of their energy, and general contact as a sum over them.
//!
//! Each pair of a vertex and a triangle, or of two edges, has the potential `V = w m psi(D)` of its squared distance `D`
//! (theory/barrier). There is no slave and no master, no slot and no active set.
//!
//! * [`Layer`]: the barrier `psi`, its derivatives and its divided difference;
//! * [`EdgeMollifier`]: the factor `m` that fades pairs of nearly parallel edges out;
//! * [`PairStart`], [`PairForce`]: the force of a pair between two states, or at one, with tangent;
//! * [`PairFriction`], [`FrictionForce`]: friction of a pair in a step;
//! * [`Skin`]: vertices, edges, triangles and points of integration of all bodies, with their weights;
//! * [`Interactions`]: who acts on whom, how stiff, with which friction;
//! * [`check_initial`]: surfaces that cross before the first step, and the smallest distances;
//! * [`start`]: the skin for the start: its thickness, and surfaces that go inside where bodies touch;
//! * [`Overlaps`]: bodies that overlap, and how far they have to be moved; [`separate`]: motions that take them apart;
//! * [`GeneralContact`]: the sum, as a potential of the solver, with the collision detection that keeps iterates from passing through each other.
//!
//! Signs: a `gradient` is that of an energy, to be added to a residual; the force on the nodes is minus it.
//!
#![doc = include_str!("../README.md")]

mod general;
mod initial;
mod inset;
mod interactions;
mod layer;
mod mollifier;
mod overlap;
mod pair;
mod pattern;
mod proximity;
mod sensitivity;
mod separate;
mod skin;
mod slip;
mod start;
mod tangent;

pub use general::{GeneralContact, GeneralOptions};
pub use initial::{InitialCheck, Nearest, check_initial};
pub use inset::{Facing, mitre};
pub use interactions::{Interaction, Interactions};
pub use layer::Layer;
pub use mollifier::EdgeMollifier;
pub use overlap::{Overlaps, Relation, Separation};
pub use pair::{PairForce, PairStart, PairTerm, StepForce};
pub use separate::{SeparationFault, separate};
pub use skin::{Skin, SkinFacet, is_closed};
pub use slip::{FrictionForce, PairFriction, Presliding};
pub use start::{Bodies, Nearer, ONE_SIDED, Start, StartError, StartFault, THICKNESS, THINNEST, layer_edge, start};
pub use tangent::Tangent;
