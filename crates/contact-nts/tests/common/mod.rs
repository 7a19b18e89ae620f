//! A row of facets with one slave facet above, and dense assembly, for the tests of whole steps.
#![allow(dead_code, reason = "each test binary uses a part")]

use stoss_contact::{ContactMethod, ContactRule, Enforcement, SearchOptions, StepConfiguration};
use stoss_contact_nts::{ConstraintForm, NodeToSurface, NodeToSurfaceOptions};

pub const ACTIVE: [bool; 4] = [true, false, false, false];
pub const OPEN: [bool; 4] = [false; 4];

/// Master: facets of edge one in a row along x, heights given at x = 0, 1, ...; slave: a facet of edge one half, its
/// first node at `at`, the others above it.
pub fn positions(heights: &[f64], at: [f64; 3]) -> Vec<f64> {
    let mut q = Vec::new();
    for (i, h) in heights.iter().enumerate() {
        q.extend([i as f64, 0.0, *h]);
        q.extend([i as f64, 1.0, *h]);
    }
    for d in [[0.0, 0.0, 0.0], [0.0, 0.5, 0.3], [0.5, 0.5, 0.3], [0.5, 0.0, 0.3]] {
        q.extend([at[0] + d[0], at[1] + d[1], at[2] + d[2]]);
    }
    q
}

pub fn method(facets: u32, constraint: ConstraintForm, search: SearchOptions) -> NodeToSurface {
    with_options(facets, NodeToSurfaceOptions { constraint, search, ..NodeToSurfaceOptions::default() })
}

pub fn enforced(facets: u32, enforcement: Enforcement) -> NodeToSurface {
    with_options(facets, NodeToSurfaceOptions { enforcement, ..NodeToSurfaceOptions::default() })
}

fn with_options(facets: u32, options: NodeToSurfaceOptions) -> NodeToSurface {
    let master: Vec<[u32; 4]> = (0..facets).map(|i| [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1]).collect();
    let reference = positions(&vec![0.0; facets as usize + 1], [0.3, 0.2, 0.5]);
    let k = 2 * (facets + 1);
    NodeToSurface::new("test", &[[k, k + 1, k + 2, k + 3]], &master, &reference, options).unwrap()
}

pub fn standard(facets: u32) -> NodeToSurface {
    method(facets, ConstraintForm::Standard, SearchOptions::default())
}

/// Puts the first node in contact at `on` and begins the next step there.
pub fn in_contact(m: &mut NodeToSurface, on: &[f64]) {
    m.begin_step(on, 20.0).unwrap();
    m.repair(on, &ACTIVE).unwrap();
    m.commit(on, &[1.0, 0.0, 0.0, 0.0], &ACTIVE);
    m.begin_step(on, 20.0).unwrap();
}

pub fn gap(m: &NodeToSurface, q: &[f64], active: &[bool]) -> f64 {
    let mut out = vec![f64::NAN; m.slot_count()];
    m.complementarity_gaps(q, active, &mut out).unwrap();
    out[0]
}

/// Residual over all `3 * nodes + 1` unknowns and tangent, which is empty if not wanted.
pub fn assembled(
    m: &NodeToSurface,
    q_n: &[f64],
    q_1: &[f64],
    p: f64,
    rule: ContactRule,
    want: bool,
) -> (Vec<f64>, Vec<f64>) {
    let n = q_1.len() + 1;
    let (mut residual, mut tangent) = (vec![0.0; n], vec![0.0; if want { n * n } else { 0 }]);
    m.assemble(StepConfiguration { q_n, q_np1: q_1, rule }, &[p, 0.0, 0.0, 0.0], &ACTIVE, want, &mut |local| {
        let mut map: Vec<usize> = local.nodes.iter().flat_map(|&k| (0..3).map(move |i| 3 * k as usize + i)).collect();
        map.push(n - 1);
        for (i, &row) in map.iter().enumerate() {
            residual[row] += local.residual[i];
            for (j, &column) in map.iter().enumerate().filter(|_| want) {
                tangent[row * n + column] += local.tangent[i * map.len() + j];
            }
        }
    })
    .unwrap();
    (residual, tangent)
}
