//! The energy-momentum stress (theory/integrators#ems) on a pseudo-rigid body: one deformation gradient `F(t)` with the inertia
//! `m` of each component, `m F'' = -F S`. It has the structure of a free element (momentum `m (F' F^T - F F'^T)`, energy
//! `m/2 F':F' + W`) and nothing else, so that a drift can only come from the stress.

use stoss_continuum::{
    HyperelasticLaw, SymmetricTensor2, Tensor2, Tensor4, energy_momentum_stress, energy_momentum_stress_and_tangent,
};
use stoss_materials::{MooneyRivlin, NeoHooke, Ogden, SaintVenantKirchhoff};
use stoss_tensor::{
    INDEX_PAIRS,
    nalgebra::{SMatrix, SVector},
};

#[derive(Clone, Copy, PartialEq)]
enum Rule {
    EnergyMomentum,
    Midpoint,
}

struct Run {
    /// Energy at the start.
    energy: f64,
    /// Drift of the energy, relative.
    energy_drift: f64,
    momentum_drift: f64,
    most_iterations: usize,
}

fn cauchy_green(f: &Tensor2) -> SymmetricTensor2 {
    SymmetricTensor2::right_cauchy_green(f)
}

/// Independent components of `m (V F^T - F V^T)`.
fn momentum(mass: f64, f: &Tensor2, v: &Tensor2) -> [f64; 3] {
    let a = v * f.transpose();
    [(0, 1), (1, 2), (2, 0)].map(|(i, j)| mass * (a[(i, j)] - a[(j, i)]))
}

/// `dE_v/dF`, row `a` for the component `F_iJ` with the column `3 J + i`; shears doubled.
fn strain_derivative(f: &Tensor2) -> SMatrix<f64, 6, 9> {
    SMatrix::from_fn(|a, column| {
        let (i, j) = (column % 3, column / 3);
        let (k, l) = INDEX_PAIRS[a];
        let shear = if k == l { 0.5 } else { 1.0 };
        shear * ((if j == k { f[(i, l)] } else { 0.0 }) + (if j == l { f[(i, k)] } else { 0.0 }))
    })
}

/// `steps` steps of size `dt` of a spinning and stretching body.
fn fly(law: &dyn HyperelasticLaw, rule: Rule, mass: f64, dt: f64, steps: usize, speed: f64) -> Run {
    let mut f = Tensor2::identity();
    let mut v = Tensor2::new(0.3, -1.0, 0.2, 1.1, -0.4, 0.1, -0.3, 0.2, 0.35) * speed;
    let energy = |f: &Tensor2, v: &Tensor2| 0.5 * mass * v.norm_squared() + law.energy(&cauchy_green(f)).unwrap();
    let (h_0, l_0) = (energy(&f, &v), momentum(mass, &f, &v));
    let l_size = l_0.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut run = Run { energy: h_0, energy_drift: 0.0, momentum_drift: 0.0, most_iterations: 0 };
    for _ in 0..steps {
        let c_n = cauchy_green(&f);
        let w_n = law.energy(&c_n).unwrap();
        let mut next = f + v * dt;
        let mut last = f64::INFINITY;
        for iteration in 1.. {
            let mid = (f + next) * 0.5;
            let c_np1 = cauchy_green(&next);
            let (stress, tangent): (SymmetricTensor2, Tensor4) = match rule {
                Rule::EnergyMomentum => energy_momentum_stress_and_tangent(law, &c_n, w_n, &c_np1).unwrap(),
                Rule::Midpoint => {
                    let (s, cc) = law.stress_and_elasticity(&cauchy_green(&mid)).unwrap();
                    (s, cc * 0.5)
                }
            };
            let s = stress.to_matrix();
            let inertia = 2.0 * mass / (dt * dt);
            let residual = (next - f - v * dt) * inertia + mid * s;
            // The midpoint rule's strain is that of F_mid, the energy-momentum rule's that of F_np1.
            let left = strain_derivative(&mid);
            let right = if rule == Rule::EnergyMomentum { strain_derivative(&next) } else { left };
            let a = SMatrix::<f64, 6, 6>::from_fn(|i, j| tangent.0[i][j]);
            let mut k = left.transpose() * a * right;
            for column in 0..9 {
                k[(column, column)] += inertia;
                for j in 0..3 {
                    k[(3 * j + column % 3, column)] += 0.5 * s[(j, column / 3)];
                }
            }
            let r = SVector::<f64, 9>::from_column_slice(residual.as_slice());
            let increment = k.lu().solve(&-r).unwrap();
            next += Tensor2::from_column_slice(increment.as_slice());
            run.most_iterations = run.most_iterations.max(iteration);
            // Until round-off: the increment is below that of F, or does not decrease any more.
            if increment.norm() < 2e-16 || (increment.norm() >= 0.5 * last && increment.norm() < 1e-8) {
                break;
            }
            assert!(iteration < 30, "{}: Newton stagnates at {:e}", law.name(), increment.norm());
            last = increment.norm();
        }
        v = (next - f) * (2.0 / dt) - v;
        f = next;
        run.energy_drift = run.energy_drift.max((energy(&f, &v) / h_0 - 1.0).abs());
        for (l, l_0) in momentum(mass, &f, &v).iter().zip(&l_0) {
            run.momentum_drift = run.momentum_drift.max((l - l_0).abs() / l_size);
        }
    }
    run
}

