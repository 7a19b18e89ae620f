//! Rows of tables that a scene chooses by their names.

use crate::read::{Node, Value};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};
#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::fmt;
use std::ops::Deref;

/// A table of which scenes choose rows.
pub trait Rows: Sized + 'static {
    /// All rows of the table.
    const ROWS: &'static [Self];
    /// Name and title of the table in the schema.
    const TITLE: [&'static str; 2];
    /// Name of a row.
    fn name(&self) -> &'static str;
    /// What it is, in sentences.
    fn about(&self) -> String;
}

/// A row of a table, chosen by its name.
pub struct Chosen<T: Rows>(&'static T);

impl<T: Rows> Chosen<T> {
    /// Names of all rows.
    pub fn names() -> Vec<&'static str> {
        T::ROWS.iter().map(T::name).collect()
    }

    /// The row of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        T::ROWS.iter().find(|row| row.name() == name).map(Self)
    }

    /// The row.
    pub fn row(&self) -> &'static T {
        self.0
    }
}

impl<T: Rows> Clone for Chosen<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Rows> Copy for Chosen<T> {}

impl<T: Rows> Deref for Chosen<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.0
    }
}

impl<T: Rows> PartialEq for Chosen<T> {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl<T: Rows> fmt::Display for Chosen<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl<T: Rows> fmt::Debug for Chosen<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl<T: Rows> Serialize for Chosen<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<C, T: Rows> Value<C> for Chosen<T> {
    fn read(node: &Node<'_>, _: &C) -> Option<Self> {
        node.choice(&Self::names(), Self::from_name)
    }
}

#[cfg(feature = "schema")]
impl<T: Rows> JsonSchema for Chosen<T> {
    fn schema_name() -> Cow<'static, str> {
        T::TITLE[0].into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let row = |row: &T| serde_json::json!({ "type": "string", "const": row.name(), "description": row.about() });
        json_schema!({ "description": T::TITLE[1], "oneOf": T::ROWS.iter().map(row).collect::<Vec<_>>() })
    }
}

/// The names of rows of which something holds, for messages.
pub(crate) fn of_which<T: Rows>(holds: impl Fn(&T) -> bool) -> String {
    let names: Vec<String> = T::ROWS.iter().filter(|row| holds(row)).map(|row| format!("`{}`", row.name())).collect();
    names.join(", ")
}
