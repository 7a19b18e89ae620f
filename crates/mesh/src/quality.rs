//! Jacobians of the elements and the quality report.

use stoss_reference_element::{hex8, quadrature::GAUSS_HEX_2};

use crate::Mesh;

/// Edges of the hexahedron as pairs of local nodes.
pub(crate) const EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/// What [`Mesh::quality`] found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QualityReport {
    /// Number of elements.
    pub elements: usize,
    /// Smallest scaled Jacobian `det J / (|J e1| |J e2| |J e3|)` over Gauss points and vertices of all elements: 1 for a box,
    /// 0 or less for a degenerate or inverted element.
    pub min_scaled_jacobian: f64,
    /// The element that has it.
    pub worst_element: u32,
    /// Largest ratio of the longest to the shortest edge of an element.
    pub max_aspect_ratio: f64,
    /// The element that has it.
    pub slenderest_element: u32,
    /// Number of elements with `det J <= 0` at a Gauss point.
    pub inverted_elements: usize,
    /// Length of the shortest edge.
    pub min_edge: f64,
    /// Length of the longest edge.
    pub max_edge: f64,
    /// Volume of the mesh by the 2 x 2 x 2 rule (exact: `det J` has degree 2 in each coordinate).
    pub volume: f64,
}

/// `J = sum_I X_I (x) grad N_I` (formulation §3.2) at natural coordinates: row the spatial, column the natural direction.
pub(crate) fn jacobian(x: &[[f64; 3]; 8], xi: [f64; 3]) -> [[f64; 3]; 3] {
    let dn = hex8::shape_gradient(xi);
    std::array::from_fn(|i| std::array::from_fn(|k| (0..8).map(|a| x[a][i] * dn[a][k]).sum()))
}

/// Determinant of a 3 x 3 matrix.
pub(crate) fn det(m: &[[f64; 3]; 3]) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

fn scaled(j: &[[f64; 3]; 3], det: f64) -> f64 {
    let lengths: f64 = (0..3).map(|k| (0..3).map(|i| j[i][k] * j[i][k]).sum::<f64>().sqrt()).product();
    if lengths > 0.0 { det / lengths } else { 0.0 }
}

/// Distance of two points.
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
}

/// Shortest and longest edge of an element.
pub(crate) fn edge_range(x: &[[f64; 3]; 8]) -> (f64, f64) {
    EDGES.iter().fold((f64::INFINITY, 0.0_f64), |(min, max), &[a, b]| {
        let d = distance(x[a], x[b]);
        (min.min(d), max.max(d))
    })
}

impl Mesh {
    /// Measures the mesh. An empty mesh gives infinities and a volume of zero.
    pub fn quality(&self) -> QualityReport {
        let mut report = QualityReport {
            elements: self.elements.len(),
            min_scaled_jacobian: f64::INFINITY,
            worst_element: 0,
            max_aspect_ratio: 0.0,
            slenderest_element: 0,
            inverted_elements: 0,
            min_edge: f64::INFINITY,
            max_edge: 0.0,
            volume: 0.0,
        };
        for e in 0..self.elements.len() as u32 {
            let x = self.element_coordinates(e);
            let mut smallest = f64::INFINITY;
            let mut inverted = false;
            for (xi, weight) in GAUSS_HEX_2 {
                let j = jacobian(&x, xi);
                let d = det(&j);
                inverted |= d.is_nan() || d <= 0.0;
                smallest = smallest.min(scaled(&j, d));
                report.volume += d * weight;
            }
            for xi in hex8::VERTICES {
                let j = jacobian(&x, xi);
                smallest = smallest.min(scaled(&j, det(&j)));
            }
            report.inverted_elements += usize::from(inverted);
            if smallest < report.min_scaled_jacobian {
                (report.min_scaled_jacobian, report.worst_element) = (smallest, e);
            }
            let (short, long) = edge_range(&x);
            let aspect = if short > 0.0 { long / short } else { f64::INFINITY };
            if aspect > report.max_aspect_ratio {
                (report.max_aspect_ratio, report.slenderest_element) = (aspect, e);
            }
            report.min_edge = report.min_edge.min(short);
            report.max_edge = report.max_edge.max(long);
        }
        report
    }
}

impl std::fmt::Display for QualityReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} elements, volume {:.6e}, edges {:.3e} to {:.3e}, smallest scaled Jacobian {:.3} (element {}), largest aspect ratio \
             {:.2} (element {}), {} inverted",
            self.elements,
            self.volume,
            self.min_edge,
            self.max_edge,
            self.min_scaled_jacobian,
            self.worst_element,
            self.max_aspect_ratio,
            self.slenderest_element,
            self.inverted_elements
        )
    }
}
