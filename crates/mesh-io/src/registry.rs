//! The list of formats, and the choice among them.

use std::io;
use std::path::Path;

use stoss_mesh::Mesh;

use crate::include::Include;
use crate::{Contents, MeshIoError, abaqus, gmsh, vtu_mesh};

/// A mesh format.
pub struct Format {
    /// Name of the format in messages.
    pub name: &'static str,
    /// Extensions in lower case, without the point.
    pub extensions: &'static [&'static str],
    /// True if the beginning of a file looks like this format; asked only if the extension decides nothing.
    pub recognise: fn(&str) -> bool,
    /// The reader; the path is used in messages and for the names of included files only.
    pub read: fn(&Path, &[u8], Include<'_>) -> Result<Contents, MeshIoError>,
}

/// All formats.
pub const FORMATS: &[Format] = &[
    Format { name: "Gmsh MSH 2.2 and 4.1", extensions: &["msh"], recognise: gmsh::recognise, read: gmsh::read },
    Format { name: "Abaqus input", extensions: &["inp"], recognise: abaqus::recognise, read: abaqus::read },
    Format {
        name: "VTK unstructured grid",
        extensions: &["vtu"],
        recognise: vtu_mesh::recognise,
        read: vtu_mesh::read,
    },
];

/// The number of bytes that decide about the format if the extension does not.
const BEGINNING: usize = 1 << 16;

/// Reads a mesh file: the format follows from the extension, or else from the content. The mesh is checked
/// ([`Contents::mesh`]); nodes that no element uses are dropped, and so are sets that have nothing else.
///
/// # Errors
/// Everything in [`MeshIoError`] that concerns reading.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<Mesh, MeshIoError> {
    read_contents(path)?.mesh(None)
}

/// The contents of a mesh file, before a group is chosen and the mesh is checked.
///
/// # Errors
/// The errors of [`read_mesh`], but for what is wrong with the mesh itself.
pub fn read_contents(path: impl AsRef<Path>) -> Result<Contents, MeshIoError> {
    let path = path.as_ref();
    let bytes = crate::include::regular(path).map_err(|source| MeshIoError::Io { path: path.to_owned(), source })?;
    read_contents_from_bytes(path, &bytes, &mut crate::include::regular)
}

/// [`read_contents`] for bytes in memory; `path` chooses the format and is used in messages, `include` gives the files that the
/// file includes.
///
/// # Errors
/// The errors of [`read_contents`].
pub fn read_contents_from_bytes(
    path: impl AsRef<Path>,
    bytes: &[u8],
    include: Include<'_>,
) -> Result<Contents, MeshIoError> {
    let path = path.as_ref();
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let beginning = || String::from_utf8_lossy(&bytes[..bytes.len().min(BEGINNING)]);
    let format = FORMATS
        .iter()
        .find(|f| f.extensions.contains(&extension.as_str()))
        .or_else(|| FORMATS.iter().find(|f| (f.recognise)(&beginning())));
    match format {
        Some(format) => (format.read)(path, bytes, include),
        None => Err(MeshIoError::UnknownFormat {
            path: path.to_owned(),
            known: FORMATS.iter().map(|f| format!("{} (.{})", f.name, f.extensions.join(", ."))).collect(),
        }),
    }
}

/// [`read_mesh`] for a text in memory, which includes no other files; `path` chooses the format and is used in messages.
///
/// # Errors
/// The errors of [`read_mesh`].
pub fn read_mesh_from_str(path: impl AsRef<Path>, text: &str) -> Result<Mesh, MeshIoError> {
    let mut none = |_: &Path| Err(io::Error::new(io::ErrorKind::Unsupported, "a text in memory includes no files"));
    read_contents_from_bytes(path, text.as_bytes(), &mut none)?.mesh(None)
}
