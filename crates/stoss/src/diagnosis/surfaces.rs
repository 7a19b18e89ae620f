//! Bodies inside each other: from the start, through surfaces that face away, without a contact.

use super::case::DiagnosedRun;
use super::{Cause, Change, Confidence, LikelyCause, Remedy, Where, toml};
use crate::build::general_schemes::keeps_apart;
use crate::scene::split_set;
use stoss_reference_element::FacetNodes;
use stoss_watch::{Finding as Seen, FindingKind, Severity};

/// Part of the way out of each other by which a body is moved farther than that.
const CLEARANCE: f64 = 0.01;

/// Cosine beyond a right angle from which on two facets see each other better than edge-on: 15 degrees.
const EDGE_ON: f64 = 0.25;

/// Most facets of a surface that are checked.
const MOST_FACETS: usize = 400;

/// What the watch saw of one body in another.
fn inside<'a>(case: &'a DiagnosedRun<'_>) -> impl Iterator<Item = (&'a Seen, [String; 2])> {
    case.verdict.reasons.iter().filter_map(|seen| {
        let is_inside = matches!(seen.kind, FindingKind::Penetration | FindingKind::Tunnelling);
        let [a, b] = seen.bodies.filter(|[a, b]| is_inside && a != b)?;
        Some((seen, [case.watched_name(a), case.watched_name(b)]))
    })
}

/// The contact that is named between two bodies.
fn contact_between<'a>(case: &'a DiagnosedRun<'_>, names: &[String; 2]) -> Option<(usize, &'a crate::scene::Contact)> {
    case.contacts().find(|(_, item)| {
        let of = item.surfaces().map(|set| split_set(set).map_or(set, |(body, _)| body));
        of.contains(&names[0].as_str()) && of.contains(&names[1].as_str())
    })
}

fn between(case: &DiagnosedRun<'_>, seen: &Seen, names: &[String; 2], pair: Option<String>) -> Where {
    let text = match &pair {
        Some(pair) => format!("between `{}` and `{}`, contact `{pair}`", names[0], names[1]),
        None => format!("between `{}` and `{}`", names[0], names[1]),
    };
    let nearest = case.part(&names[0]).zip(seen.position).map(|(part, x)| part.nearest(x).0);
    let node = nearest.and_then(|node| case.node(node).node);
    Where { text, body: Some(names[0].clone()), node, pair, position: seen.position, ..Where::default() }
}

fn confidence(seen: &Seen) -> Confidence {
    if seen.level == Severity::Wrong { Confidence::High } else { Confidence::Medium }
}

/// Bodies that overlap before the first step.
pub(super) fn overlap(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    let mut seen_of: Vec<[String; 2]> = Vec::new();
    let mut list = Vec::new();
    for (seen, names) in inside(case).filter(|(seen, _)| seen.step == 0) {
        if seen_of.iter().any(|other| other.contains(&names[0]) && other.contains(&names[1])) {
            continue;
        }
        if names.iter().all(|name| is_fixed(case, name)) {
            // They stay where they are, and nothing acts between them.
            continue;
        }
        let contact = contact_between(case, &names);
        let pair = contact.map(|(_, item)| item.label());
        let mut evidence = vec![seen.sentence.clone()];
        if contact.is_some() && case.failure().is_some() {
            evidence.push("contact cannot push them apart in one step".to_owned());
        }
        list.push(LikelyCause {
            cause: Cause::OverlapAtStart,
            confidence: of_overlap(case, seen, &names, pair.as_deref()),
            place: between(case, seen, &names, pair),
            sentence: format!("`{}` and `{}` overlap before the first step", names[0], names[1]),
            evidence,
            remedies: apart(case, &names),
        });
        seen_of.push(names);
    }
    list
}

/// Whether a rigid body does not move in the whole run.
fn is_fixed(case: &DiagnosedRun<'_>, name: &str) -> bool {
    case.scene.rigids.iter().any(|rigid| rigid.name == name && rigid.fixed)
}

