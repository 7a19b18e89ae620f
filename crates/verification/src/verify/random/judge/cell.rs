//! Shape functions of cells, made from the places of their nodes alone, Gauss rules and the inverse map.
//!
//! The functions are the polynomials of the cell that are one at a node and zero at the others: the coefficients are the inverse of the matrix of the
//! monomials at the nodes. Nothing is shared with the elements of the program but the order of the nodes.

use stoss_reference_element::{CellKind, Family};

use super::vector::{cross, dot, norm};

/// Points of Gauss' rule with four points on [0, 1], exact for degree 7, with weights.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Largest number of iterations of the inverse map.
const ITERATIONS: usize = 20;

/// A kind of cell.
#[derive(Debug)]
pub struct Cell {
    /// Kind of the cell.
    pub kind: CellKind,
    monomials: Vec<[i32; 3]>,
    /// Row the monomial, column the node.
    coefficients: Vec<Vec<f64>>,
    /// Shape functions and their gradients at the points of the rule, and the weights.
    rule: Vec<(Vec<f64>, Vec<[f64; 3]>, f64)>,
    /// Gradients of the shape functions at the corners.
    corners: Vec<Vec<[f64; 3]>>,
}

impl Cell {
    /// The functions of a kind.
    pub fn new(kind: CellKind) -> Self {
        let nodes = kind.table().nodes;
        let monomials = monomials(kind);
        let rows = nodes.iter().map(|&xi| monomials.iter().map(|&m| power(xi, m)).collect()).collect();
        let mut cell = Self { kind, monomials, coefficients: inverse(rows), rule: Vec::new(), corners: Vec::new() };
        cell.rule = rule(kind).into_iter().map(|(xi, weight)| (cell.shape(xi), cell.gradient(xi), weight)).collect();
        cell.corners = nodes[..kind.table().corners].iter().map(|&xi| cell.gradient(xi)).collect();
        cell
    }

    /// Values at natural coordinates.
    pub fn shape(&self, xi: [f64; 3]) -> Vec<f64> {
        let powers: Vec<f64> = self.monomials.iter().map(|&m| power(xi, m)).collect();
        (0..powers.len()).map(|node| (0..powers.len()).map(|k| powers[k] * self.coefficients[k][node]).sum()).collect()
    }

    /// Gradients at natural coordinates.
    pub fn gradient(&self, xi: [f64; 3]) -> Vec<[f64; 3]> {
        let powers: Vec<[f64; 3]> = self.monomials.iter().map(|&m| derivative(xi, m)).collect();
        let of = |node: usize, i: usize| (0..powers.len()).map(|k| powers[k][i] * self.coefficients[k][node]).sum();
        (0..powers.len()).map(|node| std::array::from_fn(|i| of(node, i))).collect()
    }

    /// Calls `f` with the shape functions and the volume that belongs to each point of the rule, of nodes at these places.
    pub fn integrate(&self, places: &[[f64; 3]], mut f: impl FnMut(&[f64], f64)) {
        for (shape, gradient, weight) in &self.rule {
            f(shape, weight * determinant(jacobian(gradient, places)));
        }
    }

    /// Integrates over a face: calls `f` with the shape functions of the cell and the area that belongs to each point.
    pub fn integrate_face(&self, face: usize, places: &[[f64; 3]], mut f: impl FnMut(&[f64], f64)) {
        let table = self.kind.table();
        let corners: Vec<[f64; 3]> = table.faces[face].nodes[..table.faces[face].kind.corner_count()]
            .iter()
            .map(|&node| table.nodes[node as usize])
            .collect();
        let mix = |weights: [f64; 4]| -> [f64; 3] {
            std::array::from_fn(|i| corners.iter().zip(weights).map(|(c, w)| w * c[i]).sum())
        };
        let is_triangle = corners.len() == 3;
        for (u, a) in GAUSS {
            for (v, b) in GAUSS {
                // Points of the face in the cell, and how they move with two coordinates of the face.
                let (xi, along, weight) = if is_triangle {
                    let w = v * (1.0 - u);
                    let along = [mix([-1.0, 1.0, 0.0, 0.0]), mix([-1.0, 0.0, 1.0, 0.0])];
                    (mix([1.0 - u - w, u, w, 0.0]), along, a * b * (1.0 - u))
                } else {
                    let along = [mix([v - 1.0, 1.0 - v, v, -v]), mix([u - 1.0, -u, u, 1.0 - u])];
                    (mix([(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v]), along, a * b)
                };
                let j = jacobian(&self.gradient(xi), places);
                let [s, t] = along.map(|d| j.map(|row| dot(row, d)));
                f(&self.shape(xi), weight * norm(cross(s, t)));
            }
        }
    }

    /// Smallest and largest Jacobian determinant at the points of the rule and at the corners.
    pub fn determinants(&self, places: &[[f64; 3]]) -> [f64; 2] {
        let points = self.rule.iter().map(|(_, gradient, _)| gradient).chain(&self.corners);
        points.map(|gradient| determinant(jacobian(gradient, places))).fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[low, high], det| {
                if det.is_nan() { [f64::NAN; 2] } else { [low.min(det), high.max(det)] }
            },
        )
    }

