//! Prolongation, Galerkin products, the cycle.

use super::{Body, CUBE, clamped, cube, system};
use crate::MatrixKind;
use crate::iterative::aggregates::{Graph, NONE, aggregate};
use crate::iterative::bsr::tests::{dense, dense_product, difference};
use crate::iterative::bsr::{Block, Bsr, product};
use crate::iterative::entries::Entries;
use crate::iterative::hierarchy::Hierarchy;
use crate::iterative::inverse::inverse_diagonal;
use crate::iterative::layout::Layout;
use crate::iterative::modes::{MODES, rigid_modes, smoothed, tentative};
use crate::iterative::real::Real;
use crate::iterative::saddle::Border;
use crate::iterative::smoother::largest_eigenvalue;
use crate::vector::pseudo_random;

/// The blocks and the layout of bodies.
fn blocks(bodies: &[Body], held: impl Fn(usize, [f64; 3]) -> [bool; 3]) -> (Bsr<f64, 3, 3>, Layout) {
    let system = system(bodies, held, &[]);
    let mut layout = Layout::default();
    layout.set(&mut system.places.iter().copied());
    let mut k = layout.block_pattern(system.pattern());
    let entries = Entries::new(&layout, system.pattern(), &k, false);
    entries.set(&layout, system.pattern(), &system.matrix.values, &mut k, &mut Border::default());
    (k, layout)
}

fn as_matrix<const B: usize>(modes: &[Block<f64, B, MODES>]) -> Vec<Vec<f64>> {
    modes.iter().flatten().map(|row| row.to_vec()).collect()
}

fn transposed(a: &[Vec<f64>]) -> Vec<Vec<f64>> {
    (0..a[0].len()).map(|c| a.iter().map(|row| row[c]).collect()).collect()
}

#[test]
fn rigid_motions_of_a_free_body_are_carried_to_its_aggregates() {
    let (k, layout) = blocks(&[cube(5)], |_, _| [false; 3]);
    let modes = rigid_modes(&layout.positions, &layout.free);
    let (of, count) = aggregate(&Graph::within(&k, &layout.labels), &vec![false; k.rows()]);
    assert!(count > 4 && of.iter().all(|&a| a != NONE));
    let (p0, coarse) = tentative(&modes, &of, count);
    let inverse = inverse_diagonal(&k);
    let p = smoothed(&k, &inverse, &p0, 4.0 / 3.0 / largest_eigenvalue(&k, &inverse));
    let coarse = as_matrix(&coarse);
    assert!(difference(&dense_product(&dense(&p0), &coarse), &as_matrix(&modes)) < 1e-13);
    assert!(difference(&dense_product(&dense(&p), &coarse), &as_matrix(&modes)) < 1e-12);
    // Nothing resists them.
    let forces = dense_product(&dense(&k), &dense_product(&dense(&p), &coarse));
    assert!(difference(&forces, &vec![vec![0.0; MODES]; forces.len()]) < 1e-12 * 1e3);
    // Orthonormal columns.
    let unit = dense_product(&transposed(&dense(&p0)), &dense(&p0));
    let expected: Vec<Vec<f64>> =
        (0..unit.len()).map(|i| (0..unit.len()).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    assert!(difference(&unit, &expected) < 1e-13);
    // The coarse matrix.
    let galerkin = product(&p.transposed(), &product(&k, &p));
    let exact = dense_product(&transposed(&dense(&p)), &dense_product(&dense(&k), &dense(&p)));
    assert!(difference(&dense(&galerkin), &exact) < 1e-11 * 1e3);
}

/// Aggregates of one, two and three nodes on a line have fewer than six modes, components without equation fewer yet.
#[test]
fn modes_that_depend_on_others_become_empty_columns() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [5.0, 1.0, 0.0], [6.0, 1.0, 2.0], [9.0, 4.0, 1.0]];
    let free = [[true; 3], [true; 3], [true; 3], [true; 3], [true, false, true], [true, true, false]];
    let modes = rigid_modes(&positions, &free);
    let (p0, coarse) = tentative(&modes, &[0, 0, 0, 1, 1, 2], 3);
    assert!(difference(&dense_product(&dense(&p0), &as_matrix(&coarse)), &as_matrix(&modes)) < 1e-14);
    let p0 = dense(&p0);
    let kept = |a: usize| (0..MODES).filter(|c| p0.iter().any(|row| row[MODES * a + c] != 0.0)).count();
    // The second aggregate: five components, of which the four in the plane of its two nodes keep their distance.
    assert_eq!([kept(0), kept(1), kept(2)], [5, 4, 2]);
    assert!(p0[13].iter().all(|v| *v == 0.0), "a component without equation");
}

