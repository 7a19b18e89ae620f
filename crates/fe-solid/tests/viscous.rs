//! The viscous force: power, momenta, rigid motions, tangent, and the limit of small strains.
use crate::common::*;
use stoss_fe_solid::{ForceRule, SolidBody, SolidStep, TangentTarget, ViscousRate};

const FACTOR: f64 = 0.3;

fn viscous(body: &SolidBody, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; q.len()];
    let rate = ViscousRate { q, v, factor: FACTOR, slopes: [0.0; 2] };
    body.add_viscous_force(rate, &mut force, None).unwrap();
    force
}

fn viscous_tangent(body: &SolidBody, q: &[f64], v: &[f64], slopes: [f64; 2]) -> Vec<Vec<f64>> {
    let (pattern, map) = pattern(body, q.len());
    let mut values = vec![0.0; pattern.nnz()];
    let target = TangentTarget { map: &map, first_stencil: 0, factor: 1.0, values: &mut values };
    let rate = ViscousRate { q, v, factor: FACTOR, slopes };
    body.add_viscous_force(rate, &mut vec![0.0; q.len()], Some(target)).unwrap();
    dense(&pattern, &values)
}

#[test]
fn a_step_between_two_places_of_a_rigid_body_has_no_viscous_force() {
    let mesh = distorted_block([2, 1, 1], 0.12, 3);
    let mut random = Random(11);
    let q_n = random.perturbed(&positions(&mesh), 0.1);
    let r = random.rotation();
    let q_np1 =
        map_positions(&q_n, |x| std::array::from_fn(|i| 7.0 - r[i][0] * x[0] - r[i][1] * x[1] + r[i][2] * x[2]));
    // -(two columns): still a proper rotation.
    let mid: Vec<f64> = q_n.iter().zip(&q_np1).map(|(a, b)| 0.5 * (a + b)).collect();
    let v: Vec<f64> = q_n.iter().zip(&q_np1).map(|(a, b)| b - a).collect();
    for law in laws() {
        let body = body(&mesh, &law);
        let scale = FACTOR * law.small_strain_moduli().bulk;
        assert!(max_abs(&viscous(&body, &mid, &v)) < 1e-13 * scale, "{}", law.name());
    }
}

#[test]
fn resultant_and_moment_are_zero_and_the_power_is_not_negative() {
    let mesh = distorted_block([2, 1, 2], 0.12, 3);
    let mut random = Random(12);
    let q = random.perturbed(&positions(&mesh), 0.15);
    for law in laws() {
        let body = body(&mesh, &law);
        for _ in 0..10 {
            let v = random.perturbed(&vec![0.0; q.len()], 1.0);
            let f = viscous(&body, &q, &v);
            let scale = max_abs(&f);
            let (sum, moment) = resultant_and_moment(&q, &f);
            assert!(max_abs(&sum).max(max_abs(&moment)) < 1e-12 * scale, "{}", law.name());
            let power = dot(&f, &v);
            assert!(power > 0.0, "{}: {power:e}", law.name());
        }
    }
}

#[test]
fn at_the_reference_the_force_is_the_factor_times_the_stiffness_times_the_velocity() {
    let mesh = distorted_block([2, 1, 1], 0.12, 3);
    let q = positions(&mesh);
    let v = Random(13).perturbed(&vec![0.0; q.len()], 1.0);
    for law in laws() {
        let body = body(&mesh, &law);
        let (_, k) = force_and_tangent(&body, SolidStep { q_n: &q, q_np1: &q, rule: ForceRule::END_POINT });
        let f = viscous(&body, &q, &v);
        for (row, f) in k.iter().zip(&f) {
            let expected: f64 = FACTOR * row.iter().zip(&v).map(|(k, v)| k * v).sum::<f64>();
            assert!((f - expected).abs() < 1e-11 * max_abs(row), "{}: {f} against {expected}", law.name());
        }
    }
}

#[test]
fn the_tangent_is_the_derivative_of_the_force() {
    let mesh = distorted_block([2, 1, 1], 0.12, 5);
    let mut random = Random(14);
    let q_n = random.perturbed(&positions(&mesh), 0.1);
    let q_np1 = random.perturbed(&q_n, 0.1);
    let v_n = random.perturbed(&vec![0.0; q_n.len()], 1.0);
    for law in laws() {
        let body = body(&mesh, &law);
        // Positions and velocities of the midpoint, and of some other point with a velocity of its own.
        for (theta, slope) in [(0.5, 4.0), (0.7, 2.9)] {
            let place = |q: &[f64]| -> Vec<f64> { q_n.iter().zip(q).map(|(a, b)| a + theta * (b - a)).collect() };
            let speed = |q: &[f64]| -> Vec<f64> {
                q_n.iter().zip(q).zip(&v_n).map(|((a, b), v)| slope * (b - a) + (1.0 - theta) * v).collect()
            };
            let tangent = viscous_tangent(&body, &place(&q_np1), &speed(&q_np1), [theta, slope]);
            let scale = tangent.iter().map(|row| max_abs(row)).fold(0.0, f64::max);
            for j in 0..q_np1.len() {
                let column = derivative(&q_np1, j, 5e-4, |q: &[f64]| viscous(&body, &place(q), &speed(q)));
                for i in 0..q_np1.len() {
                    let difference = (tangent[i][j] - column[i]).abs();
                    assert!(difference < 1e-9 * scale, "{} ({i},{j}): {difference:e} of {scale:e}", law.name());
                }
            }
        }
    }
}
