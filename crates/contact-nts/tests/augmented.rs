//! Coordinate augmentation: tangents, reductions, momenta, and the direct form that it equals at the end point.

use crate::common::{path as path_of, *};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use std::sync::Arc;
use stoss_contact::ContactError;
use stoss_contact::friction::{Coulomb, Friction, Stick};
use stoss_contact_nts::{CoordinateAugmented, NodeToSurface, Reduction};
use stoss_term::check::sharing;
use stoss_term::{At, Auxiliary, GradientRule, StepConfiguration, StepContext, Term, Unilateral};
use stoss_testkit::meshes::{Mesh, divide, meshes};
use stoss_testkit::oracle::{assert_jacobian_close, central_difference_jacobian};

const RULES: [GradientRule; 2] = [GradientRule::EndPoint, GradientRule::Midpoint];
const FACETS: u32 = 6;
const NODES: usize = 2 * (FACETS as usize + 1) + 4;
const PRESSURE: f64 = 3.0;
const STEP: f64 = 0.1;

/// A step of warped, moving facets with a gap; the node is in contact before and after it.
#[derive(Clone, Debug)]
struct Path {
    meshes: [Mesh; 2],
    q: [Vec<f64>; 3],
    rule: GradientRule,
    /// Coefficient of friction: none, slip for certain, stick for certain.
    mu: Option<f64>,
    /// Stick by multipliers, not by springs.
    exact: bool,
    /// Off the foot by so much, and multipliers beside those of the reductions.
    off: [f64; 6],
}

fn path() -> impl Strategy<Value = Path> {
    let noise = |size: f64| proptest::collection::vec(-size..size, 3 * NODES);
    (
        (noise(0.06), noise(0.05), noise(0.05)),
        (0.4..0.6_f64, 0.2..0.4_f64, 0.1..0.2_f64),
        (-0.15..0.15_f64, -0.15..0.15_f64),
        (prop_oneof![0.05..0.15_f64, 0.9..1.1_f64, 3.9..4.1_f64], 0.05..0.15_f64, -0.25..-0.15_f64),
        (prop::sample::select(&RULES[..]), prop::sample::select(vec![None, Some(0.02), Some(1e3)])),
        (meshes(), any::<bool>(), proptest::array::uniform6(-0.2..0.2_f64)),
    )
        .prop_map(|(noise, (x, y, z), (dx, dy), (slide, side, depth), (rule, mu), (meshes, exact, off))| {
            let q = path_of(FACETS, [&noise.0, &noise.1, &noise.2], [x, y, z], [dx, dy], [slide, side, depth]);
            Path { meshes, q, rule, mu, exact, off }
        })
}

impl Path {
    fn direct(&self) -> NodeToSurface {
        let direct = standard_on(&divide(self.meshes), FACETS);
        match self.mu {
            Some(mu) => {
                let law = Arc::new(Coulomb::new(mu).unwrap());
                let stick = if self.exact { Stick::Multiplier } else { Stick::Penalty };
                direct.with_friction(Friction::new(law, 40.0, stick).unwrap()).unwrap()
            }
            None => direct,
        }
    }

    /// Does the first step and pairs the second one.
    fn run<M: Term + Unilateral>(&self, m: M) -> M {
        second_step(m, &self.q, self.rule, STEP, 7.0)
    }

    fn augmented(&self, reduction: Reduction) -> CoordinateAugmented {
        self.run(CoordinateAugmented::new(self.direct(), reduction))
    }

    /// All auxiliaries, those of the first slot off the foot.
    fn start(&self, m: &CoordinateAugmented) -> Vec<f64> {
        let mut values = vec![0.0; m.slot_count() * m.auxiliaries().len()];
        let step = StepConfiguration { q_n: &self.q[1], q_np1: &self.q[2], rule: self.rule };
        m.start_auxiliaries(&step.at(&[PRESSURE, 0.0, 0.0, 0.0], &ACTIVE), &mut values).unwrap();
        for (value, off) in values.iter_mut().zip(self.off).take(m.auxiliaries().len()) {
            *value += off;
        }
        values
    }
}

/// Residual and tangent over positions, the pressure and the auxiliaries of the first slot.
fn dense(m: &CoordinateAugmented, path: &Path, x: &[f64], auxiliaries: &[f64], want: bool) -> (Vec<f64>, Vec<f64>) {
    assembled_with(m, &path.q[1], path.rule, x, auxiliaries, want)
}

