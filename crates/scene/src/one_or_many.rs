//! A value or a list of them.

use crate::read::{Node, Value};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Serialize;
use toml::de::DeValue;

/// One value or a list of them; see [`OneOrMany::as_slice`].
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "{T}s"))]
#[serde(untagged)]
pub enum OneOrMany<T> {
    /// A single one.
    One(T),
    /// Several, in their order.
    Many(Vec<T>),
}

impl<C, T: Value<C>> Value<C> for OneOrMany<T> {
    fn read(node: &Node<'_>, context: &C) -> Option<Self> {
        match node.value {
            DeValue::Array(_) => node.list(|node| T::read(node, context)).map(Self::Many),
            _ => T::read(node, context).map(Self::One),
        }
    }
}

impl<T> Default for OneOrMany<T> {
    fn default() -> Self {
        Self::Many(Vec::new())
    }
}

impl<T> OneOrMany<T> {
    /// The values in their order.
    pub fn as_slice(&self) -> &[T] {
        match self {
            Self::One(value) => std::slice::from_ref(value),
            Self::Many(values) => values,
        }
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.as_slice().is_empty()
    }
}
