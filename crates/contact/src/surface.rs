//! A contact surface: facets, nodes, adjacency and reference areas.
//!
//! Made once from the reference configuration. It holds no positions of the deformed state: whatever depends on them takes
//! `q` (`3 * nodes` entries, node-major). It searches nothing; that is [`crate::search`].

use crate::carriers::Carriers;
use crate::{ContactError, position};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_geometry::Patch;
use stoss_reference_element::{FacetNodes, MAX_NODES, Nodal};

const NONE: u32 = u32::MAX;

/// An edge at which the surface is not an oriented manifold. Its facets are not connected there: contact ends at the edge as at
/// a rim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NonManifoldEdge {
    /// Global nodes, the smaller first.
    pub nodes: [u32; 2],
    /// Facets that have the edge, ascending: three or more, or two whose orientations disagree.
    pub facets: Vec<u32>,
}

/// Facets of any kinds, numbered so that `a_1 x a_2` points out of the body (theory/node-to-surface#symbols).
///
/// Facets and surface nodes have local numbers, the positions in [`ContactSurface::facets`] and [`ContactSurface::nodes`]. Edge `k` of a facet
/// runs from its corner `k` to the next one.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactSurface {
    facets: Vec<FacetNodes>,
    nodes: Vec<u32>,
    local_facets: Vec<FacetNodes>,
    /// Neighbour over each edge; [`NONE`] at a rim.
    neighbours: Vec<FacetNodes>,
    around_start: Vec<u32>,
    around: Vec<u32>,
    nodal_areas: Vec<f64>,
    corner_areas: Vec<Nodal<f64>>,
    length_scale: f64,
    non_manifold_edges: Vec<NonManifoldEdge>,
    carriers: Option<Carriers>,
    /// Number of the first facet that lies beside a rim.
    first_beside: usize,
}

impl ContactSurface {
    /// Builds the surface from facets (global nodes, outward numbering) and the reference coordinates of all nodes. Facets of one kind may be
    /// arrays; [`FacetNodes`] of different kinds make a mixed surface.
    ///
    /// `side` ("slave" or "master") is for messages.
    ///
    /// # Errors
    /// [`ContactError::EmptySurface`], [`ContactError::MissingNode`], [`ContactError::NotFinite`], and
    /// [`ContactError::DegenerateFacet`] if a facet has no area, an edge without length, or a reference normal that turns over
    /// between two of its corners. Edges that are not manifold are no error: see [`ContactSurface::non_manifold_edges`].
    pub fn new<F: Copy + Into<FacetNodes>>(
        side: &'static str,
        facets: &[F],
        reference: &[f64],
    ) -> Result<Self, ContactError> {
        Self::of_nodes(side, facets.iter().map(|&f| f.into()).collect(), reference)
    }

    /// The surface with facets of its body beside its rims ([`crate::beside_rims`]). Its length scale stays.
    ///
    /// # Errors
    /// The errors of [`Self::new`].
    pub fn with_sides(&self, sides: &[FacetNodes], reference: &[f64]) -> Result<Self, ContactError> {
        let whole = Self::of_nodes("master", [&self.facets, sides].concat(), reference)?;
        Ok(Self { length_scale: self.length_scale, first_beside: self.facets.len(), ..whole })
    }

    /// Whether a facet lies beside a rim of the surface that was named.
    pub fn is_beside(&self, facet: u32) -> bool {
        facet as usize >= self.first_beside
    }

    fn of_nodes(side: &'static str, facets: Vec<FacetNodes>, reference: &[f64]) -> Result<Self, ContactError> {
        if facets.is_empty() {
            return Err(ContactError::EmptySurface { side });
        }
        let count = reference.len() / 3;
        for (facet, corners) in facets.iter().enumerate() {
            for node in *corners {
                if node as usize >= count {
                    return Err(ContactError::MissingNode { facet: facet as u32, node, count });
                }
                if !position(reference, node).iter().all(|c| c.is_finite()) {
                    return Err(ContactError::NotFinite { node });
                }
            }
            check_facet(facet as u32, &Patch::new(corners.map(|n| position(reference, n))))?;
        }

        let mut nodes: Vec<u32> = facets.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let local = |node: u32| nodes.partition_point(|&n| n < node) as u32;
        let local_facets: Vec<FacetNodes> = facets.iter().map(|f| f.map(local)).collect();

        let (neighbours, non_manifold_edges) = connect(&facets);
        let (around_start, around) = facets_around_nodes(&local_facets, nodes.len());

        let mut nodal_areas = vec![0.0; nodes.len()];
        let mut corner_areas = Vec::with_capacity(facets.len());
        let (mut length, mut edges) = (0.0, 0usize);
        for (facet, local_nodes) in facets.iter().zip(&local_facets) {
            let patch = Patch::new(facet.map(|n| position(reference, n)));
            let areas = shape_integrals(&patch);
            for (node, area) in local_nodes.iter().zip(areas) {
                nodal_areas[*node as usize] += area;
            }
            corner_areas.push(Nodal::from_fn(facet.kind(), |k| areas[k]));
            for edge in edge_vectors(&patch) {
                length += edge.norm();
                edges += 1;
            }
        }
        Ok(Self {
            first_beside: facets.len(),
            facets,
            nodes,
            local_facets,
            neighbours,
            around_start,
            around,
            nodal_areas,
            corner_areas,
            length_scale: length / edges as f64,
            non_manifold_edges,
            carriers: None,
        })
    }

