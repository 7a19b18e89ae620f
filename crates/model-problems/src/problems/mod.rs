//! The problems, one file each.

mod bar;
mod mass_point;
mod pendulum;
mod spring;
mod string;

pub use bar::BouncingBar;
pub use mass_point::MassPoint;
pub use pendulum::{Pendulum, ReducedPendulum};
pub use spring::{AugmentedSpringPendulum, SpringPair, SpringPendulum};
pub use string::StringPendulum;
