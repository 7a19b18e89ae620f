//! Prescribed motion, loads, contact.

use super::Problems;
use super::placed::{self, Placed};
use crate::scene::{LoadKind as SceneLoad, Prescribe, Scene, Stage, known, split_set};
use crate::solver::{AxisRotation, Load, LoadKind, Model, Prescription, Table};
use std::collections::BTreeMap;
use stoss_mesh::{MeshError, SetKind};
use stoss_reference_element::FaceNodes;

/// A prescription with a normal that becomes a sliding support.
pub(super) struct InclinedPrescription {
    /// Number in the scene.
    pub item: usize,
    pub nodes: Vec<u32>,
    pub normal: [f64; 3],
    pub displacement: Table,
}

/// The axis of space that a direction lies on, and its sign.
pub(super) fn axis(normal: [f64; 3]) -> Option<(u8, f64)> {
    let mut entries = (0..3).filter(|&i| normal[i] != 0.0);
    let (first, second) = (entries.next()?, entries.next());
    second.is_none().then(|| (first as u8, normal[first].signum()))
}

/// Faces of a deformable body's set in global node numbers.
pub(super) fn solid_facets(placed: &Placed, set: &str) -> Result<Vec<FaceNodes>, MeshError> {
    let list = placed.mesh().map_or_else(|| Ok(Vec::new()), |mesh| mesh.facets_of(set))?;
    Ok(list.iter().map(|facet| facet.nodes.map(|n| n + placed.first_node)).collect())
}

/// Resolves `body.set` with a given look-up; reports and returns `None` if it does not exist or is empty.
pub(super) fn resolve<T>(
    placed: &[Placed],
    key: &str,
    reference: &str,
    problems: &mut Problems<'_>,
    look_up: impl Fn(&Placed, &str) -> Result<Vec<T>, MeshError>,
) -> Option<(usize, Vec<T>)> {
    let (body, set) = split_set(reference)?;
    let b = placed::index(placed, body)?;
    let names = || placed[b].set_names();
    match look_up(&placed[b], set) {
        Ok(list) if !list.is_empty() => Some((b, list)),
        Ok(_) => {
            let remedy = format!("choose a set that is not empty; body `{body}` has: {}", names().join(", "));
            problems.add(key.to_owned(), reference, "the set is empty", remedy);
            None
        }
        Err(MeshError::UnknownSet { name, .. }) => {
            let message = format!("body `{body}` has no set `{name}`");
            problems.add(key.to_owned(), reference, message, known(&name, names().iter().map(String::as_str)));
            None
        }
        Err(error) => {
            let remedy = match &error {
                MeshError::WrongSetKind { wanted: SetKind::Facets, name, .. }
                    if problems.scene.set_expressions().iter().any(|set| set.part == body && set.name == *name) =>
                {
                    let message =
                        "holds at nodes, but at all nodes of no facet of the surface, and a surface is needed";
                    let remedy = "let it hold at whole facets, or take facets by normal(part, nx, ny, nz, degrees)";
                    problems.add(key.to_owned(), reference, message, remedy);
                    return None;
                }
                MeshError::WrongSetKind { wanted: SetKind::Facets, .. } => format!(
                    "choose a set of facets of body `{body}`: {}; a surface between two elements has no outside and is a set of nodes",
                    placed[b].facet_sets().join(", ")
                ),
                _ => format!("body `{body}` has: {}", names().join(", ")),
            };
            problems.add(key.to_owned(), reference, error.to_string(), remedy);
            None
        }
    }
}

/// Whether there is a stage in which two prescriptions act.
fn act_together(scene: &Scene, one: &Prescribe, other: &Prescribe) -> bool {
    let acts = |item: &Prescribe, stage: &Stage| item.name.as_ref().is_none_or(|name| !stage.off.contains(name));
    scene.stages.is_empty() || scene.stages.iter().any(|stage| acts(one, stage) && acts(other, stage))
}

