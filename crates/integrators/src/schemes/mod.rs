//! The schemes, one file each.

mod energy_momentum;
mod euler;
mod generalised_alpha;
mod midpoint;
mod trapezoidal;
mod variational;

pub use energy_momentum::EnergyMomentum;
pub use euler::{BackwardEuler, ForwardEuler};
pub use generalised_alpha::{ForceAverage, GeneralisedAlpha};
pub use midpoint::Midpoint;
pub use trapezoidal::Trapezoidal;
pub use variational::VariationalMidpoint;
