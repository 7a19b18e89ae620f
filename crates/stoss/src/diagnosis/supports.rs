//! Rigid motions that nothing holds, in statics: of single bodies, and of bodies that ties, joints and springs connect.

use super::case::Case;
use super::motion::{Motions, motions, null_space};
use super::{Cause, Change, Confidence, Finding, Remedy, toml};
use crate::scene::split_set;
use crate::solver::{Coupling, Model};
use std::collections::BTreeSet;
use stoss_contact::{ContactRule, StepConfiguration};
use stoss_solver::FailureKind;

/// How a prescription on another set is offered.
const ANOTHER: &str = "fix another set: ";

/// Most bodies that are connected for which motions are looked for.
const MOST_MEMBERS: usize = 20;

/// What moves as a rigid body: a solid, or a part with vectors of its own.
struct Member {
    name: String,
    vectors: std::ops::Range<u32>,
    centre: [f64; 3],
    length: f64,
    /// Its vectors that are directions.
    directions: BTreeSet<u32>,
    /// Whether it has an extent, so that it can turn.
    turns: bool,
    /// Whether something elastic, or a string, may hold it.
    elastic: bool,
}

/// A linear equation for rigid motions: members with six coefficients each.
type Row = Vec<(usize, [f64; 6])>;

/// Findings for every group of bodies that is not held.
pub(super) fn supports(case: &Case<'_>) -> Vec<Finding> {
    if case.simulation.plan().rule.has_inertia() {
        return Vec::new();
    }
    let members = members(case);
    let mut rows = prescribed(case, &members);
    rows.extend(supported(case, &members));
    rows.extend(bilateral(case, &members));
    let touching = touching(case);
    groups(members.len(), &rows)
        .into_iter()
        .filter(|group| group.len() <= MOST_MEMBERS && !group.iter().any(|&m| members[m].elastic))
        .filter_map(|group| finding(case, &members, &rows, &group, &touching))
        .collect()
}

fn members(case: &Case<'_>) -> Vec<Member> {
    let model = case.model();
    let strings: BTreeSet<&str> = case.scene.strings.iter().map(|string| string.name.as_str()).collect();
    let solids = model.bodies.iter().map(|body| (body.solid.name().to_owned(), body.nodes.clone(), BTreeSet::new()));
    let parts = model.parts.iter().filter(|part| !part.own_vectors().is_empty()).map(|part| {
        let directions = part.own_vectors().filter(|&vector| part.is_direction(vector)).collect();
        (part.name().to_owned(), part.own_vectors(), directions)
    });
    let mut list: Vec<Member> = solids
        .chain(parts)
        .map(|(name, vectors, directions): (String, std::ops::Range<u32>, BTreeSet<u32>)| {
            let points: Vec<[f64; 3]> =
                vectors.clone().filter(|v| !directions.contains(v)).map(|v| case.position(v)).collect();
            let count = points.len().max(1) as f64;
            let centre: [f64; 3] = std::array::from_fn(|i| points.iter().map(|x| x[i]).sum::<f64>() / count);
            let arms = points.iter().map(|x| (0..3).map(|i| (x[i] - centre[i]).powi(2)).sum::<f64>().sqrt());
            let lengths = directions.iter().map(|&v| case.position(v).iter().map(|x| x * x).sum::<f64>().sqrt());
            let length = arms.chain(lengths).fold(0.0, f64::max);
            let elastic = strings.contains(name.as_str());
            Member {
                name,
                vectors,
                centre,
                directions,
                turns: length > 0.0,
                length: length.max(f64::MIN_POSITIVE),
                elastic,
            }
        })
        .collect();
    let mut elastic: Vec<u32> = Vec::new();
    // Supports are checked by component.
    let supports: BTreeSet<String> =
        case.scene.supports.iter().enumerate().map(|(s, item)| item.part_name(s)).collect();
    let springs = model.parts.iter().filter(|part| part.own_vectors().is_empty() && !supports.contains(part.name()));
    for part in springs {
        part.stencils(&mut |vectors| elastic.extend_from_slice(vectors));
    }
    for pair in model.contacts.iter().filter(|pair| matches!(pair.method, Coupling::Potential(_))) {
        let active = vec![true; pair.method.slot_count()];
        pair.method.stencils(&active, &mut |nodes, _| elastic.extend_from_slice(nodes));
    }
    for node in elastic {
        if let Some(m) = member_of(model, &list, node) {
            list[m].elastic = true;
        }
    }
    list
}

