//! What data lines belong to.

use super::model::Kind;
use super::types::SolidType;
use crate::place::FileLocation;
use crate::{Contents, MeshIoError};

/// Section of a file: what the data lines that come next belong to. Not a cross-section.
pub(super) enum KeywordBlock {
    Skip,
    Node {
        set: Option<String>,
    },
    Element {
        kind: SolidType,
        set: Option<String>,
        pending: Vec<u64>,
        place: FileLocation,
    },
    /// Elements of another type are counted; true within a continued line.
    OtherElement {
        kind: usize,
        set: Option<String>,
        continued: bool,
    },
    Set {
        kind: Kind,
        name: String,
        generate: bool,
        /// Instance that the numbers belong to, if it is named.
        instance: Option<usize>,
    },
    Surface {
        name: String,
        nodes: bool,
    },
    Instance {
        lines: usize,
    },
}

impl KeywordBlock {
    /// At its end nothing may be missing.
    pub fn close(&self, contents: &Contents) -> Result<(), MeshIoError> {
        match self {
            KeywordBlock::Element { kind, pending, place, .. } if !pending.is_empty() => Err(contents.error(
                *place,
                format_args!("element {}", pending[0]),
                format_args!("has {} nodes, but {} needs {}", pending.len() - 1, kind.name, kind.node_count()),
            )),
            _ => Ok(()),
        }
    }
}