/// An overlap at the start stops the first step, at one of the two bodies; what stops elsewhere or later has passed it.
fn of_overlap(case: &DiagnosedRun<'_>, seen: &Seen, names: &[String; 2], pair: Option<&str>) -> Confidence {
    let Some(failure) = case.failure() else { return confidence(seen) };
    let place = case.place_of(&failure.place);
    let is_here = place.body.as_ref().is_some_and(|body| names.contains(body))
        || place.pair.is_some() && place.pair.as_deref() == pair;
    match (is_here, case.simulation.step() == 0) {
        (true, true) => Confidence::High,
        (true, false) | (false, true) => Confidence::Medium,
        (false, false) => Confidence::Low,
    }
}

/// Moving one of two bodies out of the other, by their bounding boxes along the axis where that is shortest.
fn apart(case: &DiagnosedRun<'_>, names: &[String; 2]) -> Vec<Remedy> {
    let last = Remedy::words("move or shrink one of the bodies so that they do not overlap");
    let bodies = names.each_ref().map(|name| case.scene.body_index(name));
    let [Some(mesh_a), Some(mesh_b)] = names.each_ref().map(|name| case.mesh(name)) else { return vec![last] };
    let ((low_a, high_a), (low_b, high_b)) = (mesh_a.bounding_box(), mesh_b.bounding_box());
    let is_held = |name: &String| {
        let sets = case.scene.prescriptions.iter().filter_map(|item| item.set.as_deref());
        sets.filter_map(split_set).any(|(body, _)| body == name)
    };
    // The one that nothing holds, else the second.
    let moved = if is_held(&names[1]) && !is_held(&names[0]) { 0 } else { 1 };
    let moves = (0..3).flat_map(|i| [(i, high_a[i] - low_b[i]), (i, low_a[i] - high_b[i])]);
    let Some((axis, by)) = moves.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) else { return vec![last] };
    let by = if moved == 1 { by } else { -by } * (1.0 + CLEARANCE);
    let Some(index) = bodies[moved] else { return vec![last] };
    let mut position = case.scene.bodies[index].position;
    position[axis] = toml::short(position[axis] + by);
    let why = format!("`{}` moved by {:.4} along {}", names[moved], by, ["x", "y", "z"][axis]);
    vec![Remedy::set(format!("body[{index}].position"), toml::vector(position), &why), last]
}

/// Unit normal, middle and size, a length, of a facet.
pub(super) fn measured(facet: &FacetNodes, q: &[f64]) -> ([f64; 3], [f64; 3], f64) {
    let x = facet.map(|node| -> [f64; 3] { std::array::from_fn(|i| q[3 * node as usize + i]) });
    let difference = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| x[b][i] - x[a][i]) };
    let (a, b) = (difference(0, 2), difference(1, if x.len() == 4 { 3 } else { 0 }));
    let n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let length = n.iter().map(|n| n * n).sum::<f64>().sqrt();
    let middle = std::array::from_fn(|i| x.iter().map(|x| x[i]).sum::<f64>() / x.len() as f64);
    // Twice the area.
    (n.map(|n| n / length.max(f64::MIN_POSITIVE)), middle, (0.5 * length).sqrt())
}

/// Measures of some facets of a surface.
fn facets(facets: &[FacetNodes], q: &[f64]) -> Vec<([f64; 3], [f64; 3], f64)> {
    let every = facets.len().div_ceil(MOST_FACETS).max(1);
    facets.iter().step_by(every).map(|facet| measured(facet, q)).collect()
}

/// Whether a facet of one surface and one of the other look at each other: their normals point against each other, and each is before the other one.
fn facing(a: &[FacetNodes], b: &[FacetNodes], q: &[f64]) -> bool {
    let (a, b) = (facets(a, q), facets(b, q));
    let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    a.iter().any(|(n, x, edge_a)| {
        b.iter().any(|(m, y, edge_b)| {
            let away: [f64; 3] = std::array::from_fn(|i| y[i] - x[i]);
            let near = 0.5 * edge_a.min(*edge_b);
            dot(n, m) < -EDGE_ON && dot(n, &away) > -near && dot(m, &away) < near
        })
    })
}

