//! Negative eigenvalues that a factorisation reports, against eigenvalues.

use crate::common::{Random, hex_system, pattern};
use faer::Side;
use proptest::prelude::*;
use stoss_linalg::{AutoSolver, DenseSolver, FaerSolver, LinearSolver, MatrixKind, MultifrontalSolver, SparseMatrix};

fn eigenvalues(a: &SparseMatrix) -> Vec<f64> {
    let dense = faer::Mat::from_fn(a.n(), a.n(), |i, j| a.get(i as u32, j as u32));
    dense.self_adjoint_eigenvalues(Side::Lower).unwrap()
}

/// A random symmetric matrix; rows and columns are scaled together over `2 span` orders of magnitude.
fn random_symmetric(seed: u64, n: usize, diagonal: f64, span: f64) -> SparseMatrix {
    let mut random = Random(seed);
    let stencils: Vec<Vec<u32>> =
        (0..2 * n).map(|_| (0..1 + random.index(5)).map(|_| random.index(n) as u32).collect()).collect();
    let mut a = SparseMatrix::zeros(pattern(n, &stencils));
    let scale: Vec<f64> = (0..n).map(|_| 10f64.powf(span * random.value())).collect();
    for j in 0..n as u32 {
        for i in a.pattern.column(j as usize).to_vec().into_iter().filter(|&i| i >= j) {
            let v = random.value() + if i == j { diagonal * random.value() } else { 0.0 };
            for (r, c) in [(i, j), (j, i)] {
                let k = a.pattern.position(r, c).unwrap();
                a.values[k] = v * scale[i as usize] * scale[j as usize];
            }
        }
    }
    a
}

fn negative(solver: &mut dyn LinearSolver, a: &SparseMatrix, kind: MatrixKind) -> Option<usize> {
    solver.analyse(&a.pattern, kind).unwrap();
    solver.factorise(&a.values).ok()?;
    solver.negative_eigenvalues()
}

proptest! {
    #[test]
    fn negative_eigenvalues_are_counted(
        seed in 1u64.., n in 1usize..120, diagonal in prop_oneof![Just(0.0), Just(3.0)], span in prop_oneof![Just(0.0), Just(2.0)],
    ) {
        let a = random_symmetric(seed, n, diagonal, span);
        // The count of the unscaled matrix is that of the scaled one.
        let plain = random_symmetric(seed, n, diagonal, 0.0);
        let values = eigenvalues(&plain);
        // A matrix that is nearly singular has no number.
        prop_assume!(values.iter().all(|l| l.abs() > 1e-8));
        let expected = values.iter().filter(|l| **l < 0.0).count();
        let mut dense = DenseSolver::new();
        prop_assert_eq!(negative(&mut dense, &a, MatrixKind::Symmetric), Some(expected));
        // Where a front has no pivot, full pivoting takes over, which does not tell.
        let mut multifrontal = MultifrontalSolver::new();
        let found = negative(&mut multifrontal, &a, MatrixKind::Symmetric);
        let fell_back = multifrontal.statistics().pivoting_fallbacks > 0;
        prop_assert!(found == Some(expected) || (found.is_none() && fell_back), "{:?} of {}", found, expected);
        prop_assert_eq!(negative(&mut AutoSolver::new(), &a, MatrixKind::General), None);
        prop_assert_eq!(negative(&mut FaerSolver::new(), &a, MatrixKind::Symmetric), None);
    }
}

/// Constraints on a stable stiffness have as many negative eigenvalues as there are multipliers, and those of an unstable stiffness come on top.
#[test]
fn multipliers_and_instabilities_are_counted() {
    for share in [0.0, 0.05] {
        let (mut a, _) = hex_system(4, share, true);
        let multipliers = (0..a.n()).filter(|&i| a.get(i as u32, i as u32) == 0.0).count();
        assert_eq!(multipliers > 0, share > 0.0);
        let mut solver = MultifrontalSolver::new();
        assert_eq!(negative(&mut solver, &a, MatrixKind::Symmetric), Some(multipliers));
        let values = eigenvalues(&a);
        let between = 0.5 * (values[multipliers + 19] + values[multipliers + 20]);
        for i in 0..(a.n() - multipliers) as u32 {
            let k = a.pattern.position(i, i).unwrap();
            a.values[k] -= between;
        }
        let expected = eigenvalues(&a).iter().filter(|l| **l < 0.0).count();
        assert!(expected > multipliers + 5);
        assert_eq!(negative(&mut solver, &a, MatrixKind::Symmetric), Some(expected));
    }
}
