//! Differential geometry, projection and closest point against finite differences, reconstruction and brute force.

use nalgebra::Vector3;
use proptest::prelude::*;
use stoss_geometry::{Patch, PatchFeature};
use stoss_reference_element::{FacetKind, Nodal};

fn vector(range: f64) -> impl Strategy<Value = Vector3<f64>> {
    proptest::array::uniform3(-range..range).prop_map(Vector3::from)
}

fn kind() -> impl Strategy<Value = FacetKind> {
    proptest::sample::select(&FacetKind::ALL[..])
}

/// Any points: folded, twisted, far from a facet of a sensible mesh.
fn wild_patch() -> impl Strategy<Value = Patch> {
    (kind(), proptest::array::uniform4(vector(1.0)))
        .prop_map(|(kind, corners)| Patch::new(Nodal::from_fn(kind, |i| corners[i])))
}

/// The reference facet, skewed, warped and moved far from the origin.
fn facet() -> impl Strategy<Value = Patch> {
    (kind(), proptest::array::uniform4(vector(0.3)), vector(50.0), vector(1.0), 0.0..3.1f64).prop_map(
        |(kind, noise, offset, axis, angle)| {
            let place = |i: usize| Vector3::new(kind.vertices()[i][0], kind.vertices()[i][1], 0.0);
            let rotation = nalgebra::Rotation3::new(axis.normalize() * angle);
            // Edges of a triangle are half as long.
            let noise = noise.map(|n| n * (0.5 * kind.area().sqrt()));
            Patch::new(Nodal::from_fn(kind, |i| offset + rotation * (place(i) + noise[i])))
        },
    )
}

/// Distance by dense sampling and a shrinking pattern search from the best samples: knows nothing of derivatives.
fn brute_force_distance(patch: &Patch, x: &Vector3<f64>) -> f64 {
    const N: usize = 40;
    let f = |xi: [f64; 2]| (x - patch.point(xi)).norm();
    let mut samples: Vec<([f64; 2], f64)> = (0..=N * N + 2 * N)
        .map(|i| [2.0 * (i / (N + 1)) as f64 / N as f64 - 1.0, 2.0 * (i % (N + 1)) as f64 / N as f64 - 1.0])
        .map(|xi| patch.kind().clamp(xi))
        .map(|xi| (xi, f(xi)))
        .collect();
    samples.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut best = f64::INFINITY;
    for &(mut xi, mut value) in samples.iter().step_by(4).take(6) {
        let mut size = 2.0 / N as f64;
        while size > 1e-9 {
            let mut improved = false;
            for k in 0..8 {
                let angle = std::f64::consts::FRAC_PI_4 * k as f64;
                let trial = patch.kind().clamp([xi[0] + size * angle.cos(), xi[1] + size * angle.sin()]);
                if f(trial) < value {
                    (xi, value, improved) = (trial, f(trial), true);
                }
            }
            if !improved {
                size *= 0.5;
            }
        }
        best = best.min(value);
    }
    best
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn frame_agrees_with_finite_differences(patch in facet(), xi in proptest::array::uniform2(-1.2..1.2f64)) {
        let frame = patch.frame(xi);
        let h = 1e-4;
        // The patch is quadratic: central differences are exact up to round-off.
        let d_1 = (patch.point([xi[0] + h, xi[1]]) - patch.point([xi[0] - h, xi[1]])) / (2.0 * h);
        let d_2 = (patch.point([xi[0], xi[1] + h]) - patch.point([xi[0], xi[1] - h])) / (2.0 * h);
        prop_assert!((frame.tangents[0] - d_1).norm() < 1e-9);
        prop_assert!((frame.tangents[1] - d_2).norm() < 1e-9);
        let d_12 = (patch.tangents([xi[0], xi[1] + h])[0] - patch.tangents([xi[0], xi[1] - h])[0]) / (2.0 * h);
        prop_assert!((frame.a_12 - d_12).norm() < 1e-9);
        prop_assert!(frame.normal.dot(&d_1).abs() < 1e-9 && frame.normal.dot(&d_2).abs() < 1e-9);
        prop_assert!((frame.normal.norm() - 1.0).abs() < 1e-14);
        prop_assert_eq!(frame.metric, patch.metric(xi));
        prop_assert_eq!(frame.curvature_12, patch.curvature(xi)[0][1]);
        let shape = patch.shape(xi);
        let sum: Vector3<f64> = patch.corners.iter().zip(shape).map(|(m, n)| m * n).sum();
        prop_assert!((sum - frame.point).norm() < 1e-13 * (1.0 + sum.norm()));
    }

    #[test]
    fn projection_recovers_foot_and_gap(
        patch in facet(), xi in proptest::array::uniform2(-1.3..1.3f64), gap in -0.3..0.3f64,
    ) {
        let frame = patch.frame(xi);
        let x = frame.point + frame.normal * gap;
        // Any start within the facet must do; the foot may differ only where another one exists.
        for start in [[0.0, 0.0], [0.9, -0.9], [-0.9, -0.9]] {
            let p = patch.project(&x, start);
            prop_assert!(p.converged);
            let r = x - patch.point(p.xi);
            for a in patch.tangents(p.xi) {
                prop_assert!(r.dot(&a).abs() <= 1e-12 * a.norm_squared());
            }
        }
        let p = patch.project(&x, [xi[0] + 0.05, xi[1] - 0.05]);
        let unique = (gap * frame.curvature_12).abs() < 0.5 * (frame.metric[0][0] * frame.metric[1][1]).sqrt()
            - frame.metric[0][1].abs();
        if unique {
            prop_assert!((p.xi[0] - xi[0]).abs() < 1e-11 && (p.xi[1] - xi[1]).abs() < 1e-11, "{:?} {:?}", p.xi, xi);
            prop_assert!((p.gap - gap).abs() < 1e-12);
            prop_assert!((p.normal - frame.normal).norm() < 1e-11);
        }
    }

    /// From the facet that a node starts its step on to a foot far beyond: nothing bends the parametrisation on a parallelogram.
    #[test]
    fn a_foot_a_thousand_facets_away_is_found_on_a_plane(
        xi in proptest::array::uniform2(-2000.0..2000.0f64), gap in -1.0..1.0f64,
        a in vector(1.0), b in vector(1.0), o in vector(1.0),
    ) {
        prop_assume!(a.cross(&b).norm() > 0.1 * a.norm() * b.norm() && a.norm().min(b.norm()) > 0.1);
        let patch = Patch::new([o, o + a, o + a + b, o + b]);
        let x = patch.point(xi) + patch.frame([0.0; 2]).normal * gap;
        let p = patch.project(&x, [0.0, 0.0]);
        prop_assert!(p.converged);
        prop_assert!((p.xi[0] - xi[0]).abs() < 1e-9 && (p.xi[1] - xi[1]).abs() < 1e-9, "{:?} {:?}", p.xi, xi);
    }

    #[test]
    fn closest_point_is_the_global_minimum(patch in wild_patch(), x in vector(2.5)) {
        let c = patch.closest_point(&x);
        let distance = c.distance_squared.sqrt();
        prop_assert!(((x - patch.point(c.xi)).norm() - distance).abs() < 1e-13);
        prop_assert!((c.point - patch.point(c.xi)).norm() < 1e-14);
        let brute = brute_force_distance(&patch, &x);
        prop_assert!(distance <= brute + 1e-13, "{distance} {brute}");
        prop_assert!(distance >= brute - 1e-7, "{distance} {brute}");
    }

    #[test]
    fn closest_point_feature_and_optimality(patch in facet(), xi in proptest::array::uniform2(-2.0..2.0f64), gap in -1.0..1.0f64) {
        let x = patch.point(xi) + patch.normal(xi) * gap;
        let c = patch.closest_point(&x);
        let kind = patch.kind();
        let on_side: Vec<bool> = (0..kind.edge_count()).map(|k| kind.edge_excess(k, c.xi) == 0.0).collect();
        let sides = on_side.iter().filter(|s| **s).count();
        match c.feature {
            PatchFeature::Interior => prop_assert_eq!(sides, 0),
            PatchFeature::Edge(k) => prop_assert!(sides == 1 && on_side[k]),
            PatchFeature::Vertex(k) => {
                prop_assert_eq!(sides, 2);
                prop_assert_eq!(c.point, patch.corners[k]);
            }
        }
        prop_assert!(kind.excess(c.xi) <= 0.0);
        // First-order optimality in the directions that the facet allows: to its corners, and in the interior all.
        let r = x - c.point;
        let size = patch.tangents(c.xi)[0].norm();
        let [a_1, a_2] = patch.tangents(c.xi);
        for vertex in kind.vertices() {
            let to = a_1 * (vertex[0] - c.xi[0]) + a_2 * (vertex[1] - c.xi[1]);
            prop_assert!(r.dot(&to) <= 1e-11 * size * size.max(to.norm()), "{}", r.dot(&to));
        }
        if c.feature == PatchFeature::Interior {
            for a in patch.tangents(c.xi) {
                prop_assert!(r.dot(&a).abs() < 1e-11 * a.norm_squared());
            }
        }
    }
}

