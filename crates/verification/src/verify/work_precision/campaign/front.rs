//! The Pareto front of a problem, and the cheapest run for an error.

use super::ABOVE_REFERENCE;
use super::problem::Problem;
use super::record::{Figures, Record, Records};

/// Errors for which the cheapest run is named.
pub const TARGETS: [f64; 3] = [0.1, 0.01, 0.001];

/// Runs that came to their end, with figures.
pub fn finished(records: &Records) -> impl Iterator<Item = (&Record, &Figures)> {
    records.rows.iter().filter_map(|row| Some((row, row.result.as_ref().ok()?)))
}

/// The iterative solver factorises smaller systems: such a run is one of the direct solver.
const ITERATIVE_FROM: u64 = 1000;

/// Those among them that a user may take: the watch calls them sound, and they are what their words say.
fn usable(records: &Records) -> impl Iterator<Item = (&Record, &Figures)> {
    let is_iterative = |record: &Record| record.choice[5] == "iterative";
    finished(records).filter(move |(record, figures)| {
        figures.verdict == "sound" && (!is_iterative(record) || figures.unknowns >= ITERATIVE_FROM)
    })
}

/// Usable runs of which no other one has a smaller error of the first quantity in the same time, cheapest first.
pub fn front(records: &Records) -> Vec<(&Record, &Figures)> {
    let mut all: Vec<_> = usable(records).collect();
    all.sort_by(|a, b| a.1.cpu_seconds.total_cmp(&b.1.cpu_seconds).then(a.1.errors[0].total_cmp(&b.1.errors[0])));
    let mut least = f64::INFINITY;
    all.retain(|(_, figures)| {
        let is_better = figures.errors[0] < least;
        least = least.min(figures.errors[0]);
        is_better
    });
    all
}

/// The usable run with the least time whose error of the first quantity is not above `target`; none where the reference does not tell such an error from its own.
pub fn cheapest(records: &Records, target: f64) -> Option<(&Record, &Figures)> {
    let is_told = target >= ABOVE_REFERENCE * records.reference_errors[0];
    let reached = usable(records).filter(|(_, figures)| is_told && figures.errors[0] <= target);
    reached.min_by(|a, b| a.1.cpu_seconds.total_cmp(&b.1.cpu_seconds))
}

/// What distinguishes a run from others of the problem, in words.
pub fn words(problem: &Problem, record: &Record) -> String {
    let [scheme, method, cell, mesh, steps, solver, tolerance] = &record.choice;
    let mut words = Vec::new();
    let mut say = |is_chosen: bool, text: String| {
        if is_chosen {
            words.push(text);
        }
    };
    say(problem.schemes.len() > 1, scheme.clone());
    say(problem.methods.len() > 1, method.clone());
    say(problem.cells.len() > 1, cell.clone());
    let counted = |count: &str, what: &str| format!("{count} {what}{}", if count == "1" { "" } else { "s" });
    say(problem.meshes.len() > 1, counted(mesh, "element"));
    say(problem.steps.len() > 1, counted(steps, "step"));
    say(*solver != problem.best.solver, solver.clone());
    say(*tolerance != format!("{:e}", problem.best.tolerance), format!("tolerance {tolerance}"));
    words.join(", ")
}

/// A duration in words.
pub fn seconds(seconds: f64) -> String {
    if seconds < 0.1 { format!("{:.0} ms", 1e3 * seconds) } else { format!("{} s", short(seconds)) }
}

/// Two digits.
fn short(value: f64) -> String {
    if value >= 10.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.2}").trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str, cpu_seconds: f64, error: f64) -> Record {
        let figures = Figures {
            unknowns: 1,
            cuts: 0,
            iterations: 1,
            cpu_seconds,
            memory: 1.0,
            verdict: "sound".into(),
            errors: vec![error],
        };
        Record { choice: std::array::from_fn(|_| name.to_owned()), result: Ok(figures) }
    }

    #[test]
    fn what_another_run_betters_is_not_on_the_front() {
        let failed = Record { result: Err("no".into()), ..row("e", 0.1, 0.0) };
        let rows = vec![row("a", 1.0, 0.1), row("b", 2.0, 0.2), row("c", 3.0, 0.01), row("d", 1.0, 0.3), failed];
        let mut wrong = row("f", 0.1, 1e-9);
        if let Ok(figures) = &mut wrong.result {
            figures.verdict = "wrong".into();
        }
        let rows = rows.into_iter().chain([wrong]).collect();
        let records = Records { reference_errors: vec![0.0], rows };
        let names: Vec<&str> = front(&records).iter().map(|(row, _)| row.choice[0].as_str()).collect();
        assert_eq!(names, ["a", "c"]);
        assert_eq!(cheapest(&records, 0.15).unwrap().0.choice[0], "a");
        assert_eq!(cheapest(&records, 0.001), None);
        let uncertain = Records { reference_errors: vec![0.1], ..records };
        assert_eq!(cheapest(&uncertain, 0.15), None, "the reference is off by a tenth");
    }
}
