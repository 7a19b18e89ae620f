//! The set-up of a scene: every named thing is a layer, in its place.

use std::path::Path;
use stoss::run::{RunError, RunOptions};
use stoss::setup::{FILE, Kind, Layer, Setup, write};

/// Two blocks with a gap of 0.1 between them, a ball on a spring, and something of every kind.
const SCENE: &str = r#"
[scene]
title = "Two blocks"
kind = "dynamic"
[time]
end = 1.0
step = 0.1
integrator = { scheme = "energy-momentum" }
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
name = "lower"
mesh = { generator = "block", min = [0, 0, 0], max = [2, 2, 1], divisions = [2, 2, 1] }
material = { law = "neo-hooke", young = 100.0, poisson = 0.3 }
density = 1.0
[[body]]
name = "upper"
mesh = { generator = "block", min = [0, 0, 1.1], max = [2, 2, 2.1], divisions = [3, 3, 1] }
material = { law = "neo-hooke", young = 100.0, poisson = 0.3 }
density = 1.0
[[mass]]
name = "ball"
mass = 1.0
at = [5.0, 0.0, 0.0]
[sets]
corner = "lower.top & x > 0.9 & y > 0.9"
[[contact]]
name = "floor"
method = "nts"
slave = "upper.bottom"
master = "lower.top"
[[joint]]
name = "thread"
kind = "distance"
between = ["ball", "ground"]
at = [[5.0, 0.0, 0.0], [5.0, 0.0, 3.0]]
[[spring]]
name = "rubber"
between = ["ball", "lower.right"]
at = [[5.0, 0.0, 0.0], [2.0, 0.0, 0.0]]
stiffness = 1.0
[[prescribe]]
name = "base"
set = "lower.bottom"
components = ["x", "z"]
fixed = true
[[prescribe]]
set = "lower.left"
components = ["y"]
displacement = { table = [[0.0, 0.0], [1.0, 0.1]] }
[[equation]]
name = "glide"
terms = [{ set = "upper.back", component = "x", mean = true }, { set = "upper.front", component = "x", factor = -1.0, mean = true }]
[[support]]
set = "lower.back"
stiffness = [0.0, 2.0, 0.0]
[[load]]
name = "wind"
set = "upper.left"
follower_pressure = { table = [[0.0, 0.0], [0.5, 3.0], [1.0, 0.0]] }
[[load]]
set = "upper.top"
total_force = [0.0, 0.0, -4.0]
"#;

fn setup(text: &str) -> Result<(tempfile::TempDir, Setup), RunError> {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    write(&scene, &RunOptions::default(), &folder.path().join("view"))?;
    let text = std::fs::read_to_string(folder.path().join("view").join(FILE)).unwrap();
    Ok((folder, serde_json::from_str(&text).unwrap()))
}

fn layer<'a>(setup: &'a Setup, kind: Kind, name: &str) -> &'a Layer {
    let found = setup.layers.iter().find(|layer| (layer.kind, layer.name.as_str()) == (kind, name));
    found.unwrap_or_else(|| panic!("no {name} among {:?}", setup.layers.iter().map(|l| &l.name).collect::<Vec<_>>()))
}

