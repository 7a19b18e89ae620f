//! Energy that the scheme adds to the bodies.

use super::case::Case;
use super::{Cause, Confidence, Finding, Remedy, Where, toml};
use stoss_integrators::{ForceRule, Scheme};
use stoss_watch::{FindingKind, Severity};

/// The scheme that conserves energy.
const CONSERVING: &str = "{ scheme = \"energy-momentum\" }";

/// Whether a scheme takes all forces at the end of the step and carries nothing over from the step before: it loses energy.
fn is_dissipative(scheme: &dyn Scheme) -> bool {
    let rule = scheme.rule(1.0);
    rule.force.rule == ForceRule::END_POINT && rule.history.is_none() && rule.acceleration.is_none()
}

/// A gain of energy that the watch found, with a scheme that does not exclude it.
pub(super) fn scheme_gains(case: &Case<'_>) -> Vec<Finding> {
    let Some(gain) = case.verdict.reasons.iter().find(|found| found.kind == FindingKind::EnergyGain) else {
        return Vec::new();
    };
    let Some((key, integrator)) = case.integrator() else { return Vec::new() };
    let Ok(scheme) = integrator.make() else { return Vec::new() };
    if scheme.claims().energy || is_dissipative(&*scheme) {
        return Vec::new();
    }
    let name = &integrator.scheme;
    let by_impacts = scheme.rule(1.0).gains_energy_in_impacts() && case.model().has_unilateral_contact();
    let sentence = match by_impacts {
        true => format!(
            "the scheme `{name}` adds energy in impacts: it keeps the acceleration of the step before, which in an impact is that of the contact force"
        ),
        false => format!(
            "the scheme `{name}` does not conserve energy, and adds some where a step does not resolve vibrations or turns by more than a few degrees"
        ),
    };
    let mut remedies = vec![Remedy::set(key, CONSERVING, "energy is then conserved at every step size")];
    let half = toml::number(toml::down(0.5 * case.step_size()));
    remedies.push(match by_impacts {
        true => Remedy::words(
            "or `{ scheme = \"backward-euler\" }`, which loses energy; a smaller step does not reduce the gain",
        ),
        false => {
            let smaller = Remedy::set(case.step_key(), half, "half the present value: the gain falls with the step");
            Remedy { text: format!("or {}", smaller.text), ..smaller }
        }
    });
    vec![Finding {
        cause: Cause::SchemeGainsEnergy,
        confidence: if gain.level == Severity::Wrong { Confidence::High } else { Confidence::Medium },
        place: Where {
            text: format!("`{name}`; the gain was judged at step {} (t = {})", gain.step, toml::plain(gain.time)),
            ..Where::default()
        },
        sentence,
        evidence: vec![gain.sentence.clone()],
        remedies,
    }]
}
