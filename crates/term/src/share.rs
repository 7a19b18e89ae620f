//! The part of a term's contributions that one of several ranks evaluates.

use crate::bisect;
use std::sync::Arc;

/// The contributions of one of several ranks, told by their nodes: all ranks know whose a contribution is, whether it acts or is a candidate, and in whatever list it stands. The default
/// is one rank, which has all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Share {
    ranks: u32,
    rank: u32,
    /// Nodes that are dealt out by their places, ascending, and their ranks.
    by_place: Arc<[(u32, u32)]>,
}

impl Default for Share {
    fn default() -> Self {
        Self::new(1, 0)
    }
}

impl Share {
    /// The share of a rank, counted from 0, among so many (0 counts as 1).
    pub fn new(ranks: u32, rank: u32) -> Self {
        Self { ranks: ranks.max(1), rank, by_place: Arc::default() }
    }

    /// Deals out contributions that begin with one of these nodes by places, so that those of a rank are beside each other ([`bisect`]): nodes, their positions (a length), and how much begins with each.
    #[must_use]
    pub fn by_place(self, nodes: impl IntoIterator<Item = (u32, [f64; 3], u64)>) -> Self {
        let mut nodes: Vec<_> = nodes.into_iter().collect();
        nodes.sort_unstable_by_key(|node| node.0);
        let (places, weights): (Vec<_>, Vec<_>) = nodes.iter().map(|node| (node.1, node.2)).unzip();
        let ranks = bisect(&places, &weights, self.ranks as usize);
        let by_place = nodes.iter().map(|node| node.0).zip(ranks).collect();
        Self { by_place, ..self }
    }

    /// The rank that evaluates a contribution to these nodes: that of its first node. Nodes that are not dealt out by places are by a hash of their numbers, because those of a side of a structured mesh
    /// may all be even. Without nodes rank 0.
    pub fn owner(&self, nodes: &[u32]) -> u32 {
        let Some(&node) = nodes.first() else { return 0 };
        match self.by_place.binary_search_by_key(&node, |of| of.0) {
            Ok(place) => self.by_place[place].1,
            Err(_) => hash(node) % self.ranks,
        }
    }

    /// Whether this rank evaluates a contribution to these nodes.
    pub fn has(&self, nodes: &[u32]) -> bool {
        self.ranks == 1 || self.owner(nodes) == self.rank
    }
}

/// A bijection of 32 bits each of which depends on all (the finaliser of MurmurHash3, A. Appleby).
fn hash(mut number: u32) -> u32 {
    number ^= number >> 16;
    number = number.wrapping_mul(0x85eb_ca6b);
    number ^= number >> 13;
    number = number.wrapping_mul(0xc2b2_ae35);
    number ^ (number >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes on the sides of structured blocks: numbers of any stride are dealt out evenly.
    #[test]
    fn numbers_of_any_stride_are_dealt_out_evenly() {
        for ranks in [2, 3, 4, 7, 16] {
            for stride in [1, 2, 3, 4, 8, 12, 21, 64, 441] {
                let mut counts = vec![0; ranks as usize];
                let share = Share::new(ranks, 0);
                (0..400 * ranks).for_each(|k| counts[share.owner(&[stride * k, 5]) as usize] += 1);
                assert!(counts.iter().all(|count| (320..480).contains(count)), "{ranks} {stride}: {counts:?}");
            }
        }
    }

    #[test]
    fn each_contribution_has_one_rank() {
        let shares: Vec<Share> = (0..5).map(|rank| Share::new(5, rank)).collect();
        for node in 0..100 {
            assert_eq!(shares.iter().filter(|share| share.has(&[node, 1])).count(), 1);
            assert!(Share::default().has(&[node]) && Share::new(0, 0).has(&[node]));
        }
        assert!(shares[0].has(&[]) && !shares[1].has(&[]));
        // A line of nodes, of which the last is as heavy as all others.
        let line = (0..8).map(|k| (10 * k, [f64::from(k), 0.0, 0.0], if k == 7 { 7 } else { 1 }));
        let share = Share::new(2, 1).by_place(line);
        assert_eq!([0, 30, 60, 70].map(|node| share.owner(&[node, 0])), [0, 0, 0, 1]);
        assert_eq!(share.owner(&[5, 70]), Share::new(2, 0).owner(&[5]));
    }
}
