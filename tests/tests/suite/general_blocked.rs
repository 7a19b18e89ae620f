//! General contact where a prescribed motion is blocked: the run ends with a diagnosis that names a place, or goes on, whatever is near there.

use crate::failing::run;
use stoss::run::RunError;

/// A soft body that is held at its top, and rigid plates or boxes that move into its sides.
fn scene(body: &str, tools: &[(&str, f64)], shape: &str, step: f64) -> String {
    let mut text = format!(
        "[scene]\ntitle = \"blocked\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = {step:?}\n[general_contact]\n\
         [[body]]\nname = \"soft\"\n{body}material = {{ law = \"neo-hooke\", young = 0.001, poisson = 0.3 }}\n\
         [[prescribe]]\nset = \"soft.top\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n"
    );
    for (name, side) in tools {
        // The face of a box lies where the plane does.
        let (at, turn) = if shape.contains("box") { (side * 1.25, 0.0) } else { (*side, -90.0 * side) };
        text += &format!(
            "[[rigid]]\nname = \"{name}\"\nshape = {{ {shape} }}\nrotation = {{ axis = [0, 1, 0], degrees = {turn:?} }}\nposition = [{at:?}, 0, -0.9]\n\
             [[prescribe]]\nrigid = \"{name}\"\ncomponents = [\"x\"]\ndisplacement = {{ table = [[0, 0], [1, {:?}]] }}\n",
            -0.5 * side
        );
    }
    text
}

#[test]
fn blocked_motions_are_diagnosed() {
    let block = |n: u32| {
        format!(
            "mesh = {{ generator = \"block\", min = [-1, -1, -1], max = [1, 1, 0], divisions = [{n}, {n}, {n}] }}\n"
        )
    };
    let ball = |n: u32| {
        format!("mesh = {{ generator = \"ball\", radius = 1, part = \"half\", divisions = [{n}, {n}, {n}] }}\n")
    };
    let (plane, cube) = ("kind = \"plane\", size = [3.2, 4]", "kind = \"box\", size = [0.5, 4, 3.2]");
    let (right, left) = (("right", 1.0), ("left", -1.0));
    let mut stopped = 0;
    for body in [block(1), block(2), block(3), ball(1), ball(2)] {
        for tools in [&[right][..], &[right, left]] {
            for shape in [plane, cube] {
                for step in [0.5, 0.05] {
                    let text = scene(&body, tools, shape, step);
                    let left = run(&text);
                    match left.result {
                        Ok(_) => (),
                        Err(RunError::Simulation { .. }) => {
                            stopped += 1;
                            assert!(left.diagnosis.is_some_and(|told| !told.findings.is_empty()), "{text}");
                        }
                        Err(error) => panic!("{error}\n{text}"),
                    }
                }
            }
        }
    }
    assert!(stopped > 10, "{stopped}");
}