    /// Tells which nodes are carried by others, and with which weights: `of(node)`. Positions are still those of the nodes; where all are carried by the same few
    /// vectors, a search need not look at all of them to know how the surface has moved.
    pub fn set_carriers<'a>(&mut self, of: &dyn Fn(u32) -> Option<&'a [(u32, f64)]>) {
        self.carriers = Carriers::new(&self.nodes, of);
    }

    /// What carries the surface, if it was told and moves as a whole.
    pub fn carriers(&self) -> Option<&Carriers> {
        self.carriers.as_ref()
    }

    /// Global nodes of every facet.
    pub fn facets(&self) -> &[FacetNodes] {
        &self.facets
    }

    /// Local nodes of every facet.
    pub fn local_facets(&self) -> &[FacetNodes] {
        &self.local_facets
    }

    /// Global numbers of the surface's nodes, ascending.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Local number of a global node, if it is on the surface.
    pub fn local_node(&self, node: u32) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// Facet on the other side of edge `edge` of `facet`; `None` at a rim and at a non-manifold edge.
    pub fn neighbour(&self, facet: u32, edge: usize) -> Option<u32> {
        let other = self.neighbours[facet as usize][edge];
        (other != NONE).then_some(other)
    }

    /// Facets over the edges of a facet.
    pub fn neighbours(&self, facet: u32) -> impl Iterator<Item = u32> {
        self.neighbours[facet as usize].into_iter().filter(|&n| n != NONE)
    }

    /// Facets that have a (local) node, ascending.
    pub fn facets_around(&self, local_node: usize) -> &[u32] {
        &self.around[self.around_start[local_node] as usize..self.around_start[local_node + 1] as usize]
    }

    /// Edges at which facets could not be connected.
    pub fn non_manifold_edges(&self) -> &[NonManifoldEdge] {
        &self.non_manifold_edges
    }

    /// Number of facet edges without a neighbour (the rim, non-manifold edges included).
    pub fn boundary_edge_count(&self) -> usize {
        self.neighbours.iter().flatten().filter(|&&n| n == NONE).count()
    }

    /// `A^s = int N_s dA` over the reference surface for every local node (theory/node-to-surface#symbols), an area; with the kind's quadrature rule on each facet.
    pub fn nodal_areas(&self) -> &[f64] {
        &self.nodal_areas
    }

    /// [`Self::nodal_areas`] of the surface at positions `q`.
    pub fn nodal_areas_at(&self, q: &[f64]) -> Vec<f64> {
        let mut areas = vec![0.0; self.nodes.len()];
        for (facet, local_nodes) in self.facets.iter().zip(&self.local_facets) {
            let patch = Patch::new(facet.map(|n| position(q, n)));
            for (node, area) in local_nodes.iter().zip(shape_integrals(&patch)) {
                areas[*node as usize] += area;
            }
        }
        areas
    }

    /// What each facet adds to the nodal areas of its corners, an area.
    pub fn corner_areas(&self) -> &[Nodal<f64>] {
        &self.corner_areas
    }

    /// Sum of the nodal areas.
    pub fn area(&self) -> f64 {
        self.nodal_areas.iter().sum()
    }

    /// Characteristic length `h`: mean length of the facets' reference edges.
    pub fn length_scale(&self) -> f64 {
        self.length_scale
    }

    /// The patch of a facet at positions `q`.
    pub fn patch(&self, facet: u32, q: &[f64]) -> Patch {
        Patch::new(self.facets[facet as usize].map(|n| position(q, n)))
    }

    /// Unit normal of the surface at a local node: mean of the surrounding facets' normals weighted by their angles there
    /// (Baerentzen and Aanaes 2005); zero if the normals cancel.
    pub fn node_normal(&self, local_node: usize, q: &[f64]) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for &facet in self.facets_around(local_node) {
            let patch = self.patch(facet, q);
            for (corner, &node) in self.local_facets[facet as usize].iter().enumerate() {
                if node as usize == local_node {
                    sum += patch.normal(patch.kind().vertices()[corner]) * patch.corner_angle(corner);
                }
            }
        }
        let length = sum.norm();
        if length > 1e-12 { sum / length } else { Vector3::zeros() }
    }

    /// Checks that two surfaces have no node in common.
    ///
    /// # Errors
    /// [`ContactError::SharedNode`] with the smallest shared node.
    pub fn check_disjoint(&self, other: &Self) -> Result<(), ContactError> {
        match self.nodes.iter().find(|n| other.nodes.binary_search(n).is_ok()) {
            Some(&node) => Err(ContactError::SharedNode { node }),
            None => Ok(()),
        }
    }
}

