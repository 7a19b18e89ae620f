//! VTK's cell types: which are used, and what to say about the others.

use stoss_reference_element::{CellKind, FaceKind, FacetNodes};

use crate::contents::{Source, entry};
use crate::place::FileLocation;
use crate::{Contents, MeshIoError};

const VOXEL: u8 = 11;

/// The groups of a cell.
pub(crate) struct Names {
    /// `array=value`.
    pub values: Vec<String>,
    /// Arrays of zeros and ones.
    pub choices: Vec<String>,
}

/// Name of a type, and whether it has a volume.
fn describe(kind: u8) -> (&'static str, bool) {
    match kind {
        1 | 2 => ("points", false),
        3 | 4 => ("lines", false),
        5..=7 => ("triangles and polygons", false),
        8 | 9 => ("quadrilaterals", false),
        10 => ("tetrahedra", true),
        VOXEL => ("voxels", true),
        12 => ("hexahedra", true),
        13 => ("wedges", true),
        14 => ("pyramids", true),
        21 | 35 => ("quadratic lines", false),
        22 | 23 | 28 | 30 | 34 | 36 => ("quadratic facets", false),
        24 => ("10-node tetrahedra", true),
        25 => ("20-node hexahedra", true),
        26 => ("15-node wedges", true),
        27 => ("13-node pyramids", true),
        29 => ("27-node hexahedra", true),
        31 => ("12-node wedges", true),
        32 => ("18-node wedges", true),
        33 => ("24-node hexahedra", true),
        37 => ("19-node pyramids", true),
        42 => ("polyhedra", true),
        68..=70 | 75..=77 => ("curved lines and facets", false),
        71 | 78 => ("curved tetrahedra", true),
        72 | 79 => ("curved hexahedra", true),
        73 | 80 => ("curved wedges", true),
        74 | 81 => ("curved pyramids", true),
        _ => ("cells of another kind", true),
    }
}

/// What a face is called when cells are counted.
fn face_name(face: FaceKind) -> &'static str {
    match face {
        FaceKind::Tri3 => "triangles",
        FaceKind::Quad4 => "quadrilaterals",
        FaceKind::Tri6 => "6-node triangles",
        FaceKind::Quad8 => "8-node quadrilaterals",
        FaceKind::Quad9 => "9-node quadrilaterals",
    }
}

/// What to do instead of a type that has a volume.
fn remedy(kind: u8) -> &'static str {
    match kind {
        14 | 27 | 37 | 74 | 81 => {
            "Stoss does not compute with pyramids: mesh each body with hexahedra or with tetrahedra, and tie them"
        }
        31..=33 => "Stoss computes with wedges of 6 and 15 nodes and hexahedra of 8, 20 and 27: save one of these",
        71..=73 | 78..=80 => {
            "Stoss computes with VTK's linear and quadratic cells: save those (types 10, 12, 13, 24, 25, 26, 29), not Lagrange or Bezier cells"
        }
        _ => {
            "Stoss computes with hexahedra, tetrahedra and wedges (types 10, 12, 13, 24, 25, 26, 29): mesh the volume with them"
        }
    }
}

/// Adds a cell of a type with its nodes.
pub(crate) fn add(
    contents: &mut Contents,
    kind: u8,
    cell: usize,
    nodes: &[u32],
    names: &Names,
    place: FileLocation,
) -> Result<(), MeshIoError> {
    let solid = match kind {
        VOXEL => Some(CellKind::Hex8),
        _ => CellKind::ALL.into_iter().find(|cell| cell.table().vtk == kind),
    };
    let face = FaceKind::ALL.into_iter().find(|face| face.vtk() == kind);
    let (name, has_volume) = describe(kind);
    let check = |contents: &Contents, count| {
        if nodes.len() == count {
            return Ok(());
        }
        let remedy = format!("{name} (type {kind}) need {count} points each, and it has {}", nodes.len());
        Err(contents.error(place, format_args!("cell {cell}"), remedy))
    };
    if let Some(solid) = solid {
        check(contents, solid.node_count())?;
        let mut nodes = nodes.to_vec();
        if kind == VOXEL {
            nodes.swap(2, 3);
            nodes.swap(6, 7);
        }
        if let Some(i) = (1..nodes.len()).find(|&i| nodes[..i].contains(&nodes[i])) {
            let remedy = format!("it has point {} twice: collapsed elements are not supported", nodes[i]);
            return Err(contents.error(place, format_args!("cell {cell}"), remedy));
        }
        let element = contents.element_source.len() as u32;
        contents.elements.push(solid, &nodes);
        contents.element_source.push(Source { number: cell as u64, place });
        contents.count_cell(&format!("{name} (type {kind})"), place);
        for name in names.values.iter().chain(&names.choices) {
            entry(&mut contents.element_sets, name).insert(element);
        }
    } else if let (Some(face), false) = (face, names.choices.is_empty()) {
        check(contents, face.node_count())?;
        contents.count_cell(&format!("{} of facet sets (type {kind})", face_name(face)), place);
        for name in &names.choices {
            entry(&mut contents.faces, name).push((FacetNodes::from_fn(face.linear(), |k| nodes[k]), place));
        }
    } else if has_volume {
        let groups: Vec<String> = names.values.iter().chain(&names.choices).cloned().collect();
        contents.count_other(&format!("{name} (type {kind})"), remedy(kind), Some(&groups), place);
    } else {
        let note = format!("{name} are left out: they have no volume");
        if !contents.notes.contains(&note) {
            contents.notes.push(note);
        }
    }
    Ok(())
}
