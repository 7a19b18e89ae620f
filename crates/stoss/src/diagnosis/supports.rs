//! Rigid motions that nothing holds, in statics: of single bodies, and of bodies that ties, joints and springs connect.

use super::case::DiagnosedRun;
use super::members::{
    Member, Row, all_held, bilateral, closed, free, groups, is_free, members, moved, null_vectors, prescribed,
    supported,
};
use super::motion::Motions;
use super::{Cause, Change, Confidence, LikelyCause, Remedy, toml};
use crate::build::general_schemes::keeps_apart;
use crate::scene::split_set;
use std::collections::BTreeSet;
use stoss_solver::FailureKind;

/// How a prescription on another set is offered.
const ANOTHER: &str = "fix another set: ";

/// Most bodies that are connected for which motions are looked for.
const MOST_MEMBERS: usize = 20;

/// Findings for every group of bodies that is not held.
pub(super) fn supports(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    if case.simulation.plan().rule.has_inertia() {
        return Vec::new();
    }
    let members = members(case);
    let mut rows = prescribed(case, &members);
    rows.extend(supported(case, &members));
    rows.extend(bilateral(case, &members));
    let touching = touching(case);
    // Where the matrix is singular in a motion of a body, no layer holds it.
    let place = case.place();
    let is_singular =
        |m: usize| case.failed_by(&[FailureKind::Singular]) && place.body.as_deref() == Some(members[m].name.as_str());
    let is_held = |group: &[usize]| {
        group.iter().any(|&m| members[m].elastic)
            || group.iter().any(|&m| members[m].layered) && !group.iter().any(|&m| is_singular(m))
    };
    groups(members.len(), &rows)
        .into_iter()
        .filter(|group| group.len() <= MOST_MEMBERS && !is_held(group))
        .filter_map(|group| finding(case, &members, &rows, &group, &touching))
        .collect()
}

/// Names of the bodies that a contact of the scene touches, or general contact may.
fn touching(case: &DiagnosedRun<'_>) -> BTreeSet<String> {
    let names =
        |item: &crate::scene::Contact| item.surfaces().map(|set| split_set(set).map(|(body, _)| body.to_owned()));
    let named = case.scene.contacts.iter().flat_map(names).flatten();
    let all: Vec<String> = case.part_names();
    let by_layer = all.iter().filter(|a| all.iter().any(|b| b != *a && keeps_apart(case.scene, [a, b]))).cloned();
    named.chain(by_layer).collect()
}

fn finding(
    case: &DiagnosedRun<'_>,
    members: &[Member],
    rows: &[Row],
    group: &[usize],
    touching: &BTreeSet<String>,
) -> Option<LikelyCause> {
    let free_of = free(members, rows, group);
    let moving: Vec<(usize, &Motions)> =
        group.iter().copied().zip(&free_of).filter(|(_, motions)| is_free(motions)).collect();
    let &(first, motions) = moving.first()?;
    let touches = moving.iter().any(|&(m, _)| touching.contains(&members[m].name));
    let place = case.place();
    let is_here = |m: usize| place.body.as_deref() == Some(members[m].name.as_str());
    let singular = case.failed_by(&[FailureKind::Singular]);
    // A rigid motion moves no multiplier: where a multiplier is what is not determined, constraints follow from others.
    let of_multiplier = singular && case.failure().is_some_and(|failure| failure.place.slot.is_some());
    // And with a free motion the matrix is singular: where it was factorised, contact holds the body.
    let was_factorised = !singular && case.failure().is_some();
    if touches && (of_multiplier || was_factorised) {
        return None;
    }
    let confidence = match (singular && moving.iter().any(|&(m, _)| is_here(m)), touches) {
        _ if of_multiplier || was_factorised => Confidence::Low,
        (true, _) => Confidence::High,
        (false, false) if case.is_bad() => Confidence::High,
        (false, false) => Confidence::Medium,
        (false, true) if case.is_bad() => Confidence::Medium,
        (false, true) => Confidence::Low,
    };
    let at = moving.iter().map(|&(m, _)| m).find(|&m| is_here(m)).unwrap_or(first);
    let words: Vec<String> = moving.iter().map(|(m, motions)| format!("`{}` is {motions}", members[*m].name)).collect();
    let contact =
        if touches { "; contact supports it only where it is closed, friction only while it sticks" } else { "" };
    let slides = moving.iter().any(|(_, motions)| !motions.translations.is_empty());
    let place = if is_here(at) {
        place
    } else {
        super::Where {
            text: format!("`{}`", members[at].name),
            body: Some(members[at].name.clone()),
            position: Some(members[at].centre),
            ..Default::default()
        }
    };
    let mut evidence = vec![format!(
        "prescribed displacements{}{} leave {} of the six rigid-body motions free, and statics has no inertia",
        if case.scene.supports.is_empty() { "" } else { ", the springs of supports" },
        if group.len() > 1 { ", the joints and the ties" } else { "" },
        motions.translations.len() + motions.rotations.len()
    )];
    if singular {
        evidence.push("the stiffness matrix is singular".to_owned());
    }
    Some(LikelyCause {
        cause: if slides { Cause::NoSupport } else { Cause::FreeRotation },
        confidence,
        place,
        sentence: format!("{}{contact}", words.join("; ")),
        evidence,
        remedies: match touches.then(|| stabilised(case, members, rows, group)).flatten() {
            Some(remedies) => remedies,
            None if touches => touch_first(case, members, group),
            None => remedies(case, members, rows, group),
        },
    })
}

