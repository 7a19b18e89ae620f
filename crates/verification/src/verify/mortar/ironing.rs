//! A stiff block pressed into a soft slab and drawn along it, without and with friction: coverage, effort, smooth forces.

use std::path::Path;

use toml::{Table, Value};

use super::super::check::{Bound, Check, number};
use super::super::report::{Grid, ReportSection};
use super::super::{Bench, Findings, Run, newton};
use super::{ITERATIONS, entry, resistance};
use crate::gallery::{Interface, Sides};
use crate::plot::{self, Labels, Series};
use crate::verify::numbers::larger;
use crate::vtu::{self, Grid as Frame};
use crate::workspace::Outcome;

/// Speed of the indenter, length of the slab, and of the shipped slab's facets.
const SPEED: f64 = 0.15;
const LENGTH: f64 = 9.0;
const FACET: f64 = 0.45;
/// The pressing ends at 1; then the force needs some way until it is that of steady sliding.
const STEADY: f64 = 3.0;
/// Time from which on all points slip with friction.
const SLIDING: f64 = 8.0;
/// Largest oscillation in steady sliding, on all meshes with the shipped stiffness of the contact, and with ten times that where four facets of the slab and more lie below the
/// indenter.
const SMOOTH: f64 = 0.02;
/// Part of the ratio of facets' lengths on two meshes that the ratio of their oscillations is at most: with a stiff contact, too, the oscillation is an error
/// of the mesh.
const FALL: f64 = 0.9;
/// Difference of the force at the end of a straight way down and after sliding there, relative: nothing depends on the way.
const SAME: f64 = 1e-8;
/// Place at which they are compared, and when the shipped scene is there.
const PLACE: [f64; 2] = [0.96, 7.4];
/// Largest residual over the square of the one before. Linear convergence by the factor 0.1 would give 1e4 where residuals are 1e-5.
const QUADRATIC: f64 = 20.0;
/// Residuals for which that is checked; those below this many times the smallest of the step are round-off.
const ASYMPTOTIC: f64 = 0.1;
const ROUND_OFF: f64 = 20.0;
const COEFFICIENT: f64 = 0.5;

/// The shipped scenes, other meshes of the slab, deeper indentations.
pub fn measure(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    smooth(bench, findings)?;
    frictional(bench, findings)?;
    quadratic(bench, findings)
}

/// Ironing without friction: depth 0.7 on several meshes, depth 0.9.
fn smooth(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let run = bench.run_shipped(Path::new("scenes/ironing-mortar.toml"))?;
    let mut lines = Vec::new();
    let mut rows = Vec::new();
    let shipped = ironing(&run, findings, FACET, Bound::AtMost(SMOOTH))?;
    if run.succeeded() {
        bench.show(&run, findings);
    }
    keep(&mut lines, &mut rows, "slab of 20 x 5 x 3", shipped);
    let scene = bench.scene("ironing-mortar")?;
    if !bench.quick {
        independence(bench, findings, &scene, &run)?;
        let run = bench.run_variant("ironing-mortar-plain", &plain(&scene)?)?;
        let found = ironing(&run, findings, FACET, Bound::Unbounded)?;
        keep(&mut lines, &mut rows, "slab of 20 x 5 x 3, not smoothed", found);
        // The indenter is as long as two, three and four facets: both of its rims pass an edge at the same time. Two facets are passed.
        let mut coarser: Option<(f64, f64)> = None;
        for (n, slab, bound) in [
            (2.0, [18, 8, 4], Bound::Unbounded),
            (3.0, [27, 12, 6], Bound::Unbounded),
            (4.0, [36, 16, 8], Bound::AtMost(SMOOTH)),
        ] {
            let facet = LENGTH / slab[0] as f64;
            let end = STEADY + (20.0 * facet / SPEED).ceil() / 10.0;
            let scene = variant(&scene, end, None, Some(slab))?;
            let name = format!("slab of {} x {} x {}", slab[0], slab[1], slab[2]);
            let run = bench.run_variant(&format!("ironing-mortar-{}", slab[0]), &scene)?;
            let found = ironing(&run, findings, facet, Bound::AtMost(SMOOTH))?;
            keep(&mut lines, &mut rows, &name, found);
            let run = bench.run_variant(&format!("ironing-mortar-plain-{}", slab[0]), &plain(&scene)?)?;
            let found = ironing(&run, findings, facet, bound)?;
            let size = found.as_ref().and_then(|found| found.2);
            if let (Some((m, coarse)), Some(fine)) = (coarser, size) {
                let quantity = "oscillation of Fz over that of the coarser slab, by the ratio of the facets";
                let check = Check::new(&run.name, quantity, fine / coarse * n / m, Bound::AtMost(FALL));
                findings.checks.push(check.noted(format!(
                    "{n} facets below the indenter; {} and {}",
                    number(coarse),
                    number(fine)
                )));
            }
            coarser = size.map(|size| (n, size));
            keep(&mut lines, &mut rows, &format!("{name}, not smoothed"), found);
        }
        // Twice the shipped divisions, half of the way: eight of its facets.
        let run = bench.run_variant("ironing-mortar-fine", &variant(&scene, 10.0, None, Some([40, 10, 6]))?)?;
        let found = ironing(&run, findings, 0.5 * FACET, Bound::AtMost(SMOOTH))?;
        keep(&mut lines, &mut rows, "slab of 40 x 10 x 6", found);
    }
    let end = if bench.quick { 2.0 } else { 20.0 };
    let deep = variant(&scene, end, Some(0.9), None)?;
    let run = bench.run_variant("ironing-mortar-deeper", &deep)?;
    let found = ironing(&run, findings, FACET, Bound::AtMost(SMOOTH))?;
    keep(&mut lines, &mut rows, "20 x 5 x 3, depth 0.9", found);
    findings.sections.push(section("Ironing without friction", &lines, rows));
    Ok(())
}

