//! What acts on the displacement of cylindrical joints and on both angles of universal ones, through scenes.

use std::path::Path;
use stoss::build::{Built, build};
use stoss::run::{RunOptions, run_scene};
use stoss::solver::Simulation;

const SLEEVE: &str = r#"
[scene]
title = "sleeve"
kind = "KIND"
[time]
end = 1.0
step = 0.05
INTEGRATOR
[[rigid]]
name = "sleeve"
shape = { kind = "box", size = [1, 1, 1] }
density = 2.0
[[joint]]
name = "guide"
kind = "cylindrical"
between = ["ground", "sleeve"]
at = [0, 0, 0]
axis = [0, 0, 1]
ACTS
[[load]]
set = "sleeve.all"
force = [0, 0, FORCE]
[[probe]]
name = "place"
body = "sleeve"
quantity = "position"
"#;

fn run(text: &str) -> (Simulation, Vec<[f64; 2]>, f64) {
    let scene = stoss::scene::parse(text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    let Built { mut simulation, joints, .. } = build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    let (mut found, start, mut drift) = (Vec::new(), simulation.balance().total(), 0.0_f64);
    while !simulation.finished() {
        let balance = simulation.advance().unwrap().balance;
        drift = drift.max((balance.total() - start).abs());
        let place = joints[0].place;
        let joint = &simulation.model().contacts[place];
        let report = joint.joint(&simulation.state().q, &simulation.pressures()[place]).unwrap();
        assert_eq!(report.coordinates.len(), 2);
        found.push([report.coordinates[0].value, report.coordinates[1].value]);
    }
    (simulation, found, drift)
}

fn sleeve(kind: &str, force: f64, acts: &str) -> (Vec<[f64; 2]>, f64) {
    let integrator = if kind == "dynamic" { "integrator = { scheme = \"energy-momentum\" }" } else { "" };
    let text = SLEEVE.replace("KIND", kind).replace("INTEGRATOR", integrator).replace("ACTS", acts);
    let (_, found, drift) = run(&text.replace("FORCE", &format!("{force:?}")));
    (found, drift)
}

/// Springs, limits, motors and friction along the axis, in statics; the angle has a spring or a motor of its own.
#[test]
fn a_sleeve_in_statics() {
    let turn = "spring = { stiffness = 5.0, rest = 30.0 }\n";
    let last = |acts: &str, force: f64| *sleeve("quasi-static", force, &format!("{turn}{acts}")).0.last().unwrap();
    let near = |found: [f64; 2], expected: [f64; 2]| {
        assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-9), "{found:?}, not {expected:?}");
    };
    let angle = 30f64.to_radians();
    near(last("second = { spring = { stiffness = 40.0, rest = 0.1 } }", 6.0), [angle, 0.1 + 6.0 / 40.0]);
    near(last("second = { spring = { stiffness = 40.0 }, limits = [-0.2, 0.1] }", 6.0), [angle, 0.1]);
    near(last("second = { spring = { stiffness = 40.0 }, limits = [-0.1, 0.2] }", -6.0), [angle, -0.1]);
    near(last("second = { motor = { displacement = { table = [[0, 0], [1, -0.7]] } } }", 6.0), [angle, -0.7]);
    near(last("second = { spring = { stiffness = 40.0 }, friction = { coulomb = 2.0 } }", 6.0), [angle, 0.1]);
    let both = "motor = { angle = { table = [[0, 0], [1, 720]] } }\nsecond = { motor = { displacement = { table = [[0, 0], [1, 0.3]] } } }";
    near(*sleeve("quasi-static", 6.0, both).0.last().unwrap(), [720f64.to_radians(), 0.3]);
}

/// Sliding down with viscous and Coulomb friction: the closed form of the scheme's differences, and the ledger.
#[test]
fn a_sleeve_that_is_braked() {
    // Mass 2: v_mid (1 / h + d / 2 m) per step by the midpoint rule, m (v' - v) / h = F - T - d (v' + v) / 2.
    let (m, h, force, bound, d) = (2.0, 0.05, 6.0, 2.0, 3.0);
    let acts = "second = { friction = { viscous = 3.0, coulomb = 2.0 } }";
    let (found, drift) = sleeve("dynamic", force, acts);
    let (mut v, mut x) = (0.0, 0.0);
    for [angle, displacement] in found {
        let next = ((force - bound) + v * (m / h - 0.5 * d)) / (m / h + 0.5 * d);
        x += 0.5 * h * (v + next);
        v = next;
        assert!((displacement - x).abs() < 1e-10 && angle.abs() < 1e-12, "{displacement} {x}");
    }
    assert!(drift < 1e-11, "{drift:e}");
    // The same load below the bound moves nothing.
    let (found, _) = sleeve("dynamic", 1.9, acts);
    assert!(found.iter().all(|c| c[1].abs() < 1e-12));
}

const CARDAN: &str = r#"
[scene]
title = "cardan"
kind = "quasi-static"
[time]
end = 1.0
step = 0.1
[[rigid]]
name = "shaft"
[[joint]]
name = "cross"
kind = "universal"
between = ["ground", "shaft"]
at = [0, 0, 0]
axes = [[1, 0, 0], [0, 1, 0]]
ACTS
[[probe]]
name = "end"
body = "shaft"
point = [0.3, 0.2, 1.0]
quantity = "position"
"#;

