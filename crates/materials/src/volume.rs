//! Energies of the change of volume of the catalogue's laws, see [`stoss_continuum::volume`].

use std::sync::Arc;
use stoss_continuum::VolumetricEnergy;
use stoss_continuum::volume::logarithm_divided_difference;

/// `U = lambda/2 (ln J)^2`, of neo-Hooke.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Logarithmic {
    pub lambda: f64,
}

impl VolumetricEnergy for Logarithmic {
    fn energy(&self, j: f64) -> f64 {
        0.5 * self.lambda * j.ln() * j.ln()
    }
    fn pressure(&self, j: f64) -> (f64, f64) {
        let log = j.ln();
        (self.lambda * log / j, self.lambda * (1.0 - log) / (j * j))
    }
    fn divided_difference(&self, a: f64, b: f64) -> (f64, f64) {
        let (quotient, slope) = logarithm_divided_difference(a, b);
        let mean = 0.5 * (a.ln() + b.ln());
        (self.lambda * mean * quotient, self.lambda * (0.5 * quotient / b + mean * slope))
    }
}

/// An energy and a logarithmic one.
#[derive(Clone, Debug)]
pub(crate) struct Sum {
    pub one: Arc<dyn VolumetricEnergy>,
    pub more: Logarithmic,
}

impl VolumetricEnergy for Sum {
    fn energy(&self, j: f64) -> f64 {
        self.one.energy(j) + self.more.energy(j)
    }
    fn pressure(&self, j: f64) -> (f64, f64) {
        let (a, b) = (self.one.pressure(j), self.more.pressure(j));
        (a.0 + b.0, a.1 + b.1)
    }
    fn divided_difference(&self, a: f64, b: f64) -> (f64, f64) {
        let (one, more) = (self.one.divided_difference(a, b), self.more.divided_difference(a, b));
        (one.0 + more.0, one.1 + more.1)
    }
}

/// `U = c (J - 1)^2`, of Mooney-Rivlin. Finite at `J = 0`: not for large compression.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quadratic {
    pub c: f64,
}

impl VolumetricEnergy for Quadratic {
    fn energy(&self, j: f64) -> f64 {
        self.c * (j - 1.0) * (j - 1.0)
    }
    fn pressure(&self, j: f64) -> (f64, f64) {
        (2.0 * self.c * (j - 1.0), 2.0 * self.c)
    }
    fn divided_difference(&self, a: f64, b: f64) -> (f64, f64) {
        (self.c * ((a - 1.0) + (b - 1.0)), self.c)
    }
}

/// `U = kappa (ln J / beta + (J^-beta - 1) / beta^2)`, of Ogden.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Power {
    pub kappa: f64,
    pub beta: f64,
}

/// `e(z) - 1` and `e'(z)` of `e(z) = (exp(z) - 1) / z`.
fn exponential_quotient(z: f64) -> (f64, f64) {
    if z.abs() < 0.1 {
        // Sums of z^k / (k + 1)! and k z^(k - 1) / (k + 1)!.
        let (mut value, mut slope, mut power, mut factorial) = (0.0, 0.0, 1.0, 1.0);
        for k in 1..=10 {
            let k = f64::from(k);
            factorial *= k + 1.0;
            slope += k * power / factorial;
            power *= z;
            value += power / factorial;
        }
        (value, slope)
    } else {
        let e = z.exp_m1() / z;
        (e - 1.0, (z.exp() - e) / z)
    }
}

impl VolumetricEnergy for Power {
    fn energy(&self, j: f64) -> f64 {
        let x = self.beta * j.ln();
        self.kappa * (x + (-x).exp_m1()) / (self.beta * self.beta)
    }
    fn pressure(&self, j: f64) -> (f64, f64) {
        let Self { kappa, beta } = *self;
        let less = -(-beta * j.ln()).exp_m1();
        // J^-beta = 1 - less
        (kappa / (beta * j) * less, kappa / (beta * j * j) * (beta - (beta + 1.0) * less))
    }
    fn divided_difference(&self, a: f64, b: f64) -> (f64, f64) {
        let Self { kappa, beta } = *self;
        let (quotient, slope) = logarithm_divided_difference(a, b);
        let z = -beta * (b - a) * quotient;
        let (more, e_slope) = exponential_quotient(z);
        let less = -(-beta * a.ln()).exp_m1();
        // 1 - a^-beta e(z), and its derivative with dz/db = -beta / b.
        let bracket = less - (1.0 - less) * more;
        let bracket_slope = (1.0 - less) * e_slope * beta / b;
        let scale = kappa / beta;
        (scale * quotient * bracket, scale * (slope * bracket + quotient * bracket_slope))
    }
}