fn unknowns(path: &Path, m: &CoordinateAugmented, auxiliaries: &[f64]) -> Vec<f64> {
    let mut x = path.q[2].clone();
    x.push(PRESSURE);
    x.extend(&auxiliaries[..Auxiliary::equations(m.auxiliaries())]);
    x
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn contributions_are_dealt_out_among_ranks(path in path(), of in 0usize..3, ranks in prop::sample::select(vec![1u32, 2, 3, 7])) {
        let mut m = path.augmented([Reduction::None, Reduction::First, Reduction::Second][of]);
        let step = StepConfiguration { q_n: &path.q[1], q_np1: &path.q[2], rule: path.rule };
        let values: Vec<f64> = path.start(&m);
        let at = step.at(&[PRESSURE, 1.0, 2.0, 0.5], &[true; 4]).with_auxiliaries(&values);
        let found = sharing(&mut m, &at, ranks).unwrap();
        prop_assert!(found.is_whole && found.counts.iter().sum::<usize>() == 4, "{found:?}");
    }

    #[test]
    fn tangents_are_the_derivatives_off_the_foot(path in path(), full: bool) {
        let m = path.augmented(if full { Reduction::None } else { Reduction::First });
        let auxiliaries = path.start(&m);
        let x = unknowns(&path, &m, &auxiliaries);
        let n = x.len();
        let (_, tangent) = dense(&m, &path, &x, &auxiliaries, true);
        let numeric = central_difference_jacobian(
            |x, out| out.copy_from_slice(&dense(&m, &path, x, &auxiliaries, false).0), &x, DIFFERENCE, n,
        );
        assert_jacobian_close(&tangent, &numeric, n, 1e-8, "augmented tangent");
    }

    #[test]
    fn condensed_tangents_are_derivatives_along_the_foot(path in path()) {
        // On the foot the condensed system is the system in which the coordinates are the projection.
        let m = path.augmented(Reduction::Second);
        let at = unknowns(&path, &m, &path.off);
        let n = at.len();
        let step = |x: &[f64], want: bool| {
            let q = [path.q[0].clone(), path.q[1].clone(), x[..3 * NODES].to_vec()];
            let on_foot = Path { off: [0.0; 6], q, ..path.clone() };
            dense(&m, &on_foot, x, &on_foot.start(&m), want)
        };
        let (_, tangent) = step(&at, true);
        let numeric = central_difference_jacobian(|x, out| out.copy_from_slice(&step(x, false).0), &at, DIFFERENCE, n);
        assert_jacobian_close(&tangent, &numeric, n, 1e-8, "condensed tangent");
    }

    #[test]
    fn reductions_are_schur_complements(path in path()) {
        let path = Path { exact: false, ..path };
        let (full, first, second) =
            (path.augmented(Reduction::None), path.augmented(Reduction::First), path.augmented(Reduction::Second));
        // Off the foot, but with the multipliers that belong to it: found by solving the linear balance of the full system.
        let mut at = path.start(&full);
        let n = 3 * NODES + 1;
        for _ in 0..2 {
            let (r, k) = dense(&full, &path, &unknowns(&path, &full, &at), &at, true);
            let k = DMatrix::from_row_slice(n + 4, n + 4, &k);
            let step = k.view((n, n + 2), (2, 2)).into_owned().lu().solve(&DVector::from_row_slice(&r[n..n + 2])).unwrap();
            at[2] -= step[0];
            at[3] -= step[1];
        }
        let (r, k) = dense(&full, &path, &unknowns(&path, &full, &at), &at, true);
        let k = DMatrix::from_row_slice(n + 4, n + 4, &k);
        let r = DVector::from_vec(r);
        let (r_1, k_1) = dense(&first, &path, &unknowns(&path, &first, &at[..2]), &[&at[..2], &[0.0; 6]].concat(), true);
        let (r_2, k_2) = dense(&second, &path, &unknowns(&path, &second, &[]), &[&at[..2], &[0.0; 6]].concat(), true);
        // First: rows without the balance of the coordinates, columns without the multipliers.
        let rows: Vec<usize> = (0..n).chain([n + 2, n + 3]).collect();
        let columns: Vec<usize> = (0..n + 2).collect();
        let pick = |rows: &[usize], columns: &[usize]| k.select_rows(rows).select_columns(columns);
        let inverse = pick(&[n, n + 1], &[n + 2, n + 3]).try_inverse().unwrap();
        let factor = pick(&rows, &[n + 2, n + 3]) * inverse;
        let k_first = pick(&rows, &columns) - &factor * pick(&[n, n + 1], &columns);
        let r_first = r.select_rows(&rows) - factor * r.rows(n, 2);
        let scale = k_first.amax();
        prop_assert!((&k_first - DMatrix::from_row_slice(n + 2, n + 2, &k_1)).amax() < 1e-11 * scale);
        prop_assert!((&r_first - DVector::from_vec(r_1)).amax() < 1e-11 * scale);
        // Second: the foot constraint and the coordinates are eliminated from that.
        let inverse = k_first.view((n, n), (2, 2)).into_owned().try_inverse().unwrap();
        let factor = k_first.view((0, n), (n, 2)) * &inverse;
        let k_second = k_first.view((0, 0), (n, n)) - &factor * k_first.view((n, 0), (2, n));
        let r_second = r_first.rows(0, n) - &factor * r_first.rows(n, 2);
        prop_assert!((&k_second - DMatrix::from_row_slice(n, n, &k_2)).amax() < 1e-11 * scale);
        prop_assert!((&r_second - DVector::from_vec(r_2)).amax() < 1e-11 * scale);
        // What the coordinates do follows from the same two rows.
        let increment: Vec<f64> = (0..n - 1).map(|k| (k as f64).sin()).collect();
        let expected = -&inverse * (r_first.rows(n, 2) + k_first.view((n, 0), (2, n - 1)) * DVector::from_row_slice(&increment));
        let mut found = vec![0.0; 8];
        let step = StepConfiguration { q_n: &path.q[1], q_np1: &path.q[2], rule: path.rule };
        second.recover(&step.at(&[], &ACTIVE).with_auxiliaries(&[&at[..2], &[0.0; 6]].concat()), &increment, &mut found).unwrap();
        prop_assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-11 * (1.0 + expected.amax())));
    }

    #[test]
    fn forces_have_no_resultant_and_no_moment(path in path(), full: bool) {
        let m = path.augmented(if full { Reduction::None } else { Reduction::First });
        let auxiliaries = path.start(&m);
        let (residual, _) = dense(&m, &path, &unknowns(&path, &m, &auxiliaries), &auxiliaries, false);
        let (force, moment) = resultants(&residual[..3 * NODES], &path.q[1], &path.q[2], path.rule);
        let size = residual.iter().fold(0.0_f64, |a, f| a.max(f.abs()));
        prop_assert!(size > 1e-3);
        prop_assert!(force < 1e-13 * (1.0 + size) && moment < 1e-12 * (1.0 + size), "{force:e} {moment:e}");
    }

    #[test]
    fn at_the_end_point_it_is_the_direct_form(path in path()) {
        let path = Path { rule: GradientRule::EndPoint, ..path };
        let m = path.augmented(Reduction::Second);
        let x = unknowns(&path, &m, &path.off);
        let multipliers = [path.off, [0.0; 6]].concat();
        let expected = assembled_with(&path.run(path.direct()), &path.q[1], path.rule, &x, &multipliers, true);
        let path = Path { off: [0.0; 6], ..path };
        let found = dense(&m, &path, &x, &path.start(&m), true);
        for (a, b) in [(expected.0, found.0), (expected.1, found.1)] {
            let size = a.iter().fold(1.0_f64, |s, a| s.max(a.abs()));
            for (a, b) in a.iter().zip(&b) {
                prop_assert!((a - b).abs() < 1e-10 * size, "{a} {b}");
            }
        }
    }
}

