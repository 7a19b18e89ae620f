//! Nearly parallel edges: the factor by which their energy fades out, a mollifier.

use nalgebra::{Matrix3, Vector3};

/// Smooth factor of pairs of edges `u = x_1 - x_0`, `v = x_3 - x_2`: `m = z (2 - z)`, `z = C/threshold` for `C = |u x v|^2 <= threshold`, 1 beyond;
/// theory/barrier#eq-parallel.
///
/// The closest points of parallel edges jump along them. Such pairs need no energy of their own: their ends against the other facets do what is necessary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeMollifier {
    threshold: f64,
}

/// Invariants of two edges at one state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgePair {
    u: Vector3<f64>,
    v: Vector3<f64>,
    /// `u . u`, `v . v`, `u . v`.
    uu: f64,
    vv: f64,
    uv: f64,
    /// `C = |u x v|^2`.
    squared: f64,
}

impl EdgePair {
    pub fn new(x: &[Vector3<f64>; 4]) -> Self {
        let (u, v) = (x[1] - x[0], x[3] - x[2]);
        Self { u, v, uu: u.norm_squared(), vv: v.norm_squared(), uv: u.dot(&v), squared: u.cross(&v).norm_squared() }
    }

    /// Half of `dC/du` and of `dC/dv`.
    fn half_gradient(&self) -> [Vector3<f64>; 2] {
        [self.u * self.vv - self.v * self.uv, self.v * self.uu - self.u * self.uv]
    }
}

/// Signs of the points in `u` and `v`.
const IN_U: [f64; 4] = [-1.0, 1.0, 0.0, 0.0];
const IN_V: [f64; 4] = [0.0, 0.0, -1.0, 1.0];

/// A gradient by the four points from one by the two edges.
fn at_points([by_u, by_v]: [Vector3<f64>; 2]) -> [Vector3<f64>; 4] {
    [-by_u, by_u, -by_v, by_v]
}

impl EdgeMollifier {
    /// A factor that is 1 for edges with `|u x v|^2 >= threshold`, a positive length to the fourth power.
    pub const fn new(threshold: f64) -> Self {
        Self { threshold }
    }

    /// A hundredth of the squared lengths of the edges: sines below 0.1.
    pub fn of_edges(length_squared: f64, other_length_squared: f64) -> Self {
        Self::new(0.01 * length_squared * other_length_squared)
    }

    /// `m` for edges given by the points of their pair.
    pub fn factor(&self, x: &[Vector3<f64>; 4]) -> f64 {
        self.at(&EdgePair::new(x)).0
    }

    /// `m`, `dm/dC`, `d2m/dC2`.
    fn at(&self, edges: &EdgePair) -> (f64, f64, f64) {
        if edges.squared >= self.threshold {
            return (1.0, 0.0, 0.0);
        }
        let z = edges.squared / self.threshold;
        (z * (2.0 - z), 2.0 * (1.0 - z) / self.threshold, -2.0 / (self.threshold * self.threshold))
    }

    /// The divided difference of `m` by `C`, and its derivative by `C_np1`.
    fn divided_difference(&self, c_n: f64, c: f64) -> (f64, f64) {
        let limit = self.threshold;
        let (z_n, z) = (c_n.min(limit) / limit, c.min(limit) / limit);
        let inside = (2.0 - (z_n + z)) / limit;
        match (c_n < limit, c < limit) {
            (false, false) => (0.0, 0.0),
            (true, true) => (inside, -1.0 / (limit * limit)),
            (true, false) => {
                let part = (limit - c_n) / (c - c_n);
                (inside * part, -inside * part / (c - c_n))
            }
            (false, true) => {
                let part = (limit - c) / (c_n - c);
                (inside * part, -part / (limit * limit) - inside * ((c_n - limit) / (c_n - c)) / (c_n - c))
            }
        }
    }

