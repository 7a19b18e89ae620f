//! Closed forms of multibody systems, and equations in minimal coordinates that are integrated by themselves.

pub mod bend;
pub mod elastica;
pub mod elliptic;
pub mod lines;
pub mod mechanisms;
pub mod pendulums;
pub mod top;
pub mod trebuchet;
