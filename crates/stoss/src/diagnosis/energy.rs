//! Energy that the scheme adds to the bodies.

use super::case::DiagnosedRun;
use super::{Cause, Confidence, LikelyCause, Remedy, Where, toml};
use crate::terms::Terms;
use stoss_integrators::{ForceRule, Scheme};
use stoss_watch::{FindingKind, Severity};

/// The scheme that conserves energy.
const CONSERVING: &str = "{ scheme = \"energy-momentum\" }";

/// Whether a scheme takes all forces at the end of the step and carries nothing over from the step before: it loses energy.
fn is_dissipative(scheme: &dyn Scheme) -> bool {
    let rule = scheme.rule(1.0);
    rule.force.rule == ForceRule::END_POINT && rule.history.is_none() && rule.acceleration.is_none()
}

/// Number of terms that are named.
const MOST_TERMS: usize = 3;

/// Which bodies, parts and couplings made the energy that is too much, or lost what is missing: their remainders since the process began.
fn by_terms(case: &DiagnosedRun<'_>) -> Option<String> {
    let names: Vec<String> = case.scene.bodies.iter().map(|body| body.name.clone()).collect();
    let terms = Terms::new(&names, false, case.simulation);
    let books = case.simulation.books();
    let mut remainders: Vec<(&str, f64)> =
        terms.of(books).map(|(name, posting)| (name, posting.remainder)).filter(|(_, rest)| *rest != 0.0).collect();
    remainders.sort_by(|a, b| a.1.total_cmp(&b.1));
    remainders.retain(|(_, rest)| *rest < 0.0);
    remainders.truncate(MOST_TERMS);
    let list: Vec<String> = remainders.iter().map(|(name, rest)| format!("`{name}` {:.2e}", -rest)).collect();
    (!list.is_empty())
        .then(|| format!("energy made since the run was started or resumed, by term (terms.csv): {}", list.join(", ")))
}

/// A gain of energy that the watch found, with a scheme that does not exclude it.
pub(super) fn scheme_gains(case: &DiagnosedRun<'_>) -> Vec<LikelyCause> {
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
    vec![LikelyCause {
        cause: Cause::SchemeGainsEnergy,
        confidence: if gain.level == Severity::Wrong { Confidence::High } else { Confidence::Medium },
        place: Where {
            text: format!("`{name}`; the gain was judged at step {} (t = {})", gain.step, toml::plain(gain.time)),
            ..Where::default()
        },
        sentence,
        evidence: std::iter::once(gain.sentence.clone()).chain(by_terms(case)).collect(),
        remedies,
    }]
}
