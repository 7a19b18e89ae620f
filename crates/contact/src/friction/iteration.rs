//! What the iterations of a step know of one point with friction: where it slid at the last iterate, how its multiplier settles.

use super::law::Plane;
use super::step::{Friction, FrictionStep, Stick};
use crate::ContactError;

/// Rounds of augmentation in one step. What has not settled then is taken if it is close, else the step has failed.
pub const MAX_AUGMENTATIONS: u32 = 16;
/// A sticking point that moves by less than this times an edge may be left, and one that slides whose multiplier changes relatively by less than the
/// root of it.
const CLOSE: f64 = 1.0e-8;
/// A sticking point moves by less than this times an edge once its multiplier has settled, or by what round-off of the positions is.
const STUCK: f64 = 1.0e-13;
/// Relative change of the multiplier of a sliding point (its direction, that is) that counts as settled.
const SETTLED: f64 = 1.0e-8;
/// A round of augmentation that leaves more than this fraction of a gap or slip is slow.
const SLOWLY: f64 = 0.1;
/// Factor on the stiffness after a slow round.
const STIFFER: f64 = 100.0;
/// The stiffness makes no more than this fraction of the pressure out of the round-off of positions, which Newton's method would not get below.
const ROUND_OFF: f64 = 1.0e-10;

/// What becomes of the multiplier of a point after a converged iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Augmentation {
    /// The multiplier has settled.
    Settled,
    /// The traction at the end of the step is the new multiplier.
    Take,
    /// The multiplier is against the slip, from before a reversal: begin with zero.
    Reset,
}

/// A converged iterate of a point, for [`AugmentationRound::visit`].
#[derive(Clone, Copy, Debug)]
pub struct ConvergedPoint {
    /// Multiplier that the step was solved with, in the frame of `FrictionStep::end`, a traction.
    pub multiplier: [f64; 2],
    /// Slip of the step, a length.
    pub slip: [f64; 2],
    /// Pressure, a traction.
    pub pressure: f64,
    /// Length of an edge.
    pub edge: f64,
    /// Distance of the point from the origin: round-off of its position is a fraction of it.
    pub far: f64,
}

impl ConvergedPoint {
    /// Round-off of the slip, a length.
    fn round_off(&self) -> f64 {
        4.0 * f64::EPSILON * self.far.max(self.edge)
    }

    /// Whether the traction drives the slip, by more than round-off.
    fn is_reversed(&self, step: &FrictionStep) -> bool {
        step.work < -self.round_off() * norm(step.force)
    }
}

fn norm(v: Plane) -> f64 {
    v[0].hypot(v[1])
}

/// Factor on the stiffness of an augmented Lagrangian within a step. Where rounds are slow the spring is soft against inertia or against the bodies: what hits hard
/// may need a force that is far beyond stiffness times gap or slip of a small step. What the rounds converge to does not depend on the stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffening {
    factor: f64,
    last: f64,
}

impl Default for Stiffening {
    /// The factor at the start of every step.
    fn default() -> Self {
        Self { factor: 1.0, last: f64::INFINITY }
    }
}

impl Stiffening {
    /// The factor, at least 1.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Adapts the factor to a round that left a gap or slip of this size, a length; it does not exceed `stiffest`, or 1.
    pub fn follow(&mut self, left: f64, stiffest: f64) {
        if left > SLOWLY * self.last {
            self.factor = (STIFFER * self.factor).min(stiffest).max(1.0);
        }
        self.last = left;
    }
}

/// State of the iterations of one step for one point; [`PointIteration::default`] at the start of every step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointIteration {
    stiffening: Stiffening,
    /// Traction at the last iterate, if the point slid there.
    sliding: Option<Plane>,
    followed: bool,
    reversed: bool,
}

impl PointIteration {
    /// Factor on the tangential stiffness with which the multiplier is augmented, at least 1.
    pub fn stiffening(&self) -> f64 {
        self.stiffening.factor()
    }

    /// Whether the point is to be linearised on [`Friction::sticking_step`] although it slides, see [`Self::follow`].
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

    /// What round-off of the positions makes of the multiplier of a point, a traction.
    fn noise(&self, friction: &Friction, at: &ConvergedPoint) -> f64 {
        self.stiffening.factor() * friction.penalty() * at.round_off()
    }

