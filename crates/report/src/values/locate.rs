//! Which elements hold a point, and where in them it is.

use nalgebra::{Matrix3, Vector3};
use stoss_geometry::{Aabb, BoundingVolumeTree};
use stoss_mesh::Elements;
use stoss_reference_element::{CellKind, ShapeFunctions};

/// A point belongs to a cell up to this far outside, in halves of an edge: points on faces and edges are given in rounded numbers.
const TOLERANCE: f64 = 1e-8;
/// Boxes of cells are enlarged by this part of their diagonal, for the same reason.
const MARGIN: f64 = 1e-7;
/// Boxes of quadratic elements are enlarged by this part.
const BULGE: f64 = 0.25;
/// Newton's method converges in five or six iterations where it converges.
const ITERATIONS: usize = 30;
/// Iterates stay within this distance of the centre in each coordinate: roots outside of the cell are not sought.
const REACH: f64 = 2.0;

/// A cell that holds a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Number of the element.
    pub cell: usize,
    /// Natural coordinates of the point.
    pub xi: [f64; 3],
    /// Shape functions of its nodes at the point, zero beyond them.
    pub weights: ShapeFunctions,
}

/// Elements at their places, with a search tree.
#[derive(Clone, Debug)]
pub struct Locator<'a> {
    elements: &'a Elements,
    places: &'a [[f64; 3]],
    tree: BoundingVolumeTree,
}

impl<'a> Locator<'a> {
    /// A locator of these elements, from the places of all points; elements without finite places hold nothing.
    pub fn new(elements: &'a Elements, places: &'a [[f64; 3]]) -> Self {
        let of_element = |nodes: &[u32]| {
            let corners: Vec<_> = nodes.iter().map(|&node| Vector3::from(places[node as usize])).collect();
            if !corners.iter().all(|x| x.iter().all(|x| x.is_finite())) {
                return Aabb::empty();
            }
            // Curved edges may bulge out of the box of the nodes by less than half of it.
            let around = Aabb::from_points(&corners);
            let margin = if nodes.len() > 8 { BULGE } else { MARGIN };
            around.inflated(margin * (around.max - around.min).norm())
        };
        let boxes: Vec<Aabb> = elements.iter().map(of_element).collect();
        Self { elements, places, tree: BoundingVolumeTree::build(&boxes) }
    }

    /// All elements that hold the point, by rising number.
    pub fn find(&self, x: [f64; 3], found: &mut Vec<Held>) {
        found.clear();
        let x = Vector3::from(x);
        let point = Aabb { min: x, max: x };
        let mut corners = Vec::new();
        self.tree.query(&point, |cell| {
            corners.clear();
            corners.extend(self.elements[cell].iter().map(|&node| Vector3::from(self.places[node as usize])));
            let kind = self.elements.kind(cell);
            found.extend(coordinates(kind, &corners, x).map(|xi| Held { cell, xi, weights: (kind.table().shape)(xi) }));
        });
        found.sort_unstable_by_key(|held| held.cell);
    }
}

/// Natural coordinates of `x` in an element, if it is inside: Newton's method for `sum N_I(xi) X_I = x` from the centre, and if that
/// finds nothing inside, from the points half way to the nodes.
fn coordinates(kind: CellKind, corners: &[Vector3<f64>], x: Vector3<f64>) -> Option<[f64; 3]> {
    let table = kind.table();
    let centre = table.family.centre();
    let half_way = |node: &[f64; 3]| std::array::from_fn(|i| 0.5 * (centre[i] + node[i]));
    let starts = std::iter::once(centre).chain(table.nodes.iter().map(half_way));
    starts.filter_map(|start| newton(kind, corners, x, start)).find(|xi| table.family.excess(*xi) <= TOLERANCE)
}

fn newton(kind: CellKind, corners: &[Vector3<f64>], x: Vector3<f64>, start: [f64; 3]) -> Option<[f64; 3]> {
    let (table, centre) = (kind.table(), kind.table().family.centre());
    let mut xi = start;
    for _ in 0..ITERATIONS {
        let (shape, gradient) = ((table.shape)(xi), (table.shape_gradient)(xi));
        let mut residual = -x;
        let mut jacobian = Matrix3::zeros();
        for (k, corner) in corners.iter().enumerate() {
            residual += shape[k] * corner;
            jacobian += corner * nalgebra::RowVector3::from(gradient[k]);
        }
        let step = jacobian.try_inverse()? * residual;
        for i in 0..3 {
            xi[i] = (xi[i] - step[i]).clamp(centre[i] - REACH, centre[i] + REACH);
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
        /// A point made of its natural coordinates in a distorted element is found there, one beyond a face is not.
        #[test]
        fn coordinates_are_found_again(
            shift in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 27),
            xi in prop::array::uniform3(-1.0..1.0_f64),
            axis in 0..3_usize,
        ) {
            for kind in CellKind::ALL {
                let table = kind.table();
                // A natural coordinate has a smaller range in a simplex; nodes on edges move less.
                let size = if kind.is_quadratic() { 0.03 } else if kind == CellKind::Hex8 { 0.25 } else { 0.1 };
                let corners: Vec<Vector3<f64>> =
                    table.nodes.iter().zip(&shift).map(|(x, s)| Vector3::from(*x) + size * Vector3::from(*s)).collect();
                let at = |xi: [f64; 3]| -> Vector3<f64> {
                    (table.shape)(xi).iter().zip(&corners).map(|(n, x)| *n * x).sum()
                };
                let centre = table.family.centre();
                let inside = |part: f64| std::array::from_fn(|i| centre[i] + part * (table.nodes[axis][i] + xi[i] * (table.nodes[axis + 1][i] - table.nodes[axis][i]) - centre[i]));
                let inner: [f64; 3] = if kind == CellKind::Hex8 { xi } else { inside(0.5) };
                prop_assume!(table.family.excess(inner) < 0.0);
                let found = coordinates(kind, &corners, at(inner)).unwrap();
                prop_assert!((0..3).all(|i| (found[i] - inner[i]).abs() < 1e-12), "{kind}: {found:?} {inner:?}");
                // Beyond the boundary on the ray from the centre.
                let mut part = 1.0;
                let ray = |part: f64| -> [f64; 3] { std::array::from_fn(|i| centre[i] + part * (inner[i] - centre[i])) };
                while table.family.excess(ray(part)) < 1e-3 && part < 100.0 {
                    part *= 1.01;
                }
                if part < 100.0 {
                    prop_assert_eq!(coordinates(kind, &corners, at(ray(part))), None);
                }
            }
        }
    }

    #[test]
    fn a_point_on_a_common_face_is_in_both_cells() {
        let places: Vec<[f64; 3]> = [0.0, 1.0, 2.0]
            .into_iter()
            .flat_map(|z| [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]])
            .chain([[f64::NAN; 3]])
            .collect();
        let cells = vec![[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11], [0, 1, 2, 3, 4, 5, 6, 12]];
        let elements = cells.into();
        let locator = Locator::new(&elements, &places);
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
