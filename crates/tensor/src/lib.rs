//! Second- and fourth-order 3-D tensors, invariants, spectral decomposition.
//!
//! Symmetric tensors are stored as six *plain* components in the order 11, 22, 33, 12, 23, 13 (theory/kinematics#components); full
//! tensors and vectors are nalgebra's. This crate knows no kinematics and no material.
//!
//! * [`SymmetricTensor2`]: six components, invariants, inverse, products;
//! * [`Tensor4`]: six by six components with both minor symmetries;
//! * [`SpectralDecomposition`], [`spectral_decomposition()`], [`spectral_decompositions`]: eigenvalues and eigenvectors of a symmetric tensor;
//! * [`wide`], [`components`]: numbers and tensors of several points side by side, and formulas for both;
//! * [`Tensor2`], [`Vector3`]: nalgebra's.
//!
#![doc = include_str!("../README.md")]

pub mod components;
mod fourth_order;
mod number;
mod spectral;
mod symmetric;
pub mod wide;

pub use fourth_order::Tensor4;
pub use nalgebra;
pub use spectral::{SpectralDecomposition, spectral_decomposition, spectral_decompositions};
pub use symmetric::SymmetricTensor2;

/// A vector of three components.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A second-order tensor without symmetry, 3x3.
pub type Tensor2 = nalgebra::Matrix3<f64>;

/// Row and column of each of the six stored components: 11, 22, 33, 12, 23, 13, the order of VTK. Voigt's own order has 23, 13, 12 behind 33.
pub const INDEX_PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
