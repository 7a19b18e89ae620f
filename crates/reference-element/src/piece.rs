//! Linear facets that are pieces of faces.

use crate::{FaceGradient, FaceNodes, FaceShape, FacetKind, FacetNodes, Nodal};

/// A linear facet that is a piece of a face: the facet says where a point is, the face what the position of that point is. A linear face is its own only piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacePiece {
    facet: FacetNodes,
    face: FaceNodes,
    corners: Nodal<[f64; 2]>,
}

impl FacePiece {
    /// The pieces of a face, with corners on its nodes. `centre`: the number of a vertex at natural coordinates zero of a face that has no node there
    /// ([`crate::FaceKind::lacks_centre`]); without it that face is divided on its nodes alone.
    pub fn of_face(face: FaceNodes, centre: Option<u32>) -> impl Iterator<Item = Self> {
        let kind = face.kind();
        let pieces = if centre.is_some() || !kind.lacks_centre() { kind.trace().facets } else { kind.pieces() };
        pieces.iter().map(move |piece| {
            let shape = if piece.len() == 3 { FacetKind::Tri3 } else { FacetKind::Quad4 };
            let places = |k: usize| usize::from(piece[k]);
            Self {
                facet: Nodal::from_fn(shape, |k| face.get(places(k)).copied().or(centre).unwrap_or(face[0])),
                face,
                corners: Nodal::from_fn(shape, |k| kind.nodes().get(places(k)).copied().unwrap_or_default()),
            }
        })
    }

    /// The linear facet.
    #[inline]
    pub fn facet(&self) -> FacetNodes {
        self.facet
    }

    /// The face.
    #[inline]
    pub fn face(&self) -> FaceNodes {
        self.face
    }

    /// Numbers of the face's nodes.
    #[inline]
    pub fn face_nodes(&self) -> &[u32] {
        &self.face
    }

    /// Natural coordinates of the facet's corners in the face.
    #[inline]
    pub fn corners(&self) -> &Nodal<[f64; 2]> {
        &self.corners
    }

    /// Natural coordinates in the face of a point of the facet, and their derivatives: row the coordinate of the face, column that of the facet.
    fn place(&self, xi: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        let kind = self.corners.kind();
        let (n, dn) = (kind.shape(xi), kind.shape_gradient(xi));
        let (mut zeta, mut slope) = ([0.0; 2], [[0.0; 2]; 2]);
        for ((corner, n), dn) in self.corners.iter().zip(n).zip(dn) {
            for i in 0..2 {
                zeta[i] += n * corner[i];
                (0..2).for_each(|b| slope[i][b] += dn[b] * corner[i]);
            }
        }
        (zeta, slope)
    }

    /// Shape functions of the face at a point of the facet.
    pub fn shape(&self, xi: [f64; 2]) -> FaceShape {
        self.face.kind().shape(self.place(xi).0)
    }

    /// Gradients of the face's shape functions by the coordinates of the facet, at a point of the facet.
    pub fn shape_gradient(&self, xi: [f64; 2]) -> FaceGradient {
        let (zeta, slope) = self.place(xi);
        self.face.kind().shape_gradient(zeta).map(|g| [0, 1].map(|b| g[0] * slope[0][b] + g[1] * slope[1][b]))
    }
}

/// A facet is a linear face.
impl<F: Into<FacetNodes>> From<F> for FacePiece {
    fn from(facet: F) -> Self {
        let facet = facet.into();
        let kind = facet.kind();
        Self { facet, face: facet.into(), corners: Nodal::from_fn(kind, |k| kind.vertices()[k]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceKind;

    /// Pieces tile their face, and at their corners a face has its nodes.
    #[test]
    fn pieces_tile_the_face() {
        for kind in FaceKind::ALL {
            let face = FaceNodes::from_fn(kind, |k| k as u32);
            for centre in [None, Some(100)] {
                let mut area = 0.0;
                for piece in FacePiece::of_face(face, centre) {
                    let flat = piece.facet().kind();
                    for (k, &node) in piece.facet().iter().enumerate() {
                        let shape = piece.shape(flat.vertices()[k]);
                        let at = |node: u32| if (node as usize) < face.len() { node as usize } else { usize::MAX };
                        for (j, n) in shape.iter().enumerate().filter(|_| at(node) != usize::MAX) {
                            assert_eq!(*n, f64::from(u8::from(j == at(node))), "{kind} {node}");
                        }
                    }
                    for &(xi, w) in flat.rule() {
                        let ([..], s) = piece.place(xi);
                        area += w * (s[0][0] * s[1][1] - s[0][1] * s[1][0]);
                        let h = 1e-6;
                        for b in 0..2 {
                            let moved =
                                |d: f64| piece.shape(std::array::from_fn(|i| xi[i] + if i == b { d } else { 0.0 }));
                            let (plus, minus) = (moved(h), moved(-h));
                            for (j, g) in piece.shape_gradient(xi).iter().enumerate() {
                                assert!((g[b] - (plus[j] - minus[j]) / (2.0 * h)).abs() < 1e-9, "{kind}");
                            }
                        }
                    }
                }
                assert!((area - kind.linear().area()).abs() < 1e-14, "{kind}");
            }
        }
    }
}