/// The member that a vector belongs to, or that carries it.
fn member_of(model: &Model, members: &[Member], node: u32) -> Option<usize> {
    let of = |vector: u32| members.iter().position(|member| member.vectors.contains(&vector));
    of(node).or_else(|| of(model.embedding.carriers(node)?.first()?.0))
}

/// Adds `factor` times component `i` of the motion of a vector to a row.
fn add(case: &Case<'_>, members: &[Member], row: &mut Row, node: u32, i: usize, factor: f64) {
    let Some(m) = member_of(case.model(), members, node).filter(|_| factor != 0.0) else { return };
    let member = &members[m];
    let x = case.position(node);
    let is_direction = member.directions.contains(&node);
    let arm: [f64; 3] = if is_direction { x } else { std::array::from_fn(|k| x[k] - member.centre[k]) };
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    let place = row.iter().position(|(other, _)| *other == m).unwrap_or_else(|| {
        row.push((m, [0.0; 6]));
        row.len() - 1
    });
    let coefficients = &mut row[place].1;
    coefficients[i] += if is_direction { 0.0 } else { factor };
    coefficients[3 + j] += factor * arm[k] / member.length;
    coefficients[3 + k] -= factor * arm[j] / member.length;
}

/// Components of a node, as rows.
fn component(case: &Case<'_>, members: &[Member], node: u32, i: usize) -> Row {
    let mut row = Row::new();
    add(case, members, &mut row, node, i, 1.0);
    row
}

/// Components that springs of supports hold; dashpots hold nothing in statics.
fn supported(case: &Case<'_>, members: &[Member]) -> Vec<Row> {
    let mut rows = Vec::new();
    for support in &case.scene.supports {
        for node in case.nodes(&support.set) {
            let held = (0..3).filter(|&i| support.stiffness[i] > 0.0);
            rows.extend(held.map(|i| component(case, members, node, i)));
        }
    }
    rows
}

/// What the contacts of the scene hold of some members while they are closed: the normal direction, with friction that sticks all directions.
fn closed(case: &Case<'_>, members: &[Member], group: &[usize]) -> Vec<Row> {
    let q = &case.simulation.state().q;
    let mut rows = Vec::new();
    for item in &case.scene.contacts {
        let of_group =
            |set: &&str| split_set(set).is_some_and(|(body, _)| group.iter().any(|&m| members[m].name == body));
        for set in item.surfaces().iter().filter(|set| of_group(set)) {
            for facet in &case.facets(set) {
                let (normal, ..) = super::surfaces::measured(facet, q);
                for &node in facet.iter() {
                    if item.friction.is_some() {
                        rows.extend((0..3).map(|i| component(case, members, node, i)));
                        continue;
                    }
                    let mut row = Row::new();
                    (0..3).for_each(|i| add(case, members, &mut row, node, i, normal[i]));
                    rows.push(row);
                }
            }
        }
    }
    rows
}

/// Prescribed components.
fn prescribed(case: &Case<'_>, members: &[Member]) -> Vec<Row> {
    let mut rows = Vec::new();
    for prescription in &case.model().prescriptions {
        for &node in &prescription.nodes {
            for &component in &prescription.components {
                rows.push(self::component(case, members, node, usize::from(component)));
            }
        }
    }
    rows
}

