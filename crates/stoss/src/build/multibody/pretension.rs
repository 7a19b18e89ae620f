//! Whether a pretension pulls the sides of its cut together: which way the axis of the slider points between them.

use super::super::placed::Discretisation;
use crate::build::{Placed, Problems};
use crate::scene::{Joint, Scene, Series, split_set};

/// Part of its own size by which the material beside a cut has to lie on one side of it.
const DECIDED: f64 = 0.1;

/// Refuses a pretension whose axis points from the second side of the cut to the first: what is positive in tension then pushes them apart. A negative force that
/// pushes is warned of.
pub(super) fn check(scene: &Scene, placed: &[Placed], problems: &mut Problems<'_>, warnings: &mut Vec<String>) {
    for (j, joint) in scene.joints.iter().enumerate() {
        let (Some(pretension), Some(axis)) = (&joint.pretension, joint.axis) else { continue };
        // The first side is behind the cut and the second ahead of it, along the axis.
        let [first, second] = sides(joint, placed, axis);
        let votes = second - first;
        let is_split = first * second > 0;
        let force = extreme(&pretension.force);
        if is_split || votes == 0 || force == 0.0 {
            continue;
        }
        let [a, b] = &joint.between;
        if votes < 0 && force > 0.0 {
            let back = axis.map(|x| if x == 0.0 { 0.0 } else { -x });
            problems.add(
                format!("joint[{j}].between"),
                format!("[\"{a}\", \"{b}\"]"),
                format!("the axis points from `{b}` to `{a}`, not from the first side to the second: a force that is positive in tension would push the sides of the cut apart"),
                format!("write between = [\"{b}\", \"{a}\"], or axis = {back:?}"),
            );
        } else if votes > 0 && force < 0.0 {
            warnings.push(format!(
                "joint[{j}].pretension.force: a negative force pushes `{a}` and `{b}` apart; it is positive where it pulls them together"
            ));
        }
    }
}

/// Side of the cut on which the material of both sides is: 1 ahead along the axis, -1 behind, 0 if neither.
fn sides(joint: &Joint, placed: &[Placed], axis: [f64; 3]) -> [i32; 2] {
    let at = joint.at.both();
    std::array::from_fn(|k| {
        let Some((along, size)) = behind(&joint.between[k], at[k], placed, axis) else { return 0 };
        let decided = DECIDED * size * dot(axis, axis).sqrt();
        i32::from(along > decided) - i32::from(along < -decided)
    })
}

/// Distance of the material ahead of a side of the cut, times the length of the axis, and the size of what was looked at. `None` for what has no extent.
fn behind(side: &str, at: [f64; 3], placed: &[Placed], axis: [f64; 3]) -> Option<(f64, f64)> {
    let (part, set) = split_set(side).map_or((side, None), |(part, set)| (part, Some(set)));
    let part = placed.iter().find(|placed| placed.name == part)?;
    match &part.shape {
        Discretisation::Solid { mesh, .. } => {
            // The elements at the cut: what is farther away may lie anywhere, as in a bent bolt.
            let nodes = mesh.nodes_of(set?).ok()?;
            let mut is_cut = vec![false; mesh.nodes.len()];
            nodes.iter().for_each(|&n| is_cut[n as usize] = true);
            let cut = mean(nodes.iter().map(|&n| mesh.nodes[n as usize]))?;
            let beside = mesh.elements.iter().filter(|element| element.iter().any(|&n| is_cut[n as usize]));
            let (mut along, mut size, mut count) = (0.0, 0.0, 0.0);
            for element in beside {
                let corner = |&n: &u32| mesh.nodes[n as usize];
                let middle = mean(element.iter().map(corner))?;
                along += dot(axis, less(middle, cut));
                size += element.iter().map(|n| length(less(corner(n), middle))).fold(0.0, f64::max);
                count += 1.0;
            }
            (count > 0.0).then(|| (along / count, size / count))
        }
        Discretisation::Surface(surface) => {
            let middle = mean(surface.nodes.iter().copied())?;
            let size = surface.nodes.iter().map(|&x| length(less(x, middle))).fold(0.0, f64::max);
            Some((dot(axis, less(middle, at)), size))
        }
        Discretisation::Nodes { positions, lengths, .. } if !lengths.is_empty() => {
            // A line ends at the cut and goes on from there one way.
            let node = match set {
                Some("start") => 0,
                Some("end") => positions.len().checked_sub(1)?,
                _ => (0..positions.len())
                    .min_by(|&a, &b| length(less(positions[a], at)).total_cmp(&length(less(positions[b], at))))?,
            };
            let beside = [node.checked_sub(1), Some(node + 1)].into_iter().flatten().filter_map(|n| positions.get(n));
            let ways: Vec<[f64; 3]> = beside.map(|&x| less(x, positions[node])).collect();
            let size = ways.iter().map(|&way| length(way)).fold(0.0, f64::max);
            Some((dot(axis, mean(ways.into_iter())?), size))
        }
        Discretisation::Nodes { .. } => None,
    }
}

/// The value of the force that is farthest from zero.
fn extreme(force: &Series) -> f64 {
    let values = force.rows().into_iter().filter_map(|row| row.get(1).copied());
    values.fold(0.0, |extreme: f64, value| if value.abs() > extreme.abs() { value } else { extreme })
}

fn mean(points: impl Iterator<Item = [f64; 3]>) -> Option<[f64; 3]> {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for x in points {
        (0..3).for_each(|i| sum[i] += x[i]);
        count += 1.0;
    }
    (count > 0.0).then(|| sum.map(|x| x / count))
}

fn less(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
