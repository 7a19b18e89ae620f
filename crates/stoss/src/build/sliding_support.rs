//! Prescribed displacement along a normal: components where it is an axis of space, supports elsewhere.

use super::Problems;
use super::condition::InclinedPrescription;
use super::schedule::Named;
use crate::scene::Scene;
use crate::solver::{CouplingTerm, Model, Prescription, SlidingSupport, Table};
use std::collections::{BTreeMap, BTreeSet};

/// Sine of the angle below which a direction follows from others.
const DEPENDENT: f64 = 1e-6;
/// Part of a displacement by which two that ought to be the same may differ.
const SAME: f64 = 1e-6;
/// Parts of the time between two rows of tables at which displacements are compared: rotations are not linear in between.
const SAMPLES: usize = 8;

/// Adds supports behind the contacts and ties of a model; from the prescription `own` on they are sides of sections. For each the number in the scene and what it is in the model.
pub(super) fn add(
    scene: &Scene,
    inclined: Vec<InclinedPrescription>,
    own: usize,
    of_prescriptions: &[Option<usize>],
    tied: &BTreeSet<u32>,
    model: &mut Model,
    problems: &mut Problems<'_>,
) -> Vec<(usize, Named)> {
    let before = problems.list.len();
    compare(scene, &inclined, of_prescriptions, model, problems);
    let mut names = Vec::new();
    for InclinedPrescription { item, nodes, normal, displacement } in inclined {
        let key = format!("prescribe[{item}].normal");
        let given = &scene.prescriptions[item];
        let set = given.set.as_deref().unwrap_or_default();
        if let Some(node) = nodes.iter().find(|node| tied.contains(node)) {
            let message = format!(
                "node {node} of `{set}` belongs to the slave surface of a tie, which says where it is in all directions"
            );
            let remedy = "exchange slave and master of the tie, leave the slave's nodes out of the set, or turn the scene so that the normal is an axis of space";
            problems.add(key, set, message, remedy);
            continue;
        }
        let name = given.name.clone().unwrap_or_else(|| format!("prescribe[{item}] of {set}"));
        let Some(support) =
            SlidingSupport::new(&name, &nodes, normal, displacement, &model.reference, length(model, &nodes))
        else {
            problems.add(key, format!("{normal:?}"), "is no direction", "give finite numbers that are not all zero");
            continue;
        };
        names.push((item, Named::Contact(model.contacts.len())));
        model.contacts.push(CouplingTerm {
            name,
            acts: true,
            term: Box::new(if item < own { support } else { support.of_section() }),
            complementarity: 1.0,
            restitution: None,
        });
    }
    if problems.list.len() > before { Vec::new() } else { names }
}

/// Length of an edge of the body, or of the part, that has the nodes.
fn length(model: &Model, nodes: &[u32]) -> f64 {
    let Some(&node) = nodes.first() else { return 1.0 };
    let body = model.bodies.iter().find(|body| body.nodes.contains(&node));
    let part = model.parts.iter().find(|part| part.own_vectors().contains(&node));
    match (body, part) {
        (Some(body), _) => body.solid.characteristic_length(),
        (None, Some(part)) => part.length_scale(),
        (None, None) => 1.0,
    }
}

/// A displacement along a direction of a node.
#[derive(Clone, Copy)]
struct Condition<'a> {
    item: Option<usize>,
    direction: [f64; 3],
    of: Source<'a>,
}

