//! Friction in the direct form and with the energy-momentum element: tangents, momenta, objectivity, energies, edges, history.

use crate::common::{path as path_of, *};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use std::sync::Arc;
use stoss_contact::friction::{Coulomb, Friction, FrictionLaw, Regularised, StaticDynamic, Stick, SurfaceVelocity};
use stoss_contact::{ContactError, Enforcement};
use stoss_contact_nts::kinematics::{Gap, LOCAL, Local, points};
use stoss_contact_nts::{ConstraintForm, NodeToSurface};
use stoss_reference_element::FacetKind;
use stoss_term::check::sharing;
use stoss_term::{At, GradientRule, StepConfiguration, StepContext, Term, Unilateral, Work};
use stoss_testkit::meshes::{Mesh, divide, meshes};
use stoss_testkit::oracle::{assert_jacobian_close, central_difference_jacobian};

const RULES: [GradientRule; 3] = [GradientRule::EndPoint, GradientRule::Midpoint, GradientRule::DiscreteGradient];
const FACETS: u32 = 6;
const SLAVE: usize = 2 * (FACETS as usize + 1);
const PENALTY: f64 = 40.0;
const PRESSURE: f64 = 3.0;
const STEP: f64 = 0.1;

const QUADS: [Mesh; 2] = Mesh::PAIRS[0];

fn with_law(meshes: [Mesh; 2], law: Arc<dyn FrictionLaw>, stick: Stick) -> NodeToSurface {
    rough(standard_on(&divide(meshes), FACETS), law, stick)
}

fn rough(smooth: NodeToSurface, law: Arc<dyn FrictionLaw>, stick: Stick) -> NodeToSurface {
    on_belt(smooth, law, stick, false)
}

fn on_belt(smooth: NodeToSurface, law: Arc<dyn FrictionLaw>, stick: Stick, moves: bool) -> NodeToSurface {
    let friction = Friction::new(law, PENALTY, stick).unwrap();
    smooth.with_friction(friction.with_surface_velocity(belt(moves))).unwrap()
}

/// A master surface that moves along itself, across the surface too, and faster and faster.
fn belt(moves: bool) -> SurfaceVelocity {
    let rows = if moves { vec![(0.0, [0.7, -0.4, 0.3]), (1.0, [1.9, 0.2, -0.5])] } else { Vec::new() };
    SurfaceVelocity::new(rows)
}

fn with_coulomb(meshes: [Mesh; 2], mu: f64) -> NodeToSurface {
    with_law(meshes, Arc::new(Coulomb::new(mu).unwrap()), Stick::Penalty)
}

/// Three configurations of warped, moving facets with a gap: the node closes in the first step, and slides in it and in the second one.
#[derive(Clone, Debug)]
struct Path {
    meshes: [Mesh; 2],
    q: [Vec<f64>; 3],
    rule: GradientRule,
    /// Pressure of the first step.
    before: f64,
}

/// The second step ends on the same facet, the next or the fifth.
fn path() -> impl Strategy<Value = Path> {
    let noise = |size: f64| proptest::collection::vec(-size..size, 3 * SLAVE);
    (
        (noise(0.06), noise(0.05), noise(0.05), meshes()),
        (0.4..0.6_f64, 0.2..0.4_f64, 0.1..0.2_f64),
        (-0.15..0.15_f64, -0.15..0.15_f64),
        (prop_oneof![0.05..0.15_f64, 0.9..1.1_f64, 3.9..4.1_f64], 0.05..0.15_f64, -0.25..-0.15_f64),
        (prop::sample::select(&RULES[..]), prop_oneof![Just(1.4), Just(7.0)]),
    )
        .prop_map(|((shape, moved, again, meshes), (x, y, z), (dx, dy), (slide, side, depth), (rule, before))| {
            let q = path_of(FACETS, [&shape, &moved, &again], [x, y, z], [dx, dy], [slide, side, depth]);
            Path { meshes, q, rule, before }
        })
}

impl Path {
    /// Does the first step and pairs the second one.
    fn run(&self, m: NodeToSurface) -> NodeToSurface {
        second_step(m, &self.q, self.rule, STEP, self.before)
    }

    fn residual(&self, m: &NodeToSurface) -> Vec<f64> {
        assembled(m, &self.q[1], &self.q[2], PRESSURE, self.rule, false).0
    }

