//! Layers of prescribed displacements, supports and loads, with arrows along what they hold or push.

use super::layer::{Arrow, Kind, Layer, Space};
use super::part_of;
use crate::scene::{Component, LoadKind as SceneLoad, Prescribe, Scene};
use crate::solver::LoadKind;
use stoss_solver::digits;

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Arrows of a layer at most; beyond, places are left out evenly.
const MANY: usize = 60;

/// Every so manieth one, so that there are at most [`MANY`].
fn some<T>(list: &[T]) -> impl Iterator<Item = &T> {
    list.iter().step_by(list.len().div_ceil(MANY).max(1))
}

/// Displacements that are prescribed, with an arrow for each direction at each node.
pub(super) fn prescriptions(scene: &Scene, space: &Space) -> Vec<Layer> {
    let numbered = scene.prescriptions.iter().enumerate();
    let mut layers: Vec<Layer> = numbered.map(|(number, item)| prescription(number, item, space)).collect();
    for rigid in scene.rigids.iter().filter(|rigid| rigid.fixed) {
        let mut layer = Layer::new(Kind::Prescribed, rigid.name.clone(), "the rigid body is fixed".to_owned());
        let middle = space.middle(&space.nodes(&format!("{}.all", rigid.name))).unwrap_or(rigid.position);
        layer.arrows.extend(AXES.map(|axis| Arrow::new(middle, axis, true)));
        layers.push(layer);
    }
    layers
}

fn prescription(number: usize, item: &Prescribe, space: &Space) -> Layer {
    let on = item.set.clone().or_else(|| item.rigid.clone()).unwrap_or_default();
    let name = item.name.clone().unwrap_or_else(|| format!("prescribe[{number}] of {on}"));
    let nodes = match (&item.set, &item.rigid) {
        (Some(set), _) => space.nodes(set),
        (None, Some(rigid)) => space.nodes(&format!("{rigid}.all")),
        (None, None) => Vec::new(),
    };
    let axis = |component: &Component| match component {
        Component::X => AXES[0],
        Component::Y => AXES[1],
        Component::Z => AXES[2],
    };
    let components = item.prescribed_components();
    let directions = item.normal.map_or_else(|| components.iter().map(axis).collect(), |normal| vec![normal]);
    let names: Vec<String> = components.iter().map(ToString::to_string).collect();
    let along = if item.normal.is_some() { "the normal".to_owned() } else { names.join(", ") };
    let is_still = item.rows().iter().all(|row| row[1..].iter().all(|value| *value == 0.0));
    let about = match (&item.rotation, is_still) {
        (Some(_), _) => format!("rotation of {on}"),
        (None, true) => format!("{on} fixed along {along}"),
        (None, false) => format!("{on} moved along {along}"),
    };
    let mut layer = Layer::new(Kind::Prescribed, name, about);
    // The motion of a rigid body is that of one point.
    let places: Vec<[f64; 3]> = match item.rigid {
        Some(_) => space.middle(&nodes).into_iter().collect(),
        None => nodes.iter().map(|&node| space.place(node)).collect(),
    };
    layer.add_places(&places);
    for place in some(&places) {
        layer.arrows.extend(directions.iter().map(|direction| Arrow::new(*place, *direction, true)));
    }
    if let Some(rotation) = &item.rotation {
        layer.arrows = vec![Arrow::new(rotation.about, rotation.axis, false)];
    }
    layer
}

/// Supports, with an arrow for each axis that has a stiffness or damping.
pub(super) fn supports(scene: &Scene, space: &Space) -> Vec<Layer> {
    let one = |(number, support): (usize, &crate::scene::Support)| {
        let about = format!("springs and dashpots to the ground per {}", support.per);
        let mut layer = space.surface(Kind::Support, support.part_name(number), &support.set, &about);
        let axes = support.axes().unwrap_or(AXES);
        let acts = |k: &usize| support.stiffness[*k] > 0.0 || support.damping[*k] > 0.0;
        for node in some(&space.nodes(&support.set)) {
            let arrows = (0..3).filter(acts).map(|k| Arrow::new(space.place(*node), axes[k], true));
            layer.arrows.extend(arrows);
        }
        layer
    };
    scene.supports.iter().enumerate().map(one).collect()
}

