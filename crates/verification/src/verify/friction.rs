//! Friction: laws and their stepping, blocks on a plate with closed forms, the impact of two blocks, and how far parameters may go.

mod elements;

use std::path::Path;
use std::sync::Arc;

use stoss_contact::friction::{Friction as Rough, FrictionPoint, LAWS, Stick};
use toml::{Table, Value};

use super::check::{Bound, Check};
use super::states::Random;
use super::{Bench, Findings, Run, Suite, quadratic};
use crate::verify::numbers::larger;
use crate::workspace::Outcome;

/// Laws, contact elements, incline, stopping block, two blocks, extremes.
pub struct Friction;

/// Coefficient and slope of the blocks in `scenes/incline.toml`, and gravity.
const MU: f64 = 0.3;
const TANGENT: f64 = 0.303;
const GRAVITY: f64 = 10.0;
/// When the vibrations of the landing are gone.
const SETTLED: f64 = 1.0;

const ACCELERATION: f64 = 1e-3;
const CREEP: f64 = 1e-12;
const DISTANCE: f64 = 5e-3;
const MOMENTUM: f64 = 1e-11;
const ENERGY: f64 = 1e-11;

impl Suite for Friction {
    fn name(&self) -> &'static str {
        "friction"
    }

    fn about(&self) -> &'static str {
        "Laws of friction on random paths, contact elements in random steps, blocks that stick, slide and stop on a plate, the impact of two blocks, extreme parameters."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        laws(&mut findings)?;
        elements::rows(&mut findings.checks)?;
        incline(bench, &mut findings)?;
        sticking(bench, &mut findings)?;
        stopping(bench, &mut findings)?;
        impacts(bench, &mut findings)?;
        reductions(bench, &mut findings)?;
        extremes(bench, &mut findings)?;
        fast(bench, &mut findings)?;
        Ok(findings)
    }
}

/// Derivatives of the force against differences, and the least dissipation of random paths.
fn laws(findings: &mut Findings) -> Outcome<()> {
    for entry in LAWS {
        let law = entry.law.of_examples()?;
        let rough = Rough::new(Arc::clone(&law), 40.0, Stick::Penalty)?;
        let mut random = Random(7);
        let (mut least, mut worst, mut rest) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        for _ in 0..200 {
            let mut history = [0.0; 2];
            for _ in 0..20 {
                let slip = [random.between(-0.1, 0.1), random.between(-0.1, 0.1)];
                let pressure = random.between(-0.5, 5.0);
                let (step_size, yielded) = (0.05, [0.0; 2]);
                let point = FrictionPoint { history, slip, pressure, step_size, slid: 0.0, stiffening: 1.0, yielded };
                let step = rough.step(&point);
                let before = rough.stored(history);
                let scale = (before + step.stored + step.work.abs()).max(f64::MIN_POSITIVE);
                least = least.min(step.dissipated / scale);
                rest = larger(rest, (step.work + before - step.stored - step.dissipated).abs());
                worst = larger(worst, slope_error(&rough, &point));
                history = step.force;
            }
        }
        let scene = law.name();
        let quantity = "least dissipation of a step, by its energies";
        findings.checks.push(Check::new(scene, quantity, least, Bound::AtLeast(-1e-15)));
        let quantity = "work less stored and dissipated energy";
        findings.checks.push(Check::new(scene, quantity, rest, Bound::AtMost(1e-13)));
        findings.checks.push(Check::new(scene, "d force / d slip, relative error", worst, Bound::AtMost(1e-7)));
    }
    Ok(())
}

/// Error of the derivative with respect to the slip, relative to the stiffness; zero next to a kink.
fn slope_error(rough: &Rough, point: &FrictionPoint) -> f64 {
    const H: f64 = 1e-6;
    let exact = rough.step(point);
    let mut worst = 0.0_f64;
    for j in 0..2 {
        let at = |h: f64| {
            let mut moved = *point;
            moved.slip[j] += h;
            rough.step(&moved)
        };
        let (far, near) = ([at(-2.0 * H), at(2.0 * H)], [at(-H), at(H)]);
        if far[0].sticks != far[1].sticks {
            continue;
        }
        for i in 0..2 {
            // Of fourth order: a slip that has just begun turns its direction quickly.
            let difference = |pair: &[stoss_contact::friction::FrictionStep; 2]| pair[1].force[i] - pair[0].force[i];
            let slope = (8.0 * difference(&near) - difference(&far)) / (12.0 * H);
            worst = larger(worst, (slope - exact.d_slip[i][j]).abs() / rough.penalty());
        }
    }
    worst
}

fn scene_of<'a>(scene: &'a mut Table, list: &str, index: usize) -> Outcome<&'a mut Table> {
    let item = scene.get_mut(list).and_then(Value::as_array_mut).and_then(|items| items.get_mut(index));
    item.and_then(Value::as_table_mut).ok_or_else(|| format!("the scene has no {list}[{index}]").into())
}

fn inline(text: &str) -> Outcome<Table> {
    Ok(text.parse()?)
}

/// A column of the probes from `SETTLED` on, with its times.
fn probe(run: &Run, column: &str, from: f64) -> Outcome<(Vec<f64>, Vec<f64>)> {
    let table = run.table("probes.csv")?;
    let (time, value) = (table.column("time")?, table.column(column)?);
    Ok(time.iter().zip(value).filter(|(t, _)| **t >= from - 1e-9).map(|(t, v)| (*t, *v)).unzip())
}

