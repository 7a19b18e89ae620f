//! The elastica: a slender cantilever under a force at its end.

use super::elliptic::{jacobi, quarter_period};

/// Tip of a clamped, inextensible elastica of length one along x under the force `load = F L^2 / EI` along z: its coordinates x and z. The moment at the clamp is `F x`.
///
/// With the angle `phi` of the tangent from `-z` and the distance `s` from the tip, `phi'' = - load sin(phi)` is that of a pendulum at its turning point: `sin(phi / 2) = k sn(K - s sqrt(load))`.
/// The modulus is such that `phi = pi / 2` at the clamp; `x` follows from the first integral, `z` by Simpson's rule (Landau and Lifshitz, *Theory of elasticity*, section 19).
///
/// A shear stiffness that equals the axial one, `GA = EA`, adds `F L / EA` to `z` and changes nothing else: the strain is the force over this stiffness in every direction.
///
/// `None` if `load` is not positive.
pub fn tip(load: f64) -> Option<[f64; 2]> {
    if load.is_nan() || load <= 0.0 {
        return None;
    }
    let root = load.sqrt();
    let half_sine = |m: f64, s: f64| m.sqrt() * jacobi(quarter_period(m) - s * root, m).0;
    let (mut low, mut high) = (0.5, 1.0 - 1e-15);
    for _ in 0..100 {
        let m = 0.5 * (low + high);
        if half_sine(m, 1.0) < std::f64::consts::FRAC_1_SQRT_2 {
            low = m;
        } else {
            high = m;
        }
    }
    let m = 0.5 * (low + high);
    let pieces = 400;
    let slope = |i: u32| 2.0 * half_sine(m, f64::from(i) / f64::from(pieces)).powi(2) - 1.0;
    let weight = |i: u32| match i {
        0 => 1.0,
        i if i == pieces => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let z = (0..=pieces).map(|i| weight(i) * slope(i)).sum::<f64>() / (3.0 * f64::from(pieces));
    Some([(2.0 * (2.0 * m - 1.0)).sqrt() / root, z])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multibody::pendulums::runge_kutta;

    /// `theta'' = - load cos(theta)` with the moment that the closed form has at the clamp, integrated: no moment at the tip, which is where the closed form has it.
    #[test]
    fn the_equation_of_the_rod_is_fulfilled() {
        for load in [0.5, 4.0, 9.0] {
            let [x, z] = tip(load).unwrap();
            let rates = |y: &[f64; 4]| [y[1], -load * y[0].cos(), y[0].cos(), y[0].sin()];
            let end = runge_kutta([0.0, load * x, 0.0, 0.0], 1.0, 2000, rates);
            assert!(end[1].abs() < 1e-9, "{load}: {end:?}");
            assert!((end[2] - x).abs() < 1e-9 && (end[3] - z).abs() < 1e-9, "{load}: {end:?} {x} {z}");
        }
        assert_eq!(tip(0.0), None);
        // A small force: F L^3 / (3 EI).
        assert!((tip(1e-3).unwrap()[1] / (1e-3 / 3.0) - 1.0).abs() < 1e-6);
    }
}
