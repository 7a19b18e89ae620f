//! The segmentation plane of a slave facet.

use crate::SegmentationError;
use crate::cell::{Cell, split};
use nalgebra::{Matrix3, Vector3};

/// Plane through the centre of a slave facet, normal to it there, and the images of its corners.
///
/// `n0 = d1 x d2 / |d1 x d2|` with the diagonals `d1 = x3 - x1`, `d2 = x4 - x2`, which is the facet's normal at `xi =
/// 0`; outward of the slave if the facet is numbered so. Coordinates in the plane are lengths along `d1` and along
/// `n0 x d1`.
#[derive(Clone, Debug)]
pub struct SlaveFrame {
    corners: [Vector3<f64>; 4],
    centre: Vector3<f64>,
    normal: Vector3<f64>,
    tangents: [Vector3<f64>; 2],
    diagonal_product: f64,
    pub(crate) images: [[f64; 2]; 4],
    pub(crate) cells: [Option<Cell>; 2],
    is_split: bool,
}

impl SlaveFrame {
    /// The frame of the facet with these corners, counter-clockwise seen from outside.
    ///
    /// # Errors
    /// [`SegmentationError::NotFinite`], [`SegmentationError::DegenerateSlave`] if the diagonals are parallel to
    /// round-off.
    pub fn new(corners: [Vector3<f64>; 4]) -> Result<Self, SegmentationError> {
        if !corners.iter().all(|x| x.iter().all(|c| c.is_finite())) {
            return Err(SegmentationError::NotFinite { side: "slave" });
        }
        let (d1, d2) = (corners[2] - corners[0], corners[3] - corners[1]);
        let c = d1.cross(&d2);
        let area = c.norm();
        if area.is_nan() || area <= 1e-14 * d1.norm() * d2.norm() {
            return Err(SegmentationError::DegenerateSlave { area });
        }
        let normal = c / area;
        let t1 = d1.normalize();
        let mut frame = Self {
            corners,
            centre: corners.iter().sum::<Vector3<f64>>() / 4.0,
            normal,
            tangents: [t1, normal.cross(&t1)],
            diagonal_product: area,
            images: [[0.0; 2]; 4],
            cells: [None; 2],
            is_split: false,
        };
        frame.images = corners.map(|x| frame.image(&x));
        (frame.cells, frame.is_split) = split(&frame.images, [0, 1, 2, 3]);
        Ok(frame)
    }

    /// Corners of the slave facet.
    pub fn corners(&self) -> &[Vector3<f64>; 4] {
        &self.corners
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

    /// `d n0 / d x_I` for the four slave nodes.
    pub fn normal_derivatives(&self) -> [Matrix3<f64>; 4] {
        let (d1, d2) = (self.corners[2] - self.corners[0], self.corners[3] - self.corners[1]);
        let n = self.normal;
        let p = (Matrix3::identity() - n * n.transpose()) / self.diagonal_product;
        let (by_d1, by_d2) = (-p * d2.cross_matrix(), p * d1.cross_matrix());
        [-by_d1, -by_d2, by_d1, by_d2]
    }
}
