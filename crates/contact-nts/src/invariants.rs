//! The frictionless energy-momentum element with 17 invariants (theory/node-to-surface#element; thesis (4.74)-(4.87), (5.96)-(5.98)).
//!
//! The director and the convective coordinates at `n` and at `n+1` satisfy their constraints at both ends, hence they *are* the
//! closest-point projections there; the five auxiliary multipliers of a unit pressure follow from five linear equations. All local
//! unknowns are thus eliminated exactly, and what is left is a discrete gradient of the gap:
//!
//! `G(q_n, q_np1) . (q_np1 - q_n) = g_np1 - g_n`, with `sum G = 0` and `sum q_mid x G = 0`.

use crate::dual::{Dual, Scalar};
use crate::kinematics::{Gap, LOCAL, Local, LocalMatrix};
use stoss_contact::dual::{V3, cross, dot};
use stoss_reference_element::{FacetKind, quad4};

const INVARIANTS: usize = 17;
/// Local positions, director, convective coordinates.
const UNKNOWNS: usize = LOCAL + 5;

/// Changes of the (scaled) invariants below this leave out the quotient of the discrete gradient (theory/node-to-surface#eq-discrete-gradient).
const SMALLEST_CHANGE: f64 = 1.0e-7;

fn sub<T: Scalar>(a: V3<T>, b: V3<T>) -> V3<T> {
    std::array::from_fn(|i| a[i] - b[i])
}
fn mean<T: Scalar>(a: T, b: T) -> T {
    (a + b).scale(0.5)
}

/// Shape functions of the last three master nodes, their derivatives and mixed derivative (a constant).
struct Shape<T> {
    n: [T; 3],
    d: [[T; 3]; 2],
    mixed: [f64; 3],
}

impl<T: Scalar> Shape<T> {
    fn at(kind: FacetKind, f: [T; 2]) -> Self {
        match kind {
            FacetKind::Quad4 => Self::of_quad4(f),
            FacetKind::Tri3 => {
                let [zero, one] = [0.0, 1.0].map(T::constant);
                Self { n: [f[0], f[1], zero], d: [[one, zero, zero], [zero, one, zero]], mixed: [0.0; 3] }
            }
        }
    }

    fn of_quad4(f: [T; 2]) -> Self {
        let one = T::constant(1.0);
        let factor = |i: usize, k: usize| one + f[k].scale(quad4::VERTICES[i + 1][k]);
        let vertex = |i: usize| quad4::VERTICES[i + 1];
        Self {
            n: std::array::from_fn(|i| (factor(i, 0) * factor(i, 1)).scale(0.25)),
            d: [
                std::array::from_fn(|i| factor(i, 1).scale(0.25 * vertex(i)[0])),
                std::array::from_fn(|i| factor(i, 0).scale(0.25 * vertex(i)[1])),
            ],
            mixed: std::array::from_fn(|i| 0.25 * vertex(i)[0] * vertex(i)[1]),
        }
    }
}

/// Relative vectors of a configuration: slave minus first master node, other master nodes minus first, director, coordinates. What a triangle has
/// not is zero, and so is the force on it.
struct Configuration<T> {
    kind: FacetKind,
    r: V3<T>,
    e: [V3<T>; 3],
    d: V3<T>,
    f: [T; 2],
}

impl<T: Scalar> Configuration<T> {
    fn new(kind: FacetKind, q: &[T; LOCAL], d: V3<T>, f: [T; 2]) -> Self {
        let node = |k: usize| [q[3 * k], q[3 * k + 1], q[3 * k + 2]];
        Self { kind, r: sub(node(0), node(1)), e: std::array::from_fn(|i| sub(node(i + 2), node(1))), d, f }
    }

    fn mean(&self, other: &Self) -> Self {
        let v = |a: &V3<T>, b: &V3<T>| std::array::from_fn(|i| mean(a[i], b[i]));
        Self {
            kind: self.kind,
            r: v(&self.r, &other.r),
            e: std::array::from_fn(|i| v(&self.e[i], &other.e[i])),
            d: v(&self.d, &other.d),
            f: std::array::from_fn(|i| mean(self.f[i], other.f[i])),
        }
    }

    /// The invariants in the order of theory/node-to-surface#eq-invariants (counted from 0); the third gap coordinate is left at zero, it drops out of all differences.
    fn invariants(&self) -> [T; INVARIANTS] {
        let (e, r, d) = (&self.e, &self.r, &self.d);
        [
            dot(r, d),
            dot(&e[0], d),
            dot(&e[1], d),
            dot(&e[2], d),
            dot(d, d),
            dot(&e[0], r),
            dot(&e[1], r),
            dot(&e[2], r),
            dot(&e[0], &e[0]),
            dot(&e[0], &e[1]),
            dot(&e[0], &e[2]),
            dot(&e[1], &e[1]),
            dot(&e[1], &e[2]),
            dot(&e[2], &e[2]),
            self.f[0],
            self.f[1],
            T::constant(0.0),
        ]
    }

