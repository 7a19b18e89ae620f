//! Names in messages for the unknowns that the linear algebra knows by the number of an equation.

use crate::assembly::System;
use crate::iterate::Iterate;
use crate::words::short;
use crate::{Model, Place, StepError, Unknown};
use stoss_linalg::{LinalgError, NONE};
use stoss_term::SurfaceNode;

/// Constraints violated by more than this part of the largest violation are named too.
const PART: f64 = 0.1;

/// Strain energy of a body without stress, in parts of that of a strain of one.
const UNSTRESSED: f64 = 1.0e-20;

/// Name of a node in messages: its number in its body, and its position.
pub(crate) fn node_name(model: &Model, node: u32, q: &[f64]) -> String {
    let at = 3 * node as usize;
    let place = q.get(at..at + 3).map_or(String::new(), |x| {
        let size = x.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        format!(" at ({}, {}, {})", short(x[0], size), short(x[1], size), short(x[2], size))
    });
    match model.bodies.iter().find(|body| body.nodes.contains(&node)) {
        Some(body) => format!("node {} of body {}{place}", node - body.nodes.start, body.solid.name()),
        None => match model.parts.iter().find(|part| part.own_vectors().contains(&node)) {
            Some(part) if part.is_direction(node) => format!("the rotation of {}", part.name()),
            Some(part) => format!("{}{place}", part.name()),
            None => match owner(model, node) {
                Some(name) => format!("node {node} of {name}{place}"),
                None => format!("node {node}{place}"),
            },
        },
    }
}

/// The body or part that a node belongs to, embedded ones included.
fn owner(model: &Model, node: u32) -> Option<&str> {
    if let Some(body) = model.bodies.iter().find(|body| body.nodes.contains(&node)) {
        return Some(body.solid.name());
    }
    let own = model.embedding.carriers(node).and_then(|carriers| carriers.first()).map_or(node, |carrier| carrier.0);
    model.parts.iter().find(|part| part.own_vectors().contains(&own)).map(|part| part.name())
}

/// Where surfaces that must stay apart are nearest to each other, as the middle of a sentence, and what helps if prescribed motion takes them there.
pub(crate) fn blocked(model: &Model, q: &[f64], is_prescribed: &dyn Fn(u32) -> bool) -> (String, Place, &'static str) {
    const CAN_DEFORM: &str = "smaller steps help where the bodies can deform";
    let nodes = model.contacts.iter().filter(|pair| pair.keeps_apart());
    let nodes: Vec<_> = nodes.filter_map(|pair| Some(pair.potential()?.surface_nodes(q))).flatten().collect();
    let nearest = |list: &mut dyn Iterator<Item = &SurfaceNode>| {
        list.filter(|node| node.distance.is_finite()).min_by(|a, b| a.distance.total_cmp(&b.distance)).copied()
    };
    let Some(first) = nearest(&mut nodes.iter()) else { return (String::new(), Place::default(), CAN_DEFORM) };
    let own = owner(model, first.node);
    let others = nodes.iter().filter(|node| owner(model, node.node) != own);
    // What it is near to: the nodes of others that are not much farther away, the one next to it.
    let far =
        |node: u32| (0..3).map(|i| (q[3 * node as usize + i] - q[3 * first.node as usize + i]).powi(2)).sum::<f64>();
    let second = others.min_by(|a, b| far(a.node).total_cmp(&far(b.node)));
    let mut place = format!(", nearest at {}", node_name(model, first.node, q));
    if let Some(second) = second {
        place += &format!(" and {}", node_name(model, second.node, q));
    }
    let all = is_prescribed(first.node) && second.is_some_and(|second| is_prescribed(second.node));
    let remedy = match all {
        true => {
            "the motion of all surfaces there is prescribed, so that no body can deform: change the prescribed motion, or leave a larger gap"
        }
        false => CAN_DEFORM,
    };
    (place, Place::of_node(first.node), remedy)
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
    let component = row.and_then(|row| system.matrix.numbering.free.get(row));
    if let Some(&component) = component {
        let node = component / 3;
        return StepError::Singular {
            unknown: Unknown::Position { component: (component % 3) as u8, node: node_name(model, node, &iterate.q) },
            at: Box::new(Place { component: Some((component % 3) as u8), ..Place::of_node(node) }),
            hint: position_hint(model, system, iterate, dynamic, node),
        };
    }
    let slot = row.and_then(|row| {
        system.matrix.slots.equation.iter().enumerate().find_map(|(pair, equations)| {
            equations.iter().position(|&equation| equation as usize == row).map(|slot| (pair, slot))
        })
    });
    let bilateral = slot.filter(|&(pair, _)| model.contacts[pair].always_holds());
    if let Some((pair, slot)) = bilateral {
        return StepError::Singular {
            unknown: Unknown::Multiplier { constraint: model.contacts[pair].name.clone(), equation: slot + 1 },
            at: Box::new(slot_place(model, pair, slot, &iterate.q)),
            hint: multiplier_hint(model, pair, slot, &iterate.active).into(),
        };
    }
    let Some((pair, slot)) = slot else {
        return StepError::Singular {
            unknown: Unknown::Unnamed,
            at: Box::default(),
            hint: "check that there are enough supports and that no constraint is given twice".into(),
        };
    };
    StepError::Singular {
        unknown: Unknown::Pressure {
            pair: model.contacts[pair].name.clone(),
            node: slot_name(model, pair, slot, &iterate.q),
        },
        at: Box::new(slot_place(model, pair, slot, &iterate.q)),
        hint: pressure_hint(model, system, iterate, pair, slot).into(),
    }
}

