//! Plasticity and Maxwell branches against closed forms (theory/inelastic#closed-forms).

use crate::inelastic::{BULK, MU, Point, metal, table, voce};
use std::sync::Arc;
use stoss_continuum::{HyperelasticLaw, Material, StepStress, SymmetricTensor2, Tensor2, energy_momentum_stress};
use stoss_materials::{Fibres, Hardening, Hencky, Inelastic, Moduli, NeoHooke};

fn young() -> f64 {
    9.0 * BULK * MU / (3.0 * BULK + MU)
}

/// Uniaxial stress: the axial stretch is prescribed, the lateral one found; Kirchhoff stress along the axis.
fn uniaxial(point: &mut Point<'_>, axial: f64) -> f64 {
    let mut lateral = point.c.0[1].sqrt();
    let strain = |lateral: f64| SymmetricTensor2([axial * axial, lateral * lateral, lateral * lateral, 0.0, 0.0, 0.0]);
    for _ in 0..60 {
        let law = point.law(1.0, StepStress::End);
        let (s, cc) = law.stress_and_elasticity(&strain(lateral)).unwrap();
        // dS_22 = (CC_2222 + CC_2233) lateral dlateral
        let slope = (cc.0[1][1] + cc.0[1][2]) * lateral;
        let change = s.0[1] / slope;
        lateral -= change;
        if change.abs() < 1e-15 {
            break;
        }
    }
    let c = strain(lateral);
    let s = point.law(1.0, StepStress::End).stress(&c).unwrap();
    assert!(s.0[1].abs() < 1e-8, "lateral stress {}", s.0[1]);
    point.go(c, 1.0, StepStress::End);
    s.0[0] * axial * axial
}

#[test]
fn uniaxial_tension() {
    // t = sigma_y(a) + H_k a and t/E + a = 0.5, solved by bisection; proportional, so that one step is as exact as a hundred.
    assert!((young() - 206_899.942).abs() < 1e-3);
    for (hardening, kinematic, known) in [
        (Hardening::linear(450.0, 1000.0), 0.0, [945.430_494_152, 0.495_430_494_152]),
        (voce(), 0.0, [779.073_836_355, 0.496_234_538_157]),
        (table(), 0.0, [699.248_967_119, 0.496_620_352_036]),
        (Hardening::linear(450.0, 0.0), 1000.0, [945.430_494_152, 0.495_430_494_152]),
    ] {
        let (mut low, mut high) = (0.0, 0.5);
        for _ in 0..80 {
            let a = 0.5 * (low + high);
            let stress = hardening.at(a).0 + kinematic * a;
            if stress / young() + a < 0.5 { low = a } else { high = a }
        }
        let stress = hardening.at(low).0 + kinematic * low;
        assert!((stress - known[0]).abs() < 1e-8 && (low - known[1]).abs() < 1e-11);
        let material = metal(hardening, kinematic, None);
        for steps in [1, 100] {
            let mut point = Point::new(&material);
            let mut found = 0.0;
            for i in 1..=steps {
                found = uniaxial(&mut point, (0.5 * f64::from(i) / f64::from(steps)).exp());
            }
            assert!((found - stress).abs() < 1e-7, "{steps} steps: {found} {stress}");
            assert!((point.state[6] - low).abs() < 1e-11, "{steps} steps: {}", point.state[6]);
        }
    }
}

#[test]
fn reversal() {
    // The yield stress of a reversal: as high as it was (isotropic), or 2 s0 below (kinematic).
    for (isotropic, kinematic, turns, reversal) in [
        (1000.0, 0.0, [467.7393, -503.0472, 538.0155], -467.7393),
        (0.0, 1000.0, [467.7393, -467.7393, 467.7393], 467.7393 - 900.0),
    ] {
        let material = metal(Hardening::linear(450.0, isotropic), kinematic, None);
        let mut point = Point::new(&material);
        let mut first = None;
        for (half, (from, to)) in [(0.0, 0.02), (0.02, -0.02), (-0.02, 0.02)].into_iter().enumerate() {
            let mut stress = 0.0;
            for i in 1..=400 {
                let before = point.state[6];
                stress = uniaxial(&mut point, (from + (to - from) * f64::from(i) / 400.0_f64).exp());
                if half == 1 && first.is_none() && point.state[6] > before {
                    first = Some(stress);
                }
            }
            assert!((stress - turns[half]).abs() < 1e-3, "{half}: {stress}");
        }
        // Within one step of the strain, which is 21 MPa elastically.
        let first = first.unwrap();
        assert!((first - reversal).abs() < 1.0, "yields at {first}, expected {reversal}");
    }
}

