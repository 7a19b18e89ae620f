//! A trebuchet of rigid parts in minimal coordinates: a lever on a fixed hinge, a weight that hangs at its short arm, a stone on a sling without mass at its long arm.

use super::pendulums::runge_kutta;

/// The machine; its plane is that of x and z, gravity acts along -z, the pivot is the origin, and the lever's short arm is at positive x.
#[derive(Clone, Copy, Debug)]
pub struct Trebuchet {
    /// Lengths of the long and of the short arm.
    pub arms: [f64; 2],
    /// Mass of the lever, a uniform rod.
    pub lever: f64,
    /// Mass of the weight.
    pub weight: f64,
    /// Moment of inertia of the weight about its centre of mass.
    pub inertia: f64,
    /// Distance of that centre from the end of the short arm.
    pub hanger: f64,
    /// Mass of the stone.
    pub stone: f64,
    /// Length of the sling.
    pub sling: f64,
    /// Gravity, positive.
    pub gravity: f64,
    /// Angles at the start, where everything rests: of the lever above the horizontal, of the hanger and of the sling from the vertical, positive towards positive x; radians.
    pub start: [f64; 3],
}

/// Points in the plane: `(x, z)`.
#[derive(Clone, Copy, Debug)]
pub struct Points {
    /// The end of the long arm, to which the sling is tied.
    pub long: [f64; 2],
    /// The end of the short arm.
    pub short: [f64; 2],
    /// The centre of mass of the lever.
    pub lever: [f64; 2],
    /// The centre of mass of the weight.
    pub weight: [f64; 2],
    /// The stone.
    pub stone: [f64; 2],
}

impl Trebuchet {
    /// Distance of the lever's centre of mass from the pivot, along the short arm.
    fn centre(&self) -> f64 {
        0.5 * (self.arms[1] - self.arms[0])
    }

    /// Moment of inertia of the lever about its centre of mass.
    pub fn rod(&self) -> f64 {
        self.lever * (self.arms[0] + self.arms[1]).powi(2) / 12.0
    }

    /// Where everything is at these three angles.
    pub fn points(&self, [lever, hanger, sling]: [f64; 3]) -> Points {
        let along = |length: f64| [length * lever.cos(), length * lever.sin()];
        let below = |[x, z]: [f64; 2], length: f64, angle: f64| [x + length * angle.sin(), z - length * angle.cos()];
        let (long, short) = (along(-self.arms[0]), along(self.arms[1]));
        Points {
            long,
            short,
            lever: along(self.centre()),
            weight: below(short, self.hanger, hanger),
            stone: below(long, self.sling, sling),
        }
    }

    /// Rates of the three angles and their rates by Lagrange's equations.
    fn rates(&self, y: &[f64; 6]) -> [f64; 6] {
        let [lever, hanger, sling, w1, w2, w3] = *y;
        let ([long, short], c, g) = (self.arms, self.centre(), self.gravity);
        let (hung, tied) = (self.weight * short * self.hanger, self.stone * long * self.sling);
        let ((s2, c2), (s3, c3)) = ((hanger - lever).sin_cos(), (sling - lever).sin_cos());
        let m11 = self.rod() + self.lever * c * c + self.weight * short * short + self.stone * long * long;
        let (m22, m33) = (self.inertia + self.weight * self.hanger.powi(2), self.stone * self.sling.powi(2));
        let (m12, m13) = (hung * s2, -tied * s3);
        let moment = g * (self.lever * c + self.weight * short - self.stone * long);
        let f1 = tied * c3 * w3 * w3 - hung * c2 * w2 * w2 - moment * lever.cos();
        let f2 = hung * c2 * w1 * w1 - self.weight * g * self.hanger * hanger.sin();
        let f3 = -tied * c3 * w1 * w1 - self.stone * g * self.sling * sling.sin();
        let a1 = (f1 - m12 * f2 / m22 - m13 * f3 / m33) / (m11 - m12 * m12 / m22 - m13 * m13 / m33);
        [w1, w2, w3, a1, (f2 - m12 * a1) / m22, (f3 - m13 * a1) / m33]
    }

    /// Angles and their rates at a time, by the method of Runge and Kutta in so many steps.
    pub fn state(&self, time: f64, steps: u32) -> [f64; 6] {
        let [a, b, c] = self.start;
        runge_kutta([a, b, c, 0.0, 0.0, 0.0], time, steps, |y| self.rates(y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: Trebuchet = Trebuchet {
        arms: [0.9, 0.25],
        lever: 0.4,
        weight: 40.0,
        inertia: 0.3,
        hanger: 0.2,
        stone: 0.7,
        sling: 0.35,
        gravity: 9.81,
        start: [0.3, 0.1, -0.2],
    };

    /// The sum of the energies of the parts, with velocities by differences of the places, stays.
    #[test]
    fn the_energy_stays() {
        let energy = |time: f64| {
            let y = MACHINE.state(time, 4000);
            let h = 1e-6;
            let at = |sign: f64| MACHINE.points([0, 1, 2].map(|i| y[i] + sign * h * y[3 + i]));
            let (before, after, now) = (at(-1.0), at(1.0), at(0.0));
            let of = |mass: f64, of: fn(&Points) -> [f64; 2]| {
                let (a, b) = (of(&before), of(&after));
                let square: f64 = (0..2).map(|i| ((b[i] - a[i]) / (2.0 * h)).powi(2)).sum();
                mass * (0.5 * square + MACHINE.gravity * of(&now)[1])
            };
            0.5 * (MACHINE.rod() * y[3] * y[3] + MACHINE.inertia * y[4] * y[4])
                + of(MACHINE.lever, |p| p.lever)
                + of(MACHINE.weight, |p| p.weight)
                + of(MACHINE.stone, |p| p.stone)
        };
        let first = energy(0.0);
        for time in [0.1, 0.3, 0.5] {
            assert!((energy(time) - first).abs() < 1e-6 * first.abs(), "{time}: {} {first}", energy(time));
        }
    }

    /// The lever without stone and weight, a rod on a hinge: it falls with `m g c / J` at first.
    #[test]
    fn the_lever_alone_falls_as_a_rod() {
        let bare = Trebuchet { weight: 1e-9, inertia: 1e-9, stone: 1e-12, start: [0.0; 3], ..MACHINE };
        let (time, c) = (1e-3, 0.5 * (0.25 - 0.9));
        let expected = -0.5 * time * time * 0.4 * 9.81 * c / (bare.rod() + 0.4 * c * c);
        assert!((bare.state(time, 100)[0] / expected - 1.0).abs() < 1e-5);
    }
}
