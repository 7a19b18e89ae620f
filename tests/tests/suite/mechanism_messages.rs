//! Messages about mechanisms: what is contradictory, singular or without stiffness is named, with a remedy.

use std::path::Path;
use stoss::build::{Built, build};

fn made(text: &str) -> Built {
    let scene = stoss::scene::parse(text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

/// The message with which a run ends.
fn failure(text: &str) -> String {
    outcome(text).expect_err("the run ends without an error")
}

fn outcome(text: &str) -> Result<(), String> {
    let Built { mut simulation, schedule, .. } = made(text);
    loop {
        if simulation.finished() && !schedule.advance(&mut simulation).unwrap() {
            return Ok(());
        }
        if let Err(error) = simulation.advance() {
            return Err(error.to_string());
        }
    }
}

fn body(name: &str, centre: [f64; 3]) -> String {
    format!("[[rigid]]\nname = \"{name}\"\nmass = 1.0\neuler = [0.1, 0.1, 0.1]\ncentre = {centre:?}\n")
}

fn motor(joint: &str, between: &str, at: &str, end: f64) -> String {
    format!(
        r#"
[[joint]]
name = "{joint}"
kind = "hinge"
between = {between}
at = {at}
axis = [0, 0, 1]
motor = {{ angle = {{ table = [[0.0, 0.0], [0.5, 0.0], [1.0, {end:?}]] }} }}
"#
    )
}

const TIME: &str = r#"
[scene]
title = "two motors"
kind = "dynamic"
[time]
end = 1.0
step = 0.05
integrator = { scheme = "energy-momentum" }
"#;

fn statics() -> String {
    TIME.replace("dynamic", "quasi-static").replace("integrator = { scheme = \"energy-momentum\" }\n", "")
}

#[test]
fn motors_that_contradict_each_other_later_are_named() {
    // A parallelogram: one angle, two motors, which agree up to 0.5.
    let bodies = body("crank", [0.0, 0.5, 0.0]) + &body("rocker", [2.0, 0.5, 0.0]) + &body("rod", [1.0, 1.0, 0.0]);
    let joints = r#"
[[joint]]
name = "left"
kind = "ball"
between = ["crank", "rod"]
at = [0, 1, 0]
[[joint]]
name = "right"
kind = "universal"
between = ["rocker", "rod"]
at = [2, 1, 0]
axes = [[0, 0, 1], [0, 1, 0]]
"#;
    let drives = motor("drive-a", r#"["ground", "crank"]"#, "[0, 0, 0]", 30.0)
        + &motor("drive-b", r#"["ground", "rocker"]"#, "[2, 0, 0]", 40.0);
    let message = failure(&format!("{TIME}{bodies}{joints}{drives}"));
    assert!(message.contains("drive-a") && message.contains("drive-b"), "{message}");
    assert!(message.contains("contradict another joint, motor or support") && !message.contains("master"), "{message}");
}

#[test]
fn a_mechanism_in_line_is_named() {
    // A crank of 1 and a rod of 2, whose slider is driven to 3, where they are in line.
    let x = 3.0_f64.sqrt();
    let bodies = body("crank", [0.0, 0.5, 0.0]) + &body("rod", [0.5 * x, 0.5, 0.0]) + &body("slide", [x, 0.0, 0.0]);
    // A step that ends in line is passed by some schemes; beyond there is no configuration.
    for (end, schemes) in [
        (3.0 - x, &["backward-euler", "generalised-alpha"][..]),
        (3.5 - x, &["energy-momentum", "backward-euler", "midpoint", "generalised-alpha", "statics"]),
    ] {
        let joints = format!(
            r#"
[[joint]]
name = "pin"
kind = "hinge"
between = ["ground", "crank"]
at = [0, 0, 0]
axis = [0, 0, 1]
[[joint]]
name = "knee"
kind = "ball"
between = ["crank", "rod"]
at = [0, 1, 0]
[[joint]]
name = "wrist"
kind = "universal"
between = ["slide", "rod"]
at = [{x:?}, 0, 0]
axes = [[0, 0, 1], [0, 1, 0]]
[[joint]]
name = "guide"
kind = "slider"
between = ["ground", "slide"]
at = [{x:?}, 0, 0]
axis = [1, 0, 0]
motor = {{ displacement = {{ table = [[0.0, 0.0], [1.0, {end:?}]] }} }}
"#
        );
        for scheme in schemes {
            let time = if *scheme == "statics" { statics() } else { TIME.replace("energy-momentum", scheme) };
            let message = failure(&format!("{time}{bodies}{joints}"));
            let named = ["pin", "knee", "wrist", "guide"].iter().any(|name| message.contains(&format!("{name} holds")));
            let named = named || message.contains("largest in equation");
            assert!(named && message.contains("singular position (a mechanism in line)"), "{scheme}: {message}");
            assert!(!message.contains("facet") && !message.contains("contact"), "{scheme}: {message}");
        }
    }
}

#[test]
fn statics_without_stiffness() {
    let ball = |name: &str, part: &str, at: &str| {
        format!("[[joint]]\nname = \"{name}\"\nkind = \"ball\"\nbetween = [\"ground\", \"{part}\"]\nat = {at}\n")
    };
    let string =
        "[[string]]\nname = \"rope\"\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nelements = 4\naxial = 100.0\nmass = 1.0\n";
    let bob = "[[mass]]\nname = \"bob\"\nmass = 1.0\nat = [1, 0, 0]\n[[spring]]\nname = \"s\"\nbetween = [\"ground\", \"bob\"]\nat = [[0, 0, 0], [1, 0, 0]]\nstiffness = 10.0\n";
    for (what, part) in [
        ("s (strings, springs and beams that hold it)", bob.to_owned()),
        (
            "rope (strings, springs and beams that hold it)",
            string.to_owned() + &ball("a", "rope.start", "[0, 0, 0]") + &ball("b", "rope.end", "[1, 0, 0]"),
        ),
        ("no elastic part supports bar", body("bar", [1.0, 0.0, 0.0]) + &ball("pin", "bar", "[1, 0, 2]")),
        ("no elastic part supports bar", body("bar", [1.0, 0.0, 0.0]) + &ball("pin", "bar", "[1, 2, 0]")),
    ] {
        let message = failure(&format!("{}[gravity]\nacceleration = [0, -9.81, 0]\n{part}", statics()));
        for words in [what, "`backward-euler`", "`natural_length`"] {
            assert!(message.contains(words), "{words}: {message}");
        }
    }
}

#[test]
fn initial_velocities_and_motors_that_a_joint_does_not_allow_are_warned_of() {
    let warnings = |velocity: &str, drive: &str| {
        let bar = body("bar", [1.0, 0.0, 0.0]) + velocity;
        let pin = "[[joint]]\nname = \"pin\"\nkind = \"hinge\"\nbetween = [\"ground\", \"bar\"]\nat = [0, 0, 0]\naxis = [0, 0, 1]\n";
        made(&format!("{TIME}{bar}{pin}{drive}")).warnings
    };
    let drive = |start: f64| format!("motor = {{ angle = {{ table = [[0.0, {start:?}], [1.0, 30.0]] }} }}\n");
    // A rotation about the pin with 2 moves the centre with 2 along y.
    let allowed = "velocity = [0, 2, 0]\nangular_velocity = [0, 0, 2]\n";
    assert_eq!(warnings(allowed, ""), Vec::<String>::new());
    assert_eq!(warnings("", &drive(0.0)), Vec::<String>::new());
    let found = warnings("velocity = [0.5, 2, 0]\nangular_velocity = [0, 0, 2]\n", "");
    assert!(found.len() == 1 && found[0].contains("hinge pin") && found[0].contains("5.000e-1"), "{found:?}");
    let found = warnings("angular_velocity = [0, 1, 0]\nvelocity = [0, 0, -1]\n", "");
    assert!(found.len() == 1 && found[0].contains("hinge pin"), "{found:?}");
    let found = warnings("", &drive(5.0));
    assert!(found.len() == 1 && found[0].contains("joint pin: its motor does not begin at zero"), "{found:?}");
}

/// Runs a scene as the program does, and tells level and findings of the verdict.
fn verdict(text: &str) -> (String, String) {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    let out = folder.path().join("out");
    let options = stoss::run::RunOptions { out, ..Default::default() };
    let summary = stoss::run::run_scene(&scene, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
    let value = serde_json::to_value(&summary).unwrap();
    (value["verdict"]["level"].as_str().unwrap_or_default().to_owned(), value["verdict"].to_string())
}

/// Two boxes of edge 1 that overlap by 0.4 about the point (0.8, 0, 0), with a joint there or without.
fn overlapping(joint: &str) -> String {
    let shape = "shape = { kind = \"box\", size = [1, 1, 1], divisions = [2, 2, 2] }\ndensity = 1.0\n";
    let part = |name: &str, x: f64| format!("[[rigid]]\nname = \"{name}\"\n{shape}position = [{x:?}, 0, 0]\n");
    format!("{TIME}{}{}{joint}", part("a", 0.5), part("b", 1.1))
}

#[test]
fn shapes_may_lie_in_each_other_where_a_joint_holds_them_and_only_then() {
    let joint = "[[joint]]\nname = \"knee\"\nkind = \"ball\"\nbetween = [\"a\", \"b\"]\nat = [0.8, 0, 0]\n";
    let (level, text) = verdict(&overlapping(joint));
    assert_eq!(level, "sound", "{text}");
    let (level, text) = verdict(&overlapping(""));
    assert!(level != "sound" && text.contains('a') && text.contains('b'), "{text}");
}

#[test]
fn what_is_at_rest_is_sound() {
    let bar = body("bar", [0.0, -1.0, 0.0]);
    let pin = "[[joint]]\nname = \"pin\"\nkind = \"hinge\"\nbetween = [\"ground\", \"bar\"]\nat = [0, 0, 0]\naxis = [0, 0, 1]\n";
    for scheme in ["energy-momentum", "backward-euler", "generalised-alpha", "newmark", "midpoint"] {
        let time = TIME.replace("energy-momentum", scheme);
        for (what, scene) in [
            ("hangs", format!("{time}[gravity]\nacceleration = [0, -9.81, 0]\n{bar}{pin}")),
            ("floats", format!("{time}{bar}")),
        ] {
            let (level, text) = verdict(&scene);
            assert_eq!(level, "sound", "{what}, {scheme}: {text}");
        }
    }
}

/// A disc that spins freely with 0.5 rad a step: the end-point schemes give it many times its energy.
#[test]
fn energy_from_nowhere_is_wrong() {
    let spin = "[[rigid]]\nname = \"top\"\nmass = 1.0\neuler = [0.4, 0.2, 0.1]\ncentre = [0, 0, 0]\nangular_velocity = [3, 6, 8]\n";
    for scheme in ["newmark", "generalised-alpha"] {
        let time = TIME.replace("energy-momentum", scheme).replace("end = 1.0", "end = 20.0");
        let (level, text) = verdict(&format!("{time}{spin}"));
        println!("{scheme} {text}");
        assert_eq!(level, "wrong", "{scheme}: {text}");
    }
    let (level, text) = verdict(&format!("{TIME}{spin}"));
    assert_eq!(level, "sound", "{text}");
}

/// A probe on which an event depends is part of what is computed.
#[test]
fn resuming_with_another_probe_of_an_event_is_refused() {
    let scene = |quantity: &str, more: &str| {
        let pin = "[[joint]]\nname = \"pin\"\nkind = \"ball\"\nbetween = [\"ground\", \"bar\"]\nat = [0, 0, 0]\n";
        let probe = format!("[[probe]]\nname = \"p\"\nquantity = \"{quantity}\"\nbody = \"bar\"\n");
        let event = "[[event]]\nname = \"let-go\"\nrelease = \"pin\"\nwhen = { probe = \"p\", component = \"y\", below = -10.0 }\n";
        let text = format!("{TIME}{}{pin}{probe}{more}{event}", body("bar", [1.0, 0.0, 0.0]));
        stoss::output::SceneIdentity::new(&stoss::scene::parse(&text, "test.toml").unwrap(), &[]).unwrap()
    };
    let other = "[[probe]]\nname = \"e\"\nquantity = \"energy\"\n";
    let before = scene("velocity", "");
    assert_eq!(scene("velocity", other).changes(&before), "");
    assert_eq!(scene("velocity", other).hash(), before.hash());
    let changes = scene("position", other).changes(&before);
    assert_eq!(changes, "probe.p.quantity: \"velocity\" -> \"position\"");
}

#[test]
fn a_rigid_slave_whose_motion_is_prescribed_is_refused_with_a_rigid_master() {
    let shape = "shape = { kind = \"box\", size = [1, 1, 1], divisions = [2, 2, 2] }\ndensity = 1.0\n";
    let part = |name: &str, z: f64| format!("[[rigid]]\nname = \"{name}\"\n{shape}position = [0, 0, {z:?}]\n");
    let scene = |slave: &str, master: &str| {
        let contact = format!("[[contact]]\nmethod = \"mortar\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n");
        let held = "[[prescribe]]\nrigid = \"lower\"\nfixed = true\n";
        let text = format!("{TIME}{}{}{held}{contact}", part("lower", 0.0), part("upper", 1.1));
        let scene = stoss::scene::parse(&text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
        build(&scene, Path::new(".")).map(|_| ()).map_err(|error| error.to_string())
    };
    let refused = scene("lower.top", "upper.bottom").unwrap_err();
    assert!(refused.contains("contact[0]") && refused.contains("the pressures are not determined"), "{refused}");
    assert_eq!(scene("upper.bottom", "lower.top"), Ok(()));
}

/// Joints between things that cannot move, or move as prescribed, determine nothing and are in no equation. They have to hold all the same.
#[test]
fn motion_that_is_prescribed_against_a_joint_is_refused() {
    let held = body("r", [0.0; 3]);
    let prescribed =
        "[[prescribe]]\nrigid = \"r\"\ncomponents = [\"z\"]\ndisplacement = { table = [[0, 0], [1, 1]] }\n";
    for (kind, axis, allowed) in
        [("weld", "", false), ("slider", "axis = [1, 0, 0]\n", false), ("slider", "axis = [0, 0, 1]\n", true)]
    {
        let joint = format!(
            "[[joint]]\nname = \"guide\"\nkind = \"{kind}\"\nbetween = [\"r\", \"ground\"]\nat = [0, 0, 0]\n{axis}"
        );
        let result = outcome(&format!("{TIME}{held}{joint}{prescribed}"));
        assert_eq!(result.is_ok(), allowed, "{kind} {axis}: {result:?}");
        if let Err(message) = result {
            assert!(message.contains("guide") && message.contains("prescribed"), "{message}");
        }
    }
}

/// The ends of a string in a plane: the equation across the plane says what the support says.
#[test]
fn an_equation_about_held_components_alone_is_left_out() {
    let ends = |y: &str| {
        format!(
            r#"{TIME}
[gravity]
acceleration = [0, 0, -10]
[[string]]
name = "s"
points = [[0, 0, 0], [2, 0, 0]]
elements = 4
axial = 1000.0
mass = 0.5
natural_length = 1.9
[[joint]]
name = "left"
kind = "ball"
between = ["s.start", "ground"]
at = [0, 0, 0]
[[joint]]
name = "right"
kind = "ball"
between = ["s.end", "ground"]
at = [2, 0, 0]
[[prescribe]]
set = "s.all"
components = ["y"]
{y}
"#
        )
    };
    outcome(&ends("fixed = true")).unwrap();
    let quasi_static = ends("fixed = true").replace("dynamic", "quasi-static");
    outcome(&quasi_static.replace("integrator = { scheme = \"energy-momentum\" }\n", "")).unwrap();
    let message = outcome(&ends("displacement = { table = [[0, 0], [1, 0.1]] }")).unwrap_err();
    assert!(message.contains("prescribed") && (message.contains("left") || message.contains("right")), "{message}");
}
