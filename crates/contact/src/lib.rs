//! Contact surfaces, pair search, friction and active-set data: what contact discretisations are made of.
//!
//! The stages are types that can be looked at: [`ContactSurface`] (facets, nodes, adjacency, nodal areas) ->
//! [`MasterSearch`] (tree over the master facets) -> [`MasterPoint`] (closest point, signed gap, which geometric case, pairing
//! facet) -> [`ActiveSetControl`] (which constraints are closed), [`Enforcement`] (their pressures) and [`friction`] (tangential tractions). A contact
//! discretisation implements [`stoss_term::Term`] and [`stoss_term::Unilateral`] on top of them, in a crate of its own.
//!
//! Not here: forces and tangents (they are a method's), the global system (the solver's), meshes' files.
//!
#![doc = include_str!("../README.md")]

pub mod active_set;
mod carriers;
pub mod dual;
mod enforcement;
mod error;
pub mod friction;
mod in_order;
pub mod line;
mod position;
mod rim;
pub mod round;
mod scales;
pub mod search;
mod shape;
mod slave;
pub mod surface;
mod surface_tree;

pub use active_set::{ActiveSetControl, ActiveSetOutcome};
pub use carriers::Carriers;
pub use enforcement::{Enforcement, NormalRow};
pub use error::ContactError;
pub use in_order::in_order;
pub use line::ContactLine;
pub use position::position;
pub use rim::beside_rims;
pub use scales::PairScales;
pub use search::{Feature, MasterPoint, MasterSearch, SearchOptions, SearchView};
pub use shape::{arch, are_curved_alike, face_each_other, facet_area_vector, finer_side};
pub use slave::{Candidate, KeptOut, Sinking, SlaveReason, choose_slave};
pub use stoss_reference_element::{FacetKind, FacetNodes};
pub use surface::{ContactSurface, NonManifoldEdge};
pub use surface_tree::SurfaceTree;
