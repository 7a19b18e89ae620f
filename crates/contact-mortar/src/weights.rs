//! Weights of one slave facet in the gap vectors of its nodes, with derivatives.

use crate::TriangleRule;
use crate::derivatives::{PairDerivatives, pair_derivatives};
use crate::factors::Factors;
use crate::integrals::{FacetIntegrals, facet_integrals};
use crate::multiplier::{MultiplierBasis, MultiplierSpace, NodeMatrix, NodeVector, matrix};
use nalgebra::Vector3;
use stoss_reference_element::{MAX_NODES, Nodal};
use stoss_segmentation::{FacetSegmentation, MASTER};

/// `g_A = sum_J D_AJ x1_J - sum_K M_AK x2_K` over one facet. Nodes are those of the facet, then those of each master facet.
#[derive(Clone, Debug)]
pub(crate) struct FacetWeights {
    /// Master facets opposite, local numbers.
    pub masters: Vec<u32>,
    /// The first node of the slave facet, of each master facet, and the number of all.
    first: Vec<usize>,
    /// Row `A`, then one weight a node.
    pub weights: Vec<f64>,
    /// `d weights / d x`: row `A`, node, component of the nodes; empty if not asked for.
    pub derivative: Vec<f64>,
    /// The integrals of the standard functions, none of them negative; empty if `weights` are these but for the sign.
    pub standard: Vec<f64>,
    /// `int phi_A dA`, an area.
    pub support: [f64; MAX_NODES],
    /// The same without the factors of the gap.
    pub opposite: [f64; MAX_NODES],
}

impl FacetWeights {
    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        // cannot fail: the last entry is always there.
        self.first.last().copied().unwrap_or(0)
    }
}

/// What facets are integrated with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integration {
    pub space: MultiplierSpace,
    pub rule: TriangleRule,
    pub factors: Factors,
}

/// Corners of a facet that hand their functions over; places where there is no corner do so.
pub(crate) type Without = [bool; MAX_NODES];

/// Functions of corners without a multiplier of their own are handed to the other corners in equal parts: the sum of all
/// functions stays one, so that constant pressures are still exact at crosspoints.
pub(crate) fn hand_over(without: Without) -> NodeMatrix {
    let keep = without.iter().filter(|&&w| !w).count();
    NodeMatrix::from_fn(|a, b| match (without[a], without[b]) {
        (true, _) => 0.0,
        (false, false) => f64::from(u8::from(a == b)),
        (false, true) => 1.0 / keep as f64,
    })
}

impl Integration {
    /// Weights of a facet. `without`: corners that have no multiplier.
    pub fn facet_weights(
        &self,
        found: &FacetSegmentation,
        corners: impl Fn(u32) -> Nodal<Vector3<f64>>,
        without: Without,
        want_derivative: bool,
    ) -> FacetWeights {
        let give = hand_over(without);
        let integrals = facet_integrals(found, &corners, self.rule, &self.factors);
        let basis = MultiplierBasis::new(self.space, &integrals);
        let own = integrals.kind.node_count();
        let mut first = vec![0, own];
        first.extend(integrals.pairs.iter().scan(own, |next, pair| {
            *next += pair.master_kind.node_count();
            Some(*next)
        }));
        let count = first[first.len() - 1];
        let rows = |slave: NodeMatrix, master: &dyn Fn(usize) -> NodeMatrix, sign: f64| {
            let mut out = vec![0.0; own * count];
            for (p, ends) in first.windows(2).enumerate() {
                let (block, sign) = if p == 0 { (slave, 1.0) } else { (master(p - 1), sign) };
                let block = give * block;
                for a in 0..own {
                    for (k, node) in (ends[0]..ends[1]).enumerate() {
                        out[a * count + node] = sign * block[(a, k)];
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
            first,
            weights,
            derivative: Vec::new(),
            standard,
            support: (give * slave.column_sum()).into(),
            opposite: (give * NodeVector::from(integrals.opposite)).into(),
        };
        if want_derivative {
            self.derivatives(found, corners, &integrals, &basis, &give, &mut out);
        }
        out
    }

    fn derivatives(
        &self,
        found: &FacetSegmentation,
        corners: impl Fn(u32) -> Nodal<Vector3<f64>>,
        integrals: &FacetIntegrals,
        basis: &MultiplierBasis,
        give: &NodeMatrix,
        out: &mut FacetWeights,
    ) {
        let (own, count) = (integrals.kind.node_count(), out.node_count());
        let columns = 3 * count;
        out.derivative = vec![0.0; own * count * columns];
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
        let couplings: Vec<NodeMatrix> = integrals.pairs.iter().map(|p| matrix(&p.coupling)).collect();
        let FacetWeights { first, derivative, .. } = out;
        let facets = first.windows(2).enumerate();
        let places = facets.flat_map(|(facet, ends)| (3 * ends[0]..3 * ends[1]).enumerate().map(move |k| (facet, k)));
        for (facet, (place, column)) in places {
            // The column of each pair that this one is: slave columns are in all pairs, a master's in its own.
            let (range, local) = if facet == 0 { (0..pairs.len(), place) } else { (facet - 1..facet, MASTER + place) };
            let (mut shape, mut mass) = ([0.0; MAX_NODES], [[0.0; MAX_NODES]; MAX_NODES]);
            for pair in &pairs[range.clone()] {
                for i in 0..MAX_NODES {
                    shape[i] += pair.shape[i][local];
                    for j in 0..MAX_NODES {
                        mass[i][j] += pair.mass[i][j][local];
                    }
                }
            }
            let dc = matrix(&basis.coefficient_variation(&shape, &mass));
            let slave = if basis.is_diagonal() {
                let total = dc * NodeVector::from(integrals.shape) + c * NodeVector::from(shape);
                NodeMatrix::from_diagonal(&total)
            } else {
                matrix(&mass)
            };
            let mut put = |facet: usize, block: &NodeMatrix, sign: f64| {
                let block = give * block;
                for a in 0..own {
                    for (k, node) in (first[facet]..first[facet + 1]).enumerate() {
                        derivative[(a * count + node) * columns + column] += sign * block[(a, k)];
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
                    block += c * NodeMatrix::from_fn(|i, k| pairs[p].coupling[i][k][local]);
                }
                put(1 + p, &block, -1.0);
            }
        }
    }
}