    /// Whether a point is inside a cell whose nodes are at these places, by Newton's method on the map.
    pub fn contains(&self, places: &[[f64; 3]], point: [f64; 3]) -> bool {
        let family = self.kind.table().family;
        let mut xi = family.centre();
        for _ in 0..ITERATIONS {
            let shape = self.shape(xi);
            let off: [f64; 3] =
                std::array::from_fn(|i| point[i] - shape.iter().zip(places).map(|(n, x)| n * x[i]).sum::<f64>());
            let Some(step) = solve(jacobian(&self.gradient(xi), places), off) else { return false };
            for i in 0..3 {
                xi[i] = (xi[i] + step[i]).clamp(-3.0, 3.0);
            }
            if step.iter().all(|s| s.abs() < 1e-12) {
                return family.excess(xi) <= 0.0;
            }
        }
        false
    }
}

/// Exponents of the polynomials of a cell.
fn monomials(kind: CellKind) -> Vec<[i32; 3]> {
    let all = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9]);
    let squares = |m: &[i32; 3]| m.iter().filter(|&&e| e == 2).count();
    all.filter(|m| {
        let (flat, total) = (m[0] + m[1], m.iter().sum::<i32>());
        match kind {
            CellKind::Hex8 => squares(m) == 0,
            CellKind::Hex20 => squares(m) <= 1,
            CellKind::Hex27 => true,
            CellKind::Tet4 => total <= 1,
            CellKind::Tet10 => total <= 2,
            CellKind::Wedge6 => flat <= 1 && m[2] <= 1,
            CellKind::Wedge15 => (flat <= 2 && m[2] <= 1) || (flat <= 1 && m[2] == 2),
        }
    })
    .collect()
}

fn power(xi: [f64; 3], m: [i32; 3]) -> f64 {
    (0..3).map(|i| xi[i].powi(m[i])).product()
}

fn derivative(xi: [f64; 3], m: [i32; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        if m[i] == 0 {
            return 0.0;
        }
        let mut lower = m;
        lower[i] -= 1;
        f64::from(m[i]) * power(xi, lower)
    })
}

/// Tensor products of Gauss' rule, collapsed for triangles and tetrahedra.
fn rule(kind: CellKind) -> Vec<([f64; 3], f64)> {
    let mut all = Vec::new();
    for (u, a) in GAUSS {
        for (v, b) in GAUSS {
            for (w, c) in GAUSS {
                let weight = a * b * c;
                all.push(match kind.table().family {
                    Family::Hexahedron => ([u, v, w].map(|x| 2.0 * x - 1.0), 8.0 * weight),
                    Family::Tetrahedron => {
                        ([u, v * (1.0 - u), w * (1.0 - u) * (1.0 - v)], weight * (1.0 - u).powi(2) * (1.0 - v))
                    }
                    Family::Wedge => ([u, v * (1.0 - u), 2.0 * w - 1.0], 2.0 * weight * (1.0 - u)),
                });
            }
        }
    }
    all
}

/// Derivatives of the place (row) by the natural coordinates (column).
fn jacobian(gradient: &[[f64; 3]], places: &[[f64; 3]]) -> [[f64; 3]; 3] {
    let mut j = [[0.0; 3]; 3];
    for (g, x) in gradient.iter().zip(places) {
        for i in 0..3 {
            for k in 0..3 {
                j[i][k] += x[i] * g[k];
            }
        }
    }
    j
}

