//! The iteration on problems whose residual is a gradient.

use stoss_newton::{
    LineSearch, NewtonFailure, NewtonOptions, NewtonProblem, Potential, ResidualNorms, StopReason, solve,
};

/// A potential of one variable with its derivatives. `solve_downhill` shifts a negative curvature to a positive one.
struct Well {
    value: fn(f64) -> f64,
    slope: fn(f64) -> f64,
    curvature: fn(f64) -> f64,
    has_potential: bool,
    is_fixed: bool,
    x: f64,
    base: f64,
    dx: f64,
    lengths: Vec<f64>,
}

impl Well {
    fn double(x: f64) -> Self {
        Self {
            value: |x| 0.25 * x.powi(4) - 0.5 * x * x,
            slope: |x| x.powi(3) - x,
            curvature: |x| 3.0 * x * x - 1.0,
            has_potential: true,
            is_fixed: true,
            x,
            base: x,
            dx: 0.0,
            lengths: Vec::new(),
        }
    }

    fn go(&mut self, curvature: f64) -> f64 {
        self.base = self.x;
        self.dx = -(self.slope)(self.x) / curvature;
        self.dx.abs()
    }
}

impl NewtonProblem for Well {
    type Error = ();

    fn assemble(&mut self) -> Result<ResidualNorms, ()> {
        self.residual_norms()
    }

    fn solve(&mut self) -> Result<f64, ()> {
        Ok(self.go((self.curvature)(self.x)))
    }

    fn solve_downhill(&mut self) -> Result<f64, ()> {
        let curvature = (self.curvature)(self.x);
        Ok(self.go(if self.has_potential { curvature.abs().max(1e-3) } else { curvature }))
    }

    fn potential(&mut self) -> Result<Option<Potential>, ()> {
        let potential = Potential { value: (self.value)(self.x), round_off: 1e-15, is_fixed: self.is_fixed };
        Ok(self.has_potential.then_some(potential))
    }

    fn slope(&self) -> f64 {
        (self.slope)(self.x) * self.dx
    }

    fn update(&mut self, factor: f64) -> Result<(), ()> {
        self.x = self.base + factor * self.dx;
        self.lengths.push(factor);
        Ok(())
    }

    fn residual_norms(&mut self) -> Result<ResidualNorms, ()> {
        Ok(ResidualNorms { residual: (self.slope)(self.x).abs(), scale: 1.0 })
    }
}

fn options() -> NewtonOptions {
    NewtonOptions {
        line_search: LineSearch::Best { reduction: 0.5, max_reductions: 5 },
        relative_tolerance: 1e-12,
        ..NewtonOptions::default()
    }
}

/// Between two wells the residual is smallest on the ridge: there goes what lowers it, and into a well what lowers the potential, over larger residuals.
#[test]
fn minima_are_found_and_not_the_ridge() {
    let mut blind = Well { has_potential: false, ..Well::double(0.1) };
    solve(&mut blind, &options()).unwrap();
    assert!(blind.x.abs() < 1e-12, "{}", blind.x);
    for start in [0.1, -1e-6, 0.5, 3.0] {
        let mut well = Well::double(start);
        let report = solve(&mut well, &options()).unwrap();
        assert!((well.x.abs() - 1.0).abs() < 1e-12 && well.x * start > 0.0, "{start}: {}", well.x);
        assert!(report.iterations.len() < 40, "{start}: {}", report.iterations.len());
    }
}

/// A step that overshoots is shortened until the potential falls as its slope promises.
#[test]
fn steps_that_go_up_are_shortened() {
    let bell = |is_fixed| Well {
        value: |x| x * x.atan() - 0.5 * (1.0 + x * x).ln(),
        slope: |x| x.atan(),
        // A tenth of the largest curvature: full steps are far too long.
        curvature: |_| 0.1,
        is_fixed,
        ..Well::double(0.9)
    };
    let o = NewtonOptions { max_iterations: 200, ..options() };
    let mut well = bell(true);
    solve(&mut well, &o).unwrap();
    assert!(well.x.abs() < 1e-11);
    assert!(well.lengths.iter().any(|length| *length <= 0.25));
    // A potential that does not last lets smaller residuals decide.
    let mut well = bell(false);
    let report = solve(&mut well, &o).unwrap();
    assert!(well.x.abs() < 1e-11);
    // An iterate that was taken back has no length.
    let kept = report.iterations.iter().filter(|record| record.step_length > 0.0);
    let residuals: Vec<f64> = kept.map(|record| record.residual).collect();
    assert!(residuals.windows(2).all(|w| w[1] < w[0]), "{residuals:?}");
}

/// Iterations that go down do not use up the limit, but not without end.
#[test]
fn a_long_way_down_is_gone() {
    // A long slope, on which steps are limited by the curvature, to a minimum at 40.
    let slope = |depth: f64| Well {
        value: |x| if x < 40.0 { 40.0 - x } else { 0.5 * (x - 40.0).powi(2) },
        slope: |x| if x < 40.0 { -1.0 } else { x - 40.0 },
        curvature: |_| 1.0,
        ..Well::double(depth)
    };
    let o = NewtonOptions { max_iterations: 10, ..options() };
    let mut near = slope(0.0);
    solve(&mut near, &o).unwrap();
    assert_eq!(near.x, 40.0);
    let reason = |result: Result<_, NewtonFailure<()>>| match result {
        Err(NewtonFailure::NotConverged(report)) => report.reason,
        other => panic!("{other:?}"),
    };
    assert_eq!(reason(solve(&mut slope(-30.0), &o)), StopReason::MaxIterations);
    let mut blind = Well { has_potential: false, ..slope(0.0) };
    assert_ne!(reason(solve(&mut blind, &o)), StopReason::Converged);
}
