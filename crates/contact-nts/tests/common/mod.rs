//! A row of facets with one slave facet above, whole steps of it and dense assembly: for the tests, and for the rows of
//! `cargo xtask verify friction`.
#![allow(dead_code, reason = "each test binary uses a part")]

use stoss_contact::{Enforcement, FacetNodes, SearchOptions};
use stoss_contact_nts::{ConstraintForm, NodeToSurface, NodeToSurfaceOptions};
use stoss_term::{At, Auxiliary, GradientRule, StepConfiguration, StepContext, Term, Unilateral};

pub const ACTIVE: [bool; 4] = [true, false, false, false];
pub const OPEN: [bool; 4] = [false; 4];

/// Step of differences of forces of friction: the direction of a slip changes over the slip's own length, and their error is of fourth order in the
/// step over that.
pub const DIFFERENCE: f64 = 2.5e-5;

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

/// Makes the facets of the slave (0) or the master (1) from quadrilaterals.
pub type Divide<'a> = &'a dyn Fn(usize, &[[u32; 4]]) -> Vec<FacetNodes>;

/// Leaves the quadrilaterals as they are.
pub fn whole(_side: usize, quads: &[[u32; 4]]) -> Vec<FacetNodes> {
    quads.iter().map(|&quad| quad.into()).collect()
}

/// The quadrilaterals of the master.
pub fn row(facets: u32) -> Vec<[u32; 4]> {
    (0..facets).map(|i| [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1]).collect()
}

pub fn method(facets: u32, constraint: ConstraintForm, search: SearchOptions) -> NodeToSurface {
    method_on(&whole, facets, constraint, search)
}

pub fn method_on(divide: Divide<'_>, facets: u32, constraint: ConstraintForm, search: SearchOptions) -> NodeToSurface {
    with_options(divide, facets, NodeToSurfaceOptions { constraint, search, ..NodeToSurfaceOptions::default() })
}

pub fn enforced(facets: u32, enforcement: Enforcement) -> NodeToSurface {
    enforced_on(&whole, facets, enforcement)
}

pub fn enforced_on(divide: Divide<'_>, facets: u32, enforcement: Enforcement) -> NodeToSurface {
    with_options(divide, facets, NodeToSurfaceOptions { enforcement, ..NodeToSurfaceOptions::default() })
}

fn with_options(divide: Divide<'_>, facets: u32, options: NodeToSurfaceOptions) -> NodeToSurface {
    let reference = positions(&vec![0.0; facets as usize + 1], [0.3, 0.2, 0.5]);
    let k = 2 * (facets + 1);
    let (slave, master) = (divide(0, &[[k, k + 1, k + 2, k + 3]]), divide(1, &row(facets)));
    NodeToSurface::new("test", &slave, &master, &reference, options).unwrap()
}

pub fn standard(facets: u32) -> NodeToSurface {
    standard_on(&whole, facets)
}

pub fn standard_on(divide: Divide<'_>, facets: u32) -> NodeToSurface {
    method_on(divide, facets, ConstraintForm::Standard, SearchOptions::default())
}

