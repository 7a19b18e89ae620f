//! Beams and strings.

/// Deflection of the tip of a cantilever under a force, with shear: `F L^3 / (3 EI) + F L / (k G A)` (Timoshenko).
pub fn cantilever(force: f64, length: f64, bending: f64, shear: f64) -> f64 {
    force * (length.powi(3) / (3.0 * bending) + length / shear)
}

/// Load at which a clamped, slender, inextensible column buckles, `pi^2 EI / (4 L^2)` (Euler).
pub fn euler_load(length: f64, bending: f64) -> f64 {
    (std::f64::consts::PI / length).powi(2) * 0.25 * bending
}

/// Load at which a column with shear and compression buckles, whose equation for strains as of a director beam is `F (1 - F/EA + F/GA) = F_Euler`: the smaller
/// root (Reissner's beam; Haringx' column without `1/EA`).
pub fn buckling_load(length: f64, bending: f64, axial: f64, shear: f64) -> f64 {
    let (euler, c) = (euler_load(length, bending), 1.0 / shear - 1.0 / axial);
    // c F^2 + F - F_Euler = 0, without cancellation.
    2.0 * euler / (1.0 + (1.0 + 4.0 * c * euler).sqrt())
}

/// Lengthening of a rod that turns about one of its ends: `(rho A w^2 / EA) (x + u) + u'' = 0` has `u(L) = tan(k L) / k - L` with `k^2 = rho A w^2 / EA`.
pub fn spun_rod(length: f64, axial: f64, mass: f64, spin: f64) -> f64 {
    let k = spin * (mass / axial).sqrt();
    (k * length).tan() / k - length
}

/// The angle of a motor that comes from rest to `spin` in `rise`: `spin / rise (t^2/2 + (rise / 2 pi)^2 (cos(2 pi t / rise) - 1))`, then `spin (t - rise/2)`
/// (Simo and Vu-Quoc, J. Appl. Mech. 53 (1986) 855, with 6 rad/s and 15 s).
pub fn spin_up(spin: f64, rise: f64, time: f64) -> f64 {
    if time >= rise {
        return spin * (time - 0.5 * rise);
    }
    let w = std::f64::consts::TAU / rise;
    spin / rise * (0.5 * time * time + ((w * time).cos() - 1.0) / (w * w))
}

/// Span and sag of an elastic catenary of natural length `length` and weight `weight` per natural length with the horizontal tension `horizontal`, for the tension
/// `N = EA/2 (nu - 1/nu)`, thus the stretch `nu = N/EA + sqrt(1 + (N/EA)^2)`; by Simpson's rule.
pub fn catenary(length: f64, weight: f64, horizontal: f64, stiffness: f64) -> (f64, f64) {
    let n = 4000;
    let h = 0.5 * length / f64::from(n);
    let (mut span, mut sag) = (0.0, 0.0);
    for i in 0..=n {
        let factor = if i == 0 || i == n {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        } * h
            / 3.0;
        let s = h * f64::from(i);
        let tension = horizontal.hypot(weight * s);
        let e = tension / stiffness;
        let stretch = e + (1.0 + e * e).sqrt();
        span += factor * 2.0 * horizontal * stretch / tension;
        sag += factor * weight * s * stretch / tension;
    }
    (span, sag)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cantilever_and_columns() {
        assert!((cantilever(2.0, 3.0, 6.0, 4.0) - (3.0 + 1.5)).abs() < 1e-14);
        assert!((euler_load(2.0, 16.0) - std::f64::consts::PI.powi(2)).abs() < 1e-13);
        // The root satisfies its equation, and is Euler's without shear and compression.
        let f = buckling_load(2.0, 16.0, 100.0, 40.0);
        assert!((f * (1.0 - f / 100.0 + f / 40.0) - euler_load(2.0, 16.0)).abs() < 1e-12);
        assert!((buckling_load(2.0, 16.0, 50.0, 50.0) - euler_load(2.0, 16.0)).abs() < 1e-12);
    }

    /// Small: `rho A w^2 L^3 / (3 EA)`, the 5.14e-4 of Simo and Vu-Quoc.
    #[test]
    fn spun_rod_of_simo_and_vu_quoc() {
        assert!((spun_rod(10.0, 2.8e7, 1.2, 6.0) - 5.14e-4).abs() < 5e-7);
        assert!((spun_rod(10.0, 2.8e7, 1.2, 6.0) / (1.2 * 36.0 * 1000.0 / 8.4e7) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn the_motor_begins_and_ends_smoothly() {
        let rate = |t: f64| (spin_up(6.0, 15.0, t + 1e-5) - spin_up(6.0, 15.0, t - 1e-5)) / 2e-5;
        assert!(spin_up(6.0, 15.0, 0.0) == 0.0 && rate(1e-5) < 1e-8);
        assert!((spin_up(6.0, 15.0, 15.0 - 1e-9) - 45.0).abs() < 1e-7 && (rate(14.9999) - 6.0).abs() < 1e-4);
        assert!((rate(7.5) - 6.0 * 0.5).abs() < 1e-6);
    }

    /// Hardly extensible: `2 a asinh(L / 2a)` and `sqrt(a^2 + L^2/4) - a`.
    #[test]
    fn stiff_catenary() {
        let (span, sag) = catenary(3.0, 2.0, 1.4, 1e9);
        let a = 0.7_f64;
        assert!((span - 2.0 * a * (1.5 / a).asinh()).abs() < 1e-7);
        assert!((sag - ((a * a + 2.25).sqrt() - a)).abs() < 1e-7);
    }
}
