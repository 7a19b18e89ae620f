//! The battery of every linear solver: what is promised in the trait, on random systems.

use crate::common::{Random, hex_system, pattern};
use proptest::prelude::*;
use std::sync::Arc;
use stoss_linalg::{
    AutoSolver, DenseSolver, FaerSolver, LinalgError, LinearSolver, MatrixKind, MultifrontalSolver, SparseMatrix,
    SystemArray,
};

fn solvers() -> Vec<Box<dyn LinearSolver>> {
    vec![
        Box::new(FaerSolver::new()),
        Box::new(DenseSolver::new()),
        Box::new(MultifrontalSolver::new()),
        Box::new(AutoSolver::new()),
    ]
}

/// `max_i |b - A x|_i / (|A| |x| + |b|)_i`, by dense loops and without the program's own measure.
fn backward_error(a: &SparseMatrix, x: &[f64], b: &[f64]) -> f64 {
    let n = b.len() as u32;
    (0..n)
        .map(|i| {
            let (mut r, mut d) = (b[i as usize], b[i as usize].abs());
            for j in 0..n {
                let v = a.get(i, j);
                r -= v * x[j as usize];
                d += (v * x[j as usize]).abs();
            }
            if r == 0.0 { 0.0 } else { r.abs() / d }
        })
        .fold(0.0, |m: f64, v| if v.is_nan() { f64::NAN } else { m.max(v) })
}

/// Random couplings of `count` groups of up to five equations.
fn random_stencils(random: &mut Random, n: usize, count: usize) -> Vec<Vec<u32>> {
    (0..count).map(|_| (0..1 + random.index(5)).map(|_| random.index(n) as u32).collect()).collect()
}

/// A random matrix: unsymmetric with a random diagonal (`General`), symmetric, or diagonally dominant symmetric.
fn random_matrix(random: &mut Random, n: usize, kind: MatrixKind) -> SparseMatrix {
    let stencils = random_stencils(random, n, 2 * n);
    let mut a = SparseMatrix::zeros(pattern(n, &stencils));
    for j in 0..n as u32 {
        let rows: Vec<u32> = a.pattern.column(j as usize).to_vec();
        for i in rows {
            let symmetric = kind != MatrixKind::General;
            if symmetric && i < j {
                continue;
            }
            let v = random.value() + if i == j { 3.0 * random.value().signum() } else { 0.0 };
            for (r, c) in [(i, j), (j, i)] {
                if symmetric || (r, c) == (i, j) {
                    let k = a.pattern.position(r, c).unwrap();
                    a.values[k] = v;
                }
            }
        }
    }
    if kind == MatrixKind::SymmetricPositiveDefinite {
        for j in 0..n as u32 {
            let sum: f64 = a.pattern.column(j as usize).iter().map(|&i| a.get(i, j).abs()).sum();
            let k = a.pattern.position(j, j).unwrap();
            a.values[k] = sum + 0.1;
        }
    }
    a
}

/// Rows and columns multiplied by factors between `10^-span` and `10^span`. Returns those of the columns.
fn rescale(a: &mut SparseMatrix, random: &mut Random, span: f64) -> Vec<f64> {
    let n = a.n();
    let factor = |r: &mut Random| 10f64.powf(span * r.value());
    let rows: Vec<f64> = (0..n).map(|_| factor(random)).collect();
    let columns: Vec<f64> = (0..n).map(|_| factor(random)).collect();
    for j in 0..n {
        for k in a.pattern.column_range(j) {
            a.values[k] *= rows[a.pattern.row_indices()[k] as usize] * columns[j];
        }
    }
    columns
}

/// `[K B; C 0]`: `m` multipliers, each coupled with the displacement that only it owns and some others.
fn saddle_point(random: &mut Random, n: usize, m: usize, stiffness: f64, symmetric: bool) -> SparseMatrix {
    let mut stencils = random_stencils(random, n, 2 * n);
    for l in 0..m {
        let mut s = vec![l as u32, (n + l) as u32];
        s.extend((0..3).map(|_| random.index(n) as u32));
        stencils.push(s);
    }
    let mut a = SparseMatrix::zeros(pattern(n + m, &stencils));
    for j in 0..n + m {
        for k in a.pattern.column_range(j) {
            let i = a.pattern.row_indices()[k] as usize;
            let v = random.value();
            a.values[k] = match (i < n, j < n) {
                (true, true) if i == j => stiffness * 10.0,
                (true, true) => stiffness * 0.3 * v,
                (false, false) => 0.0,
                (_, _) if i % n == j % n => 2.0,
                (_, _) => 0.2 * v,
            };
        }
    }
    if symmetric {
        for j in 0..(n + m) as u32 {
            let rows: Vec<u32> = a.pattern.column(j as usize).to_vec();
            for i in rows.into_iter().filter(|&i| i < j) {
                let (p, q) = (a.pattern.position(i, j).unwrap(), a.pattern.position(j, i).unwrap());
                a.values[p] = a.values[q];
            }
        }
    }
    a
}

