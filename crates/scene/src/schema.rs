//! The JSON schema of the scene format.

use crate::Scene;

/// JSON schema (draft 2020-12) of the scene format, generated from the types and their documentation; ends with a line feed.
pub fn json_schema() -> String {
    let schema = schemars::schema_for!(Scene);
    // A schema is a JSON value with string keys: printing cannot fail.
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}
