//! The trait of a friction law.

/// A vector in the tangent plane.
pub(super) type Plane = [f64; 2];

/// What a law may depend on. All of one point and one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionInput {
    /// Pressure, a traction, positive in compression. May be negative in an iteration: there is no friction then.
    pub pressure: f64,
    /// Traction that an elastic (sticking) step would end with.
    pub trial: Plane,
    /// Slip of the slave relative to the master in the step, a length.
    pub slip: Plane,
    /// Size of the step, a time. In statics the increment of the load parameter.
    pub step_size: f64,
    /// Length of the path slid so far, before this step.
    pub slid: f64,
}

/// Traction and its derivatives with respect to the first three entries of [`FrictionInput`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionOutput {
    /// Tangential traction, along the slip.
    pub traction: Plane,
    /// True if the trial traction was admissible.
    pub sticks: bool,
    /// `d traction / d pressure`.
    pub d_pressure: Plane,
    /// `d traction_i / d trial_j`.
    pub d_trial: [Plane; 2],
    /// `d traction_i / d slip_j` at fixed trial traction.
    pub d_slip: [Plane; 2],
}

/// A law of friction.
///
/// What the time stepping relies on: the traction does not exceed a bound that depends on everything but the trial traction, it is the trial
/// traction within the bound, and has its direction beyond. [`return_to_bound`] makes a traction of this kind. Then dissipation is not
/// negative, with every stepping. A law that takes no notice of the trial traction says so by [`FrictionLaw::is_elastic`]; its
/// dissipation is not negative if its traction points along the slip.
pub trait FrictionLaw: Send + Sync + std::fmt::Debug {
    /// Name for reports.
    fn name(&self) -> &str;
    /// Traction at the end of a step, with derivatives.
    fn traction(&self, input: &FrictionInput) -> FrictionOutput;
    /// False if the law does not use the trial traction: nothing is stored then, and there is no stick.
    fn is_elastic(&self) -> bool {
        true
    }
    /// Traction over pressure of a point that slides steadily with a `speed` (length per time), at unit pressure.
    fn coefficient(&self, speed: f64) -> f64 {
        // A trial traction beyond every bound.
        let trial = [1e100, 0.0];
        self.traction(&FrictionInput { pressure: 1.0, trial, slip: [speed, 0.0], step_size: 1.0, slid: 0.0 }).traction
            [0]
    }
}

/// The trial traction, scaled back to a `bound` where it is beyond (return mapping, theory/friction#eq-return; thesis (5.110)-(5.112)).
///
/// `d_pressure` and `d_slip` are the derivatives of the bound. At the kink the sticking branch is taken.
pub fn return_to_bound(trial: Plane, bound: f64, d_pressure: f64, d_slip: Plane) -> FrictionOutput {
    let norm = trial[0].hypot(trial[1]);
    if norm <= bound {
        let identity = [[1.0, 0.0], [0.0, 1.0]];
        return FrictionOutput { traction: trial, sticks: true, d_trial: identity, ..FrictionOutput::default() };
    }
    let direction = trial.map(|t| t / norm);
    let ratio = bound / norm;
    FrictionOutput {
        traction: direction.map(|d| bound * d),
        sticks: false,
        d_pressure: direction.map(|d| d_pressure * d),
        d_trial: std::array::from_fn(|i| {
            std::array::from_fn(|j| ratio * (f64::from(u8::from(i == j)) - direction[i] * direction[j]))
        }),
        d_slip: direction.map(|d| d_slip.map(|b| b * d)),
    }
}
