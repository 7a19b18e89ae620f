//! Homogeneous states of hyperelastic blocks as roots of one equation.

use super::super::scene::Matter;

/// Lamé's constants.
fn lame(matter: &Matter) -> (f64, f64) {
    let Matter { young, poisson, .. } = *matter;
    (young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 * young / (1.0 + poisson))
}

/// Root of an increasing function between two bounds.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    // Far more halvings than a double has digits.
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Neo-Hooke's nominal stress along a stretch `s` at the volume ratio `j`: `mu (s - 1/s) + lambda ln(J) / s`.
fn nominal(matter: &Matter, s: f64, j: f64) -> f64 {
    let (lambda, mu) = lame(matter);
    mu * (s - 1.0 / s) + lambda * j.ln() / s
}

/// Lateral stretch and nominal stress of a neo-Hookean block that is stretched along one axis and free along the others.
pub fn uniaxial(matter: &Matter, stretch: f64) -> (f64, f64) {
    let lateral = root(0.1, 10.0, |a| nominal(matter, a, a * a * stretch));
    (lateral, nominal(matter, stretch, lateral * lateral * stretch))
}

/// Stretch of a neo-Hookean cube under a pressure per current area: nominal stress `-p s^2`.
pub fn hydrostatic_neo_hooke(matter: &Matter, pressure: f64) -> f64 {
    root(1e-3, 1.0, |s| nominal(matter, s, s * s * s) + pressure * s * s)
}

/// The same with Saint Venant and Kirchhoff's law: `(3 lambda + 2 mu)/2 (s^2 - 1) s = -p s^2`.
pub fn hydrostatic_saint_venant_kirchhoff(matter: &Matter, pressure: f64) -> f64 {
    let (lambda, mu) = lame(matter);
    root(1e-3, 1.0, |s| 0.5 * (3.0 * lambda + 2.0 * mu) * (s * s - 1.0) + pressure * s)
}

/// Stretches of two neo-Hookean blocks of height 1 with Poisson's ratio 0, one upon the other, pressed to the height `height`
/// together, and their common nominal stress.
pub fn stack(lower: &Matter, upper: &Matter, height: f64) -> (f64, f64) {
    let stress = |matter: &Matter, s: f64| nominal(matter, s, s);
    let upper_stretch = root(height - 1.5, height - 0.5, |s| stress(upper, s) - stress(lower, height - s));
    (upper_stretch, stress(upper, upper_stretch))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_strains_follow_hooke() {
        let matter = Matter::new(1e3, 1.0);
        let (lateral, stress) = uniaxial(&matter, 1.0 + 1e-7);
        assert!((stress / 1e-4 - 1.0).abs() < 1e-5 && ((lateral - 1.0) / -3e-8 - 1.0).abs() < 1e-5);
        // Bulk modulus E / (3 (1 - 2 nu)).
        for s in [hydrostatic_neo_hooke(&matter, 1e-4), hydrostatic_saint_venant_kirchhoff(&matter, 1e-4)] {
            assert!((3.0 * (s - 1.0) * 1e3 / 1.2 / -1e-4 - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn an_incompressible_block_keeps_its_volume() {
        let (lateral, stress) = uniaxial(&Matter::new(3.0, 1.0).poisson(0.499_999_99), 2.0);
        assert!((lateral * lateral * 2.0 - 1.0).abs() < 1e-6);
        // mu (s - 1/s^2) with mu = 1.
        assert!((stress - 1.75).abs() < 1e-6);
    }

    #[test]
    fn equal_blocks_share_the_compression() {
        let matter = Matter::new(1e3, 1.0).poisson(0.0);
        assert!((stack(&matter, &matter, 1.6).0 - 0.8).abs() < 1e-12);
    }
}