/// Equations of joints and ties at the present positions; those of rigidity hold for every rigid motion and say nothing.
fn bilateral(case: &Case<'_>, members: &[Member]) -> Vec<Row> {
    let q = &case.simulation.state().q;
    let mut rows = Vec::new();
    for (pair, active) in case.model().contacts.iter().zip(case.simulation.active()) {
        if !pair.method.is_bilateral() || pair.method.is_off() {
            continue;
        }
        let pressures = vec![0.0; active.len()];
        let step = StepConfiguration { q_n: q, q_np1: q, rule: ContactRule::EndPoint };
        // What cannot be evaluated here stopped the run with an error of its own.
        let _ = pair.method.assemble(step, &pressures, active, true, &mut |local| {
            let (n, dim) = (3 * local.nodes.len(), local.dim());
            for slot in 0..local.slots.len() {
                let entries = &local.tangent[(n + slot) * dim..(n + slot) * dim + n];
                let size: f64 = entries.iter().map(|entry| entry.abs()).sum();
                let mut row = Row::new();
                for (k, &entry) in entries.iter().enumerate() {
                    add(case, members, &mut row, local.nodes[k / 3], k % 3, entry);
                }
                let left = row.iter().flat_map(|(_, c)| c).map(|c| c * c).sum::<f64>().sqrt();
                if left > 1e-9 * size {
                    row.iter_mut().flat_map(|(_, c)| c).for_each(|c| *c /= left);
                    rows.push(row);
                }
            }
        });
    }
    rows
}

/// Names of the bodies that a contact of the scene touches.
fn touching(case: &Case<'_>) -> BTreeSet<String> {
    let names =
        |item: &crate::scene::Contact| item.surfaces().map(|set| split_set(set).map(|(body, _)| body.to_owned()));
    case.scene.contacts.iter().flat_map(names).flatten().collect()
}

/// Members that equations connect.
fn groups(count: usize, rows: &[Row]) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = (0..count).collect();
    for row in rows {
        for pair in row.windows(2) {
            let (from, to) = (group[pair[0].0], group[pair[1].0]);
            group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
        }
    }
    let groups = (0..count).map(|leader| (0..count).filter(|&m| group[m] == leader).collect::<Vec<_>>());
    groups.filter(|members| !members.is_empty()).collect()
}

/// Free motions of the members of a group.
fn free(members: &[Member], rows: &[Row], group: &[usize]) -> Vec<Motions> {
    let vectors = null_vectors(members, rows, group);
    let of = |(k, &m): (usize, &usize)| {
        let own: Vec<Vec<f64>> = vectors.iter().map(|v| v[6 * k..6 * k + 6].to_vec()).collect();
        motions(&own, members[m].centre, members[m].length)
    };
    group.iter().enumerate().map(of).collect()
}

/// The same as vectors of six numbers a member.
fn null_vectors(members: &[Member], rows: &[Row], group: &[usize]) -> Vec<Vec<f64>> {
    let n = 6 * group.len();
    let mut gram = vec![vec![0.0; n]; n];
    let place = |m: usize| group.iter().position(|&other| other == m);
    for row in rows {
        let Some(row) = row.iter().map(|(m, c)| Some((place(*m)?, c))).collect::<Option<Vec<_>>>() else { continue };
        for &(a, x) in &row {
            for &(b, y) in &row {
                for i in 0..6 {
                    for j in 0..6 {
                        gram[6 * a + i][6 * b + j] += x[i] * y[j];
                    }
                }
            }
        }
    }
    for (k, _) in group.iter().enumerate().filter(|&(_, &m)| !members[m].turns) {
        (3..6).for_each(|i| gram[6 * k + i][6 * k + i] += 1.0);
    }
    null_space(gram)
}

fn is_free(motions: &Motions) -> bool {
    !(motions.translations.is_empty() && motions.rotations.is_empty())
}