#[test]
fn every_named_thing_is_where_it_acts() {
    let (folder, setup) = setup(SCENE).unwrap();
    assert_eq!(setup.title, "Two blocks");
    let heights = |layer: &Layer| layer.places.iter().map(|place| place[2]).collect::<Vec<_>>();
    let (slave, master) = (layer(&setup, Kind::Contact, "floor: slave"), layer(&setup, Kind::Contact, "floor: master"));
    assert_eq!((slave.facets.len(), master.facets.len()), (9, 4));
    assert_eq!((heights(slave), heights(master)), (vec![1.1; 16], vec![1.0; 9]));
    let thread = layer(&setup, Kind::Joint, "thread");
    assert_eq!((&thread.places[..], &thread.lines[..]), (&[[5.0, 0.0, 0.0], [5.0, 0.0, 3.0]][..], &[[0, 1]][..]));
    assert_eq!(layer(&setup, Kind::Spring, "rubber").places, [[5.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    // Two directions at each of nine nodes, whose arrows end there.
    let base = layer(&setup, Kind::Prescribed, "base");
    assert_eq!((base.places.len(), base.arrows.len(), base.about.as_str()), (9, 18, "lower.bottom fixed along x, z"));
    assert!(base.arrows.iter().all(|arrow| arrow.at[2] == 0.0 && arrow.pushes && arrow.along[1] == 0.0));
    let moved = layer(&setup, Kind::Prescribed, "prescribe[1] of lower.left");
    assert_eq!(moved.about, "lower.left moved along y");
    assert!(moved.arrows.iter().all(|arrow| arrow.at[0] == 0.0 && arrow.along == [0.0, 1.0, 0.0]));
    assert_eq!(layer(&setup, Kind::Equation, "glide").places.len(), 16);
    let support = layer(&setup, Kind::Support, "support[0] of lower.back");
    assert!(support.arrows.len() == 6 && support.arrows.iter().all(|arrow| arrow.along == [0.0, 1.0, 0.0]));
    // A pressure pushes inwards, at the middle of each facet; a force is along itself.
    let wind = layer(&setup, Kind::Load, "wind");
    assert!(wind.arrows.len() == 3 && wind.arrows.iter().all(|arrow| arrow.along == [1.0, 0.0, 0.0] && arrow.pushes));
    assert!(wind.arrows.iter().all(|arrow| arrow.at[0] == 0.0 && (arrow.at[2] - 1.6).abs() < 1e-6));
    assert!(wind.about.contains("at most 3"), "{}", wind.about);
    let pull = layer(&setup, Kind::Load, "load[1] on upper.top");
    assert!(pull.arrows.len() == 16 && pull.arrows.iter().all(|arrow| arrow.along == [0.0, 0.0, -1.0]));
    let gravity = layer(&setup, Kind::Load, "gravity");
    let weights: Vec<[f32; 3]> = gravity.arrows.iter().map(|arrow| arrow.at).collect();
    assert_eq!(weights.len(), 3);
    assert!((weights[1][2] - 1.6).abs() < 1e-6 && gravity.arrows.iter().all(|arrow| arrow.along == [0.0, 0.0, -1.0]));
    // Sets of meshes and those that the scene makes; those of all nodes and of the whole surface are the body.
    assert_eq!(layer(&setup, Kind::Set, "upper.top").facets.len(), 9);
    assert!(setup.layers.iter().any(|layer| layer.kind == Kind::Set && layer.name.ends_with(".corner")));
    assert!(!setup.layers.iter().any(|layer| layer.name.ends_with(".all") || layer.name.ends_with(".boundary")));
    // The only frame has the gap of the slave nodes.
    let frame = stoss::mesh_io::read_vtu(folder.path().join("view/frames/frame_000000.vtu")).unwrap();
    let gap = &frame.point_data["gap"];
    let known: Vec<f64> = gap.values.iter().copied().filter(|gap| gap.is_finite()).collect();
    assert!(known.len() == 16 && known.iter().all(|gap| (gap - 0.1).abs() < 1e-12), "{known:?}");
    let about = std::fs::read_to_string(folder.path().join("view/run.json")).unwrap();
    assert!(about.contains("\"upper\"") && about.contains("contact floor"));
}

/// Names of a scene with joints, a rigid body and several loads.
#[test]
fn a_scene_of_the_gallery_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/bolt.toml");
    write(&scene, &RunOptions::default(), folder.path()).unwrap();
    let setup: Setup = serde_json::from_str(&std::fs::read_to_string(folder.path().join(FILE)).unwrap()).unwrap();
    for (kind, name) in [(Kind::Joint, "guide"), (Kind::Joint, "nut"), (Kind::Joint, "cut"), (Kind::Load, "pull")] {
        assert!(layer(&setup, kind, name).arrows.len() + layer(&setup, kind, name).places.len() > 0, "{name}");
    }
    for layer in &setup.layers {
        let count = layer.places.len() as u32;
        assert!(layer.facets.iter().flatten().chain(layer.lines.as_flattened()).all(|&place| place < count));
        assert!(!layer.places.is_empty() || !layer.arrows.is_empty(), "{}", layer.name);
    }
}

#[test]
fn a_wrong_scene_is_refused() {
    assert!(matches!(setup(&SCENE.replace("upper.bottom", "upper.botom")), Err(RunError::Scene(_))));
}
