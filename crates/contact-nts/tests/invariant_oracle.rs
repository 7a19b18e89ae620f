//! The element with 17 invariants against theory/node-to-surface#eq-discrete-gradient evaluated without elimination: invariants, constraints and their
//! discrete derivative are written again, all derivatives are central differences, and the auxiliary multipliers come from the
//! rows of director and coordinates. Work, momenta and frame indifference hold for many discrete gradients; this says which one it is.

use nalgebra::{DMatrix, DVector, Matrix5, SVector, Vector3, Vector5};
use proptest::prelude::*;
use stoss_contact_nts::invariants::discrete_gradient;
use stoss_contact_nts::kinematics::{Gap, Local, points};
use stoss_reference_element::FacetKind;

type Z = SVector<f64, 20>;
type Pi = SVector<f64, 17>;
type Phi = SVector<f64, 6>;

fn node(z: &Z, k: usize) -> Vector3<f64> {
    Vector3::new(z[3 * k], z[3 * k + 1], z[3 * k + 2])
}

/// theory/node-to-surface#eq-invariants (thesis (4.78)) for `z = (x, m_1 .. m_4, d, f^1, f^2)`.
fn invariants(z: &Z) -> Pi {
    let (r, d) = (node(z, 0) - node(z, 1), node(z, 5));
    let e = [2, 3, 4].map(|k| node(z, k) - node(z, 1));
    let mut pi = vec![r.dot(&d), e[0].dot(&d), e[1].dot(&d), e[2].dot(&d), d.dot(&d)];
    pi.extend(e.iter().map(|v| v.dot(&r)));
    pi.extend([(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| e[i].dot(&e[j])));
    pi.extend([z[18], z[19], 0.0]);
    Pi::from_vec(pi)
}

/// theory/node-to-surface#eq-constraints: (4.79) of the thesis with another third row.
fn constraints(kind: FacetKind, pi: &Pi) -> Phi {
    let (u, v) = (pi[14], pi[15]);
    let (shape, by_u, by_v) = match kind {
        FacetKind::Quad4 => (
            Vector3::new((1.0 + u) * (1.0 - v), (1.0 + u) * (1.0 + v), (1.0 - u) * (1.0 + v)) / 4.0,
            Vector3::new(1.0 - v, 1.0 + v, -1.0 - v) / 4.0,
            Vector3::new(-1.0 - u, 1.0 + u, 1.0 - u) / 4.0,
        ),
        // The last of the three vectors is zero and has no function.
        FacetKind::Tri3 => (Vector3::new(u, v, 0.0), Vector3::x(), Vector3::y()),
    };
    let heights = Vector3::new(pi[1], pi[2], pi[3]);
    let gram = nalgebra::Matrix3::new(pi[8], pi[9], pi[10], pi[9], pi[11], pi[12], pi[10], pi[12], pi[13]);
    let rest = Vector3::new(pi[5], pi[6], pi[7]) - gram * shape;
    Phi::new(
        by_u.dot(&heights),
        by_v.dot(&heights),
        0.5 * (pi[4] - 1.0),
        by_u.dot(&rest),
        by_v.dot(&rest),
        pi[0] - shape.dot(&heights) - pi[16],
    )
}

/// Central differences, extrapolated: exact up to round-off for polynomials of the fourth degree in one variable.
fn jacobian<const N: usize, const M: usize>(
    f: impl Fn(&SVector<f64, N>) -> SVector<f64, M>,
    x: &SVector<f64, N>,
) -> DMatrix<f64> {
    let h = 0.1;
    DMatrix::from_fn(M, N, |i, j| {
        let at = |s: f64| {
            let mut y = *x;
            y[j] += s;
            f(&y)[i]
        };
        (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
    })
}

fn expected(kind: FacetKind, q_n: &Local, q_1: &Local, length: f64) -> Local {
    let constraints = |pi: &Pi| constraints(kind, pi);
    let state = |q: &Local| {
        let (x, patch) = points(q, kind);
        let foot = patch.project(&x, kind.centre());
        let values: Vec<f64> = q.iter().map(|c| c / length).chain(foot.normal.iter().copied()).chain(foot.xi).collect();
        Z::from_vec(values)
    };
    let (z_n, z_1) = (state(q_n), state(q_1));
    let (pi_n, pi_1) = (invariants(&z_n), invariants(&z_1));
    let (middle, change) = ((pi_n + pi_1) / 2.0, pi_1 - pi_n);
    let slope = jacobian(constraints, &middle);
    let delta = DVector::from_column_slice(change.as_slice());
    let jump = constraints(&pi_1) - constraints(&pi_n);
    let defect = DVector::from_column_slice(jump.as_slice()) - &slope * &delta;
    let discrete = slope + defect * delta.transpose() / delta.norm_squared();
    let columns = jacobian(invariants, &((z_n + z_1) / 2.0)).transpose() * discrete.transpose();
    let local = Matrix5::from_fn(|i, j| columns[(15 + i, j)]);
    let right = Vector5::from_fn(|i, _| -columns[(15 + i, 5)]);
    let multipliers = local.lu().solve(&right).unwrap();
    std::array::from_fn(|k| columns[(k, 5)] + (0..5).map(|j| columns[(k, j)] * multipliers[j]).sum::<f64>())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn element_is_the_one_without_elimination(
        kind in prop::sample::select(&FacetKind::ALL[..]),
        noise in proptest::array::uniform12(-0.25..0.25_f64),
        at in (-0.9..0.9_f64, -0.9..0.9_f64, -0.5..0.5_f64),
        by in proptest::array::uniform15(-0.2..0.2_f64),
        length in 0.5..4.0_f64,
    ) {
        let corners = [-1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0];
        let q_n: Local = std::array::from_fn(|k| if k < 3 { [at.0, at.1, at.2][k] } else { corners[k - 3] + noise[k - 3] });
        let q_1: Local = std::array::from_fn(|k| q_n[k] + by[k]);
        // Where there is no node, the first one of the facet stands.
        let padded = |q: Local| -> Local {
            std::array::from_fn(|k| if k / 3 > kind.node_count() { q[3 + k % 3] } else { q[k] })
        };
        let (q_n, q_1) = (padded(q_n), padded(q_1));
        let gap = |q: &Local| {
            let (x, patch) = points(q, kind);
            Gap::from_centre(&x, &patch).unwrap()
        };
        let found = discrete_gradient(&q_n, &q_1, &gap(&q_n), &gap(&q_1), length).unwrap();
        let expected = expected(kind, &q_n, &q_1, length);
        for k in 0..15 {
            prop_assert!((found[k] - expected[k]).abs() < 1e-10, "{k}: {} {}", found[k], expected[k]);
        }
    }
}
