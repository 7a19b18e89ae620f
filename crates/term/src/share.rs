//! Shares of the contributions of a term, for several ranks that evaluate it together.

/// The contributions of one of several ranks: those whose first node has a number with a given remainder. A rule by content and not by position in a list: whoever lists contributions, candidates for
/// instance, comes to the same ranks. Neighbours are on different ranks, so that a small zone of contact is work for all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    ranks: u32,
    rank: u32,
}

impl Default for Share {
    /// All contributions.
    fn default() -> Self {
        Self { ranks: 1, rank: 0 }
    }
}

impl Share {
    /// That of a rank, counted from 0, of so many.
    pub fn of(rank: u32, ranks: u32) -> Self {
        Self { ranks: ranks.max(1), rank }
    }

    /// Whether it has all contributions.
    pub fn is_whole(self) -> bool {
        self.ranks == 1
    }

    /// Whether it has the contribution whose nodes begin with this one.
    pub fn has(self, first: u32) -> bool {
        first % self.ranks == self.rank
    }
}
