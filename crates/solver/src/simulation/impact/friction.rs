//! Friction in an impact (theory/impacts#friction): tangential impulses within Coulomb's cone, together with the normal ones.

use super::complementarity::DenseCompliance;

/// Sweeps over all slots.
const MAX_SWEEPS: usize = 2000;

/// Change of an impulse beside the largest one that ends the sweeps.
const CONVERGED: f64 = 1e-13;

/// What the normal rates are to be at least, the rates without impulses of the slots, and the coefficients of friction. Slots first, then two directions for each of `sliding`.
#[derive(Debug)]
pub(super) struct Cone<'a> {
    /// Of each slot.
    pub least: &'a [f64],
    /// Of each row.
    pub free: &'a [f64],
    /// Slots with friction and their coefficients, in the order of their rows.
    pub sliding: &'a [(usize, f64)],
}

/// Impulses `0 <= j_N`, `u_N >= least`, complementary, and `|j_T| <= mu j_N` against the sliding: Moreau's law by sweeps over the slots, from `start` on.
pub(super) fn with_friction(w: &DenseCompliance, cone: &Cone<'_>, start: &[f64]) -> Vec<f64> {
    let (m, n) = (cone.least.len(), cone.free.len());
    let mut j = start.to_vec();
    let mut rate: Vec<f64> = (0..n).map(|i| cone.free[i] + w.product(i, &j)).collect();
    let add = |rate: &mut [f64], j: &mut [f64], row: usize, change: f64| {
        if change != 0.0 {
            j[row] += change;
            rate.iter_mut().enumerate().for_each(|(i, rate)| *rate += w.entry(i, row) * change);
        }
    };
    for _ in 0..MAX_SWEEPS {
        let (mut change, mut largest) = (0.0_f64, 0.0_f64);
        for i in 0..m {
            let before = j[i];
            let own = w.entry(i, i);
            if own > 0.0 {
                let now = (before - (rate[i] - cone.least[i]) / own).max(0.0);
                add(&mut rate, &mut j, i, now - before);
            }
            change = change.max((j[i] - before).abs());
            largest = largest.max(j[i]);
        }
        for (k, &(slot, mu)) in cone.sliding.iter().enumerate() {
            let rows = [m + 2 * k, m + 2 * k + 1];
            let own = w.entry(rows[0], rows[0]).max(w.entry(rows[1], rows[1]));
            if own <= 0.0 {
                continue;
            }
            let mut now = rows.map(|row| j[row] - rate[row] / own);
            let (size, bound) = (now[0].hypot(now[1]), mu * j[slot]);
            if size > bound {
                now = now.map(|x| if size > 0.0 { x * bound / size } else { 0.0 });
            }
            for (row, now) in rows.into_iter().zip(now) {
                let before = j[row];
                add(&mut rate, &mut j, row, now - before);
                change = change.max((now - before).abs());
            }
        }
        if change <= CONVERGED * largest {
            break;
        }
    }
    j
}
