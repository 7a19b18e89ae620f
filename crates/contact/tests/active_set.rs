//! The rule on linear complementarity problems with known solutions, thresholds, cycling.

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use stoss_contact::active_set::{ActiveSetTolerance, update};
use stoss_contact::{ActiveSetControl, ActiveSetOutcome};

const EXACT: ActiveSetTolerance = ActiveSetTolerance { gap: 0.0, pressure: 0.0 };

/// Pressures with `g_s = 0` on the active slots and `p_s = 0` elsewhere, and the gaps `g = g_0 + A p`.
fn solve(a: &DMatrix<f64>, g_0: &DVector<f64>, active: &[bool]) -> (DVector<f64>, DVector<f64>) {
    let n = g_0.len();
    let both = |i: usize, j: usize| active[i] && active[j];
    let matrix = DMatrix::from_fn(n, n, |i, j| if both(i, j) { a[(i, j)] } else { f64::from(u8::from(i == j)) });
    let right = DVector::from_fn(n, |s, _| if active[s] { -g_0[s] } else { 0.0 });
    let p = matrix.lu().solve(&right).expect("regular");
    let mut g = g_0 + a * &p;
    (0..n).filter(|&s| active[s]).for_each(|s| g[s] = 0.0);
    (p, g)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Symmetric M-matrices (springs between the nodes), for which the primal-dual method is known to converge; the solution
    /// comes from trying all sets.
    #[test]
    fn solves_complementarity_problems(
        springs in proptest::collection::vec(0.01..1.0f64, 25), g_0 in proptest::collection::vec(-1.0..1.0f64, 5),
        start in proptest::collection::vec(any::<bool>(), 5), c in 0.1..10.0f64,
    ) {
        let n = 5;
        let off = DMatrix::from_fn(n, n, |i, j| if i == j { 0.0 } else { springs[n * i.min(j) + i.max(j)] });
        let diagonal = DMatrix::from_diagonal(&DVector::from_fn(n, |i, _| off.row(i).sum() + 0.1));
        let a = diagonal - off;
        let g_0 = DVector::from_vec(g_0);

        let mut control = ActiveSetControl::new(ActiveSetTolerance::for_length_scale(1.0));
        let mut active = start;
        let mut rounds = 0;
        loop {
            let (p, g) = solve(&a, &g_0, &active);
            match control.propose(&mut active, p.as_slice(), g.as_slice(), &vec![c; n]) {
                ActiveSetOutcome::Unchanged => break,
                ActiveSetOutcome::Changed { activated, released } => prop_assert!(activated + released > 0),
                ActiveSetOutcome::Union { .. } | ActiveSetOutcome::Cycling => prop_assert!(false, "cycling"),
            }
            rounds += 1;
            prop_assert!(rounds <= 20);
        }
        let solution = (0..1u32 << n)
            .map(|bits| (0..n).map(|s| bits >> s & 1 == 1).collect::<Vec<bool>>())
            .filter(|set| {
                let (p, g) = solve(&a, &g_0, set);
                p.iter().all(|p| *p >= 0.0) && g.iter().all(|g| *g >= 0.0)
            })
            .map(|set| solve(&a, &g_0, &set).0)
            .next().expect("an M-matrix problem has a solution");
        let (p, _) = solve(&a, &g_0, &active);
        prop_assert!((p - solution).norm() < 1e-8);
    }

    #[test]
    fn rule_is_the_sign_of_p_minus_c_gamma(p in -1.0..1.0f64, gamma in -1.0..1.0f64, c in 0.1..10.0f64) {
        let mut proposed = [false];
        // Closed slots follow the complementarity function, open ones (p = 0) the sign of the gap.
        update(&[true], &[p], &[gamma], &[c], EXACT, &mut proposed);
        prop_assert_eq!(proposed[0], p - c * gamma > 0.0);
        update(&[false], &[0.0], &[gamma], &[c], EXACT, &mut proposed);
        prop_assert_eq!(proposed[0], gamma < 0.0);
    }
}

#[test]
fn boundary_cases() {
    let mut proposed = [true; 4];
    let counts = update(
        &[true, false, true, false],
        &[0.0, 0.0, 1.0, 0.0],
        &[0.0, 0.0, f64::INFINITY, f64::INFINITY],
        &[1.0; 4],
        EXACT,
        &mut proposed,
    );
    assert_eq!((counts, proposed), ((0, 2), [false; 4]));
}

#[test]
fn round_off_does_not_chatter() {
    // Slot 0 carries 100, slot 1 just touches: its pressure and then its gap are noise of the solution.
    let c = [1e3, 1e3];
    let mut control = ActiveSetControl::new(ActiveSetTolerance::for_length_scale(1.0));
    let mut active = [true, true];
    assert_eq!(
        control.propose(&mut active, &[100.0, -3e-11], &[0.0, 0.0], &c),
        ActiveSetOutcome::Changed { activated: 0, released: 1 }
    );
    assert_eq!(control.propose(&mut active, &[100.0, 0.0], &[0.0, -3e-14], &c), ActiveSetOutcome::Unchanged);
    // In the next step a penetration that means something closes.
    control.reset();
    assert_eq!(
        control.propose(&mut active, &[100.0, 0.0], &[0.0, -1e-9], &c),
        ActiveSetOutcome::Changed { activated: 1, released: 0 }
    );
}

