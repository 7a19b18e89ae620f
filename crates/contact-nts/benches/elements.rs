//! Cost of one contact element: kinematics of the gap, the energy-momentum element with its tangent, and the element of a step
//! from one facet to another.
//!
//! `cargo bench -p stoss-contact-nts`

use criterion::{Criterion, criterion_group, criterion_main};
use std::{hint::black_box, time::Duration};
use stoss_contact_nts::crossing::Crossing;
use stoss_contact_nts::invariants::{discrete_gradient, discrete_gradient_and_tangent};
use stoss_contact_nts::kinematics::{Gap, Local, points};
use stoss_reference_element::FacetKind;

/// Slave node and two warped facets that share the edge of nodes 2 and 3: seven nodes.
const NODES: [[f64; 3]; 7] = [
    [0.4, 0.1, 0.2],
    [-1.0, -1.0, 0.1],
    [1.0, -1.1, -0.1],
    [1.1, 1.0, 0.05],
    [-0.9, 1.0, 0.0],
    [3.0, -1.0, 0.2],
    [3.1, 1.1, 0.3],
];
/// Unknowns of the crossing element.
const SEVEN: usize = 21;
const START: [usize; 4] = [1, 2, 3, 4];
const END: [usize; 4] = [2, 5, 6, 3];
const QUAD4: FacetKind = FacetKind::Quad4;

fn gap(q: &Local) -> Gap {
    let (x, patch) = points(q, QUAD4);
    Gap::from_centre(&x, &patch).expect("a modestly warped facet has a foot")
}

/// Slave node and the nodes of a facet.
fn local(q: &[f64; SEVEN], facet: &[usize; 4]) -> Local {
    let nodes = [0, facet[0], facet[1], facet[2], facet[3]];
    std::array::from_fn(|k| q[3 * nodes[k / 3] + k % 3])
}

fn elements(criterion: &mut Criterion) {
    let q_n: [f64; SEVEN] = std::array::from_fn(|k| NODES[k / 3][k % 3]);
    let stays: [f64; SEVEN] = std::array::from_fn(|k| q_n[k] + 0.05 * (1.7 * k as f64).sin());
    let (l_n, l_1) = (local(&q_n, &START), local(&stays, &START));
    let (gap_n, gap_1) = (gap(&l_n), gap(&l_1));

    criterion.bench_function("gap, projection with first variation", |bencher| {
        bencher.iter(|| gap(black_box(&l_1)));
    });
    criterion.bench_function("gap, second variation", |bencher| bencher.iter(|| black_box(&gap_1).hessian()));
    criterion.bench_function("discrete gradient", |bencher| {
        bencher.iter(|| discrete_gradient(black_box(&l_n), &l_1, &gap_n, &gap_1, 2.0));
    });
    criterion.bench_function("discrete gradient with tangent", |bencher| {
        bencher.iter(|| discrete_gradient_and_tangent(black_box(&l_n), &l_1, &gap_n, &gap_1, 2.0));
    });

    // The slave node slides over the common edge.
    let mut slides = stays;
    slides[0] += 1.0;
    let middle: [f64; SEVEN] = std::array::from_fn(|k| 0.5 * (q_n[k] + slides[k]));
    let (end, mid) = (gap(&local(&slides, &END)), gap(&local(&middle, &START)));
    assert!(end.outside() < 0.0 && mid.outside() < 0.0, "the feet lie on their facets");
    let (to, from) = (END.into(), START.into());
    let crossing =
        Crossing { q_n: &q_n, q_np1: &slides, gap_n: gap_n.gap, end: (&end, &to), mid: (&mid, &from), length: 2.0 };
    let (mut gradient, mut tangent) = ([0.0; SEVEN], [0.0; SEVEN * SEVEN]);
    criterion.bench_function("crossing, 7 nodes", |bencher| {
        bencher.iter(|| black_box(&crossing).evaluate(black_box(&mut gradient), &mut []));
    });
    criterion.bench_function("crossing with tangent, 7 nodes", |bencher| {
        bencher.iter(|| black_box(&crossing).evaluate(black_box(&mut gradient), black_box(&mut tangent)));
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = elements
}
criterion_main!(benches);
