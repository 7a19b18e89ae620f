//! One potential constraint: where its node touched at `n`, and with which facet it is paired at `n+1`.

use crate::crossing::MAX_NODES;
use stoss_contact::ContactSurface;

/// A slave node in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Slot {
    /// Facet that the node was in contact with at the end of the last accepted step.
    pub committed: Option<u32>,
    /// Facet against which the gap at `n` is measured.
    pub start: Option<u32>,
    /// Gap at `n` on that facet; infinite if there is none.
    pub gap_n: f64,
    /// Facet of the constraint at `n+1`.
    pub end: Option<u32>,
    /// Changes of `end` while active in this step.
    pub switches: u32,
}

/// Nodes of a slot's element, each once: the slave node, the end facet, then what the start facet adds.
pub(crate) struct ElementNodes {
    pub count: usize,
    pub nodes: [u32; MAX_NODES],
    /// Local numbers of the end facet's nodes.
    pub end: [usize; 4],
    /// Local numbers of the start facet's nodes.
    pub start: [usize; 4],
}

impl ElementNodes {
    pub fn new(slave: u32, master: &ContactSurface, start: u32, end: u32) -> Self {
        let mut out = Self { count: 5, nodes: [0; MAX_NODES], end: [1, 2, 3, 4], start: [1, 2, 3, 4] };
        out.nodes[0] = slave;
        out.nodes[1..5].copy_from_slice(&master.facets()[end as usize]);
        if start != end {
            for (slot, &node) in out.start.iter_mut().zip(&master.facets()[start as usize]) {
                *slot = match out.nodes[1..out.count].iter().position(|&n| n == node) {
                    Some(k) => k + 1,
                    None => {
                        out.nodes[out.count] = node;
                        out.count += 1;
                        out.count - 1
                    }
                };
            }
        }
        out
    }

    pub fn list(&self) -> &[u32] {
        &self.nodes[..self.count]
    }
}
