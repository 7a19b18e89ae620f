//! A structured grid of hexahedra, possibly with cells left out: what blocks are made of.

use stoss_reference_element::hex8;

use crate::{Facet, Mesh};

/// A grid of `divisions` cells. Nodes and cells are numbered with x fastest.
pub(super) struct Grid {
    pub divisions: [usize; 3],
}

impl Grid {
    /// The mesh of the cells that `keep` selects; `place` gives the coordinates of a lattice point. Also returns the lattice
    /// position of each element.
    pub fn mesh(
        &self,
        keep: impl Fn([usize; 3]) -> bool,
        place: impl Fn([usize; 3]) -> [f64; 3],
    ) -> (Mesh, Vec<[usize; 3]>) {
        const UNUSED: u32 = u32::MAX;
        let [nx, ny, nz] = self.divisions;
        let number = |[i, j, k]: [usize; 3]| (k * (ny + 1) + j) * (nx + 1) + i;
        let cells: Vec<[usize; 3]> = lattice([nx, ny, nz]).filter(|&c| keep(c)).collect();
        let corners =
            |c: [usize; 3]| hex8::VERTICES.map(|v| number(std::array::from_fn(|d| c[d] + usize::from(v[d] > 0.0))));
        let mut new = vec![UNUSED; (nx + 1) * (ny + 1) * (nz + 1)];
        for &c in &cells {
            for n in corners(c) {
                new[n] = 0;
            }
        }
        let mut nodes = Vec::with_capacity(new.len());
        for point in lattice([nx + 1, ny + 1, nz + 1]) {
            let n = &mut new[number(point)];
            if *n != UNUSED {
                *n = nodes.len() as u32;
                nodes.push(place(point));
            }
        }
        let elements = cells.iter().map(|&c| corners(c).map(|n| new[n])).collect();
        (Mesh { nodes, elements, ..Mesh::default() }, cells)
    }
}

/// All index triples below `n`, the first index fastest.
fn lattice([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}

/// Numbers of the element's facets in the six directions of the grid.
pub(super) const LEFT: usize = 5;
pub(super) const RIGHT: usize = 3;
pub(super) const FRONT: usize = 2;
pub(super) const BACK: usize = 4;
pub(super) const BOTTOM: usize = 0;
pub(super) const TOP: usize = 1;

/// Adds a facet set: facet `local` of every cell that `select` accepts.
pub(super) fn add_facets(
    mesh: &mut Mesh,
    cells: &[[usize; 3]],
    name: &str,
    local: usize,
    select: impl Fn([usize; 3]) -> bool,
) {
    let facets: Vec<Facet> =
        (0..cells.len()).filter(|&e| select(cells[e])).map(|e| mesh.facet(e as u32, local)).collect();
    mesh.facet_sets.entry(name.to_owned()).or_default().extend(facets);
}

/// Positions `0 = s_0 < ... < s_n = 1` with element sizes in geometric progression, the last `grading` times the first.
pub(super) fn positions(n: usize, grading: f64) -> Vec<f64> {
    let ratio = if n > 1 { grading.powf(1.0 / (n - 1) as f64) } else { 1.0 };
    if ratio == 1.0 {
        return (0..=n).map(|i| i as f64 / n as f64).collect();
    }
    // s_i = (r^i - 1) / (r^n - 1), with expm1 so that nothing is lost for r near 1
    let log = ratio.ln();
    let total = (n as f64 * log).exp_m1();
    let mut s: Vec<f64> = (0..=n).map(|i| (i as f64 * log).exp_m1() / total).collect();
    s[n] = 1.0;
    s
}

/// The point at fraction `s` between `a` and `b`, exact at both ends.
pub(super) fn between(a: f64, b: f64, s: f64) -> f64 {
    if s == 1.0 { b } else { a + (b - a) * s }
}