/// Kirchhoff shear stress at some shears of a path in simple shear, 100 steps a unit.
fn shear(material: &Inelastic, at: &[f64]) -> Vec<f64> {
    let mut point = Point::new(material);
    let mut out = Vec::new();
    for i in 1..=600 {
        let g = 0.01 * f64::from(i);
        let f = Tensor2::new(1.0, g, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        let c = SymmetricTensor2::right_cauchy_green(&f);
        let s = point.law(1.0, StepStress::End).stress(&c).unwrap().to_matrix();
        let kirchhoff = f * s * f.transpose();
        point.go(c, 1.0, StepStress::End);
        if at.iter().any(|a| (a - g).abs() < 1e-9) {
            out.push(kirchhoff[(0, 1)]);
        }
    }
    out
}

#[test]
fn large_simple_shear() {
    // Perfect plasticity: the yield stress over sqrt 3, less the normal stresses of the elastic part, at any shear.
    let gammas = [0.5, 1.0, 2.0, 3.0, 6.0];
    let perfect = shear(&metal(Hardening::linear(450.0, 0.0), 0.0, None), &gammas);
    for stress in &perfect {
        assert!((stress - 259.799).abs() < 0.01, "{perfect:?}");
    }
    // Isotropic hardening: sigma_y(gamma / sqrt 3)/sqrt 3 to the accuracy of steps of 1 % and of the elastic strain.
    for (stress, g) in shear(&metal(voce(), 0.0, None), &gammas).iter().zip(gammas) {
        let closed = voce().at(g / 3_f64.sqrt()).0 / 3_f64.sqrt();
        assert!((stress / closed - 1.0).abs() < 0.01, "{g}: {stress} {closed}");
    }
    // Kinematic hardening grows without oscillation (the plastic spin): values of an independent program in Python.
    let kinematic = shear(&metal(Hardening::linear(450.0, 0.0), 500.0, None), &gammas);
    for (stress, expected) in kinematic.iter().zip([339.2, 403.7, 488.5, 558.4, 842.1]) {
        assert!((stress - expected).abs() < 0.06, "{kinematic:?}");
    }
}

/// Two branches, (1, 1 s) and (0.5, 10 s), and next to nothing of an elastic law beside them.
fn branches() -> Inelastic {
    let all = 1.5 / (1.0 - 1e-9);
    let law: Arc<dyn HyperelasticLaw> = Arc::new(Hencky::new(100.0, all).unwrap());
    Inelastic::viscous(&law, &[(1.0 / all, 1.0), (0.5 / all, 10.0)], Moduli::Instantaneous).unwrap()
}

fn isochoric(log: f64) -> SymmetricTensor2 {
    let l = log.exp();
    SymmetricTensor2([l * l, 1.0 / l, 1.0 / l, 0.0, 0.0, 0.0])
}

/// Kirchhoff stress along the axis less that across.
fn difference(s: &SymmetricTensor2, c: &SymmetricTensor2) -> f64 {
    s.0[0] * c.0[0] - s.0[1] * c.0[1]
}

#[test]
fn relaxation_and_constant_rate() {
    let material = branches();
    // At once to a stretch of 1.5, then hold for 2 s: 3 ln 1.5 (e^-2 + 0.5 e^-0.2), at any step.
    for steps in [4, 40] {
        let mut point = Point::new(&material);
        let c = isochoric(1.5_f64.ln());
        point.go(c, 1e-12, StepStress::End);
        let start = point.stored();
        let (mut stress, mut lost) = (SymmetricTensor2::ZERO, 0.0);
        for _ in 0..steps {
            let dt = 2.0 / f64::from(steps);
            stress = point.law(dt, StepStress::End).stress(&c).unwrap();
            lost += point.go(c, dt, StepStress::End);
        }
        let closed = 3.0 * 1.5_f64.ln() * ((-2.0_f64).exp() + 0.5 * (-0.2_f64).exp());
        assert!((closed - 0.662_571_335_707).abs() < 1e-11);
        assert!((difference(&stress, &c) - closed).abs() < 1e-8, "{}", difference(&stress, &c));
        assert!((point.stored() + lost - start).abs() < 1e-12 * start);
    }
    // A constant rate of ln l, 0.2/s, for 2 s: stress, and work by the discrete gradient, at any step.
    for steps in [4, 40] {
        let (mut point, mut other) = (Point::new(&material), Point::new(&material));
        let dt = 2.0 / f64::from(steps);
        let (mut work, mut lost, mut q) = (0.0, 0.0, 0.0);
        for i in 1..=steps {
            let c = isochoric(0.2 * dt * f64::from(i));
            let law = point.law(dt, StepStress::DiscreteGradient);
            let s = energy_momentum_stress(&law, &point.c, law.energy(&point.c).unwrap(), &c).unwrap();
            work += 0.5 * s.double_contract(&(c - point.c));
            lost += point.go(c, dt, StepStress::DiscreteGradient);
            q = difference(&other.law(dt, StepStress::End).stress(&c).unwrap(), &c);
            other.go(c, dt, StepStress::End);
        }
        assert!((q - 1.062_606_570_824).abs() < 1e-8, "{q}");
        assert!((work - 0.248_624_752_456).abs() < 1e-8, "{work}");
        assert!((point.stored() + lost - work).abs() < 1e-13);
    }
}

#[test]
fn creep() {
    // Neo-Hooke (mu 1) with a branch (1, 1 s), a constant stress difference of 3e-6: 1e-6 (1 - e^(-t/2)/2), to first order in the step.
    let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::new(100.0, 2.0).unwrap());
    let material = Inelastic::viscous(&law, &[(0.5, 1.0)], Moduli::Instantaneous).unwrap();
    for (dt, expected) in [(0.1_f64, 8.160_217e-7), (0.01, 8.160_596e-7)] {
        let mut point = Point::new(&material);
        let mut log = 0.0;
        let steps = (2.0 / dt).round() as usize;
        for i in 0..=steps {
            let h = if i == 0 { 1e-12 } else { dt };
            for _ in 0..40 {
                let c = isochoric(log);
                log += (3e-6 - difference(&point.law(h, StepStress::End).stress(&c).unwrap(), &c)) / 6.0;
            }
            point.go(isochoric(log), h, StepStress::End);
        }
        let closed = 1e-6 * (1.0 - 0.5 * (-1.0_f64).exp());
        assert!((log - expected).abs() < 1e-12 && (log / closed - 1.0).abs() < 1e-3 * dt, "{log} {expected} {closed}");
    }
}

