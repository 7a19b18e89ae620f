//! Identities of the element at random configurations (theory/integrators#eq-ems, theory/integrators#kept).
use crate::common::*;
use proptest::prelude::*;
use stoss_fe_solid::{ForceRule, SolidStep};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn forces_and_moments_about_the_configuration_of_the_rule_vanish(
        seed in any::<u64>(),
        shift in -50.0..50.0f64,
        law in 0usize..4,
        theta in prop_oneof![Just(0.0), Just(0.5), Just(1.0), 0.0..1.0],
    ) {
        let mesh = distorted_block([2, 1, 1], 0.15, seed);
        let mut random = Random(!seed);
        let q_n: Vec<f64> = random.perturbed(&positions(&mesh), 0.12).iter().map(|x| x + shift).collect();
        let q_np1 = random.perturbed(&q_n, 0.12);
        let mut body = body(&mesh, &laws()[law]);
        for (rule, theta) in [(ForceRule::Configuration { theta }, theta), (ForceRule::DiscreteGradient, 0.5)] {
            let q: Vec<f64> = q_n.iter().zip(&q_np1).map(|(a, b)| (1.0 - theta) * a + theta * b).collect();
            body.begin_step(&q_n, rule, 1.0).unwrap();
            let f = force(&body, SolidStep { q_n: &q_n, q_np1: &q_np1, rule }).unwrap();
            let scale = max_abs(&f);
            prop_assume!(scale > 1e-3);
            let (sum, moment) = resultant_and_moment(&q, &f);
            prop_assert!(max_abs(&sum) < 1e-13 * scale * f.len() as f64);
            prop_assert!(max_abs(&moment) < 1e-13 * scale * f.len() as f64 * max_abs(&q).max(1.0));
        }
    }

    #[test]
    fn energy_momentum_work_is_the_change_of_energy(seed in any::<u64>(), size in -5.0..-0.9f64, law in 0usize..4) {
        let mesh = distorted_block([2, 1, 1], 0.15, seed);
        let mut random = Random(!seed);
        let q_n = random.perturbed(&positions(&mesh), 0.12);
        // Increments from 1e-5 to 0.12.
        let q_np1 = random.perturbed(&q_n, 10f64.powf(size));
        let mut body = body(&mesh, &laws()[law]);
        body.begin_step(&q_n, ForceRule::DiscreteGradient, 1.0).unwrap();
        let f = force(&body, SolidStep { q_n: &q_n, q_np1: &q_np1, rule: ForceRule::DiscreteGradient }).unwrap();
        let increment: Vec<f64> = q_np1.iter().zip(&q_n).map(|(a, b)| a - b).collect();
        let (v_n, v_np1) = (body.strain_energy(&q_n).unwrap(), body.strain_energy(&q_np1).unwrap());
        // Round-off of the energies themselves (whose terms are of the size of the moduli) and of the work's terms.
        let moduli = laws()[law].small_strain_moduli();
        let scale = v_n.abs() + v_np1.abs() + (moduli.shear + moduli.bulk) * body.volume();
        prop_assert!((dot(&f, &increment) - (v_np1 - v_n)).abs() < 4e-14 * scale);
    }

    #[test]
    fn rigid_motions_need_no_force(seed in any::<u64>(), law in 0usize..4) {
        let mesh = distorted_block([2, 1, 1], 0.15, seed);
        let mut random = Random(!seed);
        let mut rigid = || {
            let (r, c) = (random.rotation(), [random.next(), random.next(), random.next()]);
            map_positions(&positions(&mesh), |x| {
                std::array::from_fn(|i| c[i] + r[i][0] * x[0] + r[i][1] * x[1] + r[i][2] * x[2])
            })
        };
        let (q_n, q_np1) = (rigid(), rigid());
        let translated: Vec<f64> = q_n.iter().map(|x| x + 0.7).collect();
        let law = &laws()[law];
        let mut body = body(&mesh, law);
        body.begin_step(&q_n, ForceRule::DiscreteGradient, 1.0).unwrap();
        let moduli = law.small_strain_moduli();
        for (q_np1, rule) in [
            (&q_np1, ForceRule::END_POINT),
            (&q_np1, ForceRule::DiscreteGradient),
            (&translated, ForceRule::MIDPOINT),
        ] {
            let f = force(&body, SolidStep { q_n: &q_n, q_np1, rule }).unwrap();
            prop_assert!(max_abs(&f) < 1e-13 * (moduli.shear + moduli.bulk) * 10.0, "{rule:?}");
        }
    }
}

#[test]
fn the_midpoint_rule_does_not_keep_the_energy() {
    // The counterpart of the work identity: the test above could not see a wrong energy otherwise.
    let mesh = distorted_block([1, 1, 1], 0.1, 1);
    let q_n = Random(2).perturbed(&positions(&mesh), 0.1);
    let q_np1 = Random(3).perturbed(&q_n, 0.1);
    for law in laws() {
        let body = body(&mesh, &law);
        let f = force(&body, SolidStep { q_n: &q_n, q_np1: &q_np1, rule: ForceRule::MIDPOINT }).unwrap();
        let increment: Vec<f64> = q_np1.iter().zip(&q_n).map(|(a, b)| a - b).collect();
        let change = body.strain_energy(&q_np1).unwrap() - body.strain_energy(&q_n).unwrap();
        assert!((dot(&f, &increment) - change).abs() > 1e-6 * change.abs(), "{}", law.name());
    }
}
