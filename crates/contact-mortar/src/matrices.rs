//! Mortar matrices of a pair of surfaces.

use crate::{Faces, Factors, MultiplierBasis, MultiplierSpace, SurfaceSegmentation, facet_integrals};
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

/// Local numbers of the nodes that positions of points of a facet are made of. All nodes of a face are corners of its pieces.
fn local_nodes(surface: &ContactSurface, faces: &Faces, facet: u32) -> Vec<u32> {
    let nodes = faces.nodes(surface, facet).iter();
    nodes.map(|&node| surface.nodes().partition_point(|&n| n < node) as u32).collect()
}

impl MortarMatrices {
    /// Integrates over all segments at positions `q`, those of the segmentation. There are no [`Factors`]: contact has others where facets are far from
    /// opposed or deep. `faces`: the quadratic faces that facets of slave and master are pieces of; the matrices belong to their nodes then.
    pub fn assemble(
        slave: &ContactSurface,
        master: &ContactSurface,
        faces: [&Faces; 2],
        q: &[f64],
        segments: &SurfaceSegmentation,
        space: MultiplierSpace,
    ) -> Self {
        let count = slave.nodes().len();
        let mut out =
            Self { slave: vec![Vec::new(); count], master: vec![Vec::new(); count], weights: vec![0.0; count] };
        for (facet, found) in segments.facets.iter().enumerate() {
            if found.segments.is_empty() {
                continue;
            }
            let (face, of_master) = (faces[0].of(facet as u32), faces[1]);
            let corners = |f| master.patch(f, q).corners;
            let integrals = facet_integrals(found, corners, face, of_master, &Factors::NONE);
            let basis = MultiplierBasis::new(space, &integrals);
            let d = basis.slave_block(&integrals);
            let nodes = slave.local_facets()[facet];
            let positions = local_nodes(slave, faces[0], facet as u32);
            for (a, &row) in nodes.iter().enumerate() {
                let row = row as usize;
                out.weights[row] += d.sum_of_row(a);
                let entries = positions.iter().enumerate().map(|(j, &node)| (node, d.at(a, j)));
                out.slave[row].extend(entries.filter(|(_, d)| *d != 0.0));
            }
            for pair in &integrals.pairs {
                let m = basis.master_block(pair);
                let opposite = local_nodes(master, of_master, pair.master_facet);
                for (a, &row) in nodes.iter().enumerate() {
                    out.master[row as usize].extend(opposite.iter().enumerate().map(|(k, &node)| (node, m.at(a, k))));
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