#[derive(Clone, Copy)]
enum Source<'a> {
    Component(&'a Prescription, usize),
    SlidingSupport(&'a Table),
}

impl Condition<'_> {
    fn value(&self, node: u32, reference: [f64; 3], time: f64) -> f64 {
        match self.of {
            Source::SlidingSupport(table) => table.value(time, 0),
            Source::Component(prescription, column) => {
                prescription.position(node, reference, time, column)
                    - reference[usize::from(prescription.components[column])]
            }
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Reports supports whose displacement contradicts other conditions of the same node. What stages or events switch may contradict what acts at another time; a run that meets
/// a contradiction then stops there.
fn compare(
    scene: &Scene,
    inclined: &[InclinedPrescription],
    of_prescriptions: &[Option<usize>],
    model: &Model,
    problems: &mut Problems<'_>,
) {
    let is_switched = |item: usize| {
        let name = scene.prescriptions[item].name.as_ref();
        let off = scene.stages.iter().flat_map(|stage| &stage.off);
        let mut switched = off.chain(scene.events.iter().map(|event| &event.release));
        name.is_some_and(|name| switched.any(|other| other == name))
    };
    // Rows of all tables, and points between them.
    let rows: Vec<f64> = scene.prescriptions.iter().flat_map(times).chain([0.0]).collect();
    let sorted: BTreeSet<u64> = rows.iter().filter(|&&t| t >= 0.0).map(|t| t.to_bits()).collect();
    let sorted: Vec<f64> = sorted.into_iter().map(f64::from_bits).collect();
    let between = sorted.windows(2).flat_map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        (0..SAMPLES).map(move |k| from + (to - from) * k as f64 / SAMPLES as f64)
    });
    let times: Vec<f64> = between.chain(sorted.last().copied()).collect();

    let mut at: BTreeMap<u32, Vec<Condition<'_>>> = BTreeMap::new();
    for support in inclined.iter().filter(|support| !is_switched(support.item)) {
        support.nodes.iter().for_each(|&node| {
            at.entry(node).or_default();
        });
    }
    for (p, prescription) in model.prescriptions.iter().enumerate() {
        let item = of_prescriptions.iter().position(|&place| place == Some(p));
        if item.is_some_and(is_switched) {
            continue;
        }
        for node in &prescription.nodes {
            let Some(list) = at.get_mut(node) else { continue };
            for (column, &component) in prescription.components.iter().enumerate() {
                let direction = std::array::from_fn(|i| f64::from(u8::from(i == usize::from(component))));
                if !list.iter().any(|known| known.direction == direction) {
                    list.push(Condition { item, direction, of: Source::Component(prescription, column) });
                }
            }
        }
    }
    for support in inclined.iter().filter(|support| !is_switched(support.item)) {
        let size = dot(support.normal, support.normal).sqrt();
        let direction = support.normal.map(|d| d / size);
        let own = Condition { item: Some(support.item), direction, of: Source::SlidingSupport(&support.displacement) };
        for node in &support.nodes {
            let list = at.entry(*node).or_default();
            list.push(own);
            let Some((time, given, follows, others)) = contradiction(*node, list, &times, model) else { continue };
            let set = scene.prescriptions[support.item].set.as_deref().unwrap_or_default();
            let names: Vec<String> = others.iter().map(|item| format!("prescribe[{item}]")).collect();
            let message = format!(
                "node {node} of `{set}` is to move by {given:.6e} along this normal at t = {time}, but by {follows:.6e} according to {}",
                if names.is_empty() { "what else holds it".to_owned() } else { names.join(", ") }
            );
            let remedy = "let the sets not overlap, or give the same displacement where they do";
            problems.add(
                format!("prescribe[{}].normal", support.item),
                format!("{:?}", support.normal),
                message,
                remedy,
            );
            return;
        }
    }
}

fn times(item: &crate::scene::Prescribe) -> Vec<f64> {
    let turn = item.rotation.iter().flat_map(|rotation| rotation.degrees.rows());
    item.rows().into_iter().chain(turn).map(|row| row[0]).collect()
}

/// Whether the last of the conditions at a node follows from the others and asks for something else: time, what it asks for, what follows, who says so.
fn contradiction(
    node: u32,
    list: &[Condition<'_>],
    times: &[f64],
    model: &Model,
) -> Option<(f64, f64, f64, Vec<usize>)> {
    let reference = std::array::from_fn(|i| model.reference[3 * node as usize + i]);
    let (last, others) = list.split_last()?;
    for &time in times {
        // Orthonormal directions with their displacements.
        let mut known: Vec<([f64; 3], f64)> = Vec::new();
        let across = |direction: [f64; 3], value: f64, known: &[([f64; 3], f64)]| {
            let (mut rest, mut left) = (direction, value);
            for &(e, u) in known.iter().chain(known) {
                let part = dot(rest, e);
                (0..3).for_each(|i| rest[i] -= part * e[i]);
                left -= part * u;
            }
            (rest, left, dot(rest, rest).sqrt())
        };
        for other in others {
            let (rest, left, size) = across(other.direction, other.value(node, reference, time), &known);
            if size > DEPENDENT {
                known.push((rest.map(|r| r / size), left / size));
            }
        }
        let given = last.value(node, reference, time);
        let (_, left, size) = across(last.direction, given, &known);
        let scale = known.iter().fold(given.abs(), |scale, (_, u)| scale.max(u.abs()));
        if size <= DEPENDENT && left.abs() > SAME * scale {
            let mut items: Vec<usize> = others.iter().filter_map(|other| other.item).collect();
            items.sort_unstable();
            items.dedup();
            return Some((time, given, given - left, items));
        }
    }
    None
}
