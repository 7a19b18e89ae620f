//! Good scenes: the shipped ones and those of the tests are read, survive a round trip, and agree with the JSON schema.

mod support;

use std::path::PathBuf;
use stoss_scene::{
    Friction, Kind, LoadKind, Material, MeshSource, OwnNames, Parameter, Problem, Scene, Series, json_schema, parse,
    parse_with,
};
use support::schema;

const DYNAMIC: &str = include_str!("data/dynamic.toml");
const STATIC: &str = include_str!("data/quasi-static.toml");

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
fn our_reader_and_serde_agree() {
    for (file, text) in good_scenes() {
        let by_serde: Scene = toml::from_str(&text).unwrap();
        assert_eq!(read(&text, &file), by_serde, "{file}");
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
        ("kappa = 2000.0", "kappa = \"2000\""),
        ("kappa = 2000.0, ", ""),
        ("generator = \"block\"", "generator = \"cube\""),
        ("outer_diameter = 1.0", "outer_diameter = 1.0, layers = 2"),
        ("every = 2", "every = 2.5"),
        ("fixed = true", "fixed = \"yes\""),
    ] {
        assert!(DYNAMIC.contains(from));
        let value: serde_json::Value = toml::from_str(&DYNAMIC.replacen(from, to, 1)).unwrap();
        assert!(!schema::violations(&schema, &value).is_empty(), "{from} -> {to} is valid under the schema");
    }
}

#[test]
fn the_schema_documents_every_key() {
    let schema: serde_json::Value = serde_json::from_str(&json_schema()).unwrap();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert_eq!(schema::undocumented(&schema), Vec::<String>::new());
}

#[test]
fn values_arrive_where_they_belong() {
    let scene = read(DYNAMIC, "dynamic.toml");
    assert_eq!(scene.header.kind, Kind::Dynamic);
    assert_eq!(scene.time.max_cuts, 8);
    assert_eq!(scene.bodies[0].position, [0.0, -0.6, 0.8]);
    assert_eq!(scene.bodies[1].rotation.as_slice().len(), 2);
    assert_eq!(scene.bodies[0].rotation.as_slice()[0].axis, [0.0, 0.0, 1.0]);
    assert!(matches!(&scene.bodies[0].material, Material::Ogden(ogden) if ogden.alpha == [1.3, 5.0, -2.0]));
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
    assert_eq!(rotation.degrees.rows(), [[0.0, 0.0], [1.0, 720.0]]);
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
    let Material::Own(own) = &scene.bodies[0].material else { panic!("{:?}", scene.bodies[0].material) };
    assert_eq!(own.law, "mine");
    assert_eq!(own.parameters["stiffness"], Parameter::Number(3.0));
    assert_eq!(own.parameters["exponents"], Parameter::List(vec![1.0, 2.5]));
    // The same through serde, in both directions.
    let written = toml::to_string(&scene).unwrap();
    assert_eq!(parse_with(&written, "written", &names).unwrap(), scene);
    assert_eq!(toml::from_str::<Scene>(&text).unwrap(), scene);
    // A law of the catalogue without one of its parameters is not a law of one's own.
    assert!(toml::from_str::<Scene>(&DYNAMIC.replacen("kappa = 2000.0, ", "", 1)).is_err());
    let bad = text.replacen("stiffness = 3", "stiffness = \"3\"", 1);
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
    let Some(Friction::Own(own)) = &scene.contacts[0].friction else { panic!("{:?}", scene.contacts[0].friction) };
    assert_eq!((own.law.as_str(), own.penalty, own.midpoint, own.slip), ("mine", Some(1e4), None, None));
    assert_eq!(own.parameters["strength"], Parameter::Number(3.0));
    assert_eq!(own.parameters["slopes"], Parameter::List(vec![1.0, 2.5]));
    assert_eq!(own.parameters.len(), 2);
    let written = toml::to_string(&scene).unwrap();
    assert_eq!(parse_with(&written, "written", &names).unwrap(), scene);
    assert_eq!(toml::from_str::<Scene>(&text).unwrap(), scene);
    // A law of the catalogue without one of its parameters is not a law of one's own.
    let without = text.replacen("law = \"mine\"", "law = \"coulomb\"", 1);
    assert!(toml::from_str::<Scene>(&without).is_err());
    for (from, to, key) in [
        ("strength = 3", "strength = \"3\"", "contact[0].friction.strength"),
        ("penalty = 1e4", "penalty = 0", "contact[0].friction.penalty"),
        ("strength = 3", "slip = \"objective\"", "contact[0].friction.slip"),
    ] {
        let problems = parse_with(&text.replacen(from, to, 1), "x", &names).unwrap_err();
        assert_eq!(problems.problems()[0].key, key);
    }
}
