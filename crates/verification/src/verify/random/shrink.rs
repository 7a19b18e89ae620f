//! Makes a failing scene as small as it can be without ceasing to fail.

use std::path::PathBuf;

use toml::{Table, Value};

use super::scene::{Case, observe};
use super::{Fault, Shot, keep, run};
use crate::verify::Bench;
use crate::workspace::Outcome;

/// Largest number of runs spent on one scene.
const RUNS: usize = 40;

/// The smallest scene found that still has this fault, as a file.
pub fn shrink(bench: &Bench, case: &Case, fault: Fault, reason: &str) -> Outcome<PathBuf> {
    let (mut best, mut reason, mut runs) = (case.clone(), reason.to_owned(), 0);
    'again: loop {
        for scene in smaller(&best.scene) {
            if runs == RUNS {
                break 'again;
            }
            runs += 1;
            let candidate = Case { scene, ..best.clone() };
            let shot: Shot = run(bench, &format!("shrink-{}", case.seed), &candidate)?;
            if shot.fault() == Some(fault) && !shot.reason().starts_with("the scene is refused") {
                (best, reason) = (candidate, shot.reason());
                continue 'again;
            }
        }
        break;
    }
    keep(bench, &best, &reason)
}

/// Keys of lists whose entries may go one by one.
const LISTS: [&str; 4] = ["contact", "joint", "load", "support"];

/// Scenes that have a little less: a body, a contact, a joint, a load, gravity, friction, half of the time, a turn, a finer mesh.
fn smaller(scene: &Table) -> Vec<Table> {
    let mut all = Vec::new();
    let list = |key: &str| scene.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    let bodies = list("body");
    let with = |key: &str, rest: Vec<Value>| {
        let mut next = scene.clone();
        match rest.is_empty() {
            true => next.remove(key),
            false => next.insert(key.into(), Value::Array(rest)),
        };
        next
    };
    for k in 0..bodies.len() {
        if bodies.len() + list("rigid").len() < 2 || scene.contains_key("prescribe") || scene.contains_key("tie") {
            break;
        }
        let gone = format!("{}.", bodies[k].get("name").and_then(Value::as_str).unwrap_or_default());
        let names = |contact: &Value, key: &str| {
            contact.get(key).and_then(Value::as_str).is_some_and(|set| set.starts_with(&gone))
        };
        let mut rest = bodies.clone();
        rest.remove(k);
        let mut next = with("body", rest);
        let left: Vec<Value> =
            list("contact").iter().filter(|c| !names(c, "slave") && !names(c, "master")).cloned().collect();
        match left.is_empty() {
            true => next.remove("contact"),
            false => next.insert("contact".into(), Value::Array(left)),
        };
        all.push(next);
    }
    for key in LISTS {
        let entries = list(key);
        for k in 0..entries.len() {
            let mut rest = entries.clone();
            rest.remove(k);
            all.push(with(key, rest));
            for detail in ["friction", "limits", "motor", "spring", "closing", "constraint"] {
                all.extend(without(&entries, k, detail).map(|plain| with(key, plain)));
            }
        }
    }
    for key in ["gravity", "general_contact"] {
        let mut next = scene.clone();
        if key == "gravity" && next.remove(key).is_some() {
            all.push(next);
        } else if let Some(general) = next.get_mut(key).and_then(Value::as_table_mut)
            && general.remove("friction").is_some()
        {
            all.push(next);
        }
    }
    if let Some(Value::Table(time)) = scene.get("time")
        && !scene.contains_key("prescribe")
        && let (Some(end), Some(step)) =
            (time.get("end").and_then(Value::as_float), time.get("step").and_then(Value::as_float))
        && end > 1.5 * step
    {
        let mut time = time.clone();
        time.insert("end".into(), (step * (0.5 * end / step).ceil()).into());
        let mut next = scene.clone();
        next.insert("time".into(), Value::Table(time));
        all.push(next);
    }
    for k in 0..bodies.len() {
        for detail in ["rotation", "cell", "angular_velocity"] {
            all.extend(without(&bodies, k, detail).map(|plain| with("body", plain)));
        }
        let mut coarse = bodies.clone();
        if let Some(divisions) = coarse[k].get_mut("mesh").and_then(|mesh| mesh.get_mut("divisions")?.as_array_mut())
            && divisions.len() == 3
            && divisions.iter().any(|n| n.as_integer() != Some(1))
        {
            divisions.iter_mut().for_each(|n| *n = 1.into());
            all.push(with("body", coarse));
        }
    }
    all.iter_mut().for_each(observe);
    all
}

/// The entries, number `k` without a key; none if it has no such key.
fn without(entries: &[Value], k: usize, key: &str) -> Option<Vec<Value>> {
    let mut entries = entries.to_vec();
    entries[k].as_table_mut()?.remove(key)?;
    Some(entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_candidate_is_another_scene_and_shrinking_ends() {
        for seed in 0..20 {
            let mut scene = Case::new(seed).unwrap().scene;
            let mut rounds = 0;
            while let Some(next) = smaller(&scene).into_iter().next() {
                assert_ne!(next, scene);
                scene = next;
                rounds += 1;
                assert!(rounds < 200);
            }
        }
    }
}
