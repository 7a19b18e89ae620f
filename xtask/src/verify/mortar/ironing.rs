//! A stiff block pressed into a soft slab and drawn along it without friction: coverage, effort, smooth forces.

use std::path::Path;

use toml::{Table, Value};

use super::super::check::{Bound, Check, number};
use super::super::report::{Grid, Section};
use super::super::{Bench, Findings, Run, newton};
use super::ITERATIONS;
use crate::gallery::Interface;
use crate::plot::{self, Labels, Series};
use crate::vtu::{self, Grid as Frame};
use crate::workspace::Outcome;

/// Speed of the indenter, and length of the shipped slab's facets.
const SPEED: f64 = 0.15;
const FACET: f64 = 0.45;
/// The pressing ends at 1; then the force needs some way until it is that of steady sliding.
const STEADY: f64 = 3.0;
/// Largest oscillation in steady sliding, on the finer slab; the shipped one has two facets below the indenter.
const SMOOTH: f64 = 0.02;
/// The oscillation is an error of the mesh, at least of first order: a slab with twice the elements has this part of it.
const FALL: f64 = 0.6;

/// The shipped scene, a finer slab, a deeper indentation.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let run = bench.run_shipped(Path::new("scenes/ironing-mortar.toml"))?;
    let mut lines = Vec::new();
    let mut rows = Vec::new();
    let shipped = ironing(&run, findings, FACET, Must::Complete, Bound::Told)?;
    if run.succeeded() {
        bench.show(&run, findings)?;
    }
    let coarse = shipped.as_ref().and_then(|found| found.2);
    keep(&mut lines, &mut rows, "slab of 20 x 5 x 3", shipped);
    let scene = bench.scene("ironing-mortar")?;
    if !bench.quick {
        // Half of the way: eight of its facets.
        let fine = variant(&scene, 10.0, None, Some([40, 10, 6]))?;
        let run = bench.run_variant("ironing-mortar-fine", &fine)?;
        let found = ironing(&run, findings, 0.5 * FACET, Must::Complete, Bound::AtMost(SMOOTH))?;
        if let Some((coarse, fine)) = coarse.zip(found.as_ref().and_then(|found| found.2)) {
            let name = "oscillation of Fz, finer over coarser slab";
            findings.checks.push(Check::new("ironing-mortar", name, fine / coarse, Bound::AtMost(FALL)));
        }
        keep(&mut lines, &mut rows, "slab of 40 x 10 x 6", found);
    }
    let end = if bench.quick { 2.0 } else { 20.0 };
    let deep = variant(&scene, end, Some(0.9), None)?;
    let run = bench.run_variant("ironing-mortar-deep", &deep)?;
    let found = ironing(&run, findings, FACET, Must::Try, Bound::Told)?;
    keep(&mut lines, &mut rows, "20 x 5 x 3, depth 0.9", found);
    let pick = |component: usize| -> Vec<Series> {
        lines
            .iter()
            .map(|(name, [x, z]): &(String, [Series; 2])| Series { name: name.clone(), ..[x, z][component].clone() })
            .collect()
    };
    let chart = |title: &str, component: usize| plot::linear(Labels { title, x: "time", y: "" }, &pick(component));
    let head = ["run", "steps", "iterations a step", "cuts", "mean of Fz", "oscillation of Fz", "what it is"];
    findings.sections.push(Section {
        title: "Ironing without friction".into(),
        figures: vec![chart("vertical force on the indenter's top", 1), chart("force along the slab", 0)],
        tables: vec![Grid {
            caption: "Oscillation: largest distance of Fz from its mean over the length of a slab's facet around, by that mean, \
                      while the indenter slides"
                .into(),
            head: head.map(str::to_owned).to_vec(),
            rows,
        }],
    });
    Ok(())
}

/// Whether a run has to come to its end.
#[derive(Clone, Copy, PartialEq)]
enum Must {
    Complete,
    Try,
}