#[test]
fn bodies_never_share_an_aggregate() {
    let bodies = [cube(4), Body { at: [0.0, 0.0, 1.0], ..cube(4) }];
    let (mut k, layout) = blocks(&bodies, |_, _| [false; 3]);
    // As if the nodes that face each other were tied.
    let tied = super::super::bsr::sum_with(&k, |i, add| {
        if (100..125).contains(&i) {
            add(i as u32 + 25, &[[1e4; 3]; 3]);
        }
    });
    k = tied;
    let (of, count) = aggregate(&Graph::within(&k, &layout.labels), &vec![false; k.rows()]);
    for a in 0..count as u32 {
        let mut labels = of.iter().zip(&layout.labels).filter(|(of, _)| **of == a).map(|(_, label)| label);
        let first = labels.next().unwrap();
        assert!(labels.all(|label| label == first));
    }
}

fn asymmetry<T: Real>(k: &Bsr<f64, 3, 3>, layout: &Layout) -> f64 {
    let modes = rigid_modes(&layout.positions, &layout.free);
    let mut hierarchy = Hierarchy::<T>::new(k, &modes, &layout.labels, MatrixKind::Symmetric).unwrap();
    let n = 3 * k.rows();
    let (u, v): (Vec<f64>, Vec<f64>) = ((0..n).map(pseudo_random).collect(), (n..2 * n).map(pseudo_random).collect());
    let (mut mu, mut mv) = (vec![0.0; n], vec![0.0; n]);
    hierarchy.apply(&u, &mut mu);
    hierarchy.apply(&v, &mut mv);
    let dot = crate::vector::dot;
    let scale = (dot(&u, &mu) * dot(&v, &mv)).sqrt();
    assert!(dot(&u, &mu) > 0.0 && dot(&v, &mv) > 0.0);
    (dot(&v, &mu) - dot(&u, &mv)).abs() / scale
}

#[test]
fn the_cycle_is_symmetric() {
    let (k, layout) = blocks(&[cube(9)], clamped);
    assert!(asymmetry::<f64>(&k, &layout) < 1e-13);
    assert!(asymmetry::<f32>(&k, &layout) < 1e-5);
}

#[test]
fn levels_are_small() {
    let (k, layout) = blocks(&[Body { poisson: 0.4, ..cube(14) }], clamped);
    let modes = rigid_modes(&layout.positions, &layout.free);
    let hierarchy = Hierarchy::<f32>::new(&k, &modes, &layout.labels, MatrixKind::Symmetric).unwrap();
    let (p, complexity) = hierarchy.prolongation_and_complexity();
    assert!(k.rows() > 15 * p.columns, "{} nodes, {} aggregates", k.rows(), p.columns);
    assert!(complexity < 1.3, "{complexity}");
}

/// A column whose matrix is that of a body that has buckled, as a long body of negative stiffness in its softest motion would be.
#[test]
fn the_coarsest_level_sees_a_negative_direction() {
    let column = Body { cells: [4, 4, 40], size: [1.0, 1.0, 10.0], ..CUBE };
    let (mut k, layout) = blocks(&[column], clamped);
    let modes = rigid_modes(&layout.positions, &layout.free);
    let is_indefinite = |k: &Bsr<f64, 3, 3>| {
        Hierarchy::<f32>::new(k, &modes, &layout.labels, MatrixKind::Symmetric).unwrap().is_indefinite()
    };
    assert!(!is_indefinite(&k));
    // Clamped at its foot it bends with 3 E I / L^3 = 0.25 at its top; a spring of -0.5 there has a negative sum.
    let top = k.rows() - 13;
    let at = k.position(top, top).unwrap();
    k.blocks[at][0][0] -= 0.5;
    assert!(is_indefinite(&k));
}
