//! The rule of one configuration `q_{n+theta}`: which positions it reads, its ends, its tangent.
use crate::common::*;
use proptest::prelude::*;
use stoss_continuum::SymmetricTensor2;
use stoss_fe_solid::{ForceRule, SolidError, SolidStep, TangentTarget, TimeLevel, Workspace, kernel::*};
use stoss_mesh::generate::Block;
use stoss_reference_element::{hex8, quadrature::GAUSS_HEX_2};

const NODES: usize = 8;
const GAUSS_POINTS: usize = 8;
const START: ForceRule = ForceRule::Configuration { theta: 0.0 };

fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

/// An element's values, component-major.
fn nodal(q: &[f64], nodes: &[u32]) -> NodalVectors {
    std::array::from_fn(|i| std::array::from_fn(|node| q[3 * nodes[node] as usize + i]))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    // The static force and tangent of a single element put together here from the kernel and the law.
    #[test]
    fn end_point_is_the_static_element_and_reads_no_start(seed in any::<u64>(), law in 0usize..4) {
        let mesh = distorted_block([1, 1, 1], 0.12, seed);
        let q = Random(!seed).perturbed(&positions(&mesh), 0.12);
        let law = &laws()[law];
        let body = body(&mesh, law);
        let nodes = body.elements()[0].to_vec();
        let natural = std::array::from_fn(|g| {
            let gradient = hex8::shape_gradient(GAUSS_HEX_2[g].0);
            std::array::from_fn(|a| std::array::from_fn(|node| gradient[node][a]))
        });
        let element = integration(&nodal(&positions(&mesh), &nodes), &natural, &GAUSS_HEX_2.map(|(_, w)| w)).unwrap();
        let local = nodal(&q, &nodes);
        let mut expected_force = [[0.0; NODES]; 3];
        let mut factors: TangentFactors = [[[[0.0; NODES]; 3]; GAUSS_POINTS]; 9];
        for g in 0..GAUSS_POINTS {
            let (gradients, weight) = (&element.gradients[g], element.weights[g]);
            let f = deformation_gradient(&local, gradients);
            let c = SymmetricTensor2::from_components(right_cauchy_green(&f));
            let (stress, moduli) = law.stress_and_elasticity(&c).unwrap();
            let stress = stress.to_components();
            add_force(&f, &stress, gradients, weight, &mut expected_force);
            let (left, right, moduli, stress) = (&f, &f, &moduli.0, &stress);
            let point = TangentPoint { left, right, moduli, stress, geometric: 1.0, weight };
            tangent_factors(&[point], &element.gradients, g, true, &mut factors);
        }
        let mut expected: LocalTangent = [[[[0.0; 3]; NODES]; 3]; NODES];
        tangent_from_factors(&element.gradients, &factors, true, 1.0, &mut expected);

        let nowhere = vec![f64::NAN; q.len()];
        let scale = flat(&expected).iter().fold(0.0_f64, |scale, x| scale.max(x.abs()));
        for q_n in [&[] as &[f64], &nowhere] {
            let (force, tangent) = force_and_tangent(&body, SolidStep { q_n, q_np1: &q, rule: ForceRule::END_POINT });
            for (k, force) in force.iter().enumerate() {
                let node = nodes.iter().position(|&n| n as usize == k / 3).unwrap();
                prop_assert!((force - expected_force[k % 3][node]).abs() < 1e-13 * scale);
            }
            for i in 0..24 {
                for j in 0..24 {
                    let at = |k: usize| 3 * nodes[k / 3] as usize + k % 3;
                    prop_assert!((tangent[at(i)][at(j)] - flat(&expected)[24 * i + j]).abs() < 1e-13 * scale);
                    prop_assert_eq!(tangent[at(i)][at(j)].to_bits(), tangent[at(j)][at(i)].to_bits());
                }
            }
        }
    }

    #[test]
    fn the_force_is_the_static_one_between_and_its_tangent_theta_times_as_large(
        seed in any::<u64>(),
        theta in 0.05..0.95_f64,
        law in 0usize..4,
    ) {
        let mesh = distorted_block([2, 1, 1], 0.12, seed);
        let mut random = Random(!seed);
        let q_n = random.perturbed(&positions(&mesh), 0.12);
        let q_np1 = random.perturbed(&q_n, 0.12);
        let q: Vec<f64> = q_n.iter().zip(&q_np1).map(|(a, b)| a + theta * (b - a)).collect();
        let body = body(&mesh, &laws()[law]);
        let rule = ForceRule::Configuration { theta };
        let (force, tangent) = force_and_tangent(&body, SolidStep { q_n: &q_n, q_np1: &q_np1, rule });
        let static_step = SolidStep { q_n: &[], q_np1: &q, rule: ForceRule::END_POINT };
        let (static_force, static_tangent) = force_and_tangent(&body, static_step);
        let scale = static_tangent.iter().map(|row| max_abs(row)).fold(0.0, f64::max);
        for i in 0..q.len() {
            prop_assert!((force[i] - static_force[i]).abs() < 1e-14 * scale);
            for j in 0..q.len() {
                prop_assert!((tangent[i][j] - theta * static_tangent[i][j]).abs() < 1e-13 * scale);
            }
        }
    }

    #[test]
    fn at_the_start_the_end_is_not_read_and_the_tangent_not_touched(seed in any::<u64>(), law in 0usize..4) {
        let mesh = distorted_block([2, 1, 1], 0.12, seed);
        let q = Random(!seed).perturbed(&positions(&mesh), 0.12);
        let body = body(&mesh, &laws()[law]);
        let (pattern, map) = pattern(&body, q.len());
        let expected = force(&body, SolidStep { q_n: &[], q_np1: &q, rule: ForceRule::END_POINT }).unwrap();
        let nowhere = vec![f64::NAN; q.len()];
        for q_np1 in [&[] as &[f64], &nowhere] {
            let marks: Vec<f64> = (0..pattern.nnz()).map(|k| k as f64 - 0.3).collect();
            let (mut values, mut out) = (marks.clone(), vec![0.0; q.len()]);
            let target = TangentTarget { map: &map, first_stencil: 0, factor: 3.0, values: &mut values };
            let step = SolidStep { q_n: &q, q_np1, rule: START };
            body.assemble(step, 1.0, &mut out, Some(target), &mut Workspace::default()).unwrap();
            prop_assert_eq!(bits(&out), bits(&expected));
            prop_assert_eq!(bits(&values), bits(&marks));
        }
    }
}

