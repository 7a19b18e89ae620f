//! The campaign: problems with references that are mostly no runs of the program, every method on each of them, and what is read from the results.
//!
//! In full mode all combinations are run, and `docs/verification/work-precision` is written: a CSV file a problem, diagrams and tables drawn from it. In quick mode the coarsest runs are repeated and compared
//! with the stored ones, and the pages must be those that the stored results give.

mod choice;
mod front;
mod lines;
mod order;
mod page;
mod peers;
mod problem;
mod quick;
mod record;
mod stored;

pub use choice::Choice;
pub use problem::{Claim, Problem, Reference, Values, no_files};

use std::time::Duration;

use crate::table::Table;
use crate::verify::check::{Bound, Check};
use crate::verify::curve::relative_distance;
use crate::verify::launch::launch_within;
use crate::verify::side_by_side::side_by_side;
use crate::verify::{Bench, Findings};
use crate::workspace::Outcome;
pub use lines::lines;
use record::{Figures, Record, Records};
use stored::Store;

/// Where scenes and results go, below the folder of `verify`.
const FOLDER: &str = "work-precision";

/// A run that takes longer is stopped and listed.
const LIMIT: Duration = Duration::from_secs(240);

/// An order is that of so many of the finest runs.
const FINEST: usize = 4;

/// Errors below so many times the reference's own say nothing of an order.
const ABOVE_REFERENCE: f64 = 3.0;

/// Runs what the mode asks for.
pub fn measure(bench: &Bench, problems: &[&Problem], findings: &mut Findings) -> Outcome<()> {
    let store = Store::new(&bench.workspace);
    let asked: Vec<&Problem> = problems.iter().copied().filter(|problem| bench.is_asked(problem.name)).collect();
    if !bench.quick {
        announce(&store, &asked);
    }
    for problem in asked {
        if bench.quick {
            quick::measure(bench, &store, problem, findings)?;
        } else {
            let records = run_all(bench, &store, problem)?;
            store.write_records(problem, &records)?;
            claims(problem, &records, findings);
        }
    }
    if bench.quick { quick::pages(&store, problems, findings) } else { page::write_all(&store, problems) }
}

/// Says how long it takes, by what the stored runs took.
fn announce(store: &Store, asked: &[&Problem]) {
    let runs: usize = asked.iter().map(|problem| lines::combinations(&lines(problem)).len()).sum();
    let stored = asked.iter().filter_map(|problem| store.records(problem).ok());
    let seconds: f64 =
        stored.map(|records| front::finished(&records).map(|(_, figures)| figures.cpu_seconds).sum::<f64>()).sum();
    println!(
        "verify: work-precision: {runs} runs, {:.0} CPU minutes by the stored ones, {} at a time",
        seconds / 60.0,
        threads()
    );
}

/// How many runs go side by side. Their CPU times are little longer for it.
fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Every combination of a problem; the values of a converged reference are stored.
fn run_all(bench: &Bench, store: &Store, problem: &Problem) -> Outcome<Records> {
    let reference = match problem.reference {
        Reference::Closed { .. } => None,
        Reference::Converged { by, coarser } => {
            let values = side_by_side(&[coarser, by], threads(), |choice| {
                run(bench, problem, choice)
                    .and_then(|(run, _)| (problem.measure)(&run, choice).map_err(|error| error.to_string()))
            });
            let [coarser, by]: [Result<Values, String>; 2] =
                values.try_into().map_err(|_| "two runs give two results")?;
            let named = |error: String| format!("{}: the reference: {error}", problem.name);
            let (coarser, by) = (coarser.map_err(named)?, by.map_err(named)?);
            store.write_reference(problem, &by)?;
            Some((by.clone(), errors(&coarser, &by)))
        }
    };
    let reference_errors =
        reference.as_ref().map_or_else(|| vec![0.0; problem.quantities.len()], |(_, own)| own.clone());
    let reference = reference.map(|(values, _)| values);
    let choices = lines::combinations(&lines(problem));
    println!("verify: {}: {} combinations", problem.name, choices.len());
    let rows = side_by_side(&choices, threads(), |choice| record(bench, problem, choice, reference.as_ref()));
    Ok(Records { reference_errors, rows })
}

/// Errors of all quantities.
fn errors(values: &Values, reference: &Values) -> Vec<f64> {
    values
        .iter()
        .zip(reference)
        .map(|(a, b)| if a.len() == b.len() { relative_distance(a, b) } else { f64::NAN })
        .collect()
}

