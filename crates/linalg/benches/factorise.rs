//! Analysis, factorisation and solution on patterns of hexahedral meshes: blocks of `n^3` hex8 with three equations a node,
//! with and without a saddle-point block of 3 % of the equations (one multiplier a surface node, coupled with five nodes).

#[path = "../tests/common/mod.rs"]
mod common;

use common::hex_system;
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use stoss_linalg::{DenseSolver, FaerSolver, LinearSolver, MatrixKind, MultifrontalSolver};

/// Elements per edge; 144, 300, 540, 882, 1944, 2700 and 11520 displacement components (one face is clamped).
const SIZES: [usize; 7] = [3, 4, 5, 6, 8, 9, 15];

fn solvers(n: usize, kind: MatrixKind) -> Vec<(&'static str, Box<dyn LinearSolver>)> {
    let mut list: Vec<(&'static str, Box<dyn LinearSolver>)> =
        vec![("faer", Box::new(FaerSolver::new())), ("multifrontal", Box::new(MultifrontalSolver::new()))];
    if n <= 1100 && kind == MatrixKind::General {
        list.push(("dense", Box::new(DenseSolver::new())));
    }
    list
}

fn benches(c: &mut Criterion) {
    for (what, share, kind) in [
        ("saddle", 0.03, MatrixKind::General),
        ("unsymmetric", 0.0, MatrixKind::General),
        ("spd", 0.0, MatrixKind::SymmetricPositiveDefinite),
    ] {
        for size in SIZES {
            let (matrix, rhs) = hex_system(size, share, kind != MatrixKind::General);
            let n = rhs.len();
            let mut x = vec![0.0; n];
            for (name, mut solver) in solvers(n, kind) {
                let mut group = c.benchmark_group(format!("{what}/{name}"));
                group.sample_size(10);
                group.warm_up_time(std::time::Duration::from_millis(300));
                group.measurement_time(std::time::Duration::from_millis(1000));
                group.bench_function(BenchmarkId::new("analyse", n), |b| {
                    b.iter(|| {
                        // An empty pattern in between defeats the cache.
                        let empty = common::pattern(0, &[]);
                        solver.analyse(&empty, kind).unwrap();
                        solver.analyse(&matrix.pattern, kind).unwrap();
                    });
                });
                // A filter may have left out the benchmark above.
                solver.analyse(&matrix.pattern, kind).unwrap();
                solver.factorise(&matrix.values).unwrap();
                group.bench_function(BenchmarkId::new("factorise", n), |b| {
                    b.iter(|| solver.factorise(&matrix.values).unwrap());
                });
                group.bench_function(BenchmarkId::new("solve", n), |b| {
                    b.iter(|| solver.solve(&rhs, &mut x).unwrap());
                });
                let report = solver.solve(&rhs, &mut x).unwrap();
                println!("{what}/{name}/{n}: {report:?}, {} kB", solver.memory_bytes() / 1024);
            }
        }
    }
}

criterion_group!(group, benches);
criterion_main!(group);
