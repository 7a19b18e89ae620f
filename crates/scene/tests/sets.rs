//! Expressions over sets: what is read, under which name the scene keeps it, and what is refused.

use stoss_scene::{RegionKind, Scene, SceneErrors, SetRegion, parse};

const STATIC: &str = include_str!("data/quasi-static.toml");

/// The press with another set and other text before it.
fn with(set: &str, before: &str) -> Result<Scene, SceneErrors> {
    let set = format!("set = {set:?}\ncomponents = [\"z\"]");
    parse(&(before.to_owned() + &STATIC.replacen("set = \"block.top\"\ncomponents = [\"z\"]", &set, 1)), "x.toml")
}

fn read(set: &str, before: &str) -> Scene {
    with(set, before).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The tree in brackets.
fn tree(region: &SetRegion) -> String {
    let list =
        |word: &str, inner: &[SetRegion]| format!("({word} {})", inner.iter().map(tree).collect::<Vec<_>>().join(" "));
    match &region.kind {
        RegionKind::Set(name) => name.clone(),
        RegionKind::Comparison { difference, relation } => {
            format!("[{:?} {:?}]", relation, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|x| difference.value(&x)))
        }
        RegionKind::Nearest { within, point } => format!("(nearest {} {point:?})", tree(within)),
        RegionKind::Normal { within, direction, degrees } => {
            format!("(normal {} {direction:?} {degrees})", tree(within))
        }
        RegionKind::Not(inner) => format!("(not {})", tree(inner)),
        RegionKind::All(inner) => list("and", inner),
        RegionKind::Any(inner) => list("or", inner),
    }
}

#[test]
fn expressions_have_their_trees() {
    for (text, expected) in [
        ("block.top & x > 0.2", "(and top [Greater [0.8, -0.2]])"),
        ("block.top | block.left & block.right", "(or top (and left right))"),
        ("(block.top | block.left) & block.right", "(and (or top left) right)"),
        ("block.top - block.left - block.right", "(and top (not left) (not right))"),
        ("!block.top & !!x=1", "(and (not top) (not (not [Equal [0.0, -1.0]])))"),
        ("block.all & (x + y)*2 != half", "(and all [NotEqual [1.5, 1.5]])"),
        ("block.all & ((x + y) < 1 | (y >= 2))", "(and all (or [Less [0.0, 0.0]] [GreaterOrEqual [-2.0, -1.0]]))"),
        ("block.top & 0 <= x < 1", "(and top (and [LessOrEqual [-1.0, 0.0]] [Less [0.0, -1.0]]))"),
        ("nearest(block, 0.1, half, -1e-1)", "(nearest all [0.1, 0.5, -0.1])"),
        ("nearest(block.top & x = 0, 0, 0, 1)", "(nearest (and top [Equal [1.0, 0.0]]) [0.0, 0.0, 1.0])"),
        ("normal(block, 0, 0, 1, 30)", "(normal all [0.0, 0.0, 1.0] 30)"),
        ("block.(top) & x > 0", ""),
        ("block.(block.top | x > 0)", "(or top [Greater [1.0, 0.0]])"),
        ("block.'odd & name' & x-0.5 > 0", "(and odd & name [Greater [0.5, -0.5]])"),
        ("block.set-1.2 & x > 0", "(and set-1.2 [Greater [1.0, 0.0]])"),
        ("left-half | upper", "(or left-half upper)"),
    ] {
        let before = "[sets]\nleft-half = \"block.all & x < half\"\nupper = \"block.top\"\n[parameters]\nhalf = 0.5\n";
        match with(text, before) {
            Ok(scene) => {
                let set = scene.prescriptions[1].set.as_deref().unwrap();
                let found = scene.set_expressions().iter().find(|found| found.reference() == set).unwrap();
                assert_eq!((tree(&found.region).as_str(), found.part.as_str()), (expected, "block"), "{text}");
                // What the scene keeps is read again as the same.
                let written = toml::to_string(&scene).unwrap();
                let again = parse(&written, "written").unwrap_or_else(|errors| panic!("{text}: {errors}"));
                assert_eq!(again, scene, "{text}");
                assert_eq!(again.set_expressions().len(), scene.set_expressions().len(), "{text}");
            }
            Err(errors) => assert!(expected.is_empty(), "{text}: {errors}"),
        }
    }
}