    /// `[D pi]^T w` at this configuration: forces on the five nodes, on the director and on the coordinates.
    fn pull_back(&self, w: &[T; INVARIANTS]) -> [T; UNKNOWNS] {
        let mut out = [T::constant(0.0); UNKNOWNS];
        let mut add = |block: usize, v: &V3<T>, factor: T| {
            for i in 0..3 {
                out[3 * block + i] = out[3 * block + i] + factor * v[i];
            }
        };
        // Blocks: 0 slave, 1..=4 master nodes, 5 director. A dot product of two relative vectors pulls both of their nodes
        // and, with the opposite sign, the first master node.
        let (r, e, d) = (&self.r, &self.e, &self.d);
        add(0, d, w[0]);
        add(1, d, -w[0]);
        add(5, r, w[0]);
        for i in 0..3 {
            let v = w[1 + i];
            add(i + 2, d, v);
            add(1, d, -v);
            add(5, &e[i], v);
            let v = w[5 + i];
            add(i + 2, r, v);
            add(0, &e[i], v);
            add(1, r, -v);
            add(1, &e[i], -v);
        }
        add(5, d, w[4].scale(2.0));
        let mut k = 8;
        for i in 0..3 {
            for j in i..3 {
                let v = w[k];
                add(i + 2, &e[j], v);
                add(j + 2, &e[i], v);
                add(1, &e[i], -v);
                add(1, &e[j], -v);
                k += 1;
            }
        }
        out[18] = w[14];
        out[19] = w[15];
        out
    }
}

/// Gram matrix of the master's relative vectors.
fn gram<T: Scalar>(pi: &[T; INVARIANTS]) -> [[T; 3]; 3] {
    [[pi[8], pi[9], pi[10]], [pi[9], pi[11], pi[12]], [pi[10], pi[12], pi[13]]]
}

/// The six constraints (theory/node-to-surface#eq-constraints).
fn constraints<T: Scalar>(kind: FacetKind, pi: &[T; INVARIANTS]) -> [T; 6] {
    let s = Shape::at(kind, [pi[14], pi[15]]);
    let heights = [pi[1], pi[2], pi[3]];
    let along = [pi[5], pi[6], pi[7]];
    let g = gram(pi);
    let rest: [T; 3] = std::array::from_fn(|i| along[i] - dot(&g[i], &s.n));
    [
        dot(&s.d[0], &heights),
        dot(&s.d[1], &heights),
        (pi[4] - T::constant(1.0)).scale(0.5),
        dot(&s.d[0], &rest),
        dot(&s.d[1], &rest),
        pi[0] - dot(&s.n, &heights) - pi[16],
    ]
}

/// Derivatives of the constraints with respect to the invariants.
fn constraint_gradients<T: Scalar>(kind: FacetKind, pi: &[T; INVARIANTS]) -> [[T; INVARIANTS]; 6] {
    let zero = T::constant(0.0);
    let mut out = [[zero; INVARIANTS]; 6];
    let s = Shape::at(kind, [pi[14], pi[15]]);
    let heights = [pi[1], pi[2], pi[3]];
    let along = [pi[5], pi[6], pi[7]];
    let g = gram(pi);
    let mixed = s.mixed.map(T::constant);
    let g_n: [T; 3] = std::array::from_fn(|i| dot(&g[i], &s.n));
    let rest: [T; 3] = std::array::from_fn(|i| along[i] - g_n[i]);
    for a in 0..2 {
        for i in 0..3 {
            out[a][1 + i] = s.d[a][i];
            out[3 + a][5 + i] = s.d[a][i];
        }
        out[a][14 + (1 - a)] = dot(&mixed, &heights);
        let mut k = 8;
        for i in 0..3 {
            for j in i..3 {
                let term = s.d[a][i] * s.n[j];
                out[3 + a][k] = if i == j { -term } else { -(term + s.d[a][j] * s.n[i]) };
                k += 1;
            }
        }
        for b in 0..2 {
            let g_d: [T; 3] = std::array::from_fn(|i| dot(&g[i], &s.d[b]));
            let direct = -dot(&s.d[a], &g_d);
            out[3 + a][14 + b] = if a == b { direct } else { direct + dot(&mixed, &rest) };
            out[5][14 + b] = -dot(&s.d[b], &heights);
        }
    }
    out[2][4] = T::constant(0.5);
    out[5][0] = T::constant(1.0);
    for i in 0..3 {
        out[5][1 + i] = -s.n[i];
    }
    out[5][16] = T::constant(-1.0);
    out
}

/// Solves five equations by elimination with row pivoting; `None` if singular.
fn solve<T: Scalar>(mut m: [[T; 6]; 5]) -> Option<[T; 5]> {
    for p in 0..5 {
        let best = (p..5).max_by(|&a, &b| m[a][p].value().abs().total_cmp(&m[b][p].value().abs()))?;
        if m[best][p].value().abs() < 1.0e-14 {
            return None;
        }
        m.swap(p, best);
        for i in p + 1..5 {
            let factor = m[i][p] / m[p][p];
            for j in p + 1..6 {
                m[i][j] = m[i][j] - factor * m[p][j];
            }
        }
    }
    let mut x = [T::constant(0.0); 5];
    for i in (0..5).rev() {
        let mut sum = m[i][5];
        for j in i + 1..5 {
            sum = sum - m[i][j] * x[j];
        }
        x[i] = sum / m[i][i];
    }
    Some(x)
}

