//! Where every scheme stays bounded, what becomes of extreme scenes, and maps of the methods.

mod extremes;
mod maps;
mod springs;

use super::{Bench, Findings, Suite};
use crate::workspace::Outcome;

/// Map of the schemes on springs, extreme scenes, maps of the methods.
pub struct Stability;

impl Suite for Stability {
    fn name(&self) -> &'static str {
        "stability"
    }

    fn about(&self) -> &'static str {
        "Verdicts over step size and stiffness on the spring pendulum, scenes at the edge of what can be computed, and maps of methods over the axes along which they may fail."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = springs::measure(bench)?;
        for further in [maps::measure(bench)?, extremes::measure(bench)?] {
            findings.checks.extend(further.checks);
            findings.sections.extend(further.sections);
        }
        Ok(findings)
    }
}
