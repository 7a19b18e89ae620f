//! What acts at the iterate, and its force.

use super::GeneralContact;
use super::contacts::Contact;
use super::history::Rubbed;
use super::joint::{Joint, Law, Sums, Term};
use super::pieces::{Patch, Summand};
use crate::proximity::Candidate;
use crate::skin::GUARD;
use crate::slip::{Slid, SlipLine};
use crate::{FrictionForce, Layer, PairFriction, PairStart, PairTerm, Presliding, StepForce, Tangent};
use nalgebra::Vector3;
use std::ops::Range;
use stoss_geometry::{ClosestPair, PairKind, closest};

/// Shear stiffness of the layer of a contact that sticks, in moduli over thicknesses: that of an isotropic skin, 1/(2 (1 + nu)).
const SHEAR: f64 = 0.4;

/// A contact that acts. It owns what it needs: candidates are found anew on the way from one iterate to the next.
#[derive(Clone, Debug)]
pub(super) struct Act {
    pub weight: f64,
    pub thickness: f64,
    /// The pair that is nearest at the start, and how, and the same at the iterate.
    pub begin: Candidate,
    pub start: ClosestPair,
    pub end: Candidate,
    pub close: ClosestPair,
    rubbed: Rubbed,
    /// The facets that have a part in it, ascending, and the pieces of the patch if these act: places in [`Acts`].
    key: Range<usize>,
    pieces: Range<usize>,
}

/// The energy of a contact at the iterate, and what it does in the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct ActForce {
    /// Number of the points of the first primitive.
    pub first: usize,
    pub energy: f64,
    /// What the damping takes.
    pub dissipated: f64,
    /// Work of friction, and what it has come to.
    pub work: f64,
    pub rubbed: Rubbed,
}

/// All that acts, by facets.
#[derive(Debug, Default)]
pub(super) struct Acts {
    list: Vec<Act>,
    keys: Vec<u32>,
    pieces: Vec<Summand>,
}

impl<'a> IntoIterator for &'a Acts {
    type Item = &'a Act;
    type IntoIter = std::slice::Iter<'a, Act>;

    fn into_iter(self) -> Self::IntoIter {
        self.list.iter()
    }
}

impl Acts {
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub fn get(&self, k: usize) -> Option<&Act> {
        self.list.get(k)
    }

    /// Facets that have a part in what acts.
    pub fn facets(&self, act: &Act) -> &[u32] {
        &self.keys[act.key.clone()]
    }

    fn clear(&mut self) {
        self.list.clear();
        self.keys.clear();
        self.pieces.clear();
    }

    fn push(&mut self, contact: &Contact, end: Candidate, close: ClosestPair, pieces: &[Summand]) {
        let (key, first) = (self.keys.len(), self.pieces.len());
        self.pieces.extend_from_slice(pieces);
        self.keys.extend(contact.begin.facets.into_iter().chain(end.facets));
        self.keys.extend(pieces.iter().flat_map(|piece| piece.facets));
        self.keys[key..].sort_unstable();
        let mut count = key;
        for k in key..self.keys.len() {
            if count == key || self.keys[count - 1] != self.keys[k] {
                self.keys[count] = self.keys[k];
                count += 1;
            }
        }
        self.keys.truncate(count);
        let Contact { weight, thickness, begin, start, rubbed, .. } = *contact;
        let (key, pieces) = (key..count, first..self.pieces.len());
        self.list.push(Act { weight, thickness, begin, start, end, close, rubbed, key, pieces });
    }

    /// Sorts by facets, what has the same ones in the order in which it was found.
    fn sort(&mut self) {
        let Self { list, keys, .. } = self;
        list.sort_by(|a, b| keys[a.key.clone()].cmp(&keys[b.key.clone()]));
    }
}

