//! The ranks that run a program together: what they tell each other, not what they compute.
//!
//! All ranks run the same program on the same state and take the same decisions (theory/scale-out). Whatever a decision depends on must therefore have the same bits on all of them, and nothing here
//! sums by itself: sums are formed from what was gathered, in the order of the ranks, and not by a reduction, whose order MPI leaves open.

use std::fmt::Debug;
use std::sync::Arc;

/// What a rank has received so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Collective operations.
    pub operations: u64,
    /// Messages of other ranks that were not empty.
    pub messages: u64,
    /// Bytes of these messages.
    pub bytes: u64,
}

impl Traffic {
    /// Counts one operation with so many bytes from each rank, of which those of `rank` itself do not travel.
    pub fn count(&mut self, rank: usize, received: impl Iterator<Item = usize>) {
        self.operations += 1;
        for (_, bytes) in received.enumerate().filter(|&(from, bytes)| from != rank && bytes > 0) {
            self.messages += 1;
            self.bytes += bytes as u64;
        }
    }
}

/// The ranks of a run. Every method but [`Communicator::rank`], [`Communicator::size`] and [`Communicator::traffic`] is collective: all ranks call the same methods in the same order.
///
/// A rank that is lost ends the others (MPI aborts, threads panic): no method has an error to handle.
pub trait Communicator: Send + Sync + Debug {
    /// Number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Concatenates what all ranks give, in their order; `counts` has the length of each, the same list on all ranks.
    fn gather(&self, mine: &[f64], counts: &[usize], all: &mut [f64]);

    /// Sends consecutive pieces to the ranks in their order, and receives theirs. What a rank sends to itself is copied.
    fn exchange(&self, send: &[f64], send_counts: &[usize], receive: &mut [f64], receive_counts: &[usize]);

    /// What each rank gives, of any length.
    fn gather_bytes(&self, mine: &[u8]) -> Vec<Vec<u8>>;

    /// Operations, messages and bytes so far.
    fn traffic(&self) -> Traffic {
        Traffic::default()
    }
}

impl dyn Communicator + '_ {
    /// Sums of the ranks' values, in the order of the ranks: the same bits on all.
    pub fn sum(&self, values: &mut [f64]) {
        if self.size() == 1 {
            return;
        }
        let n = values.len();
        let mut all = vec![0.0; n * self.size()];
        self.gather(values, &vec![n; self.size()], &mut all);
        values.copy_from_slice(&all[..n]);
        for of_rank in all[n..].chunks_exact(n.max(1)) {
            values.iter_mut().zip(of_rank).for_each(|(sum, value)| *sum += value);
        }
    }

    /// Sum of one value.
    pub fn sum_of(&self, value: f64) -> f64 {
        let mut values = [value];
        self.sum(&mut values);
        values[0]
    }

    /// Whether it is true on any rank.
    pub fn any(&self, value: bool) -> bool {
        self.sum_of(f64::from(u8::from(value))) > 0.0
    }

    /// The text of the first rank that has one, on all ranks.
    pub fn first_text(&self, text: Option<&str>) -> Option<String> {
        if !self.any(text.is_some()) {
            return None;
        }
        // A text that is empty is one too.
        let mine = text.map(|text| [&[1], text.as_bytes()].concat()).unwrap_or_default();
        let texts = self.gather_bytes(&mine);
        texts.into_iter().find(|text| !text.is_empty()).map(|text| String::from_utf8_lossy(&text[1..]).into_owned())
    }
}

/// One rank.
#[derive(Debug, Clone, Copy, Default)]
pub struct Serial;

impl Serial {
    /// The communicator of one rank as what a solver returns.
    pub fn shared() -> Arc<dyn Communicator> {
        Arc::new(Self)
    }
}

impl Communicator for Serial {
    fn rank(&self) -> usize {
        0
    }
    fn size(&self) -> usize {
        1
    }
    fn gather(&self, mine: &[f64], _counts: &[usize], all: &mut [f64]) {
        all.copy_from_slice(mine);
    }
    fn exchange(&self, send: &[f64], _: &[usize], receive: &mut [f64], _: &[usize]) {
        receive.copy_from_slice(send);
    }
    fn gather_bytes(&self, mine: &[u8]) -> Vec<Vec<u8>> {
        vec![mine.to_vec()]
    }
}
