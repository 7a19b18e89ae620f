//! `docs/guide/reference.md`: every key of a scene, from the schema that `stoss schema` prints and the shipped scenes.
//!
//! A section for each table of a scene, then one for each type that several keys share. What a key is for is its doc comment in
//! `crates/scene`; nothing is written here by hand.

use serde_json::{Map, Value};
use std::fmt::Write;

/// A shipped scene: its name, and its text.
pub struct Sample {
    pub name: String,
    pub text: String,
}

/// The page, from the schema and the scenes among which its examples are sought.
pub fn page(schema: &Value, samples: &[Sample]) -> Result<String, String> {
    let definitions = object(schema, "$defs")?;
    let tables = object(schema, "properties")?;
    let required = required(schema);
    let mut text = String::from(
        "# Reference of the scene file\n\n\
         Every table of a scene with its keys. This page is written by `cargo xtask schema` from the schema of the program \
         (`stoss schema`); [the pages of the guide](README.md) say what the keys are for.\n\n\
         * A key is needed if its default is *needed*; *none* is nothing, or what its description says.\n\
         * A *number* may be a string with an [expression](scene.md) over the parameters, for instance `\"2*radius\"`.\n\
         * *Unit* is what a number measures, in the system of units of the scene ([units](units.md)). An angle is in degrees, an angular velocity in radians \
         per time; \"-\" is no unit. Where there are two, the description says which one applies.\n\
         * An example is the shortest of its kind among the shipped scenes.\n\n",
    );
    let names: Vec<String> = tables.keys().map(|name| format!("[`{name}`](#{name})")).collect();
    writeln!(text, "Tables: {}.\n", names.join(", ")).unwrap();
    for (name, schema) in tables {
        let (heading, inner) = table(name, schema, definitions);
        writeln!(text, "## `{heading}`\n").unwrap();
        let needed = if required.contains(&name.as_str()) { " Needed." } else { "" };
        let description = [own_words(inner), own_words(schema)].into_iter().max_by_key(String::len).unwrap_or_default();
        let description = without_heading(&description, &heading);
        writeln!(text, "{description}{needed}\n").unwrap();
        body(&mut text, inner);
        if let Some((scene, example)) = example(&heading, samples) {
            writeln!(text, "From `scenes/{scene}`:\n\n```toml\n{example}\n```\n").unwrap();
        }
    }
    text.push_str("# Types\n\n");
    let direct: Vec<&Value> = tables.iter().map(|(name, schema)| table(name, schema, definitions).1).collect();
    for (name, definition) in definitions {
        if direct.iter().any(|used| std::ptr::eq(*used, definition)) {
            continue;
        }
        writeln!(text, "## {name}\n").unwrap();
        let description = own_words(definition);
        if !description.is_empty() {
            writeln!(text, "{description}\n").unwrap();
        }
        body(&mut text, definition);
    }
    Ok(format!("{}\n", text.trim_end()))
}

/// A description that begins with the name of its table, without it.
fn without_heading(description: &str, heading: &str) -> String {
    let Some(rest) = description.strip_prefix(&format!("`{heading}`")) else {
        return description.to_owned();
    };
    let rest = rest.trim_start_matches([':', '.', ',', ';', ' ']);
    let mut letters = rest.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Heading of a table of the scene, and the definition of its keys.
fn table<'a>(name: &str, schema: &'a Value, definitions: &'a Map<String, Value>) -> (String, &'a Value) {
    if let Some(items) = schema.get("items") {
        return (format!("[[{name}]]"), resolved(items, definitions));
    }
    (format!("[{name}]"), resolved(without_null(schema), definitions))
}

/// Keys, variants or values of a definition.
fn body(text: &mut String, definition: &Value) {
    if definition.get("properties").is_some() {
        return keys(text, definition);
    }
    let Some(variants) = alternatives(definition) else {
        return;
    };
    if variants.iter().all(|variant| variant.get("const").is_some()) {
        text.push_str("| value | |\n|---|---|\n");
        for variant in variants {
            writeln!(text, "| {} | {} |", value(&variant["const"]), cell(&own_words(variant))).unwrap();
        }
        text.push('\n');
        return;
    }
    for variant in variants {
        let words = own_words(variant);
        match tag(variant) {
            Some((key, name)) => writeln!(text, "**`{key} = {name}`**: {words}\n").unwrap(),
            None => writeln!(text, "* {}{}\n", kind(variant), separated(&words)).unwrap(),
        }
        if variant.get("properties").is_some() {
            keys(text, variant);
        }
    }
}

