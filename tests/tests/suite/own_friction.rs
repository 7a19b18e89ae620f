//! A law of friction that is not in the catalogue, used from a scene as a program outside of this workspace would.

use std::path::Path;
use std::sync::Arc;
use stoss::build::{FrictionLawResult, LawParameters, OwnLaws, ParameterError, build_with};
use stoss::contact::friction::{FrictionInput, FrictionLaw, FrictionOutput, return_to_bound};
use stoss::run::{RunError, RunOptions, check_scene_with, run_scene};
use stoss::scene::{SceneErrors, parse_with};

/// Shear-limited friction, `|tau| <= min(mu p, strength)` (Tresca's bound over Coulomb's).
#[derive(Debug)]
struct ShearLimited {
    mu: f64,
    strength: f64,
}

impl FrictionLaw for ShearLimited {
    fn name(&self) -> &str {
        "shear-limited"
    }
    fn traction(&self, input: &FrictionInput) -> FrictionOutput {
        let coulomb = self.mu * input.pressure.max(0.0);
        let slope = if input.pressure > 0.0 && coulomb < self.strength { self.mu } else { 0.0 };
        return_to_bound(input.trial, coulomb.min(self.strength), slope, [0.0; 2])
    }
}

/// Traction proportional to the velocity of the slip; it cannot stick.
#[derive(Debug)]
struct Viscous(f64);

impl FrictionLaw for Viscous {
    fn name(&self) -> &str {
        "viscous"
    }
    fn traction(&self, input: &FrictionInput) -> FrictionOutput {
        let c = if input.pressure > 0.0 { self.0 / input.step_size } else { 0.0 };
        FrictionOutput {
            traction: input.slip.map(|s| c * s),
            d_slip: [[c, 0.0], [0.0, c]],
            ..FrictionOutput::default()
        }
    }
    fn is_elastic(&self) -> bool {
        false
    }
}

fn shear_limited(parameters: &LawParameters<'_>) -> FrictionLawResult {
    let (mu, strength) = (parameters.number("mu")?, parameters.number_or("strength", f64::INFINITY)?);
    if mu < 0.0 {
        return Err(ParameterError::new("mu", "must not be negative", "enlarge mu").into());
    }
    Ok(Arc::new(ShearLimited { mu, strength }))
}

fn laws() -> OwnLaws {
    OwnLaws::default()
        .with_friction("shear-limited", shear_limited)
        .unwrap()
        .with_friction("viscous", |parameters| Ok(Arc::new(Viscous(parameters.number("viscosity")?))))
        .unwrap()
}

/// A block that slides on a level plate: mass 1/2 on an area of 1, weight 5.
const SLIDING: &str = r#"
[scene]
title = "sliding"
kind = "dynamic"

[time]
end = 0.5
step = 0.01
integrator = { scheme = "backward-euler" }

[[body]]
name = "plate"
mesh = { generator = "block", min = [-1, -1, -1], max = [3, 2, 0], divisions = [4, 3, 1] }
material = { law = "neo-hooke", young = 1e5, poisson = 0.3 }
density = 1.0

[[body]]
name = "slider"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 1, 0.5], divisions = [2, 2, 1] }
material = { law = "neo-hooke", young = 1e5, poisson = 0.3 }
density = 1.0
velocity = [2.0, 0.0, 0.0]

[[prescribe]]
set = "plate.all"
components = ["x", "y", "z"]
fixed = true

[[load]]
body = "slider"
body_force = [0.0, 0.0, -10.0]

[[contact]]
method = "nts"
slave = "slider.bottom"
master = "plate.top"
friction = { law = "shear-limited", mu = 0.3, strength = 0.4 }

[[probe]]
name = "slider"
body = "slider"
quantity = "linear_momentum"

[output]
every = 100
"#;

const FRICTION: &str = "{ law = \"shear-limited\", mu = 0.3, strength = 0.4 }";

/// Speed of the slider at the end.
fn final_speed(friction: &str) -> f64 {
    let scene = parse_with(&SLIDING.replace(FRICTION, friction), "test.toml", &laws().names()).unwrap();
    let mut simulation = build_with(&scene, Path::new("."), &laws()).unwrap().simulation;
    while !simulation.finished() {
        simulation.advance().unwrap();
    }
    simulation.body_balance(1).linear_momentum[0] / 0.5
}

