//! Bodies that overlap at the start: how deep, and `initial = "separate"`, which moves them apart.

use super::interacting::{self, Classes};
use super::phase::Phase;
use super::tie::Ties;
use super::{Placed, Problems};
use crate::scene::{Initial, Scene, split_set};
use crate::solver::Model;
use stoss_contact_barrier::{Facing, Interaction, Interactions, Overlaps, Relation, Separation, Skin, SkinFacet};
use stoss_mesh::BOUNDARY;
use stoss_tensor::Vector3;

/// A body is moved by no more than this part of the smallest extent of the box around it.
const FARTHEST: f64 = 0.25;

/// The gap that is left, in thicknesses of the layer: no force and no inset surfaces.
const GAP: f64 = 1.01;

/// Rounds of finding who lies in whom.
const ROUNDS: usize = 50;

/// Sweeps over the conditions of a round.
const SWEEPS: usize = 10_000;

/// Gaps are kept up to this part.
const TOLERANCE: f64 = 1e-9;

/// In words, how deep two bodies overlap.
pub(super) fn depth(
    skin: &Skin,
    rules: &Interactions,
    model: &Model,
    placed: &[Placed],
    [a, b]: [u32; 2],
) -> Option<String> {
    let overlaps = Overlaps::new(skin, rules, &model.reference);
    let limit = overlaps.extents(a)[0].min(overlaps.extents(b)[0]);
    let Separation { direction, length } = overlaps.separation([a, b], &Vector3::zeros(), 0.0, limit)?;
    let by = interacting::point(direction.into(), 1.0);
    let name = &placed[a as usize].name;
    Some(format!("{} deep (the way out of `{name}` is along {by})", format_length(length)))
}

/// Whether two bodies are free of each other after a motion by no more than `limit`.
pub(super) fn slight<'a>(
    skin: &Skin,
    rules: &Interactions,
    model: &'a Model,
    limit: f64,
) -> impl Fn([u32; 2]) -> bool + use<'a> {
    let overlaps = Overlaps::new(skin, rules, &model.reference);
    move |[a, b]| a != b && overlaps.separation([a, b], &Vector3::zeros(), 0.0, limit).is_some()
}

/// Two bodies of which one lies in the other although no edge goes through a facet: wholly, or with common planes. Those for which `is_slight` holds are left out.
pub(super) fn inside(
    skin: &Skin,
    rules: &Interactions,
    model: &Model,
    is_slight: &impl Fn([u32; 2]) -> bool,
) -> Option<([u32; 2], Relation)> {
    let overlaps = Overlaps::new(skin, rules, &model.reference);
    let relation = |pair| (pair, overlaps.relation(pair, &Vector3::zeros(), 0.0));
    let mut relations = rules.body_pairs().into_iter().map(relation);
    relations.find(|(pair, relation)| !matches!(relation, Relation::Apart(_)) && !is_slight(*pair))
}

/// Two bodies of which one is wholly inside the other: of whole bodies, also where some of their surfaces are left out. [`inside`] knows only what acts.
pub(super) fn enclosed(placed: &[Placed], rules: &Interactions, model: &Model) -> Option<[u32; 2]> {
    let count = placed.len() as u32;
    let facets_of = |part: u32| placed[part as usize].facets_of(BOUNDARY).unwrap_or_default();
    let bounds = |part: u32| {
        let x = |node: u32| Vector3::from_column_slice(&model.reference[3 * node as usize..3 * node as usize + 3]);
        let none = [Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)];
        facets_of(part).iter().flatten().fold(none, |[low, high], &node| [low.inf(&x(node)), high.sup(&x(node))])
    };
    let boxes: Vec<[Vector3; 2]> = (0..count).map(bounds).collect();
    let holds = |outer: u32, inner: u32| {
        let ([low, high], [first, last]) = (boxes[outer as usize], boxes[inner as usize]);
        (0..3).all(|i| first[i] >= low[i] && last[i] <= high[i] && first[i] <= last[i])
    };
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    let is_near = |[a, b]: &[u32; 2]| (holds(*a, *b) || holds(*b, *a)) && rules.acts_between([*a, *b]);
    let pairs: Vec<[u32; 2]> = pairs.filter(is_near).collect();
    if pairs.is_empty() {
        return None;
    }
    let mut all = Interactions::none(&(0..count).map(|part| (part, 1.0)).collect::<Vec<_>>());
    pairs.iter().for_each(|&[a, b]| all.set(a, b, Some(Interaction { modulus: 1.0, friction: 0.0 })));
    let facets = (0..count)
        .filter(|part| pairs.iter().any(|pair| pair.contains(part)))
        .flat_map(|class| facets_of(class).into_iter().map(move |nodes| SkinFacet { nodes, class }));
    let skin = Skin::new(facets.collect(), &model.reference, &|_| None);
    let overlaps = Overlaps::new(&skin, &all, &model.reference);
    pairs.into_iter().find(|pair| overlaps.is_enclosed(*pair))
}

