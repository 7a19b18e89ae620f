//! Lower bounds of `det J` over whole elements, by Bernstein polynomials.
//!
//! In natural coordinates `det J` of an element is a polynomial. Bernstein polynomials are not negative in the cell and add up to one, so that the smallest
//! coefficient is a lower bound, and at a corner the coefficient is the value. With shape functions of order `p` the degrees are `3 p - 1` in each direction of a
//! hexahedron (27 or 216 coefficients), `3 (p - 1)` in a tetrahedron (1 or 20), `3 p - 2` in the triangle and `3 p - 1` along the line of a wedge (9 or 90).
//! The coefficients follow from the values at as many equidistant points.

use std::sync::OnceLock;

use stoss_reference_element::{CellKind, Family};

use crate::element::gauss_points;
use crate::vector::det;
use crate::{ElementCoordinates, ElementPoint};

/// Validity below which an element deserves a warning, and a bound is made sharper by a subdivision.
pub(crate) const POOR: f64 = 0.1;

/// What is known of `det J` in the whole of an element. The unit is the mean of `det J` in the linear cell with the same corners, which is 1 everywhere in a
/// parallelepiped, a tetrahedron with straight edges, or a prism.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validity {
    /// `det J` is nowhere below this.
    pub bound: f64,
    /// The smallest value at a point that was evaluated.
    pub least: f64,
    /// Natural coordinates of that point.
    pub at: [f64; 3],
}

impl Validity {
    /// Whether `det J` is not positive, or no number, at a point.
    pub fn is_inverted(&self) -> bool {
        self.least.is_nan() || self.least <= 0.0
    }

    /// Whether it is not known if `det J` is positive everywhere: it is at all points that were evaluated, and the bound is not.
    pub fn is_undecided(&self) -> bool {
        !self.is_inverted() && self.bound <= 0.0
    }
}

/// A point of an element at which `det J` is not positive: Gauss points; of quadratic elements then the nodes, which they invert at first, and the points
/// that [`ElementCoordinates::validity`] evaluates.
pub(crate) fn not_positive(x: &ElementCoordinates, validity: Option<&Validity>) -> Option<(ElementPoint, f64)> {
    first_not_positive(x).or_else(|| {
        let at = validity.filter(|found| x.kind().is_quadratic() && found.is_inverted())?.at;
        Some((ElementPoint::Natural(at), det(&x.jacobian(at))))
    })
}

/// The first Gauss point, or node of a quadratic element, at which `det J` is not positive.
fn first_not_positive(x: &ElementCoordinates) -> Option<(ElementPoint, f64)> {
    let gauss = gauss_points(x.kind()).enumerate().map(|(g, (xi, _))| (ElementPoint::Gauss(g), xi));
    let nodes = x.kind().table().nodes.iter().enumerate().filter(|_| x.kind().is_quadratic());
    gauss
        .chain(nodes.map(|(n, &xi)| (ElementPoint::Node(n), xi)))
        .map(|(point, xi)| (point, det(&x.jacobian(xi))))
        .find(|(_, jacobian)| jacobian.is_nan() || *jacobian <= 0.0)
}

impl ElementCoordinates {
    /// Bound and smallest value of `det J` in the element; where the bound is poor, after a subdivision into halves in every direction.
    pub fn validity(&self) -> Validity {
        let basis = Basis::of(self.kind());
        let table = self.kind().table();
        let mut values = Vec::with_capacity(basis.points.len());
        // The polynomial is that of the affine part plus a difference, so that round-off is that of the difference alone: the coefficients have some thousand times that
        // of the values.
        let centre = table.family.centre();
        let (middle, affine) = (self.at(centre), self.jacobian(centre));
        let base = det(&affine);
        let off = |(x, xi): (&[f64; 3], &[f64; 3])| {
            [0, 1, 2].map(|i| x[i] - middle[i] - (0..3).map(|k| affine[i][k] * (xi[k] - centre[k])).sum::<f64>())
        };
        let off: Vec<[f64; 3]> = self.iter().zip(table.nodes).map(off).collect();
        for gradients in basis.gradients.chunks_exact(off.len()) {
            let mut j = [[0.0; 3]; 3];
            for (x, dn) in off.iter().zip(gradients) {
                for i in 0..3 {
                    for k in 0..3 {
                        j[i][k] += x[i] * dn[k];
                    }
                }
            }
            values.push(det(&j) + mixed(&affine, &j) + mixed(&j, &affine));
        }
        let unit = self.straight_mean();
        let mut found = Validity { bound: f64::INFINITY, least: f64::INFINITY, at: [0.0; 3] };
        found.record(values.iter().map(|v| base + v), &basis.points, unit);
        let mut scratch = Vec::new();
        found.bound = (base + basis.smallest_coefficient(&mut values, &mut scratch)) / unit;
        if found.bound < POOR && !found.is_inverted() {
            let mut bound = f64::INFINITY;
            for points in &basis.children {
                values.clear();
                values.extend(points.iter().map(|&xi| det(&self.jacobian(xi))));
                found.record(values.iter().copied(), points, unit);
                bound = bound.min(basis.smallest_coefficient(&mut values, &mut scratch) / unit);
            }
            found.bound = found.bound.max(bound);
        }
        found
    }

