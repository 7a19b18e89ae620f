//! Facets that lie on each other without being the same: displacements are not continuous there.

use crate::vector::{cross, distance, dot, minus, norm, unit};
use crate::{Facet, FacetIndex, Mesh, MeshError};

/// Two facets lie roughly on each other at a common corner if their outward normals there are opposite within 8 degrees: chords of curved
/// edges differ by that much between a coarse and a fine side. Where that holds at all corners of a facet, it is no notch.
const OPPOSITE: f64 = -0.99;

/// Cosine from which two facets lie exactly on each other, within 0.3 degrees. One corner is enough then: a notch is not so sharp.
const EXACTLY_OPPOSITE: f64 = -0.999_986;

/// Nodes of the two faces of a crack are a pair if they are nearer along the faces than this part of the shortest edge of a facet; a crack may be open.
const PAIRED: f64 = 1e-3;

/// A direction lies inside an angle if it is farther than this, in radians, from its legs.
const INSIDE: f64 = 1e-3;

/// A facet at one of its corners: unit vectors along the edges that leave it, and the outward normal.
struct Angle {
    legs: [[f64; 3]; 2],
    normal: [f64; 3],
}

impl Angle {
    /// The angle of a facet at its corner number `i`; `None` if an edge has no length or both have the same direction.
    fn new(mesh: &Mesh, facet: &Facet, i: usize) -> Option<Angle> {
        let (nodes, n) = (&facet.nodes, facet.nodes.corners().len());
        let place = |k: usize| mesh.nodes[nodes[k] as usize];
        // the next node along each edge: its middle, where it has one
        let (next, previous) =
            if nodes.len() > n { (n + i, n + (i + n - 1) % n) } else { ((i + 1) % n, (i + n - 1) % n) };
        let legs = [unit(minus(place(next), place(i)))?, unit(minus(place(previous), place(i)))?];
        Some(Angle { legs, normal: unit(cross(legs[0], legs[1]))? })
    }

    fn contains(&self, direction: [f64; 3]) -> bool {
        let [first, second] = self.legs;
        dot(cross(first, direction), self.normal) > INSIDE && dot(cross(direction, second), self.normal) > INSIDE
    }

    fn bisector(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.legs[0][k] + self.legs[1][k])
    }

    /// Whether two angles with the same corner, in planes that are nearly the same, have more than a leg in common.
    fn overlaps(&self, other: &Angle) -> bool {
        let has_one_of = |a: &Angle, b: &Angle| b.legs.iter().any(|&leg| a.contains(leg)) || a.contains(b.bisector());
        has_one_of(self, other) || has_one_of(other, self)
    }
}

/// The facets of the boundary by their corners.
struct Boundary<'a> {
    mesh: &'a Mesh,
    facets: Vec<Facet>,
    /// A corner, a facet that has it and its number there; sorted.
    corners: Vec<(u32, u32, u8)>,
}

impl<'a> Boundary<'a> {
    fn new(mesh: &'a Mesh, index: &FacetIndex) -> Self {
        let facets = index.boundary();
        let mut corners = Vec::with_capacity(4 * facets.len());
        for (f, facet) in facets.iter().enumerate() {
            corners.extend(facet.nodes.corners().iter().enumerate().map(|(i, &node)| (node, f as u32, i as u8)));
        }
        corners.sort_unstable();
        Self { mesh, facets, corners }
    }

    /// The other facets with a corner at a node, and its number there.
    fn others_at(&self, f: usize, node: u32) -> impl Iterator<Item = (&Facet, usize)> {
        let start = self.corners.partition_point(|entry| entry.0 < node);
        let here = self.corners[start..].iter().take_while(move |entry| entry.0 == node);
        here.filter(move |entry| entry.1 as usize != f)
            .map(|&(_, other, i)| (&self.facets[other as usize], usize::from(i)))
    }