/// Why a multiplier of a constraint that always holds is not determined.
fn multiplier_hint(model: &Model, pair: usize, slot: usize, active: &[Vec<bool>]) -> &'static str {
    let Some(held) = model.contacts[pair].supported_node(slot, 0.0) else {
        return "it is redundant at this moment: a mechanism is in a singular position, a joint, tie or support is given twice, or a part is fixed at both ends";
    };
    let mut touches = false;
    for (pair, active) in model.contacts.iter().zip(active).filter(|(pair, _)| pair.unilateral().is_some()) {
        pair.term.stencils(active, &mut |nodes, _| touches |= nodes.contains(&held.node));
    }
    if touches {
        "a support along a normal and a contact hold the same node: leave the nodes that touch out of the support, or those that are held out of the contact"
    } else {
        "the support is redundant at this node: prescribe its motion only once along each direction"
    }
}

/// Why the pressure of a contact is not determined.
fn pressure_hint(model: &Model, system: &System, iterate: &Iterate, pair: usize, slot: usize) -> &'static str {
    let node = slot_place(model, pair, slot, &iterate.q).node;
    if node.is_some_and(|node| model.follows_its_face(node)) {
        return "it is in the middle of a face with 8 nodes and moves with it, so that its constraint is redundant: use `method = \"mortar\"`, or a penalty, or exchange slave and master";
    }
    // Of pressures that depend on each other the factorisation may meet any one last.
    let reports = model.contacts[pair].term.report(&iterate.q).unwrap_or_default();
    let mut closed = reports.iter().zip(&iterate.active[pair]).filter(|(_, active)| **active);
    let follow = closed.any(|(report, _)| model.follows_its_face(report.node));
    let is_guided = |node: u32| {
        let mut slots = model
            .contacts
            .iter()
            .flat_map(|pair| (0..pair.term.slot_count()).map_while(|slot| pair.supported_node(slot, 0.0)));
        slots.any(|held| held.node == node)
    };
    let own = |node: u32| model.embedding.carriers(node).is_none();
    let is_prescribed = |node: u32| {
        own(node) && (0..3).any(|i| system.matrix.numbering.equation.get(3 * node as usize + i) == Some(&NONE))
    };
    if node.is_some_and(|node| is_guided(node) || is_prescribed(node)) {
        "prescribed motion, or a support along a normal, holds its node as well: leave the nodes that touch out of the support, or those that are held out of the contact"
    } else if follow {
        "it is redundant, because the middle of a face with 8 nodes moves with the face: use `method = \"mortar\"`, or a penalty, or exchange slave and master"
    } else {
        "its constraint is redundant: is the same contact given twice, or is the motion of all nodes there prescribed?"
    }
}

