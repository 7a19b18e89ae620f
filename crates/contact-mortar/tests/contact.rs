//! The weighted gap as a function of positions, and the contact method at random configurations: the identities of theory/mortar#energy and theory/mortar#tangent.

use crate::sheets;

use crate::sheets::{
    NODES, SLAVE, SheetKind, base, factors, method, moved, options, pressures, residual_of, resultants, surfaces,
    tangent_errors, warp,
};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use stoss_contact_mortar::{Integrals, MortarContact, MortarOptions};
use stoss_term::{At, GradientRule, HeldNodes, StepConfiguration, StepContext, Term, Unilateral};

fn lifted(d: &[f64], lift: f64) -> Vec<f64> {
    let mut q = moved(d);
    (0..SLAVE).for_each(|k| q[3 * k + 2] += lift);
    q
}

fn plus(q: &[f64], f: f64, d: &[f64]) -> Vec<f64> {
    q.iter().zip(d).map(|(x, d)| x + f * d).collect()
}

fn begun(surfaces: [SheetKind; 2], dual: bool, kind: usize, rule: GradientRule, q_n: &[f64]) -> MortarContact {
    let mut method = method(surfaces, options(dual)).with_factors(factors(kind));
    method.begin(&StepContext { reach: 0.5, ..StepContext::new(q_n, rule, 0.1) }).unwrap();
    method
}

