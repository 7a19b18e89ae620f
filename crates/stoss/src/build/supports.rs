//! Whether supports hold the bodies of a quasi-static scene.

use super::placed::Placed;
use crate::scene::{Scene, split_set};
use crate::solver::Model;

/// Part of the largest pivot below which a rigid motion is not held.
const NOT_HELD: f64 = 1e-9;

/// Warnings for bodies that can move as rigid ones although nothing but their inertia, which statics do not have, would hold them.
pub(super) fn warnings(scene: &Scene, placed: &[Placed], model: &Model) -> Vec<String> {
    if scene.is_dynamic() {
        return Vec::new();
    }
    let body = |set: &str| split_set(set).and_then(|(body, _)| scene.body_index(body));
    // Tied bodies hold each other: the same number for all of them.
    let mut group: Vec<usize> = (0..scene.bodies.len()).collect();
    for tie in &scene.ties {
        if let (Some(a), Some(b)) = (body(&tie.slave), body(&tie.master)) {
            let (from, to) = (group[a], group[b]);
            group.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
        }
    }
    let mut list = Vec::new();
    for leader in 0..scene.bodies.len() {
        let members: Vec<usize> = (0..scene.bodies.len()).filter(|&b| group[b] == leader).collect();
        if members.is_empty() {
            continue;
        }
        let nodes = |b: usize| model.bodies[b].nodes.clone();
        let is_member = |node: u32| members.iter().any(|&b| nodes(b).contains(&node));
        let mut prescribed = Vec::new();
        for prescription in &model.prescriptions {
            for &node in prescription.nodes.iter().filter(|&&node| is_member(node)) {
                prescribed.extend(prescription.components.iter().map(|&c| (node, AXES[usize::from(c)])));
            }
        }
        // Springs of supports hold as well; dashpots hold nothing in statics.
        for support in &scene.supports {
            let Some(axes) = support.axes() else { continue };
            let held = (0..3).filter(|&i| support.stiffness[i] > 0.0).map(move |i| axes[i]);
            let nodes = nodes_of(placed, &support.set).into_iter().filter(|&node| is_member(node));
            prescribed.extend(nodes.flat_map(|node| held.clone().map(move |axis| (node, axis))));
        }
        for item in scene.prescriptions.iter().filter(|item| item.is_inclined()) {
            let (Some(set), Some(normal)) = (&item.set, item.normal) else { continue };
            let size = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
            let nodes = nodes_of(placed, set).into_iter().filter(|&node| is_member(node));
            prescribed.extend(nodes.map(|node| (node, normal.map(|n| n / size))));
        }
        let touches = scene
            .contacts
            .iter()
            .any(|contact| contact.surfaces().into_iter().filter_map(body).any(|b| members.contains(&b)));
        // Joints, equations and springs may hold it; whether they do, the solution tells.
        let joined = scene.joints.iter().map(|joint| &joint.between).chain(scene.springs.iter().map(|s| &s.between));
        let coupled = scene.couplings.iter().map(|coupling| coupling.set.as_str());
        let terms = scene.equations.iter().flat_map(|equation| &equation.terms);
        let in_terms = terms.filter_map(|term| term.set.as_deref());
        let named = scene.equations.iter().flat_map(|equation| &equation.terms).filter_map(|term| term.body.as_deref());
        let named = named.filter_map(|part| scene.body_index(part));
        let joined = joined.flatten().map(String::as_str).chain(coupled).chain(in_terms).filter_map(body).chain(named);
        if joined.into_iter().any(|b| members.contains(&b)) {
            continue;
        }
        let left = 6 - held_motions(&model.reference, &prescribed);
        let names: Vec<String> = members.iter().map(|&b| format!("`{}`", scene.bodies[b].name)).collect();
        let names = names.join(" with ");
        let by_general = super::general_contact(scene).is_some() && !touches;
        if by_general && (left == 0 || scene.time.stabilise.is_some()) {
            continue;
        }
        if by_general {
            list.push(format!(
                "{names}: only general contact can prevent {left} of 6 rigid motions, and it has no stiffness before surfaces are pressed together; a quasi-static run may find \
                 the system singular. `stabilise` the run, or prescribe displacements that exclude them"
            ));
        } else if prescribed.is_empty() && touches && scene.time.stabilise.is_none() {
            list.push(format!(
                "{names}: supported by contact alone; in a quasi-static run a rigid motion is free until other contacts or friction prevent it. Prescribe some displacements, or `stabilise` the run"
            ));
        } else if left > 0 && !touches {
            list.push(format!(
                "{names}: {left} of 6 rigid motions are free, and no contact is named for it; a quasi-static run will find the system singular. Prescribe \
                 displacements that exclude them"
            ));
        }
    }
    list
}

