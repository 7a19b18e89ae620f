//! Nodes of a node-to-surface slave at an open rim of their master, where their gaps jump.

use super::case::DiagnosedRun;
use super::redundant::is_prescribed_whole;
use super::{Cause, Change, Confidence, LikelyCause, Remedy, Where, toml};
use crate::scene::Contact;
use std::collections::{BTreeMap, BTreeSet};
use stoss_reference_element::FacetNodes;
use stoss_solver::FailureKind;

/// Distance from a rim, in lengths of its edges, within which a node is at it.
const AT_RIM: f64 = 0.5;

/// Slave nodes that changed their state, or are where the residual is largest, at the rim of the master: beside the rim they have no gap, on it they have one.
pub(super) fn at_rim(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
    use FailureKind::{Cycling, NotConverged, Unsettled};
    if !case.failed_by(&[Cycling, NotConverged, Unsettled]) {
        return Vec::new();
    }
    case.contacts().filter_map(|(c, item)| of_contact(case, c, item)).collect()
}

fn of_contact(case: &DiagnosedRun<'_>, c: usize, item: &Contact) -> Option<LikelyCause> {
    let ([Some(slave), Some(master)], true) = ([&item.slave, &item.master], !item.method.integrates) else {
        return None;
    };
    let reports = case.simulation.contact_report(c).ok()?;
    let slots = case.failures().iter().flat_map(|failure| &failure.slots).filter(|slot| slot.pair == c);
    let changing: BTreeSet<u32> = slots.filter_map(|slot| Some(reports.get(slot.slot)?.node)).collect();
    let rim = rim(&case.facets(master));
    let close = |&&node: &&u32| {
        let x = case.position(node);
        rim.iter().any(|&[a, b]| {
            let (from, to) = (case.position(a), case.position(b));
            let (length, far) = (distance(from, to), from_edge(x, from, to));
            far < AT_RIM * length
        })
    };
    let nodes: Vec<u32> = changing.iter().filter(close).copied().collect();
    let &first = nodes.first()?;
    let label = item.label();
    let node = case.node(first);
    let set =
        |key: &str, value: &str| Change::Set { key: format!("contact[{c}].{key}"), value: format!("\"{value}\"") };
    let mut remedies =
        vec![Remedy::set(format!("contact[{c}].method"), "\"mortar\"", "its pressures fade out over the rim")];
    if item.constraint.is_some() || item.reduction.is_some() {
        // Keys that mortar does not have.
        remedies.clear();
    }
    let exchanged = Remedy {
        text: format!(
            "exchange slave and master, so that the rim belongs to the slave: set `contact[{c}].slave = \"{master}\"` and `contact[{c}].master = \"{slave}\"`"
        ),
        changes: vec![set("slave", master), set("master", slave)],
    };
    if !is_prescribed_whole(case, master) {
        remedies.push(exchanged);
    }
    Some(LikelyCause {
        cause: Cause::OpenRim,
        confidence: Confidence::Medium,
        place: Where { text: format!("{}, contact `{label}`", node.text), pair: Some(label.clone()), ..node },
        sentence: format!(
            "nodes of `{slave}` open and close at the rim of `{master}`: beside the rim they have no gap, on it they are closed, so that contact jumps there"
        ),
        evidence: vec![format!(
            "{} of the {} nodes that opened or closed in the last attempts are within {} edges of the rim",
            nodes.len(),
            changing.len(),
            toml::plain(AT_RIM)
        )],
        remedies,
    })
}

/// Edges that one facet of a surface has alone.
fn rim(facets: &[FacetNodes]) -> Vec<[u32; 2]> {
    let mut count: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for facet in facets {
        let nodes: Vec<u32> = facet.iter().copied().collect();
        for k in 0..nodes.len() {
            let (a, b) = (nodes[k], nodes[(k + 1) % nodes.len()]);
            *count.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    count.into_iter().filter(|(_, count)| *count == 1).map(|(edge, _)| edge).collect()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Distance of a point from an edge.
fn from_edge(x: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let along: f64 = (0..3).map(|i| (x[i] - a[i]) * (b[i] - a[i])).sum();
    let part = (along / distance(a, b).powi(2).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    distance(x, std::array::from_fn(|i| a[i] + part * (b[i] - a[i])))
}
