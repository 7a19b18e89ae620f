//! A block flies obliquely onto another one: the coefficient of friction, either side as the slave.

use toml::{Table, Value};

use super::super::check::{Bound, Check};
use super::super::{Bench, Findings};
use super::{ITERATIONS, entry};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Coefficients of friction.
const COEFFICIENTS: [f64; 3] = [0.0, 0.2, 0.8];
/// Drift of the momenta, over the momentum and over the moment of momentum of the flying block.
const MOMENTUM: f64 = 1e-12;
/// Largest rise of the energy in a step.
const ENERGY: f64 = 1e-12;

/// The energy changes by what closings and friction take, and by nothing else.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let shipped = bench.scene("block-impact-mortar")?;
    let surfaces = [("upper.bottom", "lower.top"), ("lower.top", "upper.bottom")];
    for mu in COEFFICIENTS {
        for (slave, master) in surfaces {
            // Quick: one run without friction, one with.
            let skipped = mu == 0.2 || (mu == 0.0) == (slave == "upper.bottom");
            if bench.quick && skipped {
                continue;
            }
            let side = slave.split('.').next().unwrap_or(slave);
            let run = bench.run_variant(&format!("oblique-{mu}-{side}"), &variant(&shipped, mu, slave, master)?)?;
            findings.checks.push(run.completed(0));
            if !run.succeeded() {
                continue;
            }
            let balance = run.balance()?;
            let row = |quantity: &str, value: f64, bound: Bound| {
                Check::new(&run.name, quantity, value, bound).noted(run.note())
            };
            findings.checks.push(row("step cuts", run.summary_number("cuts")?, Bound::AtMost(0.0)));
            let iterations = run.summary_number("mean_iterations")?;
            findings.checks.push(row("iterations a step", iterations, Bound::AtMost(ITERATIONS)));
            findings.checks.extend(run.momentum_drifts(&balance, MOMENTUM));
            let changes = balance.energy_changes(None);
            let rise = changes.iter().copied().fold(0.0, larger);
            let lost = -changes.iter().sum::<f64>();
            findings.checks.push(row("largest rise of the energy in a step", rise, Bound::AtMost(ENERGY)));
            findings.checks.push(row("energy taken by friction and by closings", lost, Bound::AtLeast(0.0)));
            findings.checks.push(run.coverage()?);
        }
    }
    Ok(())
}

fn variant(shipped: &Table, mu: f64, slave: &str, master: &str) -> Outcome<Table> {
    let mut scene = shipped.clone();
    scene.remove("expect");
    let contact = entry(&mut scene, "contact", 0)?;
    contact.insert("slave".into(), slave.into());
    contact.insert("master".into(), master.into());
    if mu == 0.0 {
        contact.remove("friction");
    } else {
        let friction = contact.get_mut("friction").and_then(Value::as_table_mut);
        friction.ok_or("block-impact-mortar has no friction")?.insert("mu".into(), mu.into());
    }
    Ok(scene)
}
