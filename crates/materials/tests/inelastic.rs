//! Laws of a step along random paths: derivatives against differences, the balance of work, stored energy and loss, objectivity (theory/inelastic).

use proptest::prelude::*;
use std::sync::Arc;
use stoss_continuum::{
    HyperelasticLaw, Material, PointStep, StepLaw, StepStress, SymmetricTensor2, Tensor2, energy_momentum_stress,
    energy_momentum_stress_and_tangent,
};
use stoss_materials::{Fibres, Hardening, Hencky, Inelastic, Moduli, Mullins, NeoHooke, Overstress, Plasticity};

pub const BULK: f64 = 164_206.0;
pub const MU: f64 = 80_193.8;

pub fn metal(hardening: Hardening, kinematic: f64, overstress: Option<Overstress>) -> Inelastic {
    let law = Hencky::new(BULK - 2.0 / 3.0 * MU, MU).unwrap();
    Inelastic::plastic(law, Plasticity { hardening, kinematic, overstress }).unwrap()
}

pub fn voce() -> Hardening {
    Hardening::Voce { s0: 450.0, h: 129.24, saturation: 715.0, rate: 16.93 }
}

pub fn table() -> Hardening {
    Hardening::Table(vec![(0.0, 450.0), (0.01, 500.0), (0.05, 600.0), (0.5, 700.0)])
}

fn rubber() -> Arc<dyn HyperelasticLaw> {
    Arc::new(NeoHooke::new(BULK - 2.0 / 3.0 * MU, MU).unwrap())
}

/// Directions of two families.
const ALONG: [[f64; 3]; 2] = [[0.6, 0.8, 0.0], [0.0, -0.6, 0.8]];
const DISPERSION: f64 = 0.1;

fn fibres() -> Fibres {
    Fibres { stiffness: 0.5 * MU, exponent: 2.0, dispersion: DISPERSION }
}

/// A material, and whether its loss is known in closed form.
pub fn materials() -> Vec<(&'static str, Inelastic)> {
    let overstress = |exponent| Some(Overstress { stress: 200.0, rate: 1.0, exponent });
    let prony = [(0.4, 0.01), (0.2, 0.3), (0.1, 1e-5)];
    vec![
        ("perfect", metal(Hardening::linear(450.0, 0.0), 0.0, None)),
        ("voce", metal(voce(), 0.0, None)),
        ("table", metal(table(), 0.0, None)),
        ("kinematic", metal(Hardening::linear(450.0, 0.0), 2000.0, None)),
        ("voce and kinematic", metal(voce(), 2000.0, None)),
        ("overstress", metal(voce(), 500.0, overstress(0.3))),
        ("linear overstress", metal(voce(), 0.0, overstress(1.0))),
        ("maxwell", Inelastic::viscous(&rubber(), &prony, Moduli::Instantaneous).unwrap()),
        ("softening", Inelastic::softening(&rubber(), Mullins { r: 1.5, m: 0.02 * MU, beta: 0.1 }).unwrap()),
        (
            "maxwell and softening",
            Inelastic::viscous(&rubber(), &prony, Moduli::LongTerm)
                .unwrap()
                .with_softening(Mullins { r: 2.0, m: 0.01 * MU, beta: 0.0 })
                .unwrap(),
        ),
        ("fibres", Inelastic::fibrous(&rubber(), fibres(), &ALONG).unwrap()),
        (
            "maxwell and fibres",
            Inelastic::viscous(&rubber(), &prony, Moduli::Instantaneous)
                .unwrap()
                .with_fibres(fibres(), &ALONG[..1])
                .unwrap(),
        ),
    ]
}

/// A material in a point that goes along a path.
pub struct Point<'a> {
    pub material: &'a Inelastic,
    pub state: Vec<f64>,
    pub c: SymmetricTensor2,
}

impl<'a> Point<'a> {
    pub fn new(material: &'a Inelastic) -> Self {
        let mut state = vec![0.0; material.state_len()];
        material.virgin(&mut state);
        Self { material, state, c: SymmetricTensor2::IDENTITY }
    }

