//! Gmsh's cell types: which are used, and what to say about the others.

pub(super) const LINE: u32 = 1;
pub(super) const QUADRILATERAL: u32 = 3;
pub(super) const HEXAHEDRON: u32 = 5;
pub(super) const POINT: u32 = 15;

const RECOMBINE: &str = "in Gmsh use Transfinite Volume with Recombine Surface, or Mesh.RecombineAll = 1 with Mesh.SubdivisionAlgorithm = 2 \
                         (all hexahedra)";
const FIRST_ORDER: &str = "in Gmsh set Mesh.ElementOrder = 1";

/// Name and advice.
fn describe(kind: u32) -> (&'static str, &'static str) {
    match kind {
        2 => ("triangles", RECOMBINE),
        4 => ("tetrahedra", RECOMBINE),
        6 => ("prisms", RECOMBINE),
        7 => ("pyramids", RECOMBINE),
        8 => ("3-node lines", FIRST_ORDER),
        9 => ("6-node triangles", FIRST_ORDER),
        10 => ("9-node quadrilaterals", FIRST_ORDER),
        11 => ("10-node tetrahedra", RECOMBINE),
        12 => ("27-node hexahedra", FIRST_ORDER),
        13 => ("18-node prisms", RECOMBINE),
        14 => ("14-node pyramids", RECOMBINE),
        16 => ("8-node quadrilaterals", FIRST_ORDER),
        17 => ("20-node hexahedra", FIRST_ORDER),
        18 => ("15-node prisms", RECOMBINE),
        19 => ("13-node pyramids", RECOMBINE),
        _ => ("cells of another kind", "in Gmsh set Mesh.ElementOrder = 1 and recombine"),
    }
}

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

/// What a type is called when cells are counted, and what to do instead.
pub(super) fn other(kind: u32) -> (String, String) {
    let (name, advice) = describe(kind);
    (format!("{name} (type {kind})"), format!("Stoss computes with 8-node hexahedra (type 5); {advice}"))
}
