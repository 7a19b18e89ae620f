//! What the schemes promise to conserve, measured on free flights and impacts (theory/integrators#kept).

use std::path::Path;

use super::check::{Bound, Check};
use super::{Bench, Findings, Run, Suite, models, newton};
use crate::workspace::Outcome;

/// Free flight with every law, and the impact of the ball on the plate.
pub struct Conservation;

/// Free flights with the energy-momentum scheme, one for each law.
const FLIGHTS: [&str; 4] = ["flight", "flight-svk", "flight-mooney-rivlin", "flight-ogden"];

const FLIGHT_ENERGY: f64 = 1e-10;
const FLIGHT_MOMENTUM: f64 = 1e-11;
const IMPACT_MOMENTUM: f64 = 1e-10;
const IMPACT_ENERGY_MODIFIED: f64 = 1e-9;
const IMPACT_ENERGY_BETWEEN: f64 = 1e-10;

/// Least relative change of the energy that counts as visible.
const VISIBLE: f64 = 1e-4;

/// A quadratic rate shows an order near 2; the last residual is spoilt by round-off now and then, hence the median.
const QUADRATIC: f64 = 1.7;

/// Most iterations a step on average.
const ITERATIONS: f64 = 6.0;

impl Suite for Conservation {
    fn name(&self) -> &'static str {
        "conservation"
    }

    fn about(&self) -> &'static str {
        "Momenta and energy of free flights and of the ball on the plate, relative to the largest value of the run."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        models::measure(&mut findings)?;
        let flight = Bounds { energy: FLIGHT_ENERGY, momentum: FLIGHT_MOMENTUM };
        let impact = Bounds { energy: IMPACT_ENERGY_MODIFIED, momentum: IMPACT_MOMENTUM };
        for scene in FLIGHTS {
            conserves(bench, &mut findings, scene, Promise::Throughout, flight)?;
        }
        conserves(bench, &mut findings, "flight-midpoint", Promise::None, flight)?;
        for (scene, promise) in [
            ("ball-plate", Promise::BetweenClosings),
            ("ball-plate-modified", Promise::Throughout),
            ("ball-plate-midpoint", Promise::None),
        ] {
            conserves(bench, &mut findings, scene, promise, impact)?;
        }
        general(bench, &mut findings, impact)?;
        Ok(findings)
    }
}

/// What a scheme says of the energy.
#[derive(Clone, Copy, PartialEq)]
enum Promise {
    /// The energy is conserved but in steps in which a node closes.
    BetweenClosings,
    /// The energy is always conserved.
    Throughout,
    /// The energy is not conserved.
    None,
}

/// Largest drifts of a scene.
#[derive(Clone, Copy)]
struct Bounds {
    energy: f64,
    momentum: f64,
}

/// Momenta always, energy as promised, Newton's rate, no cut.
fn conserves(bench: &Bench, findings: &mut Findings, scene: &str, promise: Promise, bounds: Bounds) -> Outcome<()> {
    let run = bench.run_shipped(Path::new(&format!("scenes/{scene}.toml")))?;
    findings.checks.push(run.completed(0));
    if !run.succeeded() {
        return Ok(());
    }
    momenta(findings, &run, bounds.momentum)?;
    energy(findings, &run, promise, bounds.energy)?;
    let steps = run.newton()?;
    let triples = newton::triples(&steps);
    let order = newton::median_order(&triples);
    let row = |quantity: &str, measured: f64, bound: Bound| Check::new(scene, quantity, measured, bound);
    findings.checks.push(
        row("order of the last residuals", order, Bound::AtLeast(QUADRATIC))
            .noted(format!("median of {}", triples.len())),
    );
    findings.checks.push(row("iterations a step", newton::mean_iterations(&steps), Bound::AtMost(ITERATIONS)));
    findings.checks.push(row("step cuts", run.summary_number("cuts")?, Bound::AtMost(0.0)));
    bench.show(&run, findings);
    Ok(())
}

/// General contact: momenta, and the energy with what friction took. Steps are cut where corners slip off each other.
fn general(bench: &Bench, findings: &mut Findings, bounds: Bounds) -> Outcome<()> {
    let run = bench.run_shipped(Path::new("scenes/general-contact.toml"))?;
    findings.checks.push(run.completed(0));
    if !run.succeeded() {
        return Ok(());
    }
    momenta(findings, &run, bounds.momentum)?;
    energy(findings, &run, Promise::Throughout, bounds.energy)?;
    bench.show(&run, findings);
    Ok(())
}

fn momenta(findings: &mut Findings, run: &Run, bound: f64) -> Outcome<()> {
    findings.checks.extend(run.momentum_drifts(&run.balance()?, bound));
    Ok(())
}

fn energy(findings: &mut Findings, run: &Run, promise: Promise, bound: f64) -> Outcome<()> {
    let balance = run.balance()?;
    let row = |quantity: &str, measured: f64, bound: Bound| Check::new(&run.name, quantity, measured, bound);
    match promise {
        Promise::Throughout => {
            findings.checks.push(row("energy drift", balance.energy_drift(None), Bound::AtMost(bound)));
        }
        Promise::None => findings.checks.push(row("energy drift", balance.energy_drift(None), Bound::AtLeast(VISIBLE))),
        Promise::BetweenClosings => {
            let closings = run.closings(&balance)?;
            let count = closings.iter().filter(|closing| **closing).count();
            let between = balance.energy_drift_between(&closings);
            findings.checks.push(
                row("energy drift between closings", between, Bound::AtMost(IMPACT_ENERGY_BETWEEN))
                    .noted(format!("{} steps without a closing", closings.len() - count - 1)),
            );
            findings.checks.push(row("steps with a closing", count as f64, Bound::AtLeast(1.0)));
            let change = balance.largest_change(&closings, true, None);
            findings.checks.push(row("largest energy change in a closing", change, Bound::Unbounded));
        }
    }
    Ok(())
}
