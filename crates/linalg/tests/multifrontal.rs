//! The multifrontal solver on what it is for: saddle points of contact, badly scaled ones, and on what its pivoting cannot do.

use crate::common::tangents::{Setting, block_pair, tori};
use crate::common::{Random, pattern};
use proptest::prelude::*;
use std::sync::Arc;
use stoss_linalg::{
    DenseSolver, FaerSolver, LinalgError, LinearSolver, MatrixKind, MultifrontalSolver, SparseMatrix, SparsityPattern,
};

/// `max_i |b - A x|_i / (|A| |x| + |b|)_i`, by loops over the columns and without the program's own measure.
fn backward_error(a: &SparseMatrix, x: &[f64], b: &[f64]) -> f64 {
    let (mut r, mut d) = (b.to_vec(), b.iter().map(|v| v.abs()).collect::<Vec<_>>());
    for j in 0..a.n() {
        for k in a.pattern.column_range(j) {
            let i = a.pattern.row_indices()[k] as usize;
            r[i] -= a.values[k] * x[j];
            d[i] += (a.values[k] * x[j]).abs();
        }
    }
    r.iter().zip(&d).map(|(r, d)| if *r == 0.0 { 0.0 } else { r.abs() / d }).fold(0.0, f64::max)
}

fn solve(
    solver: &mut dyn LinearSolver,
    a: &SparseMatrix,
    kind: MatrixKind,
    b: &[f64],
) -> Result<Vec<f64>, LinalgError> {
    let mut x = vec![f64::NAN; b.len()];
    solver.analyse(&a.pattern, kind)?;
    solver.factorise(&a.values)?;
    solver.solve(b, &mut x)?;
    Ok(x)
}

/// Values announced as symmetric that are not: the answer is right all the same, by the fallback.
#[test]
fn a_wrong_announcement_costs_time_only() {
    let (a, b) = block_pair(6, Setting::new(true));
    let (symmetric, _) = block_pair(6, Setting::new(false));
    assert!(a.pattern.asymmetry(&a.values) > 1e-3);
    assert!(symmetric.pattern.asymmetry(&symmetric.values) < 1e-12);
    let mut solver = MultifrontalSolver::new();
    let x = solve(&mut solver, &a, MatrixKind::Symmetric, &b).unwrap();
    assert!(backward_error(&a, &x, &b) <= 1e-13);
    assert_eq!(solver.statistics().pivoting_fallbacks, 1);
}

/// The matrix with the same pattern without groups.
fn ungrouped(a: &SparseMatrix) -> SparseMatrix {
    let pairs: Vec<[u32; 2]> =
        (0..a.n()).flat_map(|j| a.pattern.column(j).iter().map(move |&i| [i, j as u32]).collect::<Vec<_>>()).collect();
    let pattern = SparsityPattern::from_stencils(a.n(), pairs.iter().map(|p| &p[..])).unwrap();
    SparseMatrix { pattern: Arc::new(pattern), values: a.values.clone() }
}

/// Contact of small bodies, all settings: backward error, no fallback, and the solution of an independent solver.
#[test]
fn saddle_points_of_contact() {
    let soft = Setting::new(false);
    let bad = Setting { contrast: 1e6, penalty: 1e7, inertia: 1.0, ..soft };
    let systems = [
        tori([16, 8, 2], 24, soft),
        tori([16, 8, 2], 24, Setting { unsymmetric: true, ..soft }),
        block_pair(6, soft),
        block_pair(6, Setting { unsymmetric: true, ..soft }),
        block_pair(6, bad),
        block_pair(6, Setting { unsymmetric: true, ..bad }),
    ];
    for (s, (a, b)) in systems.iter().enumerate() {
        let kinds =
            if s % 2 == 0 { vec![MatrixKind::General, MatrixKind::Symmetric] } else { vec![MatrixKind::General] };
        for kind in kinds {
            for a in [a, &ungrouped(a)] {
                let mut solver = MultifrontalSolver::new();
                let x = solve(&mut solver, a, kind, b).unwrap();
                let error = backward_error(a, &x, b);
                assert!(error <= 1e-13, "system {s} {kind:?}: {error:e}");
                assert_eq!(solver.statistics().pivoting_fallbacks, 0, "system {s} {kind:?}");
                if s < 4 {
                    let reference = solve(&mut FaerSolver::new(), a, MatrixKind::General, b).unwrap();
                    let size = reference.iter().fold(0f64, |m, v| m.max(v.abs()));
                    let difference = x.iter().zip(&reference).fold(0f64, |m, (p, q)| m.max((p - q).abs()));
                    assert!(difference <= 1e-8 * size, "system {s} {kind:?}: {difference:e} of {size:e}");
                }
            }
        }
    }
}

