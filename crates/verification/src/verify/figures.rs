//! Figures and tables that several suites show of a run.

use super::check::number;
use super::newton::{self, StepResiduals};
use super::report::{Grid, ReportSection};
use super::run::Run;
use crate::gallery;
use crate::plot::{self, Labels, Series};
use crate::workspace::Outcome;

/// Drifts below this are drawn on the axis.
const FLOOR: f64 = 1e-17;

/// Number of triples shown of a run.
const TRIPLES: usize = 6;

/// Drifts, energies, forces, Newton residuals of one run; snapshots and segments if the scene is in the table of pictures, else the last frame.
/// `reading` is what the scene says of itself.
pub fn section(run: &Run, reading: String) -> Outcome<ReportSection> {
    let balance = run.balance()?;
    let time = &balance.time;
    let [linear, angular, energy] = balance.histories();
    let drifts = [
        Series::new("linear momentum", time, linear),
        Series::new("angular momentum", time, angular),
        Series::new("energy", time, energy),
    ];
    let labels = Labels { title: "drift over the largest value of the run", x: "time", y: "" };
    let mut figures = vec![plot::logarithmic(labels, &drifts, FLOOR)];
    figures.extend(components("linear momentum", time, &balance.linear));
    figures.extend(components("angular momentum", time, &balance.angular));
    let table = run.table("balance.csv")?;
    let mut parts = Vec::new();
    for name in ["kinetic", "strain", "potential", "contact", "dissipation", "external_work", "total"] {
        let column = table.column(name)?;
        if name == "total" || column.iter().any(|value| *value != 0.0) {
            parts.push(Series::new(name, time, column.iter().copied()));
        }
    }
    figures.push(plot::linear(Labels { title: "energies", x: "time", y: "" }, &parts));
    figures.extend(forces(run)?);
    let picture = gallery::of(&run.name);
    match picture {
        Some(picture) => {
            for field in picture.fields {
                figures.push(gallery::snapshots(picture, field, &run.folder)?);
            }
            figures.extend(gallery::interfaces(picture, &run.folder)?);
        }
        None => figures.push(gallery::last_frame(&run.last_frame()?)?),
    }
    let thesis = picture.map(|picture| picture.thesis).filter(|numbers| !numbers.is_empty());
    let thesis = thesis.map(|numbers| format!(", figures {numbers} of the thesis")).unwrap_or_default();
    let title = format!("{}{thesis}{}", run.name, if run.until.is_some() { " (shortened)" } else { "" });
    Ok(ReportSection { title, reading, figures, tables: vec![triples(&run.newton()?)] })
}

/// The three components of a momentum over time; nothing if it is zero throughout, as in statics.
fn components(title: &str, time: &[f64], values: &[[f64; 3]]) -> Option<String> {
    let line = |(i, name)| Series::new(name, time, values.iter().map(|value| value[i]));
    let moves = values.iter().flatten().any(|value| *value != 0.0);
    let series: Vec<Series> = ["x", "y", "z"].into_iter().enumerate().map(line).collect();
    moves.then(|| plot::linear(Labels { title, x: "time", y: "" }, &series))
}

/// Forces over time: of the contact on all slave nodes, if there is contact, and the reaction that the scene's picture names.
fn forces(run: &Run) -> Outcome<Vec<String>> {
    let mut charts = Vec::new();
    let mut chart = |title: &str, file: &str, prefix: &str| -> Outcome<()> {
        let table = run.table(file)?;
        let time = table.column("time")?;
        let mut parts = Vec::new();
        for axis in ["x", "y", "z"] {
            let column = table.column(&format!("{prefix}{axis}"))?;
            parts.push((axis, column, column.iter().fold(0.0_f64, |most, force| most.max(force.abs()))));
        }
        let largest = parts.iter().fold(0.0_f64, |most, part| most.max(part.2));
        // A component that is round-off is no line.
        let drawn = parts.iter().filter(|part| part.2 > 1e-9 * largest);
        let series: Vec<Series> =
            drawn.map(|(axis, column, _)| Series::new(axis, time, column.iter().copied())).collect();
        if !series.is_empty() {
            charts.push(plot::linear(Labels { title, x: "time", y: "" }, &series));
        }
        Ok(())
    };
    if run.folder.join("contact.csv").is_file() {
        chart("contact force on the slave", "contact.csv", "contact_force_")?;
    }
    if let Some(probe) = gallery::of(&run.name).and_then(|picture| picture.reaction) {
        chart(&format!("reaction at {probe}"), "probes.csv", &format!("{probe}."))?;
    }
    Ok(charts)
}

/// Three consecutive residuals of typical steps.
fn triples(steps: &[StepResiduals]) -> Grid {
    let chosen = newton::typical(&newton::triples(steps), TRIPLES);
    let rows = chosen.iter().map(|triple| {
        let [r0, r1, r2] = triple.residuals.map(|residual| format!("{residual:.3e}"));
        vec![number(triple.step), number(triple.active), r0, r1, r2, format!("{:.2}", triple.order())]
    });
    let head = ["step", "active", "residual", "next", "next", "order"];
    let caption =
        format!("Newton: {:.2} iterations a step; the last residuals of some steps", newton::mean_iterations(steps));
    Grid { caption, head: head.map(str::to_owned).to_vec(), rows: rows.collect() }
}