#[cfg(test)]
mod tests {
    use crate::{MooneyRivlin, NeoHooke, Ogden, SaintVenantKirchhoff};
    use proptest::prelude::*;
    use stoss_continuum::{HyperelasticLaw, SymmetricTensor2, volume::pressure_stress};

    fn laws() -> Vec<Box<dyn HyperelasticLaw>> {
        vec![
            Box::new(NeoHooke::new(5000.0, 1.0).unwrap()),
            Box::new(MooneyRivlin::new(0.4, 0.1, 2500.0).unwrap()),
            Box::new(Ogden::new(&[0.63, 0.0012, -0.01], &[1.3, 5.0, -2.0], 5000.0, 9.0).unwrap()),
            Box::new(Ogden::new(&[0.63], &[1.3], 50.0, -2.0).unwrap()),
        ]
    }

    proptest! {
        #[test]
        fn the_parts_add_up_to_the_law(c in proptest::array::uniform6(-0.3..0.3_f64)) {
            let c = SymmetricTensor2::IDENTITY + SymmetricTensor2(c);
            let j = c.det().sqrt();
            for law in laws() {
                let split = law.volumetric().unwrap();
                let energy = split.rest.energy(&c).unwrap() + split.volume.energy(j);
                prop_assert!((energy - law.energy(&c).unwrap()).abs() < 1e-12 * energy.abs().max(1.0), "{}", law.name());
                let (p, slope) = split.volume.pressure(j);
                let (of_pressure, mut moduli) = pressure_stress(p, &c, j);
                let inverse = c.inverse();
                moduli.add_dyad(slope * j * j, &inverse, &inverse);
                let (stress, rest) = split.rest.stress_and_elasticity(&c).unwrap();
                let (expected, elasticity) = law.stress_and_elasticity(&c).unwrap();
                prop_assert!((stress + of_pressure - expected).norm() < 1e-11 * expected.norm().max(1.0), "{}", law.name());
                let scale = elasticity.max_abs();
                let difference = rest + moduli + elasticity * -1.0;
                prop_assert!(difference.max_abs() < 1e-12 * scale, "{}", law.name());
                // Nothing of a large modulus is left in the rest.
                let moduli = split.rest.small_strain_moduli();
                prop_assert!((moduli.shear - law.small_strain_moduli().shear).abs() < 1e-12);
                prop_assert!(moduli.bulk < 5.0);
            }
        }

        #[test]
        fn quotients_of_the_energy(a in 0.3..2.5_f64, power in -9.0..0.0_f64) {
            for law in laws() {
                let u = law.volumetric().unwrap().volume;
                let b = a * (1.0 + 10f64.powf(power));
                let (p, slope) = u.divided_difference(a, b);
                let change = u.energy(b) - u.energy(a);
                prop_assert!((p * (b - a) - change).abs() < 1e-14 * (u.energy(a) + u.energy(b)).max(1e-2), "{}", law.name());
                let h = 1e-4 * b;
                let difference = |f: &dyn Fn(f64) -> f64| (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h);
                // The second derivative of Ogden's has a zero, where the first one is the measure.
                let measure = |j: f64| u.pressure(j).1.abs().max(u.pressure(j).0.abs() / j);
                let scale = measure(a).max(measure(b));
                prop_assert!((slope - difference(&|t| u.divided_difference(a, b + t).0)).abs() < 1e-9 * scale, "{}", law.name());
                let (first, second) = u.pressure(b);
                prop_assert!((first - difference(&|t| u.energy(b + t))).abs() < 1e-9 * scale);
                prop_assert!((second - difference(&|t| u.pressure(b + t).0)).abs() < 1e-9 * scale);
                // The limit of no step.
                let (p, slope) = u.divided_difference(b, b);
                prop_assert!((p - first).abs() < 1e-14 * scale && (slope - 0.5 * second).abs() < 1e-13 * scale, "{}", law.name());
            }
        }
    }

    #[test]
    fn saint_venant_kirchhoff_has_no_such_form() {
        assert!(SaintVenantKirchhoff::new(1.0, 1.0).unwrap().volumetric().is_none());
    }
}
