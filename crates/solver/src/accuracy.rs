//! How accurately linear equations are solved by iteration.

/// Relative residual of a linear solution. Newton's own residual falls at most by this factor in an iteration then, which is what it
/// gains at best where it converges quadratically and the residual is not yet at round-off. (Two tori with friction, 25 steps: as many Newton
/// iterations as with 1e-10; 1e-4 takes two more. With the forcing terms of Eisenstat and Walker, between 1e-2 and 1e-6, a quarter of the iterations with factors of an earlier iterate is spared, but
/// Newton's method no longer ends quadratically, and a block that hits a wall has its step cut.)
const LEAST: f64 = 1.0e-6;

/// The largest one that Newton's tolerance may ask for.
const LARGEST: f64 = 1.0e-2;

/// What the linear equations of an iterate are solved to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Accuracy {
    /// Whether Newton's method ends at its tolerance: if not, more accuracy is of use.
    pub ends_at_tolerance: bool,
    enough: f64,
}

impl Accuracy {
    /// What is enough for the tolerance ([`stoss_newton::NewtonProblem::aim`]).
    pub fn aim(&mut self, relative: f64) {
        self.enough = if self.ends_at_tolerance { relative } else { 0.0 };
    }

    /// Relative tolerance to which the linear equations of the iterate are to be solved.
    pub fn tolerance(self) -> f64 {
        self.enough.clamp(LEAST, LARGEST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_enough_counts_where_the_iteration_ends_at_its_tolerance() {
        let mut accuracy = Accuracy::default();
        accuracy.aim(1e-4);
        assert_eq!(accuracy.tolerance(), LEAST);
        accuracy.ends_at_tolerance = true;
        for (aim, enough) in [(1e-4, 1e-4), (0.3, LARGEST), (1e-9, LEAST), (f64::INFINITY, LARGEST)] {
            accuracy.aim(aim);
            assert_eq!(accuracy.tolerance(), enough);
        }
    }
}