/// A slot, and the node that it belongs to.
pub(crate) fn slot_place(model: &Model, pair: usize, slot: usize, q: &[f64]) -> Place {
    let reports = model.contacts[pair].term.report(q).unwrap_or_default();
    Place { node: reports.get(slot).map(|report| report.node), slot: Some((pair, slot)), ..Place::default() }
}

/// The slave node of a slot.
pub(crate) fn slot_name(model: &Model, pair: usize, slot: usize, q: &[f64]) -> String {
    let reports = model.contacts[pair].term.report(q).unwrap_or_default();
    reports.get(slot).map_or_else(|| format!("slot {slot}"), |report| node_name(model, report.node, q))
}

/// Where the residual that was assembled last is largest, and what may be the reason. `of_constraints`: the largest violation of a constraint is
/// what counts.
pub(crate) fn largest_residual(
    model: &Model,
    system: &System,
    iterate: &Iterate,
    of_constraints: bool,
) -> (String, Place) {
    let size =
        |equation: usize| system.rhs.get(equation).map_or(0.0, |r| if r.is_nan() { f64::INFINITY } else { r.abs() });
    if of_constraints {
        let slots = system.matrix.slots.equation.iter().enumerate().flat_map(|(pair, equations)| {
            let method = &model.contacts[pair].term;
            let closed = equations.iter().enumerate().filter(|(_, equation)| **equation != NONE);
            closed.map(move |(slot, &equation)| (size(equation as usize) / method.slot_weight(slot), pair, slot))
        });
        let all: Vec<_> = slots.collect();
        if let Some(&(largest, pair, slot)) = all.iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
            let name = &model.contacts[pair].name;
            let at = slot_place(model, pair, slot, &iterate.q);
            if model.contacts[pair].always_holds() {
                let mut others: Vec<&str> = Vec::new();
                for &(size, other, _) in &all {
                    let name = model.contacts[other].name.as_str();
                    if other != pair && size > PART * largest && !others.contains(&name) {
                        others.push(name);
                    }
                }
                let others = if others.is_empty() { String::new() } else { format!(" (and in {})", others.join(", ")) };
                let text = format!(
                    "largest in equation {} of {name}{others}: it may be in a singular position (a mechanism in line), or contradict another joint, motor or support",
                    slot + 1
                );
                return (text, at);
            }
            let node = slot_name(model, pair, slot, &iterate.q);
            let text = format!(
                "largest in the constraint of {node} in contact {name}: if the master has an edge or a rim there, exchange slave and master"
            );
            return (text, at);
        }
    }
    let free = system.matrix.numbering.free.iter().enumerate();
    let Some((_, &component)) = free.max_by(|a, b| size(a.0).total_cmp(&size(b.0))) else {
        return ("there is no free unknown".into(), Place::default());
    };
    let node = component / 3;
    let place = node_name(model, node, &iterate.q);
    // What touches there says more than what holds it, and a support along a normal no more than one along an axis.
    let mut contact: Option<(&str, bool, bool)> = None;
    for (c, pair) in model.couplings() {
        let holds = pair.always_holds();
        if holds && (contact.is_some_and(|(_, bilateral, _)| !bilateral) || is_sliding_support(pair)) {
            continue;
        }
        pair.term.stencils(&iterate.active[c], &mut |nodes, _| {
            if nodes.contains(&node) {
                contact = Some((pair.name.as_str(), holds, pair.keeps_apart()));
            }
        });
    }
    let text = match contact {
        Some((name, true, _)) => format!(
            "largest at {place}, which {name} holds: it may be in a singular position (a mechanism in line), or contradict another joint, motor or support, or the load there may be too large"
        ),
        Some((name, false, true)) => format!(
            "largest at {place}, which is in contact {name}: in one step the bodies there slide, or move by much more than the thickness of the layer; a larger `thickness` may help"
        ),
        Some((name, false, false)) => {
            let with_friction = model.contacts.iter().any(|pair| pair.name == name && pair.term.has_friction());
            let stick = if with_friction { ", or between stick and slip," } else { "" };
            format!(
                "largest at {place}, which is in contact {name}: contact points there may change facets{stick} with every iteration; exchanging slave and master may help"
            )
        }
        None => format!(
            "largest at {place}: the elements there may deform too much for one step, or the load there may be too large"
        ),
    };
    (text, Place { component: Some((component % 3) as u8), ..Place::of_node(node) })
}