/// The table of the keys of an object; the key that tells variants apart is left to their headings.
fn keys(text: &mut String, object: &Value) {
    let Some(properties) = object["properties"].as_object() else {
        return;
    };
    let required = required(object);
    let tag = tag(object).map(|(key, _)| key);
    let rows: Vec<_> = properties.iter().filter(|(key, _)| Some(key.as_str()) != tag).collect();
    if rows.is_empty() {
        return;
    }
    text.push_str("| key | type | unit | default | meaning |\n|---|---|---|---|---|\n");
    for (key, schema) in rows {
        let words = cell(&own_words(schema));
        let default = match (schema.get("default"), left_out(&words)) {
            (Some(default), _) => value(default),
            _ if required.contains(&key.as_str()) => "*needed*".into(),
            (None, Some(default)) => default.to_owned(),
            (None, None) => "*none*".into(),
        };
        writeln!(text, "| `{key}` | {} | {} | {default} | {words} |", cell(&kind(schema)), unit(schema)).unwrap();
    }
    text.push('\n');
}

/// What a key measures, as its `x-dimension` says.
fn unit(schema: &Value) -> String {
    let name = |dimension: &Value| match dimension.as_str() {
        None | Some("number") => "-".to_owned(),
        Some(name) => name.replace('_', " "),
    };
    match &schema["x-dimension"] {
        Value::Array(choices) => choices.iter().map(name).collect::<Vec<_>>().join(" or "),
        dimension => name(dimension),
    }
}

/// What a description says that a key is "if left out".
fn left_out(words: &str) -> Option<&str> {
    let (before, _) = words.split_once(" if left out")?;
    let start =
        ["; ", ". ", ", ", ": "].iter().filter_map(|mark| Some(before.rfind(mark)? + mark.len())).max().unwrap_or(0);
    Some(&before[start..]).filter(|default| !default.is_empty() && !default.ends_with([';', '.', ',', ':']))
}

/// Type of a value in words, with links to the types of this page.
fn kind(schema: &Value) -> String {
    if let Some(reference) = schema.get("$ref").and_then(Value::as_str) {
        let name = reference.rsplit('/').next().unwrap_or(reference);
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(constant) = schema.get("const") {
        return value(constant);
    }
    if let Some(variants) = alternatives(schema) {
        let kinds: Vec<_> = variants.iter().filter(|variant| !is_null(variant)).map(kind).collect();
        return kinds.join(" or ");
    }
    let names: Vec<&str> = match &schema["type"] {
        Value::String(name) => vec![name],
        Value::Array(names) => names.iter().filter_map(Value::as_str).filter(|name| *name != "null").collect(),
        _ => return "any".into(),
    };
    let range = range(schema);
    let name = |sought: &str| names.contains(&sought);
    if name("array") {
        let items = kind(&schema["items"]);
        return match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
            (Some(least), Some(most)) if least == most => format!("{least} of {items}"),
            _ => format!("list of {items}"),
        };
    }
    if name("number") {
        return format!("number{range}");
    }
    if name("integer") {
        return format!("whole number{range}");
    }
    if name("object") {
        return match schema.get("additionalProperties") {
            Some(values) if values.is_object() => format!("names with {}", kind(values)),
            _ => "table".into(),
        };
    }
    if name("boolean") { "true or false".into() } else { "text".into() }
}

/// ` in [a, b]`, or nothing; 0 as the only bound is the type's.
fn range(schema: &Value) -> String {
    match (schema.get("minimum"), schema.get("maximum")) {
        (Some(least), Some(most)) => format!(" in [{least}, {most}]"),
        _ => String::new(),
    }
}

/// Key and value that tell a variant from the others.
fn tag(variant: &Value) -> Option<(&str, String)> {
    let properties = variant.get("properties")?.as_object()?;
    properties.iter().find_map(|(key, schema)| Some((key.as_str(), schema.get("const")?.to_string())))
}

fn alternatives(schema: &Value) -> Option<&Vec<Value>> {
    schema.get("oneOf").or_else(|| schema.get("anyOf"))?.as_array()
}

fn is_null(schema: &Value) -> bool {
    schema["type"] == "null"
}

/// The alternative of an optional value that is not null.
fn without_null(schema: &Value) -> &Value {
    let variants = alternatives(schema).filter(|variants| variants.iter().any(is_null));
    variants.and_then(|variants| variants.iter().find(|variant| !is_null(variant))).unwrap_or(schema)
}

fn resolved<'a>(schema: &'a Value, definitions: &'a Map<String, Value>) -> &'a Value {
    let name = schema.get("$ref").and_then(Value::as_str).and_then(|reference| reference.rsplit('/').next());
    name.and_then(|name| definitions.get(name)).unwrap_or(schema)
}

fn required(schema: &Value) -> Vec<&str> {
    schema["required"].as_array().map(|names| names.iter().filter_map(Value::as_str).collect()).unwrap_or_default()
}

