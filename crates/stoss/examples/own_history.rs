//! A material with a state of one's own, used from a scene: neo-Hooke's law that has softened where it was stretched before.
//!
//! Shown: the trait `Material` beside `HyperelasticLaw`, a constructor that reads the parameters of a scene, a run with the law.
//! Checked: stress and moduli against differences, work is stored or lost along a path of steps, energy and loss of a cube that flies.
//!
//! `cargo run --example own_history -p stoss`; docs/how-to-add/material-law.md explains it.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use stoss::build::{LawParameters, LawResult, OwnLaws, ParameterError, build_with};
use stoss::continuum::{
    ConstitutiveError, HyperelasticLaw, Loss, Material, Mechanisms, PointStep, Response, SmallStrainModuli, StateEntry,
    StateOutput, StepLaw, StepStress, SymmetricTensor2, Tensor4, Want, energy_momentum_stress,
};
use stoss::materials::NeoHooke;
use stoss::scene::parse_with;

/// With the energy `W` of neo-Hooke's law and the largest one so far, `M`: `w = (1 - part) W + part W^2/(2 M)` below `M`, and `W - part M/2` above, whose slope
/// `eta = dw/dW` goes from `1 - part` at rest to 1 at `M`.
#[derive(Debug)]
pub struct Softer {
    law: NeoHooke,
    /// What is lost of the stiffness at rest, from 0 up to below 1.
    part: f64,
    entries: Vec<StateEntry>,
    outputs: Vec<StateOutput>,
}

impl Softer {
    fn new(law: NeoHooke, part: f64) -> Self {
        let about = "Largest energy per volume so far.";
        let entry = StateEntry { name: "largest_energy".into(), len: 1, about };
        let outputs = vec![StateOutput { entry: entry.clone(), jumps: false }];
        Self { law, part, entries: vec![entry], outputs }
    }

    /// `w`, `dw/dW` and its slope.
    fn curve(&self, energy: f64, largest: f64) -> [f64; 3] {
        if energy >= largest {
            return [energy - 0.5 * self.part * largest, 1.0, 0.0];
        }
        let reached = energy / largest;
        let w = energy * (1.0 - self.part + 0.5 * self.part * reached);
        [w, 1.0 - self.part + self.part * reached, self.part / largest]
    }

    /// A virgin point, which is neo-Hooke's law.
    fn virgin_law(&self) -> StepLaw<'_> {
        StepLaw { material: self, at: PointStep { state: &[0.0], dt: 0.0, stress: StepStress::Frozen } }
    }
}

impl Material for Softer {
    fn state(&self) -> &[StateEntry] {
        &self.entries
    }
    fn virgin(&self, state: &mut [f64]) {
        state[0] = 0.0;
    }
    // No rate and no flow: the function of the step is the same for all three questions.
    fn respond(&self, at: &PointStep<'_>, c: &SymmetricTensor2, want: Want) -> Result<Response, ConstitutiveError> {
        let energy = self.law.energy(c)?;
        let [w, eta, slope] = self.curve(energy, at.state[0]);
        let mut out = Response { energy: w, stress: SymmetricTensor2::ZERO, moduli: Tensor4::ZERO };
        if want == Want::Moduli {
            let (stress, moduli) = self.law.stress_and_elasticity(c)?;
            out.stress = stress * eta;
            out.moduli = moduli * eta;
            out.moduli.add_dyad(slope, &stress, &stress);
        } else if want == Want::Stress {
            out.stress = self.law.stress(c)? * eta;
        }
        Ok(out)
    }
    fn commit(
        &self,
        at: &PointStep<'_>,
        _c_n: &SymmetricTensor2,
        c_np1: &SymmetricTensor2,
        next: &mut [f64],
    ) -> Result<Loss, ConstitutiveError> {
        let (energy, largest) = (self.law.energy(c_np1)?, at.state[0]);
        next[0] = energy.max(largest);
        // What the step took, less what the point gives back: w(W; M_n) - w(W; M_np1).
        Ok(Loss { softening: 0.5 * self.part * (next[0] - largest), ..Loss::default() })
    }
    fn mechanisms(&self) -> Mechanisms {
        Mechanisms { softening: true, ..Mechanisms::default() }
    }
    fn outputs(&self) -> &[StateOutput] {
        &self.outputs
    }
    fn output(&self, _before: &[f64], state: &[f64], out: &mut [f64]) {
        out.copy_from_slice(state);
    }
}

impl HyperelasticLaw for Softer {
    fn name(&self) -> &str {
        "softer"
    }
    fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        self.virgin_law().energy(c)
    }
    fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        self.virgin_law().stress(c)
    }
    fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        self.virgin_law().stress_and_elasticity(c)
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        self.law.small_strain_moduli()
    }
    fn history(&self) -> Option<&dyn Material> {
        Some(self)
    }
}

/// The law from `material = { law = "softer", young = .., poisson = .., part = .. }`.
pub fn softer(parameters: &LawParameters<'_>) -> LawResult {
    let law = NeoHooke::from_young_poisson(parameters.number("young")?, parameters.number("poisson")?)?;
    let part = parameters.number("part")?;
    if !(0.0..1.0).contains(&part) {
        return Err(ParameterError::new("part", "must be from 0 up to below 1", "write for instance 0.4").into());
    }
    Ok(Arc::new(Softer::new(law, part)))
}

