//! Drifts of conserved quantities over a run.

use super::numbers::{self, distance, larger, norm};
use crate::table::Table;

/// The columns of `balance.csv` that the drifts are made of. One row a completed step and one for the start.
#[derive(Clone, Debug, Default)]
pub struct Balance {
    /// Step numbers.
    pub step: Vec<f64>,
    /// Times.
    pub time: Vec<f64>,
    /// Linear momentum.
    pub linear: Vec<[f64; 3]>,
    /// Angular momentum about the origin.
    pub angular: Vec<[f64; 3]>,
    /// Total energy.
    pub total: Vec<f64>,
    /// What the law of impact has taken since the start; it also takes a little in steps in which nothing closes and a closed slot moves on. Empty: nothing.
    pub impact_loss: Vec<f64>,
}

impl Balance {
    /// Takes the columns out of the table.
    pub fn new(table: &Table) -> Result<Self, String> {
        Ok(Self {
            step: table.column("step")?.to_vec(),
            time: table.column("time")?.to_vec(),
            linear: table.vectors(["lx", "ly", "lz"])?,
            angular: table.vectors(["jx", "jy", "jz"])?,
            total: table.column("total")?.to_vec(),
            // Only where there are gaps.
            impact_loss: table.column("impact_loss").map(<[f64]>::to_vec).unwrap_or_default(),
        })
    }

    /// `max |L - L_0|` over `scale`, or over the largest `|L|` of the run.
    pub fn linear_drift(&self, scale: Option<f64>) -> f64 {
        largest(&history(&self.linear, scale))
    }

    /// `max |J - J_0|` over `scale`, or over the largest `|J|` of the run.
    pub fn angular_drift(&self, scale: Option<f64>) -> f64 {
        largest(&history(&self.angular, scale))
    }

    /// `max |H - H_0|` over `scale`, or over the largest `|H|` of the run.
    pub fn energy_drift(&self, scale: Option<f64>) -> f64 {
        largest(&history(&scalars(&self.total), scale))
    }

    /// `|L - L_0|`, `|J - J_0|` and `|H - H_0|` of every row, over the largest value of the run.
    pub fn histories(&self) -> [Vec<f64>; 3] {
        let plain = [history(&self.linear, None), history(&self.angular, None), history(&scalars(&self.total), None)];
        plain.map(|history| history.into_iter().map(|[value]| value).collect())
    }

    /// Change of the energy in every step, with its sign, over `scale`, or over the largest `|H|` of the run. The first
    /// entry belongs to row 1 of the table.
    pub fn energy_changes(&self, scale: Option<f64>) -> Vec<f64> {
        let scale = scale.unwrap_or_else(|| unit(&scalars(&self.total)));
        self.total.windows(2).map(|pair| (pair[1] - pair[0]) / scale).collect()
    }

    /// The energy with what the law of impact has taken.
    fn with_losses(&self) -> Vec<f64> {
        let loss = self.impact_loss.iter().copied().chain(std::iter::repeat(0.0));
        self.total.iter().zip(loss).map(|(total, loss)| total + loss).collect()
    }

    /// Largest change of the energy, without its sign, in the steps whose mark is `wanted`, with what the law of impact has taken in those that are not marked; see
    /// [`Self::energy_changes`]. `marked[i]` belongs to row `i`, the end of a step.
    pub fn largest_change(&self, marked: &[bool], wanted: bool, scale: Option<f64>) -> f64 {
        let scale = scale.unwrap_or_else(|| unit(&scalars(&self.total)));
        let energy = if wanted { self.total.clone() } else { self.with_losses() };
        let changes = energy.windows(2).map(|pair| (pair[1] - pair[0]) / scale).zip(marked.iter().skip(1));
        changes.filter(|(_, marked)| **marked == wanted).fold(0.0, |worst, (change, _)| larger(worst, change.abs()))
    }

