//! What becomes of the rows of unilateral contact where they are scattered into the system, whatever method wrote them: a compliance in the tangent
//! (theory/constraints#compliance), and smoothed complementarity in place of the set of closed slots (theory/constraints#smoothed).

use stoss_contact::LocalContribution;

/// Compliance of rows in the tangent of a static step, in parts of one over the factor of the complementarity function: far below the eigenvalues
/// that rows have among bodies of like stiffness (1 to 1e-3), and half of the digits of a factorisation.
pub(crate) const COMPLIANCE: f64 = 1.0e-8;

/// The same while complementarity is smoothed: a slave that is a thousand times stiffer than its master has eigenvalues of 1e-3 of the others, which are not to
/// be slowed down.
pub(crate) const COMPLIANCE_SMOOTHED: f64 = 1.0e-9;

/// How rows of unilateral contact are scattered.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// Parts of one over the factor of the complementarity function; zero: none.
    pub compliance: f64,
    /// Smoothing of each pair, a stress; empty: rows as the methods write them, of closed slots.
    pub smoothing: Vec<f64>,
}

/// Value and derivative of the smoothed complementarity function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Smoothed {
    /// `p - (z + sqrt(z^2 + 4 theta^2)) / 2`, a stress, with `z = p - c gap`.
    pub value: f64,
    /// `d value = (1 - share) dp + share c dgap`, between 0 and 1.
    pub share: f64,
}

/// The function of Chen and Harker, Kanzow, and Smale: zero where `p > 0`, `gap > 0` and `p c gap = theta^2`. With `theta = 0` it is `p - max(0, p - c gap)`.
/// `p`: a stress; `gap`: a length; `c`: a stress per length; `theta`: a stress.
pub(crate) fn smoothed(p: f64, gap: f64, c: f64, theta: f64) -> Smoothed {
    let z = p - c * gap;
    let root = z.hypot(2.0 * theta);
    if root == 0.0 {
        return Smoothed { value: p, share: 0.5 };
    }
    // The smaller one of both roots without cancellation.
    let positive = if z > 0.0 { 0.5 * (z + root) } else { 2.0 * theta * (theta / (root - z)) };
    let value = if z > 0.0 { c * gap - 2.0 * theta * (theta / (z + root)) } else { p - positive };
    Smoothed { value, share: positive / root }
}

/// A pair whose rows are scattered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SmoothedPair<'a> {
    /// Stress.
    pub theta: f64,
    /// Stress per length.
    pub factor: f64,
    /// Of all slots of the pair.
    pub pressures: &'a [f64],
}

impl SmoothedPair<'_> {
    fn of(&self, slot: u32, row: f64, weight: f64) -> Smoothed {
        smoothed(self.pressures[slot as usize], -row / weight, self.factor, self.theta)
    }

    /// The row of a slot of this weight (an area), minus area times a length, for the one that a method wrote.
    pub fn row(&self, slot: u32, row: f64, weight: f64) -> f64 {
        -weight / self.factor * self.of(slot, row, weight).value
    }

    /// Changes the rows of slots in a tangent as [`Self::row`] does in the residual; `first`: row of the first slot.
    pub fn change_tangent(
        &self,
        local: &LocalContribution,
        tangent: &mut [f64],
        first: usize,
        weight: impl Fn(u32) -> f64,
    ) {
        let rest = local.dim() - 3 * local.nodes.len();
        let dim = first + rest;
        for (k, (&slot, &row)) in local.slots.iter().zip(&local.residual[3 * local.nodes.len()..]).enumerate() {
            let weight = weight(slot);
            let share = self.of(slot, row, weight).share;
            let entries = &mut tangent[(first + k) * dim..(first + k + 1) * dim];
            entries.iter_mut().for_each(|entry| *entry *= share);
            entries[first + k] -= weight / self.factor * (1.0 - share);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivative_is_that_of_differences_at_any_smoothing() {
        let c = 3.0;
        for exponent in -8..=8 {
            let ratio = 10f64.powi(exponent);
            for sign in [-1.0, 1.0] {
                for (p, theta) in [(0.7, 0.2), (1e-3, 5.0), (40.0, 1e-3)] {
                    let z: f64 = sign * ratio * theta;
                    let gap = (p - z) / c;
                    let at = smoothed(p, gap, c, theta);
                    assert!((0.0..=1.0).contains(&at.share));
                    // Of the differences of p and of gap those of z alone are ill conditioned, so that both are looked at.
                    let h = 1e-6 * (z.abs() + theta);
                    let dp = (smoothed(p + h, gap, c, theta).value - smoothed(p - h, gap, c, theta).value) / (2.0 * h);
                    let dg = (smoothed(p, gap + h / c, c, theta).value - smoothed(p, gap - h / c, c, theta).value)
                        / (2.0 * h / c);
                    let round_off = 1e-15 * (p.abs() + (c * gap).abs()) / h + 1e-9;
                    assert!((dp - (1.0 - at.share)).abs() < round_off, "z/theta {ratio}: {dp} {}", at.share);
                    assert!((dg - c * at.share).abs() < c * round_off, "z/theta {ratio}: {dg} {}", at.share);
                }
            }
        }
    }

    #[test]
    fn it_does_not_cancel_and_ends_at_the_set() {
        // On the path p c gap = theta^2 the value is zero to round-off of the smaller one, however different the factors are.
        for exponent in -8..=8 {
            let (theta, c) = (2.0, 5.0);
            let p = theta * 10f64.powi(exponent);
            let gap = theta * theta / (p * c);
            let at = smoothed(p, gap, c, theta);
            assert!(at.value.abs() <= 4e-16 * p.max(c * gap), "{p}: {}", at.value);
            let expected = p / (p + c * gap);
            assert!((at.share - expected).abs() <= 1e-14 * expected, "{p}: {} {expected}", at.share);
        }
        // Without smoothing: closed where p > c gap.
        assert_eq!(smoothed(2.0, 0.25, 4.0, 0.0), Smoothed { value: 1.0, share: 1.0 });
        assert_eq!(smoothed(2.0, 0.75, 4.0, 0.0), Smoothed { value: 2.0, share: 0.0 });
        assert_eq!(smoothed(0.0, 0.0, 4.0, 0.0), Smoothed { value: 0.0, share: 0.5 });
    }
}
