//! The battery of hyperelastic laws: [`battery`] for any law, [`against_dual_numbers`] for one whose energy is written once more.
//!
//! Not here: laws, and elements that use them.

use crate::{oracle, strategies};
use num_dual::{DualNum, hessian};
use proptest::test_runner::{Config, TestRunner};
use stoss_continuum::{
    HyperelasticLaw, SymmetricTensor2, Tensor2, Tensor4, cauchy_stress, energy_momentum_stress,
    energy_momentum_stress_and_tangent,
};
use stoss_tensor::spectral_decomposition;

/// The energy of a law once more, over any dual number: the oracle of its derivatives. The six arguments are the plain
/// components of `C`.
pub trait EnergyOracle {
    /// `W(C)`.
    fn energy<D: DualNum<Primitive = f64> + Copy>(&self, right_cauchy_green: [D; 6]) -> D;
}

/// Eigenvalue-free helpers for oracles.
pub mod invariants {
    use num_dual::DualNum;

    /// `det C` from plain components.
    pub fn det<D: DualNum<Primitive = f64> + Copy>(c: [D; 6]) -> D {
        let [xx, yy, zz, xy, yz, xz] = c;
        xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    }
    /// Trace.
    pub fn trace<D: DualNum<Primitive = f64> + Copy>(c: [D; 6]) -> D {
        c[0] + c[1] + c[2]
    }
    /// Second invariant.
    pub fn second<D: DualNum<Primitive = f64> + Copy>(c: [D; 6]) -> D {
        let [xx, yy, zz, xy, yz, xz] = c;
        xx * yy + yy * zz + xx * zz - xy * xy - yz * yz - xz * xz
    }

    type Matrix<D> = [[D; 3]; 3];

