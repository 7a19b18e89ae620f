//! The list of cells.

use crate::{FacetKind, hex8};

/// A kind of cell that Stoss computes with.
///
/// Deliberately exhaustive: a new variant makes every `match` that needs a decision fail to compile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CellKind {
    /// The trilinear 8-node hexahedron, see [`hex8`].
    Hex8,
}

impl CellKind {
    /// All kinds.
    pub const ALL: [CellKind; 1] = [CellKind::Hex8];

    /// Number of nodes of the cell.
    pub const fn node_count(self) -> usize {
        match self {
            CellKind::Hex8 => hex8::NODE_COUNT,
        }
    }

    /// Number of facets of the cell.
    pub const fn facet_count(self) -> usize {
        self.facets().len()
    }

    /// The kind of all facets.
    pub const fn facet_kind(self) -> FacetKind {
        match self {
            CellKind::Hex8 => FacetKind::Quad4,
        }
    }

    /// Local node numbers of each facet, numbered so that `a1 x a2` points out of the cell.
    pub const fn facets(self) -> &'static [[usize; 4]] {
        match self {
            CellKind::Hex8 => &hex8::FACETS,
        }
    }

    /// Natural coordinates of the nodes.
    pub const fn vertices(self) -> &'static [[f64; 3]] {
        match self {
            CellKind::Hex8 => &hex8::VERTICES,
        }
    }

    /// The cell's name in messages and files.
    pub const fn name(self) -> &'static str {
        match self {
            CellKind::Hex8 => "hex8",
        }
    }
}

impl std::fmt::Display for CellKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
