//! Multiplier spaces on a slave facet.

use crate::centres::{Centres, Moments, image, polygon_moments};
use crate::faces::FaceBlock;
use crate::local::{FacetMatrix, NodeMatrix, NodeVector, matrix, rows_of};
use crate::{FacetIntegrals, Factors, PairIntegrals};
use nalgebra::{SymmetricEigen, Vector2, Vector3};
use stoss_reference_element::{MAX_NODES, Nodal};
use stoss_segmentation::FacetSegmentation;

/// Which functions the multipliers are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MultiplierSpace {
    /// The slave's shape functions: `D` couples the nodes of a facet.
    #[default]
    Standard,
    /// Functions biorthogonal to the slave's shape functions on the covered part: `D` is diagonal.
    Dual,
    /// Dual functions whose resultants lie in the covered part of the facet; dual ones where it is wholly covered, and in ties.
    Centred,
}

/// Smallest eigenvalue of the scaled mass matrix (1/9 for a parallelogram that is wholly covered, 1/4 for a triangle) below which dual
/// functions would be larger than 1e7 and their integrals lose all digits.
const SMALLEST_EIGENVALUE: f64 = 1e-7;

/// Multiplier functions `phi_A = sum_i C_Ai N_i` of one facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultiplierBasis {
    /// Coefficients `C_Ai`: row the multiplier, column the shape function.
    pub coefficients: FacetMatrix,
    /// Whether the facet is covered too little for dual functions: standard functions, lumped `D`.
    pub lumped: bool,
    diagonal: bool,
    inverse_mass: NodeMatrix,
    /// The shape functions at the centres of the functions: row the centre.
    at_centres: NodeMatrix,
    /// The inverse of its transpose.
    shares: NodeMatrix,
    /// `int phi_A dA`.
    areas: NodeVector,
}

/// Parts of a covered area below which that of a function is not taken: points of a part of an odd shape may come near a line on which the functions do not tell them apart.
const SMALLEST_SHARE: f64 = 1e-2;
/// A facet that is covered up to this is wholly covered.
const WHOLE: f64 = 1e-12;

impl MultiplierBasis {
    /// The functions of a facet with these integrals, biorthogonal also where it is partly covered: centres are the nodes, as ties have them.
    pub fn new(space: MultiplierSpace, integrals: &FacetIntegrals) -> Self {
        Self::with_centres(space, integrals, None)
    }

    /// The functions that contact has on a facet with these segments and integrals: where it is partly covered, centres of [`MultiplierSpace::Centred`] lie in the covered part
    /// (theory/mortar#centres), so that no pressure acts beside the master. `corners` gives the positions of a master facet.
    pub fn of_contact(
        space: MultiplierSpace,
        integrals: &FacetIntegrals,
        found: &FacetSegmentation,
        corners: impl Fn(u32) -> Nodal<Vector3<f64>>,
        factors: &Factors,
    ) -> Self {
        let centres = centres(space, found, corners, factors);
        Self::with_centres(space, integrals, centres.as_ref())
    }

    pub(crate) fn with_centres(space: MultiplierSpace, integrals: &FacetIntegrals, centres: Option<&Centres>) -> Self {
        let standard = |diagonal| Self {
            coefficients: rows_of(&NodeMatrix::identity()),
            lumped: diagonal,
            diagonal,
            inverse_mass: NodeMatrix::zeros(),
            at_centres: NodeMatrix::identity(),
            shares: NodeMatrix::identity(),
            areas: NodeVector::from(integrals.shape),
        };
        if space == MultiplierSpace::Standard {
            return standard(false);
        }
        // Scaled to unit row sums of the constant: the eigenvalues tell how well the functions are distinguished.
        let nodes = integrals.kind.node_count();
        if integrals.shape[..nodes].iter().any(|s| s.is_nan() || *s <= 0.0) {
            return standard(true);
        }
        let scale = NodeVector::from_fn(|i, _| if i < nodes { 1.0 / integrals.shape[i].sqrt() } else { 0.0 });
        let mass = matrix(&integrals.mass);
        // Where there is no node a row of the identity, which gives no information and drops out again.
        let absent = |i: usize, j: usize| if i == j && i >= nodes { 1.0 } else { 0.0 };
        let scaled = NodeMatrix::from_fn(|i, j| scale[i] * mass[(i, j)] * scale[j] + absent(i, j));
        let eigen = SymmetricEigen::new(scaled).eigenvalues;
        let smallest = eigen.iter().fold(f64::INFINITY, |m: f64, &e| m.min(e));
        let inverse = (smallest > SMALLEST_EIGENVALUE).then(|| scaled.try_inverse()).flatten();
        let Some(inverse) = inverse else { return standard(true) };
        let inverse_mass = NodeMatrix::from_fn(|i, j| scale[i] * inverse[(i, j)] * scale[j]);
        let at_centres = centres.map_or(NodeMatrix::identity(), |centres| centres.functions);
        let Some(shares) = at_centres.transpose().try_inverse() else { return standard(true) };
        let areas = shares * NodeVector::from(integrals.shape);
        let least = SMALLEST_SHARE * integrals.shape.iter().sum::<f64>();
        if centres.is_some() && areas.iter().take(nodes).any(|a| a.is_nan() || *a <= least) {
            return standard(true);
        }
        let c = NodeMatrix::from_diagonal(&areas) * at_centres * inverse_mass;
        Self { coefficients: rows_of(&c), lumped: false, diagonal: true, inverse_mass, at_centres, shares, areas }
    }