/// Force on mass 1/2 over an area of 1 in half a unit of time: the pressure of 5 allows a traction of 1.5, the law 0.4.
#[test]
fn a_block_is_braked_by_the_bound_of_the_law() {
    let speed = final_speed(FRICTION);
    approx::assert_relative_eq!(speed, 2.0 - 0.4 * 0.5 / 0.5, max_relative = 1e-3);
    // Without the limit it is the catalogue's law.
    let own = final_speed("{ law = \"shear-limited\", mu = 0.3 }");
    let coulomb = final_speed("{ law = \"coulomb\", mu = 0.3 }");
    assert_eq!(own, coulomb);
    assert!(own < speed);
}

/// Backward Euler: a factor of `1 / (1 + c h A / m)` each step.
#[test]
fn a_law_without_stick_slows_a_block_down() {
    let speed = final_speed("{ law = \"viscous\", viscosity = 0.5 }");
    approx::assert_relative_eq!(speed, 2.0 * 1.01_f64.powi(-50), max_relative = 1e-3);
}

#[test]
fn a_run_with_an_own_law_of_friction_resumes_and_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sliding.toml");
    std::fs::write(&path, SLIDING).unwrap();
    let plan = check_scene_with(&path, &laws()).unwrap().to_string();
    assert!(plan.contains("friction shear-limited (mu = 0.3, strength = 0.4), stick = multiplier"), "{plan}");
    let run = |out: &str, until: Option<f64>, resume: bool| {
        let out = folder.path().join(out);
        run_scene(&path, &RunOptions { out, until, resume, laws: laws(), ..RunOptions::default() }, &mut |_| {})
            .unwrap()
    };
    run("whole", None, false);
    run("parts", Some(0.2), false);
    let summary = run("parts", None, true);
    let friction = summary.contacts[0].friction.as_ref().unwrap();
    assert_eq!((friction.law.as_str(), friction.stick.as_deref()), ("shear-limited", Some("multiplier")));
    let table = |out: &str| std::fs::read(folder.path().join(out).join("balance.csv")).unwrap();
    assert_eq!(table("whole"), table("parts"));
    // A program without the law.
    let options = RunOptions { out: folder.path().join("none"), ..RunOptions::default() };
    match run_scene(&path, &options, &mut |_| {}) {
        Err(RunError::Scene(problems)) => assert_eq!(problems.problems()[0].key, "contact[0].friction.law"),
        other => panic!("{other:?}"),
    }
}

fn problems(friction: &str) -> SceneErrors {
    match parse_with(&SLIDING.replace(FRICTION, friction), "test.toml", &laws().names()) {
        Err(problems) => problems,
        Ok(scene) => build_with(&scene, Path::new("."), &laws()).map(|_| ()).unwrap_err(),
    }
}

#[test]
fn wrong_parameters_are_told_at_their_place() {
    for (friction, key, message, remedy) in [
        ("{ law = \"shear-limited\" }", "contact[0].friction.mu", "is missing", "mu = 1.0"),
        ("{ law = \"shear-limited\", mu = -1.0 }", "contact[0].friction.mu", "must not be negative", "enlarge"),
        ("{ law = \"shear-limited\", mu = 1, strenght = 2 }", "contact[0].friction.strenght", "unknown", "`strength`"),
        ("{ law = \"shear-limted\", mu = 1 }", "contact[0].friction.law", "is unknown", "did you mean `shear-limited`"),
        ("{ law = \"viscous\", viscosity = 1, penalty = 2 }", "contact[0].friction.penalty", "stick", "remove it"),
    ] {
        let problems = problems(friction);
        let problem = &problems.problems()[0];
        assert_eq!((problem.key.as_str(), problem.line), (key, 37), "{problem}");
        assert!(problem.message.contains(message) && problem.remedy.contains(remedy), "{problem}");
    }
}

#[test]
fn names_of_the_catalogue_are_taken() {
    for name in ["coulomb", "viscous", "two words", ""] {
        assert_eq!(laws().with_friction(name, shear_limited).unwrap_err().name, name);
    }
    // A material is another matter.
    assert!(laws().with_friction("neo-hooke", shear_limited).is_ok());
}