    pub fn law(&self, dt: f64, stress: StepStress) -> StepLaw<'_> {
        StepLaw { material: self.material, at: PointStep { state: &self.state, dt, stress } }
    }

    pub fn stored(&self) -> f64 {
        self.law(0.0, StepStress::Frozen).energy(&self.c).unwrap()
    }

    /// Goes to `c`, and says what was lost.
    pub fn go(&mut self, c: SymmetricTensor2, dt: f64, stress: StepStress) -> f64 {
        let mut next = self.state.clone();
        let at = PointStep { state: &self.state, dt, stress };
        let loss = self.material.commit(&at, &self.c, &c, &mut next).unwrap();
        self.state = next;
        self.c = c;
        loss.total()
    }

    /// What jumps where the law of the step has a kink in its stress (elastic or not, the segment of the table), and the increment of the plastic strain.
    fn piece(&self, c: &SymmetricTensor2, dt: f64) -> ((bool, usize), f64) {
        let mut next = self.state.clone();
        let at = PointStep { state: &self.state, dt, stress: StepStress::End };
        self.material.commit(&at, &self.c, c, &mut next).unwrap();
        if self.material.state().iter().any(|entry| entry.name == "fibre_direction_1") {
            // Which families carry: those whose mean isochoric stretch is above 1.
            let carries = ALONG.map(|a| {
                let m = c.to_matrix();
                let along: f64 =
                    (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).map(|(i, j)| a[i] * m[(i, j)] * a[j]).sum();
                c.det().cbrt().recip() * (DISPERSION * c.trace() + (1.0 - 3.0 * DISPERSION) * along) > 1.0
            });
            return ((carries[0], usize::from(carries[1])), 0.0);
        }
        match self.material.state()[0].name.as_str() {
            "plastic_map" => {
                let segment = [0.01, 0.05, 0.5].iter().filter(|a| **a < next[6]).count();
                ((next[6] > self.state[6], segment), next[6] - self.state[6])
            }
            "largest_energy" => ((next[0] > self.state[0], 0), 0.0),
            _ => ((false, 0), 0.0),
        }
    }

    /// Whether differences over this interval see one smooth function. Behind a kink an overstress has steep powers of the increment.
    fn smooth_between(&self, a: &SymmetricTensor2, b: &SymmetricTensor2, dt: f64) -> bool {
        let ((a, x), (b, y)) = (self.piece(a, dt), self.piece(b, dt));
        a == b && (x - y).abs() <= 0.05 * x.max(y)
    }
}

fn admissible(c: &SymmetricTensor2) -> bool {
    let values = stoss_continuum::principal_values(c);
    values.iter().all(|x| (0.2..8.0).contains(x))
}

/// Sizes of increments of strain, increments, times.
fn path() -> impl Strategy<Value = (f64, Vec<([f64; 6], f64, [f64; 6])>)> {
    let unit = || proptest::array::uniform6(-1.0..1.0_f64);
    (-5.0..-0.5_f64, proptest::collection::vec((unit(), -4.0..0.0_f64, unit()), 8))
        .prop_map(|(size, steps)| (10f64.powf(size), steps))
}

