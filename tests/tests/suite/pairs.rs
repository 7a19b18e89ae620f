//! What is reported about the pairs of surfaces of a scene before it runs.

use crate::support::two_blocks;

/// Both surfaces of a contact as the slave of the other: told where neither may be penetrated, and nothing where springs hold one of them.
#[test]
fn two_contacts_with_exchanged_surfaces_are_told() {
    let warnings = |contacts: &str| {
        let text = two_blocks("backward-euler", 0.01, 1.0, [0.0; 3], "method = \"nts\"");
        let scene = stoss::scene::parse(&format!("{text}\n{contacts}"), "test.toml").unwrap();
        stoss::build::build(&scene, std::path::Path::new(".")).unwrap().warnings
    };
    let other = "[[contact]]\nmethod = \"nts\"\nslave = \"lower.top\"\nmaster = \"upper.bottom\"\nname = \"other\"\n";
    let told = warnings(other);
    assert!(told.len() == 1 && told[0].starts_with("other is ") && told[0].contains("exchanged"), "{told:?}");
    let springs = format!("{other}enforcement = {{ penalty = 1e4 }}\n");
    assert_eq!(warnings(&springs), Vec::<String>::new());
}

/// Surfaces that look past each other are reported, whichever of them is the slave; those that touch are not.
#[test]
fn surfaces_that_do_not_face_each_other_are_told() {
    let warnings = |slave: &str, master: &str, method: &str| {
        let contact = format!("slave = \"{slave}\"\nmaster = \"{master}\"\nmethod = \"{method}\"");
        let scene = two_blocks("energy-momentum", 0.1, 1.0, [0.0; 3], "")
            .replace("slave = \"upper.bottom\"\nmaster = \"lower.top\"", &contact);
        let scene = stoss::scene::parse(&scene, "test.toml").unwrap();
        stoss::build::build(&scene, std::path::Path::new(".")).unwrap().warnings
    };
    for method in ["mortar", "nts"] {
        assert_eq!(warnings("upper.bottom", "lower.top", method), Vec::<String>::new());
        assert_eq!(warnings("upper.boundary", "lower.top", method), Vec::<String>::new());
        for (slave, master) in [("upper.left", "lower.top"), ("lower.top", "upper.left"), ("upper.top", "lower.top")] {
            let told = warnings(slave, master, method);
            let is_told = told.iter().any(|warning| warning.contains("no facet of the slave faces"));
            assert!(is_told, "{method}, {slave}, {master}: {told:?}");
        }
    }
}

/// `between` leaves the choice of the slave open: not the prescribed surface, else the finer one, else the softer one, else the first.
#[test]
fn the_slave_of_between_is_chosen() {
    let text = |divisions: [usize; 2], young: [f64; 2], held: &str| {
        let body = |k: usize| {
            format!(
                "[[body]]\nname = \"{}\"\nmesh = {{ generator = \"block\", min = [0, 0, {}], max = [1, 1, {}], divisions = [{n}, {n}, 1] }}\n\
                 material = {{ law = \"neo-hooke\", young = {:?}, poisson = 0.3 }}\ndensity = 1.0\n",
                ["a", "b"][k],
                [1.1, 0.0][k],
                [2.1, 1.0][k],
                young[k],
                n = divisions[k],
            )
        };
        format!(
            "[scene]\ntitle = \"choice\"\nkind = \"dynamic\"\n[time]\nend = 0.1\nstep = 0.1\nintegrator = {{ scheme = \"energy-momentum\" }}\n{}{}\
             [[contact]]\nmethod = \"mortar\"\nbetween = [\"a.bottom\", \"b.top\"]\n{held}",
            body(0),
            body(1)
        )
    };
    let held = "[[prescribe]]\nset = \"b.all\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n";
    for (text, expected) in [
        (text([2, 4], [1e3, 1e3], held), "a.bottom (the other one is prescribed)"),
        (text([2, 4], [1e3, 1e5], ""), "b.top (finer)"),
        (text([2, 2], [1e5, 1e3], ""), "b.top (softer)"),
        (text([2, 2], [1e3, 1e3], ""), "a.bottom (both are alike)"),
    ] {
        let scene = stoss::scene::parse(&text, "choice.toml").unwrap();
        let built = stoss::build::build(&scene, std::path::Path::new(".")).unwrap();
        assert_eq!(built.contacts[0].slave.as_deref(), Some(expected));
    }
}
