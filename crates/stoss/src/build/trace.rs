//! The surfaces that contact sees of quadratic faces (theory/elements#contact): embedded nodes in place of those on edges and in the middle.

use crate::solver::Model;
use std::collections::BTreeMap;
use stoss_mesh::{Facet, Mesh};
use stoss_reference_element::{FacetKind, FacetNodes, Nodal};

/// What a vertex of a trace is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Vertex {
    /// That of a node of the mesh.
    Node(u32),
    /// The middle of a face that has no node there: element and number in it.
    Middle(u32, u8),
}

/// Global numbers of the vertices of traces that are no corners; none of a mesh without quadratic faces.
#[derive(Clone, Debug, Default)]
pub(crate) struct Traces(BTreeMap<Vertex, u32>);

fn vertex(facet: &Facet, v: usize) -> Vertex {
    facet.nodes.get(v).map_or(Vertex::Middle(facet.element, facet.local), |&node| Vertex::Node(node))
}

impl Traces {
    /// Adds the vertices of all facets on the boundary of a mesh or in its sets to the model.
    pub fn add(mesh: &Mesh, first_node: u32, model: &mut Model) -> Self {
        let mut traces = BTreeMap::new();
        if !mesh.elements.kinds().into_iter().any(|kind| kind.is_quadratic()) {
            return Self(traces);
        }
        let boundary = mesh.boundary_facets();
        for facet in boundary.iter().chain(mesh.facet_sets.values().flatten()) {
            let trace = facet.nodes.kind().trace();
            for (v, terms) in trace.vertices.iter().enumerate().skip(facet.nodes.kind().corner_count()) {
                traces.entry(vertex(facet, v)).or_insert_with(|| {
                    let carriers: Vec<(u32, f64)> =
                        terms.iter().map(|&(n, w)| (first_node + facet.nodes[usize::from(n)], w)).collect();
                    let node = model.node_count() as u32;
                    let sum = |values: &[f64]| -> [f64; 3] {
                        std::array::from_fn(|i| carriers.iter().map(|&(n, w)| w * values[3 * n as usize + i]).sum())
                    };
                    model.reference.extend(sum(&model.reference));
                    if !model.velocity.is_empty() {
                        model.velocity.extend(sum(&model.velocity));
                    }
                    model.embedding.add(node, &carriers);
                    let shown = facet.nodes.get(v).map(|&n| first_node + n);
                    model.traces.insert(node, shown);
                    node
                });
            }
        }
        Self(traces)
    }

    /// The linear facets that contact sees of a facet, in global node numbers.
    /// Without contact, for which there are no vertices, pieces on the nodes.
    pub fn facets_of(&self, facet: &Facet, first_node: u32) -> Vec<FacetNodes> {
        let kind = facet.nodes.kind();
        if !kind.is_quadratic() || self.0.is_empty() {
            return facet.nodes.map(|n| first_node + n).pieces().collect();
        }
        let node = |v: usize| {
            if v < kind.corner_count() { first_node + facet.nodes[v] } else { self.0[&vertex(facet, v)] }
        };
        let of_piece = |piece: &&[u8]| {
            let shape = if piece.len() == 3 { FacetKind::Tri3 } else { FacetKind::Quad4 };
            Nodal::from_fn(shape, |k| node(usize::from(piece[k])))
        };
        kind.trace().facets.iter().map(of_piece).collect()
    }
}
