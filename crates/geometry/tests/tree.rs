//! The tree against brute force, refit, and degenerate input.

use nalgebra::Vector3;
use proptest::prelude::*;
use stoss_geometry::{Aabb, BoundingVolume, BoundingVolumeTree, MovingBox};

fn boxes(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Aabb>> {
    let corner = proptest::array::uniform3(-5.0..5.0f64);
    let size = proptest::array::uniform3(0.0..1.0f64);
    proptest::collection::vec(
        (corner, size).prop_map(|(c, s)| Aabb { min: Vector3::from(c), max: Vector3::from(c) + Vector3::from(s) }),
        count,
    )
}

fn hits(tree: &BoundingVolumeTree, region: &Aabb) -> Vec<usize> {
    let mut hits = Vec::new();
    tree.query(region, |i| hits.push(i));
    hits
}

fn check_queries(
    tree: &BoundingVolumeTree,
    boxes: &[Aabb],
    region: &Aabb,
    x: &Vector3<f64>,
) -> Result<(), TestCaseError> {
    let found = hits(tree, region);
    prop_assert_eq!(&found, &hits(tree, region));
    let mut sorted = found;
    sorted.sort_unstable();
    let expected: Vec<usize> = (0..boxes.len()).filter(|&i| boxes[i].overlaps(region)).collect();
    prop_assert_eq!(sorted, expected);

    // The nearest centre: an item's true distance is at least that of its box.
    let distance = |i: usize| (boxes[i].centre() - x).norm();
    let mut best = None;
    tree.nearest(x, f64::INFINITY, |i, bound| {
        if distance(i) < bound {
            best = Some(i);
        }
        bound.min(distance(i))
    });
    let expected = (0..boxes.len()).min_by(|&i, &j| distance(i).total_cmp(&distance(j)));
    prop_assert_eq!(best.map(distance), expected.map(distance));
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn queries_agree_with_brute_force(
        first in boxes(0..200), other in boxes(200..201), region in boxes(1..2), x in proptest::array::uniform3(-7.0..7.0f64),
    ) {
        let x = Vector3::from(x);
        let mut tree = BoundingVolumeTree::build(&first);
        prop_assert_eq!(tree.len(), first.len());
        check_queries(&tree, &first, &region[0].inflated(0.7), &x)?;
        let moved = &other[..first.len()];
        tree.refit(|i| moved[i]);
        check_queries(&tree, moved, &region[0].inflated(0.7), &x)?;
        prop_assert!(moved.iter().all(|b| b.union(&tree.bounds()) == tree.bounds()));
    }

    #[test]
    fn a_finite_bound_limits_the_search(list in boxes(1..100), x in proptest::array::uniform3(-7.0..7.0f64), bound in 0.0..3.0f64) {
        let x = Vector3::from(x);
        let tree = BoundingVolumeTree::build(&list);
        let mut seen = Vec::new();
        let last = tree.nearest(&x, bound, |i, bound| { seen.push(i); bound });
        prop_assert_eq!(last, bound);
        seen.sort_unstable();
        let expected: Vec<usize> = (0..list.len()).filter(|&i| list[i].distance_squared(&x) <= bound * bound).collect();
        prop_assert_eq!(seen, expected);
    }
}

/// Boxes around points that fly, mostly together.
fn moving(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<MovingBox>> {
    let point = (proptest::array::uniform3(-5.0..5.0f64), proptest::array::uniform3(-0.5..0.5f64), 0.0..0.5f64);
    let moving = |(start, motion, size): ([f64; 3], [f64; 3], f64)| {
        MovingBox::new(&Vector3::from(start), &(Vector3::from(motion) + Vector3::new(50.0, -20.0, 10.0)), size)
    };
    proptest::collection::vec(point.prop_map(moving), count)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Pairs of two trees and of one with itself are those of brute force, and what comes together is among them.
    #[test]
    fn pairs_agree_with_brute_force(first in moving(0..120), second in moving(0..120)) {
        let (a, b) = (BoundingVolumeTree::build(&first), BoundingVolumeTree::build(&second));
        let mut found = Vec::new();
        a.pairs(&b, &mut |i, j| found.push((i, j)));
        found.sort_unstable();
        let all = (0..first.len()).flat_map(|i| (0..second.len()).map(move |j| (i, j)));
        let expected: Vec<_> = all.filter(|&(i, j)| first[i].overlaps(&second[j])).collect();
        prop_assert_eq!(&found, &expected);

        let mut own = Vec::new();
        a.own_pairs(&mut |i, j| own.push((i.min(j), i.max(j))));
        own.sort_unstable();
        let all = (0..first.len()).flat_map(|i| (i..first.len()).map(move |j| (i, j)));
        let expected: Vec<_> = all.filter(|&(i, j)| i == j || first[i].overlaps(&first[j])).collect();
        prop_assert_eq!(own, expected);

        for (i, x) in first.iter().enumerate() {
            for (j, y) in second.iter().enumerate() {
                let meet = [0.0, 0.25, 0.5, 0.75, 1.0].iter().any(|t| {
                    let at = |v: &MovingBox| Aabb { min: v.start.min + v.motion.min * *t, max: v.start.max + v.motion.max * *t };
                    at(x).overlaps(&at(y))
                });
                prop_assert!(!meet || found.binary_search(&(i, j)).is_ok());
            }
        }
    }
}

#[test]
fn what_moves_together_stays_apart() {
    let at = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
    let first = MovingBox::new(&at(0.0, 0.0, 0.0), &at(100.0, -50.0, 20.0), 0.5);
    assert!(!first.overlaps(&MovingBox::new(&at(3.0, 0.0, 0.0), &at(100.0, -50.0, 20.0), 0.5)));
    assert!(first.overlaps(&MovingBox::new(&at(3.0, 0.0, 0.0), &at(97.0, -50.0, 20.0), 0.5)));
    assert!(!first.overlaps(&MovingBox::new(&at(3.0, 0.0, 0.0), &at(103.0, -50.0, 20.0), 0.5)));
    assert!(!first.overlaps(&MovingBox::empty()));
}

#[test]
fn degenerate_input() {
    let unit = Aabb { min: Vector3::zeros(), max: Vector3::repeat(1.0) };
    let mut empty = BoundingVolumeTree::build(&[]);
    empty.refit(|_| unit);
    assert!(empty.is_empty() && hits(&empty, &unit).is_empty());
    assert_eq!(empty.nearest(&Vector3::zeros(), 3.0, |_, _| 0.0), 3.0);
    assert_eq!(empty.bounds(), Aabb::empty());

    assert_eq!(hits(&BoundingVolumeTree::build(&[unit]), &unit), [0]);
    // Identical boxes: no axis splits them, the depth must still be logarithmic.
    let same = BoundingVolumeTree::build(&vec![unit; 5000]);
    let mut found = hits(&same, &unit);
    found.sort_unstable();
    assert_eq!(found, (0..5000).collect::<Vec<_>>());
    assert!(hits(&same, &Aabb { min: Vector3::repeat(2.0), max: Vector3::repeat(3.0) }).is_empty());
}

#[test]
fn nearest_search_visits_few_items() {
    let side = 64;
    let boxes: Vec<Aabb> = (0..side * side)
        .map(|i| {
            let min = Vector3::new((i % side) as f64, (i / side) as f64, 0.0);
            Aabb { min, max: min + Vector3::new(1.0, 1.0, 0.0) }
        })
        .collect();
    let tree = BoundingVolumeTree::build(&boxes);
    let x = Vector3::new(20.3, 41.7, 0.5);
    let mut visits = 0;
    tree.nearest(&x, f64::INFINITY, |i, bound| {
        visits += 1;
        bound.min(boxes[i].distance_squared(&x).sqrt())
    });
    assert!(visits < 40, "{visits} of {}", boxes.len());
}
