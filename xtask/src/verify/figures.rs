//! Figures and tables that several suites show of a run.

use super::check::number;
use super::newton::{self, Step};
use super::report::{Grid, Section};
use super::run::Run;
use crate::gallery;
use crate::plot::{self, Labels, Series};
use crate::workspace::Outcome;

/// Drifts below this are drawn on the axis.
const FLOOR: f64 = 1e-17;

/// Number of triples shown of a run.
const TRIPLES: usize = 6;

/// Drifts, energy, Newton residuals and the last frame of one run.
pub fn section(run: &Run) -> Outcome<Section> {
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
    let table = run.table("balance.csv")?;
    let mut parts = Vec::new();
    for name in ["kinetic", "strain", "potential", "contact", "dissipation", "external_work", "total"] {
        let column = table.column(name)?;
        if name == "total" || column.iter().any(|value| *value != 0.0) {
            parts.push(Series::new(name, time, column.iter().copied()));
        }
    }
    figures.push(plot::linear(Labels { title: "energies", x: "time", y: "" }, &parts));
    figures.push(gallery::last_frame(&run.last_frame()?)?);
    let title = format!("{} {}", run.name, if run.until.is_some() { "(shortened)" } else { "" });
    Ok(Section { title, figures, tables: vec![triples(&run.newton()?)] })
}

/// Three consecutive residuals of typical steps.
fn triples(steps: &[Step]) -> Grid {
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
