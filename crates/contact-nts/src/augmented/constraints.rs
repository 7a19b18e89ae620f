//! The constraints of the augmentation, `Phi_A,a = r . a_a` and `Phi_N = r . n` with `r = x - x(f)`, as functions of the 15 positions and
//! the two coordinates, with first and second derivatives (theory/coordinate-augmentation#constraints).
//!
//! `r`, `a_1`, `a_2` are linear in the positions at fixed coordinates, and bilinear in the coordinates. All derivatives are made of
//! theirs by the product rule; only the normal needs the derivatives of a unit vector.

use crate::kinematics::{LOCAL, Local, points};
use nalgebra::Vector3;
use stoss_reference_element::{FacetKind, MAX_NODES};

/// Positions, then coordinates.
pub(crate) const UNKNOWNS: usize = LOCAL + 2;
/// A gradient.
pub(crate) type Gradient = [f64; UNKNOWNS];

type V = Vector3<f64>;

/// Values and first derivatives.
#[derive(Clone, Debug)]
pub(crate) struct Constraints {
    /// `Phi_A`.
    pub foot: [f64; 2],
    /// `Phi_N`.
    pub gap: f64,
    /// Gradients of `Phi_A`: rows of `A_q`, `A_f`.
    pub foot_gradient: [Gradient; 2],
    /// Gradient of `Phi_N`: `b_q`, `b_f`.
    pub gap_gradient: Gradient,
    kind: FacetKind,
    shape_gradient: [[f64; 2]; MAX_NODES],
    r: V,
    a: [V; 2],
    a_12: V,
    n: V,
    /// `|a_1 x a_2|`.
    area: f64,
    jets: Jets,
}

/// First derivatives of `r`, `a_1`, `a_2`, `a_1 x a_2` with respect to each unknown.
#[derive(Clone, Debug)]
struct Jets {
    r: [V; UNKNOWNS],
    a: [[V; UNKNOWNS]; 2],
    w: [V; UNKNOWNS],
}

impl Constraints {
    /// The constraints at positions and coordinates; `None` where the facet has no normal.
    pub fn new(q: &Local, kind: FacetKind, f: [f64; 2]) -> Option<Self> {
        let (x, patch) = points(q, kind);
        let frame = patch.frame(f);
        let (shape, shape_gradient) = (kind.shape(f), kind.shape_gradient(f));
        let (r, a, a_12, n) = (x - frame.point, frame.tangents, frame.a_12, frame.normal);
        let area = a[0].cross(&a[1]).norm();
        if area.is_nan() || area <= 0.0 {
            return None;
        }
        let zero = [V::zeros(); UNKNOWNS];
        let mut jets = Jets { r: zero, a: [zero; 2], w: zero };
        for i in 0..3 {
            jets.r[i][i] = 1.0;
            for k in 0..MAX_NODES {
                let u = 3 * (k + 1) + i;
                jets.r[u][i] = -shape[k];
                for al in 0..2 {
                    jets.a[al][u][i] = shape_gradient[k][al];
                }
            }
        }
        for al in 0..2 {
            jets.r[LOCAL + al] = -a[al];
            jets.a[al][LOCAL + 1 - al] = a_12;
        }
        let mut foot_gradient = [[0.0; UNKNOWNS]; 2];
        let mut gap_gradient = [0.0; UNKNOWNS];
        for u in 0..UNKNOWNS {
            jets.w[u] = jets.a[0][u].cross(&a[1]) + a[0].cross(&jets.a[1][u]);
            for al in 0..2 {
                foot_gradient[al][u] = jets.r[u].dot(&a[al]) + r.dot(&jets.a[al][u]);
            }
            let turn = (jets.w[u] - n * n.dot(&jets.w[u])) / area;
            gap_gradient[u] = jets.r[u].dot(&n) + r.dot(&turn);
        }
        let foot = a.map(|a| r.dot(&a));
        Some(Self {
            kind,
            foot,
            gap: r.dot(&n),
            foot_gradient,
            gap_gradient,
            shape_gradient,
            r,
            a,
            a_12,
            n,
            area,
            jets,
        })
    }

    /// `A_f`, symmetric.
    pub fn foot_by_coordinates(&self) -> [[f64; 2]; 2] {
        self.foot_gradient.map(|row| [row[LOCAL], row[LOCAL + 1]])
    }

    /// `b_f`.
    pub fn gap_by_coordinates(&self) -> [f64; 2] {
        [self.gap_gradient[LOCAL], self.gap_gradient[LOCAL + 1]]
    }

    /// Second derivatives of `lambda . Phi_A - pressure Phi_N`.
    pub fn hessian(&self, lambda: [f64; 2], pressure: f64) -> [Gradient; UNKNOWNS] {
        let Self { r, a, a_12, n, area, jets, .. } = self;
        // With w = a_1 x a_2, P = 1 - n n, s = P r / |w|:
        // r . n_uv = s . w_uv - ((n . w_v)(P r . w_u) + (n . w_u)(P r . w_v) + (r . n) P w_u . P w_v) / |w|^2.
        let flat = r - n * r.dot(n);
        let s = flat / *area;
        let across = |v: &V| v - n * n.dot(v);
        let mut along_n = [0.0; UNKNOWNS];
        let mut along_r = [0.0; UNKNOWNS];
        let mut turn = [V::zeros(); UNKNOWNS];
        for u in 0..UNKNOWNS {
            along_n[u] = n.dot(&jets.w[u]) / *area;
            along_r[u] = flat.dot(&jets.w[u]) / *area;
            turn[u] = across(&jets.w[u]) / *area;
        }
        let height = r.dot(n);
        let mut out = [[0.0; UNKNOWNS]; UNKNOWNS];
        for u in 0..UNKNOWNS {
            for v in u..UNKNOWNS {
                let mut sum = 0.0;
                for al in 0..2 {
                    sum += lambda[al] * (jets.r[u].dot(&jets.a[al][v]) + jets.r[v].dot(&jets.a[al][u]));
                }
                if pressure != 0.0 {
                    let mixed = jets.a[0][u].cross(&jets.a[1][v]) + jets.a[0][v].cross(&jets.a[1][u]);
                    sum -= pressure
                        * (jets.r[u].dot(&turn[v]) + jets.r[v].dot(&turn[u]) + s.dot(&mixed)
                            - along_n[v] * along_r[u]
                            - along_n[u] * along_r[v]
                            - height * turn[u].dot(&turn[v]));
                }
                out[u][v] = sum;
            }
        }
        // Second derivatives of r, a_1, a_2: one position and one coordinate, or both coordinates.
        let on_r = a[0] * lambda[0] + a[1] * lambda[1] - n * pressure;
        let on_a = [r * lambda[0] - a[1].cross(&s) * pressure, r * lambda[1] - s.cross(&a[0]) * pressure];
        let mixed = self.kind.mixed_derivative();
        for k in 0..MAX_NODES {
            for i in 0..3 {
                for al in 0..2 {
                    out[3 * (k + 1) + i][LOCAL + al] +=
                        mixed[k] * on_a[1 - al][i] - self.shape_gradient[k][al] * on_r[i];
                }
            }
        }
        out[LOCAL][LOCAL + 1] -= on_r.dot(a_12);
        for u in 0..UNKNOWNS {
            for v in 0..u {
                out[u][v] = out[v][u];
            }
        }
        out
    }
}
