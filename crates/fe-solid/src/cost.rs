//! What an element costs in an iteration, for dividing elements among ranks. Not a measurement of a run: clocks of ranks differ.

use crate::{SolidBody, Volumetric};

/// Solution of the linear equations, for each node: 13 us by smoothed aggregation to 55 us by elimination of some ten thousand nodes.
const SOLUTION: u64 = 27_000;
/// Force and tangent of a neo-Hooke law at a Gauss point: a part of its own, and one for each two nodes.
const POINT: u64 = 240;
const PAIR: u64 = 2;
/// What a law with a state and averages of the change of volume take more.
const STATE: u64 = 1_900;
const AVERAGE: u64 = 600;

impl SolidBody {
    /// The time that each element of the body takes in an iteration, in nanoseconds of the machine that the parts were measured on: stress and tangent at its points, by their number, its nodes, and
    /// whether the law has a state or sees averages; and the solution of the linear equations of its nodes, each divided among the elements around it. Nothing depends on the rank. Weights of
    /// [`stoss_term::bisect`].
    pub fn element_costs(&self) -> Vec<u64> {
        let mut around = vec![0_u64; self.node_count()];
        let local = |node: &u32| (node - self.node_offset()) as usize;
        self.elements().iter().flatten().for_each(|node| around[local(node)] += 1);
        let options = self.options();
        let mut more = if self.has_history() { STATE } else { 0 };
        if options.volumetric == Volumetric::Mixed {
            more += AVERAGE;
        }
        let cost = |(kind, nodes): (_, &[u32])| {
            let (points, nodes_squared) = (options.rule(kind).len() as u64, nodes.len().pow(2) as u64);
            let solution: u64 = nodes.iter().map(|node| SOLUTION / around[local(node)]).sum();
            points * (POINT + PAIR * nodes_squared + more) + solution
        };
        self.elements().cells().map(cost).collect()
    }
}
