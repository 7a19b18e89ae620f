//! Compliance in the tangent that makes the linear equations of redundant constraints solvable, without an influence on the converged solution.

use stoss_term::Local;

/// Number of linear equations at the beginning of a step that are written for the multipliers themselves, not for their increments.
const ABSOLUTE: u32 = 2;

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
/// The residual has no compliance, so the constraints hold exactly. Multipliers are to be those of least norm `sum lambda^2` among all that balance, combinations `G y` of the gradients
/// at the end of the step (theory/multibody#redundancy). Increments are such combinations of the iterate's gradients, but multipliers begin with those of the last step, and away
/// from the solution redundant equations contradict each other in second order. So the first two linear equations of a step are written for the multipliers themselves
/// and not for their increments (`Local::shift`), as if they began at zero: the second is at gradients that are nearly the last. What the compliance takes
/// of the forces there is `eps` of them, and the iterations after them give it back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Compliance {
    weights: Option<Weights>,
    value: f64,
    tangents: u32,
}

impl Compliance {
    /// An iteration leaves this part of an error, and round-off of a constraint over it is the error of multipliers. Three pins of a door, a loop of four links and 18 welds
    /// between two bodies have multipliers to 2e-9, 2e-9 and 3e-7 with 1e-3; the first and the last to 4e-7 and 2e-4 with 1e-6.
    pub const RELATIVE: f64 = 1e-3;

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
    pub fn add(&self, row: usize, multiplier: f64, want_tangent: bool, local: &mut Local) {
        if self.value == 0.0 || !want_tangent {
            return;
        }
        let dim = local.dim();
        local.tangent[row * dim + row] -= self.value;
        if self.tangents <= ABSOLUTE {
            local.shift.resize(dim, 0.0);
            local.shift[row] -= self.value * multiplier;
        }
    }
}