/// Reports a ramp that begins nowhere, or ends before a stage begins it.
fn check_ramp(scene: &Scene, p: usize, problems: &mut Problems<'_>) {
    let item = &scene.prescriptions[p];
    let Some(until) = item.ramp_until else { return };
    let is_off = |stage: &Stage| item.name.as_ref().is_some_and(|name| stage.off.contains(name));
    let begins: Vec<f64> = scene
        .stages
        .windows(2)
        .filter(|pair| is_off(&pair[0]) && !is_off(&pair[1]))
        .map(|pair| pair[0].until)
        .collect();
    let key = || format!("prescribe[{p}].ramp_until");
    if begins.is_empty() {
        let message = "no stage switches this prescription on, so that nothing has to be ramped";
        let remedy =
            "remove it, or give the prescription a `name` that a [[stage]] has in `off` and the next one has not";
        problems.add(key(), format!("{until}"), message, remedy);
    } else if let Some(start) = begins.iter().find(|start| until <= **start) {
        let message = format!("the ramp ends at t = {until}, and a stage begins it at t = {start}");
        problems.add(key(), format!("{until}"), message, "let it end within that stage, for instance with it");
    }
}

/// Warnings for ramps that end after the run.
pub(super) fn warnings(scene: &Scene) -> Vec<String> {
    let end = scene.stages.iter().map(|stage| stage.until).fold(scene.time.end, f64::max);
    let ramps = scene.prescriptions.iter().enumerate().filter_map(|(p, item)| Some((p, item.ramp_until?)));
    let late = ramps.filter(|(_, until)| until.is_finite() && *until > end);
    late.map(|(p, until)| {
        format!(
            "prescribe[{p}].ramp_until: the ramp ends at t = {until}, and the run at t = {end}: the nodes do not get to their `displacement`; let the ramp end within the run"
        )
    })
    .collect()
}

fn table(key: String, rows: &[Vec<f64>], columns: usize, problems: &mut Problems<'_>) -> Option<Table> {
    Table::from_rows(rows, columns)
        .map_err(|error| problems.add(key, "", error.to_string(), "give rows [time, value, ...] with increasing times"))
        .ok()
}

/// What a prescription of a rigid body moves: its nodes, those of them that are directions, and rows with three values each.
pub(super) type RigidMotion = (Vec<u32>, Vec<u32>, Vec<Vec<f64>>);

