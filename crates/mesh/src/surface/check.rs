//! Everything that makes a surface unusable, as a named error.

use stoss_reference_element::Nodal;

use super::SurfaceMesh;
use crate::vector::{cross, dot, minus, norm};
use crate::{MeshError, SetKind};

/// Areas over the square of a facet's size, and edges over its size, that are no more than this are zero: some thousand
/// times round-off, and far below what coordinates of single precision can resolve.
const ZERO: f64 = 1e-12;

impl SurfaceMesh {
    /// Checks that the surface can be computed with: there are facets, their nodes exist, all coordinates are finite,
    /// no facet is degenerate ([`SurfaceMesh::is_degenerate`]), sets in range. An open surface is no error.
    ///
    /// # Errors
    /// The first problem found, in this order.
    pub fn check(&self) -> Result<(), MeshError> {
        if self.facets.is_empty() {
            return Err(MeshError::NoFacets);
        }
        self.check_node_numbers()?;
        if let Some(n) = self.nodes.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
            return Err(MeshError::NonFiniteNode { node: n as u32, coordinates: self.nodes[n] });
        }
        if let Some(facet) = (0..self.facets.len() as u32).find(|&f| self.is_degenerate(f)) {
            return Err(MeshError::DegenerateFacet { facet, nodes: self.facets[facet as usize].to_vec() });
        }
        self.facet_sets.iter().try_for_each(|(name, set)| self.check_set(name, set))
    }

    /// True if the facet uses a node twice, has no area, an edge of length zero, or a fold: `(a1 x a2) . n <= 0` at a
    /// point of the facet's quadrature rule, with the normal `n` of its mean plane. Lengths below 1e-12 of the facet's size count
    /// as zero.
    ///
    /// # Panics
    /// If the facet or one of its nodes does not exist; this is a programming error.
    pub fn is_degenerate(&self, facet: u32) -> bool {
        let nodes = self.facets[facet as usize];
        (1..nodes.len()).any(|i| nodes[..i].contains(&nodes[i])) || degenerate(&self.facet_coordinates(facet))
    }

    /// Drops degenerate facets, renumbers the sets, drops sets that become empty and nodes that no facet uses any more.
    /// Returns the number of facets dropped. Where a facet had three different nodes on a line, the surface is open
    /// afterwards.
    ///
    /// # Panics
    /// If a node of a facet does not exist; this is a programming error.
    pub fn drop_degenerate(&mut self) -> usize {
        let mut new = vec![None; self.facets.len()];
        let mut facets = Vec::with_capacity(self.facets.len());
        for f in 0..self.facets.len() as u32 {
            if !self.is_degenerate(f) {
                new[f as usize] = Some(facets.len() as u32);
                facets.push(self.facets[f as usize]);
            }
        }
        let dropped = self.facets.len() - facets.len();
        if dropped > 0 {
            self.facets = facets;
            for set in self.facet_sets.values_mut() {
                *set = set.iter().filter_map(|f| new.get(*f as usize).copied().flatten()).collect();
            }
            self.facet_sets.retain(|_, set| !set.is_empty());
            self.drop_unused_nodes();
        }
        dropped
    }

    pub(super) fn check_node_numbers(&self) -> Result<(), MeshError> {
        let count = self.nodes.len();
        for (f, nodes) in self.facets.iter().enumerate() {
            if let Some(&node) = nodes.iter().find(|&&n| n as usize >= count) {
                return Err(MeshError::FacetNodeOutOfRange { facet: f as u32, node, count });
            }
        }
        Ok(())
    }

    pub(super) fn check_set(&self, name: &str, set: &[u32]) -> Result<(), MeshError> {
        let count = self.facets.len();
        match set.iter().find(|&&f| f as usize >= count) {
            None => Ok(()),
            Some(&index) => {
                Err(MeshError::SetOutOfRange { name: name.to_owned(), kind: SetKind::Facets, index, count })
            }
        }
    }
}

fn degenerate(x: &Nodal<[f64; 3]>) -> bool {
    let kind = x.kind();
    // In units of the facet's size, so that nothing overflows.
    let size = (0..3).map(|i| x.iter().map(|p| (p[i] - x[0][i]).abs()).fold(0.0, f64::max)).fold(0.0, f64::max);
    let y = x.map(|p| -> [f64; 3] { std::array::from_fn(|i| (p[i] - x[0][i]) / size) });
    let sum = |weight: &dyn Fn(usize) -> f64| -> [f64; 3] {
        std::array::from_fn(|i| (0..y.len()).map(|k| weight(k) * y[k][i]).sum())
    };
    // Not a number where the size is zero or infinite, which no comparison passes.
    let exceeds = |value: f64| value > ZERO;

    let edges = (0..kind.edge_count()).all(|edge| {
        let [a, b] = kind.side(edge);
        exceeds(norm(minus(y[b], y[a])))
    });
    let [d1, d2] = kind.diagonals();
    let normal = cross(sum(&|k| d1[k]), sum(&|k| d2[k]));
    let area = norm(normal);
    let unfolded = kind.rule().iter().all(|&(xi, _)| {
        let gradient = kind.shape_gradient(xi);
        let n = cross(sum(&|k| gradient[k][0]), sum(&|k| gradient[k][1]));
        exceeds(dot(n, normal) / area)
    });
    !(edges && exceeds(area) && unfolded)
}
