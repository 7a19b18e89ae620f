//! Whether a scene can follow a remedy: what it sets is not set already, and the table that it changes is there.

use super::case::DiagnosedRun;
use super::{Change, Remedy};
use serde_json::Value;

/// Leaves out remedies that change nothing, or a table that the scene does not have.
pub(super) fn keep(case: &DiagnosedRun<'_>, remedies: &mut Vec<Remedy>) {
    if remedies.iter().all(|remedy| remedy.changes.is_empty()) {
        return;
    }
    // A scene that cannot be written as JSON is not compared.
    let Ok(scene) = serde_json::to_value(case.scene) else { return };
    remedies.retain(|remedy| {
        let is_there = |change: &Change| match change {
            Change::Set { key, .. } => has_table(&scene, key),
            Change::Add { .. } => true,
        };
        let is_new = |change: &Change| match change {
            Change::Set { key, value } => at(&scene, key).is_none_or(|present| {
                serde_json::from_str::<Value>(value).map_or(true, |value| !is_same(present, &value))
            }),
            Change::Add { .. } => true,
        };
        remedy.changes.is_empty() || (remedy.changes.iter().all(is_there) && remedy.changes.iter().any(is_new))
    });
}

/// Numbers by their value: `1` and `1.0` are the same.
fn is_same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => a.as_f64() == b.as_f64(),
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same(a, b)),
        (a, b) => a == b,
    }
}

/// The value of a key such as `contact[0].friction.mu`.
fn at<'a>(scene: &'a Value, key: &str) -> Option<&'a Value> {
    key.split('.').try_fold(scene, |value, part| match part.split_once('[') {
        Some((name, index)) => value.get(name)?.get(index.trim_end_matches(']').parse::<usize>().ok()?),
        None => value.get(part),
    })
}

/// Whether every numbered table on the way to a key is there; others can be added by setting the key.
fn has_table(scene: &Value, key: &str) -> bool {
    let numbered = key.match_indices(']').map(|(end, _)| &key[..=end]);
    numbered.into_iter().all(|table| at(scene, table).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_in_tables_and_lists() {
        let scene = serde_json::json!({
            "time": { "step": 0.5 },
            "contact": [{ "friction": { "mu": 1 } }],
            "prescribe": [{ "components": ["x", "z"] }],
        });
        assert_eq!(at(&scene, "contact[0].friction.mu"), Some(&serde_json::json!(1)));
        assert!(is_same(&serde_json::json!([1, "x"]), &serde_json::json!([1.0, "x"])));
        assert!(!is_same(&serde_json::json!(["x"]), &serde_json::json!(["x", "y"])));
        assert!(has_table(&scene, "solver.relative_tolerance") && has_table(&scene, "contact[0].enforcement"));
        assert!(!has_table(&scene, "prescribe[1].components") && !has_table(&scene, "body[0].density"));
        assert_eq!(at(&scene, "prescribe[0].fixed"), None);
    }
}
