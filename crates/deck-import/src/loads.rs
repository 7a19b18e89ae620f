//! `*CLOAD`, `*DLOAD`, `*DSLOAD` to `[[load]]`.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh::Facet;
use stoss_mesh_io::deck::{Deck, DeckPlace, ElementLoad, Ends, LoadKind, Target};

use crate::axes::LocalAxes;
use crate::bodies::Bodies;
use crate::cover::Cover;
use crate::history::{History, Value, amplitude, history};
use crate::left_out::List;
use crate::records::{Acting, chains};
use crate::sets::{Lookup, Meant};
use crate::supports::{by_history, named, without_unknown};
use crate::text::{number, text, vector};
use crate::timeline::Timeline;
use crate::write::{Tables, series};

/// What all loads need.
struct Loads<'a, 'b> {
    deck: &'a Deck,
    bodies: &'a Bodies,
    lookup: &'a Lookup<'a>,
    timeline: &'a Timeline,
    axes: &'a LocalAxes,
    cover: &'a mut Cover<'b>,
    scene: &'a mut Tables,
    list: &'a mut List,
}

/// Points of the square root of a ramp.
const ROOT: usize = 16;

/// Adds all loads.
pub(crate) fn loads(
    deck: &Deck,
    bodies: &Bodies,
    lookup: &Lookup<'_>,
    timeline: &Timeline,
    axes: &LocalAxes,
    cover: &mut Cover<'_>,
    scene: &mut Tables,
    list: &mut List,
) {
    let mut loads = Loads { deck, bodies, lookup, timeline, axes, cover, scene, list };
    loads.forces();
    loads.face_pressures();
    loads.surface_pressures();
    loads.of_bodies();
}

impl Loads<'_, '_> {
    /// The amplitude of a load; nothing, with an entry, if it cannot act.
    fn amplitude(&mut self, name: Option<&String>, place: DeckPlace, what: &str) -> Option<Option<usize>> {
        let Some(name) = name else { return Some(None) };
        let found = amplitude(self.deck, name);
        if found.is_none() {
            let consequence = format!("there is no amplitude {name} that is read: the load does not act");
            self.list.add(place, what, consequence, "give it a table of times and values");
        }
        found.map(Some)
    }

    fn forces(&mut self) {
        let mut meant = Vec::new();
        let mut values = Vec::new();
        let mut acting: [Vec<Acting<u32>>; 3] = Default::default();
        for (s, step) in self.deck.steps.iter().enumerate() {
            for force in &step.forces {
                let Some(scale) = self.amplitude(force.amplitude.as_ref(), force.place, "*CLOAD") else { continue };
                let mut nodes = self.lookup.nodes(&force.nodes);
                if !nodes.members.iter().any(|node| self.bodies.owner(*node).is_some()) {
                    let consequence = format!("{} has no node of a body: the force does not act", text(&force.nodes));
                    self.list.add(
                        force.place,
                        "*CLOAD",
                        consequence,
                        "if it is a reference node, see [[joint]] and `moment` of [[load]]",
                    );
                    continue;
                }
                without_unknown(&mut nodes, self.axes, "*CLOAD", force.place, self.list);
                acting[force.component].push(Acting {
                    step: Some(s),
                    record: values.len() as u32,
                    members: nodes.members.clone(),
                });
                meant.push(nodes);
                values.push(Value { value: force.value, amplitude: scale, is_rate: false });
            }
        }
        let mut found: BTreeMap<String, [Option<History>; 3]> = BTreeMap::new();
        let mut order = Vec::new();
        let mut inclined = Vec::new();
        for (component, acting) in acting.iter().enumerate() {
            let ends = |s: usize| self.deck.steps[s].ends.forces;
            let chains = chains(acting, self.deck.steps.len(), ends, self.timeline, true);
            for (own, nodes, records) in by_history(chains, &values, self.timeline, self.deck, true) {
                if own.is_zero() {
                    continue;
                }
                let all = self.axes.by_direction(&nodes, component);
                let of_bodies = all.iter().flat_map(|group| (0..self.bodies.all.len()).map(move |b| (b, group)));
                for (b, (direction, nodes)) in of_bodies {
                    let of = |node: &u32| self.bodies.owner(*node) == Some(b);
                    let wanted: BTreeSet<u32> = nodes.iter().copied().filter(of).collect();
                    if wanted.is_empty() {
                        continue;
                    }
                    for set in self.cover.nodes(b, &wanted, &named(&meant, &records), "loaded") {
                        if let Some(direction) = direction {
                            inclined.push((set, direction.map(|entry| own.times(entry))));
                            continue;
                        }
                        let entry = found.entry(set.clone()).or_insert_with(|| {
                            order.push(set);
                            Default::default()
                        });
                        entry[component] = Some(own.clone());
                    }
                }
            }
        }
        let none = History::none();
        for set in order {
            let own: Vec<&History> = found[&set].iter().map(|history| history.as_ref().unwrap_or(&none)).collect();
            self.scene.load("set", &set, &format!("force = {}", series(&own)));
        }
        for (set, own) in inclined {
            self.scene.load("set", &set, &format!("force = {}", series(&own.each_ref())));
        }
    }

