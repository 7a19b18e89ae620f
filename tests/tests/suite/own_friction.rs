//! The example of laws of friction of one's own in whole runs: bound, checkpoints, messages. Its closed forms are checked in the example.

#[path = "../../../crates/stoss/examples/own_friction_law.rs"]
mod example;

use example::{FRICTION, SLIDING, final_speed, laws, shear_limited, speed_of};
use std::path::Path;
use stoss::build::build_with;
use stoss::run::{RunError, RunOptions, check_scene_with, run_scene};
use stoss::scene::{SceneErrors, parse_with};

/// Speed of a point of the mass 1/2 and the weight 5 that is braked from 2 with the bound of a law, by backward Euler as in [`SLIDING`].
fn braked(tau: impl Fn(f64) -> f64) -> f64 {
    let (h, mass) = (0.01, 0.5);
    (0..50).fold(2.0, |v, _| {
        let (mut low, mut high) = (0.0, v);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            if mass * (middle - v) + h * tau(middle) > 0.0 { high = middle } else { low = middle }
        }
        0.5 * (low + high)
    })
}

/// Every law works with every method: a block that slides loses what a point with the same bound loses.
#[test]
fn every_law_with_every_method() {
    let entry = format!("friction = {FRICTION}");
    let [start, end] = ["[[contact]]", "[[probe]]"].map(|table| SLIDING.find(table).unwrap());
    let p = 5.0;
    type Tau = fn(f64) -> f64;
    let laws: [(&str, Tau); 5] = [
        ("{ law = \"coulomb\", mu = 0.2 }", |_| 1.0),
        ("{ law = \"static-dynamic\", mu_static = 0.3, mu_dynamic = 0.1, speed = 1.5 }", |v| {
            5.0 * (0.1 + 0.2 * (-(v / 1.5_f64).powi(2)).exp())
        }),
        ("{ law = \"regularised\", mu = 0.2, speed = 1.0 }", |v| v / v.hypot(1.0)),
        ("{ law = \"shear-limited\", mu = 0.3, strength = 0.4 }", |_| 0.4),
        ("{ law = \"viscous\", viscosity = 0.5 }", |v| 0.5 * v),
    ];
    assert_eq!(p * 0.2, 1.0);
    for (law, tau) in laws {
        let expected = braked(tau);
        for method in ["nts", "mortar", "general"] {
            let friction = format!("friction = {law}");
            let scene = match method {
                "general" => {
                    format!("{}[general_contact]\n{friction}\n\n{}", &SLIDING[..start], &SLIDING[end..])
                }
                _ => SLIDING.replace(&entry, &friction).replace("\"nts\"", &format!("\"{method}\"")),
            };
            let speed = speed_of(&scene).unwrap();
            println!("{method:8} {law:75} {speed:.5} {expected:.5}");
            // In general contact the vertices have a hundredth of the area once more (theory/barrier#eq-weight), which counts for laws that are not proportional to the pressure.
            let bound = if method == "general" { 1.5e-2 } else { 1e-4 };
            assert!(((2.0 - speed) / (2.0 - expected) - 1.0).abs() < bound, "{method} {law}: {speed} {expected}");
        }
    }
}

/// The law of the catalogue, which this one is without the limit of the shear.
#[test]
fn a_law_of_ones_own_gives_the_bits_of_the_catalogue() {
    let own = final_speed("{ law = \"shear-limited\", mu = 0.3 }").unwrap();
    let coulomb = final_speed("{ law = \"coulomb\", mu = 0.3 }").unwrap();
    assert_eq!(own, coulomb);
    assert!(own < final_speed(FRICTION).unwrap());
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
