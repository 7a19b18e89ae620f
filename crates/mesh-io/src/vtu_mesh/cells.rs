//! VTK's cell types: which are used, and what to say about the others.

use super::Names;
use crate::contents::{Source, entry};
use crate::place::Place;
use crate::{Contents, MeshIoError};

const QUADRILATERAL: u8 = 9;
const VOXEL: u8 = 11;
const HEXAHEDRON: u8 = 12;

/// Name of a type, and whether it has a volume.
fn describe(kind: u8) -> (&'static str, bool) {
    match kind {
        1 | 2 => ("points", false),
        3 | 4 => ("lines", false),
        5..=7 => ("triangles and polygons", false),
        8 | QUADRILATERAL => ("quadrilaterals", false),
        10 => ("tetrahedra", true),
        13 => ("wedges", true),
        14 => ("pyramids", true),
        21 | 35 => ("quadratic lines", false),
        22 | 23 | 28 | 30 | 32 | 34 | 36 => ("quadratic facets", false),
        24 => ("10-node tetrahedra", true),
        25 => ("20-node hexahedra", true),
        29 => ("27-node hexahedra", true),
        26 | 31 => ("quadratic wedges", true),
        27 | 37 => ("quadratic pyramids", true),
        33 => ("24-node hexahedra", true),
        42 => ("polyhedra", true),
        68..=70 | 75..=77 => ("curved lines and facets", false),
        72 => ("Lagrange hexahedra", true),
        _ => ("cells of another kind", true),
    }
}

/// Adds a cell of a type with its nodes.
pub(super) fn add(
    contents: &mut Contents,
    kind: u8,
    cell: usize,
    nodes: &[u32],
    names: &Names,
    place: Place,
) -> Result<(), MeshIoError> {
    let number = cell as u64;
    match (kind, nodes) {
        (HEXAHEDRON | VOXEL, nodes) => {
            let Ok(mut nodes) = <[u32; 8]>::try_from(nodes) else {
                return Err(contents.error(place, format_args!("cell {cell}"), "a hexahedron needs 8 points"));
            };
            if kind == VOXEL {
                nodes.swap(2, 3);
                nodes.swap(6, 7);
            }
            if let Some(i) = (1..8).find(|&i| nodes[..i].contains(&nodes[i])) {
                let remedy = format!("it has point {} twice: collapsed hexahedra are not supported", nodes[i]);
                return Err(contents.error(place, format_args!("cell {cell}"), remedy));
            }
            let element = contents.elements.len() as u32;
            contents.elements.push(nodes);
            contents.element_source.push(Source { number, place });
            contents.count_cell(if kind == VOXEL { "voxels (type 11)" } else { "hexahedra (type 12)" }, place);
            for name in names.values.iter().chain(&names.choices) {
                entry(&mut contents.element_sets, name).insert(element);
            }
        }
        (QUADRILATERAL, &[a, b, c, d]) if !names.choices.is_empty() => {
            contents.count_cell("quadrilaterals of facet sets (type 9)", place);
            for name in &names.choices {
                entry(&mut contents.quads, name).push(([a, b, c, d], place));
            }
        }
        _ => {
            let (name, has_volume) = describe(kind);
            if has_volume {
                let remedy =
                    "Stoss computes with 8-node hexahedra (type 12): mesh the volume with them, and save linear cells";
                let groups: Vec<String> = names.values.iter().chain(&names.choices).cloned().collect();
                contents.count_other(&format!("{name} (type {kind})"), remedy, Some(&groups), place);
            } else {
                let note = format!("{name} are left out: they have no volume");
                if !contents.notes.contains(&note) {
                    contents.notes.push(note);
                }
            }
        }
    }
    Ok(())
}