    /// Whether a multiplier that has not settled after all rounds may be left as it is.
    fn is_close(&self, friction: &Friction, step: &FrictionStep, at: &ConvergedPoint) -> bool {
        if step.sticks {
            return norm(at.slip) <= CLOSE * at.edge;
        }
        let change = norm([0, 1].map(|i| step.force[i] - at.multiplier[i]));
        !at.is_reversed(step) && change <= CLOSE.sqrt() * norm(step.force) + self.noise(friction, at)
    }

    /// Decides on the multiplier after a converged iteration (augmented Lagrangian), and on the stiffness of the next one.
    fn augment(&mut self, friction: &Friction, step: &FrictionStep, at: &ConvergedPoint) -> Augmentation {
        let round_off = at.round_off();
        let left = if step.sticks {
            norm(at.slip)
        } else {
            // The traction of a point that slides is to turn until it is along the slip, and a soft spring turns it little in a round.
            (step.force[0] * at.slip[1] - step.force[1] * at.slip[0]).abs() / norm(step.force).max(f64::MIN_POSITIVE)
        };
        let change = norm([0, 1].map(|i| step.force[i] - at.multiplier[i]));
        let settled = if step.sticks {
            left <= STUCK * at.edge + round_off
        } else {
            change <= SETTLED * norm(step.force) + self.noise(friction, at)
        };
        if !step.sticks && at.is_reversed(step) {
            return Augmentation::Reset;
        }
        if settled {
            return Augmentation::Settled;
        }
        let stiffest = friction.resistance().max(ROUND_OFF * at.pressure / round_off);
        self.stiffening.follow(left, stiffest / friction.penalty());
        Augmentation::Take
    }
}

/// One round of augmentation of the points of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AugmentationRound {
    is_last: bool,
    unsettled: usize,
    far_off: usize,
}

impl AugmentationRound {
    /// Counts a round; `None` if nothing is augmented.
    pub fn begin(friction: &Friction, rounds: &mut u32) -> Option<Self> {
        (friction.stick() == Stick::Augmented).then(|| {
            *rounds += 1;
            Self { is_last: *rounds > MAX_AUGMENTATIONS, unsettled: 0, far_off: 0 }
        })
    }

    /// Gives a point the multiplier of the next round: `carried`, the traction at the end of the step in the frame of `start`, or none.
    pub fn visit(
        &mut self,
        iteration: &mut PointIteration,
        friction: &Friction,
        step: &FrictionStep,
        at: &ConvergedPoint,
        carried: Plane,
        start: &mut Plane,
    ) {
        let next = match iteration.augment(friction, step, at) {
            Augmentation::Settled => return,
            Augmentation::Take => carried,
            Augmentation::Reset => [0.0; 2],
        };
        self.unsettled += 1;
        self.far_off += usize::from(!iteration.is_close(friction, step, at));
        // After the last round nothing is solved any more: the forces stay those of the motion.
        if !self.is_last {
            *start = next;
        }
    }