/// Remedies for bodies that contact has to hold once it is closed: stabilisation until then, with a prescription of what contact never holds. Nothing for what is not
/// stabilised, or is already.
fn stabilised(case: &DiagnosedRun<'_>, members: &[Member], rows: &[Row], group: &[usize]) -> Option<Vec<Remedy>> {
    let solids = case.model().bodies.len();
    if group.iter().any(|&m| m >= solids) {
        return None;
    }
    let stage = (case.simulation.stage() as usize).saturating_sub(1);
    let present = case.scene.stages.get(stage).and_then(|stage| stage.stabilise.as_ref());
    if present.or(case.scene.time.stabilise.as_ref()).is_some() {
        return None;
    }
    let key =
        if case.scene.stages.is_empty() { "time.stabilise".to_owned() } else { format!("stage[{stage}].stabilise") };
    let why = "a viscous force then resists motions that are free until contact closes, and vanishes until the end";
    let mut first = Remedy::set(key, "{ fraction = 2e-4 }", why);
    let mut with_contact = rows.to_vec();
    with_contact.extend(closed(case, members, group));
    // What the layer of general contact would hold is not known.
    let is_named = with_contact.len() > rows.len();
    if is_named && !all_held(case, members, &with_contact, group, &[]) {
        let &[only] = group else { return None };
        let vectors = null_vectors(members, &with_contact, group);
        // A prescription that holds the body without contact would keep it from closing.
        let holds = |more: &[(u32, usize)]| {
            all_held(case, members, &with_contact, group, more) && !all_held(case, members, rows, group, more)
        };
        match other_set(case, &members[only].name, &holds, &|more| moved(case, members, &vectors, more)) {
            Some(rest) => {
                first.text += &format!(", and hold what contact does not: {}", rest.text.trim_start_matches(ANOTHER));
                first.changes.extend(rest.changes);
            }
            None => first.text += ", and prescribe the motions that contact does not hold",
        }
    }
    let mut rest = touch_first(case, members, group);
    rest[0].text.insert_str(0, "or ");
    rest.insert(0, first);
    Some(rest)
}

/// Remedies for bodies that contact has to hold once it is closed, and that are not stabilised: the motion that closes it, or inertia.
fn touch_first(case: &DiagnosedRun<'_>, members: &[Member], group: &[usize]) -> Vec<Remedy> {
    let names: Vec<String> = group.iter().map(|&m| format!("`{}`", members[m].name)).collect();
    let start = format!(
        "let contact close first: in a first `[[stage]]` prescribe the motion of {} until it touches, and in the next one, where the load acts, switch that motion `off`",
        names.join(", ")
    );
    vec![Remedy::words(start), by_inertia(case)]
}

