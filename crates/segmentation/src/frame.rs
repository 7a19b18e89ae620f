//! The segmentation plane of a slave facet.

use crate::SegmentationError;
use crate::map::Images;
use crate::pieces::{ConvexPolygon, Orientation, split};
use nalgebra::{Matrix3, Vector3};
use stoss_reference_element::{FacetKind, MAX_NODES, Nodal};

/// Plane through the centre of a slave facet, normal to it there, and the images of its corners.
///
/// `n0 = d1 x d2 / |d1 x d2|` with the diagonals of [`FacetKind::diagonals`], which is the facet's normal at its
/// centre; outward of the slave if the facet is numbered so. Coordinates in the plane are lengths along `d1` and along
/// `n0 x d1`.
#[derive(Clone, Debug)]
pub struct SlaveFrame {
    corners: Nodal<Vector3<f64>>,
    normal_derivatives: [Matrix3<f64>; MAX_NODES],
    centre: Vector3<f64>,
    normal: Vector3<f64>,
    tangents: [Vector3<f64>; 2],
    diagonal_product: f64,
    pub(crate) images: Images,
    pub(crate) pieces: [Option<ConvexPolygon>; 2],
    is_split: bool,
}

impl SlaveFrame {
    /// The frame of the facet with these corners, counter-clockwise seen from outside.
    ///
    /// # Errors
    /// [`SegmentationError::NotFinite`], [`SegmentationError::DegenerateSlave`] if the diagonals are parallel to
    /// round-off.
    pub fn new(corners: impl Into<Nodal<Vector3<f64>>>) -> Result<Self, SegmentationError> {
        let corners = corners.into();
        if !corners.iter().all(|x| x.iter().all(|c| c.is_finite())) {
            return Err(SegmentationError::NotFinite { side: "slave" });
        }
        let [d1, d2] = corners.kind().diagonals().map(|d| weighted(&d, &corners));
        let c = d1.cross(&d2);
        let area = c.norm();
        if area.is_nan() || area <= 1e-14 * d1.norm() * d2.norm() {
            return Err(SegmentationError::DegenerateSlave { area });
        }
        let normal = c / area;
        let t1 = d1.normalize();
        let mut frame = Self {
            corners,
            normal_derivatives: normal_derivatives(corners.kind(), [d1, d2], normal, area),
            centre: corners.iter().sum::<Vector3<f64>>() / corners.len() as f64,
            normal,
            tangents: [t1, normal.cross(&t1)],
            diagonal_product: area,
            images: corners.map(|_| [0.0; 2]),
            pieces: [None; 2],
            is_split: false,
        };
        frame.images = corners.map(|x| frame.image(&x));
        (frame.pieces, frame.is_split) = split(&frame.images, Orientation::Forward);
        Ok(frame)
    }

    /// Tells which planes of symmetry the corners lie in, a bit each.
    #[must_use]
    pub fn with_planes(mut self, planes: &Nodal<u8>) -> Self {
        self.pieces.iter_mut().flatten().for_each(|piece| piece.set_planes(*planes.padded()));
        self
    }

    /// Corners of the slave facet.
    pub fn corners(&self) -> &Nodal<Vector3<f64>> {
        &self.corners
    }

    /// The kind of the slave facet.
    pub fn kind(&self) -> FacetKind {
        self.corners.kind()
    }

    /// Unit normal `n0`, direction of projection.
    pub fn normal(&self) -> Vector3<f64> {
        self.normal
    }

    /// Orthonormal tangents of the plane.
    pub fn tangents(&self) -> [Vector3<f64>; 2] {
        self.tangents
    }

    /// Whether the slave's own image is not convex (strong warp), so that it was split into triangles with affine
    /// coordinates.
    pub fn is_split(&self) -> bool {
        self.is_split
    }

    /// Area of the slave's image, an area; for a plane facet that of the facet.
    pub fn image_area(&self) -> f64 {
        0.5 * self.diagonal_product
    }

    /// Image of a point in the plane, two lengths.
    pub fn image(&self, x: &Vector3<f64>) -> [f64; 2] {
        let r = x - self.centre;
        [self.tangents[0].dot(&r), self.tangents[1].dot(&r)]
    }

    /// `d n0 / d x_I` for the slave nodes.
    pub fn normal_derivatives(&self) -> &[Matrix3<f64>; MAX_NODES] {
        &self.normal_derivatives
    }
}

/// Derivatives of a unit normal `n = d1 x d2 / |d1 x d2|` by the nodes; `length` is `|d1 x d2|`, an area.
fn normal_derivatives(
    kind: FacetKind,
    [d1, d2]: [Vector3<f64>; 2],
    n: Vector3<f64>,
    length: f64,
) -> [Matrix3<f64>; MAX_NODES] {
    let p = (Matrix3::identity() - n * n.transpose()) / length;
    let (by_d1, by_d2) = (-p * d2.cross_matrix(), p * d1.cross_matrix());
    let [c1, c2] = kind.diagonals();
    std::array::from_fn(|k| by_d1 * c1[k] + by_d2 * c2[k])
}

/// `sum_I w_I x_I`; weights are zero beyond the nodes.
pub(crate) fn weighted(weights: &[f64; MAX_NODES], x: &Nodal<Vector3<f64>>) -> Vector3<f64> {
    let x = x.padded();
    x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2] + x[3] * weights[3]
}