    /// The factor at both ends and its discrete gradient; of no pair of edges or of edges that cross well the gradient is `None`.
    pub(crate) fn between(&self, start: &EdgePair, end: &EdgePair) -> MollifierStep {
        let ((m_n, ..), (m_np1, slope, _)) = (self.at(start), self.at(end));
        if start.squared >= self.threshold && end.squared >= self.threshold {
            return MollifierStep { m_n, m_np1, varies: None };
        }
        let (secant, secant_slope) = self.divided_difference(start.squared, end.squared);
        // C is quadratic in the means over both ends of u.u, v.v, u.v, and these are quadratic in the positions: the midpoint rule is exact.
        let mean = EdgePair {
            u: (start.u + end.u) * 0.5,
            v: (start.v + end.v) * 0.5,
            uu: (start.uu + end.uu) * 0.5,
            vv: (start.vv + end.vv) * 0.5,
            uv: (start.uv + end.uv) * 0.5,
            squared: f64::NAN,
        };
        let c_gradient = end.half_gradient().map(|g| g * 2.0);
        let varies = MollifierChange {
            m_np1_gradient: at_points(c_gradient.map(|g| g * slope)),
            mean_gradient: at_points(mean.half_gradient().map(|g| g * 2.0)),
            mean,
            end: *end,
            secant,
            secant_gradient: at_points(c_gradient.map(|g| g * secant_slope)),
        };
        MollifierStep { m_n, m_np1, varies: Some(varies) }
    }

    /// `m` at one state with gradient and second derivative.
    pub(crate) fn at_state(&self, edges: &EdgePair) -> (f64, Option<MollifierState>) {
        let (m, slope, curvature) = self.at(edges);
        if edges.squared >= self.threshold {
            return (m, None);
        }
        let c_gradient = edges.half_gradient().map(|g| g * 2.0);
        let state = MollifierState {
            gradient: at_points(c_gradient.map(|g| g * slope)),
            edges: *edges,
            c_gradient: at_points(c_gradient),
            slope,
            curvature,
        };
        (m, Some(state))
    }
}

/// The factor over a step.
pub(crate) struct MollifierStep {
    pub m_n: f64,
    pub m_np1: f64,
    pub varies: Option<MollifierChange>,
}

/// What changes where the factor is not 1 at both ends.
pub(crate) struct MollifierChange {
    /// Gradient of `m_np1` at the end.
    pub m_np1_gradient: [Vector3<f64>; 4],
    mean: EdgePair,
    end: EdgePair,
    /// Discrete gradient of `C`.
    mean_gradient: [Vector3<f64>; 4],
    /// Divided difference of `m` by `C`, and its gradient at the end.
    secant: f64,
    secant_gradient: [Vector3<f64>; 4],
}

impl MollifierChange {
    /// Discrete gradient of `m`: its product with the motion is `m_np1 - m_n`.
    pub fn gradient(&self) -> [Vector3<f64>; 4] {
        self.mean_gradient.map(|g| g * self.secant)
    }

    /// Derivative of the discrete gradient at point `i` with respect to the position of point `j` at the end.
    pub fn gradient_tangent(&self, i: usize, j: usize) -> Matrix3<f64> {
        let Self { mean, end, .. } = self;
        // Half of dC/du = vv u - uv v and of dC/dv = uu v - uv u, with the means.
        let (du, dv) = (IN_U[j], IN_V[j]);
        let (d_uu, d_vv) = (end.u * du, end.v * dv);
        let d_uv = (end.v * du + end.u * dv) * 0.5;
        let identity = Matrix3::identity();
        let half = if i < 2 {
            mean.u * d_vv.transpose() - mean.v * d_uv.transpose() + identity * (0.5 * (mean.vv * du - mean.uv * dv))
        } else {
            mean.v * d_uu.transpose() - mean.u * d_uv.transpose() + identity * (0.5 * (mean.uu * dv - mean.uv * du))
        };
        let sign = IN_U[i] + IN_V[i];
        half * (2.0 * self.secant * sign) + self.mean_gradient[i] * self.secant_gradient[j].transpose()
    }
}

/// The factor at one state where it is not 1.
pub(crate) struct MollifierState {
    pub gradient: [Vector3<f64>; 4],
    edges: EdgePair,
    c_gradient: [Vector3<f64>; 4],
    slope: f64,
    curvature: f64,
}

impl MollifierState {
    /// Second derivative of `m` with respect to points `i` and `j`.
    pub fn hessian(&self, i: usize, j: usize) -> Matrix3<f64> {
        let EdgePair { u, v, uu, vv, uv, .. } = &self.edges;
        let (du, dv) = (IN_U[j], IN_V[j]);
        let d_uv = v * du + u * dv;
        let identity = Matrix3::identity();
        let half = if i < 2 {
            u * v.transpose() * (2.0 * dv) - v * d_uv.transpose() + identity * (vv * du - uv * dv)
        } else {
            v * u.transpose() * (2.0 * du) - u * d_uv.transpose() + identity * (uu * dv - uv * du)
        };
        let sign = IN_U[i] + IN_V[i];
        half * (2.0 * sign * self.slope) + self.c_gradient[i] * self.c_gradient[j].transpose() * self.curvature
    }
}
