//! Which nodes and slots contributions join, and which equations that makes.

use crate::Model;
use crate::numbering::Numbering;
use crate::shares::Shares;
use std::ops::Range;
use stoss_linalg::NONE;
use stoss_term::{Share, Term};

/// Lists of equation numbers, flat.
#[derive(Debug, Default, Clone)]
pub(crate) struct StencilList {
    pub starts: Vec<usize>,
    entries: Vec<u32>,
}

impl StencilList {
    pub fn push(&mut self, fill: impl FnOnce(&mut Vec<u32>)) {
        self.starts.push(self.entries.len());
        fill(&mut self.entries);
    }

    /// Adds the stencils of a term without slots; returns their numbers. What is not kept has an empty one.
    pub fn push_term(&mut self, term: &dyn Term, numbering: &Numbering, keep: impl Fn(u32) -> bool) -> Range<usize> {
        let first = self.starts.len();
        term.stencils(&[], &mut |nodes, _| {
            let kept = if nodes.first().is_none_or(|&node| keep(node)) { nodes } else { &[] };
            self.push(|out| numbering.node_equations(kept, out));
        });
        first..self.starts.len()
    }

    pub fn iter(&self) -> impl Iterator<Item = &[u32]> + Clone {
        (0..self.starts.len()).map(|k| {
            let end = self.starts.get(k + 1).copied().unwrap_or(self.entries.len());
            &self.entries[self.starts[k]..end]
        })
    }
}

/// Nodes and slots of contact contributions.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Contributions {
    /// Pair, number of nodes and number of slots, and the first node as the method names it.
    heads: Vec<[u32; 4]>,
    /// Nodes, then slots, of one after the other.
    entries: Vec<u32>,
}

impl Contributions {
    /// Contributions of the couplings that act, in the order in which the methods visit them.
    pub fn active(model: &Model, active: &[Vec<bool>]) -> Self {
        let mut list = Self::default();
        for (c, pair) in model.couplings() {
            pair.term.stencils(&active[c], &mut |nodes, slots| list.push(model, c, nodes, slots));
        }
        list
    }

    /// Adds a contribution, with carriers in place of embedded nodes.
    pub fn push(&mut self, model: &Model, pair: usize, nodes: &[u32], slots: &[u32]) {
        let (mut expanded, first) = (Vec::new(), nodes.first().copied().unwrap_or(0));
        let nodes = if model.embedding.touches(nodes) {
            model.embedding.expand(nodes, &mut expanded);
            &expanded
        } else {
            nodes
        };
        self.heads.push([pair as u32, nodes.len() as u32, slots.len() as u32, first]);
        self.entries.extend_from_slice(nodes);
        self.entries.extend_from_slice(slots);
    }

    /// Pair, nodes, slots.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &[u32], &[u32])> + Clone {
        let mut start = 0;
        self.heads.iter().map(move |&[pair, nodes, slots, _]| {
            let (middle, end) = (start + nodes as usize, start + (nodes + slots) as usize);
            let item = (pair as usize, &self.entries[start..middle], &self.entries[middle..end]);
            start = end;
            item
        })
    }

    pub fn append(&mut self, other: &Self) {
        self.heads.extend_from_slice(&other.heads);
        self.entries.extend_from_slice(&other.entries);
    }

    /// Equations of each: those of the displacements, then those of the pressures, then those of the auxiliaries, slot by slot; of those of other ranks none.
    pub fn stencils(
        &self,
        numbering: &Numbering,
        slot_equation: &[Vec<u32>],
        slot_width: &[u32],
        shares: &Shares,
    ) -> StencilList {
        let mut list = StencilList::default();
        let of_pairs: Vec<Share> = (0..slot_equation.len()).map(|pair| shares.of_coupling(pair)).collect();
        for ((pair, nodes, slots), [.., first]) in self.iter().zip(&self.heads) {
            let (equations, width) = (&slot_equation[pair], slot_width[pair]);
            list.push(|out| {
                if !of_pairs[pair].has(&[*first]) {
                    return;
                }
                numbering.node_equations(nodes, out);
                out.extend(slots.iter().map(|&slot| equations[slot as usize]));
                for &slot in slots {
                    let first = equations[slot as usize];
                    out.extend((1..width).map(|k| if first == NONE { NONE } else { first + k }));
                }
            });
        }
        list
    }
}
