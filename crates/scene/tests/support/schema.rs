//! A validator for the part of JSON schema (draft 2020-12) that occurs in the scene's schema. Anything else is an error.

use serde_json::{Map, Value};

/// Violations of `schema` by `value`, as text; empty if the value is valid.
pub fn violations(schema: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(schema, schema, value, "", &mut found);
    found
}

fn resolve<'a>(root: &'a Value, reference: &str) -> &'a Value {
    root.pointer(reference.strip_prefix('#').expect("local reference")).expect("reference to a definition")
}

fn check(root: &Value, schema: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    let schema = match schema {
        Value::Bool(true) => return,
        Value::Bool(false) => return found.push(format!("{path}: is refused")),
        Value::Object(schema) => schema,
        other => panic!("schema {other}"),
    };
    for (keyword, argument) in schema {
        match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "default" | "format" | "x-dimension" => {}
            "$ref" => check(root, resolve(root, argument.as_str().unwrap()), value, path, found),
            "type" => check_type(argument, value, path, found),
            "const" => {
                if value != argument {
                    found.push(format!("{path}: must be {argument}"));
                }
            }
            "enum" => {
                if !argument.as_array().unwrap().contains(value) {
                    found.push(format!("{path}: must be one of {argument}"));
                }
            }
            "anyOf" | "oneOf" => {
                let fits = argument.as_array().unwrap().iter().filter(|branch| {
                    let mut inner = Vec::new();
                    check(root, branch, value, path, &mut inner);
                    inner.is_empty()
                });
                let count = fits.count();
                if count == 0 || (keyword == "oneOf" && count > 1) {
                    found.push(format!("{path}: fits {count} branches"));
                }
            }
            "allOf" => argument.as_array().unwrap().iter().for_each(|part| check(root, part, value, path, found)),
            "if" => {
                let mut others = Vec::new();
                check(root, argument, value, path, &mut others);
                if others.is_empty() {
                    check(root, &schema["then"], value, path, found);
                }
            }
            "then" => {}
            "minimum" => bound(value, argument, path, found, |v, b| v >= b),
            "maximum" => bound(value, argument, path, found, |v, b| v <= b),
            "minItems" => items(value, argument, path, found, |n, b| n >= b),
            "maxItems" => items(value, argument, path, found, |n, b| n <= b),
            "items" => {
                for (i, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(root, argument, item, &format!("{path}[{i}]"), found);
                }
            }
            "properties" | "additionalProperties" => {}
            "required" => {
                if let Value::Object(object) = value {
                    let names = argument.as_array().unwrap().iter().map(|name| name.as_str().unwrap());
                    found.extend(
                        names.filter(|name| !object.contains_key(*name)).map(|name| format!("{path}: no {name}")),
                    );
                }
            }
            other => panic!("{path}: keyword {other} is not known to this validator"),
        }
    }
    if let Value::Object(object) = value {
        check_properties(root, schema, object, path, found);
    }
}

fn check_properties(
    root: &Value,
    schema: &Map<String, Value>,
    object: &Map<String, Value>,
    path: &str,
    found: &mut Vec<String>,
) {
    let properties = schema.get("properties").and_then(Value::as_object);
    for (key, value) in object {
        match (properties.and_then(|p| p.get(key)), schema.get("additionalProperties")) {
            (Some(property), _) => check(root, property, value, &format!("{path}.{key}"), found),
            (None, Some(Value::Bool(false))) => found.push(format!("{path}: unknown key {key}")),
            (None, None | Some(Value::Bool(true))) => {}
            (None, Some(other)) => check(root, other, value, &format!("{path}.{key}"), found),
        }
    }
}

fn check_type(argument: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    let is = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("type {other}"),
    };
    let fits = match argument {
        Value::String(name) => is(name),
        Value::Array(names) => names.iter().any(|name| is(name.as_str().unwrap())),
        other => panic!("type {other}"),
    };
    if !fits {
        found.push(format!("{path}: must be of type {argument}"));
    }
}

fn bound(value: &Value, argument: &Value, path: &str, found: &mut Vec<String>, holds: impl Fn(f64, f64) -> bool) {
    if value.as_f64().is_some_and(|v| !holds(v, argument.as_f64().unwrap())) {
        found.push(format!("{path}: beyond the bound {argument}"));
    }
}

fn items(value: &Value, argument: &Value, path: &str, found: &mut Vec<String>, holds: impl Fn(u64, u64) -> bool) {
    if value.as_array().is_some_and(|v| !holds(v.len() as u64, argument.as_u64().unwrap())) {
        found.push(format!("{path}: wrong length, bound {argument}"));
    }
}

/// Paths of properties without a description, tags of variants and properties that are refused aside.
pub fn undocumented(schema: &Value) -> Vec<String> {
    let mut found = Vec::new();
    collect(schema, "", &mut found);
    found
}

fn collect(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            for (key, inner) in object {
                if key == "properties" {
                    for (name, property) in inner.as_object().unwrap() {
                        if property != &Value::Bool(false)
                            && property.get("description").is_none()
                            && property.get("const").is_none()
                        {
                            found.push(format!("{path}.{name}"));
                        }
                    }
                }
                collect(inner, &format!("{path}/{key}"), found);
            }
        }
        Value::Array(values) => values.iter().for_each(|inner| collect(inner, path, found)),
        _ => {}
    }
}

/// Paths of properties with numbers, or lists of numbers, that do not say which dimension they have; and of those that say one that there is not.
pub fn without_dimension(schema: &Value, names: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    collect_without_dimension(schema, schema, names, "", &mut found);
    found
}

fn collect_without_dimension(root: &Value, value: &Value, names: &[&str], path: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            let properties = object.get("properties").and_then(Value::as_object);
            for (name, property) in properties.into_iter().flatten() {
                let is_name =
                    |value: &Value| value.as_str().is_some_and(|text| names.contains(&text) || text.contains("as "));
                let is_dimension = match property.get("x-dimension") {
                    None => !is_numeric(root, property),
                    Some(Value::Array(choices)) => choices.iter().all(is_name),
                    Some(dimension) => is_name(dimension),
                };
                if !is_dimension {
                    found.push(format!("{path}.{name}"));
                }
            }
            for (key, inner) in object {
                collect_without_dimension(root, inner, names, &format!("{path}/{key}"), found);
            }
        }
        Value::Array(values) => {
            values.iter().for_each(|inner| collect_without_dimension(root, inner, names, path, found));
        }
        _ => {}
    }
}

/// Whether a value may be a number that is not whole, or hold some outside of the properties of a table.
fn is_numeric(root: &Value, schema: &Value) -> bool {
    let is_number = match &schema["type"] {
        Value::String(name) => name == "number",
        Value::Array(names) => names.iter().any(|name| name == "number"),
        _ => false,
    };
    let referred = schema.get("$ref").and_then(Value::as_str).map(|reference| resolve(root, reference));
    let choices = ["anyOf", "oneOf"].iter().filter_map(|key| schema.get(key)?.as_array()).flatten();
    let inner = ["items", "additionalProperties"].iter().filter_map(|key| schema.get(key));
    is_number || referred.into_iter().chain(choices).chain(inner).any(|schema| is_numeric(root, schema))
}