/// Loads where they are largest, with arrows along their forces; gravity.
pub(super) fn loads(scene: &Scene, space: &Space) -> Vec<Layer> {
    let mut layers = Vec::new();
    for (number, (item, load)) in scene.loads.iter().zip(&space.model.loads).enumerate() {
        let Some((kind, series)) = item.kind() else { continue };
        let on = item.set.clone().or_else(|| item.body.clone()).unwrap_or_default();
        let name = item.name.clone().unwrap_or_else(|| format!("load[{number}] on {on}"));
        let size = |row: &[f64]| row[1..].iter().map(|value| value * value).sum::<f64>();
        let rows = series.rows();
        let largest = rows.iter().max_by(|a, b| size(a).total_cmp(&size(b))).map_or(&[][..], |row| &row[1..]);
        let values: Vec<String> = largest.iter().map(|value| digits(*value)).collect();
        let about = format!("{kind} on {on}, at most {}", values.join(", "));
        let mut layer = match item.set.as_deref().filter(|_| !matches!(kind, SceneLoad::Force | SceneLoad::Moment)) {
            Some(set) => space.surface(Kind::Load, name, set, &about),
            None => Layer::new(Kind::Load, name, about),
        };
        let nodes = space.nodes(&item.set.clone().unwrap_or_else(|| format!("{}.all", part_of(&on))));
        match (&load.kind, kind) {
            (LoadKind::Dead { .. }, SceneLoad::BodyForce | SceneLoad::Acceleration) => {
                let middle = space.middle(&nodes);
                layer.arrows.extend(middle.map(|place| Arrow::new(place, vector(largest), false)));
            }
            (LoadKind::Dead { patterns }, _) => {
                let is_pressure = kind == SceneLoad::Pressure;
                let forces = nodal_forces(patterns, largest);
                let place = |node: u32| space.place(node);
                layer.arrows.extend(some(&forces).map(|&(node, force)| Arrow::new(place(node), force, is_pressure)));
            }
            (LoadKind::FollowerPressure { facets }, _) => {
                let sign = largest.first().map_or(1.0, |pressure| pressure.signum());
                layer.arrows.extend(some(facets).map(|facet| inward(space, facet.corners(), sign)));
            }
            (LoadKind::Moment { .. }, _) => {
                let middle = space.middle(&nodes);
                layer.arrows.extend(middle.map(|place| Arrow::new(place, vector(largest), false)));
            }
            (LoadKind::Centrifugal { axis, about, .. }, _) => layer.arrows.push(Arrow::new(*about, *axis, false)),
        }
        layers.push(layer);
    }
    if let Some(gravity) = &scene.gravity {
        let about = gravity.acceleration.map(digits).join(", ");
        let mut layer = Layer::new(Kind::Load, "gravity".to_owned(), about);
        for part in space.placed {
            let middle = space.middle(&space.nodes(&format!("{}.all", part.name)));
            layer.arrows.extend(middle.map(|place| Arrow::new(place, gravity.acceleration, false)));
        }
        layers.push(layer);
    }
    layers
}

fn vector(values: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0))
}

/// Nodes and forces of a dead load: the patterns, whose entries are components of nodes, times values.
fn nodal_forces(patterns: &[Vec<(u32, f64)>], values: &[f64]) -> Vec<(u32, [f64; 3])> {
    let mut forces = std::collections::BTreeMap::<u32, [f64; 3]>::new();
    for (pattern, value) in patterns.iter().zip(values) {
        for &(component, force) in pattern {
            forces.entry(component / 3).or_default()[component as usize % 3] += force * value;
        }
    }
    forces.into_iter().collect()
}

/// The arrow of a pressure on a facet, at its middle.
fn inward(space: &Space, corners: &[u32], sign: f64) -> Arrow {
    let middle = space.middle(corners).unwrap_or_default();
    let [a, b, c] = [0, 1, 2].map(|k| space.place(corners[k]));
    let [u, v] = [b, c].map(|x| std::array::from_fn::<f64, 3, _>(|i| x[i] - a[i]));
    let outward = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    Arrow::new(middle, outward.map(|n| -sign * n), sign > 0.0)
}
