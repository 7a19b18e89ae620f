//! Stiffness and inertia of the cross-section of a beam.

use crate::error::{PartDataError, not_negative, positive};
use std::f64::consts::PI;

/// A cross-section with principal axes along the first two directors `d_1`, `d_2` (coordinates `x_1`, `x_2` from the centroid); `d_3` is its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// `E A`, a force.
    pub axial: f64,
    /// `k G A` along `d_1` and `d_2`, forces.
    pub shear: [f64; 2],
    /// `E int x_2^2 dA` about `d_1` and `E int x_1^2 dA` about `d_2`, force times length squared.
    pub bending: [f64; 2],
    /// `G J`, force times length squared.
    pub torsion: f64,
    /// `rho A`, a mass per length.
    pub mass: f64,
    /// `rho int x_1^2 dA` and `rho int x_2^2 dA`, mass times length: what the directors `d_1` and `d_2` carry.
    pub rotary: [f64; 2],
}

/// Isotropic elastic material of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionMaterial {
    /// `E`, a stress.
    pub young: f64,
    /// Poisson's ratio, in `(-1, 1/2]`; `G = E / (2 (1 + nu))`.
    pub poisson: f64,
    /// Mass per volume; zero in statics.
    pub density: f64,
}

/// Numbers of an area: `A`, `int x_1^2`, `int x_2^2`, and Saint-Venant's torsion constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// `A`, a length squared.
    pub area: f64,
    /// `int x_1^2 dA`, `int x_2^2 dA`, lengths to the fourth.
    pub second: [f64; 2],
    /// `J`, a length to the fourth.
    pub torsion: f64,
}

impl Area {
    /// A rectangle with sides along `d_1` and `d_2`.
    pub fn rectangle(sides: [f64; 2]) -> Self {
        let [a, b] = sides;
        Self { area: a * b, second: [a * a * a * b / 12.0, a * b * b * b / 12.0], torsion: rectangle_torsion(sides) }
    }

    /// A circle.
    pub fn circle(radius: f64) -> Self {
        Self::tube(0.0, radius)
    }

    /// A circular tube.
    pub fn tube(inner: f64, outer: f64) -> Self {
        let fourth = 0.25 * PI * (outer.powi(4) - inner.powi(4));
        Self { area: PI * (outer * outer - inner * inner), second: [fourth; 2], torsion: 2.0 * fourth }
    }
}

/// Saint-Venant's torsion constant of a rectangle with long side `a` and short side `b`,
/// `J = a b^3 (1/3 - 64/pi^5 b/a sum_{n odd} tanh(n pi a / (2 b)) / n^5)` (Timoshenko and Goodier, Theory of Elasticity, art. 109).
fn rectangle_torsion(sides: [f64; 2]) -> f64 {
    let (a, b) = (sides[0].max(sides[1]), sides[0].min(sides[1]));
    // The terms left out are below n^-4 / 8, 1e-13 of the sum.
    let term = |n: i32| (f64::from(n) * PI * a / (2.0 * b)).tanh() / f64::from(n).powi(5);
    let sum: f64 = (0..800).rev().map(|k| term(2 * k + 1)).sum();
    a * b.powi(3) * (1.0 / 3.0 - 64.0 / PI.powi(5) * b / a * sum)
}

impl Section {
    /// The section of an area, with a factor `k` of the shear area (1: none) and, in place of [`Area::torsion`], a torsion constant `J` if it is given.
    ///
    /// # Errors
    /// [`PartDataError::Number`].
    pub fn new(
        area: Area,
        material: SectionMaterial,
        shear_factor: f64,
        torsion_constant: Option<f64>,
    ) -> Result<Self, PartDataError> {
        let SectionMaterial { young, poisson, density } = material;
        if !(poisson > -1.0 && poisson <= 0.5) {
            return Err(PartDataError::Number { what: "Poisson's ratio", value: poisson, must: "in (-1, 1/2]" });
        }
        let shear_modulus = young / (2.0 * (1.0 + poisson));
        let shear = shear_factor * shear_modulus * area.area;
        let section = Self {
            axial: young * area.area,
            shear: [shear; 2],
            bending: [young * area.second[1], young * area.second[0]],
            torsion: shear_modulus * torsion_constant.unwrap_or(area.torsion),
            mass: density * area.area,
            rotary: area.second.map(|i| density * i),
        };
        section.check()?;
        Ok(section)
    }

    /// A rectangle with sides along `d_1`, `d_2`; shear factor and torsion constant as in [`Self::new`] (5/6 is usual).
    ///
    /// # Errors
    /// The errors of [`Self::new`].
    pub fn rectangle(
        sides: [f64; 2],
        material: SectionMaterial,
        shear_factor: f64,
        torsion_constant: Option<f64>,
    ) -> Result<Self, PartDataError> {
        positive("side of a rectangle", sides[0])?;
        positive("side of a rectangle", sides[1])?;
        Self::new(Area::rectangle(sides), material, shear_factor, torsion_constant)
    }

