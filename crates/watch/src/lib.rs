//! An independent watch on runs: are bodies inside each other, has anything passed through a body, are the elements sound?
//!
//! It knows positions and elements, and nothing of contact: no pairs, no search, no projection of a contact method. All pairs of
//! bodies are looked at, and every body against itself. What is inside is decided by counting crossings of a ray with exact
//! predicates.
//!
//! The surface of a hexahedron's face is four triangles about its centre, the mean of its four nodes.
//!
//! [`Watch`] looks at one state, or at two states in a row; [`BalanceWatch`] compares momenta and energy with what is promised; what contacts
//! report of their points is in [`ContactState`]; [`Judge`] keeps what was worst in a run and gives the [`Verdict`].
//!
//! # What it does not see
//! Edges that pass through each other between two states that are looked at while no node does; what enters a body and leaves it
//! on the same side between two states; a fold of a body that is not deep enough to reach an element that shares no node with it.

mod balance;
mod contact;
mod finding;
mod observe;
mod pairs;
mod solids;
mod surface;
mod sweep;
mod verdict;

pub use balance::{BalanceState, BalanceWatch, Promises};
pub use contact::{ContactPoint, ContactState, PointFriction};
pub use finding::{Finding, FindingKind, Level};
pub use observe::{Observation, Penetration, Tunnelling, Watch};
pub use solids::SolidObservation;
pub use verdict::{Judge, Limits, Verdict};

use std::ops::Range;

/// A body of hexahedra.
#[derive(Clone, Debug)]
pub struct WatchBody {
    /// Name for sentences.
    pub name: String,
    /// Global numbers of its nodes.
    pub nodes: Range<u32>,
    /// Global node numbers of each hexahedron: the bottom counter-clockwise seen from the top, then the top.
    pub hexahedra: Vec<[u32; 8]>,
}

/// Nodes that a tie holds together: they are no concern between these two bodies.
#[derive(Clone, Debug)]
pub struct TiedPair {
    /// Global numbers of the nodes of both tied surfaces.
    pub nodes: Vec<u32>,
    /// The two bodies.
    pub bodies: [usize; 2],
}

/// What is watched.
#[derive(Clone, Debug)]
pub struct WatchModel {
    /// The bodies.
    pub bodies: Vec<WatchBody>,
    /// Reference positions, three a node, node after node (lengths).
    pub reference: Vec<f64>,
    /// Ties.
    pub ties: Vec<TiedPair>,
}

/// Why there can be no watch.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WatchError {
    /// A node that does not exist.
    #[error("element {element} of `{body}` names node {node}, but there are {nodes}")]
    Node {
        /// The body.
        body: String,
        /// Its element.
        element: usize,
        /// The node.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
}
