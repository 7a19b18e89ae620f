//! A block that falls on a larger one.

/// Bodies and frictionless contact (nodes against surfaces) of a scene: a unit block with this velocity hits one with a 2 x 2 top, its nodes beside those of the other. With a speed of 4
/// downwards it arrives after 5e-3.
pub fn falling(velocity: [f64; 3]) -> String {
    format!(
        r#"
[[body]]
name = "lower"
mesh = {{ generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [2, 2, 1] }}
material = {{ law = "neo-hooke", young = 1.0e6, poisson = 0.3 }}
density = 1000.0
[[body]]
name = "upper"
mesh = {{ generator = "block", min = [0.3, 0.4, 1.02], max = [1.3, 1.4, 2.02], divisions = [1, 1, 1] }}
material = {{ law = "neo-hooke", young = 1.0e6, poisson = 0.3 }}
density = 1000.0
velocity = {velocity:?}
[[contact]]
method = "nts"
slave = "upper.bottom"
master = "lower.top"
"#
    )
}
