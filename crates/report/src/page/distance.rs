//! Distances between bodies before a run, for scenes whose contact has no gap yet.

use nalgebra::Vector3;
use stoss_geometry::{Aabb, BoundingVolumeTree, Patch};

use super::shape::Connectivity;
use crate::vtu::{Array, Grid};

/// Name of the array.
pub const NAME: &str = "distance_to_other_bodies";
/// Cosine of the angle to the outward normal below which a point is inside of what it is near to.
const INSIDE: f64 = -0.5;
/// Where a body is near, in longest sides of facets: a facet has a colour where all of its corners have a distance.
const REACH: f64 = 2.0;

/// Distance of the surface nodes of each body to the nearest facet of another one in the reference configuration (a length), negative inside of it; not a number farther away than
/// [`REACH`] times the longest side of a facet. Nothing where no node is that near.
pub fn distances(grid: &Grid) -> Option<Array> {
    let shape = Connectivity::new(grid, &[], false);
    let place = |node: u32| Vector3::from(grid.points[shape.nodes[node as usize]]);
    let mut owner = Vec::new();
    let mut patches = Vec::new();
    let mut reach = 0.0_f64;
    for (number, body) in shape.bodies.iter().enumerate() {
        for &[a, b, c, d] in &shape.facets[body.facets[0]..body.facets[0] + body.facets[1]] {
            let [p, q, r, s] = [a, b, c, d].map(place);
            reach = [q - p, r - q, s - r, p - s].iter().fold(reach, |reach, side| reach.max(side.norm()));
            patches.push(if c == d { Patch::new([p, q, r]) } else { Patch::new([p, q, r, s]) });
            owner.push(number);
        }
    }
    reach *= REACH;
    let boxes: Vec<Aabb> = patches.iter().map(|patch| Aabb::from_points(patch.corners.iter())).collect();
    let tree = BoundingVolumeTree::build(&boxes);
    let mut values = vec![f64::NAN; grid.points.len()];
    for (number, body) in shape.bodies.iter().enumerate() {
        for &node in shape.facets[body.facets[0]..body.facets[0] + body.facets[1]].as_flattened() {
            let value = &mut values[shape.nodes[node as usize]];
            if !value.is_nan() {
                continue;
            }
            let x = place(node);
            let mut found = None;
            tree.nearest(&x, reach, |item, bound| {
                if owner[item] == number {
                    return bound;
                }
                let near = patches[item].closest_point(&x);
                let distance = near.distance_squared.sqrt();
                if distance > bound || (distance == bound && found.is_some()) {
                    return bound;
                }
                let is_inside = (x - near.point).dot(&patches[item].normal(near.xi)) < INSIDE * distance;
                found = Some(if is_inside { -distance } else { distance });
                distance
            });
            *value = found.unwrap_or(f64::NAN);
        }
    }
    values.iter().any(|value| value.is_finite()).then_some(Array { components: 1, values })
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_mesh::Elements;

    /// Two cubes above each other, of sides one, the upper one from a height on; a third one far away.
    fn cubes(height: f64) -> Grid {
        let mut points = Vec::new();
        for (x, z) in [(0.0, 0.0), (0.25, height), (9.0, 0.0)] {
            points.extend(crate::vtu::tests::CUBE.map(|[a, b, c]| [a + x, b + x, c + z]));
        }
        let elements = Elements::from([0, 8, 16].map(|first| [0, 1, 2, 3, 4, 5, 6, 7].map(|k| first + k)).to_vec());
        let cell_data = [("body".to_owned(), Array { components: 1, values: vec![0.0, 1.0, 2.0] })].into();
        Grid { points, elements, cell_data, ..Grid::default() }
    }

    #[test]
    fn gaps_and_overlaps_are_signed_and_far_bodies_have_none() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        for height in [1.25, 0.9] {
            let values = distances(&cubes(height)).unwrap().values;
            // A lower node of the upper cube is above the top of the lower one, or below it, and so is an upper node of that.
            assert!(near(values[8], height - 1.0) && near(values[6], height - 1.0), "{values:?}");
            assert!(values[16..].iter().all(|value| value.is_nan()));
        }
        // Beside the lower cube, not above it.
        let values = distances(&cubes(1.25)).unwrap().values;
        assert!(near(values[9], 0.25_f64.hypot(0.25)));
        assert_eq!(distances(&cubes(7.0)), None);
    }
}
