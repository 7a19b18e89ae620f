//! Meshes of other cells: hexahedra and wedges divided into tetrahedra or wedges, linear cells made quadratic.
//!
//! Nodes stay where they are and keep their numbers; new ones follow. Boundaries that are curved stay so ([`curve`]). Facet and element sets hold what lies on or in
//! the old facets and elements; a node set gets the new nodes of edges, faces and elements all of whose corners it has.

mod curve;
mod divide;

use std::collections::{BTreeMap, BTreeSet};

use stoss_reference_element::{CellKind, FaceKind, Family};

use crate::error::parameter;
use crate::{Elements, Mesh, MeshError};

impl Mesh {
    /// The mesh with all elements of one kind. Linear hexahedra can become any kind, linear wedges wedges and tetrahedra, linear tetrahedra
    /// tetrahedra; elements of that kind stay.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] if an element cannot become one of that kind; [`MeshError::CurvedBoundary`] if a curved boundary turns an element
    /// inside out.
    pub fn with_cells(&self, kind: CellKind) -> Result<Mesh, MeshError> {
        if self.elements.kinds() == [kind] {
            return Ok(self.clone());
        }
        let linear = kind.table().linear;
        let divided = divide::divided(self, linear, kind)?;
        if kind == linear { finish(divided) } else { divided.upgraded(&curve::Curves::new(self), |_| kind) }
    }

    /// The mesh with nodes on the edges of its linear elements: hex20, tet10 and wedge15 in place of hex8, tet4 and wedge6.
    ///
    /// # Errors
    /// [`MeshError::CurvedBoundary`] if a curved boundary turns an element inside out.
    pub fn quadratic(&self) -> Result<Mesh, MeshError> {
        self.upgraded(&curve::Curves::new(self), CellKind::quadratic)
    }

    /// The mesh with linear elements replaced by quadratic ones of these kinds on the same corners.
    fn upgraded(&self, curves: &curve::Curves, quadratic: impl Fn(CellKind) -> CellKind) -> Result<Mesh, MeshError> {
        let mut mesh = Mesh { nodes: self.nodes.clone(), ..Mesh::default() };
        // New nodes, and those of elements that are quadratic already, by the corners that they lie between.
        let mut between: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
        for (kind, nodes) in self.elements.cells().filter(|(kind, _)| kind.is_quadratic()) {
            for [a, b, middle] in kind.table().edges {
                let [a, b, middle] = [a, b, middle].map(|&k| nodes[usize::from(k)]);
                between.insert(vec![a.min(b), a.max(b)], middle);
            }
            for face in kind.faces().iter().filter(|face| face.nodes.len() == 9) {
                let mut key: Vec<u32> = face.nodes[..4].iter().map(|&k| nodes[usize::from(k)]).collect();
                key.sort_unstable();
                between.insert(key, nodes[usize::from(face.nodes[8])]);
            }
        }
        for (kind, corners) in self.elements.cells() {
            let quadratic = quadratic(kind);
            if quadratic == kind {
                mesh.elements.push(kind, corners);
                continue;
            }
            let mut nodes = corners.to_vec();
            let mut node = |mesh: &mut Mesh, corners: Vec<u32>, place: &dyn Fn(&[[f64; 3]]) -> [f64; 3]| {
                let mut key = corners;
                key.sort_unstable();
                *between.entry(key).or_insert_with(|| {
                    let x = place(&mesh.nodes);
                    mesh.nodes.push(x);
                    mesh.nodes.len() as u32 - 1
                })
            };
            for [a, b, _] in quadratic.table().edges {
                let [a, b] = [a, b].map(|&k| corners[usize::from(k)]);
                nodes.push(node(&mut mesh, vec![a, b], &|x| curves.middle(x, a, b)));
            }
            if quadratic == CellKind::Hex27 {
                // Faces in the order of the nodes 20 to 25, then the centre: where the nodes on the edges put them.
                for face in [5, 3, 2, 4, 0, 1] {
                    let face = &quadratic.faces()[face];
                    let of_face: Vec<u32> = face.nodes[..8].iter().map(|&k| nodes[usize::from(k)]).collect();
                    let shape = FaceKind::Quad8.shape([0.0; 2]);
                    let corners = of_face[..4].to_vec();
                    nodes.push(node(&mut mesh, corners, &|x| sum(x, &of_face, &shape)));
                }
                let shape = (CellKind::Hex20.table().shape)([0.0; 3]);
                let of_edges = nodes[..20].to_vec();
                nodes.push(node(&mut mesh, corners.to_vec(), &|x| sum(x, &of_edges, &shape)));
            }
            mesh.elements.push(quadratic, &nodes);
        }
        let first_new = self.nodes.len() as u32;
        let kinds: Vec<CellKind> = self.elements.cells().map(|(kind, _)| kind).collect();
        mesh.element_sets = self.element_sets.clone();
        mesh.element_vectors = self.element_vectors.clone();
        for (name, set) in &self.facet_sets {
            let facets = set.iter().map(|f| mesh.facet(f.element, f.local as usize)).collect();
            mesh.facet_sets.insert(name.clone(), facets);
        }
        for (name, set) in &self.node_sets {
            let old: BTreeSet<u32> = set.iter().copied().collect();
            let new = between.iter().filter(|(corners, n)| **n >= first_new && corners.iter().all(|n| old.contains(n)));
            let new = new.map(|(_, &n)| n);
            let mut all: Vec<u32> = set.iter().copied().chain(new).collect();
            all.sort_unstable();
            mesh.node_sets.insert(name.clone(), all);
        }
        finish(mesh).map_err(|error| match error {
            MeshError::InvertedElement { element, jacobian, .. } => {
                let kind = quadratic(kinds[element as usize]);
                MeshError::CurvedBoundary { kind, element, jacobian, sharp: curves.perhaps_smooth_edges() }
            }
            other => other,
        })
    }
}

