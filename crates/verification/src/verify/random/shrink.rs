//! Makes a failing scene as small as it can be without ceasing to fail.

use std::path::PathBuf;

use toml::{Table, Value};

use super::scene::Case;
use super::{Fate, keep, run};
use crate::verify::Bench;
use crate::workspace::Outcome;

/// Largest number of runs spent on one scene.
const RUNS: usize = 40;

/// The smallest scene found that still fails, as a file.
pub fn shrink(bench: &Bench, case: &Case, reason: &str) -> Outcome<PathBuf> {
    let (mut best, mut reason, mut runs) = (case.clone(), reason.to_owned(), 0);
    'again: loop {
        for scene in smaller(&best.scene) {
            if runs == RUNS {
                break 'again;
            }
            runs += 1;
            let candidate = Case { scene, ..best.clone() };
            if let Fate::Failed(now) = run(bench, &format!("shrink-{}", case.seed), &candidate)?
                && !now.starts_with("the scene is refused")
            {
                (best, reason) = (candidate, now);
                continue 'again;
            }
        }
        break;
    }
    keep(bench, &best, &reason)
}

/// Scenes that have a little less: a body, a contact, friction, half of the time, the shift, the turn.
fn smaller(scene: &Table) -> Vec<Table> {
    let mut all = Vec::new();
    let list = |key: &str| scene.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    let (bodies, contacts) = (list("body"), list("contact"));
    let name = |body: &Value| body.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    let with = |key: &str, value: Value| {
        let mut next = scene.clone();
        next.insert(key.into(), value);
        next
    };
    for k in 0..bodies.len() {
        if bodies.len() < 2 || scene.contains_key("prescribe") {
            break;
        }
        let gone = format!("{}.", name(&bodies[k]));
        let names = |contact: &Value, key: &str| {
            contact.get(key).and_then(Value::as_str).is_some_and(|set| set.starts_with(&gone))
        };
        let mut rest = bodies.clone();
        rest.remove(k);
        let left = contacts.iter().filter(|c| !names(c, "slave") && !names(c, "master")).cloned().collect();
        let mut next = with("body", Value::Array(rest));
        next.insert("contact".into(), Value::Array(left));
        all.push(next);
    }
    for k in 0..contacts.len() {
        let mut rest = contacts.clone();
        rest.remove(k);
        all.push(with("contact", Value::Array(rest)));
        let mut plain = contacts.clone();
        if let Some(contact) = plain[k].as_table_mut()
            && contact.remove("friction").is_some()
        {
            all.push(with("contact", Value::Array(plain)));
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
        all.push(with("time", Value::Table(time)));
    }
    for k in 0..bodies.len() {
        let mut straight = bodies.clone();
        if let Some(body) = straight[k].as_table_mut()
            && body.remove("rotation").is_some()
        {
            all.push(with("body", Value::Array(straight)));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_candidate_is_another_scene_and_shrinking_ends() {
        let mut scene = Case::new(3).scene;
        let mut rounds = 0;
        while let Some(next) = smaller(&scene).into_iter().next() {
            assert_ne!(next, scene);
            scene = next;
            rounds += 1;
            assert!(rounds < 200);
        }
    }
}
