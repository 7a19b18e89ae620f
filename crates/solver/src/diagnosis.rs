//! Says in words of the model what the linear algebra knows by the number of an equation.

use crate::assembly::{Iterate, System};
use crate::{Model, StepError, Unknown};
use stoss_linalg::LinalgError;

/// A node in words: its number in its body, and where it is.
pub(crate) fn node_name(model: &Model, node: u32, q: &[f64]) -> String {
    let at = 3 * node as usize;
    let place = q.get(at..at + 3).map_or(String::new(), |x| format!(" at ({:.4}, {:.4}, {:.4})", x[0], x[1], x[2]));
    match model.bodies.iter().find(|body| body.nodes.contains(&node)) {
        Some(body) => format!("node {} of body {}{place}", node - body.nodes.start, body.solid.name()),
        None => format!("node {node}{place}"),
    }
}

/// The error of the linear solver, with the unknown named if the matrix is singular.
pub(crate) fn linear_error(
    model: &Model,
    system: &System,
    iterate: &Iterate,
    dynamic: bool,
    e: LinalgError,
) -> StepError {
    let LinalgError::Singular { row } = e else { return StepError::Linear(e) };
    let component = row.and_then(|row| system.numbering.free.get(row));
    if let Some(&component) = component {
        let node = component / 3;
        return StepError::Singular {
            unknown: Unknown::Position { component: (component % 3) as u8, node: node_name(model, node, &iterate.q) },
            hint: position_hint(model, &iterate.active, dynamic, node),
        };
    }
    let slot = row.and_then(|row| {
        system.slot_equation.iter().enumerate().find_map(|(pair, equations)| {
            equations.iter().position(|&equation| equation as usize == row).map(|slot| (pair, slot))
        })
    });
    let Some((pair, slot)) = slot else {
        return StepError::Singular {
            unknown: Unknown::Unnamed,
            hint: "are there enough supports, and no constraint twice?".into(),
        };
    };
    StepError::Singular {
        unknown: Unknown::Pressure {
            pair: model.contacts[pair].name.clone(),
            node: slot_name(model, pair, slot, &iterate.q),
        },
        hint: "its constraint follows from others: is the same contact given twice, or is the motion of all nodes \
               there prescribed?"
            .into(),
    }
}

/// The slave node of a slot.
pub(crate) fn slot_name(model: &Model, pair: usize, slot: usize, q: &[f64]) -> String {
    let reports = model.contacts[pair].method.report(q).unwrap_or_default();
    reports.get(slot).map_or_else(|| format!("slot {slot}"), |report| node_name(model, report.node, q))
}

fn position_hint(model: &Model, active: &[Vec<bool>], dynamic: bool, node: u32) -> String {
    let Some(body) = model.bodies.iter().find(|body| body.nodes.contains(&node)) else {
        return "are there enough supports?".into();
    };
    let name = body.solid.name();
    if dynamic {
        return format!("body {name} is unstable at this load and step size: try smaller steps");
    }
    let held = model.prescriptions.iter().flat_map(|p| &p.nodes).any(|node| body.nodes.contains(node));
    let mut touches = false;
    for (pair, active) in model.contacts.iter().zip(active) {
        pair.method.stencils(active, &mut |nodes, _| touches |= nodes.iter().any(|node| body.nodes.contains(node)));
    }
    let contact = if model.contacts.is_empty() || touches {
        ""
    } else {
        "; contact can hold it only if it touches from the start (gap below 1/1000 of an edge)"
    };
    let reason = match (held, touches) {
        (false, false) => format!("nothing holds body {name}: prescribe displacements that exclude a rigid motion"),
        (false, true) => {
            format!("body {name} is held by contact alone, which leaves a rigid motion: prescribe some displacements")
        }
        _ => format!(
            "body {name} has too few supports (a rigid motion is left), or it buckles at this load: prescribe more \
             displacements, or try smaller steps"
        ),
    };
    reason + contact
}
