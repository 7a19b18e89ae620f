//! Element and body integrals of finite-strain solids of any cells: energy, force, tangent, mass, momenta, loads.
//!
//! A [`SolidBody`] is a mesh with a law. It evaluates, for a [`ForceRule`], the internal force `F(q_n, q_np1)` and its
//! derivative with respect to `q_np1`, and adds both to the caller's global arrays. The rules:
//!
//! * `Configuration { theta }`: stress and `B` both at `q_{n+theta}`, `theta` times the static tangent. For schemes
//!   that take forces at one configuration: the start (0), `MIDPOINT` (1/2), `END_POINT` (1), or any in between;
//! * `DiscreteGradient`: the stress of theory/integrators#eq-ems with `B` at `q_mid`, unsymmetric tangent.
//!
//! The trapezoidal rule is the mean of the forces at both ends, which its scheme forms.
//!
//! [`MassMatrix`] holds the inertia and the momenta, the functions of `load` ([`dead_traction`], [`follower_pressure`]) the loads.
//!
//! What it is *not*: no law (laws come in by the trait [`stoss_continuum::HyperelasticLaw`]), no time stepping, no
//! boundary conditions, no linear solver.
//!
//! Conventions: all vectors over the model (`q`, `v`, forces) have `3 * nodes` entries, node-major (`x0 y0 z0 x1 ...`);
//! positions, not displacements. Symmetric tensors as six numbers are in the order 11, 22, 33, 12, 23, 13, stresses plain.
//! Free of units: with lengths in L and stresses in P, forces are in P L^2 and energies in P L^3.
//!
//! The layers inside, from below: [`kernel`] (plain arrays, one element), `element` (the stress by the scheme's rule at the Gauss
//! points of one element, of which `laws` says what function of the strain each is), `mixed` (the same with averages of the change of volume), `block` (the elements of one kind, with the numbers of nodes and points as constants) and `nodal` (tet4 with averages at nodes), behind the trait `element_block::ElementBlock`; [`SolidBody`] (all
//! elements, order, threads, scatter). A new kind of cell is a line in `blocks` and one in `mass`.
//!
#![doc = include_str!("../README.md")]

mod assembly;
mod block;
mod blocks;
mod body;
mod cost;
mod element;
mod element_block;
mod error;
mod history;
pub mod kernel;
mod laws;
mod load;
mod mass;
mod massless;
mod matrices;
mod mixed;
mod nodal;
mod options;
mod own;
mod point;
mod recovery;
mod reference;
mod rule;
mod scratch;
mod share;
mod state_output;
mod step_end;
mod term;
mod viscous;

pub use assembly::{TangentTarget, Workspace};
pub use body::{InsideOut, SolidBody};
pub use error::{SolidError, TimeLevel};
pub use load::{
    FollowerPressure, add_follower_pressure, area_matrix, dead_pressure, dead_traction, external_work,
    follower_pressure, surface_area,
};
pub use mass::{MassKind, MassMatrix};
pub use massless::{Massless, MasslessError};
pub use options::{SolidOptions, Volumetric};
pub use point::{MaterialPoint, PointState};
pub use recovery::{GaussPointState, NodalSums, principal_stresses, von_mises};
pub use rule::SolidStep;
pub use state_output::OutputPlace;
pub use step_end::StepEnd;
pub use stoss_integrators::ForceRule;
pub use viscous::ViscousRate;