/// Minus the weighted gaps at `q`, and the residual.
fn residual(method: &mut MortarContact, rule: GradientRule, q_n: &[f64], q: &[f64], p: &[f64]) -> Vec<f64> {
    let active: Vec<bool> = p.iter().map(|p| *p != 0.0).collect();
    method.renew(&At::end(q, &[], &active), false).unwrap();
    residual_of(method, StepConfiguration { q_n, q_np1: q, rule }, p, &active)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// M2, M11: rows are the gradients of the discrete gaps. In the derivative of the forces the second derivatives of the weights are missing.
    #[test]
    fn rows_are_gradients(
        surfaces in surfaces(), d in warp(), e in warp(), p in pressures(), dual in any::<bool>(), rule in 0usize..5, kind in 0usize..3, lift in -0.2f64..0.1,
    ) {
        let q_n = lifted(&d, lift);
        let q = plus(&q_n, 0.3, &e);
        let mut method = method(surfaces, options(dual)).with_factors(factors(kind));
        if let Some([rows, forces]) = tangent_errors(&mut method, GradientRule::ALL[rule], &q_n, &q, &p) {
            prop_assert!(rows < 1e-6, "{:?} dual {dual} factors {kind}: {rows:e}", GradientRule::ALL[rule]);
            // With gaps of a tenth of a facet they are of the size of all others; a kink of the polygon within the difference, or a sliver, may be more.
            prop_assert!(GradientRule::ALL[rule] != GradientRule::StartPoint || forces < 1e-6, "{:?} factors {kind}: {forces:e}", GradientRule::ALL[rule]);
        }
    }

    /// In statics the tangent is exact, with a law for the penetration and at planes of symmetry, too.
    #[test]
    fn tangents_of_statics_are_derivatives(
        surfaces in surfaces(), d in warp(), e in warp(), p in pressures(), dual in any::<bool>(), kind in 0usize..3, lift in -0.2f64..0.1, soft in any::<bool>(), mirrored in any::<[bool; 2]>(),
    ) {
        let q_n = lifted(&d, lift);
        let q = plus(&q_n, 0.3, &e);
        let overclosure = soft.then_some(7.0);
        let mut method = method(surfaces, MortarOptions { overclosure, ..options(dual) })
            .with_factors(factors(kind))
            .with_symmetry((0..SLAVE as u32).map(|n| {
                (n, u8::from(mirrored[0] && n % 3 == 0) + 2 * u8::from(mirrored[1] && n % 2 == 0))
            }));
        if let Some([rows, forces]) = tangent_errors(&mut method, GradientRule::EndPoint, &q_n, &q, &p) {
            prop_assert!(rows < 1e-6 && forces < 1e-6, "dual {dual} factors {kind}: {rows:e} {forces:e}");
        }
    }

    /// With integrals that are held the derivative of the forces is exact but for the slope of `theta`, which is one of higher order in the increment.
    #[test]
    fn tangents_with_frozen_integrals_are_derivatives(surfaces in surfaces(), d in warp(), e in warp(), p in pressures(), dual in any::<bool>(), lift in -0.2f64..0.1) {
        let q_n = lifted(&d, lift);
        let q = plus(&q_n, 0.02, &e);
        let mut method = method(surfaces, MortarOptions { integrals: Integrals::Frozen, ..options(dual) });
        if let Some([rows, forces]) = tangent_errors(&mut method, GradientRule::DiscreteGradient, &q_n, &q, &p) {
            prop_assert!(rows < 1e-7 && forces < 1e-4, "{rows:e} {forces:e}");
        }
    }

    /// M1, M4, M5: for any gaps, at every iterate.
    #[test]
    fn forces_have_neither_resultant_nor_moment(
        surfaces in surfaces(), d in warp(), e in warp(), lift in -0.3f64..0.5, p in pressures(), dual in any::<bool>(), kind in 0usize..3, frozen in any::<bool>(),
    ) {
        let q_n = lifted(&d, lift);
        let q = plus(&q_n, 1.0, &e);
        let middle = plus(&q_n, 0.5, &e);
        for (rule, about) in [
            (GradientRule::StartPoint, Some(&q_n)), (GradientRule::EndPoint, Some(&q)), (GradientRule::EndPointMean, None),
            (GradientRule::Midpoint, Some(&middle)), (GradientRule::DiscreteGradient, Some(&middle)),
        ] {
            if frozen && rule != GradientRule::DiscreteGradient {
                continue;
            }
            let integrals = if frozen { Integrals::Frozen } else { Integrals::Moving };
            let mut method = method(surfaces, MortarOptions { integrals, ..options(dual) }).with_factors(factors(kind));
            method.begin(&StepContext { reach: 0.5, v_n: &plus(&vec![0.0; q.len()], 10.0, &e), ..StepContext::new(&q_n, rule, 0.1) }).unwrap();
            let r = residual(&mut method, rule, &q_n, &q, &p);
            let size = r[..3 * NODES].iter().map(|x| x.abs()).sum::<f64>().max(1.0);
            let (force, moment) = resultants(&r, about.unwrap_or(&q));
            prop_assert!(force.amax() < 1e-11 * size, "{rule:?}: {force}");
            prop_assert!(about.is_none() || moment.amax() < 1e-11 * size, "{rule:?}: {moment}");
        }
    }

    /// The gradients that closing losses are restored along: those of the rows, without resultant or moment about the end of the step.
    #[test]
    fn constraint_gradients_are_those_of_the_rows(
        surfaces in surfaces(), d in warp(), e in warp(), lift in -0.3f64..0.5, p in pressures(), dual in any::<bool>(), kind in 0usize..3,
    ) {
        let q_n = lifted(&d, lift);
        let q = plus(&q_n, 1.0, &e);
        let mut method = method(surfaces, options(dual)).with_factors(factors(kind));
        method.begin(&StepContext { reach: 0.5, ..StepContext::new(&q_n, GradientRule::DiscreteGradient, 0.1) }).unwrap();
        let mut force = vec![0.0; q.len()];
        method.constraint_gradients(&q, &[true; SLAVE], &mut |slot, nodes, gradient| {
            for (&node, g) in nodes.iter().zip(gradient.chunks_exact(3)) {
                (0..3).for_each(|i| force[3 * node as usize + i] -= p[slot] * g[i]);
            }
        }).unwrap();
        method.begin(&StepContext { reach: 0.5, ..StepContext::new(&q_n, GradientRule::EndPoint, 0.1) }).unwrap();
        let expected = residual(&mut method, GradientRule::EndPoint, &q_n, &q, &p);
        let size = expected.iter().map(|x| x.abs()).sum::<f64>().max(1.0);
        for (f, r) in force.iter().zip(&expected) {
            prop_assert!((f - r).abs() < 1e-12 * size, "{f:e} {r:e}");
        }
        let (force, moment) = resultants(&force, &q);
        prop_assert!(force.amax() < 1e-11 * size && moment.amax() < 1e-11 * size, "{force} {moment}");
    }

    /// A corner of a facet that has passed the diagonal beside it: its image is split into triangles with maps of their own, and the depth factor fades there.
    #[test]
    fn forces_on_split_facets_have_no_moment(d in warp(), lift in -0.35f64..-0.2, corner in 0.55f64..0.7) {
        let mut q = lifted(&d.iter().map(|d| 0.2 * d).collect::<Vec<f64>>(), lift);
        let at = |q: &[f64], k: usize| Vector3::new(q[3 * k], q[3 * k + 1], q[3 * k + 2]);
        let inside = at(&q, 0) + (at(&q, 4) - at(&q, 0)) * corner;
        q[..3].copy_from_slice(inside.as_slice());
        let p = [1.0; SLAVE];
        let mut method = begun([SheetKind::Quads; 2], false, 2, GradientRule::EndPoint, &q);
        prop_assert!(method.segments().is_some_and(|s| s.facets[0].frame.is_split()));
        let r = residual(&mut method, GradientRule::EndPoint, &q, &q, &p);
        let (force, moment) = resultants(&r, &q);
        prop_assert!(force.amax() < 1e-11 && moment.amax() < 1e-11, "{force} {moment}");
    }

    /// M7: the work of the force is the change of the weighted gaps, counted from the distance in the middle of the step.
    #[test]
    fn the_work_is_the_change_of_the_gaps(
        surfaces in surfaces(), d in warp(), e in warp(), p in pressures(), lift in -0.3f64..0.3, dual in any::<bool>(), kind in 0usize..3, frozen in any::<bool>(),
    ) {
        let q_n = lifted(&d, lift);
        let q = plus(&q_n, 1.0, &e);
        let integrals = if frozen { Integrals::Frozen } else { Integrals::Moving };
        for rule in [GradientRule::Midpoint, GradientRule::DiscreteGradient] {
            let mut method = method(surfaces, MortarOptions { integrals, ..options(dual) }).with_factors(factors(kind));
            method.begin(&StepContext { reach: 0.5, ..StepContext::new(&q_n, rule, 0.1) }).unwrap();
            let start = residual(&mut method, rule, &q_n, &q_n, &p);
            let before = method.supports();
            let end = residual(&mut method, rule, &q_n, &q, &p);
            let after = method.supports();
            let work: f64 = (0..3 * NODES).map(|k| -end[k] * (q[k] - q_n[k])).sum();
            let change = (0..SLAVE).map(|s| {
                // A gap is to close, a penetration is kept, so that its row is zero at the start.
                let distance = if before[s] > 0.0 { -0.5 * start[3 * NODES + s] / before[s] } else { 0.0 };
                p[s] * (start[3 * NODES + s] - end[3 * NODES + s] - distance * (after[s] - before[s]))
            });
            let change: f64 = change.sum();
            prop_assert!((work - change).abs() < 1e-12, "{rule:?} {work} {change}");
        }
    }

    /// M3, M6.
    #[test]
    fn a_rigid_motion_changes_no_gap(surfaces in surfaces(), d in warp(), angle in -1.0f64..1.0, dual in any::<bool>(), kind in 0usize..3) {
        let q_n = moved(&d);
        let turn = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(Vector3::new(0.3, -0.5, 0.8)), angle);
        let q: Vec<f64> = q_n.chunks_exact(3)
            .flat_map(|x| { let y = turn * Vector3::new(x[0], x[1], x[2]) + Vector3::new(1.0, 2.0, -0.5); [y.x, y.y, y.z] }).collect();
        for rule in GradientRule::ALL {
            let mut method = begun(surfaces, dual, kind, rule, &q_n);
            let p = [1.0; SLAVE];
            let (before, after) = (residual(&mut method, rule, &q_n, &q_n, &p), residual(&mut method, rule, &q_n, &q, &p));
            for (a, b) in before[3 * NODES..].iter().zip(&after[3 * NODES..]) {
                prop_assert!((a - b).abs() < 1e-13, "{rule:?}: {a} {b}");
            }
        }
    }

    /// M9: along a path on which polygons gain and lose vertices the gaps never jump.
    #[test]
    fn gaps_are_continuous(surfaces in surfaces(), d in warp(), e in warp(), kind in 0usize..3, shift in 0.2f64..1.0) {
        let q_n = moved(&d);
        let mut method = begun(surfaces, false, kind, GradientRule::EndPoint, &q_n);
        let path = |s: f64| { let mut q = plus(&q_n, s, &e); (0..SLAVE).for_each(|k| q[3 * k] += s * shift); q };
        let mut kind_of = |s: f64| { let q = path(s); let r = residual(&mut method, GradientRule::EndPoint, &q_n, &q, &[1.0; SLAVE]); (sheets::kinds(&method), r) };
        // Bisection for the first change.
        let (mut low, mut high) = (0.0, 1.0);
        let (start, _) = kind_of(low);
        prop_assume!(kind_of(high).0 != start);
        for _ in 0..46 {
            let middle = 0.5 * (low + high);
            if kind_of(middle).0 == start { low = middle } else { high = middle }
        }
        let ((a, x), (b, y)) = (kind_of(low), kind_of(high));
        prop_assert!(a == start && b != start);
        for (x, y) in x[3 * NODES..].iter().zip(&y[3 * NODES..]) {
            prop_assert!((x - y).abs() < 1e-11, "{x} {y}");
        }
    }
}

