//! Numerical tangents against the exact one (thesis D.1).

use stoss_numerical_derivative::{Analytic, AnalyticScalar, Method, Row, Scalar, optimum, steps, study};

use super::check::{Bound, Check, number};
use super::report::{Grid, ReportSection};
use super::{Bench, Findings, Suite};
use crate::plot::{self, Labels, Series};
use crate::workspace::Outcome;

/// Figure D.1 of the thesis.
pub struct Tangents;

/// The study is at this argument.
const X: f64 = 2.0;

/// The complex step must be exact but for round-off with steps up to this.
const SMALL_STEP: f64 = 1e-8;
const COMPLEX_STEP: f64 = 1e-14;

/// A difference must reach the theoretical error at its best step within this factor.
const OPTIMUM: f64 = 10.0;

impl Suite for Tangents {
    fn name(&self) -> &'static str {
        "tangents"
    }

    fn about(&self) -> &'static str {
        "Differences and complex step against an exact derivative."
    }

    fn measure(&self, _bench: &Bench) -> Outcome<Findings> {
        let mut findings = Findings::default();
        example(&mut findings)?;
        Ok(findings)
    }
}

/// `f(x) = sin x + x^4`, thesis (D.6).
struct Example;

impl AnalyticScalar for Example {
    fn at<S: Scalar>(&self, x: S) -> S {
        x.sin() + x.powi(4)
    }
}

/// `f'(x) = cos x + 4 x^3`, thesis (D.7).
fn exact(x: f64) -> f64 {
    x.cos() + 4.0 * x.powi(3)
}

/// Figure D.1 of the thesis and what must be seen in it.
fn example(findings: &mut Findings) -> Outcome<()> {
    let rows = study(&mut Analytic(Example), exact(X), X, &steps(0, -16, 8))?;
    let scene = "figure D.1";
    let small = rows.iter().filter(|row| row.step <= SMALL_STEP).map(|row| row.error(Method::ComplexStep));
    let worst = small.fold(0.0_f64, |worst, error| if error.is_nan() { f64::INFINITY } else { worst.max(error) });
    let quantity = format!("complex step, error for steps up to {SMALL_STEP:.0e}");
    findings.checks.push(Check::new(scene, quantity, worst, Bound::AtMost(COMPLEX_STEP)));
    for method in [Method::Forward, Method::Backward, Method::Central] {
        let best = optimum(&rows, method).ok_or("the study has no rows")?;
        let bound = Bound::AtMost(OPTIMUM * method.attainable_error());
        let check = Check::new(scene, format!("{method}, error at the best step"), best.error, bound);
        let expected = method.unit_step();
        findings.checks.push(check.noted(format!("step {:.1e}, in theory about {expected:.1e}", best.step)));
    }
    for method in Method::ALL {
        let order = order(&rows, method);
        let bound = Bound::Near { value: method.order().into(), tolerance: 0.05 };
        findings.checks.push(Check::new(scene, format!("{method}, order"), order, bound));
    }
    findings.sections.push(figure(&rows));
    Ok(())
}

/// Observed order between the steps 1e-2 and 1e-4.
fn order(rows: &[Row], method: Method) -> f64 {
    let at = |step: f64| rows.iter().find(|row| (row.step / step - 1.0).abs() < 1e-9).map(|row| row.error(method));
    match (at(1e-2), at(1e-4)) {
        (Some(large), Some(small)) => 0.5 * (large / small).log10(),
        _ => f64::NAN,
    }
}

/// Left the function, right the errors.
fn figure(rows: &[Row]) -> ReportSection {
    let x: Vec<f64> = (0..=150).map(|k| 0.02 * f64::from(k)).collect();
    let near = [X - 0.7, X + 0.7];
    let function = [
        Series::new("f", &x, x.iter().map(|x| Example.at(*x))),
        Series::new("tangent at 2", &near, near.map(|x| Example.at(X) + exact(X) * (x - X))),
    ];
    let step: Vec<f64> = rows.iter().map(|row| row.step).collect();
    let errors = Method::ALL.map(|method| Series::new(method.name(), &step, rows.iter().map(|row| row.error(method))));
    let labels = Labels { title: "error of f'(2); zero is drawn at 1e-17", x: "step", y: "relative error" };
    let figures = vec![
        plot::linear(Labels { title: "f(x) = sin x + x⁴", x: "x", y: "" }, &function),
        plot::log_log(labels, &errors, Some(1e-17), &[1.0, 2.0]),
    ];
    let entries = |row: &Row| {
        let errors = Method::ALL.map(|method| row.error(method));
        std::iter::once(format!("{:.0e}", row.step)).chain(errors.map(number_or_dash)).collect()
    };
    let grid = Grid {
        caption: "relative error; no value where the step is lost in the round-off of x".into(),
        head: std::iter::once("step").chain(Method::ALL.map(Method::name)).map(str::to_owned).collect(),
        rows: rows.iter().step_by(16).map(entries).collect(),
    };
    ReportSection { title: "Figure D.1: numerical tangents".into(), reading: "Derivatives by differences, by a complex step and by dual numbers against the exact one (thesis, appendix D). Differences lose half of the digits or more; the other two none.".into(), figures, tables: vec![grid] }
}

fn number_or_dash(value: f64) -> String {
    if value.is_nan() { "-".into() } else { number(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read_between_two_steps() {
        let row = |step: f64, error: f64| Row { step, errors: [error, error * error, f64::NAN, 1.0] };
        let rows = [row(1e-1, 1.0), row(1e-2, 1e-3), row(1e-3, 1e-4), row(1e-4, 1e-5)];
        assert!((order(&rows, Method::Forward) - 1.0).abs() < 1e-12);
        assert!((order(&rows, Method::Backward) - 2.0).abs() < 1e-12);
        assert!(order(&rows, Method::Central).is_nan() && order(&rows[..2], Method::Forward).is_nan());
    }
}
