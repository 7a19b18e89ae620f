//! `*BOUNDARY` to `[[prescribe]]`.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh_io::deck::{Deck, DeckPlace, Prescribed, Support};

use crate::axes::{Direction, LocalAxes};
use crate::bodies::Bodies;
use crate::cover::Cover;
use crate::history::{History, Value, amplitude, history, parts};
use crate::left_out::List;
use crate::records::{Acting, Chain, chains};
use crate::sets::{Lookup, Meant};
use crate::text::{text, vector};
use crate::timeline::Timeline;
use crate::write::{Tables, series};

const AXES: [&str; 3] = ["x", "y", "z"];

/// Takes the nodes whose axes are not known out of what a line means, and tells of it.
pub(crate) fn without_unknown(meant: &mut Meant<u32>, axes: &LocalAxes, what: &str, place: DeckPlace, list: &mut List) {
    let before = meant.members.len();
    meant.members.retain(|&node| !axes.are_unknown(node));
    let out = before - meant.members.len();
    if out > 0 {
        meant.name = None;
        list.add(
            place,
            what,
            format!("it does not act on {out} nodes: the axes of their *TRANSFORM are not known there (on the line of cylindrical axes, or another type)"),
            "write it by hand",
        );
    }
}

/// One record for each line that acts.
fn record(
    deck: &Deck,
    support: &Support,
    bodies: &Bodies,
    lookup: &Lookup<'_>,
    axes: &LocalAxes,
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
        without_unknown(&mut meant, axes, "*BOUNDARY", support.place, list);
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
    let value = match support.prescribed {
        Prescribed::Displacement => Value { value: support.value, amplitude: scale, is_rate: false },
        // At rest is at rest.
        Prescribed::Place => Value { value: 0.0, amplitude: None, is_rate: true },
        _ if support.value == 0.0 => Value { value: 0.0, amplitude: None, is_rate: true },
        Prescribed::Velocity if scale.is_none() => Value { value: support.value, amplitude: None, is_rate: true },
        _ => {
            let consequence = "an acceleration, or a velocity with an amplitude, is not prescribed: the nodes are free";
            list.add(support.place, "*BOUNDARY", consequence, "give displacements, as a table of times and values");
            return None;
        }
    };
    Some((meant, value))
}

/// A prescription of some nodes: along the components of space, or along a direction.
type Group = (History, Direction, Vec<u32>, BTreeSet<u32>);

