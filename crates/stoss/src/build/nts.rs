//! Node-to-surface contact of a scene.

use super::beside::beside;
use super::pair::PairInput;
use super::{ContactPlan, FrictionPlan, Problems};
use crate::scene::{Constraint, Enforcement as Enforced, OverlapAtStart};
use crate::solver::{CouplingTerm, Model};
use stoss_contact::{ContactLine, Enforcement};
use stoss_contact_nts::{Arches, ConstraintForm, CoordinateAugmented, NodeToSurface, NodeToSurfaceOptions};
use stoss_mesh::BOUNDARY;
use stoss_term::Term;

/// Adds the contact to the model; reports what is wrong.
pub(super) fn contact(
    pair: &PairInput<'_>,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<ContactPlan> {
    Some(add(pair, model, made(pair, model, problems, warnings)?, |method| Box::new(method)))
}

/// Adds a contact as [`contact`], by coordinate augmentation.
pub(super) fn augmented(
    pair: &PairInput<'_>,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<ContactPlan> {
    let made = made(pair, model, problems, warnings)?;
    if let Some(scheme) = super::friction::scheme_elsewhere(pair) {
        let message = format!("is not available with the scheme `{scheme}`");
        let schemes = super::friction::schemes_that_fit();
        let remedy = format!("use `nts`, or one of the schemes {schemes}");
        problems.add(format!("{}.method", pair.key), pair.item.method.name, message, remedy);
        return None;
    }
    let reduction = reduction(pair.item);
    Some(add(pair, model, made, |method| Box::new(CoordinateAugmented::new(method, reduction))))
}

/// The method of a contact, and what it will be computed with.
struct Made {
    method: NodeToSurface,
    constraint: Constraint,
    friction: Option<FrictionPlan>,
    complementarity: f64,
}

fn add(
    pair: &PairInput<'_>,
    model: &mut Model,
    made: Made,
    term: impl Fn(NodeToSurface) -> Box<dyn Term>,
) -> ContactPlan {
    let Made { method, constraint, friction, complementarity } = made;
    let term = term(method);
    let plan = pair.plan(&*term, constraint, friction);
    let (name, restitution) = (pair.item.label(), pair.restitution());
    model.contacts.push(CouplingTerm { name, term, acts: true, complementarity, restitution });
    plan
}

fn made(pair: &PairInput<'_>, model: &Model, problems: &mut Problems<'_>, warnings: &mut Vec<String>) -> Option<Made> {
    let item = pair.item;
    let constraint = item.constraint.unwrap_or(Constraint::Standard);
    let form = match constraint {
        Constraint::Standard => ConstraintForm::Standard,
        Constraint::Modified => ConstraintForm::Modified,
    };
    let enforcement = match item.enforcement {
        Enforced::Multiplier => Enforcement::Multiplier,
        Enforced::Penalty(stiffness) => Enforcement::Penalty(stiffness),
    };
    pair.warn_of_restitution(warnings);
    let hold = pair.hold(model);
    let options = NodeToSurfaceOptions { constraint: form, enforcement, hold, ..NodeToSurfaceOptions::default() };
    let [slave, master] = pair.facets;
    let made = if pair.line.is_empty() {
        NodeToSurface::new(&item.label(), slave, master, &model.reference, options)
    } else {
        let (nodes, lengths): (Vec<u32>, Vec<f64>) = pair.line.iter().copied().unzip();
        ContactLine::new(&nodes, &lengths, &model.reference)
            .and_then(|line| NodeToSurface::of_line(&item.label(), line, master, &model.reference, options))
    };
    let mut method = match made.and_then(|made| made.with_sides(&beside(pair, model), &model.reference)) {
        Ok(method) => method,
        Err(error) => {
            pair.refused(&error, problems);
            return None;
        }
    };
    warnings.extend(quadratic(pair, model));
    let complementarity = pair.prepare(&mut method, constraint, model, problems, warnings);
    refuse_arches(pair, &method, model, problems);
    let mut plan = None;
    if let Some(friction) = &item.friction {
        let (friction, described) = super::friction::friction(pair, friction, complementarity, problems)?;
        let friction = friction.with_inertia(pair.inertia(model, method.length_scale()));
        plan = Some(described);
        method = match method.with_friction(friction) {
            Ok(method) if pair.is_rigid() => method.with_compliant_stick(),
            Ok(method) => method,
            Err(error) => {
                let key = format!("{}.friction", pair.key);
                problems.add(key, "", error.to_string(), "use the standard constraint");
                return None;
            }
        };
    }
    Some(Made { method, constraint, friction: plan, complementarity })
}

/// Refuses a press fit, or an overlap, of round quadratic faces whose gaps differ because of the arches of their traces.
fn refuse_arches(pair: &PairInput<'_>, method: &NodeToSurface, model: &Model, problems: &mut Problems<'_>) {
    let interference = pair.item.interference.iter().flat_map(|d| d.rows()).map(|row| row[1]).fold(0.0, f64::max);
    let overlaps = pair.item.overlap != Some(OverlapAtStart::Keep);
    if let Some(Arches { spread, overlap, .. }) =
        Arches::spoil(pair.pieces, method, &model.reference, interference, overlaps)
    {
        let (what, size) = if interference > 0.0 { ("interference", interference) } else { ("overlap", overlap) };
        let message = format!(
            "takes vertices that lie beside these round quadratic faces by a third of the height of their arches: gaps differ by {spread:.3e} from their mean, and the {what} is {size:.3e}, so that pressures would be those of the arches"
        );
        problems.add(
            format!("{}.method", pair.key),
            pair.item.method.name,
            message,
            "use `method = \"mortar\"`, which has the faces as they are",
        );
    }
}

/// What to know of quadratic faces here.
fn quadratic(pair: &PairInput<'_>, model: &Model) -> Option<String> {
    let [slave, master] = pair.facets;
    let mut nodes = slave.iter().chain(master).flatten();
    // Vertices of round surfaces of linear cells are traces, too.
    let has_quadratic = |&body: &usize| {
        let facets = pair.placed[body].mesh().map(|mesh| mesh.facets_of(BOUNDARY));
        facets.is_some_and(|found| found.is_ok_and(|list| list.iter().any(|facet| facet.nodes.kind().is_quadratic())))
    };
    if !nodes.any(|node| model.traces.contains_key(node)) || !pair.bodies.iter().any(has_quadratic) {
        return None;
    }
    let is_redundant = pair.item.enforcement == Enforced::Multiplier
        && slave.iter().flatten().any(|&node| model.follows_its_face(node));
    let redundant = "; exact pressures in the middle of the slave's 8-node faces are redundant, and the system may be singular where the slave is as fine as the master or finer";
    Some(format!(
        "{}: node-to-surface contact of quadratic faces does not pass a uniform pressure between meshes that do not match: pressures at nodes are wrong by tens of per cent \
         (up to 36 % between two blocks){}. Use `method = \"mortar\"`, or `[general_contact]`{}",
        pair.item.label(),
        if is_redundant { redundant } else { "" },
        if is_redundant { ", or a penalty" } else { "" }
    ))
}

fn reduction(item: &crate::scene::Contact) -> stoss_contact_nts::Reduction {
    use stoss_contact_nts::Reduction;
    match item.reduction {
        Some(crate::scene::Reduction::None) => Reduction::None,
        Some(crate::scene::Reduction::First) => Reduction::First,
        Some(crate::scene::Reduction::Second) | None => Reduction::Second,
    }
}
