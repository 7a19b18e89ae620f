//! The list of cells, and what is asked of one by its kind.

use crate::cells::{HEX8, HEX20, HEX27, TET4, TET10, WEDGE6, WEDGE15};
use crate::table::{CellKind, CellTable, Face, Family, Integration, QuadratureRule};

impl CellKind {
    /// All kinds of cells.
    pub const ALL: [Self; 7] =
        [Self::Hex8, Self::Hex20, Self::Hex27, Self::Tet4, Self::Tet10, Self::Wedge6, Self::Wedge15];

    /// The cell's data.
    pub fn table(self) -> &'static CellTable {
        match self {
            Self::Hex8 => &HEX8,
            Self::Hex20 => &HEX20,
            Self::Hex27 => &HEX27,
            Self::Tet4 => &TET4,
            Self::Tet10 => &TET10,
            Self::Wedge6 => &WEDGE6,
            Self::Wedge15 => &WEDGE15,
        }
    }

    /// The kind with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// The quadratic cell of the same corners that has nodes on edges only; itself if it is quadratic.
    pub fn quadratic(self) -> Self {
        let middles = |kind: &Self| kind.table().edges.len() + kind.table().corners == kind.node_count();
        let of_corners = |kind: &Self| kind.is_quadratic() && middles(kind) && kind.table().linear == self;
        // cannot fail: every linear cell has one, as a test says.
        if self.is_quadratic() { self } else { Self::ALL.into_iter().find(of_corners).unwrap_or(self) }
    }

    /// The cell's name in messages and files.
    pub fn name(self) -> &'static str {
        self.table().name
    }

    /// Number of nodes.
    pub fn node_count(self) -> usize {
        self.table().nodes.len()
    }

    /// The faces.
    pub fn faces(self) -> &'static [Face] {
        self.table().faces
    }

    /// True for cells with nodes on their edges.
    pub fn is_quadratic(self) -> bool {
        !self.table().edges.is_empty()
    }

    /// Quadrature rule of stress and stiffness, if the cell has it.
    pub fn rule(self, integration: Integration) -> Option<QuadratureRule> {
        self.table().rules.iter().find(|(name, _)| *name == integration).map(|(_, rule)| *rule)
    }

    /// Every kind with each of its quadrature rules of stress and stiffness, in the order of [`Self::ALL`].
    pub fn with_rules() -> impl Iterator<Item = (Self, Integration)> {
        Self::ALL.into_iter().flat_map(|kind| kind.table().rules.iter().map(move |(name, _)| (kind, *name)))
    }

    /// Pairs of corners that an edge joins, each once.
    pub fn edges(self) -> &'static [[u8; 2]] {
        match self.table().family {
            Family::Hexahedron => {
                &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
            }
            Family::Tetrahedron => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
            Family::Wedge => &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
        }
    }
}

impl std::fmt::Display for CellKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
