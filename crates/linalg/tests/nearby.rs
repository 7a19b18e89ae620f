//! Solutions with the factors of other values than those at hand.

use crate::common::Random;
use crate::common::tangents::{Setting, block_pair};
use std::sync::Arc;
use stoss_linalg::{
    AutoSolver, DenseSolver, LinalgError, LinearSolver, MatrixKind, MultifrontalSolver, SolverOptions, SparseMatrix,
    SparsityPattern, SystemArray,
};

/// A saddle point that is large enough to be worth an iteration.
fn system(unsymmetric: bool) -> (SparseMatrix, Vec<f64>) {
    block_pair(9, Setting::new(unsymmetric))
}

/// Every entry changed by up to `share` of itself.
fn disturbed(a: &SparseMatrix, share: f64) -> SparseMatrix {
    let mut random = Random(7);
    let mut a = a.clone();
    a.values.iter_mut().for_each(|v| *v *= 1.0 + share * random.value());
    a
}

/// The `k`-th last equation as an identity row and column, as of a multiplier that is not active.
fn switched_off(a: &SparseMatrix, k: usize) -> SparseMatrix {
    let mut a = a.clone();
    let off = a.n() - k;
    for j in 0..a.n() {
        for k in a.pattern.column_range(j) {
            let i = a.pattern.row_indices()[k] as usize;
            if i == off || j == off {
                a.values[k] = if i == j { 1.0 } else { 0.0 };
            }
        }
    }
    a
}

fn factorised(a: &SparseMatrix, kind: MatrixKind) -> MultifrontalSolver {
    let mut solver = MultifrontalSolver::new();
    solver.analyse(&a.pattern, kind).unwrap();
    solver.factorise(&a.values).unwrap();
    solver
}

fn nearby(solver: &mut dyn LinearSolver, a: &SparseMatrix, b: &[f64], tolerance: f64) -> Option<(u32, Vec<f64>)> {
    let mut x = vec![f64::NAN; b.len()];
    solver.solve_nearby(&a.values, b, &mut x, tolerance).unwrap().map(|iterations| (iterations, x))
}

fn difference(x: &[f64], y: &[f64]) -> f64 {
    let size = y.iter().fold(0f64, |m, v| m.max(v.abs()));
    x.iter().zip(y).fold(0f64, |m, (x, y)| m.max((x - y).abs())) / size
}

/// The solution is that of the values at hand, and the factors stay those of the old ones.
#[test]
fn a_solution_is_that_of_the_new_values() {
    for (unsymmetric, kind) in [(true, MatrixKind::General), (false, MatrixKind::Symmetric)] {
        let (a, b) = system(unsymmetric);
        let mut solver = factorised(&a, kind);
        let mut before = vec![0.0; b.len()];
        solver.solve(&b, &mut before).unwrap();
        for change in [disturbed(&a, 1e-4), switched_off(&a, 1), switched_off(&switched_off(&a, 1), 3)] {
            let mut exact = vec![0.0; b.len()];
            factorised(&change, MatrixKind::General).solve(&b, &mut exact).unwrap();
            assert!(difference(&before, &exact) > 1e-6, "the change must be one");
            let (iterations, x) = nearby(&mut solver, &change, &b, 1e-11).expect("near enough");
            assert!((1..12).contains(&iterations), "{iterations}");
            assert!(difference(&x, &exact) < 1e-7, "{kind:?}: {:e}", difference(&x, &exact));
        }
        let mut after = vec![0.0; b.len()];
        solver.solve(&b, &mut after).unwrap();
        assert_eq!(before, after);
        assert_eq!((solver.statistics().factorisations, solver.statistics().nearby_solves), (1, 3));
    }
}

