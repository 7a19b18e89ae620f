//! A hyperelastic law that is not in the catalogue, used from a scene as a program outside of this workspace would.

use std::path::Path;
use std::sync::Arc;
use stoss::build::{LawParameters, LawResult, OwnLaws, ParameterError, build_with};
use stoss::continuum::{ConstitutiveError, HyperelasticLaw, SmallStrainModuli, SymmetricTensor2, Tensor4};
use stoss::run::{RunError, RunOptions, check_scene_with, run_scene};
use stoss::scene::{SceneErrors, parse_with};

/// `W = mu/2 (I1 - 3 - 2 ln J) + lambda/4 (J^2 - 1 - 2 ln J)` (Ciarlet's compressible neo-Hookean law), `det C > 0`.
#[derive(Debug)]
struct Ciarlet {
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

fn ciarlet(parameters: &LawParameters<'_>) -> LawResult {
    let (lambda, mu) = (parameters.number("lambda")?, parameters.number("mu")?);
    if mu <= 0.0 {
        return Err(ParameterError::new("mu", "must be positive", "enlarge mu").into());
    }
    if parameters.number_or("softening", 0.0)? != 0.0 {
        return Err("softening is not available".into());
    }
    Ok(Arc::new(Ciarlet { lambda, mu }))
}

fn laws() -> OwnLaws {
    OwnLaws::default().with("ciarlet", ciarlet).unwrap()
}

const LAMBDA: f64 = 1300.0;
const MU: f64 = 865.0;

/// A cube that is stretched along z while its sides are held.
const STRETCHED: &str = r#"
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

/// A cube that flies, turns and vibrates.
const FLYING: &str = r#"
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
material = { law = "ciarlet", lambda = 1300.0, mu = 865.0 }
density = 10.0
angular_velocity = [1.0, 2.0, 3.0]
velocity_gradient = [[0, 0, 0], [0, 0, 0], [0, 0, 4]]

[output]
every = 100
"#;

#[test]
fn a_stretched_cube_has_the_energy_of_the_law() {
    let scene = parse_with(STRETCHED, "test.toml", &laws().names()).unwrap();
    let mut simulation = build_with(&scene, Path::new("."), &laws()).unwrap().simulation;
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
    let j = 1.4f64;
    let energy = 0.5 * MU * (j * j - 1.0 - 2.0 * j.ln()) + 0.25 * LAMBDA * (j * j - 1.0 - 2.0 * j.ln());
    approx::assert_relative_eq!(simulation.balance().strain, energy, max_relative = 1e-11);
}

#[test]
fn a_run_with_an_own_law_conserves_and_resumes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flying.toml");
    std::fs::write(&path, FLYING).unwrap();
    assert!(check_scene_with(&path, &laws()).unwrap().to_string().contains("ciarlet"));
    let options =
        RunOptions { out: folder.path().join("out"), until: Some(0.1), laws: laws(), ..RunOptions::default() };
    run_scene(&path, &options, &mut |_| {}).unwrap();
    let options = RunOptions { resume: true, until: None, ..options };
    let summary = run_scene(&path, &options, &mut |_| {}).unwrap();
    assert_eq!(summary.steps, 15);
    assert!(summary.drift["energy"].relative.unwrap() < 1e-12, "{:?}", summary.drift);
    assert!(summary.drift["angular_momentum"].relative.unwrap() < 1e-12, "{:?}", summary.drift);
    // A program without the law.
    let options = RunOptions { laws: OwnLaws::default(), ..options };
    match run_scene(&path, &options, &mut |_| {}) {
        Err(RunError::Scene(problems)) => assert_eq!(problems.problems()[0].key, "body[0].material.law"),
        other => panic!("{other:?}"),
    }
}

/// The problems of a scene whose material was changed.
fn problems(to: &str) -> SceneErrors {
    let text = STRETCHED.replace("{ law = \"ciarlet\", lambda = 1300.0, mu = 865.0 }", to);
    assert_ne!(text, STRETCHED);
    match parse_with(&text, "test.toml", &laws().names()) {
        Err(problems) => problems,
        Ok(scene) => build_with(&scene, Path::new("."), &laws()).map(|_| ()).unwrap_err(),
    }
}

#[test]
fn wrong_parameters_are_told_at_their_place() {
    for (material, key, message, remedy) in [
        ("{ law = \"ciarlet\", mu = 865.0 }", "body[0].material.lambda", "is missing", "lambda = 1.0"),
        ("{ law = \"ciarlet\", lambda = 1.0, mu = [1.0] }", "body[0].material.mu", "must be a number", "not a list"),
        ("{ law = \"ciarlet\", lambda = 1.0, mu = true }", "body[0].material.mu", "must be a number", "1.0"),
        ("{ law = \"ciarlet\", lambda = 1.0, mu = -1.0 }", "body[0].material.mu", "must be positive", "enlarge mu"),
        ("{ law = \"ciarlet\", lambda = 1, mu = 1, lamda = 2 }", "body[0].material.lamda", "unknown key", "`lambda`"),
        ("{ law = \"ciarlet\", lambda = 1, mu = 1, softening = 2 }", "body[0].material", "softening is not", "other"),
        ("{ law = \"ciarlte\", lambda = 1, mu = 1 }", "body[0].material.law", "is unknown", "did you mean `ciarlet`"),
    ] {
        let problems = problems(material);
        let problem = &problems.problems()[0];
        assert_eq!((problem.key.as_str(), problem.line), (key, 13), "{problem}");
        assert!(problem.message.contains(message) && problem.remedy.contains(remedy), "{problem}");
    }
}

#[test]
fn names_of_the_catalogue_are_taken() {
    for name in ["neo-hooke", "ciarlet", "two words", ""] {
        let error = laws().with(name, ciarlet).unwrap_err();
        assert_eq!(error.name, name);
    }
}
