//! Several products with one matrix, one after the other, while its rows are in the cache: as soon as all neighbours of some rows have the result of a pass, these rows go on to the next one.
//! A large matrix comes from memory once instead of once a pass. What is computed is the same, bit by bit.

use super::bsr::Bsr;
use super::real::Real;

/// Rows of blocks that go on together.
const ROWS: usize = 128;

/// Which rows wait for which.
#[derive(Debug)]
pub(crate) struct Waves {
    rows: usize,
    /// Last chunk that a row of each chunk, or a row before it, is coupled with, in either direction.
    reach: Vec<u32>,
}

impl Waves {
    pub fn new<T: Real, const B: usize>(a: &Bsr<T, B, B>) -> Self {
        let rows = a.rows();
        let mut reach = vec![0u32; rows.div_ceil(ROWS)];
        for i in 0..rows {
            let row = &a.indices[a.starts[i]..a.starts[i + 1]];
            let (first, last) = (row.first().map_or(i, |&j| j as usize), row.last().map_or(i, |&j| j as usize));
            for (from, to) in [(i, last.max(i)), (first, i)] {
                let reach = &mut reach[from / ROWS];
                *reach = (*reach).max((to / ROWS) as u32);
            }
        }
        for c in 1..reach.len() {
            reach[c] = reach[c].max(reach[c - 1]);
        }
        Self { rows, reach }
    }

    /// Calls `task(pass, rows)` for all rows and passes. When it is called all neighbours of the rows have their result of the pass before, and none of them needs that of the pass before that
    /// any more: two vectors in turn are enough.
    pub fn run<const PASSES: usize>(&self, passes: usize, mut task: impl FnMut(usize, std::ops::Range<usize>)) {
        let chunks = self.reach.len();
        let mut done = [0; PASSES];
        loop {
            let ready = |&p: &usize| done[p] < chunks && (p == 0 || done[p - 1] > self.reach[done[p]] as usize);
            let Some(pass) = (0..passes).rev().find(ready) else { break };
            let first = done[pass] * ROWS;
            task(pass, first..self.rows.min(first + ROWS));
            done[pass] += 1;
        }
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<u32>() * self.reach.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows that are coupled at random, one-sidedly, over a band of some chunks.
    #[test]
    fn neighbours_are_one_pass_ahead_and_no_more() {
        let rows = 11 * ROWS + 17;
        let mut a = Bsr::<f32, 3, 3>::empty(rows);
        for i in 0..rows {
            let offset = |seed: usize| (i * 7919 + seed * 104_729) % (3 * ROWS);
            let mut near = vec![i.saturating_sub(offset(1)), i, (i + offset(2)).min(rows - 1)];
            near.dedup();
            near.iter().for_each(|&j| a.indices.push(j as u32));
            a.blocks.resize(a.indices.len(), [[0.0; 3]; 3]);
            a.starts.push(a.indices.len());
        }
        for passes in 1..=5 {
            let mut done = vec![0; rows];
            Waves::new(&a).run::<5>(passes, |pass, part| {
                for i in part {
                    assert_eq!(done[i], pass);
                    done[i] += 1;
                }
                // A row that is computed reads the results of the pass before, and those of the pass before that are written over.
                for i in 0..rows {
                    for (j, _) in a.row(i) {
                        assert!(done[i] <= done[j] + 1 && done[j] <= done[i] + 1, "{i} {j}");
                    }
                }
            });
            assert!(done.iter().all(|&done| done == passes));
        }
    }
}
