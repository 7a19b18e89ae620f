//! What of the crate needs MPI, on any number of ranks: `mpirun -n P ranks`. Sums, texts and exchanges; a saddle point, factorised three times with other values; negative pivots, against closed forms;
//! a body that nothing holds; multigrid against factors; options that are wrong. With `panic` the last rank panics while the others wait: all end, with one message and the code 1.

use std::sync::Arc;
use stoss_linalg::{Communicator, EquationPlace, LinalgError, LinearSolver, MatrixKind, SparsityPattern};
use stoss_linalg_petsc::{Method, Mpi, PetscSolver};

fn main() {
    let mpi = Mpi::start().expect("MPI");
    if std::env::args().any(|argument| argument == "panic") {
        assert!(mpi.rank() + 1 != mpi.size(), "the last rank has enough");
        let all: &dyn Communicator = &*mpi;
        all.sum_of(1.0);
    }
    talk(&*mpi);
    saddle_point(&mpi);
    negative_pivots(&mpi);
    free_body(&mpi);
    let iterations = multigrid(&mpi);
    wrong_options(&mpi);
    if mpi.rank() == 0 {
        println!("{} ranks: all well, {iterations} iterations with multigrid", mpi.size());
    }
    Mpi::end();
}

fn talk(all: &dyn Communicator) {
    let (rank, size) = (all.rank(), all.size());
    // In the order of the ranks: 0.1 + 0.2 + 0.3 is not 0.3 + 0.2 + 0.1.
    let mut values = [0.1 * (rank as f64 + 1.0), 1.0];
    all.sum(&mut values);
    let expected = (1..size).fold(0.1, |sum, r| sum + 0.1 * (r as f64 + 1.0));
    assert_eq!(values, [expected, size as f64]);
    assert_eq!(all.first_text((rank + 1 == size).then_some("last")).as_deref(), Some("last"));
    assert_eq!(all.first_text(None), None);
    // Rank r sends r + 1 numbers to each.
    let send: Vec<f64> = (0..size).flat_map(|to| vec![(10 * rank + to) as f64; rank + 1]).collect();
    let counts: Vec<usize> = (1..=size).collect();
    let mut received = vec![0.0; counts.iter().sum()];
    all.exchange(&send, &vec![rank + 1; size], &mut received, &counts);
    let expected: Vec<f64> = (0..size).flat_map(|from| vec![(10 * from + rank) as f64; from + 1]).collect();
    assert_eq!(received, expected);
    let mine = vec![rank as u8; rank];
    assert!(all.gather_bytes(&mine).iter().enumerate().all(|(from, bytes)| *bytes == vec![from as u8; from]));
}

/// A system of stencils, each of which is one rank's.
struct Parts {
    n: usize,
    stencils: Vec<Vec<u32>>,
    owner_of_stencil: Vec<usize>,
    places: Vec<EquationPlace>,
    owner_of_equation: Vec<u32>,
}

impl Parts {
    fn node(node: u32, component: u8, position: [f64; 3]) -> EquationPlace {
        EquationPlace::Node { body: 0, node, component, position }
    }

    fn solver(&self, mpi: &Arc<Mpi>, method: Method, kind: MatrixKind) -> (PetscSolver, Arc<SparsityPattern>) {
        let own = |stencil: usize| self.owner_of_stencil[stencil] == mpi.rank();
        let stencils = self.stencils.iter().enumerate().map(|(s, stencil)| if own(s) { &stencil[..] } else { &[] });
        let owns = |equation: usize| self.owner_of_equation[equation] as usize == mpi.rank();
        let pattern = SparsityPattern::from_own_stencils(self.n, stencils, owns).expect("pattern");
        let pattern = Arc::new(pattern);
        let mut solver = PetscSolver::new(Arc::clone(mpi), method);
        solver.place(&mut self.places.iter().copied());
        solver.spread(&mut self.owner_of_equation.iter().copied());
        solver.analyse(&pattern, kind).expect("analyse");
        (solver, pattern)
    }

    /// Values of the rank's part of a matrix that is the sum of `entry(stencil, row, column)`.
    fn values(&self, mpi: &Mpi, pattern: &SparsityPattern, entry: &dyn Fn(usize, u32, u32) -> f64) -> Vec<f64> {
        let mut values = vec![0.0; pattern.nnz()];
        for (s, stencil) in self.stencils.iter().enumerate().filter(|(s, _)| self.owner_of_stencil[*s] == mpi.rank()) {
            for &j in stencil {
                for &i in stencil {
                    values[pattern.position(i, j).expect("an entry")] += entry(s, i, j);
                }
            }
        }
        values
    }

