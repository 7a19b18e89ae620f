//! A coefficient that falls from a static to a dynamic value.

use super::check;
use super::law::{Coefficient, FrictionLaw, Sliding};
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
    /// The law with both coefficients (`mu_static >= mu_dynamic >= 0`) and the speed of the transition.
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

    fn coefficient(&self, at: &Sliding) -> Coefficient {
        let length = self.speed * at.step_size;
        let x = at.slip / length;
        let excess = (self.mu_static - self.mu_dynamic) * (-x * x).exp();
        // A step of no duration has an infinite speed, and far beyond the speed of the transition there is no slope: quotients may overflow there.
        if length > 0.0 && excess > 0.0 {
            Coefficient { value: self.mu_dynamic + excess, d_pressure: 0.0, d_slip: -2.0 * excess * x / length }
        } else {
            Coefficient { value: self.mu_dynamic, ..Coefficient::default() }
        }
    }
}
