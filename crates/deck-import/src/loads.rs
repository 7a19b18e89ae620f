//! `*CLOAD`, `*DLOAD`, `*DSLOAD` to `[[load]]`.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh::Facet;
use stoss_mesh_io::deck::{DeckPlace, ElementLoad, LoadKind, OpNew, Target};

use crate::context::Context;
use crate::history::{History, Value, by_history, history};
use crate::records::{DeckLine, members_by_records};
use crate::sets::{Selection, named};
use crate::severity::Severity;
use crate::text::{count, text, vector};

/// Straight pieces in place of the square root of a straight one.
const PIECES: usize = 16;

const NO_LOAD: &str = "the load does not act";

/// Adds all loads.
pub(crate) fn loads(context: &mut Context<'_>) {
    context.forces();
    context.face_pressures();
    context.surface_pressures();
    context.body_loads();
}

/// Pressures on facets, line by line.
#[derive(Default)]
struct Pressures {
    selections: Vec<Selection<Facet>>,
    values: Vec<Value>,
    lines: Vec<DeckLine<Facet>>,
}

impl Context<'_> {
    fn forces(&mut self) {
        let mut selections = Vec::new();
        let mut values = Vec::new();
        let mut lines: [Vec<DeckLine<u32>>; 3] = Default::default();
        let deck = self.deck;
        for (s, step) in deck.steps.iter().enumerate() {
            for force in &step.forces {
                let mut nodes = self.lookup.nodes(&force.nodes);
                let has_own = nodes.members.iter().any(|node| self.bodies.owner(*node).is_some());
                if !has_own && !self.references.of(&force.nodes).is_empty() {
                    continue;
                }
                if force.freedom > 2 {
                    self.list.add_unread(force.place, format!("degree of freedom {} of *CLOAD", force.freedom + 1));
                    continue;
                }
                let amplitude = self.amplitude(force.amplitude.as_ref(), "*CLOAD", force.place, NO_LOAD);
                let Some(amplitude) = amplitude else { continue };
                let outside = self.nodes_outside(&nodes, &force.nodes);
                let is_none = !has_own;
                if force.value != 0.0 && (is_none || outside > 0) {
                    let consequence = if is_none {
                        format!("{} has no node of a body: the force does not act", text(&force.nodes))
                    } else {
                        let number = count(outside, "node", "nodes");
                        format!("{number} of {} in no body: no force acts there", text(&force.nodes))
                    };
                    let remedy = "if it is a reference node, see [[coupling]] and `moment` of [[load]]";
                    self.list.add(Severity::Missing, force.place, "*CLOAD", consequence, remedy);
                }
                if is_none {
                    continue;
                }
                let components = std::array::from_fn(|i| i == force.freedom);
                self.drop_unknown_axes(&mut nodes, components, "*CLOAD", force.place);
                let members = nodes.members.clone();
                lines[force.freedom].push(DeckLine { step: Some(s), record: values.len() as u32, members });
                selections.push(nodes);
                let value = force.value / self.section.map_or(1.0, |section| section.extent);
                values.push(Value { value, amplitude, is_rate: false });
            }
        }
        let mut found: BTreeMap<String, [Option<History>; 3]> = BTreeMap::new();
        let mut order = Vec::new();
        let mut inclined = Vec::new();
        for (component, lines) in lines.iter().enumerate() {
            let replaces_all = |s: usize| deck.steps[s].op_new.forces;
            let groups = members_by_records(lines, deck.steps.len(), replaces_all, self.timeline, true);
            for (own, nodes, records) in by_history(groups, &values, self.timeline, true) {
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
                    for set in self.sets.nodes(b, &wanted, &named(&selections, &records), "loaded") {
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
            let own = found[&set].each_ref().map(|history| history.as_ref().unwrap_or(&none));
            self.scene.load(self.timeline, ("set", &set), "force", &own, "");
        }
        for (set, own) in inclined {
            self.scene.load(self.timeline, ("set", &set), "force", &own.each_ref(), "");
        }
    }

    /// Pressures on faces of elements.
    fn face_pressures(&mut self) {
        let mut pressures = Pressures::default();
        let deck = self.deck;
        for (s, step) in deck.steps.iter().enumerate() {
            for load in &step.loads {
                let LoadKind::Pressure { face, value } = load.kind else { continue };
                let amplitude = self.amplitude(load.amplitude.as_ref(), "*DLOAD", load.place, NO_LOAD);
                let Some(amplitude) = amplitude else { continue };
                let elements = self.elements_of_bodies(load);
                let mesh = self.sets.mesh();
                // The edges of a plane element are the faces of its layer behind the first two.
                let face = if self.section.is_some() { face + 2 } else { face };
                let has_face = |e: &u32| face < mesh.elements.kind(*e as usize).faces().len();
                let facets: Vec<Facet> =
                    elements.iter().filter(|e| has_face(e)).map(|&e| mesh.facet(e, face)).collect();
                if facets.len() < elements.len() {
                    let consequence = format!("{} elements have no face P{}", elements.len() - facets.len(), face + 1);
                    self.list.add(Severity::Missing, load.place, "*DLOAD", consequence, "name a face that they have");
                }
                let value = Value { value, amplitude, is_rate: false };
                self.pressure(
                    &mut pressures,
                    s,
                    Selection { name: None, members: facets },
                    value,
                    load.place,
                    "*DLOAD",
                );
            }
        }
        self.write_pressures(&pressures, |op_new| op_new.loads);
    }

    /// Pressures on surfaces.
    fn surface_pressures(&mut self) {
        let mut pressures = Pressures::default();
        let deck = self.deck;
        for (s, step) in deck.steps.iter().enumerate() {
            for load in &step.pressures {
                let amplitude = self.amplitude(load.amplitude.as_ref(), "*DSLOAD", load.place, NO_LOAD);
                let Some(amplitude) = amplitude else { continue };
                let Some((surface, _)) = self.lookup.surface(&load.surface) else {
                    let consequence = format!("there is no surface {}: the pressure does not act", load.surface);
                    self.list.add(
                        Severity::Missing,
                        load.place,
                        "*DSLOAD",
                        consequence,
                        "name a surface of solid elements",
                    );
                    continue;
                };
                let value = Value { value: load.value, amplitude, is_rate: false };
                self.pressure(&mut pressures, s, surface, value, load.place, "*DSLOAD");
            }
        }
        self.write_pressures(&pressures, |op_new| op_new.pressures);
    }

    /// Keeps a pressure on those facets that have an outside.
    fn pressure(
        &mut self,
        pressures: &mut Pressures,
        step: usize,
        facets: Selection<Facet>,
        value: Value,
        place: DeckPlace,
        keyword: &str,
    ) {
        let Selection { name, members: facets } = facets;
        let outside = |facet: &Facet| self.bodies.of_element(facet.element).is_some() && !self.bodies.is_inner(facet);
        let members: Vec<Facet> = facets.iter().copied().filter(outside).collect();
        if members.len() < facets.len() {
            let consequence = format!(
                "{} faces lie inside of a body, or belong to none: no pressure acts on them",
                facets.len() - members.len()
            );
            self.list.add(Severity::Missing, place, keyword, consequence, "");
        }
        let name = name.filter(|_| members.len() == facets.len());
        let record = pressures.values.len() as u32;
        pressures.lines.push(DeckLine { step: Some(step), record, members: members.clone() });
        pressures.selections.push(Selection { name, members });
        pressures.values.push(value);
    }

    fn write_pressures(&mut self, pressures: &Pressures, op_new: fn(&OpNew) -> bool) {
        let Pressures { selections, values, lines } = pressures;
        let deck = self.deck;
        let replaces_all = |s: usize| op_new(&deck.steps[s].op_new);
        let groups = members_by_records(lines, deck.steps.len(), replaces_all, self.timeline, true);
        for (own, facets, records) in by_history(groups, values, self.timeline, true) {
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
                for set in self.sets.facets(b, &wanted, &named(selections, &records), "pressed") {
                    self.scene.load(self.timeline, ("set", &set), kind, &[&own], "");
                }
            }
        }
    }

    /// The elements of a load that belong to bodies; an entry if there are none.
    fn elements_of_bodies(&mut self, load: &ElementLoad) -> Vec<u32> {
        let mut elements = self.lookup.elements(&load.elements).members;
        elements.retain(|&e| self.bodies.of_element(e).is_some());
        if elements.is_empty() {
            let consequence = format!("{} has no element of a body: the load does not act", text(&load.elements));
            self.list.add(Severity::Missing, load.place, "*DLOAD", consequence, "");
        }
        elements
    }

    /// Gravity, forces per volume and centrifugal forces.
    fn body_loads(&mut self) {
        let loads = self.deck.steps.iter().flat_map(|step| &step.loads);
        for load in loads.filter(|load| !matches!(load.kind, LoadKind::Pressure { .. })) {
            self.report_part_of_body(load);
        }
        for b in 0..self.bodies.all.len() {
            self.loads_of_body(b);
        }
    }

    /// An entry for a load on a part of a body.
    fn report_part_of_body(&mut self, load: &ElementLoad) {
        let elements: BTreeSet<u32> = self.elements_of_bodies(load).into_iter().collect();
        for body in &self.bodies.all {
            let count = body.elements.iter().filter(|e| elements.contains(e)).count();
            if count > 0 && count < body.elements.len() {
                let consequence = format!(
                    "it acts on {count} of {} elements of body {}, and a scene loads whole bodies: it does not act",
                    body.elements.len(),
                    body.name
                );
                let remedy = "give these elements a material of their own";
                self.list.add(Severity::Missing, load.place, "*DLOAD", consequence, remedy);
            }
        }
    }

    fn loads_of_body(&mut self, b: usize) {
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
        if let Some(own) = acceleration {
            if body.density.is_none() {
                let what = format!("gravity of body {}", body.name);
                let consequence = "its material has no *DENSITY: it has no weight";
                self.list.add_general(Severity::Missing, what, consequence, "give it a density");
            } else {
                self.scene.load(self.timeline, ("body", &body.name), "acceleration", &own.each_ref(), "");
            }
        }
        if let Some(own) = force {
            self.scene.load(self.timeline, ("body", &body.name), "body_force", &own.each_ref(), "");
        }
        self.rotation(b, &loads);
    }

    /// The sum of the loads of a kind on a body over time, by components; nothing if there are none. `value`: the components of a load of this kind that
    /// it has.
    fn vector_load(
        &mut self,
        loads: &[(usize, &ElementLoad)],
        value: impl Fn(&LoadKind) -> Option<[Option<f64>; 3]>,
    ) -> Option<[History; 3]> {
        let mut values: [Vec<Value>; 3] = Default::default();
        // A component that a load says nothing of stays what it was.
        let mut lines: [Vec<DeckLine<u32>>; 3] = Default::default();
        for (s, load) in loads {
            let Some(vector) = value(&load.kind) else { continue };
            if vector == [None; 3] {
                let remedy = "give its three components";
                let consequence = "it has no direction: it does not act";
                self.list.add(Severity::Missing, load.place, "*DLOAD", consequence, remedy);
                continue;
            }
            let amplitude = self.amplitude(load.amplitude.as_ref(), "*DLOAD", load.place, NO_LOAD);
            let Some(amplitude) = amplitude else { continue };
            for ((values, lines), value) in values.iter_mut().zip(&mut lines).zip(vector) {
                if let Some(value) = value {
                    lines.push(DeckLine { step: Some(*s), record: values.len() as u32, members: vec![0_u32] });
                    values.push(Value { value, amplitude, is_rate: false });
                }
            }
        }
        let own = [0, 1, 2].map(|axis| self.load_of_body(&lines[axis], &values[axis]).unwrap_or_else(History::none));
        if own.iter().all(History::is_zero) { None } else { Some(own) }
    }

    /// What lines of `*DLOAD` say of a whole body, whose only member is 0.
    fn load_of_body(&self, lines: &[DeckLine<u32>], values: &[Value]) -> Option<History> {
        let replaces_all = |s: usize| self.deck.steps[s].op_new.loads;
        let mut groups = members_by_records(lines, self.deck.steps.len(), replaces_all, self.timeline, true);
        let (by_stage, _) = groups.pop_first()?;
        Some(history(&by_stage, values, self.timeline, true))
    }

    /// Centrifugal forces: of one axis.
    fn rotation(&mut self, b: usize, loads: &[(usize, &ElementLoad)]) {
        let body = &self.bodies.all[b];
        let mut values = Vec::new();
        let mut lines = Vec::new();
        // A point of the axis and its direction.
        let mut about: Option<([f64; 3], [f64; 3])> = None;
        for (s, load) in loads {
            let LoadKind::Centrifugal { squared, point, axis } = load.kind else { continue };
            let length = axis.iter().map(|a| a * a).sum::<f64>();
            let reasons = [
                (body.density.is_none(), "its material has no *DENSITY", "give it a density"),
                (length == 0.0, "the direction of its axis is zero", "give its three components"),
                (squared < 0.0, "the square of its angular velocity is negative", "make it positive"),
                (
                    about.is_some_and(|about| about != (point, axis)),
                    "the body has a centrifugal load about another axis",
                    "give both the same axis",
                ),
            ];
            if let Some((_, reason, remedy)) = reasons.into_iter().find(|(holds, ..)| *holds) {
                let consequence = format!("{reason}: {NO_LOAD}");
                self.list.add(Severity::Missing, load.place, "*DLOAD, CENTRIF", consequence, remedy);
                continue;
            }
            let amplitude = self.amplitude(load.amplitude.as_ref(), "*DLOAD", load.place, NO_LOAD);
            let Some(amplitude) = amplitude else { continue };
            about = Some((point, axis));
            lines.push(DeckLine { step: Some(*s), record: values.len() as u32, members: vec![0_u32] });
            values.push(Value { value: squared, amplitude, is_rate: false });
        }
        let (Some(squared), Some((point, axis))) = (self.load_of_body(&lines, &values), about) else { return };
        let speed = History { rows: square_root(&squared.rows), ..squared.clone() };
        if speed.rows.len() > squared.rows.len() {
            self.list.add_general(
                Severity::Note,
                format!("centrifugal force of body {}", body.name),
                format!(
                    "a scene has the angular velocity, the square root of this load: each straight piece of the load becomes {PIECES} of the velocity"
                ),
                "",
            );
        }
        let more = format!("axis = {}\nabout = {}\n", vector(axis), vector(point));
        self.scene.load(self.timeline, ("body", &body.name), "angular_velocity", &[&speed], &more);
    }
}

