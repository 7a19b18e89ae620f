//! General contact by its defaults: starts at rest, and curved quadratic bodies that touch.

use crate::general_contact::try_build;
use crate::support::simulation;

/// A block that is put on a slope slides with `g (sin - mu cos)`, without a slip velocity in the scene.
#[test]
fn a_block_is_put_on_a_slope() {
    let (degrees, friction, end) = (30.0_f64, 0.25, 0.6);
    let text = format!(
        "[scene]\ntitle = \"slope\"\nkind = \"dynamic\"\n[time]\nend = {end:?}\nstep = 0.01\nintegrator = {{ scheme = \"energy-momentum\" }}\n\
         [gravity]\nacceleration = [0, 0, -9.81]\n[general_contact]\nfriction = {friction:?}\n\
         [[body]]\nname = \"block\"\nmesh = {{ generator = \"block\", min = [-0.5, -0.5, 0], max = [0.5, 0.5, 0.4], divisions = [3, 3, 2] }}\n\
         material = {{ law = \"neo-hooke\", young = 2.1e8, poisson = 0.3 }}\ndensity = 7800\nrotation = {{ axis = [0, 1, 0], degrees = {degrees:?} }}\n\
         [[rigid]]\nname = \"slope\"\nshape = {{ kind = \"plane\", size = [10, 10] }}\nrotation = {{ axis = [0, 1, 0], degrees = {degrees:?} }}\nfixed = true\n"
    );
    let mut simulation = simulation(&text);
    while !simulation.finished() {
        simulation.advance().unwrap_or_else(|e| panic!("{e}"));
    }
    let (sin, cos) = degrees.to_radians().sin_cos();
    let along = 9.81 * (sin - friction * cos) * end;
    let v = &simulation.state().v;
    let count = 4 * 4 * 3;
    let mean = |c: usize| (0..count).map(|k| v[3 * k + c]).sum::<f64>() / f64::from(count as u32);
    let speed = mean(0) * cos - mean(2) * sin;
    assert!((speed / along - 1.0).abs() < 0.03, "{speed} of {along}");
}

/// Chords of curved faces lie outside of the elements: bodies of them may touch all the same, and there is no force at the start.
#[test]
fn curved_quadratic_bodies_may_touch() {
    let material = "material = { law = \"neo-hooke\", young = 1.0, poisson = 0.3 }\n";
    for (mesh, cell) in [
        ("generator = \"ball\", radius = 1.0, divisions = [3, 3, 2]", "hex20"),
        ("generator = \"ball\", radius = 1.0, divisions = [2, 2, 2]", "hex20"),
        ("generator = \"ball\", radius = 1.0, divisions = [3, 3, 2]", "tet10"),
        ("generator = \"cylinder\", radius = 1.0, length = 1.0, divisions = [3, 3, 2, 2]", "hex20"),
    ] {
        let text = format!(
            "[scene]\ntitle = \"round\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\n[general_contact]\n\
             [[body]]\nname = \"round\"\nmesh = {{ {mesh} }}\ncell = \"{cell}\"\n{material}\
             [[rigid]]\nname = \"floor\"\nshape = {{ kind = \"plane\", size = [4, 4] }}\nposition = [0, 0, -1]\nfixed = true\n\
             [[prescribe]]\nset = \"round.outer\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n"
        );
        let mut built = try_build(&text).unwrap_or_else(|e| panic!("{mesh} {cell}: {e}"));
        let record = built.simulation.advance().unwrap_or_else(|e| panic!("{mesh} {cell}: {e}"));
        assert!(record.contact.unwrap().bodies.iter().all(|pair| pair.force == [0.0; 3]), "{mesh} {cell}");
    }
}
