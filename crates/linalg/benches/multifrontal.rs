//! The multifrontal solver against faer's LU on tangents of contact problems: CPU seconds (medians of three), memory, backward error, and ratios
//! in one run. Each solver runs in a process of its own, so that the growth of the peak memory is its own.
//!
//!     cargo bench -p stoss-linalg --bench multifrontal [-- NAME ...]
//!     cargo bench -p stoss-linalg --bench multifrontal -- pairs [NAME ...]
//!
//! A NAME is one of the systems made here, or the file of a system that a run has written (`stoss run SCENE --systems N`), for instance
//! `tori.out/systems/system-000003.mtx`; LDL' is for those whose names end in `symmetric`.
//!
//! `pairs` runs LU, LDL' and both numbers of threads in turn in one process, so that a drift of the machine's speed shows in all of them: CPU time of
//! LDL' over LU (median of the rounds), wall time of two threads over one (of the fastest rounds).

#[path = "../tests/common/mod.rs"]
mod common;

use common::tangents::{Setting, block_pair, tori};
use cpu_time::ProcessTime;
use std::path::Path;
use std::process::Command;
use std::time::Instant;
use stoss_linalg::matrix_market::read_system;
use stoss_linalg::{FaerSolver, LinearSolver, MatrixKind, MultifrontalSolver, SparseMatrix};

const SYSTEMS: [&str; 8] = [
    "pair-4k-symmetric",
    "pair-4k",
    "tori-26k-symmetric",
    "tori-26k",
    "pair-30k-symmetric",
    "pair-30k",
    "pair-30k-scaled-symmetric",
    "pair-30k-scaled",
];
const SOLVERS: [(&str, &str); 5] = [
    ("faer LU", "1"),
    ("multifrontal LU", "1"),
    ("multifrontal LU", "2"),
    ("multifrontal LDL'", "1"),
    ("multifrontal LDL'", "2"),
];

fn is_symmetric(name: &str) -> bool {
    name.trim_end_matches(".mtx").ends_with("symmetric")
}

/// The names given, in this order, or all systems made here.
fn chosen(names: &[String]) -> Vec<String> {
    match names {
        [] => SYSTEMS.map(str::to_owned).to_vec(),
        names => names.to_vec(),
    }
}

fn system(name: &str) -> (SparseMatrix, Vec<f64>) {
    if name.ends_with(".mtx") {
        let file = read_system(Path::new(name)).unwrap();
        return (file.matrix, file.rhs);
    }
    assert!(SYSTEMS.contains(&name), "no system {name}; there are {SYSTEMS:?} and files");
    let mut setting = Setting::new(!is_symmetric(name));
    if name.contains("scaled") {
        setting = Setting { contrast: 1e6, penalty: 1e7, inertia: 1.0, ..setting };
    }
    match name.split('-').take(2).collect::<Vec<_>>()[..] {
        ["tori", _] => tori([52, 20, 3], 330, setting),
        ["pair", "4k"] => block_pair(10, setting),
        _ => block_pair(20, setting),
    }
}

/// Peak resident memory in MB; 0 where the system does not tell.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:")).unwrap_or("");
    line.split_whitespace().next().and_then(|kb| kb.parse::<f64>().ok()).unwrap_or(0.0) / 1024.0
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Prints analyse, factorise (CPU and wall), solve, memory, backward error, refinement steps, fallbacks.
fn measure(name: &str, solver: &str, threads: usize) {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().unwrap();
    let (matrix, rhs) = system(name);
    let (mut solver, kind): (Box<dyn LinearSolver>, MatrixKind) = match solver {
        "faer LU" => (Box::new(FaerSolver::new()), MatrixKind::General),
        "multifrontal LU" => (Box::new(MultifrontalSolver::new()), MatrixKind::General),
        _ => (Box::new(MultifrontalSolver::new()), MatrixKind::Symmetric),
    };
    let mut x = vec![0.0; rhs.len()];
    let before = peak();
    let start = ProcessTime::now();
    solver.analyse(&matrix.pattern, kind).unwrap();
    let analyse = start.elapsed().as_secs_f64();
    solver.factorise(&matrix.values).unwrap();
    let (mut factorise, mut wall, mut solve) = (Vec::new(), Vec::new(), Vec::new());
    let mut report = None;
    for _ in 0..3 {
        let (start, clock) = (ProcessTime::now(), Instant::now());
        solver.factorise(&matrix.values).unwrap();
        factorise.push(start.elapsed().as_secs_f64());
        wall.push(clock.elapsed().as_secs_f64());
        let start = ProcessTime::now();
        report = Some(solver.solve(&rhs, &mut x).unwrap());
        solve.push(start.elapsed().as_secs_f64());
    }
    let report = report.unwrap();
    println!(
        "{analyse} {} {} {} {} {} {} {}",
        median(factorise),
        median(wall),
        median(solve),
        peak() - before,
        report.backward_error,
        report.refinement_steps,
        solver.statistics().pivoting_fallbacks
    );
}

