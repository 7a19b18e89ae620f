//! Mortar contact of a scene.

use super::pair::PairInput;
use super::{ContactPlan, Problems, symmetry};
use crate::scene::{Constraint, Enforcement, Integrals as Chosen, Multipliers, Slip};
use crate::solver::{CouplingTerm, Model};
use stoss_contact::friction::Stick;
use stoss_contact_mortar::{Integrals, MortarContact, MortarOptions, MultiplierSpace, SlipMeasure};
use stoss_integrators::GradientRule;
use stoss_term::{HeldNodes, Term as _};

/// Adds the contact to the model; reports what is wrong.
pub(super) fn contact(
    pair: &PairInput<'_>,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<ContactPlan> {
    let item = pair.item;
    let label = item.label();
    let phases = || pair.phases.with(&label);
    // Statics, and schemes that take contact forces at the end of the step; the others hold integrals there.
    let has_end_point = phases().any(|phase| phase.rule() == GradientRule::EndPoint);
    let within = phases().find_map(|phase| phase.scheme_within_step());
    let options = MortarOptions {
        space: match item.multipliers {
            Some(Multipliers::Dual) => MultiplierSpace::Dual,
            Some(Multipliers::Centred) => MultiplierSpace::Centred,
            Some(Multipliers::Standard) | None => MultiplierSpace::Standard,
        },
        integrals: match item.integrals {
            Some(Chosen::Frozen) => Integrals::Frozen,
            Some(Chosen::Moving) | None => Integrals::Moving,
        },
        hold: pair.hold(model),
        overclosure: match item.enforcement {
            Enforcement::Penalty(stiffness) => Some(stiffness),
            Enforcement::Multiplier => None,
        },
    };
    if options.integrals == Integrals::Frozen && has_end_point {
        let message = "are those of the middle of the step; statics and this scheme take contact forces at its end";
        let remedy = "remove it, or use a scheme such as `energy-momentum`";
        problems.add(format!("{}.integrals", pair.key), "frozen", message, remedy);
        return None;
    }
    if let (Some(stiffness), Some(scheme)) = (options.overclosure, within) {
        let message =
            format!("is for statics and schemes that take contact forces at the end of the step, not for `{scheme}`");
        problems.add(
            format!("{}.enforcement", pair.key),
            stiffness.to_string(),
            message,
            "remove it, or use `backward-euler`",
        );
        return None;
    }
    pair.warn_of_restitution(warnings);
    let [slave, master] = pair.pieces;
    match MortarContact::new(&item.label(), slave, master, &model.reference, options) {
        Ok(method) => {
            let mut method = method.with_symmetry(symmetry::planes(pair.scene, pair.placed));
            let acting: Vec<HeldNodes> = pair.acting(&label, model).map(|(_, support)| support).collect();
            let is_held = |support: &HeldNodes| {
                let held = |&n: &u32| support.prescribed(n) == [true; 3] && model.embedding.carriers(n).is_some();
                method.slave().nodes().iter().all(held)
            };
            if pair.is_rigid() && acting.iter().any(is_held) {
                let message = "the slave is a rigid body whose whole motion is prescribed, and the master is rigid too: the pressures are not determined";
                problems.add(pair.key.clone(), item.label(), message, "exchange slave and master");
                return None;
            }
            if acting.iter().any(|support| method.is_slave_held_along_normals(|n| given(support, model, n))) {
                warnings.push(format!(
                    "{}: the motion of the whole slave surface along its normal is prescribed; where it has more nodes than the master beside it the \
                     pressures are not determined, and the contact resists more than the bodies do. Exchange slave and master",
                    item.label()
                ));
            }
            let is_dragged = acting.iter().any(|support| method.is_slave_dragged(|n| given(support, model, n)));
            let complementarity = pair.prepare(&mut method, Constraint::Standard, model, problems, warnings);
            method = method.with_stiffness(complementarity);
            let mut plan = None;
            if let Some(friction) = &item.friction {
                let slip = match friction.slip {
                    Some(Slip::Direct) => SlipMeasure::Direct,
                    Some(Slip::Objective) | None => SlipMeasure::Objective,
                };
                let (friction, described) = super::friction::friction(pair, friction, complementarity, problems)?;
                if is_dragged && friction.stick() == Stick::Multiplier && pair.is_slave_finer(model) {
                    warnings.push(format!(
                        "{}: a motion of all slave nodes along the surface is prescribed, and the slave is finer than the master: where it sticks there are more tractions than \
                         motions of the master, they are not determined, and Newton's iteration may stagnate. Exchange slave and master, prescribe the motion away from the contact, or \
                         give the friction a tangential stiffness, `penalty`",
                        item.label()
                    ));
                }
                let friction = friction.with_inertia(pair.inertia(model, method.length_scale()));
                plan = Some(described);
                method = match method.with_friction(friction, slip) {
                    Ok(method) if pair.is_rigid() => method.with_compliant_stick(),
                    Ok(method) => method,
                    Err(error) => {
                        let key = format!("{}.friction", pair.key);
                        problems.add(key, "", error.to_string(), "use the standard constraint");
                        return None;
                    }
                };
            }
            let plan = pair.plan(&method, Constraint::Standard, plan);
            model.contacts.push(CouplingTerm {
                name: item.label(),
                acts: true,
                term: Box::new(method),
                complementarity,
                restitution: pair.restitution(),
            });
            Some(plan)
        }
        Err(error) => {
            pair.refused(&error, problems);
            None
        }
    }
}

/// Which components of a node are prescribed, or all of them if a tie gives its motion; of vertices that follow their faces those of the former alone.
fn given(support: &HeldNodes, model: &Model, node: u32) -> [bool; 3] {
    if model.follows_its_face(node) { support.prescribed(node) } else { support.given(node) }
}
