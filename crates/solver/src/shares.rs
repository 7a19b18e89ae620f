//! Which rank evaluates which elements and contributions, and the sums over the ranks (theory/scale-out). Not the matrix: the linear solver sums its parts up.
//!
//! All ranks have the same state and take the same decisions. A rank evaluates its elements; a sum of nodal vectors is formed by the rank that owns the node, in the order of the ranks, and goes
//! to all. So all ranks have the same bits, which depend on the number of ranks alone. With one rank every method is a branch and nothing is stored.

use crate::{Model, StepError};
use std::sync::Arc;
use stoss_fe_solid::{InsideOut, SolidError};
use stoss_linalg::{Communicator, GatheredSolver, LinearSolver, Serial};
use stoss_term::{At, Fault, Local, Share, Term, Work};

/// Numbers for each rank below which all ranks sum all of them up: one operation less.
const SHORT: usize = 16;

/// What cannot be evaluated on one of the ranks: the same on all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{text}")]
pub struct RankFault {
    /// The message of the rank that has it.
    pub text: String,
    /// Body and element, if it is one.
    pub element: Option<(String, usize)>,
}

/// The share of this rank.
#[derive(Debug)]
pub(crate) struct Shares {
    communicator: Arc<dyn Communicator>,
    /// Rank of each node; of what belongs to no element the first one. Empty with one rank.
    owner: Vec<u32>,
    /// Rank of each element of each body; empty with one rank.
    elements: Vec<Vec<u32>>,
    /// Contributions of each coupling; empty with one rank.
    couplings: Vec<OfCoupling>,
    /// Nodes that this rank adds to, ascending.
    touched: Vec<u32>,
    /// Nodes among the touched ones that another rank owns, by rank, and those that this rank owns and others add to, by rank.
    lent: Lists,
    borrowed: Lists,
    /// Nodes that any rank adds to, by the rank that owns them.
    owned: Lists,
}

/// The contributions of a coupling that are this rank's.
#[derive(Debug)]
struct OfCoupling {
    share: Share,
    /// Whether the coupling evaluates those alone.
    deals: bool,
}

impl Default for Shares {
    fn default() -> Self {
        let (owner, elements, couplings, touched) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let [lent, borrowed, owned] = std::array::from_fn(|_| Lists::default());
        Self { communicator: Serial::shared(), owner, elements, couplings, touched, lent, borrowed, owned }
    }
}

/// Nodes of each rank, one rank after the other.
#[derive(Debug, Default)]
struct Lists {
    nodes: Vec<u32>,
    /// Numbers of components.
    counts: Vec<usize>,
}

impl Lists {
    /// The lists from pairs of a rank and a node.
    fn new(mut pairs: Vec<(u32, u32)>, ranks: usize) -> Self {
        pairs.sort_unstable();
        pairs.dedup();
        let mut counts = vec![0; ranks];
        pairs.iter().for_each(|&(rank, _)| counts[rank as usize] += 3);
        Self { nodes: pairs.into_iter().map(|(_, node)| node).collect(), counts }
    }

    fn of_rank(&self, rank: usize) -> &[u32] {
        let first: usize = self.counts[..rank].iter().sum();
        &self.nodes[first / 3..(first + self.counts[rank]) / 3]
    }
}

fn packed(nodes: &[u32], values: &[f64]) -> Vec<f64> {
    nodes.iter().flat_map(|&node| &values[3 * node as usize..3 * node as usize + 3]).copied().collect()
}

fn add_packed(nodes: &[u32], packed: &[f64], values: &mut [f64]) {
    for (&node, from) in nodes.iter().zip(packed.chunks_exact(3)) {
        let to = &mut values[3 * node as usize..3 * node as usize + 3];
        to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
    }
}