/// Puts the first node in contact at `on` and begins the next step there.
pub fn in_contact(m: &mut NodeToSurface, on: &[f64]) {
    m.begin(&StepContext { reach: 20.0, ..StepContext::new(on, GradientRule::EndPoint, 0.0) }).unwrap();
    m.repair(on, &ACTIVE).unwrap();
    m.commit(&At::end(on, &[1.0, 0.0, 0.0, 0.0], &ACTIVE));
    m.begin(&StepContext { reach: 20.0, ..StepContext::new(on, GradientRule::EndPoint, 0.0) }).unwrap();
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
    rule: GradientRule,
    want: bool,
) -> (Vec<f64>, Vec<f64>) {
    let n = q_1.len() + 1;
    let (mut residual, mut tangent) = (vec![0.0; n], vec![0.0; if want { n * n } else { 0 }]);
    m.assemble(&StepConfiguration { q_n, q_np1: q_1, rule }.at(&[p, 0.0, 0.0, 0.0], &ACTIVE), want, &mut |local| {
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

/// Three configurations of flat facets with noise on as many coordinates as `noise` has, the master's first: the first slave node is at `at`, goes by `first` through the surface, and by
/// `second` along it to the depth `second[2]`.
pub fn path(facets: u32, noise: [&[f64]; 3], at: [f64; 3], first: [f64; 2], second: [f64; 3]) -> [Vec<f64>; 3] {
    let flat = vec![0.0; facets as usize + 1];
    let [x, y, z] = at;
    let (x_1, y_1) = (x + first[0], y + first[1]);
    let mut q = [
        positions(&flat, [x, y, z]),
        positions(&flat, [x_1, y_1, -z]),
        positions(&flat, [x_1 + second[0], y_1 + second[1], second[2]]),
    ];
    for k in 0..noise[0].len() {
        q[0][k] += noise[0][k];
        q[1][k] += noise[0][k] + noise[1][k];
        q[2][k] += noise[0][k] + noise[1][k] + noise[2][k];
    }
    q
}

/// Does the first step of a [`path`], with a pressure at its end, and pairs the second one.
pub fn second_step<M: Term + Unilateral>(mut m: M, q: &[Vec<f64>; 3], rule: GradientRule, dt: f64, pressure: f64) -> M {
    m.begin(&StepContext { reach: 20.0, ..StepContext::new(&q[0], rule, dt) }).unwrap();
    m.repair(&q[1], &ACTIVE).unwrap();
    m.commit(&At::end(&q[1], &[pressure, 0.0, 0.0, 0.0], &ACTIVE));
    m.begin(&StepContext { reach: 20.0, ..StepContext::new(&q[1], rule, dt) }).unwrap();
    m.repair(&q[2], &ACTIVE).unwrap();
    m
}

/// Sizes of the sum of nodal forces and of the sum of their moments about the origin, where the rule evaluates them.
pub fn resultants(forces: &[f64], q_n: &[f64], q_1: &[f64], rule: GradientRule) -> (f64, f64) {
    let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
    for (k, f) in forces.chunks_exact(3).enumerate() {
        let x: [f64; 3] = std::array::from_fn(|i| {
            let (a, b) = (q_n[3 * k + i], q_1[3 * k + i]);
            if rule == GradientRule::EndPoint { b } else { 0.5 * (a + b) }
        });
        for i in 0..3 {
            let (j, l) = ((i + 1) % 3, (i + 2) % 3);
            force[i] += f[i];
            moment[i] += x[j] * f[l] - x[l] * f[j];
        }
    }
    let norm = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (norm(force), norm(moment))
}

/// Residual and tangent of a method with auxiliaries over positions, the pressure and the auxiliaries of the first slot, all of which `x` holds.
pub fn assembled_with(
    m: &(impl Term + Unilateral),
    q_n: &[f64],
    rule: GradientRule,
    x: &[f64],
    auxiliaries: &[f64],
    want: bool,
) -> (Vec<f64>, Vec<f64>) {
    let (m_q, global) = (q_n.len(), Auxiliary::equations(m.auxiliaries()));
    let n = m_q + 1 + global;
    let mut values = auxiliaries.to_vec();
    values[..global].copy_from_slice(&x[m_q + 1..n]);
    let (mut residual, mut tangent) = (vec![0.0; n], vec![0.0; if want { n * n } else { 0 }]);
    let step = StepConfiguration { q_n, q_np1: &x[..m_q], rule };
    m.assemble(&step.at(&[x[m_q], 0.0, 0.0, 0.0], &ACTIVE).with_auxiliaries(&values), want, &mut |local| {
        let mut map: Vec<usize> = local.nodes.iter().flat_map(|&k| (0..3).map(move |i| 3 * k as usize + i)).collect();
        map.extend(m_q..n);
        assert_eq!(map.len(), local.dim());
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
