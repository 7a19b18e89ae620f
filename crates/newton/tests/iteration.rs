//! The iteration on small systems whose behaviour is known.

use proptest::prelude::*;
use stoss_newton::{
    LineSearch, NewtonFailure, NewtonOptions, NewtonProblem, NewtonReport, ResidualNorms, StopReason, solve,
};

/// A scalar equation `f(x) = 0`, solved with slope `k(x)`; trials outside of the domain are errors.
struct Scalar<F, K> {
    f: F,
    k: K,
    domain: (f64, f64),
    x: f64,
    base: f64,
    dx: f64,
    scale: f64,
    recoverable: bool,
    assemblies: u32,
    /// The iterate never goes more than nine tenths of the way to here, from either side.
    wall: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
struct Outside(f64);

impl<F: Fn(f64) -> f64, K: Fn(f64) -> f64> Scalar<F, K> {
    fn new(f: F, k: K, x: f64) -> Self {
        Self {
            f,
            k,
            domain: (f64::NEG_INFINITY, f64::INFINITY),
            x,
            base: x,
            dx: 0.0,
            scale: 1.0,
            recoverable: true,
            assemblies: 0,
            wall: None,
        }
    }

    fn run(&mut self, o: &NewtonOptions) -> Result<NewtonReport, NewtonFailure<Outside>> {
        let result = solve(self, o);
        if let Ok(report) = &result {
            // The record of the accepted iterate is the truth.
            assert_eq!(report.final_residual(), (self.f)(self.x).abs());
        }
        result
    }
}

impl<F: Fn(f64) -> f64, K: Fn(f64) -> f64> NewtonProblem for Scalar<F, K> {
    type Error = Outside;

    fn assemble(&mut self) -> Result<ResidualNorms, Outside> {
        self.assemblies += 1;
        self.residual_norms()
    }

    fn solve(&mut self) -> Result<f64, Outside> {
        self.base = self.x;
        self.dx = -(self.f)(self.x) / (self.k)(self.x);
        Ok(self.dx.abs())
    }

    fn longest_step(&mut self) -> Result<f64, Outside> {
        let to_wall = self.wall.map_or(f64::INFINITY, |wall| 0.9 * (wall - self.x) / self.dx);
        Ok(if to_wall > 0.0 { to_wall.min(1.0) } else { 1.0 })
    }

    fn update(&mut self, factor: f64) -> Result<(), Outside> {
        self.x = self.base + factor * self.dx;
        Ok(())
    }

    fn residual_norms(&mut self) -> Result<ResidualNorms, Outside> {
        if self.x < self.domain.0 || self.x > self.domain.1 {
            return Err(Outside(self.x));
        }
        Ok(ResidualNorms { residual: (self.f)(self.x).abs(), scale: self.scale })
    }

    fn is_recoverable(&self, _: &Outside) -> bool {
        self.recoverable
    }

    fn iterate_norm(&self) -> f64 {
        self.x.abs()
    }

