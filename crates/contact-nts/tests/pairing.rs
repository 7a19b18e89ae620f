//! Pairing over a step: edges, ridges, valleys, jumps, and what the elements conserve with the pairing that was found.

use crate::common::*;
use proptest::prelude::*;
use stoss_contact::SearchOptions;
use stoss_contact_nts::ConstraintForm;
use stoss_term::{At, GradientRule, StepContext, Term, Unilateral};
use stoss_testkit::meshes::{Mesh, divide, meshes};
use stoss_testkit::oracle::{assert_jacobian_close, central_difference_jacobian};

/// Index of the height of the slave node above four facets.
const SLAVE_HEIGHT: usize = 3 * 10 + 2;

/// Work of the contact forces in the step.
fn work(residual: &[f64], q_n: &[f64], q_1: &[f64]) -> f64 {
    -q_n.iter().zip(q_1).zip(residual).map(|((a, b), f)| f * (b - a)).sum::<f64>()
}

/// Largest component of the sum of the forces and of their moments about the origin at the midpoint.
fn resultant(residual: &[f64], q_n: &[f64], q_1: &[f64]) -> f64 {
    let mut sums = [0.0; 6];
    for k in 0..q_1.len() / 3 {
        let f = &residual[3 * k..3 * k + 3];
        let x: [f64; 3] = std::array::from_fn(|i| 0.5 * (q_n[3 * k + i] + q_1[3 * k + i]));
        for i in 0..3 {
            sums[i] += f[i];
            sums[3 + i] += x[(i + 1) % 3] * f[(i + 2) % 3] - x[(i + 2) % 3] * f[(i + 1) % 3];
        }
    }
    sums.iter().fold(0.0, |m, s| s.abs().max(m))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    // Facets at n and at n+1 have no node in common, and the midpoint lies on another one: the element with 9 nodes.
    #[test]
    fn a_slide_between_disjoint_facets(
        meshes in meshes(),
        heights in proptest::array::uniform7(-0.08..0.08_f64),
        moved in proptest::array::uniform7(-0.05..0.05_f64),
        from in (0.35..0.65_f64, 0.2..0.4_f64),
        slide in 3.85..4.15_f64,
        conserving: bool,
    ) {
        let q_n = positions(&heights, [from.0, from.1, 0.0]);
        let end: Vec<f64> = heights.iter().zip(&moved).map(|(h, m)| h + m).collect();
        let q_1 = positions(&end, [from.0 + slide, from.1, -0.15]);
        let mut m = standard_on(&divide(meshes), 6);
        in_contact(&mut m, &q_n);
        prop_assert_eq!(m.repair(&q_1, &ACTIVE).unwrap(), 1);
        let mut count = 0;
        m.stencils(&ACTIVE, &mut |nodes, _| count = nodes.len());
        prop_assert!(if meshes[1] == Mesh::Quads { count == 9 } else { (7..=9).contains(&count) }, "{count}");
        let rule = if conserving { GradientRule::DiscreteGradient } else { GradientRule::Midpoint };
        let (residual, tangent) = assembled(&m, &q_n, &q_1, 3.0, rule, true);
        prop_assert!(resultant(&residual, &q_n, &q_1) < 1e-12);
        prop_assert_eq!(&assembled(&m, &q_n, &q_1, 3.0, rule, false).0, &residual);
        let n = residual.len();
        let mut at = q_1.clone();
        at.push(3.0);
        let numeric = central_difference_jacobian(
            |x, out| out.copy_from_slice(&assembled(&m, &q_n, &x[..n - 1], x[n - 1], rule, false).0), &at, 1e-3, n,
        );
        assert_jacobian_close(&tangent, &numeric, n, 1e-7, "tangent between disjoint facets");
    }

    // What the standard constraint promises: a closed node that goes over edges and stays closed does no work.
    #[test]
    fn a_closed_node_that_slides_over_edges_does_no_work(
        meshes in meshes(),
        heights in proptest::array::uniform5(-0.3..0.3_f64),
        moved in proptest::array::uniform5(-0.1..0.1_f64),
        x in (0.1..0.9_f64, 1.1..3.9_f64),
        y in 0.1..0.4_f64,
    ) {
        let height = |h: &[f64; 5], x: f64| {
            let i = x.floor() as usize;
            h[i] + (x - i as f64) * (h[i + 1] - h[i])
        };
        let end: [f64; 5] = std::array::from_fn(|i| heights[i] + moved[i]);
        let q_n = positions(&heights, [x.0, y, height(&heights, x.0)]);
        let q_1 = positions(&end, [x.1, y, height(&end, x.1)]);
        let mut m = standard_on(&divide(meshes), 4);
        in_contact(&mut m, &q_n);
        prop_assert_eq!(m.repair(&q_1, &ACTIVE).unwrap(), 1);
        let pressure = 7.0;
        for rule in [GradientRule::DiscreteGradient, GradientRule::Midpoint] {
            let (residual, _) = assembled(&m, &q_n, &q_1, pressure, rule, false);
            prop_assert!(residual[q_1.len()].abs() < 1e-14, "closed at n+1");
            prop_assert!(work(&residual, &q_n, &q_1).abs() < 1e-13 * pressure);
            prop_assert!(resultant(&residual, &q_n, &q_1) < 1e-12 * pressure);
        }
    }

    // Modified constraint: work and constraint row refer to the same gap at n, wherever the node comes from.
    #[test]
    fn a_node_that_closes_from_above_a_ridge(
        meshes in meshes(),
        slope in 0.1..1.0_f64,
        x in (0.6..1.4_f64, 0.3..1.7_f64),
        height in 0.01..0.2_f64,
    ) {
        let heights = [0.0, 0.0, -slope, -2.0 * slope, -3.0 * slope];
        let q_n = positions(&heights, [x.0, 0.3, height]);
        let q_1 = positions(&heights, [x.1, 0.3, -slope * (x.1 - 1.0_f64).max(0.0) - 0.02]);
        let mut m = method_on(&divide(meshes), 4, ConstraintForm::Modified, SearchOptions::default());
        m.begin(&StepContext { reach: 10.0, ..StepContext::new(&q_n, GradientRule::EndPoint, 0.0) }).unwrap();
        let closed = gap(&m, &q_1, &OPEN);
        prop_assert!((-0.02..0.0).contains(&closed), "the gap to the surface, no deeper than under its flat facet: {}", closed);
        m.repair(&q_1, &ACTIVE).unwrap();
        let (residual, _) = assembled(&m, &q_n, &q_1, 3.0, GradientRule::DiscreteGradient, false);
        // Row -A (g_np1 - g_n), work p A (g_np1 - g_n).
        prop_assert!((work(&residual, &q_n, &q_1) + 3.0 * residual[q_1.len()]).abs() < 1e-13);
        prop_assert!(work(&residual, &q_n, &q_1) < 0.0, "an open node that closes gives energy to nobody");
    }
}

