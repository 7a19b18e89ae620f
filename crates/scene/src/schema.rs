//! The JSON schema of the scene format.

use crate::Scene;
use serde_json::{Value, json};

/// JSON schema (draft 2020-12) of the scene format, generated from the types and their documentation; ends with a line feed.
pub fn json_schema() -> String {
    let mut schema = schemars::schema_for!(Scene).to_value();
    allow_expressions(&mut schema);
    // A schema is a JSON value with string keys: printing cannot fail.
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}

/// A number may also be a string with an expression.
fn allow_expressions(schema: &mut Value) {
    match schema {
        Value::Object(table) => {
            if let Some(kind) = table.get_mut("type") {
                match kind {
                    Value::String(name) if is_numeric(name) => *kind = json!([name, "string"]),
                    Value::Array(names) if names.iter().any(|name| name.as_str().is_some_and(is_numeric)) => {
                        names.push(json!("string"));
                    }
                    _ => {}
                }
            }
            table.values_mut().for_each(allow_expressions);
        }
        Value::Array(list) => list.iter_mut().for_each(allow_expressions),
        _ => {}
    }
}

fn is_numeric(name: &str) -> bool {
    matches!(name, "number" | "integer")
}
