//! A plane cantilever of one body or of two that are tied, and the distance of its nodes from those of a finer mesh.

use std::collections::BTreeMap;
use std::ops::Range;

/// A plane cantilever of length 4 and height 1, clamped at the left, under its weight; `parts` has the elements per unit
/// length of one body, or of two that are tied in the middle.
pub fn cantilever(parts: &[usize], tie: &str) -> String {
    let mut text = String::from(
        "[scene]\ntitle = \"cantilever\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n\
         [[prescribe]]\nset = \"b0.left\"\ncomponents = [\"x\", \"z\"]\nfixed = true\n",
    );
    let length = 4 / parts.len();
    for (b, n) in parts.iter().enumerate() {
        // Without lateral contraction the clamped corners are no singularities.
        text += &format!(
            "[[body]]\nname = \"b{b}\"\nmaterial = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.0 }}\n\
             mesh = {{ generator = \"block\", min = [{}, 0, 0], max = [{}, 0.1, 1], divisions = [{}, 1, {n}] }}\n\
             [[load]]\nbody = \"b{b}\"\nbody_force = [0, 0, -0.05]\n",
            b * length,
            (b + 1) * length,
            length * n
        );
        for set in ["front", "back"] {
            text += &format!("[[prescribe]]\nset = \"b{b}.{set}\"\ncomponents = [\"y\"]\nfixed = true\n");
        }
    }
    if parts.len() > 1 {
        text += &format!("[[tie]]\n{tie}\n");
    }
    text
}

/// Displacements in the plane by place, in units of 1/48.
pub type Field = BTreeMap<(i64, i64), [f64; 2]>;

/// The field of the nodes of one body in the plane y = 0; `x` are reference positions and `q` positions of all.
pub fn field(nodes: Range<u32>, x: &[f64], q: &[f64]) -> Field {
    let unit = |x: f64| (48.0 * x).round() as i64;
    let nodes = nodes.map(|n| 3 * n as usize).filter(|&k| x[k + 1] == 0.0);
    nodes.map(|k| ((unit(x[k]), unit(x[k + 2])), [q[k] - x[k], q[k + 2] - x[k + 2]])).collect()
}

/// Nodal L2 norm of the difference from the reference, which has all of their nodes; `parts` as in [`cantilever`].
pub fn error(fields: &[Field], parts: &[usize], reference: &Field) -> f64 {
    let mut sum = 0.0;
    for (field, n) in fields.iter().zip(parts) {
        for (place, u) in field {
            let r = reference[place];
            sum += ((u[0] - r[0]).powi(2) + (u[1] - r[1]).powi(2)) / (n * n) as f64;
        }
    }
    sum.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_those_of_the_front_and_their_distance_is_weighted_by_the_mesh() {
        // Two nodes, the second behind the plane y = 0.
        let (x, q) = ([0.5, 0.0, 1.0, 0.5, 0.1, 1.0], [0.75, 0.0, 0.5, 9.0, 9.0, 9.0]);
        let moved = field(0..2, &x, &q);
        assert_eq!(moved, Field::from([((24, 48), [0.25, -0.5])]));
        let rest = Field::from([((24, 48), [0.0, 0.0]), ((0, 0), [1.0, 1.0])]);
        assert_eq!(error(&[moved], &[2], &rest), (0.3125_f64 / 4.0).sqrt());
    }
}
