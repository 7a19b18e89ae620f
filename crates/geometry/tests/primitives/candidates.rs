//! Candidates against all pairs.

use nalgebra::Vector3;
use proptest::prelude::*;
use stoss_geometry::{Aabb, CandidatePair, CandidateSearch, PairKind, closest, edges_of};

/// Triangles of a soup with common points, and two states of the points.
#[derive(Clone, Debug)]
struct Soup {
    triangles: Vec<[u32; 3]>,
    start: Vec<Vector3<f64>>,
    end: Vec<Vector3<f64>>,
}

fn soup() -> impl Strategy<Value = Soup> {
    let state = || proptest::collection::vec(proptest::array::uniform3(-2.0..2.0f64).prop_map(Vector3::from), 30);
    let triangle = (0..30u32, 0..30u32, 0..30u32)
        .prop_filter("three points", |(a, b, c)| a != b && b != c && a != c)
        .prop_map(|(a, b, c)| [a, b, c]);
    (proptest::collection::hash_set(triangle, 0..60), state(), state(), 0.0..1.0f64).prop_map(
        |(triangles, start, other, motion)| {
            let end = start.iter().zip(&other).map(|(a, b)| a + (b - a) * motion).collect();
            let mut triangles: Vec<[u32; 3]> = triangles.into_iter().collect();
            triangles.sort_unstable();
            Soup { triangles, start, end }
        },
    )
}

fn points(soup: &Soup) -> Vec<u32> {
    let mut points: Vec<u32> = soup.triangles.iter().flatten().copied().collect();
    points.sort_unstable();
    points.dedup();
    points
}

fn search(soup: &Soup) -> CandidateSearch {
    CandidateSearch::new(points(soup), edges_of(&soup.triangles), soup.triangles.clone())
}

/// Every pair without common points, sorted.
fn all_pairs(soup: &Soup) -> Vec<CandidatePair> {
    let edges = edges_of(&soup.triangles);
    let mut pairs = Vec::new();
    for (v, p) in points(soup).into_iter().enumerate() {
        for (k, t) in soup.triangles.iter().enumerate().filter(|(_, t)| !t.contains(&p)) {
            let (points, primitives) = ([p, t[0], t[1], t[2]], [v as u32, k as u32]);
            pairs.push(CandidatePair { kind: PairKind::VertexTriangle, points, primitives });
        }
    }
    for (k, e) in edges.iter().enumerate() {
        for (l, f) in edges.iter().enumerate().skip(k + 1).filter(|(_, f)| !f.contains(&e[0]) && !f.contains(&e[1])) {
            let (points, primitives) = ([e[0], e[1], f[0], f[1]], [k as u32, l as u32]);
            pairs.push(CandidatePair { kind: PairKind::EdgeEdge, points, primitives });
        }
    }
    pairs.sort_unstable();
    pairs
}

fn brute_force(soup: &Soup, box_of: impl Fn(u32) -> Aabb) -> Vec<CandidatePair> {
    let overlap = |pair: &CandidatePair| {
        let first = pair.kind.first_count();
        let around = |points: &[u32]| points.iter().fold(Aabb::empty(), |b, &p| b.union(&box_of(p)));
        around(&pair.points[..first]).overlaps(&around(&pair.points[first..]))
    };
    all_pairs(soup).into_iter().filter(overlap).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn candidates_are_those_of_brute_force(soup in soup(), distance in 0.0..0.5f64, seed in 0..1000usize) {
        let moving = |p: u32| Aabb::swept(&soup.start[p as usize], &soup.end[p as usize], 0.5 * distance);
        let still = |p: u32| Aabb::swept(&soup.end[p as usize], &soup.end[p as usize], 0.5 * distance);
        let mut search = search(&soup);
        let mut found = vec![CandidatePair { kind: PairKind::VertexVertex, points: [0; 4], primitives: [0; 2] }];
        search.find(moving, |_| true, &mut found);
        prop_assert_eq!(&found, &brute_force(&soup, moving));
        let swept = found.clone();

        // A second state, in the tree of the first one and in a new one.
        search.find(still, |_| true, &mut found);
        prop_assert_eq!(&found, &brute_force(&soup, still));
        search.rebuild();
        let mut again = Vec::new();
        search.find(still, |_| true, &mut again);
        prop_assert_eq!(&found, &again);

        // The lists in another order, and a condition of the caller.
        let turned = |mut list: Vec<[u32; 3]>| { if !list.is_empty() { let n = seed % list.len(); list.rotate_left(n) } list };
        let mut edges = edges_of(&soup.triangles);
        edges.reverse();
        let admits = |pair: &CandidatePair| pair.points.iter().sum::<u32>() % 3 != 0;
        let mut vertices = points(&soup);
        vertices.reverse();
        CandidateSearch::new(vertices, edges, turned(soup.triangles.clone())).find(moving, admits, &mut again);
        // Places in the lists are others, the pairs are the same.
        let pairs = |list: &[CandidatePair]| list.iter().map(|pair| (pair.kind, pair.points)).collect::<Vec<_>>();
        let expected: Vec<_> = swept.into_iter().filter(admits).collect();
        prop_assert_eq!(pairs(&expected), pairs(&again));
    }

    #[test]
    fn nothing_near_is_missed(soup in soup(), distance in 0.0..0.5f64) {
        let moving = |p: u32| Aabb::swept(&soup.start[p as usize], &soup.end[p as usize], 0.5 * distance);
        let mut found = Vec::new();
        search(&soup).find(moving, |_| true, &mut found);
        for pair in all_pairs(&soup) {
            for t in [0.0, 0.2, 0.5, 0.9, 1.0] {
                let at = |p: u32| soup.start[p as usize] * (1.0 - t) + soup.end[p as usize] * t;
                if closest(pair.kind, &pair.points.map(at)).distance_squared.sqrt() < distance - 1e-12 {
                    prop_assert!(found.binary_search(&pair).is_ok(), "{:?} at {}", pair, t);
                }
            }
        }
    }
}

#[test]
fn edges_of_two_triangles() {
    assert_eq!(edges_of(&[[2, 0, 1], [1, 3, 2]]), [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
    assert!(edges_of(&[]).is_empty());
}

#[test]
fn no_primitives() {
    let mut found = Vec::new();
    CandidateSearch::default().find(|_| Aabb::empty(), |_| true, &mut found);
    assert!(found.is_empty());
}
