//! Whether the bodies of a frame are still bodies, and outside each other; independent of the program's own figures.

use crate::hexahedra;
use crate::vtu::Grid;

type Point = [f64; 3];

/// For every vertex of a hexahedron the ends of its edges, so that their triple product is positive.
const EDGES: [[usize; 3]; 8] = [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]];

/// Convective coordinates of the vertices.
const VERTICES: [Point; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

fn sub(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|i| a[i] - b[i])
}

fn determinant(a: &Point, b: &Point, c: &Point) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// Bodies of a frame: reference and present positions, elements of each body.
#[derive(Clone, Debug)]
pub struct Configuration {
    reference: Vec<Point>,
    present: Vec<Point>,
    elements: Vec<[usize; 8]>,
    body: Vec<usize>,
}

/// Which nodes of the slave body are slave nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// Those with the least reference coordinate z.
    Bottom,
    /// Those with the largest.
    Top,
    /// All.
    All,
}

impl Configuration {
    /// From a frame with displacements.
    pub fn new(grid: &Grid) -> Result<Self, String> {
        let field = grid.point_data.get("displacement").ok_or("no displacement in the frame")?;
        let body = grid.cell_data.get("body").ok_or("no body numbers in the frame")?;
        let present = grid.points.iter().zip(field.values.chunks_exact(3));
        let present = present.map(|(x, u)| std::array::from_fn(|i| x[i] + u[i])).collect();
        let body = body.values.iter().map(|number| *number as usize).collect();
        Ok(Self { reference: grid.points.clone(), present, elements: hexahedra(grid), body })
    }

    /// The least volume ratio at a vertex of an element, `det(dx/dxi) / det(dX/dxi)`: not positive if an element is turned
    /// inside out there, whatever the integration points say.
    pub fn least_vertex_volume(&self) -> f64 {
        let volume = |points: &[Point], element: &[usize; 8], vertex: usize| {
            let edge = |k: usize| sub(&points[element[EDGES[vertex][k]]], &points[element[vertex]]);
            determinant(&edge(0), &edge(1), &edge(2))
        };
        let mut least = f64::INFINITY;
        for element in &self.elements {
            for vertex in 0..8 {
                let ratio = volume(&self.present, element, vertex) / volume(&self.reference, element, vertex);
                // NaN must not be lost.
                least = if ratio < least || ratio.is_nan() { ratio } else { least };
            }
        }
        least
    }

    /// Mean of the nodes' heights z of a body.
    pub fn height(&self, body: usize) -> f64 {
        let nodes = self.nodes(body);
        nodes.iter().map(|&node| self.present[node][2]).sum::<f64>() / nodes.len() as f64
    }