/// Adds all supports.
pub(crate) fn supports(
    deck: &Deck,
    bodies: &Bodies,
    lookup: &Lookup<'_>,
    timeline: &Timeline,
    axes: &LocalAxes,
    cover: &mut Cover<'_>,
    scene: &mut Tables,
    list: &mut List,
) {
    let of_model = deck.supports.iter().map(|support| (None, support));
    let of_steps = deck.steps.iter().enumerate().flat_map(|(s, step)| step.supports.iter().map(move |x| (Some(s), x)));
    let mut meant: Vec<Meant<u32>> = Vec::new();
    let mut places = Vec::new();
    let mut values = Vec::new();
    let mut acting: [Vec<Acting<u32>>; 3] = Default::default();
    for (step, support) in of_model.chain(of_steps) {
        let Some((nodes, value)) = record(deck, support, bodies, lookup, axes, list) else { continue };
        for component in (0..3).filter(|&i| support.components[i]) {
            acting[component].push(Acting { step, record: values.len() as u32, members: nodes.members.clone() });
        }
        meant.push(nodes);
        places.push(support.place);
        values.push(value);
    }
    let of_components = acting.map(|acting| {
        let chains = chains(&acting, deck.steps.len(), |s| deck.steps[s].ends.supports, timeline, false);
        let mut all: BTreeMap<Chain, Vec<u32>> = BTreeMap::new();
        for (chain, nodes) in chains {
            parts(&chain, &values).into_iter().for_each(|part| all.entry(part).or_default().extend(&nodes));
        }
        by_history(all, &values, timeline, deck, false)
    });
    let whole = held_in_all_directions(&of_components, axes);
    // By set and stages: the displacement of each component.
    let mut found: BTreeMap<(usize, String, Vec<bool>, Option<u64>), [Option<History>; 3]> = BTreeMap::new();
    let mut order = Vec::new();
    let mut inclined = Vec::new();
    for (component, histories) in of_components.into_iter().enumerate() {
        let groups = histories.into_iter().flat_map(|(own, nodes, records)| -> Vec<Group> {
            let (whole, others): (Vec<u32>, Vec<u32>) =
                nodes.iter().copied().partition(|node| !axes.has(*node) || own.is_zero() && whole.contains(node));
            let others = axes.by_direction(&others, component);
            let all = std::iter::once((None, whole)).chain(others).filter(|(_, nodes)| !nodes.is_empty());
            all.map(|(direction, nodes)| (own.clone(), direction, nodes, records.clone())).collect()
        });
        for (own, direction, nodes, records) in groups {
            if let (Some(normal), Some(_)) = (direction, own.ramp_until)
                && normal.iter().filter(|&&entry| entry != 0.0).count() > 1
            {
                let place = records.first().map_or(places[0], |&record| places[record as usize]);
                let consequence = "it begins in a later step along an inclined axis of a *TRANSFORM, and is there after one increment: it does not begin where the nodes are";
                let remedy = "let it begin in the first step, or turn the mesh so that the axis is x, y or z";
                list.add(place, "*BOUNDARY", consequence, remedy);
            }
            for (b, body) in bodies.all.iter().enumerate() {
                let wanted: BTreeSet<u32> = nodes.iter().copied().filter(|node| body.nodes.contains(node)).collect();
                if wanted.is_empty() {
                    continue;
                }
                for set in cover.nodes(b, &wanted, &named(&meant, &records), "support") {
                    if let Some(normal) = direction {
                        inclined.push((set, normal, own.clone()));
                        continue;
                    }
                    let key = (b, set, own.active.clone(), own.ramp_until.map(f64::to_bits));
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
        let (_, set, active, _) = &key;
        let components = &found[&key];
        let is_fixed = |i: &usize| components[*i].as_ref().is_some_and(History::is_zero);
        let fixed: Vec<usize> = (0..3).filter(is_fixed).collect();
        let moved: Vec<usize> = (0..3).filter(|i| components[*i].is_some() && !is_fixed(i)).collect();
        for chosen in [fixed, moved].iter().filter(|chosen| !chosen.is_empty()) {
            let own: Vec<&History> = chosen.iter().filter_map(|&i| components[i].as_ref()).collect();
            let names: Vec<String> = chosen.iter().map(|&i| format!("\"{}\"", AXES[i])).collect();
            let along = format!("components = [{}]", names.join(", "));
            scene.prescribe(set, &along, &displacement(&own), active, own[0].ramp_until);
        }
    }
    for (set, normal, own) in inclined {
        let is_inclined = normal.iter().filter(|&&entry| entry != 0.0).count() > 1;
        let along = format!("normal = {}", vector(normal));
        scene.prescribe(&set, &along, &displacement(&[&own]), &own.active, own.ramp_until.filter(|_| !is_inclined));
    }
}

fn displacement(own: &[&History]) -> String {
    if own.iter().all(|history| history.is_zero()) {
        "fixed = true".to_owned()
    } else {
        format!("displacement = {}", series(own))
    }
}

/// Nodes with axes of their own of which all three components are zero at the same times: the axes do not matter.
fn held_in_all_directions(
    of_components: &[Vec<(History, Vec<u32>, BTreeSet<u32>)>; 3],
    axes: &LocalAxes,
) -> BTreeSet<u32> {
    let mut keys: BTreeMap<u32, Vec<(usize, &History)>> = BTreeMap::new();
    for (component, histories) in of_components.iter().enumerate() {
        for (own, nodes, _) in histories {
            nodes.iter().filter(|node| axes.has(**node)).for_each(|&node| {
                keys.entry(node).or_default().push((component, own));
            });
        }
    }
    let is_whole = |own: &[(usize, &History)]| {
        let components: Vec<usize> = own.iter().map(|(component, _)| *component).collect();
        components == [0, 1, 2] && own.iter().all(|(_, history)| history.is_zero() && history.key() == own[0].1.key())
    };
    keys.into_iter().filter(|(_, own)| is_whole(own)).map(|(node, _)| node).collect()
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