    /// The element of a facet that lies on facet number `f`: of a triangle with three corners of a quadrilateral, of a facet, no larger,
    /// that lies exactly on `f` at one corner and has not all of its corners at those of `f`, or of the first facet if others lie roughly on `f` at
    /// each of its corners.
    fn element_on(&self, f: usize) -> Option<u32> {
        let facet = &self.facets[f];
        let corners = facet.nodes.corners();
        let shared = |other: &Facet| other.nodes.corners().iter().filter(|node| corners.contains(node)).count();
        let mut first = None;
        let mut certain = None;
        let mut covered = true;
        for (i, &node) in corners.iter().enumerate() {
            let angle = Angle::new(self.mesh, facet, i);
            let mut on_corner = None;
            for (other, k) in self.others_at(f, node) {
                let is_certain = if shared(other) == 3 && other.nodes.corners().len() != corners.len() {
                    // it counts for the quadrilateral only
                    corners.len() == 4
                } else if let Some(cosine) = angle.as_ref().and_then(|angle| self.lies_on(angle, node, other, k)) {
                    on_corner.get_or_insert(other.element);
                    cosine < EXACTLY_OPPOSITE
                        && self.is_no_larger(other, facet)
                        && !self.are_faces_of_a_crack(facet, other)
                } else {
                    false
                };
                if is_certain {
                    let found = certain.get_or_insert(other.element);
                    *found = other.element.min(*found);
                }
            }
            covered &= on_corner.is_some();
            first = first.or(on_corner);
        }
        certain.or(first.filter(|_| covered))
    }

    fn edges(&self, facet: &Facet) -> impl Iterator<Item = f64> + use<'a> {
        let (mesh, corners) = (self.mesh, facet.nodes);
        let n = corners.corners().len();
        (0..n).map(move |i| distance(mesh.nodes[corners[i] as usize], mesh.nodes[corners[(i + 1) % n] as usize]))
    }

    /// Whether `other`, which lies on `facet`, is the smaller one, or neither is.
    fn is_no_larger(&self, other: &Facet, facet: &Facet) -> bool {
        self.edges(other).sum::<f64>() <= (1.0 + PAIRED) * self.edges(facet).sum::<f64>()
    }

    /// Whether all corners of two facets that lie on each other are pairs of nodes, as those of the two faces of a crack.
    fn are_faces_of_a_crack(&self, a: &Facet, b: &Facet) -> bool {
        let place = |node: u32| self.mesh.nodes[node as usize];
        let (first, second) = (a.nodes.corners(), b.nodes.corners());
        let near = PAIRED * self.edges(a).fold(f64::INFINITY, f64::min);
        let Some(normal) = (0..first.len()).find_map(|i| Some(Angle::new(self.mesh, a, i)?.normal)) else {
            return false;
        };
        let along = |x: [f64; 3]| norm(cross(x, normal));
        let has_pair = |node: &u32| second.iter().any(|other| along(minus(place(*node), place(*other))) <= near);
        first.len() == second.len() && first.iter().all(has_pair)
    }

    /// The cosine of the normals if `other` lies on the angle of a facet at their common corner, with its element on the other side.
    fn lies_on(&self, angle: &Angle, node: u32, other: &Facet, corner: usize) -> Option<f64> {
        let opposite = Angle::new(self.mesh, other, corner)?;
        let corner = self.mesh.nodes[node as usize];
        // at the sharp edge of one body the normals are opposite, too, but there is nothing beyond the facet
        let beyond = || {
            let x = self.mesh.element_coordinates(other.element);
            x.iter().map(|x| dot(minus(*x, corner), angle.normal)).sum::<f64>() > 0.0
        };
        let cosine = dot(angle.normal, opposite.normal);
        (cosine < OPPOSITE && angle.overlaps(&opposite) && beyond()).then_some(cosine)
    }
}

impl Mesh {
    /// Checks that no facet on the boundary lies on others: a quadrilateral on triangles, a large one on small ones, a quadratic one on linear
    /// ones, or meshes of two parts that do not fit. Such facets have corners in common, so that no search in space is needed. The faces of
    /// a crack, which have common nodes at its front, have to match.
    pub(crate) fn check_conforming(&self, index: &FacetIndex) -> Result<(), MeshError> {
        let boundary = Boundary::new(self, index);
        let mut pairs = (0..boundary.facets.len()).filter_map(|f| Some((&boundary.facets[f], boundary.element_on(f)?)));
        let Some((facet, other)) = pairs.next() else { return Ok(()) };
        let elements = [facet.element, other];
        let kinds = elements.map(|e| self.elements.kind(e as usize).name()).join(", ");
        let corners = facet.nodes.corners();
        let weight = 1.0 / corners.len() as f64;
        let centre = std::array::from_fn(|i| corners.iter().map(|&n| weight * self.nodes[n as usize][i]).sum());
        Err(MeshError::NonConformingFacet { elements, kinds, centre, count: pairs.count() + 1 })
    }
}
