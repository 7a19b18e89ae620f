//! Names of bodies and nodes in sentences.

use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Bodies with their names and nodes: sentences count nodes within their body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Names {
    bodies: Vec<String>,
    nodes: Vec<Range<u32>>,
}

impl FromIterator<(String, Range<u32>)> for Names {
    fn from_iter<T: IntoIterator<Item = (String, Range<u32>)>>(bodies: T) -> Self {
        let (bodies, nodes) = bodies.into_iter().unzip();
        Self { bodies, nodes }
    }
}

impl Names {
    /// Name of a body.
    pub fn body(&self, body: usize) -> &str {
        &self.bodies[body]
    }

    /// Name of a node in messages: its number in its body, or in the model if it belongs to no body.
    pub fn node(&self, node: u32) -> String {
        match self.nodes.iter().position(|nodes| nodes.contains(&node)) {
            Some(body) => format!("node {} of `{}`", node - self.nodes[body].start, self.bodies[body]),
            None => format!("node {node} of the model"),
        }
    }
}
