//! Kinematic and distributing couplings of nodes, for instance of the surface of a solid, to a rigid body, usually one without mass, to which joints and loads are then applied.

use crate::{ConstraintSet, Embedded, Equation, QuadraticsBuilder, RigidBody};
use nalgebra::{Matrix3, Vector3};

/// Why nodes cannot be coupled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CouplingError {
    /// The coupling has no nodes.
    #[error("coupling {coupling} has no nodes")]
    NoNodes {
        /// The coupling.
        coupling: String,
    },
    /// A number is out of its range.
    #[error(
        "coupling {coupling}: the weight {weight:e} of node {node} must be finite, and all weights must add up to a positive number"
    )]
    Weight {
        /// The coupling.
        coupling: String,
        /// Global node.
        node: u32,
        /// Weight of the node.
        weight: f64,
    },
    /// Nodes on a line, or all at one point, do not determine a rotation.
    #[error("coupling {coupling}: the nodes are on a line, or all at one point, and do not determine a rotation")]
    OnALine {
        /// The coupling.
        coupling: String,
    },
}

/// Each node is a point of the body: `x_a - c - sum_k X_ak D_k / l = 0`, 3 equations a node, linear.
///
/// # Errors
/// [`CouplingError::NoNodes`].
pub fn kinematic_coupling(
    name: &str,
    body: &RigidBody,
    nodes: &[u32],
    reference: &[f64],
) -> Result<ConstraintSet, CouplingError> {
    if nodes.is_empty() {
        return Err(CouplingError::NoNodes { coupling: name.to_owned() });
    }
    let equations = nodes.iter().map(|&node| {
        let at = position(reference, node);
        let apart = Embedded::vector(node).plus(-1.0, &body.point([at.x, at.y, at.z]));
        let mut builder = QuadraticsBuilder::new();
        let apart = builder.form(&apart);
        for i in 0..3 {
            let unit = builder.form(&Embedded::ground(std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 })));
            builder.function(0.0, &[(1.0, apart, unit)]);
        }
        Equation::each(builder.build())
    });
    Ok(ConstraintSet::new(name, body.director_length(), equations.collect()))
}

/// The body follows the weighted mean motion of the nodes: `sum w_a x_a - c = 0` with weights that are scaled to the sum 1 and the point `c` of the body that is at the weighted centre of the
/// nodes in the reference configuration, and `sum w_a (R X_a) x (x_a - c) = 0` with the arms `X_a` from there, in the body's axes: `(S_j . D_k - S_k . D_j) / L = 0`, `S_j = sum w_a X_aj x_a`,
/// with the square `L` of the radius of gyration of the nodes over a length. 6 equations.
///
/// Weights may be negative, as the integrals of shape functions at corners of quadratic faces are. Forces and moments on the body go to the nodes, `w_a (f + t x R X_a)` with some vector `t`; the deformation of the nodes is not constrained. All nodes form one dense contribution: use a few hundred nodes
/// at most.
///
/// # Errors
/// [`CouplingError`].
pub fn distributing_coupling(
    name: &str,
    body: &RigidBody,
    nodes: &[(u32, f64)],
    reference: &[f64],
) -> Result<ConstraintSet, CouplingError> {
    let coupling = || name.to_owned();
    if nodes.is_empty() {
        return Err(CouplingError::NoNodes { coupling: coupling() });
    }
    let total: f64 = nodes.iter().map(|(_, w)| w).sum();
    let worst = nodes.iter().find(|(_, w)| !w.is_finite());
    let least = || nodes.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some(&(node, weight)) = worst.or_else(|| least().filter(|_| total <= 0.0)) {
        return Err(CouplingError::Weight { coupling: coupling(), node, weight });
    }
    let weights: Vec<(u32, f64)> = nodes.iter().map(|&(node, w)| (node, w / total)).collect();
    let centre = weights.iter().fold(Vector3::zeros(), |c, &(node, w)| c + w * position(reference, node));
    let mut spread = Matrix3::zeros();
    for &(node, w) in &weights {
        let arm = position(reference, node) - centre;
        spread += w * arm * arm.transpose();
    }
    let square = spread.trace();
    let mut principal: [f64; 3] = spread.symmetric_eigenvalues().into();
    principal.sort_by(f64::total_cmp);
    if principal[1] <= 1e-12 * principal[2] {
        return Err(CouplingError::OnALine { coupling: coupling() });
    }
    let mut mean = Embedded::default();
    let mut moments = [Embedded::default(), Embedded::default(), Embedded::default()];
    for &(node, w) in &weights {
        mean.terms.push((node, w));
        let arm = position(reference, node) - centre;
        for (moment, axis) in moments.iter_mut().zip(body.mass().axes) {
            moment.terms.push((node, w * arm.dot(&Vector3::from(axis))));
        }
    }
    let mut builder = QuadraticsBuilder::new();
    let apart = builder.form(&mean.plus(-1.0, &body.point(centre.into())));
    for i in 0..3 {
        let unit = builder.form(&Embedded::ground(std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 })));
        builder.function(0.0, &[(1.0, apart, unit)]);
    }
    let moments = moments.each_ref().map(|moment| builder.form(moment));
    let directors = [1, 2, 3].map(|k| builder.form(&Embedded::vector(body.first() + k)));
    // `D` has the length l and `S` that of `square`: divided by `l sqrt(square)` the function is a length.
    let factor = 1.0 / (square.sqrt() * body.director_length());
    for (j, k) in [(1, 2), (2, 0), (0, 1)] {
        builder.function(0.0, &[(factor, moments[j], directors[k]), (-factor, moments[k], directors[j])]);
    }
    Ok(ConstraintSet::new(name, body.director_length(), vec![Equation::each(builder.build())]))
}

fn position(q: &[f64], node: u32) -> Vector3<f64> {
    Vector3::from_column_slice(&q[3 * node as usize..3 * node as usize + 3])
}
