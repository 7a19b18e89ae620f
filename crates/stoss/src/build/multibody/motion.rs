//! Prescribed motion of rigid bodies.

use super::Parts;
use crate::build::condition::RigidMotion;
use crate::scene::{Prescribe, Scene};
use crate::solver::{Model, Prescription, Table};

/// Holds the bodies that are fixed.
pub(in crate::build) fn fix(scene: &Scene, parts: &Parts, model: &mut Model) {
    for body in scene.rigids.iter().filter(|item| item.fixed).filter_map(|item| parts.rigid(&item.name)) {
        let nodes: Vec<u32> = body.vectors().collect();
        model.prescriptions.push(Prescription {
            directions: nodes[1..].to_vec(),
            nodes,
            components: vec![0, 1, 2],
            displacement: Table::constant(&[0.0; 3]),
            rotation: None,
        });
    }
}

/// Nodes of a prescription that moves a rigid body, those of them that are directions, and the rows of its table with a column for each of the three
/// components: what is not named does not move.
pub(in crate::build) fn prescribe_rigid(item: &Prescribe, parts: &Parts) -> Option<RigidMotion> {
    let body = parts.rigid(item.rigid.as_deref()?)?;
    let nodes: Vec<u32> = body.vectors().collect();
    let directions = nodes[1..].to_vec();
    let components = item.prescribed_components();
    let rows = item.rows();
    let full = rows.iter().map(|row| {
        let mut full = vec![row[0], 0.0, 0.0, 0.0];
        for (component, value) in components.iter().zip(&row[1..]) {
            full[1 + component.index()] = *value;
        }
        full
    });
    Some((nodes, directions, full.collect()))
}
