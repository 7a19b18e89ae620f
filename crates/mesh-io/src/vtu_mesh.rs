//! VTK unstructured grids (`.vtu`) of any program as meshes.
//!
//! | in the file | in the mesh |
//! |---|---|
//! | hexahedra (types 12, 25, 29), voxels (11), tetrahedra (10, 24), wedges (13, 26) | elements; nodes on edges stay where they are |
//! | array of the cells of whole numbers, one a cell | element set `array=value` for each value, but not of zeros and ones of a floating-point type |
//! | array of the cells of zeros and ones | also the set `array` of its ones; of triangles (5, 22) and quadrilaterals (9, 23, 28) a facet set |
//! | array of the cells with three components | vectors of the elements, such as directions of fibres |
//! | array of the points of zeros and ones | the node set `array` of its ones |
//!
//! Several pieces are put side by side. Cells without a volume are left out with a note, but for those of a facet set.

use std::collections::BTreeSet;
use std::path::Path;

use crate::contents::{Source, entry};
use crate::include::Include;
use crate::place::FileLocation;
use crate::vtu_cells::{self, Names};
use crate::vtu_file::{self, Named, Piece, Section};
use crate::{Contents, MeshIoError};

/// An array with more different values than this is no list of groups.
const GROUPS: usize = 256;

/// Whether a text begins like a VTU file.
pub(crate) fn recognise(text: &str) -> bool {
    text.contains("<VTKFile") && text.contains("\"UnstructuredGrid\"")
}

/// Reads a file.
pub(crate) fn read(path: &Path, bytes: &[u8], _: Include<'_>) -> Result<Contents, MeshIoError> {
    let wants = |section, components| match section {
        Section::Point => components == 1,
        Section::Cell => components == 1 || components == 3,
        Section::Field => false,
    };
    let file = vtu_file::read(path, bytes, wants)?;
    let mut contents = Contents::new(path, "VTK unstructured grid (VTU)");
    file.pieces.iter().try_for_each(|piece| add(piece, &mut contents))?;
    Ok(contents)
}

/// Puts a piece beside those that are there.
fn add(piece: &Piece, contents: &mut Contents) -> Result<(), MeshIoError> {
    let place = FileLocation { file: 0, at: piece.line as u64 };
    let first_node = contents.nodes.len() as u32;
    if contents.nodes.len() + piece.points.len() >= u32::MAX as usize {
        return Err(contents.error(
            place,
            format_args!("{} points", piece.points.len()),
            "the file has too many points",
        ));
    }
    for x in &piece.points {
        if !x.iter().all(|c| c.is_finite()) {
            return Err(contents.error(place, format_args!("{x:?}"), "expected the finite coordinates of a point"));
        }
        contents.node_source.push(Source { number: contents.nodes.len() as u64, place });
        contents.nodes.push(*x);
    }
    let (vectors, scalars): (Vec<&Named>, Vec<&Named>) = piece.cell_data.iter().partition(|a| a.components == 3);
    let groups = Groups::new(&scalars);
    for (cell, (kind, nodes)) in piece.cells().enumerate() {
        let nodes: Vec<u32> = nodes.iter().map(|n| first_node + n).collect();
        let names = groups.of(cell);
        let before = contents.elements.len();
        vtu_cells::add(contents, kind, cell, &nodes, &names, place)?;
        if contents.elements.len() > before {
            for Named { name, values, .. } in &vectors {
                // Elements of pieces without this array have none.
                let of_elements = contents.element_vectors.entry(name.clone()).or_default();
                of_elements.resize(before, [f64::NAN; 3]);
                of_elements.push(values.as_chunks::<3>().0[cell]);
            }
        }
    }
    for Named { name, values, .. } in piece.point_data.iter().filter(|a| is_choice(&a.values)) {
        let chosen = (0..piece.points.len()).filter(|&n| values[n] == 1.0).map(|n| first_node + n as u32);
        entry(&mut contents.node_sets, name).extend(chosen);
    }
    Ok(())
}

/// Zeros and ones, not only zeros.
fn is_choice(values: &[f64]) -> bool {
    values.iter().all(|&v| v == 0.0 || v == 1.0) && values.contains(&1.0)
}

/// The arrays that make groups.
struct Groups<'a> {
    arrays: Vec<(&'a Named, bool)>,
}

impl<'a> Groups<'a> {
    fn new(arrays: &[&'a Named]) -> Groups<'a> {
        let few = |values: &[f64]| {
            let mut seen = BTreeSet::new();
            values.iter().all(|v| {
                v.fract() == 0.0 && v.abs() < 1e15 && {
                    seen.insert(*v as i64);
                    seen.len() <= GROUPS
                }
            })
        };
        let arrays = arrays.iter().filter(|a| few(&a.values)).map(|&a| (a, is_choice(&a.values))).collect();
        Groups { arrays }
    }

    fn of(&self, cell: usize) -> Names {
        let mut names = Names { values: Vec::new(), choices: Vec::new() };
        for (Named { name, values, is_integer, .. }, is_choice) in &self.arrays {
            // Zeros and ones that are no integers are a set and its rest, as this crate writes them.
            if *is_integer || !*is_choice {
                names.values.push(format!("{name}={}", values[cell]));
            }
            if *is_choice && values[cell] == 1.0 {
                names.choices.push(name.clone());
            }
        }
        names
    }
}
