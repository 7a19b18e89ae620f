//! What a deck says of nodes that are joined: equations, couplings, rigid bodies, pretension, springs.

use super::{DeckPlace, Target};

/// A linear equation between degrees of freedom (`*EQUATION`): the sum of factor times displacement is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Equation {
    /// Terms of the equation.
    pub terms: Vec<EquationTerm>,
    /// Place of the equation.
    pub place: DeckPlace,
}

/// A term of an [`Equation`].
#[derive(Debug, Clone, PartialEq)]
pub struct EquationTerm {
    /// The node, or a set of nodes: then there is an equation for each.
    pub nodes: Target,
    /// The degree of freedom, counted from 0: 0 to 2 are displacements, 3 to 5 rotations.
    pub freedom: usize,
    /// The factor.
    pub factor: f64,
}

/// A multi-point constraint with a law of its own (`*MPC`).
#[derive(Debug, Clone, PartialEq)]
pub struct MultiPoint {
    /// The law in upper case, as `PLANE`.
    pub kind: String,
    /// Nodes of the constraint.
    pub nodes: Vec<u64>,
    /// Place of the constraint.
    pub place: DeckPlace,
}

/// How nodes follow a reference node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Following {
    /// The nodes move as a rigid body.
    Kinematic,
    /// The nodes follow in the mean.
    Distributing,
}

/// The nodes that follow a reference node.
#[derive(Debug, Clone, PartialEq)]
pub enum Followers {
    /// Nodes of a surface.
    Surface(String),
    /// Nodes of a node set, or single nodes, with their weights.
    Nodes(Vec<(Target, f64)>),
    /// Nodes of the elements of a set.
    Elements(String),
}

/// Nodes that follow a reference node (`*COUPLING`, `*DISTRIBUTING COUPLING`, `*RIGID BODY`).
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    /// The keyword, as `*COUPLING`.
    pub keyword: &'static str,
    /// The reference node, by its number or a set with it.
    pub node: Target,
    /// A second node whose displacements are the rotations of the first (`ROT NODE`).
    pub rotations: Option<Target>,
    /// The nodes.
    pub followers: Followers,
    /// How they follow; nothing if no keyword after it said so.
    pub following: Option<Following>,
    /// Degrees of freedom that are coupled, counted from 0.
    pub freedoms: [bool; 6],
    /// Place of the coupling.
    pub place: DeckPlace,
}

/// A section of a bolt that is tightened (`*PRE-TENSION SECTION`).
#[derive(Debug, Clone, PartialEq)]
pub struct Pretension {
    /// The surface at which solids are cut.
    pub surface: Option<String>,
    /// The beam that is cut.
    pub element: Option<u64>,
    /// The node whose first degree of freedom is the opening of the cut; a force there is that of the bolt.
    pub node: Target,
    /// Normal of the section; that of the surface if it is not given.
    pub normal: Option<[f64; 3]>,
    /// Place of the section.
    pub place: DeckPlace,
}

/// An element that is no solid: a spring, a dashpot, a mass, a beam, with its nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Connection {
    /// Type of the element in upper case, as `SPRINGA`.
    pub kind: String,
    /// Number of the element.
    pub number: u64,
    /// Nodes of the element.
    pub nodes: Vec<u64>,
    /// The element set that its keyword names.
    pub set: Option<String>,
    /// Place of the element.
    pub place: DeckPlace,
}

/// What the connections of a set are (`*SPRING`, `*DASHPOT`, `*MASS`).
#[derive(Debug, Clone, PartialEq)]
pub struct ConnectionSection {
    /// The keyword, as `*SPRING`.
    pub keyword: &'static str,
    /// The element set.
    pub elements: String,
    /// Degrees of freedom of its ends, counted from 0; none of elements that act along their line.
    pub freedoms: Vec<usize>,
    /// Stiffness (force per length), damping (force per velocity) or mass.
    pub value: f64,
    /// Place of the section.
    pub place: DeckPlace,
}

/// A change at the beginning of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Kind of the change.
    pub kind: ChangeKind,
    /// Place of the change.
    pub place: DeckPlace,
}

/// What a step changes.
#[derive(Debug, Clone, PartialEq)]
pub enum ChangeKind {
    /// The friction of an interaction (`*CHANGE FRICTION`).
    Friction(String, super::Friction),
    /// The law of an interaction (`*CHANGE SURFACE BEHAVIOR`).
    Behavior(String, super::SurfaceBehavior),
    /// A contact pair begins to act, or ends (`*MODEL CHANGE, TYPE=CONTACT PAIR`).
    Contact {
        /// The slave surface.
        slave: String,
        /// The master surface.
        master: String,
        /// Whether it acts from now on.
        acts: bool,
    },
}