fn difference(f: &dyn Fn(f64) -> SymmetricTensor2, h: f64) -> SymmetricTensor2 {
    ((f(h) - f(-h)) * 8.0 - (f(2.0 * h) - f(-2.0 * h))) * (1.0 / (12.0 * h))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn stress_and_moduli_are_derivatives((size, steps) in path()) {
        for (name, material) in materials() {
            let mut point = Point::new(&material);
            for (increment, power, direction) in &steps {
                let (c0, c1) = (point.c, point.c + SymmetricTensor2(*increment) * size);
                if !admissible(&c1) {
                    break;
                }
                let (dt, d) = (10f64.powf(*power), SymmetricTensor2(*direction));
                let h = 1e-3 * size.min(0.01);
                let at = |t: f64| c1 + d * t;
                for stress in [StepStress::DiscreteGradient, StepStress::End, StepStress::Frozen] {
                    let law = point.law(dt, stress);
                    let smooth = point.smooth_between(&at(-2.0 * h), &at(2.0 * h), dt);
                    let (s, moduli) = law.stress_and_elasticity(&c1).unwrap();
                    prop_assert_eq!(law.energy_and_stress(&c1).unwrap().1, law.stress(&c1).unwrap());
                    prop_assert!((law.stress(&c1).unwrap() - s).norm() <= 1e-12 * MU, "{}", name);
                    prop_assert!((moduli + moduli.major_transpose() * -1.0).max_abs() < 1e-10 * MU, "{name}: symmetry");
                    if !smooth {
                        continue;
                    }
                    let w = |t: f64| law.energy(&at(t)).unwrap();
                    let slope = (8.0 * (w(h) - w(-h)) - (w(2.0 * h) - w(-2.0 * h))) / (12.0 * h);
                    let error = (slope - 0.5 * s.double_contract(&d)).abs() / (s.norm() + 1e-3 * MU);
                    // Round-off of the energy, that of the stress times that of the strain, over the length of the difference.
                    let room = 1e-9 + 4e-16 * (w(0.0).abs() + s.norm()) / h / (s.norm() + 1e-3 * MU);
                    prop_assert!(error < room, "{name} {stress:?}: stress {error:e} {room:e} {size:e}");
                    let found = difference(&|t| law.stress(&at(t)).unwrap(), h);
                    let error = (found - moduli.double_contract_right(&(d * 0.5))).norm() / MU;
                    let room = 1e-7 + (4e-15 * s.norm() / MU + 1e-15) / h;
                    prop_assert!(error < room, "{name} {stress:?}: moduli {error:e} {size:e}");
                }
                // The stress of the step and its tangent.
                let law = point.law(dt, StepStress::DiscreteGradient);
                let w0 = law.energy(&c0).unwrap();
                let (_, tangent) = energy_momentum_stress_and_tangent(&law, &c0, w0, &c1).unwrap();
                let mean = |t: f64| (c0 + at(t)) * 0.5;
                let smooth = point.smooth_between(&at(-2.0 * h), &at(2.0 * h), dt)
                    && point.smooth_between(&mean(-2.0 * h), &mean(2.0 * h), dt);
                if smooth && (c1 - c0).norm() > 1e-5 {
                    let found = difference(&|t| energy_momentum_stress(&law, &c0, w0, &at(t)).unwrap(), h);
                    let error = (found - tangent.double_contract_right(&(d * 0.5))).norm() / MU;
                    // Round-off of the energy, that of the stress times that of the strain, over both increments.
                    let (w, s) = law.energy_and_stress(&c1).unwrap();
                    let noise = 2e-15 * (w.abs() + s.norm()) / (c1 - c0).norm() / h / MU;
                    prop_assert!(error < 1e-7 + noise, "{name}: tangent of the step {error:e} {size:e}");
                }
                point.go(c1, dt, StepStress::DiscreteGradient);
            }
        }
    }

    #[test]
    fn work_is_stored_or_lost((size, steps) in path()) {
        for (name, material) in materials() {
            let mut point = Point::new(&material);
            for (increment, power, _) in &steps {
                let (c0, c1, dt) = (point.c, point.c + SymmetricTensor2(*increment) * size, 10f64.powf(*power));
                if !admissible(&c1) {
                    break;
                }
                let law = point.law(dt, StepStress::DiscreteGradient);
                let s = energy_momentum_stress(&law, &c0, law.energy(&c0).unwrap(), &c1).unwrap();
                let work = 0.5 * s.double_contract(&(c1 - c0));
                let before = point.stored();
                let lost = point.go(c1, dt, StepStress::DiscreteGradient);
                let after = point.stored();
                let scale = MU * (c1 - SymmetricTensor2::IDENTITY).norm().max((c0 - SymmetricTensor2::IDENTITY).norm());
                let gap = (work - (after - before) - lost).abs() / scale;
                prop_assert!(gap < 1e-14, "{name}: {gap:e} for increments of {size:e}");
                prop_assert!(lost >= -1e-15 * scale, "{name}: lost {lost:e} of {scale:e}");
                // The maps keep their determinant.
                let mut at = 0;
                for entry in material.state() {
                    if entry.name.contains("map") {
                        let map = SymmetricTensor2(std::array::from_fn(|i| point.state[at + i]));
                        prop_assert!((map.det() - 1.0).abs() < 4e-14, "{name}: det G - 1 = {:e}", map.det() - 1.0);
                    }
                    at += entry.len;
                }
            }
        }
    }

    #[test]
    fn the_stress_of_an_accepted_step_is_that_of_its_state((size, steps) in path()) {
        // End of a step by the law of its end: the same stress as that of the accepted state, where the flow has the axes of the strain. (Otherwise they
        // differ to second order in the step.)
        let coaxial = ["perfect", "voce", "table", "linear overstress", "softening"];
        for (name, material) in materials().into_iter().filter(|(name, _)| coaxial.contains(name)) {
            let mut point = Point::new(&material);
            for (increment, power, _) in &steps {
                let (c1, dt) = (point.c + SymmetricTensor2(*increment) * size, 10f64.powf(*power));
                if !admissible(&c1) {
                    break;
                }
                let of_step = point.law(dt, StepStress::End).stress(&c1).unwrap();
                let lost = point.go(c1, dt, StepStress::End);
                let of_state = point.law(0.0, StepStress::Frozen).stress(&c1).unwrap();
                let scale = of_step.norm().max(1e-2 * MU);
                prop_assert!((of_step - of_state).norm() < 1e-12 * scale, "{name}: {:e}", (of_step - of_state).norm() / scale);
                prop_assert!(lost >= -1e-15 * MU);
            }
        }
    }

    #[test]
    fn rotated_paths_give_rotated_answers((size, steps) in path(), q in stoss_testkit::strategies::rotation()) {
        // All laws are isotropic but for their fibres: a path in turned reference axes, with turned fibres, has turned stresses.
        for (name, material) in materials() {
            let (mut one, mut other) = (Point::new(&material), Point::new(&material));
            let mut at = 0;
            for entry in material.state() {
                if entry.name.starts_with("fibre") {
                    let a: Vec<f64> = (0..3).map(|i| (0..3).map(|j| q[(i, j)] * one.state[at + j]).sum()).collect();
                    other.state[at..at + 3].copy_from_slice(&a);
                }
                at += entry.len;
            }
            let turn = |a: &SymmetricTensor2, q: &Tensor2| a.rotated(q);
            for (increment, power, _) in &steps {
                let (c1, dt) = (one.c + SymmetricTensor2(*increment) * size, 10f64.powf(*power));
                if !admissible(&c1) {
                    break;
                }
                let stress = |point: &Point<'_>, c1: &SymmetricTensor2| {
                    let law = point.law(dt, StepStress::DiscreteGradient);
                    energy_momentum_stress(&law, &point.c, law.energy(&point.c).unwrap(), c1).unwrap()
                };
                let turned = turn(&c1, &q);
                let (a, b) = (turn(&stress(&one, &c1), &q), stress(&other, &turned));
                prop_assert!((a - b).norm() < 1e-9 * MU, "{name}: {:e}", (a - b).norm() / MU);
                one.go(c1, dt, StepStress::DiscreteGradient);
                other.go(turned, dt, StepStress::DiscreteGradient);
            }
        }
    }
}

