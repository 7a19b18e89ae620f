//! What can go wrong with a body of finite elements.

use stoss_continuum::ConstitutiveError;

/// The configuration at which a quantity was evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeLevel {
    /// The end of the step, `q_np1` (or the single configuration of a query).
    End,
    /// A configuration between start and end, `q_{n+theta}` with `0 < theta < 1`.
    Intermediate,
    /// The beginning of the step, `q_n`.
    Start,
}

impl std::fmt::Display for TimeLevel {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::End => "end of step",
            Self::Intermediate => "intermediate configuration of step",
            Self::Start => "start of step",
        })
    }
}

/// Errors of this crate. Elements are counted from 0 within the body, Gauss points from 0 in the element.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// `det F <= 0` (or not a number). A step control answers it with a smaller step.
    #[error(
        "body '{body}': element {element} is inverted at Gauss point {gauss_point} (det F = {determinant:e}, {level})"
    )]
    InvertedElement {
        /// Name of the body.
        body: String,
        /// Element in the body.
        element: usize,
        /// Gauss point in the element.
        gauss_point: usize,
        /// `det F`.
        determinant: f64,
        /// Where in the step.
        level: TimeLevel,
    },
    /// The averaged change of volume of a mixed element is not positive though `det F > 0` at every Gauss point. A step control answers it with a smaller step.
    #[error(
        "body '{body}': element {element} has no volume on average at Gauss point {gauss_point} (averaged det F = {dilatation:e}, {level})"
    )]
    CollapsedElement {
        /// Name of the body.
        body: String,
        /// Element in the body.
        element: usize,
        /// Gauss point in the element.
        gauss_point: usize,
        /// The average there.
        dilatation: f64,
        /// Where in the step.
        level: TimeLevel,
    },
    /// Mixed elements need a law that has a part for the change of volume.
    #[error(
        "body '{body}': the law {law} has no separate energy of the change of volume, which mixed elements need: use displacement elements or another law"
    )]
    NoVolumetricPart {
        /// Name of the body.
        body: String,
        /// Name of the law.
        law: String,
    },
    /// The law has no value at a state of strain.
    #[error("body '{body}': element {element}, Gauss point {gauss_point}: {source}")]
    Constitutive {
        /// Name of the body.
        body: String,
        /// Element in the body.
        element: usize,
        /// Gauss point in the element.
        gauss_point: usize,
        /// What the law says.
        source: ConstitutiveError,
    },
    /// The mesh itself is inverted or flat: `det dX/dxi <= 0`.
    #[error(
        "body '{body}': the mesh is inverted in element {element} at Gauss point {gauss_point} (det dX/dxi = {determinant:e})"
    )]
    InvertedReference {
        /// Name of the body.
        body: String,
        /// Element in the body.
        element: usize,
        /// Gauss point in the element.
        gauss_point: usize,
        /// `det dX/dxi`.
        determinant: f64,
    },
    /// An element names a node that the mesh does not have.
    #[error("body '{body}': element {element} names node {node}, but the mesh has {count} nodes")]
    NoSuchNode {
        /// Name of the body.
        body: String,
        /// Element in the body.
        element: usize,
        /// The node, counted in the mesh.
        node: u32,
        /// Number of nodes of the mesh.
        count: usize,
    },
    /// A mesh without elements.
    #[error("body '{body}' has no elements")]
    Empty {
        /// Name of the body.
        body: String,
    },
    /// Energy-momentum force without [`crate::SolidBody::begin_step`] for the rule.
    #[error("body '{body}': begin_step was not called for the energy-momentum rule")]
    StepNotBegun {
        /// Name of the body.
        body: String,
    },
    /// A vector of the model is too short for the body's nodes, or an output array has the wrong length.
    #[error("'{name}': {what} has {found} entries, {expected} are needed")]
    Length {
        /// Name of the body or load.
        name: String,
        /// Name of the array.
        what: &'static str,
        /// Length of the array.
        found: usize,
        /// The length that is needed.
        expected: usize,
    },
    /// A body whose elements have averages in common was to be divided among ranks.
    #[error("body '{body}': averages at the nodes are over all its elements, which one rank has to have")]
    Indivisible {
        /// Name of the body.
        body: String,
    },
    /// An element of which nothing is kept here, because another rank has it.
    #[error("body '{body}': the states of element {element} are on another rank")]
    OnOtherRank {
        /// Name of the body.
        body: String,
        /// Element in the body.
        element: usize,
    },
    /// A loaded facet has no area, or names a node beyond the positions.
    #[error("facet {facet} of the loaded surface is degenerate (area {area:e})")]
    DegenerateFacet {
        /// Facet in the load's list.
        facet: usize,
        /// Reference area of the facet.
        area: f64,
    },
}
