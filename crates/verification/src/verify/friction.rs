//! Friction: the impact of two blocks, how far parameters may go, and slides over many facets in a step.

use std::path::Path;

use toml::{Table, Value};

use super::check::{Bound, Check};
use super::{Bench, Findings, Run, Suite, quadratic};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Two blocks, extremes, fast slides.
pub struct FrictionSuite;

/// Coefficient of the block in `scenes/incline.toml`, and gravity.
const MU: f64 = 0.3;
const GRAVITY: f64 = 10.0;

const MOMENTUM: f64 = 1e-11;
const ENERGY: f64 = 1e-11;

impl Suite for FrictionSuite {
    fn name(&self) -> &'static str {
        "friction"
    }

    fn about(&self) -> &'static str {
        "The impact of two blocks, extreme parameters, a block that slides over many facets in a step."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        impacts(bench, &mut findings)?;
        reductions(bench, &mut findings)?;
        extremes(bench, &mut findings)?;
        fast(bench, &mut findings)?;
        Ok(findings)
    }
}

fn scene_of<'a>(scene: &'a mut Table, list: &str, index: usize) -> Outcome<&'a mut Table> {
    let item = scene.get_mut(list).and_then(Value::as_array_mut).and_then(|items| items.get_mut(index));
    item.and_then(Value::as_table_mut).ok_or_else(|| format!("the scene has no {list}[{index}]").into())
}

fn inline(text: &str) -> Outcome<Table> {
    Ok(text.parse()?)
}

/// A column of the probes from a time on, with its times.
fn probe(run: &Run, column: &str, from: f64) -> Outcome<(Vec<f64>, Vec<f64>)> {
    let table = run.table("probes.csv")?;
    let (time, value) = (table.column("time")?, table.column(column)?);
    Ok(time.iter().zip(value).filter(|(t, _)| **t >= from - 1e-9).map(|(t, v)| (*t, *v)).unzip())
}

/// Takes the block that sticks out of the scene of the incline, with all that names it.
fn only_the_slider(scene: &mut Table) {
    for list in ["body", "load", "contact", "probe"] {
        if let Some(items) = scene.get_mut(list).and_then(Value::as_array_mut) {
            items.retain(|item| !item.to_string().contains("sticker"));
        }
    }
}

/// The column `dissipation` never falls; what friction takes out of the bodies is stored or dissipated.
fn dissipation(run: &Run, findings: &mut Findings) -> Outcome<()> {
    let table = run.table("balance.csv")?;
    let column = table.column("dissipation")?;
    let scale = column.last().copied().unwrap_or(0.0).abs().max(f64::MIN_POSITIVE);
    let least = column.windows(2).map(|pair| (pair[1] - pair[0]) / scale).fold(f64::INFINITY, f64::min);
    // Round-off of springs; exact stick has none.
    let springs = run.summary()?["contacts"].to_string().contains("\"stick\":\"penalty\"");
    let bound = if springs { -1e-15 } else { 0.0 };
    findings.checks.push(Check::new(&run.name, "least dissipation of a step, relative", least, Bound::AtLeast(bound)));
    let sums = table.column("friction_stored")?.iter().zip(column).map(|(stored, dissipated)| stored + dissipated);
    let rest = table.column("friction_work")?.iter().zip(sums).map(|(work, sum)| (work - sum).abs() / scale);
    let quantity = "work of friction less stored and dissipated energy, relative";
    findings.checks.push(Check::new(&run.name, quantity, rest.fold(0.0, larger), Bound::AtMost(1e-10)));
    Ok(())
}

/// Momenta, energy gain; of a run without loads.
fn impact(run: &Run, findings: &mut Findings, conserves: bool) -> Outcome<()> {
    findings.checks.push(run.completed(0));
    if !run.succeeded() {
        return Ok(());
    }
    let balance = run.balance()?;
    let row =
        |quantity: &str, value: f64, bound: Bound| Check::new(&run.name, quantity, value, bound).noted(run.note());
    if conserves {
        findings.checks.extend(run.momentum_drifts(&balance, MOMENTUM));
        let gain = balance.energy_changes(None).into_iter().fold(0.0, larger);
        findings.checks.push(row("energy gain of a step", gain, Bound::AtMost(ENERGY)));
    }
    findings.checks.push(row("step cuts", run.summary_number("cuts")?, Bound::Unbounded));
    dissipation(run, findings)
}

fn impacts(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    for (scene, conserves) in
        [("two-blocks-friction", true), ("two-blocks-friction-midpoint", false), ("two-blocks-friction-euler", false)]
    {
        let run = bench.run_shipped(Path::new(&format!("scenes/{scene}.toml")))?;
        impact(&run, findings, conserves)?;
        if run.succeeded() {
            quadratic::rows(&run, findings)?;
            bench.show(&run, findings);
        }
    }
    Ok(())
}

