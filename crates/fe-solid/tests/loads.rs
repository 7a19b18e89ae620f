//! Surface loads: closed surfaces, resultants, work, tangent of the follower pressure.
use crate::common::*;
use proptest::prelude::*;
use stoss_fe_solid::*;
use stoss_mesh::{BOUNDARY, generate::Block};
use stoss_reference_element::{FaceKind, FaceNodes};

fn boundary(mesh: &stoss_mesh::Mesh) -> Vec<FaceNodes> {
    mesh.facets_of(BOUNDARY).unwrap().iter().map(|f| f.nodes).collect()
}

fn corners(facet: &FaceNodes, q: &[f64]) -> Vec<[f64; 3]> {
    facet.iter().map(|&n| std::array::from_fn(|i| q[3 * n as usize + i])).collect()
}

fn of_facet(facet: &FaceNodes, q: &[f64], pressure: f64) -> FollowerPressure {
    follower_pressure(facet.kind(), &corners(facet, q), pressure)
}

fn follower(facets: &[FaceNodes], q: &[f64], pressure: f64) -> Vec<f64> {
    let mut out = vec![0.0; q.len()];
    for facet in facets {
        add_follower_pressure(facet, of_facet(facet, q, pressure).force(), &mut out);
    }
    out
}

/// Enclosed volume by the divergence theorem with a 3x3 rule, not by elements: `1/3 int x . (x_,xi x x_,eta)`.
fn enclosed_volume(facets: &[FaceNodes], q: &[f64]) -> f64 {
    let line = [(-(0.6f64.sqrt()), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6f64.sqrt(), 5.0 / 9.0)];
    let mut volume = 0.0;
    for facet in facets {
        let c = corners(facet, q);
        for (s, ws) in line {
            for (t, wt) in line {
                let n = [(1.0 - s) * (1.0 - t), (1.0 + s) * (1.0 - t), (1.0 + s) * (1.0 + t), (1.0 - s) * (1.0 + t)];
                let at =
                    |w: [f64; 4]| -> [f64; 3] { std::array::from_fn(|i| (0..4).map(|k| 0.25 * w[k] * c[k][i]).sum()) };
                let (x, a, b) =
                    (at(n), at([t - 1.0, 1.0 - t, 1.0 + t, -1.0 - t]), at([s - 1.0, -1.0 - s, 1.0 + s, 1.0 - s]));
                volume += ws * wt / 3.0
                    * (x[0] * (a[1] * b[2] - a[2] * b[1])
                        + x[1] * (a[2] * b[0] - a[0] * b[2])
                        + x[2] * (a[0] * b[1] - a[1] * b[0]));
            }
        }
    }
    volume
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn pressure_on_a_closed_surface_has_no_resultant_and_no_moment(seed in any::<u64>()) {
        let mesh = distorted_block([2, 2, 1], 0.2, seed);
        let facets = boundary(&mesh);
        let q = Random(!seed).perturbed(&positions(&mesh), 0.2);
        let mut dead = vec![0.0; q.len()];
        dead_pressure(&facets, &positions(&mesh), 3.0, &mut dead).unwrap();
        for (x, f) in [(&q, &follower(&facets, &q, 3.0)), (&positions(&mesh), &dead)] {
            let (sum, moment) = resultant_and_moment(x, f);
            prop_assert!(max_abs(f) > 0.1);
            prop_assert!(max_abs(&sum) < 1e-13 && max_abs(&moment) < 1e-12);
        }
    }

    #[test]
    fn follower_force_is_minus_p_times_the_gradient_of_the_volume(seed in any::<u64>()) {
        let mesh = distorted_block([1, 1, 1], 0.2, seed);
        let facets = boundary(&mesh);
        let q = Random(!seed).perturbed(&positions(&mesh), 0.1);
        let f = follower(&facets, &q, 2.0);
        for j in 0..q.len() {
            let gradient = derivative(&q, j, 1e-2, |q| vec![enclosed_volume(&facets, q)])[0];
            prop_assert!((f[j] + 2.0 * gradient).abs() < 1e-11);
        }
    }

    #[test]
    fn follower_tangent_matches_differences(seed in any::<u64>(), pressure in -5.0..5.0f64) {
        for kind in FaceKind::ALL {
            let flat: Vec<f64> = kind.nodes().iter().flat_map(|x| [x[0], x[1], 0.0]).collect();
            let x = Random(seed).perturbed(&flat, 0.2);
            let facet = FaceNodes::from_fn(kind, |k| k as u32);
            let found = of_facet(&facet, &x, pressure);
            for j in 0..x.len() {
                let column = derivative(&x, j, 1e-2, |x| follower(&[facet], x, pressure));
                for i in 0..x.len() {
                    prop_assert!((found.tangent()[x.len() * i + j] - column[i]).abs() < 1e-11, "{}", kind);
                }
            }
        }
    }
}

