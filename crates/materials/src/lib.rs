//! The catalogue of hyperelastic laws.
