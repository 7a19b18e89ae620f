//! The quick part: the coarsest runs of each problem against the stored ones, and the pages against the stored results.

use super::lines::{Line, lines};
use super::order::order;
use super::page;
use super::problem::{Problem, Reference};
use super::record::Records;
use super::stored::Store;
use super::{points, record, threads};
use crate::verify::check::{Bound, Check};
use crate::verify::side_by_side::side_by_side;
use crate::verify::{Bench, Findings};
use crate::workspace::{Outcome, read};

/// An order may fall by so much.
const ORDER: f64 = 0.3;

/// Errors and iterations may grow by this factor.
const FRONT: f64 = 1.3;

/// Smallest errors that are compared: below them are round-off and the tolerance of Newton's method.
const ROUND_OFF: f64 = 1e-8;

/// The coarsest runs of the lines that are repeated.
fn repeated(problem: &Problem) -> Vec<Line> {
    let main = lines(problem).into_iter().filter(|line| matches!(line.name.as_str(), "mesh" | "step"));
    main.map(|line| Line { choices: line.choices[..problem.quick.min(line.choices.len())].to_vec(), ..line }).collect()
}

/// Repeats the coarsest runs.
pub fn measure(bench: &Bench, store: &Store, problem: &Problem, findings: &mut Findings) -> Outcome<()> {
    let stored = store.records(problem)?;
    let reference = match problem.reference {
        Reference::Closed { .. } => None,
        Reference::Converged { .. } => Some(store.reference(problem)?),
    };
    let lines = repeated(problem);
    let choices = super::lines::combinations(&lines);
    let rows = side_by_side(&choices, threads(), |choice| record(bench, problem, choice, reference.as_ref()));
    let now = Records { reference_errors: stored.reference_errors.clone(), rows };
    for choice in &choices {
        let name = format!("{}, {}", problem.name, choice.slug());
        let before = stored.figures(choice);
        let found = now.of(choice).map(|row| &row.result);
        let mut check = |quantity: String, measured: f64, bound: Bound, note: String| {
            findings.checks.push(Check::new(&name, quantity, measured, bound).noted(note));
        };
        match (before, found) {
            (Some(before), Some(Ok(found))) => {
                for (k, quantity) in problem.quantities.iter().enumerate() {
                    let floor = ROUND_OFF.max(now.reference_errors[k]);
                    let bound = Bound::AtMost(FRONT * before.errors[k].max(floor));
                    check(format!("error of {quantity}"), found.errors[k], bound, String::new());
                }
                check(
                    "iterations".into(),
                    found.iterations as f64,
                    Bound::AtMost(FRONT * before.iterations as f64),
                    String::new(),
                );
            }
            // It failed before too: listed on the page.
            (None, Some(Err(_))) if stored.of(choice).is_some() => {}
            (_, found) => {
                let reason = found.and_then(|found| found.as_ref().err()).cloned();
                check(
                    "is as stored".into(),
                    f64::NAN,
                    Bound::AtMost(0.0),
                    reason.unwrap_or_else(|| "not stored: run the full mode".into()),
                );
            }
        }
    }
    for line in &lines {
        for (k, quantity) in problem.quantities.iter().enumerate() {
            let of =
                |records: &Records| order(&points(records, line, k)).filter(|_| points(records, line, k).len() > 2);
            let (Some(before), Some(found)) = (of(&stored), of(&now)) else { continue };
            let check = Check::new(
                problem.name,
                format!("order of {quantity}, {}", line.name),
                found.value,
                Bound::AtLeast(before.value - ORDER),
            );
            findings.checks.push(check.noted(format!("stored: {}", before.text())));
        }
    }
    Ok(())
}

/// The pages are those that the stored results give.
pub fn pages(store: &Store, problems: &[&Problem], findings: &mut Findings) -> Outcome<()> {
    let mut stale = Vec::new();
    for (name, text) in page::all(store, problems)? {
        if read(&store.file(&name)).ok().as_ref() != Some(&text) {
            stale.push(name);
        }
    }
    let check = Check::new(
        "work-precision",
        "pages that the stored results do not give",
        stale.len() as f64,
        Bound::AtMost(0.0),
    );
    findings.checks.push(check.noted(stale.join("; ")));
    Ok(())
}
