//! The trait of a law, and the traction that its bound makes of a trial traction and a slip.

/// A vector in the tangent plane.
pub(super) type Plane = [f64; 2];

/// What a law may depend on. All of one point and one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding {
    /// Pressure, a traction, positive: without pressure there is no friction, and no law is asked.
    pub pressure: f64,
    /// Length of the slip of the slave relative to the master in the step.
    pub slip: f64,
    /// Size of the step, a time. In statics the increment of the load parameter.
    pub step_size: f64,
    /// Length of the path slid so far, before this step.
    pub slid: f64,
}

impl Sliding {
    /// Steady slip with a `speed` (length per time) at unit pressure, from a path of no length.
    pub fn steady(speed: f64) -> Self {
        Self { pressure: 1.0, slip: speed, step_size: 1.0, slid: 0.0 }
    }
}

/// A coefficient of friction and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficient {
    /// Largest tangential traction over pressure, not negative.
    pub value: f64,
    /// Derivative of the coefficient by the pressure (area per force).
    pub d_pressure: f64,
    /// Derivative of the coefficient by the length of the slip (one over a length).
    pub d_slip: f64,
}

/// A law of friction: one number, the coefficient, as a function of pressure, slip, step and path.
///
/// The bound of the traction is the coefficient times the pressure. A point sticks as long as the traction that holds it is within the bound, and slides against the bound else. What makes a traction of
/// the bound, and the energies of stick and slip, are not the law's: dissipation is not negative whatever the coefficient does.
pub trait FrictionLaw: Send + Sync + std::fmt::Debug {
    /// Name for reports.
    fn name(&self) -> &str;
    /// The coefficient, with derivatives.
    fn coefficient(&self, at: &Sliding) -> Coefficient;
    /// Whether a point can stick. If not, the traction is the bound itself in the direction of the slip: a function of it that starts from zero, with the slope
    /// [`Coefficient::d_slip`] times the pressure at rest. Nothing is stored then.
    fn sticks(&self) -> bool {
        true
    }
}

/// Bound of a traction and its derivatives by pressure and length of the slip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bound {
    pub traction: f64,
    pub d_pressure: f64,
    pub d_slip: f64,
}

impl Bound {
    /// The bound of a law at a pressure that may be negative in an iteration; there is no friction then.
    pub fn of(law: &dyn FrictionLaw, at: &Sliding) -> Self {
        if at.pressure > 0.0 {
            let Coefficient { value, d_pressure, d_slip } = law.coefficient(at);
            let p = at.pressure;
            Self { traction: value * p, d_pressure: value + p * d_pressure, d_slip: p * d_slip }
        } else {
            Self::default()
        }
    }
}

/// A traction and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Traction {
    /// Along the slip.
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

/// Direction of a slip; zero at rest.
pub(super) fn direction(slip: Plane) -> Plane {
    let length = slip[0].hypot(slip[1]);
    if length > 0.0 { slip.map(|s| s / length) } else { [0.0; 2] }
}

fn dyad(a: Plane, b: Plane) -> [Plane; 2] {
    a.map(|a| b.map(|b| a * b))
}

/// The trial traction, scaled back to the bound where it is beyond (return mapping, theory/friction#eq-return; thesis (5.110)-(5.112)). At the kink the sticking branch is taken.
pub(super) fn return_to_bound(trial: Plane, bound: &Bound, slip: Plane) -> Traction {
    let norm = trial[0].hypot(trial[1]);
    if norm <= bound.traction {
        let identity = [[1.0, 0.0], [0.0, 1.0]];
        return Traction { traction: trial, sticks: true, d_trial: identity, ..Traction::default() };
    }
    let d = trial.map(|t| t / norm);
    let ratio = bound.traction / norm;
    Traction {
        traction: d.map(|d| bound.traction * d),
        sticks: false,
        d_pressure: d.map(|d| bound.d_pressure * d),
        d_trial: std::array::from_fn(|i| std::array::from_fn(|j| ratio * (f64::from(u8::from(i == j)) - d[i] * d[j]))),
        d_slip: dyad(d, direction(slip).map(|s| bound.d_slip * s)),
    }
}

/// The bound in the direction of the slip: laws that do not stick.
pub(super) fn along_slip(bound: &Bound, slip: Plane) -> Traction {
    let (length, d) = (slip[0].hypot(slip[1]), direction(slip));
    let across = if length > 0.0 { bound.traction / length } else { bound.d_slip };
    let along = dyad(d, d);
    Traction {
        traction: d.map(|d| bound.traction * d),
        d_pressure: d.map(|d| bound.d_pressure * d),
        d_slip: std::array::from_fn(|i| {
            std::array::from_fn(|j| across * f64::from(u8::from(i == j)) + (bound.d_slip - across) * along[i][j])
        }),
        ..Traction::default()
    }
}
