//! Node-to-surface contact: direct form and energy-momentum element (theory/node-to-surface).
//!
//! * [`kinematics`]: gap of a node to an extended facet, first and second variation;
//! * [`invariants`]: the frictionless energy-momentum element with 17 invariants, its local unknowns eliminated;
//! * [`crossing`]: the element for a step from one facet to another;
//! * the normal part by multiplier, penalty or augmented Lagrangian ([`stoss_contact::Enforcement`]);
//! * friction in the direct form, also with the energy-momentum element ([`NodeToSurface::with_friction`]);
//! * [`NodeToSurface`]: all of them as a [`stoss_term::Unilateral`];
//! * [`augmented`]: the coordinate augmentation technique (theory/coordinate-augmentation) on the same pairings, laws and histories.
//!
//! The crate knows neither solids nor the global system.
//!
#![doc = include_str!("../README.md")]

mod arches;
pub mod augmented;
pub mod crossing;
mod dual;
mod friction;
mod gap_gradient;
pub mod invariants;
pub mod kinematics;
mod method;
mod normal;
mod options;
mod slave;
mod slot;

pub use arches::Arches;
pub use augmented::{CoordinateAugmented, Reduction};
pub use method::NodeToSurface;
pub use options::{ConstraintForm, NodeToSurfaceOptions};