/// The sum of the places of nodes with weights.
fn sum(x: &[[f64; 3]], nodes: &[u32], weights: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| nodes.iter().zip(weights).map(|(&n, w)| w * x[n as usize][i]).sum())
}

/// Sorts the facet sets and checks the geometry.
fn finish(mut mesh: Mesh) -> Result<Mesh, MeshError> {
    mesh.facet_sets.values_mut().for_each(crate::check::normalise);
    mesh.check_geometry()?;
    Ok(mesh)
}

/// The error for an element that cannot become one of a kind.
fn cannot(element: usize, from: CellKind, to: CellKind) -> MeshError {
    let into = |family| matches!((from.table().family, family), (Family::Hexahedron, _) | (_, Family::Tetrahedron));
    let can = if from.is_quadratic() {
        ": only linear elements can be made others".to_owned()
    } else {
        let kinds = CellKind::ALL
            .into_iter()
            .filter(|kind| kind.table().family == from.table().family || into(kind.table().family));
        format!(", only {}", kinds.map(CellKind::name).collect::<Vec<_>>().join(", "))
    };
    parameter("cell", to.name(), format!("element {element} is a {from} and cannot become a {to}{can}"))
}

/// The mesh with new elements and the sets of the old one: those of old element `e` have the numbers `first_child[e]..first_child[e + 1]`.
fn with_elements(mesh: &Mesh, elements: Elements, first_child: &[u32]) -> Mesh {
    let mut new = Mesh { nodes: mesh.nodes.clone(), elements, node_sets: mesh.node_sets.clone(), ..Mesh::default() };
    let children = |e: u32| first_child[e as usize]..first_child[e as usize + 1];
    for (name, set) in &mesh.element_sets {
        new.element_sets.insert(name.clone(), set.iter().flat_map(|&e| children(e)).collect());
    }
    for (name, vectors) in &mesh.element_vectors {
        let of_children = vectors.iter().enumerate().flat_map(|(e, v)| children(e as u32).map(|_| *v));
        new.element_vectors.insert(name.clone(), of_children.collect());
    }
    for (name, set) in &mesh.facet_sets {
        let mut facets = Vec::new();
        for old in set {
            for child in children(old.element) {
                let faces = new.elements.kind(child as usize).faces().len();
                let candidates = (0..faces).map(|local| new.facet(child, local));
                facets.extend(candidates.filter(|f| f.nodes.iter().all(|n| old.nodes.contains(n))));
            }
        }
        new.facet_sets.insert(name.clone(), facets);
    }
    new
}