/// The three forms of coordinate augmentation have one solution.
fn reductions(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    // Through the impact.
    let end = if bench.quick { 3.0 } else { 20.0 };
    let mut found: Vec<Vec<f64>> = Vec::new();
    for reduction in ["none", "first", "second"] {
        let mut scene = bench.scene("two-blocks-cat")?;
        scene.remove("expect");
        scene_of(&mut scene, "contact", 0)?.insert("reduction".into(), reduction.into());
        scene.get_mut("time").and_then(Value::as_table_mut).ok_or("no [time]")?.insert("end".into(), end.into());
        let run = bench.run_variant(&format!("two-blocks-cat-{reduction}"), &scene)?;
        findings.checks.push(run.completed(0));
        if !run.succeeded() {
            return Ok(());
        }
        quadratic::rows(&run, findings)?;
        let mut all = Vec::new();
        for frame in run.frames()? {
            let grid = crate::vtu::load(&frame)?;
            let field = grid.point_data.get("displacement").ok_or("no displacement in the frame")?;
            all.extend_from_slice(&field.values);
        }
        found.push(all);
    }
    let travelled = found[2].iter().fold(0.0_f64, |most, u| u.abs().max(most));
    for (other, name) in found.iter().zip(["none", "first"]) {
        // Another number of frames is no agreement.
        let same = other.len() == found[2].len();
        let difference = other.iter().zip(&found[2]).map(|(a, b)| (a - b).abs()).fold(0.0, larger) / travelled;
        let quantity = format!("reduction {name} against second, all displacements, by the largest");
        let measured = if same { difference } else { f64::NAN };
        findings.checks.push(Check::new("two-blocks-cat", quantity, measured, Bound::AtMost(1e-9)));
    }
    Ok(())
}

/// The impact with coefficients from 0 to 10 and tangential stiffnesses over six decades.
fn extremes(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let coefficients: &[f64] = if bench.quick { &[0.0, 10.0] } else { &[0.0, 0.1, 1.0, 10.0] };
    let stiffnesses: &[f64] = if bench.quick { &[1e2, 1e8] } else { &[1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8] };
    let cases = coefficients.iter().map(|&mu| (mu, 1e4)).chain(stiffnesses.iter().map(|&penalty| (0.5, penalty)));
    for (mu, penalty) in cases {
        let mut scene = bench.scene("two-blocks-friction")?;
        scene.remove("expect");
        let friction = inline(&format!("law = \"coulomb\"\nmu = {mu:?}\npenalty = {penalty:e}"))?;
        scene_of(&mut scene, "contact", 0)?.insert("friction".into(), Value::Table(friction));
        let run = bench.run_variant(&format!("two-blocks-mu-{mu}-penalty-{penalty:e}"), &scene)?;
        impact(&run, findings, true)?;
    }
    Ok(())
}

/// A block slides over 1, 10 and 100 facets in a step and loses `mu g t` of its speed.
fn fast(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    const STEP: f64 = 0.1;
    const EDGE: f64 = 0.1;
    const STEPS: f64 = 5.0;
    for facets in [1.0, 10.0, 100.0] {
        let speed = facets * EDGE / STEP;
        let mut scene = bench.scene("incline")?;
        scene.remove("expect");
        let time = format!("end = {}\nstep = {STEP}\nintegrator = {{ scheme = \"backward-euler\" }}", STEPS * STEP);
        scene.insert("time".into(), Value::Table(inline(&time)?));
        let length = 2.0 + speed * STEPS * STEP;
        let mesh = format!(
            "generator = \"block\"\nmin = [-1.0, -1.0, -1.0]\nmax = [{length:?}, 2.0, 0.0]\ndivisions = [{}, 3, 1]",
            ((length + 1.0) / EDGE).round() as u32
        );
        scene_of(&mut scene, "body", 0)?.insert("mesh".into(), Value::Table(inline(&mesh)?));
        scene_of(&mut scene, "body", 1)?.insert("velocity".into(), vec![speed, 0.0, 0.0].into());
        scene_of(&mut scene, "load", 0)?.insert("body_force".into(), vec![0.0, 0.0, -GRAVITY].into());
        only_the_slider(&mut scene);
        let run = bench.run_variant(&format!("slide-{facets}-facets"), &scene)?;
        findings.checks.push(run.completed(0));
        if !run.succeeded() {
            continue;
        }
        let (time, velocity) = probe(&run, "slider.x", STEP)?;
        let last = time.len().saturating_sub(1);
        // A block that has stopped lost what it had.
        let expected = (MU * GRAVITY * time[last]).min(speed);
        let lost = speed - velocity[last];
        let row =
            Check::new(&run.name, "lost speed, relative error", (lost / expected - 1.0).abs(), Bound::AtMost(1e-2));
        findings.checks.push(row);
        findings.checks.push(Check::new(&run.name, "step cuts", run.summary_number("cuts")?, Bound::Unbounded));
    }
    Ok(())
}
