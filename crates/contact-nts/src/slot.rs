//! One potential constraint: where its node was at `n`, and with which facets it is paired in the step.

use crate::crossing::{MAX_NODES, local_of};
use crate::kinematics::{Gap, Local};
use stoss_contact::{ContactSurface, FacetNodes};
use stoss_reference_element::Nodal;
use stoss_term::StepConfiguration;

/// Returns of one node to a facet that it had in this step already, after which it stays on the extension of the last one. A node in a
/// valley or on a ridge can be sent back and forth between two facets without end. Staying is harmless: every pairing conserves, the extension
/// differs from the other facet by the kink times the overshoot, and the next step starts from there with its gap.
const MAX_RETURNS: u32 = 2;
/// Most facets of one node in one step; a search that finds the facet at once needs two or three.
const MAX_VISITS: usize = 8;

/// Facets of one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pairing {
    /// Facet against which the gap at `n` is measured, and whose gradient at `q_n` the start-point rules take.
    pub start: u32,
    /// Facet whose gradient the crossing element takes at the midpoint: start or end.
    pub mid: u32,
    /// Facet of the constraint at `n+1`.
    pub end: u32,
}

impl Pairing {
    /// One facet for the whole step.
    pub fn single(facet: u32) -> Self {
        Self { start: facet, mid: facet, end: facet }
    }
}

/// A slave node in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    /// Facet that the node was in contact with at the end of the last accepted step.
    pub committed: Option<u32>,
    /// Gap that the constraint keeps if the facet stays. Of an open node: the negative gap with which it was left behind the surface when it was
    /// released, until it has been in front; 0 otherwise. If such a node closes again it keeps what gap it has.
    pub kept: f64,
    /// Gap that it should keep: 0 for the standard form, the gap at `n` for the modified one. `kept` differs from it by the
    /// steps between the extended facets over which the node has slid slowly.
    pub wanted: f64,
    /// The part of `kept` that is a gap which was held when it closed, as the step leaves it, and by how much it comes down in the step.
    pub held: f64,
    pub settling: f64,
    /// Steps that the node has been closed without a break.
    pub steps: u32,
    /// An open node that got behind the surface from the side or from behind: it is no contact until it has been in front.
    pub strayed: bool,
    /// Facet at `n`: the committed one, or that found by the search; `None` if nothing is within reach.
    pub origin: Option<u32>,
    /// Gap at `n` to `origin`: to its extension if committed, else to the whole surface; infinite if there is none.
    pub origin_gap: f64,
    /// Pairing while active; `None` until [`stoss_term::Unilateral::repair`] made one.
    pub pairing: Option<Pairing>,
    /// Gap at `n` from which the work of the step is counted.
    pub gap_n: f64,
    /// Gap that the constraint keeps at `n+1`.
    pub reference: f64,
    /// The constraint takes back a part of what is misplaced although the facet stays: the work is then counted by the crossing element.
    pub relaxing: bool,
    /// The facet at the midpoint was chosen again in this step.
    pub rechosen: bool,
    visited: [u32; MAX_VISITS],
    visits: usize,
    returns: u32,
}

impl Slot {
    /// A node that has never touched.
    pub const FREE: Self = Self {
        committed: None,
        kept: 0.0,
        wanted: 0.0,
        held: 0.0,
        settling: 0.0,
        steps: 0,
        strayed: false,
        origin: None,
        origin_gap: f64::INFINITY,
        pairing: None,
        gap_n: f64::INFINITY,
        reference: 0.0,
        relaxing: false,
        rechosen: false,
        visited: [0; MAX_VISITS],
        visits: 0,
        returns: 0,
    };

    /// A node that is open at the start of a step; `kept` is negative if it was left behind the surface.
    pub fn open(origin: Option<u32>, origin_gap: f64, kept: f64, strayed: bool) -> Self {
        Self { origin, origin_gap, kept, strayed, ..Self::FREE }
    }

    /// A node in contact at the start of a step: on `facet`, with the gap `gap_n` there.
    pub fn closed(facet: u32, gap_n: f64, kept: f64, wanted: f64) -> Self {
        let origin = Some(facet);
        let mut slot = Self { committed: origin, kept, wanted, origin, origin_gap: gap_n, ..Self::FREE };
        slot.stay(facet);
        slot.admits(facet);
        slot
    }

    /// The slot with its gap held: it keeps what is `held` of it, after it has come down by `settling`.
    pub fn holding(self, held: f64, settling: f64, steps: u32) -> Self {
        let mut slot = Self { wanted: held, held, settling, steps, ..self };
        if let Some(facet) = slot.committed {
            slot.stay(facet);
        }
        slot
    }

