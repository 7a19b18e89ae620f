//! Error against CPU time, step size and number of force evaluations, for every scheme; error against CPU time for every cell; and the campaign of all methods on problems with references.

mod campaign;
mod cells;
mod problems;
mod solids;
mod springs;

use super::curve::{self, ProblemCurves, TARGETS};

use super::check::{Bound, Check, number};
use super::report::{Grid, ReportSection};
use super::{Bench, Findings, Suite};
use crate::plot::{self, Labels, Series};
use crate::workspace::Outcome;

/// Which scheme is cheapest at which error.
pub struct WorkPrecision;

/// Schemes this near to the cheapest are reported with it: the clock is not better than that.
const LEVEL: f64 = 1.25;

/// Share of the target error that a reference's own error may have.
const REFERENCE_SHARE: f64 = 0.1;

impl Suite for WorkPrecision {
    fn name(&self) -> &'static str {
        "work-precision"
    }

    fn about(&self) -> &'static str {
        "Relative error of the end positions against CPU time, step size and evaluations of the forces, for every scheme; with friction \
         also that of the dissipated energy; references are converged to what each case says."
    }

    fn measure(&self, bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        campaign::measure(bench, problems::PROBLEMS, &mut findings)?;
        if !bench.problems.is_empty() {
            return Ok(findings);
        }
        for case in springs::cases(bench.quick)?.into_iter().chain(solids::cases(bench.quick)?) {
            report(&case, &mut findings);
        }
        if !bench.quick {
            cells::measure(&mut findings)?;
        }
        Ok(findings)
    }
}

/// Refuses names that no problem of the campaign has.
pub fn is_known(names: &[String]) -> Outcome<()> {
    let known: Vec<&str> = problems::PROBLEMS.iter().map(|problem| problem.name).collect();
    match names.iter().find(|name| !known.contains(&name.as_str())) {
        Some(name) => Err(format!("no problem {name:?} of work-precision; there are {}", known.join(", ")).into()),
        None => Ok(()),
    }
}

fn report(case: &ProblemCurves, findings: &mut Findings) {
    let mut check = |quantity: String, measured: f64, bound: Bound, note: String| {
        findings.checks.push(Check::new(&case.name, quantity, measured, bound).noted(note));
    };
    let bound = Bound::AtMost(REFERENCE_SHARE * case.least_target);
    check("error of the reference".into(), case.reference_error, bound, case.reference.clone());
    if let Some(error) = case.dissipation_error {
        check("error of the reference's dissipation".into(), error, bound, String::new());
    }
    for curve in &case.curves {
        if let (Some(dissipation), Some(last)) = (case.dissipation_error, curve.points.last())
            && let Some(error) = last.of_dissipation
        {
            let note = format!("of positions {}; the reference is good to {}", number(last.error), number(dissipation));
            check(format!("error of the dissipation of {}, finest step", curve.scheme), error, Bound::Unbounded, note);
        }
        if let (Some(order), Some(claim)) = (curve.order(case.floor()), curve.checked_order) {
            let tolerance = if claim < 2.0 { 0.05 } else { 0.02 };
            let quantity = format!("order of {}", curve.scheme);
            check(quantity, order, Bound::Near { value: claim, tolerance }, String::new());
        }
    }
    // The answer in one sentence, from the measurement.
    let cheapest = case.cheapest(1e-3);
    let seconds = cheapest.map_or(f64::NAN, |(_, seconds)| seconds);
    let sentence = match cheapest {
        Some((scheme, seconds)) => {
            let level = case.level(1e-3, LEVEL);
            let others = if level.is_empty() { "no other".to_owned() } else { level.join(", ") };
            format!("cheapest at an error of 1e-3: {scheme} with {seconds:.1e} s; within {LEVEL} times that: {others}")
        }
        None => "no scheme reaches an error of 1e-3 with the steps tried".into(),
    };
    check("seconds of the cheapest scheme at 1e-3".into(), seconds, Bound::Unbounded, sentence.clone());

    let series = |x: fn(&curve::Point) -> f64| -> Vec<Series> {
        let line = |c: &curve::Curve| Series {
            name: c.scheme.clone(),
            points: c.points.iter().map(|p| (x(p), p.error)).collect(),
        };
        case.curves.iter().map(line).collect()
    };
    let chart = |title: &str, x: &str, points: Vec<Series>, slopes: &[f64]| {
        plot::log_log(Labels { title, x, y: "relative error" }, &points, Some(1e-13), slopes)
    };
    let title = |what: &str| match &case.figure {
        Some(figure) if what == "step" => format!("{} (figure {figure})", case.name),
        _ => case.name.clone(),
    };
    let mut figures = vec![
        chart(&title("work"), "CPU seconds", series(|p| p.seconds), &[-1.0, -2.0]),
        chart(&title("step"), "step size", series(|p| p.dt), &[1.0, 2.0]),
        chart(&title("evaluations"), "evaluations of the forces", series(|p| p.evaluations as f64), &[-1.0, -2.0]),
    ];
    if case.dissipation_error.is_some() {
        let line = |c: &curve::Curve| Series {
            name: c.scheme.clone(),
            points: c.points.iter().filter_map(|p| Some((p.dt, p.of_dissipation?))).collect(),
        };
        let series: Vec<Series> = case.curves.iter().map(line).collect();
        let labels = Labels { title: "dissipated energy", x: "step size", y: "relative error" };
        figures.push(plot::log_log(labels, &series, Some(1e-13), &[1.0, 2.0]));
    }
    let mut head = vec!["scheme".to_owned(), "order".to_owned()];
    head.extend(TARGETS.map(|target| format!("CPU s to {target:.0e}")));
    head.push("failed".to_owned());
    let row = |c: &curve::Curve| {
        let mut row = vec![c.scheme.clone(), c.order(case.floor()).map_or_else(|| "-".into(), |o| format!("{o:.2}"))];
        let seconds = |target| c.seconds_to(target).filter(|_| target >= case.least_target);
        row.extend(TARGETS.map(|target| seconds(target).map_or_else(|| "-".into(), |s| format!("{s:.1e}"))));
        row.push(c.failures.join("; "));
        row
    };
    let caption = format!(
        "{}. Reference: {}, its own error {}. {sentence}.",
        case.about,
        case.reference,
        number(case.reference_error)
    );
    let table = Grid { caption, head, rows: case.curves.iter().map(row).collect() };
    findings.sections.push(ReportSection {
        title: format!("work and precision: {}", case.name),
        reading: "Error against run time, a line for each method. The lower left is best; a steeper line is a higher order, and a line that ends early stopped there.".into(),
        figures,
        tables: vec![table],
    });
}
