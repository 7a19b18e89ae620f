//! Weights of one slave facet in the gap vectors of its four nodes, with derivatives.

use crate::pair_derivatives;
use crate::{FacetIntegrals, MultiplierBasis, MultiplierSpace, PairDerivatives, Quadrature, facet_integrals};
use nalgebra::{Matrix4, Vector3};
use stoss_segmentation::FacetSegmentation;

/// Measure of the integrals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Measure {
    /// Area (formulation (7.1)).
    Area,
    /// Convective coordinates: the director carries the area (formulation §8.3).
    Parametric,
}

/// `g_A = sum_J D_AJ x1_J - sum_K M_AK x2_K` over one facet. Nodes are the facet's four, then four of each master facet.
#[derive(Clone, Debug)]
pub(crate) struct FacetWeights {
    /// Master facets opposite, local numbers.
    pub masters: Vec<u32>,
    /// Row `A`, then one weight a node.
    pub weights: Vec<f64>,
    /// `d weights / d x`: row `A`, node, component of the nodes; empty if the integrals are frozen.
    pub derivative: Vec<f64>,
    /// `int phi_A dA`, always an area.
    pub support: [f64; 4],
    /// The same before functions were handed over.
    pub bare_support: [f64; 4],
    /// Part of the facet's own weight that all these are.
    pub part: f64,
}

impl FacetWeights {
    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        4 + 4 * self.masters.len()
    }

    /// This part of all weights.
    pub fn scaled(mut self, part: f64) -> Self {
        let values = self.weights.iter_mut().chain(&mut self.derivative);
        values.chain(&mut self.support).chain(&mut self.bare_support).chain([&mut self.part]).for_each(|w| *w *= part);
        self
    }
}

/// Functions of corners without a multiplier of their own are handed to the other corners in equal parts: the sum of all
/// functions stays one, so that constant pressures are still exact at crosspoints.
pub(crate) fn hand_over(without: [bool; 4]) -> Matrix4<f64> {
    let keep = without.iter().filter(|&&w| !w).count();
    Matrix4::from_fn(|a, b| match (without[a], without[b]) {
        (true, _) => 0.0,
        (false, false) => f64::from(u8::from(a == b)),
        (false, true) => 1.0 / keep as f64,
    })
}

fn matrix(m: &[[f64; 4]; 4]) -> Matrix4<f64> {
    Matrix4::from_fn(|i, j| m[i][j])
}

fn parametric(integrals: &FacetIntegrals) -> FacetIntegrals {
    let mut out = integrals.clone();
    out.mass = [[0.0; 4]; 4];
    for pair in &mut out.pairs {
        pair.coupling = pair.parametric_coupling;
        pair.mass = pair.parametric_mass;
        for i in 0..4 {
            for j in 0..4 {
                out.mass[i][j] += pair.mass[i][j];
            }
        }
    }
    out.shape = out.mass.map(|row| row.iter().sum());
    out
}

/// Weights of a facet. `without`: corners that have no multiplier.
pub(crate) fn facet_weights(
    found: &FacetSegmentation,
    corners: impl Fn(u32) -> [Vector3<f64>; 4],
    space: MultiplierSpace,
    quadrature: Quadrature,
    measure: Measure,
    without: [bool; 4],
    want_derivative: bool,
) -> FacetWeights {
    let area = facet_integrals(found, &corners, quadrature);
    let give = hand_over(without);
    let bare = matrix(&MultiplierBasis::new(space, &area).slave_block(&area)).column_sum();
    let integrals = if measure == Measure::Area { area } else { parametric(&area) };
    let basis = MultiplierBasis::new(space, &integrals);
    let count = 4 + 4 * integrals.pairs.len();
    let mut out = FacetWeights {
        masters: integrals.pairs.iter().map(|p| p.master_facet).collect(),
        weights: vec![0.0; 4 * count],
        derivative: Vec::new(),
        support: (give * bare).into(),
        bare_support: bare.into(),
        part: 1.0,
    };
    let d = give * matrix(&basis.slave_block(&integrals));
    for a in 0..4 {
        for j in 0..4 {
            out.weights[a * count + j] = d[(a, j)];
        }
    }
    for (p, pair) in integrals.pairs.iter().enumerate() {
        let m = give * matrix(&basis.master_block(&pair.coupling));
        for a in 0..4 {
            for k in 0..4 {
                out.weights[a * count + 4 + 4 * p + k] = -m[(a, k)];
            }
        }
    }
    if want_derivative && measure == Measure::Area {
        derivatives(found, corners, quadrature, &integrals, &basis, &give, &mut out);
    }
    out
}

fn derivatives(
    found: &FacetSegmentation,
    corners: impl Fn(u32) -> [Vector3<f64>; 4],
    quadrature: Quadrature,
    integrals: &FacetIntegrals,
    basis: &MultiplierBasis,
    give: &Matrix4<f64>,
    out: &mut FacetWeights,
) {
    let count = out.node_count();
    let columns = 3 * count;
    out.derivative = vec![0.0; 4 * count * columns];
    let mut pairs = vec![PairDerivatives::ZERO; integrals.pairs.len()];
    let mut at = 0;
    for segment in &found.segments {
        // Segments of a pair are next to each other, as in `facet_integrals`.
        while out.masters[at] != segment.master_facet {
            at += 1;
        }
        pair_derivatives(segment, &found.frame, &corners(segment.master_facet), quadrature, &mut pairs[at]);
    }
    let c = matrix(&basis.coefficients);
    let couplings: Vec<Matrix4<f64>> = integrals.pairs.iter().map(|p| matrix(&p.coupling)).collect();
    for column in 0..columns {
        // The column of each pair that this one is: slave columns are in all pairs, a master's in its own.
        let range = if column < 12 { 0..pairs.len() } else { (column - 12) / 12..(column - 12) / 12 + 1 };
        let local = if column < 12 { column } else { 12 + (column - 12) % 12 };
        let (mut shape, mut mass) = ([0.0; 4], [[0.0; 4]; 4]);
        for pair in &pairs[range.clone()] {
            for i in 0..4 {
                shape[i] += pair.shape[i][local];
                for j in 0..4 {
                    mass[i][j] += pair.mass[i][j][local];
                }
            }
        }
        let dc = matrix(&basis.coefficient_variation(&shape, &mass));
        let slave = if basis.is_diagonal() {
            let total = dc * nalgebra::Vector4::from(integrals.shape) + c * nalgebra::Vector4::from(shape);
            Matrix4::from_diagonal(&total)
        } else {
            matrix(&mass)
        };
        let mut put = |node: usize, block: &Matrix4<f64>, sign: f64| {
            let block = give * block;
            for a in 0..4 {
                for k in 0..4 {
                    out.derivative[(a * count + node + k) * columns + column] += sign * block[(a, k)];
                }
            }
        };
        put(0, &slave, 1.0);
        for (p, coupling) in couplings.iter().enumerate() {
            let mut block = dc * coupling;
            if range.contains(&p) {
                block += c * Matrix4::from_fn(|i, k| pairs[p].coupling[i][k][local]);
            }
            put(4 + 4 * p, &block, -1.0);
        }
    }
}
