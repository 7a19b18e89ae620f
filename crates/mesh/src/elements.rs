//! The elements of a mesh: kinds and nodes. Not their places, not their sets.

use stoss_reference_element::CellKind;

/// Elements of one kind that follow each other.
#[derive(Debug, Clone, PartialEq)]
pub struct CellBlock {
    kind: CellKind,
    first: u32,
    nodes: Vec<u32>,
}

impl CellBlock {
    /// The kind of the elements.
    pub fn kind(&self) -> CellKind {
        self.kind
    }

    /// Number of the first element in the mesh.
    pub fn first(&self) -> u32 {
        self.first
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.nodes.len() / self.kind.node_count()
    }

    /// Blocks are not empty.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The nodes of all elements, one element after the other.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The nodes of each element.
    pub fn iter(&self) -> std::slice::ChunksExact<'_, u32> {
        self.nodes.chunks_exact(self.kind.node_count())
    }
}

/// Elements of any kinds, numbered from 0. Kept as blocks of one kind each: a mesh of one kind is one block.
///
/// `elements[e]` are the nodes of element `e` in the order of its [`CellKind`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Elements {
    blocks: Vec<CellBlock>,
}

impl Elements {
    /// A set without elements.
    pub fn new() -> Self {
        Self::default()
    }

    /// Elements of one kind.
    ///
    /// # Panics
    /// If the number of nodes is not a multiple of that of the kind; this is a programming error.
    pub fn of_kind(kind: CellKind, nodes: Vec<u32>) -> Self {
        assert!(nodes.len().is_multiple_of(kind.node_count()), "{} nodes of {kind}", nodes.len());
        let blocks = if nodes.is_empty() { Vec::new() } else { vec![CellBlock { kind, first: 0, nodes }] };
        Self { blocks }
    }

    /// Adds an element.
    ///
    /// # Panics
    /// If the number of nodes is not that of the kind; this is a programming error.
    pub fn push(&mut self, kind: CellKind, nodes: &[u32]) {
        assert_eq!(nodes.len(), kind.node_count(), "nodes of {kind}");
        match self.blocks.last_mut() {
            Some(block) if block.kind == kind => block.nodes.extend_from_slice(nodes),
            _ => {
                let first = self.len() as u32;
                self.blocks.push(CellBlock { kind, first, nodes: nodes.to_vec() });
            }
        }
    }

    /// The blocks in the order of the elements.
    pub fn blocks(&self) -> &[CellBlock] {
        &self.blocks
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.first as usize + block.len())
    }

    /// True without elements.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// The block of an element, and its place in there.
    fn locate(&self, element: usize) -> (usize, usize) {
        let block = self.blocks.partition_point(|block| block.first as usize <= element).saturating_sub(1);
        (block, element - self.blocks[block].first as usize)
    }

    /// The kind of an element.
    ///
    /// # Panics
    /// If there is no such element; this is a programming error.
    pub fn kind(&self, element: usize) -> CellKind {
        self.blocks[self.locate(element).0].kind
    }

    /// Kinds that occur, sorted.
    pub fn kinds(&self) -> Vec<CellKind> {
        let mut kinds: Vec<CellKind> = self.blocks.iter().map(CellBlock::kind).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }

    /// The nodes of each element.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> + Clone + '_ {
        self.blocks.iter().flat_map(CellBlock::iter)
    }

    /// Kind and nodes of each element.
    pub fn cells(&self) -> impl Iterator<Item = (CellKind, &[u32])> + Clone + '_ {
        self.blocks.iter().flat_map(|block| block.iter().map(|nodes| (block.kind, nodes)))
    }

    /// Adds a trilinear hexahedron.
    pub(crate) fn push_hex8(&mut self, nodes: [u32; 8]) {
        self.push(CellKind::Hex8, &nodes);
    }

    /// Adds the elements of another mesh with their nodes' numbers changed.
    pub fn extend(&mut self, other: &Elements, node: impl Fn(u32) -> u32) {
        let mut renumbered = Vec::new();
        for (kind, nodes) in other.cells() {
            renumbered.clear();
            renumbered.extend(nodes.iter().map(|&n| node(n)));
            self.push(kind, &renumbered);
        }
    }
}

impl std::ops::Index<usize> for Elements {
    type Output = [u32];
    fn index(&self, element: usize) -> &[u32] {
        let (block, local) = self.locate(element);
        let block = &self.blocks[block];
        let n = block.kind.node_count();
        &block.nodes[n * local..n * (local + 1)]
    }
}

impl std::ops::IndexMut<usize> for Elements {
    fn index_mut(&mut self, element: usize) -> &mut [u32] {
        let (block, local) = self.locate(element);
        let block = &mut self.blocks[block];
        let n = block.kind.node_count();
        &mut block.nodes[n * local..n * (local + 1)]
    }
}

impl From<Vec<[u32; 8]>> for Elements {
    /// Trilinear hexahedra.
    fn from(hexahedra: Vec<[u32; 8]>) -> Self {
        Self::of_kind(CellKind::Hex8, hexahedra.into_flattened())
    }
}

impl FromIterator<[u32; 8]> for Elements {
    fn from_iter<I: IntoIterator<Item = [u32; 8]>>(hexahedra: I) -> Self {
        hexahedra.into_iter().collect::<Vec<_>>().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_keep_their_order_and_kinds() {
        let mut elements = Elements::new();
        let tet = |n: u32| [n, n + 1, n + 2, n + 3];
        let hex: Vec<u32> = (20..28).collect();
        elements.push(CellKind::Tet4, &tet(0));
        elements.push(CellKind::Tet4, &tet(4));
        elements.push(CellKind::Hex8, &hex);
        elements.push(CellKind::Tet4, &tet(8));
        assert_eq!((elements.len(), elements.blocks().len()), (4, 3));
        assert_eq!(elements.kinds(), [CellKind::Hex8, CellKind::Tet4]);
        assert_eq!((&elements[1], &elements[2], &elements[3]), (&tet(4)[..], &hex[..], &tet(8)[..]));
        assert_eq!((elements.kind(1), elements.kind(2)), (CellKind::Tet4, CellKind::Hex8));
        assert!(elements.iter().eq((0..4).map(|e| &elements[e])));
        assert_eq!(elements.blocks()[2].first(), 3);
        elements[3][0] = 99;
        assert_eq!(elements[3][0], 99);
        let mut twice = elements.clone();
        twice.extend(&elements, |n| n + 100);
        assert_eq!((twice.len(), twice.kind(4), twice[6][7]), (8, CellKind::Tet4, 127));
        assert!(Elements::new().is_empty() && Elements::of_kind(CellKind::Tet4, Vec::new()).is_empty());
    }
}
