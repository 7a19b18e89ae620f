//! Springs and dampers that stages and events switch.

use std::path::Path;
use stoss::build::{Built, build};
use stoss::run::{RunOptions, run_scene};

/// A mass on two springs and a damper along x, pulled out by 0.3. One spring is off in the first stage, the other one and the damper are let go later.
const SCENE: &str = r#"
[scene]
title = "mass on springs"
kind = "dynamic"
[time]
end = 0.9
step = 0.01
integrator = { scheme = "energy-momentum" }
[[mass]]
name = "bob"
at = [1.3, 0, 0]
mass = 2.0
[[spring]]
name = "left"
between = ["ground", "bob"]
at = [[0, 0, 0], [1.3, 0, 0]]
stiffness = 50.0
rest_length = 1.0
[[spring]]
name = "right"
between = ["bob", "ground"]
at = [[1.3, 0, 0], [3, 0, 0]]
stiffness = 30.0
rest_length = 2.0
[[spring]]
name = "damper"
between = ["bob", "ground"]
at = [[1.3, 0, 0], [5, 0, 0]]
stiffness = 0.0
damping = 3.0
[[event]]
name = "snap"
release = "left"
when = { probe = "place", component = "x", below = 1.0 }
[[event]]
name = "free"
release = "damper"
time = 0.5
[[stage]]
name = "one"
kind = "dynamic"
until = 0.1
off = ["right"]
[[stage]]
name = "both"
kind = "dynamic"
until = 0.6
[[stage]]
name = "none"
kind = "dynamic"
until = 0.9
off = ["right"]
[[probe]]
name = "place"
body = "bob"
quantity = "position"
"#;

#[test]
fn energy_of_what_is_switched_is_external_work() {
    let scene = stoss::scene::parse(SCENE, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    let Built { mut simulation, probes, schedule, .. } =
        build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    let x = |simulation: &stoss::solver::Simulation| probes[0].value(simulation)[0];
    let left = |x: f64| 25.0 * (x - 1.0) * (x - 1.0);
    let right = |x: f64| 15.0 * (3.0 - x - 2.0) * (3.0 - x - 2.0);
    assert!((simulation.balance().strain - left(1.3)).abs() < 1e-12, "`right` does not act");
    let start = simulation.balance().total() - simulation.balance().external_work;
    let (mut given, mut snapped, mut last_speed) = (0.0, false, None);
    loop {
        let before = *simulation.balance();
        schedule.events(&mut simulation, &probes).unwrap();
        if !snapped && x(&simulation) < 1.0 {
            snapped = true;
            given -= left(x(&simulation));
        }
        let mut more = true;
        if simulation.finished() {
            let at = simulation.state().time;
            more = schedule.advance(&mut simulation).unwrap();
            if more && (at - 0.1).abs() < 1e-9 {
                given += right(x(&simulation));
            } else if more && (at - 0.6).abs() < 1e-9 {
                given -= right(x(&simulation));
            }
        }
        let now = *simulation.balance();
        assert!((now.external_work - given).abs() < 1e-12, "{} instead of {given}", now.external_work);
        assert!((now.kinetic, now.dissipation) == (before.kinetic, before.dissipation));
        if !more {
            break;
        }
        let time = simulation.state().time;
        simulation.advance().unwrap();
        let now = *simulation.balance();
        // Energy with what dampers took and without what was given.
        let kept = now.kinetic + now.strain + now.dissipation - now.external_work;
        assert!((kept - start).abs() < 1e-12 * start, "{kept} of {start} at {time}");
        if time > 0.6 {
            let speed = simulation.state().v[0];
            assert!(last_speed.is_none_or(|last: f64| (speed - last).abs() < 1e-13), "nothing acts any more");
            assert_eq!(now.strain, 0.0);
            last_speed = Some(speed);
        }
        if time > 0.5 {
            assert_eq!(now.dissipation, before.dissipation, "the damper is off");
        }
    }
    assert!(snapped && last_speed.is_some());
    assert_eq!(simulation.released().len(), 2);
}

#[test]
fn a_run_resumes_with_springs_switched() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("springs.toml");
    std::fs::write(&path, SCENE).unwrap();
    let run = |out: &str, until: Option<f64>, resume: bool| {
        let out = folder.path().join(out);
        run_scene(&path, &RunOptions { out, until, resume, ..RunOptions::default() }, &mut |_| {}).unwrap();
    };
    run("whole", None, false);
    run("parts", Some(0.05), false);
    run("parts", Some(0.55), true);
    run("parts", None, true);
    let table = |out: &str, file: &str| std::fs::read(folder.path().join(out).join(file)).unwrap();
    for file in ["balance.csv", "probes.csv"] {
        assert_eq!(table("whole", file), table("parts", file), "{file}");
    }
}
