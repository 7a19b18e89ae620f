//! What may act in a step: points against patches of triangles, and edges that cross, each with a weight and a thickness that stay as long as it is in the layer; theory/barrier#contacts.

use super::GeneralContact;
use super::begin::Onset;
use super::history::{Held, Key, Rubbed};
use super::pieces::{Patch, PieceList};
use crate::proximity::{Candidate, nearest};
use nalgebra::Vector3;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use stoss_geometry::{ClosestPair, PairKind, closest};

/// Cosine of the angle between the normals of triangles of one sheet, up to which they look against each other.
const AGAINST: f64 = -0.3;

/// A contact of general contact: a point and a patch, or two edges.
#[derive(Clone, Debug)]
pub(super) struct Contact {
    /// Candidates of the contact, by their places in [`Contacts::members`].
    pub members: Range<usize>,
    pub weight: f64,
    pub thickness: f64,
    /// The member that is nearest at the start of the step, and how.
    pub begin: Candidate,
    pub start: ClosestPair,
    /// Whether it is in the layer at the start, and whether more than the nearest place counts there.
    pub inside_n: bool,
    pub several_n: bool,
    /// Whether the pieces of the patch act one by one in any case.
    pub by_pieces: bool,
    /// Friction at the start of the step.
    pub rubbed: Rubbed,
}

impl Contact {
    /// Whether a squared distance is in its layer.
    pub fn is_inside(&self, distance_squared: f64) -> bool {
        distance_squared < self.thickness * self.thickness
    }
}

/// A point and the triangles of one class that it may meet, or two edges.
#[derive(Clone, Debug)]
struct Group {
    members: Range<usize>,
    /// Contacts of the group, once it was asked which there are.
    contacts: Option<Range<usize>>,
}

/// The contacts of a step.
#[derive(Debug, Default)]
pub(super) struct Contacts {
    groups: Vec<Group>,
    /// Candidates, those of a contact one after the other.
    members: Vec<u32>,
    list: Vec<Contact>,
    /// Weights and thicknesses of what was in the layer at the start, and of what has begun in the step.
    known: BTreeMap<Key, [f64; 2]>,
    /// Pairs that have stopped a motion of the step: they begin whatever is between them.
    blocked: BTreeSet<Key>,
    order: Vec<(u32, u32, u32)>,
    labels: Vec<usize>,
    normals: Vec<Vector3<f64>>,
    pieces: PieceList,
}

impl Contacts {
    /// A step begins with what was in the layer.
    pub fn begin(&mut self, held: &[Held]) {
        self.known.clear();
        self.blocked.clear();
        self.known.extend(held.iter().map(|held| (held.key, [held.weight, held.thickness])));
    }

    /// A pair that has stopped a motion begins to act in this step, as it may: it has no energy at the start. Returns whether that is new.
    pub fn block(&mut self, c: &Candidate) -> bool {
        let key = (c.kind, c.points);
        !self.known.contains_key(&key) && self.blocked.insert(key)
    }

    /// All contacts that are known.
    pub fn iter(&self) -> impl Iterator<Item = &Contact> {
        self.list.iter()
    }

    /// Candidates of a contact.
    pub fn members(&self, contact: &Contact) -> &[u32] {
        &self.members[contact.members.clone()]
    }

