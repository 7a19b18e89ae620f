//! Good scenes: the shipped ones and those of the tests are read, survive a round trip, and agree with the JSON schema.

use crate::support::schema;
use std::path::PathBuf;
use stoss_scene::{
    BoxShape, Component, Coupling, Dimension, JointKind, Kind, LoadKind, MeshSource, Omission, OwnNames, Parameter,
    PartKind, ProbeComponent, Problem, Scene, Section, Series, Shape, json_schema, parse, parse_with,
};

const DYNAMIC: &str = include_str!("data/dynamic.toml");
const STATIC: &str = include_str!("data/quasi-static.toml");
const MULTIBODY: &str = include_str!("data/multibody.toml");
const MULTIBODY_STATIC: &str = include_str!("data/multibody-static.toml");

fn good_scenes() -> Vec<(String, String)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut scenes: Vec<(String, String)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .map(|path| (path.display().to_string(), std::fs::read_to_string(&path).unwrap()))
        .collect();
    assert!(!scenes.is_empty());
    scenes.push(("dynamic".into(), DYNAMIC.into()));
    scenes.push(("quasi-static".into(), STATIC.into()));
    scenes.push(("multibody".into(), MULTIBODY.into()));
    scenes.push(("multibody-static".into(), MULTIBODY_STATIC.into()));
    scenes
}

fn read(text: &str, file: &str) -> Scene {
    parse(text, file).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn good_scenes_survive_a_round_trip() {
    for (file, text) in good_scenes() {
        let scene = read(&text, &file);
        let written = toml::to_string(&scene).unwrap();
        assert_eq!(read(&written, "written"), scene, "{file}");
    }
}

#[test]
fn good_scenes_are_valid_under_the_schema() {
    let schema: serde_json::Value = serde_json::from_str(&json_schema()).unwrap();
    for (file, text) in good_scenes() {
        let value: serde_json::Value = toml::from_str(&text).unwrap();
        assert_eq!(schema::violations(&schema, &value), Vec::<String>::new(), "{file}");
    }
}

#[test]
fn the_schema_refuses_what_is_wrong() {
    let schema: serde_json::Value = serde_json::from_str(&json_schema()).unwrap();
    for (from, to) in [
        ("density = 10.0", "desnity = 10.0"),
        ("kind = \"dynamic\"", "kind = \"static\""),
        ("velocity = [0.0, 1.0, -1.0]", "velocity = [0.0, 1.0]"),
        ("kappa = 2000.0", "kappa = true"),
        ("kappa = 2000.0, ", ""),
        ("generator = \"block\"", "generator = \"cube\""),
        ("outer_diameter = 1.0", "outer_diameter = 1.0, layers = 2"),
        ("every = 2", "every = 2.5"),
        ("fixed = true", "fixed = \"yes\""),
        ("method = \"nts\"", "method = \"nts\"\nreduction = \"none\""),
        ("method = \"nts\"", "method = \"mortar\""),
    ] {
        assert!(DYNAMIC.contains(from));
        let value: serde_json::Value = toml::from_str(&DYNAMIC.replacen(from, to, 1)).unwrap();
        assert!(!schema::violations(&schema, &value).is_empty(), "{from} -> {to} is valid under the schema");
    }
}

#[test]
fn the_schema_refuses_wrong_parts_and_joints() {
    let schema: serde_json::Value = serde_json::from_str(&json_schema()).unwrap();
    for (from, to) in [
        ("kind = \"sphere\"", "kind = \"ball\""),
        ("inertia = [0.3, 0.2, 0.4]", "inertia = 0.3"),
        ("shape = \"tube\"", "shape = \"pipe\""),
        ("torsion = 8e2, ", ""),
        ("at = [[3, 0, 0], [1, 1, 0]]", "at = [[3, 0, 0]]"),
        ("kind = \"hinge\"", "kind = \"hing\""),
        ("stiffness = 2e4\n", ""),
        ("release = \"swivel\"\n", ""),
        ("until = 1.0", "till = 1.0"),
    ] {
        assert!(MULTIBODY.contains(from), "{from}");
        let value: serde_json::Value = toml::from_str(&MULTIBODY.replacen(from, to, 1)).unwrap();
        assert!(!schema::violations(&schema, &value).is_empty(), "{from} -> {to} is valid under the schema");
    }
}

#[test]
fn the_schema_documents_every_key() {
    let schema: serde_json::Value = serde_json::from_str(&json_schema()).unwrap();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert_eq!(schema::undocumented(&schema), Vec::<String>::new());
    assert_eq!(schema::without_dimension(&schema, Dimension::NAMES), Vec::<String>::new());
}

#[test]
fn values_arrive_where_they_belong() {
    let scene = read(DYNAMIC, "dynamic.toml");
    assert_eq!(scene.header.kind, Kind::Dynamic);
    assert_eq!(scene.time.max_cuts, 8);
    assert_eq!(scene.bodies[0].position, [0.0, -0.6, 0.8]);
    assert_eq!(scene.bodies[1].rotation.as_slice().len(), 2);
    assert_eq!(scene.bodies[0].rotation.as_slice()[0].axis, [0.0, 0.0, 1.0]);
    assert_eq!(scene.bodies[0].material.law, "ogden");
    assert_eq!(scene.bodies[0].material.parameters["alpha"], Parameter::List(vec![1.3, 5.0, -2.0]));
    assert_eq!(scene.sets[0].local_name(), "rim");
    assert_eq!(scene.contacts[0].label(), "ball.outer/plate.top");
    assert_eq!(scene.prescriptions[0].rows(), [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0]]);
    assert_eq!(scene.prescriptions[1].rows(), [[0.0, 0.0]]);
    let (kind, series) = scene.loads[1].kind().unwrap();
    assert_eq!((kind, series), (LoadKind::BodyForce, &Series::Vector(vec![0.0, 0.0, -98.1])));
    assert_eq!(series.rows(), [[0.0, 0.0, 0.0, -98.1]]);
    assert_eq!(scene.probes[1].point, Some([1.25, 1.25, 0.25]));
    assert_eq!(scene.output.checkpoint_every, 10);
    assert_eq!(scene.body_index("plate"), Some(1));
    let scene = read(STATIC, "quasi-static.toml");
    assert!(!scene.is_dynamic());
    assert!(matches!(&scene.bodies[7].mesh, MeshSource::File(mesh) if mesh.file == "part.msh"));
    assert_eq!(scene.loads[1].kind().unwrap().1.columns(), 1);
    let turn = &scene.prescriptions[2];
    assert_eq!(turn.rows(), [[0.0, 0.0, 0.0, -0.1]]);
    assert_eq!(turn.prescribed_components().len(), 3);
    let rotation = turn.rotation.as_ref().unwrap();
    assert_eq!((rotation.axis, rotation.about), ([0.0, 0.0, 1.0], [0.0, 0.0, 2.0]));
    let [coupling, controls] = &scene.left_out[..] else { panic!("{:?}", scene.left_out) };
    assert_eq!((coupling.severity, controls.severity), (Omission::Missing, Omission::Note));
    assert!(coupling.to_string().starts_with("*COUPLING (part.inp:12): its nodes"), "{coupling}");
    assert_eq!(controls.to_string(), "*CONTROLS: Stoss has tolerances of its own");
    assert_eq!(rotation.degrees.rows(), [[0.0, 0.0], [1.0, 720.0]]);
}