#[test]
fn degenerate_patches_give_finite_answers() {
    let (o, e, f) = (Vector3::zeros(), Vector3::x(), Vector3::y());
    let x = Vector3::new(0.3, 0.2, 0.5);
    // A triangle, a line, a point: distances in closed form.
    for (corners, expected) in [([o, e, f, f], 0.5), ([o, e, e, o], 0.29f64.sqrt()), ([o, o, o, o], x.norm())] {
        let c = Patch::new(corners).closest_point(&x);
        assert!((c.distance_squared.sqrt() - expected).abs() < 1e-12, "{corners:?} {c:?}");
        assert!(c.xi.iter().all(|v| v.is_finite()));
    }
    let p = Patch::new([o, o, o, o]).project(&x, [0.0, 0.0]);
    assert!(!p.converged && p.gap.is_finite() && p.normal == Vector3::zeros());
}

#[test]
fn two_feet_on_a_saddle_are_both_seen() {
    // z = xy on the square: above the centre at height c > 1 the two feet are on the diagonal x = y at 2 x^2 = 2 (c - 1) ...
    let corners = [[-1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, -1.0]].map(Vector3::from);
    let patch = Patch::new(corners);
    let height = 1.5;
    let c = patch.closest_point(&Vector3::new(0.0, 0.0, height));
    // minimise 2 s^2 + (height - s^2)^2 over s: s^2 = height - 1.
    assert!((c.xi[0] * c.xi[1] - (height - 1.0)).abs() < 1e-12);
    assert!((c.distance_squared - (2.0 * height - 1.0)).abs() < 1e-12);
    assert_eq!(c.feature, PatchFeature::Interior);
}

#[test]
fn corner_angles_of_a_square() {
    let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]].map(Vector3::from);
    for k in 0..4 {
        assert!((Patch::new(corners).corner_angle(k) - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    }
}