    /// The candidates are new: those of one point and one class go together. What is near at the start of the step is asked for its contacts.
    pub fn regroup(&mut self, onset: &Onset<'_>) {
        let Self { groups, members, list, order, .. } = self;
        groups.clear();
        members.clear();
        list.clear();
        order.clear();
        for (k, c) in onset.candidates.iter().enumerate() {
            if c.kind == PairKind::VertexTriangle {
                order.push((c.points[0], c.classes[1], k as u32));
            } else {
                groups.push(Group { members: members.len()..members.len() + 1, contacts: None });
                members.push(k as u32);
            }
        }
        order.sort_unstable();
        for of_point in order.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            groups.push(Group { members: members.len()..members.len() + of_point.len(), contacts: None });
            members.extend(of_point.iter().map(|of| of.2));
        }
        self.ask(onset, onset.x_n);
    }

    /// Asks those that are near at `x` for their contacts.
    pub fn ask(&mut self, onset: &Onset<'_>, x: &[Vector3<f64>]) {
        for g in 0..self.groups.len() {
            let Group { members, contacts: None } = &self.groups[g] else { continue };
            let near = |&k: &u32| {
                let c = &onset.candidates[k as usize];
                c.may_meet(&c.of(x), &[Vector3::zeros(); 4], onset.thickness)
            };
            if !self.members[members.clone()].iter().any(near) {
                continue;
            }
            let (members, first) = (members.clone(), self.list.len());
            if onset.candidates[self.members[members.start] as usize].kind == PairKind::VertexTriangle {
                self.ask_point(onset, members);
            } else {
                self.ask_edges(onset, members);
            }
            self.groups[g].contacts = Some(first..self.list.len());
        }
    }

    fn ask_edges(&mut self, onset: &Onset<'_>, members: Range<usize>) {
        let c = &onset.candidates[self.members[members.start] as usize];
        let start = closest(c.kind, &c.of(onset.x_n));
        let key = (c.kind, c.points);
        let [weight, thickness] = match self.known.get(&key) {
            Some(known) => *known,
            None => {
                let blocked = || self.blocked.contains(&key).then(|| onset.blocked_edges(c));
                let Some([weight, thickness]) = onset.edges_begin(c).or_else(blocked) else { return };
                let begun = [weight, thickness.min(start.distance_squared.sqrt())];
                self.known.insert(key, begun);
                begun
            }
        };
        let rubbed = onset.rubbed([key].into_iter());
        self.list.push(Contact {
            members,
            weight,
            thickness,
            begin: *c,
            start,
            inside_n: start.distance_squared < thickness * thickness,
            several_n: false,
            by_pieces: false,
            rubbed,
        });
    }

    /// Patches of a point: members that are neighbours, or lie on one sheet and do not look against each other. Floor and wall of a notch are patches of their own, and so are two lobes of a surface that folds;
    /// places between which the candidates have gaps, as on a long way, are not.
    fn ask_point(&mut self, onset: &Onset<'_>, members: Range<usize>) {
        let Self { labels, normals, members: all, .. } = self;
        let of = &mut all[members.clone()];
        labels.clear();
        labels.extend(0..of.len());
        normals.clear();
        normals.extend(of.iter().map(|&k| onset.unit_normal(onset.candidates[k as usize].of[0])));
        for i in 0..of.len() {
            for j in 0..i {
                let [s, t] = [of[i], of[j]].map(|k| onset.candidates[k as usize].of[0]);
                let is_one = || {
                    onset.skin.goes_on(s, t)
                        || (onset.skin.sheet(s) == onset.skin.sheet(t) && normals[i].dot(&normals[j]) > AGAINST)
                };
                if labels[i] != labels[j] && is_one() {
                    let (from, to) = (labels[i].max(labels[j]), labels[i].min(labels[j]));
                    labels.iter_mut().filter(|label| **label == from).for_each(|label| *label = to);
                }
            }
        }
        let mut sorted: Vec<(usize, u32)> = labels.iter().copied().zip(of.iter().copied()).collect();
        sorted.sort_unstable();
        of.iter_mut().zip(&sorted).for_each(|(k, sorted)| *k = sorted.1);
        let mut first = members.start;
        for patch in sorted.chunk_by(|a, b| a.0 == b.0) {
            let patch = first..first + patch.len();
            first = patch.end;
            self.ask_patch(onset, patch);
        }
    }

    fn ask_patch(&mut self, onset: &Onset<'_>, patch: Range<usize>) {
        let key = |k: u32| {
            let c = &onset.candidates[k as usize];
            (c.kind, c.points)
        };
        let known: Vec<(u32, [f64; 2])> = self.members[patch.clone()]
            .iter()
            .filter_map(|&k| self.known.get(&key(k)).map(|known| (k, *known)))
            .collect();
        let [_, _, ..] = known[..] else {
            return self.add_patch(onset, patch, known.first().map(|known| known.1));
        };
        // Patches that have merged while the point was in both layers: each keeps what is next to where it was met.
        let foot = |k: u32| {
            let c = &onset.candidates[k as usize];
            onset.foot(c, &closest(c.kind, &c.of(onset.x_n)), onset.x_n)
        };
        let feet: Vec<Vector3<f64>> = known.iter().map(|known| foot(known.0)).collect();
        let owner = |k: u32| {
            let of = known.iter().position(|known| known.0 == k);
            let distance = |i: usize| (feet[i] - foot(k)).norm_squared();
            of.unwrap_or_else(|| (1..feet.len()).fold(0, |best, i| if distance(i) < distance(best) { i } else { best }))
        };
        let mut sorted: Vec<(usize, u32)> = self.members[patch.clone()].iter().map(|&k| (owner(k), k)).collect();
        sorted.sort_unstable();
        self.members[patch.clone()].iter_mut().zip(&sorted).for_each(|(k, sorted)| *k = sorted.1);
        let mut first = patch.start;
        for part in sorted.chunk_by(|a, b| a.0 == b.0) {
            let members = first..first + part.len();
            first = members.end;
            self.add_patch(onset, members, Some(known[part[0].0].1));
        }
    }

    /// The contact of a patch, if it is one that is known or one that begins.
    fn add_patch(&mut self, onset: &Onset<'_>, patch: Range<usize>, known: Option<[f64; 2]>) {
        let of = &self.members[patch.clone()];
        let Some((begin, start)) = nearest(onset.candidates, of, onset.x_n) else { return };
        let begin = onset.candidates[begin as usize];
        let [weight, thickness] = match known {
            Some(known) => known,
            None => {
                let candidate = |&k: &u32| &onset.candidates[k as usize];
                let stops = |c: &&Candidate| self.blocked.contains(&(c.kind, c.points));
                let blocked = || of.iter().map(candidate).find(stops).map(|c| onset.blocked_point(c));
                let Some([weight, thickness]) = onset.point_begins(of).or_else(blocked) else { return };
                let begun = [weight, thickness.min(start.distance_squared.sqrt())];
                self.known.insert((begin.kind, begin.points), begun);
                begun
            }
        };
        let inside_n = start.distance_squared < thickness * thickness;
        let Self { pieces, .. } = self;
        let view = Patch { skin: onset.skin, candidates: onset.candidates, members: of, thickness };
        let several_n = inside_n && view.several(onset.x_n, pieces);
        let by_pieces = onset.between_states && view.turns_inward(onset, &begin, &start);
        let key = |&k: &u32| {
            let c = &onset.candidates[k as usize];
            (c.kind, c.points)
        };
        let rubbed = onset.rubbed(of.iter().map(key));
        self.list.push(Contact {
            members: patch,
            weight,
            thickness,
            begin,
            start,
            inside_n,
            several_n,
            by_pieces,
            rubbed,
        });
    }
}

impl GeneralContact {
    /// The member of a contact that is nearest at `x`; none if the contact does not act there.
    pub(super) fn nearest(&self, contact: &Contact, x: &[Vector3<f64>]) -> Option<(Candidate, ClosestPair)> {
        let candidates = &self.proximity.candidates;
        let of = self.contacts.members(contact);
        let near = |k: &u32| {
            let c = &candidates[*k as usize];
            c.may_meet(&c.of(x), &[Vector3::zeros(); 4], contact.thickness)
        };
        if !contact.inside_n && !of.iter().any(near) {
            return None;
        }
        let (k, close) = nearest(candidates, of, x)?;
        (contact.inside_n || contact.is_inside(close.distance_squared)).then_some((candidates[k as usize], close))
    }
}
