//! How accurately linear equations are solved by iteration: as far as the next residual of Newton's method can show it.

use stoss_linalg::Accuracy;
use stoss_newton::ResidualNorms;

/// Relative residual of a linear solution near the end, and the least one. Newton's own residual falls at most by this factor in an iteration then, which is what it
/// gains at best where it converges quadratically and the residual is not yet at round-off. (Two tori with friction, 25 steps: as many Newton
/// iterations as with 1e-10.)
const LEAST: f64 = 1.0e-6;

/// The largest one, and that of the first solution.
const LARGEST: f64 = 1.0e-2;

/// Factor of the forcing term (Eisenstat and Walker, SIAM J. Sci. Comput. 17, 1996, choice 2). Below one, so that an iteration that converges quadratically does not need another one.
const FACTOR: f64 = 0.1;

/// Relative residual of Newton's method below which its end is near: the next iterate is to have all digits.
const NEAR: f64 = 1.0e-6;

/// The forcing terms `FACTOR (r / r_before)^2` of an inexact Newton method with the relative residuals `r`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Forcing {
    /// At the iterate.
    residual: f64,
    /// Where the linear equations were solved last; zero before.
    solved_at: f64,
    /// Whether Newton's method ends at its tolerance: if not, more accuracy is of use.
    pub ends_at_tolerance: bool,
    enough: f64,
}

impl Forcing {
    /// Notes the norms at an iterate, with the relative violation of the constraints.
    pub fn note(&mut self, norms: &ResidualNorms, violation: f64) {
        let relative = if norms.scale > 0.0 { norms.residual / norms.scale } else { 0.0 };
        self.residual = relative.max(violation);
    }

    /// What is enough for the tolerance ([`stoss_newton::NewtonProblem::aim`]).
    pub fn aim(&mut self, relative: f64) {
        self.enough = if self.ends_at_tolerance { relative } else { 0.0 };
    }

    /// To what the linear equations of the iterate are to be solved.
    pub fn accuracy(&mut self) -> Accuracy {
        Accuracy { forcing: self.forcing(), enough: self.enough.clamp(LEAST, LARGEST) }
    }

    fn forcing(&mut self) -> f64 {
        let before = std::mem::replace(&mut self.solved_at, self.residual);
        if self.residual < NEAR {
            LEAST
        } else if before == 0.0 {
            LARGEST
        } else {
            (FACTOR * (self.residual / before).powi(2)).clamp(LEAST, LARGEST)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Loose at first and where the residual does not fall, tighter the faster it falls, and tight near the end.
    #[test]
    fn the_tolerance_follows_the_residual() {
        let mut forcing = Forcing::default();
        let mut at = |residual: f64, violation: f64| {
            forcing.note(&ResidualNorms { residual: 4.0 * residual, scale: 4.0 }, violation);
            forcing.accuracy().forcing
        };
        assert_eq!(at(1.0, 0.0), LARGEST);
        assert_eq!(at(2.0, 0.0), LARGEST);
        assert!((at(2e-2, 0.0) / 1e-5 - 1.0).abs() < 1e-12);
        assert_eq!(at(1e-2, 2.0), LARGEST);
        assert_eq!(at(1e-5, 0.0), LEAST);
        assert_eq!(at(9e-7, 0.0), LEAST);
    }

    #[test]
    fn what_is_enough_counts_where_the_iteration_ends_at_its_tolerance() {
        let mut forcing = Forcing::default();
        forcing.aim(1e-4);
        assert_eq!(forcing.accuracy().enough, LEAST);
        forcing.ends_at_tolerance = true;
        for (aim, enough) in [(1e-4, 1e-4), (0.3, LARGEST), (1e-9, LEAST), (f64::INFINITY, LARGEST)] {
            forcing.aim(aim);
            assert_eq!(forcing.accuracy().enough, enough);
        }
    }
}
