//! Thesis D.1: `f(x) = sin x + x^4` at `x = 2`, `f' = cos x + 4 x^3`.

use stoss_numerical_derivative::{
    Analytic, AnalyticScalar, DifferenceStep, Method, Row, Scalar, derivative, optimum, steps, study,
};

struct Example;

impl AnalyticScalar for Example {
    fn at<S: Scalar>(&self, x: S) -> S {
        x.sin() + x.powi(4)
    }
}

const X: f64 = 2.0;

fn exact() -> f64 {
    X.cos() + 4.0 * X.powi(3)
}

fn rows(first: i32, last: i32) -> Vec<Row> {
    study(&mut Analytic(Example), exact(), X, &steps(first, last, 8)).unwrap()
}

/// Slope of a straight line through all points of a log-log plot, by least squares.
fn slope(rows: &[Row], method: Method) -> f64 {
    let points: Vec<(f64, f64)> = rows.iter().map(|row| (row.step.ln(), row.error(method).ln())).collect();
    let n = points.len() as f64;
    let (x, y) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[test]
fn complex_step_is_exact_for_all_small_steps() {
    for row in study(&mut Analytic(Example), exact(), X, &steps(-8, -300, 1)).unwrap() {
        assert!(row.error(Method::ComplexStep) < 1e-14, "{row:?}");
    }
}

#[test]
fn orders_before_the_optimum() {
    // Well above the optimal steps 1e-8 and 6e-6 (complex step: above 1e-7, where h^2 reaches round-off).
    let range = rows(-2, -4);
    for method in Method::ALL {
        let slope = slope(&range, method);
        assert!((slope - f64::from(method.order())).abs() < 0.02, "{method}: {slope}");
    }
}

#[test]
fn truncation_errors_are_those_of_taylor_s_series() {
    // f''/2 h, f'''/6 h^2 over f' = 31.58; f'' = 12 x^2 - sin x, f''' = 24 x - cos x.
    let h = 1e-3;
    let row = &study(&mut Analytic(Example), exact(), X, &[h]).unwrap()[0];
    let first = (12.0 * X * X - X.sin()) / 2.0 * h / exact();
    let second = (24.0 * X - X.cos()) / 6.0 * h * h / exact();
    let expected = [first, first, second, second];
    for method in Method::ALL {
        let ratio = row.error(method) / expected[method as usize];
        assert!((ratio - 1.0).abs() < 2e-3, "{method}: {ratio}");
    }
}

#[test]
fn optima_are_near_the_theoretical_ones() {
    let rows = rows(0, -15);
    for method in [Method::Forward, Method::Backward, Method::Central] {
        let best = optimum(&rows, method).unwrap();
        let (error, step) = (best.error / method.attainable_error(), best.step / method.unit_step());
        assert!((0.1..10.0).contains(&error), "{method}: error {:e}", best.error);
        assert!((0.03..30.0).contains(&step), "{method}: step {:e}", best.step);
    }
}

#[test]
fn default_steps_reach_what_the_method_can() {
    for method in Method::ALL {
        let value = derivative(&mut Analytic(Example), X, method, DifferenceStep::default()).unwrap();
        let error = (value / exact() - 1.0).abs();
        assert!(error < 10.0 * method.attainable_error(), "{method}: {error:e}");
    }
}
