//! The contact method at random configurations: tangents, momenta, work, crosspoints.

mod sheets;

use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use sheets::{NODES, SLAVE, assemble, base, method, moved, options, pressures, resultants, tangent_error, warp};
use stoss_contact::{ContactMethod, ContactRule, StepConfiguration};
use stoss_contact_mortar::{MortarContact, MortarOptions, WeightedConstraint};

const RULES: [ContactRule; 5] = [
    ContactRule::StartPoint,
    ContactRule::EndPoint,
    ContactRule::EndPointMean,
    ContactRule::Midpoint,
    ContactRule::EnergyMomentum,
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn tangents_are_derivatives(
        d in warp(), e in warp(), p in pressures(), dual in any::<bool>(), averaged in any::<bool>(), rule in 0usize..5,
    ) {
        let q_n = moved(&d);
        let q: Vec<f64> = q_n.iter().zip(&e).map(|(x, e)| x + 0.3 * e).collect();
        let mut method = method(options(dual, averaged));
        if let Some(error) = tangent_error(&mut method, RULES[rule], &q_n, &q, &p) {
            prop_assert!(error < 1e-7, "{:?} dual {dual} averaged {averaged}: {error:e}", RULES[rule]);
        }
    }

    /// Partly covered nodes, some of them with next to nothing.
    #[test]
    fn tangents_of_fading_constraints_are_derivatives(
        d in warp(), e in warp(), p in pressures(), shift in 0.0f64..1.4, dual in any::<bool>(), averaged in any::<bool>(),
        smoothing in prop::sample::select(vec![0.0, 0.3]), one_sided in any::<bool>(), lift in -0.3f64..0.1,
    ) {
        let mut q_n = moved(&d);
        (0..SLAVE).for_each(|k| q_n[3 * k] += 0.8 * shift);
        if one_sided {
            (0..SLAVE).for_each(|k| q_n[3 * k + 2] += lift);
        }
        let mut q: Vec<f64> = q_n.iter().zip(&e).map(|(x, e)| x + 0.3 * e).collect();
        (0..SLAVE).for_each(|k| q[3 * k] += 0.2 * shift);
        // Kept penetrations move with the support.
        let constraint = if one_sided { WeightedConstraint::OneSided } else { WeightedConstraint::Standard };
        let mut method = method(MortarOptions { constraint, ..options(dual, averaged) }).with_softening(20.0, smoothing);
        if let Some(error) = tangent_error(&mut method, ContactRule::EndPoint, &q_n, &q, &p) {
            prop_assert!(error < 1e-7, "dual {dual} averaged {averaged}: {error:e}");
        }
    }

    /// Touching flat sheets under one pressure: the rows of all nodes that have carrying neighbours vanish, however little of them is covered.
    #[test]
    fn fading_constraints_keep_constant_pressures(
        shift in 0.0f64..0.6, pressure in 0.1f64..9.0, dual in any::<bool>(), smoothing in 0.0f64..0.3,
    ) {
        let mut q = base();
        for k in 0..SLAVE {
            q[3 * k] += shift;
            q[3 * k + 2] = 1.0;
        }
        let mut method = method(options(dual, true)).with_softening(20.0, smoothing);
        method.set_rule(ContactRule::EndPoint, 0.1);
        method.begin_step(&q, 0.5).unwrap();
        let carries: Vec<bool> = (0..SLAVE).map(|k| method.supports()[k] >= 0.5 * method.slot_weight(k)).collect();
        let beside = |k: usize| {
            let (i, j) = (k % 3, k / 3);
            (0..SLAVE).any(|m| m != k && (m % 3).abs_diff(i) <= 1 && (m / 3).abs_diff(j) <= 1 && carries[m])
        };
        let active: Vec<bool> = method.supports().iter().map(|s| *s > 0.0).collect();
        let p: Vec<f64> = active.iter().map(|a| if *a { pressure } else { 0.0 }).collect();
        method.renew(&q, &p, &[], &active, false).unwrap();
        let step = StepConfiguration { q_n: &q, q_np1: &q, rule: ContactRule::EndPoint };
        let rows = assemble(&method, step, &p, &active).residual;
        let all_carry = |k: usize| {
            let (i, j) = (k % 3, k / 3);
            (0..SLAVE).filter(|m| (m % 3).abs_diff(i) <= 1 && (m / 3).abs_diff(j) <= 1 && carries[*m]).all(|m| active[m])
        };
        for k in (0..SLAVE).filter(|&k| active[k] && (carries[k] || beside(k)) && all_carry(k)) {
            prop_assert!(rows[3 * NODES + k].abs() < 1e-14, "node {k}: {}", rows[3 * NODES + k]);
        }
    }

    #[test]
    fn forces_have_neither_resultant_nor_moment(
        d in warp(), e in warp(), lift in -0.3f64..0.5, p in pressures(), dual in any::<bool>(), averaged in any::<bool>(),
    ) {
        let mut q_n = moved(&d);
        // A gap or a penetration that is not small.
        (0..SLAVE).for_each(|k| q_n[3 * k + 2] += lift);
        let q: Vec<f64> = q_n.iter().zip(&e).map(|(x, e)| x + e).collect();
        let middle: Vec<f64> = q_n.iter().zip(&q).map(|(a, b)| 0.5 * (a + b)).collect();
        let active: Vec<bool> = p.iter().map(|p| *p != 0.0).collect();
        for (rule, about) in [
            (ContactRule::StartPoint, Some(&q_n)), (ContactRule::EndPoint, Some(&q)), (ContactRule::EndPointMean, None),
            (ContactRule::Midpoint, Some(&middle)), (ContactRule::EnergyMomentum, Some(&middle)),
        ] {
            let mut method = method(options(dual, averaged));
            method.set_rule(rule, 0.1);
            method.begin_step(&q_n, 0.5).unwrap();
            method.renew(&q, &[], &[], &active, true).unwrap();
            let r = assemble(&method, StepConfiguration { q_n: &q_n, q_np1: &q, rule }, &p, &active).residual;
            let size = r[..3 * NODES].iter().map(|x| x.abs()).sum::<f64>().max(1.0);
            let (force, moment) = resultants(&r, about.unwrap_or(&q));
            prop_assert!(force.amax() < 1e-11 * size, "{rule:?}: {force}");
            prop_assert!(about.is_none() || moment.amax() < 1e-11 * size, "{rule:?}: {moment}");
        }
    }

    #[test]
    fn the_work_of_the_energy_momentum_element_is_the_change_of_the_gaps(
        d in warp(), e in warp(), p in pressures(), dual in any::<bool>(),
    ) {
        let q_n = moved(&d);
        let q: Vec<f64> = q_n.iter().zip(&e).map(|(x, e)| x + e).collect();
        let mut method = method(options(dual, true));
        let active: Vec<bool> = p.iter().map(|p| *p != 0.0).collect();
        let rule = ContactRule::EnergyMomentum;
        method.set_rule(rule, 0.1);
        method.begin_step(&q_n, 0.5).unwrap();
        let at = |q_np1: &[f64]| assemble(&method, StepConfiguration { q_n: &q_n, q_np1, rule }, &p, &active).residual;
        let (start, end) = (at(&q_n), at(&q));
        // Rows hold minus the weighted gaps of slots with a partner.
        let work: f64 = (0..3 * NODES).map(|k| -end[k] * (q[k] - q_n[k])).sum();
        let has = |s: usize| method.supports()[s] > 0.0;
        let change: f64 = (0..SLAVE).filter(|&s| has(s)).map(|s| p[s] * (start[3 * NODES + s] - end[3 * NODES + s])).sum();
        prop_assert!((work - change).abs() < 1e-13, "{work} {change}");
    }

    #[test]
    fn a_rigid_motion_changes_no_gap(d in warp(), p in pressures(), angle in -1.0f64..1.0, dual in any::<bool>()) {
        let q_n = moved(&d);
        let turn = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(Vector3::new(0.3, -0.5, 0.8)), angle);
        let q: Vec<f64> = q_n.chunks_exact(3)
            .flat_map(|x| { let y = turn * Vector3::new(x[0], x[1], x[2]) + Vector3::new(1.0, 2.0, -0.5); [y.x, y.y, y.z] }).collect();
        let active: Vec<bool> = p.iter().map(|p| *p != 0.0).collect();
        for rule in RULES {
            let mut method = method(options(dual, true));
            method.set_rule(rule, 0.1);
            method.begin_step(&q_n, 0.5).unwrap();
            let (mut before, mut after) = ([0.0; SLAVE], [0.0; SLAVE]);
            method.complementarity_gaps(&q_n, &active, &mut before).unwrap();
            method.renew(&q, &[], &[], &active, false).unwrap();
            method.complementarity_gaps(&q, &active, &mut after).unwrap();
            for (a, b) in before.iter().zip(&after) {
                prop_assert!(a == b || (a - b).abs() < 1e-12, "{rule:?}: {a} {b}");
            }
        }
    }
}