#[test]
fn inverted_ends_are_named_as_far_as_they_are_read() {
    let mesh = Block::with_size([1.0; 3], [1, 1, 1]).generate().unwrap();
    let x = positions(&mesh);
    let mirrored = map_positions(&x, |x| [-x[0], x[1], x[2]]);
    let body = body(&mesh, &laws()[1]);
    let level = |q_n: &[f64], q_np1: &[f64], theta: f64| {
        let rule = ForceRule::Configuration { theta };
        match force(&body, SolidStep { q_n, q_np1, rule }) {
            Ok(_) => None,
            Err(SolidError::InvertedElement { level, .. }) => Some(level),
            Err(other) => panic!("{other}"),
        }
    };
    // A third of the way to the mirror image the cube is still upright.
    assert_eq!(level(&x, &mirrored, 1.0 / 3.0), Some(TimeLevel::End));
    assert_eq!(level(&x, &mirrored, 1.0), Some(TimeLevel::End));
    assert_eq!(level(&x, &mirrored, 0.0), None, "the end is not read");
    assert_eq!(level(&mirrored, &x, 0.0), Some(TimeLevel::Start));
    assert_eq!(level(&mirrored, &x, 1.0 / 3.0), Some(TimeLevel::Intermediate));
    assert_eq!(level(&mirrored, &x, 2.0 / 3.0), None, "past the flat state, and q_n is not looked at");
    assert_eq!(level(&mirrored, &x, 1.0), None, "the start is not read");
    assert_eq!(level(&x, &x, f64::NAN), Some(TimeLevel::Intermediate));
}

#[test]
fn only_positions_that_are_read_need_their_length() {
    let mesh = Block::with_size([1.0; 3], [1, 1, 1]).generate().unwrap();
    let x = positions(&mesh);
    let body = body(&mesh, &laws()[0]);
    let missing = |q_n: &[f64], q_np1: &[f64], theta: f64| {
        let step = SolidStep { q_n, q_np1, rule: ForceRule::Configuration { theta } };
        match body.assemble(step, 1.0, &mut [0.0; 24], None, &mut Workspace::default()) {
            Ok(()) => None,
            Err(SolidError::Length { what, found: 0, expected: 24, .. }) => Some(what),
            Err(other) => panic!("{other}"),
        }
    };
    assert_eq!(missing(&[], &x, 1.0), None);
    assert_eq!(missing(&x, &[], 0.0), None);
    for theta in [0.0, 0.5] {
        assert_eq!(missing(&[], &x, theta), Some("the positions q_n"));
    }
    for theta in [0.5, 1.0] {
        assert_eq!(missing(&x, &[], theta), Some("the positions q_np1"));
    }
}
