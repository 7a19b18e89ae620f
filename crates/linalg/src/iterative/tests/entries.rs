//! Blocks get the values of the matrix, whatever the pattern is made of.

use super::{Body, CUBE, Multiplier, System, system};
use crate::iterative::bsr::tests::dense;
use crate::iterative::entries::Entries;
use crate::iterative::layout::Layout;
use crate::iterative::saddle::Border;
use crate::vector::pseudo_random;
use crate::{NONE, SparseMatrix, SparsityPattern};
use std::sync::Arc;

/// Nodes with three, two, one and no equation; a multiplier at three of them.
fn partly_held() -> System {
    let body = Body { cells: [3, 2, 3], ..CUBE };
    let held = |_, x: [f64; 3]| [x[2] == 0.0, x[2] == 0.0 && x[0] > 0.5, x[2] == 0.0 && x[0] > 0.9];
    let at = [(20, [0.3, -1.0, 0.2]), (33, [0.0, 0.5, 1.0])];
    let multiplier = Multiplier { slot: 0, b: at.to_vec(), c: at.to_vec(), d: vec![(0, -2.0)] };
    system(&[body], held, &[multiplier])
}

/// Matrix of the system with further entries between single components of nodes that are far from each other.
fn with_single_entries(system: &System) -> SparseMatrix {
    let (old, n) = (system.pattern(), system.matrix.n() as u32);
    let pairs = |j: u32| old.column(j as usize).iter().map(move |&i| vec![i, j]);
    let mut stencils: Vec<Vec<u32>> = (0..n).flat_map(pairs).collect();
    stencils.extend([vec![1, n - 5], vec![n - 9, 7, NONE], vec![n - 9, 12], vec![n / 2, 0]]);
    let pattern = SparsityPattern::from_stencils(n as usize, stencils.iter().map(Vec::as_slice)).unwrap();
    assert!(pattern.nnz() > old.nnz());
    SparseMatrix::zeros(Arc::new(pattern.with_first_multiplier(old.first_multiplier())))
}

#[test]
fn blocks_have_the_values_of_the_matrix() {
    let system = partly_held();
    for mut matrix in [system.matrix.clone(), with_single_entries(&system)] {
        for symmetric in [false, true] {
            let n = matrix.n();
            let pattern = Arc::clone(&matrix.pattern);
            for j in 0..n {
                for (&i, at) in pattern.column(j).iter().zip(pattern.column_range(j)) {
                    let i = i as usize;
                    let (a, b) = if symmetric { (i.min(j), i.max(j)) } else { (i, j) };
                    matrix.values[at] = pseudo_random(a * n + b);
                }
            }
            let mut layout = Layout::default();
            layout.set(&mut system.places.iter().copied());
            let mut k = layout.block_pattern(&pattern);
            let mut border = Border::default();
            Entries::new(&layout, &pattern, &k, symmetric).set(&layout, &pattern, &matrix.values, &mut k, &mut border);
            let blocks = dense(&k);
            let place: Vec<usize> = layout.place.iter().map(|&place| place as usize).collect();
            let free = pattern.first_multiplier();
            for j in 0..free {
                for i in 0..free {
                    assert_eq!(blocks[place[i]][place[j]], matrix.get(i as u32, j as u32), "{i} {j} {symmetric}");
                }
            }
            // Components without equation: something on the diagonal, nothing else.
            let is_held = |at: usize| !place.contains(&at);
            for (at, row) in blocks.iter().enumerate() {
                for (other, &value) in row.iter().enumerate().filter(|(other, _)| is_held(at) || is_held(*other)) {
                    assert!((value > 0.0) == (at == other), "{at} {other} {value}");
                }
            }
            let row: Vec<(usize, &[f64; 3])> = border.b.row(0).collect();
            for (node, value) in row {
                for (d, &value) in value.iter().enumerate() {
                    let equation = place.iter().position(|&place| place == 3 * node + d).unwrap();
                    assert_eq!(value, matrix.get(equation as u32, free as u32));
                }
            }
            for (node, row) in (0..layout.nodes()).map(|node| (node, border.c_by_node.row(node))) {
                for (multiplier, value) in row {
                    assert_eq!(multiplier, 0);
                    for (d, &value) in value.iter().enumerate() {
                        let equation = place.iter().position(|&place| place == 3 * node + d).unwrap();
                        assert_eq!(value, matrix.get(free as u32, equation as u32));
                    }
                }
            }
        }
    }
}
