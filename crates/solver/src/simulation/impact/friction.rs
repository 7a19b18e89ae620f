//! Friction in an impact (theory/impacts#friction): tangential impulses within Coulomb's cone, together with the normal ones.

use super::complementarity::DenseCompliance;

/// Sweeps over all slots.
const MAX_SWEEPS: usize = 2000;

/// Change of an impulse beside the largest one that ends the sweeps.
const CONVERGED: f64 = 1e-13;

/// What the normal rates are to be at least, the rates without impulses of the slots, and the coefficients of friction. Slots first, then two directions for each of `sliding`.
#[derive(Debug)]
pub(super) struct Cone<'a> {
    /// Least normal rate of each slot.
    pub least: &'a [f64],
    /// Rate of each row without impulses.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A point of mass one on a floor: `W` is the identity.
    fn point(v: [f64; 3], least: f64, mu: f64) -> [f64; 3] {
        let w = DenseCompliance::new(3, vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        let cone = Cone { least: &[least], free: &v, sliding: &[(0, mu)] };
        let j = with_friction(&w, &cone, &[0.0; 3]);
        std::array::from_fn(|i| v[i] + j[i])
    }

    #[test]
    fn a_point_slides_or_stops() {
        let off = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
        assert!(off(point([-1.0, 0.8, 0.6], 0.0, 0.3), [0.0, 0.8 * 0.7, 0.6 * 0.7]) < 1e-12);
        assert!(off(point([-1.0, 0.8, 0.6], 0.5, 0.3), [0.5, 0.8 * 0.55, 0.6 * 0.55]) < 1e-12);
        assert!(off(point([-1.0, 0.8, 0.6], 0.5, 0.8), [0.5, 0.0, 0.0]) < 1e-12);
        // It leaves by itself.
        assert!(off(point([1.0, 0.8, 0.6], 0.0, 0.8), [1.0, 0.8, 0.6]) < 1e-15);
    }

    /// A ball of the radius one whose inertia is 2/5: a push along the floor moves its lowest point by 7/2 of that of the centre.
    #[test]
    fn a_ball_rolls_with_five_sevenths_of_its_speed() {
        let w = DenseCompliance::new(3, vec![1.0, 0.0, 0.0, 0.0, 3.5, 0.0, 0.0, 0.0, 3.5]);
        let cone = Cone { least: &[0.0], free: &[-1.0, 1.0, 0.0], sliding: &[(0, 0.8)] };
        let j = with_friction(&w, &cone, &[0.0; 3]);
        assert!((1.0 + j[1] - 5.0 / 7.0).abs() < 1e-12 && j[2].abs() < 1e-15, "{j:?}");
    }

    /// Four corners of a plate that carries more of its weight on one side: impulses are not unique, velocities are.
    #[test]
    fn corners_share_the_friction() {
        let rows: Vec<[f64; 3]> = (0..4).map(|_| [1.0, 0.0, 0.0]).collect();
        let along = (0..4).flat_map(|_| [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let all: Vec<[f64; 3]> = rows.into_iter().chain(along).collect();
        let dot = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
        let entries = all.iter().flat_map(|a| all.iter().map(move |b| dot(a, b))).collect();
        let w = DenseCompliance::new(12, entries);
        let v = [-1.0, 1.0, 0.0];
        let free: Vec<f64> = all.iter().map(|row| dot(row, &v)).collect();
        let sliding: Vec<(usize, f64)> = (0..4).map(|slot| (slot, 0.4)).collect();
        let cone = Cone { least: &[0.0; 4], free: &free, sliding: &sliding };
        let mut start = [0.0; 12];
        start[0] = 0.7;
        let j = with_friction(&w, &cone, &start);
        let sum = |i: usize| v[i] + all.iter().zip(&j).map(|(row, j)| row[i] * j).sum::<f64>();
        assert!(sum(0).abs() < 1e-12 && (sum(1) - 0.6).abs() < 1e-10, "{j:?}");
    }
}
