//! `stoss import`: decks that are imported, checked and run, with known answers.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

struct Folder(tempfile::TempDir);

impl Folder {
    /// A folder with a deck of the tests of the crate that imports.
    fn new(deck: &str) -> Folder {
        let folder = Folder(tempfile::tempdir().unwrap());
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../deck-import/tests/data").join(deck);
        std::fs::copy(from, folder.path(deck)).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn stoss(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let command = Command::new(env!("CARGO_BIN_EXE_stoss")).args(arguments).current_dir(self.0.path()).output();
        let Output { status, stdout, stderr } = command.unwrap();
        (status.code(), String::from_utf8([stdout, stderr].concat()).unwrap())
    }

    /// Imports the deck, adds text to the scene and runs it; the last row of `probes.csv` by its heads.
    fn run(&self, deck: &str, more: &str) -> Vec<(String, f64)> {
        let (code, text) = self.stoss(&["import", deck, "-o", "scene.toml"]);
        assert_eq!(code, Some(0), "{text}");
        let (code, text) = self.stoss(&["check", "scene.toml"]);
        assert_eq!(code, Some(0), "{text}");
        let scene = std::fs::read_to_string(self.path("scene.toml")).unwrap();
        std::fs::write(self.path("scene.toml"), format!("{scene}{more}")).unwrap();
        let (code, text) = self.stoss(&["run", "scene.toml", "--out", "out", "--quiet", "--no-report"]);
        assert_eq!(code, Some(0), "{text}");
        let probes = std::fs::read_to_string(self.path("out/probes.csv")).unwrap();
        let mut lines = probes.lines();
        let heads = lines.next().unwrap().split(',').map(str::to_owned);
        heads.zip(lines.next_back().unwrap().split(',').map(|value| value.parse().unwrap())).collect()
    }
}

fn value(row: &[(String, f64)], head: &str) -> f64 {
    row.iter().find(|(name, _)| name == head).unwrap_or_else(|| panic!("no {head} in {row:?}")).1
}

const PRESS: &str = r#"
[[probe]]
name = "floor"
set = "lower.bottom"
quantity = "reaction"
[[probe]]
name = "below"
body = "lower"
point = [0.3, 0.4, 0.8]
quantity = "cauchy_stress"
[[probe]]
name = "above"
body = "upper"
point = [0.7, 0.2, 1.1]
quantity = "cauchy_stress"
"#;

/// The dead pressure 8 on the unit square passes the contact with friction: its sum at the floor, and a uniform stress in both blocks.
#[test]
fn pressed_blocks_have_the_pressure_everywhere() {
    let row = Folder::new("press.inp").run("press.inp", PRESS);
    assert!((value(&row, "floor.z") - 8.0).abs() < 1e-9, "{row:?}");
    // Areas grow by 2 nu p / E.
    let stress = -8.0 / (1.0 + 0.3 * 8.0 / 1e5_f64).powi(2);
    for point in ["below", "above"] {
        assert!((value(&row, &format!("{point}.zz")) - stress).abs() < 1e-5, "{row:?}");
        for across in ["xx", "yy", "xy", "yz", "xz"] {
            assert!(value(&row, &format!("{point}.{across}")).abs() < 1e-5, "{across} {row:?}");
        }
    }
}

const BAR: &str = r#"
[[probe]]
name = "end"
set = "hard.right"
quantity = "displacement"
[[probe]]
name = "joint"
body = "soft"
point = [1, 0, 0]
quantity = "displacement"
[[probe]]
name = "left"
set = "soft.left"
quantity = "reaction"
"#;

/// The second step releases the end and pulls it with forces that make a uniform traction: each half of the bar, of area and length 1, is strained by what its
/// law says, `S = E e`, `F = S (1 + u)`, `e = u + u^2/2`.
#[test]
fn a_bar_of_two_materials_is_pulled() {
    let row = Folder::new("bar.inp").run("bar.inp", BAR);
    let force = 0.9;
    let stretch = |young: f64| {
        let mut u = force / young;
        for _ in 0..20 {
            u = force / young / ((1.0 + u) * (1.0 + 0.5 * u));
        }
        u
    };
    let (soft, hard) = (stretch(1000.0), stretch(3000.0));
    assert!((value(&row, "left.x") + force).abs() < 1e-8, "{row:?}");
    assert!((value(&row, "joint.x") / soft - 1.0).abs() < 1e-7, "{row:?} {soft}");
    assert!((value(&row, "end.x") / (soft + hard) - 1.0).abs() < 1e-7, "{row:?}");
}

/// CAX8R become an axisymmetric section: Lame's tube with open ends and an axial stress `s`, `u = p a ((1 - nu) a^2 + (1 + nu) b^2) / (E (b^2 - a^2)) - nu s a / E` at the bore. Forces on nodes of the deck are those
/// of the whole circumference, reactions of the scene those of a radian.
#[test]
fn a_tube_of_axisymmetric_elements() {
    let more = "[[set]]\nname = \"tube.bore\"\nbody = \"tube\"\nbox = { min = [9.9, -1, 0], max = [10.1, 9, 0] }\n\
                [[set]]\nname = \"tube.floor\"\nbody = \"tube\"\nbox = { min = [0, -1, 0], max = [30, 0.1, 0] }\n\
                [[probe]]\nname = \"bore\"\nset = \"tube.bore\"\nquantity = \"displacement\"\n\
                [[probe]]\nname = \"floor\"\nset = \"tube.floor\"\nquantity = \"reaction\"\n";
    let row = Folder::new("tube.inp").run("tube.inp", more);
    let [a, b, p, s, young, nu] = [10.0_f64, 20.0, 10.0, 2.0, 2e5, 0.3];
    let u = p * a * ((1.0 - nu) * a * a + (1.0 + nu) * b * b) / (young * (b * b - a * a)) - nu * s * a / young;
    assert!((value(&row, "bore.x") / u - 1.0).abs() < 1e-3, "{row:?} {u}");
    assert!((value(&row, "floor.y") / (-0.5 * s * (b * b - a * a)) - 1.0).abs() < 1e-6, "{row:?}");
}

#[test]
fn what_is_left_out_is_said_and_files_stay() {
    let folder = Folder::new("left-out.inp");
    let (code, text) = folder.stoss(&["import", "left-out.inp"]);
    assert_eq!(code, Some(0), "{text}");
    let parts = [
        "missing, so that the verdict of a run is at best doubtful:",
        "left-out.inp:47: *EQUATION: its nodes are not coupled",
        "not as in the deck:",
        "left-out.inp:36: *PLASTIC, HARDENING=COMBINED: of *PLASTIC only isotropic",
        "next: stoss check left-out.toml",
    ];
    let places = parts.map(|part| text.find(part).unwrap_or_else(|| panic!("{part} in\n{text}")));
    assert!(places.is_sorted() && text.matches("of *PLASTIC only isotropic").count() == 1, "{text}");
    assert!(folder.path("left-out.toml").exists() && folder.path("left-out.mesh.inp").exists());
    let (code, text) = folder.stoss(&["import", "left-out.inp"]);
    assert!(code == Some(1) && text.contains("--force"), "{text}");
    assert_eq!(folder.stoss(&["import", "left-out.inp", "--force"]).0, Some(0));
    // Never the deck itself.
    let (code, text) = folder.stoss(&["import", "left-out.inp", "--force", "-o", "left-out.inp"]);
    assert!(code == Some(2) && text.contains("is the deck"), "{text}");
    // From another folder the scene has the whole path.
    std::fs::create_dir(folder.path("sub")).unwrap();
    assert_eq!(folder.stoss(&["import", "left-out.inp", "-o", "sub/scene.toml"]).0, Some(0));
    assert_eq!(folder.stoss(&["check", "sub/scene.toml"]).0, Some(0));
}

#[test]
fn decks_that_cannot_be_read() {
    let folder = Folder::new("bar.inp");
    let (code, text) = folder.stoss(&["import", "none.inp"]);
    assert!(code == Some(1) && text.contains("none.inp"), "{text}");
    let deck = std::fs::read_to_string(folder.path("bar.inp")).unwrap();
    std::fs::write(folder.path("bad.inp"), deck.replace("3000.0, 0.0", "wood, 0.0")).unwrap();
    let (code, text) = folder.stoss(&["import", "bad.inp"]);
    assert!(code == Some(2) && text.contains("bad.inp:92") && !folder.path("bad.toml").exists(), "{text}");
    // A dynamic step needs a density: the scene is there to be mended, and the problem is reported.
    let dynamic = deck.replace("*STATIC\n1.0, 2.0", "*DYNAMIC\n0.1, 2.0");
    std::fs::write(folder.path("light.inp"), dynamic).unwrap();
    let (code, text) = folder.stoss(&["import", "light.inp"]);
    assert!(code == Some(2) && text.contains("density") && folder.path("light.toml").exists(), "{text}");
}

/// Displacements that begin in later steps on nodes that were free before: CalculiX 2.20 with the same increments, in the same law and element, gives these displacements of a
/// corner of the top at the ends of increments, iterated to 1e-10 of the forces (`*CONTROLS, PARAMETERS=FIELD`; its default leaves errors of 1e-5 here).
const LATER: [(f64, [f64; 3]); 11] = [
    (0.5, [8.847701e-3, 8.847701e-3, 3.618302e-2]),
    (1.0, [1.765037e-2, 1.765037e-2, 6.939170e-2]),
    (1.25, [2.083746e-2, 2.083746e-2, 1.020438e-1]),
    (1.75, [2.882034e-2, 2.882034e-2, 1.673479e-1]),
    (2.0, [3.365379e-2, 3.365379e-2, 2.0e-1]),
    (2.5, [5.584526e-2, 4.097784e-4, 3.594324e-2]),
    (3.0, [1.076784e-1, 1.804347e-3, 6.646147e-2]),
    (3.25, [8.807487e-2, 3.638253e-3, 7.484610e-2]),
    (4.0, [4.176710e-2, 9.740661e-3, 1.0e-1]),
    (4.25, [4.176710e-2, 9.740661e-3, 7.5e-2]),
    (5.0, [4.176710e-2, 9.740661e-3, 0.0]),
];

#[test]
fn what_begins_in_a_later_step_begins_where_the_nodes_are() {
    let folder = Folder::new("later.inp");
    folder.run(
        "later.inp",
        "[[probe]]\nname = \"corner\"\nbody = \"Cube\"\npoint = [0, 0, 1]\nquantity = \"displacement\"\n",
    );
    let scene = std::fs::read_to_string(folder.path("scene.toml")).unwrap();
    assert_eq!(scene.matches("ramp_until = ").count(), 3, "{scene}");
    assert!(
        scene.contains("ramp_until = 2.0") && scene.contains("ramp_until = 4.0") && scene.contains("ramp_until = inf"),
        "{scene}"
    );
    let probes = std::fs::read_to_string(folder.path("out/probes.csv")).unwrap();
    let heads: Vec<&str> = probes.lines().next().unwrap().split(',').collect();
    let column =
        |head: &str| heads.iter().position(|other| *other == head).unwrap_or_else(|| panic!("{head} {heads:?}"));
    let columns = ["corner.x", "corner.y", "corner.z"].map(column);
    let rows: Vec<Vec<f64>> =
        probes.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    for (time, wanted) in LATER {
        let row =
            rows.iter().find(|row| row[column("time")] == time).unwrap_or_else(|| panic!("no {time} in {probes}"));
        for (column, wanted) in columns.iter().zip(wanted) {
            assert!((row[*column] - wanted).abs() < 2e-6, "{time}: {} for {wanted}", row[*column]);
        }
    }
}

/// A cube that can only be stretched is a mass of a third of it on a spring `E A / L`. Forces that a dynamic step changes act from its beginning on, with the accelerations that
/// they cause there: the trapezoidal rule for this oscillator gives the displacements at the ends of all increments.
#[test]
fn forces_that_a_dynamic_step_changes_act_at_once() {
    let folder = Folder::new("jump.inp");
    folder.run(
        "jump.inp",
        "[[probe]]\nname = \"top\"\nbody = \"Cube\"\npoint = [0.5, 0.5, 1]\nquantity = \"displacement\"\n",
    );
    let (stiffness, mass, dt) = (1000.0, 1.0 / 3.0, 0.002);
    let [mut time, mut u, mut v] = [1.0, 4e-3 / stiffness, 0.0];
    let mut expected = Vec::new();
    for (force, steps) in [(8e-3, 14), (0.0, 20)] {
        let mut a = (force - stiffness * u) / mass;
        for _ in 0..steps {
            let predicted = u + dt * v + 0.25 * dt * dt * a;
            let next = (force / mass - stiffness / mass * predicted) / (1.0 + 0.25 * dt * dt * stiffness / mass);
            u = predicted + 0.25 * dt * dt * next;
            v += 0.5 * dt * (a + next);
            a = next;
            time += dt;
            expected.push((time, u));
        }
    }
    let probes = std::fs::read_to_string(folder.path("out/probes.csv")).unwrap();
    let heads: Vec<&str> = probes.lines().next().unwrap().split(',').collect();
    let column = |head: &str| heads.iter().position(|other| *other == head).unwrap();
    let (times, tops) = (column("time"), column("top.z"));
    let rows: Vec<Vec<f64>> =
        probes.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    for (time, u) in expected {
        let row = rows.iter().find(|row| (row[times] - time).abs() < 1e-9).unwrap_or_else(|| panic!("{time} {probes}"));
        // Strains of 1e-5 stiffen the cube by as much.
        assert!((row[tops] - u).abs() < 1e-4 * 8e-6, "{time}: {} for {u}", row[tops]);
    }
}

/// A bar of unit area along z with two elements a unit of length, from z = 0 on, without Poisson's effect; `first` is added to the numbers, `z` and `name` to the places and names.
fn bar(name: &str, length: usize, first: usize, z: f64, young: f64) -> String {
    let layers = 2 * length + 1;
    let mut text = String::from("*NODE\n");
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
    for layer in 0..layers {
        for (c, [x, y]) in corners.iter().enumerate() {
            text += &format!("{}, {x}, {y}, {}\n", first + 4 * layer + c + 1, z + 0.5 * layer as f64);
        }
    }
    text += &format!("*ELEMENT, TYPE=C3D8I, ELSET={name}\n");
    for e in 0..layers - 1 {
        let nodes: Vec<String> = (1..=8).map(|n| (first + 4 * e + n).to_string()).collect();
        text += &format!("{}, {}\n", first + e + 1, nodes.join(", "));
    }
    let end = first + 4 * (layers - 1);
    text += &format!("*NSET, NSET={name}-START\n{}, {}, {}, {}\n", first + 1, first + 2, first + 3, first + 4);
    text += &format!("*NSET, NSET={name}-END\n{}, {}, {}, {}\n", end + 1, end + 2, end + 3, end + 4);
    text += &format!(
        "*SURFACE, NAME={name}-LOW\n{}, S1\n*SURFACE, NAME={name}-TOP\n{}, S2\n",
        first + 1,
        first + layers - 1
    );
    text +=
        &format!("*MATERIAL, NAME=M-{name}\n*ELASTIC\n{young}, 0.0\n*SOLID SECTION, ELSET={name}, MATERIAL=M-{name}\n");
    text
}

impl Folder {
    /// A folder with a deck of this text.
    fn with(deck: &str) -> Folder {
        let folder = Folder(tempfile::tempdir().unwrap());
        std::fs::write(folder.path("deck.inp"), deck).unwrap();
        folder
    }