/// Ironing with friction: depth 0.4 to the end on two slabs, and 0.7 with the slab as the slave.
fn frictional(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let (mut lines, mut rows) = (Vec::new(), Vec::new());
    for (name, slab, facet) in [
        ("ironing-mortar-friction", "27 x 12 x 6", LENGTH / 27.0),
        ("ironing-mortar-friction-thesis", "20 x 5 x 3", FACET),
    ] {
        let run = bench.run_shipped(Path::new(&format!("scenes/{name}.toml")))?;
        let found = ironing(&run, findings, facet, Bound::AtMost(SMOOTH))?;
        if run.succeeded() {
            bench.show(&run, findings);
            judge_resistance(&run, findings)?;
        }
        keep(&mut lines, &mut rows, &format!("depth 0.4, indenter is slave, slab of {slab}"), found);
    }
    let scene = plain(&bench.scene("ironing-mortar-friction")?)?;
    let mut scene = variant(&scene, 20.0, Some(0.7), Some([20, 5, 3]))?;
    if bench.quick {
        scene = variant(&scene, 3.0, Some(0.7), None)?;
    }
    let contact = entry(&mut scene, "contact", 0)?;
    contact.insert("slave".into(), "slab.top".into());
    contact.insert("master".into(), "indenter.bottom".into());
    let run = bench.run_variant("ironing-mortar-friction-deep", &scene)?;
    let found = ironing(&run, findings, FACET, Bound::Unbounded)?;
    if run.succeeded() {
        judge_resistance(&run, findings)?;
    }
    keep(&mut lines, &mut rows, "depth 0.7, slab is slave, not smoothed", found);
    findings.sections.push(section("Ironing with friction", &lines, rows));
    Ok(())
}

/// Force along the slab over that on it: no more than the coefficient of friction, but for what the slope of the surface adds.
fn judge_resistance(run: &Run, findings: &mut Findings) -> Outcome<()> {
    let steady = resistance(run, SLIDING)?;
    if steady.is_empty() {
        return Ok(());
    }
    let mean = steady.iter().sum::<f64>() / steady.len() as f64;
    let bound = Bound::Near { value: COEFFICIENT, tolerance: 0.1 * COEFFICIENT };
    let note = format!("mean from t = {SLIDING}; {}", run.note());
    findings.checks.push(Check::new(&run.name, "Fx over Fz while sliding", mean, bound).noted(note));
    Ok(())
}