/// The sets of facets of two bodies that look at each other and are nearest to a point and to each other.
fn facing_sets(case: &DiagnosedRun<'_>, names: &[String; 2], x: Option<[f64; 3]>) -> Option<[String; 2]> {
    let q = &case.model().reference;
    let sets = |name: &String| -> Option<Vec<(String, Vec<FacetNodes>)>> {
        let part = case.part(name)?;
        let named = |set: String| (format!("{name}.{set}"), part.facets_of(&set).unwrap_or_default());
        Some(part.facet_sets().into_iter().map(named).collect())
    };
    let (first, second) = (sets(&names[0])?, sets(&names[1])?);
    let apart = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    let mut best: Option<(f64, usize, [String; 2])> = None;
    for (a, of_a) in &first {
        for (b, of_b) in second.iter().filter(|(_, of_b)| facing(of_a, of_b, q)) {
            let count = of_a.len() + of_b.len();
            let (of_a, of_b) = (facets(of_a, q), facets(of_b, q));
            let each = of_a.iter().flat_map(|(_, x, _)| of_b.iter().map(move |(_, y, _)| apart(x, y)));
            let near = |facets: &[([f64; 3], [f64; 3], f64)], x: &[f64; 3]| {
                facets.iter().map(|(_, y, _)| apart(x, y)).fold(f64::INFINITY, f64::min)
            };
            let far = x.map_or(0.0, |x| near(&of_a, &x) + near(&of_b, &x)) + each.fold(f64::INFINITY, f64::min);
            // Of sets that are as near the smaller ones: the whole boundary costs more and says less.
            let is_better = best.as_ref().is_none_or(|&(other, facets, _)| {
                far < other * (1.0 - 1e-9) || far <= other * (1.0 + 1e-9) && count < facets
            });
            if is_better {
                best = Some((far, count, [a.clone(), b.clone()]));
            }
        }
    }
    best.map(|(.., sets)| sets)
}

/// Contacts none of whose facets look at each other, now or at the start.
pub(super) fn facing_away(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    let mut list = Vec::new();
    if !case.is_bad() {
        return list;
    }
    for (c, item) in case.contacts() {
        let surfaces = item.surfaces();
        let [first, second] = surfaces.map(|set| case.facets(set));
        if first.is_empty() || second.is_empty() {
            continue;
        }
        let q = [&case.model().reference, &case.simulation.state().q];
        if q.iter().any(|q| facing(&first, &second, q)) {
            continue;
        }
        let names = surfaces.map(|set| split_set(set).map_or(set, |(body, _)| body).to_owned());
        let crossed = inside(case).find(|(_, other)| other.contains(&names[0]) && other.contains(&names[1]));
        let position = crossed.as_ref().and_then(|(seen, _)| seen.position);
        let label = item.label();
        let place = match &crossed {
            Some((seen, names)) => between(case, seen, names, Some(label.clone())),
            None => Where { text: format!("contact `{label}`"), pair: Some(label.clone()), ..Where::default() },
        };
        let mut evidence = vec![format!(
            "no facet of `{}` faces a facet of `{}`, neither at the start nor now",
            surfaces[0], surfaces[1]
        )];
        evidence.extend(crossed.as_ref().map(|(seen, _)| seen.sentence.clone()));
        if case.simulation.active()[c].iter().all(|active| !active) {
            evidence.push(format!("no point of `{label}` is in contact"));
        }
        let mut remedies = Vec::new();
        if let Some(better) = facing_sets(case, &names, position).filter(|better| *better != surfaces) {
            let set = |k: usize| Change::Set {
                key: format!("contact[{c}].{}", item.surface_keys()[k]),
                value: format!("\"{}\"", better[k]),
            };
            let changes: Vec<Change> = (0..2).filter(|&k| better[k] != surfaces[k]).map(set).collect();
            let keys: Vec<String> = changes
                .iter()
                .filter_map(|change| match change {
                    Change::Set { key, value } => Some(format!("`{key} = {value}`")),
                    Change::Add { .. } => None,
                })
                .collect();
            remedies.push(Remedy {
                text: format!("name the surfaces that face each other: set {}", keys.join(" and ")),
                changes,
            });
        }
        remedies.push(Remedy::words("if the bodies turn before they touch, leave the contact as it is"));
        list.push(LikelyCause {
            cause: Cause::SurfacesFaceAway,
            confidence: match &crossed {
                Some((seen, _)) => confidence(seen),
                None => Confidence::Medium,
            },
            place,
            sentence: format!("the surfaces of contact `{label}` face away from each other: they cannot touch"),
            evidence,
            remedies,
        });
    }
    list
}

