//! Stoss: large-deformation contact elastodynamics. The facade.
//!
//! Every crate of the stack is re-exported under its short name; a cargo feature leaves out what a project does not need.
//!
//! | feature | adds |
//! |---|---|
//! | `nts` | node-to-surface contact ([`contact_nts`]) |
//! | `mortar` | mortar contact and mesh ties ([`contact_mortar`]) |
//! | `general` | general contact: everything with everything, by a barrier |
//! | `multibody` | rigid bodies, beams, strings, springs and joints ([`multibody`]) |
//! | `scene` | TOML scenes and the catalogue of laws ([`scene`], [`materials`], [`build`]) |
//! | `mesh-files` | Gmsh and Abaqus readers |
//! | `decks` | scenes from Abaqus and CalculiX decks ([`deck_import`]) |
//! | `vtkhdf` | frames of a run in one HDF5 file |
//! | `schema` | the scene format as a JSON schema |
//! | `output` | folders of results, the [`watch`] on every run, and [`run`], which the program `stoss` is a thin layer over |
//!
//! With `scene`: [`scene::Scene`], [`build::build`] and [`build::OwnLaws`]; with `output`: [`run::run_scene`] and [`run::RunOptions`]; always: [`solver::Model`], [`solver::Settings`] and
//! [`solver::Simulation`] for models made by hand.
//!
//! This crate contains no algorithm: it translates a scene into a [`solver::Model`] and writes what the
//! [`solver::Simulation`] did.
//!
#![cfg_attr(feature = "scene", doc = include_str!("../README.md"))]

pub use stoss_contact as contact;
#[cfg(feature = "mortar")]
pub use stoss_contact_mortar as contact_mortar;
#[cfg(feature = "nts")]
pub use stoss_contact_nts as contact_nts;
pub use stoss_continuum as continuum;
#[cfg(feature = "decks")]
pub use stoss_deck_import as deck_import;
pub use stoss_fe_solid as fe_solid;
pub use stoss_integrators as integrators;
pub use stoss_linalg as linalg;
#[cfg(feature = "scene")]
pub use stoss_materials as materials;
pub use stoss_mesh as mesh;
#[cfg(any(feature = "mesh-files", feature = "output"))]
pub use stoss_mesh_io as mesh_io;
#[cfg(feature = "multibody")]
pub use stoss_multibody as multibody;
pub use stoss_newton as newton;
pub use stoss_reference_element as reference_element;
pub use stoss_registry as registry;
#[cfg(feature = "scene")]
pub use stoss_scene as scene;
pub use stoss_solver as solver;
pub use stoss_tensor as tensor;
pub use stoss_term as term;
#[cfg(feature = "output")]
pub use stoss_watch as watch;

#[cfg(feature = "scene")]
pub mod build;
#[cfg(feature = "output")]
pub mod diagnosis;
#[cfg(feature = "output")]
mod error;
#[cfg(feature = "output")]
pub mod events;
#[cfg(feature = "output")]
mod exact_stick;
#[cfg(feature = "output")]
mod left_out;
#[cfg(feature = "output")]
pub mod output;
#[cfg(any(feature = "output", feature = "scene"))]
#[cfg_attr(
    not(any(feature = "output", feature = "nts", feature = "mortar")),
    allow(dead_code, reason = "probes need a part of it only")
)]
mod points;
#[cfg(feature = "scene")]
pub mod ranks;
#[cfg(any(feature = "output", all(feature = "scene", feature = "mesh-files")))]
mod regular;
#[cfg(feature = "output")]
pub mod run;
#[cfg(feature = "output")]
pub mod setup;
#[cfg(feature = "output")]
pub mod sweep;
#[cfg(feature = "output")]
mod terms;

/// The recipes whose code is executed.
#[cfg(all(doctest, feature = "output"))]
mod recipes {
    #[doc = include_str!("../../../docs/how-to-add/friction-law.md")]
    struct FrictionLaw;
    #[doc = include_str!("../../../docs/how-to-add/material-law.md")]
    struct MaterialLaw;
}
