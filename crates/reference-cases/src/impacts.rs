//! Closed forms of impacts: a bar on a wall, a body that bounces, a corner.

use nalgebra::{Rotation3, Unit, Vector3};

/// Momentum of an elastic bar that hits a rigid wall with its end, over that of its flight: -1 before, 1 after. `time` is that since the impact, over the time in which the wave runs along the bar;
/// the bar pushes with the constant force `rho c v A` for twice that time (Timoshenko and Goodier, *Theory of elasticity*, section 168).
pub fn bar_on_wall(time: f64) -> f64 {
    (time - 1.0).clamp(-1.0, 1.0)
}

/// A body that falls flat on a floor from rest, and bounces.
#[derive(Clone, Copy, Debug)]
pub struct Bounces {
    /// Height of its lower side above the floor at the start.
    pub height: f64,
    /// Gravity, positive.
    pub gravity: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

impl Bounces {
    /// Time of an impact; the first one is 0.
    pub fn impact(&self, number: u32) -> f64 {
        let fall = (2.0 * self.height / self.gravity).sqrt();
        (1..=number).fold(fall, |time, k| time + 2.0 * fall * self.restitution.powi(k as i32))
    }

    /// Height to which the body rises after so many impacts.
    pub fn apex(&self, impacts: u32) -> f64 {
        self.height * self.restitution.powi(2 * impacts as i32)
    }

    /// Height at a time between the impacts `after` and `after + 1`.
    pub fn place(&self, after: u32, time: f64) -> f64 {
        let flight = time - self.impact(after);
        let speed = (2.0 * self.gravity * self.apex(after + 1)).sqrt();
        (speed - 0.5 * self.gravity * flight) * flight
    }
}

/// The lowest corner of a cube of edge one about the origin that is turned about an axis through the origin.
pub fn lowest_corner(axis: [f64; 3], degrees: f64) -> [f64; 3] {
    let turn = Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::from(axis)), degrees.to_radians());
    let corners = (0..8).map(|k| turn * Vector3::from([1, 2, 4].map(|bit| if k & bit == 0 { -0.5 } else { 0.5 })));
    let lower = |low: Vector3<f64>, corner: Vector3<f64>| if corner.z < low.z { corner } else { low };
    corners.fold(Vector3::zeros(), lower).into()
}

/// A body whose moments of inertia are equal meets a frictionless floor with a corner; it does not turn before.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Mass.
    pub mass: f64,
    /// Moment of inertia about every axis through the centre of mass.
    pub inertia: f64,
    /// The corner, from the centre of mass; the floor is below, its normal is z.
    pub arm: [f64; 3],
    /// Speed downwards.
    pub speed: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

impl Corner {
    /// Velocity of the centre of mass along z and angular velocity afterwards: the impulse is `(1 + e) v / (1/m + |r x n|^2 / J)`.
    pub fn after(&self) -> (f64, [f64; 3]) {
        let [x, y, _] = self.arm;
        let impulse = (1.0 + self.restitution) * self.speed / (1.0 / self.mass + (x * x + y * y) / self.inertia);
        (impulse / self.mass - self.speed, [impulse * y / self.inertia, -impulse * x / self.inertia, 0.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_hands_back_twice_its_momentum_in_two_passages_of_the_wave() {
        assert_eq!([-0.5, 0.0, 1.0, 2.0, 3.0].map(bar_on_wall), [-1.0, -1.0, 0.0, 1.0, 1.0]);
    }

    #[test]
    fn flights_begin_and_end_on_the_floor_and_have_their_apex_between() {
        let bounces = Bounces { height: 2.0, gravity: 9.81, restitution: 0.7 };
        assert!((0.5 * 9.81 * bounces.impact(0).powi(2) - 2.0).abs() < 1e-12);
        for k in 0..3 {
            let (start, end) = (bounces.impact(k), bounces.impact(k + 1));
            assert!(bounces.place(k, start).abs() < 1e-12 && bounces.place(k, end).abs() < 1e-12);
            assert!((bounces.place(k, 0.5 * (start + end)) - bounces.apex(k + 1)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_lowest_corner_of_a_cube_on_its_edge_is_the_edge() {
        let [x, y, z] = lowest_corner([0.0, 1.0, 0.0], 45.0);
        assert!(x.abs() < 1e-12 && y.abs() == 0.5 && (z + 0.5_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_corner_leaves_with_the_restitution_and_loses_no_energy_with_one() {
        for restitution in [0.0, 0.4, 1.0] {
            let corner = Corner { mass: 2.0, inertia: 0.3, arm: [0.2, -0.3, -0.6], speed: 1.5, restitution };
            let (v, w) = corner.after();
            let [x, y, _] = corner.arm;
            let rate = v + w[0] * y - w[1] * x;
            assert!((rate - restitution * corner.speed).abs() < 1e-12, "{rate}");
            let energy = corner.mass * v * v + corner.inertia * w.iter().map(|w| w * w).sum::<f64>();
            let before = corner.mass * corner.speed * corner.speed;
            assert!(if restitution == 1.0 { (energy - before).abs() < 1e-12 } else { energy < before });
        }
    }
}
