//! The mesh and its named sets.

use std::collections::{BTreeMap, BTreeSet};

use crate::{ElementCoordinates, Elements, Facet, FacetIndex, MeshError, SetKind};

/// Name of the automatic set of all nodes and elements.
pub const ALL: &str = "all";
/// Name of the automatic set of all boundary facets.
pub const BOUNDARY: &str = "boundary";

/// A mesh with named sets.
///
/// All sets are sorted and hold nothing twice. A facet set gives a node set of the same name, an element set too, see
/// [`Mesh::nodes_of`]. The names [`ALL`] and [`BOUNDARY`] always exist; a set of this name in the maps goes before them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Coordinates of the nodes in the reference configuration (lengths).
    pub nodes: Vec<[f64; 3]>,
    /// Kinds and nodes of the elements.
    pub elements: Elements,
    /// Named sets of nodes.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Named sets of facets.
    pub facet_sets: BTreeMap<String, Vec<Facet>>,
    /// Named sets of elements.
    pub element_sets: BTreeMap<String, Vec<u32>>,
    /// Named vectors, one an element: directions in the axes of the mesh, which turn with it.
    pub element_vectors: BTreeMap<String, Vec<[f64; 3]>>,
}

pub(crate) fn bounding_box(nodes: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
    let Some(&first) = nodes.first() else {
        return ([0.0; 3], [0.0; 3]);
    };
    nodes.iter().fold((first, first), |(min, max), x| {
        (std::array::from_fn(|i| min[i].min(x[i])), std::array::from_fn(|i| max[i].max(x[i])))
    })
}

impl Mesh {
    /// A mesh without sets. Nothing is checked but that the elements' nodes exist; see [`Mesh::check`].
    ///
    /// # Errors
    /// [`MeshError::NodeOutOfRange`].
    pub fn new(nodes: Vec<[f64; 3]>, elements: impl Into<Elements>) -> Result<Mesh, MeshError> {
        let mesh = Mesh { nodes, elements: elements.into(), ..Mesh::default() };
        mesh.check_node_numbers()?;
        Ok(mesh)
    }

    /// Facet `local` of an element, outward.
    ///
    /// # Panics
    /// If the element or the facet does not exist; this is a programming error.
    pub fn facet(&self, element: u32, local: usize) -> Facet {
        let e = element as usize;
        Facet::of_element(element, self.elements.kind(e), &self.elements[e], local)
    }

    /// Coordinates of an element's nodes.
    ///
    /// # Panics
    /// If the element does not exist; this is a programming error.
    pub fn element_coordinates(&self, element: u32) -> ElementCoordinates {
        let e = element as usize;
        ElementCoordinates::new(self.elements.kind(e), &self.elements[e], &self.nodes)
    }

    /// All facets, searchable by nodes.
    pub fn facet_index(&self) -> FacetIndex {
        FacetIndex::new(&self.elements)
    }

    /// The facets that only one element has, sorted by element and local number.
    pub fn boundary_facets(&self) -> Vec<Facet> {
        self.facet_index().boundary()
    }

    /// Smallest and largest coordinates of all nodes; both `[0, 0, 0]` without nodes.
    pub fn bounding_box(&self) -> ([f64; 3], [f64; 3]) {
        bounding_box(&self.nodes)
    }

    /// True if there is a set of this name, of whatever kind, the automatic ones included.
    pub fn has_set(&self, name: &str) -> bool {
        name == ALL
            || name == BOUNDARY
            || self.node_sets.contains_key(name)
            || self.facet_sets.contains_key(name)
            || self.element_sets.contains_key(name)
    }

    /// All names of sets, sorted, the automatic ones included.
    pub fn set_names(&self) -> Vec<String> {
        let names: BTreeSet<&str> = [ALL, BOUNDARY]
            .into_iter()
            .chain(self.node_sets.keys().map(String::as_str))
            .chain(self.facet_sets.keys().map(String::as_str))
            .chain(self.element_sets.keys().map(String::as_str))
            .collect();
        names.into_iter().map(str::to_owned).collect()
    }

    /// The nodes of a set: those of the node set of this name, or else of the facet set, or else of the element set.
    /// Sorted, unique.
    ///
    /// # Errors
    /// [`MeshError::UnknownSet`].
    pub fn nodes_of(&self, name: &str) -> Result<Vec<u32>, MeshError> {
        if let Some(nodes) = self.node_sets.get(name) {
            Ok(nodes.clone())
        } else if let Some(facets) = self.facet_sets.get(name) {
            Ok(facet_nodes(facets))
        } else if let Some(elements) = self.element_sets.get(name) {
            Ok(self.element_nodes(elements))
        } else if name == ALL {
            Ok((0..self.nodes.len() as u32).collect())
        } else if name == BOUNDARY {
            Ok(facet_nodes(&self.boundary_facets()))
        } else {
            Err(self.unknown(name))
        }
    }

