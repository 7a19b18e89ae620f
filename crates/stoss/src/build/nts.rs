//! Node-to-surface contact of a scene.

use super::pair::PairInput;
use super::{ContactPlan, Problems};
use crate::scene::{Constraint, Enforcement as Enforced, split_set};
use crate::solver::{ContactPair, Coupling, Model};
use std::collections::BTreeSet;
use stoss_contact::{ContactLine, Enforcement, Report as _};
use stoss_contact_nts::{ConstraintForm, CoordinateAugmented, NodeToSurface, NodeToSurfaceOptions};
use stoss_mesh::BOUNDARY;
use stoss_reference_element::FacetNodes;

/// Component of a unit normal from which on a support in that direction holds the facet in its plane, and cosine of its angle with an inclined one.
const HELD: f64 = 0.5;
const ALONG: f64 = 0.9;

/// Adds the contact to the model; reports what is wrong.
pub(super) fn contact(
    pair: &PairInput<'_>,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<ContactPlan> {
    let item = pair.item;
    let constraint = item.constraint.unwrap_or(Constraint::Standard);
    let form = match constraint {
        Constraint::Standard => ConstraintForm::Standard,
        Constraint::Modified => ConstraintForm::Modified,
    };
    let enforcement = match item.enforcement {
        Enforced::Multiplier => Enforcement::Multiplier,
        Enforced::Penalty(stiffness) => Enforcement::Penalty(stiffness),
        Enforced::Augmented(stiffness) => Enforcement::Augmented(stiffness),
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
    let mut plan = None;
    if let Some(friction) = &item.friction {
        let (friction, described) = super::friction::friction(pair, friction, complementarity, problems, warnings)?;
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
    let method = match item.method {
        crate::scene::ContactMethod::Cat => {
            if let Some(scheme) = super::friction::scheme_elsewhere(pair) {
                let message = format!("is not available with the scheme `{scheme}`");
                let key = format!("{}.method", pair.key);
                let schemes = super::friction::schemes_that_fit();
                problems.add(key, "cat", message, format!("use `nts`, or one of the schemes {schemes}"));
                return None;
            }
            Coupling::contact(CoordinateAugmented::new(method, augmentation(item)))
        }
        _ => Coupling::contact(method),
    };
    let plan = pair.plan(&*method, constraint, plan);
    model.contacts.push(ContactPair { name: item.label(), method, complementarity, restitution: pair.restitution() });
    Some(plan)
}

/// What of the master's body lies beside the rims of the master and can be touched: not what supports hold in its plane, as in planes of symmetry, nor surfaces of other contacts and of ties.
fn beside(pair: &PairInput<'_>, model: &Model) -> Vec<FacetNodes> {
    let (scene, body, slave) = (pair.scene, &pair.placed[pair.bodies[1]], pair.facets[0]);
    let Ok(boundary) = body.facets_of(BOUNDARY) else { return Vec::new() };
    let of_body = |set: &str| {
        let named = split_set(set).filter(|(name, _)| *name == body.name);
        named.and_then(|(_, set)| body.facets_of(set).ok()).unwrap_or_default()
    };
    let key = |facet: &FacetNodes| facet.iter().copied().collect::<BTreeSet<u32>>();
    let others = scene.contacts.iter().filter(|other| !std::ptr::eq(*other, pair.item));
    let others = others
        .flat_map(|other| other.surfaces())
        .chain(scene.ties.iter().flat_map(|tie| [&tie.slave[..], &tie.master[..]]));
    let others: BTreeSet<BTreeSet<u32>> = others.flat_map(|set| of_body(set)).map(|facet| key(&facet)).collect();
    let slave_nodes: BTreeSet<u32> =
        slave.iter().flatten().chain(pair.line.iter().map(|(node, _)| node)).copied().collect();
    let support = pair.first_support(model);
    let inclined: Vec<([f64; 3], BTreeSet<u32>)> = scene
        .prescriptions
        .iter()
        .filter_map(|item| {
            let (_, set) = split_set(item.set.as_deref()?).filter(|(name, _)| *name == body.name)?;
            Some((item.normal?, body.nodes_of(set).ok()?.into_iter().collect()))
        })
        .collect();
    let is_held = |facet: &FacetNodes, normal: &[f64; 3]| {
        let of = |node: u32| support.prescribed(node);
        let across = |node: u32| (0..3).all(|c| of(node)[c] || normal[c].abs() < HELD);
        let is_along = |direction: &[f64; 3]| {
            let [dot, length] =
                [[direction, normal], [direction, direction]].map(|[a, b]| (0..3).map(|c| a[c] * b[c]).sum::<f64>());
            dot.abs() > ALONG * length.sqrt()
        };
        let by_components = facet.iter().all(|&node| across(node)) && !facet.iter().all(|&node| of(node) == [true; 3]);
        by_components
            || inclined
                .iter()
                .any(|(direction, nodes)| is_along(direction) && facet.iter().all(|node| nodes.contains(node)))
    };
    let longest =
        slave.iter().flat_map(|facet| (0..facet.len()).map(move |k| [facet[k], facet[(k + 1) % facet.len()]]));
    let x = |node: u32| -> [f64; 3] { std::array::from_fn(|i| model.reference[3 * node as usize + i]) };
    let longest = longest.map(|[a, b]| x(a).iter().zip(x(b)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt());
    let reach = longest.chain(pair.line.iter().map(|(_, length)| *length)).fold(0.0, f64::max);
    stoss_contact::beside_rims(pair.facets[1], &boundary, &model.reference, reach, |facet, normal| {
        !facet.iter().any(|node| slave_nodes.contains(node)) && !others.contains(&key(facet)) && !is_held(facet, normal)
    })
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

fn augmentation(item: &crate::scene::Contact) -> stoss_contact_nts::AugmentedOptions {
    use stoss_contact_nts::Reduction;
    let reduction = match item.reduction {
        Some(crate::scene::Reduction::None) => Reduction::None,
        Some(crate::scene::Reduction::First) => Reduction::First,
        Some(crate::scene::Reduction::Second) | None => Reduction::Second,
    };
    stoss_contact_nts::AugmentedOptions {
        reduction,
        drop_gap_term: item.drop_gap_term,
        drop_gap_slope: item.drop_gap_slope,
    }
}
