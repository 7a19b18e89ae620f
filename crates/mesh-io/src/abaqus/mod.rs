//! Abaqus and CalculiX input files: nodes, solid elements, node, element and surface sets, parts and their instances.
//!
//! | in the file | in the mesh |
//! |---|---|
//! | `*NODE`, `*ELEMENT, TYPE=C3D8`, `C3D20`, `C3D27`, `C3D4`, `C3D10`, `C3D6`, `C3D15` | nodes, elements |
//! | variants of these, as `C3D20R`, `C3D8I`, `C3D10M`, `C3D10H` | the same, with a note that says how it is computed here |
//! | `*NSET`, `*NODE, NSET=`, `*SURFACE, TYPE=NODE` | node set |
//! | `*ELSET`, `*ELEMENT, ELSET=` | element set |
//! | `*SURFACE, TYPE=ELEMENT` | facet set; S1, S2 and so on are the rows of the cell's faces; without a face: all free faces |
//! | `*PART`, `*INSTANCE` | a group of elements by the name of the instance, in its place (translation, then rotation) |
//! | `*INCLUDE, INPUT=`, `*NODE, INPUT=` and the like | the content of the file, whose name is relative to the folder of the file that has it |
//!
//! A flat file is one part with one instance; so is a part without an instance. Sets of an instance are called `instance.set` where
//! there are several instances, and `set` where there is one. Coordinates that are left out are zero. Names keep the spelling of
//! their first occurrence; within the file they are compared without regard to case. Sets of an assembly that refer to nodes of
//! the assembly itself (reference points) lose them. Keywords that would change the mesh and are not read (`*NGEN`, ...) are refused;
//! all others (materials, steps, ...) are skipped; [`deck`] keeps
//! them for a reader of the whole file.

mod block;
mod data_lines;
pub mod deck;
mod fields;
mod flatten;
mod keyword;
mod model;
mod reader;
mod section;
mod sets;
mod types;

use std::path::Path;

use crate::include::Include;
use crate::{Contents, MeshIoError};

/// Whether a text looks like an input file.
pub(crate) fn recognise(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim_start).filter(|l| !l.is_empty() && !l.starts_with("**")).take(200);
    lines.any(|l| {
        let keyword: String = l.chars().take_while(|c| *c != ',').collect::<String>().trim_end().to_uppercase();
        ["*NODE", "*HEADING", "*PART", "*INCLUDE"].contains(&keyword.as_str())
    })
}

/// Reads a file.
pub(crate) fn read(path: &Path, bytes: &[u8], include: Include<'_>) -> Result<Contents, MeshIoError> {
    // Names of sets may be in any encoding; everything else is ASCII.
    reader::Reader::new(path, include).read(path, &String::from_utf8_lossy(bytes)).map(|(contents, _)| contents)
}
