//! One element: places of its nodes, Jacobians, edges.

use std::ops::Deref;

use stoss_reference_element::{CellKind, Family, Integration, MAX_CELL_NODES};

use crate::vector::{det, distance, norm};

/// Places of the nodes of one element, a slice of as many as it has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementCoordinates {
    kind: CellKind,
    /// Zeros beyond the nodes.
    places: [[f64; 3]; MAX_CELL_NODES],
}

impl ElementCoordinates {
    /// Coordinates of an element with these nodes.
    pub(crate) fn new(kind: CellKind, element: &[u32], nodes: &[[f64; 3]]) -> Self {
        let mut places = [[0.0; 3]; MAX_CELL_NODES];
        for (x, &n) in places.iter_mut().zip(element) {
            *x = nodes[n as usize];
        }
        Self { kind, places }
    }

    /// Kind of the element.
    pub fn kind(&self) -> CellKind {
        self.kind
    }

    /// Coordinates with each place replaced by its image.
    pub(crate) fn map(mut self, place: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        self.places[..self.kind.node_count()].iter_mut().for_each(|x| *x = place(*x));
        self
    }

    /// The place of the natural coordinates `xi`.
    pub fn at(&self, xi: [f64; 3]) -> [f64; 3] {
        let n = (self.kind.table().shape)(xi);
        std::array::from_fn(|i| self.iter().zip(n).map(|(x, n)| n * x[i]).sum())
    }

    /// `J = sum_I X_I (x) grad N_I` (theory/kinematics#eq-deformation-gradient) at natural coordinates: row the spatial, column the natural direction.
    pub fn jacobian(&self, xi: [f64; 3]) -> [[f64; 3]; 3] {
        let dn = (self.kind.table().shape_gradient)(xi);
        std::array::from_fn(|i| std::array::from_fn(|k| self.iter().zip(dn).map(|(x, dn)| x[i] * dn[k]).sum()))
    }

    /// The smallest scaled Jacobian (see [`crate::QualityReport::min_scaled_jacobian`]) at a node, and the node.
    pub fn worst_node(&self) -> (f64, usize) {
        let table = self.kind.table();
        let at = |xi: [f64; 3]| {
            let j = self.jacobian(xi);
            scaled_jacobian(table.family, &j, xi, det(&j))
        };
        let nodes = table.nodes.iter().enumerate().map(|(k, &xi)| (at(xi), k));
        nodes.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((1.0, 0))
    }
}

impl Deref for ElementCoordinates {
    type Target = [[f64; 3]];
    fn deref(&self) -> &[[f64; 3]] {
        &self.places[..self.kind.node_count()]
    }
}

/// Points and weights of the quadrature of the stiffness.
pub(crate) fn gauss_points(kind: CellKind) -> impl Iterator<Item = ([f64; 3], f64)> {
    kind.rule(Integration::Full).unwrap_or_default().iter().copied()
}

/// `det J` over the lengths of the tangents that meet at the corner nearest to the point, times the factor that makes it 1 for equal edges.
pub(crate) fn scaled_jacobian(family: Family, j: &[[f64; 3]; 3], xi: [f64; 3], det: f64) -> f64 {
    let column = |k: usize| -> [f64; 3] { [j[0][k], j[1][k], j[2][k]] };
    let difference = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| j[i][a] - j[i][b]) };
    // Tangents along the edges of the simplex in the first `d` directions at its corner nearest to the point.
    let simplex = |d: usize| -> Vec<[f64; 3]> {
        let rest = 1.0 - xi[..d].iter().sum::<f64>();
        let nearest = (0..d).max_by(|&a, &b| xi[a].total_cmp(&xi[b])).filter(|&a| xi[a] > rest);
        match nearest {
            None => (0..d).map(column).collect(),
            Some(a) => (0..d).map(|k| if k == a { column(a) } else { difference(k, a) }).collect(),
        }
    };
    let (tangents, factor) = match family {
        Family::Hexahedron => ((0..3).map(column).collect(), 1.0),
        Family::Tetrahedron => (simplex(3), 2f64.sqrt()),
        Family::Wedge => (simplex(2).into_iter().chain([column(2)]).collect::<Vec<_>>(), 2.0 / 3f64.sqrt()),
    };
    let lengths: f64 = tangents.into_iter().map(norm).product();
    if lengths > 0.0 { factor * det / lengths } else { 0.0 }
}

/// Shortest and longest edge of an element, between corners.
pub(crate) fn edge_range(x: &ElementCoordinates) -> (f64, f64) {
    x.kind.edges().iter().fold((f64::INFINITY, 0.0_f64), |(min, max), &[a, b]| {
        let d = distance(x[usize::from(a)], x[usize::from(b)]);
        (min.min(d), max.max(d))
    })
}