fn finding(
    case: &Case<'_>,
    members: &[Member],
    rows: &[Row],
    group: &[usize],
    touching: &BTreeSet<String>,
) -> Option<Finding> {
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
    let confidence = match (singular && moving.iter().any(|&(m, _)| is_here(m)), touches) {
        _ if of_multiplier => Confidence::Low,
        (true, _) => Confidence::High,
        (false, false) if case.is_bad() => Confidence::High,
        (false, false) => Confidence::Medium,
        (false, true) if case.is_bad() => Confidence::Medium,
        (false, true) => Confidence::Low,
    };
    let at = moving.iter().map(|&(m, _)| m).find(|&m| is_here(m)).unwrap_or(first);
    let words: Vec<String> = moving.iter().map(|(m, motions)| format!("`{}` is {motions}", members[*m].name)).collect();
    let contact =
        if touches { "; contact supports it only where it is closed, and friction only while it sticks" } else { "" };
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
        "the prescribed components{}{} leave {} of the six rigid-body motions free, and a static analysis has no inertia",
        if case.scene.supports.is_empty() { "" } else { ", the springs of supports" },
        if group.len() > 1 { ", the joints and the ties" } else { "" },
        motions.translations.len() + motions.rotations.len()
    )];
    if singular {
        evidence.push("the stiffness matrix is singular".to_owned());
    }
    Some(Finding {
        cause: if slides { Cause::NoSupport } else { Cause::FreeRotation },
        confidence,
        place,
        sentence: format!("{}{contact}", words.join("; ")),
        evidence,
        remedies: match touches.then(|| stabilised(case, members, rows, group)).flatten() {
            Some(remedies) => remedies,
            None => remedies(case, members, rows, group),
        },
    })
}

/// How far a free motion moves some components (node, component), in the mean; of the one that moves them least.
fn moved(case: &Case<'_>, members: &[Member], vectors: &[Vec<f64>], more: &[(u32, usize)]) -> f64 {
    let square = |v: &Vec<f64>| {
        let along = |&(node, i): &(u32, usize)| {
            let row = component(case, members, node, i);
            row.iter().flat_map(|(_, c)| c.iter().zip(v)).map(|(c, v)| c * v).sum::<f64>().powi(2)
        };
        more.iter().map(along).sum::<f64>() / more.len().max(1) as f64
    };
    vectors.iter().map(square).fold(f64::INFINITY, f64::min)
}

/// Whether some rows together with further components leave no motion free.
fn all_held(case: &Case<'_>, members: &[Member], rows: &[Row], group: &[usize], more: &[(u32, usize)]) -> bool {
    let mut all = rows.to_vec();
    all.extend(more.iter().map(|&(node, i)| component(case, members, node, i)));
    free(members, &all, group).iter().all(|motions| !is_free(motions))
}

/// For bodies that contact has to hold once it is closed: stabilisation until then, with a prescription of what contact never holds. Nothing for what is not
/// stabilised, or is already.
fn stabilised(case: &Case<'_>, members: &[Member], rows: &[Row], group: &[usize]) -> Option<Vec<Remedy>> {
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
    let why = "motions that nothing holds before contact closes are then resisted by a viscous force, which vanishes until the end";
    let mut first = Remedy::set(key, "{ fraction = 2e-4 }", why);
    let mut with_contact = rows.to_vec();
    with_contact.extend(closed(case, members, group));
    if !all_held(case, members, &with_contact, group, &[]) {
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
    let names: Vec<String> = group.iter().map(|&m| format!("`{}`", members[m].name)).collect();
    let start = format!(
        "or let the run begin with closed contact: prescribe the motion of {} until it touches in a first `[[stage]]`, and switch that motion `off` in the next one, where the load acts",
        names.join(", ")
    );
    Some(vec![
        first,
        Remedy::words(start),
        Remedy::words(match case.scene.stages.is_empty() {
            true => {
                "or set `scene.kind = \"dynamic\"` with densities and an integrator: free bodies are then held by their inertia"
            }
            false => "or use a dynamic stage: free bodies are then held by their inertia",
        }),
    ])
}

/// Prescriptions that would hold a single body: more components of one that is there, or one on another set.
fn remedies(case: &Case<'_>, members: &[Member], rows: &[Row], group: &[usize]) -> Vec<Remedy> {
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
    list.push(Remedy::words(match case.scene.stages.is_empty() {
        true => "or set `scene.kind = \"dynamic\"` with densities and an integrator: free bodies are then held by their inertia",
        false => "or use a dynamic stage: free bodies are then held by their inertia",
    }));
    list
}

/// The prescription of fewest components on a set of the body, without one and without a load, that holds it; of several the one on what would move most.
fn other_set(
    case: &Case<'_>,
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
