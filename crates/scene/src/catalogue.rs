//! What scenes have of the rows of catalogues (`stoss_registry::Row`): parameters by key, and the schema of a row.

#[cfg(feature = "schema")]
use crate::Dimension;
#[cfg(feature = "schema")]
use schemars::{JsonSchema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stoss_registry::Given;
#[cfg(feature = "schema")]
use stoss_registry::{Row, Unit};

/// A parameter that is given for a row of a catalogue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Parameter {
    /// `key = 1.0`
    Number(f64),
    /// `key = [1.0, 2.0]`
    List(Vec<f64>),
}

/// Parameters by key as a row takes them.
pub fn given(parameters: &BTreeMap<String, Parameter>) -> impl Iterator<Item = (&str, Given<'_>)> {
    parameters.iter().map(|(name, value)| {
        let given = match value {
            Parameter::Number(value) => Given::Number(*value),
            Parameter::List(values) => Given::List(values),
        };
        (name.as_str(), given)
    })
}

/// Keys of a table with their schemas.
#[cfg(feature = "schema")]
pub(crate) fn properties<T: JsonSchema>(generator: &mut SchemaGenerator) -> serde_json::Map<String, serde_json::Value> {
    match T::json_schema(generator).get("properties") {
        Some(serde_json::Value::Object(properties)) => properties.clone(),
        _ => serde_json::Map::new(),
    }
}

/// The schema of a law with its parameters, and with further properties, none of which is needed.
#[cfg(feature = "schema")]
pub(crate) fn schema<T>(row: &Row<T>, mut properties: serde_json::Map<String, serde_json::Value>) -> serde_json::Value {
    properties.insert("law".into(), serde_json::json!({ "type": "string", "const": row.name }));
    for parameter in row.parameters() {
        let dimension = match parameter.unit {
            Unit::Stress => Dimension::Stress,
            Unit::Velocity => Dimension::Velocity,
            Unit::Number => Dimension::Number,
        };
        let value = match parameter.is_list() {
            true => serde_json::json!({
                "type": "array", "items": { "type": "number", "format": "double" }, "minItems": 1,
                "description": parameter.about, "x-dimension": dimension,
            }),
            false => serde_json::json!({
                "type": "number", "format": "double", "description": parameter.about, "x-dimension": dimension,
            }),
        };
        properties.insert(parameter.name.into(), value);
    }
    // Of several ways to give the parameters none is needed.
    let needed = if let [way] = row.ways { *way } else { &[] };
    let required: Vec<&str> = std::iter::once("law").chain(needed.iter().map(|p| p.name)).collect();
    serde_json::json!({
        "description": row.about, "type": "object", "properties": properties,
        "required": required, "additionalProperties": false,
    })
}
