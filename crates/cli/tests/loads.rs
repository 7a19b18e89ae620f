//! Columns, verdicts and resuming of runs with damping, stabilisation and increments that are chosen.

use std::path::Path;
use std::process::{Command, Stdio};

/// Runs a scene as a whole and in parts (resumed at `until`), checks that both have the same bits, and returns the columns of `balance.csv` and the verdict.
fn run(scene: &str, until: &str) -> (Vec<(String, Vec<f64>)>, serde_json::Value) {
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("the temporary folder is writable");
    let stoss = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_stoss"))
            .args([&["run", "scene.toml", "--quiet", "--no-report", "--out"], arguments].concat())
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
            .expect("the program starts");
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    };
    stoss(&["whole"]);
    stoss(&["parts", "--until", until]);
    stoss(&["parts", "--resume"]);
    let read = |out: &str, file: &str| std::fs::read_to_string(Path::new(folder.path()).join(out).join(file)).unwrap();
    let text = read("whole", "balance.csv");
    assert_eq!(text, read("parts", "balance.csv"), "the same bits after resuming");
    let heads: Vec<String> = text.lines().next().unwrap().split(',').map(str::to_owned).collect();
    let column = |at: usize| text.lines().skip(1).map(|row| row.split(',').nth(at).unwrap().parse().unwrap()).collect();
    let columns = heads.iter().enumerate().map(|(at, head)| (head.clone(), column(at))).collect();
    (columns, serde_json::from_str(&read("whole", "summary.json")).unwrap())
}

fn column<'a>(columns: &'a [(String, Vec<f64>)], name: &str) -> &'a [f64] {
    &columns.iter().find(|(head, _)| head == name).unwrap_or_else(|| panic!("no column {name}")).1
}