    fn nodes(&self, body: usize) -> Vec<usize> {
        let of_body = self.elements.iter().zip(&self.body).filter(|(_, number)| **number == body);
        let mut nodes: Vec<usize> = of_body.flat_map(|(element, _)| *element).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    fn slave_nodes(&self, body: usize, side: Side) -> Vec<usize> {
        let mut nodes = self.nodes(body);
        let heights = || nodes.iter().map(|&node| self.reference[node][2]);
        let (least, largest) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
        let tolerance = 1e-9 * (largest - least);
        nodes.retain(|&node| match side {
            Side::Bottom => self.reference[node][2] <= least + tolerance,
            Side::Top => self.reference[node][2] >= largest - tolerance,
            Side::All => true,
        });
        nodes
    }

    /// How deep the deepest slave node is inside an element of the master body: 0 on its surface or outside, 1 in its middle.
    pub fn penetration(&self, slave: usize, side: Side, master: usize) -> f64 {
        let mut deepest = 0.0_f64;
        for node in self.slave_nodes(slave, side) {
            let x = &self.present[node];
            for element in self.elements.iter().zip(&self.body).filter(|(_, body)| **body == master).map(|(e, _)| e) {
                let corners = element.map(|node| self.present[node]);
                let outside = (0..3).any(|i| {
                    let range = corners.iter().map(|corner| corner[i]);
                    x[i] < range.clone().fold(f64::INFINITY, f64::min) || x[i] > range.fold(f64::NEG_INFINITY, f64::max)
                });
                if !outside && let Some(xi) = inverse(&corners, x) {
                    let margin = 1.0 - xi.iter().fold(0.0_f64, |largest, xi| largest.max(xi.abs()));
                    deepest = deepest.max(margin);
                }
            }
        }
        deepest
    }
}

/// Convective coordinates of a point in a hexahedron by Newton's method; nothing if it does not converge.
fn inverse(corners: &[Point; 8], x: &Point) -> Option<Point> {
    let mut xi = [0.0; 3];
    for _ in 0..30 {
        let (mut residual, mut columns) = (*x, [[0.0; 3]; 3]);
        for (corner, vertex) in corners.iter().zip(&VERTICES) {
            let factor: Point = std::array::from_fn(|i| 1.0 + vertex[i] * xi[i]);
            for i in 0..3 {
                residual[i] -= 0.125 * factor[0] * factor[1] * factor[2] * corner[i];
                columns[0][i] += 0.125 * vertex[0] * factor[1] * factor[2] * corner[i];
                columns[1][i] += 0.125 * vertex[1] * factor[0] * factor[2] * corner[i];
                columns[2][i] += 0.125 * vertex[2] * factor[0] * factor[1] * corner[i];
            }
        }
        let [a, b, c] = &columns;
        let det = determinant(a, b, c);
        let step = [determinant(&residual, b, c), determinant(a, &residual, c), determinant(a, b, &residual)];
        let step = step.map(|numerator| numerator / det);
        (0..3).for_each(|i| xi[i] += step[i]);
        let size = step.iter().fold(0.0_f64, |largest, step| largest.max(step.abs()));
        if !(size.is_finite() && xi.iter().all(|xi| xi.abs() < 1e3)) {
            return None;
        }
        if size < 1e-10 {
            return Some(xi);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unit cubes, the second with its lower corner at `at`.
    fn two(at: Point) -> Configuration {
        let cube = |at: Point| VERTICES.map(|v| -> Point { std::array::from_fn(|i| at[i] + 0.5 * (1.0 + v[i])) });
        let points: Vec<Point> = cube([0.0; 3]).into_iter().chain(cube(at)).collect();
        Configuration {
            reference: points.clone(),
            present: points,
            elements: vec![std::array::from_fn(|i| i), std::array::from_fn(|i| i + 8)],
            body: vec![0, 1],
        }
    }

    #[test]
    fn an_undeformed_body_has_volume_one_and_a_folded_one_is_noticed() {
        let mut bodies = two([0.0, 0.0, 2.0]);
        assert!((bodies.least_vertex_volume() - 1.0).abs() < 1e-15);
        // Vertex 0 is pushed through the middle of the cube, along the diagonal.
        bodies.present[0] = [0.9; 3];
        assert!(bodies.least_vertex_volume() < 0.0);
        bodies.present[0] = [f64::NAN; 3];
        assert!(bodies.least_vertex_volume().is_nan());
    }

    #[test]
    fn depth_inside_the_master_is_found() {
        assert_eq!(two([0.25, 0.25, 1.0]).penetration(1, Side::Bottom, 0), 0.0);
        // The bottom nodes are at z = 0.75: 0.25 below the top, which is half of the way to the middle. One of them is inside.
        assert!((two([0.5, 0.5, 0.75]).penetration(1, Side::Bottom, 0) - 0.5).abs() < 1e-9);
        assert_eq!(two([0.5, 0.5, 0.75]).penetration(1, Side::Top, 0), 0.0);
        assert!((two([0.5, 0.5, 0.75]).penetration(0, Side::Top, 1) - 0.5).abs() < 1e-9);
        assert_eq!(two([0.0, 0.0, 4.0]).height(1), 4.5);
    }

    #[test]
    fn the_inverse_map_of_a_skewed_element_is_exact() {
        let skew = |v: &Point| [2.0 * v[0] + 0.3 * v[1] * v[2], v[1] + 0.2 * v[0], 0.5 * v[2] + 0.1 * v[0] * v[1]];
        let corners = VERTICES.map(|v| skew(&v));
        let xi = inverse(&corners, &skew(&[0.2, -0.4, 0.7])).unwrap();
        assert!(xi.iter().zip([0.2, -0.4, 0.7]).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
