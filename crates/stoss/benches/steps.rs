//! Whole steps: search, assembly, factorisation and solution of shipped scenes, without output of files.
//!
//! `cargo bench -p stoss`; a figure is for all the steps in the name, with steps per second below it. Building the simulation
//! is not measured.

use criterion::{BatchSize, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use std::{path::Path, time::Duration};
use stoss::build::build;
use stoss::solver::Simulation;

/// Name of the scene, its text, and the steps that are measured at most.
const SCENES: [(&str, &str, u64); 3] = [
    ("two-blocks", include_str!("../../../scenes/two-blocks.toml"), u64::MAX),
    ("free-bar", include_str!("../../../scenes/free-bar.toml"), u64::MAX),
    // The first node closes in step 11.
    ("block-impact", include_str!("../../../scenes/block-impact.toml"), 50),
];

fn simulation(name: &str, text: &str) -> Simulation {
    let scene = stoss::scene::parse(text, name).expect("a shipped scene is well-formed");
    build(&scene, Path::new(".")).expect("a shipped scene can be built").simulation
}

/// Runs to the end, or to the given step; returns the steps done.
fn advance(simulation: &mut Simulation, steps: u64) -> u64 {
    while !simulation.finished() && simulation.step() < steps {
        simulation.advance().expect("a shipped scene runs through");
    }
    simulation.step()
}

fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("steps");
    group.sampling_mode(SamplingMode::Flat);
    for (name, text, limit) in SCENES {
        // Halved steps are steps too: the number is not known before.
        let steps = advance(&mut simulation(name, text), limit);
        group.throughput(Throughput::Elements(steps));
        group.bench_function(format!("{name}, {steps} steps"), |bencher| {
            bencher.iter_batched_ref(
                || simulation(name, text),
                |simulation| advance(simulation, limit),
                BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

criterion_group! {
    name = group;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = benches
}
criterion_main!(group);
