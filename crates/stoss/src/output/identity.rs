//! What the results of a run depend on. A run may be resumed with a scene that differs in nothing of it.

use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

/// Tables of a scene that say what is written and judged, not what is computed.
/// Of parameters what counts is where they are used.
const WITHOUT_INFLUENCE: [&str; 6] = ["output", "watch", "expect", "parameters", "sweep", "left_out"];

/// Number of differences that are named.
const NAMED: usize = 5;

/// Version, parsed scene and mesh files; comments, title, units, end, probes on which no event depends, `[output]`, `[watch]`, `[expect]` and `[[left_out]]` do not count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneIdentity {
    version: String,
    scene: Value,
    /// SHA-256 of each mesh file, hexadecimal.
    meshes: Vec<String>,
}

impl SceneIdentity {
    /// The identity of a scene and the contents of its mesh files.
    ///
    /// # Errors
    /// If the scene cannot be written as JSON.
    pub fn new(scene: &Scene, meshes: &[Vec<u8>]) -> Result<Self, serde_json::Error> {
        let mut value = serde_json::to_value(scene)?;
        if let Value::Object(tables) = &mut value {
            let parameters = parameters_of_sets(scene, tables);
            for table in WITHOUT_INFLUENCE {
                tables.remove(table);
            }
            tables.extend(parameters.map(|parameters| ("parameters".to_owned(), parameters)));
            keep_probes_of_events(tables);
            for label in ["title", "units", "format"] {
                remove(tables, "scene", label);
            }
            remove(tables, "time", "end");
            remove_unused_sets(tables);
        }
        let meshes = meshes.iter().map(|mesh| hexadecimal(Sha256::digest(mesh).as_slice())).collect();
        Ok(Self { version: env!("CARGO_PKG_VERSION").to_owned(), scene: value, meshes })
    }

    /// SHA-256, hexadecimal.
    pub fn hash(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(&self.version);
        // Keys of a map are sorted.
        hash.update(self.scene.to_string());
        for mesh in &self.meshes {
            hash.update(mesh);
        }
        hexadecimal(hash.finalize().as_slice())
    }

    /// What has changed since `before`, in words; empty if nothing has.
    pub fn changes(&self, before: &Self) -> String {
        let mut list = Vec::new();
        if self.version != before.version {
            list.push(format!("the version of Stoss: {} -> {}", before.version, self.version));
        }
        compare("", Some(&before.scene), Some(&self.scene), &mut list);
        if self.meshes != before.meshes {
            list.push("the content of a mesh file".to_owned());
        }
        let more = list.len().saturating_sub(NAMED);
        list.truncate(NAMED);
        if more > 0 {
            list.push(format!("and {more} more"));
        }
        list.join("; ")
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn remove(tables: &mut Map<String, Value>, table: &str, key: &str) {
    if let Some(Value::Object(table)) = tables.get_mut(table) {
        table.remove(key);
    }
}

/// Probes have an influence if an event depends on them. They stand under their names, so that others may come and go.
fn keep_probes_of_events(tables: &mut Map<String, Value>) {
    let Some(Value::Array(probes)) = tables.remove("probe") else { return };
    let events = tables.get("event").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let of_events: Vec<&str> = events.iter().filter_map(|event| event.pointer("/when/probe")?.as_str()).collect();
    let name = |probe: &Value| probe.get("name").and_then(Value::as_str).map(str::to_owned);
    let named = probes.into_iter().filter_map(|probe| Some((name(&probe)?, probe)));
    let kept: Map<String, Value> = named.filter(|(name, _)| of_events.contains(&name.as_str())).collect();
    if !kept.is_empty() {
        tables.insert("probe".to_owned(), Value::Object(kept));
    }
}

/// The parameters that expressions over sets name: those of numbers are in the numbers.
fn parameters_of_sets(scene: &Scene, tables: &Map<String, Value>) -> Option<Value> {
    let texts: Vec<&str> = scene.set_expressions().iter().map(|set| set.region.text.as_str()).collect();
    let words = |text: &str, name: &str| text.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|w| w == name);
    let parameters = tables.get("parameters")?.as_object()?.iter();
    let named = parameters.filter(|(name, _)| texts.iter().any(|text| words(text, name)));
    let named: Map<String, Value> = named.map(|(name, value)| (name.clone(), value.clone())).collect();
    (!named.is_empty()).then_some(Value::Object(named))
}

/// Sets that nothing or only other probes name have no influence.
fn remove_unused_sets(tables: &mut Map<String, Value>) {
    if let Some(Value::Object(sets)) = tables.remove("sets") {
        let used = |name: &str| {
            names(&Value::Object(tables.clone()), name)
                || sets.iter().any(|(other, text)| other != name && names(text, name))
        };
        let kept: Map<String, Value> =
            sets.iter().filter(|(name, _)| used(name)).map(|(name, text)| (name.clone(), text.clone())).collect();
        if !kept.is_empty() {
            tables.insert("sets".to_owned(), Value::Object(kept));
        }
    }
    let Some(Value::Array(mut sets)) = tables.remove("set") else { return };
    let rest = Value::Object(tables.clone());
    sets.retain(|set| set.get("name").and_then(Value::as_str).is_none_or(|name| names(&rest, name)));
    if !sets.is_empty() {
        tables.insert("set".to_owned(), Value::Array(sets));
    }
}

/// Whether a text stands anywhere in a value, also as part of an expression.
fn names(value: &Value, text: &str) -> bool {
    match value {
        Value::String(found) => found.contains(text),
        Value::Array(list) => list.iter().any(|value| names(value, text)),
        Value::Object(table) => table.values().any(|value| names(value, text)),
        _ => false,
    }
}

/// Adds every key of which the value differs.
fn compare(key: &str, before: Option<&Value>, now: Option<&Value>, list: &mut Vec<String>) {
    match (before, now) {
        (Some(Value::Object(before)), Some(Value::Object(now))) => {
            let added = now.keys().filter(|name| !before.contains_key(*name));
            for name in before.keys().chain(added) {
                let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                compare(&key, before.get(name), now.get(name), list);
            }
        }
        (Some(Value::Array(before)), Some(Value::Array(now))) => {
            for k in 0..before.len().max(now.len()) {
                compare(&format!("{key}[{k}]"), before.get(k), now.get(k), list);
            }
        }
        (before, now) if before == now => {}
        (Some(_), None) => list.push(format!("{key} was removed")),
        (None, _) => list.push(format!("{key} was added")),
        (Some(before), Some(now)) => list.push(format!("{key}: {before} -> {now}")),
    }
}
