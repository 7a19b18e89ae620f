//! Errors of contact geometry.

/// Errors of contact geometry.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// Multipliers of an augmented Lagrangian do not settle.
    #[error(
        "{unsettled} multipliers of the augmented Lagrangian ({what}) have not settled after {rounds} rounds; a larger stiffness or multipliers as \
         unknowns help"
    )]
    Augmentation {
        /// Friction or gap.
        what: &'static str,
        /// How many are far from it.
        unsettled: usize,
        /// Rounds of augmentation.
        rounds: u32,
    },
    /// Over an edge of the master the contact force has no part along the normal of either facet.
    #[error(
        "slave node {node} moves over an edge of the master as if its facets were folded upon each other, and its pressure is not determined; smaller steps or \
         a rounder edge help"
    )]
    Folded {
        /// Global slave node.
        node: u32,
    },
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
        /// Its reference area.
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
    /// A search option is out of its range.
    #[error("search option `{option}` must be {range}, but is {value}")]
    Option {
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
    /// The stiffness of a penalty or of an augmented Lagrangian is out of its range.
    #[error("the normal stiffness must be positive, but is {value}")]
    Stiffness {
        /// Value given.
        value: f64,
    },
    /// A penalty has nothing to keep.
    #[error("normal contact by a penalty is not available with the modified constraint")]
    PenaltyUnavailable,
    /// There is no friction under a rule or constraint.
    #[error("contact with friction is not available with {what}")]
    FrictionUnavailable {
        /// Which rule or form of the constraint.
        what: String,
    },
    /// A method does not have a rule.
    #[error("contact method {method} is not available with the rule {rule}")]
    Rule {
        /// The method.
        method: &'static str,
        /// The rule.
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
        /// What is wrong.
        reason: String,
    },
    /// The normals of the facets around a slave node cancel.
    #[error("the slave surface folds up at node {node}: it has no normal there")]
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
        /// Its uncovered area that lies opposite the master.
        uncovered: f64,
        /// Its area that is covered twice.
        double: f64,
        /// Interior edges that do not fit.
        open_edges: usize,
    },
    /// A part of the slave went through the surface of the master.
    #[error(
        "slave facet {facet} goes through the surface of the master in one step: a part of it that was {before:.3e} before the master is {after:.3e} from it now, \
         deeper than contact reaches; take smaller steps"
    )]
    Passed {
        /// Local number of the slave facet.
        facet: u32,
        /// Its gap at the start of the step.
        before: f64,
        /// Its gap at the end.
        after: f64,
    },
    /// A joint cannot be evaluated.
    #[error("joint {joint}: {reason}")]
    Joint {
        /// Its name.
        joint: String,
        /// What is wrong.
        reason: String,
    },
    /// History bytes do not fit.
    #[error("contact history does not fit this model: {reason}")]
    History {
        /// What does not fit.
        reason: String,
    },
}
