//! General contact: nothing named, nothing inside anything, energy and momenta to round-off.
//!
//! Every scene is held against the same promises, see [`judge`]; what else a case shows is in its own rows. The method is in theory/barrier.

mod closed_forms;
mod extremes;
mod features;
mod judge;
mod mesh;
mod parts;
mod patch;
mod random;
mod scene;

use super::check::{Bound, Check};
use super::{Bench, Findings, Suite};
use crate::workspace::Outcome;

/// Patch, impulse, Hertz, features, machines and crowds, extremes, random scenes.
pub struct General;

/// A group of cases.
type Group = fn(&Bench, &mut Findings) -> Outcome<()>;

impl Suite for General {
    fn name(&self) -> &'static str {
        "general"
    }

    fn about(&self) -> &'static str {
        "General contact: no intersection found by the watch, energy with losses and momenta to round-off; pressure, impulse and force against closed forms; extremes; random scenes."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        let groups: [(&str, Group); 6] = [
            ("patch", patch::measure),
            ("impulse and Hertz", closed_forms::measure),
            ("features", features::measure),
            ("parts", parts::measure),
            ("extremes", extremes::measure),
            ("random", random::measure),
        ];
        for (name, measure) in groups {
            let start = std::time::Instant::now();
            // A group that cannot be measured falls short; the others still run.
            if let Err(error) = measure(bench, &mut findings) {
                let failed = Check::new(name, "could be measured", f64::NAN, Bound::AtLeast(1.0));
                findings.checks.push(failed.noted(error.to_string()));
            }
            let seconds = start.elapsed().as_secs_f64();
            findings.checks.push(Check::new(name, "seconds of these cases", seconds, Bound::Unbounded));
            println!("verify: general: {name} in {seconds:.1} s");
        }
        Ok(findings)
    }
}