/// Whether a pair is a support along a normal.
fn is_sliding_support(pair: &crate::CouplingTerm) -> bool {
    pair.supported_node(0, 0.0).is_some()
}

/// Why a vector of a part (position or director) is not determined.
fn part_hint(model: &Model, dynamic: bool, node: u32) -> String {
    let Some(part) = model.parts.iter().find(|part| part.own_vectors().contains(&node)) else {
        return "check that there are enough supports".into();
    };
    let name = part.name();
    if dynamic {
        return format!("{name} has neither mass nor stiffness along it, or is unstable at this step size");
    }
    let mut elastic = Vec::new();
    for other in &model.parts {
        let mut acts = false;
        other.stencils(&[], &mut |vectors, _| acts |= vectors.iter().any(|vector| part.own_vectors().contains(vector)));
        if acts {
            elastic.push(other.name());
        }
    }
    let reason = if elastic.is_empty() {
        format!("no elastic part supports {name}, and its weight gives no stiffness before its joints transmit forces")
    } else {
        format!(
            "{} (strings, springs and beams that hold it) have no stiffness in this direction: strings and springs without tension have no lateral stiffness",
            elastic.join(", ")
        )
    };
    format!(
        "{reason}. Let a first stage with `backward-euler` find the equilibrium, give strings and springs tension (`natural_length`, `rest_length`), or add supports"
    )
}

fn position_hint(model: &Model, system: &System, iterate: &Iterate, dynamic: bool, node: u32) -> String {
    let Some(body) = model.bodies.iter().find(|body| body.nodes.contains(&node)) else {
        return part_hint(model, dynamic, node);
    };
    let name = body.solid.name();
    if dynamic {
        return format!("body {name} is unstable at this load and step size");
    }
    let supports = model.prescriptions.iter().zip(&system.present.acting.prescriptions).filter(|(_, acts)| **acts);
    let mut held = supports.flat_map(|(p, _)| &p.nodes).any(|node| body.nodes.contains(node));
    let mut touches = false;
    for (c, pair) in model.couplings() {
        let is_support = pair.supported_node(0, 0.0).is_some();
        let reached = if is_support { &mut held } else { &mut touches };
        pair.term.stencils(&iterate.active[c], &mut |nodes, _| {
            *reached |= nodes.iter().any(|node| body.nodes.contains(node))
        });
    }
    let is_stabilised = system.present.stabilisation.is_some();
    let contact = if is_stabilised {
        ""
    } else if model.keeps_apart() {
        "; general contact has no stiffness before surfaces are pressed together: where it has to support the body, set `stabilise`"
    } else if model.contacts.is_empty() || touches {
        ""
    } else {
        "; contact can support it only if it is closed from the start (gap below 1/1000 of an edge length)"
    };
    let reason = match (held, touches) {
        (false, false) => format!("body {name} has no supports: prescribe displacements that exclude a rigid motion"),
        (false, true) => {
            let or = if is_stabilised { "" } else { ", or stabilise the run" };
            format!(
                "body {name} is supported by contact alone, which leaves a rigid motion free: prescribe some displacements{or}"
            )
        }
        // Without stress nothing buckles.
        _ if system.shares.sum(body.solid.strain_energy(&iterate.q).unwrap_or(f64::INFINITY))
            <= UNSTRESSED * system.scales.energy =>
        {
            format!("body {name} has too few supports, a rigid motion is free: prescribe more displacements")
        }
        _ => format!(
            "body {name} has too few supports (a rigid motion is free), or it buckles at this load: prescribe more displacements"
        ),
    };
    reason + contact + single_rows(body)
}

/// Hint about zero-energy modes of reduced integration.
fn single_rows(body: &crate::Body) -> &'static str {
    if body.solid.has_own_modes() {
        "; hex20 with reduced integration has zero-energy modes unless neighbouring elements prevent them, as in a single row of elements: use two elements through the thickness, or \
         `integration = \"full\"`"
    } else {
        ""
    }
}
