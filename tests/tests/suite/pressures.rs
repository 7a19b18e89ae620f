//! The contact pressure is a force per current area, whichever the method.

use crate::support::simulation;

/// A block on a stiff base, free to slide, compressed by three tenths of its height; it widens.
fn scene(method: &str) -> String {
    format!(
        r#"
[scene]
title = "press"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
[[body]]
name = "block"
mesh = {{ generator = "block", min = [0, 0, 1], max = [1, 1, 2], divisions = [2, 2, 2] }}
material = {{ law = "neo-hooke", young = 100.0, poisson = 0.4 }}
[[body]]
name = "base"
mesh = {{ generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [3, 3, 1] }}
material = {{ law = "neo-hooke", young = 1e7, poisson = 0.0 }}
[[contact]]
method = "{method}"
slave = "block.bottom"
master = "base.top"
[[prescribe]]
set = "base.bottom"
components = ["x", "y", "z"]
fixed = true
[[prescribe]]
set = "block.left"
components = ["x"]
fixed = true
[[prescribe]]
set = "block.front"
components = ["y"]
fixed = true
[[prescribe]]
set = "block.top"
components = ["z"]
displacement = {{ table = [[0.0, 0.0], [1.0, -0.3]] }}
"#
    )
}

#[test]
fn pressures_are_per_current_area() {
    let stress = ["nts", "mortar"].map(|method| {
        let mut run = simulation(&scene(method));
        let mut largest = 0.0;
        while !run.finished() {
            largest = run.advance().unwrap_or_else(|error| panic!("{method}: {error}")).contact.unwrap().max_pressure;
        }
        // Uniform Cauchy stress: the force over the current area.
        let force: f64 = run.contact_force()[..3 * 27].iter().skip(2).step_by(3).sum();
        let corner = run.state().q[3 * 8];
        let (width, area) = (corner, corner * corner);
        assert!(width > 1.1, "{method}: the block does not grow: {width}");
        assert!((largest * area / force - 1.0).abs() < 1e-4, "{method}: {largest} {}", force / area);
        largest
    });
    assert!((stress[0] / stress[1] - 1.0).abs() < 1e-4, "{stress:?}");
}
