//! Which hexahedra hold a point, and where in them it is.

use nalgebra::{Matrix3, Vector3};
use stoss_geometry::{Aabb, BoundingVolumeTree};
use stoss_reference_element::hex8;

/// A point belongs to a cell up to this far outside of `[-1, 1]^3`: points on faces and edges are given in rounded numbers.
const TOLERANCE: f64 = 1e-8;
/// Boxes of cells are enlarged by this part of their diagonal, for the same reason.
const MARGIN: f64 = 1e-7;
/// Newton's method converges in five or six iterations where it converges.
const ITERATIONS: usize = 30;
/// Iterates stay within this distance of the origin in each coordinate: roots outside of the cell are not sought.
const REACH: f64 = 2.0;

/// A cell that holds a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Number of the hexahedron.
    pub cell: usize,
    /// Trilinear shape functions of its nodes at the point.
    pub weights: [f64; 8],
}

/// Hexahedra at their places, with a search tree.
#[derive(Clone, Debug)]
pub struct Locator<'a> {
    cells: &'a [[usize; 8]],
    places: &'a [[f64; 3]],
    tree: BoundingVolumeTree,
}

impl<'a> Locator<'a> {
    /// Of cells and the places of all points; cells without finite places hold nothing.
    pub fn new(cells: &'a [[usize; 8]], places: &'a [[f64; 3]]) -> Self {
        let of_cell = |nodes: &[usize; 8]| {
            let corners = nodes.map(|node| Vector3::from(places[node]));
            if !corners.iter().all(|x| x.iter().all(|x| x.is_finite())) {
                return Aabb::empty();
            }
            let around = Aabb::from_points(&corners);
            around.inflated(MARGIN * (around.max - around.min).norm())
        };
        let boxes: Vec<Aabb> = cells.iter().map(of_cell).collect();
        Self { cells, places, tree: BoundingVolumeTree::build(&boxes) }
    }

    /// All cells that hold the point, by rising number.
    pub fn find(&self, x: [f64; 3], found: &mut Vec<Held>) {
        found.clear();
        let x = Vector3::from(x);
        let point = Aabb { min: x, max: x };
        self.tree.query(&point, |cell| {
            let corners = self.cells[cell].map(|node| Vector3::from(self.places[node]));
            found.extend(coordinates(&corners, x).map(|xi| Held { cell, weights: hex8::shape(xi) }));
        });
        found.sort_unstable_by_key(|held| held.cell);
    }
}

/// Natural coordinates of `x` in a trilinear cell, if it is inside: Newton's method for `sum N_I(xi) X_I = x` from the middle, and if that
/// finds nothing inside, from the points half way to the nodes.
fn coordinates(corners: &[Vector3<f64>; 8], x: Vector3<f64>) -> Option<[f64; 3]> {
    let starts = std::iter::once([0.0; 3]).chain(hex8::VERTICES.map(|vertex| vertex.map(|xi| 0.5 * xi)));
    starts.filter_map(|start| newton(corners, x, start)).find(|xi| xi.iter().all(|xi| xi.abs() <= 1.0 + TOLERANCE))
}

fn newton(corners: &[Vector3<f64>; 8], x: Vector3<f64>, start: [f64; 3]) -> Option<[f64; 3]> {
    let mut xi = start;
    for _ in 0..ITERATIONS {
        let (shape, gradient) = (hex8::shape(xi), hex8::shape_gradient(xi));
        let mut residual = -x;
        let mut jacobian = Matrix3::zeros();
        for (k, corner) in corners.iter().enumerate() {
            residual += shape[k] * corner;
            jacobian += corner * nalgebra::RowVector3::from(gradient[k]);
        }
        let step = jacobian.try_inverse()? * residual;
        for (xi, step) in xi.iter_mut().zip(step.iter()) {
            *xi = (*xi - step).clamp(-REACH, REACH);
        }
        // The error after a step is of the order of the square of the step.
        if step.amax() < 1e-10 {
            return Some(xi);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A point made of its natural coordinates in a distorted cell is found there, one beyond a face is not.
        #[test]
        fn coordinates_are_found_again(
            shift in prop::collection::vec(prop::array::uniform3(-0.25..0.25_f64), 8),
            xi in prop::array::uniform3(-1.0..1.0_f64),
            axis in 0..3_usize,
        ) {
            let corners: [Vector3<f64>; 8] =
                std::array::from_fn(|k| Vector3::from(hex8::VERTICES[k]) + Vector3::from(shift[k]));
            let at = |xi: [f64; 3]| -> Vector3<f64> {
                hex8::shape(xi).iter().zip(&corners).map(|(n, x)| *n * x).sum()
            };
            let found = coordinates(&corners, at(xi)).unwrap();
            prop_assert!((0..3).all(|i| (found[i] - xi[i]).abs() < 1e-12), "{found:?} {xi:?}");
            let mut outside = xi;
            outside[axis] = 1.0_f64.copysign(xi[axis]) * 1.001;
            prop_assert_eq!(coordinates(&corners, at(outside)), None);
        }
    }

    #[test]
    fn a_point_on_a_common_face_is_in_both_cells() {
        let places: Vec<[f64; 3]> = [0.0, 1.0, 2.0]
            .into_iter()
            .flat_map(|z| [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]])
            .chain([[f64::NAN; 3]])
            .collect();
        let cells = [[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11], [0, 1, 2, 3, 4, 5, 6, 12]];
        let locator = Locator::new(&cells, &places);
        let mut found = Vec::new();
        for (x, expected) in [
            ([0.3, 0.4, 1.0], &[0, 1][..]),
            ([0.3, 0.4, 1.2], &[1]),
            ([0.3, 0.0, 0.2], &[0]),
            ([0.3, -1e-6, 0.2], &[]),
            ([f64::NAN, 0.5, 0.5], &[]),
        ] {
            locator.find(x, &mut found);
            assert_eq!(found.iter().map(|held| held.cell).collect::<Vec<_>>(), expected, "{x:?}");
        }
    }
}