#[test]
fn parts_and_joints_arrive_where_they_belong() {
    let scene = read(MULTIBODY, "multibody.toml");
    assert_eq!(scene.gravity.unwrap().acceleration, [0.0, 0.0, -9.81]);
    for (name, place) in [
        ("block", (PartKind::Body, 0)),
        ("lever", (PartKind::Rigid, 7)),
        ("bow", (PartKind::Beam, 1)),
        ("rope", (PartKind::String, 0)),
        ("bob", (PartKind::Mass, 0)),
    ] {
        assert_eq!(scene.part(name), Some(place));
    }
    assert_eq!((scene.part("ground"), scene.joint_index("clamp")), (None, Some(5)));
    let rigid = |name| &scene.rigids[scene.part(name).unwrap().1];
    assert_eq!(rigid("crate").shape, Some(Shape::Box(BoxShape { size: [1.0, 2.0, 3.0], divisions: [1; 3] })));
    assert_eq!(rigid("crate").principal_euler(), Some([1.0, 4.0, 9.0]));
    // E_1 = (0.2 + 0.4 - 0.3) / 2 and so on
    let euler = rigid("lever").principal_euler().unwrap();
    for (value, expected) in euler.into_iter().zip([0.15, 0.25, 0.05]) {
        approx::assert_relative_eq!(value, expected, max_relative = 1e-14);
    }
    assert!(rigid("tool").has_surface() && !rigid("lever").has_surface() && rigid("floor").fixed);
    let bow = &scene.beams[1];
    assert_eq!((bow.order, scene.beams[0].order, bow.shear_factor), (3, 2, Some(0.5)));
    assert_eq!(bow.arc.unwrap().degrees, 90.0);
    assert!(matches!(scene.beams[2].section, Section::Stiffness(s) if s.rotary == Some([1e-3, 2e-3])));
    let [rope, wire] = &scene.strings[..] else { panic!("{:?}", scene.strings) };
    assert_eq!(
        (rope.corners(), rope.natural_length(), rope.tension_only),
        (vec![[0.0; 3], [3.0, 0.0, 0.0]], 2.9, true)
    );
    assert_eq!((wire.natural_length(), wire.axial_stiffness(), wire.order), (2.0, 2e5, 2));
    approx::assert_relative_eq!(wire.mass_per_length().unwrap(), 7.85e-3, max_relative = 1e-14);
    let elbow = &scene.joints[1];
    assert_eq!(
        (elbow.kind, elbow.limits, elbow.at.both()),
        (JointKind::from_name("hinge").unwrap(), Some([-30.0, 60.0]), [[0.0, 0.0, 1.0]; 2])
    );
    assert_eq!((elbow.friction.unwrap().radius, elbow.spring.unwrap().rest), (Some(0.01), 15.0));
    assert_eq!(scene.joints[5].coupling, Some(Coupling::Kinematic));
    assert_eq!(scene.joints[6].at.both(), [[3.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(scene.prescriptions[0].rows(), [[0.0, 0.0], [1.0, -0.1]]);
    assert_eq!(scene.prescriptions[0].prescribed_components(), [Component::Z]);
    assert_eq!(
        (scene.prescriptions[1].prescribed_components().len(), scene.prescriptions[1].rows()),
        (3, vec![vec![0.0; 4]])
    );
    assert_eq!(scene.events[1].when.as_ref().unwrap().component, Some(ProbeComponent::Z));
    assert_eq!((scene.stages[0].kind, scene.stages[0].off.len()), (Kind::QuasiStatic, 3));
}

#[test]
fn later_checks_find_their_line() {
    let scene = read(DYNAMIC, "dynamic.toml");
    let location = scene.locate("contact[0].master").unwrap();
    let line = DYNAMIC.lines().nth(location.line - 1).unwrap();
    assert_eq!(line, "master = \"plate.top\"");
    assert_eq!(&line[location.column - 1..], "\"plate.top\"");
    assert_eq!(&scene.text()[location.span], "\"plate.top\"");
    assert_eq!(scene.locate("contact[0].friction"), None);
    let problem = Problem::at(&scene, "contact[0].friction", "", "message", "remedy");
    assert_eq!(DYNAMIC.lines().nth(problem.line - 1), Some("[[contact]]"));
    assert_eq!(problem.file, "dynamic.toml");
}

#[test]
fn laws_of_a_program_are_read_only_if_it_names_them() {
    let from = "{ law = \"ogden\", mu = [6300.0, 12.0, -100.0], alpha = [1.3, 5.0, -2.0], kappa = 2000.0, beta = 9.0 }";
    assert!(DYNAMIC.contains(from));
    let text = DYNAMIC.replacen(from, "{ law = \"mine\", stiffness = 3, exponents = [1, 2.5] }", 1);
    let problems = parse(&text, "x").unwrap_err();
    assert_eq!(problems.problems()[0].key, "body[0].material.law");
    let names = OwnNames { materials: vec!["mine"], friction: Vec::new() };
    let scene = parse_with(&text, "x", &names).unwrap();
    let own = &scene.bodies[0].material;
    assert_eq!(own.law, "mine");
    assert_eq!(own.parameters["stiffness"], Parameter::Number(3.0));
    assert_eq!(own.parameters["exponents"], Parameter::List(vec![1.0, 2.5]));
    let written = toml::to_string(&scene).unwrap();
    assert_eq!(parse_with(&written, "written", &names).unwrap(), scene);
    // A law of the catalogue without one of its parameters is not a law of one's own.
    assert!(parse_with(&DYNAMIC.replacen("kappa = 2000.0, ", "", 1), "x", &names).is_err());
    let bad = text.replacen("stiffness = 3", "stiffness = \"three\"", 1);
    let problems = parse_with(&bad, "x", &names).unwrap_err();
    assert_eq!(problems.problems()[0].key, "body[0].material.stiffness");
}

#[test]
fn laws_of_friction_of_a_program_are_read_only_if_it_names_them() {
    let line = "friction = { law = \"mine\", stick = \"penalty\", penalty = 1e4, strength = 3, slopes = [1, 2.5] }";
    let text = DYNAMIC.replacen("constraint = \"modified\"", line, 1);
    let problems = parse(&text, "x").unwrap_err();
    assert_eq!(problems.problems()[0].key, "contact[0].friction.law");
    // The name of a material is none of a law of friction.
    let materials = OwnNames { materials: vec!["mine"], friction: Vec::new() };
    assert_eq!(parse_with(&text, "x", &materials).unwrap_err().problems()[0].key, "contact[0].friction.law");
    let names = OwnNames { materials: Vec::new(), friction: vec!["mine"] };
    let scene = parse_with(&text, "x", &names).unwrap();
    let own = scene.contacts[0].friction.as_ref().unwrap();
    assert_eq!((own.law.as_str(), own.given.penalty, own.slip), ("mine", Some(1e4), None));
    assert_eq!(own.parameters["strength"], Parameter::Number(3.0));
    assert_eq!(own.parameters["slopes"], Parameter::List(vec![1.0, 2.5]));
    assert_eq!(own.parameters.len(), 2);
    let written = toml::to_string(&scene).unwrap();
    assert_eq!(parse_with(&written, "written", &names).unwrap(), scene);
    // A law of the catalogue without one of its parameters is not a law of one's own.
    let without = text.replacen("law = \"mine\"", "law = \"coulomb\"", 1);
    assert!(parse_with(&without, "x", &names).is_err());
    for (from, to, key) in [
        ("strength = 3", "strength = \"three\"", "contact[0].friction.strength"),
        ("penalty = 1e4", "penalty = 0", "contact[0].friction.penalty"),
        ("strength = 3", "slip = \"objective\"", "contact[0].friction.slip"),
    ] {
        let problems = parse_with(&text.replacen(from, to, 1), "x", &names).unwrap_err();
        assert_eq!(problems.problems()[0].key, key);
    }
}
