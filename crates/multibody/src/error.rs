//! Errors in the data of a beam, string, spring or point mass.

/// What is wrong with the data of a part.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartDataError {
    /// A number has the wrong sign, or is not finite.
    #[error("{what} = {value:e} must be {must}")]
    Number {
        /// Name of the number.
        what: &'static str,
        /// The number.
        value: f64,
        /// Condition that it violates.
        must: &'static str,
    },
    /// The nodes do not make elements of this order.
    #[error("{nodes} nodes do not make elements of order {order} (1, 2 or 3; order * elements + 1 nodes)")]
    Elements {
        /// Number of nodes.
        nodes: usize,
        /// Order of the shape functions.
        order: usize,
    },
    /// Two neighbours coincide, or an element is folded.
    #[error("element {element} has zero length at a point of its axis (coincident nodes, or a folded element)")]
    NoLength {
        /// Number of the element.
        element: usize,
    },
    /// The directors of a node are no right-handed orthonormal triad.
    #[error("the directors of node {node} are not orthonormal and right-handed")]
    Directors {
        /// Number of the node.
        node: usize,
    },
    /// A direction that is needed for the directors is zero or along the axis.
    #[error(
        "the direction {direction:?} does not determine the directors of a beam along {axis:?}: it is zero or parallel to the axis"
    )]
    Direction {
        /// The direction.
        direction: [f64; 3],
        /// Tangent of the axis.
        axis: [f64; 3],
    },
    /// Lists that belong together differ in length.
    #[error("{what}: {found} entries, expected {expected}")]
    Count {
        /// Name of the list.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Entries expected.
        expected: usize,
    },
}

/// An error unless the number is positive and finite.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<(), PartDataError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(PartDataError::Number { what, value, must: "positive and finite" })
}

/// An error unless the number is finite and not negative.
pub(crate) fn not_negative(what: &'static str, value: f64) -> Result<(), PartDataError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(PartDataError::Number { what, value, must: "finite and not negative" })
}

/// An error unless all components are finite.
pub(crate) fn finite(what: &'static str, vectors: &[[f64; 3]]) -> Result<(), PartDataError> {
    match vectors.iter().flatten().find(|x| !x.is_finite()) {
        Some(&value) => Err(PartDataError::Number { what, value, must: "finite" }),
        None => Ok(()),
    }
}
