//! Everything that makes a mesh unusable, as a named error.

use std::collections::HashMap;

use crate::element::edge_range;
use crate::validity::not_positive;
use crate::vector::distance;
use crate::{Facet, FacetIndex, Mesh, MeshError, SetKind};

/// Two nodes are one if they are closer than this times the shortest edge of the mesh. Files with 6 digits of an element
/// of 1/1000 of the body's size still distinguish neighbours from copies.
const COINCIDENT: f64 = 1e-4;

/// An edge has no length if it is shorter than this times the longest one of its element: round-off of the coordinates.
const NO_LENGTH: f64 = 1e-10;

/// What [`Mesh::coincident_nodes`] found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coincident {
    /// Number of nodes at the place of an earlier one.
    pub count: usize,
    /// The earlier node of the first such pair.
    pub first: u32,
    /// The other node of that pair.
    pub second: u32,
    /// Distance of both nodes, a length.
    pub distance: f64,
}

impl Mesh {
    /// Checks that the mesh can be computed with: elements exist, their nodes exist and differ, coordinates are finite,
    /// `det J > 0` at all Gauss points, and of quadratic elements wherever [`crate::ElementCoordinates::validity`] looks, no unused and no coincident nodes, no overlapping elements, no facets that lie on others without being the same, sets in range.
    ///
    /// # Errors
    /// The first problem found, in this order.
    pub fn check(&self) -> Result<(), MeshError> {
        if self.elements.is_empty() {
            return Err(MeshError::NoElements);
        }
        self.check_node_numbers()?;
        self.check_geometry()?;
        self.check_unused()?;
        if let Some(Coincident { first, second, distance, .. }) = self.coincident_nodes() {
            let coordinates = self.nodes[first as usize];
            return Err(MeshError::DuplicateNodes { first, second, coordinates, distance });
        }
        self.check_overlap()?;
        self.check_sets()
    }

    /// [`Mesh::check`], but two nodes may lie at the same place if no element has both: bodies that touch in one file, a crack. Whoever allows that should report
    /// [`Mesh::coincident_nodes`] to the user, because it may be an oversight.
    ///
    /// # Errors
    /// The errors of [`Mesh::check`].
    pub fn check_allowing_coincident(&self) -> Result<(), MeshError> {
        if self.elements.is_empty() {
            return Err(MeshError::NoElements);
        }
        self.check_node_numbers()?;
        self.check_geometry()?;
        self.check_unused()?;
        self.check_edges()?;
        self.check_overlap()?;
        self.check_sets()
    }

    /// Checks that no edge has the length zero: two nodes of an element at the same place.
    fn check_edges(&self) -> Result<(), MeshError> {
        for e in 0..self.elements.len() {
            let (nodes, x) = (&self.elements[e], self.element_coordinates(e as u32));
            let longest = edge_range(&x).1;
            for &[a, b] in self.elements.kind(e).edges() {
                let [a, b] = [usize::from(a), usize::from(b)];
                let distance = distance(x[a], x[b]);
                if distance <= NO_LENGTH * longest {
                    let (first, second) = (nodes[a].min(nodes[b]), nodes[a].max(nodes[b]));
                    return Err(MeshError::DuplicateNodes { first, second, coordinates: x[a], distance });
                }
            }
        }
        Ok(())
    }

    pub(crate) fn check_node_numbers(&self) -> Result<(), MeshError> {
        let count = self.nodes.len();
        for (e, nodes) in self.elements.iter().enumerate() {
            if let Some(&node) = nodes.iter().find(|&&n| n as usize >= count) {
                return Err(MeshError::NodeOutOfRange { element: e as u32, node, count });
            }
        }
        Ok(())
    }

