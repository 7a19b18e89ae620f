//! `closing = "restore"` and the other constraints of the bodies that touch.

use std::path::Path;
use stoss::build::build;

const HEAD: &str = r#"
[scene]
title = "a block falls on a floor"
kind = "dynamic"
[time]
end = 0.45
step = 0.0105
integrator = { scheme = "energy-momentum" }
[[rigid]]
name = "floor"
shape = { kind = "plane", size = [10, 10] }
fixed = true
"#;

const SOFT: &str = r#"
[[body]]
name = "block"
mesh = { generator = "block", min = [-0.4, -0.4, 0.12], max = [0.4, 0.4, 0.92], divisions = [2, 2, 2] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.0 }
density = 1.0
velocity = [0, 0, -1.1]
"#;

const RIGID: &str = r#"
[[rigid]]
name = "block"
shape = { kind = "box", size = [0.8, 0.8, 0.8] }
position = [0, 0, 0.52]
density = 1.0
velocity = [0, 0, -1.1]
"#;

const RESTORE: &str = r#"
[[contact]]
method = "mortar"
slave = "block.bottom"
master = "floor.all"
closing = "restore"
"#;

fn built(parts: &[&str]) -> Result<stoss::build::Built, String> {
    let text = parts.concat();
    let scene = stoss::scene::parse(&text, "restore.toml").unwrap_or_else(|e| panic!("{e}"));
    build(&scene, Path::new(".")).map_err(|errors| errors.to_string())
}

/// An impulse on the surfaces alone violates rigidity, joints, ties and supports along normals of their bodies. It is refused beside them, with the constraint and what to write in its place. Beside
/// what is prescribed, supports along axes, and constraints of other bodies it is not.
#[test]
fn restored_energy_is_refused_beside_constraints() {
    let cap = r#"
[[body]]
name = "cap"
mesh = { generator = "block", min = [-0.4, -0.4, 0.92], max = [0.4, 0.4, 1.2], divisions = [2, 2, 1] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.0 }
density = 1.0
velocity = [0, 0, -1.1]
"#;
    let tie = "[[tie]]\nname = \"glue\"\nslave = \"cap.bottom\"\nmaster = \"block.top\"\n";
    let hinge = "[[joint]]\nname = \"hinge\"\nkind = \"hinge\"\nbetween = [\"ground\", \"block.left\"]\nat = [-0.4, 0, 0.52]\naxis = [0, 1, 0]\n";
    let inclined = "[[prescribe]]\nset = \"block.left\"\nnormal = [1, 0, 0.5]\nfixed = true\n";
    let straight = "[[prescribe]]\nset = \"block.left\"\ncomponents = [\"x\"]\nfixed = true\n";
    let other = "[[rigid]]\nname = \"other\"\nshape = { kind = \"box\", size = [1, 1, 1] }\nposition = [5, 5, 5]\ndensity = 1.0\n";
    for (more, body, constraint) in [
        (&[RIGID][..], "`block`", "block (rigidity)"),
        (&[SOFT, cap, tie], "`block`", "glue"),
        (&[SOFT, hinge], "`block`", "block.left"),
        (&[SOFT, inclined], "`block`", "block.left"),
    ] {
        let message = built(&[&[HEAD][..], more, &[RESTORE]].concat()).map(|_| ()).unwrap_err();
        for part in ["contact[0].closing", body, constraint, "constraint = \"modified\""] {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
    for more in [&[SOFT][..], &[SOFT, straight], &[SOFT, other]] {
        built(&[&[HEAD][..], more, &[RESTORE]].concat()).unwrap_or_else(|message| panic!("{message}"));
    }
}

/// What is written in its place gives a rigid box its speed back, wherever in a step it meets the floor, and all its points one velocity.
#[test]
fn a_rigid_box_comes_back_under_the_modified_constraint() {
    let contact = RESTORE.replace("mortar", "nts").replace("closing = \"restore\"", "constraint = \"modified\"");
    for step in ["0.01", "0.0102", "0.0105", "0.0109"] {
        let head = HEAD.replace("0.0105", step);
        let mut simulation = built(&[&head, RIGID, &contact]).unwrap_or_else(|message| panic!("{message}")).simulation;
        while !simulation.finished() {
            simulation.advance().unwrap_or_else(|e| panic!("{step}: {e}"));
        }
        let model = simulation.model();
        let part = model.parts.iter().find(|part| part.name() == "block").unwrap();
        for vector in part.own_vectors() {
            let v = &simulation.state().v[3 * vector as usize..][..3];
            let expected = if part.is_direction(vector) { 0.0 } else { 1.1 };
            assert!(v[0].abs() < 1e-9 && v[1].abs() < 1e-9 && (v[2] - expected).abs() < 1e-9, "{step}: {v:?}");
        }
    }
}
