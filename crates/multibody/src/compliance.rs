//! What makes the linear equations of redundant constraints solvable, without a trace in the solution.

use stoss_contact::LocalContribution;

/// Weights against which the rows of constraints are measured: a mass and a stiffness that are typical of what they connect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// A mass.
    pub mass: f64,
    /// A force over a length.
    pub stiffness: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self { mass: 1.0, stiffness: 0.0 }
    }
}

impl Weights {
    /// `m / dt^2 + k`, a force over a length; without a step size the mass counts as a stiffness.
    pub(crate) fn stiffness(self, dt: f64) -> f64 {
        let inertia = if dt > 0.0 { self.mass / (dt * dt) } else { self.mass };
        inertia + self.stiffness
    }
}

/// Compliance of redundant equations in the tangent: `-eps` on the diagonal of their multipliers, `eps = `[`Compliance::RELATIVE`]` / (m / dt^2 + k)`.
///
/// The residual has no compliance, so the constraints hold exactly. Updates of the multipliers stay in the range of the Jacobian `G`; the first
/// linear equations of a step are written for the multipliers themselves and not for their increments (`LocalContribution::shift`), as if the iteration began at
/// zero. So the multipliers are those of least norm `sum lambda^2` among all that balance (docs/theory/multibody.md#redundancy).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Compliance {
    weights: Option<Weights>,
    value: f64,
    tangents: u32,
}

impl Compliance {
    /// Part of the range that an iteration leaves; the round-off of a constraint, over it, is what multipliers have beside their range. Both are to be small.
    pub const RELATIVE: f64 = 1e-6;

    pub fn set(&mut self, weights: Option<Weights>) {
        self.weights = weights;
        self.begin(0.0);
    }

    /// A step begins.
    pub fn begin(&mut self, dt: f64) {
        self.value = self.weights.map_or(0.0, |weights| Self::RELATIVE / weights.stiffness(dt));
        self.tangents = 0;
    }

    /// An evaluation follows.
    pub fn renew(&mut self, want_tangent: bool) {
        self.tangents = self.tangents.saturating_add(u32::from(want_tangent));
    }

    /// Adds to the row of a multiplier.
    pub fn add(&self, row: usize, multiplier: f64, want_tangent: bool, local: &mut LocalContribution) {
        if self.value == 0.0 || !want_tangent {
            return;
        }
        let dim = local.dim();
        local.tangent[row * dim + row] -= self.value;
        if self.tangents == 1 {
            local.shift.resize(dim, 0.0);
            local.shift[row] -= self.value * multiplier;
        }
    }
}
