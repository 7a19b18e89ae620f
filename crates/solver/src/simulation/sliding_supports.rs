//! Sliding supports in a run: which of their directions are independent, positions and velocities that satisfy them, reaction forces.

use super::Simulation;
use crate::sliding_support::along;
use std::borrow::Cow;
use std::collections::BTreeMap;
use stoss_linalg::NONE;
use stoss_term::SupportedNode;

/// Sine of the angle below which a direction follows from others of the same node.
const DEPENDENT: f64 = 1.0e-6;

type Vector = [f64; 3];

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Orthonormal directions of a node, by Gram-Schmidt orthogonalisation.
#[derive(Debug, Default)]
struct Directions(Vec<Vector>);

impl Directions {
    /// The part of a direction normal to all of them, and its norm.
    fn across(&self, direction: Vector) -> (Vector, f64) {
        let mut rest = direction;
        // Twice, against round-off.
        for known in self.0.iter().chain(&self.0) {
            let part = dot(&rest, known);
            (0..3).for_each(|i| rest[i] -= part * known[i]);
        }
        let size = dot(&rest, &rest).sqrt();
        (rest, size)
    }

    /// Adds a direction; returns its part that is linearly independent, or `None` if there is none.
    fn add(&mut self, direction: Vector) -> Option<Vector> {
        let (rest, size) = self.across(direction);
        if size <= DEPENDENT {
            return None;
        }
        self.0.push(rest.map(|r| r / size));
        Some(rest)
    }
}

impl Simulation {
    /// Directions of a node of which the components are prescribed.
    fn prescribed_directions(&self, node: u32) -> Directions {
        let held = |i: &usize| self.system.matrix.numbering.equation[3 * node as usize + i] == NONE;
        Directions((0..3).filter(held).map(|i| std::array::from_fn(|k| f64::from(u8::from(k == i)))).collect())
    }

    /// Active sliding supports at a time: contact pair, slot, and the constrained direction.
    fn supported_nodes(&self, time: f64) -> impl Iterator<Item = (usize, usize, SupportedNode)> {
        self.model.contacts.iter().enumerate().flat_map(move |(c, pair)| {
            let count = if pair.supported_node(0, time).is_some() { pair.term.slot_count() } else { 0 };
            (0..count).filter_map(move |slot| Some((c, slot, pair.supported_node(slot, time)?)))
        })
    }

    /// Whether there are sliding supports.
    pub(super) fn has_sliding_supports(&self) -> bool {
        self.supported_nodes(0.0).next().is_some()
    }

    /// Deactivates slots whose direction follows from prescribed components and from directions of other slots at the same node, as at the common edge of symmetry
    /// planes that are given twice. Whether their motions agree is checked after each step.
    pub(super) fn drop_dependent_directions(&mut self) {
        let mut known: BTreeMap<u32, Directions> = BTreeMap::new();
        let mut dropped = Vec::new();
        for (c, slot, held) in self.supported_nodes(0.0) {
            let of_node = known.entry(held.node).or_insert_with(|| self.prescribed_directions(held.node));
            if of_node.add(held.direction).is_none() {
                dropped.push((c, slot));
            }
        }
        for (c, slot) in dropped {
            self.slots.active[c][slot] = false;
            self.slots.pressures[c][slot] = 0.0;
            self.slots.mean_pressures.get_mut(c).into_iter().for_each(|pressures| pressures[slot] = 0.0);
        }
    }

    /// Makes the smallest change of positions, or velocities, of the supported nodes that satisfies the constraints of the active slots; prescribed components are kept.
    pub(super) fn meet_held_directions(&self, time: f64, demanded: impl Fn(&SupportedNode) -> f64, x: &mut [f64]) {
        let mut known: BTreeMap<u32, Directions> = BTreeMap::new();
        for (.., held) in self.supported_nodes(time).filter(|&(c, slot, _)| self.slots.active[c][slot]) {
            let of_node = known.entry(held.node).or_insert_with(|| self.prescribed_directions(held.node));
            // Normal to the directions already satisfied, which are kept.
            let Some(rest) = of_node.add(held.direction) else { continue };
            let missing = demanded(&held) - along(&held, x);
            let by = missing / dot(&rest, &held.direction);
            (0..3).for_each(|i| x[3 * held.node as usize + i] += by * rest[i]);
        }
    }

    /// Makes the positions at the start, and in dynamics the velocities, satisfy the sliding supports; embedded nodes follow.
    pub(super) fn start_at_sliding_supports(&mut self) {
        if !self.has_sliding_supports() {
            return;
        }
        let time = self.state.time;
        let (mut q, mut v) = (std::mem::take(&mut self.state.q), std::mem::take(&mut self.state.v));
        self.meet_held_directions(time, |held| held.place, &mut q);
        self.model.embedding.follow(&mut q);
        if self.how.scheme.is_some() {
            self.meet_held_directions(time, |held| held.rate, &mut v);
            self.model.embedding.follow(&mut v);
        }
        (self.state.q, self.state.v) = (q, v);
    }

    /// Removes the forces of sliding supports from the contact forces: they are reactions.
    pub(super) fn take_sliding_supports_from_contact_force(&mut self) {
        let mut force = std::mem::take(&mut self.forces.contact);
        for (c, slot, held) in self.supported_nodes(0.0) {
            let first = 3 * held.node as usize;
            for i in (0..3).filter(|i| self.system.matrix.numbering.equation[first + i] != NONE) {
                force[first + i] -= self.mean_pressures()[c][slot] * held.direction[i];
            }
        }
        self.forces.contact = force;
    }

    /// Reaction forces of the last step at prescribed components and sliding supports (`3 * nodes`; empty without either), but for sides of sections.
    /// In dynamics they are taken where the scheme evaluates its forces, for instance at the midpoint.
    pub fn reactions(&self) -> Cow<'_, [f64]> {
        let mut all = Cow::Borrowed(self.forces.reactions.as_slice());
        for (c, slot, held) in self.supported_nodes(0.0).filter(|(.., held)| !held.is_side) {
            let all = all.to_mut();
            if all.is_empty() {
                all.resize(self.state.q.len(), 0.0);
            }
            let force = self.mean_pressures()[c][slot];
            (0..3).for_each(|i| all[3 * held.node as usize + i] += force * held.direction[i]);
        }
        all
    }
}
