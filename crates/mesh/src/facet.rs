//! Facets of elements, and the search for the elements that own one.

use stoss_reference_element::hex8;

/// One facet of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Facet {
    /// The element that the facet belongs to.
    pub element: u32,
    /// The facet's number in the element: row of [`hex8::FACETS`].
    pub local: u8,
    /// The nodes in the order of `quad4`, numbered so that `a1 x a2` points out of the element.
    pub nodes: [u32; 4],
}

impl Facet {
    /// Facet `local` (0 to 5) of element number `element` with these nodes.
    ///
    /// # Panics
    /// If `local > 5`; this is a programming error.
    pub fn of_element(element: u32, nodes: &[u32; 8], local: usize) -> Facet {
        Facet { element, local: local as u8, nodes: hex8::FACETS[local].map(|i| nodes[i]) }
    }

    /// True if `self` and `other` have the same nodes in the same sense of rotation.
    pub fn same_side(&self, other: &Facet) -> bool {
        (0..4).any(|shift| (0..4).all(|i| self.nodes[i] == other.nodes[(i + shift) % 4]))
    }

    fn key(&self) -> [u32; 4] {
        sorted(self.nodes)
    }
}

fn sorted(mut nodes: [u32; 4]) -> [u32; 4] {
    nodes.sort_unstable();
    nodes
}

/// All facets of a mesh, inner ones too, searchable by their nodes in any order.
#[derive(Debug, Clone, Default)]
pub struct FacetIndex {
    /// Sorted by (sorted nodes, element, local).
    entries: Vec<([u32; 4], Facet)>,
}

impl FacetIndex {
    /// The index of these elements.
    pub fn new(elements: &[[u32; 8]]) -> FacetIndex {
        let mut entries = Vec::with_capacity(6 * elements.len());
        for (e, nodes) in elements.iter().enumerate() {
            for local in 0..hex8::FACETS.len() {
                let facet = Facet::of_element(e as u32, nodes, local);
                entries.push((facet.key(), facet));
            }
        }
        entries.sort_unstable();
        FacetIndex { entries }
    }

    /// The facets with these four nodes in any order: none, one on the boundary, two between elements.
    pub fn find(&self, nodes: [u32; 4]) -> impl ExactSizeIterator<Item = &Facet> {
        let key = sorted(nodes);
        let start = self.entries.partition_point(|(k, _)| *k < key);
        let count = self.entries[start..].partition_point(|(k, _)| *k == key);
        self.entries[start..start + count].iter().map(|(_, facet)| facet)
    }

    /// Groups of facets with the same nodes.
    pub(crate) fn groups(&self) -> impl Iterator<Item = &[([u32; 4], Facet)]> {
        self.entries.chunk_by(|a, b| a.0 == b.0)
    }

    /// The facets that only one element has, sorted by element and local number.
    pub fn boundary(&self) -> Vec<Facet> {
        let mut facets: Vec<Facet> = self.groups().filter(|g| g.len() == 1).map(|g| g[0].1).collect();
        facets.sort_unstable();
        facets
    }
}
