//! What is in the folder of results, what is left alone there, and what the program says about doubtful scenes.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A block falls on another one.
const SCENE: &str = r#"[scene]
title = "fall"
kind = "dynamic"

[time]
end = 0.04
step = 0.002
integrator = { scheme = "energy-momentum" }

[[body]]
name = "upper"
mesh = { generator = "block", min = [0, 0, 1.02], max = [1, 1, 2.02], divisions = [2, 2, 2] }
material = { law = "neo-hooke", lambda = 1300.0, mu = 865.0 }
density = 10.0
velocity = [0.0, 0.0, -1.0]

[[body]]
name = "lower"
mesh = { generator = "block", min = [-1, -1, 0], max = [2, 2, 1], divisions = [3, 3, 2] }
material = { law = "neo-hooke", lambda = 1300.0, mu = 865.0 }
density = 10.0

[[contact]]
method = "nts"
slave = "upper.bottom"
master = "lower.top"

[[prescribe]]
set = "lower.bottom"
components = ["x", "y", "z"]
fixed = true

[output]
every = 1
checkpoint_every = 3
"#;

fn stoss(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stoss"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn folder_with(scene: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    std::fs::write(folder.path().join("scene.toml"), scene).expect("the temporary folder is writable");
    folder
}

/// The scene with texts replaced, which must be there.
fn changed(replacements: &[(&str, &str)]) -> String {
    replacements.iter().fold(SCENE.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "no `{from}`");
        text.replacen(from, to, 1)
    })
}

fn run(folder: &Path, out: &str, more: &[&str]) -> Output {
    let output = stoss(folder, &[&["run", "scene.toml", "--out", out][..], more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    output
}

/// Every file of a folder of results but the checkpoint, the summary, which holds times of computing, and the page, which holds the summary.
fn results(out: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files: Vec<PathBuf> = [out.to_owned(), out.join("frames")]
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).expect("the folder exists"))
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_file() && path.extension().is_some_and(|e| e != "json" && e != "html"))
        .collect();
    files.sort();
    files.iter().map(|path| (path.strip_prefix(out).unwrap().to_owned(), std::fs::read(path).unwrap())).collect()
}

fn summary(out: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap()
}