/// Solves for a known solution of which no entry is tiny (in units of `1 / columns`), so that no row's denominator is.
fn check(a: &SparseMatrix, kind: MatrixKind, random: &mut Random, columns: &[f64]) -> Result<(), TestCaseError> {
    let n = a.n();
    let exact: Vec<f64> = (0..n)
        .map(|j| {
            let v = random.value();
            (v + 0.5 * v.signum()) / columns.get(j).unwrap_or(&1.0)
        })
        .collect();
    let mut b = vec![0.0; n];
    a.multiply(&exact, &mut b);
    for mut solver in solvers() {
        let mut x = vec![f64::NAN; n];
        solver.analyse(&a.pattern, kind).unwrap();
        solver.factorise(&a.values).unwrap();
        let report = solver.solve(&b, &mut x).unwrap();
        let error = backward_error(a, &x, &b);
        prop_assert!(error <= 1e-13, "{}: {error:e} {report:?}", solver.name());
        // With zeros in the right-hand side, rows whose exact terms vanish hold nothing but round-off; the solver has to
        // tell them from a bad solution.
        let sparse: Vec<f64> = b.iter().map(|v| if random.value() > 0.0 { *v } else { 0.0 }).collect();
        let report = solver.solve(&sparse, &mut x).unwrap();
        prop_assert!(report.backward_error <= 1e-13, "{}: {report:?}", solver.name());
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn unsymmetric(seed in 1u64..u64::MAX, n in 1usize..120) {
        let mut random = Random(seed);
        let a = random_matrix(&mut random, n, MatrixKind::General);
        check(&a, MatrixKind::General, &mut random, &[])?;
    }

    #[test]
    fn symmetric_positive_definite(seed in 1u64..u64::MAX, n in 1usize..200) {
        let mut random = Random(seed);
        let kind = MatrixKind::SymmetricPositiveDefinite;
        let a = random_matrix(&mut random, n, kind);
        check(&a, kind, &mut random, &[])?;
    }

    #[test]
    fn indefinite_but_announced_as_positive(seed in 1u64..u64::MAX, n in 2usize..120) {
        let mut random = Random(seed);
        let mut a = random_matrix(&mut random, n, MatrixKind::SymmetricPositiveDefinite);
        let k = a.pattern.position(1, 1).unwrap();
        a.values[k] = -a.values[k];
        check(&a, MatrixKind::SymmetricPositiveDefinite, &mut random, &[])?;
        let mut solver = FaerSolver::new();
        solver.analyse(&a.pattern, MatrixKind::SymmetricPositiveDefinite).unwrap();
        solver.factorise(&a.values).unwrap();
        prop_assert_eq!(solver.statistics().indefinite_fallbacks, 1);
    }

    #[test]
    fn saddle_points(seed in 1u64..u64::MAX, n in 4usize..150, share in 0.0..0.5, exponent in -3i32..7, symmetric: bool) {
        let mut random = Random(seed);
        let m = (n as f64 * share) as usize;
        let a = saddle_point(&mut random, n, m, 10f64.powi(exponent), symmetric);
        let kind = if symmetric { MatrixKind::Symmetric } else { MatrixKind::General };
        check(&a, kind, &mut random, &[])?;
    }

    #[test]
    fn badly_scaled(seed in 1u64..u64::MAX, n in 2usize..100, saddle: bool) {
        let mut random = Random(seed);
        let mut a = if saddle && n > 4 {
            saddle_point(&mut random, n, n / 4, 1e3, false)
        } else {
            random_matrix(&mut random, n, MatrixKind::General)
        };
        // Entries between 1e-8 and 1e8.
        let columns = rescale(&mut a, &mut random, 4.0);
        check(&a, MatrixKind::General, &mut random, &columns)?;
    }

    #[test]
    fn exactly_and_numerically_singular(seed in 1u64..u64::MAX, n in 3usize..150, how in 0usize..3) {
        let mut random = Random(seed);
        let mut a = random_matrix(&mut random, n, MatrixKind::SymmetricPositiveDefinite);
        let p = Arc::clone(&a.pattern);
        match how {
            // A row of zeros.
            0 => (0..p.nnz()).filter(|&k| p.row_indices()[k] == 1).for_each(|k| a.values[k] = 0.0),
            // A column of zeros.
            1 => p.column_range(n / 2).for_each(|k| a.values[k] = 0.0),
            // Every row sums to zero: a free-floating body. The zero pivot is spoilt by round-off.
            _ => for j in 0..n as u32 {
                let off: f64 = p.column(j as usize).iter().copied().filter(|&i| i != j)
                    .map(|i| { let v = -a.get(i, j).abs(); a.values[p.position(i, j).unwrap()] = v; v }).sum();
                a.values[p.position(j, j).unwrap()] = -off;
            },
        }
        for mut solver in solvers() {
            for kind in [MatrixKind::General, MatrixKind::SymmetricPositiveDefinite] {
                solver.analyse(&a.pattern, kind).unwrap();
                let result = solver.factorise(&a.values);
                let singular = matches!(result, Err(LinalgError::Singular { .. }));
                prop_assert!(singular, "{}: {result:?}", solver.name());
                // After an error there is no factorisation.
                let call_order = matches!(solver.solve(&vec![1.0; n], &mut vec![0.0; n]), Err(LinalgError::CallOrder { .. }));
                prop_assert!(call_order);
            }
        }
    }
}

#[test]
fn known_solution_of_a_mesh() {
    for (share, symmetric) in [(0.0, true), (0.0, false), (0.03, true), (0.03, false)] {
        let (a, _) = hex_system(5, share, symmetric);
        let n = a.n();
        let exact: Vec<f64> = (0..n).map(|i| 1.0 + (i as f64 * 0.7).sin()).collect();
        let mut b = vec![0.0; n];
        a.multiply(&exact, &mut b);
        let spd = symmetric && share == 0.0;
        let kind = if spd { MatrixKind::SymmetricPositiveDefinite } else { MatrixKind::General };
        for mut solver in solvers() {
            let mut x = vec![0.0; n];
            solver.analyse(&a.pattern, kind).unwrap();
            solver.factorise(&a.values).unwrap();
            solver.solve(&b, &mut x).unwrap();
            let error = x.iter().zip(&exact).fold(0f64, |m, (p, q)| m.max((p - q).abs()));
            assert!(error < 1e-9, "{}: {error:e}", solver.name());
            assert!(solver.memory_bytes() > 8 * a.pattern.nnz());
            assert_eq!(solver.statistics().indefinite_fallbacks, 0);
        }
    }
}

/// Symbolic work once per pattern, numbers of calls as they were made.
#[test]
fn the_analysis_is_cached() {
    let (a, b) = hex_system(3, 0.03, false);
    let mut x = vec![0.0; a.n()];
    for mut solver in solvers() {
        for k in 0..3 {
            solver.analyse(&a.pattern, MatrixKind::General).unwrap();
            // An equal pattern at another place is the same pattern.
            solver.analyse(&Arc::new((*a.pattern).clone()), MatrixKind::General).unwrap();
            let values: Vec<f64> = a.values.iter().map(|v| v * (1.0 + k as f64)).collect();
            solver.factorise(&values).unwrap();
            solver.solve(&b, &mut x).unwrap();
            solver.solve(&b, &mut x).unwrap();
        }
        let s = solver.statistics();
        assert_eq!((s.analyses, s.factorisations, s.solves), (1, 3, 6), "{}", solver.name());
        let (other, _) = hex_system(2, 0.0, false);
        solver.analyse(&other.pattern, MatrixKind::General).unwrap();
        assert_eq!(solver.statistics().analyses, 2);
    }
}

/// The same bits from a fresh solver, from a used one, and inside thread pools of any size.
#[test]
fn bits_do_not_depend_on_history_or_threads() {
    let (a, b) = hex_system(6, 0.03, false);
    let n = a.n();
    let run = |solver: &mut dyn LinearSolver| {
        let mut x = vec![0.0; n];
        solver.analyse(&a.pattern, MatrixKind::General).unwrap();
        solver.factorise(&a.values).unwrap();
        solver.solve(&b, &mut x).unwrap();
        x.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
    };
    for k in 0..solvers().len() {
        let first = run(solvers()[k].as_mut());
        let mut used = solvers().swap_remove(k);
        let scaled: Vec<f64> = a.values.iter().map(|v| 3.0 * v).collect();
        used.analyse(&a.pattern, MatrixKind::General).unwrap();
        used.factorise(&scaled).unwrap();
        assert_eq!(run(used.as_mut()), first);
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| run(solvers()[k].as_mut())), first, "{threads} threads");
        }
    }
}

