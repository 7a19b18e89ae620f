//! Small-strain moduli.

/// Moduli of a law's linearisation at the reference state; each is a stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallStrainModuli {
    /// Shear modulus.
    pub shear: f64,
    /// Bulk modulus.
    pub bulk: f64,
}

impl SmallStrainModuli {
    /// The moduli from Young's modulus and Poisson's ratio (`-1 < poisson < 1/2`).
    pub fn from_young_poisson(young: f64, poisson: f64) -> Self {
        Self { shear: young / (2.0 * (1.0 + poisson)), bulk: young / (3.0 * (1.0 - 2.0 * poisson)) }
    }

    /// The moduli from Lamé's constants.
    pub fn from_lame(lambda: f64, shear: f64) -> Self {
        Self { shear, bulk: lambda + 2.0 * shear / 3.0 }
    }

    /// Young's modulus.
    pub fn young_modulus(&self) -> f64 {
        9.0 * self.bulk * self.shear / (3.0 * self.bulk + self.shear)
    }

    /// Poisson's ratio.
    pub fn poisson_ratio(&self) -> f64 {
        (3.0 * self.bulk - 2.0 * self.shear) / (2.0 * (3.0 * self.bulk + self.shear))
    }

    /// Lamé's first constant.
    pub fn lame_lambda(&self) -> f64 {
        self.bulk - 2.0 * self.shear / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_textbook_values() {
        // nu = 1/4 makes both Lamé constants equal, E = 5/2 of them; nu = 0: lambda = 0, E = 2 mu = 3 K.
        let m = SmallStrainModuli::from_lame(1.0, 1.0);
        assert!((m.poisson_ratio() - 0.25).abs() < 1e-15 && (m.young_modulus() - 2.5).abs() < 1e-15);
        let m = SmallStrainModuli::from_young_poisson(3.0, 0.0);
        assert_eq!((m.shear, m.bulk), (1.5, 1.0));
        assert!(m.lame_lambda().abs() < 1e-15);
    }

    #[test]
    fn conversions_agree() {
        let m = SmallStrainModuli::from_young_poisson(2250.0, 0.3);
        assert!((m.young_modulus() - 2250.0).abs() < 1e-9);
        assert!((m.poisson_ratio() - 0.3).abs() < 1e-14);
        assert!((m.lame_lambda() - 1_298.076_923_076_923).abs() < 1e-9);
        let again = SmallStrainModuli::from_lame(m.lame_lambda(), m.shear);
        assert!((again.bulk - m.bulk).abs() < 1e-9);
    }
}