#[test]
fn an_open_node_behind_the_extension_of_its_facet_keeps_its_true_gap() {
    // In front of the flat facet 0 at n, behind the extension of the steep facet 1 that it closes on.
    let heights = [0.0, 0.0, -1.0, -2.0, -3.0];
    let (q_n, q_1) = (positions(&heights, [0.8, 0.3, 0.05]), positions(&heights, [1.3, 0.3, -0.3]));
    let mut m = standard(4);
    m.begin(&StepContext { reach: 10.0, ..StepContext::new(&q_n, GradientRule::EndPoint, 0.0) }).unwrap();
    m.repair(&q_1, &ACTIVE).unwrap();
    let (residual, _) = assembled(&m, &q_n, &q_1, 1.0, GradientRule::DiscreteGradient, false);
    let weight = m.slot_weight(0);
    let loss = work(&residual, &q_n, &q_1) / weight;
    assert!((loss + 0.05).abs() < 1e-14, "the energy lost in closing is p g_n, but it is {loss}");
}

#[test]
fn a_node_that_closes_far_from_its_facet_loses_its_true_gap() {
    // A bowl; the extension of the facet that it closes on passes below the facet that it came from.
    let heights = [0.0, 0.0, 0.3, 0.9, 1.8];
    let (q_n, q_1) = (positions(&heights, [0.3, 0.3, 0.05]), positions(&heights, [3.5, 0.3, 1.34]));
    let mut m = standard(4);
    m.begin(&StepContext { reach: 10.0, ..StepContext::new(&q_n, GradientRule::EndPoint, 0.0) }).unwrap();
    m.repair(&q_1, &ACTIVE).unwrap();
    let (residual, _) = assembled(&m, &q_n, &q_1, 1.0, GradientRule::DiscreteGradient, false);
    let depth = -residual[q_1.len()];
    let change = work(&residual, &q_n, &q_1) - depth;
    assert!((change / m.slot_weight(0) + 0.05).abs() < 1e-14, "{change}");
}

