//! Closest weights against exact arithmetic, over all shapes and scales.

use crate::primitives::exact;
use nalgebra::Vector3;
use proptest::prelude::*;
use stoss_geometry::{ClosestPair, PairFeature, PairKind, closest, combine};

const KINDS: [PairKind; 4] =
    [PairKind::VertexTriangle, PairKind::EdgeEdge, PairKind::VertexEdge, PairKind::VertexVertex];

type Points = [Vector3<f64>; 4];

fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = Vector3<f64>> {
    proptest::array::uniform3(range).prop_map(Vector3::from)
}

fn general() -> impl Strategy<Value = Points> {
    proptest::array::uniform4(vector(-1.0..1.0))
}

/// Points of a small lattice: coinciding, collinear, parallel, coplanar ones are frequent, and exact.
fn lattice() -> impl Strategy<Value = Points> {
    proptest::array::uniform4(proptest::array::uniform3(-2i32..3).prop_map(|p| Vector3::from(p.map(f64::from))))
}

/// Nearly degenerate: a lattice, and perturbations of any size down to round-off.
fn nearly_degenerate() -> impl Strategy<Value = Points> {
    (lattice(), general(), proptest::array::uniform4(-18.0..-2.0f64))
        .prop_map(|(base, noise, size)| std::array::from_fn(|i| base[i] + noise[i] * 10f64.powf(size[i])))
}

/// All points near one line: slivers and nearly parallel edges with long overlaps, and a second primitive near the first.
fn sliver() -> impl Strategy<Value = Points> {
    (vector(-1.0..1.0), proptest::array::uniform4(-1.0..1.0f64), general(), proptest::array::uniform4(-17.0..0.0f64))
        .prop_map(|(line, along, noise, size)| {
            std::array::from_fn(|i| line * along[i] + noise[i] * 10f64.powf(size[i]))
        })
}

fn scaled() -> impl Strategy<Value = Points> {
    let one = prop_oneof![general(), lattice(), nearly_degenerate(), sliver()];
    // A translation costs digits of the points, none of the distance of what is left of them.
    (one, -400i32..400, prop_oneof![Just(0.0), Just(1.0), Just(1e6)], vector(-1.0..1.0))
        .prop_map(|(x, power, far, shift)| x.map(|x| (x + shift * far) * 2f64.powi(power)))
}

fn oracle(kind: PairKind, x: &Points) -> f64 {
    let (p, exponent) = exact::points(x);
    let squared = match kind {
        PairKind::VertexTriangle => exact::vertex_triangle(&p[0], [&p[1], &p[2], &p[3]]),
        PairKind::EdgeEdge => exact::edge_edge([&p[0], &p[1]], [&p[2], &p[3]]),
        PairKind::VertexEdge => exact::vertex_edge(&p[0], &p[1], &p[2]),
        PairKind::VertexVertex => exact::vertex_edge(&p[0], &p[1], &p[1]),
    };
    squared.to_f64(2 * exponent)
}

/// `|sum c_i x_i|^2` in exact arithmetic.
fn exact_square(weights: &[f64; 4], x: &Points) -> f64 {
    let (p, exponent) = exact::points(x);
    let (c, weight_exponent) = exact::integers(weights);
    let r: exact::Point = [0, 1, 2].map(|k| (0..4).map(|i| &c[i] * &p[i][k]).sum());
    let numerator = exact::dot(&r, &r);
    exact::Fraction { numerator, denominator: 1.into() }.to_f64(2 * (exponent + weight_exponent))
}

/// Largest distance of two points that the kind uses.
fn extent(kind: PairKind, x: &Points) -> f64 {
    let used = &x[..kind.point_count()];
    used.iter().flat_map(|a| used.iter().map(move |b| (a - b).norm())).fold(0.0, f64::max)
}

fn check(kind: PairKind, x: &Points) -> Result<(), TestCaseError> {
    let pair = closest(kind, x);
    let (c, first) = (pair.weights, kind.first_count());
    // The weights are in K.
    prop_assert!(c[..first].iter().all(|&c| (0.0..=1.0).contains(&c)), "{:?}", c);
    prop_assert!(c[first..].iter().all(|&c| (-1.0..=0.0).contains(&c)), "{:?}", c);
    prop_assert!(
        (c[..first].iter().sum::<f64>() - 1.0).abs() < 4e-16 && c.iter().sum::<f64>().abs() < 4e-16,
        "{:?}",
        c
    );
    prop_assert!(c[kind.point_count()..].iter().all(|&c| c == 0.0));
    // They are those of the minimum.
    let length = extent(kind, x);
    let (expected, found) = (oracle(kind, x), pair.distance_squared);
    let tolerance = 2e-15 * length * expected.sqrt() + 1e-30 * length * length;
    prop_assert!((found - expected).abs() <= tolerance, "{:?}: {:e}, exact {:e}", kind, found, expected);
    let square = exact_square(&c, x);
    // The weights' own sum of round-off would move far points; the program works with differences.
    if x[0].norm() <= 4.0 * length {
        prop_assert!((square - found).abs() <= 8.0 * tolerance, "{:?}: {:e}, exact weights {:e}", kind, found, square);
    }
    let r = combine(&c, x);
    prop_assert_eq!(found, r.norm_squared());
    // Necessary and sufficient for the minimum over the convex set: no corner of K lies in a direction of descent.
    for i in 0..first {
        for j in first..kind.point_count() {
            prop_assert!(r.dot(&(x[i] - x[j])) - found >= -2e-15 * length * length, "{:?}", pair);
        }
    }
    check_directions(&pair, x, length)
}

