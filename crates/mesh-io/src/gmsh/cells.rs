//! Gmsh's types: which are used, and what to say about the others.

use stoss_reference_element::{CellKind, FaceKind};

/// Gmsh's number of a face, whose nodes are numbered as ours.
pub(crate) fn face_type(kind: FaceKind) -> u32 {
    match kind {
        FaceKind::Tri3 => 2,
        FaceKind::Quad4 => 3,
        FaceKind::Tri6 => 9,
        FaceKind::Quad8 => 16,
        FaceKind::Quad9 => 10,
    }
}

/// What a type is to Stoss.
pub(super) enum Role {
    Cell(CellKind),
    Face(FaceKind),
    /// A line or a point: what has a group is a set of nodes.
    Nodes {
        dimension: usize,
    },
    Other,
}

/// What a type is.
pub(super) fn role(kind: u32) -> Role {
    if let Some(cell) = CellKind::ALL.into_iter().find(|cell| cell.table().gmsh == kind) {
        return Role::Cell(cell);
    }
    match (FaceKind::ALL.into_iter().find(|&face| face_type(face) == kind), kind) {
        (Some(face), _) => Role::Face(face),
        (None, 1 | 8) => Role::Nodes { dimension: 1 },
        (None, 15) => Role::Nodes { dimension: 0 },
        _ => Role::Other,
    }
}

/// The nodes of a cell in our order.
pub(super) fn ours(kind: CellKind, theirs: &[u64]) -> Vec<u64> {
    kind.table().from_gmsh.iter().map(|&i| theirs[usize::from(i)]).collect()
}

/// The nodes of a cell in Gmsh's order.
pub(crate) fn theirs(kind: CellKind, ours: &[u32]) -> Vec<u32> {
    let mut theirs = ours.to_vec();
    for (&node, &i) in ours.iter().zip(kind.table().from_gmsh) {
        theirs[usize::from(i)] = node;
    }
    theirs
}

/// What a cell is called when cells are counted.
pub(super) fn cell_name(kind: CellKind) -> String {
    let name = match kind {
        CellKind::Hex8 => "hexahedra",
        CellKind::Hex20 => "20-node hexahedra",
        CellKind::Hex27 => "27-node hexahedra",
        CellKind::Tet4 => "tetrahedra",
        CellKind::Tet10 => "10-node tetrahedra",
        CellKind::Wedge6 => "prisms",
        CellKind::Wedge15 => "15-node prisms",
    };
    format!("{name} (type {})", kind.table().gmsh)
}

const NO_PYRAMIDS: &str = "Stoss does not compute with pyramids: Gmsh makes them between hexahedra and tetrahedra; mesh each body with hexahedra \
                           (Transfinite Volume with Recombine Surface) or with tetrahedra (without Recombine) and tie them";
const INCOMPLETE: &str = "Stoss computes with 15-node prisms (type 18): in Gmsh set Mesh.SecondOrderIncomplete = 1, which has no nodes on faces";
const ORDER: &str = "Stoss computes with cells of first and second order: in Gmsh set Mesh.ElementOrder = 1 or 2";

/// Number of nodes of a type; `None` for types that a reader need not know.
pub(super) fn node_count(kind: u32) -> Option<usize> {
    // Types 1 to 31 in the order of Gmsh's reference manual, section "MSH file format".
    const COUNTS: [usize; 31] =
        [2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6, 20, 35, 56];
    match kind {
        92 => Some(64),
        93 => Some(125),
        _ => COUNTS.get((kind as usize).checked_sub(1)?).copied(),
    }
}

/// True of types that fill a volume.
pub(super) fn is_volume(kind: u32) -> bool {
    matches!(kind, 4..=7 | 11..=14 | 17..=19 | 29..=31 | 92 | 93)
}

/// What a type is called when cells that are not read are counted, and what to do instead.
pub(super) fn other(kind: u32) -> (String, &'static str) {
    let (name, remedy) = match kind {
        7 => ("pyramids", NO_PYRAMIDS),
        14 => ("14-node pyramids", NO_PYRAMIDS),
        19 => ("13-node pyramids", NO_PYRAMIDS),
        13 => ("18-node prisms", INCOMPLETE),
        20..=25 => ("triangles of higher order", ORDER),
        26..=28 => ("lines of higher order", ORDER),
        29..=31 => ("tetrahedra of higher order", ORDER),
        92 | 93 => ("hexahedra of higher order", ORDER),
        _ => ("cells of another kind", ORDER),
    };
    (format!("{name} (type {kind})"), remedy)
}