#[test]
fn a_node_from_the_side_is_no_contact_until_it_has_been_in_front() {
    let heights = [0.0; 5];
    let at = |x: f64, z: f64| positions(&heights, [x, 0.3, z]);
    let mut m = standard(4);
    let mut last = at(4.3, -0.05);
    for (next, expected) in
        [(at(3.9, -0.05), None), (at(3.5, -0.05), None), (at(3.5, 0.05), Some(0.05)), (at(3.5, -0.05), Some(-0.05))]
    {
        m.begin(&StepContext { reach: 10.0, ..StepContext::new(&last, GradientRule::EndPoint, 0.0) }).unwrap();
        let found = gap(&m, &next, &OPEN);
        match expected {
            None => assert_eq!(found, f64::INFINITY),
            Some(gap) => assert!((found - gap).abs() < 1e-14, "{found}"),
        }
        m.commit(&At::end(&next, &[0.0; 4], &OPEN));
        last = next;
    }
}

#[test]
fn a_node_that_went_over_a_ridge_comes_back_to_the_surface() {
    let heights = [0.0, 0.0, -0.3, -0.6, -0.9];
    let mut m = standard(4);
    let mut last = positions(&heights, [0.704, 0.3, 0.0]);
    in_contact(&mut m, &last);
    let mut distances = Vec::new();
    // Its sixth step ends on the extension of the first facet, by less than the hysteresis beyond the edge.
    for k in 1..=10 {
        let x = 0.704 + 0.05 * f64::from(k);
        let mut next = positions(&heights, [x, 0.3, 0.0]);
        m.begin(&StepContext { reach: 20.0, ..StepContext::new(&last, GradientRule::EndPoint, 0.0) }).unwrap();
        // The height that the constraint asks for.
        for _ in 0..4 {
            m.repair(&next, &ACTIVE).unwrap();
            let residual = assembled(&m, &last, &next, 1.0, GradientRule::EndPoint, false).0;
            next[SLAVE_HEIGHT] -= residual[next.len()] / residual[SLAVE_HEIGHT];
        }
        distances.push(gap(&m, &next, &OPEN));
        m.commit(&At::end(&next, &[1.0, 0.0, 0.0, 0.0], &ACTIVE));
        last = next;
    }
    assert!(distances[5] > 1e-3 && distances[9].abs() < 1e-4, "{distances:?}");
}

#[test]
fn the_force_is_continuous_where_the_midpoint_passes_an_edge() {
    let heights = [0.0, 0.0, -0.3, -0.9, -1.5];
    for rule in [GradientRule::Midpoint, GradientRule::DiscreteGradient] {
        let q_n = positions(&heights, [0.7, 0.3, 0.0]);
        let mut m = standard(4);
        in_contact(&mut m, &q_n);
        m.repair(&positions(&heights, [1.2, 0.3, -0.06]), &ACTIVE).unwrap();
        let force = |x: f64| {
            let q_1 = positions(&heights, [x, 0.3, -0.3 * (x - 1.0)]);
            assembled(&m, &q_n, &q_1, 1.0, rule, false).0
        };
        // The midpoint is at x = 1 if the end is at 1.3.
        let (before, after) = (force(1.3 - 1e-6), force(1.3 + 1e-6));
        let jump = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(jump < 1e-5, "{rule:?}: the force jumps by {jump:e}");
    }
}

#[test]
fn a_jump_is_caught_though_the_depth_limit_is_small() {
    let heights = [0.0; 5];
    let mut m = method(4, ConstraintForm::Standard, SearchOptions { depth_limit: 0.1, ..SearchOptions::default() });
    m.begin(&StepContext {
        reach: 10.0,
        ..StepContext::new(&positions(&heights, [1.4, 0.3, 0.05]), GradientRule::EndPoint, 0.0)
    })
    .unwrap();
    let q_1 = positions(&heights, [1.4, 0.3, -0.35]);
    assert!((gap(&m, &q_1, &OPEN) + 0.35).abs() < 1e-14);
    assert_eq!(m.repair(&q_1, &ACTIVE).unwrap(), 1);
    assert!((gap(&m, &q_1, &ACTIVE) + 0.35).abs() < 1e-14);
}

