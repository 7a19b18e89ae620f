//! The list of formats, and the choice among them.

use std::path::Path;

use stoss_mesh::Mesh;

use crate::{MeshIoError, abaqus, gmsh};

/// A mesh format.
pub struct Format {
    /// Its name in messages.
    pub name: &'static str,
    /// Extensions in lower case, without the point.
    pub extensions: &'static [&'static str],
    /// True if the beginning of a text looks like this format; asked only if the extension decides nothing.
    pub recognise: fn(&str) -> bool,
    /// The reader; the path serves messages only.
    pub read: fn(&Path, &str) -> Result<Mesh, MeshIoError>,
}

/// All formats.
pub const FORMATS: &[Format] = &[
    Format { name: "Gmsh MSH 2.2 and 4.1 (text)", extensions: &["msh"], recognise: gmsh::recognise, read: gmsh::read },
    Format { name: "Abaqus input", extensions: &["inp"], recognise: abaqus::recognise, read: abaqus::read },
];

/// Reads a mesh file: the format follows from the extension, or else from the content. The mesh is checked
/// ([`Mesh::check`]); nodes that no hexahedron uses are dropped, and so are sets that have nothing else.
///
/// # Errors
/// Everything in [`MeshIoError`] that concerns reading.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<Mesh, MeshIoError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| MeshIoError::Io { path: path.to_owned(), source })?;
    // names of sets may be in any encoding; everything else is ASCII
    read_mesh_from_str(path, &String::from_utf8_lossy(&bytes))
}

/// [`read_mesh`] for a text in memory; `path` chooses the format and stands in messages.
///
/// # Errors
/// As for [`read_mesh`].
pub fn read_mesh_from_str(path: impl AsRef<Path>, text: &str) -> Result<Mesh, MeshIoError> {
    let path = path.as_ref();
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let format = FORMATS
        .iter()
        .find(|f| f.extensions.contains(&extension.as_str()))
        .or_else(|| FORMATS.iter().find(|f| (f.recognise)(text)));
    match format {
        Some(format) => (format.read)(path, text),
        None => Err(MeshIoError::UnknownFormat {
            path: path.to_owned(),
            known: FORMATS.iter().map(|f| format!("{} (.{})", f.name, f.extensions.join(", ."))).collect(),
        }),
    }
}