/// M10, and flat surfaces a distance apart: every weighted gap over its support is that distance, on partly covered facets too.
#[test]
fn gaps_of_flat_surfaces_are_their_distance() {
    for (surfaces, dual) in SheetKind::pairs().flat_map(|m| [(m, false), (m, true)]) {
        let method = begun(surfaces, dual, 1, GradientRule::EndPoint, &base());
        let reports = method.report(&base()).unwrap();
        assert!(reports.iter().filter(|r| r.gap.is_some()).count() > 5);
        for report in reports {
            assert!(report.gap.is_none_or(|g| (g - 0.05).abs() < 1e-12), "{report:?}");
            assert!(report.gap.is_none() || (report.normal[2] - 1.0).abs() < 1e-14);
        }
        assert!(method.coverage(&base()).unwrap().unwrap().faults.is_empty());
    }
}

/// A node without its own multiplier hands its function on: a constant pressure on the others pushes with the whole area.
#[test]
fn crosspoints_keep_the_area() {
    for (surfaces, dual) in SheetKind::pairs().flat_map(|m| [(m, false), (m, true)]) {
        let mut method = method(surfaces, options(dual));
        // Prescribed components of the slave nodes before `end`.
        let mut total = |end: u32, components: &[usize]| {
            let mut support = HeldNodes::new(NODES);
            (0..end).for_each(|node| components.iter().for_each(|&c| support.prescribe(node, c)));
            let q = base();
            let step = StepContext { reach: 0.5, held: &support, ..StepContext::new(&q, GradientRule::EndPoint, 0.0) };
            method.begin(&step).unwrap();
            let mut gaps = [0.0; SLAVE];
            method.complementarity_gaps(&base(), &[false; SLAVE], &mut gaps).unwrap();
            (method.supports(), gaps)
        };
        // Nodes 0, 1, 2: one edge of the surface.
        let ((a, _), (b, gaps)) = (total(0, &[]), total(3, &[0, 1, 2]));
        assert!((a.iter().sum::<f64>() - b.iter().sum::<f64>()).abs() < 1e-13);
        assert!(b[..3].iter().all(|s| *s == 0.0), "{b:?}");
        assert!(gaps[..3].iter().all(|g| g.is_infinite()));
        // What matters is the motion along the normal, here z.
        assert_eq!(total(3, &[2]).0, b);
        assert_eq!(total(3, &[0, 1]).0, a);
        // A rigid tool keeps its multipliers, and so does everybody as soon as the support is gone.
        assert_eq!(total(SLAVE as u32, &[0, 1, 2]).0, a);
        assert_eq!(total(0, &[]).0, a);
    }
}