    /// Nodal forces of the friction alone, on the nodes.
    fn friction(&self, m: &NodeToSurface) -> Vec<f64> {
        let mut frictionless = standard_on(&divide(self.meshes), FACETS);
        frictionless = self.run(frictionless);
        let without = self.residual(&frictionless);
        let n = without.len() - 1;
        self.residual(m)[..n].iter().zip(&without).map(|(a, b)| b - a).collect()
    }

    /// Nodal forces of the friction with given multipliers, at any end.
    fn friction_with(&self, m: &NodeToSurface, q: &[f64], pressure: f64, auxiliaries: &[f64]) -> Vec<f64> {
        let x: Vec<f64> = q.iter().chain(&[pressure]).chain(&auxiliaries[..2]).copied().collect();
        let with = assembled_with(m, &self.q[1], self.rule, &x, auxiliaries, false).0;
        let frictionless = self.run(standard_on(&divide(self.meshes), FACETS));
        let without = assembled(&frictionless, &self.q[1], q, pressure, self.rule, false).0;
        with[..q.len()].iter().zip(&without).map(|(a, b)| b - a).collect()
    }

    fn increment(&self) -> Vec<f64> {
        self.q[2].iter().zip(&self.q[1]).map(|(a, b)| a - b).collect()
    }
}