    /// Pressures on faces of elements.
    fn face_pressures(&mut self) {
        let mut meant = Vec::new();
        let mut values = Vec::new();
        let mut acting = Vec::new();
        for (s, step) in self.deck.steps.iter().enumerate() {
            for load in &step.loads {
                let LoadKind::Pressure { face, value } = load.kind else { continue };
                let Some(scale) = self.amplitude(load.amplitude.as_ref(), load.place, "*DLOAD") else { continue };
                let elements = self.of_bodies_only(load);
                let mesh = self.cover.mesh();
                let has_face = |e: &u32| face < mesh.elements.kind(*e as usize).faces().len();
                let members: Vec<Facet> =
                    elements.iter().filter(|e| has_face(e)).map(|&e| mesh.facet(e, face)).collect();
                if members.len() < elements.len() {
                    let consequence = format!("{} elements have no face P{}", elements.len() - members.len(), face + 1);
                    self.list.add(load.place, "*DLOAD", consequence, "name a face that they have");
                }
                self.pressure(
                    Some(s),
                    members,
                    None,
                    Value { value, amplitude: scale, is_rate: false },
                    load.place,
                    "*DLOAD",
                    (&mut meant, &mut values, &mut acting),
                );
            }
        }
        self.write_pressures(&meant, &values, &acting, |ends| ends.loads);
    }

    /// Pressures on surfaces.
    fn surface_pressures(&mut self) {
        let mut meant = Vec::new();
        let mut values = Vec::new();
        let mut acting = Vec::new();
        for (s, step) in self.deck.steps.iter().enumerate() {
            for load in &step.pressures {
                let Some(scale) = self.amplitude(load.amplitude.as_ref(), load.place, "*DSLOAD") else { continue };
                let Some((surface, _)) = self.lookup.surface(&load.surface) else {
                    let consequence = format!("there is no surface {}: the pressure does not act", load.surface);
                    self.list.add(load.place, "*DSLOAD", consequence, "name one of solid elements");
                    continue;
                };
                let value = Value { value: load.value, amplitude: scale, is_rate: false };
                self.pressure(
                    Some(s),
                    surface.members,
                    surface.name,
                    value,
                    load.place,
                    "*DSLOAD",
                    (&mut meant, &mut values, &mut acting),
                );
            }
        }
        self.write_pressures(&meant, &values, &acting, |ends| ends.pressures);
    }

    /// Keeps a pressure on those facets that have an outside.
    fn pressure(
        &mut self,
        step: Option<usize>,
        facets: Vec<Facet>,
        name: Option<String>,
        value: Value,
        place: DeckPlace,
        what: &str,
        (meant, values, acting): (&mut Vec<Meant<Facet>>, &mut Vec<Value>, &mut Vec<Acting<Facet>>),
    ) {
        let outside = |facet: &Facet| self.bodies.of_element(facet.element).is_some() && !self.bodies.is_inner(facet);
        let members: Vec<Facet> = facets.iter().copied().filter(outside).collect();
        if members.len() < facets.len() {
            let consequence = format!(
                "{} faces lie inside of a body, or belong to none: no pressure acts on them",
                facets.len() - members.len()
            );
            self.list.add(place, what, consequence, "");
        }
        let name = name.filter(|_| members.len() == facets.len());
        acting.push(Acting { step, record: values.len() as u32, members: members.clone() });
        meant.push(Meant { name, members });
        values.push(value);
    }