impl GeneralContact {
    /// Finds what acts at the iterate; returns whether there are new stencils.
    pub(super) fn activate(&mut self) -> bool {
        let mut contacts = std::mem::take(&mut self.contacts);
        contacts.ask(&self.onset(), &self.x);
        self.contacts = contacts;
        let (mut acts, mut pieces) = (std::mem::take(&mut self.acts), std::mem::take(&mut self.pieces));
        acts.clear();
        let both = !self.at_end;
        for contact in self.contacts.iter() {
            let Some((end, close)) = self.nearest(contact, &self.x) else { continue };
            let patch = self.patch(contact);
            pieces.list.clear();
            if contact.members.len() > 1 {
                let several = patch.several(&self.x, &mut pieces);
                if several || (both && (contact.several_n || contact.by_pieces)) {
                    // All that is in the layer at either end.
                    if !several {
                        pieces.list.clear();
                        patch.add(&self.x, &mut pieces);
                    }
                    if both && contact.inside_n {
                        patch.add(&self.x_n, &mut pieces);
                    }
                    pieces.list.sort_by_key(|piece| (piece.kind, piece.points));
                    pieces.list.dedup_by_key(|piece| (piece.kind, piece.points));
                } else {
                    pieces.list.clear();
                }
            }
            acts.push(contact, end, close, &pieces.list);
        }
        acts.sort();
        let known = self.groups.len();
        for act in &acts {
            let key = acts.facets(act);
            let is_new = self.groups.len() == known || self.groups.last().is_none_or(|last| &**last != key);
            if is_new && self.groups[..known].binary_search_by(|group| (**group).cmp(key)).is_err() {
                self.groups.push(key.into());
            }
        }
        (self.acts, self.pieces) = (acts, pieces);
        let changed = self.groups.len() > known;
        self.groups.sort_unstable();
        changed
    }

