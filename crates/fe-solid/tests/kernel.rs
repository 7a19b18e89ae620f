//! The two-point form of the tangent against `B_I^T A B_J` with the `B` of theory/kinematics#eq-b, at random moduli.
use crate::common::Random;
use proptest::prelude::*;
use stoss_fe_solid::kernel::*;
use stoss_reference_element::{hex8, quadrature::GAUSS_HEX_2};

const NODES: usize = 8;
const GAUSS_POINTS: usize = 8;
const UNKNOWNS: usize = 24;

/// `B_I`, rows 11, 22, 33, 12, 23, 13.
fn b(f: &Matrix3, n: [f64; 3]) -> [[f64; 3]; 6] {
    let row = |a: usize, b: usize| -> [f64; 3] {
        std::array::from_fn(|i| if a == b { f[i][a] * n[a] } else { f[i][a] * n[b] + f[i][b] * n[a] })
    };
    [row(0, 0), row(1, 1), row(2, 2), row(0, 1), row(1, 2), row(0, 2)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn two_point_form_equals_the_b_form(seed in any::<u64>(), symmetric in any::<bool>(), geometric in 0.0..1.0f64) {
        let mut random = Random(seed);
        let natural: [Gradients; 8] = std::array::from_fn(|g| {
            let gradient = hex8::shape_gradient(GAUSS_HEX_2[g].0);
            std::array::from_fn(|a| std::array::from_fn(|node| gradient[node][a]))
        });
        let x = std::array::from_fn(|i| std::array::from_fn(|node| hex8::VERTICES[node][i] + 0.2 * random.next()));
        let element = integration(&x, &natural, &[1.0; 8]).unwrap();

        let mut factors: TangentFactors = [[[[f64::NAN; NODES]; 3]; GAUSS_POINTS]; 9];
        let mut given: Vec<(Matrix3, Matrix3, [[f64; 6]; 6], [f64; 6])> = Vec::new();
        let mut force = [[0.0; NODES]; 3];
        let mut expected = [[0.0; UNKNOWNS]; UNKNOWNS];
        let mut expected_force = [[0.0; NODES]; 3];
        for g in 0..GAUSS_POINTS {
            let mut matrix = || -> Matrix3 { std::array::from_fn(|_| std::array::from_fn(|_| random.next())) };
            let left = matrix();
            let right = if symmetric { left } else { matrix() };
            let mut moduli: [[f64; 6]; 6] = std::array::from_fn(|_| std::array::from_fn(|_| random.next()));
            if symmetric {
                for v in 0..6 {
                    for w in 0..v {
                        moduli[v][w] = moduli[w][v];
                    }
                }
            }
            let stress: [f64; 6] = std::array::from_fn(|_| random.next());
            let (gradients, weight) = (&element.gradients[g], element.weights[g]);
            given.push((left, right, moduli, stress));
            add_force(&left, &stress, gradients, weight, &mut force);
            let n = |node: usize| -> [f64; 3] { std::array::from_fn(|a| gradients[a][node]) };
            for i in 0..NODES {
                let b_left = b(&left, n(i));
                for r in 0..3 {
                    expected_force[r][i] += weight * (0..6).map(|v| b_left[v][r] * stress[v]).sum::<f64>();
                }
                for j in 0..NODES {
                    let b_right = b(&right, n(j));
                    let mut scalar = 0.0;
                    for a in 0..3 {
                        for c in 0..3 {
                            scalar += n(i)[a] * stress[COMPONENT_OF[a][c]] * n(j)[c];
                        }
                    }
                    for r in 0..3 {
                        for c in 0..3 {
                            let mut sum = if r == c { geometric * scalar } else { 0.0 };
                            for v in 0..6 {
                                for w in 0..6 {
                                    sum += b_left[v][r] * moduli[v][w] * b_right[w][c];
                                }
                            }
                            expected[3 * i + r][3 * j + c] += weight * sum;
                        }
                    }
                }
            }
        }
        let point = |g: usize| {
            let (left, right, moduli, stress) = &given[g];
            TangentPoint { left, right, moduli, stress, geometric, weight: element.weights[g] }
        };
        let mut alone = factors;
        for g in 0..GAUSS_POINTS {
            tangent_factors(&[point(g)], &element.gradients, g, symmetric, &mut alone);
        }
        for first in [0, 4] {
            let points: [TangentPoint<'_>; 4] = std::array::from_fn(|k| point(first + k));
            tangent_factors(&points, &element.gradients, first, symmetric, &mut factors);
        }
        // Side by side they have the bits that they have alone; what is not written is not a number.
        let bits = |factors: &TangentFactors| factors.as_flattened().as_flattened().as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&factors), bits(&alone));
        let mut tangent: LocalTangent = [[[[f64::NAN; 3]; NODES]; 3]; NODES];
        tangent_from_factors(&element.gradients, &factors, symmetric, 2.0, &mut tangent);
        for r in 0..UNKNOWNS {
            for c in 0..UNKNOWNS {
                prop_assert!((flat(&tangent)[r * UNKNOWNS + c] - 2.0 * expected[r][c]).abs() < 1e-12);
            }
        }
        for r in 0..3 {
            for i in 0..NODES {
                prop_assert!((force[r][i] - expected_force[r][i]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn gradients_reproduce_a_linear_field(seed in any::<u64>()) {
        let mut random = Random(seed);
        let natural: [Gradients; 8] = std::array::from_fn(|g| {
            let gradient = hex8::shape_gradient(GAUSS_HEX_2[g].0);
            std::array::from_fn(|a| std::array::from_fn(|node| gradient[node][a]))
        });
        let x: NodalVectors = std::array::from_fn(|i| std::array::from_fn(|node| hex8::VERTICES[node][i] + 0.2 * random.next()));
        let element = integration(&x, &natural, &[1.0; 8]).unwrap();
        let f: Matrix3 = std::array::from_fn(|_| std::array::from_fn(|_| random.next()));
        let q: NodalVectors = std::array::from_fn(|i| {
            std::array::from_fn(|node| 0.4 + (0..3).map(|a| f[i][a] * x[a][node]).sum::<f64>())
        });
        for g in 0..GAUSS_POINTS {
            let found = deformation_gradient(&q, &element.gradients[g]);
            let c = right_cauchy_green(&found);
            for i in 0..3 {
                for a in 0..3 {
                    prop_assert!((found[i][a] - f[i][a]).abs() < 1e-13);
                    let expected: f64 = (0..3).map(|k| f[k][i] * f[k][a]).sum();
                    prop_assert!((c[COMPONENT_OF[i][a]] - expected).abs() < 1e-13);
                }
            }
        }
    }
}