    fn write_pressures(
        &mut self,
        meant: &[Meant<Facet>],
        values: &[Value],
        acting: &[Acting<Facet>],
        ends: fn(&Ends) -> bool,
    ) {
        let of = |s: usize| ends(&self.deck.steps[s].ends);
        let chains = chains(acting, self.deck.steps.len(), of, self.timeline, true);
        for (own, facets, records) in by_history(chains, values, self.timeline, self.deck, true) {
            if own.is_zero() {
                continue;
            }
            let follows =
                self.timeline.stages.iter().zip(&own.active).any(|(stage, active)| *active && stage.is_nonlinear);
            let kind = if follows { "follower_pressure" } else { "pressure" };
            for b in 0..self.bodies.all.len() {
                let wanted = facets.iter().copied().filter(|facet| self.bodies.of_element(facet.element) == Some(b));
                let wanted: BTreeSet<Facet> = wanted.collect();
                if wanted.is_empty() {
                    continue;
                }
                for set in self.cover.facets(b, &wanted, &named(meant, &records), "pressed") {
                    self.scene.load("set", &set, &format!("{kind} = {}", series(&[&own])));
                }
            }
        }
    }

    /// The elements of a load that belong to bodies.
    fn of_bodies_only(&mut self, load: &ElementLoad) -> Vec<u32> {
        let mut elements = self.lookup.elements(&load.elements).members;
        elements.retain(|&e| self.bodies.of_element(e).is_some());
        if elements.is_empty() {
            let consequence = format!("{} has no element of a body: the load does not act", text(&load.elements));
            self.list.add(load.place, "*DLOAD", consequence, "");
        }
        elements
    }

    /// Gravity, forces per volume and centrifugal forces.
    fn of_bodies(&mut self) {
        for (s, step) in self.deck.steps.iter().enumerate() {
            for load in &step.loads {
                if matches!(load.kind, LoadKind::Pressure { .. }) {
                    continue;
                }
                self.partial(s, load);
            }
        }
        for b in 0..self.bodies.all.len() {
            self.of_body(b);
        }
    }

    /// Tells of a load on a part of a body.
    fn partial(&mut self, _step: usize, load: &ElementLoad) {
        let elements: BTreeSet<u32> = self.of_bodies_only(load).into_iter().collect();
        for body in &self.bodies.all {
            let count = body.elements.iter().filter(|e| elements.contains(e)).count();
            if count > 0 && count < body.elements.len() {
                let consequence = format!(
                    "it acts on {count} of {} elements of body {}, and a scene loads whole bodies: it does not act",
                    body.elements.len(),
                    body.name
                );
                self.list.add(load.place, "*DLOAD", consequence, "give these elements a material of their own");
            }
        }
    }

    fn of_body(&mut self, b: usize) {
        let body = &self.bodies.all[b];
        let mut loads: Vec<(usize, &ElementLoad)> = Vec::new();
        for (s, step) in self.deck.steps.iter().enumerate() {
            for load in &step.loads {
                let elements = match &load.elements {
                    Target::All => None,
                    target => Some(self.lookup.elements(target).members),
                };
                let is_whole = elements.is_none_or(|own| body.elements.iter().all(|e| own.binary_search(e).is_ok()));
                if is_whole && !matches!(load.kind, LoadKind::Pressure { .. }) {
                    loads.push((s, load));
                }
            }
        }
        // By kind: the value of each component.
        let acceleration = self.vector_load(&loads, |kind| match kind {
            LoadKind::Gravity { magnitude, direction } => {
                let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
                Some(direction.map(|d| (length > 0.0).then(|| magnitude * d / length)))
            }
            _ => None,
        });
        let force = self.vector_load(&loads, |kind| match kind {
            LoadKind::Body { component, value } => {
                let mut force = [None; 3];
                force[*component] = Some(*value);
                Some(force)
            }
            _ => None,
        });
        let name = body.name.clone();
        if let Some(value) = acceleration {
            if body.density.is_none() {
                let what = format!("gravity of body {name}");
                self.list.add_general(what, "its material has no *DENSITY: it has no weight", "give it a density");
            } else {
                self.scene.load("body", &name, &format!("acceleration = {value}"));
            }
        }
        if let Some(value) = force {
            self.scene.load("body", &name, &format!("body_force = {value}"));
        }
        self.rotation(b, &loads);
    }

