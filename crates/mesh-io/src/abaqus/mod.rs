//! Abaqus input files: nodes, C3D8 elements, node, element and surface sets.
//!
//! | in the file | in the mesh |
//! |---|---|
//! | `*NODE`, `*ELEMENT, TYPE=C3D8` | nodes, elements (the numbering of the nodes is the same) |
//! | `*NSET`, `*NODE, NSET=`, `*SURFACE, TYPE=NODE` | node set |
//! | `*ELSET`, `*ELEMENT, ELSET=` | element set |
//! | `*SURFACE, TYPE=ELEMENT` | facet set; S1 to S6 are the rows of `hex8::FACETS`; without a face: all free faces |
//!
//! Flat files, and files with one part and one instance, whose placement is applied. Names keep the spelling of their first
//! occurrence; within the file they are compared without regard to case. Sets of an assembly that refer to nodes of the
//! assembly itself (reference points) lose them. Keywords that would change the mesh and are not read (`*INCLUDE`, `*NGEN`,
//! ...) are refused; all others (materials, steps, ...) are skipped: no physics of a file is read.

mod data;
mod keyword;
mod reader;
mod sets;

use std::path::Path;

use stoss_mesh::Mesh;

use crate::MeshIoError;

/// Does a text look like an input file?
pub(crate) fn recognise(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim_start).filter(|l| !l.is_empty() && !l.starts_with("**")).take(200);
    lines.any(|l| {
        let keyword: String = l.chars().take_while(|c| *c != ',').collect::<String>().trim_end().to_uppercase();
        ["*NODE", "*HEADING", "*PART"].contains(&keyword.as_str())
    })
}

/// Reads a file.
pub(crate) fn read(path: &Path, text: &str) -> Result<Mesh, MeshIoError> {
    reader::Reader::new(path).read(text)
}
