//! Springs, friction, motors, pretension and limits on the coordinate of a joint.

use std::sync::Arc;

/// A function of time that a motor follows.
pub trait Drive: Send + Sync + std::fmt::Debug {
    /// Angle (radians) or displacement at a time.
    fn value(&self, time: f64) -> f64;
}

/// A drive that is linear between pairs `(time, value)` in the order of time, and constant before the first and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseLinear(pub Vec<(f64, f64)>);

impl Drive for PiecewiseLinear {
    fn value(&self, time: f64) -> f64 {
        let after = self.0.partition_point(|&(t, _)| t <= time);
        let (Some(&(t0, v0)), next) = (self.0.get(after.max(1) - 1), self.0.get(after)) else { return 0.0 };
        match next {
            Some(&(t1, v1)) if after > 0 => v0 + (v1 - v0) * (time - t0) / (t1 - t0),
            _ => v0,
        }
    }
}

/// A drive by a function.
pub struct DriveFunction<F>(pub F);

impl<F> std::fmt::Debug for DriveFunction<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("DriveFunction")
    }
}

impl<F: Fn(f64) -> f64 + Send + Sync> Drive for DriveFunction<F> {
    fn value(&self, time: f64) -> f64 {
        (self.0)(time)
    }
}

/// An elastic spring on the coordinate, `V = 1/2 k (gamma - gamma_0)^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateSpring {
    /// `k`: a moment over an angle, or a force over a length.
    pub stiffness: f64,
    /// `gamma_0`.
    pub rest: f64,
}

/// Coulomb friction: the torque (or force) against the motion is at most `bound + coefficient * radius * |F|` with the force `F` between the points of
/// the joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoordinateFriction {
    /// Constant bound, a moment or a force.
    pub bound: f64,
    /// Coefficient of friction.
    pub coefficient: f64,
    /// Radius of the journal, a length; not used for a displacement.
    pub radius: f64,
}

/// Pretension of a bolt whose halves the joint connects: a given force (or torque) on the coordinate until the lock time, after which the coordinate keeps its value.
#[derive(Clone, Debug)]
pub struct Pretension {
    /// The force against the coordinate, positive in tension; until the lock it does work, and after it none.
    pub force: Arc<dyn Drive>,
    /// Time of the lock. Steps that begin at it or later are locked; one should end there.
    pub lock: f64,
}

/// Springs, friction, motor, pretension and limits on the coordinate of a joint; none by default.
#[derive(Clone, Debug, Default)]
pub struct CoordinateOptions {
    /// A spring.
    pub spring: Option<CoordinateSpring>,
    /// `d` of the torque `-d gamma'` (or force), not negative; without effect in statics.
    pub viscous: f64,
    /// Coulomb friction; sticks exactly. In statics it is against the increments of load steps.
    pub friction: Option<CoordinateFriction>,
    /// A motor: it prescribes the coordinate as a function of time.
    pub motor: Option<Arc<dyn Drive>>,
    /// A pretension; not with a motor.
    pub pretension: Option<Pretension>,
    /// Lower and upper limit. Kinetic energy is lost at closing, as in contact with the standard constraint.
    pub limits: Option<[f64; 2]>,
}

impl CoordinateOptions {
    pub(crate) fn any(&self) -> bool {
        self.spring.is_some()
            || self.viscous > 0.0
            || self.friction.is_some()
            || self.motor.is_some()
            || self.pretension.is_some()
            || self.limits.is_some()
    }

    /// Name and value of an option that is out of its range.
    pub(crate) fn fault(&self) -> Option<(&'static str, f64)> {
        let not_negative = |what, value: f64| (!(value >= 0.0 && value.is_finite())).then_some((what, value));
        let finite = |what, value: f64| (!value.is_finite()).then_some((what, value));
        let of_spring = |s: CoordinateSpring| not_negative("the stiffness", s.stiffness).or(finite("the rest", s.rest));
        let of_friction = |f: CoordinateFriction| {
            not_negative("the bound of friction", f.bound)
                .or(not_negative("the coefficient of friction", f.coefficient))
                .or(not_negative("the radius", f.radius))
        };
        let of_limits =
            |[low, high]: [f64; 2]| (low >= high || low.is_nan() || high.is_nan()).then_some(("the upper limit", high));
        let of_lock = |lock: f64| {
            // After the lock both would give the coordinate.
            let clash = self.motor.is_some().then_some(("the lock of a pretension beside a motor", lock));
            finite("the time of the lock", lock).or(clash)
        };
        (self.spring.and_then(of_spring))
            .or(not_negative("the viscous coefficient", self.viscous))
            .or(self.friction.and_then(of_friction))
            .or(self.limits.and_then(of_limits))
            .or(self.pretension.as_ref().and_then(|p| of_lock(p.lock)))
    }
}
