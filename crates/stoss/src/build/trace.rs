//! What contact sees of quadratic faces: linear facets, and embedded nodes for those of their vertices that are no nodes.
//!
//! Mortar contact and ties take facets on the nodes of faces, and the faces behind them (theory/mortar#faces). Node-to-surface and general contact take the trace
//! (theory/elements#contact), with vertices of its own in place of the nodes on edges.

use crate::scene::Scene;
use crate::solver::Model;
use std::collections::BTreeMap;
use stoss_contact::round::{BEYOND, Corner, Finer, VertexKey};
use stoss_mesh::{Facet, Mesh};
use stoss_reference_element::{FacePiece, FacetKind, FacetNodes, Nodal};

/// What a vertex that is no node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Vertex {
    /// A vertex of the trace, in the place of a node of the mesh.
    Node(u32),
    /// A vertex of the trace, in the middle of a face that has no node there: element and number in it.
    Middle(u32, u8),
    /// A vertex on the face itself, at its middle.
    Centre(u32, u8),
    /// A vertex of a finer facet of a round surface.
    Round(VertexKey),
}

/// Which vertices a scene needs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Needs {
    /// Whether vertices of traces are needed: something looks at surfaces that does not know of faces.
    pub trace: bool,
    /// Whether vertices on faces are needed: mortar contact or a tie.
    pub faces: bool,
}

impl Needs {
    /// The needs of a scene.
    pub fn of(scene: &Scene) -> Self {
        let integrates = |contact: &crate::scene::Contact| contact.method.integrates;
        Self {
            trace: !scene.contacts.iter().all(integrates) || super::general_contact(scene).is_some(),
            faces: scene.contacts.iter().any(integrates) || !scene.ties.is_empty(),
        }
    }
}

/// Global numbers of the vertices that are no nodes; none of a mesh without quadratic faces.
#[derive(Clone, Debug, Default)]
pub(crate) struct Traces {
    vertices: BTreeMap<Vertex, u32>,
    has_trace: bool,
    /// Finer facets of round surfaces, in global node numbers, by element and number in it.
    finer: BTreeMap<(u32, u8), Vec<FacetNodes>>,
}

fn vertex(facet: &Facet, v: usize) -> Vertex {
    facet.nodes.get(v).map_or(Vertex::Middle(facet.element, facet.local), |&node| Vertex::Node(node))
}

impl Traces {
    /// Adds the vertices of all facets on the boundary of a mesh or in its sets to the model.
    pub fn add(mesh: &Mesh, needs: Needs, first_node: u32, model: &mut Model) -> Self {
        let mut traces = Self::default();
        if !mesh.elements.kinds().into_iter().any(|kind| kind.is_quadratic()) {
            return traces;
        }
        traces.has_trace = needs.trace;
        let boundary = mesh.boundary_facets();
        let facets = || boundary.iter().chain(mesh.facet_sets.values().flatten());
        if needs.trace {
            for facet in facets() {
                let kind = facet.nodes.kind();
                for (v, terms) in kind.trace().vertices.iter().enumerate().skip(kind.corner_count()) {
                    let carriers = terms.iter().map(|&(n, w)| (first_node + facet.nodes[usize::from(n)], w));
                    let shown = facet.nodes.get(v).map(|&n| first_node + n);
                    traces.add_vertex(vertex(facet, v), carriers, shown, model);
                }
            }
        }
        if needs.faces {
            for facet in facets().filter(|facet| facet.nodes.kind().lacks_centre()) {
                let shape = facet.nodes.kind().shape([0.0; 2]);
                let carriers = facet.nodes.iter().zip(shape).map(|(&n, w)| (first_node + n, w));
                traces.add_vertex(Vertex::Centre(facet.element, facet.local), carriers, None, model);
            }
        }
        traces
    }

    fn add_vertex(
        &mut self,
        vertex: Vertex,
        carriers: impl Iterator<Item = (u32, f64)>,
        shown: Option<u32>,
        model: &mut Model,
    ) {
        self.vertices.entry(vertex).or_insert_with(|| {
            let carriers: Vec<(u32, f64)> = carriers.collect();
            let node = model.node_count() as u32;
            let sum = |values: &[f64]| -> [f64; 3] {
                std::array::from_fn(|i| carriers.iter().map(|&(n, w)| w * values[3 * n as usize + i]).sum())
            };
            model.reference.extend(sum(&model.reference));
            if !model.velocity.is_empty() {
                model.velocity.extend(sum(&model.velocity));
            }
            model.embedding.add(node, &carriers);
            model.traces.insert(node, shown);
            node
        });
    }

    /// The linear facets of a facet's trace, in global node numbers. Without what needs the trace they are pieces on the nodes.
    pub fn facets_of(&self, facet: &Facet, first_node: u32) -> Vec<FacetNodes> {
        let kind = facet.nodes.kind();
        if let Some(finer) = self.finer.get(&(facet.element, facet.local)) {
            return finer.clone();
        }
        if !kind.is_quadratic() || !self.has_trace {
            return self.pieces_of(facet, first_node).map(|piece| piece.facet()).collect();
        }
        let node = |v: usize| {
            if v < kind.corner_count() { first_node + facet.nodes[v] } else { self.vertices[&vertex(facet, v)] }
        };
        let of_piece = |piece: &&[u8]| {
            let shape = if piece.len() == 3 { FacetKind::Tri3 } else { FacetKind::Quad4 };
            Nodal::from_fn(shape, |k| node(usize::from(piece[k])))
        };
        kind.trace().facets.iter().map(of_piece).collect()
    }

    /// Takes finer facets of round surfaces in place of those of the mesh, of the body that was added to the model last. Their vertices are points of its elements, in which they may lie a little outside; one that is farther is an error.
    pub fn refine(&mut self, finer: &Finer, first_node: u32, model: &mut Model) -> Result<(), [f64; 3]> {
        for (place, (element, x)) in &finer.points {
            let x = <[f64; 3]>::from(*x);
            let solid = &model.bodies.last().ok_or(x)?.solid;
            let point = solid.material_point_of(*element as usize, &model.reference, x, BEYOND).ok_or(x)?;
            let (kind, nodes) = (solid.elements().kind(point.element), &solid.elements()[point.element]);
            let carriers: Vec<(u32, f64)> = nodes.iter().copied().zip((kind.table().shape)(point.natural)).collect();
            self.add_vertex(Vertex::Round(*place), carriers.into_iter(), None, model);
        }
        let number = |corner: &Corner| match corner {
            Corner::Node(node) => first_node + node,
            Corner::Point(place) => self.vertices[&Vertex::Round(*place)],
        };
        let of_facet = |list: &Vec<Vec<Corner>>| list.iter().map(|corners| Finer::nodes(corners, number)).collect();
        self.finer = finer.facets.iter().map(|(&key, list)| (key, of_facet(list))).collect();
        Ok(())
    }

    /// The pieces of a facet on its nodes, in global node numbers.
    pub fn pieces_of(&self, facet: &Facet, first_node: u32) -> impl Iterator<Item = FacePiece> + use<> {
        let centre = self.vertices.get(&Vertex::Centre(facet.element, facet.local)).copied();
        FacePiece::of_face(facet.nodes.map(|n| first_node + n), centre)
    }
}