#[test]
fn wrong_input_is_named() {
    let (a, b) = hex_system(2, 0.0, false);
    let n = a.n();
    let mut x = vec![0.0; n];
    for mut solver in solvers() {
        assert!(matches!(solver.factorise(&a.values), Err(LinalgError::CallOrder { .. })));
        assert!(matches!(solver.solve(&b, &mut x), Err(LinalgError::CallOrder { .. })));
        solver.analyse(&a.pattern, MatrixKind::General).unwrap();
        assert!(matches!(solver.solve(&b, &mut x), Err(LinalgError::CallOrder { .. })));
        assert!(matches!(solver.factorise(&a.values[1..]), Err(LinalgError::Length { .. })));
        let mut bad = a.values.clone();
        bad[7] = f64::NAN;
        let expected = LinalgError::NonFinite { place: SystemArray::Matrix, index: 7 };
        assert_eq!(solver.factorise(&bad), Err(expected));
        solver.factorise(&a.values).unwrap();
        let mut bad = b.clone();
        bad[3] = f64::INFINITY;
        let expected = LinalgError::NonFinite { place: SystemArray::RightHandSide, index: 3 };
        assert_eq!(solver.solve(&bad, &mut x), Err(expected));
        assert!(matches!(solver.solve(&b, &mut x[1..]), Err(LinalgError::Length { .. })));
        solver.solve(&b, &mut x).unwrap();
    }
}