/// CPU and wall seconds of a refactorisation.
fn time(pool: &rayon::ThreadPool, solver: &mut MultifrontalSolver, values: &[f64]) -> (f64, f64) {
    let (start, clock) = (ProcessTime::now(), Instant::now());
    pool.install(|| solver.factorise(values)).unwrap();
    (start.elapsed().as_secs_f64(), clock.elapsed().as_secs_f64())
}

/// LU on one thread, on two, LDL' on one, on two, and again.
fn pairs(name: &str, rounds: usize) {
    let pools = [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    let (matrix, _) = system(name);
    let kinds = [MatrixKind::General, MatrixKind::Symmetric];
    let kinds = if is_symmetric(name) { &kinds[..] } else { &kinds[..1] };
    let mut solvers: Vec<MultifrontalSolver> = kinds.iter().map(|_| MultifrontalSolver::new()).collect();
    for (solver, kind) in solvers.iter_mut().zip(kinds) {
        solver.analyse(&matrix.pattern, *kind).unwrap();
        for pool in &pools {
            time(pool, solver, &matrix.values);
        }
    }
    let mut times = vec![[Vec::new(), Vec::new()]; 2 * kinds.len()];
    for _ in 0..rounds {
        for (s, solver) in solvers.iter_mut().enumerate() {
            for (p, pool) in pools.iter().enumerate() {
                let (cpu, wall) = time(pool, solver, &matrix.values);
                times[2 * s + p][0].push(cpu);
                times[2 * s + p][1].push(wall);
            }
        }
    }
    let least = |list: &[f64]| list.iter().copied().fold(f64::INFINITY, f64::min);
    for (s, kind) in kinds.iter().enumerate() {
        let [one, two] = [&times[2 * s], &times[2 * s + 1]];
        let base = &times[0][0];
        let mut ratios: Vec<f64> = one[0].iter().zip(base).map(|(a, b)| a / b).collect();
        ratios.sort_by(f64::total_cmp);
        println!(
            "| {name} | {kind:?} | {:.3} s | {:.2} | {:.3} s | {:.3} s | {:.2} | {:.2} |",
            median(one[0].clone()),
            median(ratios),
            least(&one[1]),
            least(&two[1]),
            least(&two[1]) / least(&one[1]),
            median(two[0].clone()) / median(one[0].clone())
        );
    }
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    if let [key, name, solver, threads] = &args[..]
        && key == "measure"
    {
        return measure(name, solver, threads.parse().unwrap());
    }
    if let [key, names @ ..] = &args[..]
        && key == "pairs"
    {
        println!(
            "| system | kind | CPU, 1 thread | over LU | wall, 1 thread | wall, 2 threads | 2 over 1 | CPU, 2 over 1 |"
        );
        println!("|---|---|---|---|---|---|---|---|");
        for name in chosen(names) {
            pairs(&name, 9);
        }
        return;
    }
    println!(
        "| system | solver | threads | analyse | factorise | ratio | wall | solve | MB | ratio | backward error | steps | fallbacks |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for name in chosen(&args) {
        let mut reference: Option<Vec<f64>> = None;
        for (solver, threads) in SOLVERS {
            if solver.ends_with("LDL'") && !is_symmetric(&name) {
                continue;
            }
            let output = Command::new(std::env::current_exe().unwrap())
                .args(["measure", &name, solver, threads])
                .output()
                .unwrap();
            let text = String::from_utf8_lossy(&output.stdout);
            let values: Vec<f64> = text.split_whitespace().filter_map(|v| v.parse().ok()).collect();
            let [analyse, factorise, wall, solve, memory, error, steps, fallbacks] = values[..] else {
                println!("| {name} | {solver} | {threads} | failed: {} |", String::from_utf8_lossy(&output.stderr));
                continue;
            };
            let base = reference.get_or_insert_with(|| values.clone());
            println!(
                "| {name} | {solver} | {threads} | {analyse:.3} s | {factorise:.3} s | {:.2} | {wall:.3} s | {solve:.3} s | {memory:.0} | {:.2} | {error:.1e} | {steps} | {fallbacks} |",
                factorise / base[1],
                memory / base[4]
            );
        }
    }
}
