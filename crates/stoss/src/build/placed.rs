//! Parts of a scene in their places: what has sets, and which nodes of the model these are.

use super::trace::Traces;
use std::collections::BTreeMap;
use std::sync::Arc;
use stoss_continuum::HyperelasticLaw;
use stoss_mesh::{Mesh, MeshError, SurfaceMesh};
use stoss_reference_element::{FacePiece, FacetNodes};

/// What a part is made of.
pub(crate) enum Discretisation {
    /// A deformable body.
    Solid {
        mesh: Mesh,
        /// Law of the body, for bodies whose nodes a tie moves.
        #[cfg_attr(not(feature = "mortar"), expect(dead_code))]
        law: Arc<dyn HyperelasticLaw>,
        /// What contact sees of its quadratic faces.
        traces: Traces,
    },
    /// The surface of a rigid body, embedded nodes.
    #[cfg_attr(not(feature = "multibody"), expect(dead_code))]
    Surface(SurfaceMesh),
    /// Nodes of beams and strings, points: their positions, and sets of them.
    #[cfg_attr(not(feature = "multibody"), expect(dead_code))]
    Nodes {
        positions: Vec<[f64; 3]>,
        /// Distance of the numbers of two that follow each other.
        stride: u32,
        sets: BTreeMap<String, Vec<u32>>,
        /// Length that belongs to each node of beams and strings; empty of points.
        #[allow(dead_code, reason = "contact reads it, and is an option")]
        lengths: Vec<f64>,
    },
}

/// A part with the number of its first node in the model. Numbers in its sets count from there.
pub(crate) struct Placed {
    pub name: String,
    pub shape: Discretisation,
    pub first_node: u32,
}

impl Placed {
    /// The mesh of a deformable body.
    pub fn mesh(&self) -> Option<&Mesh> {
        if let Discretisation::Solid { mesh, .. } = &self.shape { Some(mesh) } else { None }
    }

    /// Facets of a set in global node numbers, outward; of quadratic faces those of the trace, if something needs it.
    pub fn facets_of(&self, set: &str) -> Result<Vec<FacetNodes>, MeshError> {
        let first = self.first_node;
        Ok(match &self.shape {
            Discretisation::Solid { mesh, traces, .. } => {
                mesh.facets_of(set)?.iter().flat_map(|facet| traces.facets_of(facet, first)).collect()
            }
            Discretisation::Surface(surface) => {
                surface.facets_of(set)?.iter().map(|&f| surface.facets[f as usize].map(|n| n + first)).collect()
            }
            Discretisation::Nodes { .. } => Vec::new(),
        })
    }

    /// Facets of a set as pieces of their faces, in global node numbers, outward.
    #[cfg_attr(
        not(any(feature = "nts", feature = "mortar")),
        expect(dead_code, reason = "for contacts, which are not built in")
    )]
    pub fn pieces_of(&self, set: &str) -> Result<Vec<FacePiece>, MeshError> {
        match &self.shape {
            Discretisation::Solid { mesh, traces, .. } => {
                let facets = mesh.facets_of(set)?;
                Ok(facets.iter().flat_map(|facet| traces.pieces_of(facet, self.first_node)).collect())
            }
            Discretisation::Surface(_) | Discretisation::Nodes { .. } => {
                Ok(self.facets_of(set)?.into_iter().map(Into::into).collect())
            }
        }
    }

    /// Global nodes of a set.
    pub fn nodes_of(&self, set: &str) -> Result<Vec<u32>, MeshError> {
        let list = match &self.shape {
            Discretisation::Solid { mesh, .. } => mesh.nodes_of(set)?,
            Discretisation::Surface(surface) => surface.nodes_of(set)?,
            Discretisation::Nodes { sets, stride, .. } => {
                let unknown = || MeshError::UnknownSet { name: set.to_owned(), available: self.set_names() };
                sets.get(set).ok_or_else(unknown)?.iter().map(|n| stride * n).collect()
            }
        };
        Ok(list.iter().map(|n| n + self.first_node).collect())
    }

    /// Global nodes of a set of a beam or string in their order, with their lengths; nothing of other parts.
    #[cfg(any(feature = "nts", feature = "mortar"))]
    pub fn line_of(&self, set: &str) -> Option<Vec<(u32, f64)>> {
        let Discretisation::Nodes { sets, stride, lengths, .. } = &self.shape else { return None };
        let nodes = sets.get(set).filter(|_| !lengths.is_empty())?;
        Some(nodes.iter().map(|&n| (self.first_node + stride * n, lengths[n as usize])).collect())
    }

    /// Names of all sets.
    pub fn set_names(&self) -> Vec<String> {
        match &self.shape {
            Discretisation::Solid { mesh, .. } => mesh.set_names(),
            Discretisation::Surface(surface) => surface.set_names(),
            Discretisation::Nodes { sets, .. } => sets.keys().cloned().collect(),
        }
    }

    /// Names of the sets that have facets.
    pub fn facet_sets(&self) -> Vec<String> {
        let has_facets = |name: &String| self.facets_of(name).is_ok_and(|facets| !facets.is_empty());
        self.set_names().into_iter().filter(has_facets).collect()
    }

    /// Global number of the node nearest to a point, the first of equals, and its distance.
    pub fn nearest(&self, point: [f64; 3]) -> (u32, f64) {
        let (nodes, stride) = match &self.shape {
            Discretisation::Solid { mesh, .. } => (&mesh.nodes, 1),
            Discretisation::Surface(surface) => (&surface.nodes, 1),
            Discretisation::Nodes { positions, stride, .. } => (positions, *stride),
        };
        let distance = |x: &[f64; 3]| (0..3).map(|i| (x[i] - point[i]).powi(2)).sum::<f64>();
        let mut best = 0;
        for (k, x) in nodes.iter().enumerate() {
            if distance(x) < distance(&nodes[best]) {
                best = k;
            }
        }
        let far = nodes.get(best).map_or(f64::INFINITY, |x| distance(x).sqrt());
        (self.first_node + stride * best as u32, far)
    }
}

/// Position of a part in the list.
pub(crate) fn index(placed: &[Placed], name: &str) -> Option<usize> {
    placed.iter().position(|part| part.name == name)
}