/// Nodes of a set `part.set`; none of one that cannot be resolved, which was reported.
pub(super) fn nodes_of(placed: &[Placed], set: &str) -> Vec<u32> {
    let nodes = || {
        let (part, set) = split_set(set)?;
        placed.iter().find(|placed| placed.name == part)?.nodes_of(set).ok()
    };
    nodes().unwrap_or_default()
}

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Number of the six rigid motions of a body that these held directions (node, unit direction) exclude.
fn held_motions(reference: &[f64], prescribed: &[(u32, [f64; 3])]) -> usize {
    let position = |node: u32| -> [f64; 3] { std::array::from_fn(|i| reference[3 * node as usize + i]) };
    let count = prescribed.len().max(1) as f64;
    let centre: [f64; 3] =
        std::array::from_fn(|i| prescribed.iter().map(|&(node, _)| position(node)[i]).sum::<f64>() / count);
    let arm = |node: u32| -> [f64; 3] { std::array::from_fn(|i| position(node)[i] - centre[i]) };
    let size = prescribed.iter().flat_map(|&(node, _)| arm(node)).fold(0.0_f64, |size, x| size.max(x.abs()));
    let mut gram = [[0.0; 6]; 6];
    for &(node, d) in prescribed {
        let x = arm(node).map(|x| if size > 0.0 { x / size } else { 0.0 });
        // d . (a + w x X) = d . a + (X x d) . w, in terms of a and w.
        let row = [d[0], d[1], d[2], x[1] * d[2] - x[2] * d[1], x[2] * d[0] - x[0] * d[2], x[0] * d[1] - x[1] * d[0]];
        for a in 0..6 {
            for b in 0..6 {
                gram[a][b] += row[a] * row[b];
            }
        }
    }
    rank(gram)
}

/// Rank of a symmetric, positive semi-definite matrix by elimination with the largest diagonal first.
fn rank(mut matrix: [[f64; 6]; 6]) -> usize {
    let largest = (0..6).map(|i| matrix[i][i]).fold(0.0, f64::max);
    let mut left: Vec<usize> = (0..6).collect();
    while let Some(place) =
        (0..left.len()).max_by(|&a, &b| matrix[left[a]][left[a]].total_cmp(&matrix[left[b]][left[b]]))
    {
        let p = left[place];
        let pivot = matrix[p][p];
        if pivot <= NOT_HELD * largest || pivot <= 0.0 {
            break;
        }
        left.swap_remove(place);
        for &a in &left {
            let factor = matrix[a][p] / pivot;
            for &b in &left {
                matrix[a][b] -= factor * matrix[p][b];
            }
        }
    }
    6 - left.len()
}

#[cfg(test)]
mod tests {
    use super::{AXES, held_motions};

    const REFERENCE: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

    #[test]
    fn rigid_motions_are_counted() {
        let all = |nodes: &[u32]| nodes.iter().flat_map(|&node| AXES.map(move |axis| (node, axis))).collect::<Vec<_>>();
        assert_eq!(held_motions(&REFERENCE, &[]), 0);
        assert_eq!(held_motions(&REFERENCE, &all(&[0])), 3);
        // Two nodes leave the rotation about the line through them.
        assert_eq!(held_motions(&REFERENCE, &all(&[0, 1])), 5);
        assert_eq!(held_motions(&REFERENCE, &all(&[0, 1, 2])), 6);
        // The symmetry planes of a block.
        assert_eq!(
            held_motions(
                &REFERENCE,
                &[(0, 0), (2, 0), (3, 0), (0, 1), (1, 1), (3, 1), (0, 2), (1, 2), (2, 2)]
                    .map(|(n, i): (u32, usize)| (n, AXES[i]))
            ),
            6
        );
    }
}
