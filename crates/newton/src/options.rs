//! Settings of the iteration, and their defaults with reasons.

/// When and how a step is shortened.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LineSearch {
    /// Full steps only. A trial that is not admissible ends the iteration with the problem's error.
    #[default]
    Off,
    /// A full step is tried first, and assembled at once, so that the line search costs nothing while it is not needed.
    /// If the step is not admissible or the residual grows too much, the step is shortened until both are fine.
    Backtracking {
        /// A step is accepted if the residual is at most this times the previous one. In contact problems the residual may
        /// grow in one iteration; with 1 the iteration would stall there.
        max_growth: f64,
        /// Lower bound of the previous residual in this test, as a part of the scale. In dynamics a contact that closes starts with the violation of its
        /// constraint alone, which may be arbitrarily small; the contact forces come with the first step.
        small: f64,
        /// Factor between two trials, in (0, 1).
        reduction: f64,
        /// Largest number of reductions; then the iteration stops with [`crate::StopReason::LineSearchFailed`].
        max_reductions: u32,
    },
    /// The search of [`Self::Backtracking`]; where no constraint is violated, a full step that goes too far is also shortened by the slope
    /// `g(s) = R(u + s du) . du`: it is accepted if `g` has changed its sign by at most [`OVERSHOOT`]; else a root of `g` is sought by false position. For
    /// forces with kinks, as of points that begin to yield, between which full steps may jump for ever while the residual grows by little.
    Slope {
        /// Largest factor by which the residual may grow, see [`Self::Backtracking`].
        max_growth: f64,
        /// Lower bound of the previous residual in this test, as a part of the scale, see [`Self::Backtracking`].
        small: f64,
        /// Factor between two trials, in (0, 1).
        reduction: f64,
        /// Largest number of reductions, see [`Self::Backtracking`]; also the largest number of trials along the slope.
        max_reductions: u32,
    },
    /// If the problem has a [`crate::Potential`], a step is accepted if the potential falls sufficiently (Armijo's condition), up to round-off; the residual may grow. Without a potential a step is accepted if the residual does
    /// not grow. Otherwise the step is reduced, and if no length is accepted, the one with the smallest potential, or residual, is taken.
    /// For forces that grow without bound as surfaces approach each other.
    Best {
        /// Factor between two trials, in (0, 1).
        reduction: f64,
        /// Largest number of reductions.
        max_reductions: u32,
    },
}

/// Part of the slope at the start by which the slope may change its sign over a full step.
pub const OVERSHOOT: f64 = 0.3;

impl LineSearch {
    /// Halving, at most 8 times, when the residual grows tenfold.
    pub fn backtracking() -> Self {
        Self::Backtracking { max_growth: 10.0, small: 0.0, reduction: 0.5, max_reductions: 8 }
    }

    /// Search without a look at the slope.
    pub(crate) fn without_slope(self) -> Self {
        match self {
            Self::Slope { max_growth, small, reduction, max_reductions } => {
                Self::Backtracking { max_growth, small, reduction, max_reductions }
            }
            other => other,
        }
    }

    /// Search with a look at the slope; [`Self::Off`] and others stay what they are.
    pub fn with_slope(self) -> Self {
        match self {
            Self::Backtracking { max_growth, small, reduction, max_reductions } => {
                Self::Slope { max_growth, small, reduction, max_reductions }
            }
            other => other,
        }
    }

    /// Halving, at most 5 times, down to the smallest potential or residual.
    pub fn best() -> Self {
        Self::Best { reduction: 0.5, max_reductions: 5 }
    }
}

/// Settings of the iteration. Norms are those of the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonOptions {
    /// Least number of linear systems solved before the tolerance is tested. 1 where a small first residual does not mean a solution: after a change of
    /// constraints it may be small before anything has moved.
    pub min_iterations: u32,
    /// Largest number of linear systems solved to reach the tolerance. The iterations of [`Self::polish`] are not counted, nor, up to four times this number, those whose
    /// step lowered a fixed potential.
    pub max_iterations: u32,
    /// Converged when `residual <= absolute_tolerance + relative_tolerance * scale` and the constraints' relative violation is at
    /// most `relative_tolerance`. A residual's unit.
    pub absolute_tolerance: f64,
    /// Part of the scale to which the residual and the constraints' violation have to fall, see [`Self::absolute_tolerance`]. Without unit.
    pub relative_tolerance: f64,
    /// Largest number of further iterations after the tolerance is reached, each only if the one before reduced the residual
    /// by [`Self::polish_factor`] and round-off is not reached yet. Zero: stop at the tolerance.
    pub polish: u32,
    /// Reduction of the residual, in (0, 1), that a further iteration must reach for another one to follow.
    pub polish_factor: f64,
    /// Whether the problem is to hold the tangent of a polished solution. Nothing is solved with it any more.
    pub tangent_at_solution: bool,
    /// Part of the scale below which the residual is round-off: no further iterations there.
    pub round_off_level: f64,
    /// A residual that no longer falls by [`Self::polish_factor`] counts as converged to round-off although the tolerance is
    /// not reached, if it is at most this times the scale, or ...
    pub stagnation_residual: f64,
    /// ... if the increment is at most this times the norm of the iterate: the last bits of the iterate decide then.
    pub stagnation_increment: f64,
    /// Stop as stagnated after so many iterations without a new smallest residual.
    pub stagnation_iterations: u32,
    /// Stop as diverged when the residual exceeds this times the larger of first residual and first scale.
    pub divergence_factor: f64,
    /// The line search.
    pub line_search: LineSearch,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self {
            min_iterations: 0,
            max_iterations: 25,
            absolute_tolerance: 0.0,
            relative_tolerance: 1e-9,
            polish: 1,
            polish_factor: 0.5,
            tangent_at_solution: false,
            round_off_level: 1e-15,
            stagnation_residual: 1e-11,
            stagnation_increment: 1e-13,
            stagnation_iterations: 10,
            divergence_factor: 1e8,
            line_search: LineSearch::Off,
        }
    }
}
