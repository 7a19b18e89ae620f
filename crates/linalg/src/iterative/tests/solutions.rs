//! Solutions without multipliers.

use super::{Body, CUBE, System, clamped, cube, prepared, relative_residual, system};
use crate::iterative::{Curvature, IterativeSolver};
use crate::{AutoSolver, LinalgError, LinearSolver, MatrixKind, MultifrontalSolver, SolverOptions};

/// Iterations and solution to 1e-8.
fn solve(system: &System, kind: MatrixKind) -> (u32, Vec<f64>) {
    let mut solver = prepared(system, kind);
    let mut x = vec![0.0; system.rhs.len()];
    // The first solution after `forget` has the largest forcing term; the second one is asked for eight digits.
    let iterations = precise(&mut solver, system, &mut x);
    (iterations, x)
}

/// A solution to 1e-8: right-hand sides before it make the forcing term that small.
fn precise(solver: &mut IterativeSolver, system: &System, x: &mut [f64]) -> u32 {
    let large: Vec<f64> = system.rhs.iter().map(|b| 1e6 * b).collect();
    let (values, any) = (&system.matrix.values, Curvature::Any);
    solver.solve(values, &large, x, 1e-8, any).unwrap().unwrap();
    let iterations = solver.solve(values, &system.rhs, x, 1e-8, any).unwrap().unwrap();
    assert!(relative_residual(system, x) < 1.01e-8, "{}", relative_residual(system, x));
    iterations
}

/// Prototype and two other programs: 8, 8, 9 for 10, 20, 30 cells along an edge.
#[test]
fn iterations_stay_level_as_the_mesh_is_refined() {
    let counts = [8, 12, 18].map(|n| solve(&system(&[cube(n)], clamped, &[]), MatrixKind::Symmetric).0);
    assert!(counts.iter().all(|&count| count <= 12), "{counts:?}");
    assert!(counts[2] <= counts[0] + 2, "{counts:?}");
}

#[test]
fn columns_and_nearly_incompressible_bodies() {
    let soft = Body { poisson: 0.45, ..cube(12) };
    let column = Body { cells: [4, 4, 60], size: [1.0, 1.0, 15.0], ..CUBE };
    let counts = [soft, column].map(|body| solve(&system(&[body], clamped, &[]), MatrixKind::Symmetric).0);
    assert!(counts.iter().all(|&count| count <= 25), "{counts:?}");
}

/// Cells of 1 to 20: aggregates of neighbours on all sides are none of the strong couplings. What takes many iterations twice, or does not end, is refused, with the reason.
#[test]
fn flat_cells_are_left_to_the_direct_solver() {
    let flat = Body { cells: [12; 3], size: [1.0, 1.0, 0.05], ..CUBE };
    let refusal = |held: fn(usize, [f64; 3]) -> [bool; 3]| {
        let system = system(&[flat], held, &[]);
        let mut solver = prepared(&system, MatrixKind::Symmetric);
        let mut x = vec![0.0; system.rhs.len()];
        // Right-hand sides that fall as Newton's do, so that all digits are asked for.
        for k in 0..4 {
            let rhs: Vec<f64> = system.rhs.iter().map(|b| b * 1e-4_f64.powi(k)).collect();
            if solver.solve(&system.matrix.values, &rhs, &mut x, 1e-8, Curvature::Any).unwrap().is_none() {
                return solver.take_reason().unwrap();
            }
        }
        String::new()
    };
    let glued = refusal(clamped);
    assert!(glued.contains("took many iterations"), "{glued}");
    let plate = refusal(|_, x| [x[0] == 0.0; 3]);
    assert!(plate.contains("would take more than 150"), "{plate}");
}