/// Adds the prescribed components. For each prescription of the scene its place in the model, and those along a normal that is no axis of space, which have none.
pub(super) fn prescriptions(
    scene: &Scene,
    placed: &[Placed],
    rigid: &dyn Fn(&Prescribe) -> Option<RigidMotion>,
    model: &mut Model,
    problems: &mut Problems<'_>,
) -> (Vec<Option<usize>>, Vec<InclinedPrescription>) {
    let (mut places, mut inclined) = (vec![None; scene.prescriptions.len()], Vec::new());
    // Of every component the prescriptions: their places in the model and in the scene.
    let mut owners: BTreeMap<(u32, u8), Vec<(usize, usize)>> = BTreeMap::new();
    for (p, item) in scene.prescriptions.iter().enumerate() {
        check_ramp(scene, p, problems);
        let key = format!("prescribe[{p}]");
        let (place, target) = match (&item.set, &item.rigid) {
            (Some(set), _) => (format!("{key}.set"), set),
            (None, Some(rigid)) => (format!("{key}.rigid"), rigid),
            (None, None) => continue,
        };
        let (found, components, rows) = match rigid(item) {
            Some((nodes, directions, rows)) => (Some((nodes, directions)), vec![0, 1, 2], rows),
            None => {
                let found = resolve(placed, &place, target, problems, Placed::nodes_of);
                let components: Vec<u8> = item.prescribed_components().iter().map(|c| c.index() as u8).collect();
                let (components, rows) = match item.normal.and_then(axis) {
                    None => (components, item.rows()),
                    // Along an axis of space, or against it.
                    Some((axis, sign)) => {
                        (vec![axis], item.rows().iter().map(|row| vec![row[0], sign * row[1]]).collect())
                    }
                };
                (found.map(|(_, nodes)| (nodes, Vec::new())), components, rows)
            }
        };
        let values = if item.rotation.is_some() { "translation" } else { "displacement" };
        let displacement = table(format!("{key}.{values}"), &rows, rows[0].len() - 1, problems);
        let rotation = match &item.rotation {
            Some(rotation) => {
                let Some(degrees) = table(format!("{key}.rotation.degrees"), &rotation.degrees.rows(), 1, problems)
                else {
                    continue;
                };
                let turn = AxisRotation::new(rotation.axis, rotation.about, degrees);
                if turn.is_none() {
                    let remedy = "give a direction, for instance [0, 0, 1]";
                    problems.add(format!("{key}.rotation.axis"), "", "the axis must be finite and not zero", remedy);
                    continue;
                }
                turn
            }
            None => None,
        };
        let (Some((nodes, directions)), Some(displacement)) = (found, displacement) else { continue };
        if let Some(normal) = item.normal.filter(|_| components.is_empty()) {
            inclined.push(InclinedPrescription { item: p, nodes, normal, displacement });
            continue;
        }
        let name = item.name.clone().unwrap_or(key);
        let ramp_until = item.ramp_until;
        let prescription = Prescription { name, nodes, directions, components, displacement, rotation, ramp_until };
        let Prescription { nodes, components, .. } = &prescription;
        let clash = nodes.iter().find_map(|&n| {
            components.iter().find_map(|&c| {
                owners.get(&(n, c))?.iter().find_map(|&(in_model, in_scene)| {
                    let contradicts = !model.prescriptions[in_model].agrees(&prescription, c)
                        && act_together(scene, item, &scene.prescriptions[in_scene]);
                    contradicts.then_some((n, c, in_scene))
                })
            })
        });
        if let Some((node, component, other)) = clash {
            let axis = ["x", "y", "z"][component as usize];
            let message = format!(
                "component {axis} of node {node} is prescribed by prescribe[{other}] as well, with other values"
            );
            let remedy = "let the sets not overlap, or give the same values where they do";
            problems.add(place, target, message, remedy);
            continue;
        }
        for &n in nodes {
            for &c in components {
                owners.entry((n, c)).or_default().push((model.prescriptions.len(), p));
            }
        }
        places[p] = Some(model.prescriptions.len());
        model.prescriptions.push(prescription);
    }
    (places, inclined)
}

/// Adds the loads; those that are forces act on what is modelled of a section, `extent`.
pub(super) fn loads(scene: &Scene, placed: &[Placed], extent: f64, model: &mut Model, problems: &mut Problems<'_>) {
    for (l, item) in scene.loads.iter().enumerate() {
        let key = format!("load[{l}]");
        let Some((kind, series)) = item.kind() else { continue };
        let magnitude = table(format!("{key}.{}", kind.name()), &series.rows(), kind.columns(), problems);
        let mut load = load_kind(scene, placed, model, &key, item, kind, problems);
        if let (Some(LoadKind::Dead { patterns }), SceneLoad::Force | SceneLoad::TotalForce) = (&mut load, kind) {
            patterns.iter_mut().flatten().for_each(|(_, force)| *force *= extent);
        }
        if let (Some(magnitude), Some(load)) = (magnitude, load) {
            model.loads.push(Load { name: format!("{key} {}", kind.name()), kind: load, magnitude });
        }
    }
}

/// Lets moments on sets of deformable bodies act on their reference bodies, whose first vectors `reference` tells.
pub(super) fn moments(
    scene: &Scene,
    reference: impl Fn(&str, crate::scene::Coupling) -> Option<u32>,
    model: &mut Model,
) {
    for (item, load) in scene.loads.iter().zip(&mut model.loads) {
        if let (LoadKind::Moment { directors }, Some(set)) = (&mut load.kind, &item.set)
            && directors.is_empty()
            && let Some(first) = reference(set, item.coupling())
        {
            directors.push([1, 2, 3].map(|k| first + k));
        }
    }
}