    /// Finite coordinates, no node twice in an element, positive orientation.
    pub(crate) fn check_geometry(&self) -> Result<(), MeshError> {
        if let Some(n) = self.nodes.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
            return Err(MeshError::NonFiniteNode { node: n as u32, coordinates: self.nodes[n] });
        }
        for (e, nodes) in self.elements.iter().enumerate() {
            let element = e as u32;
            if let Some(i) = (1..nodes.len()).find(|&i| nodes[..i].contains(&nodes[i])) {
                return Err(MeshError::RepeatedNode { element, nodes: nodes.to_vec(), node: nodes[i] });
            }
            let x = self.element_coordinates(element);
            let validity = x.kind().is_quadratic().then(|| x.validity());
            if let Some((point, jacobian)) = not_positive(&x, validity.as_ref()) {
                return Err(MeshError::InvertedElement { element, nodes: nodes.to_vec(), point, jacobian });
            }
        }
        Ok(())
    }

    fn check_unused(&self) -> Result<(), MeshError> {
        let mut used = vec![false; self.nodes.len()];
        for nodes in self.elements.iter() {
            for &n in nodes {
                used[n as usize] = true;
            }
        }
        match used.iter().position(|u| !u) {
            None => Ok(()),
            Some(first) => Err(MeshError::UnusedNodes {
                count: used.iter().filter(|u| !**u).count(),
                first: first as u32,
                coordinates: self.nodes[first],
            }),
        }
    }

    /// The nodes that lie at the place of an earlier one, within a ten-thousandth of the shortest edge; `None` if there are none.
    ///
    /// The nodes are sorted into cells as large as the shortest edge, so that each cell holds few.
    pub fn coincident_nodes(&self) -> Option<Coincident> {
        let shortest = (0..self.elements.len() as u32)
            .map(|e| edge_range(&self.element_coordinates(e)).0)
            .fold(f64::INFINITY, f64::min);
        // An edge of length zero joins two coincident nodes; a tiny cell size then still finds them.
        let (min, max) = self.bounding_box();
        let size = (0..3).map(|i| max[i] - min[i]).fold(0.0, f64::max);
        let cell = shortest.max(1e-12 * size).max(f64::MIN_POSITIVE);
        let tolerance = COINCIDENT * cell;
        let index = |x: [f64; 3], shift: f64| -> [i64; 3] {
            std::array::from_fn(|i| ((x[i] - min[i] + shift) / cell).floor() as i64)
        };
        let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::with_capacity(self.nodes.len());
        let mut found: Option<Coincident> = None;
        for (n, &x) in self.nodes.iter().enumerate() {
            let second = n as u32;
            match self.node_near(x, &cells, index(x, -tolerance), index(x, tolerance), tolerance) {
                None => cells.entry(index(x, 0.0)).or_default().push(second),
                Some((first, distance)) => {
                    found.get_or_insert(Coincident { count: 0, first, second, distance }).count += 1;
                }
            }
        }
        found
    }

    /// A node of the cells `low` to `high` within a distance.
    fn node_near(
        &self,
        x: [f64; 3],
        cells: &HashMap<[i64; 3], Vec<u32>>,
        low: [i64; 3],
        high: [i64; 3],
        tolerance: f64,
    ) -> Option<(u32, f64)> {
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                for k in low[2]..=high[2] {
                    for &m in cells.get(&[i, j, k]).map_or(&[][..], Vec::as_slice) {
                        let distance = distance(x, self.nodes[m as usize]);
                        if distance <= tolerance {
                            return Some((m, distance));
                        }
                    }
                }
            }
        }
        None
    }

    fn check_overlap(&self) -> Result<(), MeshError> {
        let index = FacetIndex::new(&self.elements);
        for group in index.groups() {
            for (i, (_, a)) in group.iter().enumerate() {
                if let Some((_, b)) = group[i + 1..].iter().find(|(_, b)| a.same_side(b)) {
                    return Err(MeshError::OverlappingElements {
                        elements: [a.element, b.element],
                        nodes: a.nodes.to_vec(),
                    });
                }
            }
            if let [(_, a), (_, b)] = group
                && (a.nodes.len() != b.nodes.len() || !a.nodes.iter().all(|n| b.nodes.contains(n)))
            {
                let elements = [a.element, b.element];
                let kinds = elements.map(|e| self.elements.kind(e as usize).name()).join(", ");
                return Err(MeshError::NonMatchingFacet { elements, kinds, nodes: a.nodes.to_vec() });
            }
        }
        self.check_conforming(&index)
    }

    fn check_sets(&self) -> Result<(), MeshError> {
        let range = |name: &String, kind: SetKind, index: u32, count: usize| {
            if (index as usize) < count {
                Ok(())
            } else {
                Err(MeshError::SetOutOfRange { name: name.clone(), kind, index, count })
            }
        };
        for (name, set) in &self.node_sets {
            set.iter().try_for_each(|&n| range(name, SetKind::Nodes, n, self.nodes.len()))?;
        }
        for (name, set) in &self.element_sets {
            set.iter().try_for_each(|&e| range(name, SetKind::Elements, e, self.elements.len()))?;
        }
        for (name, set) in &self.facet_sets {
            for facet in set {
                range(name, SetKind::Elements, facet.element, self.elements.len())?;
                let count = self.elements.kind(facet.element as usize).faces().len();
                let exists =
                    (facet.local as usize) < count && *facet == self.facet(facet.element, facet.local as usize);
                if !exists {
                    return Err(MeshError::SetOutOfRange {
                        name: name.clone(),
                        kind: SetKind::Facets,
                        index: u32::from(facet.local),
                        count,
                    });
                }
            }
        }
        Ok(())
    }
}

/// Sorts a set of facets and drops repetitions.
pub(crate) fn normalise(facets: &mut Vec<Facet>) {
    facets.sort_unstable();
    facets.dedup();
}
