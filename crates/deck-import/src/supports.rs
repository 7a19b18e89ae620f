//! `*BOUNDARY` to `[[prescribe]]`.
//!
//! Supports in axes of their own (`*TRANSFORM`) are left out in [`local`], which is the place for them once a scene can say them.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh_io::deck::{Deck, DeckPlace, Prescribed, Support};

use crate::bodies::Bodies;
use crate::cover::Cover;
use crate::history::{History, Value, amplitude, history};
use crate::left_out::List;
use crate::records::{Acting, Chain, chains};
use crate::sets::{Lookup, Meant};
use crate::text::text;
use crate::timeline::Timeline;
use crate::write::{Tables, series};

const AXES: [&str; 3] = ["x", "y", "z"];

/// Nodes that have axes of their own.
pub(crate) fn local(deck: &Deck, lookup: &Lookup<'_>) -> BTreeSet<u32> {
    deck.local_axes.iter().filter_map(|axes| lookup.node_set(&axes.nodes)).flat_map(|nodes| nodes.members).collect()
}

/// Takes the nodes with axes of their own out of what a line means, and tells of it.
pub(crate) fn without_local(
    meant: &mut Meant<u32>,
    local: &BTreeSet<u32>,
    what: &str,
    place: DeckPlace,
    list: &mut List,
) {
    let before = meant.members.len();
    meant.members.retain(|node| !local.contains(node));
    let out = before - meant.members.len();
    if out > 0 {
        meant.name = None;
        list.add(
            place,
            what,
            format!("it has the axes of a *TRANSFORM at {out} nodes, and does not act on them"),
            "turn the mesh so that the axes are x, y and z, or write it by hand",
        );
    }
}

/// One record for each line that acts.
fn record(
    deck: &Deck,
    support: &Support,
    bodies: &Bodies,
    lookup: &Lookup<'_>,
    local: &BTreeSet<u32>,
    list: &mut List,
) -> Option<(Meant<u32>, Value)> {
    let mut meant = lookup.nodes(&support.nodes);
    if !meant.members.iter().any(|node| bodies.owner(*node).is_some()) {
        list.add(
            support.place,
            "*BOUNDARY",
            format!("{} has no node of a body", text(&support.nodes)),
            "if it is a reference node, see [[joint]] and `rotation` of [[prescribe]]",
        );
        return None;
    }
    let is_whole = support.components == [true; 3] && support.value == 0.0;
    if !is_whole {
        without_local(&mut meant, local, "*BOUNDARY", support.place, list);
    }
    let scale = match &support.amplitude {
        None => None,
        Some(name) => match amplitude(deck, name) {
            Some(index) => Some(index),
            None if support.value == 0.0 => None,
            None => {
                let consequence =
                    format!("there is no amplitude {name} that is read: the displacement is not prescribed");
                list.add(support.place, "*BOUNDARY", consequence, "give it a table of times and values");
                return None;
            }
        },
    };
    let is_rate = match support.prescribed {
        Prescribed::Displacement => false,
        // At rest is at rest.
        _ if support.value == 0.0 => false,
        Prescribed::Velocity if scale.is_none() => true,
        _ => {
            let consequence = "an acceleration, or a velocity with an amplitude, is not prescribed: the nodes are free";
            list.add(support.place, "*BOUNDARY", consequence, "give displacements, as a table of times and values");
            return None;
        }
    };
    Some((meant, Value { value: support.value, amplitude: scale, is_rate }))
}