#[test]
fn ten_thousand_cycles_do_not_drift() {
    // Stretch and shear with turning axes: the balance of all work, and the determinants of the maps.
    for (name, material) in materials() {
        let mut point = Point::new(&material);
        let (mut work, mut lost) = (0.0, 0.0);
        let steps = 10_000;
        for i in 1..=steps {
            let t = 0.37 * f64::from(i);
            let (a, g) = (0.03 * t.sin(), 0.05 * (1.3 * t).cos());
            let f = Tensor2::new(1.0 + a, g, 0.0, 0.2 * g, 1.0 - 0.4 * a, 0.1 * a, 0.0, -0.3 * g, 1.0 - 0.5 * a);
            let c1 = SymmetricTensor2::right_cauchy_green(&f);
            let law = point.law(0.01, StepStress::DiscreteGradient);
            let s = energy_momentum_stress(&law, &point.c, law.energy(&point.c).unwrap(), &c1).unwrap();
            work += 0.5 * s.double_contract(&(c1 - point.c));
            lost += point.go(c1, 0.01, StepStress::DiscreteGradient);
        }
        let gap = (work - lost - point.stored()).abs() / lost.max(1.0);
        assert!(gap < 1e-12, "{name}: {gap:e} of {lost}");
        let mut at = 0;
        for entry in material.state() {
            if entry.name.contains("map") {
                let det = SymmetricTensor2(std::array::from_fn(|i| point.state[at + i])).det();
                assert!((det - 1.0).abs() < 1e-11, "{name}: {}: det G - 1 = {:e}", entry.name, det - 1.0);
            }
            at += entry.len;
        }
    }
}
