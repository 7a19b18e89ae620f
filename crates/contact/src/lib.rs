//! Contact surfaces, pair search, active-set data, and the trait of a contact discretisation.
//!
//! The stages are types that can be looked at: [`ContactSurface`] (facets, nodes, adjacency, nodal areas) ->
//! [`MasterSearch`] (tree over the master facets) -> [`MasterPoint`] (closest point, signed gap, which geometric case, pairing
//! facet) -> [`ActiveSetControl`] (which constraints are closed), [`Enforcement`] (their pressures) and [`friction`] (tangential tractions). A contact
//! discretisation implements [`ContactMethod`] on top of them, in a crate of its own.
//!
//! Not here: forces and tangents (they are a method's), the global system (the solver's), meshes' files.
//!
#![doc = include_str!("../README.md")]

pub mod active_set;
mod carriers;
mod contribution;
pub mod dual;
mod enforcement;
mod error;
pub mod friction;
pub mod line;
mod method;
mod position;
mod potential;
mod reference_gap;
mod report;
mod rim;
pub mod search;
mod step;
pub mod surface;
mod surface_tree;

pub use active_set::{ActiveSetControl, ActiveSetOutcome};
pub use carriers::Carriers;
pub use contribution::{Auxiliary, LocalContribution, StepConfiguration, multipliers_of};
pub use enforcement::{Enforcement, NormalRow};
pub use error::ContactError;
pub use line::ContactLine;
pub use method::{Bilateral, Constraint, ContactMethod, History, SlotKind};
pub use position::position;
pub use potential::{BodyPair, Potential, PotentialConstraint, SurfaceForce, SurfaceNode};
pub use reference_gap::{ClosingFriction, Overlap, ReferenceGap, ReferenceGapOptions};
pub use report::{
    ContactWork, Coverage, JointCoordinate, JointReport, JointTorques, Report, SlotFriction, SlotReport, SupportedNode,
};
pub use rim::beside_rims;
pub use search::{Feature, MasterPoint, MasterSearch, SearchOptions, SearchView};
pub use step::{Hold, Step, Support};
pub use stoss_integrators::GradientRule;
pub use stoss_reference_element::{FacetKind, FacetNodes};
pub use surface::{ContactSurface, NonManifoldEdge};
pub use surface_tree::SurfaceTree;
