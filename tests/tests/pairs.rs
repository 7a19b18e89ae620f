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