    fn slope(&self) -> f64 {
        (self.f)(self.x) * self.dx
    }
}

fn with_line_search() -> NewtonOptions {
    NewtonOptions { line_search: LineSearch::backtracking(), ..NewtonOptions::default() }
}

fn reason<T: std::fmt::Debug>(r: Result<T, NewtonFailure<Outside>>) -> StopReason {
    r.unwrap_err().report().reason
}

#[test]
fn newton_is_quadratic_and_ends_at_round_off() {
    let mut p = Scalar::new(|x| x * x - 2.0, |x| 2.0 * x, 10.0);
    let report = p.run(&NewtonOptions::default()).unwrap();
    assert!(report.reason.is_converged());
    assert!((p.x - 2f64.sqrt()).abs() <= 4.5e-16, "{}", p.x);
    let order = report.observed_order().unwrap();
    assert!((order - 2.0).abs() < 0.1, "{order}");
    assert_eq!(p.assemblies as usize, report.iterations.len());
}

/// A barrier at zero, approached from the right: full steps from far away would land on its left, where there is another solution of the equation.
#[test]
fn no_iterate_passes_a_wall() {
    let (f, k) = (|x: f64| 4.0 - 1.0 / (x * x), |x: f64| 2.0 / (x * x * x));
    let o = NewtonOptions { max_iterations: 60, ..NewtonOptions::default() };
    let mut free = Scalar::new(f, k, 1.2);
    let _ = free.run(&o);
    let mut stopped = Scalar { wall: Some(0.0), ..Scalar::new(f, k, 1.2) };
    let report = stopped.run(&o).unwrap();
    assert!((stopped.x - 0.5).abs() < 1e-12);
    assert!((free.x - 0.5).abs() > 1e-3, "{}", free.x);
    assert!(report.iterations.iter().any(|record| record.step_length > 0.0 && record.step_length < 1.0));
}

/// Where no step lowers the residual the best one is taken, and the iteration goes on.
#[test]
fn the_best_of_bad_steps_is_taken() {
    // A slope that is far too small: every trial overshoots, and the smallest residual is that of the shortest step.
    let (f, k) = (|x: f64| x.atan(), |x: f64| 0.02 / (1.0 + x * x));
    let best = LineSearch::Best { reduction: 0.5, max_reductions: 3 };
    let o =
        NewtonOptions { max_iterations: 1, relative_tolerance: 1e-12, line_search: best, ..NewtonOptions::default() };
    let mut p = Scalar::new(f, k, 0.5);
    let failure = p.run(&o).unwrap_err();
    let taken = failure.report().iterations.last().unwrap().step_length;
    assert_eq!(taken, 0.125);
    let strict = LineSearch::Backtracking { max_growth: 1.0, small: 0.0, reduction: 0.5, max_reductions: 3 };
    let failure = Scalar::new(f, k, 0.5).run(&NewtonOptions { line_search: strict, ..o }).unwrap_err();
    assert_eq!(failure.report().reason, StopReason::LineSearchFailed);
}

/// A frozen slope converges linearly with a known factor: `f = x - 1`, `k = 2` halves the error.
#[test]
fn a_frozen_tangent_is_linear() {
    let mut p = Scalar::new(|x| x - 1.0, |_| 2.0, 3.0);
    let o = NewtonOptions { max_iterations: 100, polish: 0, ..NewtonOptions::default() };
    let report = p.run(&o).unwrap();
    assert_eq!(report.reason, StopReason::Converged);
    assert!((report.observed_order().unwrap() - 1.0).abs() < 1e-6);
    // 2 * 2^-k <= 1e-9 for the first time at k = 31.
    assert_eq!(report.iteration_count(), 31);
}

/// A double root: the error halves, hence the residual falls by four; order one.
#[test]
fn a_double_root_is_linear() {
    let mut p = Scalar::new(|x| x * x, |x| 2.0 * x, 1.0);
    let report = p.run(&NewtonOptions::default()).unwrap();
    assert!((report.observed_order().unwrap() - 1.0).abs() < 1e-6);
}

/// A residual below the tolerance is no reason to stop before the least number of solutions.
#[test]
fn the_least_number_of_iterations_is_done() {
    let run = |min_iterations| {
        let mut p = Scalar::new(|x| x.exp() - 3.0, f64::exp, 3f64.ln() + 1e-4);
        let o = NewtonOptions { min_iterations, polish: 0, relative_tolerance: 1e-2, ..NewtonOptions::default() };
        (p.run(&o).unwrap().iteration_count(), (p.x - 3f64.ln()).abs())
    };
    let [none, one, two] = [run(0), run(1), run(2)];
    assert_eq!([none.0, one.0, two.0], [0, 1, 2]);
    assert!(one.1 < 1e-8 && two.1 < 1e-14, "{one:?} {two:?}");
}

#[test]
fn polishing_pays_or_ends() {
    let run = |polish| {
        let mut p = Scalar::new(|x| x.exp() - 3.0, f64::exp, 1.0);
        let o = NewtonOptions { polish, relative_tolerance: 1e-3, ..NewtonOptions::default() };
        (p.run(&o).unwrap(), (p.x - 3f64.ln()).abs())
    };
    let (none, one, many) = (run(0), run(1), run(9));
    assert_eq!(one.0.iteration_count(), none.0.iteration_count() + 1);
    assert!(one.1 < 1e-3 * none.1);
    assert!(many.1 <= 3e-16);
    // Round-off ends the polishing long before nine.
    assert!(many.0.iteration_count() <= none.0.iteration_count() + 4);
    assert!(many.0.reason.is_converged());
}

/// Below the tolerance the iteration must not lose what it has: a slope of the wrong sign doubles the residual.
#[test]
fn polishing_that_worsens_is_taken_back() {
    // Of tangents only the first is solved with.
    for (tangent_at_solution, assemblies) in [(false, 1), (true, 3)] {
        let mut p = Scalar::new(|x| x - 1.0, |_| -0.5, 1.0 + 1e-7);
        let o = NewtonOptions { relative_tolerance: 1e-6, tangent_at_solution, ..NewtonOptions::default() };
        let before = p.x;
        let report = p.run(&o).unwrap();
        assert_eq!(report.reason, StopReason::Converged);
        assert_eq!(p.x.to_bits(), before.to_bits());
        assert_eq!(report.iterations.last().unwrap().step_length, 0.0);
        assert_eq!(p.assemblies, assemblies);
    }
}

/// A trial of the polishing outside of the domain is no failure.
#[test]
fn polishing_outside_of_the_domain_is_taken_back() {
    let mut p = Scalar::new(|x| x - 1.0, |_| 1.0, 1.0 + 1e-7);
    p.domain = (1.0 + 1e-8, 2.0);
    p.recoverable = false;
    let o = NewtonOptions { relative_tolerance: 1e-6, ..NewtonOptions::default() };
    assert_eq!(p.run(&o).unwrap().reason, StopReason::Converged);
    assert_eq!(p.x, 1.0 + 1e-7);
}

#[test]
fn a_tolerance_below_round_off_is_not_a_failure() {
    // The residual of 1e3 (x^2 - 2) at the doubles next to sqrt(2) is about 4e-13, never zero.
    let mut p = Scalar::new(|x| 1e3 * (x * x - 2.0), |x| 2e3 * x, 1.0);
    p.scale = 2e3;
    let o = NewtonOptions { relative_tolerance: 1e-30, ..NewtonOptions::default() };
    let report = p.run(&o).unwrap();
    assert_eq!(report.reason, StopReason::ConvergedToRoundOff);
    assert!((p.x - 2f64.sqrt()).abs() <= 4.5e-16);
    assert!(report.iteration_count() < 10);
}

fn with_slope() -> NewtonOptions {
    NewtonOptions { line_search: LineSearch::backtracking().with_slope(), ..NewtonOptions::default() }
}

/// A force with kinks: full steps jump from one side to the other for ever, those that follow the slope end.
#[test]
fn a_force_that_yields_is_followed_along_its_slope() {
    let yields = |x: f64| if x.abs() > 0.1 { x.signum() * (0.1 + 0.01 * (x.abs() - 0.1)) } else { x } - 0.05;
    let stiffness = |x: f64| if x.abs() > 0.1 { 0.01 } else { 1.0 };
    let mut jumps = Scalar::new(yields, stiffness, 4.0);
    assert!(jumps.run(&with_line_search()).is_err());
    let mut follows = Scalar::new(yields, stiffness, 4.0);
    assert!(follows.run(&with_slope()).unwrap().reason.is_converged());
    assert!((follows.x - 0.05).abs() < 1e-12, "{}", follows.x);
}

/// The residual is round-off above the tolerance, as that of a stiff body that nothing loads yet: its slope changes its sign whatever the length, and says nothing.
#[test]
fn a_slope_of_round_off_is_not_followed() {
    let mut p = Scalar::new(|x| x - 1.0 + 1e-14 * (x - 1.0).signum(), |_| 1.0, 1.0 + 3e-14);
    p.scale = 1e-9;
    let report = p.run(&with_slope()).unwrap();
    assert_eq!(report.reason, StopReason::ConvergedToRoundOff, "{:?}", report.iterations);
}

/// The last bits of the iterate lead to another branch, whose residual is as large as the forces: the iterate before is the solution.
#[test]
fn a_jump_within_round_off_is_not_taken() {
    let jump = |x: f64| if (x - 1.0).abs() < 1e-15 { 1.0 } else { 1e3 * (x - 1.0) };
    let mut p = Scalar::new(jump, |_| 1e3 * (1.0 + 2.2e-7), 2.0);
    p.scale = 1e3;
    let o = NewtonOptions { relative_tolerance: 1e-30, ..NewtonOptions::default() };
    let report = p.run(&o).unwrap();
    assert_eq!(report.reason, StopReason::ConvergedToRoundOff);
    assert!(report.final_residual() < 1e-10 && (p.x - 1.0).abs() < 1e-13, "{} {}", report.final_residual(), p.x);
}

#[test]
fn an_exact_start_needs_no_solve() {
    let mut p = Scalar::new(|x| x, |_| 1.0, 0.0);
    p.scale = 0.0;
    let report = p.run(&NewtonOptions::default()).unwrap();
    assert_eq!(report.iteration_count(), 0);
    assert_eq!(report.observed_order(), None);
}

/// `ln x = 0` from 4: the full step leads to x < 0, outside of the domain; half of it is admissible.
#[test]
fn an_inadmissible_trial_needs_the_line_search() {
    let problem = || {
        let mut p = Scalar::new(f64::ln, |x| 1.0 / x, 4.0);
        p.domain = (1e-10, f64::INFINITY);
        p
    };
    let mut p = problem();
    let report = p.run(&with_line_search()).unwrap();
    assert!((p.x - 1.0).abs() < 1e-15);
    assert_eq!(report.iterations[1].step_length, 0.5);
    assert_eq!(report.iterations.last().unwrap().step_length, 1.0);
    match problem().run(&NewtonOptions::default()) {
        Err(NewtonFailure::Problem { error: Outside(x), report }) => {
            assert!(x < 0.0);
            assert_eq!(report.reason, StopReason::ProblemError);
        }
        other => panic!("{other:?}"),
    }
    let mut p = problem();
    p.recoverable = false;
    assert_eq!(reason(p.run(&with_line_search())), StopReason::ProblemError);
}

/// `atan x = 0` from 3: Newton diverges, the line search converges.
#[test]
fn the_line_search_globalises() {
    let problem = || Scalar::new(f64::atan, |x| 1.0 / (1.0 + x * x), 3.0);
    let o = NewtonOptions {
        line_search: LineSearch::Backtracking { max_growth: 1.0, small: 0.0, reduction: 0.5, max_reductions: 20 },
        ..NewtonOptions::default()
    };
    let mut p = problem();
    p.run(&o).unwrap();
    assert!(p.x.abs() < 1e-15);
    assert!(problem().run(&NewtonOptions::default()).is_err());
}

/// `x^3 - 2 x + 2 = 0` from 0: Newton goes round between 0 and 1. A shorter step leaves the round, and all others are full ones. The same with `x = 0`
/// and half its slope, from 1 to -1 and back.
#[test]
fn a_cycle_is_left() {
    let mut p = Scalar::new(|x| x, |_| 0.5, 1.0);
    p.run(&NewtonOptions::default()).unwrap();
    assert_eq!(p.x, 0.0);
    let mut p = Scalar::new(|x| x.powi(3) - 2.0 * x + 2.0, |x| 3.0 * x * x - 2.0, 0.0);
    let report = p.run(&NewtonOptions::default()).unwrap();
    let short: Vec<usize> = (1..report.iterations.len()).filter(|&k| report.iterations[k].step_length < 1.0).collect();
    assert_eq!(short, [5]);
    assert!((p.x + 1.769_292_354_238_631_4).abs() < 1e-14, "{}", p.x);
}

/// A step that multiplies a tiny residual is refused, unless the residual counts as more than it is.
#[test]
fn a_small_residual_may_grow() {
    // A slope a thousand times too small: one step is a thousand times too long.
    let run = |small| {
        let first = std::cell::Cell::new(true);
        let slope = move |_: f64| if first.replace(false) { 1e-3 } else { 1.0 };
        let mut p = Scalar::new(|x| x - 1.0, slope, 1.0 + 1e-4);
        let search = LineSearch::Backtracking { max_growth: 10.0, small, reduction: 0.5, max_reductions: 2 };
        p.run(&NewtonOptions { line_search: search, ..NewtonOptions::default() }).map(|report| report.iteration_count())
    };
    assert!(run(0.0).is_err());
    assert_eq!(run(0.1).unwrap(), 2);
}

#[test]
fn no_acceptable_length_is_named() {
    // The slope has the wrong sign: every step makes it worse.
    let o = NewtonOptions {
        line_search: LineSearch::Backtracking { max_growth: 1.0, small: 0.0, reduction: 0.5, max_reductions: 5 },
        ..NewtonOptions::default()
    };
    let mut p = Scalar::new(|x| x - 1.0, |_| -1.0, 3.0);
    assert_eq!(reason(p.run(&o)), StopReason::LineSearchFailed);
    // Nothing but the base is admissible: the problem's error comes out.
    let mut p = Scalar::new(|x| x - 1.0, |_| 1.0, 3.0);
    p.domain = (3.0, 3.0);
    assert_eq!(reason(p.run(&o)), StopReason::ProblemError);
}

#[test]
fn other_stops_are_named() {
    let run = |f: fn(f64) -> f64, k: fn(f64) -> f64, x| Scalar::new(f, k, x).run(&NewtonOptions::default());
    assert_eq!(reason(run(|x| x, |_| 10.0, 1.0)), StopReason::MaxIterations);
    assert_eq!(reason(run(|x| x, |_| -1e-3, 1.0)), StopReason::Diverged);
    // x^2 + 1 has no root: the residual never falls below 1 for long.
    assert_eq!(reason(run(|x| x * x + 1.0, |x| 2.0 * x, 1e-3)), StopReason::Stagnated);
}

#[test]
fn nan_and_infinity_stop() {
    for line_search in [LineSearch::Off, LineSearch::backtracking()] {
        let o = NewtonOptions { line_search, ..NewtonOptions::default() };
        let mut p = Scalar::new(|_| f64::NAN, |_| 1.0, 1.0);
        assert_eq!(reason(p.run(&o)), StopReason::NotFinite);
        // NaN or an infinite scale must not pass for convergence.
        let mut p = Scalar::new(|x| x, |_| 1.0, 1.0);
        p.scale = f64::INFINITY;
        assert_eq!(reason(p.run(&o)), StopReason::NotFinite);
        let mut p = Scalar::new(|x| x, |_| 0.0, 1.0);
        assert_eq!(reason(p.run(&o)), StopReason::NotFinite);
    }
    let sqrt = || Scalar::new(|x: f64| x.sqrt() - 0.1, |x: f64| 0.5 / x.sqrt(), 1.0);
    // The full step from 1 goes to -0.8, where the root is NaN.
    assert_eq!(reason(sqrt().run(&NewtonOptions::default())), StopReason::NotFinite);
    let mut p = sqrt();
    p.run(&with_line_search()).unwrap();
    assert!((p.x - 0.01).abs() < 1e-15);
}

/// Two equations, `x^2 + y^2 = r^2`, `x y = c`, with the exact tangent or one whose entry is wrong.
struct Circle {
    q: [f64; 2],
    base: [f64; 2],
    d: [f64; 2],
    r: f64,
    c: f64,
}

impl Circle {
    fn residual(&self) -> [f64; 2] {
        let [x, y] = self.q;
        [x * x + y * y - self.r * self.r, x * y - self.c]
    }
}

impl NewtonProblem for Circle {
    type Error = std::convert::Infallible;