/// Gravity as a dead load on everything that has mass, behind all other loads.
pub(super) fn gravity(scene: &Scene, model: &mut Model, problems: &mut Problems<'_>) {
    let Some(gravity) = &scene.gravity else { return };
    let components = model.reference.len();
    let mut patterns = Vec::new();
    for axis in AXES {
        let made = pattern(components, "gravity", problems, |force| {
            // The force of the very mass that is accelerated: with another, lumped bodies would not fall alike at all nodes.
            let along: Vec<f64> = (0..components).map(|c| axis[c % 3]).collect();
            for (item, body) in scene.bodies.iter().zip(&model.bodies) {
                let mass = body.mass(item.density.unwrap_or(0.0));
                mass.multiply_add(1.0, &along, force);
            }
            for part in &model.parts {
                part.weight(axis, &mut |vector, f| {
                    let first = 3 * vector as usize;
                    force[first..first + 3].iter_mut().zip(f).for_each(|(sum, f)| *sum += f);
                });
            }
            Ok(())
        });
        patterns.extend(made);
    }
    if patterns.len() == AXES.len() {
        let magnitude = Table::constant(&gravity.acceleration);
        model.loads.push(Load { name: "gravity".into(), kind: LoadKind::Dead { patterns }, magnitude });
    }
}

/// Nodal forces of unit magnitude, as the entries that are not zero.
fn pattern(
    components: usize,
    key: &str,
    problems: &mut Problems<'_>,
    fill: impl FnOnce(&mut [f64]) -> Result<(), stoss_fe_solid::SolidError>,
) -> Option<Vec<(u32, f64)>> {
    let mut force = vec![0.0; components];
    match fill(&mut force) {
        Ok(()) => Some(
            force.iter().enumerate().filter(|(_, f)| **f != 0.0).map(|(component, &f)| (component as u32, f)).collect(),
        ),
        Err(error) => {
            problems.add(key.to_owned(), "", error.to_string(), "correct the mesh or choose another set");
            None
        }
    }
}

/// Scales nodal forces of unit traction, whose sum is the area, to the sum one.
fn to_resultant_one(pattern: &mut [(u32, f64)]) {
    let area: f64 = pattern.iter().map(|(_, force)| force).sum();
    // A set has a facet at least, and facets without area are no mesh.
    if area > 0.0 {
        pattern.iter_mut().for_each(|(_, force)| *force /= area);
    }
}

/// What each of some nodes gets of a force on a node: all of it, but of the nodes of a slice over the same place of its section equal parts.
fn shares(scene: &Scene, model: &Model, nodes: &[u32]) -> Vec<f64> {
    if scene.header.section.is_none() {
        return vec![1.0; nodes.len()];
    }
    let place = |n: &u32| [0, 1].map(|i| model.reference[3 * *n as usize + i].to_bits());
    let mut counts: BTreeMap<[u64; 2], f64> = BTreeMap::new();
    nodes.iter().for_each(|n| *counts.entry(place(n)).or_default() += 1.0);
    nodes.iter().map(|n| 1.0 / counts[&place(n)]).collect()
}