fn work(m: &NodeToSurface, q: &[f64], pressure: f64, active: &[bool]) -> Work {
    m.work(&At::end(q, &[pressure, 0.0, 0.0, 0.0], active)).unwrap()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Stick and slip for certain: coefficients far beyond what the trial tractions are, and far below.
fn coefficient(stick: bool) -> f64 {
    if stick { 1.0e3 } else { 0.02 }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn contributions_are_dealt_out_among_ranks(path in path(), exact: bool, ranks in prop::sample::select(vec![1u32, 2, 3, 7])) {
        let stick = if exact { Stick::Multiplier } else { Stick::Penalty };
        let law: Arc<dyn FrictionLaw> = Arc::new(Coulomb::new(0.3).unwrap());
        let mut direct = path.run(with_law(path.meshes, law, stick));
        // Slots that found a facet, and one that did not.
        let active = [true; 4];
        let pressures = [3.0, 1.0, 2.0, 0.5];
        let step = StepConfiguration { q_n: &path.q[1], q_np1: &path.q[2], rule: path.rule };
        let found = sharing(&mut direct, &step.at(&pressures, &active), ranks).unwrap();
        prop_assert!(found.is_whole && found.counts.iter().sum::<usize>() == 4, "{found:?}");
    }

    #[test]
    fn tangents_are_the_derivatives(path in path(), law in 0..4_usize, is_spring: bool, moves: bool) {
        let law: Arc<dyn FrictionLaw> = match law {
            0 => Arc::new(StaticDynamic::new(0.03, 0.01, 2.0).unwrap()),
            1 => Arc::new(Regularised::new(0.3, 1.0).unwrap()),
            k => Arc::new(Coulomb::new(coefficient(k == 2)).unwrap()),
        };
        let normal = if is_spring { Enforcement::Penalty(30.0) } else { Enforcement::Multiplier };
        let plain = enforced_on(&divide(path.meshes), FACETS, normal);
        let m = path.run(on_belt(plain, law, Stick::Penalty, moves));
        let (residual, tangent) = assembled(&m, &path.q[1], &path.q[2], PRESSURE, path.rule, true);
        let n = residual.len();
        let mut at = path.q[2].clone();
        at.push(PRESSURE);
        let numeric = central_difference_jacobian(
            |x, out| out.copy_from_slice(&assembled(&m, &path.q[1], &x[..n - 1], x[n - 1], path.rule, false).0),
            &at, DIFFERENCE, n,
        );
        assert_jacobian_close(&tangent, &numeric, n, 1e-8, "tangent with friction");
    }

    #[test]
    fn tangents_with_multipliers_are_the_derivatives(
        path in path(),
        law in 0..3_usize,
        multiplier in proptest::array::uniform2(-0.5..0.5_f64),
        compliant: bool,
        moves: bool,
    ) {
        let law: Arc<dyn FrictionLaw> = match law {
            0 => Arc::new(StaticDynamic::new(0.03, 0.01, 2.0).unwrap()),
            k => Arc::new(Coulomb::new(coefficient(k == 2)).unwrap()),
        };
        let m = on_belt(standard_on(&divide(path.meshes), FACETS), law, Stick::Multiplier, moves);
        let m = path.run(if compliant { m.with_compliant_stick() } else { m });
        let x: Vec<f64> = path.q[2].iter().chain(&[PRESSURE]).chain(&multiplier).copied().collect();
        let (n, auxiliaries) = (x.len(), vec![0.0; 2 * m.slot_count()]);
        let (_, tangent) = assembled_with(&m, &path.q[1], path.rule, &x, &auxiliaries, true);
        let numeric = central_difference_jacobian(
            |x, out| out.copy_from_slice(&assembled_with(&m, &path.q[1], path.rule, x, &auxiliaries, false).0),
            &x, DIFFERENCE, n,
        );
        assert_jacobian_close(&tangent, &numeric, n, 1e-8, "tangent with multipliers");
    }

    /// Newton's method for the two multipliers alone, in a step that slides: the traction has the size that the law says and the direction of the slip, so
    /// that its work is proportional to the coefficient.
    #[test]
    fn a_multiplier_is_the_traction_of_the_law(path in path(), mu in 0.01..0.25_f64) {
        let solved = |mu: f64, start: [f64; 2]| {
            let mut m = path.run(with_law(path.meshes, Arc::new(Coulomb::new(mu).unwrap()), Stick::Multiplier));
            let mut x: Vec<f64> = path.q[2].iter().chain(&[PRESSURE]).chain(&start).copied().collect();
            let (n, mut auxiliaries) = (x.len(), vec![0.0; 2 * m.slot_count()]);
            for _ in 0..40 {
                let (r, k) = assembled_with(&m, &path.q[1], path.rule, &x, &auxiliaries, true);
                let of = |i: usize, j: usize| k[(n - 2 + i) * n + n - 2 + j];
                let det = of(0, 0) * of(1, 1) - of(0, 1) * of(1, 0);
                x[n - 2] -= (of(1, 1) * r[n - 2] - of(0, 1) * r[n - 1]) / det;
                x[n - 1] -= (of(0, 0) * r[n - 1] - of(1, 0) * r[n - 2]) / det;
            }
            auxiliaries[..2].copy_from_slice(&x[n - 2..]);
            m.renew(&At::end(&path.q[2], &[PRESSURE, 0.0, 0.0, 0.0], &ACTIVE).with_auxiliaries(&auxiliaries), false).unwrap();
            let work = work(&m, &path.q[2], PRESSURE, &ACTIVE);
            assert_eq!(work.stored, 0.0);
            (work.dissipated, [auxiliaries[0], auxiliaries[1]])
        };
        // From zero only a small traction is sure to slide.
        const SMALL: f64 = 0.005;
        let (_, small) = solved(SMALL, [0.0; 2]);
        let dissipated = |mu: f64| solved(mu, small.map(|traction| traction * mu / SMALL)).0;
        let (once, twice) = (dissipated(mu), dissipated(2.0 * mu));
        prop_assert!(once > 0.0 && (twice / once - 2.0).abs() < 1e-10, "{once} {twice}");
    }

    /// A sticking point of multipliers, at any gap, pressure and traction, in a step that also moves and warps the master: where its slip is zero the
    /// friction does no work and nothing is stored or dissipated, although the forces are there. The slave is moved to where that is so.
    #[test]
    fn no_work_in_stick_with_multipliers(
        path in path(),
        pressure in 0.1..10.0_f64,
        multiplier in proptest::array::uniform2(-1.0..1.0_f64),
    ) {
        prop_assume!(multiplier[0].hypot(multiplier[1]) > 0.1);
        let mut m = path.run(with_law(path.meshes, Arc::new(Coulomb::new(1e3).unwrap()), Stick::Multiplier));
        let mut x: Vec<f64> = path.q[2].iter().chain(&[pressure]).chain(&multiplier).copied().collect();
        let (n, mut auxiliaries) = (x.len(), vec![0.0; 2 * m.slot_count()]);
        let apart = |r: &[f64]| r[n - 2].hypot(r[n - 1]);
        let mut rest = f64::INFINITY;
        for _ in 0..12 {
            // The shortest way of the slave node on which the two conditions of stick vanish.
            let (r, k) = assembled_with(&m, &path.q[1], path.rule, &x, &auxiliaries, true);
            rest = apart(&r);
            let row = |i: usize| Vector3::from_fn(|j, _| k[(n - 2 + i) * n + 3 * SLAVE + j]);
            let (a, b) = (row(0), row(1));
            let (aa, ab, bb) = (a.dot(&a), a.dot(&b), b.dot(&b));
            let det = aa * bb - ab * ab;
            let way = a * ((bb * r[n - 2] - ab * r[n - 1]) / det) + b * ((aa * r[n - 1] - ab * r[n - 2]) / det);
            // Points far from where they were paired have no such place, and at last no projection.
            prop_assume!(way.norm() < 0.4);
            (0..3).for_each(|i| x[3 * SLAVE + i] -= way[i]);
        }
        prop_assume!(rest < 1e-14);
        let q = &x[..n - 3];
        auxiliaries[..2].copy_from_slice(&multiplier);
        let pressures = [pressure, 0.0, 0.0, 0.0];
        m.renew(&At::end(q, &pressures, &ACTIVE).with_auxiliaries(&auxiliaries), false).unwrap();
        let w = m.work(&At::end(q, &pressures, &ACTIVE)).unwrap();
        prop_assert!(w.dissipated == 0.0 && w.stored == 0.0 && w.friction_work.abs() < 1e-13, "{w:?}");
        let forces = path.friction_with(&m, q, pressure, &auxiliaries);
        let size = forces.iter().fold(0.0_f64, |a, f| a.max(f.abs()));
        prop_assert!(size > 1e-3, "there is friction: {size:e}");
        if path.rule == GradientRule::DiscreteGradient {
            // Not only the slip's: the work on the motion of all nodes.
            let motion: Vec<f64> = q.iter().zip(&path.q[1]).map(|(a, b)| a - b).collect();
            prop_assert!(dot(&forces, &motion).abs() < 1e-12, "{:e}", dot(&forces, &motion));
        }
    }

    #[test]
    fn multipliers_have_no_resultant_and_turn_with_the_step(
        path in path(),
        stick: bool,
        multiplier in proptest::array::uniform2(-1.0..1.0_f64),
        turn in proptest::array::uniform3(-1.0..1.0_f64),
        shift in proptest::array::uniform3(-2.0..2.0_f64),
    ) {
        let make = || with_law(path.meshes, Arc::new(Coulomb::new(coefficient(stick)).unwrap()), Stick::Multiplier);
        let rotation = Rotation3::new(Vector3::from(turn));
        let rotate = |v: &[f64], shift: Vector3<f64>| -> Vec<f64> {
            v.chunks_exact(3).flat_map(|x| <[f64; 3]>::from(rotation * Vector3::from_column_slice(x) + shift)).collect()
        };
        let mut other = path.clone();
        for (rotated, q) in other.q.iter_mut().zip(&path.q) {
            *rotated = rotate(q, Vector3::from(shift));
        }
        let forces = |path: &Path| {
            let m = path.run(make());
            let mut auxiliaries = vec![0.0; 2 * m.slot_count()];
            auxiliaries[..2].copy_from_slice(&multiplier);
            path.friction_with(&m, &path.q[2], PRESSURE, &auxiliaries)
        };
        let (expected, found) = (rotate(&forces(&path), Vector3::zeros()), forces(&other));
        let size = expected.iter().fold(0.0_f64, |a, f| a.max(f.abs()));
        prop_assert!(size > 1e-6, "there is friction: {size:e}");
        let (force, moment) = resultants(&forces(&path), &path.q[1], &path.q[2], path.rule);
        prop_assert!(force < 1e-13 * (1.0 + size) && moment < 1e-12 * (1.0 + size), "{force:e} {moment:e}");
        for (a, b) in expected.iter().zip(&found) {
            prop_assert!((a - b).abs() < 1e-11 * (1.0 + size));
        }
    }

    #[test]
    fn friction_has_no_resultant_and_no_moment(path in path(), stick: bool) {
        let m = path.run(with_coulomb(path.meshes, coefficient(stick)));
        let forces = path.friction(&m);
        let size = forces.iter().fold(0.0_f64, |a, f| a.max(f.abs()));
        prop_assume!(size > 1e-4);
        let (force, moment) = resultants(&forces, &path.q[1], &path.q[2], path.rule);
        prop_assert!(force < 1e-13 * (1.0 + size) && moment < 1e-12 * (1.0 + size), "{force:e} {moment:e}");
    }

    #[test]
    fn a_rotated_step_has_rotated_forces(
        path in path(),
        stick: bool,
        turn in proptest::array::uniform3(-1.0..1.0_f64),
        shift in proptest::array::uniform3(-2.0..2.0_f64),
    ) {
        let rotation = Rotation3::new(Vector3::from(turn));
        let rotate = |v: &[f64], shift: Vector3<f64>| -> Vec<f64> {
            v.chunks_exact(3).flat_map(|x| <[f64; 3]>::from(rotation * Vector3::from_column_slice(x) + shift)).collect()
        };
        let mut other = path.clone();
        for (rotated, q) in other.q.iter_mut().zip(&path.q) {
            *rotated = rotate(q, Vector3::from(shift));
        }
        let mu = coefficient(stick);
        let (a, b) = (path.run(with_coulomb(path.meshes, mu)), other.run(with_coulomb(path.meshes, mu)));
        let expected = rotate(&path.friction(&a), Vector3::zeros());
        let found = other.friction(&b);
        let size = expected.iter().fold(1.0_f64, |a, f| a.max(f.abs()));
        for (a, b) in expected.iter().zip(&found) {
            prop_assert!((a - b).abs() < 1e-11 * size);
        }
        let (a, b) = (work(&a, &path.q[2], PRESSURE, &ACTIVE), work(&b, &other.q[2], PRESSURE, &ACTIVE));
        prop_assert!((a.stored - b.stored).abs() + (a.dissipated - b.dissipated).abs() < 1e-11 * (1.0 + a.stored));
    }

    #[test]
    fn a_rigid_step_only_turns_the_traction(
        path in path(),
        turn in proptest::array::uniform3(-0.6..0.6_f64),
        shift in proptest::array::uniform3(-2.0..2.0_f64),
    ) {
        // The whole turns by a finite angle in the second step: no slip, nothing dissipated, the traction keeps its size.
        let rotation = Rotation3::new(Vector3::from(turn));
        let mut rigid = path;
        rigid.q[2] = rigid.q[1]
            .chunks_exact(3)
            .flat_map(|x| <[f64; 3]>::from(rotation * Vector3::from_column_slice(x) + Vector3::from(shift)))
            .collect();
        let m = rigid.run(with_coulomb(rigid.meshes, 1e3));
        let before = {
            let mut at_rest = rigid.clone();
            at_rest.q[2] = at_rest.q[1].clone();
            let m = at_rest.run(with_coulomb(rigid.meshes, 1e3));
            work(&m, &at_rest.q[2], PRESSURE, &ACTIVE)
        };
        let after = work(&m, &rigid.q[2], PRESSURE, &ACTIVE);
        prop_assert!(before.dissipated.abs() < 1e-12 * (1.0 + before.stored));
        // A first step that by chance hardly slid leaves nothing to turn.
        prop_assume!(before.stored > 1e-6);
        prop_assert!((after.stored - before.stored).abs() < 1e-11 * before.stored.max(1.0));
        prop_assert!(after.dissipated.abs() < 1e-11 * before.stored.max(1.0), "{}", after.dissipated);
        // And the energy-momentum force does no work on the motion.
        if rigid.rule == GradientRule::DiscreteGradient {
            let forces = rigid.friction(&m);
            prop_assert!(dot(&forces, &rigid.increment()).abs() < 1e-11 * (1.0 + before.stored));
        }
    }

    #[test]
    fn dissipation_is_not_negative_and_the_energy_momentum_balance_is_exact(path in path(), mu in 0.0..2.0_f64, moves: bool) {
        let law = Arc::new(Coulomb::new(mu).unwrap());
        let plain = standard_on(&divide(path.meshes), FACETS);
        let start = path.run(on_belt(plain, law, Stick::Penalty, moves));
        let w = work(&start, &path.q[2], PRESSURE, &ACTIVE);
        // What the released spring held is lost.
        let open = work(&start, &path.q[2], PRESSURE, &OPEN);
        let scale = open.dissipated + w.stored + w.friction_work.abs();
        prop_assert!(w.dissipated >= -1e-15 * scale && w.stored >= 0.0 && w.friction_stored == w.stored, "{w:?}");
        let rest = w.friction_work + open.dissipated - w.stored - w.dissipated;
        prop_assert!(rest.abs() < 1e-13 * (1.0 + scale), "{w:?}, rest {rest:e}");
        prop_assert_eq!(open.stored, 0.0);
        prop_assert!(open.dissipated >= 0.0);
        if path.rule == GradientRule::DiscreteGradient {
            let before = open.dissipated;
            let done = dot(&path.friction(&start), &path.increment());
            let balance = done + w.stored - before + w.dissipated - w.driven;
            prop_assert!(balance.abs() < 1e-12 * (1.0 + done.abs() + w.stored), "balance {balance:e}");
        }
    }
}

/// A flat surface with edges of length one: slip and traction are plain vectors.
fn flat(at: [f64; 2]) -> Vec<f64> {
    positions(&[0.0; FACETS as usize + 1], [at[0], at[1], 0.0])
}

#[test]
fn on_a_flat_surface_edges_do_not_matter() {
    for rule in RULES {
        let mut m = with_coulomb(QUADS, 0.5);
        let q_0 = positions(&[0.0; FACETS as usize + 1], [0.4, 0.3, 0.1]);
        m.begin(&StepContext { reach: 10.0, ..StepContext::new(&q_0, rule, STEP) }).unwrap();
        let area = m.slot_weight(0);
        let mut from = q_0;
        // Closed form: return mapping of plain vectors (theory/friction#eq-return), over no edge, one edge, several.
        let mut tau = [0.0; 2];
        let mut here = [0.4, 0.3];
        for to in [[0.41, 0.31], [0.43, 0.32], [1.2, 0.5], [1.19, 0.45], [4.5, 0.4], [4.6, 0.45]] {
            let q = flat(to);
            m.repair(&q, &ACTIVE).unwrap();
            let trial = [tau[0] + PENALTY * (to[0] - here[0]), tau[1] + PENALTY * (to[1] - here[1])];
            let norm = f64::hypot(trial[0], trial[1]);
            let cut = (0.5 * PRESSURE / norm).min(1.0);
            let before = (tau[0] * tau[0] + tau[1] * tau[1]) / (2.0 * PENALTY);
            let slip_work = |t: [f64; 2]| t[0] * (to[0] - here[0]) + t[1] * (to[1] - here[1]);
            tau = trial.map(|t| cut * t);
            let (residual, _) = assembled(&m, &from, &q, PRESSURE, rule, false);
            for i in 0..2 {
                assert!((residual[3 * SLAVE + i] - area * tau[i]).abs() < 1e-12, "{rule:?} {to:?}");
            }
            let w = work(&m, &q, PRESSURE, &ACTIVE);
            let stored = (tau[0] * tau[0] + tau[1] * tau[1]) / (2.0 * PENALTY);
            assert!((w.stored - area * stored).abs() < 1e-12);
            assert!((w.dissipated - area * (slip_work(tau) + before - stored)).abs() < 1e-12);
            m.commit(&At::end(&q, &[PRESSURE, 0.0, 0.0, 0.0], &ACTIVE));
            m.begin(&StepContext { reach: 10.0, ..StepContext::new(&q, rule, STEP) }).unwrap();
            (from, here) = (q, to);
        }
    }
}

/// A sticking node that is carried over a ridge and a valley keeps the size of its traction up to what the small step adds.
#[test]
fn traction_turns_with_the_surface_over_edges() {
    for heights in [[0.0, 0.0, -0.5, -1.0, -1.5, -2.0, -2.5], [0.0, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5]] {
        for rule in RULES {
            let mut m = with_coulomb(QUADS, 1e3);
            let on = |x: f64| {
                let z = if x < 1.0 { 0.0 } else { (x - 1.0) * heights[2] };
                positions(&heights, [x, 0.3, z])
            };
            m.begin(&StepContext {
                reach: 1.0,
                ..StepContext::new(&positions(&heights, [0.94, 0.3, 0.1]), rule, STEP)
            })
            .unwrap();
            m.repair(&on(0.98), &ACTIVE).unwrap();
            m.commit(&At::end(&on(0.98), &[PRESSURE, 0.0, 0.0, 0.0], &ACTIVE));
            m.begin(&StepContext { reach: 1.0, ..StepContext::new(&on(0.98), rule, STEP) }).unwrap();
            let area = m.slot_weight(0);
            let traction = |w: Work| (2.0 * PENALTY * w.stored / area).sqrt();
            let before = traction(work(&m, &on(0.98), PRESSURE, &ACTIVE));
            assert!((before - PENALTY * 0.04).abs() < 0.05, "{before}");
            let q = on(1.01);
            assert_eq!(m.repair(&q, &ACTIVE).unwrap(), 1, "over the edge");
            let length = 0.02 + 0.01 * 1.25_f64.sqrt();
            let after = traction(work(&m, &q, PRESSURE, &ACTIVE));
            assert!((after - before - PENALTY * length).abs() < 0.1 * PENALTY * length, "{rule:?} {before} {after}");
            // Beyond the edge the next step begins with the traction that this one ended with.
            m.commit(&At::end(&q, &[PRESSURE, 0.0, 0.0, 0.0], &ACTIVE));
            m.begin(&StepContext { reach: 1.0, ..StepContext::new(&q, rule, STEP) }).unwrap();
            assert!((traction(work(&m, &q, PRESSURE, &ACTIVE)) - after).abs() < 1e-12 * after);
        }
    }
}

#[test]
fn a_node_that_comes_back_begins_anew() {
    let mut m = with_coulomb(QUADS, 0.5);
    let above = positions(&[0.0; FACETS as usize + 1], [0.4, 0.3, 0.1]);
    let pressures = [PRESSURE, 0.0, 0.0, 0.0];
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&above, GradientRule::EndPoint, STEP) }).unwrap();
    m.repair(&flat([0.42, 0.3]), &ACTIVE).unwrap();
    m.commit(&At::end(&flat([0.42, 0.3]), &pressures, &ACTIVE));
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&flat([0.42, 0.3]), GradientRule::EndPoint, STEP) }).unwrap();
    assert!(work(&m, &flat([0.42, 0.3]), PRESSURE, &ACTIVE).stored > 0.0);
    // Open in the next step: what was stored is lost; closed again in the one after: only the new slip counts.
    m.repair(&above, &OPEN).unwrap();
    assert!(work(&m, &above, 0.0, &OPEN).dissipated > 0.0);
    m.commit(&At::end(&above, &[0.0; 4], &OPEN));
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&above, GradientRule::EndPoint, STEP) }).unwrap();
    assert_eq!(work(&m, &above, 0.0, &OPEN), Work { closing: None, ..Work::default() });
    let q = flat([0.41, 0.3]);
    m.repair(&q, &ACTIVE).unwrap();
    let (residual, _) = assembled(&m, &above, &q, PRESSURE, GradientRule::EndPoint, false);
    assert!((residual[3 * SLAVE] - m.slot_weight(0) * PENALTY * 0.01).abs() < 1e-13);
}