    /// The whole matrix times a vector.
    fn times(&self, entry: &dyn Fn(usize, u32, u32) -> f64, x: &[f64]) -> Vec<f64> {
        let mut b = vec![0.0; self.n];
        for (s, stencil) in self.stencils.iter().enumerate() {
            for &i in stencil {
                for &j in stencil {
                    b[i as usize] += entry(s, i, j) * x[j as usize];
                }
            }
        }
        b
    }
}

/// Nodes of the chain.
const NODES: u32 = 40;

/// A chain of nodes, each coupled to the next one by a unit spring for each component and held by one of stiffness `1`; multipliers keep the ends at the same place.
fn chain(mpi: &Mpi, tied: bool) -> Parts {
    let owner = |node: u32| node as usize * mpi.size() / NODES as usize;
    let n = 3 * NODES + if tied { 3 } else { 0 };
    let springs = (0..NODES - 1).map(|k| (3 * k..3 * k + 6).collect());
    let tie = vec![0, 1, 2, 3 * NODES - 3, 3 * NODES - 2, 3 * NODES - 1, 3 * NODES, 3 * NODES + 1, 3 * NODES + 2];
    let node = |e: u32| Parts::node(e / 3, (e % 3) as u8, [f64::from(e / 3), 0.0, 0.0]);
    let multiplier = |slot: u32| EquationPlace::Multiplier { pair: 0, slot };
    Parts {
        n: n as usize,
        stencils: springs.chain(tied.then_some(tie)).collect(),
        owner_of_stencil: (0..NODES - 1).chain(tied.then_some(0)).map(owner).collect(),
        places: (0..3 * NODES).map(node).chain((0..n - 3 * NODES).map(multiplier)).collect(),
        owner_of_equation: (0..n).map(|e| if e < 3 * NODES { owner(e / 3) as u32 } else { 0 }).collect(),
    }
}

/// Entries of the chain; `held`: whether springs hold its nodes to the ground, too.
fn of_chain(held: bool) -> impl Fn(usize, u32, u32) -> f64 {
    move |s, i, j| {
        let (spring, ends) = (s as u32 + 1 < NODES, [0, NODES - 1]);
        let component = i % 3 == j % 3;
        match (i < 3 * NODES, j < 3 * NODES) {
            _ if !component => 0.0,
            (true, true) if spring && i == j => {
                let ground = f64::from(u8::from(i / 3 == s as u32)) + f64::from(u8::from(i / 3 == NODES - 1));
                1.0 + if held { ground } else { 0.0 }
            }
            (true, true) if spring => -1.0,
            (true, false) | (false, true) => match i.min(j) / 3 {
                node if node == ends[0] => 1.0,
                node if node == ends[1] => -1.0,
                _ => 0.0,
            },
            _ => 0.0,
        }
    }
}

/// Smooth numbers that are not small.
fn wanted(n: usize) -> Vec<f64> {
    (0..n).map(|e| (0.7 * e as f64).sin() + 2.0).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs()))
}

/// Values that are set again must replace those before.
fn saddle_point(mpi: &Arc<Mpi>) {
    let parts = chain(mpi, true);
    for kind in [MatrixKind::General, MatrixKind::Symmetric] {
        let (mut solver, pattern) = parts.solver(mpi, Method::Direct, kind);
        for round in 1..4 {
            let entry = |s, i, j| f64::from(round) * of_chain(true)(s, i, j);
            let exact = wanted(parts.n);
            solver.factorise(&parts.values(mpi, &pattern, &entry)).expect("factorise");
            let mut x = vec![0.0; parts.n];
            let report = solver.solve(&parts.times(&entry, &exact), &mut x).expect("solve");
            assert!(report.backward_error < 1e-15, "{report:?}");
            assert!(largest_difference(&x, &exact) < 1e-13, "{kind:?}, round {round}");
        }
        assert!(solver.memory_bytes() > 0 && solver.statistics().factorisations == 3);
    }
}

