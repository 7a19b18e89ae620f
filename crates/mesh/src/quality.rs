//! The quality report.

use crate::Mesh;
use crate::element::{det, edge_range, first_not_positive, gauss_points, scaled};

/// What [`Mesh::quality`] found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QualityReport {
    /// Number of elements.
    pub elements: usize,
    /// Smallest scaled Jacobian `det J / (|J e1| |J e2| |J e3|)` over Gauss points and nodes of all elements, relative to a box, or a tetrahedron or wedge
    /// with equal edges: 1 for these, 0 or less for a degenerate or inverted element. `e` are the edges' directions at a corner.
    pub min_scaled_jacobian: f64,
    /// The element that has it.
    pub worst_element: u32,
    /// Largest ratio of the longest to the shortest edge of an element.
    pub max_aspect_ratio: f64,
    /// The element that has it.
    pub slenderest_element: u32,
    /// Number of elements with `det J <= 0` at a Gauss point, or at a node of a quadratic element.
    pub inverted_elements: usize,
    /// Length of the shortest edge.
    pub min_edge: f64,
    /// Length of the longest edge.
    pub max_edge: f64,
    /// Volume of the mesh by the rule of the mass (exact for hex8, whose `det J` has degree 2 in each coordinate, and for straight edges).
    pub volume: f64,
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
            let table = x.kind().table();
            let points = gauss_points(x.kind()).map(|(xi, _)| xi).chain(table.nodes.iter().copied());
            for xi in points {
                let j = x.jacobian(xi);
                smallest = smallest.min(scaled(table.family, &j, xi, det(&j)));
            }
            report.volume += table.mass.iter().map(|&(xi, weight)| det(&x.jacobian(xi)) * weight).sum::<f64>();
            report.inverted_elements += usize::from(first_not_positive(&x).is_some());
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
