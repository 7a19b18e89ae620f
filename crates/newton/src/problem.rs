//! The trait of a problem `R(q) = 0`.

use crate::LineSearch;

/// Size of the residual, and what it is to be compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResidualNorms {
    /// Norm of the residual; zero at the solution.
    pub residual: f64,
    /// Size of the terms whose sum the residual is, in the same norm (for a balance of forces: the largest of the norms of
    /// inertial, internal, external and contact forces). Round-off leaves a residual of about `1e-16 * scale`. May be zero.
    pub scale: f64,
}

/// A function whose gradient the residual is, such as the potential energy, at an iterate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Potential {
    /// Value of the potential, up to a constant.
    pub value: f64,
    /// Bound of the round-off of a difference of two values, `>= 0`.
    pub round_off: f64,
    /// Whether it is the same function in all iterations. If not (friction with the normal forces of the last iterate), a smaller residual counts as progress too.
    pub is_fixed: bool,
}

/// A system of equations at an iterate that the problem itself stores.
///
/// Calls come in this order: `assemble`, then for each iteration `solve` (or `solve_downhill`, `potential`, `slope`), `longest_step`, `update` by that much, `assemble`; where a line search or
/// the polishing rejects that step, `update(s)` with smaller `s` (0 included), `residual_norms`, and `assemble` again. The last iteration of the polishing ends with `residual_norms`.
pub trait NewtonProblem {
    /// What can go wrong in the problem.
    type Error;

    /// Assembles residual and tangent at the present iterate and returns the residual's norms.
    ///
    /// # Errors
    /// The problem's own; recoverable ones (see [`Self::is_recoverable`]) lead to a shorter step.
    fn assemble(&mut self) -> Result<ResidualNorms, Self::Error>;

    /// Told before each solution: how small the residual of the linear equations has to be, over their right-hand side, for Newton's residual to come below its tolerance, as far as the
    /// linear equations decide. A problem that solves them by iteration need not be more accurate. Zero, or a small number, if more is better. Ignored by default.
    fn aim(&mut self, _relative: f64) {}

    /// Solves `K du = -R` with what was assembled last, remembers the iterate as the base of `update`, and returns the norm
    /// of `du`.
    ///
    /// # Errors
    /// The problem's own errors, for instance a singular tangent. They end the iteration.
    fn solve(&mut self) -> Result<f64, Self::Error>;

    /// Solves as [`Self::solve`], with a tangent that is modified, if necessary, so that the potential falls along the increment. Called instead of `solve`
    /// with [`crate::LineSearch::Best`]. [`Self::solve`] by default.
    ///
    /// # Errors
    /// The errors of [`Self::solve`].
    fn solve_downhill(&mut self) -> Result<f64, Self::Error> {
        self.solve()
    }

    /// The line search of the next iteration, where the options have `chosen`: [`crate::LineSearch::Best`] pays where forces may grow without bound along the increment.
    /// `chosen` by default.
    fn line_search(&self, chosen: LineSearch) -> LineSearch {
        chosen
    }

    /// The potential at the iterate that was evaluated last, if the problem has one. It may be another function after each linear solution, if its gradient at the iterate of that solution is the residual.
    /// None by default.
    ///
    /// # Errors
    /// The errors of [`Self::assemble`].
    fn potential(&mut self) -> Result<Option<Potential>, Self::Error> {
        Ok(None)
    }

    /// Derivative of the potential along the increment that was solved for last, at the iterate that was evaluated last: residual times increment. Used with a potential, and with [`crate::LineSearch::Slope`].
    fn slope(&self) -> f64 {
        0.0
    }

    /// Largest admissible step length in this iteration, as a part of the last increment, in (0, 1]: beyond it surfaces would pass through each other, for instance.
    /// 1 by default.
    ///
    /// # Errors
    /// The problem's own.
    fn longest_step(&mut self) -> Result<f64, Self::Error> {
        Ok(1.0)
    }

    /// Sets the iterate to `base + factor * du`, where `base` is the iterate at which `solve` was called. A second call replaces
    /// the first. After an error it must be possible to call it again with a smaller factor; `factor = 0` must restore
    /// the base, bit by bit.
    ///
    /// # Errors
    /// The problem's own.
    fn update(&mut self, factor: f64) -> Result<(), Self::Error>;

    /// The residual's norms at the present (trial) iterate, without the tangent. The default assembles everything.
    ///
    /// # Errors
    /// The errors of [`Self::assemble`].
    fn residual_norms(&mut self) -> Result<ResidualNorms, Self::Error> {
        self.assemble()
    }

    /// Largest violation of the constraints among the equations at the iterate that was evaluated last, relative to what they
    /// are measured with (a gap to a length): it must not exceed the relative tolerance. `residual` and `scale` are then those of
    /// the other equations. Zero without constraints (default).
    fn relative_violation(&self) -> f64 {
        0.0
    }

    /// Whether the linear equations that were solved last were those of the residual. If not, a small increment is no sign of round-off. True by default.
    fn is_linearised(&self) -> bool {
        true
    }

    /// Whether a shorter step may help: true for an inadmissible trial (an inverted element), false for everything that
    /// no step length changes. By default false.
    fn is_recoverable(&self, _error: &Self::Error) -> bool {
        false
    }

    /// Norm of the iterate, in the norm of the increment, for the relative size of an increment; zero if unknown (default).
    fn iterate_norm(&self) -> f64 {
        0.0
    }
}
