//! `*BOUNDARY` to `[[prescribe]]`.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh_io::deck::{DeckBoundary, DeckPlace, Prescribed};

use crate::axes::{Direction, LocalAxes};
use crate::context::Context;
use crate::history::{History, Value, amplitude, by_history, parts};
use crate::records::{DeckLine, StageRecords, members_by_records};
use crate::sets::{Selection, named};
use crate::severity::Severity;
use crate::text::{count, text, vector};
use crate::write::series;

const AXES: [&str; 3] = ["x", "y", "z"];

/// A prescription of some nodes: along the components of space, or along a direction.
type Group = (History, Direction, Vec<u32>, BTreeSet<u32>);

/// Adds all supports.
pub(crate) fn supports(context: &mut Context<'_>) {
    context.supports();
}

/// Whether a direction is not a coordinate axis.
fn is_inclined(normal: [f64; 3]) -> bool {
    normal.iter().filter(|&&entry| entry != 0.0).count() > 1
}

impl Context<'_> {
    /// Takes the nodes for whose components the axes are not known out of what a line means; an entry if there are some.
    pub(crate) fn drop_unknown_axes(
        &mut self,
        nodes: &mut Selection<u32>,
        components: [bool; 3],
        keyword: &str,
        place: DeckPlace,
    ) {
        let before = nodes.members.len();
        nodes.members.retain(|&node| !self.axes.are_unknown(node, components));
        let out = before - nodes.members.len();
        if out > 0 {
            nodes.name = None;
            let consequence = format!(
                "it does not act on {} whose *TRANSFORM gives no such axes there: its type is not read, or the node lies on the line of cylindrical axes",
                count(out, "node", "nodes")
            );
            let remedy = "write [[prescribe]] or [[load]] for these nodes";
            self.list.add(Severity::Missing, place, keyword, consequence, remedy);
        }
    }

    /// The nodes of a line, and what it prescribes there; nothing, with an entry, if it does not act.
    fn record(&mut self, support: &DeckBoundary) -> Option<(Selection<u32>, Value)> {
        let place = support.place;
        let mut nodes = self.lookup.nodes(&support.nodes);
        let components: [bool; 3] = std::array::from_fn(|i| support.freedoms[i]);
        let is_of_references = !self.references.of(&support.nodes).is_empty();
        if is_of_references && !nodes.members.iter().any(|node| self.bodies.owner(*node).is_some()) {
            return None;
        }
        if let Some(turn) = (3..6).find(|&i| support.freedoms[i]).filter(|_| components == [false; 3]) {
            self.list.add_unread(place, format!("degree of freedom {} of *BOUNDARY", turn + 1));
            return None;
        }
        if !nodes.members.iter().any(|node| self.bodies.owner(*node).is_some()) {
            let consequence = format!("{} has no node of a body: nothing is prescribed", text(&support.nodes));
            let remedy = "if it is a reference node, see [[coupling]] and [[joint]]";
            self.list.add(Severity::Missing, place, "*BOUNDARY", consequence, remedy);
            return None;
        }
        let outside = self.nodes_outside(&nodes, &support.nodes);
        if outside > 0 {
            let consequence = format!(
                "{} of {} in no body: nothing is prescribed there",
                count(outside, "node", "nodes"),
                text(&support.nodes)
            );
            self.list.add(Severity::Note, place, "*BOUNDARY", consequence, "");
        }
        let is_zero = support.value == 0.0;
        // Of a node that is held in all directions the axes do not matter.
        if !(is_zero && components == [true; 3]) {
            self.drop_unknown_axes(&mut nodes, components, "*BOUNDARY", place);
        }
        Some((nodes, self.prescribed(support)?))
    }

    /// What a line prescribes over time; nothing, with an entry, if that does not map.
    pub(crate) fn prescribed(&mut self, support: &DeckBoundary) -> Option<Value> {
        let (place, is_zero) = (support.place, support.value == 0.0);
        let amplitude = match &support.amplitude {
            // Any multiple of zero is zero.
            Some(name) if is_zero => amplitude(self.deck, name),
            name => self.amplitude(name.as_ref(), "*BOUNDARY", place, "the displacement is not prescribed")?,
        };
        let at_rest = Value { value: 0.0, amplitude: None, is_rate: true };
        let value = match support.prescribed {
            Prescribed::Displacement => Value { value: support.value, amplitude, is_rate: false },
            Prescribed::Fixed => at_rest,
            Prescribed::Velocity | Prescribed::Acceleration if is_zero => at_rest,
            Prescribed::Velocity if amplitude.is_none() => Value { value: support.value, ..at_rest },
            Prescribed::Velocity | Prescribed::Acceleration => {
                let what = if support.prescribed == Prescribed::Velocity {
                    "a velocity with an amplitude"
                } else {
                    "an acceleration"
                };
                let consequence = format!("{what} is not prescribed: the nodes are free");
                let remedy = "prescribe the displacement over time: an amplitude with a table of times and values";
                self.list.add(Severity::Missing, place, "*BOUNDARY", consequence, remedy);
                return None;
            }
        };
        Some(value)
    }

    fn supports(&mut self) {
        let deck = self.deck;
        let of_model = deck.supports.iter().map(|support| (None, support));
        let of_steps =
            deck.steps.iter().enumerate().flat_map(|(s, step)| step.supports.iter().map(move |x| (Some(s), x)));
        let mut selections: Vec<Selection<u32>> = Vec::new();
        let mut places = Vec::new();
        let mut values = Vec::new();
        let mut lines: [Vec<DeckLine<u32>>; 3] = Default::default();
        for (step, support) in of_model.chain(of_steps) {
            let Some((nodes, value)) = self.record(support) else { continue };
            let across = if self.section.is_some() { 2 } else { 3 };
            for component in (0..across).filter(|&i| support.freedoms[i]) {
                let members = nodes.members.clone();
                lines[component].push(DeckLine { step, record: values.len() as u32, members });
            }
            selections.push(nodes);
            places.push(support.place);
            values.push(value);
        }
        let of_components = lines.map(|lines| {
            let replaces_all = |s: usize| deck.steps[s].op_new.supports;
            let groups = members_by_records(&lines, deck.steps.len(), replaces_all, self.timeline, false);
            let mut all: BTreeMap<StageRecords, Vec<u32>> = BTreeMap::new();
            for (by_stage, nodes) in groups {
                parts(&by_stage, &values).into_iter().for_each(|part| all.entry(part).or_default().extend(&nodes));
            }
            by_history(all, &values, self.timeline, false)
        });
        let whole = held_in_all_directions(&of_components, self.axes);
        // By set and stages: the displacement of each component.
        let mut found: BTreeMap<(usize, String, Vec<bool>, Option<u64>), [Option<History>; 3]> = BTreeMap::new();
        let mut order = Vec::new();
        let mut along_normals = Vec::new();
        for (component, histories) in of_components.into_iter().enumerate() {
            let axes = self.axes;
            let groups = histories.into_iter().flat_map(|(own, nodes, records)| -> Vec<Group> {
                let (in_space, others): (Vec<u32>, Vec<u32>) =
                    nodes.iter().copied().partition(|node| !axes.has(*node) || own.is_zero() && whole.contains(node));
                let others = axes.by_direction(&others, component);
                let all = std::iter::once((None, in_space)).chain(others).filter(|(_, nodes)| !nodes.is_empty());
                all.map(|(direction, nodes)| (own.clone(), direction, nodes, records.clone())).collect()
            });
            for (own, direction, nodes, records) in groups {
                if let (Some(normal), Some(_)) = (direction, own.ramp_until)
                    && is_inclined(normal)
                {
                    let place = records.first().map_or(places[0], |&record| places[record as usize]);
                    let consequence = "it begins in a later step along an inclined axis of a *TRANSFORM: it does not begin where the nodes are, but takes them to its value in the first increment";
                    let remedy = "let it begin in the first step, or turn the mesh so that the axis is x, y or z";
                    self.list.add(Severity::Changed, place, "*BOUNDARY", consequence, remedy);
                }
                for (b, body) in self.bodies.all.iter().enumerate() {
                    let wanted: BTreeSet<u32> =
                        nodes.iter().copied().filter(|node| body.nodes.contains(node)).collect();
                    if wanted.is_empty() {
                        continue;
                    }
                    for set in self.sets.nodes(b, &wanted, &named(&selections, &records), "support") {
                        if let Some(normal) = direction {
                            along_normals.push((set, normal, own.clone()));
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
                self.scene.prescribe(set, &along, &displacement(&own), active, own[0].ramp_until);
            }
        }
        for (set, normal, own) in along_normals {
            let along = format!("normal = {}", vector(normal));
            let ramp_until = own.ramp_until.filter(|_| !is_inclined(normal));
            self.scene.prescribe(&set, &along, &displacement(&[&own]), &own.active, ramp_until);
        }
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