#[test]
fn unsymmetric_matrices_and_stiff_and_soft_bodies() {
    let skew = system(&[Body { skew: 0.3, ..cube(10) }], clamped, &[]);
    let (count, x) = solve(&skew, MatrixKind::General);
    assert!(count <= 16, "{count}");
    let mut direct = MultifrontalSolver::new();
    let mut y = x.clone();
    direct.analyse(skew.pattern(), MatrixKind::General).unwrap();
    direct.factorise(&skew.matrix.values).unwrap();
    direct.solve(&skew.rhs, &mut y).unwrap();
    let error = x.iter().zip(&y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    assert!(error < 1e-6 * crate::vector::norm_inf(&y), "{error}");
    // Ten orders of magnitude between two bodies that do not touch.
    let pair = [cube(7), Body { young: 1e13, at: [2.0, 0.0, 0.0], ..cube(7) }];
    let (count, _) = solve(&system(&pair, clamped, &[]), MatrixKind::Symmetric);
    assert!(count <= 12, "{count}");
}

/// Units do not matter: single precision has room for 1e-38 to 1e38 only.
#[test]
fn the_same_iterations_in_every_unit() {
    let counts = [1e-12, 1e-3, 1.0, 1e12, 1e45].map(|young| {
        let body = Body { young, ..cube(8) };
        solve(&system(&[body], clamped, &[]), MatrixKind::Symmetric).0
    });
    assert!(counts.iter().all(|count| *count == counts[2]), "{counts:?}");
}

/// Rollers on three faces, so that many nodes have one or two equations.
#[test]
fn nodes_that_are_held_in_part() {
    let rollers = system(&[cube(10)], |_, x| x.map(|x| x == 0.0), &[]);
    let (count, _) = solve(&rollers, MatrixKind::Symmetric);
    assert!(count <= 12, "{count}");
}

#[test]
fn bits_depend_on_neither_threads_nor_what_was_solved_before() {
    let first = system(&[cube(14)], clamped, &[]);
    let other = system(&[Body { skew: 0.5, ..cube(9) }], clamped, &[]);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&first, MatrixKind::Symmetric).1)
    };
    let one = run(1);
    let same = |x: &[f64]| x.iter().zip(&one).all(|(x, y)| x.to_bits() == y.to_bits());
    assert!(same(&run(2)) && same(&run(3)));
    let mut solver = prepared(&other, MatrixKind::General);
    precise(&mut solver, &other, &mut vec![0.0; other.rhs.len()]);
    solver.forget();
    solver.place(&mut first.places.iter().copied());
    solver.analyse(first.pattern(), MatrixKind::Symmetric);
    let mut x = vec![0.0; first.rhs.len()];
    precise(&mut solver, &first, &mut x);
    assert!(same(&x));
    solver.forget();
    precise(&mut solver, &first, &mut x);
    assert!(same(&x));
}

/// A step of a third of the time in which a wave crosses a cell: mass alone.
#[test]
fn one_level_is_enough_where_mass_dominates() {
    let wave = |dt: f64| Body { inertia: 1.0 / (dt * dt), ..cube(12) };
    let crossing = 1.0 / 12.0 / 1e3_f64.sqrt();
    for crossings in [0.3, 1.0, 3.0, 10.0, 100.0] {
        let free = system(&[wave(crossings * crossing)], |_, _| [false; 3], &[]);
        let mut solver = prepared(&free, MatrixKind::Symmetric);
        let count = precise(&mut solver, &free, &mut vec![0.0; free.rhs.len()]);
        println!("{crossings} crossings: {count} iterations, {} preconditioners", solver.statistics().set_ups);
        assert!(count <= 18, "{crossings}: {count}");
    }
}

/// A hierarchy serves for values nearby, and is renewed when it has become too old.
#[test]
fn a_hierarchy_is_kept_while_it_is_good() {
    let mut system = system(&[cube(10)], clamped, &[]);
    let mut solver = prepared(&system, MatrixKind::Symmetric);
    let mut x = vec![0.0; system.rhs.len()];
    let old = system.matrix.values.clone();
    for _ in 0..4 {
        precise(&mut solver, &system, &mut x);
        system.matrix.values.iter_mut().for_each(|v| *v *= 1.01);
    }
    assert_eq!(solver.statistics().set_ups, 1);
    // Another material in some rows and columns.
    let pattern = system.matrix.pattern.clone();
    for j in 0..pattern.n() {
        for k in pattern.column_range(j) {
            let stiff = |e: usize| if e % 90 < 45 { 30.0 } else { 1.0 };
            system.matrix.values[k] = old[k] * stiff(j) * stiff(pattern.row_indices()[k] as usize);
        }
    }
    for _ in 0..3 {
        precise(&mut solver, &system, &mut x);
    }
    assert!(solver.statistics().set_ups > 1);
}

