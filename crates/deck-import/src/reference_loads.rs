//! Supports and loads of reference nodes, and the parts that they become.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use stoss_mesh_io::deck::DeckPlace;

use crate::context::Context;
use crate::history::{History, Value, by_history, parts};
use crate::records::{DeckLine, StageRecords, members_by_records};
use crate::references::Role;
use crate::severity::Severity;
use crate::text::{number, string, vector};
use crate::write::series;

const AXES: [&str; 3] = ["x", "y", "z"];

/// What a line of the deck says of the degrees of freedom of reference nodes.
#[derive(Default)]
struct Lines {
    /// Lines by degree of freedom: of the reference node that the members name.
    of: [Vec<DeckLine<u32>>; 6],
    values: Vec<Value>,
    places: Vec<DeckPlace>,
}

impl Lines {
    fn add(&mut self, step: Option<usize>, members: &[(usize, usize)], value: Value, place: DeckPlace) {
        for freedom in 0..6 {
            let own = members.iter().filter(|(_, f)| *f == freedom).map(|(r, _)| *r as u32).collect::<Vec<_>>();
            if !own.is_empty() {
                self.of[freedom].push(DeckLine { step, record: self.values.len() as u32, members: own });
            }
        }
        self.values.push(value);
        self.places.push(place);
    }
}

/// Adds supports and loads of reference nodes.
pub(crate) fn reference_loads(context: &mut Context<'_>) {
    let held = context.reference_supports();
    context.reference_forces();
    context.write_references(&held);
}