/// A multiplier that begins to act has its part in the residual, also where its row and column are tiny or huge in the units of the system: the compliance on its diagonal before tells how
/// large they will be.
#[test]
fn a_multiplier_that_begins_to_act_counts_in_all_units() {
    for (unsymmetric, kind) in [(true, MatrixKind::General), (false, MatrixKind::Symmetric)] {
        let (a, b) = system(unsymmetric);
        let n = a.n();
        let first = (0..n).find(|&j| a.get(j as u32, j as u32) == 0.0).unwrap();
        let mut exact = vec![0.0; n];
        factorised(&a, kind).solve(&b, &mut exact).unwrap();
        for unit in [1.0, 2f64.powi(-60), 2f64.powi(60)] {
            let of = |i: usize| if i < first { 1.0 } else { unit };
            let mut a = a.clone();
            a.pattern = Arc::new(SparsityPattern::clone(&a.pattern).with_first_multiplier(first));
            let (mut row, mut stiffness) = (0f64, 0f64);
            for j in 0..n {
                for k in a.pattern.column_range(j) {
                    let i = a.pattern.row_indices()[k] as usize;
                    a.values[k] *= of(i) * of(j);
                    if j < first {
                        let largest = if i == n - 1 { &mut row } else { &mut stiffness };
                        *largest = largest.max(if i < first || i == n - 1 { a.values[k].abs() } else { 0.0 });
                    }
                }
            }
            let b: Vec<f64> = (0..n).map(|i| of(i) * b[i]).collect();
            let mut off = switched_off(&a, 1);
            let diagonal = a.pattern.position(n as u32 - 1, n as u32 - 1).unwrap();
            off.values[diagonal] = row * row / stiffness;
            let (_, x) = nearby(&mut factorised(&off, kind), &a, &b, 1e-10).expect("near enough");
            let found = difference(&x[..first], &exact[..first]);
            assert!(found < 1e-6, "{kind:?}, unit {unit:e}: {found:e}");
        }
    }
}

#[test]
fn without_factors_that_serve_there_is_none() {
    let (a, b) = system(true);
    let mut fresh = MultifrontalSolver::new();
    assert!(nearby(&mut fresh, &a, &b, 1e-6).is_none(), "nothing analysed");
    fresh.analyse(&a.pattern, MatrixKind::General).unwrap();
    assert!(nearby(&mut fresh, &a, &b, 1e-6).is_none(), "nothing factorised");
    let mut solver = factorised(&a, MatrixKind::General);
    assert!(nearby(&mut solver, &a, &b, 1e-6).is_some());
    assert!(nearby(&mut solver, &disturbed(&a, 3.0), &b, 1e-12).is_none(), "too far");
    solver.forget();
    assert!(nearby(&mut solver, &a, &b, 1e-6).is_none(), "forgotten");
    assert!(matches!(solver.solve(&b, &mut vec![0.0; b.len()]), Err(LinalgError::CallOrder { .. })));
    let off = SolverOptions { max_nearby_iterations: 0, ..SolverOptions::default() };
    let mut solver = AutoSolver::with_options(off);
    solver.analyse(&a.pattern, MatrixKind::General).unwrap();
    solver.factorise(&a.values).unwrap();
    assert!(nearby(&mut solver, &a, &b, 1e-6).is_none(), "not wanted");
    let mut dense = DenseSolver::new();
    dense.analyse(&a.pattern, MatrixKind::General).unwrap();
    assert!(nearby(&mut dense, &a, &b, 1e-6).is_none(), "not offered");
}

#[test]
fn bad_input_is_an_error() {
    let (a, b) = system(true);
    let mut solver = factorised(&a, MatrixKind::General);
    let mut x = vec![0.0; b.len()];
    let error = solver.solve_nearby(&a.values[1..], &b, &mut x, 1e-6).unwrap_err();
    assert!(matches!(error, LinalgError::Length { what: "values", .. }), "{error}");
    let mut spoilt = b.clone();
    spoilt[5] = f64::NAN;
    let error = solver.solve_nearby(&a.values, &spoilt, &mut x, 1e-6).unwrap_err();
    assert!(matches!(error, LinalgError::NonFinite { place: SystemArray::RightHandSide, index: 5 }), "{error}");
}

/// The same bits for any number of threads.
#[test]
fn threads_do_not_show() {
    let (a, b) = system(true);
    let a = Arc::new(a);
    let results = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut solver = factorised(&a, MatrixKind::General);
            nearby(&mut solver, &disturbed(&a, 1e-3), &b, 1e-10).unwrap().1
        })
    });
    assert!(results.iter().all(|r| *r == results[0]));
}