/// A penetration at the start of a step is kept in dynamics and closed in statics, an open gap is closed in both.
#[test]
fn penetrations_of_the_start_are_kept_in_dynamics() {
    let surfaces = [SheetKind::Triangles; 2];
    let gaps_from = |rates: bool, start: f64, end: f64| {
        let mut method = method(surfaces, options(false));
        let zero = vec![0.0; 3 * NODES];
        let q_n = lifted(&zero, start);
        method
            .begin(&StepContext { reach: 0.5, rates, ..StepContext::new(&q_n, GradientRule::DiscreteGradient, 0.1) })
            .unwrap();
        method.renew(&At::end(&lifted(&zero, end), &[], &[false; SLAVE]), false).unwrap();
        let mut gaps = [0.0; SLAVE];
        method.complementarity_gaps(&lifted(&zero, end), &[true; SLAVE], &mut gaps).unwrap();
        gaps.into_iter().filter(|g| g.is_finite()).collect::<Vec<f64>>()
    };
    let all = |gaps: Vec<f64>, value: f64| !gaps.is_empty() && gaps.iter().all(|g| (g - value).abs() < 1e-12);
    assert!(all(gaps_from(true, -0.15, -0.15), 0.0));
    assert!(all(gaps_from(true, -0.15, -0.13), 0.02));
    assert!(all(gaps_from(true, 0.05, 0.0), 0.05));
    assert!(all(gaps_from(false, -0.15, -0.15), -0.1));
}