fn check_directions(pair: &ClosestPair, x: &Points, length: f64) -> Result<(), TestCaseError> {
    let (r, free) = (combine(&pair.weights, x), pair.free_directions());
    let nodes = pair.weights.iter().filter(|&&c| c != 0.0).count();
    prop_assert_eq!(free.as_slice().len(), nodes - 2);
    let count = match pair.feature() {
        PairFeature::VertexVertex(k) => {
            prop_assert!(k.iter().all(|&k| pair.weights[k].abs() == 1.0));
            0
        }
        PairFeature::VertexEdge(k, e) => {
            prop_assert!(pair.weights[k].abs() == 1.0 && e.iter().all(|&e| pair.weights[e] * pair.weights[k] < 0.0));
            1
        }
        PairFeature::VertexTriangle => {
            prop_assert_eq!(pair.kind, PairKind::VertexTriangle);
            2
        }
        PairFeature::EdgeEdge => {
            prop_assert_eq!(pair.kind, PairKind::EdgeEdge);
            2
        }
    };
    prop_assert_eq!(count, free.as_slice().len());
    for b in free.as_slice() {
        prop_assert_eq!(b.iter().sum::<f64>(), 0.0);
        prop_assert!((0..4).all(|i| b[i] == 0.0 || (b[i].abs() == 1.0 && pair.weights[i] != 0.0)));
        prop_assert!(r.dot(&combine(b, x)).abs() <= 2e-15 * length * length, "{:?}", pair);
    }
    if let [a, b] = free.as_slice() {
        prop_assert!(a != b && a.map(|a| -a) != *b);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn weights_are_those_of_the_exact_minimum(x in scaled()) {
        for kind in KINDS {
            check(kind, &x)?;
        }
    }
}

#[test]
fn degenerate_pairs() {
    let o = Vector3::zeros();
    let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
    let of = |kind, x: [Vector3<f64>; 4]| {
        let pair = closest(kind, &x);
        (pair.weights, pair.distance_squared, pair.feature())
    };
    // All points in one: first corners.
    assert_eq!(of(PairKind::VertexTriangle, [o; 4]), ([1.0, -1.0, -0.0, 0.0], 0.0, PairFeature::VertexVertex([0, 1])));
    assert_eq!(of(PairKind::EdgeEdge, [o; 4]), ([1.0, 0.0, -1.0, 0.0], 0.0, PairFeature::VertexVertex([0, 2])));
    // An edge of length zero against an edge.
    assert_eq!(
        of(PairKind::EdgeEdge, [v(0.25, 1.0, 0.0), v(0.25, 1.0, 0.0), o, v(1.0, 0.0, 0.0)]),
        ([1.0, 0.0, -0.75, -0.25], 1.0, PairFeature::VertexEdge(0, [2, 3]))
    );
    // Parallel edges that overlap: the first end that is nearest.
    assert_eq!(
        of(PairKind::EdgeEdge, [v(0.5, 1.0, 0.0), v(1.5, 1.0, 0.0), o, v(1.0, 0.0, 0.0)]),
        ([1.0, 0.0, -0.5, -0.5], 1.0, PairFeature::VertexEdge(0, [2, 3]))
    );
    // Collinear edges, apart.
    assert_eq!(
        of(PairKind::EdgeEdge, [o, v(1.0, 0.0, 0.0), v(4.0, 0.0, 0.0), v(3.0, 0.0, 0.0)]),
        ([0.0, 1.0, -0.0, -1.0], 4.0, PairFeature::VertexVertex([1, 3]))
    );
    // A triangle without area, its corners in any order on a line.
    assert_eq!(
        of(PairKind::VertexTriangle, [v(0.5, 3.0, 0.0), o, v(2.0, 0.0, 0.0), v(1.0, 0.0, 0.0)]),
        ([1.0, -0.75, -0.25, 0.0], 9.0, PairFeature::VertexEdge(0, [1, 2]))
    );
    // Squares of the differences underflow: no NaN, and weights of K.
    let tiny = closest(PairKind::EdgeEdge, &[o, v(1e-200, 0.0, 0.0), v(0.0, 1e-200, 0.0), v(0.0, 1e-200, 1e-200)]);
    assert_eq!(tiny.distance_squared, 0.0);
    assert!(tiny.weights.iter().all(|c| c.is_finite()));
}
