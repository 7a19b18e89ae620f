//! Gmsh's cell types: which are used, and what to say about the others.

use std::collections::BTreeMap;
use std::path::Path;

use crate::MeshIoError;
use crate::lines::unsupported;

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

/// Number of nodes of the types that are used.
pub(super) fn node_count(kind: u32) -> Option<usize> {
    match kind {
        LINE => Some(2),
        QUADRILATERAL => Some(4),
        HEXAHEDRON => Some(8),
        POINT => Some(1),
        _ => None,
    }
}

/// Counts of cells that Stoss does not compute with.
#[derive(Default)]
pub(super) struct OtherCells {
    /// By type: how many, and the line of the first.
    counts: BTreeMap<u32, (usize, usize)>,
}

impl OtherCells {
    pub fn count(&mut self, kind: u32, line: usize) {
        self.counts.entry(kind).or_insert((0, line)).0 += 1;
    }

    /// An error if there are any.
    pub fn refuse(&self, path: &Path) -> Result<(), MeshIoError> {
        let Some((first, &(_, line))) = self.counts.iter().min_by_key(|(_, (_, line))| *line) else {
            return Ok(());
        };
        let list: Vec<String> = self
            .counts
            .iter()
            .map(|(&kind, (count, _))| format!("{count} {} (type {kind})", describe(kind).0))
            .collect();
        let remedy = format!("Stoss computes with 8-node hexahedra (type 5); {}", describe(*first).1);
        Err(unsupported(path, line, list.join(", "), remedy))
    }
}
