//! Systems for tests and benches.
#![allow(dead_code, reason = "each test binary uses a part")]

pub mod tangents;

use std::sync::Arc;
use stoss_linalg::{NONE, ScatterMap, SparseMatrix, SparsityPattern};

/// A small generator of pseudo-random numbers (xorshift), so that benches need no crate for it.
pub struct Random(pub u64);

impl Random {
    /// Uniform in [-1, 1).
    pub fn value(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn index(&mut self, n: usize) -> usize {
        (((self.value() + 1.0) / 2.0 * n as f64) as usize).min(n - 1)
    }
}

pub fn pattern(n: usize, stencils: &[Vec<u32>]) -> Arc<SparsityPattern> {
    Arc::new(SparsityPattern::from_stencils(n, stencils.iter().map(Vec::as_slice)).unwrap())
}

/// A block of `size^3` hexahedra with one face clamped, three equations a node, then multipliers (`share` of the equations)
/// on the nodes of the opposite face. The local stiffness is `B^T B` of random `B` (24 x 24) plus a mass; `symmetric` or
/// with a skew disturbance of 10 %.
pub fn hex_system(size: usize, share: f64, symmetric: bool) -> (SparseMatrix, Vec<f64>) {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let m = size + 1;
    let node = |i: usize, j: usize, k: usize| i + m * (j + m * k);
    // Layer k = 0 would be clamped: it has no equations.
    let equation = |a: usize, c: usize| if a < m * m { NONE } else { (3 * (a - m * m) + c) as u32 };
    let displacements = 3 * m * m * size;
    let mut stencils: Vec<Vec<u32>> = Vec::new();
    for k in 0..size {
        for j in 0..size {
            for i in 0..size {
                let corners = [
                    node(i, j, k),
                    node(i + 1, j, k),
                    node(i + 1, j + 1, k),
                    node(i, j + 1, k),
                    node(i, j, k + 1),
                    node(i + 1, j, k + 1),
                    node(i + 1, j + 1, k + 1),
                    node(i, j + 1, k + 1),
                ];
                stencils.push(corners.iter().flat_map(|&a| (0..3).map(move |c| equation(a, c))).collect());
            }
        }
    }
    let elements = stencils.len();
    let multipliers = ((displacements as f64 * share).round() as usize).min(size * size);
    let mut n = displacements;
    for l in 0..multipliers {
        // A "slave" node on the face k = size and the four corners of a facet on the face j = 0 (far away).
        let slave = node(1 + l % size, 1 + l / size, size);
        let (i, k) = (l % size, 1 + (l / size).min(size - 2));
        let mut s: Vec<u32> = [slave, node(i, 0, k), node(i + 1, 0, k), node(i, 0, k + 1), node(i + 1, 0, k + 1)]
            .iter()
            .flat_map(|&a| (0..3).map(move |c| equation(a, c)))
            .collect();
        s.push(n as u32);
        n += 1;
        stencils.push(s);
    }
    let pattern = pattern(n, &stencils);
    let map = ScatterMap::new(&pattern, stencils.iter().map(Vec::as_slice)).unwrap();
    let mut matrix = SparseMatrix::zeros(Arc::clone(&pattern));
    let mut local = [0.0; 576];
    for e in 0..elements {
        let b: Vec<f64> = (0..576).map(|_| random.value()).collect();
        for i in 0..24 {
            for j in 0..24 {
                let dot: f64 = (0..24).map(|q| b[24 * q + i] * b[24 * q + j]).sum();
                let skew = if symmetric { 0.0 } else { random.value() };
                let mass = if i == j { 2.0 } else { 0.0 };
                local[24 * i + j] = 1e3 * (dot + 0.1 * skew + mass);
            }
        }
        map.add(e, &local, &mut matrix.values);
    }
    for l in 0..multipliers {
        let mut local = [0.0; 256];
        for i in 0..15 {
            let g = if i < 3 { 1.0 } else { -0.25 } * (1.0 + 0.2 * random.value());
            local[16 * i + 15] = g;
            local[16 * 15 + i] = g * if symmetric { 1.0 } else { 1.0 + 0.1 * random.value() };
        }
        map.add(elements + l, &local, &mut matrix.values);
    }
    let rhs = (0..n).map(|_| random.value()).collect();
    (matrix, rhs)
}