/// An attempt that fails leaves the report of the last step as it was; the next step that is accepted has its own.
#[test]
fn the_report_is_that_of_the_last_accepted_step() {
    let mut m = with_coulomb(QUADS, 0.5);
    let above = positions(&[0.0; FACETS as usize + 1], [0.4, 0.3, 0.1]);
    let on = flat([0.42, 0.3]);
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&above, GradientRule::EndPoint, STEP) }).unwrap();
    m.repair(&on, &ACTIVE).unwrap();
    m.commit(&At::end(&on, &[PRESSURE, 0.0, 0.0, 0.0], &ACTIVE));
    let accepted = m.report(&on).unwrap()[0].friction;
    assert!(accepted.is_some());
    // Attempts with a facet before and without one.
    for reach in [1.0, 0.5] {
        m.begin(&StepContext { reach, ..StepContext::new(&on, GradientRule::EndPoint, STEP) }).unwrap();
        m.repair(&flat([0.9, 0.3]), &ACTIVE).unwrap();
        assert_eq!(m.report(&on).unwrap()[0].friction, accepted);
    }
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&on, GradientRule::EndPoint, STEP) }).unwrap();
    m.repair(&above, &OPEN).unwrap();
    m.commit(&At::end(&above, &[0.0; 4], &OPEN));
    assert_eq!(m.report(&above).unwrap()[0].friction, None);
}

