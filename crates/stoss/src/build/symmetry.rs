//! Planes of symmetry of a whole scene: bodies end there, and their cut faces are no surfaces.

use super::Problems;
use super::placed::Placed;
use crate::scene::{Component, Prescribe, Scene};
use stoss_mesh::{BOUNDARY, Mesh};
#[cfg(feature = "mortar")]
use {
    std::collections::BTreeMap,
    stoss_mesh::slice::{AXIS, HIGH, LOW},
};

/// Distance of nodes in the plane from it, in parts of the size of the body.
const IN_PLANE: f64 = 1e-6;

/// Name of the set of a body's nodes in the plane across a component.
fn set(component: Component) -> String {
    format!("symmetry-{component}")
}

/// Puts nodes in the planes onto them exactly, as sets, and takes the cut faces out of the boundary. Reports a body that lies on both sides.
pub(super) fn cut(scene: &Scene, key: &str, mut mesh: Mesh, problems: &mut Problems<'_>) -> Option<Mesh> {
    if scene.header.symmetry.is_empty() {
        return Some(mesh);
    }
    let (low, high) = mesh.bounding_box();
    let tolerance = IN_PLANE * (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let mut boundary = mesh.facets_of(BOUNDARY).unwrap_or_default();
    for &component in scene.header.symmetry.as_slice() {
        let i = component.index();
        if low[i] < -tolerance && high[i] > tolerance {
            let message =
                format!("lies on both sides of the plane of symmetry {component} = 0, from {} to {}", low[i], high[i]);
            problems.add(
                format!("{key}.mesh"),
                "",
                message,
                "model one side of it, or leave the plane out of `symmetry`",
            );
            return None;
        }
        let mut nodes = Vec::new();
        for (n, x) in mesh.nodes.iter_mut().enumerate().filter(|(_, x)| x[i].abs() <= tolerance) {
            x[i] = 0.0;
            nodes.push(n as u32);
        }
        boundary.retain(|facet| !facet.nodes.iter().all(|node| nodes.binary_search(node).is_ok()));
        if !nodes.is_empty() {
            mesh.node_sets.insert(set(component), nodes);
        }
    }
    mesh.facet_sets.insert(BOUNDARY.to_owned(), boundary);
    Some(mesh)
}

/// The side of the plane that a mesh lies on: 1 or -1.
fn side(mesh: &Mesh, component: Component) -> f64 {
    let (low, high) = mesh.bounding_box();
    (low[component.index()] + high[component.index()]).signum()
}

/// Axes across the planes, and the sides of the planes on which the bodies lie.
pub(super) fn sides(scene: &Scene, placed: &[Placed]) -> Vec<(usize, f64)> {
    let first = placed.iter().find_map(Placed::mesh);
    let planes = scene.header.symmetry.as_slice().iter();
    planes.filter_map(|&component| Some((component.index(), side(first?, component)))).collect()
}

/// What holds the bodies in the planes; a plane that no body reaches is reported.
pub(super) fn supports(scene: &Scene, placed: &[Placed], problems: &mut Problems<'_>) -> Vec<Prescribe> {
    let mut held = Vec::new();
    for &component in scene.header.symmetry.as_slice() {
        let before = held.len();
        let sides = placed.iter().filter_map(|part| Some((side(part.mesh()?, component), part)));
        let sides: Vec<(f64, &Placed)> = sides.collect();
        if let Some((_, other)) = sides.iter().find(|(side, _)| Some(*side) != sides.first().map(|first| first.0)) {
            let message =
                format!("`{}` and `{}` lie on two sides of the plane {component} = 0", sides[0].1.name, other.name);
            problems.add("scene.symmetry".into(), component, message, "model one side, or leave the plane out");
        }
        let meets = |part: &&Placed| part.mesh().is_some_and(|mesh| mesh.node_sets.contains_key(&set(component)));
        held.extend(placed.iter().filter(meets).map(|part| Prescribe {
            components: vec![component],
            ..Prescribe::fixed(format!("{}.{}", part.name, set(component)))
        }));
        if held.len() == before {
            let message = format!("no deformable body has a node in the plane {component} = 0");
            problems.add("scene.symmetry".into(), component, message, "move the bodies, or leave the plane out");
        }
    }
    held
}

/// Planes that nodes of the model lie in, a bit each: those across x, y, z, the sides of slices, and the axis of sectors.
#[cfg(feature = "mortar")]
pub(super) fn planes(scene: &Scene, placed: &[Placed]) -> BTreeMap<u32, u8> {
    let mut planes: BTreeMap<u32, u8> = BTreeMap::new();
    let across = scene.header.symmetry.as_slice().iter().map(|&component| (set(component), component.index()));
    let sides = [(LOW, 3), (HIGH, 4), (AXIS, 5)].into_iter().filter(|_| scene.header.section.is_some());
    for (name, bit) in across.chain(sides.map(|(name, bit)| (name.to_owned(), bit))) {
        for node in placed.iter().filter_map(|part| part.nodes_of(&name).ok()).flatten() {
            *planes.entry(node).or_default() |= 1 << bit;
        }
    }
    planes
}
