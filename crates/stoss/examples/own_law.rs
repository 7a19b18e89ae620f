//! A material law of one's own, used from a scene: the compressible neo-Hookean law of Ciarlet, which is not in the catalogue.
//!
//! Shown: the trait `HyperelasticLaw`, a constructor that reads the parameters of a scene, a run with the law.
//! Checked: stress and tangent against differences of the energy and of the stress, the energy of a stretched cube against its closed form.
//!
//! `cargo run --example own_law -p stoss`; docs/how-to-add/material-law.md explains it.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use stoss::build::{LawParameters, LawResult, OwnLaws, ParameterError, build_with};
use stoss::continuum::{ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4};
use stoss::scene::parse_with;

/// `W = mu/2 (I1 - 3 - 2 ln J) + lambda/4 (J^2 - 1 - 2 ln J)`, `det C > 0`; `lambda` and `mu` are stresses.
#[derive(Debug)]
pub struct Ciarlet {
    lambda: f64,
    mu: f64,
}

impl Ciarlet {
    fn det(c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        let det_c = c.det();
        if det_c > 0.0 { Ok(det_c) } else { Err(ConstitutiveError::NonPositiveJacobian { det_c }) }
    }
}

impl HyperelasticLaw for Ciarlet {
    fn name(&self) -> &str {
        "ciarlet"
    }
    fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        let det = Self::det(c)?;
        let log = det.ln();
        Ok(0.5 * self.mu * (c.trace() - 3.0 - log) + 0.25 * self.lambda * (det - 1.0 - log))
    }
    fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        Ok(self.stress_and_elasticity(c)?.0)
    }
    fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        let det = Self::det(c)?;
        let inverse = c.inverse_with_det(det);
        let factor = 0.5 * self.lambda * (det - 1.0) - self.mu;
        let mut elasticity = Tensor4::inverse_derivative(&inverse) * (2.0 * factor);
        elasticity.add_dyad(self.lambda * det, &inverse, &inverse);
        Ok((SymmetricTensor2::IDENTITY * self.mu + inverse * factor, elasticity))
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        SmallStrainModuli::from_lame(self.lambda, self.mu)
    }
}

/// The law from `material = { law = "ciarlet", lambda = .., mu = .. }`. A missing or unknown key is reported for you.
pub fn ciarlet(parameters: &LawParameters<'_>) -> LawResult {
    let (lambda, mu) = (parameters.number("lambda")?, parameters.number("mu")?);
    if mu <= 0.0 {
        return Err(ParameterError::new("mu", "must be positive", "enlarge mu").into());
    }
    if parameters.number_or("softening", 0.0)? != 0.0 {
        return Err("softening is not available".into());
    }
    Ok(Arc::new(Ciarlet { lambda, mu }))
}

/// The names that scenes may use.
pub fn laws() -> OwnLaws {
    OwnLaws::default().with("ciarlet", ciarlet).expect("the catalogue has no law of this name")
}

/// A unit cube that is stretched along z while its sides are held.
pub const STRETCHED: &str = r#"
[scene]
title = "stretched"
kind = "quasi-static"

[time]
end = 1.0
step = 0.5

[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 1], divisions = [2, 2, 2] }
material = { law = "ciarlet", lambda = 1300.0, mu = 865.0 }

[[prescribe]]
set = "block.all"
components = ["x", "y"]
fixed = true

[[prescribe]]
set = "block.bottom"
components = ["z"]
fixed = true

[[prescribe]]
set = "block.top"
components = ["z"]
displacement = { table = [[0.0, 0.0], [1.0, 0.4]] }
"#;

/// Largest error of stress and tangent along directions in the space of `C`, relative: `S : D = 2 dW`, `CC : D = 2 dS`.
fn derivatives(law: &Ciarlet) -> Result<f64, ConstitutiveError> {
    let c = SymmetricTensor2([1.3, 0.8, 1.1, 0.2, -0.1, 0.15]);
    let (stress, elasticity) = law.stress_and_elasticity(&c)?;
    let h = 1e-5;
    let mut worst = 0.0_f64;
    for component in 0..6 {
        let mut direction = SymmetricTensor2([0.0; 6]);
        direction.0[component] = 1.0;
        let [plus, minus] = [c + direction * h, c - direction * h];
        let energy = (law.energy(&plus)? - law.energy(&minus)?) / h;
        worst = worst.max((energy - stress.double_contract(&direction)).abs() / stress.norm());
        let difference = (law.stress(&plus)? - law.stress(&minus)?) * (1.0 / h);
        let tangent = elasticity.double_contract_right(&direction);
        worst = worst.max((difference - tangent).norm() / tangent.norm());
    }
    Ok(worst)
}

/// Prints and checks.
pub fn main() -> Result<(), Box<dyn Error>> {
    let (lambda, mu) = (1300.0, 865.0);
    let worst = derivatives(&Ciarlet { lambda, mu })?;
    println!("stress and tangent against differences: {worst:.1e}");
    assert!(worst < 1e-8);

    let laws = laws();
    let scene = parse_with(STRETCHED, "stretched.toml", &laws.names())?;
    let mut simulation = build_with(&scene, Path::new("."), &laws)?.simulation;
    println!("stretch   energy of the run   closed form");
    while !simulation.finished() {
        let record = simulation.advance()?;
        // The deformation is diag(1, 1, J).
        let j = 1.0 + 0.4 * record.time;
        let energy = (0.5 * mu + 0.25 * lambda) * (j * j - 1.0 - 2.0 * j.ln());
        let found = record.balance.strain;
        println!("{j:7.2} {found:19.6} {energy:13.6}");
        assert!((found / energy - 1.0).abs() < 1e-11, "{found} {energy}");
    }
    Ok(())
}

#[test]
fn the_checks_hold() -> Result<(), Box<dyn Error>> {
    main()
}
