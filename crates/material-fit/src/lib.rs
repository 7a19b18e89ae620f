//! Parameters of hyperelastic laws from measured curves (theory/kinematics#from-data).
//!
//! * [`Curves`]: stretch and nominal stress of uniaxial, equibiaxial and planar tests, from a table;
//! * [`Family`]: which parameters of a law are sought, and where the search begins;
//! * [`fit`]: the parameters with the least squares of the deviations, [`Fit`];
//! * [`nominal_stress`], [`stable_stretches`]: what an incompressible material of a law does in such a test.
//!
//! Specimens count as incompressible: stresses across the specimen vanish, and the volumetric part of a law says nothing. It follows from Poisson's ratio.
//!
//! Not here: files, units, laws with a history.
//!
//! To fit a further law: an arm of [`Family::of`].
//!
#![doc = include_str!("../README.md")]

mod curves;
mod error;
mod family;
mod least_squares;
mod response;
mod search;

pub use curves::{Curve, Curves, Mode};
pub use error::FitError;
pub use family::Family;
pub use response::{nominal_stress, stable_stretches};
pub use search::{Fit, fit};
