//! Equations of couplings, joints and sliding supports that follow from others, or contradict them.

use super::extent::{extent, largest};
use crate::build::Problems;
use crate::build::phase::Phases;
use crate::scene::Scene;
use crate::solver::Model;
use std::collections::BTreeSet;
use stoss_multibody::{
    ConstraintSet, Embedded, Equations, Joint, LinearEquations, LinearTerms, PiecewiseLinear, Weights, analyse,
};
use stoss_term::HeldNodes;

/// What may have redundant equations, whose multipliers are then to be determined.
pub(super) struct Held<'a> {
    pub couplings: &'a mut [ConstraintSet],
    pub equations: &'a mut [Option<LinearEquations>],
    pub joints: &'a mut [Option<Joint>],
}

/// Sliding supports as equations, which come before those of [`Held`] and are not made compliant: a run finds by itself which of them are independent.
fn sliding_supports(model: &Model) -> Vec<LinearEquations> {
    let of_pair = |pair: &crate::solver::CouplingTerm| {
        let slots = if pair.supported_node(0, 0.0).is_some() { pair.term.slot_count() } else { 0 };
        let held = (0..slots).filter_map(|slot| pair.supported_node(slot, 0.0));
        let terms: Vec<LinearTerms> = held.map(|held| vec![(Embedded::vector(held.node), held.direction)]).collect();
        let none = PiecewiseLinear(vec![(0.0, 0.0)]);
        LinearEquations::new(&pair.name, pair.term.length_scale(), &terms, none, &model.reference).ok()
    };
    model.contacts.iter().filter_map(of_pair).collect()
}

/// Warns of redundant joints and makes their multipliers determined; reports contradictions. Once for each set of prescribed motions that act together in a stage, and once without any, if
/// some are released.
pub(super) fn examine(
    scene: &Scene,
    phases: &Phases,
    rigidity: &[ConstraintSet],
    held: Held<'_>,
    model: &Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) {
    let mut supports: Vec<HeldNodes> = Vec::new();
    let is_released = |item: &crate::scene::Prescribe| {
        scene.events.iter().any(|event| item.name.as_ref().is_some_and(|name| *name == event.release))
    };
    let without = scene.prescriptions.iter().any(is_released).then(HeldNodes::default);
    for support in phases.all().map(|phase| phase.held_nodes(model)).chain(without) {
        if !supports.contains(&support) {
            supports.push(support);
        }
    }
    let Held { couplings, equations, joints } = held;
    let supported = sliding_supports(model);
    let mut involved = BTreeSet::new();
    for support in &supports {
        let made = joints.iter().flatten().map(|joint| joint as &dyn Equations);
        let sets: Vec<&dyn Equations> = rigidity
            .iter()
            .map(|set| set as &dyn Equations)
            .chain(supported.iter().map(|set| set as &dyn Equations))
            .chain(couplings.iter().map(|set| set as &dyn Equations))
            .chain(equations.iter().flatten().map(|set| set as &dyn Equations))
            .chain(made)
            .collect();
        let is_free = |component: u32| !support.prescribed(component / 3)[component as usize % 3];
        match analyse(&sets, &model.reference, is_free) {
            Ok(found) => {
                involved.extend(found.involved);
                for message in found.messages {
                    let note = format!(
                        "{message}; the multipliers of least norm are taken, forces and moments of all together are exact"
                    );
                    if !warnings.contains(&note) {
                        warnings.push(note);
                    }
                }
            }
            Err(error) => {
                let remedy = "remove one of the joints, motors or equations that contradict each other, or correct their places and values";
                let name = match &error {
                    stoss_multibody::RedundancyError::Contradiction { name, .. } => name.as_str(),
                    _ => "",
                };
                let of_equation = scene.equations.iter().position(|item| item.name == name);
                let of_coupling = scene.couplings.iter().position(|item| item.name == name);
                let key = match (of_equation, of_coupling) {
                    (Some(e), _) => format!("equation[{e}]"),
                    (_, Some(c)) => format!("coupling[{c}]"),
                    _ => format!("joint[{}]", scene.joint_index(name).unwrap_or_default()),
                };
                problems.add(key, name, error.to_string(), remedy);
                return;
            }
        }
    }
    let weights = weights(scene, model);
    let first = rigidity.len() + supported.len();
    for (k, set) in couplings.iter_mut().enumerate() {
        if involved.contains(&(first + k)) {
            set.set_redundant(Some(weights));
        }
    }
    let first = first + couplings.len();
    let own = equations.iter_mut().flatten();
    let count = own.enumerate().fold(0, |count, (k, equation)| {
        if involved.contains(&(first + k)) {
            equation.set_redundant(Some(weights));
        }
        count + 1
    });
    let first = first + count;
    for (k, joint) in joints.iter_mut().flatten().enumerate() {
        if involved.contains(&(first + k)) {
            joint.set_redundant(Some(weights));
        }
    }
}

/// A mass that is typical of the model, and the largest stiffness in it; only their orders of magnitude matter. Where nothing has mass or stiffness, the largest load over a length.
pub(super) fn weights(scene: &Scene, model: &Model) -> Weights {
    let (mut total, mut count) = (0.0, 0_u32);
    for part in &model.parts {
        part.mass(&mut |i, j, m| {
            if i == j && !part.is_direction(i) && m > 0.0 {
                total += m;
                count += 1;
            }
        });
    }
    let mass = if count > 0 { total / f64::from(count) } else { 0.0 };
    let solids = model
        .bodies
        .iter()
        .map(|body| body.solid.law().small_strain_moduli().shear * body.solid.characteristic_length());
    let parts = model.parts.iter().map(|part| part.force_scale() / part.length_scale());
    let stiffness = solids.chain(parts).fold(0.0, f64::max);
    if mass > 0.0 || stiffness > 0.0 {
        return Weights { mass, stiffness };
    }
    let length = extent(scene, &model.reference);
    let loads = scene.loads.iter().map(|load| {
        let forces = [&load.force, &load.total_force].map(|force| force.as_ref().map_or(0.0, largest));
        forces[0].max(forces[1]).max(load.moment.as_ref().map_or(0.0, largest) / length)
    });
    let force = loads.fold(0.0, f64::max);
    Weights { mass, stiffness: if force > 0.0 { force / length } else { 1.0 } }
}