#[test]
fn a_branch_that_relaxes_within_the_step_is_a_fluid() {
    // tau << h: stress mu tau times twice the rate, no oscillation from step to step.
    let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::new(100.0, 1.0).unwrap());
    let material = Inelastic::viscous(&law, &[(0.9, 1e-9)], Moduli::Instantaneous).unwrap();
    let mut point = Point::new(&material);
    for i in 1..=5 {
        let c = isochoric(0.1 * f64::from(i));
        let law = point.law(1.0, StepStress::DiscreteGradient);
        let s = energy_momentum_stress(&law, &point.c, law.energy(&point.c).unwrap(), &c).unwrap();
        let lost = point.go(c, 1.0, StepStress::DiscreteGradient);
        // e' = 0.1 (1, -1/2, -1/2): D = 2 mu tau e':e' dt
        let expected = 2.0 * 0.9 * 1e-9 * 0.01 * 1.5;
        assert!(s.norm() < 1.0 && (lost / expected - 1.0).abs() < 1e-6, "{lost:e} {expected:e}");
    }
}

#[test]
fn moduli_are_those_that_were_given() {
    let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::from_young_poisson(2.1, 0.49).unwrap());
    let given = law.small_strain_moduli();
    for (moduli, shear) in [(Moduli::Instantaneous, given.shear), (Moduli::LongTerm, 2.0 * given.shear)] {
        let material = Inelastic::viscous(&law, &[(0.3, 1e-3), (0.2, 0.1)], moduli).unwrap();
        let found = material.small_strain_moduli();
        assert!((found.shear - shear).abs() < 1e-14 && (found.bulk - given.bulk).abs() < 1e-12 * given.bulk);
        stoss_testkit::laws::battery(&material, 1e-12);
        // Relaxed: the long-term shear modulus, and the same bulk modulus.
        let mut point = Point::new(&material);
        let c = SymmetricTensor2([1.0, 1.0, 1.0, 1e-7, 0.0, 0.0]);
        point.go(c, 1e9, StepStress::End);
        let s = point.law(0.0, StepStress::Frozen).stress(&c).unwrap();
        let long = if moduli == Moduli::Instantaneous { 0.5 * given.shear } else { given.shear };
        assert!((s.0[3] / (1e-7 * long) - 1.0).abs() < 1e-6, "{}", s.0[3]);
    }
}