/// The names that scenes may use.
pub fn laws() -> OwnLaws {
    OwnLaws::default().with("softer", softer).expect("the catalogue has no law of this name")
}

/// A cube that flies, turns and vibrates.
pub const FLYING: &str = r#"
[scene]
title = "flying"
kind = "dynamic"

[time]
end = 0.3
step = 0.02
integrator = { scheme = "energy-momentum" }

[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }
material = { law = "softer", young = 2250.0, poisson = 0.3, part = 0.4 }
density = 10.0
angular_velocity = [1.0, 2.0, 3.0]
velocity_gradient = [[0, 0, 0], [0, 0, 0], [0, 0, 4]]

[output]
every = 100
"#;

/// Largest error of stress and moduli against differences below and above the largest energy, relative: `S : D = 2 dw`, `CC : D = 2 dS`.
fn derivatives(law: &Softer) -> Result<f64, ConstitutiveError> {
    let c = SymmetricTensor2([1.3, 0.8, 1.1, 0.2, -0.1, 0.15]);
    let mut worst = 0.0_f64;
    for largest in [0.3, 3.0].map(|factor| law.law.energy(&c).map(|w| factor * w)) {
        let state = [largest?];
        let at = StepLaw { material: law, at: PointStep { state: &state, dt: 1.0, stress: StepStress::End } };
        let (stress, moduli) = at.stress_and_elasticity(&c)?;
        let h = 1e-5;
        for component in 0..6 {
            let mut direction = SymmetricTensor2([0.0; 6]);
            direction.0[component] = 1.0;
            let [plus, minus] = [c + direction * h, c - direction * h];
            let energy = (at.energy(&plus)? - at.energy(&minus)?) / h;
            worst = worst.max((energy - stress.double_contract(&direction)).abs() / stress.norm());
            let difference = (at.stress(&plus)? - at.stress(&minus)?) * (1.0 / h);
            let tangent = moduli.double_contract_right(&direction);
            worst = worst.max((difference - tangent).norm() / tangent.norm());
        }
    }
    Ok(worst)
}

/// Largest difference of the work of a step and what was stored and lost in it, over the work of all; and the least loss.
fn balance(law: &Softer) -> Result<[f64; 2], ConstitutiveError> {
    let mut state = [0.0];
    let (mut c_n, mut worst, mut least, mut all) = (SymmetricTensor2::IDENTITY, 0.0_f64, 0.0_f64, 0.0);
    for step in 1..=200 {
        let t = 0.1 * f64::from(step);
        let (a, b) = (0.002 * t * t.sin(), 0.05 * (1.7 * t).cos() - 0.05);
        let c_np1 = SymmetricTensor2([1.0 + a, 1.0 - 0.3 * a, 1.0 + 0.2 * b, b, 0.5 * a, 0.1 * b]);
        let at = PointStep { state: &state, dt: 0.1, stress: StepStress::DiscreteGradient };
        let of_step = StepLaw { material: law, at };
        let stress = energy_momentum_stress(&of_step, &c_n, of_step.energy(&c_n)?, &c_np1)?;
        let work = 0.5 * stress.double_contract(&(c_np1 - c_n));
        let stored = |state: &[f64], c: &SymmetricTensor2| {
            let at = PointStep { state, dt: 0.0, stress: StepStress::Frozen };
            StepLaw { material: law, at }.energy(c)
        };
        let mut next = [0.0];
        let lost = law.commit(&at, &c_n, &c_np1, &mut next)?.total();
        worst = worst.max((work - (stored(&next, &c_np1)? - stored(&state, &c_n)?) - lost).abs());
        least = least.min(lost);
        all += work.abs();
        (state, c_n) = (next, c_np1);
    }
    Ok([worst / all, least / all])
}

/// Prints and checks.
pub fn main() -> Result<(), Box<dyn Error>> {
    let law = Softer::new(NeoHooke::from_young_poisson(2250.0, 0.3)?, 0.4);
    let worst = derivatives(&law)?;
    println!("stress and moduli against differences: {worst:.1e}");
    assert!(worst < 1e-8);
    let [worst, least] = balance(&law)?;
    println!("work less what is stored and lost: {worst:.1e}; least loss of a step: {least:.1e}");
    assert!(worst < 1e-14 && least >= 0.0);

    let laws = laws();
    let scene = parse_with(FLYING, "flying.toml", &laws.names())?;
    let mut simulation = build_with(&scene, Path::new("."), &laws)?.simulation;
    let start = simulation.balance().total();
    println!("time  stored and kinetic  lost by softening  sum less that at the start");
    while !simulation.finished() {
        let balance = simulation.advance()?.balance;
        let (energy, off) = (balance.kinetic + balance.strain, balance.total() / start - 1.0);
        println!("{:4.2} {energy:19.6} {:18.6} {off:27.1e}", simulation.state().time, balance.softening_loss);
        assert!(off.abs() < 1e-12, "{off}");
    }
    assert!(simulation.balance().softening_loss > 1e-2 * start);
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