#[test]
fn uniform_pressure_on_quadratic_facets_is_not_shared_equally() {
    // Of the total on corners, edges, centre: tri6 0 and 1/3, quad8 -1/12 and 1/3, quad9 1/36, 1/9 and 4/9.
    for (kind, shares) in [
        (FaceKind::Tri3, [1.0 / 3.0, 0.0, 0.0]),
        (FaceKind::Quad4, [0.25, 0.0, 0.0]),
        (FaceKind::Tri6, [0.0, 1.0 / 3.0, 0.0]),
        (FaceKind::Quad8, [-1.0 / 12.0, 1.0 / 3.0, 0.0]),
        (FaceKind::Quad9, [1.0 / 36.0, 1.0 / 9.0, 4.0 / 9.0]),
    ] {
        // A parallelogram, or half of one.
        let x: Vec<f64> = kind.nodes().iter().flat_map(|x| [2.0 * x[0] + 0.3 * x[1], x[1], 0.0]).collect();
        let facet = FaceNodes::from_fn(kind, |k| k as u32);
        let area = surface_area(&[facet], &x).unwrap();
        let (mut dead, mut traction) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        dead_pressure(&[facet], &x, -1.0, &mut dead).unwrap();
        dead_traction(&[facet], &x, [0.0, 0.0, 1.0], &mut traction).unwrap();
        for force in [dead, traction, follower(&[facet], &x, -1.0)] {
            for node in 0..kind.node_count() {
                let corners = kind.corner_count();
                let share = shares[if node < corners {
                    0
                } else if node < 2 * corners {
                    1
                } else {
                    2
                }];
                assert!(
                    (force[3 * node + 2] - share * area).abs() < 1e-14 * area,
                    "{kind} {node}: {}",
                    force[3 * node + 2] / area
                );
            }
        }
    }
}

/// Consistent matrices of a parallelogram and a triangle in parts of 1/180 of the area: the closed forms of the textbooks. Their rows add up to the nodal forces of a uniform traction.
#[test]
fn area_matrices_of_quadratic_facets_have_their_closed_form() {
    let of = |kind: FaceKind| {
        let x: Vec<f64> = kind.nodes().iter().flat_map(|x| [2.0 * x[0] + 0.3 * x[1], x[1], 0.0]).collect();
        let facet = FaceNodes::from_fn(kind, |k| k as u32);
        let area = surface_area(&[facet], &x).unwrap();
        let (matrix, mut traction) = (area_matrix(&facet, &x).unwrap(), vec![0.0; x.len()]);
        dead_traction(&[facet], &x, [0.0, 0.0, 1.0], &mut traction).unwrap();
        for (node, row) in matrix.chunks_exact(kind.node_count()).enumerate() {
            assert!((row.iter().sum::<f64>() - traction[3 * node + 2]).abs() < 1e-14 * area, "{kind}");
        }
        matrix.into_iter().map(|entry| 180.0 * entry / area).collect::<Vec<_>>()
    };
    let near = |found: &[f64], exact: &[f64]| found.iter().zip(exact).all(|(f, e)| (f - e).abs() < 1e-12);
    // First rows of corners and of middles of edges.
    let quad = of(FaceKind::Quad8);
    assert!(near(&quad[..8], &[6.0, 2.0, 3.0, 2.0, -6.0, -8.0, -8.0, -6.0]), "{quad:?}");
    assert!(near(&quad[32..40], &[-6.0, -6.0, -8.0, -8.0, 32.0, 20.0, 16.0, 20.0]), "{quad:?}");
    let tri = of(FaceKind::Tri6);
    assert!(near(&tri[..6], &[6.0, -1.0, -1.0, 0.0, -4.0, 0.0]), "{tri:?}");
    assert!(near(&tri[18..24], &[0.0, 0.0, -4.0, 32.0, 16.0, 16.0]), "{tri:?}");
    assert!(near(&of(FaceKind::Quad4)[..4], &[20.0, 10.0, 5.0, 10.0]));
    assert!(near(&of(FaceKind::Tri3)[..3], &[30.0, 15.0, 15.0]));
    of(FaceKind::Quad9);
    // A node without a place, a facet without area.
    let facet = FaceNodes::from([0, 1, 2]);
    assert!(matches!(area_matrix(&facet, &[0.0; 6]), Err(SolidError::Length { .. })));
    assert!(matches!(area_matrix(&facet, &[0.0; 9]), Err(SolidError::DegenerateFacet { .. })));
}

