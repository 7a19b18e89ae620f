//! The set-up of a scene before its run: the initial state as a frame, and what is where on it, in the file `setup.json`.
//!
//! A layer is one thing of the scene with its name: a surface of a contact, a support, a load, a joint, a set. It has places of its own, so that whoever draws it needs
//! to know nothing of the model.
//!
//! Not here: drawing, which the page of the crate `stoss-report` does.

mod conditions;
mod layer;

pub use layer::{Arrow, Kind, Layer};

use crate::build::{Built, Placed, named_parts};
use crate::output::{Description, OutputError, UnitLabels, write_start};
use crate::run::{RunError, RunOptions, load, report_lines, scene_folder};
use crate::scene::{Contact, Equation, Field, Joint, Scene, Spring, split_set};
use layer::Space;
use serde::{Deserialize, Serialize};
use std::path::Path;
use stoss_mesh::{ALL, BOUNDARY};

/// The file.
pub const FILE: &str = "setup.json";

/// What a scene has where, with its names.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// Title of the scene.
    pub title: String,
    /// Things of the scene: first what acts, in the order of the tables of the scene format, then sets.
    pub layers: Vec<Layer>,
}

/// Writes the set-up of a scene into a folder, which a run's page can be made of: the initial state as the only frame, `run.json` with what `stoss check` reports
/// as its plan, and `setup.json`. Of the options laws and parameters are used.
///
/// # Errors
/// The errors of [`crate::run::check_scene_for`], and what the system says about writing.
pub fn write(path: &Path, options: &RunOptions, folder: &Path) -> Result<(), RunError> {
    let (scene, built) = load(path, options)?;
    let placed = named_parts(&scene, scene_folder(path), &options.laws);
    let setup = Setup { title: scene.header.title.clone(), layers: layers(&scene, &built, &placed) };
    let description = Description {
        plan: report_lines(path, options, &scene, &built)?,
        file: scene.file().to_owned(),
        scene: scene.text().to_owned(),
        section: scene.header.section.map(|section| section.name().to_owned()),
        units: UnitLabels::new(&scene, &built.probes),
        ..Description::new(built.simulation.model(), &built.drawing)
    };
    let mut fields = vec![Field::Displacement, Field::Gap];
    fields.extend(scene.is_dynamic().then_some(Field::Velocity));
    write_start(folder, &built.simulation, &built.drawing, &description, &fields)?;
    let file = folder.join(FILE);
    let damaged = |error: serde_json::Error| OutputError::Damaged { path: file.clone(), reason: error.to_string() };
    let text = serde_json::to_string(&setup).map_err(damaged)?;
    std::fs::write(&file, text).map_err(|source| OutputError::Io { path: file, source })?;
    Ok(())
}

/// All layers of a scene; parts that cannot be found, which is an error of the scene, have none.
fn layers(scene: &Scene, built: &Built, placed: &[Placed]) -> Vec<Layer> {
    let model = built.simulation.model();
    let space = Space { model, placed };
    let mut layers: Vec<Layer> = scene.contacts.iter().flat_map(|contact| contact_surfaces(&space, contact)).collect();
    for tie in &scene.ties {
        for (set, role) in [(&tie.slave, "slave"), (&tie.master, "master")] {
            layers.push(space.surface(Kind::Tie, format!("{}: {role}", tie.label()), set, set));
        }
    }
    layers.extend(scene.couplings.iter().map(|item| {
        let about = format!("{} to {}", item.set, item.rigid);
        space.surface(Kind::Coupling, item.name.clone(), &item.set, &about)
    }));
    layers.extend(scene.equations.iter().map(|item| equation(&space, item)));
    layers.extend(scene.joints.iter().map(joint));
    layers.extend(scene.springs.iter().map(spring));
    layers.extend(conditions::prescriptions(scene, &space));
    layers.extend(conditions::supports(scene, &space));
    layers.extend(conditions::loads(scene, &space));
    layers.extend(placed.iter().flat_map(|part| sets(&space, part)));
    layers
}

fn contact_surfaces(space: &Space, contact: &Contact) -> [Layer; 2] {
    let roles = if contact.between.is_some() { ["first surface", "second surface"] } else { ["slave", "master"] };
    let sets = contact.surfaces();
    [0, 1].map(|k| space.surface(Kind::Contact, format!("{}: {}", contact.label(), roles[k]), sets[k], sets[k]))
}

fn equation(space: &Space, equation: &Equation) -> Layer {
    let mut layer = Layer::new(Kind::Equation, equation.name.clone(), String::new());
    for term in &equation.terms {
        let nodes = term.set.as_deref().map(|set| space.nodes(set)).unwrap_or_default();
        layer.add_places(&nodes.iter().map(|&node| space.place(node)).collect::<Vec<_>>());
        layer.add_places(term.point.as_slice());
    }
    layer
}

fn joint(joint: &Joint) -> Layer {
    let [a, b] = &joint.between;
    let ends = joint.at.both();
    let mut layer = Layer::new(Kind::Joint, joint.name.clone(), format!("{} between {a} and {b}", joint.kind));
    layer.add_places(&ends[..if ends[0] == ends[1] { 1 } else { 2 }]);
    if ends[0] != ends[1] {
        layer.lines.push([0, 1]);
    }
    let axes = joint.axis.into_iter().chain(joint.axes.into_iter().flatten());
    layer.arrows.extend(axes.map(|axis| Arrow::new(ends[0], axis, false)));
    layer
}

fn spring(spring: &Spring) -> Layer {
    let [a, b] = &spring.between;
    let mut layer = Layer::new(Kind::Spring, spring.name.clone(), format!("between {a} and {b}"));
    layer.add_places(&spring.at);
    layer.lines.push([0, 1]);
    layer
}

/// The sets of a part but for those of all its nodes and of its whole surface.
fn sets(space: &Space, part: &Placed) -> Vec<Layer> {
    let names = part.set_names().into_iter().filter(|name| name != ALL && name != BOUNDARY);
    names
        .map(|name| {
            let set = format!("{}.{name}", part.name);
            space.surface(Kind::Set, set.clone(), &set, "")
        })
        .collect()
}

/// The part that a set `part.set` belongs to.
fn part_of(set: &str) -> &str {
    split_set(set).map_or(set, |(part, _)| part)
}