#[test]
fn other_rules_are_refused() {
    let mut m = CoordinateAugmented::new(standard(FACETS), Reduction::default());
    let q = positions(&[0.0; FACETS as usize + 1], [0.4, 0.3, -0.1]);
    m.begin(&StepContext { reach: 1.0, ..StepContext::new(&q, GradientRule::EndPoint, 0.0) }).unwrap();
    m.repair(&q, &ACTIVE).unwrap();
    let step = StepConfiguration { q_n: &q, q_np1: &q, rule: GradientRule::StartPoint };
    let error = m.assemble(&step.at(&[1.0, 0.0, 0.0, 0.0], &ACTIVE), false, &mut |_| {}).unwrap_err();
    assert!(matches!(error.cause(), Some(ContactError::RuleUnavailable { .. })), "{error}");
}

/// An active slot without a facet leaves its pressure and its auxiliaries at zero.
#[test]
fn a_slot_without_a_facet_has_identity_rows() {
    for (reduction, further) in [(Reduction::None, 4), (Reduction::First, 2), (Reduction::Second, 0)] {
        let mut m = CoordinateAugmented::new(standard(FACETS), reduction);
        let q = positions(&[0.0; FACETS as usize + 1], [0.4, 0.3, 50.0]);
        m.begin(&StepContext { reach: 1.0, ..StepContext::new(&q, GradientRule::EndPoint, 0.0) }).unwrap();
        let step = StepConfiguration { q_n: &q, q_np1: &q, rule: GradientRule::Midpoint };
        let mut visits = 0;
        m.assemble(&step.at(&[2.0, 0.0, 0.0, 0.0], &ACTIVE), true, &mut |local| {
            visits += 1;
            assert_eq!((local.dim(), local.residual.len()), (4 + further, 4 + further));
            let k = DMatrix::from_row_slice(local.dim(), local.dim(), &local.tangent);
            let part = k.view((3, 3), (1 + further, 1 + further)).into_owned();
            assert!(part.lu().is_invertible() && local.residual[3] != 0.0);
        })
        .unwrap();
        assert_eq!(visits, 1);
    }
}