#[test]
fn virgin_metals_are_henckys() {
    let law = Hencky::from_young_poisson(206_900.0, 0.29).unwrap();
    stoss_testkit::laws::battery(&law, 1e-12);
    let material = metal(voce(), 0.0, None);
    stoss_testkit::laws::battery(&material, 1e-12);
    assert!(material.history().is_some() && law.history().is_none());
    let names: Vec<&str> = material.state().iter().map(|entry| entry.name.as_str()).collect();
    assert_eq!(names, ["plastic_map", "equivalent_plastic_strain"]);
    assert_eq!(metal(voce(), 1.0, None).state_len(), 13);
}

/// Isochoric uniaxial stretch of neo-Hooke with one family of fibres: `t1 - t3 = mu (l^2 - 1/l) + 2 W' (d (l^2 - 1/l) + (1 - 3 d) m)` with `W' = k1 E exp(k2 E^2)`,
/// `E = d (l^2 + 2/l - 3) + (1 - 3 d) (n - 1)`; along the fibres `n = m = l^2`, across (in the direction of 2) `n = 1/l`, `m = 0`. Fibres that are pressed carry nothing.
#[test]
fn fibres_carry_as_they_lie() {
    let (mu, k1, k2) = (MU, 2.0 * MU, 3.0);
    let law: Arc<dyn HyperelasticLaw> = Arc::new(NeoHooke::new(BULK, mu).unwrap());
    for d in [0.0, 0.2, 1.0 / 3.0] {
        for (direction, along) in [([2.0, 0.0, 0.0], true), ([0.0, 0.5, 0.0], false)] {
            let fibres = Fibres { stiffness: k1, exponent: k2, dispersion: d };
            let material = Inelastic::fibrous(&law, fibres, &[direction]).unwrap();
            for l in [0.8, 0.95, 1.0, 1.1, 1.3_f64] {
                let c = SymmetricTensor2([l * l, 1.0 / l, 1.0 / l, 0.0, 0.0, 0.0]);
                let s = Point::new(&material).law(1.0, StepStress::End).stress(&c).unwrap();
                let found = l * l * s.0[0] - s.0[2] / l;
                let (n, m) = if along { (l * l, l * l) } else { (1.0 / l, 0.0) };
                let e = d * (l * l + 2.0 / l - 3.0) + (1.0 - 3.0 * d) * (n - 1.0);
                let slope = k1 * e.max(0.0) * (k2 * e * e).exp();
                let difference = l * l - 1.0 / l;
                let expected = mu * difference + 2.0 * slope * (d * difference + (1.0 - 3.0 * d) * m);
                assert!((found - expected).abs() < 1e-11 * mu, "{d} {along} {l}: {found} {expected}");
            }
        }
    }
}
