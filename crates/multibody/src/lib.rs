//! Rigid bodies without rotation parameters, beams, strings, springs and joints, for one energy-momentum scheme together with solids and contact.
//!
//! The unknowns are vectors in space only: positions and directors (theory/multibody; thesis chapter 2). A [`RigidBody`] has four of them, the
//! node of a beam four, the node of a string one. Masses are constant, strains and joints are at most quadratic functions of the vectors
//! ([`Quadratics`]), and every force is made of their gradients: linear and angular momentum are exact in every scheme that takes gradients at the midpoint, energy
//! in the energy-momentum scheme.
//!
//! What acts at a point acts at an [`Embedded`] point, whatever carries it.
//!
//! * [`RigidBody`], [`Beam`], [`ElasticString`], [`PointMass`], [`Spring`], [`ElasticSupport`]: parts;
//! * [`Joint`], [`JOINTS`], [`CoordinateOptions`]: joints between two [`JointFrame`]s, with springs, friction, limits and motors;
//! * [`ConstraintSet`], [`QuadraticsBuilder`]: constraints of your own; [`kinematic_coupling`], [`distributing_coupling`]: nodes to a body;
//! * [`LinearEquations`]: multi-point constraints;
//! * [`analyse`]: equations that follow from others.
//!
//! # What it is not
//! No global system, no time stepping, no contact search, no files.
//!
//! # How to add a joint
//! docs/how-to-add/joint.md.
//!
#![doc = include_str!("../README.md")]

mod axis;
mod beam;
mod compliance;
mod constraint;
mod coupling;
mod embedded;
mod error;
mod frame;
mod joint;
mod kernel;
mod line;
mod linear;
mod point_mass;
mod quadratic;
mod redundancy;
mod response;
mod rigid;
mod section;
mod spring;
mod string;
mod support;

pub use axis::{BeamAxis, Triad};
pub use beam::{Beam, SectionForces};
pub use compliance::Weights;
pub use constraint::{ConstraintSet, Equation};
pub use coupling::{CouplingError, distributing_coupling, kinematic_coupling};
pub use embedded::Embedded;
pub use error::PartDataError;
pub use frame::{JointFrame, axes_along};
pub use joint::{
    CoordinateFriction, CoordinateKind, CoordinateOptions, CoordinateSpring, Directions, Drive, DriveFunction, JOINTS,
    Joint, JointEntry, JointError, JointKind, PiecewiseLinear, Pretension,
};
pub use kernel::{GradientAt, Kernel};
pub use line::tributary_lengths;
pub use linear::{LinearEquationError, LinearEquations, LinearTerms};
pub use point_mass::PointMass;
pub use quadratic::{Evaluation, FormId, Quadratics, QuadraticsBuilder};
pub use redundancy::{Equations, Redundancy, RedundancyError, analyse, velocity_violation};
pub use response::{QuadraticEnergy, Response};
pub use rigid::{RigidBody, RigidError, RigidMass};
pub use section::{Area, Section, SectionMaterial};
pub use spring::{Spring, SpringData};
pub use string::{ElasticString, StringMaterial};
pub use support::{AXES_OF_SPACE, ElasticSupport, Foundation, Supported};
