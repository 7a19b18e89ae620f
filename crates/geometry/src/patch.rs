//! The patch of a facet and its differential geometry.
//!
//! Not here: the projections ([`crate::Projection`], [`crate::ClosestPoint`]), which are further `impl` blocks of the patch.

use nalgebra::Vector3;
use stoss_reference_element::{FacetKind, MAX_NODES, Nodal};

/// A surface patch `x(xi) = sum_I N_I(xi) m_I`: a bilinear quadrilateral or a triangle.
///
/// Corners are numbered as in the reference facet, [`FacetKind::vertices`]. Edge `k` runs from corner `k` to the next one. The normal
/// `a_1 x a_2` points to the side from which the corners are seen counter-clockwise.
///
/// Four corners need not lie in a plane (a *warped* patch is a piece of a hyperbolic paraboloid).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Positions of the corners, a length.
    pub corners: Nodal<Vector3<f64>>,
}

/// Everything that contact needs of a patch at one point (theory/node-to-surface#eq-metric).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFrame {
    /// `x(xi)`.
    pub point: Vector3<f64>,
    /// Tangents `a_1`, `a_2`.
    pub tangents: [Vector3<f64>; 2],
    /// Mixed second derivative `a_12 = a_21`, zero for a triangle; `a_11 = a_22 = 0`.
    pub a_12: Vector3<f64>,
    /// Unit normal `a_1 x a_2 / |a_1 x a_2|`, zero where the patch is degenerate.
    pub normal: Vector3<f64>,
    /// Metric `m_ab = a_a . a_b`, a length squared.
    pub metric: [[f64; 2]; 2],
    /// Curvature `h_12 = h_21 = a_12 . n`, a length; `h_11 = h_22 = 0`.
    pub curvature_12: f64,
}

/// The patch relative to its first corner in monomials: `x - m_1 = c_0 + xi^1 c_1 + xi^2 c_2 + xi^1 xi^2 c_12`. In this form patches of all kinds differ
/// only in the domain of the coordinates.
///
/// Differences of corners are formed first, so that a patch far from the origin loses no digits.
#[derive(Clone, Copy)]
pub(crate) struct Monomials {
    pub kind: FacetKind,
    pub c_0: Vector3<f64>,
    pub c_1: Vector3<f64>,
    pub c_2: Vector3<f64>,
    pub c_12: Vector3<f64>,
}

impl Monomials {
    /// `x(xi) - m_1`.
    pub fn point(&self, xi: [f64; 2]) -> Vector3<f64> {
        self.c_0 + self.c_1 * xi[0] + (self.c_2 + self.c_12 * xi[0]) * xi[1]
    }

    /// `a_1`, `a_2` at `xi`.
    pub fn tangents(&self, xi: [f64; 2]) -> [Vector3<f64>; 2] {
        [self.c_1 + self.c_12 * xi[1], self.c_2 + self.c_12 * xi[0]]
    }
}

impl Patch {
    /// A patch from its corners.
    pub fn new(corners: impl Into<Nodal<Vector3<f64>>>) -> Self {
        Self { corners: corners.into() }
    }

    /// The kind of the facet.
    pub fn kind(&self) -> FacetKind {
        self.corners.kind()
    }

    /// Shape functions at `xi`.
    pub fn shape(&self, xi: [f64; 2]) -> [f64; MAX_NODES] {
        self.kind().shape(xi)
    }

    pub(crate) fn monomials(&self) -> Monomials {
        let kind = self.kind();
        let edge = |i: usize| self.corners[i] - self.corners[0];
        match kind {
            FacetKind::Quad4 => {
                let [e_2, e_3, e_4] = [1, 2, 3].map(edge);
                Monomials {
                    kind,
                    c_0: (e_2 + e_3 + e_4) * 0.25,
                    c_1: (e_2 + e_3 - e_4) * 0.25,
                    c_2: (e_3 + e_4 - e_2) * 0.25,
                    c_12: (e_3 - e_2 - e_4) * 0.25,
                }
            }
            FacetKind::Tri3 => {
                Monomials { kind, c_0: Vector3::zeros(), c_1: edge(1), c_2: edge(2), c_12: Vector3::zeros() }
            }
        }
    }

    /// `x(xi)`, also outside the reference facet.
    pub fn point(&self, xi: [f64; 2]) -> Vector3<f64> {
        self.corners[0] + self.monomials().point(xi)
    }

    /// Tangents `a_1`, `a_2` at `xi`.
    pub fn tangents(&self, xi: [f64; 2]) -> [Vector3<f64>; 2] {
        self.monomials().tangents(xi)
    }

    /// Mixed second derivative `a_12`, the same everywhere.
    pub fn a_12(&self) -> Vector3<f64> {
        self.monomials().c_12
    }

    /// `a_1 x a_2` at `xi`: its length is the area of the surface per area of the reference facet.
    pub fn area_vector(&self, xi: [f64; 2]) -> Vector3<f64> {
        let [a_1, a_2] = self.tangents(xi);
        a_1.cross(&a_2)
    }

    /// Unit normal at `xi`, zero where the patch is degenerate.
    pub fn normal(&self, xi: [f64; 2]) -> Vector3<f64> {
        unit_or_zero(self.area_vector(xi))
    }

    /// Metric `m_ab = a_a . a_b` at `xi`.
    pub fn metric(&self, xi: [f64; 2]) -> [[f64; 2]; 2] {
        let [a_1, a_2] = self.tangents(xi);
        let m_12 = a_1.dot(&a_2);
        [[a_1.dot(&a_1), m_12], [m_12, a_2.dot(&a_2)]]
    }

    /// Curvature `h_ab = a_ab . n` at `xi`; only the mixed component differs from zero.
    pub fn curvature(&self, xi: [f64; 2]) -> [[f64; 2]; 2] {
        let h_12 = self.a_12().dot(&self.normal(xi));
        [[0.0, h_12], [h_12, 0.0]]
    }

    /// Point, tangents, normal, metric and curvature at `xi` in one go.
    pub fn frame(&self, xi: [f64; 2]) -> SurfaceFrame {
        let monomials = self.monomials();
        let [a_1, a_2] = monomials.tangents(xi);
        let normal = unit_or_zero(a_1.cross(&a_2));
        let m_12 = a_1.dot(&a_2);
        SurfaceFrame {
            point: self.corners[0] + monomials.point(xi),
            tangents: [a_1, a_2],
            a_12: monomials.c_12,
            normal,
            metric: [[a_1.dot(&a_1), m_12], [m_12, a_2.dot(&a_2)]],
            curvature_12: monomials.c_12.dot(&normal),
        }
    }

    /// Angle between the two edges that meet at a corner, in radians; zero if one of them has no length.
    pub fn corner_angle(&self, corner: usize) -> f64 {
        let here = self.corners[corner];
        let u = self.corners[self.kind().next(corner)] - here;
        let v = self.corners[self.kind().previous(corner)] - here;
        if u.norm() > 0.0 && v.norm() > 0.0 { u.cross(&v).norm().atan2(u.dot(&v)).max(0.0) } else { 0.0 }
    }
}

pub(crate) fn unit_or_zero(v: Vector3<f64>) -> Vector3<f64> {
    let length = v.norm();
    if length > 0.0 { v / length } else { Vector3::zeros() }
}
