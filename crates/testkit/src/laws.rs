//! The battery of hyperelastic laws.

use crate::{oracle, strategies};
use num_dual::{DualNum, hessian};
use proptest::test_runner::{Config, TestRunner};
use stoss_continuum::{
    HyperelasticLaw, SymmetricTensor2, Tensor4, energy_momentum_stress, energy_momentum_stress_and_tangent,
};

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
}

fn run(
    cases: u32,
    strategy: impl proptest::strategy::Strategy<Value = SymmetricTensor2>,
    test: impl Fn(&SymmetricTensor2),
) {
    let mut runner = TestRunner::new(Config { cases, failure_persistence: None, ..Config::default() });
    runner
        .run(&strategy, |c| {
            test(&c);
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
}

/// Stress and elasticity tensor from the Hessian of the oracle's energy.
fn dual_derivatives(oracle: &impl EnergyOracle, c: &SymmetricTensor2) -> (SymmetricTensor2, Tensor4) {
    let x = nalgebra::SVector::<f64, 6>::from(c.0);
    let (_, gradient, second) = hessian(|x| oracle.energy([x[0], x[1], x[2], x[3], x[4], x[5]]), &x);
    // A plain shear component stands for two entries of the tensor: dW/dC_12 (stored) = 2 (dW/dC)_12.
    let half = |a: usize| if a < 3 { 1.0 } else { 0.5 };
    let stress = SymmetricTensor2(std::array::from_fn(|a| 2.0 * half(a) * gradient[a]));
    let elasticity =
        Tensor4(std::array::from_fn(|a| std::array::from_fn(|b| 4.0 * half(a) * half(b) * second[(a, b)])));
    (stress, elasticity)
}

/// What must hold for every isotropic hyperelastic law; `tolerance` is relative and covers the law's round-off.
///
/// # Panics
/// With the state and the size of the first violation.
pub fn battery(law: &dyn HyperelasticLaw, tolerance: f64) {
    let identity = SymmetricTensor2::IDENTITY;
    let moduli = law.small_strain_moduli();
    let scale = moduli.shear.max(moduli.bulk);
    let (stress, elasticity) = law.stress_and_elasticity(&identity).expect("the reference state is admissible");
    assert!(law.energy(&identity).expect("admissible").abs() <= 1e-13 * scale, "energy at C = 1");
    assert!(stress.norm() <= 1e-13 * scale, "stress at C = 1: {stress:?}");
    let mut expected = Tensor4::identity_dyad() * moduli.lame_lambda();
    expected.add_scaled(2.0 * moduli.shear, &Tensor4::symmetric_identity());
    let flat = |t: &Tensor4| t.0.concat();
    let error = oracle::max_relative_error(&flat(&elasticity), &flat(&expected), 0.0);
    assert!(error < 1e-12, "{}: tangent at C = 1 and small-strain moduli differ by {error:e}", law.name());

    let bad = SymmetricTensor2([1.0, 1.0, -1.0, 0.0, 0.0, 0.0]);
    for state in [bad, SymmetricTensor2::ZERO, SymmetricTensor2([f64::NAN; 6])] {
        assert!(law.energy(&state).is_err(), "{}: energy accepts {state:?}", law.name());
        assert!(law.stress(&state).is_err(), "{}: stress accepts {state:?}", law.name());
        assert!(law.stress_and_elasticity(&state).is_err(), "{}: tangent accepts {state:?}", law.name());
    }

    run(128, strategies::any_state(), |c| consistency(law, c, tolerance));
    run(64, strategies::right_cauchy_green(), |c| discrete_gradient(law, c, tolerance));
}

/// Stress, tangent and symmetries at one state by central differences of the law's own energy and stress.
fn consistency(law: &dyn HyperelasticLaw, c: &SymmetricTensor2, tolerance: f64) {
    let (stress, elasticity) = law.stress_and_elasticity(c).expect("admissible");
    let only = law.stress(c).expect("admissible");
    let scale = elasticity.max_abs();
    assert!((stress - only).norm() <= 1e-13 * scale.max(stress.norm()), "stress and stress_and_elasticity differ");
    let (energy, together) = law.energy_and_stress(c).expect("admissible");
    let w = law.energy(c).expect("admissible");
    assert!((energy - w).abs() <= 1e-14 * (w.abs() + scale), "energy and energy_and_stress differ");
    assert!((together - only).norm() <= 1e-14 * scale.max(stress.norm()), "stress and energy_and_stress differ");
    // The step follows the smallest eigenvalue: relative, not absolute, changes matter near collapse.
    let step = 1e-3 * stoss_tensor::spectral(c).values[0];
    let energy = oracle::central_difference_jacobian(
        |x, out| out[0] = law.energy(&SymmetricTensor2(std::array::from_fn(|i| x[i]))).expect("admissible"),
        &c.0,
        step,
        1,
    );
    let half = |a: usize| if a < 3 { 1.0 } else { 0.5 };
    let from_energy: Vec<f64> = (0..6).map(|a| 2.0 * half(a) * energy[a]).collect();
    let error = oracle::max_relative_error(&stress.0, &from_energy, 1e-3 * scale);
    assert!(error < 1e-6, "{}: S and 2 dW/dC differ by {error:e} at {c:?}", law.name());
    let from_stress = oracle::central_difference_jacobian(
        |x, out| {
            out.copy_from_slice(&law.stress(&SymmetricTensor2(std::array::from_fn(|i| x[i]))).expect("admissible").0);
        },
        &c.0,
        step,
        6,
    );
    let doubled: Vec<f64> = from_stress.iter().enumerate().map(|(k, x)| 2.0 * half(k % 6) * x).collect();
    let flat = elasticity.0.concat();
    let error = oracle::max_relative_error(&flat, &doubled, 0.0);
    assert!(error < 1e-6, "{}: CC and 2 dS/dC differ by {error:e} at {c:?}", law.name());
    let error = oracle::max_relative_error(&elasticity.major_transpose().0.concat(), &flat, 0.0);
    assert!(error < 1e-12, "{}: CC has no major symmetry ({error:e})", law.name());
    // Isotropy: W(Q C Q^T) = W(C), S(Q C Q^T) = Q S(C) Q^T. Objectivity is built in: the laws see C alone.
    let q = nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner();
    let rotated = c.rotated(&q);
    let difference = (law.stress(&rotated).expect("admissible") - stress.rotated(&q)).norm();
    assert!(difference <= tolerance * scale * c.norm(), "{}: not isotropic, {difference:e}", law.name());
    let difference = (law.energy(&rotated).expect("admissible") - w).abs();
    assert!(difference <= tolerance * (w.abs() + scale), "{}: energy not isotropic, {difference:e}", law.name());
}

/// Directionality and tangent of the energy-momentum stress between `c` and a neighbour at several distances.
fn discrete_gradient(law: &dyn HyperelasticLaw, c: &SymmetricTensor2, tolerance: f64) {
    let moduli = law.small_strain_moduli();
    let scale = moduli.shear.max(moduli.bulk);
    let direction = SymmetricTensor2([0.3, -0.2, 0.25, 0.15, -0.1, 0.2]);
    let energy_n = law.energy(c).expect("admissible");
    for size in [0.5, 1e-1, 1e-2, 1e-4, 1e-5, 1e-8] {
        let next = *c + direction * size;
        let Ok(energy_np1) = law.energy(&next) else { continue };
        let (stress, tangent) = energy_momentum_stress_and_tangent(law, c, energy_n, &next).expect("admissible");
        let alone = energy_momentum_stress(law, c, energy_n, &next).expect("admissible");
        assert!((alone - stress).norm() <= 1e-13 * (stress.norm() + scale));
        let work = 0.5 * stress.double_contract(&(next - *c));
        let error = (work - (energy_np1 - energy_n)).abs() / (energy_n.abs() + energy_np1.abs() + scale);
        assert!(error < tolerance, "{}: directionality {error:e} at distance {size}", law.name());
        if size < 1e-3 {
            // The quotient amplifies the round-off of the energies by 1/|dC|^2, in differences by a further 1/step.
            continue;
        }
        let differences = oracle::central_difference_jacobian(
            |x, out| {
                let next = SymmetricTensor2(std::array::from_fn(|i| x[i]));
                out.copy_from_slice(&energy_momentum_stress(law, c, energy_n, &next).expect("admissible").0);
            },
            &next.0,
            2e-3 * size.max(0.05),
            6,
        );
        // dS_v = A dE_v, dE_v = dC_v / 2 with doubled shears: dS/dC_11 = A/2, dS/dC_12 (stored) = A.
        let expected: Vec<f64> =
            tangent.0.concat().iter().enumerate().map(|(k, a)| if k % 6 < 3 { 0.5 * a } else { *a }).collect();
        let error = oracle::max_relative_error(&expected, &differences, 0.0);
        assert!(error < 1e-6, "{}: tangent A differs by {error:e} at distance {size}, C = {c:?}", law.name());
    }
}

/// Stress and tangent against exact second derivatives of the energy written over dual numbers, `tolerance` relative.
///
/// # Panics
/// With the state and the size of the first violation.
pub fn against_dual_numbers(law: &dyn HyperelasticLaw, energy: &impl EnergyOracle, tolerance: f64) {
    run(256, strategies::any_state(), |c| {
        let (stress, elasticity) = law.stress_and_elasticity(c).expect("admissible");
        let (s, cc) = dual_derivatives(energy, c);
        let scale = cc.max_abs();
        let error = oracle::max_relative_error(&stress.0, &s.0, 1e-3 * scale);
        assert!(error < tolerance, "{}: S differs from dual numbers by {error:e} at {c:?}", law.name());
        let error = oracle::max_relative_error(&elasticity.0.concat(), &cc.0.concat(), 0.0);
        assert!(error < tolerance, "{}: CC differs from dual numbers by {error:e} at {c:?}", law.name());
    });
}