    /// Runs the imported scene; the printed text, the verdict, and the strain energy at the end.
    fn judged(&self) -> (String, serde_json::Value, f64) {
        let (code, text) = self.stoss(&["run", "deck.toml", "--out", "out", "--no-report"]);
        assert_eq!(code, Some(0), "{text}");
        let summary = std::fs::read_to_string(self.path("out/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let balance = std::fs::read_to_string(self.path("out/balance.csv")).unwrap();
        let mut lines = balance.lines();
        let column = lines.next().unwrap().split(',').position(|head| head == "strain").unwrap();
        let energy = lines.next_back().unwrap().split(',').nth(column).unwrap().parse().unwrap();
        (text, summary["verdict"].clone(), energy)
    }
}

/// Energy of a bar of unit area that carries a force: `F^2 L / (2 E)`.
fn bar_energy(force: f64, length: f64, young: f64) -> f64 {
    force * force * length / (2.0 * young)
}

/// The only load acts through a coupling that is not imported: the bar carries nothing where it should have `F^2 L / (2 E A)`, and check, run and verdict say so, until
/// the load is in the scene and the entries are removed.
#[test]
fn a_load_that_is_lost_makes_the_verdict_doubtful() {
    let (force, young) = (2.0, 1e4);
    let deck = bar("B", 3, 0, 0.0, young)
        + "*NODE, NSET=REF\n99, 0.5, 0.5, 4\n*COUPLING, REF NODE=99, SURFACE=B-TOP, CONSTRAINT NAME=C\n*KINEMATIC\n3\n"
        + "*BOUNDARY\nB-START, 1, 3\n*STEP, NLGEOM\n*STATIC\n1., 1.\n*CLOAD\nREF, 3, 2.0\n*NODE PRINT, NSET=REF\nU\n*END STEP\n";
    let folder = Folder::with(&deck);
    let (code, text) = folder.stoss(&["import", "deck.inp"]);
    assert!(code == Some(0) && text.contains("*COUPLING: its nodes are not coupled"), "{text}");
    let (code, text) = folder.stoss(&["check", "deck.toml"]);
    assert_eq!(code, Some(0), "{text}");
    for part in [
        "warning: missing: *COUPLING (deck.inp:",
        "warning: missing: *CLOAD (deck.inp:",
        "lacks 2 things that its deck has",
    ] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    assert!(!text.contains("no problems found") && !text.contains("NODE PRINT"), "{text}");
    let (text, verdict, energy) = folder.judged();
    assert!(energy.abs() < 1e-9 * bar_energy(force, 3.0, young));
    assert!(
        text.contains("warning: missing: *COUPLING") && text.contains("verdict: doubtful: the scene lacks"),
        "{text}"
    );
    assert_eq!(
        (verdict["level"].as_str(), verdict["reasons"][0]["kind"].as_str()),
        (Some("doubtful"), Some("left-out"))
    );
    // Stored results are judged alike.
    assert!(folder.stoss(&["judge", "out"]).1.contains("doubtful: the scene lacks what its deck has: *COUPLING"));

    let scene = std::fs::read_to_string(folder.path("deck.toml")).unwrap();
    let tables = scene.split_inclusive("\n\n").filter(|table| !table.contains("severity = \"missing\""));
    let load = format!("\n[[load]]\nset = \"B.B-TOP\"\ntraction = {{ table = [[0, 0, 0, 0], [1, 0, 0, {force}]] }}\n");
    std::fs::write(folder.path("deck.toml"), tables.collect::<String>() + &load).unwrap();
    let (text, verdict, energy) = folder.judged();
    assert_eq!(verdict["level"], "sound", "{text}");
    // Strains are F / E = 2e-4.
    assert!((energy / bar_energy(force, 3.0, young) - 1.0).abs() < 1e-3, "{energy}");
}

/// A bar between two fixed ends that a pretension pulls: without it the energy is zero and not `F^2 L / (2 E A)`.
#[test]
fn a_pretension_that_is_lost_makes_the_verdict_doubtful() {
    let deck = bar("B", 2, 0, 0.0, 1e4)
        + "*NODE\n99, 0.5, 0.5, 9\n*PRE-TENSION SECTION, SURFACE=B-TOP, NODE=99\n0., 0., 1.\n"
        + "*BOUNDARY\nB-START, 1, 3\nB-END, 1, 3\n*STEP, NLGEOM\n*STATIC\n1., 1.\n*CLOAD\n99, 1, 5.0\n*END STEP\n";
    let folder = Folder::with(&deck);
    assert_eq!(folder.stoss(&["import", "deck.inp"]).0, Some(0));
    let (text, verdict, energy) = folder.judged();
    assert!(energy < 1e-9 * bar_energy(5.0, 2.0, 1e4) && verdict["level"] == "doubtful", "{text}");
    assert!(verdict["reasons"][0]["sentence"].as_str().unwrap().contains("*PRE-TENSION SECTION"), "{verdict}");
}

/// Two bars with a gap, or an overlap, of 0.02, which `ADJUST` closes without strain: pressed with `p` they have the energy `p^2 L / (2 E)` of both, and the end moves by
/// `p L / E`, whatever the gap was. Nothing else holds the upper bar along z.
#[test]
fn adjusted_surfaces_touch_without_strain() {
    let (pressure, young) = (3.0, 1e4);
    for (gap, adjust) in [(0.02, "0.05"), (-0.02, "0.05"), (0.02, "U-START")] {
        let deck = bar("L", 1, 0, 0.0, young)
            + &bar("U", 2, 100, 1.0 + gap, young)
            + "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n"
            + &format!("*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE, ADJUST={adjust}\nU-LOW, L-TOP\n")
            + "*BOUNDARY\nL-START, 1, 3\nU-END, 1, 2\n*STEP, NLGEOM, INC=500, NAME=press\n*STATIC\n0.5, 1.\n*DSLOAD\n"
            + &format!("U-TOP, P, {pressure}\n*END STEP\n");
        let folder = Folder::with(&deck);
        let (code, text) = folder.stoss(&["import", "deck.inp"]);
        assert_eq!(code, Some(0), "{text}");
        assert!(text.contains("4 nodes of U-LOW moved onto L-TOP without strain, by at most 2.000e-2"), "{text}");
        let probe = "\n[[probe]]\nname = \"end\"\nset = \"U.U-TOP\"\nquantity = \"displacement\"\n";
        let scene = std::fs::read_to_string(folder.path("deck.toml")).unwrap();
        std::fs::write(folder.path("deck.toml"), scene + probe).unwrap();
        let (text, verdict, energy) = folder.judged();
        assert_eq!(verdict["level"], "sound", "{text}");
        // The element at the contact has become longer by the gap, or shorter.
        let length = 3.0 + gap;
        let exact = bar_energy(pressure, length, young);
        assert!((energy / exact - 1.0).abs() < 1e-3, "{gap} {adjust}: {energy} for {exact}");
        let probes = std::fs::read_to_string(folder.path("out/probes.csv")).unwrap();
        let end: f64 = probes.lines().next_back().unwrap().split(',').next_back().unwrap().parse().unwrap();
        assert!((end / (-pressure * length / young) - 1.0).abs() < 1e-3, "{gap} {adjust}: {end}");
    }
}

/// The force of a bolt with pretension is that of its node, whatever it stretches; then its shortening, and a motion of the plate to which a reference node couples it, determine the strain.
#[test]
fn a_bolt_with_pretension_and_a_coupled_plate() {
    let folder = Folder::new("bolt.inp");
    let probes = r#"
[[probe]]
name = "base"
set = "Bolt-1.Base"
quantity = "reaction"
[[probe]]
name = "u"
set = "Bolt-1.Cut"
quantity = "displacement"
"#;
    let stress = |e: f64| 100.0 * (e + 0.5 * e * e) * (1.0 + e);
    let row = folder.run("bolt.inp", probes);
    // Both halves are stretched alike: 0.1 is what the cut lost, and 0.05 what the plate moved.
    assert!((value(&row, "base.z") + stress(0.5 * 0.15)).abs() < 1e-9, "{row:?}");
    assert!((value(&row, "u.z") - 0.075).abs() < 1e-12);
    let rows = std::fs::read_to_string(folder.path("out/probes.csv")).unwrap();
    let at_one: Vec<f64> = rows
        .lines()
        .filter_map(|line| line.split(',').map(|v| v.parse().ok()).collect::<Option<Vec<f64>>>())
        .find(|row| row[1] == 1.0)
        .unwrap();
    assert!((at_one[4] + 3.0).abs() < 1e-9, "{at_one:?}");
    let stretch = at_one[7];
    assert!((stress(stretch) - 3.0).abs() < 1e-8, "{at_one:?}");
}