/// What is shown of a run, and its oscillation.
type Found = Option<(Vec<String>, [Series; 2], Option<f64>)>;

fn keep(lines: &mut Vec<(String, [Series; 2])>, rows: &mut Vec<Vec<String>>, name: &str, found: Found) {
    if let Some((row, series, _)) = found {
        rows.push(std::iter::once(name.to_owned()).chain(row).collect());
        lines.push((name.to_owned(), series));
    }
}

/// The scene until `end`, with another depth or another mesh of the slab.
fn variant(scene: &Table, end: f64, depth: Option<f64>, slab: Option<[i64; 3]>) -> Outcome<Table> {
    let mut scene = scene.clone();
    scene.remove("expect");
    let mut set = |list: &str, key: &str, inner: &str, value: Value| -> Outcome<()> {
        let table = match scene.get_mut(list) {
            Some(Value::Array(items)) => items.get_mut(1).and_then(|item| item.get_mut(key)),
            other => other,
        };
        let table =
            table.and_then(Value::as_table_mut).ok_or_else(|| format!("{list} is not as the suite knows it"))?;
        table.insert(inner.to_owned(), value);
        Ok(())
    };
    set("time", "", "end", end.into())?;
    if let Some(depth) = depth {
        let table = format!("t = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, -{depth:?}], [20.0, 2.85, 0.0, -{depth:?}]]");
        let table: Table = table.parse()?;
        set("prescribe", "displacement", "table", table["t"].clone())?;
    }
    if let Some(divisions) = slab {
        set("body", "mesh", "divisions", divisions.to_vec().into())?;
    }
    Ok(scene)
}

/// Rows of a run; a line of the table and the forces along and down.
fn ironing(run: &Run, findings: &mut Findings, facet: f64, must: Must, smooth: Bound) -> Outcome<Found> {
    let completed = run.completed(0);
    if !run.succeeded() && must == Must::Try {
        // How far it came is told; the error is named in the log.
        let reached = run.balance().map_or(0.0, |b| b.time.last().copied().unwrap_or(0.0));
        let note = format!("the run ends with exit code {:?}; {}", run.ending.code, completed.note);
        findings.checks.push(Check::new(&run.name, "time reached", reached, Bound::Told).noted(note));
        return Ok(None);
    }
    findings.checks.push(completed);
    if !run.succeeded() {
        return Ok(None);
    }
    let row =
        |quantity: &str, value: f64, bound: Bound| Check::new(&run.name, quantity, value, bound).noted(run.note());
    let steps = run.newton()?;
    let (count, cuts, mean) =
        (run.summary_number("steps")?, run.summary_number("cuts")?, newton::mean_iterations(&steps));
    findings.checks.push(row("steps", count, Bound::Told));
    findings.checks.push(row("step cuts", cuts, Bound::Told));
    findings.checks.push(row("iterations a step", mean, Bound::AtMost(ITERATIONS)));
    let triples = newton::triples(&steps);
    findings.checks.push(
        row("order of the last residuals", newton::median_order(&triples), Bound::Told)
            .noted(format!("median of {}", triples.len())),
    );
    let mut faults = 0;
    let mut uncovered = 0.0_f64;
    let frames = run.frames()?;
    for file in &frames {
        let (count, part) = coverage(&vtu::load(file)?)?;
        faults += count;
        uncovered = uncovered.max(part);
    }
    let note =
        format!("{} frames, whole master searched; the program checks every step and would have failed", frames.len());
    findings
        .checks
        .push(row("slave facets not covered as the master lies", faults as f64, Bound::AtMost(0.0)).noted(note));
    findings.checks.push(row("largest part of the slave uncovered", uncovered, Bound::AtMost(1e-12)));
    let probes = run.table("probes.csv")?;
    let time = probes.column("time")?;
    let [along, down] = [probes.column("indenter.x")?, probes.column("indenter.z")?];
    let found = oscillation(time, down, facet / SPEED, STEADY);
    let mut cells = vec![number(count), number(mean), number(cuts)];
    match found {
        Some((mean, size)) => {
            let note = format!("from t = {STEADY}, mean over {} around; {}", number(facet / SPEED), run.note());
            findings.checks.push(row("oscillation of Fz, by its mean", size, smooth).noted(note));
            cells.extend([
                number(mean),
                number(size),
                format!("slab's facets of {facet} pass below the indenter's rim"),
            ]);
        }
        None => cells.extend(["-".to_owned(), "-".to_owned(), "the run is too short".to_owned()]),
    }
    let series = [along, down].map(|force| Series::new("", time, force.iter().copied()));
    Ok(Some((cells, series, found.map(|(_, size)| size))))
}