/// General contact for two bodies, if the schemes carry it.
fn by_general(case: &DiagnosedRun<'_>, names: &[String; 2]) -> Option<Remedy> {
    let scene = case.scene;
    let stages = scene.stages.iter().filter_map(|stage| stage.integrator.as_ref());
    let mut schemes = scene.time.integrator.iter().chain(stages);
    if !cfg!(feature = "general") || !schemes.all(crate::scene::Integrator::carries_general_contact) {
        return None;
    }
    if scene.general_contact.as_ref().is_some_and(|table| !table.enabled) {
        let change = Change::Set { key: "general_contact.enabled".into(), value: "true".into() };
        let text = "or let general contact keep all bodies apart: set `general_contact.enabled = true`".into();
        return Some(Remedy { text, changes: vec![change] });
    }
    let [a, b] = names;
    let is_rigid = names.iter().all(|name| scene.rigids.iter().any(|rigid| rigid.name == *name));
    let modulus = if is_rigid { ", modulus = 1e6" } else { "" };
    let pair = format!("pairs = [{{ between = [\"{a}\", \"{b}\"]{modulus} }}]");
    let is_on = scene.general_contact.is_some() || crate::build::general_contact(scene).is_some();
    let (toml, text) = match (is_rigid, is_on) {
        (false, false) => {
            ("[general_contact]\n".to_owned(), "or let all surfaces be in contact: `[general_contact]`".to_owned())
        }
        (true, false) => (
            format!("[general_contact]\n{pair}\n"),
            format!(
                "or let all surfaces be in contact: `[general_contact] {pair}`, with a modulus (a pressure) that suits these bodies"
            ),
        ),
        (_, true) => {
            return Some(Remedy::words(format!(
                "or let general contact keep them apart: add `{pair}` to [general_contact], and see `enabled`, `include` and `exclude`"
            )));
        }
    };
    Some(Remedy { text, changes: vec![Change::Add { toml }] })
}

/// Bodies that collide although no contact is named between them.
pub(super) fn missing_contact(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    let mut done: Vec<[String; 2]> = Vec::new();
    let mut list = Vec::new();
    for (seen, names) in inside(case).filter(|(seen, _)| seen.step > 0) {
        let is_known = done.iter().any(|other| other.contains(&names[0]) && other.contains(&names[1]));
        let has_contact = contact_between(case, &names).is_some() || keeps_apart(case.scene, [&names[0], &names[1]]);
        if is_known || has_contact {
            continue;
        }
        let mut remedies = Vec::new();
        if let Some([a, b]) = facing_sets(case, &names, seen.position) {
            let toml = format!("[[contact]]\nmethod = \"nts\"\nbetween = [\"{a}\", \"{b}\"]\n");
            let text = format!("add it: `[[contact]] method = \"nts\", between = [\"{a}\", \"{b}\"]`");
            remedies.push(Remedy { text, changes: vec![Change::Add { toml }] });
        }
        remedies.extend(by_general(case, &names));
        remedies.push(Remedy::words("or bond them with `[[tie]]` if they are one piece"));
        list.push(LikelyCause {
            cause: Cause::MissingContact,
            confidence: confidence(seen),
            place: between(case, seen, &names, None),
            sentence: format!(
                "`{}` and `{}` penetrate each other, and no contact is defined between them",
                names[0], names[1]
            ),
            evidence: vec![seen.sentence.clone()],
            remedies,
        });
        done.push(names);
    }
    list
}