/// The discrete gradient for scaled configurations.
fn gradient<T: Scalar>(n: &Configuration<T>, np1: &Configuration<T>) -> Option<[T; LOCAL]> {
    let (pi_n, pi_1) = (n.invariants(), np1.invariants());
    let pi_mid: [T; INVARIANTS] = std::array::from_fn(|k| mean(pi_n[k], pi_1[k]));
    let delta: [T; INVARIANTS] = std::array::from_fn(|k| pi_1[k] - pi_n[k]);
    let mut square = T::constant(0.0);
    for d in delta {
        square = square + d * d;
    }
    let mut rows = constraint_gradients(n.kind, &pi_mid);
    if square.value() > SMALLEST_CHANGE * SMALLEST_CHANGE {
        let (phi_n, phi_1) = (constraints(n.kind, &pi_n), constraints(n.kind, &pi_1));
        for (i, row) in rows.iter_mut().enumerate() {
            let mut defect = phi_1[i] - phi_n[i];
            for k in 0..INVARIANTS {
                defect = defect - row[k] * delta[k];
            }
            let theta = defect / square;
            for k in 0..INVARIANTS {
                row[k] = row[k] + theta * delta[k];
            }
        }
    }
    let mid = n.mean(np1);
    let columns = rows.map(|row| mid.pull_back(&row));
    // Director and coordinates carry no force: five equations for the five auxiliary multipliers of a unit pressure.
    let system: [[T; 6]; 5] = std::array::from_fn(|i| {
        std::array::from_fn(|j| if j < 5 { columns[j][LOCAL + i] } else { -columns[5][LOCAL + i] })
    });
    let lambda = solve(system)?;
    Some(std::array::from_fn(|k| {
        let mut sum = columns[5][k];
        for (column, l) in columns.iter().zip(&lambda) {
            sum = sum + column[k] * *l;
        }
        sum
    }))
}

/// Discrete gradient `G` of the gap between `q_n` and `q_np1` on one (extended) facet. `gap_n`, `gap_np1` are the projections at
/// both ends; `length` is a typical master edge. `None` if the local equations are singular.
pub fn discrete_gradient(q_n: &Local, q_np1: &Local, gap_n: &Gap, gap_np1: &Gap, length: f64) -> Option<Local> {
    let scale = 1.0 / length;
    let n = Configuration::new(gap_n.kind, &q_n.map(|x| scale * x), gap_n.normal.into(), gap_n.xi);
    let np1 = Configuration::new(gap_np1.kind, &q_np1.map(|x| scale * x), gap_np1.normal.into(), gap_np1.xi);
    gradient(&n, &np1)
}

/// Discrete gradient as of [`discrete_gradient`], with its derivative with respect to `q_np1` (row `i`: derivative of component `i`).
pub fn discrete_gradient_and_tangent(
    q_n: &Local,
    q_np1: &Local,
    gap_n: &Gap,
    gap_np1: &Gap,
    length: f64,
) -> Option<(Local, LocalMatrix)> {
    let scale = 1.0 / length;
    let constant = |x: f64| Dual::constant(x);
    let q_0: [Dual; LOCAL] = std::array::from_fn(|k| constant(scale * q_n[k]));
    // The seeds are the scaled positions; the derivative is scaled back at the end.
    let q_1: [Dual; LOCAL] = std::array::from_fn(|k| Dual::variable(scale * q_np1[k], k));
    let n = Configuration::new(
        gap_n.kind,
        &q_0,
        std::array::from_fn(|i| constant(gap_n.normal[i])),
        gap_n.xi.map(constant),
    );
    // At the foot the coordinates' derivative is D^alpha, and the director's that of the normalised cross product.
    let f: [Dual; 2] =
        std::array::from_fn(|al| Dual { value: gap_np1.xi[al], partial: gap_np1.xi_gradient[al].map(|d| d * length) });
    let s = Shape::at(gap_np1.kind, f);
    let zero = constant(0.0);
    let free = Configuration::new(gap_np1.kind, &q_1, [zero; 3], f);
    let tangent = |a: usize| -> V3<Dual> {
        std::array::from_fn(|i| s.d[a][0] * free.e[0][i] + s.d[a][1] * free.e[1][i] + s.d[a][2] * free.e[2][i])
    };
    let c = cross(&tangent(0), &tangent(1));
    let norm = dot(&c, &c).sqrt();
    let np1 = Configuration { d: c.map(|x| x / norm), ..free };
    let g = gradient(&n, &np1)?;
    Some((g.map(|x| x.value), g.map(|x| x.partial.map(|p| scale * p))))
}
