//! The part of a term's contributions that one of several ranks evaluates.

/// The contributions of one of several ranks, told by their nodes: all ranks know whose a contribution is, whether it acts or is a candidate, and in whatever list it stands. The default
/// is one rank, which has all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    ranks: u32,
    rank: u32,
}

impl Default for Share {
    fn default() -> Self {
        Self { ranks: 1, rank: 0 }
    }
}

impl Share {
    /// That of a rank, counted from 0, among so many (0 counts as 1).
    pub fn new(ranks: u32, rank: u32) -> Self {
        Self { ranks: ranks.max(1), rank }
    }

    /// Whether it has all contributions.
    pub fn is_whole(&self) -> bool {
        self.ranks == 1
    }

    /// The rank that evaluates a contribution to these nodes: a hash of the number of its first node, so that the nodes of a structured mesh, whose numbers on a side may all be even, are dealt
    /// out evenly. Without nodes rank 0.
    pub fn owner(&self, nodes: &[u32]) -> u32 {
        nodes.first().map_or(0, |&node| hash(node) % self.ranks)
    }

    /// Whether this rank evaluates a contribution to these nodes.
    pub fn has(&self, nodes: &[u32]) -> bool {
        self.is_whole() || self.owner(nodes) == self.rank
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
    }
}
