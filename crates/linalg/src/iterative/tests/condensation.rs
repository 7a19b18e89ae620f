//! Multipliers that are condensed.

use super::contact::{Friction, sandwich, solve};
use super::{System, prepared};
use crate::iterative::bsr::Bsr;
use crate::iterative::bsr::tests::dense;
use crate::iterative::condense::Condensation;
use crate::iterative::entries::Entries;
use crate::iterative::inverse::{inverse_diagonal, invert};
use crate::iterative::krylov::{Krylov, Operator};
use crate::iterative::layout::Layout;
use crate::iterative::saddle::{Border, Saddle};
use crate::iterative::{Curvature, IterativeSolver};
use crate::{MatrixKind, vector::pseudo_random};

/// A system in blocks.
struct Parts {
    k: Bsr<f64, 3, 3>,
    border: Border,
    saddle: Saddle,
    condensation: Option<Condensation>,
}

fn parts(system: &System) -> Parts {
    let mut layout = Layout::default();
    layout.set(&mut system.places.iter().copied());
    let (mut k, mut border, mut saddle) =
        (layout.block_pattern(system.pattern()), Border::default(), Saddle::default());
    let entries = Entries::new(&layout, system.pattern(), &k, false);
    entries.set(&layout, system.pattern(), &system.matrix.values, &mut k, &mut border);
    saddle.set_weights(&border, &inverse_diagonal(&k), &layout.slots);
    let slaves = layout.slaves(system.pattern());
    let condensation = Condensation::new(&k, &border, &layout.slots, &slaves, &saddle.sizes);
    Parts { k, border, saddle, condensation }
}

/// A preconditioner with an exact inverse of the condensed matrix.
struct Exact {
    parts: Parts,
    inverse: Vec<f64>,
}

impl Operator for Exact {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        let Parts { k, border, saddle, .. } = &self.parts;
        let n = 3 * k.rows();
        k.multiply(&x[..n], &mut y[..n]);
        border.add_products(&saddle.scale, x, y);
    }

    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        let Self { parts: Parts { k, saddle, condensation, .. }, inverse } = self;
        let cycle = |r: &[f64], z: &mut [f64]| {
            let n = r.len();
            z.iter_mut()
                .zip(inverse.chunks_exact(n))
                .for_each(|(z, row)| *z = row.iter().zip(r).map(|(a, r)| a * r).sum());
        };
        condensation.as_mut().unwrap().apply(k, &saddle.scale, cycle, r, z);
    }
}

/// One iteration, since the preconditioner with an exact inverse of what is left is the inverse: multipliers that constrain, that stick, and friction that slides, which is eliminated.
#[test]
fn one_iteration_with_an_exact_inverse() {
    for friction in [Friction::Stick, Friction::SomeSlip] {
        let mut parts = parts(&sandwich(3, [1e3; 3], true, friction));
        let condensation = parts.condensation.as_mut().unwrap();
        let mut inverse: Vec<f64> = dense(&condensation.matrix(&parts.k, &parts.border)).concat();
        let n = 3 * parts.k.rows();
        invert(&mut inverse, n);
        let b: Vec<f64> = (0..n + parts.border.len()).map(pseudo_random).collect();
        let mut x = vec![0.0; b.len()];
        let report = Krylov::default().fgmres(&mut Exact { parts, inverse }, &b, &mut x, 1e-9, 20, true);
        assert!(report.iterations <= 2 && report.residual < 1e-9, "{friction:?}: {report:?}");
    }
}

/// Prototype: 6 at h, 8 at h / 2.
#[test]
fn the_mesh_does_not_matter() {
    let counts = [4, 6, 9].map(|n| solve(&sandwich(n, [1e3; 3], true, Friction::SomeSlip)).0);
    assert!(counts.iter().all(|&count| count <= 14), "{counts:?}");
    assert!(counts[2] <= counts[0] + 3, "{counts:?}");
}

/// Rows on several slave nodes, and a slave that is much stiffer than the master.
#[test]
fn where_it_does_not_suit() {
    let suits = |young, lumped| parts(&sandwich(4, young, lumped, Friction::Stick)).condensation.is_some();
    assert!(suits([1e3; 3], true) && suits([1e6, 1e3, 1e3], true));
    assert!(!suits([1e3; 3], false) && !suits([1e3, 1e6, 1e3], true));
}

/// A slot that begins to slide gives its node a motion that the hierarchy does not have.
#[test]
fn other_rows_need_another_hierarchy() {
    let of = |friction| sandwich(5, [1e3; 3], true, friction);
    let (sticks, slides) = (of(Friction::Stick), of(Friction::SomeSlip));
    let mut solver: IterativeSolver = prepared(&sticks, MatrixKind::General);
    let mut x = vec![0.0; sticks.rhs.len()];
    for (system, set_ups) in [(&sticks, 1), (&sticks, 1), (&slides, 2), (&slides, 2)] {
        solver.analyse(system.pattern(), MatrixKind::General);
        let count = solver.solve(&system.matrix.values, &system.rhs, &mut x, 1e-8, Curvature::Any).unwrap().unwrap();
        assert!(count <= 14, "{count}");
        assert!(solver.statistics().set_ups >= set_ups, "{:?}", solver.statistics());
    }
}