#[test]
fn history_goes_through_bytes() {
    let mut m = with_coulomb(QUADS, 0.5);
    m.begin(&StepContext {
        reach: 1.0,
        ..StepContext::new(&positions(&[0.0; FACETS as usize + 1], [0.4, 0.3, 0.1]), GradientRule::Midpoint, STEP)
    })
    .unwrap();
    let on = flat([0.5, 0.33]);
    m.repair(&on, &ACTIVE).unwrap();
    m.commit(&At::end(&on, &[PRESSURE, 0.0, 0.0, 0.0], &ACTIVE));
    let bytes = m.save_history();
    let mut other = with_coulomb(QUADS, 0.5);
    other.load_history(&bytes).unwrap();
    assert_eq!(other.save_history(), bytes);
    let next = flat([0.52, 0.33]);
    let both = [&mut m, &mut other].map(|m| {
        m.begin(&StepContext { reach: 1.0, ..StepContext::new(&on, GradientRule::Midpoint, STEP) }).unwrap();
        assembled(m, &on, &next, PRESSURE, GradientRule::Midpoint, true)
    });
    assert_eq!(both[0], both[1]);
    assert!(both[0].0[3 * SLAVE] > 0.1, "there is friction");
    // Without friction the history is shorter.
    assert!(standard(FACETS).load_history(&bytes).is_err());
    assert!(other.load_history(&standard(FACETS).save_history()).is_err());
}