/// Determinant.
pub fn determinant(m: [[f64; 3]; 3]) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

/// Cramer's rule; `None` if the matrix is singular.
pub fn solve(m: [[f64; 3]; 3], b: [f64; 3]) -> Option<[f64; 3]> {
    let det = determinant(m);
    if det == 0.0 || !det.is_finite() {
        return None;
    }
    Some(std::array::from_fn(|column| {
        let mut with = m;
        for row in 0..3 {
            with[row][column] = b[row];
        }
        determinant(with) / det
    }))
}

/// Inverse by Gauss-Jordan elimination with row exchange. The matrix of a cell is regular.
fn inverse(mut a: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = a.len();
    for (i, row) in a.iter_mut().enumerate() {
        row.extend((0..n).map(|k| f64::from(u8::from(k == i))));
    }
    for i in 0..n {
        let largest = (i..n).max_by(|&r, &s| a[r][i].abs().total_cmp(&a[s][i].abs())).unwrap_or(i);
        a.swap(i, largest);
        let pivot = a[i][i];
        a[i].iter_mut().for_each(|x| *x /= pivot);
        let row = a[i].clone();
        for (r, other) in a.iter_mut().enumerate().filter(|(r, _)| *r != i) {
            let factor = other[i];
            debug_assert!(r < n);
            other.iter_mut().zip(&row).for_each(|(x, y)| *x -= factor * y);
        }
    }
    a.into_iter().map(|row| row[n..].to_vec()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_one_at_their_node_and_add_up_to_one() {
        for kind in CellKind::ALL {
            let cell = Cell::new(kind);
            assert_eq!(cell.monomials.len(), kind.node_count());
            for (node, &xi) in kind.table().nodes.iter().enumerate() {
                for (k, value) in cell.shape(xi).into_iter().enumerate() {
                    assert!((value - f64::from(u8::from(k == node))).abs() < 1e-12, "{kind:?}");
                }
            }
            let xi = [0.2, 0.1, 0.3];
            assert!((cell.shape(xi).iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    /// The cell itself is its own picture: volume, centre, second moment of the hexahedron.
    #[test]
    fn rules_measure_volumes_and_points_are_found_inside() {
        for kind in CellKind::ALL {
            let cell = Cell::new(kind);
            let places = kind.table().nodes;
            let (mut volume, mut centre, mut second) = (0.0, [0.0; 3], 0.0);
            cell.integrate(places, |shape, part| {
                volume += part;
                let x: [f64; 3] = std::array::from_fn(|i| shape.iter().zip(places).map(|(n, x)| n * x[i]).sum());
                (0..3).for_each(|i| centre[i] += part * x[i]);
                second += part * x[2] * x[2];
            });
            let family = kind.table().family;
            assert!((volume - family.volume()).abs() < 1e-12, "{kind:?} {volume}");
            assert!((0..3).all(|i| (centre[i] / volume - family.centre()[i]).abs() < 1e-12), "{kind:?}");
            let exact = match family {
                Family::Hexahedron => 8.0 / 3.0,
                Family::Tetrahedron => 1.0 / 60.0,
                Family::Wedge => 1.0 / 3.0,
            };
            assert!((second - exact).abs() < 1e-12, "{kind:?} {second}");
            assert!(cell.contains(places, family.centre()) && !cell.contains(places, [1.01, 0.3, 0.2]));
            assert!(cell.determinants(places)[0] > 0.0);
            // The divergence theorem: the integral of x . n over the surface of a cell that holds its centre is three volumes.
            let mut flux = 0.0;
            for (k, face) in kind.table().faces.iter().enumerate() {
                let corner = |i: usize| places[face.nodes[i] as usize];
                let edge = |i: usize| super::super::vector::minus(corner(i), corner(0));
                let normal = cross(edge(1), edge(2));
                cell.integrate_face(k, places, |shape, area| {
                    let x: [f64; 3] = std::array::from_fn(|i| shape.iter().zip(places).map(|(n, x)| n * x[i]).sum());
                    flux += area * dot(x, normal) / norm(normal);
                });
            }
            assert!((flux - 3.0 * family.volume()).abs() < 1e-12, "{kind:?} {flux}");
        }
    }
}
