//! Directions of nodes that the ground holds: which of them say something, positions and velocities that agree with them, forces.

use super::Simulation;
use crate::guide::along;
use std::borrow::Cow;
use std::collections::BTreeMap;
use stoss_contact::Held;
use stoss_linalg::NONE;

/// Sine of the angle below which a direction follows from others of the same node.
const DEPENDENT: f64 = 1.0e-6;

type Vector = [f64; 3];

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Orthonormal directions of a node, made one after the other.
#[derive(Debug, Default)]
struct Directions(Vec<Vector>);

impl Directions {
    /// The part of a direction across all of them, and its size.
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

    /// Adds a direction; the part that is new, or `None` if there is none.
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
        let held = |i: &usize| self.system.numbering.equation[3 * node as usize + i] == NONE;
        Directions((0..3).filter(held).map(|i| std::array::from_fn(|k| f64::from(u8::from(k == i)))).collect())
    }

    /// Slots that hold a node along a direction at a time, as pair, slot and what they hold; those of what is switched off are none.
    fn held(&self, time: f64) -> impl Iterator<Item = (usize, usize, Held)> {
        self.model.contacts.iter().enumerate().flat_map(move |(c, pair)| {
            let count = if pair.method.held(0, time).is_some() { pair.method.slot_count() } else { 0 };
            (0..count).filter_map(move |slot| Some((c, slot, pair.method.held(slot, time)?)))
        })
    }

    /// Whether the ground holds a node along a direction.
    pub(super) fn has_guides(&self) -> bool {
        self.held(0.0).next().is_some()
    }

    /// Deactivates slots whose direction follows from prescribed components and from directions of other slots at the same node, as at the common edge of symmetry
    /// planes that are given twice. Whether their motions agree is looked at after each step.
    pub(super) fn drop_dependent_directions(&mut self) {
        let mut known: BTreeMap<u32, Directions> = BTreeMap::new();
        let mut dropped = Vec::new();
        for (c, slot, held) in self.held(0.0) {
            let of_node = known.entry(held.node).or_insert_with(|| self.prescribed_directions(held.node));
            if of_node.add(held.direction).is_none() {
                dropped.push((c, slot));
            }
        }
        for (c, slot) in dropped {
            self.active[c][slot] = false;
            self.pressures[c][slot] = 0.0;
        }
    }

    /// Changes positions, or velocities, of the held nodes by the least so that the directions of the slots with multipliers are as demanded; prescribed components stay.
    pub(super) fn guide(&self, time: f64, demanded: impl Fn(&Held) -> f64, x: &mut [f64]) {
        let mut known: BTreeMap<u32, Directions> = BTreeMap::new();
        for (.., held) in self.held(time).filter(|&(c, slot, _)| self.active[c][slot]) {
            let of_node = known.entry(held.node).or_insert_with(|| self.prescribed_directions(held.node));
            // Across what was set before, so that it stays.
            let Some(rest) = of_node.add(held.direction) else { continue };
            let missing = demanded(&held) - along(&held, x);
            let by = missing / dot(&rest, &held.direction);
            (0..3).for_each(|i| x[3 * held.node as usize + i] += by * rest[i]);
        }
    }

    /// Positions at the start, and in dynamics velocities, that agree with what is held; embedded nodes follow.
    pub(super) fn start_guided(&mut self) {
        if !self.has_guides() {
            return;
        }
        let time = self.state.time;
        let (mut q, mut v) = (std::mem::take(&mut self.state.q), std::mem::take(&mut self.state.v));
        self.guide(time, |held| held.place, &mut q);
        self.model.embedding.follow(&mut q);
        if self.scheme.is_some() {
            self.guide(time, |held| held.rate, &mut v);
            self.model.embedding.follow(&mut v);
        }
        (self.state.q, self.state.v) = (q, v);
    }

    /// Forces along held directions are reactions, not forces of contact.
    pub(super) fn take_guides_from_contact_force(&mut self) {
        let mut force = std::mem::take(&mut self.contact_force);
        for (c, slot, held) in self.held(0.0) {
            let first = 3 * held.node as usize;
            for i in (0..3).filter(|i| self.system.numbering.equation[first + i] != NONE) {
                force[first + i] -= self.pressures[c][slot] * held.direction[i];
            }
        }
        self.contact_force = force;
    }

    /// Forces that the ground exerted in the last step on prescribed components and along held directions (`3 * nodes`; empty without either).
    /// Under a scheme they are those at the point where its forces are taken.
    pub fn reactions(&self) -> Cow<'_, [f64]> {
        let mut all = Cow::Borrowed(self.reactions.as_slice());
        for (c, slot, held) in self.held(0.0) {
            let all = all.to_mut();
            if all.is_empty() {
                all.resize(self.state.q.len(), 0.0);
            }
            let force = self.pressures[c][slot];
            (0..3).for_each(|i| all[3 * held.node as usize + i] += force * held.direction[i]);
        }
        all
    }
}
