//! Made-up contact: blocks on each other whose faces do not match, with the rows of mortar contact, standard and lumped, and friction.

use super::{Body, Multiplier, System, cube, offsets, relative_residual, system};
use crate::iterative::bsr::Bsr;
use crate::iterative::entries::Entries;
use crate::iterative::inverse::{inverse_diagonal, invert};
use crate::iterative::krylov::{Krylov, Operator};
use crate::iterative::layout::Layout;
use crate::iterative::saddle::{Border, Saddle};
use crate::iterative::{Curvature, IterativeSolver};
use crate::vector::pseudo_random;
use crate::{LinearSolver, MatrixKind, MultifrontalSolver};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    None,
    /// All stick: two more multipliers with the other sign.
    Stick,
    /// Every second slot slides along `x`, with a force of 0.3 of the pressure.
    SomeSlip,
}

/// Constraints between the top of body `master` and the bottom of `slave`, from slot `first` on. `lumped`: each on one slave node.
fn contact(
    bodies: &[Body],
    master: usize,
    slave: usize,
    lumped: bool,
    friction: Friction,
    first: u32,
) -> Vec<Multiplier> {
    let offsets = offsets(bodies);
    let (m, s) = (&bodies[master], &bodies[slave]);
    let [nx, ny, _] = s.cells;
    // Displacement of a slave node relative to the master's face under it.
    let relative = |i: usize, j: usize| {
        let mut row = vec![(offsets[slave] + s.node(i, j, 0), 1.0)];
        let place = |k: usize, n: usize, cells: usize| {
            let x = k as f64 / n as f64 * cells as f64;
            let cell = (x as usize).min(cells - 1);
            (cell, x - cell as f64)
        };
        let ((a, u), (b, v)) = (place(i, nx, m.cells[0]), place(j, ny, m.cells[1]));
        for (da, wa) in [(0, 1.0 - u), (1, u)] {
            for (db, wb) in [(0, 1.0 - v), (1, v)] {
                if wa * wb != 0.0 {
                    row.push((offsets[master] + m.node(a + da, b + db, m.cells[2]), -wa * wb));
                }
            }
        }
        row
    };
    let near = |i: usize, n: usize| {
        (i.saturating_sub(1)..=n.min(i + 1)).map(move |k| (k, if k == i { 4.0 } else { 1.0 } / 6.0))
    };
    let mut out: Vec<Multiplier> = Vec::new();
    for j in 0..=ny {
        for i in 0..=nx {
            let mut row: Vec<(usize, f64)> = relative(i, j);
            if !lumped {
                row.iter_mut().for_each(|entry| entry.1 *= 16.0 / 36.0);
                for (k, wk) in near(i, nx) {
                    for (l, wl) in near(j, ny).filter(|&(l, _)| (k, l) != (i, j)) {
                        for (node, w) in relative(k, l) {
                            match row.iter_mut().find(|entry| entry.0 == node) {
                                Some(entry) => entry.1 += wk * wl * w,
                                None => row.push((node, wk * wl * w)),
                            }
                        }
                    }
                }
            }
            let area = 1.0 / (nx * ny) as f64;
            let along = |d: usize, sign: f64| -> Vec<(usize, [f64; 3])> {
                let unit = |w: f64| std::array::from_fn(|c| if c == d { sign * w * area } else { 0.0 });
                row.iter().map(|&(node, w)| (node, unit(w))).collect()
            };
            let slot = first + out.len() as u32 / if friction == Friction::None { 1 } else { 3 };
            let normal = out.len();
            out.push(Multiplier { slot, b: along(2, -1.0), c: along(2, -1.0), d: vec![] });
            if friction == Friction::None {
                continue;
            }
            for d in [0, 1] {
                let slides = friction == Friction::SomeSlip && (i + j) % 2 == 0 && d == 0;
                out.push(if slides {
                    // The friction is 0.3 times the pressure.
                    Multiplier { slot, b: along(d, 1.0), c: vec![], d: vec![(out.len(), area), (normal, -0.3 * area)] }
                } else {
                    Multiplier { slot, b: along(d, 1.0), c: along(d, -1.0), d: vec![] }
                });
            }
        }
    }
    out
}

/// Three blocks, the lowest clamped below, the highest above; the middle one is held by contact alone.
pub fn sandwich(n: usize, young: [f64; 3], lumped: bool, friction: Friction) -> System {
    let body = |k: usize, cells: usize| Body { at: [0.0, 0.0, k as f64], young: young[k], ..cube(cells) };
    let bodies = [body(0, n), body(1, n + 1), body(2, n)];
    let mut rows = contact(&bodies, 0, 1, lumped, friction, 0);
    let before = rows.len();
    let mut upper = contact(&bodies, 1, 2, lumped, friction, 10_000);
    upper.iter_mut().flat_map(|m| &mut m.d).for_each(|(j, _)| *j += before);
    rows.append(&mut upper);
    system(&bodies, |b, x| [(b == 0 && x[2] == 0.0) || (b == 2 && x[2] == 3.0); 3], &rows)
}