#[test]
fn what_has_no_friction_says_so() {
    let friction = || Friction::new(Arc::new(Coulomb::new(0.1).unwrap()), 1.0, Stick::Penalty).unwrap();
    let modified = method(FACETS, ConstraintForm::Modified, stoss_contact::SearchOptions::default());
    assert!(matches!(modified.with_friction(friction()), Err(ContactError::FrictionUnavailable { .. })));
    let mut m = standard(FACETS).with_friction(friction()).unwrap();
    let q = flat([0.4, 0.3]);
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&q, GradientRule::EndPoint, 0.0) }).unwrap();
    m.repair(&q, &ACTIVE).unwrap();
    let step = StepConfiguration { q_n: &q, q_np1: &q, rule: GradientRule::EndPointMean };
    let error = m.assemble(&step.at(&[1.0, 0.0, 0.0, 0.0], &ACTIVE), false, &mut |_| ()).unwrap_err();
    assert_eq!(error.to_string(), "contact with friction is not available with the rule EndPointMean");
}

#[test]
fn the_paths_reach_every_kind_of_pairing() {
    use proptest::{strategy::ValueTree, test_runner::TestRunner};
    let mut runner = TestRunner::deterministic();
    let mut nodes = Vec::new();
    for _ in 0..200 {
        let m = path().new_tree(&mut runner).unwrap().current().run(with_coulomb(QUADS, 1.0));
        m.stencils(&ACTIVE, &mut |stencil, _| nodes.push(stencil.len()));
    }
    for kind in [5, 7, 9] {
        let count = nodes.iter().filter(|&&n| n == kind).count();
        assert!(count > 20, "{count} elements with {kind} nodes");
    }
}