#[test]
fn what_nothing_holds_and_what_is_indefinite_is_left_to_the_direct_solver() {
    let floating = system(&[cube(10)], |_, _| [false; 3], &[]);
    let mut solver = prepared(&floating, MatrixKind::Symmetric);
    let mut x = vec![0.0; floating.rhs.len()];
    let result = solver.solve(&floating.matrix.values, &floating.rhs, &mut x, 1e-8, Curvature::Any);
    assert_eq!(result, Ok(None));
    assert!(solver.has_refused() && solver.statistics().handed_over == 1);
    let reason = solver.take_reason().unwrap();
    assert!(reason.contains("singular"), "{reason}");
    assert_eq!(solver.take_reason(), None);
    // The whole of it names the motion, as ever.
    let mut auto = AutoSolver::new();
    auto.place(&mut floating.places.iter().copied());
    auto.analyse(floating.pattern(), MatrixKind::Symmetric).unwrap();
    assert_eq!(auto.solve_nearby(&floating.matrix.values, &floating.rhs, &mut x, 1e-6), Ok(None));
    assert!(matches!(auto.factorise(&floating.matrix.values), Err(LinalgError::Singular { row: Some(_) })));

    // A block with less than nothing on its diagonal: each translation of the whole has a negative energy.
    let mut negative = system(&[cube(10)], |_, _| [false; 3], &[]);
    for i in 0..negative.matrix.n() as u32 {
        let at = negative.matrix.pattern.position(i, i).unwrap();
        negative.matrix.values[at] -= 1e-3;
    }
    let mut auto = AutoSolver::preferring_iteration(SolverOptions::default());
    auto.place(&mut negative.places.iter().copied());
    auto.analyse(negative.pattern(), MatrixKind::Symmetric).unwrap();
    let (values, rhs) = (&negative.matrix.values, &negative.rhs);
    assert_eq!(auto.solve_definite(values, rhs, &mut x, 1e-6), Ok(false));
    auto.factorise(values).unwrap();
    assert_eq!(auto.negative_eigenvalues(), Some(6));
    // Whoever does not ask for the sign gets the solution.
    assert!(auto.solve_nearby(values, rhs, &mut x, 1e-8).unwrap().is_some());
}

/// A column whose softest motion has a small negative stiffness, under a load that has nothing of that motion.
#[test]
fn a_direction_that_the_load_does_not_have_is_seen() {
    let column = Body { cells: [4, 4, 48], size: [1.0, 1.0, 12.0], ..CUBE };
    let mut column = system(&[column], clamped, &[]);
    // Along the axis, the same in a cross-section.
    for (b, place) in column.rhs.iter_mut().zip(&column.places) {
        *b = if matches!(place, crate::EquationPlace::Node { component: 2, .. }) { -1.0 } else { 0.0 };
    }
    let run = |system: &System| {
        let mut solver = prepared(system, MatrixKind::Symmetric);
        let mut x = vec![0.0; system.rhs.len()];
        let solved = solver.solve(&system.matrix.values, &system.rhs, &mut x, 1e-8, Curvature::Positive).unwrap();
        (solved.is_some(), solver.has_refused(), solver.is_definite(&system.matrix.values))
    };
    assert_eq!(run(&column), (true, false, Some(true)));
    // It bends with 3 E I / L^3 = 0.145 at its top: springs of -0.16 in all in both directions across.
    let n = column.matrix.n();
    for e in (n - 75..n).filter(|e| e % 3 != 2) {
        let at = column.matrix.pattern.position(e as u32, e as u32).unwrap();
        column.matrix.values[at] -= 0.16 / 25.0;
    }
    let mut direct = MultifrontalSolver::new();
    direct.analyse(column.pattern(), MatrixKind::Symmetric).unwrap();
    direct.factorise(&column.matrix.values).unwrap();
    assert_eq!(direct.negative_eigenvalues(), Some(2));
    assert_eq!(run(&column), (false, false, Some(false)));
}

#[test]
fn bad_input_is_an_error() {
    let mut system = system(&[cube(10)], clamped, &[]);
    let mut solver = prepared(&system, MatrixKind::Symmetric);
    let mut x = vec![0.0; system.rhs.len()];
    let short = solver.solve(&system.matrix.values[1..], &system.rhs, &mut x, 1e-8, Curvature::Any);
    assert!(matches!(short, Err(LinalgError::Length { what: "values", .. })));
    system.rhs[7] = f64::NAN;
    let nan = solver.solve(&system.matrix.values, &system.rhs, &mut x, 1e-8, Curvature::Any);
    assert!(matches!(nan, Err(LinalgError::NonFinite { index: 7, .. })));
}

/// No iteration without places, or below the sizes of the solver.
#[test]
fn the_choice_depends_on_places_and_size() {
    let large = system(&[cube(10)], clamped, &[]);
    let mut auto = AutoSolver::new();
    auto.analyse(large.pattern(), MatrixKind::Symmetric).unwrap();
    assert_eq!(auto.name(), "multifrontal");
    auto.place(&mut large.places.iter().copied());
    auto.analyse(large.pattern(), MatrixKind::Symmetric).unwrap();
    assert_eq!(auto.name(), "smoothed aggregation");
    let small = system(&[cube(8)], clamped, &[]);
    auto.place(&mut small.places.iter().copied());
    auto.analyse(small.pattern(), MatrixKind::Symmetric).unwrap();
    assert_eq!(auto.name(), "multifrontal");
    let mut x = vec![0.0; small.rhs.len()];
    auto.factorise(&small.matrix.values).unwrap();
    auto.solve(&small.rhs, &mut x).unwrap();
    assert!(relative_residual(&small, &x) < 1e-12);
}
