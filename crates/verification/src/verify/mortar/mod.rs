//! What the mortar method promises beyond the patch test: impacts, ironing, a rotating indenter, Hertz, ties.

mod cantilever;
mod deep;
mod hertz;
mod ironing;
mod oblique;
mod rotating;

use std::path::Path;

use toml::{Table, Value};

use super::check::{Bound, Check};
use super::{Bench, Findings, Run, Suite};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Impact, oblique impact, ironing, deep ironing in few steps, rotating indenter, Hertz, tied cantilever.
pub struct Mortar;

const MOMENTUM: f64 = 1e-11;
const ENERGY: f64 = 1e-10;
const ITERATIONS: f64 = 6.0;

impl Suite for Mortar {
    fn name(&self) -> &'static str {
        "mortar"
    }

    fn about(&self) -> &'static str {
        "Impact of two blocks, oblique impact with friction, ironing, deep ironing in few steps, a rotating indenter, Hertz, order of a tied cantilever."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        impact(bench, &mut findings)?;
        oblique::measure(bench, &mut findings)?;
        cantilever::measure(bench, &mut findings)?;
        ironing::measure(bench, &mut findings)?;
        deep::measure(bench, &mut findings)?;
        rotating::measure(bench, &mut findings)?;
        hertz::measure(bench, &mut findings)?;
        Ok(findings)
    }
}

/// Momenta always, energy in free flight before and after.
fn impact(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let run = bench.run_shipped(Path::new("scenes/two-blocks-mortar.toml"))?;
    findings.checks.push(run.completed(0));
    if !run.succeeded() {
        return Ok(());
    }
    let balance = run.balance()?;
    let row =
        |quantity: &str, value: f64, bound: Bound| Check::new(&run.name, quantity, value, bound).noted(run.note());
    findings.checks.extend(run.momentum_drifts(&balance, MOMENTUM));
    let contact = run.table("contact.csv")?;
    let active: Vec<f64> = contact
        .column("step")?
        .iter()
        .zip(contact.column("active")?)
        .filter(|(_, a)| **a > 0.0)
        .map(|(s, _)| *s)
        .collect();
    let (Some(first), Some(last)) = (active.first(), active.last()) else {
        return Err("the blocks of two-blocks-mortar do not meet".into());
    };
    let energies = |inside: &dyn Fn(f64) -> bool| -> Vec<f64> {
        balance.step.iter().zip(&balance.total).filter(|(s, _)| inside(**s)).map(|(_, e)| *e).collect()
    };
    let before = energies(&|step| step < *first);
    // The step that opens the last node still has its force.
    let after = energies(&|step| step >= *last);
    findings.checks.push(row("energy drift before the impact", spread(&before), Bound::AtMost(ENERGY)));
    if run.until.is_none() {
        findings.checks.push(row("energy drift after the impact", spread(&after), Bound::AtMost(ENERGY)));
        let change = after.last().zip(before.first()).map_or(f64::NAN, |(end, start)| end / start - 1.0);
        findings.checks.push(row("energy change over the impact", change, Bound::Unbounded));
    }
    findings.checks.push(row("step cuts", run.summary_number("cuts")?, Bound::Unbounded));
    findings.checks.push(run.coverage()?);
    bench.show(&run, findings);
    Ok(())
}

/// Largest distance from the first value, relative.
fn spread(values: &[f64]) -> f64 {
    let Some(first) = values.first() else { return f64::NAN };
    values.iter().map(|value| (value / first - 1.0).abs()).fold(0.0, larger)
}

/// An entry of a list of the scene, as `body` and `contact` are.
fn entry<'a>(scene: &'a mut Table, list: &str, index: usize) -> Outcome<&'a mut Table> {
    let item = scene.get_mut(list).and_then(Value::as_array_mut).and_then(|items| items.get_mut(index));
    Ok(item.and_then(Value::as_table_mut).ok_or_else(|| format!("{list}[{index}] is not as the suite knows it"))?)
}

/// Force along the slab over that on it in steps of an ironing run from a time on.
fn resistance(run: &Run, from: f64) -> Outcome<Vec<f64>> {
    let probes = run.table("probes.csv")?;
    let [time, along, down] = ["time", "indenter.x", "indenter.z"].map(|name| probes.column(name));
    let (time, along, down) = (time?, along?, down?);
    let steady = (0..time.len()).filter(|&k| time[k] >= from - 1e-9);
    Ok(steady.map(|k| (along[k] / down[k]).abs()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_is_relative_to_the_start() {
        assert_eq!(spread(&[4.0, 5.0, 3.0, 4.0]), 0.25);
        assert!(spread(&[]).is_nan());
    }
}
