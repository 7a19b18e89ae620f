//! The whole method on a small surface: tangents of what it assembles, crossing, jumps, rims, history.

use proptest::prelude::*;
use stoss_contact_nts::{ConstraintForm, NodeToSurface, NodeToSurfaceOptions};
use stoss_term::{At, GradientRule, StepConfiguration, StepContext, Term, Unilateral};
use stoss_testkit::oracle::{assert_jacobian_close, central_difference_jacobian};

/// Master: four facets of edge one in a row along x, heights given at x = 0..4; slave: one facet of edge one half above, its first node at `at`.
fn positions(heights: [f64; 5], at: [f64; 3]) -> Vec<f64> {
    crate::common::positions(&heights, at)
}

const SLAVE: u32 = 10;

fn method(constraint: ConstraintForm) -> NodeToSurface {
    let master: Vec<[u32; 4]> = (0..4).map(|i| [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1]).collect();
    let reference = positions([0.0; 5], [0.3, 0.2, 0.5]);
    let options = NodeToSurfaceOptions { constraint, ..NodeToSurfaceOptions::default() };
    NodeToSurface::new("test", &[[10, 11, 12, 13]], &master, &reference, options).unwrap()
}

fn gaps(m: &NodeToSurface, q: &[f64], active: &[bool]) -> Vec<f64> {
    let mut out = vec![0.0; m.slot_count()];
    m.complementarity_gaps(q, active, &mut out).unwrap();
    out
}

/// Residual of the only active slot over all `3 * nodes + 1` unknowns, and its tangent.
fn assembled(m: &NodeToSurface, q_n: &[f64], q_1: &[f64], p: f64, rule: GradientRule) -> (Vec<f64>, Vec<f64>) {
    let n = q_1.len() + 1;
    let (mut residual, mut tangent) = (vec![0.0; n], vec![0.0; n * n]);
    let active = [true, false, false, false];
    m.assemble(&StepConfiguration { q_n, q_np1: q_1, rule }.at(&[p, 0.0, 0.0, 0.0], &active), true, &mut |local| {
        assert_eq!(local.slots, [0]);
        let mut map: Vec<usize> = local.nodes.iter().flat_map(|&k| (0..3).map(move |i| 3 * k as usize + i)).collect();
        map.push(n - 1);
        for (i, &row) in map.iter().enumerate() {
            residual[row] += local.residual[i];
            for (j, &column) in map.iter().enumerate() {
                tangent[row * n + column] += local.tangent[i * map.len() + j];
            }
        }
    })
    .unwrap();
    (residual, tangent)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn tangent_momenta_and_work_of_what_is_assembled(
        heights in proptest::array::uniform5(-0.15..0.15_f64),
        moved in proptest::array::uniform5(-0.05..0.05_f64),
        from in (0.15..0.85_f64, 0.1..0.45_f64),
        slide in 0.0..1.5_f64,
        depth in -0.1..-0.01_f64,
        pressure in 0.5..20.0_f64,
        rule in prop_oneof![Just(GradientRule::EndPoint), Just(GradientRule::Midpoint), Just(GradientRule::DiscreteGradient)],
        modified: bool,
    ) {
        let q_n = positions(heights, [from.0, from.1, 0.3]);
        let q_1 = positions(std::array::from_fn(|i| heights[i] + moved[i]), [from.0 + slide, from.1, depth - 0.15]);
        let mut m = method(if modified { ConstraintForm::Modified } else { ConstraintForm::Standard });
        m.begin(&StepContext { reach: 10.0, ..StepContext::new(&q_n, GradientRule::EndPoint, 0.0) }).unwrap();
        let active = [true, false, false, false];
        m.repair(&q_1, &active).unwrap();
        let (residual, tangent) = assembled(&m, &q_n, &q_1, pressure, rule);
        let n = q_1.len() + 1;
        let mut at = q_1.clone();
        at.push(pressure);
        let numeric = central_difference_jacobian(
            |x, out| out.copy_from_slice(&assembled(&m, &q_n, &x[..n - 1], x[n - 1], rule).0),
            &at, 1e-3, n,
        );
        assert_jacobian_close(&tangent, &numeric, n, 1e-7, "assembled tangent");
        // Action and reaction; no moment about the origin at the configuration of the rule.
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        let mut work = 0.0;
        for k in 0..q_1.len() / 3 {
            let f = &residual[3 * k..3 * k + 3];
            let x: [f64; 3] = std::array::from_fn(|i| {
                let c = 3 * k + i;
                if rule == GradientRule::EndPoint { q_1[c] } else { 0.5 * (q_n[c] + q_1[c]) }
            });
            for i in 0..3 {
                force[i] += f[i];
                moment[i] += x[(i + 1) % 3] * f[(i + 2) % 3] - x[(i + 2) % 3] * f[(i + 1) % 3];
                work -= f[i] * (q_1[3 * k + i] - q_n[3 * k + i]);
            }
        }
        for i in 0..3 {
            prop_assert!(force[i].abs() < 1e-12 * pressure && moment[i].abs() < 1e-12 * pressure);
        }
        if rule == GradientRule::DiscreteGradient && modified {
            // The constraint row is -A (g_np1 - g_n), and the work of the contact forces p A (g_np1 - g_n).
            prop_assert!((work + pressure * residual[n - 1]).abs() < 1e-12 * pressure, "work {work:e}");
        }
    }
}