/// Runs a combination and measures it; `reference` is the values of a converged one.
fn record(bench: &Bench, problem: &Problem, choice: &Choice, reference: Option<&Values>) -> Record {
    let result = run(bench, problem, choice).and_then(|(run, mut figures)| {
        let text = |error: Box<dyn std::error::Error>| error.to_string();
        let values = (problem.measure)(&run, choice).map_err(text)?;
        let closed = match (problem.reference, reference) {
            (Reference::Closed { values, .. }, _) => Some(values(&run, choice).map_err(text)?),
            _ => None,
        };
        let reference = closed.as_ref().or(reference).ok_or("no reference")?;
        figures.errors = errors(&values, reference);
        match figures.errors.len() == problem.quantities.len() && figures.errors.iter().all(|error| error.is_finite()) {
            true => Ok(figures),
            false => Err("what was measured is not comparable with the reference".into()),
        }
    });
    Record { choice: record::words(choice), result }
}

/// Runs a combination; the errors are still empty.
fn run(bench: &Bench, problem: &Problem, choice: &Choice) -> Result<(crate::verify::Run, Figures), String> {
    let text = |error: Box<dyn std::error::Error>| error.to_string();
    let scene = (problem.scene)(choice).map_err(text)?;
    let (home, files) = (format!("{FOLDER}/{}", problem.name), (problem.files)(choice));
    let launched = launch_within(bench, &home, &choice.slug(), &scene, &files, LIMIT).map_err(text)?;
    if launched.hung {
        return Err(format!("stopped after {} s", LIMIT.as_secs()));
    }
    let run = launched.run;
    if !run.succeeded() {
        let last = launched.log.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no message");
        let code = run.ending.code.map_or_else(|| "a signal".to_owned(), |code| code.to_string());
        return Err(format!("exit code {code}: {}", first(&launched.log).unwrap_or(last).trim()));
    }
    let summary = run.summary().map_err(text)?;
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or(f64::NAN);
    let newton = run.table("newton.csv").map_err(text)?;
    let figures = Figures {
        unknowns: summary["unknowns"]["largest_number_of_equations"].as_u64().unwrap_or(0),
        cuts: summary["cuts"].as_u64().unwrap_or(0),
        iterations: newton.column("iteration")?.iter().filter(|iteration| **iteration > 0.0).count() as u64,
        cpu_seconds: number(&summary["cpu_seconds"]),
        memory: number(&summary["memory"]["peak_resident_bytes"]) / 1e6,
        verdict: run.verdict().map_err(text)?,
        errors: Vec::new(),
    };
    Ok((run, figures))
}

/// Last values of columns of a table.
pub fn last(table: &Table, columns: &[impl AsRef<str>]) -> Outcome<Vec<f64>> {
    let value = |name: &str| table.column(name)?.last().copied().ok_or_else(|| format!("{name} has no rows"));
    Ok(columns.iter().map(|name| value(name.as_ref())).collect::<Result<_, _>>()?)
}

/// What a log says of the error, without the place of the scene.
fn first(log: &str) -> Option<&str> {
    let line = log.lines().find(|line| line.starts_with("error"))?;
    let Some((_, rest)) = line.split_once(".toml:") else { return Some(line) };
    Some(rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == ':'))
}

/// Points of a line for a quantity that tell its order: size and error of the finest runs whose error is clearly above that of the reference.
fn points(records: &Records, line: &lines::Line, quantity: usize) -> Vec<(f64, f64)> {
    let floor = ABOVE_REFERENCE * records.reference_errors[quantity];
    let found = line
        .choices
        .iter()
        .filter_map(|choice| Some((line.axis.size(choice), records.figures(choice)?.errors[quantity])));
    let told: Vec<(f64, f64)> = found.filter(|point| point.1 > floor).collect();
    told[told.len().saturating_sub(FINEST)..].to_vec()
}

/// Checks the orders that theory promises.
fn claims(problem: &Problem, records: &Records, findings: &mut Findings) {
    let lines = lines(problem);
    for claim in problem.claims {
        let line = lines.iter().find(|line| line.name == claim.line);
        let quantity = problem.quantities.iter().position(|name| *name == claim.quantity);
        let order = line.zip(quantity).and_then(|(line, quantity)| order::order(&points(records, line, quantity)));
        let what = format!("order of {}, {}", claim.quantity, claim.line);
        let check =
            Check::new(problem.name, what, order.map_or(f64::NAN, |order| order.value), Bound::AtLeast(claim.at_least));
        findings.checks.push(check.noted(order.map_or_else(String::new, |order| order.text())));
    }
}
