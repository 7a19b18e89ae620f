//! The errors of this crate.

use std::path::{Path, PathBuf};

use stoss_mesh::{ElementPoint, MeshError, NON_CONFORMING_REMEDY};
use stoss_reference_element::CellKind;

/// Where something stands in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePosition {
    /// A line of a text, from 1.
    Line(usize),
    /// A byte of a binary file, from 0.
    Byte(u64),
}

/// The position as it follows the name of the file: ":12", ": byte 12".
impl std::fmt::Display for FilePosition {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FilePosition::Line(line) => write!(f, ":{line}"),
            FilePosition::Byte(byte) => write!(f, ": byte {byte}"),
        }
    }
}

/// Why a file could not be read or written. Lines count from 1; element and node numbers are those of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshIoError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// A file of which neither the name nor the content belongs to a known format.
    #[error("{}: unknown mesh format; known are {}", path.display(), known.join(", "))]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Names and extensions of the known formats.
        known: Vec<String>,
    },
    /// A line does not say what it must.
    #[error("{}:{line}: {value:?}: {remedy}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The line; the last one if something is missing at the end.
        line: usize,
        /// What stands there.
        value: String,
        /// What is expected.
        remedy: String,
    },
    /// A place of a binary file does not say what it must.
    #[error("{}: byte {offset}: {value}: {remedy}", path.display())]
    Binary {
        /// The file.
        path: PathBuf,
        /// The place, in bytes from the beginning.
        offset: u64,
        /// What stands there.
        value: String,
        /// What is expected.
        remedy: String,
    },
    /// A file with frames in HDF5 cannot be read or written.
    #[cfg(feature = "vtkhdf")]
    #[error("{}: {problem}", path.display())]
    Container {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// Something that is correct, but that Stoss does not compute with: other cells, other versions, several bodies.
    #[error("{}{at}: {value}: {remedy}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// The place of the first occurrence.
        at: FilePosition,
        /// Name of the thing.
        value: String,
        /// Remedy: what to do instead.
        remedy: String,
    },
    /// A number refers to something that the file does not define.
    #[error("{}{at}: there is no {kind} {number}: define it or remove the reference", path.display())]
    Unknown {
        /// The file.
        path: PathBuf,
        /// The place of the reference.
        at: FilePosition,
        /// "node", "element", "node set", ...
        kind: &'static str,
        /// Number or name that is not defined.
        number: String,
    },
    /// A file without hexahedra, tetrahedra or wedges.
    #[error("{}: there are no hexahedra, tetrahedra or wedges in this file: mesh the volumes, and save their elements", path.display())]
    NoElements {
        /// The file.
        path: PathBuf,
    },
    /// The Jacobian determinant of an element is not positive at a Gauss point, or at another point of a quadratic element.
    #[error(
        "{}{at}: element {element} ({kind}) with nodes {nodes:?} has det J = {jacobian:e} at {point}: it is inverted or degenerate; \
         {remedy}", path.display()
    )]
    InvertedElement {
        /// The file.
        path: Box<Path>,
        /// The place of the element.
        at: FilePosition,
        /// The element's number.
        element: u64,
        /// Kind of the element.
        kind: CellKind,
        /// Numbers of the element's nodes, in the order of the kind.
        nodes: Box<[u64]>,
        /// Place where the element is inverted.
        point: Box<ElementPoint>,
        /// `det J` (a volume per reference volume).
        jacobian: f64,
        /// Remedy: what to do.
        remedy: &'static str,
    },
    /// Two elements on the same side of a facet.
    #[error("{}{at}: elements {} and {} overlap: remove one of them", path.display(), elements[0], elements[1])]
    OverlappingElements {
        /// The file.
        path: PathBuf,
        /// The place of the second element.
        at: FilePosition,
        /// Numbers of the elements.
        elements: [u64; 2],
    },
    /// Elements that share the corners of a facet but not the nodes on its edges.
    #[error(
        "{}{at}: elements {} and {} ({kinds}) share the corners of a facet but not its other nodes: use linear elements on both sides, or \
         quadratic ones on both", path.display(), elements[0], elements[1]
    )]
    NonMatchingFacet {
        /// The file.
        path: PathBuf,
        /// The place of the second element.
        at: FilePosition,
        /// Numbers of the elements.
        elements: [u64; 2],
        /// Kinds of the elements.
        kinds: String,
    },
    /// A facet of one element on facets of others that do not have the same nodes.
    #[error(
        "{}{at}: elements {} and {} ({kinds}) lie on each other at the facet of the first around {centre:?}, but do not share this facet \
         ({count} such facets): displacements are not continuous there; {NON_CONFORMING_REMEDY}", path.display(), elements[0], elements[1]
    )]
    NonConformingFacet {
        /// The file.
        path: PathBuf,
        /// The place of the second element.
        at: FilePosition,
        /// Numbers of the element of the facet and of one of those on it.
        elements: [u64; 2],
        /// Kinds of the elements.
        kinds: String,
        /// Mean of the corners of the facet.
        centre: [f64; 3],
        /// Number of facets that others lie on.
        count: usize,
    },
    /// The file has no such group of elements.
    #[error("{}: {problem}; {known}", path.display())]
    NoGroup {
        /// The file.
        path: PathBuf,
        /// What is wrong with the name.
        problem: String,
        /// The groups that there are.
        known: String,
    },
    /// Any other problem of the mesh.
    #[error("{}: {source}", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// The problem; numbers count from 0 in the order of the file.
        source: MeshError,
    },
    /// The data given to a writer do not fit together.
    #[error("cannot write {name:?}: {problem}")]
    Output {
        /// Name of the field or the part of the frame.
        name: String,
        /// What is wrong.
        problem: String,
    },
}
