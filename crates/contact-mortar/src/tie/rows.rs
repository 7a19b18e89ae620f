//! The rows of the constraints: which slave nodes have multipliers, and their coefficients.

use crate::MortarMatrices;
use stoss_contact::ContactSurface;

/// Coefficients of a node in the gap vector, one a component [area].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    pub node: u32,
    pub coefficients: [f64; 3],
    /// True for a slave node.
    pub is_slave: bool,
}

/// Gap vector of a slave node: `g_i = sum coefficients_i q_i`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ConstraintRow {
    pub local_node: usize,
    /// Global number.
    pub node: u32,
    /// Entries of the row, that of the node itself first.
    pub entries: Vec<Entry>,
    /// Components with a multiplier.
    pub kept: [bool; 3],
    /// True if no component of the node is fixed.
    pub is_free: bool,
    /// Integral of the multiplier's function, the largest of the components [area].
    pub weight: f64,
}

/// A node whose support is covered by less than this share takes no part.
const SMALLEST_COVER: f64 = 1e-8;

impl ConstraintRow {
    /// The gap vector [volume].
    pub fn gap(&self, q: &[f64]) -> [f64; 3] {
        let mut g = [0.0; 3];
        for entry in &self.entries {
            let at = 3 * entry.node as usize;
            for i in 0..3 {
                g[i] += entry.coefficients[i] * q[at + i];
            }
        }
        g
    }

    /// Largest component with a multiplier, divided by the weight: a length.
    pub fn largest_gap(&self, q: &[f64]) -> f64 {
        let g = self.gap(q);
        (0..3).filter(|&i| self.kept[i]).map(|i| g[i].abs() / self.weight).fold(0.0, f64::max)
    }
}

/// Rows of all slave nodes that keep a multiplier. The functions of fixed components go to the kept ones around in
/// equal parts.
pub(super) fn constraint_rows(
    slave: &ContactSurface,
    master: &ContactSurface,
    matrices: &MortarMatrices,
    is_fixed: impl Fn(usize) -> bool,
) -> Vec<ConstraintRow> {
    let count = slave.nodes().len();
    let areas = slave.nodal_areas();
    let covered = |a: usize| matrices.weights[a] > SMALLEST_COVER * areas[a];
    let fixed = |a: usize, i: usize| is_fixed(3 * slave.nodes()[a] as usize + i);
    let keeps = |a: usize, i: usize| covered(a) && !fixed(a, i);
    // Shares of the functions: (component, of node, share).
    let mut shares: Vec<Vec<(usize, usize, f64)>> = vec![Vec::new(); count];
    for (a, own) in shares.iter_mut().enumerate() {
        own.extend((0..3).filter(|&i| keeps(a, i)).map(|i| (i, a, 1.0)));
    }
    let mut around = Vec::new();
    for a in (0..count).filter(|&a| covered(a)) {
        for i in (0..3).filter(|&i| fixed(a, i)) {
            around.clear();
            let facets = slave.facets_around(a).iter().flat_map(|&f| slave.local_facets()[f as usize]);
            around.extend(facets.map(|n| n as usize).filter(|&n| keeps(n, i)));
            around.sort_unstable();
            around.dedup();
            for &n in &around {
                shares[n].push((i, a, 1.0 / around.len() as f64));
            }
        }
    }
    let mut rows = Vec::new();
    for (a, shares) in shares.iter().enumerate() {
        let kept: [bool; 3] = std::array::from_fn(|i| keeps(a, i));
        if !kept.contains(&true) {
            continue;
        }
        let mut entries: Vec<Entry> = Vec::new();
        let mut weights = [0.0; 3];
        let mut add = |node: u32, i: usize, value: f64, is_slave: bool| {
            let at = entries.iter().position(|e| e.node == node).unwrap_or_else(|| {
                entries.push(Entry { node, coefficients: [0.0; 3], is_slave });
                entries.len() - 1
            });
            entries[at].coefficients[i] += value;
        };
        // The node itself comes first, whatever its coefficient.
        add(slave.nodes()[a], 0, 0.0, true);
        for &(i, of, share) in shares {
            weights[i] += share * matrices.weights[of];
            for &(node, d) in &matrices.slave[of] {
                add(slave.nodes()[node as usize], i, share * d, true);
            }
            for &(node, m) in &matrices.master[of] {
                add(master.nodes()[node as usize], i, -share * m, false);
            }
        }
        rows.push(ConstraintRow {
            local_node: a,
            node: slave.nodes()[a],
            entries,
            kept,
            is_free: kept == [true; 3],
            weight: weights.into_iter().fold(0.0, f64::max),
        });
    }
    rows
}