pub fn solve(system: &System) -> (u32, Vec<f64>) {
    let mut solver = IterativeSolver::default();
    solver.place(&mut system.places.iter().copied());
    solver.analyse(system.pattern(), MatrixKind::General);
    let mut x = vec![0.0; system.rhs.len()];
    let count = solver.solve(&system.matrix.values, &system.rhs, &mut x, 1e-8, Curvature::Any).unwrap();
    (count.unwrap_or_else(|| panic!("{:?}", solver.take_reason())), x)
}

fn direct(system: &System) -> Vec<f64> {
    let mut solver = MultifrontalSolver::new();
    let mut x = vec![0.0; system.rhs.len()];
    solver.analyse(system.pattern(), MatrixKind::General).unwrap();
    solver.factorise(&system.matrix.values).unwrap();
    solver.solve(&system.rhs, &mut x).unwrap();
    x
}

#[test]
fn a_body_held_by_contact_alone() {
    let mut counts = Vec::new();
    for lumped in [false, true] {
        for friction in [Friction::Stick, Friction::SomeSlip] {
            let system = sandwich(6, [1e3; 3], lumped, friction);
            let (count, x) = solve(&system);
            let y = direct(&system);
            let free = system.pattern().first_multiplier();
            for part in [0..free, free..x.len()] {
                let size = crate::vector::norm_inf(&y[part.clone()]);
                let error = part.map(|i| (x[i] - y[i]).abs()).fold(0.0, f64::max);
                assert!(error < 1e-5 * size, "{error} of {size}");
            }
            counts.push(count);
        }
    }
    // Standard multipliers by the Schur complement; lumped ones are condensed.
    assert!(counts[..2].iter().all(|&count| count <= 30), "{counts:?}");
    assert!(counts[2..].iter().all(|&count| count <= 14), "{counts:?}");
}

/// Ties are the same rows; stiffnesses of 1 to 1000 were the hardest of them.
#[test]
fn bodies_of_different_stiffness_that_stick_together() {
    let counts =
        [[1e3; 3], [1e3, 1e6, 1e3], [1e6, 1e3, 1e6]].map(|young| solve(&sandwich(6, young, false, Friction::Stick)).0);
    assert!(counts.iter().all(|&count| count <= 45), "{counts:?}");
}

/// Three motions of the middle body that nothing resists, without friction.
#[test]
fn a_body_that_may_slide_is_refused() {
    let system = sandwich(6, [1e3; 3], true, Friction::None);
    let mut solver = IterativeSolver::default();
    solver.place(&mut system.places.iter().copied());
    solver.analyse(system.pattern(), MatrixKind::General);
    let mut x = vec![0.0; system.rhs.len()];
    assert_eq!(solver.solve(&system.matrix.values, &system.rhs, &mut x, 1e-8, Curvature::Any), Ok(None));
    assert!(solver.has_refused());
}

/// A multiplier and its row in another unit: the same iterations.
#[test]
fn units_of_multipliers_do_not_matter() {
    let mut system = sandwich(5, [1e3; 3], false, Friction::Stick);
    let free = system.pattern().first_multiplier();
    let (before, _) = solve(&system);
    let pattern = system.matrix.pattern.clone();
    let factor = |e: usize| if e >= free { 2.0_f64.powi(20) } else { 1.0 };
    for j in 0..pattern.n() {
        for k in pattern.column_range(j) {
            system.matrix.values[k] *= factor(j) * factor(pattern.row_indices()[k] as usize);
        }
    }
    (free..pattern.n()).for_each(|e| system.rhs[e] *= factor(e));
    let (after, x) = solve(&system);
    assert!(before.abs_diff(after) <= 1, "{before} {after}");
    assert!(x.iter().all(|x| x.is_finite()));
}

/// Inactive rows say that the pressure stays; rows of a penalty have `D`.
#[test]
fn open_slots_and_penalties() {
    let bodies = [cube(6), Body { at: [0.0, 0.0, 1.0], ..cube(7) }];
    let mut rows = contact(&bodies, 0, 1, true, Friction::None, 0);
    for (k, row) in rows.iter_mut().enumerate() {
        match k % 3 {
            0 => (row.b, row.c, row.d) = (vec![], vec![], vec![(k, 1.0)]),
            1 => row.d.push((k, -1e-5)),
            _ => {}
        }
    }
    let held = |b: usize, x: [f64; 3]| [(b == 0 && x[2] == 0.0) || (b == 1 && x[2] == 2.0); 3];
    let system = system(&bodies, held, &rows);
    let (count, x) = solve(&system);
    assert!(count <= 30, "{count}");
    assert!(relative_residual(&system, &x) < 1e-6);
    let free = system.pattern().first_multiplier();
    for k in (0..rows.len()).step_by(3) {
        assert!((x[free + k] - system.rhs[free + k]).abs() < 1e-6);
    }
}

