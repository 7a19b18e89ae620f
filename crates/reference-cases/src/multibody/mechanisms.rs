//! Mechanisms and bearings.

/// Place of the slider of a crank of length `crank` with a rod of length `rod` at a crank angle: `r cos a + sqrt(l^2 - r^2 sin^2 a)`.
pub fn slider(crank: f64, rod: f64, angle: f64) -> f64 {
    let (s, c) = angle.sin_cos();
    crank * c + (rod * rod - (crank * s).powi(2)).sqrt()
}

/// Time and angle after which a torque stops a spin: `J w / T` and half of `w` times that.
pub fn braked(inertia: f64, spin: f64, torque: f64) -> (f64, f64) {
    let time = inertia * spin / torque;
    (time, 0.5 * spin * time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slider_at_its_ends_and_at_a_right_angle() {
        assert!((slider(3.0, 5.0, 0.0) - 8.0).abs() < 1e-14);
        assert!((slider(3.0, 5.0, std::f64::consts::PI) - 2.0).abs() < 1e-14);
        assert!((slider(3.0, 5.0, std::f64::consts::FRAC_PI_2) - 4.0).abs() < 1e-14);
    }

    #[test]
    fn braking() {
        assert_eq!(braked(0.5, 6.0, 1.5), (2.0, 6.0));
    }
}