    fn assemble(&mut self) -> Result<ResidualNorms, Self::Error> {
        let [a, b] = self.residual();
        Ok(ResidualNorms { residual: a.hypot(b), scale: self.r * self.r })
    }

    fn solve(&mut self) -> Result<f64, Self::Error> {
        let ([x, y], [a, b]) = (self.q, self.residual());
        // [2x 2y; y x] d = -[a; b]
        let det = 2.0 * (x * x - y * y);
        self.base = self.q;
        self.d = [-(x * a - 2.0 * y * b) / det, -(2.0 * x * b - y * a) / det];
        Ok(self.d[0].hypot(self.d[1]))
    }

    fn update(&mut self, factor: f64) -> Result<(), Self::Error> {
        self.q = [0, 1].map(|i| self.base[i] + factor * self.d[i]);
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn a_system_of_two(angle in 0.05f64..0.7, r in 0.1f64..100.0, dx in -0.1f64..0.1, dy in -0.02f64..0.02) {
        let exact = [r * angle.cos(), r * angle.sin()];
        let mut p = Circle {
            q: [exact[0] + r * dx, exact[1] + r * dy],
            base: [0.0; 2],
            d: [0.0; 2],
            r,
            c: exact[0] * exact[1],
        };
        let report = solve(&mut p, &NewtonOptions::default()).unwrap();
        prop_assert!(report.final_residual() <= 1e-15 * r * r);
        prop_assert!(report.iteration_count() <= 9);
        for w in report.iterations.windows(2) {
            // Kantorovich: near the solution the residual falls quadratically.
            if w[0].residual < 1e-3 * r * r && w[0].residual > 1e-7 * r * r {
                prop_assert!(w[1].residual <= 30.0 * (w[0].residual / (r * r)).powi(2) * r * r / (2.0 * angle).cos().powi(2));
            }
        }
    }

    /// Whatever the slope does, the iteration ends, and "converged" is never said of a large residual.
    #[test]
    fn it_always_ends(a in -2.0f64..2.0, b in -2.0f64..2.0, k in -1.0f64..1.0, x in -3.0f64..3.0, search: bool, polish in 0u32..4) {
        let mut p = Scalar::new(move |x| x * x * x + a * x + b, move |x| 3.0 * x * x + a + k, x);
        p.scale = 1.0 + a.abs() + b.abs();
        let line_search = if search { LineSearch::backtracking() } else { LineSearch::Off };
        let o = NewtonOptions { line_search, polish, ..NewtonOptions::default() };
        let scale = p.scale;
        match p.run(&o) {
            Ok(report) => prop_assert!(report.final_residual() <= 1e-9 * scale),
            Err(failure) => prop_assert!(!failure.report().reason.is_converged()),
        }
    }
}

/// A force balance `f = 0` that is nearly fulfilled, and a constraint `y = 0` that is not.
struct Constrained {
    y: f64,
    base: f64,
}

impl NewtonProblem for Constrained {
    type Error = std::convert::Infallible;