/// Nodes that the bodies' elements of this rank add to, ascending: their own, and those that carry masses of others.
fn touched(model: &Model) -> Vec<u32> {
    let mut nodes = Vec::new();
    for body in &model.bodies {
        body.solid.stencils().for_each(|of| nodes.extend_from_slice(of));
        if body.massless.is_some() {
            body.mass(1.0).stencils().for_each(|of| nodes.extend_from_slice(of));
        }
    }
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

impl Shares {
    /// Shares out the elements of the bodies, which keep the data of those of this rank.
    pub fn new(model: &mut Model, communicator: Arc<dyn Communicator>) -> Result<Arc<Self>, StepError> {
        let (rank, ranks) = (communicator.rank() as u32, communicator.size());
        if ranks == 1 {
            return Ok(Arc::new(Self { communicator, ..Self::default() }));
        }
        let elements = crate::partition::of_elements(model, ranks);
        let of_bodies = model.bodies.iter().zip(&elements);
        let pairs = || of_bodies.clone().flat_map(|(body, ranks)| body.solid.elements().iter().zip(ranks));
        let mut owner = vec![u32::MAX; model.node_count()];
        for (nodes, &of) in pairs() {
            nodes.iter().for_each(|&node| owner[node as usize] = owner[node as usize].min(of));
        }
        owner.iter_mut().filter(|of| **of == u32::MAX).for_each(|of| *of = 0);
        for (body, ranks) in model.bodies.iter_mut().zip(&elements) {
            let mine: Vec<bool> = ranks.iter().map(|&of| of == rank).collect();
            body.solid.share(&mine).map_err(Fault::from)?;
        }
        let touched = touched(model);
        let bytes: Vec<u8> = touched.iter().flat_map(|node| node.to_le_bytes()).collect();
        let (mut lent, mut borrowed, mut owned) = (Vec::new(), Vec::new(), Vec::new());
        for (of, bytes) in (0_u32..).zip(communicator.gather_bytes(&bytes)) {
            for node in bytes.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)) {
                let owner = owner[node as usize];
                owned.push((owner, node));
                if owner != of && of == rank {
                    lent.push((owner, node));
                } else if owner != of && owner == rank {
                    borrowed.push((of, node));
                }
            }
        }
        let couplings = model.contacts.iter_mut().map(|pair| {
            let share = Share::new(ranks as u32, rank);
            match pair.term.set_share(share.clone()) {
                Some(share) => OfCoupling { share, deals: true },
                None => OfCoupling { share, deals: false },
            }
        });
        let couplings = couplings.collect();
        let [lent, borrowed, owned] = [lent, borrowed, owned].map(|pairs| Lists::new(pairs, ranks));
        Ok(Arc::new(Self { communicator, owner, elements, couplings, touched, lent, borrowed, owned }))
    }

    /// Whether there is more than one rank.
    pub fn is_shared(&self) -> bool {
        !self.owner.is_empty()
    }

    /// Whether this is the first rank.
    pub fn is_first(&self) -> bool {
        self.communicator.rank() == 0
    }

    /// A solver of one rank for matrices of which each rank has a part.
    pub fn gathered(&self, solver: Box<dyn LinearSolver>) -> Box<dyn LinearSolver> {
        if self.is_shared() { Box::new(GatheredSolver::new(Arc::clone(&self.communicator), solver)) } else { solver }
    }

    /// Rank of a node, or of the label of a group.
    pub fn owner(&self, node: u32) -> u32 {
        self.owner.get(node as usize).copied().unwrap_or(0)
    }

    /// Whether what begins with this node is this rank's.
    pub fn has(&self, node: u32) -> bool {
        self.owner(node) as usize == self.communicator.rank()
    }

    /// Whose the contributions of a coupling are in the matrix.
    pub fn of_coupling(&self, coupling: usize) -> Share {
        self.couplings.get(coupling).map_or_else(Share::default, |of| of.share.clone())
    }

    /// Whether the ranks evaluate the contributions of a coupling each in part.
    pub fn deals(&self, coupling: usize) -> bool {
        self.couplings.get(coupling).is_some_and(|of| of.deals)
    }

    /// Residuals of all contributions of a coupling at an iterate, as one rank alone visits them: those that other ranks evaluate are sent.
    pub fn visit_all(
        &self,
        coupling: usize,
        term: &dyn Term,
        at: &At<'_>,
        visit: &mut (dyn FnMut(&Local) + Send),
    ) -> Result<(), Fault> {
        let Some(of) = self.couplings.get(coupling).filter(|of| of.deals) else {
            return term.assemble(at, false, visit);
        };
        let (mut locals, mut mine): (Vec<Local>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut counts = vec![0; self.communicator.size()];
        let assembled = term.assemble(at, false, &mut |local| {
            counts[of.share.owner(&local.nodes) as usize] += local.dim();
            if !local.is_elsewhere {
                mine.extend_from_slice(&local.residual);
            }
            locals.push(local.clone());
        });
        self.agree(assembled)?;
        let mut all = vec![0.0; counts.iter().sum()];
        self.communicator.gather(&mine, &counts, &mut all);
        let mut next: Vec<usize> = (0..counts.len()).map(|rank| counts[..rank].iter().sum()).collect();
        for mut local in locals {
            let next = &mut next[of.share.owner(&local.nodes) as usize];
            let end = *next + local.dim();
            local.residual.clear();
            local.residual.extend_from_slice(&all[*next..end]);
            *next = end;
            local.is_elsewhere = false;
            visit(&local);
        }
        Ok(())
    }

    /// Adds to `out` the sum over the ranks of what `add` adds at nodes of elements.
    pub fn add_sum<T>(&self, out: &mut [f64], add: impl FnOnce(&mut [f64]) -> T) -> T {
        if !self.is_shared() {
            return add(out);
        }
        let mut part = vec![0.0; out.len()];
        let result = add(&mut part);
        debug_assert!(self.has_touched(&part), "something was added at a node that this rank does not know of");
        let mut received = vec![0.0; 3 * self.borrowed.nodes.len()];
        let (lent, borrowed) = (&self.lent, &self.borrowed);
        self.communicator.exchange(&packed(&lent.nodes, &part), &lent.counts, &mut received, &borrowed.counts);
        add_packed(&borrowed.nodes, &received, &mut part);
        let mine = packed(self.owned.of_rank(self.communicator.rank()), &part);
        let mut all = vec![0.0; 3 * self.owned.nodes.len()];
        self.communicator.gather(&mine, &self.owned.counts, &mut all);
        add_packed(&self.owned.nodes, &all, out);
        result
    }

    /// Sums of numbers over the ranks, each formed by one rank if there are many.
    pub fn sum_all(&self, values: &mut [f64]) {
        if !self.is_shared() {
            return;
        }
        if values.len() < SHORT * self.communicator.size() {
            self.communicator.sum(values);
        } else {
            values.copy_from_slice(&self.sums_by_slices(values));
        }
    }

    /// Each rank sums a slice of the numbers, in the order of the ranks; then all get all.
    fn sums_by_slices(&self, part: &[f64]) -> Vec<f64> {
        let (rank, ranks) = (self.communicator.rank(), self.communicator.size());
        let start = |r: usize| part.len() * r / ranks;
        let counts: Vec<usize> = (0..ranks).map(|r| start(r + 1) - start(r)).collect();
        let own = counts[rank];
        let mut received = vec![0.0; own * ranks];
        self.communicator.exchange(part, &counts, &mut received, &vec![own; ranks]);
        let mut sums = vec![0.0; own];
        for of_rank in received.chunks_exact(own.max(1)) {
            sums.iter_mut().zip(of_rank).for_each(|(sum, value)| *sum += value);
        }
        let mut all = vec![0.0; part.len()];
        self.communicator.gather(&sums, &counts, &mut all);
        all
    }

    /// Sum of a number over the ranks.
    pub fn sum(&self, value: f64) -> f64 {
        if self.is_shared() { self.communicator.sum_of(value) } else { value }
    }

    /// Sums of three numbers.
    pub fn sum3(&self, mut values: [f64; 3]) -> [f64; 3] {
        self.sum_all(&mut values);
        values
    }

    /// Whether nothing but nodes that this rank adds to have values.
    fn has_touched(&self, part: &[f64]) -> bool {
        let nodes = part.chunks_exact(3).zip(0..);
        nodes.filter(|(x, _)| **x != [0.0; 3]).all(|(_, node)| self.touched.binary_search(&node).is_ok())
    }

    /// Adds to `out`, at each of some components, the sum over the ranks of `part`. The components are the same on all ranks, each of which sums a slice of them in the order of the ranks.
    pub fn add_sum_at(&self, components: &[u32], part: &[f64], out: &mut [f64]) {
        let mine: Vec<f64> = components.iter().map(|&c| part[c as usize]).collect();
        components.iter().zip(self.sums_by_slices(&mine)).for_each(|(&c, sum)| out[c as usize] += sum);
    }

    /// Whether it is true on any rank.
    pub fn any(&self, value: bool) -> bool {
        if self.is_shared() { self.communicator.any(value) } else { value }
    }

    /// Largest of the ranks' numbers, of each of a list.
    pub fn max_all(&self, values: &mut [f64]) {
        if !self.is_shared() {
            return;
        }
        let (n, ranks) = (values.len(), self.communicator.size());
        let mut all = vec![0.0; n * ranks];
        self.communicator.gather(values, &vec![n; ranks], &mut all);
        for of_rank in all.chunks_exact(n.max(1)) {
            values.iter_mut().zip(of_rank).for_each(|(largest, value)| *largest = largest.max(*value));
        }
    }

    /// A result of this rank's share: an error on any rank is one on all, with the message of the first rank that has one.
    pub fn agree<T>(&self, result: Result<T, Fault>) -> Result<T, Fault> {
        if !self.is_shared() {
            return result;
        }
        let text = result.as_ref().err().map(written);
        match self.communicator.first_text(text.as_deref()) {
            Some(text) => Err(read(&text)),
            None => result,
        }
    }

    /// Work of bodies: sums over the ranks, and the largest flow of a point.
    pub fn sum_work(&self, works: &mut [Work]) {
        if !self.is_shared() {
            return;
        }
        let mut sums: Vec<f64> = works
            .iter()
            .flat_map(|Work { stored, dissipated, material: of, .. }| {
                [*stored, *dissipated, of.hardening, of.plastic, of.viscous, of.softening]
            })
            .collect();
        self.sum_all(&mut sums);
        let mut flows: Vec<f64> = works.iter().map(|work| work.material.flow).collect();
        self.max_all(&mut flows);
        for ((work, sum), flow) in works.iter_mut().zip(sums.chunks_exact(6)).zip(flows) {
            (work.stored, work.dissipated) = (sum[0], sum[1]);
            let of = &mut work.material;
            (of.hardening, of.plastic, of.viscous, of.softening) = (sum[2], sum[3], sum[4], sum[5]);
            of.flow = flow;
        }
    }

    /// The worst of what the ranks found in a body.
    pub fn worst(&self, found: Option<InsideOut>) -> Option<InsideOut> {
        if !self.is_shared() {
            return found;
        }
        let mine = found.map_or([0.0; 4], |f| [f.count as f64, f.element as f64, f.node as f64, f.relative_volume]);
        let mut all = vec![0.0; 4 * self.communicator.size()];
        self.communicator.gather(&mine, &vec![4; self.communicator.size()], &mut all);
        let found = all.chunks_exact(4).filter(|f| f[0] > 0.0).map(|f| {
            let [count, element, node] = [f[0], f[1], f[2]].map(|number| number as usize);
            InsideOut { count, element, node, relative_volume: f[3] }
        });
        found.reduce(|a, b| a.and(&b))
    }

    /// The history of a term of the model, in the order of [`Model::terms`], from what each rank has of it.
    pub fn history(&self, model: &Model, number: usize, mine: Vec<u8>) -> Vec<u8> {
        let first_coupling = model.terms().count() - model.contacts.len();
        let coupling = number.checked_sub(first_coupling).filter(|&c| self.deals(c));
        let body = model.bodies.get(number).filter(|_| self.is_shared());
        if body.is_none() && coupling.is_none() {
            return mine;
        }
        let parts = self.communicator.gather_bytes(&mine);
        // cannot fail: each rank has what it was given.
        match (body, coupling) {
            (Some(body), _) => body.solid.merge_history(&parts, &self.elements[number]).unwrap_or_default(),
            (_, Some(coupling)) => model.contacts[coupling].term.join_histories(&parts).unwrap_or_default(),
            _ => mine,
        }
    }

    /// Ends the run if the ranks do not have the same bits any more: whatever was not summed up shows here at once.
    ///
    /// # Panics
    /// If they do not.
    pub fn compare<'a>(&self, step: u64, values: impl Iterator<Item = &'a f64>) {
        if !self.is_shared() {
            return;
        }
        let mix = |hash: u64, x: &f64| (hash ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3).rotate_left(23);
        let hash = values.fold(0xcbf2_9ce4_8422_2325, mix);
        let all = self.communicator.gather_bytes(&hash.to_le_bytes());
        assert!(all.iter().all(|other| *other == all[0]), "the ranks have drifted apart in step {step}");
    }
}

