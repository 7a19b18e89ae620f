//! What the mortar method promises beyond the patch test: an oblique impact, ironing, a rotating indenter, Hertz, ties.

mod cantilever;
mod deep;
mod hertz;
mod ironing;
mod oblique;
mod rotating;

use toml::{Table, Value};

use super::{Bench, Findings, Run, Suite};
use crate::workspace::Outcome;

/// Oblique impact, ironing, deep ironing in few steps, rotating indenter, Hertz, tied cantilever.
pub struct Mortar;

const ITERATIONS: f64 = 6.0;

impl Suite for Mortar {
    fn name(&self) -> &'static str {
        "mortar"
    }

    fn about(&self) -> &'static str {
        "Oblique impact with friction, ironing, deep ironing in few steps, a rotating indenter, Hertz, order of a tied cantilever."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        oblique::measure(bench, &mut findings)?;
        cantilever::measure(bench, &mut findings)?;
        ironing::measure(bench, &mut findings)?;
        deep::measure(bench, &mut findings)?;
        rotating::measure(bench, &mut findings)?;
        hertz::measure(bench, &mut findings)?;
        Ok(findings)
    }
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
