//! Prescribed motion of rigid bodies.

use super::Parts;
use crate::build::condition::RigidMotion;
use crate::scene::{Prescribe, Scene};
use crate::solver::{Model, Prescription, Table};
use stoss_multibody::{ConstraintSet, Equations, Joint, LinearEquations, velocity_violation};

/// Part of the largest speed of the model that is round-off.
const NO_SPEED: f64 = 1e-6;

/// Warnings for initial velocities that joints and equations do not allow, and for motors and values of equations that do not begin where the parts are.
pub(super) fn velocities(
    scene: &Scene,
    couplings: &[ConstraintSet],
    equations: &[Option<LinearEquations>],
    joints: &[Option<Joint>],
    model: &Model,
) -> Vec<String> {
    let fastest = model.velocity.iter().fold(0.0_f64, |fastest, v| fastest.max(v.abs()));
    let sets = couplings.iter().map(|set| set as &dyn Equations);
    let sets = sets.chain(equations.iter().flatten().map(|equation| equation as &dyn Equations));
    let sets = sets.chain(joints.iter().flatten().map(|joint| joint as &dyn Equations));
    let mut list = Vec::new();
    for set in sets {
        let violation = velocity_violation(set, &model.reference, &model.velocity).unwrap_or(0.0);
        if violation > NO_SPEED * fastest {
            list.push(format!(
                "{} {}: the initial velocities violate it by {violation:.3e} (length over time); the first step changes them, which acts as an impact. Give velocities that it allows",
                set.kind_name(),
                set.name()
            ));
        }
    }
    for item in &scene.joints {
        let Some(motor) = &item.motor else { continue };
        let start = motor.angle.iter().chain(&motor.displacement).flat_map(|series| series.rows());
        if start.take(1).any(|row| row.len() > 1 && row[1] != 0.0) {
            list.push(format!(
                "joint {}: its motor does not begin at zero, where the joint is: the first step turns it by the whole value, which acts as an impact. Begin its table with \
                 [0, 0]",
                item.name
            ));
        }
    }
    for item in &scene.equations {
        if item.value.rows().first().is_some_and(|row| row.get(1).is_some_and(|&value| value != 0.0)) {
            list.push(format!(
                "equation {}: its value does not begin at zero, where the displacements are: the first step makes it hold at once, which acts as an impact. Begin its table with [0, 0]",
                item.name
            ));
        }
    }
    list
}

/// Holds the bodies that are fixed.
pub(in crate::build) fn fix(scene: &Scene, parts: &Parts, model: &mut Model) {
    for item in scene.rigids.iter().filter(|item| item.fixed) {
        let Some(body) = parts.rigid(&item.name) else { continue };
        let nodes: Vec<u32> = body.vectors().collect();
        model.prescriptions.push(Prescription {
            name: format!("that fixes {}", item.name),
            directions: nodes[1..].to_vec(),
            nodes,
            components: vec![0, 1, 2],
            displacement: Table::constant(&[0.0; 3]),
            rotation: None,
            ramp_until: None,
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
