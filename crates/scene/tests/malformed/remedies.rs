//! What the remedies of malformed scenes name.

use super::DYNAMIC;
use stoss_scene::parse;

#[test]
fn remedies_name_what_was_probably_meant() {
    for (from, to, hint) in [
        ("density = 10.0", "desnity = 10.0", "`density`"),
        ("\"energy-momentum\"", "\"energy-momentun\"", "did you mean `energy-momentum`"),
        ("master = \"plate.top\"", "master = \"plat.top\"", "did you mean `plate`"),
        ("generator = \"block\"", "generator = \"blok\"", "did you mean `block`"),
        ("\"energy-momentum\"", "\"bdf2\"", "`midpoint`"),
        ("[output]", "[outputs]", "did you mean `output`"),
        ("[scene]\n", "[scene]\nunits = \"mm-t\"\n", "did you mean `mm-t-s`"),
    ] {
        let errors = parse(&DYNAMIC.replacen(from, to, 1), "x.toml").unwrap_err();
        assert!(errors.problems().iter().any(|problem| problem.remedy.contains(hint)), "{errors}");
    }
}

#[test]
fn old_keys_and_words_are_told_from_unknown_ones() {
    for (to, message) in [
        ("normals = \"averaged\"", "normals are the means of the facets"),
        ("smoothing = 0.1", "slivers have no pressure"),
        ("constraint = \"one-sided\"", "mortar contact keeps the true gap"),
        ("normal = \"averaged\"", "is an unknown key"),
    ] {
        let errors = parse(&DYNAMIC.replacen("constraint = \"modified\"", to, 1), "x.toml").unwrap_err();
        assert!(errors.problems().iter().any(|problem| problem.message.contains(message)), "{errors}");
    }
    let stages = include_str!("../data/multibody.toml").replacen("kind = \"quasi-static\"", "kind = \"static\"", 1);
    let errors = parse(&stages, "x.toml").unwrap_err();
    let [problem] = errors.problems() else { panic!("{errors}") };
    assert_eq!(
        (problem.key.as_str(), problem.remedy.as_str()),
        ("stage[0].kind", "write \"quasi-static\""),
        "{errors}"
    );
    let newer = parse(&DYNAMIC.replacen("[scene]\n", "[scene]\nformat = 7\n", 1), "x.toml").unwrap_err();
    assert!(newer.problems()[0].message.contains("newer than this program"), "{newer}");
}
