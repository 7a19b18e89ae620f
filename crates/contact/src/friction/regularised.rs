//! Friction without stick.

use super::check;
use super::law::{Coefficient, FrictionLaw, Sliding};
use crate::ContactError;

/// Coulomb's law, smoothed over the speed: `tau = mu p v / sqrt(|v|^2 + v_0^2)` with the mean velocity `v` of the slip in the step.
///
/// There is no stick and no spring: below `v_0` it is viscous, and a load below the bound creeps at `v_0 t / sqrt((mu p)^2 - t^2)`. Smooth in
/// all arguments for `p > 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regularised {
    mu: f64,
    speed: f64,
}

impl Regularised {
    /// The law with a coefficient `mu >= 0` and the speed `v_0 > 0`.
    ///
    /// # Errors
    /// [`ContactError::Friction`] if one is out of its range.
    pub fn new(mu: f64, speed: f64) -> Result<Self, ContactError> {
        Ok(Self {
            mu: check("mu", mu, mu >= 0.0, "not negative")?,
            speed: check("speed", speed, speed > 0.0, "positive")?,
        })
    }
}

impl FrictionLaw for Regularised {
    fn name(&self) -> &str {
        "regularised"
    }

    fn coefficient(&self, at: &Sliding) -> Coefficient {
        let length = self.speed * at.step_size;
        let root = at.slip.hypot(length);
        if root == 0.0 {
            return Coefficient::default();
        }
        let [sine, cosine] = [at.slip / root, length / root];
        Coefficient { value: self.mu * sine, d_pressure: 0.0, d_slip: self.mu * cosine * cosine / root }
    }

    fn sticks(&self) -> bool {
        false
    }
}