#[test]
fn a_node_that_crosses_an_edge_changes_its_facet() {
    let mut m = method(ConstraintForm::Standard);
    let active = [true, false, false, false];
    let heights = [0.0, 0.0, -0.1, -0.3, -0.6];
    let q_0 = positions(heights, [0.5, 0.3, 0.05]);
    let on = positions(heights, [0.6, 0.3, -1e-3]);
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&q_0, GradientRule::EndPoint, 0.0) }).unwrap();
    assert!(gaps(&m, &on, &[false; 4])[0] < 0.0);
    assert_eq!(m.repair(&on, &active).unwrap(), 1);
    m.commit(&At::end(&on, &[1.0, 0.0, 0.0, 0.0], &active));
    // From facet 0 over the ridge to facet 2: the stencil then has the nodes of both.
    m.begin(&StepContext { reach: 5.0, ..StepContext::new(&on, GradientRule::EndPoint, 0.0) }).unwrap();
    let far = positions(heights, [2.5, 0.3, -0.2]);
    assert_eq!(m.repair(&far, &active).unwrap(), 1);
    let mut stencils = Vec::new();
    m.stencils(&active, &mut |nodes, _| stencils.push(nodes.to_vec()));
    assert_eq!(stencils, [vec![SLAVE, 4, 6, 7, 5, 0, 2, 3, 1]]);
    assert_eq!(m.repair(&far, &active).unwrap(), 0, "the pairing settles");
}

#[test]
fn a_node_that_jumps_through_the_surface_is_caught() {
    let mut m = method(ConstraintForm::Standard);
    let q_0 = positions([0.0; 5], [1.4, 0.3, 0.2]);
    let beyond = positions([0.0; 5], [1.6, 0.3, -5.0]);
    m.begin(&StepContext { reach: 10.0, ..StepContext::new(&q_0, GradientRule::EndPoint, 0.0) }).unwrap();
    let gap = gaps(&m, &beyond, &[false; 4])[0];
    assert!((gap + 5.0).abs() < 1e-12, "gap {gap}");
    assert_eq!(m.repair(&beyond, &[true, false, false, false]).unwrap(), 1);
}

#[test]
fn a_node_beyond_the_rim_is_let_go() {
    let mut m = method(ConstraintForm::Standard);
    let active = [true, false, false, false];
    let on = positions([0.0; 5], [3.8, 0.3, 0.0]);
    m.begin(&StepContext {
        reach: 1.0,
        ..StepContext::new(&positions([0.0; 5], [3.8, 0.3, 0.01]), GradientRule::EndPoint, 0.0)
    })
    .unwrap();
    m.repair(&on, &active).unwrap();
    m.commit(&At::end(&on, &[1.0, 0.0, 0.0, 0.0], &active));
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&on, GradientRule::EndPoint, 0.0) }).unwrap();
    let off = positions([0.0; 5], [4.3, 0.3, -0.01]);
    assert_eq!(gaps(&m, &off, &active)[0], f64::INFINITY);
    assert_eq!(gaps(&m, &off, &[false; 4])[0], f64::INFINITY);
}

#[test]
fn history_goes_through_bytes() {
    let mut m = method(ConstraintForm::Standard);
    let active = [true, false, false, false];
    let on = positions([0.0; 5], [2.2, 0.3, -0.01]);
    m.begin(&StepContext {
        reach: 1.0,
        ..StepContext::new(&positions([0.0; 5], [2.2, 0.3, 0.1]), GradientRule::EndPoint, 0.0)
    })
    .unwrap();
    m.repair(&on, &active).unwrap();
    m.commit(&At::end(&on, &[1.0, 0.0, 0.0, 0.0], &active));
    let bytes = m.save_history();
    let mut other = method(ConstraintForm::Standard);
    other.load_history(&bytes).unwrap();
    assert_eq!(other.save_history(), bytes);
    for method in [&mut m, &mut other] {
        method.begin(&StepContext { reach: 1.0, ..StepContext::new(&on, GradientRule::EndPoint, 0.0) }).unwrap();
    }
    let both = [&m, &other].map(|m| assembled(m, &on, &on, 2.0, GradientRule::DiscreteGradient));
    assert_eq!(both[0], both[1]);
    assert!(other.load_history(&bytes[1..]).is_err());
    assert!(other.load_history(&[7; 16]).is_err());
}