/// One negative pivot for each multiplier; and for a chain without ground, shifted by `-s`, as many as eigenvalues `2 - 2 cos(k pi / n)`, `k = 0 .. n`, are smaller than `s`, three times.
fn negative_pivots(mpi: &Arc<Mpi>) {
    let tied = chain(mpi, true);
    let (mut solver, pattern) = tied.solver(mpi, Method::Direct, MatrixKind::Symmetric);
    solver.factorise(&tied.values(mpi, &pattern, &of_chain(true))).expect("factorise");
    assert_eq!(solver.negative_eigenvalues(), Some(3));
    let free = chain(mpi, false);
    let (mut solver, pattern) = free.solver(mpi, Method::Direct, MatrixKind::Symmetric);
    let values = free.values(mpi, &pattern, &of_chain(false));
    for shift in [0.001, 0.5, 3.999] {
        let mut shifted = values.clone();
        for e in (0..free.n).filter(|&e| free.owner_of_equation[e] as usize == mpi.rank()) {
            shifted[pattern.position(e as u32, e as u32).expect("the diagonal")] -= shift;
        }
        solver.factorise(&shifted).expect("factorise");
        let eigenvalue = |k: u32| 2.0 - 2.0 * (f64::from(k) * std::f64::consts::PI / f64::from(NODES)).cos();
        let below = (0..NODES).filter(|&k| eigenvalue(k) < shift).count();
        assert_eq!(solver.negative_eigenvalues(), Some(3 * below), "shift {shift}");
    }
    let (mut general, pattern) = free.solver(mpi, Method::Direct, MatrixKind::General);
    general.factorise(&free.values(mpi, &pattern, &of_chain(true))).expect("factorise");
    assert_eq!(general.negative_eigenvalues(), None);
}

fn free_body(mpi: &Arc<Mpi>) {
    let parts = chain(mpi, false);
    for kind in [MatrixKind::General, MatrixKind::Symmetric] {
        let (mut solver, pattern) = parts.solver(mpi, Method::Direct, kind);
        let result = solver.factorise(&parts.values(mpi, &pattern, &of_chain(false)));
        assert_eq!(result, Err(LinalgError::Singular { row: None }), "{kind:?}");
        let mut wrong = parts.values(mpi, &pattern, &of_chain(true));
        if mpi.rank() + 1 == mpi.size() {
            wrong[0] = f64::NAN;
        }
        assert!(matches!(solver.factorise(&wrong), Err(LinalgError::NonFinite { index: 0, .. })));
        assert!(matches!(solver.solve(&[], &mut []), Err(LinalgError::CallOrder { .. })));
    }
}

/// Nodes along an edge of the block.
const EDGE: u32 = 9;

/// A block of cells of springs along all lines between their eight nodes, with one face that does not move and, in another node, one component that is prescribed.
fn block(mpi: &Mpi) -> Parts {
    let nodes: Vec<[u32; 3]> = (0..EDGE.pow(3)).map(|k| [k / EDGE / EDGE, k / EDGE % EDGE, k % EDGE]).collect();
    let owner = |node: u32| (nodes[node as usize][0] as usize * mpi.size() / EDGE as usize) as u32;
    let mut equation = vec![None; 3 * nodes.len()];
    let (mut places, mut owners) = (Vec::new(), Vec::new());
    for (k, place) in nodes.iter().enumerate().filter(|(_, place)| place[0] > 0) {
        for component in (0..3).filter(|&component| component != 1 || *place != [EDGE - 1; 3]) {
            equation[3 * k + component] = Some(places.len() as u32);
            places.push(Parts::node(k as u32, component as u8, place.map(f64::from)));
            owners.push(owner(k as u32));
        }
    }
    let cells = nodes.iter().filter(|place| place.iter().all(|&c| c + 1 < EDGE));
    let of_cell = |place: &[u32; 3]| -> Vec<u32> {
        let corner = |c: u32| ((place[0] + c / 4) * EDGE + place[1] + c / 2 % 2) * EDGE + place[2] + c % 2;
        (0..8).flat_map(|c| (0..3).map(move |d| 3 * corner(c) + d)).filter_map(|e| equation[e as usize]).collect()
    };
    let stencils: Vec<Vec<u32>> = cells.map(of_cell).collect();
    let first = |stencil: &Vec<u32>| owners[stencil[0] as usize] as usize;
    Parts {
        n: places.len(),
        owner_of_stencil: stencils.iter().map(first).collect(),
        stencils,
        places,
        owner_of_equation: owners,
    }
}