fn last_frame(out: &Path) -> (String, String) {
    let mut frames: Vec<String> = std::fs::read_dir(out.join("frames"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    frames.sort();
    let collection = std::fs::read_to_string(out.join("frames.pvd")).unwrap();
    let entry = collection.lines().rfind(|line| line.contains("frames/")).unwrap_or_default();
    (frames.pop().unwrap_or_default(), entry.to_owned())
}

#[test]
fn times_of_frames_and_drifts_are_the_same_bits_after_resuming() {
    // Among the times before the break is 13 * 0.002 = 0.026000000000000002, which a careless reader turns into 0.026.
    assert_ne!(13.0 * 0.002, 0.026);
    let folder = folder_with(SCENE);
    run(folder.path(), "whole", &["--quiet"]);
    run(folder.path(), "broken", &["--quiet", "--until", "0.03"]);
    run(folder.path(), "broken", &["--quiet", "--resume"]);
    let [whole, broken] = ["whole", "broken"].map(|out| folder.path().join(out));
    let collection = std::fs::read_to_string(whole.join("frames.pvd")).unwrap();
    assert!(collection.contains("0.026000000000000002"), "the test shows nothing:\n{collection}");
    assert!(results(&whole) == results(&broken));
    assert_eq!(summary(&whole)["drift"], summary(&broken)["drift"]);
}

#[test]
fn the_summary_says_where_the_time_went() {
    let folder = folder_with(SCENE);
    let output = run(folder.path(), "out", &["--until", "0.02"]);
    run(folder.path(), "out", &["--quiet", "--resume"]);
    let summary = summary(&folder.path().join("out"));
    let seconds = |phase: &str, key: &str| summary["seconds"][phase][key].as_f64().unwrap();
    // The initial state and twenty steps, over both sessions; twenty steps that are never tried again.
    assert_eq!([seconds("output", "calls"), seconds("total", "calls")], [21.0, 20.0]);
    for phase in ["search", "contact", "assembly", "factorisation", "solve", "output"] {
        let [wall, calls] = ["wall", "calls"].map(|key| seconds(phase, key));
        assert!(wall > 0.0 && calls >= 20.0, "{phase}: {wall} s, {calls} calls");
        let share = summary["shares"][phase].as_f64().unwrap();
        assert!((share * seconds("total", "wall") - wall).abs() < 1e-12 * wall, "{phase}: {share}");
    }
    let shares: Vec<f64> = summary["shares"].as_object().unwrap().values().map(|v| v.as_f64().unwrap()).collect();
    assert!(shares.iter().all(|share| (0.0..1.0).contains(share)), "{shares:?}");
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{shares:?}");
    let contact = summary["contact_share"].as_f64().unwrap();
    let together = seconds("search", "wall") + seconds("contact", "wall");
    assert!((contact * seconds("total", "wall") - together).abs() < 1e-12 * together);
    assert!(stderr(&output).contains("contact altogether"), "{}", stderr(&output));
}

#[test]
fn a_run_that_stops_early_says_so_and_shows_its_last_step() {
    let folder = folder_with(&changed(&[("every = 1\n", "every = 4\n")]));
    run(folder.path(), "whole", &["--quiet"]);
    let output = run(folder.path(), "part", &["--until", "0.0209"]);
    let [whole, part] = ["whole", "part"].map(|out| folder.path().join(out));
    // Step 11 is the first that reaches the time.
    assert!(stderr(&output).contains("stopped before the scene's end: 11 steps to t = 0.022"), "{}", stderr(&output));
    let outcome = summary(&part)["outcome"].clone();
    assert_eq!((outcome["kind"].as_str(), outcome["last_step"].as_u64()), (Some("stopped"), Some(11)), "{outcome}");
    let (file, entry) = last_frame(&part);
    assert_eq!(file, "frame_000011.vtu");
    assert!(entry.contains("frame_000011.vtu") && entry.contains("0.022"), "{entry}");
    // Going on, the run has frames where it would have had them.
    let output = run(folder.path(), "part", &["--resume"]);
    assert!(stderr(&output).contains("completed: 20 steps"), "{}", stderr(&output));
    assert_eq!(summary(&part)["outcome"]["kind"], "completed");
    assert!(results(&whole) == results(&part));
    assert_eq!(last_frame(&part).0, "frame_000020.vtu");
}

#[test]
fn a_run_that_fails_shows_its_last_good_step() {
    let load = "[[load]]\nset = \"upper.top\"\ntraction = { table = [[0.0, 0, 0, 0], [0.02, 0, 0, 0], \
                [0.021, 0, 0, -1e12]] }\n[output]\nevery = 4\n";
    let folder =
        folder_with(&changed(&[("[output]\nevery = 1\n", load), ("step = 0.002", "step = 0.002\nmax_cuts = 0")]));
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let out = folder.path().join("out");
    let last = summary(&out)["outcome"]["last_step"].as_u64().unwrap();
    assert_ne!(last % 4, 0, "the test shows nothing");
    assert_eq!(last_frame(&out).0, format!("frame_{last:06}.vtu"));
}

#[test]
fn files_of_others_are_left_alone() {
    let names = [
        "balance.csv",
        "newton.csv",
        "contact.csv",
        "probes.csv",
        "frames.pvd",
        "run.json",
        "report.html",
        "summary.json",
        "checkpoint",
    ];
    for name in names {
        let folder = folder_with(SCENE);
        let mine = folder.path().join(name);
        std::fs::write(&mine, "year,gain\n2024,3\n").unwrap();
        let output = stoss(folder.path(), &["run", "scene.toml", "--out", ".", "--quiet"]);
        assert_eq!(output.status.code(), Some(1), "{name}: {}", stderr(&output));
        assert!(stderr(&output).contains(name) && stderr(&output).contains("--out"), "{}", stderr(&output));
        assert_eq!(std::fs::read_to_string(&mine).unwrap(), "year,gain\n2024,3\n");
        assert!(!folder.path().join("frames").exists(), "{name}: nothing must be written");
    }
    // The results of a run of ours, ended in whatever way, are replaced.
    let folder = folder_with(SCENE);
    run(folder.path(), "out", &["--quiet", "--until", "0.01"]);
    std::fs::write(folder.path().join("out/newton.csv"), "").unwrap();
    run(folder.path(), "out", &["--quiet", "--until", "0.004"]);
    assert_eq!(summary(&folder.path().join("out"))["steps"], 2);
}

#[test]
fn frames_agree_on_which_gaps_are_shown() {
    // Three quarters of a facet above the lower block, far beyond the reach of a step.
    let folder = folder_with(&changed(&[("1.02]", "1.75]"), ("2.02]", "2.75]")]));
    run(folder.path(), "out", &["--quiet", "--until", "0.004"]);
    for frame in ["frame_000000.vtu", "frame_000002.vtu"] {
        let data = stoss::mesh_io::read_vtu(folder.path().join("out/frames").join(frame)).unwrap();
        let gap = data.point_data.get("gap").expect("there is contact");
        assert!(gap.values.iter().all(|g| g.is_nan()), "{frame}: {:?}", gap.values);
    }
    let near = folder_with(SCENE);
    run(near.path(), "out", &["--quiet", "--until", "0.002"]);
    let data = stoss::mesh_io::read_vtu(near.path().join("out/frames/frame_000000.vtu")).unwrap();
    let gaps = &data.point_data["gap"].values;
    assert_eq!(gaps.iter().filter(|g| (*g - 0.02).abs() < 1e-12).count(), 9, "{gaps:?}");
}

#[test]
fn linear_systems_are_written_on_request() {
    let folder = folder_with(SCENE);
    let arguments = ["run", "scene.toml", "--until", "0.04", "--systems", "2"];
    assert_eq!(stoss(folder.path(), &arguments).status.code(), Some(0));
    let systems = folder.path().join("scene.out/systems");
    let mut names: Vec<_> =
        std::fs::read_dir(&systems).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.retain(|name| !name.contains("groups") && !name.contains("rhs"));
    names.sort();
    assert_eq!(names.len(), 2, "{names:?}");
    let text = std::fs::read_to_string(systems.join(&names[1])).unwrap();
    assert!(text.starts_with("%%MatrixMarket matrix coordinate real general\n"), "{}", &text[..60]);
}

#[test]
fn the_plan_and_the_summary_show_contact_with_its_friction() {
    let check = |contact: &str| {
        let folder = folder_with(&changed(&[("method = \"nts\"", contact)]));
        let plan = stoss(folder.path(), &["check", "scene.toml"]);
        assert_eq!(plan.status.code(), Some(0), "{}", stderr(&plan));
        (String::from_utf8_lossy(&plan.stdout).into_owned(), folder)
    };
    let (plan, _) = check("method = \"nts\"");
    assert!(
        plan.contains("standard constraint by multiplier, 9 slave points with 1 unknown each; no friction"),
        "{plan}"
    );
    let (plan, folder) = check("method = \"nts\"\nfriction = { law = \"coulomb\", mu = 0.3, penalty = 1e4 }");
    assert!(plan.contains("friction coulomb (mu = 0.3), stick = penalty, tangential stiffness 1.0000e4"), "{plan}");
    assert!(!plan.contains("by default"), "{plan}");
    assert_eq!(stoss(folder.path(), &["run", "scene.toml", "--until", "0.02"]).status.code(), Some(0));
    let summary = std::fs::read_to_string(folder.path().join("scene.out/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let friction = &summary["contacts"][0]["friction"];
    assert_eq!((friction["law"].as_str(), friction["parameters"]["mu"].as_f64()), (Some("coulomb"), Some(0.3)));
    assert_eq!((friction["stiffness"].as_f64(), friction["stick"].as_str()), (Some(1e4), Some("penalty")));
}

#[test]
fn work_and_stored_energy_of_friction_are_listed_on_their_own() {
    for (friction, springs) in [("penalty = 1e3", true), ("stick = \"multiplier\"", false)] {
        let contact = format!("method = \"nts\"\nfriction = {{ law = \"coulomb\", mu = 0.3, {friction} }}");
        let moving =
            [("method = \"nts\"", contact.as_str()), ("velocity = [0.0, 0.0, -1.0]", "velocity = [0.5, 0.0, -1.0]")];
        let folder = folder_with(&changed(&moving));
        run(folder.path(), "whole", &["--quiet"]);
        run(folder.path(), "parts", &["--quiet", "--until", "0.03"]);
        run(folder.path(), "parts", &["--quiet", "--resume"]);
        let read = |out: &str| std::fs::read_to_string(folder.path().join(out).join("balance.csv")).unwrap();
        let text = read("whole");
        assert_eq!(text, read("parts"), "the same bits after resuming");
        let head: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        let last = [
            "total",
            "closing_loss",
            "contact_remainder",
            "impact_loss",
            "impact_deformable",
            "impacts",
            "impact_capped",
            "friction_work",
            "friction_stored",
        ];
        assert_eq!(head[head.len() - last.len()..], last);
        let column = |name: &str| -> Vec<f64> {
            let at = head.iter().position(|head| *head == name).unwrap();
            text.lines().skip(1).map(|row| row.split(',').nth(at).unwrap().parse().unwrap()).collect()
        };
        let (work, stored, dissipated) = (column("friction_work"), column("friction_stored"), column("dissipation"));
        let most = work.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        assert!(most > 0.0, "they slide on each other: {work:?}");
        for ((w, s), d) in work.iter().zip(&stored).zip(&dissipated) {
            assert!((w - s - d).abs() < 1e-10 * most, "{friction}: {w:e} {s:e} {d:e}");
        }
        assert_eq!(stored.iter().any(|s| *s > 0.0), springs, "{friction}");
    }
}

#[test]
fn bodies_in_the_same_place_are_noticed() {
    let folder = folder_with(SCENE);
    let plan = stoss(folder.path(), &["check", "scene.toml"]);
    assert!(!String::from_utf8_lossy(&plan.stdout).contains("warning"), "{plan:?}");
    // In the same place as the lower one, and of the same divisions: node on node.
    let same = "min = [-1, -1, 0], max = [2, 2, 1], divisions = [3, 3, 2]";
    let folder = folder_with(&changed(&[("min = [0, 0, 1.02], max = [1, 1, 2.02], divisions = [2, 2, 2]", same)]));
    let plan = stoss(folder.path(), &["check", "scene.toml"]);
    let text = String::from_utf8_lossy(&plan.stdout).into_owned();
    assert_eq!(plan.status.code(), Some(0), "{}", stderr(&plan));
    assert!(text.contains("warning: upper.bottom/lower.top: the bodies overlap: 18 elements"), "{text}");
    assert!(text.contains("move one of the bodies"), "{text}");
}

/// The `error:` lines of `stoss check`.
fn errors(scene: &str, files: &[(&str, &str)]) -> Vec<String> {
    let folder = folder_with(scene);
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let output = stoss(folder.path(), &["check", "scene.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    stderr(&output).lines().filter(|line| line.starts_with("error: ")).map(str::to_owned).collect()
}

#[test]
fn contact_between_prescribed_surfaces_is_refused() {
    let all = "[[prescribe]]\nset = \"upper.all\"\ncomponents = [\"x\", \"y\", \"z\"]\ndisplacement = [0.0, 0.0, 0.0]\n\
               [[prescribe]]\nset = \"lower.top\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n[output]";
    let found = errors(&changed(&[("[output]", all)]), &[]);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("contact[0]") && found[0].contains("; remove the contact, or free"), "{}", found[0]);
    // One free component is enough.
    let free = changed(&[(
        "[output]",
        &all.replacen("[\"x\", \"y\", \"z\"]\ndisplacement = [0.0, 0.0, 0.0]", "[\"x\", \"y\"]\nfixed = true", 1),
    )]);
    let folder = folder_with(&free);
    assert_eq!(stoss(folder.path(), &["check", "scene.toml"]).status.code(), Some(0));
}

#[test]
fn remedies_fit_the_mistake() {
    let found = errors(&changed(&[("\"upper.bottom\"", "\"upper.botom\"")]), &[]);
    assert!(found[0].contains("did you mean `bottom`?"), "{}", found[0]);
    assert_eq!(found[0].matches("`right`").count(), 1, "the sets are listed once: {}", found[0]);

    let file = (
        "mesh = { generator = \"block\", min = [0, 0, 1.02], max = [1, 1, 2.02], divisions = [2, 2, 2] }",
        "mesh = { file = \"part.msh\" }",
    );
    let found = errors(&changed(&[file]), &[]);
    assert!(found[0].contains("paths are relative"), "{}", found[0]);
    let found = errors(&changed(&[file]), &[("part.msh", "$MeshFormat\n9 0 8\n$EndMeshFormat\n")]);
    assert!(!found[0].contains("paths are relative") && found[0].contains("msh41"), "{}", found[0]);
    let found = errors(&changed(&[file]), &[("part.msh", "")]);
    assert!(found[0].contains("part.msh:1:"), "{}", found[0]);

    let twice =
        "[[set]]\nname = \"lower.top\"\nbody = \"lower\"\nplane = { point = [0, 0, 1], normal = [0, 0, 1] }\n[output]";
    let found = errors(&changed(&[("[output]", twice)]), &[]);
    assert!(found[0].contains("exists already") && found[0].contains("`lower` has of its own: "), "{}", found[0]);
}

/// Two cubes on one another; the physical surface 7 is between them, 8 on top.
const STACK: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 7 \"middle\"\n2 8 \"lid\"\n$EndPhysicalNames\n\
    $Nodes\n12\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n9 0 0 2\n10 1 0 2\n11 1 1 2\n12 0 1 2\n$EndNodes\n\
    $Elements\n4\n1 5 2 0 1 1 2 3 4 5 6 7 8\n2 5 2 0 1 5 6 7 8 9 10 11 12\n3 3 2 7 1 5 6 7 8\n4 3 2 8 1 9 10 11 12\n$EndElements\n";

#[test]
fn a_surface_between_elements_is_explained() {
    let file = "mesh = { file = \"stack.msh\" }\nposition = [0, 0, 1.02]";
    let scene = changed(&[
        ("mesh = { generator = \"block\", min = [0, 0, 1.02], max = [1, 1, 2.02], divisions = [2, 2, 2] }", file),
        ("upper.bottom", "upper.middle"),
    ]);
    let found = errors(&scene, &[("stack.msh", STACK)]);
    assert!(found[0].contains("contact[0].slave") && found[0].contains("boundary, lid;"), "{}", found[0]);
    assert!(found[0].contains("between two elements has no outside"), "{}", found[0]);
}

/// Two blocks on a fixed plate, drawn sideways by the same body force: one slides, the other sticks.
#[test]
fn frames_have_status_friction_and_slip_of_contact() {
    let scene = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/incline.toml")).unwrap();
    let (text, _) = scene.split_once("[expect]").unwrap();
    let folder = folder_with(&text.replace("end = 10.0", "end = 2.0").replace("every = 100", "every = 200"));
    run(folder.path(), "out", &[]);
    let frame = stoss::mesh_io::read_vtu(folder.path().join("out/frames/frame_000200.vtu")).unwrap();
    let field = |name: &str| &frame.point_data[name].values;
    let [status, pressure, friction, slip] =
        ["contact_status", "contact_pressure", "friction_traction", "slip"].map(field);
    let (mut slide, mut stick) = (0, 0);
    for (node, &status) in status.iter().enumerate() {
        let ratio = friction[node] / pressure[node];
        match status {
            2.0 => {
                slide += 1;
                assert!((ratio - 0.3).abs() < 1e-9 && slip[node] > 1e-5, "{ratio} {}", slip[node]);
            }
            1.0 => {
                stick += 1;
                assert!(ratio < 0.3061 && slip[node] < 1e-9, "{ratio} {}", slip[node]);
            }
            other => assert!(other == 0.0 && pressure[node] == 0.0 && friction[node] == 0.0),
        }
    }
    assert_eq!((slide, stick), (9, 9));
}

/// Frames at times, at intervals and at the end only; values of a frame as tables.
#[test]
fn frames_are_chosen_by_time_and_their_values_are_tables() {
    let folder =
        folder_with(&changed(&[("every = 1", "times = [0.0, 0.011]\nfields = [\"displacement\", \"velocity\"]")]));
    let frames = |out: &str| {
        let names = std::fs::read_dir(folder.path().join(out).join("frames")).unwrap();
        let mut names: Vec<String> = names.map(|f| f.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names.into_iter().map(|name| name[6..12].parse().unwrap()).collect::<Vec<u64>>()
    };
    run(folder.path(), "times", &[]);
    // Steps of 0.002: 0.012 is the first end after 0.011, and the last step has a frame.
    assert_eq!(frames("times"), [0, 6, 20]);
    // Broken off and resumed, the same frames are there; the one of the break is not.
    run(folder.path(), "broken", &["--until", "0.008"]);
    assert_eq!(frames("broken"), [0, 4]);
    run(folder.path(), "broken", &["--resume"]);
    assert_eq!(results(&folder.path().join("broken")), results(&folder.path().join("times")));
    std::fs::write(folder.path().join("scene.toml"), changed(&[("every = 1", "interval = 0.01")])).unwrap();
    run(folder.path(), "interval", &[]);
    assert_eq!(frames("interval"), [0, 5, 10, 15, 20]);
    std::fs::write(folder.path().join("scene.toml"), changed(&[("every = 1", "last_only = true")])).unwrap();
    run(folder.path(), "last", &[]);
    assert_eq!(frames("last"), [20]);

    // Through both blocks, from above the upper one to the ground.
    let line = ["values", "times", "--line", "0.5,0.5,2.5", "0.5,0.5,0", "--points", "6", "--frame", "0"];
    let output = stoss(folder.path(), &line);
    let table = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(
        lines[0],
        "distance,x,y,z,inside,body,displacement_x,displacement_y,displacement_z,velocity_x,velocity_y,velocity_z"
    );
    let ends: Vec<&str> = lines[1..].iter().map(|line| line.splitn(5, ',').last().unwrap()).collect();
    let falls = "1,upper,0e0,0e0,0e0,0e0,0e0,-1e0";
    let rests = "1,lower,0e0,0e0,0e0,0e0,0e0,0e0";
    assert_eq!(ends, ["0,,,,,,,", falls, falls, rests, rests, rests]);
    let plane = ["values", "times", "--plane", "0,0,0.5", "0,0,1", "--field", "velocity", "-o", "plane.csv"];
    assert_eq!(stoss(folder.path(), &plane).status.code(), Some(0));
    assert!(std::fs::read_to_string(folder.path().join("plane.csv")).unwrap().lines().count() > 2000);
    for wrong in [
        &["values", "times"][..],
        &["values", "times", "--line", "0,0,0", "0,0,0"],
        &["values", "times", "--line", "0,0,0", "1,1"],
        &["values", "times", "--line", "0,0,0", "1,0,0", "--spacing", "0.1"],
        &["values", "times", "--plane", "0,0,0.5", "0,0,1", "--points", "7"],
    ] {
        assert_eq!(stoss(folder.path(), wrong).status.code(), Some(2), "{wrong:?}");
    }
    assert_eq!(stoss(folder.path(), &["values", "nowhere", "--line", "0,0,0", "1,0,0"]).status.code(), Some(1));
}

/// All frames in one file: they are those of the VTU files of the same run, also after a break, and the other commands read them.
#[test]
fn one_file_has_the_frames_of_all_vtu_files() {
    use stoss_report::folder::Folder;
    let fields = "every = 2\nfields = [\"displacement\", \"cauchy_stress\", \"gap\", \"deformation_gradient\"]";
    let folder = folder_with(&changed(&[("every = 1", fields)]));
    let at = |out: &str| folder.path().join(out);
    run(folder.path(), "vtu", &[]);
    let single = changed(&[("every = 1", &format!("{fields}\nformat = \"vtkhdf\""))]);
    std::fs::write(at("scene.toml"), single).unwrap();
    run(folder.path(), "whole", &[]);
    // The frame of the break, of step 7, is not in the run that goes on.
    run(folder.path(), "broken", &["--until", "0.014"]);
    assert_eq!(Folder::open(&at("broken")).unwrap().frames.len(), 5);
    run(folder.path(), "broken", &["--resume"]);
    // Of an earlier run with VTU files nothing stays.
    run(folder.path(), "later", &["--until", "0.004"]);
    let vtu = Folder::open(&at("vtu")).unwrap();
    for out in ["whole", "broken"] {
        let one = Folder::open(&at(out)).unwrap();
        assert!(!at(out).join("frames").exists() && !at(out).join("frames.pvd").exists());
        assert_eq!(one.frames.len(), vtu.frames.len());
        for k in 0..vtu.frames.len() {
            assert_eq!(one.frames[k].time, vtu.frames[k].time);
            // Gaps may be no numbers: texts are compared.
            assert_eq!(
                format!("{:?}", one.grid(k).unwrap()),
                format!("{:?}", vtu.grid(k).unwrap()),
                "{out}: frame {k}"
            );
        }
    }
    let judged = |out: &str| stoss(folder.path(), &["judge", out]).stdout;
    assert_eq!(judged("whole"), judged("vtu"));
    let line = |out: &str| stoss(folder.path(), &["values", out, "--line", "0.5,0.5,1.8", "0.5,0.5,0"]).stdout;
    assert!(line("broken") == line("vtu") && line("vtu").len() > 5000);
    assert_eq!(stoss(folder.path(), &["report", "whole", "vtu"]).status.code(), Some(0));
    // Another format for the rest of a run is refused, and a run with VTU files removes the one file.
    std::fs::write(at("scene.toml"), changed(&[("every = 1", fields)])).unwrap();
    let output = stoss(folder.path(), &["run", "scene.toml", "--out", "later", "--resume"]);
    assert!(output.status.code() == Some(1) && stderr(&output).contains("format = \"vtkhdf\""), "{}", stderr(&output));
    run(folder.path(), "later", &[]);
    assert!(!at("later").join("frames.vtkhdf").exists() && at("later").join("frames/frame_000002.vtu").exists());
}
