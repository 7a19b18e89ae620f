//! Maps between the image of a facet in the plane and its convective coordinates.

use crate::plane::{cross, sub};
use stoss_reference_element::{FacetKind, MAX_NODES, Nodal, quad4};

/// How convective coordinates belong to points of (a piece of) a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacetMap {
    /// The bilinear map of a whole quadrilateral.
    Bilinear,
    /// The affine map of the triangle of three corners: a whole triangle, or a piece of a facet whose image is not convex.
    Affine {
        /// The kind of the whole facet.
        kind: FacetKind,
        /// The corners.
        corners: [u8; 3],
    },
}

impl FacetMap {
    /// The map of a whole facet.
    pub fn whole(kind: FacetKind) -> Self {
        match kind {
            FacetKind::Quad4 => Self::Bilinear,
            FacetKind::Tri3 => Self::Affine { kind, corners: [0, 1, 2] },
        }
    }

    /// The kind of the facet.
    pub fn kind(self) -> FacetKind {
        match self {
            Self::Bilinear => FacetKind::Quad4,
            Self::Affine { kind, .. } => kind,
        }
    }

    /// Weights of the nodes at `xi`; they add up to 1. The shape functions for [`FacetMap::whole`].
    pub fn weights(self, xi: [f64; 2]) -> [f64; MAX_NODES] {
        match self {
            Self::Bilinear => quad4::shape(xi),
            Self::Affine { kind, corners } => {
                let gradient = affine_gradient(kind, corners);
                let c = kind.vertices()[corners[0] as usize];
                let mut weights = [0.0; MAX_NODES];
                for (k, w) in weights.iter_mut().enumerate() {
                    let start = if k == corners[0] as usize { 1.0 } else { 0.0 };
                    *w = start + gradient[k][0] * (xi[0] - c[0]) + gradient[k][1] * (xi[1] - c[1]);
                }
                weights
            }
        }
    }

    /// Derivatives of the weights with respect to `xi`: row node, column direction.
    pub fn weights_gradient(self, xi: [f64; 2]) -> [[f64; 2]; MAX_NODES] {
        match self {
            Self::Bilinear => quad4::shape_gradient(xi),
            Self::Affine { kind, corners } => affine_gradient(kind, corners),
        }
    }
}

fn affine_gradient(kind: FacetKind, corners: [u8; 3]) -> [[f64; 2]; MAX_NODES] {
    let [a, b, c] = corners.map(|k| kind.vertices()[k as usize]);
    let (u, v) = (sub(b, a), sub(c, a));
    let det = cross(u, v);
    let (gb, gc) = ([v[1] / det, -v[0] / det], [-u[1] / det, u[0] / det]);
    let mut gradient = [[0.0; 2]; MAX_NODES];
    gradient[corners[0] as usize] = [-gb[0] - gc[0], -gb[1] - gc[1]];
    gradient[corners[1] as usize] = gb;
    gradient[corners[2] as usize] = gc;
    gradient
}

/// Images of a facet's corners in the plane.
pub(crate) type Images = Nodal<[f64; 2]>;

/// `xi` of the point whose image is `p`, for the facet whose corners have the images `images` (either orientation).
///
/// Bilinear: of the two solutions the one where the map keeps the orientation that it has at the centre. Beyond the
/// line where the map folds there is none; then the closest `eta`.
pub(crate) fn inverse(map: FacetMap, images: &Images, p: [f64; 2]) -> [f64; 2] {
    match map {
        FacetMap::Affine { kind, corners } => {
            let [a, b, c] = corners.map(|k| images[k as usize]);
            let (u, v, r) = (sub(b, a), sub(c, a), sub(p, a));
            let det = cross(u, v);
            // A triangle whose area is round-off.
            let (s, t) = if det == 0.0 { (0.0, 0.0) } else { (cross(r, v) / det, cross(u, r) / det) };
            let [a, b, c] = corners.map(|k| kind.vertices()[k as usize]);
            std::array::from_fn(|i| a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i]))
        }
        FacetMap::Bilinear => inverse_bilinear(images.padded(), p),
    }
}

