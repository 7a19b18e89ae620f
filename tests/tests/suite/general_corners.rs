//! Corners and edges of one body on flat faces of another one, without friction: what is flat decides the direction of the force.

use crate::general_contact::{MATERIAL, cube, head};
use crate::support::simulation;

/// A block of 3 x 3 x 1 about the origin that is held at its bottom, with a mesh that matches no cube's.
fn block(young: f64) -> String {
    let material = MATERIAL.replace("young = 1.0", &format!("young = {young:?}"));
    format!(
        "[[body]]\nname = \"block\"\nmesh = {{ generator = \"block\", size = [3.0, 3.0, 1.0], divisions = [5, 5, 2] }}\n{material}\n\
         [[prescribe]]\nset = \"block.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n"
    )
}

/// Sum of the forces of the run on the block times the steps, and the largest part along the surface of any force that is at least a twentieth of the largest, over its normal part.
fn impulse(text: &str) -> ([f64; 3], f64) {
    let mut simulation = simulation(text);
    let mut forces: Vec<[f64; 3]> = Vec::new();
    let (mut sum, mut time) = ([0.0; 3], 0.0);
    while !simulation.finished() {
        let record = simulation.advance().unwrap_or_else(|e| panic!("{e}\n{text}"));
        let step = record.time - time;
        time = record.time;
        for pair in &record.contact.unwrap().bodies {
            forces.push(pair.force);
            sum.iter_mut().zip(pair.force).for_each(|(sum, force)| *sum += step * force);
        }
    }
    let largest = forces.iter().map(|f| f[2].abs()).fold(0.0, f64::max);
    let counted = forces.iter().filter(|f| f[2].abs() > 0.05 * largest);
    (sum, counted.map(|f| f[0].hypot(f[1]) / f[2].abs()).fold(0.0, f64::max))
}

/// Cubes, one above the other's name: how they are turned, and how far their lowest point is below their middle.
fn poses() -> [(&'static str, [f64; 3], f64, f64); 4] {
    let (s, c) = 5.0_f64.to_radians().sin_cos();
    [
        ("vertex", [1.0, -1.0, 0.0], 2.0_f64.sqrt().atan().to_degrees(), 0.5 * 3.0_f64.sqrt()),
        ("edge", [0.0, 1.0, 0.0], 45.0, 0.5 * 2.0_f64.sqrt()),
        ("edge, inclined", [0.0, 1.0, 0.0], 30.0, 0.25 * (1.0 + 3.0_f64.sqrt())),
        ("face, nearly flat", [0.0, 1.0, 0.0], 5.0, 0.5 * (s + c)),
    ]
}

/// The block is a million times as stiff, so that its surface stays a plane: without friction there is no force along it, at rest along the surface or not, whatever is above.
#[test]
fn corners_and_edges_on_a_hard_flat_block_have_no_force_along_it() {
    for (name, axis, degrees, below) in poses() {
        for velocity in [[0.0, 0.0, -0.1], [0.05, 0.03, -0.1]] {
            let cube = cube("cube", [0.11, 0.07, 0.53 + below], axis, degrees, velocity, 2);
            let text = head("energy-momentum", 0.05, 4.0) + &cube + &block(1e6) + "[general_contact]\n";
            let (sum, worst) = impulse(&text);
            let side = sum[0].hypot(sum[1]) / sum[2].abs();
            println!("{name}, {velocity:?}: impulse along over normal {side:.1e}, worst force {worst:.1e}");
            assert!(sum[2].abs() > 0.08, "{name}: hits");
            assert!(side < 2e-4 && worst < 5e-3, "{name}, {velocity:?}: {side:e}, {worst:e}");
        }
    }
}

/// A rigid cube and a soft block: the force along the surface is that of slopes, of the first order in the load. It falls with the speed, by half with half of it but for where it is hit.
#[test]
fn a_rigid_corner_on_a_soft_block_has_the_force_of_its_slopes_alone() {
    for (name, axis, degrees, below) in poses() {
        let side = |speed: f64| {
            let cube = format!(
                "[[rigid]]\nname = \"cube\"\nshape = {{ kind = \"box\", size = [1.0, 1.0, 1.0], divisions = [3, 3, 3] }}\ndensity = 1.0\n\
                 rotation = {{ axis = {axis:?}, degrees = {degrees:?} }}\nposition = [0.11, 0.07, {:?}]\nvelocity = [0.0, 0.0, {:?}]\n",
                0.501 + below,
                -speed
            );
            let text = head("energy-momentum", 0.1, 12.0) + &cube + &block(1.0) + "[general_contact]\n";
            let (sum, worst) = impulse(&text);
            println!(
                "{name}, {speed}: impulse along over normal {:.1e}, worst force {worst:.1e}",
                sum[0].hypot(sum[1]) / sum[2].abs()
            );
            assert!(sum[2].abs() > 0.5 * speed, "{name}: hits");
            worst
        };
        // Strain is of the order of the speed over that of waves, 1.
        let [fast, slow] = [0.004, 0.002].map(side);
        assert!(fast < 0.005 && slow < 0.75 * fast, "{name}: {fast:e}, {slow:e}");
    }
}
