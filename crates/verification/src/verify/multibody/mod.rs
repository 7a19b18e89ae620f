//! Rigid bodies, joints, beams and strings: closed forms, momenta and energy, order, cost, extremes.

mod beams;
mod build;
mod chain;
mod collisions;
mod driven;
mod joints;
mod obstacle;
pub(super) mod pulley;
mod rigid;
mod rows;
mod scene;
mod stiff;
mod strings;
mod tools;
mod trebuchet;
mod wheel;
mod work;

use super::check::{Bound, Check};
use super::{Bench, Findings, Suite};
use crate::workspace::Outcome;

/// Tops, impacts that count the digits of pi, cradles and dominoes, pendulums, a mechanism, chains, beams, a string, extremes, work and precision, trebuchet, rigid tools, bolt, moments, driven reference points.
pub struct Multibody;

/// Drift of momenta over their size, in a step or of a run as the row says.
const MOMENTUM: f64 = 1e-11;
/// Drift of the energy over its size.
const ENERGY: f64 = 1e-10;
/// Least order that counts as two.
const ORDER: f64 = 1.9;

impl Suite for Multibody {
    fn name(&self) -> &'static str {
        "multibody"
    }

    fn about(&self) -> &'static str {
        "Flexible multibody systems against closed forms and equations in minimal coordinates; momenta and energy, order, cost, extremes, a trebuchet, rigid tools, bolts, reference points."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        let cases: [(&str, fn(&Bench, &mut Findings) -> Outcome<()>); 15] = [
            ("rigid bodies", |bench, found| rigid::measure(bench.quick, found)),
            ("impacts that count", |bench, found| collisions::measure(bench.quick, found)),
            ("rows of impacts", |bench, found| rows::measure(bench.quick, found)),
            ("joints", |_, found| joints::measure(found)),
            ("chain", |bench, found| chain::measure(bench.quick, found)),
            ("beams", |bench, found| beams::measure(bench.quick, found)),
            ("strings", |bench, found| strings::measure(bench.quick, found)),
            ("pulley", |bench, found| pulley::measure(bench.quick, found)),
            ("stiff", |bench, found| stiff::measure(bench.quick, found)),
            ("work and precision", |bench, found| work::measure(bench.quick, found)),
            ("trebuchet", trebuchet::measure),
            ("rigid tools", tools::measure),
            ("rigid wheel", wheel::measure),
            ("obstacle", obstacle::measure),
            ("driven", driven::measure),
        ];
        for (name, measure) in cases {
            let start = cpu_time::ProcessTime::now();
            // A group that cannot be measured falls short; the others still run.
            if let Err(error) = measure(bench, &mut findings) {
                let failed = Check::new(name, "could be measured", f64::NAN, Bound::AtLeast(1.0));
                findings.checks.push(failed.noted(error.to_string()));
            }
            let seconds = start.elapsed().as_secs_f64();
            findings.checks.push(Check::new(name, "CPU seconds of these cases", seconds, Bound::Unbounded));
        }
        Ok(findings)
    }
}

/// Adds a row.
fn check(findings: &mut Findings, case: &str, quantity: impl Into<String>, measured: f64, bound: Bound) {
    findings.checks.push(Check::new(case, quantity, measured, bound));
}

/// Adds a row with a note.
fn noted(findings: &mut Findings, case: &str, quantity: &str, measured: f64, bound: Bound, note: impl Into<String>) {
    findings.checks.push(Check::new(case, quantity, measured, bound).noted(note));
}