/// A length as in other messages.
fn format_length(length: f64) -> String {
    format!("{length:.3e}")
}

/// The surfaces of two bodies, one moved against the other, have to keep a distance along a direction.
struct Condition {
    bodies: [u32; 2],
    direction: Vector3,
    least: f64,
}

/// Moves bodies that overlap apart, if the scene asks for it: meshes and reference positions, so no stress arises. `lines` get what was done. False if that failed,
/// with a problem: bodies that may not be moved, or not so far.
pub(super) fn separate(
    scene: &Scene,
    placed: &mut [Placed],
    ties: &Ties,
    first: &Phase,
    model: &mut Model,
    problems: &mut Problems<'_>,
    lines: &mut Vec<String>,
) -> bool {
    let wanted = scene.general_contact.as_ref().filter(|table| table.enabled && table.initial == Initial::Separate);
    let Some(table) = wanted else { return true };
    // What is wrong with the table is reported where the contact is made.
    let mut ignored = Problems { scene, list: Vec::new() };
    let Classes { facets, classes, apart } = interacting::facets(scene, placed, table, ties, &mut ignored);
    let mut rules = interacting::interactions(scene, placed, table, model, &classes, &apart, &mut Vec::new());
    interacting::without_joined_overlaps(scene, placed, table, &facets, &model.reference, &mut rules);
    if facets.is_empty() || !ignored.list.is_empty() {
        return true;
    }
    let skin = Skin::new(facets, &model.reference, &|_| None);
    let facing = Facing::new(&skin, &rules, &model.reference);
    let edge = interacting::layer_edge(&skin, &facing, &rules, placed, &model.reference);
    let gap = GAP * table.thickness.unwrap_or(interacting::THICKNESS * edge);
    let moves = match motions(scene, placed, first, model, &skin, &rules, gap) {
        Ok(moves) => moves,
        Err((message, remedy)) => {
            problems.add("general_contact.initial".into(), table.initial, message, remedy);
            return false;
        }
    };
    for (p, by) in moves.iter().enumerate().filter(|(_, by)| **by != Vector3::zeros()) {
        let part = &mut placed[p];
        let super::placed::Shape::Solid { mesh, .. } = &mut part.shape else { continue };
        if let Err(error) = mesh.transform(None, (*by).into()) {
            problems.add("general_contact.initial".into(), table.initial, error.to_string(), "correct the mesh");
            return false;
        }
        let (first, count) = (part.first_node as usize, mesh.nodes.len());
        model.reference[3 * first..3 * (first + count)].copy_from_slice(mesh.nodes.as_flattened());
        model.embedding.follow(&mut model.reference);
        let message = "so that it no longer overlaps";
        let size = format_length(by.norm());
        lines.push(format!("{}: moved by {size}, {}, {message}", part.name, interacting::point((*by).into(), edge)));
    }
    true
}

/// Motions of all parts, the least ones in the sense of mass times squared motion, volumes in place of masses.
fn motions(
    scene: &Scene,
    placed: &[Placed],
    first: &Phase,
    model: &Model,
    skin: &Skin,
    rules: &Interactions,
    gap: f64,
) -> Result<Vec<Vector3>, (String, String)> {
    let overlaps = Overlaps::new(skin, rules, &model.reference);
    let name = |body: u32| &placed[body as usize].name;
    let holds: Vec<Option<&str>> = (0..placed.len()).map(|p| hold(scene, placed, first, model, p)).collect();
    // How easily a body moves: one over its volume.
    let volume = |p: usize| {
        model.bodies.iter().find(|body| body.nodes.start == placed[p].first_node).map(|body| body.solid.volume())
    };
    let ease: Vec<f64> = (0..placed.len())
        .map(|p| volume(p).filter(|_| holds[p].is_none()).map_or(0.0, |volume| 1.0 / volume))
        .collect();
    let farthest = |body: u32| match ease[body as usize] > 0.0 {
        true => FARTHEST * overlaps.extents(body)[1],
        false => 0.0,
    };
    let mut moves = vec![Vector3::zeros(); placed.len()];
    let mut conditions: Vec<Condition> = Vec::new();
    for _ in 0..ROUNDS {
        let known = conditions.len();
        for bodies in rules.body_pairs() {
            let [a, b] = bodies;
            let shift: Vector3 = moves[a as usize] - moves[b as usize];
            match overlaps.relation(bodies, &shift, gap / GAP) {
                Relation::Cross => {}
                // What was near each other and was not moved stays so.
                Relation::Apart(Some(_)) if shift != Vector3::zeros() => {}
                Relation::Apart(_) => continue,
                Relation::Inside => {
                    let message = format!("`{}` and `{}`: one is wholly inside the other", name(a), name(b));
                    return Err((message, "move one of them".into()));
                }
            }
            if let [Some(first), Some(second)] = [holds[a as usize], holds[b as usize]] {
                let message = format!(
                    "`{}` and `{}` overlap, and neither may be moved: the first {first}, the second {second}",
                    name(a),
                    name(b)
                );
                return Err((message, "correct the scene there".into()));
            }
            let most = [a, b].map(farthest);
            let limit = most[0] + most[1];
            let found = overlaps.separation(bodies, &shift, gap, limit).ok_or_else(|| {
                let may = [a, b].into_iter().zip(most).filter(|(_, most)| *most > 0.0);
                let may = may.map(|(body, most)| format!("of `{}` by {}", name(body), format_length(most)));
                let message = format!(
                    "`{}` and `{}` overlap too deeply: no motion {}, a quarter of the smallest extent, separates them",
                    name(a),
                    name(b),
                    may.collect::<Vec<_>>().join(" and ")
                );
                (message, "move one of them".to_owned())
            })?;
            let Separation { direction, length } = found;
            conditions.push(Condition { bodies, direction, least: direction.dot(&shift) + length });
        }
        if conditions.len() == known {
            return Ok(moves);
        }
        if let Some([a, b]) = least_motions(&conditions, &ease, gap, &mut moves) {
            let message =
                format!("there is no room for `{}` and `{}` between bodies that may not be moved", name(a), name(b));
            return Err((message, "move bodies apart in the scene".into()));
        }
        for (p, by) in moves.iter().enumerate() {
            let most = farthest(p as u32);
            if by.norm() > most * (1.0 + TOLERANCE) {
                let message = format!(
                    "`{}` would have to be moved by {}, more than {}, a quarter of its smallest extent",
                    placed[p].name,
                    format_length(by.norm()),
                    format_length(most)
                );
                return Err((message, "move it, or the body that it overlaps".into()));
            }
        }
    }
    let message = format!("after {ROUNDS} rounds some bodies still overlap");
    Err((message, "move bodies apart in the scene".into()))
}

