//! Patterns, scatter maps and products against dense matrices.

use crate::common::{Random, pattern};
use proptest::prelude::*;
use std::sync::Arc;
use stoss_linalg::{LinalgError, NONE, ScatterMap, SparseMatrix, SparsityPattern, vector};

fn stencils() -> impl Strategy<Value = (usize, Vec<Vec<u32>>)> {
    (1usize..25).prop_flat_map(|n| {
        let entry = prop_oneof![4 => 0..n as u32, 1 => Just(NONE)];
        (Just(n), prop::collection::vec(prop::collection::vec(entry, 0..7), 0..20))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn scatter_equals_dense_assembly((n, stencils) in stencils(), seed in 1u64..u64::MAX) {
        let mut random = Random(seed);
        let pattern = pattern(n, &stencils);
        let map = ScatterMap::new(&pattern, stencils.iter().map(Vec::as_slice)).unwrap();
        prop_assert_eq!(map.len(), stencils.len());
        let mut sparse = SparseMatrix::zeros(Arc::clone(&pattern));
        let mut dense = vec![0.0; n * n];
        let mut coupled = vec![false; n * n];
        (0..n).for_each(|i| coupled[i * n + i] = true);
        for (k, s) in stencils.iter().enumerate() {
            let m = s.len();
            let local: Vec<f64> = (0..m * m).map(|_| random.value()).collect();
            map.add(k, &local, &mut sparse.values);
            for i in 0..m {
                for j in 0..m {
                    if s[i] != NONE && s[j] != NONE {
                        let place = s[i] as usize * n + s[j] as usize;
                        dense[place] += local[i * m + j];
                        coupled[place] = true;
                    }
                }
            }
        }
        for i in 0..n {
            for j in 0..n {
                // The same order of additions: the same bits.
                prop_assert_eq!(sparse.get(i as u32, j as u32), dense[i * n + j]);
                prop_assert_eq!(pattern.position(i as u32, j as u32).is_some(), coupled[i * n + j]);
            }
            prop_assert!(pattern.column(i).is_sorted_by(|a, b| a < b));
        }
        // Products and norms against the dense matrix.
        let x: Vec<f64> = (0..n).map(|_| random.value()).collect();
        let (mut y, mut w) = (vec![0.0; n], vec![0.0; n]);
        sparse.multiply(&x, &mut y);
        sparse.row_max(&mut w);
        let rows: Vec<usize> = pattern.row_indices().iter().map(|&row| row as usize).collect();
        let view =
            sprs::CsMatView::try_new_csc((n, n), pattern.column_pointers(), &rows, &sparse.values).unwrap();
        let mut largest = 0.0f64;
        for i in 0..n {
            let row = &dense[i * n..i * n + n];
            let ax: f64 = row.iter().zip(&x).map(|(a, b)| a * b).sum();
            let abs: f64 = row.iter().zip(&x).map(|(a, b)| (a * b).abs()).sum();
            prop_assert!((y[i] - ax).abs() <= 1e-14 * (1.0 + abs));
            prop_assert_eq!(w[i], row.iter().fold(0f64, |m, v| m.max(v.abs())));
            largest = largest.max(row.iter().map(|v| v.abs()).sum());
            for j in 0..n {
                prop_assert_eq!(view.get(i, j).copied().unwrap_or(0.0), dense[i * n + j]);
            }
        }
        prop_assert!((sparse.norm_inf() - largest).abs() <= 1e-14 * largest);
    }

    #[test]
    fn vectors(x in prop::collection::vec(-1e3f64..1e3, 1..50), exponent in -300i32..300) {
        let sum: f64 = x.iter().map(|v| v * v).sum();
        prop_assert!((vector::dot(&x, &x) - sum).abs() <= 1e-13 * sum);
        // The norm is homogeneous where its square would overflow or vanish.
        let factor = 2f64.powi(exponent);
        let scaled: Vec<f64> = x.iter().map(|v| v * factor).collect();
        let norm = vector::norm2(&x);
        prop_assert!((vector::norm2(&scaled) / factor - norm).abs() <= 1e-12 * norm);
        let mut y = scaled.clone();
        vector::axpy(-factor, &x, &mut y);
        prop_assert_eq!(vector::norm_inf(&y), 0.0);
    }
}

#[test]
fn a_nan_is_not_lost_in_a_norm() {
    for x in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
        assert!(vector::norm_inf(&x).is_nan());
        assert!(vector::norm2(&x).is_nan());
        assert!(vector::first_non_finite(&x).is_some());
    }
    assert_eq!(vector::norm2(&[]), 0.0);
}

#[test]
fn wrong_stencils_are_named() {
    let wrong = [vec![0, 1], vec![2, NONE, 5]];
    let error = SparsityPattern::from_stencils(5, wrong.iter().map(Vec::as_slice)).unwrap_err();
    let expected = LinalgError::EquationOutOfRange { stencil: 1, entry: 2, equation: 5, n: 5 };
    assert_eq!(error, expected);
    let p = pattern(5, &[vec![0, 1], vec![2, 3]]);
    let foreign = [vec![0, 1], vec![1, 2]];
    let error = ScatterMap::new(&p, foreign.iter().map(Vec::as_slice)).unwrap_err();
    let expected = LinalgError::EntryNotInPattern { stencil: 1, row: 2, column: 1 };
    assert_eq!(error, expected);
    assert_eq!(p.position(7, 0), None);
    assert_eq!(p.position(0, 7), None);
}
