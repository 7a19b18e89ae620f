//! Ranks that are threads: what they tell each other, and a matrix that is spread over them.

use crate::common::Random;
use proptest::prelude::*;
use std::sync::Arc;
use stoss_linalg::{
    GatheredSolver, LinearSolver, MatrixKind, MultifrontalSolver, ScatterMap, SparsityPattern, Threads,
};

const RANKS: [usize; 4] = [1, 2, 3, 7];

#[test]
fn sums_are_formed_in_the_order_of_the_ranks_and_are_the_same_bits_on_all() {
    for size in RANKS {
        let of = |rank: usize| vec![0.1 * (rank as f64 + 1.0), if rank == 0 { 1e16 } else { 1.0 }];
        let found = Threads::run(size, |ranks| {
            let mut values = of(ranks.rank());
            ranks.sum(&mut values);
            (values, ranks.any(ranks.rank() + 1 == size), ranks.any(false), ranks.sum_of(1.0))
        });
        let expected: Vec<f64> = (0..2).map(|k| (1..size).fold(of(0)[k], |sum, rank| sum + of(rank)[k])).collect();
        assert!(found.iter().all(|of| *of == (expected.clone(), true, false, size as f64)), "{found:?}");
    }
}

#[test]
fn the_text_of_the_first_rank_that_has_one() {
    let texts = Threads::run(3, |ranks| {
        let mine = ["", "b", "c"][ranks.rank()];
        let first = ranks.first_text((ranks.rank() > 0).then_some(mine));
        (first, ranks.first_text(Some("")), ranks.first_text(None))
    });
    assert!(texts.iter().all(|text| *text == (Some("b".to_owned()), Some(String::new()), None)), "{texts:?}");
}

#[test]
fn pieces_are_exchanged_and_counted() {
    for size in RANKS {
        // Rank r sends r + to numbers to each rank, none to the last.
        let count = |from: usize, to: usize| if to + 1 == size { 0 } else { from + to };
        let traffic = Threads::run(size, |ranks| {
            let me = ranks.rank();
            let send: Vec<f64> = (0..size).flat_map(|to| vec![(100 * me + to) as f64; count(me, to)]).collect();
            let counts = |f: &dyn Fn(usize) -> usize| (0..size).map(f).collect::<Vec<_>>();
            let (to, from) = (counts(&|r| count(me, r)), counts(&|r| count(r, me)));
            let mut received = vec![f64::NAN; from.iter().sum()];
            ranks.exchange(&send, &to, &mut received, &from);
            let expected: Vec<f64> = (0..size).flat_map(|r| vec![(100 * r + me) as f64; count(r, me)]).collect();
            assert_eq!(received, expected);
            ranks.traffic()
        });
        for (me, traffic) in traffic.iter().enumerate() {
            let from: Vec<usize> = (0..size).filter(|&r| r != me).map(|r| count(r, me)).collect();
            assert_eq!(traffic.operations, 1);
            assert_eq!(traffic.messages, from.iter().filter(|n| **n > 0).count() as u64);
            assert_eq!(traffic.bytes, 8 * from.iter().sum::<usize>() as u64);
        }
    }
}

/// A rank that panics does not leave the others waiting, and its panic is the one that is told.
#[test]
fn a_rank_that_is_gone_ends_the_others() {
    let result = std::panic::catch_unwind(|| {
        Threads::run(3, |ranks| {
            assert_ne!(ranks.rank(), 1, "the cause");
            ranks.sum_of(1.0)
        })
    });
    let panic = result.unwrap_err();
    assert!(panic.downcast_ref::<String>().unwrap().contains("the cause"));
}

/// Random local matrices, shared out among the ranks: the solution is that of the sum.
fn solutions(seed: u64, size: usize, n: usize) -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut random = Random(seed);
    let chain: Vec<Vec<u32>> = (0..n as u32 - 1).map(|k| vec![k, k + 1]).collect();
    let far = (0..n / 2).map(|_| vec![random.index(n) as u32, random.index(n) as u32]).filter(|s| s[0] != s[1]);
    let stencils: Vec<Vec<u32>> = chain.into_iter().chain(far).collect();
    let owner: Vec<usize> = stencils.iter().map(|_| random.index(size)).collect();
    let local: Vec<[f64; 4]> = stencils.iter().map(|_| [3.0, random.value(), random.value(), 3.0]).collect();
    let rhs: Vec<f64> = (0..n).map(|_| random.value()).collect();
    let solve = |solver: &mut dyn LinearSolver, is_mine: &dyn Fn(usize) -> bool, rank: usize| {
        let empty: &[u32] = &[];
        let mine = |k: usize| if is_mine(k) { &stencils[k][..] } else { empty };
        let lists = || (0..stencils.len()).map(mine);
        let pattern =
            Arc::new(SparsityPattern::from_own_stencils(n, lists(), |e| e % size == rank).expect("a pattern"));
        let map = ScatterMap::new(&pattern, lists()).expect("a map");
        let mut x = vec![0.0; n];
        // Another matrix on the same pattern, then the one that counts.
        for factor in [2.0, 1.0] {
            let mut values = vec![0.0; pattern.nnz()];
            for (k, local) in local.iter().enumerate() {
                map.add(k, &local.map(|v| factor * v), &mut values);
            }
            solver.analyse(&pattern, MatrixKind::General).expect("an analysis");
            solver.factorise(&values).expect("factors");
            solver.solve(&rhs, &mut x).expect("a solution");
        }
        x
    };
    let whole = solve(&mut MultifrontalSolver::new(), &|_| true, 0);
    let spread = Threads::run(size, |ranks| {
        let rank = ranks.rank();
        let mut solver = GatheredSolver::new(ranks, Box::new(MultifrontalSolver::new()));
        solve(&mut solver, &|k| owner[k] == rank, rank)
    });
    (spread, whole)
}

proptest! {
    #[test]
    fn a_matrix_that_is_spread_over_ranks_is_solved_as_their_sum(seed in any::<u64>(), ranks in 0..4_usize, n in 2..40_usize) {
        let (spread, whole) = solutions(seed, RANKS[ranks], n);
        for x in &spread {
            prop_assert_eq!(x, &spread[0]);
            for (a, b) in x.iter().zip(&whole) {
                prop_assert!((a - b).abs() <= 1e-10 * (1.0 + b.abs()), "{} {}", a, b);
            }
        }
    }
}