/// On one warped facet the slip between material points is `m_ab dxi^b` (theory/friction#nts) up to the square of the slip.
#[test]
fn the_slip_is_that_of_the_coordinates_to_second_order() {
    let mut q = positions(&[0.0; FACETS as usize + 1], [0.4, 0.3, 0.0]);
    for (k, x) in q[..3 * SLAVE].iter_mut().enumerate() {
        *x += 0.1 * (1.7 * k as f64).sin();
    }
    let facet = [0, 2, 3, 1];
    let local = |q: &[f64]| -> Local {
        let mut out = [0.0; LOCAL];
        for (block, node) in out.chunks_exact_mut(3).zip(std::iter::once(SLAVE).chain(facet)) {
            block.copy_from_slice(&q[3 * node..3 * node + 3]);
        }
        out
    };
    let difference = |size: f64| {
        let mut end = q.clone();
        for (i, d) in [0.8, 0.5, -0.2].iter().enumerate() {
            end[3 * SLAVE + i] += size * d;
        }
        let mut m = with_coulomb(QUADS, 1e3);
        m.begin(&StepContext { reach: 1.0, ..StepContext::new(&q, GradientRule::EndPoint, STEP) }).unwrap();
        m.repair(&end, &ACTIVE).unwrap();
        let (residual, _) = assembled(&m, &q, &end, 0.0, GradientRule::EndPoint, false);
        assert!(residual[3 * SLAVE..3 * SLAVE + 3].iter().all(|r| *r == 0.0), "no pressure, no friction");
        let with = assembled(&m, &q, &end, PRESSURE, GradientRule::EndPoint, false).0;
        let ((x_n, patch_n), (x, patch)) =
            (points(&local(&q), FacetKind::Quad4), points(&local(&end), FacetKind::Quad4));
        let at_n = Gap::project(&x_n, &patch_n, [0.0; 2]).unwrap();
        let gap = Gap::project(&x, &patch, [0.0; 2]).unwrap();
        let tangents = patch.tangents(gap.xi);
        let tau: [f64; 2] = std::array::from_fn(|al| {
            (0..2).map(|be| PENALTY * tangents[al].dot(&tangents[be]) * (gap.xi[be] - at_n.xi[be])).sum()
        });
        (0..3)
            .map(|i| {
                let friction = tau[0] * gap.xi_gradient[0][i] + tau[1] * gap.xi_gradient[1][i];
                let expected = m.slot_weight(0) * (friction - PRESSURE * gap.gradient[i]);
                (with[3 * SLAVE + i] - expected).abs()
            })
            .fold(0.0, f64::max)
    };
    let (large, small) = (difference(2e-2), difference(1e-2));
    assert!(small > 1e-8 && small < 1e-2 * PENALTY * 1e-2, "{small:e}");
    assert!((large / small - 4.0).abs() < 0.3, "of second order: {}", large / small);
}
