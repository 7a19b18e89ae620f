//! Groups of closed slots (theory/impacts#groups): impulses of one group change no rate of another one.

use super::Closed;
use super::rows::Row;
use crate::Model;
use crate::masses::Masses;
use stoss_linalg::NONE;

/// Closed slots that bodies, ties and joints connect.
#[derive(Clone, Debug, Default)]
pub(super) struct Group {
    /// Closed slots, ascending.
    pub slots: Vec<usize>,
    /// Bilateral rows, ascending.
    pub held: Vec<usize>,
    /// Whether one of the slots closed in the step.
    pub is_new: bool,
}

/// The groups, in the order of their first slots, and what belongs to which of them: its number, or [`NONE`].
#[derive(Debug, Default)]
pub(super) struct Groups {
    pub groups: Vec<Group>,
    of_nodes: Vec<u32>,
    of_bodies: Vec<u32>,
    of_parts: Vec<u32>,
    /// Group of each constraint of the model.
    pub of_pairs: Vec<u32>,
    /// Group of each closed slot.
    pub of_slots: Vec<u32>,
    /// Group of each bilateral row.
    pub of_held: Vec<u32>,
}

/// Sets of nodes that are connected, each known by its first node.
struct Sets(Vec<u32>);

impl Sets {
    fn first(&mut self, node: u32) -> u32 {
        let mut at = node;
        while self.0[at as usize] != at {
            let next = self.0[self.0[at as usize] as usize];
            self.0[at as usize] = next;
            at = next;
        }
        at
    }

    fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.0[a.max(b) as usize] = a.min(b);
    }

    fn unite_all(&mut self, nodes: impl IntoIterator<Item = u32>) {
        let mut nodes = nodes.into_iter();
        if let Some(first) = nodes.next() {
            nodes.for_each(|node| self.unite(first, node));
        }
    }
}

impl Groups {
    /// The groups of closed slots. Connected are the nodes of a body, those that masses of parts couple, those of a row as far as they have equations (`is_free`, of a component), and all slots
    /// of one constraint, whose work in the step is known as a sum.
    pub fn new(model: &Model, masses: &Masses, is_free: &dyn Fn(u32) -> bool, closed: &Closed, held: &[Row]) -> Self {
        let mut sets = Sets((0..model.node_count() as u32).collect());
        for body in &model.bodies {
            sets.unite_all(body.nodes.clone());
            for node in body.nodes.clone() {
                let carriers = model.embedding.carriers(node).unwrap_or_default();
                carriers.iter().for_each(|&(carrier, _)| sets.unite(node, carrier));
            }
        }
        for (part, mass) in model.parts.iter().zip(&masses.parts) {
            if !mass.entries.is_empty() {
                sets.unite_all(part.own_vectors());
            }
            mass.entries.iter().for_each(|&(i, j, _)| sets.unite(i, j));
        }
        let free =
            |row: &Row| -> Vec<u32> { row.entries.iter().filter(|(c, _)| is_free(*c)).map(|(c, _)| c / 3).collect() };
        held.iter().for_each(|row| sets.unite_all(free(row)));
        let mut of_pair = vec![None; model.contacts.len()];
        for (row, &(c, _)) in closed.rows.iter().zip(&closed.slots) {
            let nodes = free(row);
            of_pair[c] = of_pair[c].or(nodes.first().copied());
            sets.unite_all(nodes.into_iter().chain(of_pair[c]));
        }
        let mut groups: Vec<Group> = Vec::new();
        let mut of_first = vec![NONE; model.node_count()];
        let mut of_slots = Vec::with_capacity(closed.rows.len());
        let mut of_pairs = vec![NONE; model.contacts.len()];
        for (k, (row, &(c, _))) in closed.rows.iter().zip(&closed.slots).enumerate() {
            // Between things that cannot move a slot is where the others of its constraint are.
            let node = of_pair[c].or(row.entries.first().map(|(c, _)| c / 3)).unwrap_or(0);
            let group = &mut of_first[sets.first(node) as usize];
            if *group == NONE {
                *group = groups.len() as u32;
                groups.push(Group::default());
            }
            of_slots.push(*group);
            of_pairs[c] = *group;
            let group = &mut groups[*group as usize];
            group.slots.push(k);
            group.is_new |= closed.is_new[k];
        }
        let of_nodes: Vec<u32> = (0..model.node_count() as u32).map(|n| of_first[sets.first(n) as usize]).collect();
        let of_node = |node: Option<u32>| node.map_or(NONE, |node| of_nodes[node as usize]);
        let of_held: Vec<u32> = held.iter().map(|row| of_node(free(row).first().copied())).collect();
        for (k, &group) in of_held.iter().enumerate().filter(|(_, group)| **group != NONE) {
            groups[group as usize].held.push(k);
        }
        let of_bodies = model.bodies.iter().map(|body| of_node(body.nodes.clone().next())).collect();
        let of_parts = masses.parts.iter().map(|mass| of_node(mass.entries.first().map(|entry| entry.0))).collect();
        Self { groups, of_nodes, of_bodies, of_parts, of_pairs, of_slots, of_held }
    }

    /// Group of a component.
    pub fn of_component(&self, component: usize) -> u32 {
        self.of_nodes[component / 3]
    }

    /// Kinetic energy of each group at the velocities `v`.
    pub fn kinetic_energies(&self, masses: &Masses, v: &[f64]) -> Vec<f64> {
        masses.kinetic_energies(v, [&self.of_bodies, &self.of_parts], self.groups.len())
    }

    /// Sum over the constraints of each group.
    pub fn sums(&self, of_pairs: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut sums = vec![0.0; self.groups.len()];
        for (value, &group) in of_pairs.into_iter().zip(&self.of_pairs).filter(|(_, group)| **group != NONE) {
            sums[group as usize] += value;
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_connected_has_one_first_node() {
        let mut sets = Sets((0..8).collect());
        sets.unite_all([5, 3, 7]);
        sets.unite(1, 2);
        sets.unite(7, 2);
        let first: Vec<u32> = (0..8).map(|node| sets.first(node)).collect();
        assert_eq!(first, [0, 1, 1, 1, 4, 1, 6, 1]);
    }
}