/// Adds all supports.
pub(crate) fn supports(
    deck: &Deck,
    bodies: &Bodies,
    lookup: &Lookup<'_>,
    timeline: &Timeline,
    cover: &mut Cover<'_>,
    scene: &mut Tables,
    list: &mut List,
) {
    let local = local(deck, lookup);
    let of_model = deck.supports.iter().map(|support| (None, support));
    let of_steps = deck.steps.iter().enumerate().flat_map(|(s, step)| step.supports.iter().map(move |x| (Some(s), x)));
    let mut meant: Vec<Meant<u32>> = Vec::new();
    let mut values = Vec::new();
    let mut acting: [Vec<Acting<u32>>; 3] = Default::default();
    for (step, support) in of_model.chain(of_steps) {
        let Some((nodes, value)) = record(deck, support, bodies, lookup, &local, list) else { continue };
        for component in (0..3).filter(|&i| support.components[i]) {
            acting[component].push(Acting { step, record: values.len() as u32, members: nodes.members.clone() });
        }
        meant.push(nodes);
        values.push(value);
    }
    // By set and stages: the displacement of each component.
    let mut found: BTreeMap<(usize, String, Vec<bool>), [Option<History>; 3]> = BTreeMap::new();
    let mut order = Vec::new();
    for (component, acting) in acting.iter().enumerate() {
        let chains = chains(acting, deck.steps.len(), |s| deck.steps[s].ends.supports, timeline, false);
        for (own, nodes, records) in by_history(chains, &values, timeline, deck, false) {
            for (b, body) in bodies.all.iter().enumerate() {
                let wanted: BTreeSet<u32> = nodes.iter().copied().filter(|node| body.nodes.contains(node)).collect();
                if wanted.is_empty() {
                    continue;
                }
                for set in cover.nodes(b, &wanted, &named(&meant, &records), "support") {
                    let key = (b, set, own.active.clone());
                    let entry = found.entry(key.clone()).or_insert_with(|| {
                        order.push(key);
                        Default::default()
                    });
                    entry[component] = Some(own.clone());
                }
            }
        }
    }
    for key in order {
        let (_, set, active) = &key;
        let components = &found[&key];
        let is_fixed = |i: &usize| components[*i].as_ref().is_some_and(History::is_zero);
        let fixed: Vec<usize> = (0..3).filter(is_fixed).collect();
        let moved: Vec<usize> = (0..3).filter(|i| components[*i].is_some() && !is_fixed(i)).collect();
        for chosen in [fixed, moved].iter().filter(|chosen| !chosen.is_empty()) {
            let own: Vec<&History> = chosen.iter().filter_map(|&i| components[i].as_ref()).collect();
            let names: Vec<String> = chosen.iter().map(|&i| format!("\"{}\"", AXES[i])).collect();
            let value = if own.iter().all(|history| history.is_zero()) {
                "fixed = true".to_owned()
            } else {
                format!("displacement = {}", series(&own))
            };
            scene.prescribe(set, &names.join(", "), &value, active);
        }
    }
}

/// The named sets of some records.
pub(crate) fn named<'m, T>(meant: &'m [Meant<T>], records: &BTreeSet<u32>) -> Vec<(&'m str, &'m [T])> {
    let own = records.iter().map(|&record| &meant[record as usize]);
    own.filter_map(|meant| Some((meant.name.as_deref()?, meant.members.as_slice()))).collect()
}

/// Members with the same history together, with the records that it is made of. In the order of the first record.
pub(crate) fn by_history<T: Copy + Ord>(
    chains: BTreeMap<Chain, Vec<T>>,
    values: &[Value],
    timeline: &Timeline,
    deck: &Deck,
    is_load: bool,
) -> Vec<(History, Vec<T>, BTreeSet<u32>)> {
    let mut all: BTreeMap<_, (History, Vec<T>, BTreeSet<u32>)> = BTreeMap::new();
    for (chain, members) in chains {
        let own = history(&chain, values, timeline, deck, is_load);
        let entry = all.entry(own.key()).or_insert_with(|| (own, Vec::new(), BTreeSet::new()));
        entry.1.extend(members);
        entry.2.extend(chain.into_iter().flatten());
    }
    let mut all: Vec<_> = all.into_values().collect();
    all.sort_by_key(|(_, _, records)| records.first().copied());
    all
}
