//! Elastic blocks of trilinear cells, held, free, or in contact by made-up multipliers.

mod condensation;
mod contact;
mod entries;
mod levels;
mod solutions;

use crate::iterative::IterativeSolver;
use crate::{EquationPlace, MatrixKind, NONE, ScatterMap, SparseMatrix, SparsityPattern};
use std::sync::Arc;

/// A box of cells.
#[derive(Clone, Copy)]
pub struct Body {
    pub cells: [usize; 3],
    pub size: [f64; 3],
    pub at: [f64; 3],
    pub young: f64,
    pub poisson: f64,
    /// Mass of a unit of volume over the square of a step.
    pub inertia: f64,
    /// Part of the stiffness that is added to it times the skew part of a rotation of the columns: zero for a symmetric matrix.
    pub skew: f64,
}

pub const CUBE: Body =
    Body { cells: [1; 3], size: [1.0; 3], at: [0.0; 3], young: 1e3, poisson: 0.3, inertia: 0.0, skew: 0.0 };

pub fn cube(n: usize) -> Body {
    Body { cells: [n; 3], ..CUBE }
}

impl Body {
    pub fn node(&self, i: usize, j: usize, k: usize) -> usize {
        i + (self.cells[0] + 1) * (j + (self.cells[1] + 1) * k)
    }

    pub fn nodes(&self) -> usize {
        self.cells.iter().map(|n| n + 1).product()
    }

    fn positions(&self) -> Vec<[f64; 3]> {
        let [nx, ny, nz] = self.cells;
        let mut out = Vec::new();
        for k in 0..=nz {
            for j in 0..=ny {
                for i in 0..=nx {
                    let c = [i, j, k];
                    out.push(std::array::from_fn(|d| self.at[d] + self.size[d] * c[d] as f64 / self.cells[d] as f64));
                }
            }
        }
        out
    }

    fn elements(&self) -> Vec<[usize; 8]> {
        let [nx, ny, nz] = self.cells;
        let corner =
            |i: usize, j: usize, k: usize| move |c: usize| self.node(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2));
        let mut out = Vec::new();
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    out.push(std::array::from_fn(corner(i, j, k)));
                }
            }
        }
        out
    }

    /// Stiffness and inertia of a cell, 24 x 24, with 2 x 2 x 2 points of Gauss.
    fn element(&self) -> Vec<f64> {
        let h: [f64; 3] = std::array::from_fn(|d| self.size[d] / self.cells[d] as f64);
        let (e, nu) = (self.young, self.poisson);
        let (lambda, mu) = (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)));
        let mut k = vec![0.0; 576];
        let g = 1.0 / 3.0_f64.sqrt();
        for point in 0..8 {
            let xi: [f64; 3] = std::array::from_fn(|d| if (point >> d) & 1 == 0 { -g } else { g });
            let side = |c: usize, d: usize| if (c >> d) & 1 == 0 { -1.0 } else { 1.0 };
            let one = |c: usize, d: usize| 0.5 * (1.0 + side(c, d) * xi[d]);
            let shape = |c: usize| one(c, 0) * one(c, 1) * one(c, 2);
            let gradient = |c: usize| -> [f64; 3] {
                std::array::from_fn(|d| side(c, d) / h[d] * one(c, (d + 1) % 3) * one(c, (d + 2) % 3))
            };
            let weight = h[0] * h[1] * h[2] / 8.0;
            for a in 0..8 {
                for b in 0..8 {
                    let (ga, gb) = (gradient(a), gradient(b));
                    let dot: f64 = (0..3).map(|d| ga[d] * gb[d]).sum();
                    for r in 0..3 {
                        for c in 0..3 {
                            let mut v = lambda * ga[r] * gb[c] + mu * ga[c] * gb[r];
                            if r == c {
                                v += mu * dot + self.inertia * shape(a) * shape(b);
                            }
                            v += self.skew * mu * (ga[r] * gb[c] - ga[c] * gb[r]);
                            k[24 * (3 * a + r) + 3 * b + c] += weight * v;
                        }
                    }
                }
            }
        }
        k
    }
}

/// A multiplier: its force on nodes, its row at nodes.
#[derive(Clone, Default)]
pub struct Multiplier {
    pub slot: u32,
    pub b: Vec<(usize, [f64; 3])>,
    pub c: Vec<(usize, [f64; 3])>,
    /// Entries at multipliers in its row.
    pub d: Vec<(usize, f64)>,
}

/// A system with the places of its equations.
pub struct System {
    pub matrix: SparseMatrix,
    pub places: Vec<EquationPlace>,
    pub rhs: Vec<f64>,
}

impl System {
    pub fn pattern(&self) -> &Arc<SparsityPattern> {
        &self.matrix.pattern
    }
}

/// Number of the first node of each body, and of all.
pub fn offsets(bodies: &[Body]) -> Vec<usize> {
    bodies.iter().fold(vec![0], |mut sums, body| {
        sums.push(sums[sums.len() - 1] + body.nodes());
        sums
    })
}

