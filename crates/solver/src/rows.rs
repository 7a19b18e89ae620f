//! What becomes of the rows of unilateral contact where they are scattered into the system, whatever method wrote them: a compliance in the tangent
//! (theory/constraints#compliance), and smoothed complementarity in place of the set of closed slots (theory/constraints#smoothed).

use stoss_term::Local;

/// Compliance of rows in the tangent of a static step, in parts of one over the factor of the complementarity function: far below the eigenvalues
/// that rows have among bodies of like stiffness (1 to 1e-3), and half of the digits of a factorisation.
pub(crate) const COMPLIANCE: f64 = 1.0e-8;

/// Compliance of rows while complementarity is smoothed: a slave that is a thousand times stiffer than its master has eigenvalues of 1e-3 of the others, which
/// are not to be slowed down.
pub(crate) const COMPLIANCE_SMOOTHED: f64 = 1.0e-9;

/// How rows of unilateral contact are scattered.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// Parts of one over the factor of the complementarity function; zero: none.
    pub compliance: f64,
    /// What was found to be undetermined, if the compliance was needed.
    pub dependent: Option<String>,
    /// Smoothing of each pair, a stress; empty: rows as the methods write them, of closed slots.
    pub smoothing: Vec<f64>,
}

impl Rows {
    /// Rows as the methods write them, with their compliance.
    pub fn compliant() -> Self {
        Self { compliance: COMPLIANCE, ..Self::default() }
    }
}

/// Entry on the diagonal of the row of a closed slot of unilateral contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosedDiagonal {
    /// Where it is in the values of the matrix.
    pub position: u32,
    /// One over the stiffness of the row, an area times a length over a stress, with the sign of the row.
    pub softness: f64,
    /// Weight of the slot, an area.
    pub weight: f64,
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
    /// Pressures of all slots of the pair.
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
    pub fn change_tangent(&self, local: &Local, tangent: &mut [f64], first: usize, weight: impl Fn(u32) -> f64) {
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

    /// Solution of `matrix x = rhs`, with the largest pivot of each column.
    fn solved(mut matrix: Vec<Vec<f64>>, mut rhs: Vec<f64>) -> Vec<f64> {
        let n = rhs.len();
        for k in 0..n {
            let pivot = (k..n).max_by(|&a, &b| matrix[a][k].abs().total_cmp(&matrix[b][k].abs())).unwrap();
            matrix.swap(k, pivot);
            rhs.swap(k, pivot);
            for row in k + 1..n {
                let factor = matrix[row][k] / matrix[k][k];
                for column in k..n {
                    matrix[row][column] -= factor * matrix[k][column];
                }
                rhs[row] -= factor * rhs[k];
            }
        }
        for k in (0..n).rev() {
            let rest: f64 = (k + 1..n).map(|j| matrix[k][j] * rhs[j]).sum();
            rhs[k] = (rhs[k] - rest) / matrix[k][k];
        }
        rhs
    }

    /// The linear complementarity problem `p >= 0`, `gap = matrix p + distance >= 0`, `p gap = 0` along the path of smoothings: the pressures at its end.
    fn along_the_path(matrix: &[Vec<f64>], distance: &[f64]) -> Vec<f64> {
        let n = distance.len();
        let gaps = |p: &[f64]| -> Vec<f64> {
            (0..n).map(|i| distance[i] + (0..n).map(|j| matrix[i][j] * p[j]).sum::<f64>()).collect()
        };
        let mut p = vec![1.0; n];
        let mut theta = 1.0;
        while theta > 1e-9 {
            let merit = |p: &[f64]| {
                let of = p.iter().zip(gaps(p)).map(|(p, gap)| smoothed(*p, gap, 1.0, theta).value.abs());
                of.fold(0.0, f64::max)
            };
            for _ in 0..60 {
                let rows: Vec<Smoothed> =
                    p.iter().zip(gaps(&p)).map(|(p, gap)| smoothed(*p, gap, 1.0, theta)).collect();
                let tangent = (0..n)
                    .map(|i| {
                        let own = |j: usize| if i == j { 1.0 - rows[i].share + COMPLIANCE_SMOOTHED } else { 0.0 };
                        (0..n).map(|j| rows[i].share * matrix[i][j] + own(j)).collect()
                    })
                    .collect();
                let step = solved(tangent, rows.iter().map(|row| -row.value).collect());
                let before = merit(&p);
                if before < 1e-2 * theta {
                    break;
                }
                let at = |length: f64| -> Vec<f64> { p.iter().zip(&step).map(|(p, d)| p + length * d).collect() };
                let length =
                    (0..12).map(|k| 0.5_f64.powi(k)).find(|&length| merit(&at(length)) < before).unwrap_or(1.0);
                p = at(length);
            }
            theta *= SLOWER;
        }
        p
    }

    const SLOWER: f64 = 0.4;

    #[test]
    fn the_path_ends_at_the_solution_of_linear_complementarity() {
        let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
        let mut random = || {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for trial in 0..60 {
            let n = 3 + trial % 5;
            // Every other one has half as many motions as rows, and a condition of about 1e10.
            let (motions, least) = if trial % 2 == 0 { (n, 1e-2) } else { (n / 2 + 1, 1e-10) };
            let rows: Vec<Vec<f64>> = (0..n).map(|_| (0..motions).map(|_| random()).collect()).collect();
            let product = |i: usize, j: usize| (0..motions).map(|k| rows[i][k] * rows[j][k]).sum::<f64>();
            let matrix: Vec<Vec<f64>> =
                (0..n).map(|i| (0..n).map(|j| product(i, j) + if i == j { least } else { 0.0 }).collect()).collect();
            // Distances that some motion makes non-negative, so that pressures stay of order one.
            let motion: Vec<f64> = (0..motions).map(|_| 4.0 * random()).collect();
            let distance: Vec<f64> = (0..n)
                .map(|i| (0..motions).map(|k| rows[i][k] * motion[k]).sum::<f64>() + 0.1 * (random() + 0.5))
                .collect();
            let p = along_the_path(&matrix, &distance);
            let gap: Vec<f64> =
                (0..n).map(|i| distance[i] + (0..n).map(|j| matrix[i][j] * p[j]).sum::<f64>()).collect();
            // A solution of a convex problem is one if and only if these hold.
            for (p, gap) in p.iter().zip(&gap) {
                assert!(*p >= -1e-6 && *gap >= -1e-6 && p.min(*gap).abs() < 1e-6, "trial {trial}: {p} {gap}");
            }
        }
    }
}
