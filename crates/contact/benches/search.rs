//! Cost of the search over a warped surface of 40 x 40 facets: build, refit, and closest points of 1600 slave nodes.
//!
//! `cargo bench -p stoss-contact`; a figure of the group `queries` is for all its points, with points per second below it.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Vector3;
use std::{hint::black_box, time::Duration};
use stoss_contact::{ContactSurface, MasterSearch, SearchOptions};

/// Facets along an edge of the surface; their edges have length one.
const FACETS: usize = 40;

/// Height of the surface over the point `(x, y)`; `phase` moves the waves.
fn height(x: f64, y: f64, phase: f64) -> f64 {
    1.5 * (0.3 * x + phase).sin() * (0.25 * y).cos() + 0.05 * (2.1 * x + 1.7 * y).sin()
}

/// Positions of all nodes.
fn positions(phase: f64) -> Vec<f64> {
    let node = |k: usize| ((k % (FACETS + 1)) as f64, (k / (FACETS + 1)) as f64);
    (0..(FACETS + 1) * (FACETS + 1))
        .map(node)
        .flat_map(|(i, j)| {
            let (x, y) = (i + 0.15 * (1.9 * j).sin(), j + 0.15 * (2.3 * i).cos());
            [x, y, height(x, y, phase)]
        })
        .collect()
}

fn surface(reference: &[f64]) -> ContactSurface {
    let facet = |k: usize| {
        let corner = (k / FACETS * (FACETS + 1) + k % FACETS) as u32;
        [corner, corner + 1, corner + 2 + FACETS as u32, corner + 1 + FACETS as u32]
    };
    let facets: Vec<[u32; 4]> = (0..FACETS * FACETS).map(facet).collect();
    ContactSurface::new("master", &facets, reference).expect("a modestly warped grid")
}

/// Slave nodes at the given distance above the surface, off the facets' centres and away from the rim.
fn slave_nodes(phase: f64, distance: f64) -> Vec<Vector3<f64>> {
    (0..FACETS * FACETS)
        .map(|k| {
            let along = |k: usize| 1.0 + 0.95 * k as f64;
            let (x, y) = (along(k % FACETS) + 0.2 * (k as f64).sin(), along(k / FACETS) + 0.2 * (k as f64).cos());
            Vector3::new(x, y, height(x, y, phase) + distance)
        })
        .collect()
}

fn benches(criterion: &mut Criterion) {
    let reference = positions(0.0);
    let moved = positions(0.1);
    let master = surface(&reference);
    let build = |master| MasterSearch::new(master, &reference, SearchOptions::default()).expect("the same positions");

    criterion.bench_function("search structure, build, 1600 facets", |bencher| {
        bencher.iter_batched(|| master.clone(), build, BatchSize::LargeInput);
    });
    let mut search = build(master.clone());
    criterion.bench_function("search structure, refit, 1600 facets", |bencher| {
        bencher.iter(|| search.update(black_box(&moved), 0.5));
    });

    let mut group = criterion.benchmark_group("queries");
    group.throughput(Throughput::Elements((FACETS * FACETS) as u64));
    for (name, distance) in [("near the surface", 0.05), ("out of reach", 5.0)] {
        let points = slave_nodes(0.1, distance);
        let view = search.at(&moved);
        group.bench_function(format!("closest, 1600 points {name}"), |bencher| {
            bencher.iter(|| points.iter().filter(|x| view.closest(black_box(x), None).pairing.is_some()).count());
        });
    }
    let points = slave_nodes(0.1, 0.05);
    let view = search.at(&moved);
    let hints: Vec<Option<u32>> = points.iter().map(|x| view.closest(x, None).pairing.map(|p| p.facet)).collect();
    assert!(hints.iter().all(Option::is_some), "every point near the surface has a partner");
    group.bench_function("pair, 1600 points with the facet they are on", |bencher| {
        bencher.iter(|| {
            let with_hints = points.iter().zip(&hints);
            with_hints.filter(|(x, hint)| view.pair(black_box(x), **hint, None).pairing.is_some()).count()
        });
    });
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