/// The mark between the parts of a written fault.
const BREAK: char = '\u{1f}';

/// Kind, body, element and message.
fn written(fault: &Fault) -> String {
    let element = match fault.cause() {
        Some(
            SolidError::InvertedElement { body, element, .. }
            | SolidError::CollapsedElement { body, element, .. }
            | SolidError::Constitutive { body, element, .. },
        ) => format!("{element}{BREAK}{body}"),
        _ => BREAK.to_string(),
    };
    format!("{}{BREAK}{element}{BREAK}{fault}", fault.is_undefined())
}

fn read(text: &str) -> Fault {
    let mut parts = text.splitn(4, BREAK);
    let mut next = || parts.next().unwrap_or_default();
    let (undefined, element, body, text) = (next() == "true", next(), next(), next());
    let element = element.parse().ok().map(|element| (body.to_owned(), element));
    let cause = RankFault { text: text.to_owned(), element };
    if undefined { Fault::undefined(cause) } else { Fault::other(cause) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stoss_linalg::Threads;
    use stoss_term::Undefined;

    #[test]
    fn an_error_on_one_rank_is_the_same_on_all() {
        let of = |rank: usize| -> Result<usize, Fault> {
            let (body, relative) = ("cube".to_owned(), -0.5);
            match rank {
                0 => Ok(7),
                1 => Err(Fault::undefined(SolidError::InvertedElement {
                    body,
                    element: 42,
                    gauss_point: 3,
                    determinant: relative,
                    level: stoss_fe_solid::TimeLevel::End,
                })),
                _ => Err(Fault::other(Undefined { term: body, reason: "another".to_owned() })),
            }
        };
        for last in [1, 3] {
            let faults = Threads::run(3, |communicator| {
                let rank = communicator.rank();
                let shares = Shares { communicator, owner: vec![0], ..Shares::default() };
                assert_eq!(shares.agree(Ok(5)).unwrap(), 5);
                let fault = shares.agree(if rank <= last { of(rank) } else { of(0) }).unwrap_err();
                (fault.is_undefined(), fault.cause::<RankFault>().cloned())
            });
            let expected = of(1).unwrap_err().to_string();
            for (undefined, cause) in faults {
                let cause = cause.unwrap();
                assert!(undefined);
                assert_eq!(cause.text, expected);
                assert_eq!(cause.element, Some(("cube".to_owned(), 42)));
            }
        }
    }

    #[test]
    #[should_panic(expected = "drifted apart in step 3")]
    fn ranks_that_differ_in_one_bit_are_found() {
        Threads::run(2, |communicator| {
            let rank = communicator.rank();
            let shares = Shares { communicator, owner: vec![0], ..Shares::default() };
            let x = [1.0, 0.5];
            shares.compare(2, x.iter());
            let y = [1.0, if rank == 0 { 0.5 } else { f64::from_bits(0.5_f64.to_bits() + 1) }];
            shares.compare(3, y.iter());
        });
    }
}