fn laws() -> Vec<(Box<dyn HyperelasticLaw>, f64)> {
    // The inertia makes the period of the stretching about 2 for each.
    vec![
        (Box::new(SaintVenantKirchhoff::from_young_poisson(2250.0, 0.3).unwrap()), 200.0),
        (Box::new(NeoHooke::from_young_poisson(2250.0, 0.3).unwrap()), 200.0),
        (Box::new(MooneyRivlin::new(176_051.0, 4332.63, 2.0e6).unwrap()), 1.5e5),
        (Box::new(Ogden::new(&[6300.0, 12.0, -100.0], &[1.3, 5.0, -2.0], 2000.0, 9.0).unwrap()), 800.0),
    ]
}

#[test]
fn free_flight_of_500_steps_keeps_energy_and_momentum() {
    for (law, mass) in laws() {
        let em = fly(&*law, Rule::EnergyMomentum, mass, 0.1, 500, 0.8);
        assert!(em.energy_drift < 1e-12, "{}: energy drifts by {:e}", law.name(), em.energy_drift);
        assert!(em.momentum_drift < 1e-12, "{}: momentum drifts by {:e}", law.name(), em.momentum_drift);
        assert!(em.most_iterations <= 9, "{}: {} iterations", law.name(), em.most_iterations);
        // At this step size the midpoint rule visibly does not keep the energy: the run is a test.
        let midpoint = fly(&*law, Rule::Midpoint, mass, 0.1, 500, 0.8);
        assert!(midpoint.energy_drift > 1e-3, "{}: midpoint drifts by {:e} only", law.name(), midpoint.energy_drift);
        assert!(midpoint.momentum_drift < 1e-12);
    }
}

#[test]
fn small_vibrations_keep_the_energy_on_both_sides_of_the_switch() {
    // Strain increments of a step of 1e-5 to 1e-7, the switch being at 1e-6. Below it the mean stress changes the energy by about
    // |dC|^3/24 times a few moduli, 1e-18; above it the energies' round-off must not do more (1e-16 of the modulus would).
    for (law, mass) in laws() {
        let modulus = law.small_strain_moduli().shear.max(law.small_strain_moduli().bulk);
        for speed in [1e-4, 1e-5, 1e-6] {
            let em = fly(&*law, Rule::EnergyMomentum, mass, 0.1, 500, speed);
            let drift = em.energy_drift * em.energy / modulus;
            assert!(drift < 1e-17, "{}: drift {drift:e} of the modulus at speed {speed:e}", law.name());
            assert!(em.momentum_drift < 1e-11, "{}: momentum {:e}", law.name(), em.momentum_drift);
        }
    }
}

#[test]
fn the_quotient_carries_little_round_off_near_the_reference_state() {
    // An energy with an error of 1e-16 of the modulus would put 1e-16 / |dC| into the stress, 1e-10 just above the switch. The laws'
    // energies have an error of 1e-16 |C - 1| of the modulus.
    let (strain_size, increment_size) = (1e-4, 2e-6);
    for (law, _) in laws() {
        let modulus = law.small_strain_moduli().shear.max(law.small_strain_moduli().bulk);
        let mut worst = 0.0_f64;
        for i in 0..500 {
            let turn = 0.1 * f64::from(i);
            let strain = SymmetricTensor2([turn.sin(), turn.cos(), 0.3, (2.0 * turn).sin(), 0.5, (3.0 * turn).cos()]);
            let direction = SymmetricTensor2([0.3, turn.sin(), -0.6, 0.1, (5.0 * turn).cos(), 0.2]);
            let c_n = SymmetricTensor2::IDENTITY + strain * (strain_size / strain.norm());
            let c_np1 = c_n + direction * (increment_size / direction.norm());
            let stress = energy_momentum_stress(&*law, &c_n, law.energy(&c_n).unwrap(), &c_np1).unwrap();
            let mean = law.stress(&((c_n + c_np1) * 0.5)).unwrap();
            // 2 (W_np1 - W_n) is the integral of S : dC, whose difference to S(mean) : dC Simpson's rule gives to |dC|^5.
            let delta = c_np1 - c_n;
            let third = (law.stress(&c_n).unwrap() + law.stress(&c_np1).unwrap() - mean * 2.0) * (1.0 / 6.0);
            let exact = delta * (third.double_contract(&delta) / delta.double_contract(&delta));
            worst = worst.max((stress - mean - exact).norm() / modulus);
        }
        let bound = 8.0 * f64::EPSILON * strain_size / increment_size;
        assert!(worst < bound, "{}: round-off {worst:e} of the modulus, not {bound:e}", law.name());
    }
}