/// Flat surfaces a distance apart: every weighted gap over its support is that distance, on partly covered facets too.
#[test]
fn gaps_of_flat_surfaces_are_their_distance() {
    for dual in [false, true] {
        let mut method = method(options(dual, true));
        method.begin_step(&base(), 0.5).unwrap();
        let reports = method.report(&base()).unwrap();
        assert!(reports.iter().filter(|r| r.gap.is_some()).count() > 5);
        for report in reports {
            assert!(report.gap.is_none_or(|g| (g - 0.05).abs() < 1e-12), "{report:?}");
            assert!(report.gap.is_none() || (report.normal[2] - 1.0).abs() < 1e-14);
        }
        assert!(method.coverage().unwrap().unwrap().faults.is_empty());
    }
}

/// A node without its own multiplier hands its function on: a constant pressure on the others pushes with the whole area.
#[test]
fn crosspoints_keep_the_area() {
    for dual in [false, true] {
        let mut plain = method(options(dual, true));
        // Nodes 0, 1, 2: one edge of the surface.
        let mut crossed = method(options(dual, true)).with_crosspoints(|n| [n < 3; 3]);
        let total = |m: &mut MortarContact| {
            m.begin_step(&base(), 0.5).unwrap();
            m.supports()
        };
        let (a, b) = (total(&mut plain), total(&mut crossed));
        assert!((a.iter().sum::<f64>() - b.iter().sum::<f64>()).abs() < 1e-13);
        assert!(b[..3].iter().all(|s| *s == 0.0), "{b:?}");
        let mut gaps = [0.0; SLAVE];
        crossed.complementarity_gaps(&base(), &[false; SLAVE], &mut gaps).unwrap();
        assert!(gaps[..3].iter().all(|g| g.is_infinite()));
        // What matters is the motion along the normal, here z.
        let mut normal = method(options(dual, true)).with_crosspoints(|n| [false, false, n < 3]);
        assert_eq!(total(&mut normal), b);
        let mut tangential = method(options(dual, true)).with_crosspoints(|n| [n < 3, n < 3, false]);
        assert_eq!(total(&mut tangential), a);
        // A rigid tool keeps its multipliers.
        let mut tool = method(options(dual, true)).with_crosspoints(|n| [n < SLAVE as u32; 3]);
        assert_eq!(total(&mut tool), a);
    }
}

