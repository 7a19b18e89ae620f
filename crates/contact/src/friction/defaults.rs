//! Friction between two bodies: the stiffness that follows from theirs.

use super::{Friction, FrictionLaw, Stick};
use crate::ContactError;
use std::sync::Arc;
use stoss_term::GradientRule;

/// Tangential stiffness of friction in multiples of Young's modulus over an edge, if none is given: as a spring, a sticking node moves by a tenth
/// of what the elements beside it yield, and Newton's method still gets over the kink between stick and slip. Multipliers are weighed against slips
/// with it.
const STIFFNESS: f64 = 10.0;

/// Weight of slips against multipliers in a static step that failed with the weight above, in multiples of Young's modulus over an edge, if no stiffness is given: slips of
/// an iterate must not outweigh what is known of the traction already.
const CAREFUL_WEIGHT: f64 = 0.1;

impl Friction {
    /// Whether friction, and coordinate augmentation, can be had under a rule of the constraint gradients (theory/friction, theory/coordinate-augmentation: statics, end point,
    /// midpoint).
    pub fn is_available(rule: GradientRule) -> bool {
        matches!(rule, GradientRule::EndPoint | GradientRule::Midpoint | GradientRule::DiscreteGradient)
    }

    /// Tangential stiffness (traction per length): what is `given`, or that of bodies with this factor of the complementarity function ([`crate::PairScales::complementarity`]).
    pub fn tangential_stiffness(given: Option<f64>, complementarity: f64) -> f64 {
        given.unwrap_or(STIFFNESS * complementarity)
    }

    /// [`Friction::new`] with the [`Friction::tangential_stiffness`], and all that follows from the stiffness of the bodies. A stiffness that is given is the weight of slips against multipliers itself.
    ///
    /// # Errors
    /// The errors of [`Friction::new`].
    pub fn between_bodies(
        law: Arc<dyn FrictionLaw>,
        given: Option<f64>,
        stick: Stick,
        complementarity: f64,
    ) -> Result<Self, ContactError> {
        let friction = Self::new(law, Self::tangential_stiffness(given, complementarity), stick)?;
        Ok(if given.is_none() { friction.with_careful_weight(CAREFUL_WEIGHT * complementarity) } else { friction })
    }
}
