//! Rigid motions of the parts of a scene, and the linear equations of what holds them: prescribed components, springs of supports, ties and joints, closed contacts.

use super::case::DiagnosedRun;
use super::motion::{Motions, motions, null_space};
use crate::scene::split_set;
use crate::solver::Model;
use std::collections::BTreeSet;
use stoss_term::{GradientRule, StepConfiguration};

/// What moves as a rigid body: a solid, or a part with vectors of its own.
pub(super) struct Member {
    pub(super) name: String,
    vectors: std::ops::Range<u32>,
    pub(super) centre: [f64; 3],
    length: f64,
    /// Directors among the vectors of the member.
    directions: BTreeSet<u32>,
    /// Whether it has an extent, so that it can turn.
    turns: bool,
    /// Whether something elastic, or a string, may hold it.
    pub(super) elastic: bool,
    /// Whether a penalty or the layer of general contact may hold it, where that is pressed.
    pub(super) layered: bool,
}

/// A linear equation for rigid motions: members with six coefficients each.
pub(super) type Row = Vec<(usize, [f64; 6])>;

pub(super) fn members(case: &DiagnosedRun<'_>) -> Vec<Member> {
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
                layered: false,
            }
        })
        .collect();
    let mut elastic: Vec<u32> = Vec::new();
    // Supports are checked by component.
    let supports: BTreeSet<String> =
        case.scene.supports.iter().enumerate().map(|(s, item)| item.part_name(s)).collect();
    let springs = model.parts.iter().filter(|part| part.own_vectors().is_empty() && !supports.contains(part.name()));
    for part in springs {
        part.stencils(&[], &mut |vectors, _| elastic.extend_from_slice(vectors));
    }
    let mut layered: Vec<u32> = Vec::new();
    for pair in model.contacts.iter().filter(|pair| pair.potential().is_some()) {
        let active = vec![true; pair.term.slot_count()];
        pair.term.stencils(&active, &mut |nodes, _| layered.extend_from_slice(nodes));
    }
    for node in elastic {
        if let Some(m) = member_of(model, &list, node) {
            list[m].elastic = true;
        }
    }
    for node in layered {
        if let Some(m) = member_of(model, &list, node) {
            list[m].layered = true;
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
fn add(case: &DiagnosedRun<'_>, members: &[Member], row: &mut Row, node: u32, i: usize, factor: f64) {
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
fn component(case: &DiagnosedRun<'_>, members: &[Member], node: u32, i: usize) -> Row {
    let mut row = Row::new();
    add(case, members, &mut row, node, i, 1.0);
    row
}

/// Components that springs of supports hold; dashpots hold nothing in statics.
pub(super) fn supported(case: &DiagnosedRun<'_>, members: &[Member]) -> Vec<Row> {
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
pub(super) fn closed(case: &DiagnosedRun<'_>, members: &[Member], group: &[usize]) -> Vec<Row> {
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
pub(super) fn prescribed(case: &DiagnosedRun<'_>, members: &[Member]) -> Vec<Row> {
    let mut rows = Vec::new();
    for prescription in case.prescriptions() {
        for &node in &prescription.nodes {
            for &component in &prescription.components {
                rows.push(self::component(case, members, node, usize::from(component)));
            }
        }
    }
    rows
}

/// Equations of joints and ties at the present positions; those of rigidity hold for every rigid motion and say nothing.
pub(super) fn bilateral(case: &DiagnosedRun<'_>, members: &[Member]) -> Vec<Row> {
    let q = &case.simulation.state().q;
    let mut rows = Vec::new();
    for (pair, active) in case.model().contacts.iter().zip(case.simulation.active()) {
        if !pair.always_holds() || !pair.acts {
            continue;
        }
        let pressures = vec![0.0; active.len()];
        let step = StepConfiguration { q_n: q, q_np1: q, rule: GradientRule::EndPoint };
        let mut locals = Vec::new();
        // What cannot be evaluated here stopped the run with an error of its own.
        let _ = pair.term.assemble(&step.at(&pressures, active), true, &mut |local| locals.push(local.clone()));
        for local in &locals {
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
        }
    }
    rows
}

/// Members that equations connect.
pub(super) fn groups(count: usize, rows: &[Row]) -> Vec<Vec<usize>> {
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
pub(super) fn free(members: &[Member], rows: &[Row], group: &[usize]) -> Vec<Motions> {
    let vectors = null_vectors(members, rows, group);
    let of = |(k, &m): (usize, &usize)| {
        let own: Vec<Vec<f64>> = vectors.iter().map(|v| v[6 * k..6 * k + 6].to_vec()).collect();
        motions(&own, members[m].centre, members[m].length)
    };
    group.iter().enumerate().map(of).collect()
}

/// Motions that nothing resists, as vectors of six numbers a member.
pub(super) fn null_vectors(members: &[Member], rows: &[Row], group: &[usize]) -> Vec<Vec<f64>> {
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

pub(super) fn is_free(motions: &Motions) -> bool {
    !(motions.translations.is_empty() && motions.rotations.is_empty())
}

/// How far a free motion moves some components (node, component), in the mean; of the one that moves them least.
pub(super) fn moved(case: &DiagnosedRun<'_>, members: &[Member], vectors: &[Vec<f64>], more: &[(u32, usize)]) -> f64 {
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
pub(super) fn all_held(
    case: &DiagnosedRun<'_>,
    members: &[Member],
    rows: &[Row],
    group: &[usize],
    more: &[(u32, usize)],
) -> bool {
    let mut all = rows.to_vec();
    all.extend(more.iter().map(|&(node, i)| component(case, members, node, i)));
    free(members, &all, group).iter().all(|motions| !is_free(motions))
}