    /// The sum of the loads of a kind on a body over time; nothing if there are none.
    fn vector_load(
        &mut self,
        loads: &[(usize, &ElementLoad)],
        value: impl Fn(&LoadKind) -> Option<[Option<f64>; 3]>,
    ) -> Option<String> {
        let mut values: [Vec<Value>; 3] = Default::default();
        // A component that a load says nothing of stays what it was.
        let mut acting: [Vec<Acting<u32>>; 3] = Default::default();
        for (s, load) in loads {
            let Some(vector) = value(&load.kind) else { continue };
            if vector == [None; 3] {
                self.list.add(
                    load.place,
                    "*DLOAD",
                    "it has no direction: it does not act",
                    "give its three components",
                );
                continue;
            }
            let Some(scale) = self.amplitude(load.amplitude.as_ref(), load.place, "*DLOAD") else { continue };
            for ((values, acting), value) in values.iter_mut().zip(&mut acting).zip(vector) {
                if let Some(value) = value {
                    acting.push(Acting { step: Some(*s), record: values.len() as u32, members: vec![0_u32] });
                    values.push(Value { value, amplitude: scale, is_rate: false });
                }
            }
        }
        let ends = |s: usize| self.deck.steps[s].ends.loads;
        let own = [0, 1, 2].map(|axis| {
            let chain = chains(&acting[axis], self.deck.steps.len(), ends, self.timeline, true).pop_first();
            chain.map(|(chain, _)| history(&chain, &values[axis], self.timeline, self.deck, true))
        });
        let none = History::none();
        let own = own.map(|history| history.unwrap_or_else(|| none.clone()));
        let own: Vec<&History> = own.iter().collect();
        if own.iter().all(|history| history.is_zero()) { None } else { Some(series(&own)) }
    }

    /// Centrifugal forces: of one axis.
    fn rotation(&mut self, b: usize, loads: &[(usize, &ElementLoad)]) {
        let mut values = Vec::new();
        let mut acting = Vec::new();
        let mut line: Option<([f64; 3], [f64; 3])> = None;
        for (s, load) in loads {
            let LoadKind::Centrifugal { squared, point, axis } = load.kind else { continue };
            let length = axis.iter().map(|a| a * a).sum::<f64>();
            if self.bodies.all[b].density.is_none() || length == 0.0 || squared < 0.0 {
                self.list.add(
                    load.place,
                    "*DLOAD, CENTRIF",
                    "it needs a density, an axis and a positive square of the speed",
                    "",
                );
                continue;
            }
            if line.is_some_and(|line| line != (point, axis)) {
                self.list.add(load.place, "*DLOAD, CENTRIF", "a second axis of the same body: it does not act", "");
                continue;
            }
            let Some(scale) = self.amplitude(load.amplitude.as_ref(), load.place, "*DLOAD") else { continue };
            line = Some((point, axis));
            acting.push(Acting { step: Some(*s), record: values.len() as u32, members: vec![0_u32] });
            values.push(Value { value: squared, amplitude: scale, is_rate: false });
        }
        let ends = |s: usize| self.deck.steps[s].ends.loads;
        let chain = chains(&acting, self.deck.steps.len(), ends, self.timeline, true).pop_first();
        let (Some((chain, _)), Some((point, axis))) = (chain, line) else { return };
        let squared = history(&chain, &values, self.timeline, self.deck, true);
        let speed = History { rows: root(&squared.rows), ..squared };
        let value =
            format!("angular_velocity = {}\naxis = {}\nabout = {}", series(&[&speed]), vector(axis), vector(point));
        let name = self.bodies.all[b].name.clone();
        if speed.rows.len() > 1 {
            let what = format!("centrifugal force of body {name}");
            let steps = number(ROOT as f64);
            self.list.add_general(
                what,
                format!("the speed is the square root of the load, in {steps} straight pieces for each of its own"),
                "",
            );
        }
        self.scene.load("body", &name, &value);
    }
}

/// The square root of a function, in pieces; negative values are zero.
fn root(rows: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let positive = |value: f64| value.max(0.0).sqrt();
    let mut all: Vec<[f64; 2]> = rows.first().map(|row| [row[0], positive(row[1])]).into_iter().collect();
    for pair in rows.windows(2) {
        let ([t0, v0], [t1, v1]) = (pair[0], pair[1]);
        for k in 1..=ROOT {
            let part = k as f64 / ROOT as f64;
            all.push([t0 + (t1 - t0) * part, positive(v0 + (v1 - v0) * part)]);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::root;

    #[test]
    fn the_root_of_a_ramp() {
        let rows = root(&[[0.0, 0.0], [2.0, 4.0]]);
        assert_eq!((rows.len(), rows[4], rows[16]), (17, [0.5, 1.0], [2.0, 2.0]));
        assert_eq!(root(&[[0.0, 9.0]]), [[0.0, 3.0]]);
    }
}
