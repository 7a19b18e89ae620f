//! Pretension of a bolt through a scene: against rods in series, its energy, and over a restart.

use std::path::Path;
use stoss::build::{Built, build};
use stoss::run::{RunOptions, run_scene};

const SCENE: &str = include_str!("../../../scenes/bolt.toml");

/// Force of a rod of length 1 of St Venant and Kirchhoff's material without lateral contraction, `E A` times `stretch (stretch^2 - 1) / 2`.
fn rod(stiffness: f64, stretch: f64) -> f64 {
    0.5 * stiffness * stretch * (stretch * stretch - 1.0)
}

/// Root of an increasing function near zero.
fn root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (-0.5, 0.5);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Until the lock the bolt has the given force; then it is in parallel with the member until that is free, and alone from there on. The opening stays. Afterwards
/// everything swings, with constant energy.
#[test]
fn a_bolt_clamps_a_member() {
    let scene = stoss::scene::parse(SCENE, "bolt.toml").unwrap_or_else(|e| panic!("{e}"));
    let Built { mut simulation, schedule, probes, .. } =
        build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    let (bolt, member, preload) = (200.0, 1000.0, 4.0);
    let down = root(|u| rod(member, 1.0 + u) + preload);
    let stretch = root(|e| rod(bolt, 1.0 + e) - preload);
    let opening = down - stretch;
    let (mut energy, mut largest) = (None, 0.0_f64);
    let (mut clamped, mut open, mut swung) = (0, 0, 0.0_f64);
    loop {
        if simulation.finished() && !schedule.advance(&mut simulation).unwrap() {
            break;
        }
        simulation.advance().unwrap();
        let time = simulation.state().time;
        let value = |name: &str| probes.iter().find(|probe| probe.name == name).unwrap().value(&simulation);
        let (force, shut, clamp, lift) = (value("bolt"), value("opening")[0], value("clamp")[2], value("plate")[2]);
        assert!(force[0].abs() < 1e-9 && force[1].abs() < 1e-9, "{force:?}");
        if time <= 1.0 {
            assert!((force[2] - preload * time).abs() < 1e-9 && (clamp - preload * time).abs() < 1e-9);
            continue;
        }
        assert!((shut - opening).abs() < 1e-10, "{time}: {shut} {opening}");
        if time <= 4.0 {
            let load = if time <= 3.0 { 3.0 * (time - 1.0) } else { 6.0 - 4.0 * (time - 3.0) };
            let together = root(|u| rod(bolt, 1.0 + u - opening) + rod(member, 1.0 + u) - load);
            let alone = root(|u| rod(bolt, 1.0 + u - opening) - load);
            let is_open = together > 0.0;
            let u = if is_open { alone } else { together };
            let expected = rod(bolt, 1.0 + u - opening);
            assert!((force[2] - expected).abs() < 1e-8, "{time}: {} {expected}", force[2]);
            assert!((lift - u).abs() < 1e-10 && (clamp - (expected - load)).abs() < 1e-8, "{time}: {clamp}");
            if is_open {
                open += 1;
                assert!((force[2] - load).abs() < 1e-8);
            } else {
                clamped += 1;
                // Springs in series and parallel: F + P k_b / (k_b + k_m), but for the strain of some per cent.
                assert!((force[2] - preload - load / 6.0).abs() < 0.06 * load / 6.0, "{time}: {}", force[2]);
            }
            continue;
        }
        let total = simulation.balance().total();
        largest = largest.max((total - *energy.get_or_insert(total)).abs());
        swung = swung.max((force[2] - preload).abs());
    }
    assert!(clamped >= 6 && open >= 3, "{clamped} {open}");
    // The elastic energy of the preload, F^2/2 (1/200 + 1/1000).
    let scale = 0.5 * preload * preload * (1.0 / bolt + 1.0 / member);
    assert!(swung > 0.2 && largest < 1e-11 * scale, "{swung} {largest:e}");
}

/// The ledger of a tightening with inertia: the work of the bolt's force is what the rods store, the masses have and closing gaps cost.
#[test]
fn the_work_of_the_force_is_in_the_ledger() {
    let dynamic = SCENE
        .replace("kind = \"quasi-static\"\nuntil = 4.0", "kind = \"dynamic\"\nuntil = 4.0\nstep = 0.01")
        .replace("end = 4.5\nstep = 0.25", "end = 0.21\nstep = 0.01")
        .replace("until = 4.5", "until = 0.21")
        .replace("[1.0, 4.0]] }, lock = 1.0", "[0.05, 4.0]] }, lock = 0.1")
        .replace("force = { table = [[1.0, 0, 0, 0], [3.0, 0, 0, 6], [4.0, 0, 0, 2]] }", "force = [0, 0, 0]")
        .replace("until = 4.0\n", "until = 0.2\n");
    let scene = stoss::scene::parse(&dynamic, "bolt.toml").unwrap_or_else(|e| panic!("{e}"));
    let Built { mut simulation, schedule, probes, .. } =
        build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    let (mut largest, mut work, mut locked) = (0.0_f64, 0.0_f64, None);
    loop {
        if simulation.finished() && !schedule.advance(&mut simulation).unwrap() {
            break;
        }
        simulation.advance().unwrap();
        let balance = simulation.balance();
        largest = largest.max((balance.total() + balance.closing_loss + balance.impact_loss).abs());
        work = work.max(balance.external_work);
        let opening = probes[1].value(&simulation)[0];
        if simulation.state().time > 0.1 - 1e-9 {
            assert!((*locked.get_or_insert(opening) - opening).abs() < 1e-12, "{opening}");
        }
    }
    assert!(work > 0.04 && largest < 1e-12, "{work} {largest:e}");
}