/// The least motions that fulfil all conditions, by coordinate ascent in their multipliers (Hildreth); two bodies whose condition is not fulfilled, if they contradict each other.
fn least_motions(conditions: &[Condition], ease: &[f64], gap: f64, moves: &mut [Vector3]) -> Option<[u32; 2]> {
    moves.iter_mut().for_each(|by| *by = Vector3::zeros());
    let mut multipliers = vec![0.0_f64; conditions.len()];
    let mut worst = (0.0, None);
    for _ in 0..SWEEPS {
        worst = (0.0, None);
        for (condition, multiplier) in conditions.iter().zip(&mut multipliers) {
            let [a, b] = condition.bodies.map(|body| body as usize);
            let ease = [ease[a], ease[b]];
            let lack = condition.least - condition.direction.dot(&(moves[a] - moves[b]));
            let change = (lack / (ease[0] + ease[1])).max(-*multiplier);
            *multiplier += change;
            moves[a] += condition.direction * (change * ease[0]);
            moves[b] -= condition.direction * (change * ease[1]);
            let moved = (change * (ease[0] + ease[1])).abs();
            if moved > worst.0 {
                worst = (moved, Some(condition.bodies));
            }
        }
        if worst.0 <= TOLERANCE * gap {
            return None;
        }
    }
    worst.1
}

/// Why a part may not be moved, by what acts in the first stage, as the end of a sentence; nothing if it may.
fn hold(scene: &Scene, placed: &[Placed], first: &Phase, model: &Model, p: usize) -> Option<&'static str> {
    let Some(mesh) = placed[p].mesh() else { return Some("is rigid") };
    let nodes = placed[p].first_node..placed[p].first_node + mesh.nodes.len() as u32;
    let is_own = |set: &str| split_set(set).is_some_and(|(part, _)| part == placed[p].name);
    let joints = scene.joints.iter().map(|joint| (&joint.name, &joint.between));
    let joined = joints.chain(scene.springs.iter().map(|spring| (&spring.name, &spring.between)));
    let joined = joined.filter(|(name, _)| first.acts(Some(name))).map(|(_, between)| between);
    let inclined = scene.prescriptions.iter().filter(|item| item.is_inclined() && first.acts(item.name.as_deref()));
    let prescribed = first.support(model);
    if nodes.into_iter().any(|node| prescribed.prescribed(node).contains(&true))
        || inclined.filter_map(|item| item.set.as_deref()).any(is_own)
    {
        Some("has prescribed motion")
    } else if scene.supports.iter().any(|support| is_own(&support.set)) {
        Some("has a support")
    } else if scene.ties.iter().any(|tie| is_own(&tie.slave) || is_own(&tie.master)) {
        Some("is tied")
    } else if joined.flatten().any(|side| is_own(side)) {
        Some("has a joint or a spring")
    } else if scene
        .contacts
        .iter()
        .any(|contact| first.acts(Some(&contact.label())) && contact.surfaces().iter().any(|set| is_own(set)))
    {
        Some("has a named contact")
    } else {
        None
    }
}
