//! Errors of surfaces, search and methods.

/// Errors of surfaces, search and methods.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// A projection did not converge.
    #[error("closest-point projection of slave node {node} on master facet {facet} did not converge")]
    Projection {
        /// Global slave node.
        node: u32,
        /// Index of the master facet.
        facet: u32,
    },
    /// A surface has no facet.
    #[error("the {side} surface is empty")]
    EmptySurface {
        /// "slave" or "master".
        side: &'static str,
    },
    /// A row of nodes is no line.
    #[error("the slave line is not valid: {reason}")]
    Line {
        /// Why.
        reason: String,
    },
    /// Slave and master share nodes.
    #[error("slave and master surface share node {node}: a body cannot be in contact with itself here")]
    SharedNode {
        /// Global node, the smallest shared one.
        node: u32,
    },
    /// A facet has a degenerate normal.
    #[error("facet {facet} is degenerate (area {area:e})")]
    DegenerateFacet {
        /// Index of the facet.
        facet: u32,
        /// Reference area of the facet.
        area: f64,
    },
    /// A facet names a node that does not exist.
    #[error("facet {facet} refers to node {node}, but there are only {count} nodes")]
    MissingNode {
        /// Index of the facet.
        facet: u32,
        /// Global node.
        node: u32,
        /// Number of nodes of the reference coordinates.
        count: usize,
    },
    /// A coordinate is not finite.
    #[error("node {node} has a coordinate that is not finite")]
    NotFinite {
        /// Global node.
        node: u32,
    },
    /// Motions of a step past so many facets that it cannot come to an end soon.
    #[error(
        "in {iterations} iterations bodies moved past so many facets in one step that contact {contact} has too many pairs to check: the step is much too large; try smaller steps"
    )]
    TooFar {
        /// Name of the contact.
        contact: String,
        /// Iterations in which that was so.
        iterations: u32,
    },
    /// An option is out of its range.
    #[error("option `{option}` must be {range}, but is {value}")]
    OptionOutOfRange {
        /// Name of the option.
        option: &'static str,
        /// Value given.
        value: f64,
        /// Allowed values.
        range: &'static str,
    },
    /// A friction parameter is out of its range.
    #[error("friction parameter `{parameter}` must be {range}, but is {value}")]
    Friction {
        /// Name of the parameter.
        parameter: &'static str,
        /// Value given.
        value: f64,
        /// Allowed values.
        range: &'static str,
    },
    /// The stiffness of a penalty is out of its range.
    #[error("the normal stiffness must be positive, but is {value}")]
    Stiffness {
        /// Value given.
        value: f64,
    },
    /// The modified constraint keeps gaps, and a penalty lets them change.
    #[error("normal contact by a penalty is not available with the modified constraint")]
    PenaltyUnavailable,
    /// Friction under a rule of the scheme, or a form of the constraint, that has none.
    #[error("contact with friction is not available with {what}")]
    FrictionUnavailable {
        /// Name of the rule or form of the constraint.
        what: String,
    },
    /// A method cannot follow a rule of the scheme.
    #[error("contact method {method} is not available with the rule {rule}")]
    RuleUnavailable {
        /// The method.
        method: &'static str,
        /// Name of the scheme's rule.
        rule: String,
    },
    /// The frame of a tied slave node degenerates in the step.
    #[error("the frame of tied slave node {node} degenerates: it turns by half a turn in the step, or its facets fold")]
    Frame {
        /// Global slave node.
        node: u32,
    },
    /// Surfaces cannot be segmented.
    #[error("segmentation failed: {reason}")]
    Segmentation {
        /// Reason.
        reason: String,
    },
    /// The normals of the facets around a slave node cancel.
    #[error("the slave surface is folded at node {node}: it has no normal there")]
    NoNormal {
        /// Global slave node.
        node: u32,
    },
    /// Segments do not tile the overlap of the surfaces.
    #[error(
        "the segments of {faults} slave facets do not exactly cover the part of the master that is opposite; the first is facet {facet} (uncovered {uncovered:e}, \
         covered twice {double:e}, {open_edges} edges that do not fit)"
    )]
    Coverage {
        /// Number of slave facets.
        faults: usize,
        /// The first of them, local number.
        facet: u32,
        /// Uncovered area of the facet that lies opposite the master.
        uncovered: f64,
        /// Area of the facet that is covered twice.
        double: f64,
        /// Interior edges that do not match.
        open_edges: usize,
    },
    /// A part of the slave passed through the master surface.
    #[error(
        "slave facet {facet} passed through the master surface in one step: the gap of a part of it was {before:.3e} and is {after:.3e} now, deeper than contact reaches; \
         use smaller steps"
    )]
    Tunnelled {
        /// Local number of the slave facet.
        facet: u32,
        /// Gap of the facet at the start of the step.
        before: f64,
        /// Gap of the facet at the end.
        after: f64,
    },
    /// A joint cannot be evaluated.
    #[error("joint {joint}: {reason}")]
    Joint {
        /// Name of the joint.
        joint: String,
        /// Reason.
        reason: String,
    },
    /// History bytes do not fit.
    #[error("contact history does not fit this model: {reason}")]
    History {
        /// What does not fit.
        reason: String,
    },
}

impl From<ContactError> for stoss_term::Fault {
    fn from(error: ContactError) -> Self {
        Self::other(error)
    }
}
