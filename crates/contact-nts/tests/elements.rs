//! The contact elements at random configurations: tangents, momenta, work, invariance.

use proptest::prelude::*;
use stoss_contact_nts::crossing::Crossing;
use stoss_contact_nts::invariants::{discrete_gradient, discrete_gradient_and_tangent};
use stoss_contact_nts::kinematics::{Gap, LOCAL, Local, points};
use stoss_reference_element::{FacetKind, Nodal};
use stoss_testkit::oracle::{assert_jacobian_close, central_difference_jacobian};

fn kind() -> impl Strategy<Value = FacetKind> {
    prop::sample::select(&FacetKind::ALL[..])
}

/// Where there is no node, the first one of the facet stands.
fn padded(kind: FacetKind, q: Local) -> Local {
    std::array::from_fn(|k| if k / 3 > kind.node_count() { q[3 + k % 3] } else { q[k] })
}

/// A slave node above or below a warped facet of size two: positions with a gap that is not zero.
fn configuration() -> impl Strategy<Value = Local> {
    (
        proptest::array::uniform12(-0.25..0.25_f64),
        proptest::array::uniform2(-0.9..0.9_f64),
        0.05..0.5_f64,
        any::<bool>(),
    )
        .prop_map(|(noise, at, height, below)| {
            let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
            let mut q = [0.0; LOCAL];
            q[..3].copy_from_slice(&[at[0], at[1], if below { -height } else { height }]);
            for (k, corner) in corners.iter().enumerate() {
                for i in 0..3 {
                    q[3 * k + 3 + i] = corner[i] + noise[3 * k + i];
                }
            }
            q
        })
}

fn gap(kind: FacetKind, q: &Local) -> Gap {
    let (x, patch) = points(q, kind);
    Gap::from_centre(&x, &patch).expect("a modestly warped facet has a foot")
}

fn moved(kind: FacetKind, q: &Local, by: &[f64], size: f64) -> Local {
    padded(kind, std::array::from_fn(|k| q[k] + size * by[k]))
}

fn rotated(q: &[f64]) -> Vec<f64> {
    let r = nalgebra::Rotation3::from_euler_angles(0.7, -0.4, 1.9);
    let shift = nalgebra::Vector3::new(3.0, -2.0, 5.0);
    q.chunks_exact(3)
        .flat_map(|x| {
            let y = r * nalgebra::Vector3::new(x[0], x[1], x[2]) + shift;
            [y[0], y[1], y[2]]
        })
        .collect()
}

/// Sum of the forces and of the moments about the origin at the midpoint.
fn resultants(q_n: &[f64], q_1: &[f64], g: &[f64]) -> f64 {
    let (mut force, mut moment) = (nalgebra::Vector3::zeros(), nalgebra::Vector3::zeros());
    for k in 0..g.len() / 3 {
        let f = nalgebra::Vector3::new(g[3 * k], g[3 * k + 1], g[3 * k + 2]);
        let x = nalgebra::Vector3::from_fn(|i, _| 0.5 * (q_n[3 * k + i] + q_1[3 * k + i]));
        force += f;
        moment += x.cross(&f);
    }
    force.norm().max(moment.norm())
}

