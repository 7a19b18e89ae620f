//! Sums of the contributions of a coupling that deals them out among the ranks.

use crate::shares::Shares;
use stoss_linalg::NONE;
use stoss_term::Local;

/// Sums of this rank's contributions, and where those of all ranks go.
#[derive(Debug)]
pub(crate) struct Dealt {
    pub out: Vec<f64>,
    pub rhs: Vec<f64>,
    pub shift: Vec<f64>,
    pub seen: Seen,
}

/// Components and equations that contributions of any rank add to: the same on all.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    components: Vec<u32>,
    rows: Vec<u32>,
}

impl Seen {
    /// Notes a contribution; `equation`: of each slot, the first of `width` that follow each other.
    pub fn note(&mut self, local: &Local, equation: &[u32], width: u32) {
        self.components.extend(local.nodes.iter().flat_map(|&node| 3 * node..3 * node + 3));
        let first = local.slots.iter().map(|&slot| equation[slot as usize]).filter(|&first| first != NONE);
        self.rows.extend(first.flat_map(|first| first..first + width));
    }
}

impl Dealt {
    /// Room for vectors of so many components and equations.
    pub fn new(components: usize, equations: usize) -> Self {
        let (out, rhs) = (vec![0.0; components], vec![0.0; equations]);
        Self { out, rhs, shift: Vec::new(), seen: Seen::default() }
    }

    /// Adds the sums over the ranks to these vectors.
    pub fn add_to(mut self, shares: &Shares, out: &mut [f64], rhs: &mut [f64], shift: &mut Vec<f64>) {
        for list in [&mut self.seen.components, &mut self.seen.rows] {
            list.sort_unstable();
            list.dedup();
        }
        let Seen { components, rows } = &self.seen;
        shares.add_sum_at(components, &self.out, out);
        shares.add_sum_at(rows, &self.rhs, rhs);
        if shares.any(!self.shift.is_empty()) {
            self.shift.resize(out.len(), 0.0);
            shift.resize(out.len(), 0.0);
            shares.add_sum_at(components, &self.shift, shift);
        }
    }
}