#[test]
fn loads_on_the_top_of_a_box() {
    let mesh = Block::new([0.0; 3], [2.0, 3.0, 1.0], [2, 3, 1]).generate().unwrap();
    let x = positions(&mesh);
    let top: Vec<FaceNodes> =
        boundary(&mesh).into_iter().filter(|f| f.iter().all(|&n| mesh.nodes[n as usize][2] == 1.0)).collect();
    assert!((surface_area(&top, &x).unwrap() - 6.0).abs() < 1e-13);
    let traction = [1.0, -2.0, 0.5];
    let (mut by_traction, mut by_pressure) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    dead_traction(&top, &x, traction, &mut by_traction).unwrap();
    dead_pressure(&top, &x, 4.0, &mut by_pressure).unwrap();
    let at_reference = follower(&top, &x, 4.0);
    for (f, force) in [(&by_traction, traction), (&by_pressure, [0.0, 0.0, -4.0]), (&at_reference, [0.0, 0.0, -4.0])] {
        let (sum, moment) = resultant_and_moment(&x, f);
        let c = [1.0, 1.5, 1.0];
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            assert!((sum[i] - 6.0 * force[i]).abs() < 1e-13 * 24.0);
            assert!((moment[i] - 6.0 * (c[j] * force[k] - c[k] * force[j])).abs() < 1e-13 * 48.0);
        }
    }
    // Corner nodes of the top carry a quarter of a facet.
    let corner = mesh.nodes.iter().position(|x| *x == [0.0, 0.0, 1.0]).unwrap();
    assert!((by_traction[3 * corner] - 0.25 * traction[0]).abs() < 1e-15);

    let moved: Vec<f64> = x.iter().enumerate().map(|(c, x)| if c % 3 == 2 { x + 0.3 } else { *x }).collect();
    assert!((external_work(&by_pressure, &x, &moved) + 4.0 * 6.0 * 0.3).abs() < 1e-12);
}

#[test]
fn bad_surfaces_are_errors() {
    let flat = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut out = [0.0; 12];
    let facets = [[0, 1, 2, 3].into()];
    assert_eq!(
        dead_traction(&facets, &flat, [1.0; 3], &mut out),
        Err(SolidError::DegenerateFacet { facet: 0, area: 0.0 })
    );
    assert!(matches!(surface_area(&facets, &flat), Err(SolidError::DegenerateFacet { facet: 0, .. })));
    assert!(matches!(
        dead_pressure(&[[0, 1, 2, 4].into()], &flat, 1.0, &mut out),
        Err(SolidError::Length { expected: 15, .. })
    ));
    assert!(matches!(dead_pressure(&facets, &flat, 1.0, &mut out[..9]), Err(SolidError::Length { found: 9, .. })));
}