    /// A circle; shear factor as in [`Self::new`] (9/10 is usual).
    ///
    /// # Errors
    /// The errors of [`Self::new`].
    pub fn circle(radius: f64, material: SectionMaterial, shear_factor: f64) -> Result<Self, PartDataError> {
        positive("radius of a circle", radius)?;
        Self::new(Area::circle(radius), material, shear_factor, None)
    }

    /// A circular tube; shear factor as in [`Self::new`] (1/2 is usual for a thin wall).
    ///
    /// # Errors
    /// The errors of [`Self::new`].
    pub fn tube(inner: f64, outer: f64, material: SectionMaterial, shear_factor: f64) -> Result<Self, PartDataError> {
        not_negative("inner radius of a tube", inner)?;
        positive("wall of a tube", outer - inner)?;
        Self::new(Area::tube(inner, outer), material, shear_factor, None)
    }

    /// Whether stiffness is positive and inertia not negative. Without any mass a beam is for statics.
    ///
    /// # Errors
    /// [`PartDataError::Number`].
    pub fn check(&self) -> Result<(), PartDataError> {
        positive("axial stiffness", self.axial)?;
        self.shear.iter().try_for_each(|&s| positive("shear stiffness", s))?;
        self.bending.iter().try_for_each(|&b| positive("bending stiffness", b))?;
        positive("torsional stiffness", self.torsion)?;
        not_negative("mass per length", self.mass)?;
        self.rotary.iter().try_for_each(|&r| not_negative("rotary inertia per length", r))
    }

    /// Stiffness of the strains `(Gamma_1, Gamma_2, Gamma_3, K_1, K_2, K_3)`.
    pub fn stiffness(&self) -> [f64; 6] {
        [self.shear[0], self.shear[1], self.axial, self.bending[0], self.bending[1], self.torsion]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: SectionMaterial = SectionMaterial { young: 2.0, poisson: 0.25, density: 3.0 };

    /// Timoshenko and Goodier, art. 109: 0.1406 of the square, 0.229 of 2:1, 0.312 of 10:1.
    #[test]
    fn torsion_constants_of_the_tables() {
        for (ratio, tabulated, digits) in [(1.0, 0.1406, 5e-5), (2.0, 0.229, 5e-4), (10.0, 0.312, 5e-4)] {
            for sides in [[ratio * 0.3, 0.3], [0.3, ratio * 0.3]] {
                let j = rectangle_torsion(sides) / (ratio * 0.3_f64.powi(4));
                assert!((j - tabulated).abs() < digits, "{ratio}: {j}");
            }
        }
        assert!((rectangle_torsion([1.0, 1.0]) - 0.140_577_014_955).abs() < 1e-11);
    }

    /// The beam of the thesis (E.1): all four values, with `J = a^4 / 6`.
    #[test]
    fn section_of_the_lever() {
        let (a, material) = (0.02_f64, SectionMaterial { young: 1.1e10, poisson: 0.5, density: 750.0 });
        let s = Section::rectangle([a, a], material, 1.0, Some(a.powi(4) / 6.0)).unwrap();
        for (value, expected) in [
            (s.axial, 4.4e6),
            (s.shear[0], 4.4e6 / 3.0),
            (s.bending[1], 440.0 / 3.0),
            (s.torsion, 880.0 / 9.0),
            (s.mass, 0.3),
            (s.rotary[0], 1e-5),
        ] {
            assert!((value / expected - 1.0).abs() < 1e-14, "{value} {expected}");
        }
    }

    #[test]
    fn a_flat_section_bends_easily_about_its_long_side() {
        // Long along d_1: stiff about d_2, and d_1 is the heavy director.
        let s = Section::rectangle([4.0, 1.0], STEEL, 5.0 / 6.0, None).unwrap();
        assert!((s.bending[0] - 2.0 * 4.0 / 12.0).abs() < 1e-14 && (s.bending[1] - 2.0 * 64.0 / 12.0).abs() < 1e-13);
        assert!((s.rotary[0] - 3.0 * 64.0 / 12.0).abs() < 1e-13 && (s.rotary[1] - 3.0 * 4.0 / 12.0).abs() < 1e-14);
    }

    #[test]
    fn tubes() {
        let (s, whole) = (Section::tube(1.0, 2.0, STEEL, 0.5).unwrap(), Section::circle(2.0, STEEL, 0.5).unwrap());
        assert!((s.axial - 2.0 * 3.0 * PI).abs() < 1e-13);
        assert!((s.torsion - 0.8 * 7.5 * PI).abs() < 1e-13 && (whole.torsion - 0.8 * 8.0 * PI).abs() < 1e-13);
        assert!(Section::tube(2.0, 2.0, STEEL, 0.5).is_err() && Section::circle(f64::NAN, STEEL, 1.0).is_err());
        assert!(Section::circle(1.0, SectionMaterial { poisson: 0.6, ..STEEL }, 1.0).is_err());
        assert!(Section::circle(1.0, SectionMaterial { young: 0.0, ..STEEL }, 1.0).is_err());
    }
}