    /// `d D` of a linear facet from the variations of `int phi_A` and of the functions at the centres.
    pub(crate) fn slave_variation(&self, areas: &NodeVector, at_centres: Option<&NodeMatrix>) -> NodeMatrix {
        let fixed = NodeMatrix::from_diagonal(areas) * self.at_centres;
        at_centres.map_or(fixed, |moved| fixed + NodeMatrix::from_diagonal(&self.areas) * moved)
    }

    /// Whether `D` follows from the areas and centres of the functions: dual (diagonal where the facet is wholly covered) or lumped.
    pub fn is_diagonal(&self) -> bool {
        self.diagonal
    }

    /// `phi_A` at a point with shape functions `shape`.
    pub fn values(&self, shape: &[f64; MAX_NODES]) -> [f64; MAX_NODES] {
        self.coefficients.map(|c| (0..MAX_NODES).map(|i| c[i] * shape[i]).sum())
    }

    /// `D_AJ = int phi_A N_J dA`. On a linear facet with dual and lumped functions the shape functions at their centres times `int phi_A dA`, which is taken from the row sums of
    /// [`MultiplierBasis::master_block`], with which they have to agree even where dual functions are large.
    pub fn slave_block(&self, integrals: &FacetIntegrals) -> FaceBlock {
        let c = matrix(&self.coefficients);
        if !self.diagonal {
            return FaceBlock::of(&integrals.mass, integrals.face.as_ref()).after(&c);
        }
        let mut sums = [0.0; MAX_NODES];
        for pair in &integrals.pairs {
            let block = self.master_block(pair);
            sums.iter_mut().enumerate().for_each(|(a, sum)| *sum += block.sum_of_row(a));
        }
        match &integrals.face {
            None => FaceBlock::Linear(NodeMatrix::from_diagonal(&NodeVector::from(sums)) * self.at_centres),
            Some(face) => FaceBlock::of(&integrals.mass, Some(face)).after(&c).with_row_sums(&sums),
        }
    }

    /// `M_AK = int phi_A N_K^(2) dA` of a pair.
    pub fn master_block(&self, pair: &PairIntegrals) -> FaceBlock {
        pair.block().after(&matrix(&self.coefficients))
    }

    /// `d C` for variations of `int N_i` and `int N_i N_j` over the whole covered part: `dC = (diag(d shape) - C d
    /// mass) mass^-1`, centres held. Zero for standard and lumped functions.
    pub fn coefficient_variation(&self, shape: &[f64; MAX_NODES], mass: &FacetMatrix) -> FacetMatrix {
        rows_of(&self.variation(shape, mass, None))
    }

    /// Variation of the coefficients as of [`Self::coefficient_variation`], with a variation of the functions at the centres.
    pub(crate) fn variation(
        &self,
        shape: &[f64; MAX_NODES],
        mass: &FacetMatrix,
        at_centres: Option<&NodeMatrix>,
    ) -> NodeMatrix {
        let mut moments = NodeVector::from(*shape);
        let mut sum = -matrix(&self.coefficients) * matrix(mass);
        if let Some(moved) = at_centres {
            moments -= moved.transpose() * self.areas;
            sum += NodeMatrix::from_diagonal(&self.areas) * moved;
        }
        sum += NodeMatrix::from_diagonal(&(self.shares * moments)) * self.at_centres;
        sum * self.inverse_mass
    }
}

/// Centres of dual functions; `None` if they are the nodes.
pub(crate) fn centres(
    space: MultiplierSpace,
    found: &FacetSegmentation,
    corners: impl Fn(u32) -> Nodal<Vector3<f64>>,
    factors: &Factors,
) -> Option<Centres> {
    let kind = found.frame.kind();
    let covered = found.parametric_area() / kind.area();
    if space != MultiplierSpace::Centred || found.segments.is_empty() {
        return None;
    }
    let facing = |facet| factors.facing_of(&found.frame, &corners(facet), false).value;
    let weights: Vec<f64> = found.segments.iter().map(|segment| facing(segment.master_facet)).collect();
    if covered >= 1.0 - WHOLE && weights.iter().all(|w| *w == 1.0) {
        return None;
    }
    let polygon = |k: usize| -> Vec<Vector2<f64>> {
        found.segments[k].vertices().iter().map(|vertex| image(kind, vertex.slave)).collect()
    };
    let polygons: Vec<Vec<Vector2<f64>>> =
        (0..weights.len()).map(|k| if weights[k] > 0.0 { polygon(k) } else { Vec::new() }).collect();
    let moments: Moments = polygons.iter().zip(&weights).map(|(polygon, w)| polygon_moments(polygon) * *w).sum();
    if moments[0] > 0.0 { Centres::new(kind, &moments, &polygons) } else { None }
}
