//! Facets of elements, and the search for the elements that own one.

use crate::Elements;
use stoss_reference_element::{CellKind, FaceNodes};

/// One facet of an element: a face of its cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Facet {
    /// The element that the facet belongs to.
    pub element: u32,
    /// The facet's number in the element: row of [`CellKind::faces`].
    pub local: u8,
    /// The nodes, numbered so that `a1 x a2` points out of the element.
    pub nodes: FaceNodes,
}

impl Facet {
    /// Facet `local` of element number `element` of this kind with these nodes.
    ///
    /// # Panics
    /// If the kind has no such facet; this is a programming error.
    pub fn of_element(element: u32, kind: CellKind, nodes: &[u32], local: usize) -> Facet {
        let face = &kind.faces()[local];
        let nodes = FaceNodes::from_fn(face.kind, |k| nodes[usize::from(face.nodes[k])]);
        Facet { element, local: local as u8, nodes }
    }

    /// True if `self` and `other` have the same corners in the same sense of rotation.
    pub(crate) fn same_side(&self, other: &Facet) -> bool {
        let (a, b) = (self.nodes.corners(), other.nodes.corners());
        let n = a.len();
        n == b.len() && (0..n).any(|shift| (0..n).all(|i| a[i] == b[(i + shift) % n]))
    }

    fn key(&self) -> [u32; 4] {
        key(self.nodes.corners())
    }
}

/// Corners in ascending order; the last again behind those of a triangle.
fn key(corners: &[u32]) -> [u32; 4] {
    let mut key = [u32::MAX; 4];
    for (k, &n) in key.iter_mut().zip(corners) {
        *k = n;
    }
    key.sort_unstable();
    key
}

/// All facets of a mesh, inner ones too, searchable by their corners in any order.
#[derive(Debug, Clone, Default)]
pub struct FacetIndex {
    /// Sorted by (sorted corners, element, local).
    entries: Vec<([u32; 4], Facet)>,
}

impl FacetIndex {
    /// The index of these elements.
    pub fn new(elements: &Elements) -> FacetIndex {
        let mut entries = Vec::with_capacity(6 * elements.len());
        for (e, (kind, nodes)) in elements.cells().enumerate() {
            for local in 0..kind.faces().len() {
                let facet = Facet::of_element(e as u32, kind, nodes, local);
                entries.push((facet.key(), facet));
            }
        }
        entries.sort_unstable_by_key(|(key, facet)| (*key, facet.element, facet.local));
        FacetIndex { entries }
    }

    /// The facets with these corners (three or four) in any order: none, one on the boundary, two between elements.
    pub fn find(&self, corners: &[u32]) -> impl ExactSizeIterator<Item = &Facet> {
        let key = key(corners);
        let start = self.entries.partition_point(|(k, _)| *k < key);
        let count = self.entries[start..].partition_point(|(k, _)| *k == key);
        self.entries[start..start + count].iter().map(|(_, facet)| facet)
    }

    /// Groups of facets with the same corners.
    pub(crate) fn groups(&self) -> impl Iterator<Item = &[([u32; 4], Facet)]> {
        self.entries.chunk_by(|a, b| a.0 == b.0)
    }

    /// The facets that only one element has, sorted by element and local number.
    pub fn boundary(&self) -> Vec<Facet> {
        let mut facets: Vec<Facet> = self.groups().filter(|g| g.len() == 1).map(|g| g[0].1).collect();
        facets.sort_unstable_by_key(|facet| (facet.element, facet.local));
        facets
    }
}
