//! Tops.

use super::elliptic::{jacobi, quarter_period};

/// A free top with three different principal moments of inertia `I_1 < I_2 < I_3` (Landau and Lifshitz, *Mechanics*, section 37).
#[derive(Clone, Copy, Debug)]
pub struct FreeTop {
    /// `I_1 < I_2 < I_3`.
    pub inertia: [f64; 3],
    /// Angular velocity at the start about the first and third axis, both positive; about the second there is none.
    pub start: [f64; 2],
}

impl FreeTop {
    /// Amplitudes, frequency and parameter.
    fn constants(&self) -> ([f64; 3], f64, f64) {
        let [i1, i2, i3] = self.inertia;
        let [w1, w3] = self.start;
        let twice = i1 * w1 * w1 + i3 * w3 * w3;
        let square = (i1 * w1).powi(2) + (i3 * w3).powi(2);
        // What is `2 E I_3 - M^2` and `M^2 - 2 E I_1` there.
        let (low, high) = (twice * i3 - square, square - twice * i1);
        let amplitudes = [w1, (low / (i2 * (i3 - i2))).sqrt(), w3];
        (amplitudes, ((i3 - i2) * high / (i1 * i2 * i3)).sqrt(), (i2 - i1) * low / ((i3 - i2) * high))
    }

    /// Whether the angular momentum goes round the third axis (`M^2 > 2 E I_2`), for which the formulas are.
    pub fn goes_round_third_axis(&self) -> bool {
        self.constants().2 < 1.0
    }

    /// Angular velocity about the principal axes at a time: `(w_1 cn, a sn, w_3 dn)`.
    pub fn angular_velocity(&self, time: f64) -> [f64; 3] {
        let (a, frequency, m) = self.constants();
        let (sn, cn, dn) = jacobi(frequency * time, m);
        [a[0] * cn, a[1] * sn, a[2] * dn]
    }

    /// Time after which the angular velocity is the same again, `4 K(m)` over the frequency.
    pub fn period(&self) -> f64 {
        let (_, frequency, m) = self.constants();
        4.0 * quarter_period(m) / frequency
    }
}

/// A symmetric top with a fixed point under gravity.
#[derive(Clone, Copy, Debug)]
pub struct LagrangeTop {
    /// Moment of inertia about the axis of symmetry, `I_3`.
    pub axial: f64,
    /// Moment of inertia about an axis through the fixed point at right angles to it, `I_1`.
    pub transverse: f64,
    /// Weight times distance of the centre of mass from the fixed point, `m g l`.
    pub moment: f64,
    /// Cosine of the inclination at the start, where the inclination does not change.
    pub cosine: f64,
    /// Spin about the axis of symmetry, `w_3`.
    pub spin: f64,
    /// Precession at the start, `phi'`.
    pub precession: f64,
}

impl LagrangeTop {
    /// `u'^2 = f(u)` for `u = cos(theta)`, `f = (alpha - beta u) (1 - u^2) - (b - a u)^2` (Goldstein, *Classical Mechanics*, (5.62)).
    pub fn cubic(&self, u: f64) -> f64 {
        let (alpha, beta, a, b) = self.constants();
        (alpha - beta * u) * (1.0 - u * u) - (b - a * u).powi(2)
    }

    fn constants(&self) -> (f64, f64, f64, f64) {
        let (u, square) = (self.cosine, 1.0 - self.cosine * self.cosine);
        let beta = 2.0 * self.moment / self.transverse;
        let a = self.axial * self.spin / self.transverse;
        let b = self.precession * square + a * u;
        (beta * u + square * self.precession * self.precession, beta, a, b)
    }

    /// Smallest and largest cosine of the inclination: the roots of the cubic in `[-1, 1]`, of which the start is one.
    pub fn limits(&self) -> [f64; 2] {
        let (alpha, beta, a, _) = self.constants();
        let u = self.cosine;
        // f = beta u^3 - (alpha + a^2) u^2 + ...: the sum of the roots is (alpha + a^2) / beta, their product from f(0) = alpha - b^2.
        let f0 = self.cubic(0.0);
        let sum = (alpha + a * a) / beta - u;
        // u v w = -f(0) / beta; at u = 0 from the linear coefficient.
        let product = if u.abs() > 1e-3 {
            -f0 / (beta * u)
        } else {
            let (_, _, _, b) = self.constants();
            (2.0 * a * b - beta) / beta - u * sum
        };
        let root = (0.25 * sum * sum - product).sqrt();
        // The other two are sum / 2 -+ root; the larger one is beyond 1. By the product without cancellation.
        let other = product / (0.5 * sum + root);
        [u.min(other), u.max(other)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multibody::pendulums::runge_kutta;

    const TOP: FreeTop = FreeTop { inertia: [0.3, 0.5, 0.6], start: [1.0, 2.0] };

    /// Euler's equations, integrated.
    #[test]
    fn free_top_follows_eulers_equations() {
        assert!(TOP.goes_round_third_axis());
        let [a, b, c] = TOP.inertia;
        let rates = |w: &[f64; 3]| [(b - c) * w[1] * w[2] / a, (c - a) * w[2] * w[0] / b, (a - b) * w[0] * w[1] / c];
        let end = 3.7;
        let integrated = runge_kutta([1.0, 0.0, 2.0], end, 4000, rates);
        let exact = TOP.angular_velocity(end);
        for i in 0..3 {
            assert!((integrated[i] - exact[i]).abs() < 1e-11, "{integrated:?} {exact:?}");
        }
        let again = TOP.angular_velocity(TOP.period());
        assert!((again[0] - 1.0).abs() < 1e-12 && again[1].abs() < 1e-12 && (again[2] - 2.0).abs() < 1e-12);
    }

    #[test]
    fn limits_are_roots_of_the_cubic() {
        for (cosine, precession) in [(0.8, 0.0), (0.5, 1.3), (0.0, 0.0), (-0.3, 0.4)] {
            let top = LagrangeTop { axial: 0.1, transverse: 0.4, moment: 2.0, cosine, spin: 30.0, precession };
            let [low, high] = top.limits();
            assert!(low < high && low >= -1.0 && high <= 1.0, "{low} {high}");
            for u in [low, high] {
                assert!(top.cubic(u).abs() < 1e-11, "{u}: {:e}", top.cubic(u));
            }
            assert!(top.cubic(0.5 * (low + high)) > 0.0);
        }
    }
}
