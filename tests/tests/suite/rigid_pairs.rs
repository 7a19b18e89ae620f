//! Contact of two rigid bodies, where more nodes touch than three: pressures and friction of all together are determined, how the nodes share them is a choice.

use std::path::Path;
use stoss::run::{RunOptions, run_scene};
use stoss::watch::Severity;

const FLOOR_AND_BOX: &str = r#"
[[rigid]]
name = "floor"
shape = { kind = "box", size = [4.0, 2.0, 0.2] }
fixed = true
position = [0.0, 0.0, -0.1]

[[rigid]]
name = "box"
shape = { kind = "box", size = [0.4, 0.4, 0.2], divisions = [2, 2, 1] }
position = [0.0, 0.0, 0.1]
"#;

/// Runs a scene; the level of the verdict, and the last row of a table.
fn run(folder: &Path, text: &str, table: &str) -> (Severity, Vec<f64>) {
    let scene = folder.join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    let out = folder.join("out");
    let summary = run_scene(&scene, &RunOptions { out: out.clone(), ..RunOptions::default() }, &mut |_| ()).unwrap();
    let table = std::fs::read_to_string(out.join(table)).unwrap();
    (summary.verdict.level, table.lines().last().unwrap().split(',').map(|v| v.parse().unwrap()).collect())
}

/// m a = mu m g: the box stops at v / (mu g) after v^2 / (2 mu g), all but for what a step makes of it, and the watch has nothing against its rest.
#[test]
fn a_box_slides_on_a_plane_and_stops() {
    for method in ["nts", "cat", "mortar"] {
        for (mu, step) in [(0.3, 0.0125), (0.9, 0.005)] {
            let text = format!(
                r#"
[scene]
title = "box on a plane"
kind = "dynamic"
[time]
end = 0.4
step = {step}
integrator = {{ scheme = "energy-momentum" }}
[gravity]
acceleration = [0.0, 0.0, -10.0]
{FLOOR_AND_BOX}
density = 1000.0
velocity = [0.7, 0.41, 0.0]
[[contact]]
slave = "box.bottom"
master = "floor.top"
method = "{method}"
friction = {{ law = "coulomb", mu = {mu} }}
[[probe]]
name = "x"
quantity = "position"
body = "box"
"#
            );
            let folder = tempfile::tempdir().unwrap();
            let (level, row) = run(folder.path(), &text, "probes.csv");
            assert_eq!(level, Severity::Sound, "{method}, mu = {mu}");
            let speed = 0.7_f64.hypot(0.41);
            let slid = row[2].hypot(row[3]);
            let bound = speed * speed / (2.0 * mu * 10.0);
            // In the step in which it stops friction is less than the law admits: at most half a step of its speed there, mu g dt.
            assert!((slid - bound).abs() < mu * 10.0 * step * step, "{method}, mu = {mu}: {slid} {bound}");
        }
    }
}

/// A box without mass on a guide, pressed on a plane: statics in which nothing has a stiffness.
#[test]
fn a_guided_box_is_pressed_on_a_plane() {
    for method in ["nts", "cat", "mortar"] {
        for force in [100.0, 1e7] {
            let text = format!(
                r#"
[scene]
title = "guided box"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
{FLOOR_AND_BOX}
[[joint]]
name = "guide"
kind = "slider"
between = ["ground", "box"]
at = [0.0, 0.0, 0.1]
axis = [0.0, 0.0, 1.0]
[[load]]
set = "box.all"
force = [0.0, 0.0, -{force:?}]
[[contact]]
slave = "box.bottom"
master = "floor.top"
method = "{method}"
"#
            );
            let folder = tempfile::tempdir().unwrap();
            let (level, row) = run(folder.path(), &text, "contact.csv");
            assert_eq!((level, row[2]), (Severity::Sound, 9.0), "{method}");
            assert!((row[10] - force).abs() < 1e-12 * force, "{method}: {}", row[10]);
        }
    }
}
