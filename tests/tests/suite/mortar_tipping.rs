//! Blocks on mortar contact stand until the vertical through their centre leaves their base, whichever side is the slave.

use stoss::run::{RunOptions, run_scene};

/// A block of the width 0.2 and the height 1 on an elastic floor of facets of 0.3, whose gravity is turned slowly to `degrees`; friction holds it. `slave`: of the contact.
fn tilted(degrees: f64, slave: &str, across: usize) -> f64 {
    let master = if slave == "floor.top" { "block.boundary" } else { "floor.top" };
    let text = format!(
        r#"
[scene]
title = "tilt"
kind = "dynamic"
[parameters]
tilt = {degrees:?}
[time]
end = 8.5
step = 0.04
integrator = {{ scheme = "energy-momentum" }}
[[stage]]
name = "settle"
kind = "quasi-static"
until = 1.0
step = 0.1
stabilise = {{ fraction = 1e-3 }}
[[stage]]
name = "tilt"
kind = "dynamic"
until = 8.5
[[body]]
name = "block"
mesh = {{ generator = "block", size = [0.2, 0.5, 1.0], divisions = [{across}, 2, 4] }}
position = [0, 0, 0.5]
material = {{ law = "neo-hooke", young = 1e4, poisson = 0.3 }}
density = 1.0
damping = {{ stiffness = 0.01 }}
[[body]]
name = "floor"
mesh = {{ generator = "block", min = [-0.43, -0.6, -0.5], max = [0.77, 0.6, 0], divisions = [4, 4, 1] }}
material = {{ law = "neo-hooke", young = 1e6, poisson = 0.0 }}
density = 1.0
[[prescribe]]
set = "floor.bottom"
components = ["x", "y", "z"]
fixed = true
[[load]]
body = "block"
acceleration = [0, 0, -1]
[[load]]
body = "block"
acceleration = {{ table = [[1.0, 0, 0, 0], [5.0, "tan(radians(tilt))", 0, 0]] }}
[[contact]]
method = "mortar"
multipliers = "centred"
slave = "{slave}"
master = "{master}"
friction = {{ law = "coulomb", mu = 1.0 }}
[[probe]]
name = "top"
set = "block.top"
quantity = "displacement"
"#
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let out = folder.path().join("out");
    let options = RunOptions { out: out.clone(), ..RunOptions::default() };
    run_scene(&path, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
    let probes = std::fs::read_to_string(out.join("probes.csv")).unwrap();
    // How far the top has moved along x.
    let column = probes.lines().next().unwrap().split(',').position(|name| name == "top.x").unwrap();
    probes.lines().last().unwrap().split(',').nth(column).unwrap().parse().unwrap()
}

/// The centre is over the edge at atan(0.2 / 1) = 11.31 degrees. (Later, when its sides begin to face the floor, Newton may stop with the block as the slave, as for any edge that rolls.)
fn stands_at_11_0_degrees_and_falls_at_11_6(slave: &str, across: usize) {
    let moved = tilted(11.0, slave, across);
    assert!(moved < 0.02, "{moved}");
    let moved = tilted(11.6, slave, across);
    assert!(moved > 0.05, "{moved}");
}

#[test]
fn a_block_that_is_the_slave() {
    stands_at_11_0_degrees_and_falls_at_11_6("block.boundary", 1);
}

#[test]
fn a_block_of_one_facet_that_is_the_master() {
    stands_at_11_0_degrees_and_falls_at_11_6("floor.top", 1);
}

#[test]
fn a_block_of_two_facets_that_is_the_master() {
    stands_at_11_0_degrees_and_falls_at_11_6("floor.top", 2);
}