/// Springs of unit stiffness, those to nodes that do not move and have no equations included.
fn of_block(parts: &Parts) -> impl Fn(usize, u32, u32) -> f64 {
    let at = |e: u32| match parts.places[e as usize] {
        EquationPlace::Node { node, component, position, .. } => (node, component as usize, position),
        _ => unreachable!("all equations are of nodes"),
    };
    move |s, i, j| {
        let ((a, c, x), (b, d, y)) = (at(i), at(j));
        let tensor = |to: [f64; 3], from: [f64; 3]| {
            let length: f64 = (0..3).map(|k| (to[k] - from[k]).powi(2)).sum();
            (to[c] - from[c]) * (to[d] - from[d]) / length
        };
        if a != b {
            return -tensor(x, y);
        }
        // All eight corners of the cell, from its largest one.
        let mut top = [0.0_f64; 3];
        parts.stencils[s].iter().for_each(|&e| (0..3).for_each(|k| top[k] = top[k].max(at(e).2[k])));
        let corner = |c: u8| std::array::from_fn(|k| top[k] - f64::from(c >> k & 1));
        (0..8).map(corner).filter(|other| *other != x).map(|other| tensor(x, other)).sum()
    }
}

/// Returns the iterations.
fn multigrid(mpi: &Arc<Mpi>) -> u64 {
    let parts = block(mpi);
    let entry = of_block(&parts);
    let exact = wanted(parts.n);
    let rhs = parts.times(&entry, &exact);
    let mut iterations = 0;
    for kind in [MatrixKind::Symmetric, MatrixKind::General] {
        let (mut solver, pattern) = parts.solver(mpi, Method::Multigrid, kind);
        let values = parts.values(mpi, &pattern, &entry);
        let mut x = vec![0.0; parts.n];
        let count = solver.solve_nearby(&values, &rhs, &mut x, 1e-11).expect("solve");
        assert!(count.is_some_and(|count| count < 30), "{count:?}, {:?}", solver.take_reason());
        assert!(largest_difference(&x, &exact) < 1e-8, "{kind:?}: {:e}", largest_difference(&x, &exact));
        iterations += u64::from(count.unwrap_or(0));
        solver.factorise(&values).expect("factorise");
        let mut direct = vec![0.0; parts.n];
        solver.solve(&rhs, &mut direct).expect("solve");
        assert!(largest_difference(&direct, &exact) < 1e-12);
        if kind == MatrixKind::Symmetric {
            assert_eq!((solver.negative_eigenvalues(), solver.is_definite(&values)), (Some(0), Some(true)));
            // A matrix with directions of negative curvature, a few, is left to the factors, which count them.
            let mut shifted = values.clone();
            for e in (0..parts.n).filter(|&e| parts.owner_of_equation[e] as usize == mpi.rank()) {
                shifted[pattern.position(e as u32, e as u32).expect("the diagonal")] -= 0.5;
            }
            assert_eq!(solver.is_definite(&shifted), Some(false));
            assert_eq!(solver.solve_definite(&shifted, &rhs, &mut x, 1e-8), Ok(false));
            solver.factorise(&shifted).expect("factorise");
            assert!(solver.negative_eigenvalues().is_some_and(|count| count > 0 && count < parts.n / 10));
        }
    }
    iterations
}

fn wrong_options(mpi: &Arc<Mpi>) {
    let parts = chain(mpi, false);
    let tried = |options: &str| {
        let (mut solver, pattern) = parts.solver(mpi, Method::Options(options.to_owned()), MatrixKind::General);
        let values = parts.values(mpi, &pattern, &of_chain(true));
        let mut x = vec![0.0; parts.n];
        let rhs = parts.times(&of_chain(true), &wanted(parts.n));
        solver.factorise(&values).and_then(|()| solver.solve(&rhs, &mut x)).map_err(|error| error.to_string())
    };
    tried("-ksp_type gmres -pc_type jacobi -ksp_rtol 1e-10").expect("options that are right");
    let error = tried("-ksp_type gmres -pc_type jacobi -ksp_typo 1").expect_err("an option that does not exist");
    assert!(error.contains("-ksp_typo") && error.contains("PETSC_OPTIONS"), "{error}");
    let error = tried("-ksp_type nonsense").expect_err("a solver that does not exist");
    assert!(error.contains("nonsense"), "{error}");
    let error = tried("-ksp_type cg -pc_type none -ksp_max_it 2").expect_err("too few iterations");
    assert!(error.contains("DIVERGED_ITS after 2 iterations"), "{error}");
}
