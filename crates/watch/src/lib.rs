//! An independent watch on runs: do bodies penetrate each other, has a node passed through a body, are the elements sound?
//!
//! It knows positions and elements, and nothing of contact: no pairs, no search, no projection of a contact method. All pairs of
//! bodies are checked, and every body against itself. What is inside is decided by counting crossings of a ray with exact
//! predicates.
//!
//! The surface of a hexahedron's face is four triangles about its centre, the mean of its four nodes; so is that of a quadrilateral facet of a
//! rigid body. A rigid surface that is closed is a body like the others. An open one has no inside: what is wrong there is an edge that runs through it,
//! or a node that has passed it since the last check.
//!
//! [`Watch`] checks the geometry of one state, or of two consecutive states; [`BalanceWatch`] compares momenta and energy with what must be conserved; what contacts
//! report of their points is in [`ContactState`]; [`Judge`] collects the findings of a run and gives the [`Verdict`].
//!
//! # What it does not see
//! Edges that pass through each other between two checked states while no node does; what enters a body and leaves it
//! on the same side between two states; a fold of a body that is not deep enough to reach an element that shares no node with it; a rigid body in itself; a
//! body that creeps through an open surface between its facets' edges without an edge of its own in it.
//!
#![doc = include_str!("../README.md")]

mod balance;
mod cone;
mod contact;
mod curved;
mod finding;
mod kept;
mod locking;
mod meeting;
mod names;
mod observe;
mod pairs;
mod predicates;
mod solids;
mod standing;
mod surface;
mod sweep;
mod verdict;
mod words;

pub use balance::{BalanceState, BalanceWatch, ClosingJudgement, Promises, Resolution};
pub use contact::{ContactPoint, ContactState, PointFriction};
pub use finding::{Finding, FindingKind, Severity};
pub use kept::KeptGaps;
pub use locking::{Elasticity, StrainEnergies};
pub use meeting::Meeting;
pub use observe::{Observation, Penetration, Tunnelling, Watch};
pub use solids::SolidObservation;
pub use verdict::{Judge, Limits, Verdict};

use std::ops::Range;
use stoss_mesh::Elements;

/// A body.
#[derive(Clone, Debug)]
pub struct WatchBody {
    /// Name in messages.
    pub name: String,
    /// Global numbers of its nodes.
    pub nodes: Range<u32>,
    /// Elements or facets that it consists of.
    pub shape: WatchShape,
}

/// What a body consists of.
#[derive(Clone, Debug)]
pub enum WatchShape {
    /// Elements with global node numbers.
    Solid(Elements),
    /// The surface of a rigid body.
    Surface {
        /// Facets of the surface.
        facets: Vec<WatchFacet>,
        /// Whether it encloses a volume.
        is_closed: bool,
    },
}

/// A facet of a rigid surface: global node numbers, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WatchFacet {
    /// A triangle.
    Triangle([u32; 3]),
    /// A quadrilateral.
    Quadrilateral([u32; 4]),
}

impl WatchFacet {
    /// The corners.
    pub fn corners(&self) -> &[u32] {
        match self {
            Self::Triangle(corners) => corners,
            Self::Quadrilateral(corners) => corners,
        }
    }
}

impl WatchBody {
    /// Elements of the body; none of a rigid body.
    pub(crate) fn elements(&self) -> Option<&Elements> {
        match &self.shape {
            WatchShape::Solid(elements) => Some(elements),
            WatchShape::Surface { .. } => None,
        }
    }
}

/// Nodes of two tied surfaces: penetrations between these two bodies at these nodes are ignored.
#[derive(Clone, Debug)]
pub struct TiedPair {
    /// Global numbers of the nodes of both tied surfaces.
    pub nodes: Vec<u32>,
    /// The two bodies.
    pub bodies: [usize; 2],
}

/// The model that is watched.
#[derive(Clone, Debug)]
pub struct WatchModel {
    /// The bodies.
    pub bodies: Vec<WatchBody>,
    /// Reference positions, three a node, node after node (lengths).
    pub reference: Vec<f64>,
    /// Ties.
    pub ties: Vec<TiedPair>,
}

/// Why a watch cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WatchError {
    /// A node that does not exist.
    #[error("element or facet {element} of `{body}` names node {node}, but there are {nodes}")]
    Node {
        /// The body.
        body: String,
        /// Element of the body, or facet.
        element: usize,
        /// The node.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
}