    fn patch(&self, contact: &Contact) -> Patch<'_> {
        let members = self.contacts.members(contact);
        Patch { skin: &self.skin, candidates: &self.proximity.candidates, members, thickness: contact.thickness }
    }

    fn layer(&self, candidate: &Candidate, thickness: f64) -> Layer {
        let [a, b] = candidate.classes;
        let modulus = self.rules.between(a, b).map_or(0.0, |interaction| interaction.modulus);
        let layer = Layer::new(modulus, thickness);
        if self.has_rates && self.options.damping > 0.0 {
            layer.damped(self.options.damping / self.step_size)
        } else {
            layer
        }
    }

    /// Speed of slip below which friction creeps, if it does not stick.
    pub(super) fn creep(&self) -> Option<f64> {
        self.options.slip_velocity.filter(|_| self.has_rates)
    }

    fn friction(&self, act: &Act) -> Option<PairFriction<'_>> {
        let [a, b] = act.begin.classes;
        let interaction = self.rules.between(a, b)?;
        let law = interaction.friction.as_deref()?;
        let Rubbed { stretch, slid, .. } = act.rubbed;
        let stick = match self.creep() {
            _ if !law.sticks() => Presliding::Never,
            Some(speed) => Presliding::Creep { slip_scale: speed * self.step_size },
            None => {
                // A guard carries alone what points of integration do not see: its spring is that of the area of which its weight is a part.
                let area = if act.begin.is_integration_point { act.weight } else { act.weight / GUARD };
                let stiffness = SHEAR * interaction.modulus / self.options.thickness * area;
                Presliding::Spring { stiffness, stretch }
            }
        };
        // The law sees the pressure of the layer.
        Some(PairFriction { law, area: act.weight, step_size: self.step_size, slid, stick })
    }

    /// Energy of a contact at positions of the points.
    fn energy_of(&self, contact: &Contact, x: &[Vector3<f64>], pieces: &mut super::pieces::PieceList) -> f64 {
        let Some((end, close)) = self.nearest(contact, x) else { return 0.0 };
        let layer = self.layer(&end, contact.thickness);
        if end.kind == PairKind::EdgeEdge {
            return self.edges(&end, contact.weight).at_state(&layer, &end.of(x), None).energy;
        }
        if self.patch(contact).several(x, pieces) {
            let sum: f64 = pieces.list.iter().map(|piece| piece.sign * layer.evaluate(piece.distance_squared)[0]).sum();
            return contact.weight * sum;
        }
        contact.weight * layer.evaluate(close.distance_squared)[0]
    }

    /// Energy of the contacts of the step at positions of the points.
    pub(super) fn energy_at(&self, x: &[Vector3<f64>]) -> f64 {
        let mut pieces = super::pieces::PieceList::default();
        self.contacts.iter().map(|contact| self.energy_of(contact, x, &mut pieces)).sum()
    }

    fn edges(&self, edges: &Candidate, weight: f64) -> PairTerm {
        PairTerm { kind: edges.kind, weight, mollifier: Some(self.skin.edge_weight(edges.of).1) }
    }

    /// Force of what acts at the iterate; its gradients and the tangent are in `joint`.
    pub(super) fn force(&self, act: &Act, joint: &mut Joint, wants_tangent: bool) -> ActForce {
        let layer = self.layer(&act.end, act.thickness);
        let friction = self.friction(act);
        if act.end.kind == PairKind::EdgeEdge {
            return self.force_of_edges(act, &layer, friction.as_ref(), joint, wants_tangent);
        }
        let base = self.gather(act, joint);
        let law = friction.as_ref().map(|law| (law, base));
        let Sums { energy, dissipated, slid } = joint.act(&layer, self.at_end, law, wants_tangent);
        let Slid { work, stored, stretch, slid, .. } = slid.unwrap_or_default();
        ActForce { first: 1, energy, dissipated, work, rubbed: Rubbed { stretch, stored, slid } }
    }

    /// The terms of a point and a patch over their common list of points; returns the triangle whose spin is no slip.
    fn gather(&self, act: &Act, joint: &mut Joint) -> (PairKind, [usize; 4]) {
        joint.points.clear();
        joint.terms.clear();
        for piece in &self.acts.pieces[act.pieces.clone()] {
            let [start, end] = [&self.x_n, &self.x].map(|x| closest(piece.kind, &piece.points.map(|p| x[p as usize])));
            let slots = piece.points.map(|p| joint.slot(p));
            joint.terms.push(Term { weight: piece.sign * act.weight, slots_n: slots, start, slots, end });
        }
        if joint.terms.is_empty() {
            let slots = act.end.points.map(|p| joint.slot(p));
            let (slots_n, start) = match self.at_end {
                true => (slots, act.close),
                false => (act.begin.points.map(|p| joint.slot(p)), act.start),
            };
            joint.terms.push(Term { weight: act.weight, slots_n, start, slots, end: act.close });
        }
        let base = (PairKind::VertexTriangle, act.begin.points.map(|p| joint.slot(p)));
        joint.place(&self.x_n, &self.x);
        base
    }

    fn force_of_edges(
        &self,
        act: &Act,
        layer: &Layer,
        friction: Option<&PairFriction<'_>>,
        joint: &mut Joint,
        wants_tangent: bool,
    ) -> ActForce {
        let term = self.edges(&act.end, act.weight);
        let (x_n, x) = (act.end.of(&self.x_n), act.end.of(&self.x));
        let mut tangent: Tangent = [[0.0; 12]; 12];
        let wanted = wants_tangent.then_some(&mut tangent);
        let StepForce { barrier, friction } = match self.at_end {
            true => term.at_end(layer, &x_n, &x, friction, wanted),
            false => PairStart::new(term, *layer, &x_n).step(&x, friction, wanted),
        };
        joint.points.clear();
        joint.points.extend(act.end.points);
        joint.barrier.clear();
        joint.barrier.extend(barrier.gradient);
        let FrictionForce { gradient, work, stored, stretch, slid, .. } = friction;
        joint.friction.clear();
        joint.friction.extend(gradient);
        if wants_tangent {
            joint.tangent.clear();
            joint.tangent.extend_from_slice(tangent.as_flattened());
        }
        ActForce {
            first: 2,
            energy: barrier.energy,
            dissipated: barrier.dissipated,
            work,
            rubbed: Rubbed { stretch, stored, slid },
        }
    }

    /// Friction of what acts, with the normal force at the iterate, along a motion of all points.
    pub(super) fn slip_along(&self, act: &Act, d: &[Vector3<f64>], joint: &mut Joint) -> Option<SlipLine> {
        let (layer, friction) = (self.layer(&act.end, act.thickness), self.friction(act)?);
        if act.end.kind == PairKind::EdgeEdge {
            let points = [act.end.of(&self.x_n), act.end.of(&self.x), act.end.of(d)];
            return self.edges(&act.end, act.weight).slip_along(&layer, points.each_ref(), &friction);
        }
        let law: Law<'_> = (&friction, self.gather(act, joint));
        joint.act(&layer, true, Some(law), false).slid?;
        let motion: Vec<Vector3<f64>> = joint.points.iter().map(|&p| d[p as usize]).collect();
        joint.along(law, &motion)
    }
}
