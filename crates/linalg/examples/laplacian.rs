//! Laplace's equation on a square: pattern from stencils, assembly edge by edge, solution by the multifrontal solver.
//!
//! Checked: five-point differences are exact for the harmonic function `x^2 - y^2`, which is given on the boundary.
//!
//! `cargo run --example laplacian -p stoss-linalg`

use std::sync::Arc;
use stoss_linalg::{
    LinalgError, LinearSolver, MatrixKind, MultifrontalSolver, NONE, ScatterMap, SparseMatrix, SparsityPattern,
};

/// Cells along a side.
const N: usize = 60;

fn exact(node: usize) -> f64 {
    let [x, y] = [node % (N + 1), node / (N + 1)].map(|k| k as f64 / N as f64);
    x * x - y * y
}

fn main() -> Result<(), LinalgError> {
    let nodes = (N + 1) * (N + 1);
    let is_free = |node: usize| [node % (N + 1), node / (N + 1)].iter().all(|&k| k > 0 && k < N);
    // Nodes on the boundary have no equation.
    let mut equations = vec![NONE; nodes];
    let free: Vec<usize> = (0..nodes).filter(|&node| is_free(node)).collect();
    free.iter().enumerate().for_each(|(k, &node)| equations[node] = k as u32);
    let across = (0..nodes).filter(|node| node % (N + 1) < N).map(|node| [node, node + 1]);
    let up = (0..nodes - N - 1).map(|node| [node, node + N + 1]);
    let edges: Vec<[usize; 2]> = across.chain(up).collect();
    let stencils: Vec<[u32; 2]> = edges.iter().map(|edge| edge.map(|node| equations[node])).collect();

    let pattern = Arc::new(SparsityPattern::from_stencils(free.len(), stencils.iter().map(|s| s.as_slice()))?);
    let map = ScatterMap::new(&pattern, stencils.iter().map(|s| s.as_slice()))?;
    let mut matrix = SparseMatrix::zeros(Arc::clone(&pattern));
    let mut rhs = vec![0.0; free.len()];
    for (k, [a, b]) in edges.into_iter().enumerate() {
        map.add(k, &[1.0, -1.0, -1.0, 1.0], &mut matrix.values);
        for (node, other) in [(a, b), (b, a)] {
            if is_free(node) && !is_free(other) {
                rhs[equations[node] as usize] += exact(other);
            }
        }
    }
    let mut solver = MultifrontalSolver::new();
    solver.analyse(&pattern, MatrixKind::SymmetricPositiveDefinite)?;
    solver.factorise(&matrix.values)?;
    let mut solution = vec![0.0; free.len()];
    let report = solver.solve(&rhs, &mut solution)?;
    let error = free.iter().zip(&solution).map(|(&node, u)| (u - exact(node)).abs()).fold(0.0, f64::max);
    println!("equations {}, entries {}, solver {}", free.len(), matrix.values.len(), solver.name());
    println!("backward error {:.1e}, factors {} kB", report.backward_error, solver.memory_bytes() / 1024);
    println!("largest error {error:.1e}");
    assert!(error < 1e-12, "{error:e}");
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), LinalgError> {
    main()
}