#[test]
fn a_chord_over_a_ridge_is_no_jump() {
    let heights = [0.0, 0.0, -1.0, -2.0, -3.0];
    let (q_n, q_1) = (positions(&heights, [0.2, 0.3, 0.01]), positions(&heights, [1.8, 0.3, -0.78]));
    let mut m = standard(4);
    m.begin(&StepContext { reach: 10.0, ..StepContext::new(&q_n, GradientRule::EndPoint, 0.0) }).unwrap();
    // In front of facet 1 by the distance of a point 0.02 above a plane of slope one.
    assert!((gap(&m, &q_1, &OPEN) - 0.02 / 2.0_f64.sqrt()).abs() < 1e-14);
}

#[test]
fn a_long_slide_in_many_repairs_is_followed() {
    let heights = [0.0; 8];
    let mut m = standard(7);
    m.begin(&StepContext {
        reach: 20.0,
        ..StepContext::new(&positions(&heights, [0.5, 0.3, 0.0]), GradientRule::EndPoint, 0.0)
    })
    .unwrap();
    for facet in 0..7 {
        let q = positions(&heights, [0.5 + f64::from(facet), 0.3, -1e-3]);
        assert_eq!(m.repair(&q, &ACTIVE).unwrap(), 1, "facet {facet}");
    }
}

#[test]
fn going_to_and_fro_in_a_valley_ends() {
    let heights = [1.0, 0.0, 1.0];
    let on = positions(&heights, [0.8, 0.3, 0.2]);
    let mut m = standard(2);
    in_contact(&mut m, &on);
    let sides = [positions(&heights, [1.3, 0.3, 0.2]), positions(&heights, [0.7, 0.3, 0.2])];
    let changes: Vec<usize> = (0..10).map(|k| m.repair(&sides[k % 2], &ACTIVE).unwrap()).collect();
    assert_eq!(changes, [1, 1, 1, 0, 0, 0, 0, 0, 0, 0]);
    // Closed on the extension at the end of this step, it starts the next one with the gap that it ended with.
    let q_1 = &sides[1];
    let row = assembled(&m, &on, q_1, 1.0, GradientRule::DiscreteGradient, false).0[q_1.len()];
    m.commit(&At::end(q_1, &[1.0, 0.0, 0.0, 0.0], &ACTIVE));
    m.begin(&StepContext { reach: 20.0, ..StepContext::new(q_1, GradientRule::EndPoint, 0.0) }).unwrap();
    assert!((gap(&m, q_1, &ACTIVE) + row / m.slot_weight(0)).abs() < 1e-14);
}

#[test]
fn a_node_released_and_closed_again_gets_its_facet_every_time() {
    let heights = [0.0; 5];
    let q = positions(&heights, [1.4, 0.3, -0.01]);
    let mut m = standard(4);
    m.begin(&StepContext {
        reach: 1.0,
        ..StepContext::new(&positions(&heights, [1.4, 0.3, 0.01]), GradientRule::EndPoint, 0.0)
    })
    .unwrap();
    for _ in 0..10 {
        assert_eq!(m.repair(&q, &ACTIVE).unwrap(), 1);
        assert_eq!(m.repair(&q, &OPEN).unwrap(), 0);
    }
}

#[test]
fn an_active_slot_without_a_partner_has_no_pressure() {
    let heights = [0.0; 5];
    let far = positions(&heights, [1.4, 0.3, 50.0]);
    let mut m = standard(4);
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&far, GradientRule::EndPoint, 0.0) }).unwrap();
    assert_eq!(m.repair(&far, &ACTIVE).unwrap(), 0);
    let (residual, tangent) = assembled(&m, &far, &far, 2.0, GradientRule::DiscreteGradient, true);
    let (n, weight) = (residual.len(), m.slot_weight(0));
    for (k, r) in residual.iter().enumerate() {
        assert_eq!(*r, if k == n - 1 { -2.0 * weight } else { 0.0 });
    }
    assert_eq!(tangent[n * n - 1], -weight);
    assert_eq!(tangent.iter().filter(|t| **t != 0.0).count(), 1);
    assert_eq!(gap(&m, &far, &ACTIVE), f64::INFINITY, "it opens next");
}