#[test]
fn plain_names_stay_what_they_are() {
    for name in ["block.top", "block.a.b-c_d", "block.set 1", "block.2x", "block.a+b"] {
        let scene = read(name, "");
        assert_eq!(scene.prescriptions[1].set.as_deref(), Some(name));
        assert!(scene.set_expressions().is_empty());
    }
}

#[test]
fn names_of_the_table_are_sets_of_their_part() {
    // In any order; each stands behind those that it uses.
    let before = "[sets]\na = \"b & y > 0.5\"\nb = \"block.top & x < 0.5\"\n";
    for name in ["a", "block.a"] {
        let scene = read(name, before);
        assert_eq!(scene.prescriptions[1].set.as_deref(), Some("block.a"));
        let names: Vec<_> = scene.set_expressions().iter().map(|set| set.reference()).collect();
        assert_eq!(names, ["block.b", "block.a"]);
    }
    let scene = read("a | b", before);
    assert_eq!(scene.prescriptions[1].set.as_deref(), Some("block.(a | b)"));
}

#[test]
fn mistakes_are_told_with_their_place() {
    let mut failures = Vec::new();
    for (text, message) in [
        ("block.top & ", "character 12: ends too early"),
        ("block.top & x", "character 14: a comparison is missing"),
        ("block.top & x >", "character 16: ends too early"),
        ("block.top & (x > 1", "character 19: a closing bracket"),
        ("block.top x > 1", "character 11: an operator is missing"),
        ("block.top & xx > 1", "character 13: `xx` is not a coordinate"),
        ("blok.top & x > 1", "there is no part `blok`"),
        ("block.top & corner.top", "character 13: has sets of `block` and of `corner`"),
        ("x > 1", "names no part"),
        ("nearest(block, 1, 2)", "character 20: an argument is missing"),
        ("nearest(block, x, 0, 0)", "character 16: must be a finite number"),
        ("normal(block, 0, 0, 0, 30)", "the direction is zero"),
        ("normal(block, 0, 0, 1, 200)", "character 22: the angle 200"),
        ("block.'' & x > 0", "character 7: a name in single quotes"),
        ("block. & x > 0", "character 7: the name of a set is missing"),
        ("block.top & sqrt x > 1", "character 18: `sqrt` needs"),
        ("block.top & y > 1/0", ""),
    ] {
        match with(text, "") {
            Ok(_) => assert!(message.is_empty(), "{text}"),
            Err(errors) => {
                let problem = &errors.problems()[0];
                let good = problem.key == "prescribe[1].set" && problem.message.starts_with(message);
                if !good || message.is_empty() || errors.problems().len() != 1 {
                    failures.push(format!("{text}: {message:?}, but {errors}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    let deep = format!("{}block.top{} & x > 0", "(".repeat(100_000), ")".repeat(100_000));
    assert!(with(&deep, "").is_err());
    assert!(with(&"!".repeat(100_000), "").is_err());
}

#[test]
fn mistakes_of_the_table_are_reported_once() {
    for (table, key) in [
        ("a = \"b & x > 0\"\nb = \"block.top | a\"", "sets.a"),
        ("x = \"block.top\"", "sets.x"),
        ("pi = \"block.top\"", "sets.pi"),
        ("block = \"block.top\"", "sets.block"),
        ("a = 1", "sets.a"),
        ("a = \"top\"", "sets.a"),
        ("a = \"y > 0\"\nb = \"a & x > 0\"", "sets.a"),
    ] {
        let errors = with("block.top", &format!("[sets]\n{table}\n")).unwrap_err();
        let keys: Vec<_> = errors.problems().iter().map(|problem| problem.key.as_str()).collect();
        assert_eq!(keys, [key], "{table}: {errors}");
    }
    let errors = parse(&format!("sets = 3\n{STATIC}"), "x.toml").unwrap_err();
    assert_eq!(errors.problems()[0].key, "sets");
}