    /// Size of the mean of `det J` of the linear cell with the same corners; 1 if that is zero.
    fn straight_mean(&self) -> f64 {
        let table = self.kind().table();
        let linear = table.linear.table();
        let corners = &self[..table.corners];
        let at = |xi: [f64; 3]| {
            let dn = (linear.shape_gradient)(xi);
            let j = [0, 1, 2].map(|i| [0, 1, 2].map(|k| corners.iter().zip(&dn).map(|(x, dn)| x[i] * dn[k]).sum()));
            det(&j)
        };
        let mean = linear.mass.iter().map(|&(xi, weight)| at(xi) * weight).sum::<f64>() / table.family.volume();
        if mean == 0.0 { 1.0 } else { mean.abs() }
    }
}

/// `cof A : B`, the part of `det (A + B)` that is linear in `B`.
fn mixed(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> f64 {
    det(&[b[0], a[1], a[2]]) + det(&[a[0], b[1], a[2]]) + det(&[a[0], a[1], b[2]])
}

impl Validity {
    /// Keeps the smallest of the values at points.
    fn record(&mut self, values: impl Iterator<Item = f64>, points: &[[f64; 3]], unit: f64) {
        for (value, &at) in values.zip(points) {
            let value = value / unit;
            if value < self.least || value.is_nan() {
                (self.least, self.at) = (value, at);
            }
        }
    }
}

/// Bernstein polynomials of a degree on a simplex, of which a cell is a product.
#[derive(Debug)]
struct Factor {
    dimension: usize,
    /// Barycentric coordinates of the equidistant points, as many as there are polynomials.
    points: Vec<[f64; 4]>,
    /// Matrix from values at the points to coefficients, row-major.
    inverse: Vec<f64>,
}

/// Corners of the halves of a simplex of each dimension: each is the middle of two of its own corners.
const HALVES: [&[&[[usize; 2]]]; 3] = [
    &[&[[0, 0], [0, 1]], &[[0, 1], [1, 1]]],
    &[&[[0, 0], [0, 1], [0, 2]], &[[0, 1], [1, 1], [1, 2]], &[[0, 2], [1, 2], [2, 2]], &[[0, 1], [1, 2], [0, 2]]],
    &[
        &[[0, 0], [0, 1], [0, 2], [0, 3]],
        &[[0, 1], [1, 1], [1, 2], [1, 3]],
        &[[0, 2], [1, 2], [2, 2], [2, 3]],
        &[[0, 3], [1, 3], [2, 3], [3, 3]],
        &[[0, 1], [2, 3], [0, 2], [1, 2]],
        &[[0, 1], [2, 3], [1, 2], [1, 3]],
        &[[0, 1], [2, 3], [1, 3], [0, 3]],
        &[[0, 1], [2, 3], [0, 3], [0, 2]],
    ],
];

impl Factor {
    fn new(dimension: usize, degree: usize) -> Self {
        let mut powers: Vec<[usize; 4]> = Vec::new();
        for all in 0..(degree + 1).pow(dimension as u32) {
            let mut power = [0; 4];
            let mut rest = all;
            for p in &mut power[1..=dimension] {
                (*p, rest) = (rest % (degree + 1), rest / (degree + 1));
            }
            let sum: usize = power.iter().sum();
            if sum <= degree {
                power[0] = degree - sum;
                powers.push(power);
            }
        }
        let point = |power: &[usize; 4]| -> [f64; 4] {
            std::array::from_fn(|i| match degree {
                // A constant, whose value is taken in the middle.
                0 if i <= dimension => 1.0 / (dimension + 1) as f64,
                0 => 0.0,
                _ => power[i] as f64 / degree as f64,
            })
        };
        let points: Vec<[f64; 4]> = powers.iter().map(point).collect();
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let polynomial = |power: &[usize; 4], at: &[f64; 4]| {
            let terms = power.iter().zip(at).map(|(&p, x)| x.powi(p as i32) / factorial(p));
            factorial(degree) * terms.product::<f64>()
        };
        let values = points.iter().flat_map(|at| powers.iter().map(move |power| polynomial(power, at))).collect();
        Self { dimension, inverse: inverse(values, points.len()), points }
    }

    /// Natural coordinates of a point: those of a line run from -1 to 1.
    fn natural(&self, at: &[f64; 4], out: &mut Vec<f64>) {
        match self.dimension {
            1 => out.push(at[1] - at[0]),
            d => out.extend_from_slice(&at[1..=d]),
        }
    }
}

/// Inverse of a matrix by elimination with pivots; Bernstein polynomials at equidistant points are independent.
fn inverse(mut matrix: Vec<f64>, n: usize) -> Vec<f64> {
    let mut inverse = vec![0.0; n * n];
    (0..n).for_each(|i| inverse[i * n + i] = 1.0);
    for column in 0..n {
        let size = |row: &usize| matrix[row * n + column].abs();
        let pivot = (column..n).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(column);
        for m in [&mut matrix, &mut inverse] {
            (0..n).for_each(|k| m.swap(column * n + k, pivot * n + k));
        }
        let factor = 1.0 / matrix[column * n + column];
        for m in [&mut matrix, &mut inverse] {
            m[column * n..(column + 1) * n].iter_mut().for_each(|x| *x *= factor);
        }
        for row in (0..n).filter(|&row| row != column) {
            let factor = matrix[row * n + column];
            for m in [&mut matrix, &mut inverse] {
                (0..n).for_each(|k| m[row * n + k] -= factor * m[column * n + k]);
            }
        }
    }
    inverse
}

/// What is the same for all elements of a kind.
#[derive(Debug)]
struct Basis {
    factors: Vec<Factor>,
    /// Natural coordinates of the points; those of the first factor run fastest.
    points: Vec<[f64; 3]>,
    /// Gradients of the shape functions there, point after point.
    gradients: Vec<[f64; 3]>,
    /// Natural coordinates of the points of the halves.
    children: Vec<Vec<[f64; 3]>>,
}

impl Basis {
    fn of(kind: CellKind) -> &'static Self {
        static BASES: [OnceLock<Basis>; CellKind::ALL.len()] = [const { OnceLock::new() }; CellKind::ALL.len()];
        BASES[kind as usize].get_or_init(|| Self::new(kind))
    }

    fn new(kind: CellKind) -> Self {
        let order = if kind.is_quadratic() { 2 } else { 1 };
        let line = || Factor::new(1, 3 * order - 1);
        let factors = match kind.table().family {
            Family::Hexahedron => vec![line(), line(), line()],
            Family::Tetrahedron => vec![Factor::new(3, 3 * (order - 1))],
            Family::Wedge => vec![Factor::new(2, 3 * order - 2), line()],
        };
        // Points of all combinations of points of the factors.
        let product = |points: &[Vec<[f64; 4]>]| -> Vec<[f64; 3]> {
            let count = points.iter().map(Vec::len).product::<usize>();
            let point = |mut k: usize| {
                let mut xi = Vec::with_capacity(3);
                for (factor, points) in factors.iter().zip(points) {
                    factor.natural(&points[k % points.len()], &mut xi);
                    k /= points.len();
                }
                [xi[0], xi[1], xi[2]]
            };
            (0..count).map(point).collect()
        };
        let own: Vec<Vec<[f64; 4]>> = factors.iter().map(|factor| factor.points.clone()).collect();
        let points = product(&own);
        let halves = |factor: &Factor| HALVES[factor.dimension - 1];
        let count = factors.iter().map(|factor| halves(factor).len()).product::<usize>();
        let child = |mut k: usize| {
            let mut all = Vec::new();
            for factor in &factors {
                let corners = halves(factor)[k % halves(factor).len()];
                k /= halves(factor).len();
                let map = |at: &[f64; 4]| {
                    let mut mapped = [0.0; 4];
                    for (&[a, b], weight) in corners.iter().zip(at) {
                        mapped[a] += 0.5 * weight;
                        mapped[b] += 0.5 * weight;
                    }
                    mapped
                };
                all.push(factor.points.iter().map(map).collect());
            }
            product(&all)
        };
        let children = (0..count).map(child).collect();
        let nodes = kind.node_count();
        let gradients =
            points.iter().flat_map(|&xi| (kind.table().shape_gradient)(xi).into_iter().take(nodes)).collect();
        Self { points, gradients, children, factors }
    }

    /// The smallest coefficient of the polynomial with these values at the points; the values are overwritten by the coefficients.
    fn smallest_coefficient(&self, values: &mut Vec<f64>, scratch: &mut Vec<f64>) -> f64 {
        let mut stride = 1;
        for factor in &self.factors {
            let n = factor.points.len();
            scratch.clear();
            scratch.resize(values.len(), 0.0);
            for start in (0..values.len()).filter(|k| k / stride % n == 0) {
                for (i, row) in factor.inverse.chunks_exact(n).enumerate() {
                    scratch[start + i * stride] =
                        row.iter().enumerate().map(|(k, weight)| weight * values[start + k * stride]).sum();
                }
            }
            std::mem::swap(values, scratch);
            stride *= n;
        }
        values.iter().fold(f64::INFINITY, |least, &b| if b.is_nan() { f64::NEG_INFINITY } else { least.min(b) })
    }
}
