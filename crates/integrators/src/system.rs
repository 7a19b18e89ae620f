//! The trait of a system that a scheme integrates.

use crate::{ForceRule, GradientRule};

/// The configurations of a step.
#[derive(Clone, Copy, Debug)]
pub struct StepConfiguration<'a> {
    /// Beginning of the step.
    pub time: f64,
    /// Size of the step.
    pub dt: f64,
    /// Positions at `n`.
    pub q_n: &'a [f64],
    /// Iterate of the positions at `n+1`.
    pub q_np1: &'a [f64],
}

/// The tangent of damping forces that a scheme needs: `weight (position dD/dq + rate dD/dv)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampingTangent {
    /// Factor of the whole.
    pub weight: f64,
    /// Derivative of the positions at which they are evaluated with respect to `q_np1`.
    pub position: f64,
    /// Derivative of the velocities at which they are evaluated with respect to `q_np1`, one over a time.
    pub rate: f64,
}

/// A system `M v' + F(q) + D(q, v) - G^T p = 0`, `Phi(q) = 0` with constant mass. Its matrix, its multipliers `p` and its constraint rows are
/// its own; vectors have [`Self::dimension`] entries.
pub trait SecondOrderSystem {
    /// What can go wrong.
    type Error;

    /// Number of coordinates.
    fn dimension(&self) -> usize;

    /// False if there are no constraints: then no storage is kept for their forces, and they are not evaluated.
    fn has_constraints(&self) -> bool {
        true
    }

    /// `out += factor M x`.
    fn add_mass_product(&self, factor: f64, x: &[f64], out: &mut [f64]);

    /// Solves `M x = rhs`; on entry `x` is an initial guess. Coordinates whose motion is prescribed keep their value on entry.
    ///
    /// # Errors
    /// The mass is singular.
    fn solve_mass(&mut self, rhs: &[f64], x: &mut [f64]) -> Result<(), Self::Error>;

    /// Sets the tangent to `factor M`. Called before the other contributions.
    fn start_tangent(&mut self, factor: f64);

    /// `out += F_rule`, external loads (taken at the rule's time) subtracted; with `tangent = Some(w)` also
    /// `w dF_rule/dq_np1` to the tangent.
    ///
    /// # Errors
    /// The force is not defined at this configuration.
    fn add_force(
        &mut self,
        step: StepConfiguration<'_>,
        rule: ForceRule,
        tangent: Option<f64>,
        out: &mut [f64],
    ) -> Result<(), Self::Error>;

    /// Whether there are damping forces ([`Self::add_damping`]); false by default.
    fn has_damping(&self) -> bool {
        false
    }

    /// `out += D(q, v)`, the damping forces; with `tangent` also their derivative to the tangent. No damping by default.
    ///
    /// # Errors
    /// The force is not defined at this configuration.
    fn add_damping(
        &mut self,
        _q: &[f64],
        _v: &[f64],
        _tangent: Option<DampingTangent>,
        _out: &mut [f64],
    ) -> Result<(), Self::Error> {
        Ok(())
    }

    /// `out += G_rule^T p`, and the system's own constraint rows; with `tangent` also `-weight d(G_rule^T p)/d(q_np1, p)` and the
    /// derivatives of the rows (these not weighted). Systems without constraints do nothing (default).
    ///
    /// # Errors
    /// The constraint is not defined at this configuration.
    fn add_constraint_force(
        &mut self,
        _step: StepConfiguration<'_>,
        _rule: GradientRule,
        _weight: f64,
        _tangent: bool,
        _out: &mut [f64],
    ) -> Result<(), Self::Error> {
        Ok(())
    }
}