/// Interrupted before the lock, at it, behind it, and in the swing: the same bits.
#[test]
fn a_run_resumes_over_the_lock() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, SCENE).unwrap();
    let run = |out: &str, until: Option<f64>, resume: bool| {
        let options = RunOptions { out: folder.path().join(out), until, resume, ..RunOptions::default() };
        run_scene(&path, &options, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
    };
    let read = |out: &str, table: &str| std::fs::read_to_string(folder.path().join(out).join(table)).unwrap();
    run("whole", None, false);
    for until in [0.5, 1.0, 1.5, 4.1] {
        let out = format!("until-{until}");
        run(&out, Some(until), false);
        run(&out, None, true);
        for table in ["balance.csv", "probes.csv", "joints.csv"] {
            assert_eq!(read("whole", table), read(&out, table), "{table}, interrupted at {until}");
        }
    }
}

fn refused(scene: &str) -> String {
    let scene = stoss::scene::parse(scene, "bolt.toml").unwrap_or_else(|e| panic!("{e}"));
    build(&scene, Path::new(".")).map(|_| ()).unwrap_err().to_string()
}

fn warned(scene: &str) -> Vec<String> {
    let scene = stoss::scene::parse(scene, "bolt.toml").unwrap_or_else(|e| panic!("{e}"));
    build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}")).warnings
}

/// An axis from the second side to the first makes a bolt that pushes: refused, with what to write, which is then accepted. So with one side that says nothing,
/// along other axes, and where one half is a beam or a rigid body.
#[test]
fn a_cut_the_other_way_round_is_refused() {
    let sides = r#"between = ["shank.top", "head.bottom"]"#;
    let turned = r#"between = ["head.bottom", "shank.top"]"#;
    let axis = "at = [0.8, 0, 0.5]\naxis = [0, 0, 1]\ncoupling";
    let down = "at = [0.8, 0, 0.5]\naxis = [0, 0, -2]\ncoupling";
    assert!(SCENE.contains(sides) && SCENE.contains(axis));
    assert!(warned(SCENE).is_empty());
    assert!(warned(&SCENE.replace(sides, turned).replace(axis, down)).is_empty());
    for wrong in [SCENE.replace(sides, turned), SCENE.replace(axis, down)] {
        let message = refused(&wrong);
        for part in ["joint[2].between", "push the sides of the cut apart", "write between = ["] {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
    let message = refused(&SCENE.replace(axis, down));
    assert!(message.contains(r#"between = ["head.bottom", "shank.top"], or axis = [0.0, 0.0, 2.0]"#), "{message}");
    // A beam, a rigid body, and the ground, which says nothing, as the shank.
    let start = SCENE.find("[[body]]\nname = \"shank\"").unwrap();
    let end = SCENE.find("[[body]]\nname = \"head\"").unwrap();
    let held = "[[prescribe]]\nset = \"shank.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n";
    assert!(SCENE.contains(held));
    let beam = "[[beam]]\nname = \"shank\"\npoints = [[0.8, 0, 0], [0.8, 0, 0.5]]\nelements = 2\nup = [0, 1, 0]\n\
                section = { shape = \"rectangle\", size = [0.2, 0.2] }\nyoung = 5000.0\npoisson = 0.0\ndensity = 0.1\n\n";
    let rigid = "[[rigid]]\nname = \"shank\"\nshape = { kind = \"box\", size = [0.2, 0.2, 0.5] }\nposition = [0.8, 0, 0.25]\nfixed = true\n\n";
    for (shank, side) in [(beam, "shank.end"), (rigid, "shank"), ("", "ground")] {
        let scene = format!("{}{shank}{}", &SCENE[..start], &SCENE[end..]).replace(held, "").replace("shank.top", side);
        assert!(warned(&scene).iter().all(|warning| !warning.contains("pretension")), "{side}");
        let turned = scene.replace(
            &format!(r#"between = ["{side}", "head.bottom"]"#),
            &format!(r#"between = ["head.bottom", "{side}"]"#),
        );
        assert!(refused(&turned).contains("push the sides of the cut apart"), "{side}");
    }
}

/// A negative force pushes: warned of where the cut is the right way round, and a force that pulls where it is not.
#[test]
fn a_force_that_pushes_is_warned_of() {
    let pushes = SCENE.replace("[1.0, 4.0]] }, lock", "[1.0, -4.0]] }, lock");
    assert_ne!(pushes, SCENE);
    let warnings = warned(&pushes);
    assert!(warnings.iter().any(|w| w.contains("joint[2].pretension.force: a negative force pushes")), "{warnings:?}");
    let sides = r#"between = ["shank.top", "head.bottom"]"#;
    assert!(warned(&pushes.replace(sides, r#"between = ["head.bottom", "shank.top"]"#)).is_empty());
}