/// Number of slave facets whose segments do not tile their overlap, and the part of the slave's area that has no segments.
fn coverage(frame: &Frame) -> Outcome<(usize, f64)> {
    let report = Interface::new(frame)?.coverage()?;
    Ok((report.faults.len(), (1.0 - report.covered / report.area).abs()))
}

/// Mean of `force` from `from` on, and its largest distance from the mean over `period` around, by that. Nothing if there
/// is no such time.
fn oscillation(time: &[f64], force: &[f64], period: f64, from: f64) -> Option<(f64, f64)> {
    /// Samples of a period.
    const SAMPLES: usize = 60;
    let end = *time.last()?;
    let step = period / SAMPLES as f64;
    let count = ((end - from) / step + 1e-9).floor();
    if count.is_nan() || count < SAMPLES as f64 + 1.0 {
        return None;
    }
    let at = |t: f64| {
        let k = time.partition_point(|x| *x < t).clamp(1, time.len() - 1);
        let part = (t - time[k - 1]) / (time[k] - time[k - 1]);
        force[k - 1] + part * (force[k] - force[k - 1])
    };
    let sampled: Vec<f64> = (0..=count as usize).map(|k| at(from + k as f64 * step)).collect();
    let mut worst = 0.0_f64;
    for window in sampled.windows(SAMPLES + 1) {
        // Trapezoids: the ends count half.
        let sum = window.iter().sum::<f64>() - 0.5 * (window[0] + window[SAMPLES]);
        let mean = sum / SAMPLES as f64;
        worst = worst.max((window[SAMPLES / 2] / mean - 1.0).abs());
    }
    Some((sampled.iter().sum::<f64>() / sampled.len() as f64, worst))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trend_is_no_oscillation_and_a_sine_is() {
        let time: Vec<f64> = (0..=200).map(|k| 0.1 * f64::from(k)).collect();
        let trend: Vec<f64> = time.iter().map(|t| 10.0 + 0.1 * t).collect();
        let (mean, size) = oscillation(&time, &trend, 3.0, 5.0).unwrap();
        assert!((mean - 11.25).abs() < 1e-9 && size < 1e-12, "{mean} {size}");
        let sine: Vec<f64> = time.iter().map(|t| 10.0 + 0.5 * (2.0 * std::f64::consts::PI * t / 3.0).sin()).collect();
        let (mean, size) = oscillation(&time, &sine, 3.0, 5.0).unwrap();
        assert!((mean - 10.0).abs() < 0.05 && (size - 0.05).abs() < 1e-3, "{mean} {size}");
        assert!(oscillation(&time, &sine, 3.0, 18.0).is_none());
    }

    #[test]
    fn variants_change_what_they_are_told() {
        let scene: Table = include_str!("../../../../scenes/ironing-mortar.toml").parse().unwrap();
        let changed = variant(&scene, 2.0, Some(0.9), Some([40, 10, 6])).unwrap();
        assert_eq!(changed["time"]["end"].as_float(), Some(2.0));
        assert_eq!(changed["prescribe"][1]["displacement"]["table"][2][3].as_float(), Some(-0.9));
        assert_eq!(changed["body"][1]["mesh"]["divisions"][0].as_integer(), Some(40));
        assert_eq!(changed["body"][0], scene["body"][0]);
    }
}