/// Over a ridge whose flanks turn in the step: the force of a sticking spring and the energy that it is booked with belong to one traction.
#[test]
fn over_an_edge_the_traction_booked_is_that_of_the_equations() {
    const STIFFNESS: f64 = 40.0;
    let surface = |h: &[f64], x: f64| h[x as usize] + (h[x as usize + 1] - h[x as usize]) * x.fract();
    for (slope, turn, from, to) in
        [(0.3, 0.0, 2.6, 3.4), (0.3, 0.1, 2.9, 3.2), (0.3, -0.3, 2.6, 3.4), (1.0, 0.1, 2.9, 3.2), (0.3, 0.1, 2.2, 2.6)]
    {
        let ridge: Vec<f64> = (0..=FACETS).map(|i| -slope * (f64::from(i) - 3.0).abs()).collect();
        let turned: Vec<f64> = (0..=FACETS).map(|i| ridge[i as usize] + turn * (f64::from(i) - 3.0)).collect();
        let path = [
            positions(&ridge, [from - 0.1, 0.3, surface(&ridge, from - 0.1) + 0.1]),
            positions(&ridge, [from, 0.3, surface(&ridge, from)]),
            positions(&turned, [to, 0.3, surface(&turned, to)]),
        ];
        let law = Arc::new(Coulomb::new(1e6).unwrap());
        let spring = Friction::new(law, STIFFNESS, Stick::Penalty).unwrap();
        let rough = standard(FACETS).with_friction(spring).unwrap();
        let rule = GradientRule::Midpoint;
        let [with, without] = [rough, standard(FACETS)]
            .map(|m| second_step(CoordinateAugmented::new(m, Reduction::Second), &path, rule, STEP, 0.0));
        let pressures = [PRESSURE, 0.0, 0.0, 0.0];
        let force = |m: &CoordinateAugmented| {
            let mut out = [0.0; 3];
            let step = StepConfiguration { q_n: &path[1], q_np1: &path[2], rule };
            m.assemble(&step.at(&pressures, &ACTIVE), false, &mut |l| {
                (0..3).for_each(|i| out[i] += l.residual[i]);
            })
            .unwrap();
            out
        };
        let (with_friction, normal) = (force(&with), force(&without));
        let squared: f64 = (0..3).map(|i| (with_friction[i] - normal[i]).powi(2)).sum();
        let weight = with.report(&path[2]).unwrap()[0].weight;
        let booked = with.work(&At::end(&path[2], &pressures, &ACTIVE)).unwrap().stored;
        let expected = squared / (2.0 * STIFFNESS * weight);
        assert!((booked / expected - 1.0).abs() < 1e-10, "slope {slope}, turn {turn}: {booked:e}, {expected:e}");
    }
}
