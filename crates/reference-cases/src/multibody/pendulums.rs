//! Pendulums in minimal coordinates, by the classical method of Runge and Kutta.

/// Integrates `y' = f(y)` to `end` in equal steps; of order 4.
pub fn runge_kutta<const N: usize>(
    start: [f64; N],
    end: f64,
    steps: u32,
    f: impl Fn(&[f64; N]) -> [f64; N],
) -> [f64; N] {
    let h = end / f64::from(steps);
    let plus = |y: &[f64; N], c: f64, d: &[f64; N]| -> [f64; N] { std::array::from_fn(|i| y[i] + c * d[i]) };
    let mut y = start;
    for _ in 0..steps {
        let k1 = f(&y);
        let k2 = f(&plus(&y, 0.5 * h, &k1));
        let k3 = f(&plus(&y, 0.5 * h, &k2));
        let k4 = f(&plus(&y, h, &k3));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    y
}

/// Two links in a plane on hinges, the second at distance `length` from the first hinge. Angles are from the downward vertical.
#[derive(Clone, Copy, Debug)]
pub struct DoublePendulum {
    /// Masses.
    pub mass: [f64; 2],
    /// Moments of inertia about the centres.
    pub inertia: [f64; 2],
    /// Distances of the centres from the upper hinge of each link.
    pub centre: [f64; 2],
    /// Distance of the hinges.
    pub length: f64,
    /// Gravity.
    pub gravity: f64,
}

impl DoublePendulum {
    fn coefficients(&self) -> ([f64; 3], [f64; 2]) {
        let ([m1, m2], [j1, j2], [a1, a2], l) = (self.mass, self.inertia, self.centre, self.length);
        (
            [j1 + m1 * a1 * a1 + m2 * l * l, j2 + m2 * a2 * a2, m2 * l * a2],
            [(m1 * a1 + m2 * l) * self.gravity, m2 * a2 * self.gravity],
        )
    }

    /// Rates of `(angle_1, angle_2, rate_1, rate_2)` by Lagrange's equations.
    pub fn rates(&self, y: &[f64; 4]) -> [f64; 4] {
        let ([m11, m22, c], [g1, g2]) = self.coefficients();
        let (s, cos) = (y[0] - y[1]).sin_cos();
        let m12 = c * cos;
        let f1 = -c * s * y[3] * y[3] - g1 * y[0].sin();
        let f2 = c * s * y[2] * y[2] - g2 * y[1].sin();
        let det = m11 * m22 - m12 * m12;
        [y[2], y[3], (m22 * f1 - m12 * f2) / det, (m11 * f2 - m12 * f1) / det]
    }

    /// Kinetic and potential energy.
    pub fn energy(&self, y: &[f64; 4]) -> f64 {
        let ([m11, m22, c], [g1, g2]) = self.coefficients();
        0.5 * (m11 * y[2] * y[2] + m22 * y[3] * y[3]) + c * (y[0] - y[1]).cos() * y[2] * y[3]
            - g1 * y[0].cos()
            - g2 * y[1].cos()
    }

    /// State at a time.
    pub fn state(&self, start: [f64; 4], time: f64, steps: u32) -> [f64; 4] {
        runge_kutta(start, time, steps, |y| self.rates(y))
    }
}

/// A body on a ball joint whose three moments about the centre are equal, without spin about the line from the joint to the centre: with the unit vector
/// `n` along that line `n'' = -|n'|^2 n + w^2 (e - (e . n) n)`, `w^2 = m g l / I`, `e` downwards (`-z`).
pub fn spherical_pendulum(start: [f64; 6], square: f64, time: f64, steps: u32) -> [f64; 6] {
    runge_kutta(start, time, steps, |y| {
        let speed = y[3] * y[3] + y[4] * y[4] + y[5] * y[5];
        let along = -y[2];
        let down = [0.0, 0.0, -1.0];
        let acceleration: [f64; 3] = std::array::from_fn(|i| -speed * y[i] + square * (down[i] - along * y[i]));
        [y[3], y[4], y[5], acceleration[0], acceleration[1], acceleration[2]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runge_and_kutta_are_of_order_four() {
        let error = |steps| (runge_kutta([1.0, 0.0], 2.0, steps, |y| [y[1], -y[0]])[0] - 2.0_f64.cos()).abs();
        assert!(((error(20) / error(40)).log2() - 4.0).abs() < 0.1);
    }

    /// Two plain pendulums, with the hinges in one place: small swings have `w^2 = m g a / (J + m a^2)`. And the energy stays.
    #[test]
    fn double_pendulum() {
        let of = |length| DoublePendulum {
            mass: [1.5, 0.8],
            inertia: [0.12, 0.08],
            centre: [0.5, 0.4],
            length,
            gravity: 9.81,
        };
        let end = of(0.0).state([1e-4, 0.0, 0.0, 0.0], 1.1, 1000);
        let w = (1.5_f64 * 9.81 * 0.5 / (0.12 + 1.5 * 0.25)).sqrt();
        assert!((end[0] - 1e-4 * (w * 1.1).cos()).abs() < 1e-11 && end[1] == 0.0);
        let start = [1.5, 0.3, 0.0, -1.0];
        let end = of(1.0).state(start, 2.0, 20000);
        assert!((of(1.0).energy(&end) - of(1.0).energy(&start)).abs() < 1e-9);
    }

    /// A conical pendulum goes round with `W^2 cos(a) = w^2`.
    #[test]
    fn conical_pendulum() {
        let (a, square) = (0.6_f64, 7.0);
        let rate = (square / a.cos()).sqrt();
        let end = spherical_pendulum([a.sin(), 0.0, -a.cos(), 0.0, rate * a.sin(), 0.0], square, 1.3, 4000);
        let (s, c) = (1.3 * rate).sin_cos();
        assert!((end[0] - a.sin() * c).abs() < 1e-10 && (end[1] - a.sin() * s).abs() < 1e-10);
        assert!((end[2] + a.cos()).abs() < 1e-10);
    }
}
