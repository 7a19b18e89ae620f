//! Random functions of several variables whose Jacobian is known in closed form.

use proptest::prelude::*;
use stoss_numerical_derivative::{
    Analytic, AnalyticVector, DerivativeError, DifferenceStep, Method, Scalar, Workspace, check_jacobian,
    directional_derivative, jacobian,
};

const INPUTS: usize = 3;
const OUTPUTS: usize = 4;

/// `f_i = sum_k a_ik x_0^p x_1^q x_2^r + b_i sin(w_i . x) + d_i exp(v_i . x) cos x_0`.
#[derive(Clone, Debug)]
struct Random {
    monomials: Vec<[(f64, [i32; INPUTS]); 3]>,
    waves: Vec<(f64, [f64; INPUTS])>,
    growth: Vec<(f64, [f64; INPUTS])>,
}

fn dot<S: Scalar>(w: &[f64; INPUTS], x: &[S]) -> S {
    x[0] * w[0] + x[1] * w[1] + x[2] * w[2]
}

impl AnalyticVector for Random {
    fn at<S: Scalar>(&self, x: &[S], value: &mut [S]) {
        for i in 0..OUTPUTS {
            let mut sum = S::from(0.0);
            for (a, [p, q, r]) in self.monomials[i] {
                sum += x[0].powi(p) * x[1].powi(q) * x[2].powi(r) * a;
            }
            let ((b, w), (d, v)) = (self.waves[i], self.growth[i]);
            value[i] = sum + dot(&w, x).sin() * b + dot(&v, x).exp() * x[0].cos() * d;
        }
    }
}

impl Random {
    /// `df_i/dx_j`.
    fn jacobian(&self, x: &[f64; INPUTS]) -> [f64; INPUTS * OUTPUTS] {
        let mut out = [0.0; INPUTS * OUTPUTS];
        for i in 0..OUTPUTS {
            for j in 0..INPUTS {
                let entry = &mut out[i * INPUTS + j];
                for (a, powers) in self.monomials[i] {
                    if powers[j] > 0 {
                        let others: f64 = (0..INPUTS).filter(|&k| k != j).map(|k| x[k].powi(powers[k])).product();
                        *entry += a * f64::from(powers[j]) * x[j].powi(powers[j] - 1) * others;
                    }
                }
                let ((b, w), (d, v)) = (self.waves[i], self.growth[i]);
                *entry += b * w[j] * dot(&w, x).cos() + d * v[j] * dot(&v, x).exp() * x[0].cos();
                if j == 0 {
                    *entry -= d * dot(&v, x).exp() * x[0].sin();
                }
            }
        }
        out
    }

    /// Bound of `f_i`; its derivatives by one variable up to the third are below 6 times that. `|w_j|, |v_j| <= 1`.
    fn size(&self, i: usize, x: &[f64; INPUTS]) -> f64 {
        let monomial = |(a, powers): &(f64, [i32; INPUTS])| {
            a.abs() * (0..INPUTS).map(|j| x[j].abs().max(1.0).powi(powers[j])).product::<f64>()
        };
        let ((b, _), (d, v)) = (self.waves[i], self.growth[i]);
        self.monomials[i].iter().map(monomial).sum::<f64>() + b.abs() + 2.0 * d.abs() * dot(&v, x).exp()
    }
}

fn function() -> impl Strategy<Value = Random> {
    let monomial = || (-2.0..2.0_f64, proptest::array::uniform3(0..4_i32));
    let wave = || (-2.0..2.0_f64, proptest::array::uniform3(-1.0..1.0_f64));
    (
        prop::collection::vec([monomial(), monomial(), monomial()], OUTPUTS),
        prop::collection::vec(wave(), OUTPUTS),
        prop::collection::vec(wave(), OUTPUTS),
    )
        .prop_map(|(monomials, waves, growth)| Random { monomials, waves, growth })
}

fn point() -> impl Strategy<Value = [f64; INPUTS]> {
    proptest::array::uniform3(-2.0..2.0_f64)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn jacobians_of_all_methods(f in function(), x in point()) {
        let exact = f.jacobian(&x);
        let mut workspace = Workspace::new(INPUTS, OUTPUTS);
        for method in Method::ALL {
            let mut numerical = [f64::NAN; INPUTS * OUTPUTS];
            jacobian(&mut Analytic(f.clone()), &x, method, DifferenceStep::default(), &mut workspace, &mut numerical).unwrap();
            for (k, (a, b)) in exact.iter().zip(&numerical).enumerate() {
                // Truncation: h/2 with h <= 2 sqrt(eps), or h^2/6, times a derivative; the rest is round-off.
                let bound = 12.0 * method.attainable_error() * f.size(k / INPUTS, &x);
                prop_assert!((a - b).abs() <= bound, "{method}: {b} against {a}, bound {bound:e}");
            }
        }
    }

    #[test]
    fn seeds_combine_the_columns(f in function(), x in point(), seed in point()) {
        prop_assume!(seed.iter().any(|p| p.abs() > 1e-3));
        let exact = f.jacobian(&x);
        let mut workspace = Workspace::default();
        for method in Method::ALL {
            let mut along = [f64::NAN; OUTPUTS];
            let mut g = Analytic(f.clone());
            directional_derivative(&mut g, &x, &seed, method, DifferenceStep::default(), &mut workspace, &mut along).unwrap();
            for i in 0..OUTPUTS {
                let expected: f64 = (0..INPUTS).map(|j| exact[i * INPUTS + j] * seed[j]).sum();
                let length: f64 = seed.iter().map(|p| p.abs()).sum();
                // Mixed derivatives too: three or nine times as many terms.
                let bound = 36.0 * method.attainable_error() * f.size(i, &x) * length;
                prop_assert!((along[i] - expected).abs() <= bound, "{method}: {} against {expected}", along[i]);
            }
        }
    }

    #[test]
    fn a_spoilt_entry_is_found(f in function(), x in point(), place in 0..INPUTS * OUTPUTS) {
        let mut jacobian = f.jacobian(&x);
        let size = (0..OUTPUTS).map(|i| f.size(i, &x)).fold(0.0, f64::max);
        let check = |jacobian: &[f64]| {
            check_jacobian(&mut Analytic(f.clone()), &x, jacobian, Method::ComplexStep, DifferenceStep::default()).unwrap()
        };
        let right = check(&jacobian);
        prop_assert!(right.relative_error * right.scale <= 1e-14 * size, "{right}");
        jacobian[place] += 1e-8 * size;
        let wrong = check(&jacobian);
        prop_assert_eq!(INPUTS * wrong.row + wrong.column, place);
        prop_assert!((wrong.relative_error * wrong.scale / (1e-8 * size) - 1.0).abs() < 1e-5);
    }
}

#[test]
fn closures_have_no_complex_step() {
    let mut f = |x: &[f64], y: &mut [f64]| y[0] = x[0];
    let step =
        jacobian(&mut f, &[1.0], Method::ComplexStep, DifferenceStep::default(), &mut Workspace::default(), &mut [0.0]);
    assert_eq!(step, Err(DerivativeError::RealOnly));
}
