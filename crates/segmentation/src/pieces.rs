//! Convex pieces of a facet's image in the plane.

use crate::map::{FacetMap, Images};
use crate::plane::orient;
use stoss_reference_element::{MAX_NODES, Nodal};

/// A convex polygon of corners of a facet, counter-clockwise in the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConvexPolygon {
    pub count: usize,
    /// Corners of the facet.
    pub corners: [u8; MAX_NODES],
    /// Images of the corners in the plane of projection, two lengths each.
    pub points: [[f64; 2]; MAX_NODES],
    pub map: FacetMap,
    /// Planes of symmetry that the corners lie in, a bit each.
    pub planes: [u8; MAX_NODES],
}

impl ConvexPolygon {
    /// Notes the planes that the corners of the facet lie in.
    pub fn set_planes(&mut self, of_facet: [u8; MAX_NODES]) {
        self.planes = self.corners.map(|k| of_facet[k as usize]);
    }

    /// Planes that both corners of a side lie in.
    pub fn planes_of_side(&self, side: usize) -> u8 {
        self.planes[side] & self.planes[(side + 1) % self.count]
    }

    fn triangle(order: [u8; 3], images: &Images) -> Option<Self> {
        let p = order.map(|k| images[k as usize]);
        (orient(p[0], p[1], p[2]) > 0.0).then_some(Self {
            count: 3,
            corners: [order[0], order[1], order[2], order[0]],
            points: [p[0], p[1], p[2], p[0]],
            map: FacetMap::Affine { kind: images.kind(), corners: order },
            planes: [0; MAX_NODES],
        })
    }

    /// Which [`stoss_reference_element::FacetKind::side`] of the facet side `side` of the piece is.
    pub fn edge(&self, side: usize) -> u8 {
        let (a, b) = (self.corners[side], self.corners[(side + 1) % self.count]);
        // cannot fail: every two corners of a facet have a side.
        self.map.kind().side_between(a as usize, b as usize).map_or(0, |side| side as u8)
    }
}

/// Order in which the corners of a facet are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Orientation {
    /// The order of their numbers.
    Forward,
    /// The order against that of their numbers: for a facet that looks the other way.
    Backward,
}

/// The convex pieces of a facet that are counter-clockwise in the plane when its corners are taken in this order.
///
/// The whole facet if the image is strictly convex. Otherwise, of a quadrilateral, the triangles of positive area that a diagonal
/// leaves: of both diagonals the one whose triangles reach less to the negative side. For a reflex image that is the
/// inner one; an image that crosses itself has one triangle of each sign, and the smaller the crossing, the less is
/// lost.
pub(crate) fn split(images: &Images, orientation: Orientation) -> ([Option<ConvexPolygon>; 2], bool) {
    let kind = images.kind();
    let count = images.len();
    let order = Nodal::from_fn(kind, |k| match orientation {
        Orientation::Forward => k as u8,
        Orientation::Backward => ((count - k) % count) as u8,
    });
    let p = order.map(|k| images[k as usize]);
    let turn = Nodal::from_fn(kind, |k| orient(p[kind.previous(k)], p[k], p[kind.next(k)]));
    if turn.iter().all(|&o| o > 0.0) {
        let (corners, points, planes) = (*order.padded(), *p.padded(), [0; MAX_NODES]);
        let whole = ConvexPolygon { count, corners, points, map: FacetMap::whole(kind), planes };
        return ([Some(whole), None], false);
    }
    // A diagonal cuts off the corners in the middle of its triangles, and their turns are the triangles' areas.
    let reach = |pieces: &[[u8; 3]; 2]| turn[pieces[0][1] as usize].min(turn[pieces[1][1] as usize]);
    let better = |best: &'static [[u8; 3]; 2], other| if reach(other) > reach(best) { other } else { best };
    let Some(pieces) = kind.pieces().iter().reduce(better) else { return ([None, None], false) };
    (pieces.map(|corners| ConvexPolygon::triangle(corners.map(|k| order[k as usize]), images)), true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_convex_reflex_crossed_and_reversed_images() {
        let count = |x: &[[f64; 2]; 4]| split(&(*x).into(), Orientation::Forward).0.iter().flatten().count();
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(!split(&square.into(), Orientation::Forward).1);
        assert_eq!(count(&[[0.0, 0.0], [0.4, 0.4], [1.0, 0.0], [0.5, 1.0]]), 2);
        assert_eq!(count(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), 1);
        assert_eq!(count(&[[0.0, 0.0], [5.0, 1.0], [1.0, 0.0], [5.0, 3.0]]), 1);
        assert_eq!(split(&square.into(), Orientation::Backward).0.iter().flatten().count(), 0);
        let triangle = Images::from([[0.0, 0.0], [1.0, 0.0], [0.3, 1.0]]);
        let pieces = |orientation| split(&triangle, orientation).0.iter().flatten().count();
        assert_eq!([pieces(Orientation::Forward), pieces(Orientation::Backward)], [1, 0]);
    }
}