/// The one-sided constraint keeps penetrations of the start of the step and closes open gaps.
#[test]
fn the_one_sided_constraint_keeps_penetrations_only() {
    let mut method = method(MortarOptions { constraint: WeightedConstraint::OneSided, ..options(false, true) });
    method.set_rule(ContactRule::EnergyMomentum, 0.1);
    let lifted = |by: f64| {
        let mut q = base();
        (0..SLAVE).for_each(|k| q[3 * k + 2] += by);
        q
    };
    let mut gaps_from = |start: f64, end: f64| {
        method.begin_step(&lifted(start), 0.5).unwrap();
        let mut gaps = [0.0; SLAVE];
        method.complementarity_gaps(&lifted(end), &[true; SLAVE], &mut gaps).unwrap();
        gaps.into_iter().filter(|g| g.is_finite()).collect::<Vec<f64>>()
    };
    // A node is then as far away as it is above what it is to keep. The surfaces are rough: lifted by 0.3 all are open, lowered by 0.3 all penetrate.
    let (open, deep) = (gaps_from(0.3, 0.3), gaps_from(-0.3, -0.3));
    assert!(!open.is_empty() && open.iter().all(|g| *g > 0.05), "{open:?}");
    assert!(!deep.is_empty() && deep.iter().all(|g| g.abs() < 1e-14), "{deep:?}");
    assert!(gaps_from(-0.3, -0.28).iter().all(|g| (g - 0.02).abs() < 1e-2), "pushed out by 0.02");
}