#[test]
fn the_empty_system_is_solved() {
    let empty = pattern(0, &[]);
    for mut solver in solvers() {
        solver.analyse(&empty, MatrixKind::General).unwrap();
        solver.factorise(&[]).unwrap();
        let report = solver.solve(&[], &mut []).unwrap();
        assert_eq!(report.backward_error, 0.0);
    }
}

/// The singular equation is named: a second body that nothing holds.
#[test]
fn a_body_that_nothing_holds_is_found() {
    let stencils: Vec<Vec<u32>> = (0..40).filter(|&i| i != 19).map(|i| vec![i, i + 1]).collect();
    let mut a = SparseMatrix::zeros(pattern(41, &stencils));
    for s in &stencils {
        for (r, c, v) in [(0, 0, 1.0), (1, 1, 1.0), (0, 1, -1.0), (1, 0, -1.0)] {
            let k = a.pattern.position(s[r], s[c]).unwrap();
            a.values[k] += v * 1e3;
        }
    }
    // The first chain, 0..=19, is held at its end; the second, 20..=40, is not.
    a.values[0] += 1e3;
    for mut solver in solvers() {
        solver.analyse(&a.pattern, MatrixKind::General).unwrap();
        match solver.factorise(&a.values) {
            Err(LinalgError::Singular { row: Some(row) }) => assert!(row >= 20, "{row}"),
            other => panic!("{other:?}"),
        }
    }
}

/// A free-floating mesh whose zero pivot is spoilt by the round-off of a thousand eliminations.
#[test]
fn a_free_mesh_is_singular() {
    let m = 12u32;
    let node = |i, j, k| i + m * (j + m * k);
    let mut stencils = Vec::new();
    for k in 0..m - 1 {
        for j in 0..m - 1 {
            for i in 0..m - 1 {
                stencils.push((0..8).map(|c| node(i + c % 2, j + c / 2 % 2, k + c / 4)).collect::<Vec<_>>());
            }
        }
    }
    let n = m * m * m;
    let mut a = SparseMatrix::zeros(pattern(n as usize, &stencils));
    let mut random = Random(3);
    for s in &stencils {
        for p in 0..8 {
            for q in 0..p {
                let v = 1e5 * (1.1 + random.value());
                for (r, c, v) in [(p, p, v), (q, q, v), (p, q, -v), (q, p, -v)] {
                    let k = a.pattern.position(s[r], s[c]).unwrap();
                    a.values[k] += v;
                }
            }
        }
    }
    for kind in [MatrixKind::General, MatrixKind::SymmetricPositiveDefinite] {
        let mut solver = FaerSolver::new();
        solver.analyse(&a.pattern, kind).unwrap();
        assert!(matches!(solver.factorise(&a.values), Err(LinalgError::Singular { .. })));
        // A soft spring on one node makes it regular.
        let mut held = a.values.clone();
        held[0] += 1e-2;
        solver.factorise(&held).unwrap();
    }
}