/// Motors on both angles: a point of the shaft is turned about the second pin, then about the first one. With springs both angles are at rest where they have no torque.
#[test]
fn both_angles_of_a_universal_joint() {
    let x = [0.3, 0.2, 1.0];
    for (acts, angles) in [
        (
            "motor = { angle = { table = [[0, 0], [1, 50]] } }\nsecond = { motor = { angle = { table = [[0, 0], [1, -35]] } } }",
            [50.0, -35.0],
        ),
        ("spring = { stiffness = 3, rest = 20 }\nsecond = { spring = { stiffness = 2, rest = -15 } }", [20.0, -15.0]),
        (
            "limits = [-10, 20]\nspring = { stiffness = 3, rest = 24 }\nsecond = { spring = { stiffness = 2, rest = -18 }, limits = [-15, 5] }",
            [20.0, -15.0],
        ),
    ] {
        let [a, b] = angles.map(f64::to_radians);
        let y = [x[0] * b.cos() + x[2] * b.sin(), x[1], x[2] * b.cos() - x[0] * b.sin()];
        let z = [y[0], y[1] * a.cos() - y[2] * a.sin(), y[1] * a.sin() + y[2] * a.cos()];
        let text = CARDAN.replace("ACTS", acts);
        let (simulation, found, _) = run(&text);
        let last = found.last().unwrap();
        assert!((last[0] - a).abs() < 1e-9 && (last[1] - b).abs() < 1e-9, "{last:?}");
        let scene = stoss::scene::parse(&text, "test.toml").unwrap();
        let probes = build(&scene, Path::new(".")).unwrap().probes;
        let end = probes[0].value(&simulation);
        assert!((0..3).all(|i| (end[i] - z[i]).abs() < 1e-9), "{end:?}, not {z:?}");
    }
}

/// Columns of both coordinates, and a run that resumes.
#[test]
fn tables_and_resume() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sleeve.toml");
    let acts =
        "friction = { viscous = 1.0 }\nsecond = { friction = { viscous = 3.0, coulomb = 2.0 }, limits = [-1.0, 0.3] }";
    let text = SLEEVE.replace("KIND", "dynamic").replace("INTEGRATOR", "integrator = { scheme = \"energy-momentum\" }");
    std::fs::write(&path, text.replace("ACTS", acts).replace("FORCE", "6.0")).unwrap();
    let run = |out: &str, until: Option<f64>, resume: bool| {
        let out = folder.path().join(out);
        run_scene(&path, &RunOptions { out, until, resume, ..RunOptions::default() }, &mut |_| {}).unwrap();
    };
    run("whole", None, false);
    run("parts", Some(0.5), false);
    run("parts", None, true);
    let table = |out: &str| std::fs::read_to_string(folder.path().join(out).join("joints.csv")).unwrap();
    assert_eq!(table("whole"), table("parts"));
    let acting = ["friction", "viscous", "spring", "motor", "limit"];
    let mut head = "step,time,guide.fx,guide.fy,guide.fz,guide.mx,guide.my,guide.mz,guide.coordinate".to_owned();
    acting.iter().for_each(|what| head += &format!(",guide.{what}"));
    head += ",guide.second";
    acting.iter().for_each(|what| head += &format!(",guide.second_{what}"));
    assert_eq!(table("whole").lines().next(), Some(head.as_str()));
    let last: Vec<f64> = table("whole").lines().last().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    assert!((last[14] - 0.3).abs() < 1e-9, "the sleeve lies on its limit: {last:?}");
}

/// Schemes that carry accelerations start from the torques and forces of the joints' springs: after one small step velocities are `a h`, to first order in it.
#[test]
fn springs_of_joints_accelerate_from_the_start() {
    let acts = "spring = { stiffness = 5.0, rest = 30.0 }\nsecond = { spring = { stiffness = 40.0, rest = 0.3 } }";
    let turning = "[[probe]]\nname = \"turning\"\nbody = \"sleeve\"\nquantity = \"angular_velocity\"\n";
    let moving = "[[probe]]\nname = \"moving\"\nbody = \"sleeve\"\nquantity = \"velocity\"\n";
    for scheme in ["trapezoidal", "newmark", "generalised-alpha"] {
        let text = SLEEVE
            .replace("step = 0.05", "step = 1e-5")
            .replace("KIND", "dynamic")
            .replace("INTEGRATOR", &format!("integrator = {{ scheme = \"{scheme}\" }}"))
            .replace("ACTS", acts)
            .replace("FORCE", "0.0");
        let scene =
            stoss::scene::parse(&format!("{text}{turning}{moving}"), "test.toml").unwrap_or_else(|e| panic!("{e}"));
        let Built { mut simulation, probes, .. } = build(&scene, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        simulation.advance().unwrap();
        let value = |name: &str| probes.iter().find(|probe| probe.name == name).unwrap().value(&simulation)[2];
        // Mass 2, moment of inertia of the cube 2/6.
        let (spin, speed) = (5.0 * 30_f64.to_radians() * 3.0 * 1e-5, 40.0 * 0.3 / 2.0 * 1e-5);
        assert!((value("turning") / spin - 1.0).abs() < 1e-3, "{scheme}: {} {spin}", value("turning"));
        assert!((value("moving") / speed - 1.0).abs() < 1e-3, "{scheme}: {} {speed}", value("moving"));
    }
}
