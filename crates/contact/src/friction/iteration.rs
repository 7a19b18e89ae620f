//! What the iterations of a step know of one point with friction: where it slid at the last iterate.

use super::law::Plane;
use super::step::FrictionStep;

/// State of the iterations of one step for one point; [`PointIteration::default`] at the start of every step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointIteration {
    /// Traction at the last iterate, if the point slid there.
    sliding: Option<Plane>,
    followed: bool,
    reversed: bool,
}

impl PointIteration {
    /// Whether the point is to be linearised on [`super::Friction::sticking_step`] although it slides, see [`Self::follow`].
    pub fn is_reversed(&self) -> bool {
        self.reversed
    }

    /// Follows an iterate that is linearised.
    ///
    /// A point that slides against the direction of the iterate before would be sent back by the tangent of the sliding branch, and so on without end:
    /// the solution is a stick between them, on a branch as short as its stiffness is large. Such a point is linearised once as if it stuck; the next
    /// iterate tells whether it does. That is the primal-dual active set, for friction.
    ///
    /// So is a point that has no traction yet because it has no pressure, at the first iterate of a step, if its coefficient is above 1: that it slides
    /// says nothing, and the tangent of the sliding branch would send it back the other way with a multiple of the pressure.
    pub fn follow(&mut self, step: &FrictionStep) {
        let now = step.force;
        let against = self.sliding.is_some_and(|last| last[0] * now[0] + last[1] * now[1] < 0.0);
        let coefficient = step.d_pressure[0].hypot(step.d_pressure[1]);
        let is_unknown = !self.followed && now == [0.0; 2] && coefficient > 1.0;
        self.followed = true;
        self.reversed = !step.sticks && (against || is_unknown);
        self.sliding = (!step.sticks && !against).then_some(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::{Coulomb, Friction, FrictionPoint, Stick};
    use std::sync::Arc;
    use stoss_term::{GradientRule, StepContext};

    fn friction(mu: f64) -> Friction {
        Friction::new(Arc::new(Coulomb::new(mu).unwrap()), 10.0, Stick::Multiplier).unwrap()
    }

    fn point(pressure: f64, slip: f64) -> FrictionPoint {
        FrictionPoint { history: [0.0; 2], slip: [slip, 0.0], pressure, step_size: 0.1, slid: 0.0, yielded: [0.0; 2] }
    }

    #[test]
    fn a_point_without_pressure_begins_stuck_if_its_coefficient_is_above_one() {
        for (mu, begins_stuck) in [(0.5, false), (10.0, true)] {
            let (friction, mut iteration) = (friction(mu), PointIteration::default());
            iteration.follow(&friction.step(&point(1e-300, 1.0)));
            assert!(!iteration.is_reversed(), "it has a traction");
            let mut iteration = PointIteration::default();
            let bare = FrictionStep { d_pressure: [mu, 0.0], ..FrictionStep::default() };
            iteration.follow(&bare);
            assert_eq!(iteration.is_reversed(), begins_stuck, "mu = {mu}");
            iteration.follow(&bare);
            assert!(!iteration.is_reversed(), "only at the first iterate");
        }
    }

    #[test]
    fn a_reversal_is_linearised_as_stick_once() {
        let (friction, mut iteration) = (friction(0.5), PointIteration::default());
        let slide = |slip: f64| friction.step(&point(2.0, slip));
        iteration.follow(&slide(1.0));
        assert!(!iteration.is_reversed());
        iteration.follow(&slide(-1.0));
        assert!(iteration.is_reversed());
        iteration.follow(&slide(-1.0));
        assert!(!iteration.is_reversed());
    }

    #[test]
    fn multipliers_are_weighed_with_the_inertia_of_the_step() {
        let mut exact = friction(0.5).with_inertia(3.0);
        exact.begin(&StepContext::new(&[], GradientRule::Midpoint, 0.1));
        assert!((exact.stiffness() - 310.0).abs() < 1e-9 && exact.share(0.0) == 1.0);
        assert!((exact.share(1e-3) - (1.0 - 31e-3)).abs() < 1e-12);
        assert!((exact.stored_by(1e-3, [3.0, 4.0]) - 0.5e-3 * 25.0 / 10.0).abs() < 1e-15);
        let mut careful = exact.clone().with_careful_weight(0.1);
        for (is_careful, weight) in [(true, 0.1), (false, 10.0)] {
            careful.begin(&StepContext { careful: is_careful, ..StepContext::quasi_static(&[], 0.1) });
            assert!(careful.stiffness() == weight && careful.spring_compliance() == 1.0);
        }
        let law = Arc::new(Coulomb::new(0.5).unwrap());
        let mut spring = Friction::new(law, 10.0, Stick::Penalty).unwrap().with_inertia(3.0);
        spring.begin(&StepContext::new(&[], GradientRule::Midpoint, 0.1));
        assert!(spring.stiffness() == 10.0 && spring.stored_by(1e-3, [3.0, 4.0]) == 0.0);
    }
}
