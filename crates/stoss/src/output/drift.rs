//! Largest drift of each balance in a run.

use serde::{Deserialize, Serialize};
use stoss_solver::Balance;

/// Follows a quantity: first value, largest deviation from it, largest magnitude.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Track<const N: usize>
where
    [f64; N]: Default + Serialize + for<'a> Deserialize<'a>,
{
    first: [f64; N],
    deviation: f64,
    magnitude: f64,
}

fn norm<const N: usize>(x: [f64; N]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl<const N: usize> Track<N>
where
    [f64; N]: Default + Serialize + for<'a> Deserialize<'a>,
{
    fn start(value: [f64; N]) -> Self {
        Self { first: value, deviation: 0.0, magnitude: norm(value) }
    }
    fn follow(&mut self, value: [f64; N]) {
        self.deviation = self.deviation.max(norm::<N>(std::array::from_fn(|i| value[i] - self.first[i])));
        self.magnitude = self.magnitude.max(norm(value));
    }
    fn report(&self, scale: Option<f64>, changed_by: Option<&String>) -> Drift {
        if changed_by.is_some() {
            return Drift { absolute: None, relative: None, reason: changed_by.cloned() };
        }
        let scale = scale.unwrap_or(self.magnitude);
        let relative = if scale > 0.0 { self.deviation / scale } else { 0.0 };
        Drift { absolute: Some(self.deviation), relative: Some(relative), reason: None }
    }
}

/// A drift as the summary reports it.
#[derive(Clone, Debug, Serialize, Deserialize, PartialEq)]
pub struct Drift {
    /// Largest deviation from the initial value; `None` for a quantity that loads or supports change.
    pub absolute: Option<f64>,
    /// Absolute drift over the scale that the scene gives in `[expect]`, or else over the largest magnitude in the run, of
    /// energy that of kinetic and strain energy if it is larger (0 if that is 0). Without a scale it
    /// says nothing of a quantity whose total is zero.
    pub relative: Option<f64>,
    /// Why there is no drift.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Drifts of all balances.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Drifts {
    linear: Track<3>,
    angular: Track<3>,
    total: Track<1>,
}

impl Drifts {
    pub fn start(balance: &Balance) -> Self {
        Self {
            linear: Track::start(balance.linear_momentum),
            angular: Track::start(balance.angular_momentum),
            total: Track::start([balance.total()]),
        }
    }
    pub fn follow(&mut self, balance: &Balance) {
        self.linear.follow(balance.linear_momentum);
        self.angular.follow(balance.angular_momentum);
        self.total.follow([balance.total()]);
        // The total has an arbitrary zero, where there are potentials.
        self.total.magnitude = self.total.magnitude.max(balance.kinetic + balance.strain);
    }
    /// Linear momentum, angular momentum, total energy, relative to these scales, as far as nothing changes them.
    pub fn report(&self, scales: [Option<f64>; 3], changed_by: &[Option<String>; 3]) -> [Drift; 3] {
        let ([linear, angular, total], [by_linear, by_angular, by_total]) = (scales, changed_by.each_ref());
        [
            self.linear.report(linear, by_linear.as_ref()),
            self.angular.report(angular, by_angular.as_ref()),
            self.total.report(total, by_total.as_ref()),
        ]
    }
}