    fn assemble(&mut self) -> Result<ResidualNorms, Self::Error> {
        Ok(ResidualNorms { residual: 0.1, scale: 100.0 })
    }

    fn solve(&mut self) -> Result<f64, Self::Error> {
        self.base = self.y;
        Ok(self.y.abs())
    }

    fn update(&mut self, factor: f64) -> Result<(), Self::Error> {
        self.y = self.base * (1.0 - 0.9 * factor);
        Ok(())
    }

    fn relative_violation(&self) -> f64 {
        self.y.abs()
    }
}

#[test]
fn the_absolute_tolerance_is_not_one_of_constraints() {
    // The force residual is below its absolute tolerance from the start; the violation has to come down to the relative one.
    let options =
        NewtonOptions { absolute_tolerance: 1.0, relative_tolerance: 1e-6, polish: 0, ..NewtonOptions::default() };
    let mut problem = Constrained { y: 0.5, base: 0.5 };
    let report = solve(&mut problem, &options).unwrap();
    assert_eq!(report.iteration_count(), 6);
    assert!(problem.y <= 1e-6);
    let last = report.accepted().unwrap();
    assert_eq!((last.violation, last.residual), (problem.y, 0.1));
    // 0.1 of 100 is more than the violation.
    assert_eq!(last.relative_residual(), 1e-3);
    assert_eq!(report.iterations[0].relative_residual(), 0.5);
}

/// A constraint that is violated by little closes on a body without load: the first step brings forces a million times those that were there.
struct Closing {
    iterations: u32,
    /// Residual of the first iterate, in multiples of its scale.
    residual: f64,
}

impl NewtonProblem for Closing {
    type Error = std::convert::Infallible;

