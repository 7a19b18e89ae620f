//! Mortar integrals between segmented contact surfaces, and contact (theory/mortar, theory/segmentation).
//!
//! # API
//! ```text
//! segment_surfaces(&slave, &master, q, GapRange) -> SurfaceSegmentation      all slave facets
//! SurfaceSegmentation::check(&master, q, CheckExtent) -> SurfaceCoverage   the invariant of coverage
//! for_each_point(&segment, &frame, &master corners, |point| ..)   shapes, weights, gap
//! for_each_point_with_derivatives(.., |point, variation| ..)   with derivatives
//! facet_integrals(&FacetSegmentation, corners of master, &Factors) -> FacetIntegrals   int N_i, N_i N_j, N_i N_k
//! pair_derivatives(&segment, &frame, &corners, &Factors, &mut PairDerivatives)   added up
//! MultiplierBasis::new(MultiplierSpace, &FacetIntegrals)                 coefficients phi_A = sum_i C_Ai N_i
//! MultiplierBasis::slave_block / master_block                            D_e = C int N N, M_e = C int N N^(2)
//! MortarMatrices::assemble(&slave, &master, faces, q, &SurfaceSegmentation, space) -> D, M
//! ```
//! With the same points on both sides `sum_K M_AK = sum_J D_AJ` for every slave node `A`
//! ([`MortarMatrices::imbalance`]): constants are transferred exactly and contact forces have no resultant. Linear
//! fields are transferred exactly between flat surfaces, because both sides are evaluated at the same place. The points are those of triangles around the
//! centroid of each segment: integrals are continuous functions of the positions.
//!
//! # Multiplier spaces
//! Standard: the slave's shape functions. Dual: biorthogonal on the covered part of each facet, `int phi_A N_J =
//! delta_AJ int N_J`, so that `D` is diagonal also where a facet is partly covered (Cichosz and Bischoff 2011). A
//! facet covered so little that its functions cannot be told apart takes the standard functions and a lumped `D`; row
//! sums still agree.
//!
//! # Tying
//! [`tie::MeshTie`] joins two surfaces for good: a `Constraint` of `stoss-contact`, without an active set.
//!
//! # What it is not
//! No global system. Integrals in reference or current coordinates: whatever `q` holds.
//!
//! # Contact
//! [`MortarContact`] is the contact method: weighted gaps `Phi_A = n_A . (D_AJ x1_J - M_AK x2_K)` whose integrals move with the positions, with
//! complementary nodal pressures, and forces that are the discrete gradient of the gap (theory/mortar#energy). [`MortarContact::with_friction`] adds a law of
//! `stoss_contact::friction` with tractions at the slave nodes and slips that are weighted as the gaps are ([`SlipMeasure`]).
//!
//! Its stages: `candidates` (pairs that may meet in a step), segmentation (`stoss-segmentation`), `factors` and `weights` (integrals of a slave facet with
//! derivatives), `slot` (the weighted gap: value, gradient, second derivative), `discrete` (its discrete gradient), `friction` (slip and traction of a node),
//! `method` (the contact method: force and row of a slot, report). `state` has what is built once, what is constant in a step, and slots at one configuration.
//!
#![doc = include_str!("../README.md")]

mod candidates;
mod centres;
mod derivatives;
mod discrete;
mod error;
mod faces;
mod factors;
mod friction;
mod integrals;
mod local;
mod matrices;
mod means;
mod method;
mod multiplier;
mod options;
mod points;
mod positions;
mod rows;
mod secant;
mod sharp_edges;
mod slot;
mod state;
mod surfaces;
pub mod tie;
mod weights;

pub use derivatives::{FaceDerivatives, PairDerivatives, pair_derivatives};
pub use error::MortarError;
pub use faces::{FaceBlock, FaceMatrix, Faces};
pub use factors::Factors;
pub use friction::SlipMeasure;
pub use integrals::{FacetIntegrals, PairIntegrals, facet_integrals};
pub use matrices::MortarMatrices;
pub use method::MortarContact;
pub use multiplier::{MultiplierBasis, MultiplierSpace};
pub use options::{Integrals, MortarOptions};
pub use points::{PointVariation, QuadraturePoint, for_each_point, for_each_point_with_derivatives};
pub use stoss_segmentation as segmentation;
pub use surfaces::{CheckExtent, CoverageFault, SurfaceCoverage, SurfaceSegmentation, segment_surfaces};