    /// Number of multipliers that have not settled; none after the last round if all are close.
    ///
    /// # Errors
    /// [`ContactError::Augmentation`] if some are far off after the last round.
    pub fn finish(self) -> Result<usize, ContactError> {
        match self.is_last {
            false => Ok(self.unsettled),
            true if self.far_off == 0 => Ok(0),
            true => {
                let (what, rounds) = ("friction", MAX_AUGMENTATIONS);
                Err(ContactError::Augmentation { what, unsettled: self.far_off, rounds })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::{Coulomb, FrictionPoint};
    use std::sync::Arc;
    use stoss_term::{GradientRule, Step};

    fn friction(mu: f64) -> Friction {
        Friction::new(Arc::new(Coulomb::new(mu).unwrap()), 10.0, Stick::Multiplier).unwrap()
    }

    fn point(pressure: f64, slip: f64) -> FrictionPoint {
        FrictionPoint {
            history: [0.0; 2],
            slip: [slip, 0.0],
            pressure,
            step_size: 0.1,
            slid: 0.0,
            stiffening: 1.0,
            yielded: [0.0; 2],
        }
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

    /// A pressure of 2 and a slip that ever new rounds find the same, across a traction that a spring of 10 turns by little.
    #[test]
    fn traction_across_the_slip_is_turned_by_a_stiffer_spring() {
        let law = Arc::new(Coulomb::new(0.5).unwrap());
        let friction = Friction::new(law, 10.0, Stick::Augmented).unwrap();
        let (mut iteration, mut start) = (PointIteration::default(), [1.0, 0.0]);
        let mut rounds = 0;
        loop {
            let mut point = point(2.0, 0.0);
            (point.history, point.slip, point.stiffening) = (start, [0.0, 1e-3], iteration.stiffening());
            let step = friction.step(&point);
            let at = ConvergedPoint { multiplier: start, slip: point.slip, pressure: 2.0, edge: 1.0, far: 1.0 };
            if rounds == 100 || iteration.augment(&friction, &step, &at) == Augmentation::Settled {
                break;
            }
            start = step.force;
            rounds += 1;
        }
        assert!(rounds < 8 && start[0].abs() < 1e-7 && (start[1] - 1.0).abs() < 1e-12, "{rounds} rounds, {start:?}");
    }

    /// A multiplier that is taken after the last solution would be in the forces and not in the motion.
    #[test]
    fn the_last_round_changes_no_multiplier() {
        let friction = Friction::new(Arc::new(Coulomb::new(0.5).unwrap()), 10.0, Stick::Augmented).unwrap();
        let step = friction.step(&point(2.0, 1e-9));
        let at = ConvergedPoint { multiplier: [0.0; 2], slip: [1e-9, 0.0], pressure: 2.0, edge: 1.0, far: 1.0 };
        for is_last in [false, true] {
            let mut round = AugmentationRound { is_last, unsettled: 0, far_off: 0 };
            let mut start = [0.0; 2];
            round.visit(&mut PointIteration::default(), &friction, &step, &at, [0.3, 0.4], &mut start);
            assert_eq!((round.unsettled, round.far_off), (1, 0));
            assert_eq!(start, if is_last { [0.0; 2] } else { [0.3, 0.4] });
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
    fn what_has_not_settled_after_the_last_round_is_an_error_unless_close() {
        let round = |is_last, far_off| AugmentationRound { is_last, unsettled: 3, far_off };
        assert_eq!(round(false, 3).finish().unwrap(), 3);
        assert_eq!(round(true, 0).finish().unwrap(), 0);
        let error = round(true, 2).finish().unwrap_err();
        assert_eq!(error, ContactError::Augmentation { what: "friction", unsettled: 2, rounds: MAX_AUGMENTATIONS });
        let at =
            |slip: f64| ConvergedPoint { multiplier: [0.0; 2], slip: [slip, 0.0], pressure: 1.0, edge: 2.0, far: 0.0 };
        let stuck = FrictionStep { sticks: true, ..FrictionStep::default() };
        let (friction, iteration) = (friction(0.5), PointIteration::default());
        assert!(
            iteration.is_close(&friction, &stuck, &at(1.9e-8)) && !iteration.is_close(&friction, &stuck, &at(2.1e-8))
        );
        // A traction that works against the slip never is.
        let backward = FrictionStep { work: -1e-9, ..FrictionStep::default() };
        assert!(!iteration.is_close(&friction, &backward, &at(0.0)));
    }

    #[test]
    fn multipliers_are_weighed_with_the_inertia_of_the_step() {
        let mut exact = friction(0.5).with_inertia(3.0);
        exact.begin(&Step::new(&[], GradientRule::Midpoint, 0.1));
        assert!((exact.stiffness() - 310.0).abs() < 1e-9 && exact.share(0.0) == 1.0);
        assert!((exact.share(1e-3) - (1.0 - 31e-3)).abs() < 1e-12);
        assert!((exact.stored_by(1e-3, [3.0, 4.0]) - 0.5e-3 * 25.0 / 10.0).abs() < 1e-15);
        let mut careful = exact.clone().with_careful_weight(0.1);
        for (is_careful, weight) in [(true, 0.1), (false, 10.0)] {
            careful.begin(&Step { careful: is_careful, ..Step::quasi_static(&[], 0.1) });
            assert!(careful.stiffness() == weight && careful.spring_compliance() == 1.0);
        }
        let law = Arc::new(Coulomb::new(0.5).unwrap());
        let mut spring = Friction::new(law, 10.0, Stick::Penalty).unwrap().with_inertia(3.0);
        spring.begin(&Step::new(&[], GradientRule::Midpoint, 0.1));
        assert!(spring.stiffness() == 10.0 && spring.stored_by(1e-3, [3.0, 4.0]) == 0.0);
    }
}