/// A straight way down at another place gives the force that sliding there gave: it is a function of the place.
fn independence(bench: &Bench, findings: &mut Findings, scene: &Table, slid: &Run) -> Outcome<()> {
    let [place, time] = PLACE;
    let mut scene = variant(scene, 1.0, None, None)?;
    entry(&mut scene, "body", 0)?.insert("position".into(), vec![place, 0.0, 0.0].into());
    let straight = bench.run_variant("ironing-mortar-straight", &scene)?;
    findings.checks.push(straight.completed(0));
    if !(slid.succeeded() && straight.succeeded()) {
        return Ok(());
    }
    let force = |run: &Run, at: f64| -> Outcome<f64> {
        let probes = run.table("probes.csv")?;
        let row = probes.column("time")?.iter().position(|t| (t - at).abs() < 1e-9).ok_or("no such time")?;
        Ok(probes.column("indenter.z")?[row])
    };
    let (a, b) = (force(slid, time)?, force(&straight, 1.0)?);
    let quantity = "Fz after sliding over that after a straight way down, less 1";
    findings.checks.push(Check::new(&slid.name, quantity, (a / b - 1.0).abs(), Bound::AtMost(SAME)));
    Ok(())
}

/// The first facets with and without friction, Newton's method led to round-off: order, residuals of typical steps.
fn quadratic(bench: &Bench, findings: &mut Findings) -> Outcome<()> {
    let mut tables = Vec::new();
    for (name, shipped, smoothed) in [
        ("frictionless", "ironing-mortar", true),
        ("frictionless, not smoothed", "ironing-mortar", false),
        ("with friction", "ironing-mortar-friction", true),
    ] {
        let mut scene = variant(&bench.scene(shipped)?, 3.0, None, Some([20, 5, 3]))?;
        if !smoothed {
            scene = plain(&scene)?;
        }
        // Stick by springs: the residual is that of the forces, and the rows of multipliers are not among them.
        if let Some(friction) = entry(&mut scene, "contact", 0)?.get_mut("friction").and_then(Value::as_table_mut) {
            friction.insert("penalty".into(), 10.0.into());
        }
        let solver: Table = "relative_tolerance = 1e-13\nfactors = \"new\"".parse()?;
        scene.insert("solver".into(), Value::Table(solver));
        let run = bench.run_variant(&format!("{shipped}{}-order", if smoothed { "" } else { "-plain" }), &scene)?;
        findings.checks.push(run.completed(0));
        if !run.succeeded() {
            continue;
        }
        let steps = run.newton()?;
        let found = squares(&steps);
        let worst = found.iter().copied().reduce(larger).unwrap_or(f64::NAN);
        let note = format!("largest of {} pairs below {ASYMPTOTIC}, relative tolerance 1e-13", found.len());
        let quantity = "quasi-static: residual over the square of the one before";
        findings.checks.push(Check::new(&run.name, quantity, worst, Bound::AtMost(QUADRATIC)).noted(note));
        let shown = steps.iter().filter(|step| step.residuals.len() > 3).step_by(4);
        let line = |step: &newton::StepResiduals| {
            let residuals: Vec<String> = step.residuals.iter().map(|r| format!("{r:.1e}")).collect();
            vec![number(step.step), number(step.active), residuals.join("  ")]
        };
        tables.push(Grid {
            caption: format!("Residuals since the active set changed last, {name}"),
            head: ["step", "active", "residuals"].map(str::to_owned).to_vec(),
            rows: shown.map(line).collect(),
        });
    }
    findings.sections.push(ReportSection { title: "Ironing: Newton's method".into(),
            reading: "Each row has the residuals of one step from the last change of the active set on. Right if the exponent doubles from one to the next, down to round-off.".into(), figures: Vec::new(), tables });
    Ok(())
}

/// Residuals over the squares of those before, from the first solution with the last active set on and above round-off.
fn squares(steps: &[newton::StepResiduals]) -> Vec<f64> {
    let mut found = Vec::new();
    for step in steps.iter().filter(|step| step.residuals.len() > 2) {
        let floor = ROUND_OFF * step.residuals.iter().copied().fold(f64::INFINITY, f64::min);
        let pairs = step.residuals[1..].windows(2).filter(|pair| pair[0] <= ASYMPTOTIC && pair[1] > floor);
        found.extend(pairs.map(|pair| pair[1] / (pair[0] * pair[0])));
    }
    found
}