#[test]
fn a_cycle_takes_the_union_once_then_one_slot_at_a_time_and_is_then_reported() {
    let mut control = ActiveSetControl::new(EXACT);
    let c = [1.0; 3];
    let mut active = [true, false, false];
    // {0} -> {1} -> {0}: the union {0, 1}.
    let first = control.propose(&mut active, &[-1.0, 0.0, 0.0], &[0.0, -1.0, 1.0], &c);
    assert_eq!((first, active), (ActiveSetOutcome::Changed { activated: 1, released: 1 }, [false, true, false]));
    assert_eq!(control.tried(), 1);
    let second = control.propose(&mut active, &[0.0, -1.0, 0.0], &[-1.0, 0.0, 1.0], &c);
    assert_eq!((second, active), (ActiveSetOutcome::Union { activated: 1, released: 0 }, [true, true, false]));
    assert_eq!(control.flipping(), [0, 1]);
    // The sets before the union are judged again: {0} once more, and {0, 1} again, which was the union.
    let third = control.propose(&mut active, &[1.0, -1.0, 0.0], &[0.0, 0.0, 1.0], &c);
    assert_eq!((third, active), (ActiveSetOutcome::Changed { activated: 0, released: 1 }, [true, false, false]));
    // It came back: slots are turned one at a time, first the one that is most wrong, then the first, until that comes back, too.
    let closed = ActiveSetOutcome::Union { activated: 1, released: 0 };
    let fourth = control.propose(&mut active, &[1.0, 0.0, 0.0], &[0.0, -1.0, 1.0], &c);
    assert_eq!((fourth, active), (closed, [true, true, false]));
    let fifth = control.propose(&mut active, &[1.0, -1.0, 0.0], &[0.0, 0.0, 1.0], &c);
    assert_eq!((fifth, active), (ActiveSetOutcome::Changed { activated: 0, released: 1 }, [true, false, false]));
    let sixth = control.propose(&mut active, &[1.0, 0.0, 0.0], &[0.0, -1.0, 1.0], &c);
    assert_eq!((sixth, active), (closed, [true, true, false]));
    let seventh = control.propose(&mut active, &[1.0, -1.0, 0.0], &[0.0, 0.0, 1.0], &c);
    assert_eq!((seventh, active), (ActiveSetOutcome::Changed { activated: 0, released: 1 }, [true, false, false]));
    let last = control.propose(&mut active, &[1.0, 0.0, 0.0], &[0.0, -1.0, 1.0], &c);
    assert_eq!((last, active), (ActiveSetOutcome::Cycling, [true, false, false]));
    assert_eq!(control.flipping(), [1]);
    // A new step, or other pairings: everything is forgotten.
    control.reset();
    assert_eq!((control.tried(), control.flipping().len()), (0, 0));
    let again = control.propose(&mut active, &[1.0, 0.0, 0.0], &[0.0, -1.0, 1.0], &c);
    assert_eq!(again, ActiveSetOutcome::Changed { activated: 1, released: 0 });
}

#[test]
fn nested_sets_are_looked_at_once_more_with_the_larger_one() {
    // {0, 1} -> {0} -> {0, 1}: the union is a set that was there already. A slot that flips because of an inaccurate solution
    // settles when the union is solved for accurately.
    let flip = |control: &mut ActiveSetControl, active: &mut [bool; 2]| {
        let outcome = control.propose(active, &[5.0, -1e-3], &[0.0, 0.0], &[1.0; 2]);
        assert_eq!((outcome, *active), (ActiveSetOutcome::Changed { activated: 0, released: 1 }, [true, false]));
        control.propose(active, &[5.0, 0.0], &[0.0, -1e-3], &[1.0; 2])
    };
    let (mut control, mut active) = (ActiveSetControl::new(EXACT), [true, true]);
    let union = ActiveSetOutcome::Union { activated: 1, released: 0 };
    assert_eq!((flip(&mut control, &mut active), active), (union, [true, true]));
    assert_eq!(control.propose(&mut active, &[5.0, 1e-9], &[0.0, 0.0], &[1.0; 2]), ActiveSetOutcome::Unchanged);
    // One that flips all the same is named.
    control.reset();
    for _ in 0..3 {
        assert_eq!(flip(&mut control, &mut active), union);
    }
    assert_eq!(flip(&mut control, &mut active), ActiveSetOutcome::Cycling);
    assert_eq!(control.flipping(), [1]);
}
