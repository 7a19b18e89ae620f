//! The quality report.

use crate::Mesh;
use crate::element::{edge_range, gauss_points, scaled_jacobian};
use crate::validity::{POOR, not_positive};
use crate::vector::det;

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
    /// Smallest lower bound of `det J` in a whole element over its mean in the linear cell with the same corners ([`crate::Validity::bound`]): 1 for
    /// parallelepipeds, straight tetrahedra and prisms.
    pub min_validity: f64,
    /// The element that has it.
    pub least_valid_element: u32,
    /// Number of elements with such a bound below 0.1.
    pub poor_elements: usize,
    /// Number of poor elements of which it is not known whether `det J` is positive everywhere ([`crate::Validity::is_undecided`]).
    pub undecided_elements: usize,
    /// Number of elements with `det J <= 0` at a Gauss point, or at another point of a quadratic element.
    pub inverted_elements: usize,
    /// Length of the shortest edge.
    pub min_edge: f64,
    /// Length of the longest edge.
    pub max_edge: f64,
    /// Volume of the mesh by the quadrature rule of the mass (exact for hex8, whose `det J` has degree 2 in each coordinate, and for straight edges).
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
            min_validity: f64::INFINITY,
            least_valid_element: 0,
            poor_elements: 0,
            undecided_elements: 0,
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
                smallest = smallest.min(scaled_jacobian(table.family, &j, xi, det(&j)));
            }
            report.volume += table.mass.iter().map(|&(xi, weight)| det(&x.jacobian(xi)) * weight).sum::<f64>();
            let validity = x.validity();
            report.inverted_elements += usize::from(not_positive(&x, Some(&validity)).is_some());
            report.poor_elements += usize::from(validity.bound < POOR);
            report.undecided_elements += usize::from(validity.is_undecided());
            if validity.bound < report.min_validity {
                (report.min_validity, report.least_valid_element) = (validity.bound, e);
            }
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

impl QualityReport {
    /// A warning about elements whose `det J` is nearly zero at a point, or may be; `None` if there are none.
    pub fn warning(&self) -> Option<String> {
        if self.poor_elements == 0 {
            return None;
        }
        let count = match self.poor_elements {
            1 => "1 element has".to_owned(),
            n => format!("{n} elements have"),
        };
        let undecided = match self.undecided_elements {
            0 => String::new(),
            n => format!("; of {n} of them it is not known whether the determinant is positive everywhere"),
        };
        Some(format!(
            "{count} a lower bound of the Jacobian determinant below {POOR} of its mean; the smallest is that of element {}, {:.3}{undecided}. Small \
             deformations turn such corners inside out: move nodes on edges nearer to their middles, or remesh",
            self.least_valid_element, self.min_validity
        ))
    }
}

impl std::fmt::Display for QualityReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} elements, volume {:.6e}, edges {:.3e} to {:.3e}, smallest scaled Jacobian {:.3} (element {}), det J above {:.3} of its mean \
             (element {}), largest aspect ratio {:.2} (element {}), {} inverted",
            self.elements,
            self.volume,
            self.min_edge,
            self.max_edge,
            self.min_scaled_jacobian,
            self.worst_element,
            self.min_validity,
            self.least_valid_element,
            self.max_aspect_ratio,
            self.slenderest_element,
            self.inverted_elements
        )
    }
}
