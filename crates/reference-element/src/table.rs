//! Cells as data: what one cell has and another has not is in its [`CellTable`].

use crate::FaceKind;

/// Most nodes of a cell.
pub const MAX_CELL_NODES: usize = 27;

/// Shape functions of a cell, zero beyond its nodes.
pub type ShapeFunctions = [f64; MAX_CELL_NODES];
/// Gradients of the shape functions of a cell: row the node, column the direction; zero beyond its nodes.
pub type ShapeGradient = [[f64; 3]; MAX_CELL_NODES];
/// Quadrature rule of a cell: points in natural coordinates and weights, which add up to the cell's volume there.
pub type QuadratureRule = &'static [([f64; 3], f64)];

/// The shape of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Family {
    /// `[-1, 1]^3`.
    Hexahedron,
    /// The corners `(0,0,0), (1,0,0), (0,1,0), (0,0,1)`.
    Tetrahedron,
    /// The triangle `(0,0), (1,0), (0,1)` times `[-1, 1]`.
    Wedge,
}

impl Family {
    /// Natural coordinates of the centre.
    pub const fn centre(self) -> [f64; 3] {
        match self {
            Self::Hexahedron => [0.0; 3],
            Self::Tetrahedron => [0.25; 3],
            Self::Wedge => [1.0 / 3.0, 1.0 / 3.0, 0.0],
        }
    }

    /// Volume in natural coordinates.
    pub const fn volume(self) -> f64 {
        match self {
            Self::Hexahedron => 8.0,
            Self::Tetrahedron => 1.0 / 6.0,
            Self::Wedge => 1.0,
        }
    }

    /// Tetrahedra that the corners are divided into for coarse purposes.
    pub const fn tetrahedra(self) -> &'static [[usize; 4]] {
        match self {
            Self::Hexahedron => &[[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]],
            Self::Tetrahedron => &[[0, 1, 2, 3]],
            Self::Wedge => &[[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]],
        }
    }

    /// How far `xi` lies outside of the cell, in halves of an edge: positive outside, zero on the boundary.
    pub fn excess(self, xi: [f64; 3]) -> f64 {
        let [x, y, z] = xi;
        match self {
            Self::Hexahedron => x.abs().max(y.abs()).max(z.abs()) - 1.0,
            Self::Tetrahedron => 2.0 * (x + y + z - 1.0).max(-x).max(-y).max(-z),
            Self::Wedge => (2.0 * (x + y - 1.0).max(-x).max(-y)).max(z.abs() - 1.0),
        }
    }
}

/// Choice of the points of a cell at which stress and stiffness are taken.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Integration {
    /// Full integration: as many points as the cell needs to have no mode without stiffness. For tet10 the 8 points that see the corners, where such a
    /// cell collapses first.
    #[default]
    Full,
    /// Fewer points: 8 of hex20, which then bends without locking and has six modes without stiffness of its own; 4 of tet10, which do not
    /// see its corners.
    Reduced,
}

/// A face of a cell.
#[derive(Debug)]
pub struct Face {
    /// Kind of the face.
    pub kind: FaceKind,
    /// Local nodes in the order of the kind; `a1 x a2` points out of the cell.
    pub nodes: &'static [u8],
}

/// What there is to know of a cell without its nodes' places. One constant a cell, [`CellKind::table`].
#[derive(Debug)]
pub struct CellTable {
    /// Name in messages and files.
    pub name: &'static str,
    /// Description, a sentence.
    pub about: &'static str,
    /// Shape of the cell.
    pub family: Family,
    /// Natural coordinates of the nodes, corners first.
    pub nodes: &'static [[f64; 3]],
    /// Number of corners.
    pub corners: usize,
    /// Edges with a node in the middle: two corners and that node; empty for linear cells.
    pub edges: &'static [[u8; 3]],
    /// The faces, in the order of Abaqus' S1, S2 and so on.
    pub faces: &'static [Face],
    /// The linear cell with the same corners.
    pub linear: CellKind,
    /// Quadrature rules of stress and stiffness; the first is the default.
    pub rules: &'static [(Integration, QuadratureRule)],
    /// Quadrature rule of mass and volume forces: exact for products of shape functions on cells with straight edges (parallelepipeds, if a hexahedron).
    pub mass: QuadratureRule,
    /// Shape functions at natural coordinates.
    pub shape: fn([f64; 3]) -> ShapeFunctions,
    /// Gradients of the shape functions at natural coordinates.
    pub shape_gradient: fn([f64; 3]) -> ShapeGradient,
    /// VTK's number of the cell, whose order of nodes is ours.
    pub vtk: u8,
    /// Gmsh's number of the cell.
    pub gmsh: u32,
    /// Node `i` is Gmsh's node `from_gmsh[i]`.
    pub from_gmsh: &'static [u8],
    /// Names in Abaqus and CalculiX that are read as this cell.
    pub abaqus: &'static [&'static str],
    /// Node `i` is Abaqus' node `from_abaqus[i]`.
    pub from_abaqus: &'static [u8],
}

/// A kind of cell that Stoss computes with.
///
/// Deliberately exhaustive: a new variant makes every `match` that needs a decision fail to compile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CellKind {
    /// The trilinear 8-node hexahedron, see [`crate::hex8`].
    Hex8,
    /// The 20-node serendipity hexahedron.
    Hex20,
    /// The triquadratic 27-node hexahedron.
    Hex27,
    /// The linear tetrahedron.
    Tet4,
    /// The quadratic tetrahedron.
    Tet10,
    /// The linear wedge.
    Wedge6,
    /// The 15-node serendipity wedge.
    Wedge15,
}