/// Same bits for any number of threads, by tasks and by one.
#[test]
fn threads_do_not_show() {
    for (unsymmetric, kind) in [(true, MatrixKind::General), (false, MatrixKind::Symmetric)] {
        let (a, b) = block_pair(12, Setting::new(unsymmetric));
        let mut results = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let x = pool.install(|| solve(&mut MultifrontalSolver::new(), &a, kind, &b)).unwrap();
            x.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
        });
        let first = std::mem::take(&mut results[0]);
        assert!(results[1..].iter().all(|r| *r == first), "{kind:?}");
    }
}

/// Storage outlives the analysis: what another matrix of another kind left in it is not read.
#[test]
fn left_over_storage_is_not_read() {
    let mut used = MultifrontalSolver::new();
    for (size, kind) in
        [(8, MatrixKind::General), (6, MatrixKind::Symmetric), (9, MatrixKind::Symmetric), (5, MatrixKind::Symmetric)]
    {
        let (a, b) = block_pair(size, Setting::new(false));
        let fresh = solve(&mut MultifrontalSolver::new(), &a, kind, &b).unwrap();
        assert_eq!(solve(&mut used, &a, kind, &b).unwrap(), fresh, "{size} {kind:?}");
        used.forget();
    }
}

/// The order is that of the pattern at hand, not of one that has grown to it.
#[test]
fn a_pattern_that_has_grown_leaves_no_trace() {
    let (small, b) = tori([12, 6, 1], 8, Setting::new(true));
    let (large, c) = tori([12, 6, 1], 16, Setting::new(true));
    assert!(large.n() > small.n());
    let mut used = MultifrontalSolver::new();
    solve(&mut used, &small, MatrixKind::General, &b).unwrap();
    let grown = solve(&mut used, &large, MatrixKind::General, &c).unwrap();
    assert_eq!(grown, solve(&mut MultifrontalSolver::new(), &large, MatrixKind::General, &c).unwrap());
}

/// The bits do not depend on which patterns and values were seen before.
#[test]
fn history_does_not_show() {
    let (a, b) = tori([12, 6, 1], 8, Setting::new(true));
    let a = ungrouped(&a);
    let (other, c) = tori([12, 6, 1], 9, Setting::new(true));
    let fresh = solve(&mut MultifrontalSolver::new(), &a, MatrixKind::General, &b).unwrap();
    let mut used = MultifrontalSolver::new();
    solve(&mut used, &other, MatrixKind::General, &c).unwrap();
    // Multipliers replaced by identity rows, then the real values.
    let mut inactive = a.clone();
    for j in 0..a.n() {
        for k in a.pattern.column_range(j) {
            let i = a.pattern.row_indices()[k] as usize;
            if i.max(j) >= a.n() - 24 {
                inactive.values[k] = if i == j { 1.0 } else { 0.0 };
            }
        }
    }
    solve(&mut used, &inactive, MatrixKind::General, &b).unwrap();
    used.forget();
    let again = solve(&mut used, &a, MatrixKind::General, &b).unwrap();
    assert!(again.iter().zip(&fresh).all(|(p, q)| p.to_bits() == q.to_bits()));
}

/// Two multipliers for the same constraint: singular, and named so.
#[test]
fn redundant_constraints_are_singular() {
    let (a, b) = block_pair(4, Setting::new(true));
    let n = a.n();
    // The last multiplier repeats the one before it.
    let mut stencils: Vec<Vec<u32>> =
        (0..n).flat_map(|j| a.pattern.column(j).iter().map(move |&i| vec![i, j as u32]).collect::<Vec<_>>()).collect();
    let (last, copy) = (n - 1, n);
    stencils.extend(a.pattern.column(last).iter().map(|&i| vec![i, copy as u32]));
    let mut doubled = SparseMatrix::zeros(pattern(n + 1, &stencils));
    let mut set = |i: usize, j: usize, v: f64| {
        let k = doubled.pattern.position(i as u32, j as u32).unwrap();
        doubled.values[k] = v;
    };
    for j in 0..n {
        for k in a.pattern.column_range(j) {
            let (i, v) = (a.pattern.row_indices()[k] as usize, a.values[k]);
            set(i, j, v);
            if j == last && i != last {
                set(i, copy, v);
            }
            if i == last && j != last {
                set(copy, j, v);
            }
        }
    }
    let result = solve(&mut MultifrontalSolver::new(), &doubled, MatrixKind::General, &[&b[..], &[0.0]].concat());
    assert!(matches!(result, Err(LinalgError::Singular { .. })), "{result:?}");
}

fn set(a: &mut SparseMatrix, entries: &[(u32, u32, f64)]) {
    for &(i, j, v) in entries {
        let k = a.pattern.position(i, j).unwrap();
        a.values[k] = v;
    }
}