fn object<'a>(schema: &'a Value, key: &str) -> Result<&'a Map<String, Value>, String> {
    schema.get(key).and_then(Value::as_object).ok_or_else(|| format!("the schema has no `{key}`"))
}

/// A value as it is written in a scene.
fn value(value: &Value) -> String {
    match value {
        Value::Object(_) => "see there".into(),
        other => format!("`{other}`"),
    }
}

/// Description without what only readers of the source need: sections, and links to items.
fn own_words(schema: &Value) -> String {
    let description = schema.get("description").and_then(Value::as_str).unwrap_or_default();
    let words = description.split("\n# ").next().unwrap_or_default().trim().replace("[`", "`").replace("`]", "`");
    words.lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
}

fn separated(words: &str) -> String {
    if words.is_empty() { String::new() } else { format!(": {words}") }
}

/// Text that fits into a cell of a table.
fn cell(words: &str) -> String {
    words.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}

/// The shortest table with this heading that has at least two keys, and its scene.
fn example<'a>(heading: &str, samples: &'a [Sample]) -> Option<(&'a str, String)> {
    let mut found: Vec<(&str, String)> = Vec::new();
    for sample in samples {
        let lines: Vec<&str> = sample.text.lines().collect();
        for start in (0..lines.len()).filter(|&line| lines[line].trim_end() == heading) {
            let rest = lines[start + 1..].iter();
            let block: Vec<&str> = rest.take_while(|line| !line.starts_with('[')).copied().collect();
            let block: Vec<&str> =
                block.into_iter().filter(|line| !line.starts_with('#') && !line.is_empty()).collect();
            if block.len() >= 2 {
                found.push((&sample.name, format!("{heading}\n{}", block.join("\n"))));
            }
        }
    }
    found.into_iter().min_by_key(|(name, text)| (text.len(), name.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn schema() -> Value {
        json!({
            "properties": {
                "wall": { "type": "array", "items": { "$ref": "#/$defs/Wall" }, "description": "`[[wall]]`." },
                "air": { "anyOf": [{ "$ref": "#/$defs/Air" }, { "type": "null" }], "description": "`[air]`." },
            },
            "required": ["wall"],
            "$defs": {
                "Wall": {
                    "description": "`[[wall]]`: a plane that nothing passes.\n\n# How to add one\nInternal.",
                    "properties": {
                        "normal": { "type": "array", "minItems": 3, "maxItems": 3, "items": { "type": ["number", "string"] }, "x-dimension": ["angular_velocity", "force/length³"] },
                        "law": { "$ref": "#/$defs/Law", "default": "dry", "description": "See [`Law`]." },
                        "share": { "type": ["number", "null"], "minimum": 0.0, "maximum": 1.0, "description": "a | b; 0.5 if left out.", "x-dimension": "number" },
                    },
                    "required": ["normal"],
                },
                "Air": { "description": "Drag.", "properties": { "density": { "type": "number" } } },
                "Law": { "oneOf": [
                    { "const": "dry", "description": "No film." },
                    { "const": "wet" },
                ] },
            },
        })
    }

    #[test]
    fn what_is_left_out_is_the_default() {
        assert_eq!(left_out("Speed, positive; 5/6 if left out. More"), Some("5/6"));
        assert_eq!(left_out("With `mass` only; if left out the middle"), None);
        assert_eq!(left_out("Needed."), None);
    }

    #[test]
    fn every_key_has_type_default_and_words() {
        let samples = [
            Sample {
                name: "long.toml".into(),
                text: "[[wall]]\nnormal = [0, 0, 1]\nlaw = \"wet\"\nshare = 0.5\n".into(),
            },
            Sample {
                name: "short.toml".into(),
                text: "[[wall]]\nnormal = [0, 0, 1]\n# why\nshare = 1\n\n[air]\n".into(),
            },
        ];
        let page = page(&schema(), &samples).unwrap();
        for line in [
            "## `[[wall]]`",
            "## `[air]`",
            "A plane that nothing passes. Needed.",
            "| `normal` | 3 of number | angular velocity or force/length³ | *needed* |  |",
            "| `law` | [Law](#law) | - | `\"dry\"` | See `Law`. |",
            "| `share` | number in [0.0, 1.0] | - | 0.5 | a \\| b; 0.5 if left out. |",
            "| `\"wet\"` |  |",
        ] {
            assert!(page.contains(line), "{line}\n{page}");
        }
        assert!(page.contains("From `scenes/short.toml`:\n\n```toml\n[[wall]]\nnormal = [0, 0, 1]\nshare = 1\n```"));
        assert!(!page.contains("Internal") && !page.contains("## Wall"));
    }
}