    /// Pairs a node in contact at `n` with its own facet: it keeps the gap that it has there.
    pub fn stay(&mut self, facet: u32) {
        self.pairing = Some(Pairing::single(facet));
        self.gap_n = self.origin_gap;
        self.reference = self.kept - self.settling;
        self.relaxing = false;
    }

    /// Pairs a node in contact at `n` so that the crossing element does no work, and brings it nearer to the gap that it should keep by at
    /// most `most`: to go a fixed distance without work tilts the force by distance over motion, which small motions could not bear.
    pub fn cross(&mut self, pairing: Pairing, most: f64) {
        let off = self.kept - self.wanted;
        self.reference = self.wanted + (off - off.clamp(-most, most));
        self.gap_n = self.reference + (self.origin_gap - self.kept);
        self.relaxing = pairing.start == pairing.end;
        self.pairing = Some(pairing);
    }

    /// Whether the end may go to `facet`; keeps the record of such changes.
    pub fn admits(&mut self, facet: u32) -> bool {
        if self.visited[..self.visits].contains(&facet) {
            self.returns += 1;
            return self.returns <= MAX_RETURNS;
        }
        if self.visits == MAX_VISITS {
            return false;
        }
        self.visited[self.visits] = facet;
        self.visits += 1;
        true
    }
}

/// A paired slot at an iterate.
#[derive(Clone, Copy)]
pub(crate) struct PairedSlot<'a> {
    pub slot: usize,
    pub element: &'a ElementNodes,
    pub pairing: Pairing,
    /// Kinematics at `n+1` on the end facet.
    pub end: &'a Gap,
    pub step: StepConfiguration<'a>,
}

/// Nodes of a slot's element, each once: the slave node, the end facet, then what the start facet adds.
pub(crate) struct ElementNodes {
    pub count: usize,
    pub nodes: [u32; MAX_NODES],
    /// Local numbers of the start facet's nodes.
    pub start: Nodal<usize>,
    /// Local numbers of the end facet's nodes: the first masters.
    pub end: Nodal<usize>,
    /// Local numbers of the nodes of the midpoint's facet, one of the two.
    pub mid: Nodal<usize>,
}

impl ElementNodes {
    pub fn new(slave: u32, master: &ContactSurface, pairing: Pairing) -> Self {
        let facet = master.facets()[pairing.end as usize];
        let end = Nodal::from_fn(facet.kind(), |k| 1 + k);
        let mut out = Self { count: 1 + facet.len(), nodes: [0; MAX_NODES], start: end, end, mid: end };
        out.nodes[0] = slave;
        out.nodes[1..1 + facet.len()].copy_from_slice(&facet);
        if pairing.start != pairing.end {
            out.start = out.add(master.facets()[pairing.start as usize]);
            out.mid = if pairing.mid == pairing.start { out.start } else { end };
        }
        out
    }

    /// Local numbers of a facet's nodes; new ones are appended.
    fn add(&mut self, facet: FacetNodes) -> Nodal<usize> {
        facet.map(|node| match self.nodes[1..self.count].iter().position(|&n| n == node) {
            Some(k) => k + 1,
            None => {
                self.nodes[self.count] = node;
                self.count += 1;
                self.count - 1
            }
        })
    }

    /// Positions (or their increments) of the slave node and the end facet.
    pub fn local(&self, q: &[f64]) -> Local {
        local_of(&self.end, |k| std::array::from_fn(|i| q[3 * self.nodes[k] as usize + i]))
    }

    pub fn list(&self) -> &[u32] {
        &self.nodes[..self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slot_goes_on_but_not_to_and_fro() {
        let mut slot = Slot::closed(3, 0.0, 0.0, 0.0);
        assert!(slot.admits(4), "a facet not visited yet");
        assert!(slot.admits(3) && slot.admits(4), "two returns");
        assert!(!slot.admits(3), "the third");
        let mut slot = Slot::closed(0, 0.0, 0.0, 0.0);
        let admitted = (1..100).filter(|&f| slot.admits(f)).count();
        assert_eq!(admitted, MAX_VISITS - 1);
    }

    #[test]
    fn crossing_brings_the_node_back_without_work() {
        // It keeps 0.1 too much and may come back by 0.03 a step.
        let mut slot = Slot::closed(0, 0.1, 0.1, 0.0);
        slot.cross(Pairing { start: 0, mid: 1, end: 1 }, 0.03);
        assert!((slot.reference - 0.07).abs() < 1e-15 && slot.gap_n == slot.reference);
        slot.cross(Pairing::single(0), 1.0);
        assert!(slot.reference == 0.0 && slot.relaxing);
        slot.stay(0);
        assert!(slot.reference == 0.1 && !slot.relaxing);
    }
}