impl Context<'_> {
    /// Members of a line: reference node and degree of freedom. An axis that is one of rotation alone takes the first displacement.
    fn freedoms_of(&self, target: &stoss_mesh_io::deck::Target, freedom: usize) -> Vec<(usize, usize)> {
        let own = self.references.of(target).into_iter();
        own.filter_map(|r| match self.references.all[r].role {
            Role::RotationAbout(..) => (freedom == 0).then_some((r, 0)),
            _ => self.references.freedom(r, freedom),
        })
        .collect()
    }

    /// Adds the supports; the bodies that are held altogether from the start to the end.
    fn reference_supports(&mut self) -> BTreeSet<usize> {
        let deck = self.deck;
        let of_model = deck.supports.iter().map(|support| (None, support));
        let of_steps =
            deck.steps.iter().enumerate().flat_map(|(s, step)| step.supports.iter().map(move |x| (Some(s), x)));
        let mut lines = Lines::default();
        for (step, support) in of_model.chain(of_steps) {
            let given = (0..6).filter(|&i| support.freedoms[i]);
            let members: Vec<(usize, usize)> = given.flat_map(|i| self.freedoms_of(&support.nodes, i)).collect();
            if members.is_empty() {
                continue;
            }
            if let Some(value) = self.prescribed(support) {
                lines.add(step, &members, value, support.place);
            }
        }
        let mut of_reference: BTreeMap<usize, Vec<(usize, History, DeckPlace)>> = BTreeMap::new();
        for (freedom, own) in lines.of.iter().enumerate() {
            let replaces_all = |s: usize| deck.steps[s].op_new.supports;
            let groups = members_by_records(own, deck.steps.len(), replaces_all, self.timeline, false);
            let mut all: BTreeMap<StageRecords, Vec<u32>> = BTreeMap::new();
            for (by_stage, members) in groups {
                parts(&by_stage, &lines.values)
                    .into_iter()
                    .for_each(|part| all.entry(part).or_default().extend(&members));
            }
            for (history, members, records) in by_history(all, &lines.values, self.timeline, false) {
                let place = records.first().map_or(lines.places[0], |&record| lines.places[record as usize]);
                for r in members {
                    of_reference.entry(r as usize).or_default().push((freedom, history.clone(), place));
                }
            }
        }
        let mut fixed = BTreeSet::new();
        for (r, own) in of_reference {
            let always = |history: &History| history.is_zero() && !history.active.contains(&false);
            match self.references.all[r].role {
                Role::Body if own.len() == 6 && own.iter().all(|(_, history, _)| always(history)) => {
                    fixed.insert(r);
                }
                Role::Body => self.support_of_body(r, &own),
                Role::RotationAbout(body, axis) => {
                    own.iter().for_each(|(_, history, _)| self.turn(body, "rotation", axis, history))
                }
                _ => self.support_of_point(r, &own),
            }
        }
        fixed
    }

    fn support_of_point(&mut self, r: usize, own: &[(usize, History, DeckPlace)]) {
        let set = format!("{}.all", self.references.all[r].name);
        for (freedom, history, _) in own {
            self.references.all[r].is_used[*freedom] = true;
            let along = format!("components = [\"{}\"]", AXES[*freedom]);
            let value = if history.is_zero() {
                "fixed = true".to_owned()
            } else {
                format!("displacement = {}", series(&[history]))
            };
            self.scene.prescribe(&set, &along, &value, &history.active, history.ramp_until);
        }
    }

    /// Displacements by equations, rotations by joints to the ground.
    fn support_of_body(&mut self, r: usize, own: &[(usize, History, DeckPlace)]) {
        let set = string(&format!("{}.all", self.references.all[r].name));
        for (freedom, history, place) in own.iter().filter(|(freedom, ..)| *freedom < 3) {
            if history.ramp_until.is_some() && !history.is_zero() {
                let consequence = "it begins in a later step at a reference node: it does not begin where the node is, but takes it to its value at once";
                self.list.add(Severity::Changed, *place, "*BOUNDARY", consequence, "let it begin in the first step");
            }
            let term = format!("{{ set = {set}, component = \"{}\" }}", AXES[*freedom]);
            self.scene.equation(&[term], Some(history), &history.active);
        }
        let turns: Vec<&(usize, History, DeckPlace)> = own.iter().filter(|(freedom, ..)| *freedom > 2).collect();
        let Some((_, first, place)) = turns.first() else { return };
        let is_alike = turns.iter().all(|(_, history, _)| history.active == first.active);
        let driven: Vec<&&(usize, History, DeckPlace)> =
            turns.iter().filter(|(_, history, _)| !history.is_zero()).collect();
        let unit = |freedom: usize| std::array::from_fn(|i| f64::from(u8::from(i == freedom - 3)));
        let free = || (3..6).find(|freedom| turns.iter().all(|(own, ..)| own != freedom));
        let none = History { active: first.active.clone(), ..History::none() };
        match (turns.len(), &driven[..], is_alike) {
            (1, _, _) => self.turn(r, "rotation", unit(turns[0].0), &turns[0].1),
            (2, [], true) => {
                let Some(axis) = free() else { return };
                let keys = self.to_ground(r, &format!("axis = {}\n", vector(unit(axis))));
                self.scene.joint("parallel", &keys, &none.active);
            }
            (3, [], true) => {
                let keys = self.to_ground(r, "");
                self.scene.joint("orientation", &keys, &none.active);
            }
            (3, [(axis, history, _)], true) => self.turn(r, "parallel", unit(*axis), history),
            _ => {
                let consequence = "its rotations are free: only one rotation, all three of which one changes, or two that are fixed can be prescribed here";
                let remedy = "see [[joint]] and `rotation` of [[prescribe]]";
                self.list.add(Severity::Missing, *place, "*BOUNDARY", consequence, remedy);
            }
        }
    }

    fn to_ground(&self, r: usize, more: &str) -> String {
        let own = &self.references.all[r];
        format!("between = [\"ground\", {}]\nat = {}\n{more}", string(&own.name), vector(own.at))
    }

    /// A rotation about an axis, in radians.
    fn turn(&mut self, r: usize, kind: &str, axis: [f64; 3], history: &History) {
        let angle = series(&[&history.times(180.0 / PI)]);
        let keys = self.to_ground(r, &format!("axis = {}\nmotor = {{ angle = {angle} }}\n", vector(axis)));
        self.scene.joint(kind, &keys, &history.active);
    }

    /// Forces and moments.
    fn reference_forces(&mut self) {
        let deck = self.deck;
        let mut lines = Lines::default();
        for (s, step) in deck.steps.iter().enumerate() {
            for force in &step.forces {
                let members = self.freedoms_of(&force.nodes, force.freedom);
                if members.is_empty() {
                    continue;
                }
                let amplitude =
                    self.amplitude(force.amplitude.as_ref(), "*CLOAD", force.place, "the load does not act");
                let Some(amplitude) = amplitude else { continue };
                let value = Value { value: force.value, amplitude, is_rate: false };
                lines.add(Some(s), &members, value, force.place);
            }
        }
        let mut found: BTreeMap<(usize, bool), [History; 3]> = BTreeMap::new();
        for (freedom, own) in lines.of.iter().enumerate() {
            let replaces_all = |s: usize| deck.steps[s].op_new.forces;
            let groups = members_by_records(own, deck.steps.len(), replaces_all, self.timeline, true);
            for (history, members, _) in by_history(groups, &lines.values, self.timeline, true) {
                for r in members {
                    let none = || [History::none(), History::none(), History::none()];
                    match self.references.all[r as usize].role {
                        Role::RotationAbout(body, axis) => {
                            let size = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
                            found.insert((body, true), axis.map(|x| history.times(x / size)));
                        }
                        _ => found.entry((r as usize, freedom > 2)).or_insert_with(none)[freedom % 3] = history.clone(),
                    }
                }
            }
        }
        for ((r, is_moment), own) in found {
            if self.references.all[r].role == Role::Point {
                (0..3).filter(|&i| !own[i].is_zero()).for_each(|i| self.references.all[r].is_used[i] = true);
            }
            let set = format!("{}.all", self.references.all[r].name);
            let kind = if is_moment { "moment" } else { "force" };
            self.scene.load(self.timeline, ("set", &set), kind, &own.each_ref(), "");
        }
    }

    /// The parts, and what holds points where nothing acts.
    fn write_references(&mut self, fixed: &BTreeSet<usize>) {
        for r in 0..self.references.all.len() {
            let own = &self.references.all[r];
            let (name, at) = (string(&own.name), vector(own.at));
            match own.role {
                Role::Body => {
                    let fixed = if fixed.contains(&r) { "fixed = true\n" } else { "" };
                    self.scene.part(&format!("[[rigid]]\nname = {name}\nposition = {at}\n{fixed}"));
                }
                Role::Point => {
                    self.scene.part(&format!("[[mass]]\nname = {name}\nat = {at}\nmass = {}\n", number(own.mass)));
                    let held: Vec<String> =
                        (0..3).filter(|&i| !own.is_used[i]).map(|i| format!("\"{}\"", AXES[i])).collect();
                    if !held.is_empty() {
                        let set = format!("{}.all", own.name);
                        self.scene.prescribe(
                            &set,
                            &format!("components = [{}]", held.join(", ")),
                            "fixed = true",
                            &[],
                            None,
                        );
                    }
                }
                Role::RotationsOf(_) | Role::RotationAbout(..) => {}
            }
        }
    }
}
