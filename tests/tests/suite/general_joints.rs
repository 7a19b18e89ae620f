//! Bodies that joints connect: whether contact acts between them is said, and what passes through the other one is seen.

use super::general_contact::try_build;
use stoss::run::{RunOptions, run_scene};
use stoss::watch::{Severity, Verdict};

const HEAD: &str = "[scene]\ntitle = \"joints\"\nkind = \"dynamic\"\n[time]\nend = 0.6\nstep = 0.01\nintegrator = { scheme = \"energy-momentum\" }\n\
                    [gravity]\nacceleration = [0, 0, -10]\n[[rigid]]\nname = \"base\"\nshape = { kind = \"box\", size = [2, 2, 0.4] }\nposition = [0, 0, -0.2]\nfixed = true\n";

fn block(min: [f64; 3], max: [f64; 3], divisions: [u32; 3]) -> String {
    format!(
        "[[body]]\nname = \"block\"\nmesh = {{ generator = \"block\", min = {min:?}, max = {max:?}, divisions = {divisions:?} }}\n\
         material = {{ law = \"neo-hooke\", young = 1e4, poisson = 0.3 }}\ndensity = 1.0\n"
    )
}

fn judged(text: &str) -> Verdict {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let options = RunOptions { out: folder.path().join("out"), ..RunOptions::default() };
    run_scene(&path, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}")).verdict
}

/// A block that hangs on a joint, which lets go at once.
fn dropped(min: f64, joint: &str) -> String {
    HEAD.to_owned()
        + &block([-0.3, -0.3, min], [0.3, 0.3, min + 0.6], [2, 2, 2])
        + "[[joint]]\nname = \"hook\"\nkind = \"ball\"\nbetween = [\"base\", \"block.top\"]\nat = [0, 0, 0.9]\n"
        + joint
}

const RELEASE: &str = "[[event]]\nname = \"drop\"\nrelease = \"hook\"\ntime = 0.02\n[watch]\nevery = 1\n";

#[test]
fn a_released_body_lands_on_what_held_it() {
    let text = dropped(0.3, RELEASE);
    let verdict = judged(&text);
    assert_eq!(verdict.level, Severity::Sound, "{verdict}");
    let warnings = try_build(&text).unwrap().warnings;
    assert!(warnings.is_empty(), "{warnings:?}");
    // Without contact it falls through: told, although a joint once connected the two.
    let fallen = judged(&format!("{text}[general_contact]\nenabled = false\n"));
    assert!(fallen.level == Severity::Wrong && fallen.to_string().contains("inside `base`"), "{fallen}");
    // What lies in the other one at the start cannot be kept apart later.
    let warnings = try_build(&dropped(-0.1, RELEASE)).unwrap().warnings;
    assert!(warnings.iter().any(|w| w.contains("`base` and `block`, which overlap")), "{warnings:?}");
}

/// An arm on a hinge that falls over, into what the hinge stands on.
#[test]
fn an_arm_that_falls_through_its_stand_is_seen() {
    let arm = |more: &str| {
        HEAD.replace("end = 0.6", "end = 1.2")
            + &block([-0.1, -0.1, 0.05], [0.1, 0.1, 1.05], [1, 1, 5])
            + "velocity = [0.8, 0, 0]\n[[joint]]\nname = \"h\"\nkind = \"hinge\"\nbetween = [\"base\", \"block.bottom\"]\nat = [0, 0, 0.05]\naxis = [0, 1, 0]\n[watch]\nevery = 1\n"
            + more
    };
    let built = try_build(&arm("")).unwrap();
    assert!(
        built.warnings.iter().any(|w| w.contains("joints connect `base` and `block`")
            && w.contains("pairs = [{ between = [\"base\", \"block\"] }]")),
        "{:?}",
        built.warnings
    );
    let verdict = judged(&arm(""));
    assert!(verdict.level == Severity::Wrong && verdict.to_string().contains("inside `base`"), "{verdict}");
    // Named, it lands.
    let named = arm("[general_contact]\npairs = [{ between = [\"base\", \"block\"] }]\n");
    let warnings = try_build(&named).unwrap().warnings;
    assert!(!warnings.iter().any(|w| w.contains("joints connect")), "{warnings:?}");
    let verdict = judged(&named);
    // On its edge alone it is pushed along the base by some per cent, and that is said.
    assert!(verdict.level < Severity::Wrong, "{verdict}");
}

/// Bars that overlap around their joint: that is what joints are for.
#[test]
fn bars_may_lie_in_each_other_at_their_joint() {
    let bar = |name: &str, x: f64, size: &str, divisions: &str, velocity: &str| {
        format!(
            "[[rigid]]\nname = \"{name}\"\nshape = {{ kind = \"box\", size = {size}, divisions = {divisions} }}\nposition = [{x:?}, 0, 0]\ndensity = 1.0\n{velocity}"
        )
    };
    for (divisions, reach) in [("[1, 1, 1]", 0.5), ("[10, 2, 1]", 0.45), ("[10, 2, 1]", 0.5)] {
        let text = "[scene]\ntitle = \"bars\"\nkind = \"dynamic\"\n[time]\nend = 0.8\nstep = 0.01\nintegrator = { scheme = \"energy-momentum\" }\n".to_owned()
            + &bar("left", -0.5, "[1.0, 0.2, 0.05]", divisions, "fixed = true\n")
            + &bar("right", reach, "[1.0, 0.2, 0.05]", divisions, "angular_velocity = [0, 0, 2]\nvelocity = [0, 1, 0]\n")
                .replace("[0, 1, 0]", &format!("[0, {:?}, 0]", 2.0 * reach))
            + "[[joint]]\nname = \"pin\"\nkind = \"hinge\"\nbetween = [\"left\", \"right\"]\nat = [0, 0, 0]\naxis = [0, 0, 1]\n[watch]\nevery = 1\n";
        let verdict = judged(&text);
        assert_eq!(verdict.level, Severity::Sound, "{divisions} {reach}: {verdict}");
    }
}