/// The system of bodies whose components are `held` by body and position, with multipliers.
pub fn system(bodies: &[Body], held: impl Fn(usize, [f64; 3]) -> [bool; 3], multipliers: &[Multiplier]) -> System {
    let offsets = offsets(bodies);
    let mut equation = Vec::new();
    let mut places = Vec::new();
    for (b, body) in bodies.iter().enumerate() {
        for (k, x) in body.positions().into_iter().enumerate() {
            for (d, held) in held(b, x).into_iter().enumerate() {
                if held {
                    equation.push(NONE);
                } else {
                    equation.push(places.len() as u32);
                    let node = (offsets[b] + k) as u32;
                    places.push(EquationPlace::Node { body: b as u32, node, component: d as u8, position: x });
                }
            }
        }
    }
    let free = places.len();
    places.extend(multipliers.iter().map(|m| EquationPlace::Multiplier { pair: 0, slot: m.slot }));
    let n = places.len();
    let mut stencils: Vec<Vec<u32>> = Vec::new();
    for (b, body) in bodies.iter().enumerate() {
        for element in body.elements() {
            let nodes = element.iter().map(|node| 3 * (offsets[b] + node));
            stencils.push(nodes.flat_map(|first| equation[first..first + 3].to_vec()).collect());
        }
    }
    for (k, m) in multipliers.iter().enumerate() {
        let nodes = m.b.iter().chain(&m.c).map(|(node, _)| 3 * node);
        let mut stencil: Vec<u32> = nodes.flat_map(|first| equation[first..first + 3].to_vec()).collect();
        stencil.extend(m.d.iter().map(|(j, _)| (free + j) as u32));
        stencil.push((free + k) as u32);
        stencils.push(stencil);
    }
    // A slave node and its multipliers together, as the multifrontal solver wants them.
    let mut groups: Vec<u32> =
        places.iter().map(|place| if let EquationPlace::Node { node, .. } = place { *node } else { NONE }).collect();
    multipliers.iter().enumerate().for_each(|(k, m)| groups[free + k] = m.b.first().map_or(NONE, |b| b.0 as u32));
    let lists = || stencils.iter().map(Vec::as_slice);
    let pattern = SparsityPattern::from_stencils(n, lists()).unwrap();
    let pattern = if groups.contains(&NONE) { pattern } else { pattern.with_groups(groups).unwrap() };
    let pattern = Arc::new(pattern.with_first_multiplier(free));
    let map = ScatterMap::new(&pattern, lists()).unwrap();
    let mut matrix = SparseMatrix::zeros(Arc::clone(&pattern));
    let mut e = 0;
    for body in bodies {
        let local = body.element();
        for _ in body.elements() {
            map.add(e, &local, &mut matrix.values);
            e += 1;
        }
    }
    let mut add = |row: u32, column: u32, value: f64| {
        if row != NONE && column != NONE {
            matrix.values[pattern.position(row, column).unwrap()] += value;
        }
    };
    for (k, m) in multipliers.iter().enumerate() {
        let own = (free + k) as u32;
        for d in 0..3 {
            m.b.iter().for_each(|(node, b)| add(equation[3 * node + d], own, b[d]));
            m.c.iter().for_each(|(node, c)| add(own, equation[3 * node + d], c[d]));
        }
        m.d.iter().for_each(|&(j, v)| add(own, (free + j) as u32, v));
    }
    // A load along z that grows with x, and something on every equation.
    let load = |(i, place): (usize, &EquationPlace)| match place {
        EquationPlace::Node { component: 2, position, .. } => {
            -1.0 - position[0] + 0.1 * crate::vector::pseudo_random(i)
        }
        EquationPlace::Node { .. } => 0.1 * crate::vector::pseudo_random(i),
        _ => 1e-3 * crate::vector::pseudo_random(i),
    };
    let rhs = places.iter().enumerate().map(load).collect();
    System { matrix, places, rhs }
}

/// Clamped where `z = 0`.
pub fn clamped(_: usize, x: [f64; 3]) -> [bool; 3] {
    [x[2] == 0.0; 3]
}

/// `|b - A x| / |b|`.
pub fn relative_residual(system: &System, x: &[f64]) -> f64 {
    let mut r = vec![0.0; x.len()];
    system.matrix.multiply(x, &mut r);
    r.iter_mut().zip(&system.rhs).for_each(|(r, b)| *r -= b);
    crate::vector::norm2(&r) / crate::vector::norm2(&system.rhs)
}

/// A solver with the places and the pattern.
pub fn prepared(system: &System, kind: MatrixKind) -> IterativeSolver {
    let mut solver = IterativeSolver::default();
    solver.place(&mut system.places.iter().copied());
    solver.analyse(system.pattern(), kind);
    solver
}
