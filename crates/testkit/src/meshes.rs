//! Surfaces of quadrilaterals, of triangles and of both, over the same nodes.

use proptest::prelude::*;
use stoss_reference_element::{FacetKind, FacetNodes, Nodal};

/// Which facets a surface has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mesh {
    /// The quadrilaterals themselves.
    Quads,
    /// Quadrilaterals each divided along a diagonal, the one or the other in turn.
    Triangles,
    /// Quadrilaterals of which every other one is divided.
    Mixed,
}

impl Mesh {
    /// All meshes.
    pub const ALL: [Self; 3] = [Self::Quads, Self::Triangles, Self::Mixed];

    /// Meshes of two surfaces opposite each other.
    pub const PAIRS: [[Self; 2]; 5] = [
        [Self::Quads, Self::Quads],
        [Self::Triangles, Self::Quads],
        [Self::Quads, Self::Triangles],
        [Self::Triangles, Self::Triangles],
        [Self::Mixed, Self::Mixed],
    ];

    /// The pieces of the quadrilateral number `k`.
    pub fn pieces<T: Copy>(self, k: usize, quad: [T; 4]) -> Vec<Nodal<T>> {
        if self == Self::Quads || self == Self::Mixed && k.is_multiple_of(2) {
            return vec![quad.into()];
        }
        let way = FacetKind::Quad4.pieces()[k / 2 % 2];
        way.iter().map(|corners| corners.map(|c| quad[usize::from(c)]).into()).collect()
    }

    /// A surface of these facets.
    pub fn of(self, quads: &[[u32; 4]]) -> Vec<FacetNodes> {
        quads.iter().enumerate().flat_map(|(k, quad)| self.pieces(k, *quad)).collect()
    }
}

/// Makes the facets of one side of a pair from quadrilaterals.
pub fn divide(meshes: [Mesh; 2]) -> impl Fn(usize, &[[u32; 4]]) -> Vec<FacetNodes> {
    move |side, quads| meshes[side].of(quads)
}

/// Any mesh.
pub fn mesh() -> impl Strategy<Value = Mesh> {
    prop::sample::select(&Mesh::ALL[..])
}

/// Meshes of two surfaces.
pub fn meshes() -> impl Strategy<Value = [Mesh; 2]> {
    prop::sample::select(&Mesh::PAIRS[..])
}