/// The square root of a function, which is no straight line where the function is one: in pieces. Negative values are zero.
fn square_root(rows: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let root = |value: f64| value.max(0.0).sqrt();
    let mut all: Vec<[f64; 2]> = rows.first().map(|row| [row[0], root(row[1])]).into_iter().collect();
    for pair in rows.windows(2) {
        let ([t0, v0], [t1, v1]) = (pair[0], pair[1]);
        let pieces = if t0 < t1 && v0 != v1 { PIECES } else { 1 };
        for k in 1..=pieces {
            let part = k as f64 / pieces as f64;
            all.push([t0 + (t1 - t0) * part, root(v0 + (v1 - v0) * part)]);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::square_root;

    #[test]
    fn the_square_root_of_a_ramp_and_of_a_jump() {
        let rows = square_root(&[[0.0, 0.0], [2.0, 4.0]]);
        assert_eq!((rows.len(), rows[4], rows[16]), (17, [0.5, 1.0], [2.0, 2.0]));
        assert_eq!(square_root(&[[0.0, 9.0]]), [[0.0, 3.0]]);
        let jump = [[0.0, 9.0], [1.0, 9.0], [1.0, 4.0]];
        assert_eq!(square_root(&jump), [[0.0, 3.0], [1.0, 3.0], [1.0, 2.0]]);
    }
}
