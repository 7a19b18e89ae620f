//! The scenes: all shipped ones, and small ones for each support, load and scheme.

use super::super::scenes::is_large;
use super::Bench;
use crate::workspace::Outcome;
use stoss_integrators::SCHEMES;
use stoss_reference_cases::blocks::falling;

/// A scene and how many of its steps show everything that it uses.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Name of the row.
    pub name: String,
    /// TOML.
    pub text: String,
    /// Steps to run.
    pub steps: u64,
}

/// How the names of shipped scenes begin that run until their contact has closed, or all of their loads act; of the others a step shows what they have.
const LONGER: [(&str, u64); 3] = [("ball-plate", 7), ("press", 12), ("two-blocks", 27)];

/// A free bar that stretches.
const BAR: &str = r#"
[[body]]
name = "bar"
mesh = { generator = "block", size = [1.0, 1.0, 2.0], divisions = [1, 1, 2] }
material = { law = "neo-hooke", young = 2250.0, poisson = 0.3 }
density = 0.1
velocity_gradient = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 5.0]]
"#;

const SUPPORT: &str = r#"
[[prescribe]]
set = "bar.bottom"
components = ["x", "y", "z"]
fixed = true
"#;

const DEAD_LOAD: &str = r#"
[[load]]
set = "bar.top"
traction = [0.0, 1.0, 0.0]
"#;

const FOLLOWER_PRESSURE: &str = r#"
[[load]]
set = "bar.top"
follower_pressure = 1.0
"#;

const STEP: f64 = 0.002;

/// Steps of 2 ms.
fn generated(name: String, scheme: &str, parts: &[&str], steps: u64) -> Sample {
    let end = STEP * steps as f64;
    let text = format!(
        "[scene]\ntitle = \"{name}\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = {STEP:?}\n\
         integrator = {{ scheme = \"{scheme}\" }}\n{}",
        parts.concat()
    );
    Sample { name, text, steps }
}

/// All scenes; in quick mode without the large ones.
pub fn samples(bench: &Bench) -> Outcome<Vec<Sample>> {
    let mut samples = Vec::new();
    for file in bench.workspace.scenes()? {
        if bench.quick && is_large(&file) {
            continue;
        }
        let text = bench.workspace.read(&file)?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let steps = LONGER.iter().find(|longer| name.starts_with(longer.0)).map_or(1, |longer| longer.1);
        samples.push(Sample { name, text, steps });
    }
    let with = |name: &str, part| generated(name.into(), "energy-momentum", &[BAR, part], 2);
    samples.push(with("bar on a fixed support", SUPPORT));
    samples.push(with("bar under a dead load", DEAD_LOAD));
    samples.push(with("bar under a follower pressure", FOLLOWER_PRESSURE));
    let impact = falling([0.0, 0.0, -4.0]);
    for entry in SCHEMES {
        samples.push(generated(format!("free bar, {}", entry.name), entry.name, &[BAR], 2));
        if entry.with([])?.claims().constraints {
            samples.push(generated(format!("impact, {}", entry.name), entry.name, &[&impact], 4));
        }
    }
    Ok(samples)
}
