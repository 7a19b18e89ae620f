//! The surface and its named sets.

use std::collections::{BTreeMap, BTreeSet};

use stoss_reference_element::{FacetNodes, Nodal};

use crate::transform::place;
use crate::{ALL, BOUNDARY, Facet, Mesh, MeshError, Rotation};

/// A surface of triangles and quadrilaterals, in any mixture, with named sets of facets.
///
/// The nodes of a facet are numbered so that `a1 x a2`, the cross product of its tangents, points outward. Sets are
/// sorted and hold nothing twice. The names [`ALL`] and [`BOUNDARY`] always exist and mean all facets; a set of this
/// name in the map goes before them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfaceMesh {
    /// Coordinates of the nodes (lengths).
    pub nodes: Vec<[f64; 3]>,
    /// Nodes of the facets.
    pub facets: Vec<FacetNodes>,
    /// Named sets of facets by number.
    pub facet_sets: BTreeMap<String, Vec<u32>>,
}

impl SurfaceMesh {
    /// A surface without sets. Nothing is checked but that the facets' nodes exist; see [`SurfaceMesh::check`].
    ///
    /// # Errors
    /// [`MeshError::FacetNodeOutOfRange`].
    pub fn new(nodes: Vec<[f64; 3]>, facets: Vec<FacetNodes>) -> Result<SurfaceMesh, MeshError> {
        let surface = SurfaceMesh { nodes, facets, facet_sets: BTreeMap::new() };
        surface.check_node_numbers()?;
        Ok(surface)
    }

    /// The boundary of a mesh: the pieces of its boundary facets in the order of [`Mesh::boundary_facets`], the nodes that
    /// they use in their old order, and the facet sets. Of a set the facets between two elements are left out; a set
    /// without any other is dropped.
    ///
    /// # Errors
    /// [`MeshError::NoElements`], [`MeshError::NodeOutOfRange`].
    pub fn from_mesh(mesh: &Mesh) -> Result<SurfaceMesh, MeshError> {
        if mesh.elements.is_empty() {
            return Err(MeshError::NoElements);
        }
        mesh.check_node_numbers()?;
        let boundary = mesh.boundary_facets();
        let mut surface = SurfaceMesh {
            nodes: mesh.nodes.clone(),
            facets: boundary.iter().flat_map(|f| f.nodes.pieces()).collect(),
            facet_sets: BTreeMap::new(),
        };
        surface.drop_unused_nodes();
        // The pieces of boundary facet `f` are `first_piece[f]..first_piece[f + 1]`.
        let mut first_piece = vec![0u32];
        for facet in &boundary {
            first_piece.push(first_piece[first_piece.len() - 1] + facet.nodes.pieces().count() as u32);
        }
        for (name, set) in &mesh.facet_sets {
            let number = |f: &Facet| boundary.binary_search_by_key(&(f.element, f.local), |b| (b.element, b.local));
            let numbers = set.iter().filter_map(|f| number(f).ok());
            let facets: BTreeSet<u32> = numbers.flat_map(|f| first_piece[f]..first_piece[f + 1]).collect();
            if !facets.is_empty() {
                surface.facet_sets.insert(name.clone(), facets.into_iter().collect());
            }
        }
        Ok(surface)
    }

    /// Coordinates of a facet's nodes.
    ///
    /// # Panics
    /// If the facet or one of its nodes does not exist; this is a programming error.
    pub fn facet_coordinates(&self, facet: u32) -> Nodal<[f64; 3]> {
        self.facets[facet as usize].map(|n| self.nodes[n as usize])
    }

    /// Smallest and largest coordinates of all nodes; both `[0, 0, 0]` without nodes.
    pub fn bounding_box(&self) -> ([f64; 3], [f64; 3]) {
        crate::mesh::bounding_box(&self.nodes)
    }

    /// All names of sets, sorted, the automatic ones included.
    pub fn set_names(&self) -> Vec<String> {
        let names: BTreeSet<&str> =
            [ALL, BOUNDARY].into_iter().chain(self.facet_sets.keys().map(String::as_str)).collect();
        names.into_iter().map(str::to_owned).collect()
    }

    /// The facets of a set, sorted.
    ///
    /// # Errors
    /// [`MeshError::UnknownSet`].
    pub fn facets_of(&self, name: &str) -> Result<Vec<u32>, MeshError> {
        if let Some(facets) = self.facet_sets.get(name) {
            Ok(facets.clone())
        } else if name == ALL || name == BOUNDARY {
            Ok((0..self.facets.len() as u32).collect())
        } else {
            Err(MeshError::UnknownSet { name: name.to_owned(), available: self.set_names() })
        }
    }

    /// The nodes of a set's facets, sorted, each once.
    ///
    /// # Errors
    /// [`MeshError::UnknownSet`], [`MeshError::SetOutOfRange`].
    pub fn nodes_of(&self, name: &str) -> Result<Vec<u32>, MeshError> {
        let facets = self.facets_of(name)?;
        self.check_set(name, &facets)?;
        let nodes: BTreeSet<u32> = facets.iter().flat_map(|&f| self.facets[f as usize]).collect();
        Ok(nodes.into_iter().collect())
    }

    /// Rotates the surface, then translates it.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] if the rotation or the translation is bad; the surface is then unchanged.
    pub fn transform(&mut self, rotation: Option<&Rotation>, translation: [f64; 3]) -> Result<(), MeshError> {
        place(&mut self.nodes, rotation, translation)
    }

    /// The surface with outside and inside exchanged, its normals reversed: the nodes of each facet in the opposite order, from
    /// the same first one.
    pub fn flipped(mut self) -> SurfaceMesh {
        for facet in &mut self.facets {
            let nodes = *facet;
            let count = nodes.len();
            *facet = FacetNodes::from_fn(nodes.kind(), |k| nodes[(count - k) % count]);
        }
        self
    }

    /// Drops the nodes that no facet uses; the others keep their order. Facets' nodes must exist.
    pub(super) fn drop_unused_nodes(&mut self) {
        const UNUSED: u32 = u32::MAX;
        let mut new = vec![UNUSED; self.nodes.len()];
        self.facets.iter().flatten().for_each(|&n| new[n as usize] = 0);
        let mut nodes = Vec::new();
        for (n, new) in new.iter_mut().enumerate() {
            if *new != UNUSED {
                *new = nodes.len() as u32;
                nodes.push(self.nodes[n]);
            }
        }
        self.nodes = nodes;
        self.facets.iter_mut().for_each(|f| *f = f.map(|n| new[n as usize]));
    }
}