    fn assemble(&mut self) -> Result<ResidualNorms, Self::Error> {
        Ok(match self.iterations {
            0 => ResidualNorms { residual: self.residual * 1e-6, scale: 1e-6 },
            k => ResidualNorms { residual: 0.01_f64.powi(k as i32 - 1), scale: 4.0 },
        })
    }

    fn solve(&mut self) -> Result<f64, Self::Error> {
        self.iterations += 1;
        Ok(1.0)
    }

    fn update(&mut self, _factor: f64) -> Result<(), Self::Error> {
        Ok(())
    }

    fn relative_violation(&self) -> f64 {
        if self.iterations == 0 { 1e-5 } else { 0.0 }
    }
}

#[test]
fn forces_may_come_with_the_first_step() {
    // Tiny next to the forces that come, so that a bound by what was there would end the iteration as diverged, too.
    let options = NewtonOptions { divergence_factor: 1e3, ..with_line_search() };
    let report = solve(&mut Closing { iterations: 0, residual: 1e-12 }, &options).unwrap();
    assert!(report.iterations[1..].iter().all(|record| record.step_length == 1.0));
    // A residual of forces does tell how large they are.
    match solve(&mut Closing { iterations: 0, residual: 1e-3 }, &options) {
        Err(NewtonFailure::NotConverged(report)) => assert_eq!(report.reason, StopReason::LineSearchFailed),
        other => panic!("{other:?}"),
    }
}
