//! Mortar contact of a scene.

use super::condition::prescribed;
use super::pair::PairInput;
use super::{ContactPlan, Problems};
use crate::scene::{
    Closing, Constraint, Enforcement, Integrals as Chosen, Multipliers, Quadrature as Points, Scene, Slip,
};
use crate::solver::{ContactPair, Coupling, Model, contact_rule};
use stoss_contact::friction::Stick;
use stoss_contact::{Constraint as _, Report as _};
use stoss_contact_mortar::{
    Force, Integrals, MortarContact, MortarOptions, MultiplierSpace, SlipMeasure, TriangleRule,
};
use stoss_integrators::GradientRule;

/// How much more near points count in statics than far ones, over the length of a slave facet. In dynamics the force would have the kinks of its weights, at which
/// Newton stops where edges of both surfaces lie on each other.
const NEARNESS: f64 = 12.0;

/// Adds the contact to the model; reports what is wrong.
pub(super) fn contact(
    pair: &PairInput<'_>,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<ContactPlan> {
    let item = pair.item;
    let rule = match item.quadrature {
        Some(Points::FourPoint) => TriangleRule::FourPoint,
        Some(Points::TwelvePoint) => TriangleRule::TwelvePoint,
        Some(Points::SevenPoint) | None => TriangleRule::SevenPoint,
    };
    let gradient = gradient_rule(pair.scene);
    let constant = pair.scene.time.integrator.as_ref().filter(|_| gradient != GradientRule::EndPoint);
    let constant = constant.map(|integrator| integrator.scheme.as_str());
    // What is inside at the start of a step gives energy if it is pushed out.
    let dynamic = pair.scene.time.integrator.is_some();
    let options = MortarOptions {
        space: match item.multipliers {
            Some(Multipliers::Dual) => MultiplierSpace::Dual,
            Some(Multipliers::Standard) | None => MultiplierSpace::Standard,
        },
        rule,
        integrals: match item.integrals {
            Some(Chosen::Frozen) => Integrals::Frozen,
            Some(Chosen::Moving) | None => Integrals::Moving,
        },
        nearness: item.nearness.unwrap_or(if dynamic { 0.0 } else { NEARNESS }),
        force: if dynamic { Force::Gradient } else { Force::FixedWeights },
        overclosure: match item.enforcement {
            Enforcement::Penalty(stiffness) => Some(stiffness),
            Enforcement::Multiplier | Enforcement::Augmented(_) => None,
        },
        keeps_penetration: dynamic,
    };
    if options.integrals == Integrals::Frozen && constant.is_none() {
        let message = "are those of the middle of the step; statics and this scheme take contact forces at its end";
        let remedy = "remove it, or use a scheme such as `energy-momentum`";
        problems.add(format!("{}.integrals", pair.key), "frozen", message, remedy);
        return None;
    }
    if let (Some(stiffness), Some(scheme)) = (options.overclosure, constant) {
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
    let restores = item.closing == Some(Closing::Restore);
    if restores && (constant.is_none() || !matches!(gradient, GradientRule::Midpoint | GradientRule::DiscreteGradient))
    {
        let message = "is for schemes whose contact forces do the work of the gaps: `energy-momentum`, and `midpoint`";
        problems.add(format!("{}.closing", pair.key), "restore", message, "remove it, or use `energy-momentum`");
        return None;
    }
    if restores && options.integrals == Integrals::Frozen {
        let message = "needs gaps that are functions of the positions; with frozen integrals they differ from one step to the next";
        problems.add(format!("{}.closing", pair.key), "restore", message, "remove it or `integrals`");
        return None;
    }
    // True if an entry cannot be had, which is said.
    let refuse = |entry: &str, value: &str, remedy: &str, problems: &mut Problems<'_>| {
        if let Some(scheme) = constant {
            let message = format!("needs integrals that move in the step; with the scheme `{scheme}` they are fixed");
            problems.add(format!("{}.{entry}", pair.key), value, message, format!("{remedy}, or use `backward-euler`"));
        }
        constant.is_some()
    };
    let [slave, master] = pair.pieces;
    let fixed = prescribed(model);
    match MortarContact::new(&item.label(), slave, master, &model.reference, options) {
        Ok(method) => {
            let prescribed = |n: u32| [0, 1, 2].map(|i| pair.tied.contains(&n) || fixed[3 * n as usize + i]);
            let held = |&n: &u32| (0..3).all(|i| fixed[3 * n as usize + i]) && model.embedding.carriers(n).is_some();
            if pair.is_rigid() && method.slave().nodes().iter().all(held) {
                let message = "the slave is a rigid body whose whole motion is prescribed, and the master is rigid too: the pressures are not determined";
                problems.add(pair.key.clone(), item.label(), message, "exchange slave and master");
                return None;
            }
            let mut slave_nodes = method.slave().nodes().iter().enumerate();
            if slave_nodes.all(|(a, &n)| method.is_held_along_normal(a, prescribed(n))) {
                warnings.push(format!(
                    "{}: the motion of the whole slave surface along its normal is prescribed; where it has more nodes than the master beside it the \
                     pressures are not determined, and the system is singular. Exchange slave and master",
                    item.label()
                ));
            }
            // A component that is prescribed on all of the slave but not on the master.
            let is_dragged = (0..3).any(|i| {
                let alone = |n: u32| std::array::from_fn(|k| k == i && prescribed(n)[k]);
                let mut slave_nodes = method.slave().nodes().iter().enumerate();
                slave_nodes.all(|(a, &n)| method.is_held_across_normal(a, alone(n)))
                    && method.master().nodes().iter().any(|&n| !alone(n)[i])
            });
            let mut method =
                method.with_crosspoints(|n| if model.follows_its_face(n) { [true; 3] } else { prescribed(n) });
            method.set_rule(contact_rule(gradient), pair.scene.time.step);
            let complementarity = pair.prepare(&mut method, Constraint::Standard, model, problems, warnings);
            method = method.with_stiffness(complementarity);
            let mut plan = None;
            if let Some(friction) = &item.friction {
                let slip = match friction.slip() {
                    Some(Slip::Direct) => SlipMeasure::Direct,
                    Some(Slip::Yang) => SlipMeasure::Yang,
                    Some(Slip::Objective) | None => SlipMeasure::Objective,
                };
                if slip == SlipMeasure::Yang && refuse("friction.slip", "yang", "use `objective`", problems) {
                    return None;
                }
                let (friction, described) =
                    super::friction::friction(pair, friction, complementarity, problems, warnings)?;
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
                    Ok(method) => method.with_compliant_stick(|node| pair.held.contains(&node) || pair.is_rigid()),
                    Err(error) => {
                        let key = format!("{}.friction", pair.key);
                        problems.add(key, "", error.to_string(), "use the standard constraint");
                        return None;
                    }
                };
            }
            let plan = pair.plan(&method, Constraint::Standard, plan);
            model.contacts.push(ContactPair {
                name: item.label(),
                method: Coupling::contact(method),
                complementarity,
                restores,
            });
            Some(plan)
        }
        Err(error) => {
            pair.refused(&error, problems);
            None
        }
    }
}

/// Where the scene takes the gradient of the gaps: in statics at the end point. Under every other rule mortar integrals are those of the start of the step.
fn gradient_rule(scene: &Scene) -> GradientRule {
    // A scheme that cannot be made is reported where it is named.
    let scheme = scene.time.integrator.as_ref().and_then(|integrator| integrator.make().ok());
    scheme.map_or(GradientRule::EndPoint, |scheme| scheme.rule(scene.time.step).constraint.rule)
}
