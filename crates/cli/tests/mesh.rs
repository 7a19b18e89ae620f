//! `stoss mesh`, and bodies from the groups of one file.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn stoss(arguments: &[&Path]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stoss")).args(arguments).output().unwrap()
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../mesh-io/tests/data").join(name)
}

fn info(file: &Path, group: Option<&str>) -> (Option<i32>, String) {
    let mut arguments = vec![Path::new("mesh"), Path::new("info"), file];
    if let Some(group) = group {
        arguments.extend([Path::new("--group"), Path::new(group)]);
    }
    let output = stoss(&arguments);
    let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    (output.status.code(), text)
}

#[test]
fn info_says_what_is_there_and_whether_it_can_be_used() {
    let (code, text) = info(&data("two-41-binary.msh"), None);
    assert_eq!(code, Some(0), "{text}");
    for part in [
        "MSH 4.1, binary",
        "nodes: 45",
        "16 hexahedra (type 5): read",
        "\"Lower\": 8",
        "volume 2.0",
        "Stoss can use it",
    ] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    let (code, text) = info(&data("parts.inp"), None);
    assert_eq!(code, Some(2), "{text}");
    for part in
        ["1 elements C3D5: not read (first in line 25)", "cannot use it as a whole", "\"Lower\"", "coincident nodes: 2"]
    {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    assert_eq!(info(&data("parts.inp"), Some("Lower")).0, Some(0));
    let (code, text) = info(&data("parts.inp"), Some("Middle"));
    assert!(code == Some(2) && text.contains("there is no group"), "{text}");
    assert_eq!(info(&data("none.inp"), None).0, Some(1));
}

#[test]
fn convert_takes_a_group_and_a_factor() {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (data("two-22-text.msh"), folder.path().join("upper.inp"));
    let convert = |to: &Path, scale: &str| {
        let words = ["--group", "Upper", "--scale", scale].map(Path::new);
        stoss(&[&[Path::new("mesh"), Path::new("convert"), &from, to], &words[..]].concat())
    };
    let output = convert(&to, "0.5");
    assert!(output.status.success(), "{output:?}");
    let (code, text) = info(&to, None);
    assert!(code == Some(0) && text.contains("[0.0, 0.0, 0.5] to [0.5, 0.5, 1.0]"), "{text}");
    assert_eq!(convert(&to, "0").status.code(), Some(2));
    assert_eq!(convert(&folder.path().join("a.txt"), "1").status.code(), Some(1));
}

/// Two bodies of one binary file that touch: a factor, sets of the file, an instance of an Abaqus file as the third body.
#[test]
fn a_scene_with_bodies_from_groups() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["two-41-binary.msh", "parts.inp"] {
        std::fs::copy(data(name), folder.path().join(name)).unwrap();
    }
    let scene = folder.path().join("scene.toml");
    let body = |name: &str, file: &str, group: &str, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmesh = {{ file = \"{file}\", group = \"{group}\"{more} }}\n\
             material = {{ law = \"neo-hooke\", young = 1000, poisson = 0.3 }}\n"
        )
    };
    let write = |group: &str| {
        let text = [
            "[scene]\ntitle = \"groups\"\nkind = \"quasi-static\"\n[time]\nend = 1.0\nstep = 0.5\n".to_owned(),
            body("lower", "two-41-binary.msh", group, ", scale = 0.001"),
            body("upper", "two-41-binary.msh", "Upper", ", scale = 1e-3"),
            body("brick", "parts.inp", "upper", ""),
            "[[prescribe]]\nset = \"lower.bottom\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n".to_owned(),
            "[[prescribe]]\nset = \"upper.top\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n".to_owned(),
            "[[prescribe]]\nset = \"brick.foot\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n".to_owned(),
            "[[contact]]\nmethod = \"nts\"\nslave = \"upper.lower contact\"\nmaster = \"lower.lower contact\"\n"
                .to_owned(),
        ];
        std::fs::write(&scene, text.concat()).unwrap();
        let output = stoss(&[Path::new("check"), &scene]);
        (output.status.code(), String::from_utf8([output.stdout, output.stderr].concat()).unwrap())
    };
    let (code, text) = write("Lower");
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("lower: 27 nodes") && text.contains("brick: 8 nodes"), "{text}");
    assert!(text.contains("volume 1.000000e-9"), "{text}");
    let (code, text) = write("lowest");
    assert!(code == Some(2) && text.contains("there is no group") && text.contains("body[0].mesh.group"), "{text}");
}