fn by_inertia(case: &DiagnosedRun<'_>) -> Remedy {
    Remedy::words(match case.scene.stages.is_empty() {
        true => {
            "or set `scene.kind = \"dynamic\"` with densities and an integrator: inertia then balances the forces on free bodies"
        }
        false => "or use a dynamic stage: inertia then balances the forces on free bodies",
    })
}

/// Prescriptions that would hold a single body: more components of one that is there, or one on another set.
fn remedies(case: &DiagnosedRun<'_>, members: &[Member], rows: &[Row], group: &[usize]) -> Vec<Remedy> {
    let mut list = Vec::new();
    let scene = case.scene;
    let names = ["x", "y", "z"];
    let holds = |more: &[(u32, usize)]| all_held(case, members, rows, group, more);
    if let &[only] = group {
        let name = &members[only].name;
        for (p, item) in scene.prescriptions.iter().enumerate().filter(|(_, item)| item.fixed) {
            let Some(set) = item.set.as_deref().filter(|set| split_set(set).is_some_and(|(body, _)| body == name))
            else {
                continue;
            };
            let more: Vec<(u32, usize)> = case.nodes(set).iter().flat_map(|&n| (0..3).map(move |i| (n, i))).collect();
            if item.components.len() < 3 && holds(&more) {
                let why = format!("`{set}` is then fixed in all directions");
                list.push(Remedy::set(format!("prescribe[{p}].components"), toml::strings(&names), &why));
            }
        }
        let vectors = null_vectors(members, rows, group);
        list.extend(other_set(case, name, &holds, &|more| moved(case, members, &vectors, more)));
    }
    list.push(by_inertia(case));
    list
}

/// The prescription of fewest components on a set of the body, without one and without a load, that holds it; of several the one on what would move most.
fn other_set(
    case: &DiagnosedRun<'_>,
    name: &str,
    holds: &dyn Fn(&[(u32, usize)]) -> bool,
    moved: &dyn Fn(&[(u32, usize)]) -> f64,
) -> Option<Remedy> {
    let names = ["x", "y", "z"];
    let scene = case.scene;
    let sets: Vec<String> = case.part(name)?.set_names().into_iter().map(|set| format!("{name}.{set}")).collect();
    let is_taken = |set: &String| {
        scene.prescriptions.iter().any(|item| item.set.as_ref() == Some(set))
            || scene.loads.iter().any(|item| item.set.as_ref() == Some(set))
            || scene.contacts.iter().any(|item| item.surfaces().contains(&set.as_str()))
            || set.ends_with(".all")
            || set.ends_with(".boundary")
    };
    let free_sets: Vec<&String> = sets.iter().filter(|set| !is_taken(set)).collect();
    let choices: [&[&[usize]]; 3] = [&[&[0], &[1], &[2]], &[&[0, 1], &[0, 2], &[1, 2]], &[&[0, 1, 2]]];
    for choices in choices {
        let more = |components: &[usize], set: &str| -> Vec<(u32, usize)> {
            case.nodes(set).iter().flat_map(|&n| components.iter().map(move |&i| (n, i))).collect()
        };
        let all = choices.iter().flat_map(|components| free_sets.iter().map(move |set| (components, set)));
        let holding =
            all.map(|(components, set)| (components, set, more(components, set))).filter(|(.., more)| holds(more));
        let best =
            holding.map(|(components, set, more)| (components, set, moved(&more))).max_by(|a, b| a.2.total_cmp(&b.2));
        if let Some((components, set, _)) = best {
            let components = toml::strings(&components.iter().map(|&i| names[i]).collect::<Vec<_>>());
            let toml = format!("[[prescribe]]\nset = \"{set}\"\ncomponents = {components}\nfixed = true\n");
            let text = format!("{ANOTHER}`[[prescribe]] set = \"{set}\", components = {components}, fixed = true`");
            return Some(Remedy { text, changes: vec![Change::Add { toml }] });
        }
    }
    None
}
