//! Energy, force and tangent against each other by differences, for all laws and rules.
use crate::common::*;
use std::sync::Arc;
use stoss_fe_solid::{ForceRule, SolidStep};
use stoss_materials::{FirstInvariant, Hencky};

#[test]
fn end_point_force_is_the_gradient_of_the_energy() {
    let mesh = distorted_block([2, 1, 1], 0.12, 3);
    let q = Random(4).perturbed(&positions(&mesh), 0.12);
    for law in laws() {
        let body = body(&mesh, &law);
        let f = force(&body, SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::END_POINT }).unwrap();
        let scale = max_abs(&f);
        for j in 0..q.len() {
            let expected = derivative(&q, j, 1e-3, |q| vec![body.strain_energy(q).unwrap()])[0];
            assert!((f[j] - expected).abs() < 1e-8 * scale, "{}: {} against {expected}", law.name(), f[j]);
        }
    }
}

#[test]
fn tangents_of_all_rules_match_differences_of_the_force() {
    let mesh = distorted_block([2, 1, 1], 0.12, 5);
    let mut random = Random(6);
    let q_n = random.perturbed(&positions(&mesh), 0.1);
    let q_np1 = random.perturbed(&q_n, 0.1);
    let mut laws = laws();
    laws.push(Arc::new(Hencky::new(1298.0769, 865.3846).unwrap()));
    laws.push(Arc::new(FirstInvariant::yeoh([0.5, -0.005, 0.0002], 2.0).unwrap()));
    laws.push(Arc::new(FirstInvariant::gent(1.0, 1000.0, 2.0).unwrap()));
    laws.push(Arc::new(FirstInvariant::arruda_boyce(1.0, 4.0, 2.0).unwrap()));
    for law in laws {
        let between = [0.3, 0.5, 0.7, 1.0].map(|theta| ForceRule::Configuration { theta });
        for rule in between.into_iter().chain([ForceRule::DiscreteGradient]) {
            let mut body = body(&mesh, &law);
            body.begin_step(&q_n, rule, 1.0).unwrap();
            let at = |q: &[f64]| force(&body, SolidStep { q_n: &q_n, q_np1: q, rule }).unwrap();
            let (with_tangent, tangent) = force_and_tangent(&body, SolidStep { q_n: &q_n, q_np1: &q_np1, rule });
            let alone = at(&q_np1);
            let scale = tangent.iter().map(|row| max_abs(row)).fold(0.0, f64::max);
            for j in 0..q_np1.len() {
                assert!((with_tangent[j] - alone[j]).abs() <= 1e-13 * max_abs(&alone));
                let column = derivative(&q_np1, j, 5e-4, at);
                for i in 0..q_np1.len() {
                    let difference = (tangent[i][j] - column[i]).abs();
                    assert!(
                        difference < 1e-8 * scale,
                        "{} {rule:?} ({i},{j}): {difference:e} of {scale:e}",
                        law.name()
                    );
                    if rule != ForceRule::DiscreteGradient {
                        assert!((tangent[i][j] - tangent[j][i]).abs() < 1e-14 * scale);
                    }
                }
            }
        }
    }
}

#[test]
fn energy_momentum_tangent_in_the_limit_of_no_motion_is_half_the_static_one() {
    let mesh = distorted_block([1, 1, 1], 0.12, 7);
    let q = Random(8).perturbed(&positions(&mesh), 0.1);
    for law in laws() {
        let mut body = body(&mesh, &law);
        body.begin_step(&q, ForceRule::DiscreteGradient, 1.0).unwrap();
        let (force_static, tangent_static) =
            force_and_tangent(&body, SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::END_POINT });
        let (force, tangent) =
            force_and_tangent(&body, SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::DiscreteGradient });
        for i in 0..q.len() {
            assert!((force[i] - force_static[i]).abs() < 1e-12 * max_abs(&force_static));
            for j in 0..q.len() {
                let scale = max_abs(&tangent_static[i]);
                assert!((tangent[i][j] - 0.5 * tangent_static[i][j]).abs() < 1e-12 * scale);
            }
        }
    }
}

#[test]
fn force_weight_and_tangent_factor_scale_what_is_added() {
    use stoss_fe_solid::{TangentTarget, Workspace};
    let mesh = distorted_block([1, 1, 2], 0.1, 1);
    let q = Random(2).perturbed(&positions(&mesh), 0.1);
    let body = body(&mesh, &laws()[0]);
    let step = SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::END_POINT };
    let (force, tangent) = force_and_tangent(&body, step);
    let (pattern, map) = pattern(&body, q.len());
    let (mut values, mut out) = (vec![1.0; pattern.nnz()], vec![2.0; q.len()]);
    let target = TangentTarget { map: &map, first_stencil: 0, factor: -3.0, values: &mut values };
    body.assemble(step, 0.25, &mut out, Some(target), &mut Workspace::default()).unwrap();
    let rows = dense(&pattern, &values);
    for i in 0..q.len() {
        assert!((out[i] - (2.0 + 0.25 * force[i])).abs() < 1e-12 * max_abs(&force));
        for &j in pattern.column(i) {
            let j = j as usize;
            assert!((rows[j][i] - (1.0 - 3.0 * tangent[j][i])).abs() < 1e-12 * max_abs(&tangent[j]));
        }
    }
}
