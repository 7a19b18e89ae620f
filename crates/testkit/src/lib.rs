//! Batteries, derivative oracles and strategies for tests; never a normal dependency.
//!
//! * [`oracle`]: Jacobians by central differences with Richardson extrapolation, comparison with a report of the worst entry;
//! * [`strategies`]: random admissible deformation states, equal stretches included;
//! * [`meshes`]: contact surfaces of quadrilaterals, triangles and both;
//! * [`laws`]: everything that a hyperelastic law must fulfil, one call an implementor.
//!
//! A battery panics with what failed, at which state, and by how much.

pub mod laws;
pub mod meshes;
pub mod oracle;
pub mod strategies;
