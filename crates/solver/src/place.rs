//! A place in a model, by numbers.

use serde::{Deserialize, Serialize};

/// A place in a model, by numbers of a node, an element or a slot; what does not apply is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Global number of a vector: a node, or the centre or a director of a rigid body.
    pub node: Option<u32>,
    /// Component of the position (0, 1, 2).
    pub component: Option<u8>,
    /// Number of a body in [`crate::Model::bodies`] and of an element in it.
    pub element: Option<(usize, usize)>,
    /// Number of a pair in [`crate::Model::contacts`] and of a slot of it.
    pub slot: Option<(usize, usize)>,
}

impl Place {
    /// A node.
    pub(crate) fn of_node(node: u32) -> Self {
        Self { node: Some(node), ..Self::default() }
    }
}