/// The centrifugal force of a body.
fn centrifugal(
    scene: &Scene,
    model: &Model,
    key: &str,
    item: &crate::scene::Load,
    problems: &mut Problems<'_>,
) -> Option<LoadKind> {
    let name = item.body.as_deref()?;
    let body = scene.body_index(name)?;
    let Some(density) = scene.bodies[body].density else {
        let message = format!("`{name}` has no density, and a body without mass has no centrifugal force");
        problems.add(format!("{key}.angular_velocity"), "", message, "give the body a density");
        return None;
    };
    let axis = item.axis?;
    let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    Some(LoadKind::Centrifugal {
        mass: model.bodies[body].mass(density),
        axis: axis.map(|a| a / length),
        about: item.about.unwrap_or_default(),
    })
}

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn load_kind(
    scene: &Scene,
    placed: &[Placed],
    model: &Model,
    key: &str,
    item: &crate::scene::Load,
    kind: SceneLoad,
    problems: &mut Problems<'_>,
) -> Option<LoadKind> {
    let components = model.reference.len();
    if kind == SceneLoad::Centrifugal {
        return centrifugal(scene, model, key, item, problems);
    }
    if matches!(kind, SceneLoad::BodyForce | SceneLoad::Acceleration) {
        // On a whole body: `body`, or a set of which the body is meant.
        let name = item.body.as_deref().or_else(|| item.set.as_deref().and_then(split_set).map(|(body, _)| body))?;
        let b = scene.body_index(name)?;
        if let Some((_, set)) = item.set.as_deref().and_then(split_set) {
            let whole = placed[b]
                .mesh()
                .is_some_and(|mesh| mesh.elements_of(set).is_ok_and(|e| e.len() == mesh.elements.len()));
            if !whole {
                let message = "a body force acts on a whole body, not on a set of it";
                problems.add(format!("{key}.set"), set, message, format!("write body = \"{name}\" instead of the set"));
                return None;
            }
        }
        // The weight of the very mass that is accelerated, as of gravity.
        let mass = match (kind, scene.bodies[b].density) {
            (SceneLoad::Acceleration, None) => {
                let message = format!("`{name}` has no density, and a body without mass needs no force");
                problems.add(
                    format!("{key}.acceleration"),
                    "",
                    message,
                    "give the body a density, or write `body_force`",
                );
                return None;
            }
            (SceneLoad::Acceleration, Some(density)) => Some(model.bodies[b].mass(density)),
            _ => None,
        };
        let solid = &model.bodies[b].solid;
        let patterns = AXES.map(|axis| {
            pattern(components, key, problems, |f| {
                let Some(mass) = &mass else { return solid.body_force(axis, f) };
                let along: Vec<f64> = (0..components).map(|c| axis[c % 3]).collect();
                mass.multiply_add(1.0, &along, f);
                Ok(())
            })
        });
        return Some(LoadKind::Dead { patterns: patterns.into_iter().collect::<Option<_>>()? });
    }
    let set = item.set.as_deref()?;
    let key = format!("{key}.set");
    if kind == SceneLoad::Force {
        let (_, nodes) = resolve(placed, &key, set, problems, Placed::nodes_of)?;
        // On a rigid body once, at its centre of mass.
        let name = split_set(set).map(|(part, _)| part);
        let is_rigid = scene.rigids.iter().any(|item| Some(item.name.as_str()) == name);
        let part = model.parts.iter().find(|part| is_rigid && Some(part.name()) == name);
        let nodes = part.map_or(nodes, |part| vec![part.own_vectors().start]);
        let shares = shares(scene, model, &nodes);
        let patterns =
            (0..3).map(|i| nodes.iter().zip(&shares).map(|(&n, share)| (3 * n + i, *share)).collect()).collect();
        return Some(LoadKind::Dead { patterns });
    }
    if kind == SceneLoad::Moment {
        let (p, nodes) = resolve(placed, &key, set, problems, Placed::nodes_of)?;
        let part = model.parts.iter().find(|part| part.name() == placed[p].name);
        let directors = match part {
            Some(part) if scene.rigids.iter().any(|item| item.name == part.name()) => {
                vec![[1, 2, 3].map(|k| part.own_vectors().start + k)]
            }
            Some(_) => nodes.iter().map(|node| [1, 2, 3].map(|k| node + k)).collect(),
            // Those of the reference body of the set, once it is made.
            None => Vec::new(),
        };
        return Some(LoadKind::Moment { directors });
    }
    let (_, facets) = resolve(placed, &key, set, problems, solid_facets)?;
    let reference = &model.reference;
    match kind {
        SceneLoad::FollowerPressure => Some(LoadKind::FollowerPressure { facets }),
        SceneLoad::Pressure => {
            let unit =
                pattern(components, &key, problems, |f| stoss_fe_solid::dead_pressure(&facets, reference, 1.0, f))?;
            Some(LoadKind::Dead { patterns: vec![unit] })
        }
        _ => {
            let mut patterns = Vec::new();
            for axis in AXES {
                let made =
                    pattern(components, &key, problems, |f| stoss_fe_solid::dead_traction(&facets, reference, axis, f));
                patterns.push(made?);
            }
            if kind == SceneLoad::TotalForce {
                patterns.iter_mut().for_each(|pattern| to_resultant_one(pattern));
            }
            Some(LoadKind::Dead { patterns })
        }
    }
}
