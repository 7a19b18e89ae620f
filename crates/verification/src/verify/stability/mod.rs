//! Where every scheme stays bounded, and what becomes of extreme scenes.

mod extremes;
mod springs;

use super::{Bench, Findings, Suite};
use crate::workspace::Outcome;

/// Map of the schemes on springs, and extreme scenes.
pub struct Stability;

impl Suite for Stability {
    fn name(&self) -> &'static str {
        "stability"
    }

    fn about(&self) -> &'static str {
        "Verdicts over step size and stiffness on the spring pendulum, and scenes at the edge of what can be computed."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = springs::measure(bench)?;
        let extremes = extremes::measure(bench)?;
        findings.checks.extend(extremes.checks);
        findings.sections.extend(extremes.sections);
        Ok(findings)
    }
}
