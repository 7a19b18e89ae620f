//! Weights of one slave facet in the gap vectors of its four nodes, with derivatives.

use crate::TriangleRule;
use crate::derivatives::{PairDerivatives, pair_derivatives};
use crate::factors::Factors;
use crate::integrals::{FacetIntegrals, facet_integrals};
use crate::multiplier::{MultiplierBasis, MultiplierSpace};
use nalgebra::{Matrix4, Vector3};
use stoss_segmentation::FacetSegmentation;

/// `g_A = sum_J D_AJ x1_J - sum_K M_AK x2_K` over one facet. Nodes are the facet's four, then four of each master facet.
#[derive(Clone, Debug)]
pub(crate) struct FacetWeights {
    /// Master facets opposite, local numbers.
    pub masters: Vec<u32>,
    /// Row `A`, then one weight a node.
    pub weights: Vec<f64>,
    /// `d weights / d x`: row `A`, node, component of the nodes; empty if not asked for.
    pub derivative: Vec<f64>,
    /// The integrals of the standard functions, none of them negative; empty if `weights` are these but for the sign.
    pub standard: Vec<f64>,
    /// `int phi_A dA`, an area.
    pub support: [f64; 4],
    /// The same without the factors of the gap.
    pub opposite: [f64; 4],
}

impl FacetWeights {
    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        4 + 4 * self.masters.len()
    }
}

/// What facets are integrated with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integration {
    pub space: MultiplierSpace,
    pub rule: TriangleRule,
    pub factors: Factors,
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

impl Integration {
    /// Weights of a facet. `without`: corners that have no multiplier.
    pub fn facet_weights(
        &self,
        found: &FacetSegmentation,
        corners: impl Fn(u32) -> [Vector3<f64>; 4],
        without: [bool; 4],
        want_derivative: bool,
    ) -> FacetWeights {
        let give = hand_over(without);
        let integrals = facet_integrals(found, &corners, self.rule, &self.factors);
        let basis = MultiplierBasis::new(self.space, &integrals);
        let count = 4 + 4 * integrals.pairs.len();
        let rows = |slave: Matrix4<f64>, master: &dyn Fn(usize) -> Matrix4<f64>, sign: f64| {
            let mut out = vec![0.0; 4 * count];
            for p in 0..=integrals.pairs.len() {
                let (block, sign) = if p == 0 { (slave, 1.0) } else { (master(p - 1), sign) };
                let block = give * block;
                for a in 0..4 {
                    for k in 0..4 {
                        out[a * count + 4 * p + k] = sign * block[(a, k)];
                    }
                }
            }
            out
        };
        let slave = matrix(&basis.slave_block(&integrals));
        let weights = rows(slave, &|p| matrix(&basis.master_block(&integrals.pairs[p].coupling)), -1.0);
        let standard = if basis.is_diagonal() {
            rows(matrix(&integrals.mass), &|p| matrix(&integrals.pairs[p].coupling), 1.0)
        } else {
            Vec::new()
        };
        let mut out = FacetWeights {
            masters: integrals.pairs.iter().map(|p| p.master_facet).collect(),
            weights,
            derivative: Vec::new(),
            standard,
            support: (give * slave.column_sum()).into(),
            opposite: (give * nalgebra::Vector4::from(integrals.opposite)).into(),
        };
        if want_derivative {
            self.derivatives(found, corners, &integrals, &basis, &give, &mut out);
        }
        out
    }

    fn derivatives(
        &self,
        found: &FacetSegmentation,
        corners: impl Fn(u32) -> [Vector3<f64>; 4],
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
            let master = corners(segment.master_facet);
            pair_derivatives(segment, &found.frame, &master, self.rule, &self.factors, &mut pairs[at]);
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
                let moves = range.contains(&p);
                if !basis.is_diagonal() && !moves {
                    continue;
                }
                let mut block = dc * coupling;
                if moves {
                    block += c * Matrix4::from_fn(|i, k| pairs[p].coupling[i][k][local]);
                }
                put(4 + 4 * p, &block, -1.0);
            }
        }
    }
}