    fn matrix<D: DualNum<Primitive = f64> + Copy>(entry: impl Fn(usize, usize) -> D) -> Matrix<D> {
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    fn product<D: DualNum<Primitive = f64> + Copy>(a: &Matrix<D>, b: &Matrix<D>) -> Matrix<D> {
        matrix(|i, j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
    }

    fn inverse<D: DualNum<Primitive = f64> + Copy>(a: &Matrix<D>) -> Matrix<D> {
        let cofactor = |i: usize, j: usize| {
            let (p, q, r, s) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            a[p][r] * a[q][s] - a[p][s] * a[q][r]
        };
        let det = a[0][0] * cofactor(0, 0) + a[0][1] * cofactor(0, 1) + a[0][2] * cofactor(0, 2);
        matrix(|i, j| cofactor(j, i) / det)
    }

    fn unit<D: DualNum<Primitive = f64> + Copy>(i: usize, j: usize) -> D {
        D::from(if i == j { 1.0 } else { 0.0 })
    }

    /// Number of square roots that bring eigenvalues between 0.02 and 10 to `|X| < 0.07`, where series of [`TERMS`] terms reach 1e-17.
    const ROOTS: u32 = 6;
    const TERMS: u32 = 14;

    /// `X` with `1 + X = C^(2^-ROOTS)` by repeated square roots (Denman and Beavers): without eigenvalues, hence differentiable for equal
    /// stretches too.
    fn root_less_one<D: DualNum<Primitive = f64> + Copy>(c: [D; 6]) -> Matrix<D> {
        let mut root = matrix(|i, j| match (i.min(j), i.max(j)) {
            (0, 1) => c[3],
            (1, 2) => c[4],
            (0, 2) => c[5],
            _ => c[i],
        });
        for _ in 0..ROOTS {
            let (mut y, mut z) = (root, matrix(unit::<D>));
            // Quadratic convergence, of the derivatives too (one iteration later each).
            for _ in 0..10 {
                let (y_inverse, z_inverse) = (inverse(&y), inverse(&z));
                (y, z) = (
                    matrix(|i, j| (y[i][j] + z_inverse[i][j]) * 0.5),
                    matrix(|i, j| (z[i][j] + y_inverse[i][j]) * 0.5),
                );
            }
            root = y;
        }
        matrix(|i, j| root[i][j] - unit::<D>(i, j))
    }

    /// `tr (ln C)^2`, with `ln C = 2^ROOTS ln(1 + X)` by its series.
    pub fn trace_of_squared_logarithm<D: DualNum<Primitive = f64> + Copy>(c: [D; 6]) -> D {
        let x = root_less_one(c);
        // ln(1 + X) = X (1 - X (1/2 - X (1/3 - ...)))
        let mut sum = matrix(|i, j| unit::<D>(i, j) / f64::from(TERMS));
        for n in (1..TERMS).rev() {
            let next = product(&x, &sum);
            sum = matrix(|i, j| unit::<D>(i, j) / f64::from(n) - next[i][j]);
        }
        let log = product(&x, &sum);
        let square = product(&log, &log);
        (square[0][0] + square[1][1] + square[2][2]) * f64::from(1_u32 << (2 * ROOTS))
    }

    /// `tr C^exponent` for each of some real exponents, as a matrix function: `C^e = ((1 + X)^e)^(2^ROOTS)` by the binomial series. For
    /// eigenvalues between 0.02 and 10.
    pub fn traces_of_powers<D: DualNum<Primitive = f64> + Copy>(c: [D; 6], exponents: &[f64]) -> Vec<D> {
        let x = root_less_one(c);
        let trace = |&exponent: &f64| {
            let mut power = matrix(unit::<D>);
            for n in (1..=TERMS).rev() {
                // Horner: 1 + (e - n + 1)/n X (1 + ...)
                let next = product(&x, &power);
                let factor = (exponent - f64::from(n) + 1.0) / f64::from(n);
                power = matrix(|i, j| unit::<D>(i, j) + next[i][j] * factor);
            }
            for _ in 0..ROOTS {
                power = product(&power, &power);
            }
            power[0][0] + power[1][1] + power[2][2]
        };
        exponents.iter().map(trace).collect()
    }
}

/// Relative round-off of a few operations.
const ROUND_OFF: f64 = 1.0e-14;

/// Bound for differences (which carry about 1e-10).
const DIFFERENCES: f64 = 1.0e-6;

fn run<T: std::fmt::Debug>(cases: u32, strategy: impl proptest::strategy::Strategy<Value = T>, test: impl Fn(&T)) {
    let mut runner = TestRunner::new(Config { cases, failure_persistence: None, ..Config::default() });
    runner
        .run(&strategy, |state| {
            test(&state);
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
}

fn state(components: &[f64]) -> SymmetricTensor2 {
    SymmetricTensor2(std::array::from_fn(|i| components[i]))
}

fn modulus(law: &dyn HyperelasticLaw) -> f64 {
    law.small_strain_moduli().shear.max(law.small_strain_moduli().bulk)
}

/// Stress and elasticity tensor from the Hessian of the oracle's energy.
fn dual_derivatives(oracle: &impl EnergyOracle, c: &SymmetricTensor2) -> (f64, SymmetricTensor2, Tensor4) {
    let x = nalgebra::SVector::<f64, 6>::from(c.0);
    let (energy, gradient, second) = hessian(|x| oracle.energy([x[0], x[1], x[2], x[3], x[4], x[5]]), &x);
    // A plain shear component stands for two entries of the tensor: dW/dC_12 (stored) = 2 (dW/dC)_12.
    let half = |a: usize| if a < 3 { 1.0 } else { 0.5 };
    let stress = SymmetricTensor2(std::array::from_fn(|a| 2.0 * half(a) * gradient[a]));
    let elasticity =
        Tensor4(std::array::from_fn(|a| std::array::from_fn(|b| 4.0 * half(a) * half(b) * second[(a, b)])));
    (energy, stress, elasticity)
}

/// What must hold for every isotropic hyperelastic law; `tolerance` is relative and covers the law's round-off.
///
/// Reference state, inadmissible and extreme states, agreement of the trait's methods, `S = 2 dW/dC`, `CC = 2 dS/dC`, major symmetry,
/// isotropy, objectivity, small-strain moduli, directionality and tangent of the energy-momentum stress; at random states
/// down to `J = 0.2` and with two and three (nearly) equal stretches.
///
/// # Panics
/// With the state and the size of the first violation.
pub fn battery(law: &dyn HyperelasticLaw, tolerance: f64) {
    reference_state(law);
    inadmissible_states(law);
    run(128, strategies::any_state(), |c| {
        methods_agree(law, c);
        derivatives(law, c);
    });
    run(128, (strategies::any_state(), strategies::rotation()), |(c, q)| isotropy(law, c, q, tolerance));
    run(128, (strategies::deformation_gradient(), strategies::rotation()), |(f, q)| objectivity(law, f, q, tolerance));
    run(256, strategies::step(), |(c_n, c_np1)| discrete_gradient(law, c_n, c_np1));
}

/// Checks the reference state `C = 1`: no energy, no stress, and the tangent of the moduli.
fn reference_state(law: &dyn HyperelasticLaw) {
    let (name, modulus) = (law.name(), modulus(law));
    let identity = SymmetricTensor2::IDENTITY;
    let (stress, elasticity) = law.stress_and_elasticity(&identity).expect("the reference state is admissible");
    let energy = law.energy(&identity).expect("the reference state is admissible");
    assert!(energy.abs() <= ROUND_OFF * modulus, "{name}: energy {energy:e} at C = 1");
    assert!(stress.norm() <= ROUND_OFF * modulus, "{name}: stress {stress:?} at C = 1");
    let moduli = law.small_strain_moduli();
    let mut expected = Tensor4::identity_dyad() * moduli.lame_lambda();
    expected.add_scaled(2.0 * moduli.shear, &Tensor4::symmetric_identity());
    let error = oracle::max_relative_error(elasticity.0.as_flattened(), expected.0.as_flattened(), 0.0);
    assert!(error < 1e-12, "{name}: tangent at C = 1 and small-strain moduli differ by {error:e}");
}

/// Errors, not numbers, where there is no state; and never a number that is none.
fn inadmissible_states(law: &dyn HyperelasticLaw) {
    let name = law.name();
    let mut states = vec![
        SymmetricTensor2([1.0, 1.0, -1.0, 0.0, 0.0, 0.0]),
        SymmetricTensor2([1.0, 1.0, 1.0, 0.0, 2.0, 0.0]),
        SymmetricTensor2([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]),
        SymmetricTensor2::ZERO,
        SymmetricTensor2([f64::NAN; 6]),
    ];
    states.extend((0..6).map(|i| {
        let mut c = SymmetricTensor2::IDENTITY;
        c.0[i] = f64::NAN;
        c
    }));
    for c in states {
        assert!(law.energy(&c).is_err(), "{name}: energy accepts {c:?}");
        assert!(law.stress(&c).is_err(), "{name}: stress accepts {c:?}");
        assert!(law.energy_and_stress(&c).is_err(), "{name}: energy_and_stress accepts {c:?}");
        assert!(law.stress_and_elasticity(&c).is_err(), "{name}: stress_and_elasticity accepts {c:?}");
    }
    let powers = [-308, -150, -100, -75, -30, -8, 0, 8, 30, 75, 100, 150, 308];
    let sizes = powers.map(|p| 10.0_f64.powi(p)).into_iter().chain([f64::INFINITY]);
    for diagonal in sizes.clone().flat_map(|x| sizes.clone().map(move |y| [x, y])) {
        for other in [diagonal[0], diagonal[1], 1.0] {
            let c = SymmetricTensor2([diagonal[0], diagonal[1], other, 0.0, 0.0, 0.0]);
            let finite = law.energy(&c).is_ok_and(f64::is_finite) || law.energy(&c).is_err();
            assert!(finite, "{name}: energy is {:?} at {c:?}", law.energy(&c));
            let finite = law.stress(&c).map_or(true, |s| s.is_finite());
            assert!(finite, "{name}: stress is {:?} at {c:?}", law.stress(&c));
            let finite = law.energy_and_stress(&c).map_or(true, |(w, s)| w.is_finite() && s.is_finite());
            assert!(finite, "{name}: energy_and_stress is not finite at {c:?}");
            let finite =
                law.stress_and_elasticity(&c).map_or(true, |(s, elasticity)| s.is_finite() && elasticity.is_finite());
            assert!(finite, "{name}: stress_and_elasticity is not finite at {c:?}");
        }
    }
}

/// `stress`, `energy_and_stress` and `stress_and_elasticity` give the same numbers.
fn methods_agree(law: &dyn HyperelasticLaw, c: &SymmetricTensor2) {
    let name = law.name();
    let (stress, elasticity) = law.stress_and_elasticity(c).expect("admissible");
    let scale = ROUND_OFF * elasticity.max_abs().max(stress.norm());
    let only = law.stress(c).expect("admissible");
    assert!((stress - only).norm() <= 10.0 * scale, "{name}: stress and stress_and_elasticity differ at {c:?}");
    let (energy, together) = law.energy_and_stress(c).expect("admissible");
    let w = law.energy(c).expect("admissible");
    assert!((energy - w).abs() <= ROUND_OFF * w.abs() + scale, "{name}: energy and energy_and_stress differ at {c:?}");
    assert!((together - only).norm() <= 10.0 * scale, "{name}: stress and energy_and_stress differ at {c:?}");
}

/// Stress, tangent and major symmetry at one state by differences of the law's own energy and stress.
fn derivatives(law: &dyn HyperelasticLaw, c: &SymmetricTensor2) {
    let name = law.name();
    let (stress, elasticity) = law.stress_and_elasticity(c).expect("admissible");
    let flat = elasticity.0.as_flattened();
    // The step follows the smallest eigenvalue: relative, not absolute, changes matter near collapse.
    let step = 1e-3 * spectral_decomposition(c).values[0];
    let half = |a: usize| if a < 3 { 1.0 } else { 0.5 };
    let energy = |x: &[f64], out: &mut [f64]| out[0] = law.energy(&state(x)).expect("admissible");
    let from_energy: Vec<f64> = oracle::central_difference_jacobian(energy, &c.0, step, 1)
        .iter()
        .enumerate()
        .map(|(a, x)| 2.0 * half(a) * x)
        .collect();
    let error = oracle::max_relative_error(&stress.0, &from_energy, 1e-3 * elasticity.max_abs());
    assert!(error < DIFFERENCES, "{name}: S and 2 dW/dC differ by {error:e} at {c:?}");
    let stresses = |x: &[f64], out: &mut [f64]| out.copy_from_slice(&law.stress(&state(x)).expect("admissible").0);
    let from_stress: Vec<f64> = oracle::central_difference_jacobian(stresses, &c.0, step, 6)
        .iter()
        .enumerate()
        .map(|(k, x)| 2.0 * half(k % 6) * x)
        .collect();
    let error = oracle::max_relative_error(flat, &from_stress, 0.0);
    assert!(error < DIFFERENCES, "{name}: CC and 2 dS/dC differ by {error:e} at {c:?}");
    let error = oracle::max_relative_error(elasticity.major_transpose().0.as_flattened(), flat, 0.0);
    assert!(error < 1e-12, "{name}: CC has no major symmetry ({error:e}) at {c:?}");
}

/// Isotropy: `W(Q C Q^T) = W(C)`, `S(Q C Q^T) = Q S(C) Q^T`.
fn isotropy(law: &dyn HyperelasticLaw, c: &SymmetricTensor2, q: &Tensor2, tolerance: f64) {
    let name = law.name();
    let (stress, elasticity) = law.stress_and_elasticity(c).expect("admissible");
    let (w, scale) = (law.energy(c).expect("admissible"), elasticity.max_abs() * c.norm());
    let rotated = c.rotated(q);
    let error = (law.stress(&rotated).expect("admissible") - stress.rotated(q)).norm() / scale;
    assert!(error <= tolerance, "{name}: stress not isotropic, {error:e} at {c:?}");
    let error = (law.energy(&rotated).expect("admissible") - w).abs() / (w.abs() + scale);
    assert!(error <= tolerance, "{name}: energy not isotropic, {error:e} at {c:?}");
}

/// Objectivity: with `F+ = Q F` the energy and `S` stay, the Cauchy stress turns with the body. A law that sees `C` alone has it
/// by construction; this is the proof for the chain `F -> C -> S -> Cauchy stress`.
fn objectivity(law: &dyn HyperelasticLaw, f: &Tensor2, q: &Tensor2, tolerance: f64) {
    let name = law.name();
    let c = SymmetricTensor2::right_cauchy_green(f);
    let turned_f = q * f;
    let turned_c = SymmetricTensor2::right_cauchy_green(&turned_f);
    let (stress, elasticity) = law.stress_and_elasticity(&c).expect("admissible");
    let scale = elasticity.max_abs() * c.norm();
    let (w, turned_w) = (law.energy(&c).expect("admissible"), law.energy(&turned_c).expect("admissible"));
    let error = (w - turned_w).abs() / (w.abs() + scale);
    assert!(error <= tolerance, "{name}: energy not objective, {error:e} at {f:?}");
    let turned_stress = law.stress(&turned_c).expect("admissible");
    let error = (turned_stress - stress).norm() / scale;
    assert!(error <= tolerance, "{name}: second Piola-Kirchhoff stress not objective, {error:e} at {f:?}");
    let sigma = cauchy_stress(f, &stress);
    let error = (cauchy_stress(&turned_f, &turned_stress) - sigma.rotated(q)).norm() * f.determinant()
        / (scale * f.norm_squared());
    assert!(error <= tolerance, "{name}: Cauchy stress not objective, {error:e} at {f:?}");
}

/// Directionality and tangent of the energy-momentum stress for a step.
fn discrete_gradient(law: &dyn HyperelasticLaw, c_n: &SymmetricTensor2, c_np1: &SymmetricTensor2) {
    let name = law.name();
    let (delta, mean) = (*c_np1 - *c_n, (*c_n + *c_np1) * 0.5);
    let size = delta.norm();
    let (energy_n, energy_np1) = (law.energy(c_n).expect("admissible"), law.energy(c_np1).expect("admissible"));
    let (mean_stress, elasticity) = law.stress_and_elasticity(&mean).expect("the mean of two states is admissible");
    let (stress, tangent) = energy_momentum_stress_and_tangent(law, c_n, energy_n, c_np1).expect("admissible");
    let alone = energy_momentum_stress(law, c_n, energy_n, c_np1).expect("admissible");
    // The quotient divides the round-off of the energies by |dC|.
    let energies = energy_n.abs() + energy_np1.abs() + elasticity.max_abs();
    let noise = ROUND_OFF * (stress.norm() + elasticity.max_abs());
    let quotient_noise = ROUND_OFF * energies / size.max(law.smallest_strain_increment());
    assert!((alone - stress).norm() <= noise + quotient_noise, "{name}: stress with and without tangent differ");
    let work = 0.5 * stress.double_contract(&delta);
    let error = (work - (energy_np1 - energy_n)).abs() / (energies + size * (stress.norm() + mean_stress.norm()));
    assert!(error < ROUND_OFF, "{name}: directionality {error:e} from {c_n:?} to {c_np1:?}");
    if size <= law.smallest_strain_increment() {
        assert!((stress - mean_stress).norm() <= noise, "{name}: S_alg is not S at the mean for |dC| = {size:e}");
        let error = oracle::max_relative_error(
            tangent.0.as_flattened(),
            (elasticity * 0.5).0.as_flattened(),
            ROUND_OFF * elasticity.max_abs(),
        );
        assert!(error < 1e-12, "{name}: A is not CC/2 at the mean for |dC| = {size:e}");
    }
    // Differences of a quotient, which is smooth over lengths of `size` only: truncation (step / size)^4, round-off energies / (size step).
    let step = f64::min(1e-3 * spectral_decomposition(c_np1).values[0], 0.02 * size);
    let round_off = f64::EPSILON * energies / (size * step);
    if round_off > 0.1 * DIFFERENCES * tangent.max_abs() {
        return;
    }
    let stresses = |x: &[f64], out: &mut [f64]| {
        out.copy_from_slice(&energy_momentum_stress(law, c_n, energy_n, &state(x)).expect("admissible").0);
    };
    let differences = oracle::central_difference_jacobian(stresses, &c_np1.0, step, 6);
    // dS_v = A dE_v, dE_v = dC_v / 2 with doubled shears: dS/dC_11 = A/2, dS/dC_12 (stored) = A.
    let expected: Vec<f64> =
        tangent.0.as_flattened().iter().enumerate().map(|(k, a)| if k % 6 < 3 { 0.5 * a } else { *a }).collect();
    let error = oracle::max_relative_error(&expected, &differences, 0.0);
    assert!(error < DIFFERENCES, "{name}: tangent A differs by {error:e} from {c_n:?} to {c_np1:?}");
}

/// Energy, stress and tangent against exact derivatives of the energy written over dual numbers, `tolerance` relative to the largest
/// component of the tangent.
///
/// # Panics
/// With the state and the size of the first violation.
pub fn against_dual_numbers(law: &dyn HyperelasticLaw, energy: &impl EnergyOracle, tolerance: f64) {
    run(256, strategies::any_state(), |c| {
        let name = law.name();
        let (stress, elasticity) = law.stress_and_elasticity(c).expect("admissible");
        let (w, s, cc) = dual_derivatives(energy, c);
        let scale = cc.max_abs();
        let error = (law.energy(c).expect("admissible") - w).abs() / (w.abs() + scale);
        assert!(error < tolerance, "{name}: W differs from dual numbers by {error:e} at {c:?}");
        let error = oracle::max_relative_error(&stress.0, &s.0, 1e-3 * scale);
        assert!(error < tolerance, "{name}: S differs from dual numbers by {error:e} at {c:?}");
        let error = oracle::max_relative_error(elasticity.0.as_flattened(), cc.0.as_flattened(), 0.0);
        assert!(error < tolerance, "{name}: CC differs from dual numbers by {error:e} at {c:?}");
    });
}
