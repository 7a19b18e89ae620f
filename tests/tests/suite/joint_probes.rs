//! What probes say of joints, against equilibrium by hand.

use std::path::Path;
use stoss::build::{Built, build};

/// A slider along x that a motor has moved by 2 carries 10 downwards: on the ground it presses with 10 downwards, 2 away from the joint's point there, a moment of
/// `(2, 0, 0) x (0, 0, -10) = (0, 20, 0)`; on the body, about the joint's point on the body, there is none.
#[test]
fn moments_are_about_the_point_of_the_first_side() {
    for (between, force, moment) in [
        ("[\"ground\", \"a\"]", [0.0, 0.0, -10.0], [0.0, 20.0, 0.0]),
        ("[\"a\", \"ground\"]", [0.0, 0.0, 10.0], [0.0; 3]),
    ] {
        // The displacement is that of the second side against the first.
        let push = if between.starts_with("[\"ground\"") { 2.0 } else { -2.0 };
        let text = format!(
            r#"
[scene]
title = "slider"
kind = "quasi-static"
[time]
end = 1.0
step = 0.5
[[rigid]]
name = "a"
[[joint]]
name = "s"
kind = "slider"
between = {between}
at = [0, 0, 0]
axis = [1, 0, 0]
motor = {{ displacement = {{ table = [[0.0, 0.0], [1.0, {push:?}]] }} }}
[[load]]
set = "a.all"
force = [0, 0, -10]
[[probe]]
name = "f"
quantity = "joint_force"
joint = "s"
[[probe]]
name = "m"
quantity = "joint_moment"
joint = "s"
"#
        );
        let scene = stoss::scene::parse(&text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
        let Built { mut simulation, probes, .. } = build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        while !simulation.finished() {
            simulation.advance().unwrap();
        }
        let found = [0, 1].map(|k| probes[k].value(&simulation));
        for (found, expected) in found.iter().zip([force, moment]) {
            assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-8), "{between}: {found:?}, not {expected:?}");
        }
    }
}