    /// Largest drift of the energy, with what the law of impact has taken, within stretches of steps that are not marked, over the largest `|H|` of the run.
    ///
    /// `marked[i]` belongs to row `i`, the end of a step. A stretch begins at the start or behind a marked step, and its
    /// first value is the reference for all others in it: many small changes of one sign do not hide.
    pub fn energy_drift_between(&self, marked: &[bool]) -> f64 {
        let scale = unit(&scalars(&self.total));
        let energies = self.with_losses();
        let mut reference = energies.first().copied().unwrap_or(0.0);
        let mut worst = 0.0_f64;
        for (energy, marked) in energies.iter().zip(marked) {
            if *marked {
                reference = *energy;
            }
            worst = larger(worst, (energy - reference).abs());
        }
        worst / scale
    }
}

fn scalars(values: &[f64]) -> Vec<[f64; 1]> {
    values.iter().map(|value| [*value]).collect()
}

fn largest<const N: usize>(values: &[[f64; N]]) -> f64 {
    numbers::largest(values.iter().copied().map(norm))
}

/// The largest value; one if everything is zero, so that nothing is divided by zero.
fn unit<const N: usize>(values: &[[f64; N]]) -> f64 {
    match largest(values) {
        0.0 => 1.0,
        largest => largest,
    }
}

fn history<const N: usize>(values: &[[f64; N]], scale: Option<f64>) -> Vec<[f64; 1]> {
    let scale = scale.unwrap_or_else(|| unit(values));
    values.iter().map(|value| [distance(*value, values[0]) / scale]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn energies(total: &[f64]) -> Balance {
        Balance { total: total.to_vec(), ..Balance::default() }
    }

    #[test]
    fn drifts_are_relative_to_the_largest_value() {
        let balance = Balance {
            linear: vec![[3.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 1.0, 0.0]],
            angular: vec![[0.0, 0.0, 2.0], [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]],
            ..energies(&[-4.0, -5.0, -4.5])
        };
        assert_eq!(balance.linear_drift(None), 4.0 / 5.0);
        assert_eq!(balance.angular_drift(None), 0.5);
        assert_eq!(balance.energy_drift(None), 0.2);
        assert_eq!(balance.histories()[2], [0.0, 0.2, 0.1]);
    }

    #[test]
    fn a_given_scale_replaces_the_largest_value() {
        let balance = Balance { linear: vec![[0.0; 3], [1e-15, 0.0, 0.0]], ..energies(&[0.0, 1.0]) };
        assert_eq!(balance.linear_drift(None), 1.0);
        assert_eq!(balance.linear_drift(Some(1e3)), 1e-18);
        assert_eq!(balance.angular_drift(None), 0.0);
        assert_eq!(energies(&[0.0, 0.0]).energy_drift(None), 0.0);
        assert_eq!(balance.energy_changes(Some(2.0)), [0.5]);
    }

    #[test]
    fn only_marked_steps_may_change_the_energy() {
        let balance = energies(&[10.0, 10.0, 8.0, 8.0, 8.5]);
        let marks = |rows: [usize; 2]| (0..5).map(|row| rows.contains(&row)).collect::<Vec<_>>();
        assert_eq!(balance.energy_drift_between(&marks([2, 4])), 0.0);
        assert_eq!(balance.energy_drift_between(&marks([2, 2])), 0.05);
        assert_eq!(balance.energy_drift_between(&marks([4, 4])), 0.2);
        assert_eq!(balance.largest_change(&marks([2, 4]), true, None), 0.2);
        assert_eq!(balance.largest_change(&marks([4, 4]), true, None), 0.05);
        assert_eq!(balance.largest_change(&marks([2, 2]), false, None), 0.05);
        assert_eq!(balance.energy_changes(None), [0.0, -0.2, 0.0, 0.05]);
    }

    #[test]
    fn slow_changes_within_a_stretch_add_up() {
        let balance = energies(&[1.0, 0.9, 0.8, 0.7]);
        assert!((balance.energy_drift_between(&[false; 4]) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn a_nan_is_never_a_small_drift() {
        assert!(energies(&[1.0, f64::NAN, 1.0]).energy_drift(None).is_nan());
        assert!(energies(&[1.0, f64::NAN, 1.0]).energy_drift_between(&[false; 3]).is_nan());
    }
}