fn inverse_bilinear(x: &[[f64; 2]; 4], p: [f64; 2]) -> [f64; 2] {
    let combine =
        |s: [f64; 4]| -> [f64; 2] { std::array::from_fn(|i| 0.25 * (0..4).map(|k| s[k] * x[k][i]).sum::<f64>()) };
    let centre = combine([1.0, 1.0, 1.0, 1.0]);
    let (b, c, d) = (combine([-1.0, 1.0, 1.0, -1.0]), combine([-1.0, -1.0, 1.0, 1.0]), combine([1.0, -1.0, 1.0, -1.0]));
    let q = sub(p, centre);
    // (q - c eta) x (b + d eta) = 0; its derivative at a solution is the Jacobian of the map there.
    let sign = cross(b, c).signum();
    let (a2, a1, a0) = (-cross(c, d), cross(q, d) + cross(b, c), cross(q, b));
    let root = sign * (a1 * a1 - 4.0 * a2 * a0).max(0.0).sqrt();
    let eta = if sign * a1 > 0.0 {
        -2.0 * a0 / (a1 + root)
    } else if a2 != 0.0 {
        (root - a1) / (2.0 * a2)
    } else {
        0.0
    };
    // Where a side has no length left, any point of it will do.
    let known = |x: f64| if x.is_finite() { x } else { 0.0 };
    let eta = known(eta);
    let w = [b[0] + d[0] * eta, b[1] + d[1] * eta];
    let r = [q[0] - c[0] * eta, q[1] - c[1] * eta];
    let xi = known((r[0] * w[0] + r[1] * w[1]) / (w[0] * w[0] + w[1] * w[1]));
    // One step of Newton takes off the round-off of the quadratic formula.
    let v = [c[0] + d[0] * xi, c[1] + d[1] * xi];
    let rest: [f64; 2] = std::array::from_fn(|i| q[i] - b[i] * xi - c[i] * eta - d[i] * xi * eta);
    let det = cross(w, v);
    let step = [cross(rest, v) / det, cross(w, rest) / det];
    if step[0].abs() + step[1].abs() < 1e-3 { [xi + step[0], eta + step[1]] } else { [xi, eta] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(x: &[[f64; 2]; 4], xi: [f64; 2]) -> [f64; 2] {
        let n = quad4::shape(xi);
        std::array::from_fn(|i| (0..4).map(|k| n[k] * x[k][i]).sum())
    }

    #[test]
    fn inverse_of_a_trapezoid_and_of_its_mirror_image() {
        let x = [[0.0, 0.0], [4.0, 0.3], [2.6, 2.0], [1.0, 1.5]];
        let mirrored = x.map(|p| [-p[0], p[1]]);
        for xi in [[-1.0, -1.0], [0.3, -0.7], [0.99, 1.0], [-1.1, 0.2]] {
            for x in [x, mirrored] {
                let back = inverse(FacetMap::Bilinear, &x.into(), image(&x, xi));
                assert!((back[0] - xi[0]).abs() + (back[1] - xi[1]).abs() < 1e-13, "{xi:?} {back:?}");
            }
        }
    }

    #[test]
    fn affine_weights_are_barycentric() {
        let map = FacetMap::Affine { kind: FacetKind::Quad4, corners: [1, 2, 3] };
        for k in [1usize, 2, 3] {
            let w = map.weights(quad4::VERTICES[k]);
            for (j, value) in w.iter().enumerate() {
                assert!((value - if j == k { 1.0 } else { 0.0 }).abs() < 1e-15);
            }
        }
        for xi in [[0.2, 0.3], [0.0, 1.0], [-0.1, 0.4]] {
            let (whole, shape) = (FacetMap::whole(FacetKind::Tri3).weights(xi), FacetKind::Tri3.shape(xi));
            assert!(whole.iter().zip(shape).all(|(w, n)| (w - n).abs() < 1e-15));
        }
    }
}
