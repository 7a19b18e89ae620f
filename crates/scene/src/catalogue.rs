//! What scenes have of the rows of catalogues (`stoss_registry::Row`): parameters by key, and the schema of a row.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::read::{Node, Table};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
#[cfg(feature = "schema")]
use stoss_registry::Unit;
use stoss_registry::{Given, Row, Values};
use toml::de::DeValue;

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

/// The parameters of a row, if it makes something of them.
pub(crate) fn of_row<T>(table: &Table<'_>, entry: &Row<T>) -> Option<BTreeMap<String, Parameter>> {
    let read = |n: &Node<'_>, values: Values| match values {
        Values::Any => n.number(),
        Values::Positive => n.positive(),
        Values::NotNegative => n.not_negative(),
        Values::NotZero => n.not_zero(),
        Values::Poisson => poisson(n),
    };
    let way = match entry.way(|name| table.has(name)) {
        Ok(way) => way,
        Err(refusal) => {
            // What is there is looked at all the same.
            entry.parameters().filter(|p| table.has(p.name)).for_each(|p| {
                table.optional(p.name, |n| read(n, p.values));
            });
            return table.fail(refusal.parameter, refusal.message, refusal.remedy);
        }
    };
    let others = entry.ways.iter().enumerate().filter(|(other, _)| *other != way).flat_map(|(_, way)| way.iter());
    others.for_each(|parameter| {
        table.get(parameter.name);
    });
    let values: Vec<_> = entry.ways[way]
        .iter()
        .map(|parameter| {
            let example = format!("{} = {}", parameter.name, parameter.example);
            let value = table.required(parameter.name, &example, |n| {
                if !parameter.is_list() {
                    return read(n, parameter.values).map(Parameter::Number);
                }
                let list = n.list(|n| read(n, parameter.values))?;
                if list.is_empty() {
                    return n.fail("must have one term or more", format!("write for instance {}", parameter.example));
                }
                Some(Parameter::List(list))
            });
            Some((parameter.name.to_owned(), value?))
        })
        .collect();
    let parameters: BTreeMap<String, Parameter> = values.into_iter().collect::<Option<_>>()?;
    if let Err(refusal) = entry.with(given(&parameters)) {
        return table.fail(refusal.parameter, refusal.message, refusal.remedy);
    }
    Some(parameters)
}

/// The keys that nobody asked for, numbers and lists of numbers; which there are is the business of a law that is not in the catalogue.
pub(crate) fn law_parameters(table: &Table<'_>) -> Option<BTreeMap<String, Parameter>> {
    let parameters: Vec<_> = table
        .rest()
        .map(|(key, node)| {
            let value = match node.value {
                DeValue::Array(_) => node.list(Node::number).map(Parameter::List),
                _ => node.number().map(Parameter::Number),
            };
            Some((key.to_owned(), value?))
        })
        .collect();
    parameters.into_iter().collect()
}

/// Poisson's ratio.
pub(crate) fn poisson(node: &Node<'_>) -> Option<f64> {
    let value = node.number()?;
    if value == 0.5 {
        return node.fail(
            "must be below 0.5: that is an incompressible body, with an infinite bulk modulus and a pressure that is no function of the displacements",
            "use 0.49; of a body with `volumetric = \"mixed\"` up to 0.499999, without it elements lock from 0.495 on",
        );
    }
    if value <= -1.0 || value >= 0.5 {
        return node.fail(
            "must lie between -1 and 0.5, both excluded",
            "use for instance 0.3, 0.49 for rubber, or up to 0.499999 for a body with `volumetric = \"mixed\"`",
        );
    }
    Some(value)
}
