//! Gap of a point to an extended facet, with first and second variation (theory/node-to-surface#gap, theory/node-to-surface#tangent).

use nalgebra::Vector3;
use stoss_geometry::Patch;
use stoss_reference_element::{FacetKind, MAX_NODES, Nodal};

/// Number of local nodes: slave node, then the master nodes.
pub const NODES: usize = 1 + MAX_NODES;
/// Number of local position components.
pub const LOCAL: usize = 3 * NODES;
/// A local vector: slave node, then the master nodes, three components each. Beyond the nodes of the facet derivatives are zero; positions there are those
/// of its first node ([`Nodal::padded`]), so that whoever adds what belongs to such a place to the first node is right.
pub type Local = [f64; LOCAL];
/// A local matrix, row by row.
pub type LocalMatrix = [[f64; LOCAL]; LOCAL];

/// Gap kinematics at the foot of the normal through the slave node.
#[derive(Clone, Debug)]
pub struct Gap {
    /// Signed gap `g = (x - x(xi)) . n`, positive outside.
    pub gap: f64,
    /// The kind of the facet.
    pub kind: FacetKind,
    /// Convective coordinates of the foot; outside of the facet on its extension.
    pub xi: [f64; 2],
    /// Unit outward normal of the master.
    pub normal: Vector3<f64>,
    /// `N` of theory/node-to-surface#eq-variation: `dg = N . dq`.
    pub gradient: Local,
    /// `D^alpha` of theory/node-to-surface#eq-variation: `d xi^alpha = D^alpha . dq`.
    pub xi_gradient: [Local; 2],
    /// Tangents `a_1`, `a_2` at the foot.
    pub(crate) tangents: [Vector3<f64>; 2],
    /// `a_12`.
    pub(crate) a_12: Vector3<f64>,
    /// Shape functions and their derivatives at the foot.
    pub(crate) shape: [f64; MAX_NODES],
    pub(crate) shape_gradient: [[f64; 2]; MAX_NODES],
    metric: [[f64; 2]; 2],
    /// `A^ab`.
    upper: [[f64; 2]; 2],
    curvature_12: f64,
}

/// Inverse of a symmetric 2x2 matrix; `None` if it is singular to working precision.
fn inverse(m: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    if det.abs() <= 1.0e-14 * (m[0][0].abs() + m[0][1].abs()) * (m[1][1].abs() + m[1][0].abs()) || det.is_nan() {
        return None;
    }
    Some([[m[1][1] / det, -m[0][1] / det], [-m[1][0] / det, m[0][0] / det]])
}

impl Gap {
    /// Projects `x` on the extended facet, from `start`; `None` if there is no foot, or the foot is a focal point (`A` singular).
    pub fn project(x: &Vector3<f64>, patch: &Patch, start: [f64; 2]) -> Option<Self> {
        let foot = patch.project(x, start);
        if !foot.converged {
            return None;
        }
        Self::at_foot(patch, foot.xi, foot.gap)
    }

    /// [`Gap::project`] from the centre of the facet.
    pub fn from_centre(x: &Vector3<f64>, patch: &Patch) -> Option<Self> {
        Self::project(x, patch, patch.kind().centre())
    }

    /// Kinematics at given coordinates instead of a foot: gap, normal, tangents and shape functions there. The variations are those of a
    /// projection only where the coordinates are its foot. `None` where the facet is degenerate.
    pub(crate) fn at(x: &Vector3<f64>, patch: &Patch, xi: [f64; 2]) -> Option<Self> {
        let gap = (x - patch.point(xi)).dot(&patch.normal(xi));
        Self::at_foot(patch, xi, gap)
    }

    fn at_foot(patch: &Patch, xi: [f64; 2], gap: f64) -> Option<Self> {
        let frame = patch.frame(xi);
        let kind = patch.kind();
        let (shape, shape_gradient) = (kind.shape(xi), kind.shape_gradient(xi));
        let (n, a) = (frame.normal, frame.tangents);
        let mut gradient = [0.0; LOCAL];
        put(&mut gradient, 0, &n, 1.0);
        // A_ab = m_ab - g h_ab; only h_12 is not zero.
        let off = frame.metric[0][1] - gap * frame.curvature_12;
        let upper = inverse([[frame.metric[0][0], off], [off, frame.metric[1][1]]])?;
        // T_b + g N_b.
        let mut lower = [[0.0; LOCAL]; 2];
        for b in 0..2 {
            put(&mut lower[b], 0, &a[b], 1.0);
        }
        for i in 0..MAX_NODES {
            put(&mut gradient, i + 1, &n, -shape[i]);
            for b in 0..2 {
                put(&mut lower[b], i + 1, &a[b], -shape[i]);
                put(&mut lower[b], i + 1, &n, gap * shape_gradient[i][b]);
            }
        }
        let xi_gradient =
            std::array::from_fn(|al| std::array::from_fn(|k| upper[al][0] * lower[0][k] + upper[al][1] * lower[1][k]));
        Some(Self {
            kind,
            gap,
            xi,
            normal: n,
            gradient,
            xi_gradient,
            tangents: a,
            a_12: frame.a_12,
            shape,
            shape_gradient,
            metric: frame.metric,
            upper,
            curvature_12: frame.curvature_12,
        })
    }