fn work(q_n: &[f64], q_1: &[f64], g: &[f64]) -> f64 {
    g.iter().zip(q_1).zip(q_n).map(|((g, b), a)| g * (b - a)).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn first_and_second_variation(kind in kind(), q in configuration()) {
        let q = padded(kind, q);
        let kinematics = gap(kind, &q);
        let gradient = central_difference_jacobian(|x, out| out[0] = gap(kind, x.try_into().unwrap()).gap, &q, 1e-3, 1);
        assert_jacobian_close(&kinematics.gradient, &gradient, LOCAL, 1e-8, "N");
        let xi = central_difference_jacobian(|x, out| out.copy_from_slice(&gap(kind, x.try_into().unwrap()).xi), &q, 1e-3, 2);
        assert_jacobian_close(&kinematics.xi_gradient.concat(), &xi, LOCAL, 1e-7, "D");
        let hessian =
            central_difference_jacobian(|x, out| out.copy_from_slice(&gap(kind, x.try_into().unwrap()).gradient), &q, 1e-3, LOCAL);
        assert_jacobian_close(&kinematics.hessian().concat(), &hessian, LOCAL, 1e-7, "second variation of g");
        let second = central_difference_jacobian(
            |x, out| out.copy_from_slice(&gap(kind, x.try_into().unwrap()).xi_gradient.concat()), &q, 1e-3, 2 * LOCAL,
        );
        let closed: Vec<f64> = kinematics.xi_hessian().iter().flat_map(|h| h.concat()).collect();
        assert_jacobian_close(&closed, &second, LOCAL, 1e-7, "second variation of xi");
    }

    #[test]
    fn full_variation_conserves_momenta_for_any_gap(kind in kind(), q in configuration()) {
        let q = padded(kind, q);
        prop_assert!(resultants(&q, &q, &gap(kind, &q).gradient) < 1e-13);
    }

    #[test]
    fn discrete_gradient_conserves_and_works(
        kind in kind(),
        q_n in configuration(),
        by in proptest::array::uniform15(-1.0..1.0_f64),
        power in 0..6_i32,
    ) {
        let q_n = padded(kind, q_n);
        let size = 0.2 * 10.0_f64.powi(-power);
        let q_1 = moved(kind, &q_n, &by, size);
        let (a, b) = (gap(kind, &q_n), gap(kind, &q_1));
        let g = discrete_gradient(&q_n, &q_1, &a, &b, 2.0).unwrap();
        prop_assert!(resultants(&q_n, &q_1, &g) < 1e-12, "momenta {:e}", resultants(&q_n, &q_1, &g));
        let defect = work(&q_n, &q_1, &g) - (b.gap - a.gap);
        prop_assert!(defect.abs() < 1e-14, "work {defect:e}");
        let (same, _) = discrete_gradient_and_tangent(&q_n, &q_1, &a, &b, 2.0).unwrap();
        for k in 0..LOCAL {
            // Both evaluations round differently; the quotient amplifies that by the inverse of the step.
            prop_assert!((same[k] - g[k]).abs() < 1e-12 + 1e-14 / size);
        }
    }

    #[test]
    fn discrete_gradient_has_its_tangent(
        kind in kind(), q_n in configuration(), by in proptest::array::uniform15(-1.0..1.0_f64),
    ) {
        let q_n = padded(kind, q_n);
        let q_1 = moved(kind, &q_n, &by, 0.1);
        let a = gap(kind, &q_n);
        let (_, tangent) = discrete_gradient_and_tangent(&q_n, &q_1, &a, &gap(kind, &q_1), 1.7).unwrap();
        let numeric = central_difference_jacobian(
            |x, out| {
                let q: &Local = x.try_into().unwrap();
                out.copy_from_slice(&discrete_gradient(&q_n, q, &a, &gap(kind, q), 1.7).unwrap());
            },
            &q_1,
            1e-3,
            LOCAL,
        );
        assert_jacobian_close(&tangent.concat(), &numeric, LOCAL, 1e-7, "tangent of the discrete gradient");
    }

    #[test]
    fn discrete_gradient_is_frame_indifferent_and_tends_to_the_gradient(
        kind in kind(),
        q_n in configuration(),
        by in proptest::array::uniform15(-1.0..1.0_f64),
    ) {
        let q_n = padded(kind, q_n);
        let q_1 = moved(kind, &q_n, &by, 0.1);
        let g = discrete_gradient(&q_n, &q_1, &gap(kind, &q_n), &gap(kind, &q_1), 2.0).unwrap();
        let (p_n, p_1): (Local, Local) = (rotated(&q_n).try_into().unwrap(), rotated(&q_1).try_into().unwrap());
        let h = discrete_gradient(&p_n, &p_1, &gap(kind, &p_n), &gap(kind, &p_1), 2.0).unwrap();
        // Rotate g without the shift.
        let zero = rotated(&[0.0; 3]);
        let expected: Vec<f64> = rotated(&g).chunks_exact(3).flat_map(|x| [x[0] - zero[0], x[1] - zero[1], x[2] - zero[2]]).collect();
        for k in 0..LOCAL {
            prop_assert!((h[k] - expected[k]).abs() < 1e-11);
        }
        // Second order: a step a tenth as large is a hundred times closer to the gradient at the midpoint.
        let distance = |size: f64| -> f64 {
            let q_1 = moved(kind, &q_n, &by, size);
            let mid: Local = std::array::from_fn(|k| 0.5 * (q_n[k] + q_1[k]));
            let g = discrete_gradient(&q_n, &q_1, &gap(kind, &q_n), &gap(kind, &q_1), 2.0).unwrap();
            let n = gap(kind, &mid).gradient;
            g.iter().zip(&n).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        prop_assert!(distance(2e-3) < 0.02 * distance(2e-2) + 1e-10, "{:e} {:e}", distance(2e-3), distance(2e-2));
    }

    #[test]
    fn crossing_conserves_works_and_has_its_tangent(
        kinds in (kind(), kind()),
        noise in proptest::array::uniform18(-0.15..0.15_f64),
        from in (0.3..0.9_f64, -0.8..0.8_f64, -0.3..0.3_f64),
        to in (1.1..1.8_f64, -0.8..0.8_f64, -0.3..0.3_f64),
        by in proptest::array::uniform18(-0.1..0.1_f64),
    ) {
        // Two facets with a common edge and a kink; nodes 0 slave, end facet 1..=4, start facet's others 5, 6.
        let base = [
            [1.0, -1.0, 0.0], [3.0, -1.0, -0.4], [3.0, 1.0, -0.4], [1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0],
        ];
        // A triangle has three of the four.
        let nodes = |kind, quad: [usize; 4]| Nodal::from_fn(kind, |k| quad[k]);
        let (end_nodes, start_nodes) = (nodes(kinds.0, [1, 2, 3, 4]), nodes(kinds.1, [5, 1, 4, 6]));
        let mut q_n = vec![from.0, from.1, from.2];
        let mut q_1 = vec![to.0, to.1, to.2];
        for (k, corner) in base.iter().enumerate() {
            for i in 0..3 {
                let x = corner[i] + noise[3 * k + i];
                q_n.push(x);
                q_1.push(x + by[3 * k + i]);
            }
        }
        let on = |q: &[f64], facet: &Nodal<usize>| {
            let mut local = [0.0; LOCAL];
            for (block, node) in std::iter::once(&0).chain(facet).enumerate() {
                local[3 * block..3 * block + 3].copy_from_slice(&q[3 * node..3 * node + 3]);
            }
            gap(facet.kind(), &local)
        };
        let gap_n = on(&q_n, &start_nodes).gap;
        let evaluate = |q_1: &[f64], tangent: &mut [f64]| {
            let mid: Vec<f64> = q_n.iter().zip(q_1).map(|(a, b)| 0.5 * (a + b)).collect();
            let (end, mid) = (on(q_1, &end_nodes), on(&mid, &start_nodes));
            let mut g = vec![0.0; 21];
            Crossing {
                q_n: &q_n, q_np1: q_1, gap_n, end: (&end, &end_nodes), mid: (&mid, &start_nodes), length: 2.0,
            }
            .evaluate(&mut g, tangent);
            (g, end.gap)
        };
        let mut tangent = vec![0.0; 21 * 21];
        let (g, gap_1) = evaluate(&q_1, &mut tangent);
        prop_assert!(resultants(&q_n, &q_1, &g) < 1e-12);
        prop_assert!((work(&q_n, &q_1, &g) - (gap_1 - gap_n)).abs() < 1e-14);
        let numeric =
            central_difference_jacobian(|x, out| out.copy_from_slice(&evaluate(x, &mut []).0), &q_1, 1e-3, 21);
        assert_jacobian_close(&tangent, &numeric, 21, 1e-7, "tangent of the crossing element");
    }
}

#[test]
fn nothing_moves() {
    let q = [0.2, 0.1, 0.3, -1.0, -1.0, 0.0, 1.0, -1.0, 0.1, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0];
    let a = gap(FacetKind::Quad4, &q);
    let g = discrete_gradient(&q, &q, &a, &a, 2.0).unwrap();
    for k in 0..LOCAL {
        assert!((g[k] - a.gradient[k]).abs() < 1e-13);
    }
}