/// What goes through the surface in a step deeper than contact reaches is refused, not lost.
#[test]
fn a_passage_is_an_error() {
    let zero = vec![0.0; 3 * NODES];
    for surfaces in SheetKind::pairs() {
        let mut method = begun(surfaces, false, 2, GradientRule::DiscreteGradient, &base());
        for (lift, passes) in [(-0.1, false), (-0.3, true), (-0.5, true)] {
            let q = lifted(&zero, lift);
            method.renew(&At::end(&q, &[], &[false; SLAVE]), false).unwrap();
            assert_eq!(method.verify(&q).is_err(), passes, "{lift}");
        }
    }
}

/// A slave that comes over the master in the step, also from beside it: whatever nodes come into the stencils of rows that count as closed is told, for the matrix has to have room for it.
#[test]
fn changed_stencils_are_told() {
    let active = [true; SLAVE];
    let stencils = |method: &MortarContact| {
        let mut all = Vec::new();
        method.stencils(&active, &mut |nodes, slots| all.push((nodes.to_vec(), slots.to_vec())));
        all
    };
    let mut changes = [0, 0];
    for rates in [false, true] {
        for shift in [0.0, 0.4, 1.2, 2.5] {
            let beside = |part: f64| -> Vec<f64> {
                let mut q = base();
                (0..SLAVE).for_each(|k| q[3 * k] += part * shift);
                q
            };
            let mut method = method([SheetKind::Quads; 2], options(false));
            let q_n = beside(1.0);
            let rule = if rates { GradientRule::DiscreteGradient } else { GradientRule::EndPoint };
            method.begin(&StepContext { reach: 3.0, rates, ..StepContext::new(&q_n, rule, 0.1) }).unwrap();
            for part in [1.0, 0.6, 0.3, 0.0] {
                let before = stencils(&method);
                let told = method.renew(&At::end(&beside(part), &[], &active), true).unwrap();
                let changed = before != stencils(&method);
                assert!(told || !changed, "rates {rates}, beside by {shift}, {part} of it left");
                changes[usize::from(rates)] += usize::from(changed);
            }
        }
    }
    assert!(changes.iter().all(|count| *count > 2), "{changes:?}");
}
