//! Where the rules take the gradient of the gap: values, tangents and momenta on one facet, over an edge, over
//! disjoint facets.

use crate::common::*;
use nalgebra::Vector3;
use proptest::prelude::*;
use stoss_contact::{FacetNodes, SearchOptions};
use stoss_contact_nts::kinematics::Gap;
use stoss_contact_nts::{ConstraintForm, NodeToSurface};
use stoss_geometry::Patch;
use stoss_term::{GradientRule, Rule, StepContext, Term, Unilateral};
use stoss_testkit::meshes::{Mesh, divide, meshes};
use stoss_testkit::oracle::{assert_jacobian_close, central_difference_jacobian};

const FACETS: u32 = 6;
/// The slave node, after the master's.
const SLAVE: u32 = 2 * (FACETS + 1);
const PRESSURE: f64 = 3.0;

/// A step with its pairing made.
#[derive(Debug)]
struct Case {
    method: NodeToSurface,
    q_n: Vec<f64>,
    q_1: Vec<f64>,
    /// Facets at both ends.
    start: FacetNodes,
    end: FacetNodes,
    /// Gaps at the start, to all facets and to the surface.
    gaps: Vec<f64>,
    nodes: usize,
}

/// Warped facets that move, and a node that starts on facet 0 with a gap and ends with one on this facet, the next or
/// the fifth. It was in contact at `n`, or closes in the step.
fn step() -> impl Strategy<Value = Case> {
    meshes().prop_flat_map(step_on)
}

fn step_on(meshes: [Mesh; 2]) -> impl Strategy<Value = Case> {
    let noise = |size: f64| proptest::collection::vec(-size..size, 3 * SLAVE as usize);
    (
        noise(0.06),
        noise(0.05),
        (0.4..0.6_f64, 0.2..0.4_f64, 0.1..0.25_f64),
        (prop_oneof![-0.1..0.1_f64, 0.9..1.1_f64, 3.9..4.1_f64], -0.35..-0.2_f64),
        any::<(bool, bool, bool)>(),
    )
        .prop_map(move |(noise, moved, (x, y, z), (slide, depth), (in_contact_at_n, behind, modified))| {
            let form = if modified { ConstraintForm::Modified } else { ConstraintForm::Standard };
            let mut m = method_on(&divide(meshes), FACETS, form, SearchOptions::default());
            let flat = [0.0; FACETS as usize + 1];
            let z = if in_contact_at_n && behind { -z } else { z };
            let (mut q_n, mut q_1) = (positions(&flat, [x, y, z]), positions(&flat, [x + slide, y, depth]));
            for (k, (a, b)) in noise.iter().zip(&moved).enumerate() {
                q_n[k] += a;
                q_1[k] += a + b;
            }
            if in_contact_at_n {
                in_contact(&mut m, &q_n);
            } else {
                m.begin(&StepContext { reach: 20.0, ..StepContext::new(&q_n, GradientRule::EndPoint, 0.0) }).unwrap();
            }
            let distance = gap(&m, &q_n, &OPEN);
            m.repair(&q_1, &ACTIVE).unwrap();
            let mut nodes = Vec::new();
            m.stencils(&ACTIVE, &mut |stencil, _| nodes.extend_from_slice(stencil));
            let facets = meshes[1].of(&row(FACETS));
            let end = *facets.iter().find(|f| nodes[1..].starts_with(f)).unwrap();
            // One facet for the whole step, or from the one that the node was at: that on whose nodes the start-point rule has forces. (Over an edge
            // or a diagonal two facets may be equally near, so that distances do not tell.)
            let forces = assembled(&m, &q_n, &q_1, PRESSURE, GradientRule::StartPoint, false).0;
            let has_force = |n: u32| forces[3 * n as usize..3 * n as usize + 3].iter().any(|f| *f != 0.0);
            let is_start = |f: &&FacetNodes| (0..SLAVE).all(|n| f.contains(&n) || !has_force(n));
            let start = if nodes.len() == 1 + end.len() { end } else { *facets.iter().find(is_start).unwrap() };
            let gaps = facets.iter().map(|f| gap_to(f, &q_n)).chain([distance]).collect();
            Case { method: m, q_n, q_1, start, end, gaps, nodes: nodes.len() }
        })
}

fn at(q: &[f64], node: u32) -> Vector3<f64> {
    Vector3::from_column_slice(&q[3 * node as usize..3 * node as usize + 3])
}

/// Gap of the slave node to an extended facet.
fn gap_to(facet: &FacetNodes, q: &[f64]) -> f64 {
    Gap::from_centre(&at(q, SLAVE), &Patch::new(facet.map(|n| at(q, n)))).unwrap().gap
}

/// Gradient of that gap by differences.
fn gradient_of_gap(facet: &FacetNodes, q: &[f64]) -> Vec<f64> {
    central_difference_jacobian(|q, out| out[0] = gap_to(facet, q), q, 1e-3, 1)
}