/// Where integrals follow the iterate, too, a node keeps the penetration with which it closes; from then on a tenth of it is let out in a step, also over a restart.
#[test]
fn kept_penetrations_are_let_out_slowly() {
    let options = MortarOptions { constraint: WeightedConstraint::OneSided, ..options(false, true) };
    let mut deep = base();
    (0..SLAVE).for_each(|k| deep[3 * k + 2] -= 0.3);
    let gaps = |method: &mut MortarContact, q: &[f64]| {
        method.set_rule(ContactRule::EndPoint, 0.1);
        method.begin_step(q, 0.5).unwrap();
        let mut gaps = [0.0; SLAVE];
        method.complementarity_gaps(q, &[true; SLAVE], &mut gaps).unwrap();
        gaps
    };
    let mut first = method(options);
    let kept = gaps(&mut first, &deep);
    assert!(
        kept.iter().filter(|g| g.is_finite()).count() > 3 && kept.iter().all(|g| g.abs() < 1e-14 || g.is_infinite())
    );
    let truly: Vec<Option<f64>> = first.report(&deep).unwrap().iter().map(|report| report.gap).collect();
    first.commit(&deep, &[1.0; SLAVE], &[true; SLAVE]);
    let mut again = method(options);
    again.load_history(&first.save_history()).unwrap();
    for method in [&mut first, &mut again] {
        for (gap, truly) in gaps(method, &deep).into_iter().zip(&truly) {
            // What stays of it is 0.9: the node is as much too deep.
            assert!(truly.map_or(gap.is_infinite(), |truly| (gap - 0.1 * truly).abs() < 1e-14), "{gap} {truly:?}");
        }
        // A hundredth of the step lets out a hundredth of that.
        method.set_rule(ContactRule::EndPoint, 1e-3);
        method.begin_step(&deep, 0.5).unwrap();
        let mut gaps = [0.0; SLAVE];
        method.complementarity_gaps(&deep, &[true; SLAVE], &mut gaps).unwrap();
        let part = 1.0 - 0.9_f64.powf(0.01);
        assert!(gaps.iter().zip(&truly).all(|(gap, t)| t.is_none_or(|t| (gap - part * t).abs() < 1e-14)), "{gaps:?}");
    }
    assert!(again.load_history(&[0; 12]).is_err());
    // What comes to be deeper between two steps, by another choice of what counts, is kept as well.
    let deeper: Vec<f64> =
        (0..deep.len()).map(|k| deep[k] - if k < 3 * SLAVE && k % 3 == 2 { 0.05 } else { 0.0 }).collect();
    let found = gaps(&mut again, &deeper);
    let truly: Vec<Option<f64>> = again.report(&deeper).unwrap().iter().map(|report| report.gap).collect();
    assert!(
        truly.iter().zip(found).all(|(truly, gap)| truly.is_none_or(|t| (gap - 0.1 * t).abs() < 1e-14)),
        "{found:?}"
    );
}

/// Where integrals stay those of the start, what is more than a facet behind the master is not opposite: the far side of a hollow body.
#[test]
fn the_far_side_is_not_opposite() {
    let mut method = method(options(false, true));
    let mut covered = |rule, lift: f64| {
        let mut q = base();
        (0..SLAVE).for_each(|k| q[3 * k + 2] += lift);
        method.set_rule(rule, 0.1);
        method.begin_step(&q, 0.5).unwrap();
        method.supports().into_iter().filter(|s| *s > 0.0).count()
    };
    for rule in [ContactRule::Midpoint, ContactRule::EnergyMomentum] {
        assert!(covered(rule, -0.4) > 0);
        assert_eq!(covered(rule, -2.0), 0);
    }
    assert!(covered(ContactRule::EndPoint, -2.0) > 0, "iterates may be far inside");
}

/// The modified constraint refers to the gap at the start of the step.
#[test]
fn the_modified_constraint_keeps_the_gap() {
    let mut method = method(MortarOptions { constraint: WeightedConstraint::Modified, ..options(false, true) });
    method.set_rule(ContactRule::EnergyMomentum, 0.1);
    method.begin_step(&base(), 0.5).unwrap();
    let mut gaps = [0.0; SLAVE];
    method.complementarity_gaps(&base(), &[true; SLAVE], &mut gaps).unwrap();
    assert!(gaps.iter().all(|g| g.is_infinite() || g.abs() < 1e-14), "{gaps:?}");
    let mut closer = base();
    (0..SLAVE).for_each(|k| closer[3 * k + 2] -= 0.02);
    method.complementarity_gaps(&closer, &[true; SLAVE], &mut gaps).unwrap();
    assert!(gaps.iter().all(|g| g.is_infinite() || (g + 0.02).abs() < 1e-13), "{gaps:?}");
}