/// A multiplier in the group of a node that it does not touch joins another one.
#[test]
fn a_wrong_group_is_repaired() {
    let stencils: Vec<Vec<u32>> = vec![vec![0, 1], vec![1, 2], vec![2, 3]];
    let pattern = (*pattern(4, &stencils)).clone().with_groups(vec![0, 1, 2, 0]).unwrap();
    let mut a = SparseMatrix::zeros(Arc::new(pattern));
    set(&mut a, &[(0, 0, 4.0), (1, 1, 5.0), (2, 2, 6.0), (0, 1, 1.0), (1, 0, 2.0), (1, 2, 1.0), (2, 1, 3.0)]);
    set(&mut a, &[(2, 3, 1.0), (3, 2, 1.0)]);
    let b = [1.0, -2.0, 3.0, 0.5];
    let mut solver = MultifrontalSolver::new();
    let x = solve(&mut solver, &a, MatrixKind::General, &b).unwrap();
    assert!(backward_error(&a, &x, &b) <= 1e-13);
    assert_eq!(solver.statistics().pivoting_fallbacks, 0);
    let reference = solve(&mut DenseSolver::new(), &a, MatrixKind::General, &b).unwrap();
    assert!(x.iter().zip(&reference).all(|(p, q)| (p - q).abs() < 1e-12));
}

/// A cyclic permutation: nothing on the diagonal and, in a front of a part of the equations, no regular block. Full pivoting solves it, and
/// is counted; the next, harmless matrix needs it no more.
#[test]
fn a_permutation_falls_back() {
    let n = 400u32;
    let stencils: Vec<Vec<u32>> = (0..n).map(|i| vec![i, (i + 1) % n]).collect();
    let mut a = SparseMatrix::zeros(pattern(n as usize, &stencils));
    for i in 0..n {
        set(&mut a, &[(i, (i + 1) % n, 1.0)]);
    }
    let b: Vec<f64> = (0..n).map(|i| f64::from(i) - 7.5).collect();
    let mut solver = MultifrontalSolver::new();
    let x = solve(&mut solver, &a, MatrixKind::General, &b).unwrap();
    assert!((0..n as usize).all(|i| x[(i + 1) % n as usize] == b[i]));
    assert_eq!(solver.statistics().pivoting_fallbacks, 1);
    for i in 0..n {
        set(&mut a, &[(i, i, 3.0)]);
    }
    let x = solve(&mut solver, &a, MatrixKind::General, &b).unwrap();
    assert!(backward_error(&a, &x, &b) <= 1e-13);
    assert_eq!(solver.statistics().pivoting_fallbacks, 1);
}

/// An entry of size `10^exponent` in a random band on a random sparse symmetric pattern with a zero block.
fn random_saddle(seed: u64, n: usize, m: usize, span: f64, symmetric: bool) -> SparseMatrix {
    let mut random = Random(seed);
    let mut stencils: Vec<Vec<u32>> =
        (0..2 * n).map(|_| (0..1 + random.index(5)).map(|_| random.index(n) as u32).collect()).collect();
    for l in 0..m {
        let mut s = vec![l as u32, (n + l) as u32];
        s.extend((0..3).map(|_| random.index(n) as u32));
        stencils.push(s);
    }
    let mut a = SparseMatrix::zeros(pattern(n + m, &stencils));
    let scale: Vec<f64> = (0..n + m).map(|_| 10f64.powf(span * random.value())).collect();
    for j in 0..n + m {
        for k in a.pattern.column_range(j) {
            let i = a.pattern.row_indices()[k] as usize;
            if symmetric && i < j {
                let mirror = a.pattern.position(j as u32, i as u32).unwrap();
                a.values[k] = a.values[mirror];
                continue;
            }
            let v = match (i < n, j < n) {
                (true, true) if i == j => 10.0,
                (true, true) => 0.3 * random.value(),
                (false, false) => 0.0,
                _ if i % n == j % n => 2.0,
                _ => 0.2 * random.value(),
            };
            a.values[k] = v * scale[i] * scale[j];
        }
    }
    a
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    /// Entries over twelve orders of magnitude and more, against dense LU with full columns.
    #[test]
    fn badly_scaled_saddle_points(seed in 1u64..u64::MAX, n in 4usize..160, share in 0.0..0.4, span in 0.0..6.0, symmetric: bool) {
        let m = (n as f64 * share) as usize;
        let a = random_saddle(seed, n, m, span, symmetric);
        let mut random = Random(seed ^ 0x55);
        let x: Vec<f64> = (0..n + m).map(|_| 1.0 + 0.5 * random.value()).collect();
        let mut b = vec![0.0; n + m];
        a.multiply(&x, &mut b);
        let kinds = if symmetric { vec![MatrixKind::Symmetric, MatrixKind::General] } else { vec![MatrixKind::General] };
        for kind in kinds {
            let mut solver = MultifrontalSolver::new();
            let x = solve(&mut solver, &a, kind, &b).unwrap();
            let error = backward_error(&a, &x, &b);
            prop_assert!(error <= 1e-13, "{:?}: {:e}, {:?}", kind, error, solver.statistics());
        }
    }
}
