//! The check of a skin before the first step: surfaces that cross, and the smallest distances.

use crate::proximity::{Candidate, Proximity};
use crate::{Interactions, Skin};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stoss_geometry::{Aabb, BoundingVolumeTree, closest};

/// Points are known up to this part of their coordinates: placement of bodies and combinations of nodes leave round-off, so points of two bodies at the same place differ by it.
const ROUND_OFF: f64 = 1e-12;

/// The smallest distance of two bodies, or of two parts of a body that are not adjacent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance, a length.
    pub distance: f64,
    /// The two facets.
    pub facets: [u32; 2],
    /// The middle between the closest points.
    pub place: [f64; 3],
}

/// Crossings and small distances of the skin at the start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InitialCheck {
    /// Facets that go through each other, each pair once, with a point near the place: first those of an edge.
    pub crossings: Vec<([u32; 2], [f64; 3])>,
    /// Smallest distances below the reach by pair of bodies, the smaller number first. Of a body with itself only what is no neighbour counts.
    pub nearest: BTreeMap<[u32; 2], Nearest>,
}

/// Looks for crossings, and for distances below `reach`, at the positions `q`.
pub fn check_initial(skin: &Skin, rules: &Interactions, q: &[f64], reach: f64) -> InitialCheck {
    let mut x = Vec::new();
    skin.place(q, &mut x);
    let mut check = InitialCheck { crossings: crossings(skin, rules, &x), ..InitialCheck::default() };
    let mut proximity = Proximity::new(skin, reach);
    proximity.begin(skin, rules, &x, |_| Vector3::zeros());
    let body = |class: u32| rules.body(class);
    for candidate in proximity.candidates.iter().filter(|candidate| !candidate.is_integration_point) {
        let Candidate { classes: [a, b], facets, kind, .. } = candidate;
        let points = candidate.of(&x);
        let pair = closest(*kind, &points);
        let distance = pair.distance_squared.sqrt();
        if distance >= reach {
            continue;
        }
        let (a, b) = (body(*a), body(*b));
        let known = check.nearest.get(&[a.min(b), a.max(b)]).map_or(f64::INFINITY, |nearest| nearest.distance);
        if distance < known {
            let place: Vector3<f64> = points.iter().zip(pair.weights).map(|(x, c)| x * (0.5 * c.abs())).sum();
            let nearest = Nearest { distance, facets: *facets, place: place.into() };
            check.nearest.insert([a.min(b), a.max(b)], nearest);
        }
    }
    check
}

/// Edges that go through triangles.
fn crossings(skin: &Skin, rules: &Interactions, x: &[Vector3<f64>]) -> Vec<([u32; 2], [f64; 3])> {
    let around =
        |points: &[u32]| points.iter().fold(Aabb::empty(), |b, &p| b.union(&Aabb::from_points([&x[p as usize]])));
    let boxes: Vec<Aabb> = skin.triangles().iter().map(|triangle| around(triangle)).collect();
    let tree = BoundingVolumeTree::build(&boxes);
    let class = |facet: u32| skin.facets()[facet as usize].class;
    let mut found = BTreeMap::new();
    for (e, edge) in skin.edges().iter().enumerate() {
        let first = skin.facet_of_edge(e as u32);
        tree.query(&around(edge), |t| {
            let (triangle, second) = (skin.triangles()[t], skin.facet_of_triangle(t as u32));
            if edge.iter().any(|p| triangle.contains(p)) || rules.between(class(first), class(second)).is_none() {
                return;
            }
            let [p, q] = edge.map(|v| x[v as usize]);
            if let Some(place) = crossing([p, q], triangle.map(|v| x[v as usize])) {
                found.entry([first, second]).or_insert(place.into());
            }
        });
    }
    found.into_iter().collect()
}

/// Where an edge goes through the inside of a triangle; `None` if it does not, or only touches it.
fn crossing([p, q]: [Vector3<f64>; 2], [a, b, c]: [Vector3<f64>; 3]) -> Option<Vector3<f64>> {
    // Differences of points are known up to this.
    let length = 2.0 * ROUND_OFF * [p, q, a, b, c].iter().map(Vector3::amax).fold(0.0, f64::max);
    // Six volumes; none where the round-off of the points may have made its sign.
    let volume = |o: Vector3<f64>, r: Vector3<f64>, s: Vector3<f64>, t: Vector3<f64>| {
        let [r, s, t] = [r - o, s - o, t - o];
        let volume = r.cross(&s).dot(&t);
        let [l, m, n] = [r.norm(), s.norm(), t.norm()];
        if volume.abs() <= length * (l * m + m * n + n * l) { 0.0 } else { volume }
    };
    let (before, after) = (volume(a, b, c, p), volume(a, b, c, q));
    if before * after >= 0.0 {
        return None;
    }
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    let inside = sides.iter().all(|v| *v > 0.0) || sides.iter().all(|v| *v < 0.0);
    inside.then(|| p + (q - p) * (before / (before - after)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_cross_touch_or_miss() {
        let triangle = [Vector3::zeros(), Vector3::x(), Vector3::y()];
        let at = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let through = crossing([at(0.2, 0.3, -1.0), at(0.2, 0.3, 3.0)], triangle).unwrap();
        assert!((through - at(0.2, 0.3, 0.0)).norm() < 1e-15);
        for edge in [
            [at(0.2, 0.3, 0.0), at(0.2, 0.3, 3.0)],
            [at(0.7, 0.7, -1.0), at(0.7, 0.7, 1.0)],
            [at(0.2, 0.3, 1e-14), at(0.2, 0.3, -1.0)],
            [at(-1.0, 0.2, 0.0), at(1.0, 0.2, 0.0)],
            [at(0.5, 0.0, -1.0), at(0.5, 0.0, 1.0)],
        ] {
            assert_eq!(crossing(edge, triangle), None, "{edge:?}");
        }
    }

    /// Surfaces that touch with a vertex at the place of another one, but for the round-off of their coordinates: near such a vertex the direction to the other one is anything.
    #[test]
    fn vertices_at_one_place_touch() {
        let far = Vector3::new(40.0, -30.0, 20.0);
        let corners = [Vector3::zeros(), Vector3::x(), Vector3::y()].map(|x| x + far);
        let noise = |k: i32| Vector3::new(1.0, -2.0, 3.0) * (f64::from(k) * f64::EPSILON * 8.0);
        for k in -3..=3 {
            let [a, b, c] = corners;
            for down in [Vector3::new(0.0, 0.0, -1.0), Vector3::new(0.2, 0.1, -1.0), Vector3::new(0.3, 0.3, 1e-3)] {
                let edge = [a + noise(k), a + down];
                assert_eq!(crossing(edge, [a, b, c]), None, "{k} {down}");
                assert_eq!(crossing(edge, [c, a, b]), None, "{k} {down}");
                // The middle of an edge.
                let middle = (b + c) / 2.0;
                assert_eq!(crossing([middle + noise(k), middle + down], [a, b, c]), None, "{k} {down}");
            }
        }
        // What goes in by more is seen.
        let deep = 1e-9;
        let edge = [corners[0] + Vector3::new(0.2, 0.3, deep), corners[0] + Vector3::new(0.2, 0.3, -1.0)];
        assert!(crossing(edge, corners).is_some());
    }
}
