//! The contact method at random configurations: tangents, momenta, work, crosspoints.

use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use stoss_contact::{ContactMethod, ContactRule, LocalContribution, StepConfiguration};
use stoss_contact_mortar::segmentation::Provenance;
use stoss_contact_mortar::{MortarContact, MortarOptions, MultiplierSpace, NormalField, WeightedConstraint};

const SLAVE: usize = 9;
const NODES: usize = 25;

/// A sheet of `n x n` facets over `[0, size]^2`, numbered from `first`; `up`: normals along +z.
fn sheet(n: usize, first: u32, up: bool) -> Vec<[u32; 4]> {
    let at = |i: usize, j: usize| first + (j * (n + 1) + i) as u32;
    let facets = (0..n * n).map(|f| (f % n, f / n)).map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if up { [a, b, c, d] } else { [a, d, c, b] }
    });
    facets.collect()
}

/// Slave: two by two facets on top of a master of three by three, turned, shifted so that they overlap in part only.
fn base() -> Vec<f64> {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.3);
    let mut q = Vec::new();
    for k in 0..SLAVE {
        let x = turn * Vector3::new((k % 3) as f64 * 0.9, (k / 3) as f64 * 0.8, 0.0) + Vector3::new(0.55, 0.37, 1.05);
        q.extend(x.iter());
    }
    for k in 0..16 {
        q.extend([(k % 4) as f64 * 0.7, (k / 4) as f64 * 0.72, 1.0]);
    }
    q
}

fn moved(d: &[f64]) -> Vec<f64> {
    base().iter().zip(d).map(|(x, d)| x + d).collect()
}

fn method(options: MortarOptions) -> MortarContact {
    MortarContact::new("test", &sheet(2, 0, false), &sheet(3, SLAVE as u32, true), &base(), options).unwrap()
}

fn options(dual: bool, averaged: bool) -> MortarOptions {
    MortarOptions {
        space: if dual { MultiplierSpace::Dual } else { MultiplierSpace::Standard },
        normals: if averaged { NormalField::Averaged } else { NormalField::Facet },
        ..MortarOptions::default()
    }
}

/// Residual and tangent in all coordinates and pressures.
struct Global {
    residual: Vec<f64>,
    tangent: Vec<f64>,
}

const ALL: usize = 3 * NODES + SLAVE;

fn assemble(method: &MortarContact, step: StepConfiguration<'_>, p: &[f64], active: &[bool]) -> Global {
    let mut out = Global { residual: vec![0.0; ALL], tangent: vec![0.0; ALL * ALL] };
    method
        .assemble(step, p, active, true, &mut |local: &LocalContribution| {
            let mut index: Vec<usize> =
                local.nodes.iter().flat_map(|&n| (0..3).map(move |i| 3 * n as usize + i)).collect();
            index.extend(local.slots.iter().map(|&s| 3 * NODES + s as usize));
            for (i, &row) in index.iter().enumerate() {
                out.residual[row] += local.residual[i];
                for (j, &column) in index.iter().enumerate() {
                    out.tangent[row * ALL + column] += local.tangent[i * local.dim() + j];
                }
            }
        })
        .unwrap();
    out
}

fn kinds(method: &MortarContact) -> Vec<(u32, Provenance)> {
    let facets = &method.segments().unwrap().facets;
    let segments = facets.iter().flat_map(|f| &f.segments);
    segments.flat_map(|s| s.vertices().iter().map(|v| (s.master_facet, v.provenance))).collect()
}

/// Largest difference between tangent and central differences, relative to the largest entry; `None` if the segments
/// change their kind within the differences.
fn tangent_error(method: &mut MortarContact, rule: ContactRule, q_n: &[f64], q: &[f64], p: &[f64]) -> Option<f64> {
    let active: Vec<bool> = p.iter().map(|p| *p != 0.0).collect();
    method.set_rule(rule, 0.1);
    method.begin_step(q_n, 0.1).unwrap();
    let mut at = |x: &[f64], p: &[f64]| {
        method.renew(x, &[], &active, true).unwrap();
        let kind = kinds(method);
        (assemble(method, StepConfiguration { q_n, q_np1: x, rule }, p, &active), kind)
    };
    let (exact, kind) = at(q, p);
    let size = exact.tangent.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let h = 2e-6;
    let mut worst = 0.0_f64;
    for column in 0..ALL {
        let mut ends = [1.0, -1.0].map(|sign| {
            let (mut x, mut p) = (q.to_vec(), p.to_vec());
            if column < 3 * NODES {
                x[column] += sign * h;
            } else if active[column - 3 * NODES] {
                p[column - 3 * NODES] += sign * h;
            }
            at(&x, &p)
        });
        if ends.iter().any(|e| e.1 != kind) {
            return None;
        }
        let [plus, minus] = &mut ends;
        for row in 0..ALL {
            let difference = (plus.0.residual[row] - minus.0.residual[row]) / (2.0 * h);
            worst = worst.max((difference - exact.tangent[row * ALL + column]).abs());
        }
    }
    Some(worst / size)
}

const RULES: [ContactRule; 5] = [
    ContactRule::StartPoint,
    ContactRule::EndPoint,
    ContactRule::EndPointMean,
    ContactRule::Midpoint,
    ContactRule::EnergyMomentum,
];

/// Resultant and moment about `x` of the forces in a residual.
fn resultants(residual: &[f64], x: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
    let v = |a: &[f64], k: usize| Vector3::new(a[3 * k], a[3 * k + 1], a[3 * k + 2]);
    let force = (0..NODES).map(|k| v(residual, k)).sum();
    let moment = (0..NODES).map(|k| v(x, k).cross(&v(residual, k))).sum();
    (force, moment)
}

fn warp() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-0.12f64..0.12, 3 * NODES)
}

fn pressures() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop_oneof![1 => Just(0.0), 3 => 0.3f64..2.0], SLAVE)
}

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
            method.renew(&q, &[], &active, true).unwrap();
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
            method.renew(&q, &[], &active, false).unwrap();
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
        let mut crossed = method(options(dual, true)).with_crosspoints(|n| n < 3);
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
        // A rigid tool keeps its multipliers.
        let mut tool = method(options(dual, true)).with_crosspoints(|n| n < SLAVE as u32);
        assert_eq!(total(&mut tool), a);
    }
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
