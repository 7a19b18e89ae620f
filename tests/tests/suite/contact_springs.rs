//! Contact by springs, and overlaps that were there before.

use crate::support::simulation;

fn cube(name: &str, z: f64, young: f64) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [0, 0, {z:?}], max = [1, 1, {:?}], divisions = [2, 2, 2] }}\n\
         material = {{ law = \"saint-venant-kirchhoff\", young = {young:?}, poisson = 0.0 }}\ndensity = 1.0\n",
        z + 1.0
    )
}

fn held(set: &str, component: &str) -> String {
    format!("[[prescribe]]\nset = \"{set}\"\ncomponents = [\"{component}\"]\nfixed = true\n")
}

/// A body at rest on mortar contact with springs stays where they carry its weight, however many steps there are: with 1 of weight over an area of 1 by 1e-5 below the floor.
#[test]
fn springs_of_mortar_do_not_sink() {
    let text = "[scene]\ntitle = \"rest\"\nkind = \"dynamic\"\n[time]\nend = 4.0\nstep = 0.04\nintegrator = { scheme = \"backward-euler\" }\n\
         [gravity]\nacceleration = [0, 0, -1]\n[[rigid]]\nname = \"floor\"\nshape = { kind = \"plane\", size = [4, 4] }\nfixed = true\n"
        .to_owned()
        + &cube("b", 0.0, 1000.0)
        + "[[contact]]\nmethod = \"mortar\"\nslave = \"b.bottom\"\nmaster = \"floor.boundary\"\nenforcement = { penalty = 1e5 }\n";
    let mut run = simulation(&text);
    while !run.finished() {
        run.advance().unwrap_or_else(|e| panic!("{e}"));
    }
    let (reference, q) = (&run.model().reference, &run.state().q);
    let bottom = run.model().bodies[0].nodes.clone().filter(|&n| reference[3 * n as usize + 2] == 0.0);
    let lowest = bottom.map(|n| q[3 * n as usize + 2]).fold(f64::INFINITY, f64::min);
    assert!((lowest + 1e-5).abs() < 2e-6, "{lowest}");
}

/// Three cubes in a row between walls; the middle one overlaps the first by 0.002, and travels 0.001 to the third before anything carries. Rows are released while it travels, without a pressure; they
/// close again: E (0.002 - 0.001) / 3 of force.
#[test]
fn what_was_released_while_a_body_travels_closes_again() {
    for method in ["nts", "cat", "mortar"] {
        let contact = |slave: &str, master: &str| {
            format!("[[contact]]\nmethod = \"{method}\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n")
        };
        let mut text =
            "[scene]\ntitle = \"travel\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.5\n".to_owned();
        for (name, z) in [("a", 0.0), ("b", 0.998), ("c", 1.999)] {
            text +=
                &(cube(name, z, 1000.0) + &held(&format!("{name}.left"), "x") + &held(&format!("{name}.front"), "y"));
        }
        text += &(held("a.bottom", "z")
            + &held("c.top", "z")
            + &contact("a.top", "b.bottom")
            + &contact("b.top", "c.bottom"));
        let mut run = simulation(&text);
        let mut force = 0.0;
        while !run.finished() {
            let record = run.advance().unwrap_or_else(|e| panic!("{method}: {e}"));
            force = record.contact.unwrap().pairs[0].force[2];
        }
        assert!((f64::abs(force) / (1000.0 * 0.001 / 3.0) - 1.0).abs() < 2e-3, "{method}: {force}");
    }
}
