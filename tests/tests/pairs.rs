//! What is told about the pairs of surfaces of a scene before it runs.

mod support;

use support::two_blocks;

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

/// Surfaces that look past each other are told, whichever of them is the slave; those that touch are not.
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