impl Case {
    fn residual(&self, rule: GradientRule) -> Vec<f64> {
        assembled(&self.method, &self.q_n, &self.q_1, PRESSURE, rule, false).0
    }

    fn mid(&self) -> Vec<f64> {
        self.q_n.iter().zip(&self.q_1).map(|(a, b)| 0.5 * (a + b)).collect()
    }
}

/// Sums of the forces and of their moments about the origin at `q`.
fn resultants(q: &[f64], forces: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for (x, f) in q.chunks_exact(3).zip(forces.chunks_exact(3)) {
        force += Vector3::from_column_slice(f);
        moment += Vector3::from_column_slice(x).cross(&Vector3::from_column_slice(f));
    }
    (force, moment)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn gradients_at_the_ends_are_those_of_the_gaps_there(case in step()) {
        let (m, n) = (&case.method, case.q_1.len());
        let (at_n, at_1) = (gradient_of_gap(&case.start, &case.q_n), gradient_of_gap(&case.end, &case.q_1));
        let mean: Vec<f64> = at_n.iter().zip(&at_1).map(|(a, b)| 0.5 * (a + b)).collect();
        let factor = -m.slot_weight(0) * PRESSURE;
        for (rule, expected) in
            [(GradientRule::StartPoint, at_n), (GradientRule::EndPoint, at_1), (GradientRule::EndPointMean, mean)]
        {
            let residual = case.residual(rule);
            let expected: Vec<f64> = expected.iter().map(|g| factor * g).collect();
            assert_jacobian_close(&residual[..n], &expected, n, 1e-8, &format!("force of {rule:?}"));
        }
        // The constraint is the gap at the end, under the standard form, and the same row under every rule.
        let row = case.residual(GradientRule::EndPoint)[n];
        let end_gap = gap_to(&case.end, &case.q_1);
        let reference = row / m.slot_weight(0) + end_gap;
        let start_gap = gap_to(&case.start, &case.q_n);
        // The gap to an extension may be anything.
        let far = |gap: f64| gap.abs() > 0.02;
        prop_assert!(far(end_gap) && (case.start == case.end || far(start_gap)), "gaps {start_gap} {end_gap}");
        // Of facets that are equally near at the start any may be the one that the gap there is measured from.
        let mut possible = std::iter::once(0.0).chain(case.gaps.iter().copied());
        prop_assert!(possible.any(|gap| (reference - gap).abs() < 1e-14), "reference gap {reference}");
        for rule in GradientRule::ALL {
            prop_assert_eq!(case.residual(rule)[n], row);
        }
    }

    #[test]
    fn tangents_are_the_derivatives(case in step(), rule in prop::sample::select(&GradientRule::ALL[..])) {
        let Case { method: m, q_n, q_1, .. } = &case;
        let (residual, tangent) = assembled(m, q_n, q_1, PRESSURE, rule, true);
        let n = residual.len();
        for (alone, with_tangent) in case.residual(rule).iter().zip(&residual) {
            // The energy-momentum element with its tangent is evaluated in dual numbers, which round differently.
            let tolerance = if rule == GradientRule::DiscreteGradient { 1e-12 } else { 0.0 };
            prop_assert!((alone - with_tangent).abs() <= tolerance);
        }
        let mut at = q_1.clone();
        at.push(PRESSURE);
        let numeric = central_difference_jacobian(
            |x, out| out.copy_from_slice(&assembled(m, q_n, &x[..n - 1], x[n - 1], rule, false).0), &at, 1e-3, n,
        );
        assert_jacobian_close(&tangent, &numeric, n, 1e-7, &format!("tangent of {rule:?}"));
        prop_assert_eq!(m.is_symmetric(Rule::Constraint(rule)), rule == GradientRule::EndPoint);
        if m.is_symmetric(Rule::Constraint(rule)) {
            let size = tangent.iter().fold(0f64, |m, k| m.max(k.abs()));
            let asymmetry = (0..n * n).fold(0f64, |m, k| m.max((tangent[k] - tangent[k % n * n + k / n]).abs()));
            prop_assert!(asymmetry <= 1e-13 * size, "{asymmetry:e} of {size:e}");
        }
        if rule == GradientRule::StartPoint {
            let rows = tangent.chunks_exact(n).take(n - 1);
            prop_assert!(rows.flat_map(|row| &row[..n - 1]).all(|k| *k == 0.0), "the force is constant in the step");
        }
    }

    #[test]
    fn forces_balance_and_moments_where_the_rule_says(case in step()) {
        let n = case.q_1.len();
        let mid = case.mid();
        for rule in GradientRule::ALL {
            let residual = case.residual(rule);
            let at = match rule {
                GradientRule::StartPoint => &case.q_n,
                GradientRule::EndPoint => &case.q_1,
                _ => &mid,
            };
            let (force, moment) = resultants(at, &residual[..n]);
            prop_assert!(force.norm() < 1e-12 * PRESSURE, "{:?}: force {:e}", rule, force.norm());
            if rule != GradientRule::EndPointMean {
                prop_assert!(moment.norm() < 1e-12 * PRESSURE, "{:?}: moment {:e}", rule, moment.norm());
            }
        }
        // The mean of two gradients, each balanced at its own end, is not balanced at the midpoint.
        let increment: Vec<f64> = case.q_1.iter().zip(&case.q_n).map(|(b, a)| b - a).collect();
        let change: Vec<f64> = case
            .residual(GradientRule::EndPoint)
            .iter()
            .zip(case.residual(GradientRule::StartPoint))
            .map(|(b, a)| b - a)
            .collect();
        let expected = -0.25 * resultants(&increment, &change[..n]).1;
        let moment = resultants(&mid, &case.residual(GradientRule::EndPointMean)[..n]).1;
        prop_assert!((moment - expected).norm() < 1e-12 * PRESSURE, "moment {moment} against {expected}");
    }

    #[test]
    fn the_mean_of_the_ends_has_no_moment_in_a_rigid_motion(
        meshes in meshes(),
        case in step(),
        turn in proptest::array::uniform3(-1.0..1.0_f64),
        shift in proptest::array::uniform3(-2.0..2.0_f64),
    ) {
        let rotation = nalgebra::Rotation3::new(Vector3::from(turn));
        let q_n = case.q_n;
        let q_1: Vec<f64> = q_n
            .chunks_exact(3)
            .flat_map(|x| <[f64; 3]>::from(rotation * Vector3::from_column_slice(x) + Vector3::from(shift)))
            .collect();
        let mut m = standard_on(&divide(meshes), FACETS);
        in_contact(&mut m, &q_n);
        prop_assert_eq!(m.repair(&q_1, &ACTIVE).unwrap(), 0);
        let residual = assembled(&m, &q_n, &q_1, PRESSURE, GradientRule::EndPointMean, false).0;
        let mid: Vec<f64> = q_n.iter().zip(&q_1).map(|(a, b)| 0.5 * (a + b)).collect();
        let moment = resultants(&mid, &residual[..q_1.len()]).1;
        prop_assert!(moment.norm() < 1e-12 * PRESSURE, "moment {:e}", moment.norm());
    }
}