/// Forces over time and the table of runs.
fn section(title: &str, lines: &[(String, [Series; 2])], rows: Vec<Vec<String>>) -> ReportSection {
    let pick = |component: usize| -> Vec<Series> {
        let named = |(name, forces): &(String, [Series; 2])| Series { name: name.clone(), ..forces[component].clone() };
        lines.iter().map(named).collect()
    };
    let chart = |title: &str, component: usize| plot::linear(Labels { title, x: "time", y: "" }, &pick(component));
    let head = ["run", "steps", "iterations a step", "cuts", "mean of Fz", "oscillation of Fz", "what it is"];
    ReportSection {
        title: title.into(),
            reading: "A block is pressed onto a slab and drawn along it (theory/examples). An exact method on fine meshes gives a vertical force that stays constant while the block slides; what oscillates with the passing facets is the error of the discretisation.".into(),
        figures: vec![chart("vertical force on the indenter's top", 1), chart("force along the slab", 0)],
        tables: vec![Grid {
            caption: "Oscillation: largest distance of Fz from its mean over the length of a slab's facet around, by that mean, \
                      while the indenter slides"
                .into(),
            head: head.map(str::to_owned).to_vec(),
            rows,
        }],
    }
}

/// What is shown of a run, and its oscillation.
type Found = Option<(Vec<String>, [Series; 2], Option<f64>)>;

fn keep(lines: &mut Vec<(String, [Series; 2])>, rows: &mut Vec<Vec<String>>, name: &str, found: Found) {
    if let Some((row, series, _)) = found {
        rows.push(std::iter::once(name.to_owned()).chain(row).collect());
        lines.push((name.to_owned(), series));
    }
}

/// The scene with a contact ten times as stiff.
fn plain(scene: &Table) -> Outcome<Table> {
    let mut scene = scene.clone();
    let stiff: Table = "penalty = 400.0".parse()?;
    entry(&mut scene, "contact", 0)?.insert("enforcement".into(), Value::Table(stiff));
    Ok(scene)
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
fn ironing(run: &Run, findings: &mut Findings, facet: f64, smooth: Bound) -> Outcome<Found> {
    findings.checks.push(run.completed(0));
    if !run.succeeded() {
        return Ok(None);
    }
    let row =
        |quantity: &str, value: f64, bound: Bound| Check::new(&run.name, quantity, value, bound).noted(run.note());
    let steps = run.newton()?;
    let (count, cuts, mean) =
        (run.summary_number("steps")?, run.summary_number("cuts")?, newton::mean_iterations(&steps));
    findings.checks.push(row("steps", count, Bound::Unbounded));
    findings.checks.push(row("step cuts", cuts, Bound::Unbounded));
    findings.checks.push(row("iterations a step", mean, Bound::AtMost(ITERATIONS)));
    let triples = newton::triples(&steps);
    findings.checks.push(
        row("order of the last residuals", newton::median_order(&triples), Bound::Unbounded)
            .noted(format!("median of {}", triples.len())),
    );
    findings.checks.push(run.coverage()?);
    let mut faults = 0;
    let mut uncovered = 0.0_f64;
    let frames = run.frames()?;
    for file in &frames {
        let (count, part) = coverage(&vtu::load(file)?)?;
        faults += count;
        uncovered = larger(uncovered, part);
    }
    let note = format!("{} frames, whole master searched", frames.len());
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
    let report = Interface::new(frame, Sides::Stacked)?.coverage()?;
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
        worst = larger(worst, (window[SAMPLES / 2] / mean - 1.0).abs());
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
    fn linear_convergence_is_not_quadratic() {
        let step = |residuals: &[f64]| newton::StepResiduals {
            step: 1.0,
            active: 0.0,
            iterations: 0,
            residuals: residuals.to_vec(),
        };
        let quadratic = squares(&[step(&[1.0, 1e-2, 1e-4, 1e-8, 1e-15]), step(&[1.0, 1e-3, 2e-6, 1e-15])]);
        assert_eq!(quadratic.len(), 3);
        assert!(quadratic.iter().all(|c| *c < 2.1), "{quadratic:?}");
        let linear = squares(&[step(&[1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7])]);
        assert!(linear.iter().any(|c| *c > QUADRATIC), "{linear:?}");
        assert!(squares(&[step(&[1.0, 1e-15])]).is_empty());
    }

    #[test]
    fn variants_change_what_they_are_told() {
        let scene: Table = include_str!("../../../../../scenes/ironing-mortar.toml").parse().unwrap();
        let changed = variant(&scene, 2.0, Some(0.9), Some([40, 10, 6])).unwrap();
        assert_eq!(changed["time"]["end"].as_float(), Some(2.0));
        assert_eq!(changed["prescribe"][1]["displacement"]["table"][2][3].as_float(), Some(-0.9));
        assert_eq!(changed["body"][1]["mesh"]["divisions"][0].as_integer(), Some(40));
        assert_eq!(changed["body"][0], scene["body"][0]);
    }
}
