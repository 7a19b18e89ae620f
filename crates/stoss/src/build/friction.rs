//! Friction of a contact: the laws of the catalogue, and which schemes have it.

use super::Problems;
use crate::scene::{self, Scene};
use std::sync::Arc;
use stoss_contact::ContactError;
use stoss_contact::friction::{Coulomb, Friction, FrictionLaw, MidpointFriction, Regularised, StaticDynamic, Stick};
use stoss_integrators::GradientRule;

fn law(item: &scene::Friction) -> Result<Arc<dyn FrictionLaw>, ContactError> {
    Ok(match item {
        scene::Friction::Coulomb(p) => Arc::new(Coulomb::new(p.mu)?),
        scene::Friction::StaticDynamic(p) => Arc::new(StaticDynamic::new(p.mu_static, p.mu_dynamic, p.speed)?),
        scene::Friction::Regularised(p) => Arc::new(Regularised::new(p.mu, p.speed)?),
    })
}

/// Name of the scene's scheme if it evaluates contact where there is neither friction nor coordinate augmentation (formulation §4, §5: statics,
/// end point, midpoint).
pub(super) fn scheme_elsewhere(scene: &Scene) -> Option<&str> {
    let integrator = scene.time.integrator.as_ref()?;
    // A scheme that cannot be made is reported where it is named.
    let rule = integrator.make().ok()?.rule(scene.time.step).constraint.rule;
    let fits = matches!(rule, GradientRule::EndPoint | GradientRule::Midpoint | GradientRule::DiscreteGradient);
    (!fits).then_some(integrator.scheme.as_str())
}

/// Tangential stiffness of friction in multiples of Young's modulus over an edge, if the scene gives none: as a spring, a sticking node moves by a tenth
/// of what the elements beside it yield, and Newton's method still gets over the kink between stick and slip. Multipliers are weighed against slips
/// with it.
pub(super) const DEFAULT_TANGENTIAL_STIFFNESS: f64 = 10.0;

/// The friction of `contact[c]`; reports what is wrong and returns `None` then. `stiffness`: tangential stiffness if none is given.
pub(super) fn friction(
    scene: &Scene,
    key: &str,
    item: &scene::Friction,
    stiffness: f64,
    problems: &mut Problems<'_>,
) -> Option<Friction> {
    let key = format!("{key}.friction");
    if let Some(scheme) = scheme_elsewhere(scene) {
        let message = format!("contact with friction is not available with the scheme `{scheme}`");
        problems.add(key, "", message, "use `energy-momentum`, `midpoint` or `backward-euler`, or remove the friction");
        return None;
    }
    let (penalty, stick, midpoint) = match item.sticking() {
        Some(s) => (s.penalty, s.stick(), s.midpoint),
        None => (None, scene::Stick::Penalty, scene::Sticking::DEFAULT_MIDPOINT),
    };
    let stick = match stick {
        scene::Stick::Penalty => Stick::Penalty,
        scene::Stick::Augmented => Stick::Augmented,
        scene::Stick::Multiplier => Stick::Multiplier,
    };
    let midpoint = match midpoint {
        scene::MidpointFriction::A => MidpointFriction::A,
        scene::MidpointFriction::B => MidpointFriction::B,
        scene::MidpointFriction::C => MidpointFriction::C,
    };
    let made = law(item).and_then(|law| Friction::new(law, penalty.unwrap_or(stiffness), stick, midpoint));
    made.map_err(|error| problems.add(key, "", error.to_string(), "correct the parameter")).ok()
}