/// `int N_I dA` for the corners; zero beyond them.
fn shape_integrals(patch: &Patch) -> [f64; MAX_NODES] {
    let mut areas = [0.0; MAX_NODES];
    for &(xi, weight) in patch.kind().rule() {
        let shape = patch.shape(xi);
        let density = patch.area_vector(xi).norm() * weight;
        for (area, n) in areas.iter_mut().zip(shape) {
            *area += n * density;
        }
    }
    areas
}

/// Corner to corner.
fn edge_vectors(patch: &Patch) -> impl Iterator<Item = Vector3<f64>> {
    let ends = (0..patch.kind().edge_count()).map(|k| patch.kind().side(k));
    ends.map(|[from, to]| patch.corners[to] - patch.corners[from])
}

fn check_facet(facet: u32, patch: &Patch) -> Result<(), ContactError> {
    let area: f64 = shape_integrals(patch).iter().sum();
    let longest = edge_vectors(patch).map(|e| e.norm()).fold(0.0, f64::max);
    let centre = patch.normal(patch.kind().centre());
    let turned =
        patch.kind().vertices().iter().any(|&xi| patch.area_vector(xi).dot(&centre) <= 1e-10 * longest * longest);
    if area <= 1e-10 * longest * longest || turned {
        return Err(ContactError::DegenerateFacet { facet, area });
    }
    Ok(())
}

/// Neighbours over edges; edges that are not shared by exactly two facets of opposite direction are left open.
fn connect(facets: &[FacetNodes]) -> (Vec<FacetNodes>, Vec<NonManifoldEdge>) {
    // Nodes of the edge, smaller first -> (facet, edge, whether it runs from the smaller to the larger).
    let mut edges: BTreeMap<[u32; 2], Vec<(u32, usize, bool)>> = BTreeMap::new();
    for (facet, corners) in facets.iter().enumerate() {
        for k in 0..corners.kind().edge_count() {
            let [from, to] = corners.kind().side(k).map(|corner| corners[corner]);
            edges.entry([from.min(to), from.max(to)]).or_default().push((facet as u32, k, from < to));
        }
    }
    let start: Vec<usize> = facets.iter().scan(0, |next, f| Some(std::mem::replace(next, *next + f.len()))).collect();
    let mut over = vec![NONE; facets.iter().map(|f| f.len()).sum()];
    let mut non_manifold = Vec::new();
    for (nodes, uses) in edges {
        match uses[..] {
            [_] => {}
            [(f, k, forward), (g, l, other)] if forward != other && f != g => {
                over[start[f as usize] + k] = g;
                over[start[g as usize] + l] = f;
            }
            _ => non_manifold.push(NonManifoldEdge { nodes, facets: uses.iter().map(|u| u.0).collect() }),
        }
    }
    let neighbours = facets.iter().zip(start).map(|(f, start)| Nodal::from_fn(f.kind(), |k| over[start + k]));
    (neighbours.collect(), non_manifold)
}

fn facets_around_nodes(local_facets: &[FacetNodes], nodes: usize) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; nodes + 1];
    for &node in local_facets.iter().flatten() {
        start[node as usize + 1] += 1;
    }
    for i in 0..nodes {
        start[i + 1] += start[i];
    }
    let mut fill = start.clone();
    let mut around = vec![0; start[nodes] as usize];
    for (facet, corners) in local_facets.iter().enumerate() {
        for &node in corners {
            around[fill[node as usize] as usize] = facet as u32;
            fill[node as usize] += 1;
        }
    }
    (start, around)
}
