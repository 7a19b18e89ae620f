//! A coefficient that falls from a static to a dynamic value.

use super::check;
use super::law::{FrictionInput, FrictionLaw, FrictionOutput, return_to_bound};
use crate::ContactError;

/// Coulomb's law with a coefficient that depends on the speed `v = |slip| / step` of the step,
/// `mu(v) = mu_d + (mu_s - mu_d) exp(-(v / v_c)^2)`.
///
/// Smooth at rest, `mu_s` there, and within 2 % of `mu_s - mu_d` of the dynamic value beyond twice the speed `v_c`. It weakens with the slip,
/// by up to `0.86 (mu_s - mu_d) p / (v_c step)` a length. Where that exceeds what the bodies resist with, there are several solutions, and Newton's method may find none:
/// in dynamics small steps help, because inertia resists with the mass over the square of the step; in statics only large ones, or a larger `v_c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticDynamic {
    mu_static: f64,
    mu_dynamic: f64,
    speed: f64,
}

impl StaticDynamic {
    /// With both coefficients (`mu_static >= mu_dynamic >= 0`) and the speed of the transition.
    ///
    /// # Errors
    /// [`ContactError::Friction`] if one is out of its range.
    pub fn new(mu_static: f64, mu_dynamic: f64, speed: f64) -> Result<Self, ContactError> {
        Ok(Self {
            mu_dynamic: check("mu_dynamic", mu_dynamic, mu_dynamic >= 0.0, "not negative")?,
            mu_static: check("mu_static", mu_static, mu_static >= mu_dynamic, "not below `mu_dynamic`")?,
            speed: check("speed", speed, speed > 0.0, "positive")?,
        })
    }
}

impl FrictionLaw for StaticDynamic {
    fn name(&self) -> &str {
        "static-dynamic"
    }

    fn traction(&self, input: &FrictionInput) -> FrictionOutput {
        let pressure = input.pressure.max(0.0);
        let length = self.speed * input.step_size;
        let (mut excess, mut slope) = (0.0, [0.0; 2]);
        // A step of no duration has an infinite speed, and far beyond the speed of the transition there is no slope: quotients may overflow there.
        if length > 0.0 {
            let [x, y] = input.slip.map(|s| s / length);
            let weight = (-(x * x + y * y)).exp();
            if weight > 0.0 {
                excess = (self.mu_static - self.mu_dynamic) * weight;
                slope = [x, y].map(|x| -2.0 * excess * x * pressure / length);
            }
        }
        let mu = self.mu_dynamic + excess;
        let d_pressure = if input.pressure > 0.0 { mu } else { 0.0 };
        return_to_bound(input.trial, mu * pressure, d_pressure, slope)
    }
}