/// `[K B; C D]` with a block diagonal `K`, for which the Schur complement is exact, and an exact inverse of `K + B W C`.
struct Exact {
    k: Bsr<f64, 3, 3>,
    border: Border,
    saddle: Saddle,
    inverse: Vec<f64>,
}

impl Operator for Exact {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        let n = 3 * self.k.rows();
        self.k.multiply(&x[..n], &mut y[..n]);
        self.border.add_products(&self.saddle.scale, x, y);
    }

    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        let inverse = &self.inverse;
        let cycle = |r: &[f64], z: &mut [f64]| {
            let n = r.len();
            (0..n).for_each(|i| z[i] = (0..n).map(|j| inverse[n * i + j] * r[j]).sum());
        };
        self.saddle.apply(&self.border, cycle, r, z);
    }
}

/// Two iterations with exact parts: multipliers that constrain, a penalty, friction that slides, an open slot.
#[test]
fn two_iterations_with_exact_parts() {
    let places = |m: usize| {
        let node = |e: usize| crate::EquationPlace::Node {
            body: 0,
            node: (e / 3) as u32,
            component: (e % 3) as u8,
            position: [(e / 3) as f64, 0.0, 0.0],
        };
        (0..18)
            .map(node)
            .chain((0..m).map(|k| crate::EquationPlace::Multiplier { pair: 0, slot: k as u32 / 2 }))
            .collect::<Vec<_>>()
    };
    // In a slot of two: nothing, a penalty, friction that slides, an open one.
    let own: [[f64; 4]; 4] = [[0.0; 4], [-0.3, 0.0, 0.0, 0.0], [0.0, 0.0, -0.4, 0.9], [1.0, 0.0, 0.0, 1.0]];
    for (case, d) in own.iter().enumerate() {
        let m = 4;
        let n = 18 + m;
        let all: Vec<u32> = (0..n as u32).collect();
        let pattern = std::sync::Arc::new(crate::SparsityPattern::from_stencils(n, std::iter::once(&all[..])).unwrap());
        let mut values = vec![0.0; pattern.nnz()];
        for column in 0..n {
            for row in 0..n {
                values[n * column + row] = match (row < 18, column < 18) {
                    (true, true) if row / 3 == column / 3 => {
                        pseudo_random(3 + 31 * row + column) + if row == column { 3.0 } else { 0.0 }
                    }
                    (true, true) => 0.0,
                    (true, false) | (false, true) if case == 3 && (row.max(column) - 18) < 2 => 0.0,
                    // Two nodes for each slot, one shared.
                    (true, false) if (row / 3).abs_diff(column - 18) < 2 => 40.0 * pseudo_random(row + 97 * column),
                    (false, true) if (column / 3).abs_diff(row - 18) < 2 => {
                        let sign = if case == 2 { -1.0 } else { 1.0 };
                        sign * 40.0 * pseudo_random(column + 97 * row) + pseudo_random(row * column)
                    }
                    (false, false) if row < 20 && column < 20 => d[2 * (row - 18) + column - 18],
                    _ => 0.0,
                };
            }
        }
        let mut layout = Layout::default();
        layout.set(&mut places(m).into_iter());
        let mut k = layout.block_pattern(&pattern);
        let mut border = Border::default();
        Entries::new(&layout, &pattern, &k, false).set(&layout, &pattern, &values, &mut k, &mut border);
        let mut saddle = Saddle::default();
        saddle.set_weights(&border, &inverse_diagonal(&k), &layout.slots);
        saddle.factorise(&border, &inverse_diagonal(&k), &layout.slots).unwrap();
        let augmented = saddle.augmented(&k, &border);
        let mut inverse: Vec<f64> = crate::iterative::bsr::tests::dense(&augmented).concat();
        invert(&mut inverse, 18);
        let mut rhs: Vec<f64> = (0..n).map(pseudo_random).collect();
        let scale = saddle.scale.clone();
        rhs[18..].iter_mut().zip(&scale).for_each(|(b, scale)| *b *= scale);
        let mut x = vec![0.0; n];
        let mut system = Exact { k, border, saddle, inverse };
        let report = Krylov::default().fgmres(&mut system, &rhs, &mut x, 1e-11, 20, true);
        assert!(report.iterations <= 2 && report.residual < 1e-10, "case {case}: {report:?}");
    }
}

#[test]
fn bits_do_not_depend_on_threads() {
    let system = sandwich(7, [1e3; 3], false, Friction::SomeSlip);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&system).1)
    };
    assert!(run(1).iter().zip(&run(2)).all(|(x, y)| x.to_bits() == y.to_bits()));
}
