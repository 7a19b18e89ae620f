//! Nodes, elements and sets of a file by parts and instances.

use std::collections::BTreeMap;

use stoss_mesh::Rotation;

use super::sets::{Labels, Sets};
use super::types::SolidType;
use crate::place::FileLocation;

/// What a set holds.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Node,
    Element,
}

/// A piece of a surface: elements and a face, "S1" to "S6" as far as the element has one, or "" for all free faces.
#[derive(Clone)]
pub(super) struct SurfaceEntry {
    pub labels: Labels,
    pub face: String,
    pub place: FileLocation,
}

/// Sets and surfaces of a part, of an instance or of the assembly.
#[derive(Clone, Default)]
pub(super) struct Names {
    pub nodes: Sets,
    pub elements: Sets,
    /// Surfaces by name in upper case: name as written, pieces.
    pub surfaces: BTreeMap<String, (String, Vec<SurfaceEntry>)>,
    /// Node sets that get the nodes of elements.
    pub nodes_of_elements: Vec<(String, Labels)>,
}

impl Names {
    pub fn sets(&self, kind: Kind) -> &Sets {
        match kind {
            Kind::Node => &self.nodes,
            Kind::Element => &self.elements,
        }
    }

    pub fn sets_mut(&mut self, kind: Kind) -> &mut Sets {
        match kind {
            Kind::Node => &mut self.nodes,
            Kind::Element => &mut self.elements,
        }
    }
}

/// An element.
#[derive(Clone)]
pub(super) struct Solid {
    pub number: u64,
    pub kind: SolidType,
    /// Nodes in our order.
    pub nodes: Box<[u64]>,
    pub place: FileLocation,
}

/// A part of Abaqus (`*PART`), or what is outside of parts in a file; not a part of a scene.
#[derive(Clone, Default)]
pub(super) struct DeckPart {
    pub name: String,
    pub nodes: Vec<(u64, [f64; 3], FileLocation)>,
    pub elements: Vec<Solid>,
    /// Elements of other types by number: index of the type.
    pub others: BTreeMap<u64, usize>,
    pub names: Names,
}

impl DeckPart {
    /// A measure of the memory of a copy: nodes, elements and numbers in sets.
    pub fn size(&self) -> usize {
        let sets = self.names.nodes.all.values().chain(self.names.elements.all.values());
        let labels: usize = sets.map(|s| 1 + s.labels.numbers.len() + s.labels.ranges.len()).sum();
        let pieces = self.names.surfaces.values().flat_map(|(_, pieces)| pieces);
        let faces: usize = pieces.map(|p| 1 + p.labels.numbers.len() + p.labels.ranges.len()).sum();
        self.nodes.len() + self.elements.len() + self.others.len() + labels + faces
    }
}

/// A part in its place.
pub(super) struct Instance {
    pub name: String,
    /// A copy of the part, with what the instance itself adds.
    pub part: DeckPart,
    pub translation: [f64; 3],
    pub rotation: Option<Rotation>,
}