/// One block sticks exactly, one slides with the analytic acceleration.
fn incline(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    // The whole scene in quick mode too: it takes seconds.
    let run = bench.run_variant("incline-whole", &bench.scene("incline")?)?;
    findings.checks.push(run.completed(0));
    if !run.succeeded() {
        return Ok(());
    }
    let (time, speed) = probe(&run, "slider.x", SETTLED)?;
    let last = time.len().saturating_sub(1);
    let found = (speed[last] - speed[0]) / (time[last] - time[0]);
    let expected = GRAVITY * (TANGENT - MU) / (1.0 + TANGENT * TANGENT).sqrt();
    let row =
        |quantity: &str, measured: f64, bound: f64| Check::new(&run.name, quantity, measured, Bound::AtMost(bound));
    let error = (found / expected - 1.0).abs();
    findings
        .checks
        .push(row("acceleration above the friction angle, relative error", error, ACCELERATION).noted(run.note()));
    let (_, place) = probe(&run, "sticker.x", SETTLED)?;
    let creep = place.iter().map(|x| (x - place[0]).abs()).fold(0.0, larger);
    findings.checks.push(row("creep below the friction angle, by the length", creep, CREEP));
    quadratic::rows(&run, findings)
}

/// The block that sticks, alone, with the schemes that keep all vibrations: its weight grows for one unit of time.
fn sticking(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    const STEPS: u32 = 1000;
    const STEP: f64 = 0.05;
    let tangent = 0.99 * MU;
    let weight = GRAVITY / (1.0 + tangent * tangent).sqrt();
    for scheme in ["energy-momentum", "midpoint"] {
        let mut scene = bench.scene("incline")?;
        scene.remove("expect");
        let end = SETTLED + STEP * f64::from(STEPS);
        let time = format!("end = {end:?}\nstep = {STEP}\nintegrator = {{ scheme = \"{scheme}\" }}");
        scene.insert("time".into(), Value::Table(inline(&time)?));
        only_the_slider(&mut scene);
        let force = format!("body_force = {{ table = [[0, 0, 0, 0], [1, {}, 0, {}]] }}", weight * tangent, -weight);
        let load = scene_of(&mut scene, "load", 0)?;
        load.extend(inline(&force)?);
        scene_of(&mut scene, "probe", 0)?.insert("quantity".into(), "displacement".into());
        let run = bench.run_variant(&format!("sticking-{scheme}"), &scene)?;
        findings.checks.push(run.completed(0));
        if !run.succeeded() {
            continue;
        }
        let (time, place) = probe(&run, "slider.x", SETTLED)?;
        let range = place.iter().fold(f64::NEG_INFINITY, |most, x| most.max(*x))
            - place.iter().fold(f64::INFINITY, |least, x| least.min(*x));
        let quantity = "range of the places below the friction angle, by the length";
        let row = Check::new(&run.name, quantity, range, Bound::AtMost(1e-6));
        let note =
            format!("{} steps; the block vibrates, and nodes with little pressure slide a little with it", time.len());
        findings.checks.push(row.noted(note));
    }
    Ok(())
}

/// The block of the incline on a level plate, with a speed: `v^2 / (2 mu g)`, then rest.
fn stopping(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    // Backward Euler is of first order.
    let springs = "law = \"coulomb\"\nmu = 0.3\npenalty = 1e6";
    for (scheme, quick, friction) in
        [("backward-euler", 0.001, None), ("energy-momentum", 0.002, None), ("energy-momentum", 0.002, Some(springs))]
    {
        let step = if bench.quick { quick } else { 0.001 };
        let mut scene = bench.scene("incline")?;
        scene.remove("expect");
        scene.insert(
            "time".into(),
            Value::Table(inline(&format!("end = 0.5\nstep = {step}\nintegrator = {{ scheme = \"{scheme}\" }}"))?),
        );
        scene_of(&mut scene, "body", 1)?.insert("velocity".into(), vec![1.0, 0.0, 0.0].into());
        scene_of(&mut scene, "load", 0)?.insert("body_force".into(), vec![0.0, 0.0, -GRAVITY].into());
        scene_of(&mut scene, "probe", 0)?.insert("quantity".into(), "displacement".into());
        only_the_slider(&mut scene);
        let mut name = format!("stopping-{scheme}");
        if let Some(friction) = friction {
            name = format!("{name}-springs");
            scene_of(&mut scene, "contact", 0)?.insert("friction".into(), Value::Table(inline(friction)?));
        }
        let run = bench.run_variant(&name, &scene)?;
        findings.checks.push(run.completed(0));
        if !run.succeeded() {
            continue;
        }
        let expected = 1.0 / (2.0 * MU * GRAVITY);
        let (_, place) = probe(&run, "slider.x", 0.4)?;
        let end = place.last().copied().unwrap_or(f64::NAN);
        let row = |quantity: &str, value: f64, bound: f64| Check::new(&run.name, quantity, value, Bound::AtMost(bound));
        let error = (end / expected - 1.0).abs();
        findings.checks.push(row("stopping distance, relative error", error, DISTANCE));
        let moved = place.iter().map(|x| (x - end).abs()).fold(0.0, larger) / expected;
        findings.checks.push(row("motion after the stop, by the distance", moved, 1e-3));
        dissipation(&run, findings)?;
        quadratic::rows(&run, findings)?;
    }
    Ok(())
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
