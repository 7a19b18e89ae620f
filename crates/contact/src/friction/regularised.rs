//! Friction without stick.

use super::check;
use super::law::{FrictionInput, FrictionLaw, FrictionOutput};
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
    /// With a coefficient `mu >= 0` and the speed `v_0 > 0`.
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

    fn traction(&self, input: &FrictionInput) -> FrictionOutput {
        let length = self.speed * input.step_size;
        let [x, y] = input.slip;
        let root = (x * x + y * y + length * length).sqrt();
        if root == 0.0 || input.pressure <= 0.0 {
            return FrictionOutput::default();
        }
        let unit = [x / root, y / root];
        let bound = self.mu * input.pressure;
        FrictionOutput {
            traction: unit.map(|u| bound * u),
            sticks: false,
            d_pressure: unit.map(|u| self.mu * u),
            d_trial: [[0.0; 2]; 2],
            d_slip: std::array::from_fn(|i| {
                std::array::from_fn(|j| bound / root * (f64::from(u8::from(i == j)) - unit[i] * unit[j]))
            }),
        }
    }

    fn is_elastic(&self) -> bool {
        false
    }
}