    /// The facets of a facet set, sorted by element and local number.
    ///
    /// # Errors
    /// [`MeshError::UnknownSet`], or [`MeshError::WrongSetKind`] if there are only nodes or elements of this name: facets do not
    /// follow from them without a guess.
    pub fn facets_of(&self, name: &str) -> Result<Vec<Facet>, MeshError> {
        if let Some(facets) = self.facet_sets.get(name) {
            Ok(facets.clone())
        } else if self.node_sets.contains_key(name) {
            Err(wrong(name, SetKind::Nodes, SetKind::Facets))
        } else if self.element_sets.contains_key(name) || name == ALL {
            Err(wrong(name, SetKind::Elements, SetKind::Facets))
        } else if name == BOUNDARY {
            Ok(self.boundary_facets())
        } else {
            Err(self.unknown(name))
        }
    }

    /// The elements of an element set, sorted.
    ///
    /// # Errors
    /// [`MeshError::UnknownSet`], or [`MeshError::WrongSetKind`] if there are only facets or nodes of this name.
    pub fn elements_of(&self, name: &str) -> Result<Vec<u32>, MeshError> {
        if let Some(elements) = self.element_sets.get(name) {
            Ok(elements.clone())
        } else if self.facet_sets.contains_key(name) {
            Err(wrong(name, SetKind::Facets, SetKind::Elements))
        } else if self.node_sets.contains_key(name) {
            Err(wrong(name, SetKind::Nodes, SetKind::Elements))
        } else if name == ALL {
            Ok((0..self.elements.len() as u32).collect())
        } else if name == BOUNDARY {
            Err(wrong(name, SetKind::Facets, SetKind::Elements))
        } else {
            Err(self.unknown(name))
        }
    }

    /// The part of the mesh that consists of these elements: nodes renumbered in their old order, sets restricted, sets that
    /// become empty dropped. A facet set keeps the facets of the elements kept.
    ///
    /// # Errors
    /// [`MeshError::NoElements`], [`MeshError::SetOutOfRange`].
    pub fn submesh(&self, elements: &[u32]) -> Result<Mesh, MeshError> {
        let elements: BTreeSet<u32> = elements.iter().copied().collect();
        let Some(&last) = elements.last() else {
            return Err(MeshError::NoElements);
        };
        if last as usize >= self.elements.len() {
            return Err(MeshError::SetOutOfRange {
                name: "(submesh)".into(),
                kind: SetKind::Elements,
                index: last,
                count: self.elements.len(),
            });
        }
        const UNUSED: u32 = u32::MAX;
        let mut new_node = vec![UNUSED; self.nodes.len()];
        let mut new_element = vec![UNUSED; self.elements.len()];
        for (new, &e) in elements.iter().enumerate() {
            new_element[e as usize] = new as u32;
            for &n in &self.elements[e as usize] {
                new_node[n as usize] = 0;
            }
        }
        let mut nodes = Vec::new();
        for (n, new) in new_node.iter_mut().enumerate() {
            if *new != UNUSED {
                *new = nodes.len() as u32;
                nodes.push(self.nodes[n]);
            }
        }
        let mut kept = Elements::new();
        for &e in &elements {
            let renumbered: Vec<u32> = self.elements[e as usize].iter().map(|&n| new_node[n as usize]).collect();
            kept.push(self.elements.kind(e as usize), &renumbered);
        }
        let mut part = Mesh::new(nodes, kept)?;
        let renumber = |set: &Vec<u32>, new: &[u32]| -> Vec<u32> {
            set.iter().map(|&i| new[i as usize]).filter(|&i| i != UNUSED).collect()
        };
        for (name, set) in &self.node_sets {
            part.node_sets.insert(name.clone(), renumber(set, &new_node));
        }
        for (name, set) in &self.element_sets {
            part.element_sets.insert(name.clone(), renumber(set, &new_element));
        }
        for (name, set) in &self.facet_sets {
            let facets = set
                .iter()
                .filter(|f| new_element[f.element as usize] != UNUSED)
                .map(|f| part.facet(new_element[f.element as usize], f.local as usize))
                .collect();
            part.facet_sets.insert(name.clone(), facets);
        }
        for (name, vectors) in &self.element_vectors {
            let kept = elements.iter().map(|&e| vectors[e as usize]).collect();
            part.element_vectors.insert(name.clone(), kept);
        }
        part.node_sets.retain(|_, s| !s.is_empty());
        part.element_sets.retain(|_, s| !s.is_empty());
        part.facet_sets.retain(|_, s| !s.is_empty());
        Ok(part)
    }

    fn element_nodes(&self, elements: &[u32]) -> Vec<u32> {
        sorted_unique(elements.iter().flat_map(|&e| &self.elements[e as usize]).copied().collect())
    }

    fn unknown(&self, name: &str) -> MeshError {
        MeshError::UnknownSet { name: name.to_owned(), available: self.set_names() }
    }
}

fn wrong(name: &str, has: SetKind, wanted: SetKind) -> MeshError {
    MeshError::WrongSetKind { name: name.to_owned(), has, wanted }
}

fn facet_nodes(facets: &[Facet]) -> Vec<u32> {
    sorted_unique(facets.iter().flat_map(|f| f.nodes.iter().copied()).collect())
}

fn sorted_unique(mut values: Vec<u32>) -> Vec<u32> {
    values.sort_unstable();
    values.dedup();
    values
}
