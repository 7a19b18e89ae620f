//! Mortar matrices of a pair of surfaces.

use crate::{Factors, MultiplierBasis, MultiplierSpace, SurfaceSegmentation, TriangleRule, facet_integrals};
use stoss_contact::ContactSurface;

/// `D` (slave by slave) and `M` (slave by master) as sparse rows, entries areas. Node numbers are the surfaces' local
/// ones, ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct MortarMatrices {
    /// `D_AJ = int phi_A N_J^(1) dA`.
    pub slave: Vec<Vec<(u32, f64)>>,
    /// `M_AK = int phi_A N_K^(2) dA`.
    pub master: Vec<Vec<(u32, f64)>>,
    /// `int phi_A dA`: row sums of both, zero for nodes without support.
    pub weights: Vec<f64>,
}

fn merge(row: &mut Vec<(u32, f64)>) {
    // Stable: entries of one node are added in the order of the facets.
    row.sort_by_key(|e| e.0);
    row.dedup_by(|later, first| {
        let same = later.0 == first.0;
        if same {
            first.1 += later.1;
        }
        same
    });
}

impl MortarMatrices {
    /// Integrates over all segments at positions `q`, those of the segmentation. There are no [`Factors`]: contact has others where facets are far from
    /// opposed or deep.
    pub fn assemble(
        slave: &ContactSurface,
        master: &ContactSurface,
        q: &[f64],
        segments: &SurfaceSegmentation,
        space: MultiplierSpace,
        rule: TriangleRule,
    ) -> Self {
        let count = slave.nodes().len();
        let mut out =
            Self { slave: vec![Vec::new(); count], master: vec![Vec::new(); count], weights: vec![0.0; count] };
        for (facet, found) in segments.facets.iter().enumerate() {
            if found.segments.is_empty() {
                continue;
            }
            let integrals = facet_integrals(found, |f| master.patch(f, q).corners, rule, &Factors::NONE);
            let basis = MultiplierBasis::new(space, &integrals);
            let d = basis.slave_block(&integrals);
            let nodes = slave.local_facets()[facet];
            for (a, &row) in nodes.iter().enumerate() {
                let row = row as usize;
                out.weights[row] += d[a].iter().sum::<f64>();
                out.slave[row].extend((0..nodes.len()).filter(|&j| d[a][j] != 0.0).map(|j| (nodes[j], d[a][j])));
            }
            for pair in &integrals.pairs {
                let m = basis.master_block(&pair.coupling);
                let opposite = master.local_facets()[pair.master_facet as usize];
                for (a, &row) in nodes.iter().enumerate() {
                    out.master[row as usize].extend(opposite.iter().zip(m[a]).map(|(&node, m)| (node, m)));
                }
            }
        }
        out.slave.iter_mut().chain(&mut out.master).for_each(merge);
        out
    }

    /// Largest `|sum_K M_AK - sum_J D_AJ|` over the largest row sum; zero to round-off.
    pub fn imbalance(&self) -> f64 {
        let largest = self.weights.iter().fold(f64::MIN_POSITIVE, |m: f64, w| m.max(w.abs()));
        let sum = |row: &Vec<(u32, f64)>| row.iter().map(|e| e.1).sum::<f64>();
        let rows = self.slave.iter().zip(&self.master).map(|(d, m)| (sum(d) - sum(m)).abs());
        rows.fold(0.0, f64::max) / largest
    }
}
