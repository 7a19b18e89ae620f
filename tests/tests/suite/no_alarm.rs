//! Scenes that come out well give no alarm.

use crate::failing::{Left, run, run_until};
use std::path::Path;
use stoss::diagnosis::Confidence;
use stoss::run::{RunOptions, diagnose_scene};
use stoss::watch::Severity;

/// A steel bar in SI units under one newton: strains of 5e-10, of which steps leave errors that are no fault of the scheme.
#[test]
fn a_tiny_load_is_no_fault() {
    let text = r#"
[scene]
title = "a bar under one newton"
kind = "dynamic"
units = "m-kg-s"
[time]
end = 1e-3
step = 1e-5
integrator = { scheme = "energy-momentum" }
[[body]]
name = "bar"
mesh = { generator = "block", min = [0, 0, 0], max = [1, 0.1, 0.1], divisions = [10, 1, 1] }
material = { law = "neo-hooke", young = 2.1e11, poisson = 0.3 }
density = 7850.0
[[prescribe]]
set = "bar.left"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "bar.right"
total_force = [1.0, 0, 0]
"#;
    let Left { result, diagnosis } = run(text);
    let summary = result.unwrap();
    assert_eq!((summary.verdict.level, diagnosis), (Severity::Sound, None), "{}", summary.verdict);
}

/// Three scenes that come out well, and before their runs some of each kind.
#[test]
fn scenes_that_come_out_well_raise_no_alarm() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    for name in ["press", "block-impact", "incline"] {
        let text = std::fs::read_to_string(scenes.join(format!("{name}.toml"))).unwrap();
        let Left { result, diagnosis } = run_until(&text, (name == "incline").then_some(0.3));
        result.unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(diagnosis, None, "{name}");
    }
    for name in ["two-blocks", "rigid-punch", "trebuchet", "stack", "tied-cantilever"] {
        let found = diagnose_scene(&scenes.join(format!("{name}.toml")), &RunOptions::default()).unwrap().findings;
        assert!(found.iter().all(|finding| finding.confidence != Confidence::High), "{name}: {found:#?}");
    }
}
