//! The signed closest point against solids in closed form and against brute force.

use crate::common::*;
use nalgebra::Vector3;
use proptest::prelude::*;
use stoss_contact::Feature;
use stoss_testkit::meshes::mesh;

fn solids() -> Vec<(&'static str, Vec<[i32; 3]>)> {
    let missing_corner = block(2, 2, 2).into_iter().filter(|c| *c != [1, 1, 1]).collect();
    let step = [[0, 0, 0], [1, 0, 0], [0, 0, 1], [2, 0, 0], [0, 0, 2]].to_vec();
    let groove = block(3, 2, 2).into_iter().filter(|c| !(c[0] == 1 && c[2] == 1)).collect();
    vec![
        ("cube", block(1, 1, 1)),
        ("fine cube", block(3, 3, 3)),
        ("L", step),
        ("cube without a corner", missing_corner),
        ("groove", groove),
        ("plate", block(4, 3, 1)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn gap_is_the_signed_distance_of_known_solids(mesh in mesh(), x in proptest::array::uniform3(-0.7..4.7f64)) {
        let x = Vector3::from(x);
        for (name, cubes) in solids() {
            let (facets, q) = voxels(&cubes);
            let search = search(&mesh.of(&facets), &q, unlimited());
            prop_assert_eq!(search.surface().boundary_edge_count(), 0);
            let point = search.at(&q).closest(&x, None);
            let expected = voxel_distance(&cubes, &x);
            prop_assert!((point.gap - expected).abs() < 1e-13, "{}: {:?} {}", name, point, expected);
            // The normal leads from the closest point to x, outwards.
            prop_assert!((point.point + point.normal * point.gap - x).norm() < 1e-13);
            prop_assert!((point.normal.norm() - 1.0).abs() < 1e-13);
            prop_assert!(point.pairing.is_some());
        }
    }

    /// Straight lines, not only points: the gap cannot change faster than the position, through edges, corners and medial surfaces inside
    /// and outside. (Lines of generic direction meet every kind of transition.)
    #[test]
    fn gap_is_continuous_along_any_line(
        mesh in mesh(), from in proptest::array::uniform3(-0.7..3.7f64), to in proptest::array::uniform3(-0.7..3.7f64),
    ) {
        let (from, to) = (Vector3::from(from), Vector3::from(to));
        for (name, cubes) in solids() {
            let (facets, q) = voxels(&cubes);
            let search = search(&mesh.of(&facets), &q, unlimited());
            let view = search.at(&q);
            let steps = 60;
            let mut last = view.closest(&from, None).gap;
            for i in 1..=steps {
                let gap = view.closest(&from.lerp(&to, f64::from(i) / f64::from(steps)), None).gap;
                let bound = (to - from).norm() / f64::from(steps) + 1e-13;
                prop_assert!((gap - last).abs() <= bound, "{}: {} {}", name, gap, last);
                last = gap;
            }
        }
    }

    #[test]
    fn closest_point_of_warped_sheets_agrees_with_brute_force(
        mesh in mesh(), noise in proptest::collection::vec(-0.3..0.3f64, 75), heights in proptest::collection::vec(-0.5..0.5f64, 25),
        x in proptest::array::uniform3(0.0..1.0f64), moved in proptest::array::uniform3(-3.0..3.0f64),
    ) {
        let (quads, mut q) = sheet(4, 4, |u, v| [u, v, 0.0]);
        let facets = mesh.of(&quads);
        let reference = q.clone();
        for (c, d) in q.iter_mut().zip(&noise) { *c += d; }
        for (i, h) in heights.iter().enumerate() { q[3 * i + 2] += h; }
        let x = Vector3::new(4.0 * x[0], 4.0 * x[1], 2.0 * x[2] - 1.0);
        let mut search = search(&facets, &reference, unlimited());
        let expected = facets.iter().map(|f| {
            let corner = |n: u32| Vector3::from_column_slice(&q[3 * n as usize..3 * n as usize + 3]);
            if let [a, b, c] = f[..] {
                return triangle_distance([a, b, c].map(corner), &x);
            }
            sampled_distance([0, 1, 2, 3].map(|k| corner(f[k])), &x)
        }).fold(f64::INFINITY, f64::min);
        // The tree is still that of the flat sheet; then that of the warped one: the same bits.
        let stale = search.at(&q).closest(&x, None);
        search.update(&q, f64::INFINITY);
        let fresh = search.at(&q).closest(&x, None);
        prop_assert_eq!(stale, fresh);
        prop_assert!(((x - fresh.point).norm() - expected).abs() < 1e-7, "{:?} {}", fresh, expected);
        if let Some(pairing) = fresh.pairing {
            let rim = !matches!(fresh.feature, Feature::Face { .. });
            prop_assert!(rim || (fresh.gap.abs() - expected).abs() < 1e-7);
            // The pairing solves the normal equations on the extended patch.
            let patch = search.surface().patch(pairing.facet, &q);
            let r = x - patch.point(pairing.xi);
            for a in patch.tangents(pairing.xi) {
                prop_assert!(r.dot(&a).abs() < 1e-11 * a.norm_squared());
            }
            prop_assert!((r.dot(&pairing.normal) - pairing.gap).abs() < 1e-13);
        } else {
            prop_assert!(fresh.beyond_rim());
        }
        // A rigid translation of everything leaves the answer.
        let moved = Vector3::from(moved);
        let shifted: Vec<f64> = q.iter().enumerate().map(|(i, c)| c + moved[i % 3]).collect();
        let there = search.at(&shifted).closest(&(x + moved), None);
        prop_assert!(there.gap == fresh.gap || (there.gap - fresh.gap).abs() < 1e-12);
    }

    #[test]
    fn sphere_of_facets_is_nearly_a_sphere(mesh in mesh(), direction in proptest::array::uniform3(-1.0..1.0f64), radius in 0.7..1.5f64) {
        let direction = Vector3::from(direction);
        prop_assume!(direction.norm() > 0.1);
        let n = 6;
        let (facets, mut q) = voxels(&block(n, n, n));
        for p in q.chunks_exact_mut(3) {
            let v = Vector3::from_column_slice(p).add_scalar(-0.5 * f64::from(n)).normalize();
            p.copy_from_slice(v.as_slice());
        }
        let search = search(&mesh.of(&facets), &q, unlimited());
        let x = direction.normalize() * radius;
        let gap = search.at(&q).closest(&x, None).gap;
        // Chords of at most 0.3 lie at most 0.023 below the sphere in the middle of a facet.
        prop_assert!(gap >= radius - 1.0 - 1e-12 && gap <= radius - 1.0 + 0.03, "{} {}", gap, radius);
    }
}

#[test]
fn the_case_is_inspectable() {
    let (facets, q) = voxels(&block(1, 1, 1));
    let search = search(&facets, &q, unlimited());
    let view = search.at(&q);
    let closest = |x: [f64; 3]| view.closest(&Vector3::from(x), None);

    let face = closest([0.5, 0.25, 1.125]);
    let Feature::Face { facet, xi } = face.feature else { panic!("{face:?}") };
    assert_eq!(search.surface().patch(facet, &q).normal(xi), Vector3::z());
    assert_eq!((face.gap, face.feature.name()), (0.125, "face"));

    let edge = closest([0.5, 1.3, 1.4]);
    assert_eq!(edge.feature.name(), "edge");
    assert!((edge.gap - 0.5).abs() < 1e-15);
    let Feature::Edge { facets: (a, Some(b)), .. } = edge.feature else { panic!("{edge:?}") };
    let normals = [a, b].map(|f| search.surface().patch(f, &q).normal([0.0, 0.0]));
    assert!(normals.contains(&Vector3::y()) && normals.contains(&Vector3::z()));

    let vertex = closest([1.2, 1.2, 1.1]);
    let Feature::Vertex { node, rim: false } = vertex.feature else { panic!("{vertex:?}") };
    assert_eq!(&q[3 * node as usize..3 * node as usize + 3], [1.0, 1.0, 1.0]);
    assert!((vertex.gap - 0.3).abs() < 1e-15);
}

#[test]
fn the_floor_of_a_groove_below_the_valley_edge_pairs_with_the_better_face() {
    // A valley along y at the origin between the floor z = 0 (x > 0) and the wall x = 0 (z > 0); the body is below and to the left.
    let (facets, q) = sheet(2, 1, |u, v| [(u - 1.0).max(0.0), 4.0 * v, (1.0 - u).max(0.0)]);
    let search = search(&facets, &q, unlimited());
    // Penetrated beyond both faces: the closest point is the edge, and the floor is better aligned.
    let point = search.at(&q).closest(&Vector3::new(-0.03, 2.0, -0.04), None);
    assert_eq!(point.feature.name(), "edge");
    assert!((point.gap + 0.05).abs() < 1e-15);
    assert!((point.normal - Vector3::new(0.6, 0.0, 0.8)).norm() < 1e-12);
    let pairing = point.pairing.expect("a penetrated point is paired");
    assert_eq!(search.surface().patch(pairing.facet, &q).normal([0.0, 0.0]), Vector3::z());
    assert!((pairing.gap + 0.04).abs() < 1e-15 && pairing.xi.iter().any(|c| c.abs() > 1.0));
    // Outside, in the valley, always a face: the nearer one.
    let point = search.at(&q).closest(&Vector3::new(0.03, 2.0, 0.04), None);
    assert_eq!((point.feature.name(), point.normal), ("face", Vector3::x()));
    assert!((point.gap - 0.03).abs() < 1e-15);
}