#[test]
fn the_strategy_reaches_every_kind_of_pairing() {
    use proptest::{strategy::ValueTree, test_runner::TestRunner};
    let mut runner = TestRunner::deterministic();
    let cases: Vec<Case> = (0..200).map(|_| step_on(Mesh::PAIRS[0]).new_tree(&mut runner).unwrap().current()).collect();
    for nodes in [5, 7, 9] {
        let count = cases.iter().filter(|c| c.nodes == nodes && (c.start == c.end) == (nodes == 5)).count();
        assert!(count > 10, "{count} cases with {nodes} nodes");
    }
    let next = FacetNodes::from(row(FACETS)[1]);
    let on_extension = |c: &&Case| c.start == next && c.end == next;
    assert!(cases.iter().any(|c| on_extension(&c)), "closes on the next facet and starts on its extension");
    // Of triangles: one, two with an edge, two with a node, two with none.
    let cases: Vec<Case> = (0..400).map(|_| step_on(Mesh::PAIRS[3]).new_tree(&mut runner).unwrap().current()).collect();
    for nodes in [4, 5, 6, 7] {
        let count = cases.iter().filter(|c| c.nodes == nodes && (c.start == c.end) == (nodes == 4)).count();
        assert!(count > 0, "{count} cases with {nodes} nodes");
    }
}

#[test]
fn the_moment_of_the_mean_of_the_ends_vanishes_with_the_square_of_the_motion() {
    let mut q_n = positions(&[0.0; FACETS as usize + 1], [0.4, 0.3, -0.1]);
    for (k, x) in q_n.iter_mut().enumerate() {
        *x += 0.05 * (1.7 * k as f64).sin();
    }
    let mut m = standard(FACETS);
    in_contact(&mut m, &q_n);
    let moment = |size: f64| {
        let q_1: Vec<f64> = q_n.iter().enumerate().map(|(k, x)| x + size * (2.3 * k as f64).cos()).collect();
        let residual = assembled(&m, &q_n, &q_1, 1.0, GradientRule::EndPointMean, false).0;
        let mid: Vec<f64> = q_n.iter().zip(&q_1).map(|(a, b)| 0.5 * (a + b)).collect();
        resultants(&mid, &residual[..q_1.len()]).1.norm()
    };
    let (large, small) = (moment(2e-2), moment(1e-2));
    assert!(small > 1e-7, "there is a moment: {small:e}");
    assert!((large / small - 4.0).abs() < 0.2, "of second order: {}", large / small);
}