const FLIGHT: &str = r#"
[scene]
title = "flight"
kind = "dynamic"
[time]
end = 0.2
step = 0.01
integrator = { scheme = "energy-momentum" }
[[body]]
name = "bar"
mesh = { generator = "block", size = [1, 1, 3], divisions = [1, 1, 3] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
density = 1.0
damping = { mass = 0.5, stiffness = 1e-3 }
velocity = [1.0, 2.0, -0.5]
angular_velocity = [2.0, 3.0, 1.0]
[output]
checkpoint_every = 3
"#;

/// Mass-proportional damping takes momentum, which is not held against the run; what it takes of the energy is a column, and the total stays.
#[test]
fn a_damped_flight_is_sound() {
    let (columns, summary) = run(FLIGHT, "0.11");
    let (damping, total) = (column(&columns, "damping"), column(&columns, "total"));
    assert!(damping.windows(2).all(|w| w[1] > w[0]) && damping[0] == 0.0);
    assert!(total.iter().all(|e| (e / total[0] - 1.0).abs() < 1e-12), "{total:?}");
    assert!(column(&columns, "ly").last().unwrap() / column(&columns, "ly")[0] < 0.95);
    assert_eq!(summary["verdict"]["level"], "sound", "{summary}");
    let plain = FLIGHT.replace("damping = { mass = 0.5, stiffness = 1e-3 }\n", "");
    let (columns, _) = run(&plain, "0.11");
    assert!(columns.iter().all(|(head, _)| head != "damping"));
}

#[test]
fn a_stabilised_stage_that_chooses_its_increments_is_resumed_with_the_same_bits() {
    let scene = r#"
[scene]
title = "gap"
kind = "quasi-static"
[time]
end = 1.0
step = 0.25
automatic = { initial = 0.02, smallest = 1e-4 }
stabilise = { fraction = 1e-2 }
[[body]]
name = "block"
mesh = { generator = "block", min = [0, 0, 0.03], max = [1, 1, 1.03], divisions = [2, 2, 2] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[body]]
name = "ground"
mesh = { generator = "block", min = [-1, -1, -1], max = [2, 2, 0], divisions = [3, 3, 1] }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
[[prescribe]]
set = "block.left"
components = ["x"]
fixed = true
[[prescribe]]
set = "block.front"
components = ["y"]
fixed = true
[[prescribe]]
set = "ground.all"
components = ["x", "y", "z"]
fixed = true
[[load]]
set = "block.top"
pressure = { table = [[0, 0], [1, 50.0]] }
[[contact]]
method = "nts"
slave = "block.bottom"
master = "ground.top"
[output]
checkpoint_every = 3
"#;
    let (columns, summary) = run(scene, "0.3");
    assert!(*column(&columns, "stabilisation").last().unwrap() > 0.0);
    let steps = column(&columns, "dt");
    assert!(steps[1] <= 0.02 && steps.iter().any(|dt| *dt > 0.1), "{steps:?}");
    assert!(summary.to_string().contains("stabilisation has dissipated"), "{summary}");
}

/// A block slides on an inclined plane that moves and lets go of it: resumed with the same bits, and the work of the plane is in the ledger.
#[test]
fn a_guide_that_moves_and_is_released_is_resumed_with_the_same_bits() {
    let scene = r#"
[scene]
title = "guide"
kind = "dynamic"
[time]
end = 0.2
step = 0.01
integrator = { scheme = "energy-momentum" }
[[body]]
name = "bar"
mesh = { generator = "block", size = [1, 1, 1], divisions = [2, 2, 2] }
rotation = { axis = [0, 1, 0], degrees = 30 }
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
density = 1.0
[[prescribe]]
name = "lift"
set = "bar.bottom"
normal = ["sin(pi / 6)", 0, "cos(pi / 6)"]
displacement = { table = [[0.0, 0.0], [0.1, 0.05]] }
[[event]]
name = "release"
release = "lift"
time = 0.15
[[probe]]
name = "force"
set = "bar.bottom"
quantity = "reaction"
[output]
checkpoint_every = 3
"#;
    let (columns, summary) = run(scene, "0.11");
    let (work, total) = (column(&columns, "external_work"), column(&columns, "total"));
    let most = work.iter().copied().fold(0.0, f64::max);
    assert!(most > 0.1);
    // The work of the plane is taken off in `total`.
    assert!(total.iter().all(|value| (value - total[0]).abs() < 1e-11 * most));
    assert_eq!(summary["verdict"]["level"], "sound");
}

/// An arm that a motor turns above a block, which it does not touch.
const MOTOR: &str = r#"
[scene]
title = "motor"
kind = "dynamic"
[time]
end = 0.05
step = 0.01
integrator = { scheme = "energy-momentum" }
[[body]]
name = "block"
mesh = { generator = "block", size = [1, 1, 1], divisions = [1, 1, 1] }
position = [0, 0, -2]
material = { law = "neo-hooke", young = 1000.0, poisson = 0.3 }
density = 1.0
[[prescribe]]
set = "block.bottom"
components = ["x", "y", "z"]
fixed = true
[[rigid]]
name = "arm"
shape = { kind = "box", size = [1, 0.2, 0.2] }
density = 1.0
[[joint]]
name = "shaft"
kind = "hinge"
between = ["ground", "arm"]
at = [0, 0, 0]
axis = [0, 1, 0]
motor = { angle = { table = [[0, 0], [1, 90]] } }
[[contact]]
method = "nts"
slave = "block.top"
master = "arm.bottom"
"#;

#[test]
fn the_work_of_a_motor_is_not_blamed_on_contact() {
    let (columns, summary) = run(MOTOR, "0.02");
    assert!(column(&columns, "kinetic").iter().any(|&kinetic| kinetic > 1e-3), "the motor moves the arm");
    let blamed = |decision: &&serde_json::Value| {
        decision["reason"].as_str().is_some_and(|reason| reason.contains("contact gave"))
    };
    let decisions = summary["decisions"].as_array().expect("a list");
    assert_eq!(decisions.iter().filter(blamed).collect::<Vec<_>>(), Vec::<&serde_json::Value>::new());
}
