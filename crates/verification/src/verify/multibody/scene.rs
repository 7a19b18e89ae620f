//! Scenes run in memory, stage by stage.

use crate::workspace::Outcome;
use stoss::build::{Built, Probe, build};
use stoss_solver::{Simulation, StepRecord};
use toml::{Table, Value};

/// Runs a scene to its end and looks after each step.
pub fn run(scene: &Table, name: &str, look: impl FnMut(&Simulation, &[Probe], &StepRecord)) -> Outcome<Simulation> {
    run_until(scene, name, f64::INFINITY, look)
}

/// Runs a scene as [`run`], no farther than the first step that ends at this time or later.
pub fn run_until(
    scene: &Table,
    name: &str,
    until: f64,
    mut look: impl FnMut(&Simulation, &[Probe], &StepRecord),
) -> Outcome<Simulation> {
    let text = toml::to_string(scene)?;
    let scene = stoss_scene::parse(&text, name).map_err(|error| error.to_string())?;
    let built = build(&scene, std::path::Path::new(".")).map_err(|error| error.to_string())?;
    let Built { mut simulation, schedule, probes, .. } = built;
    loop {
        schedule.events(&mut simulation, &probes)?;
        let ended = simulation.state().time > until - 1e-9;
        if ended || simulation.finished() && !schedule.advance(&mut simulation)? {
            return Ok(simulation);
        }
        let record = simulation.advance()?;
        look(&simulation, &probes, &record);
    }
}

/// The value of a probe.
pub fn probe(probes: &[Probe], name: &str, simulation: &Simulation) -> [f64; 3] {
    probes.iter().find(|probe| probe.name == name).map_or([f64::NAN; 3], |probe| probe.value(simulation))
}

/// The entry of a list of a scene that has this name.
pub fn named<'a>(scene: &'a mut Table, list: &str, name: &str) -> Outcome<&'a mut Table> {
    let items = scene.get_mut(list).and_then(Value::as_array_mut).ok_or_else(|| format!("no list {list}"))?;
    let item = items.iter_mut().find(|item| item.get("name").and_then(Value::as_str) == Some(name));
    Ok(item.and_then(Value::as_table_mut).ok_or_else(|| format!("no {list} {name}"))?)
}

/// A table from its text.
pub fn value(text: &str) -> Outcome<Value> {
    let table: Table = format!("v = {text}").parse()?;
    Ok(table["v"].clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_found_by_name() {
        let mut scene: Table = "[[joint]]\nname = \"a\"\n[[joint]]\nname = \"b\"\nkind = \"hinge\"".parse().unwrap();
        named(&mut scene, "joint", "b").unwrap().insert("friction".into(), value("{ viscous = 0.1 }").unwrap());
        assert_eq!(scene["joint"][1]["friction"]["viscous"].as_float(), Some(0.1));
        assert!(named(&mut scene, "joint", "c").is_err() && named(&mut scene, "beam", "a").is_err());
    }
}
