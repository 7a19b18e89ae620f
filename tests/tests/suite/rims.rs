//! Node-to-surface contact where the master ends at an edge of its body: the faces beside the rim belong to it.

use crate::support::simulation;

/// A block that is pressed into a wider and softer slab, the slave, and pushed along it.
fn pushed(method: &str, young: f64, cuts: u32, more: &str) -> String {
    format!(
        "[scene]\ntitle = \"rim\"\nkind = \"quasi-static\"\n[time]\nend = 11.0\nstep = 1.0\nmax_cuts = {cuts}\n\
         [[body]]\nname = \"lower\"\nmesh = {{ generator = \"block\", min = [0, 0, 0], max = [2, 2, 1], divisions = [4, 4, 2] }}\n\
         material = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.3 }}\n\
         [[body]]\nname = \"upper\"\nmesh = {{ generator = \"block\", min = [0.4, 0.5, 1], max = [1.4, 1.5, 2], divisions = [5, 5, 3] }}\n\
         material = {{ law = \"neo-hooke\", young = {young:?}, poisson = 0.3 }}\n\
         [[contact]]\nmethod = \"{method}\"\nslave = \"lower.top\"\nmaster = \"upper.bottom\"\n{more}\
         [[prescribe]]\nset = \"lower.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n\
         [[prescribe]]\nset = \"upper.top\"\ncomponents = [\"x\", \"y\", \"z\"]\n\
         displacement = {{ table = [[0.0, 0.0, 0.0, 0.0], [3.0, 0.0, 0.0, -0.3], [11.0, 0.5, 0.0, -0.3]] }}\n"
    )
}

/// Nodes of the slab that the rim passes over have a gap to the side of the block, small and continuous. (With friction between bodies of one stiffness the last bits decide whether the run ends: 5 of 8 did with the stiffness changed by some 1e-13, and 3 of 8 with other round-off.) With the bottom alone these runs end with "the active set cycles", whatever the step.
#[test]
fn nodes_pass_over_a_rim() {
    let friction = "friction = { law = \"coulomb\", mu = 0.3 }\n";
    for (method, young, cuts, more) in [("nts", 1e6, 0, ""), ("nts", 1e4, 0, ""), ("cat", 1e4, 0, friction)] {
        let mut run = simulation(&pushed(method, young, cuts, more));
        while !run.finished() {
            run.advance().unwrap_or_else(|e| panic!("{method} {young}: {e}"));
        }
    }
}

/// A cube that stands flush on another one, and one that lies 0.01 inside of it: nodes at the rim are carried by the face and not by the sides in whose planes they are.
#[test]
fn flush_cubes_are_carried_by_their_faces() {
    let cube = |name: &str, z: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ generator = \"block\", min = [0, 0, {z:?}], max = [1, 1, {:?}], divisions = [2, 2, 2] }}\n\
             material = {{ law = \"neo-hooke\", young = 1000.0, poisson = 0.0 }}\n",
            z + 1.0
        )
    };
    let pressed = |overlap: f64| {
        let text = "[scene]\ntitle = \"flush\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 1.0\nmax_cuts = 0\n"
            .to_owned()
            + &cube("a", 0.0)
            + &cube("b", 1.0 - overlap)
            + "[[contact]]\nmethod = \"nts\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n\
               [[prescribe]]\nset = \"a.bottom\"\ncomponents = [\"z\"]\nfixed = true\n\
               [[prescribe]]\nset = \"a.left\"\ncomponents = [\"x\"]\nfixed = true\n\
               [[prescribe]]\nset = \"a.front\"\ncomponents = [\"y\"]\nfixed = true\n\
               [[prescribe]]\nset = \"b.left\"\ncomponents = [\"x\"]\nfixed = true\n\
               [[prescribe]]\nset = \"b.front\"\ncomponents = [\"y\"]\nfixed = true\n\
               [[load]]\nset = \"b.top\"\npressure = 0.1\n";
        let mut run = simulation(&text);
        while !run.finished() {
            run.advance().unwrap_or_else(|e| panic!("{overlap}: {e}"));
        }
        let (reference, q) = (&run.model().reference, &run.state().q);
        let top = (0..reference.len() / 3).filter(|n| reference[3 * n + 2] > 1.5 - overlap);
        top.map(|n| q[3 * n + 2] - reference[3 * n + 2]).filter(|u| u.is_finite()).fold(f64::NEG_INFINITY, f64::max)
    };
    // Both cubes are shorter by p L / E.
    let [flush, overlapping] = [0.0, 0.01].map(pressed);
    assert!((flush + 2e-4).abs() < 1e-7, "{flush}");
    assert!((overlapping - flush - 0.01).abs() < 1e-6, "{flush} {overlapping}");
}