    /// How far the foot lies outside of the facet, in halves of an edge ([`FacetKind::excess`]).
    pub fn outside(&self) -> f64 {
        self.kind.excess(self.xi)
    }

    /// Second variation of the gap, theory/node-to-surface#eq-second-gap.
    pub fn hessian(&self) -> LocalMatrix {
        let [d_1, d_2] = &self.xi_gradient;
        let h = self.curvature_12;
        let mut n_a = [[0.0; LOCAL]; 2];
        for i in 0..MAX_NODES {
            for (al, n_a) in n_a.iter_mut().enumerate() {
                put(n_a, i + 1, &self.normal, self.shape_gradient[i][al]);
            }
        }
        // N_bar_a = N_a + h_ab D^b.
        let bar: [Local; 2] =
            [std::array::from_fn(|k| n_a[0][k] + h * d_2[k]), std::array::from_fn(|k| n_a[1][k] + h * d_1[k])];
        let m = self.metric;
        let det = m[0][0] * m[1][1] - m[0][1] * m[0][1];
        let scale = self.gap / det;
        let (m_11, m_12, m_22) = (scale * m[1][1], -scale * m[0][1], scale * m[0][0]);
        let mut out = [[0.0; LOCAL]; LOCAL];
        for (i, row) in out.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = m_11 * bar[0][i] * bar[0][j]
                    + m_12 * (bar[0][i] * bar[1][j] + bar[1][i] * bar[0][j])
                    + m_22 * bar[1][i] * bar[1][j]
                    - n_a[0][i] * d_1[j]
                    - n_a[1][i] * d_2[j]
                    - d_1[i] * n_a[0][j]
                    - d_2[i] * n_a[1][j]
                    - h * (d_1[i] * d_2[j] + d_2[i] * d_1[j]);
            }
        }
        out
    }

    /// Second variations of both convective coordinates, theory/node-to-surface#eq-second-coordinates.
    pub fn xi_hessian(&self) -> [LocalMatrix; 2] {
        let d = &self.xi_gradient;
        // Coefficients of the slave node and the facet's nodes in E.
        let mixed = self.kind.mixed_derivative();
        let e: [f64; NODES] = std::array::from_fn(|k| if k == 0 { 1.0 } else { -self.shape[k - 1] });
        let lower: [LocalMatrix; 2] = std::array::from_fn(|b| {
            let other = 1 - b;
            // What stands beside D^c in symmetric pairs: T_bc - g N_bc + V_bc.
            let beside: [Local; 2] = std::array::from_fn(|c| {
                let mut w = [0.0; LOCAL];
                for i in 0..MAX_NODES {
                    // T_bc and, of V_bc, T_cb.
                    put(&mut w, i + 1, &self.tangents[b], self.shape_gradient[i][c]);
                    put(&mut w, i + 1, &self.tangents[c], self.shape_gradient[i][b]);
                    if c == other {
                        put(&mut w, i + 1, &self.normal, -self.gap * mixed[i]);
                    }
                }
                let slope = self.a_12.dot(&self.tangents[c]);
                std::array::from_fn(|k| w[k] + slope * d[other][k])
            });
            let bend = self.tangents[b].dot(&self.a_12);
            // G_b, three columns.
            let g: [[f64; 3]; LOCAL] = std::array::from_fn(|k| {
                std::array::from_fn(|i| {
                    let unit = if k >= 3 && k % 3 == i { self.shape_gradient[k / 3 - 1][b] } else { 0.0 };
                    unit + d[other][k] * self.a_12[i]
                })
            });
            std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    e[i / 3] * g[j][i % 3] + g[i][j % 3] * e[j / 3]
                        - bend * (d[0][i] * d[1][j] + d[1][i] * d[0][j])
                        - beside[0][i] * d[0][j]
                        - d[0][i] * beside[0][j]
                        - beside[1][i] * d[1][j]
                        - d[1][i] * beside[1][j]
                })
            })
        });
        std::array::from_fn(|al| {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| self.upper[al][0] * lower[0][i][j] + self.upper[al][1] * lower[1][i][j])
            })
        })
    }
}

/// Adds `factor * v` to the block of a local node.
fn put(local: &mut Local, node: usize, v: &Vector3<f64>, factor: f64) {
    for i in 0..3 {
        local[3 * node + i] += factor * v[i];
    }
}

/// Mean of two pairs of convective coordinates.
pub(crate) fn mean(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

/// Positions of slave node and facet as points.
pub fn points(local: &Local, kind: FacetKind) -> (Vector3<f64>, Patch) {
    let at = |k: usize| Vector3::new(local[3 * k], local[3 * k + 1], local[3 * k + 2]);
    (at(0), Patch::new(Nodal::from_fn(kind, |k| at(1 + k))))
}
