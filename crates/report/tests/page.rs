//! The page: what is in it is what the run left, and a browser shows it.

use std::io::Read;
use std::path::Path;
use std::process::Command;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use stoss_mesh_io::{Field, VtuFrame, write_vtu};
use stoss_report::page::coding::decode;
use stoss_report::page::{Follower, NAME, page, write, write_as};
use tempfile::TempDir;

const FRAMES: usize = 6;
const CUBE: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];
/// Two points of a rope and a single point behind the cube.
const MORE: [[f64; 3]; 3] = [[2.0, 0.0, 0.5], [3.0, 0.5, 0.5], [3.0, 1.0, 1.5]];

/// Place of a point in a frame: a turn, a stretch and a way.
fn moved([x, y, z]: [f64; 3], frame: usize) -> [f64; 3] {
    let time = frame as f64 / FRAMES as f64;
    let (s, c) = (0.7 * time).sin_cos();
    [c * x - s * y + time, s * x + c * y, z * (1.0 + 0.3 * time) - 0.2 * time * time]
}

/// Stress of a node in a frame: something of every component.
fn stress(node: usize, frame: usize) -> [f64; 6] {
    std::array::from_fn(|k| ((3 * node + 5 * k) as f64).sin() * (1.0 + frame as f64))
}

/// A folder of results: a cube, a rope and a point that move, with a stress and a pressure on the cube only, and a friction that is far larger at one node once.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fill(folder.path());
    folder
}

fn fill(folder: &Path) {
    let put = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    std::fs::create_dir_all(folder.join("frames")).unwrap();
    let points: Vec<[f64; 3]> = CUBE.iter().chain(&MORE).copied().collect();
    let mut collection = String::from("<VTKFile><Collection>");
    let mut balance = String::from("step,time,dt,lx,ly,lz,jx,jy,jz,kinetic,strain,total\n");
    for frame in 0..FRAMES {
        let way: Vec<f64> = points.iter().flat_map(|&p| (0..3).map(move |k| moved(p, frame)[k] - p[k])).collect();
        let pressure: Vec<f64> = (0..11).map(|k| if k < 8 { (k * frame) as f64 * 0.125 } else { f64::NAN }).collect();
        let of_cube = |node: usize| node < CUBE.len();
        let stress: Vec<f64> =
            (0..11).flat_map(|k| if of_cube(k) { stress(k, frame) } else { [f64::NAN; 6] }).collect();
        let friction: Vec<f64> = (0..11).map(|k| if (k, frame) == (3, 5) { 500.0 } else { 1.0 + k as f64 }).collect();
        let point_data = vec![
            Field { name: "displacement", components: 3, values: &way },
            Field { name: "cauchy_stress", components: 6, values: &stress },
            Field { name: "friction_traction", components: 1, values: &friction },
            Field { name: "contact_pressure", components: 1, values: &pressure },
        ];
        let cube = stoss_mesh::Elements::from(vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
        let data = VtuFrame {
            points: &points,
            elements: cube.blocks(),
            lines: &[vec![8, 9]],
            vertices: &[10],
            point_data,
            cell_data: vec![Field { name: "body", components: 1, values: &[0.0, 1.0, 2.0] }],
            ..VtuFrame::default()
        };
        write_vtu(folder.join(format!("frames/frame_{frame:06}.vtu")), &data).unwrap();
        collection += &format!("<DataSet timestep=\"{}\" file=\"frames/frame_{frame:06}.vtu\"/>", frame as f64 / 10.0);
        balance += &format!("{frame},{},0.1,1,0,0,0,0,{frame},2,{frame},3\n", frame as f64 / 10.0);
    }
    put("frames.pvd", &(collection + "</Collection></VTKFile>"));
    put("balance.csv", &balance);
    put(
        "contact.csv",
        "step,time,active,sole.force_x,sole.force_y,sole.force_z,sole.area,sole.friction_work\n1,0.1,4,3,0,4,2,0\n2,0.2,4,6,0,8,2,1\n",
    );
    let scene = "title = '</script><b>$& http://a'";
    let bodies = serde_json::json!({"bodies": ["cube", "rope", "mass"], "plan": ["one line"], "scene": scene});
    put("run.json", &bodies.to_string());
    let finding =
        serde_json::json!({"level": "wrong", "sentence": "a node is inside", "time": 0.2, "position": [0.5, 0.5, 1.0]});
    let summary = serde_json::json!({
        "title": "A cube </title> & more", "steps": 5, "time": 0.5, "wall_seconds": 1.0, "outcome": {"kind": "completed"},
        "decisions": [{"step": 2, "time": 0.2, "dt": 0.2, "kind": "Cut", "reason": "no convergence"}],
        "verdict": {"level": "wrong", "reasons": [finding]},
    });
    put("summary.json", &summary.to_string());
}

/// Cases of a sweep, the last of them without results.
fn sweep() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let cases = folder.path().join("cases");
    let mut table =
        String::from("case,mu,outcome,verdict,reason,time,last.tip.x,last.tip.y,min.contact.max_pressure\n");
    for number in 1..4 {
        let mu = 0.1 * f64::from(number);
        if number < 3 {
            fill(&cases.join(format!("000{number}")));
            table += &format!("{number},{mu:e},completed,sound,,0.5,{},2,3\n", 0.05 / mu);
        } else {
            table += &format!("{number},{mu:e},failed,,\"step 1, </script> & \"\"more\"\"\",,,,\n");
        }
        let mark = serde_json::json!({"scene": "", "values": {"mu": mu}});
        std::fs::write(cases.join(format!("000{number}.json")), mark.to_string()).unwrap();
    }
    std::fs::write(folder.path().join("sweep.csv"), table).unwrap();
    folder
}

/// Header and arrays of the first run of a page.
fn unpacked(text: &str) -> (Value, Vec<u8>) {
    let (_, rest) = text.split_once("class=\"run\">").unwrap();
    let (data, _) = rest.split_once("</script>").unwrap();
    let packed = STANDARD.decode(data).unwrap();
    // The reader for a single member must come to the end of the data: a browser refuses bytes behind it.
    let mut reader = flate2::bufread::GzDecoder::new(packed.as_slice());
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).unwrap();
    assert!(reader.into_inner().is_empty());
    let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
    (serde_json::from_slice(&bytes[4..4 + length]).unwrap(), bytes[4 + length..].to_vec())
}

fn array<'a>(bytes: &'a [u8], place: &Value) -> &'a [u8] {
    let [start, length] = ["start", "bytes"].map(|key| place[key].as_u64().unwrap() as usize);
    &bytes[start..start + length]
}

fn whole(bytes: &[u8], place: &Value) -> Vec<usize> {
    let chunks = array(bytes, place).chunks(4);
    chunks.map(|four| u32::from_le_bytes(four.try_into().unwrap()) as usize).collect()
}

#[test]
fn positions_and_values_come_back() {
    let folder = folder();
    let (header, bytes) = unpacked(&page(&[folder.path()]).unwrap().text);
    let animation = &header["animation"];
    let numbers = whole(&bytes, &animation["numbers"]);
    assert_eq!((numbers.len(), animation["times"].as_array().unwrap().len()), (11, FRAMES));
    let names: Vec<&str> =
        animation["bodies"].as_array().unwrap().iter().map(|b| b["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["cube", "rope", "mass"]);
    let points: Vec<[f64; 3]> = CUBE.iter().chain(&MORE).copied().collect();
    let reference = decode(array(&bytes, &animation["reference"]), 33);
    let moves = decode(array(&bytes, &animation["displacement"]), 33);
    assert_eq!((reference.len(), moves.len()), (33, 33 * FRAMES));
    for (node, &point) in numbers.iter().enumerate() {
        for axis in 0..3 {
            let [corner, edge, largest] =
                ["corner", "edges", "largest"].map(|key| animation[key][axis].as_f64().unwrap());
            let found = corner + edge * f64::from(reference[11 * axis + node]) / 65535.0;
            assert!((found - points[point][axis]).abs() <= edge * 0.5001 / 65535.0, "{point} {axis}");
            for frame in 0..FRAMES {
                let found = largest * f64::from(moves[33 * frame + 11 * axis + node] as i16) / 32767.0;
                let wanted = moved(points[point], frame)[axis] - points[point][axis];
                // What does not move has no displacement at all.
                let bound = if wanted == 0.0 { 0.0 } else { largest * 0.5001 / 32767.0 };
                assert!((found - wanted).abs() <= bound, "{frame} {point} {axis}");
            }
        }
    }
    let packed = |name: &str| {
        let arrays = animation["arrays"].as_array().unwrap();
        arrays.iter().find(|array| array["name"] == name).unwrap()["components"].as_array().unwrap()
    };
    let within = |component: &Value, wanted: &dyn Fn(usize, usize) -> f64| {
        let largest = component["largest"].as_f64().unwrap();
        let codes = decode(array(&bytes, &component["stream"]), 11);
        for (frame, (node, &point)) in (0..FRAMES).flat_map(|frame| numbers.iter().enumerate().map(move |n| (frame, n)))
        {
            let code = codes[11 * frame + node];
            let root = (f64::from(code) - 2048.0) / 2047.0;
            match point < 8 {
                true => assert!((largest * root * root.abs() - wanted(point, frame)).abs() <= largest / 2047.0),
                false => assert_eq!(code, 0),
            }
        }
        largest
    };
    let largest = within(&packed("contact_pressure")[0], &|point, frame| (point * frame) as f64 * 0.125);
    assert_eq!(largest, 4.375);
    let tensor = packed("cauchy_stress");
    assert_eq!(tensor.len(), 6);
    for (k, component) in tensor.iter().enumerate() {
        within(component, &|point, frame| stress(point, frame)[k]);
    }
    let elements: Vec<usize> = whole(&bytes, &animation["elements"]).iter().map(|&node| numbers[node]).collect();
    assert_eq!(elements, [0, 1, 2, 3, 4, 5, 6, 7]);
    // Every field refers to its array.
    for field in animation["fields"].as_array().unwrap() {
        let array = &animation["arrays"][field["array"].as_u64().unwrap() as usize];
        assert!(
            field["label"].as_str().unwrap().contains(array["label"].as_str().unwrap())
                || field["part"]["kind"] == "von_mises"
        );
    }
}

#[test]
fn a_page_stands_by_itself() {
    let folder = folder();
    let page = page(&[folder.path()]).unwrap();
    assert_eq!(page.notes, Vec::<String>::new());
    for word in ["http:", "https:", "src=", "@import", "{{", "</title> & more"] {
        assert!(!page.text.contains(word), "{word}");
    }
    assert!(page.text.contains("<title>A cube &lt;/title> &amp; more</title>"));
    let (header, _) = unpacked(&page.text);
    assert_eq!(header["run"]["scene"], "title = '</script><b>$& http://a'");
}

#[test]
fn what_is_broken_is_named_and_the_rest_is_shown() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("balance.csv"), "step,time\n1\n").unwrap();
    std::fs::write(path.join("probes.csv"), "").unwrap();
    std::fs::write(path.join("newton.csv"), "step,time\n1,2\n").unwrap();
    std::fs::write(path.join("frames/frame_000003.vtu"), "<VTK").unwrap();
    let (header, _) = unpacked(&page(&[path]).unwrap().text);
    let notes: Vec<&str> = header["notes"].as_array().unwrap().iter().map(|note| note.as_str().unwrap()).collect();
    assert_eq!(notes.len(), 4, "{notes:?}");
    for name in ["balance.csv", "probes.csv", "newton.csv", "frame_000003.vtu"] {
        assert!(notes.iter().any(|note| note.contains(name)), "{name}: {notes:?}");
    }
    assert_eq!(header["animation"]["times"].as_array().unwrap().len(), 3);
    std::fs::remove_file(path.join("frames/frame_000000.vtu")).unwrap();
    let page = page(&[path]).unwrap();
    assert!(page.notes.iter().any(|note| note.contains("frame_000000.vtu")));
    assert!(unpacked(&page.text).0["animation"].is_null());
}

/// The test of the page is in no user's page, and belongs to the program that starts it.
#[test]
fn the_test_is_not_shipped() {
    let folder = folder();
    let text = page(&[folder.path()]).unwrap().text;
    assert!(!text.contains("tryControls") && !text.contains("#test") && text.contains("const started = start()"));
    assert!(text.matches("</body>").count() == 1 && TEST.contains("await test(app)"));
}

#[test]
fn a_file_of_somebody_else_is_kept() {
    let folder = folder();
    let file = folder.path().join(NAME);
    std::fs::write(&file, "my own").unwrap();
    assert!(write(&[folder.path()]).unwrap_err().to_string().contains(NAME));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "my own");
    std::fs::remove_file(&file).unwrap();
    write(&[folder.path()]).unwrap();
    write(&[folder.path()]).unwrap();
}

#[test]
fn a_page_of_a_sweep_has_its_cases_and_its_table() {
    let folder = sweep();
    write(&[folder.path()]).unwrap();
    let text = std::fs::read_to_string(folder.path().join(NAME)).unwrap();
    assert_eq!(text.matches("class=\"run\">").count(), 2);
    let (header, _) = unpacked(&text);
    assert_eq!((&header["name"], &header["values"]["mu"]), (&"mu = 0.1".into(), &0.1.into()));
    let (_, rest) = text.split_once("id=\"sweep\">").unwrap();
    let table: Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
    assert_eq!((&table["cases"][0]["results"][1], &table["cases"][1]["run"]), (&0.5.into(), &1.into()));
    assert_eq!(
        (&table["cases"][2]["run"], &table["cases"][2]["reason"]),
        (&Value::Null, &"step 1, </script> & \"more\"".into())
    );
    // A case that is named by itself has its label, too.
    let cases = [1, 2].map(|number| folder.path().join(format!("cases/000{number}")));
    let text = page(&[&cases[1], &cases[0]]).unwrap().text;
    assert_eq!(unpacked(&text).0["name"], "mu = 0.2");
    std::fs::remove_dir_all(folder.path().join("cases")).unwrap();
    assert!(write(&[folder.path()]).unwrap_err().to_string().contains("no case"));
}

#[test]
fn who_follows_a_run_reads_a_frame_once() {
    let folder = folder();
    let path = folder.path();
    let all = std::fs::read_to_string(path.join("frames.pvd")).unwrap();
    let shown = || unpacked(&std::fs::read_to_string(path.join(NAME)).unwrap());
    let wanted = unpacked(&page(&[path]).unwrap().text);
    // Three frames, and a row of a table that is being written.
    let part = all.match_indices("/>").nth(2).map(|(end, mark)| &all[..end + mark.len()]).unwrap();
    std::fs::write(path.join("frames.pvd"), format!("{part}</Collection></VTKFile>")).unwrap();
    let balance = std::fs::read_to_string(path.join("balance.csv")).unwrap();
    std::fs::write(path.join("balance.csv"), &balance[..balance.len() - 5]).unwrap();
    let mut follower = Follower::default();
    assert_eq!(follower.write(path, Some(2.5)).unwrap(), Vec::<String>::new());
    let text = std::fs::read_to_string(path.join(NAME)).unwrap();
    assert!(text.contains("<meta name=\"stoss-reload\" content=\"2.5\">"));
    assert_eq!(shown().0["animation"]["times"].as_array().unwrap().len(), 3);
    assert_eq!(shown().0["tables"][0]["rows"], FRAMES - 1);
    std::fs::write(path.join("frames.pvd"), &all).unwrap();
    std::fs::write(path.join("balance.csv"), &balance).unwrap();
    // A frame that was read, and whose file looks as before, is not looked into again.
    let frame = path.join("frames/frame_000001.vtu");
    let data = std::fs::metadata(&frame).unwrap();
    std::fs::write(&frame, vec![b'?'; data.len() as usize]).unwrap();
    let times = std::fs::FileTimes::new().set_modified(data.modified().unwrap());
    std::fs::File::options().write(true).open(&frame).unwrap().set_times(times).unwrap();
    assert_eq!(follower.write(path, None).unwrap(), Vec::<String>::new());
    assert!(shown() == wanted);
    assert!(!std::fs::read_to_string(path.join(NAME)).unwrap().contains("content=\"2.5\""));
    // One that was written again is.
    std::fs::write(&frame, "?").unwrap();
    assert!(follower.write(path, None).unwrap()[0].contains("frame_000001.vtu"));
    assert_eq!(shown().0["animation"]["times"].as_array().unwrap().len(), 1);
}

/// The browser, if there is one.
fn chromium() -> Option<&'static str> {
    let starts = |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    ["chromium", "chromium-browser", "google-chrome"].into_iter().find(starts)
}

/// What uses every control of a page; no user's page has it.
const TEST: &str =
    concat!(include_str!("../src/page/assets/selftest-model.js"), include_str!("../src/page/assets/selftest.js"));

/// Adds the test to a page.
fn with_test(file: &Path) {
    let text = std::fs::read_to_string(file).unwrap();
    assert!(!text.contains("tryControls"));
    std::fs::write(file, text.replacen("</body>", &format!("<script>\n{TEST}</script>\n</body>"), 1)).unwrap();
}

/// How the browser is started.
const FLAGS: [&str; 11] = [
    "--headless",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--enable-logging=stderr",
    "--window-size=1000,700",
];

/// Loads a page and returns its document and what the browser's console got.
fn load(browser: &str, file: &Path, hash: &str) -> (String, Vec<String>) {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(FLAGS)
        .args(["--virtual-time-budget=120000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}{hash}", file.display()))
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    // A driver may remark that reading pixels takes time: only the test does that.
    let is_told = |line: &&str| line.contains("CONSOLE") && !line.contains("GPU stall due to ReadPixels");
    let console = errors.lines().filter(is_told).map(str::to_owned).collect();
    (String::from_utf8_lossy(&output.stdout).into_owned(), console)
}

fn title(document: &str) -> &str {
    let (_, rest) = document.split_once("<title>").unwrap_or(("", document));
    rest.split_once("</title>").map_or(rest, |(title, _)| title)
}

/// Loads the page, lets it use all of its own controls, and wants `ready`, the names of what was tried, and an empty console.
fn passes(browser: &str, folders: &[&Path], tried: &[&str]) {
    write(folders).unwrap();
    passes_file(browser, &folders[0].join(NAME), tried);
}

/// Tries a page that is there, as [`passes`].
fn passes_file(browser: &str, file: &Path, tried: &[&str]) {
    with_test(file);
    let (document, console) = load(browser, file, "#test");
    assert_eq!(title(&document), "ready", "{console:?}");
    assert_eq!(console, Vec::<String>::new());
    let (_, list) = document.split_once("id=\"tested\">").unwrap();
    for name in tried {
        assert!(list.lines().any(|line| line == *name), "{name} was not tried: {list}");
    }
}

#[test]
fn a_browser_shows_it() {
    let Some(browser) = chromium() else {
        println!("skipped: no chromium on this machine");
        return;
    };
    let (one, two, plain) = (folder(), folder(), folder());
    let controls = [
        "chart Contact force by pair",
        "chart Contact area by pair",
        "chart Frictional work by pair",
        "the picture is not blank",
        "scrub",
        "squares of cauchy stress",
        "von Mises stress of principal stresses",
        "the typical range has nearly all contact",
        "rims are left out",
        "min, max are marked",
        "automatic deformation",
        "arrows of contact pressure",
        "a mirrored node",
        "a node can be picked in a copy",
        "what is shown fills the picture",
        "the saved picture has the bodies and what is over them",
        "every copy is drawn",
        "filled cut",
        "volume of cuts across axis 2",
        "a path begins and ends with the values of its nodes",
        "a path as a table",
        "columns of balance",
        "clip plane",
        "a node can be picked",
        "playing changes the picture",
    ];
    passes(browser, &[one.path()], &controls);
    passes(browser, &[one.path(), two.path()], &["panel Compare", "hide a body", "panel Verdict"]);
    // Without frames: charts only.
    std::fs::remove_file(plain.path().join("frames.pvd")).unwrap();
    passes(browser, &[plain.path()], &["panel Balance", "panel Solver"]);
    passes(browser, &[plain.path(), two.path()], &["panel Compare", "scrub"]);
    // A run that failed in its first step, and has one frame and one row.
    for (name, keep) in [("frames.pvd", "frame_000000.vtu\"/>"), ("balance.csv", "3\n")] {
        let file = plain.path().join(name);
        let text = std::fs::read_to_string(two.path().join(name)).unwrap();
        let (before, _) = text.split_once(keep).unwrap();
        std::fs::write(
            file,
            format!("{before}{keep}{}", if name == "frames.pvd" { "</Collection></VTKFile>" } else { "" }),
        )
        .unwrap();
    }
    write(&[plain.path()]).unwrap();
    let (document, console) = load(browser, &plain.path().join(NAME), "#t=0&tab=Solver&view=0,90&clip=1&extremes=true");
    assert!(document.contains("data-state=\"ready\"") && console.is_empty(), "{console:?}");
    // An error of the page is reported, so that the test can fail.
    let file = one.path().join(NAME);
    let text = std::fs::read_to_string(&file).unwrap().replacen("class=\"run\">H4s", "class=\"run\">H5s", 1);
    std::fs::write(&file, text).unwrap();
    assert!(title(&load(browser, &file, "#test").0).starts_with("error"));
}

/// A plate of 5400 facets that turns, with a stress.
fn plate(folder: &Path) {
    const N: usize = 50;
    let across = N + 1;
    let number = |i: usize, j: usize, k: usize| (i + across * (j + across * k)) as u32;
    let points: Vec<[f64; 3]> = (0..across * across * 3)
        .map(|p| [p % across, p / across % across, p / across / across].map(|n| n as f64 / N as f64))
        .collect();
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let cells = (0..N * N * 2).map(|e| [e % N, e / N % N, e / N / N]);
    let elements: Vec<[u32; 8]> = cells.map(|[i, j, k]| corners.map(|[a, b, c]| number(i + a, j + b, k + c))).collect();
    let elements = stoss_mesh::Elements::from(elements);
    std::fs::create_dir_all(folder.join("frames")).unwrap();
    let mut collection = String::from("<VTKFile><Collection>");
    for frame in 0..FRAMES {
        let way: Vec<f64> = points.iter().flat_map(|&p| (0..3).map(move |k| moved(p, frame)[k] - p[k])).collect();
        let stress: Vec<f64> = (0..points.len()).flat_map(|node| stress(node, frame)).collect();
        let point_data = vec![
            Field { name: "displacement", components: 3, values: &way },
            Field { name: "cauchy_stress", components: 6, values: &stress },
        ];
        let data = VtuFrame { points: &points, elements: elements.blocks(), point_data, ..VtuFrame::default() };
        write_vtu(folder.join(format!("frames/frame_{frame:06}.vtu")), &data).unwrap();
        collection += &format!("<DataSet timestep=\"{frame}\" file=\"frames/frame_{frame:06}.vtu\"/>");
    }
    std::fs::write(folder.join("frames.pvd"), collection + "</Collection></VTKFile>").unwrap();
}

/// The script of a frame takes less than a thirtieth of a second, also with an arrow at each node and a filled cut: in the fastest of twenty frames, for other programs run beside.
#[test]
fn a_browser_draws_a_large_run_in_time() {
    let Some(browser) = chromium() else {
        println!("skipped: no chromium on this machine");
        return;
    };
    let (folder, profile) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    plate(folder.path());
    write(&[folder.path()]).unwrap();
    let page = folder.path().join(NAME);
    with_test(&page);
    let server = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = server.local_addr().unwrap().port();
    let mut browser = Command::new(browser)
        .args(FLAGS)
        .args(["--remote-debugging-port=0", &format!("--user-data-dir={}", profile.path().display())])
        .arg(format!("file://{}#test-time={port}", page.display()))
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    server.set_nonblocking(true).unwrap();
    let asked = (0..600).find_map(|_| {
        std::thread::sleep(std::time::Duration::from_millis(100));
        server.accept().ok()
    });
    let mut text = [0; 1024];
    let read = asked.map(|(mut stream, _)| {
        stream.set_nonblocking(false).unwrap();
        stream.read(&mut text).unwrap()
    });
    browser.kill().unwrap();
    browser.wait().unwrap();
    let text = String::from_utf8_lossy(&text[..read.expect("the page tells its times")]);
    let text =
        text.replace("%22", "\"").replace("%7B", "{").replace("%7D", "}").replace("%2C", ",").replace("%3A", ":");
    let (_, rest) = text.split_once('?').unwrap();
    let times: Value = serde_json::from_str(rest.split_whitespace().next().unwrap()).unwrap();
    println!("milliseconds: {times}");
    for name in ["script", "more"] {
        assert!(times[name].as_f64().unwrap() < 33.0, "{times}");
    }
}

/// What a scene has where: a surface, places with a line, and arrows.
#[test]
fn a_browser_shows_a_scene_before_its_run() {
    let folder = folder();
    for name in ["summary.json", "balance.csv", "contact.csv"] {
        std::fs::remove_file(folder.path().join(name)).unwrap();
    }
    let layer = |kind: &str, name: &str, shown: Value| {
        let mut layer = serde_json::json!({"kind": kind, "name": name, "about": "", "places": [], "facets": [], "lines": [], "arrows": []});
        shown.as_object().unwrap().iter().for_each(|(key, value)| layer[key] = value.clone());
        layer
    };
    let square =
        serde_json::json!({"places": [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], "facets": [[0, 1, 2], [0, 2, 3]]});
    let arrows = serde_json::json!({"arrows": [{"at": [0.5, 0, 0], "along": [0, 1, 0], "pushes": true}]});
    let layers = [
        layer("contact", "floor: slave", square.clone()),
        layer("joint", "pin", serde_json::json!({"places": [[1, 0, 0], [2, 0, 0]], "lines": [[0, 1]]})),
        layer("load", "push", arrows),
        layer("set", "cube.top", square),
    ];
    let setup = serde_json::json!({"title": "Before </script>", "layers": layers});
    std::fs::write(folder.path().join("setup.json"), setup.to_string()).unwrap();
    let file = folder.path().join("scene.view.html");
    write_as(folder.path(), &file).unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("<title>Before &lt;/script></title>"));
    let (header, _) = unpacked(&text);
    assert_eq!(header["setup"], setup);
    // The only body with a surface has no other one beside it.
    assert!(!header["animation"]["arrays"].to_string().contains("distance_to_other_bodies"));
    let Some(browser) = chromium() else {
        println!("skipped: no chromium on this machine");
        return;
    };
    let layers = ["layer floor: slave", "layer pin", "layer push", "layer cube.top", "names of layers", "panel Model"];
    passes_file(browser, &file, &layers);
}

#[test]
fn a_browser_shows_a_sweep_and_keeps_what_it_shows_over_a_reload() {
    let Some(browser) = chromium() else {
        println!("skipped: no chromium on this machine");
        return;
    };
    let (one, sweep) = (folder(), sweep());
    // A page that loads itself again is as it was before.
    Follower::default().write(one.path(), Some(0.3)).unwrap();
    with_test(&one.path().join(NAME));
    let (document, console) = load(browser, &one.path().join(NAME), "#test-reload");
    assert_eq!((title(&document), console), ("ready", Vec::new()));
    passes(browser, &[sweep.path()], &["panel Sweep", "panel Compare", "chart tip at the end over mu", "scrub"]);
}

/// Another outcome and verdict in a summary.
fn ended(folder: &Path, outcome: Value, level: &str) {
    let file = folder.join("summary.json");
    let mut summary: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    summary["outcome"] = outcome;
    summary["verdict"] = serde_json::json!({"level": level, "reasons": []});
    std::fs::write(file, summary.to_string()).unwrap();
}

/// Classes and text of an element of a document.
fn element<'a>(document: &'a str, id: &str) -> (&'a str, &'a str) {
    let (_, rest) = document.split_once(&format!("id=\"{id}\"")).unwrap_or_else(|| panic!("no {id}"));
    let (head, rest) = rest.split_once('>').unwrap();
    let class = head.split_once("class=\"").map_or("", |(_, rest)| rest.split('"').next().unwrap());
    (class, rest.split('<').next().unwrap())
}

/// Only a run that reached its end has a badge in the colour of its verdict; that of another one says up to where it goes, after the outcome.
#[test]
fn a_browser_shows_the_outcome_before_the_verdict() {
    let Some(browser) = chromium() else {
        println!("skipped: no chromium on this machine");
        return;
    };
    let folder = folder();
    let shown = |outcome: Value, level: &str| {
        ended(folder.path(), outcome, level);
        write(&[folder.path()]).unwrap();
        let (document, console) = load(browser, &folder.path().join(NAME), "#tab=Verdict");
        assert_eq!(console, Vec::<String>::new());
        assert!(document.find("id=\"outcome\"") < document.find("id=\"verdict\""));
        let of = |id: &str| {
            let (class, text) = element(&document, id);
            format!("{class}: {text}")
        };
        let headings: Vec<String> =
            document.split("<h2>").skip(1).map(|rest| rest.split('<').next().unwrap().to_owned()).collect();
        ([of("outcome"), of("verdict"), of("failure")], headings[..2].to_vec())
    };
    let kind = |kind: &str| serde_json::json!({"kind": kind, "last_step": 5, "last_time": 0.5});
    let (badges, headings) = shown(kind("completed"), "sound");
    assert_eq!(badges, ["badge completed: completed", "badge sound: sound", ": "]);
    assert_eq!(headings, ["Outcome: completed", "Verdict: sound"]);
    let failed =
        serde_json::json!({"kind": "failed", "reason": "the system is singular", "last_step": 5, "last_time": 0.5});
    let (badges, headings) = shown(failed, "sound");
    assert_eq!(badges, ["badge failed: failed", "badge part: sound up to t = 0.5", ": the system is singular"]);
    assert_eq!(headings, ["Outcome: failed", "Verdict up to t = 0.5: sound"]);
    for (outcome, words) in
        [("stopped", "stopped before its end"), ("interrupted", "interrupted"), ("running", "running")]
    {
        let (badges, _) = shown(kind(outcome), "wrong");
        assert_eq!(
            badges[..2],
            [format!("badge {outcome}: {words}"), "badge part wrong: wrong up to t = 0.5".to_owned()]
        );
    }
}

/// In a frame as wide as the screen of a telephone nothing sticks out, and words of labels are whole.
#[test]
fn a_narrow_browser_shows_it() {
    let Some(browser) = chromium() else {
        println!("skipped: no chromium on this machine");
        return;
    };
    let (folder, sweep) = (folder(), sweep());
    let reason = "step 6 from time 0.5 failed even at the step size 4.883e-4: ".repeat(4);
    ended(
        folder.path(),
        serde_json::json!({"kind": "failed", "reason": reason, "last_step": 5, "last_time": 0.5}),
        "sound",
    );
    write(&[folder.path()]).unwrap();
    write(&[sweep.path()]).unwrap();
    const MEASURE: &str = "<script>
      started.then((app) => {
        const wide = [...app.panels.tabs.keys()].map((name) => {
          app.panels.open(name);
          return document.documentElement.scrollWidth - document.documentElement.clientWidth;
        });
        app.panels.open('Run');
        const label = [...document.querySelectorAll('#panels .on th')].find((found) => found.textContent === 'outcome');
        const line = label && label.getClientRects().length && new Range();
        if (line) line.selectNodeContents(label);
        parent.postMessage(JSON.stringify({ wide: Math.max(...wide), lines: line ? line.getClientRects().length : 0 }), '*');
      });
    </script></body>";
    for page in [folder.path(), sweep.path()] {
        let text = std::fs::read_to_string(page.join(NAME)).unwrap();
        std::fs::write(page.join("measured.html"), text.replacen("</body>", MEASURE, 1)).unwrap();
        for width in [390, 320] {
            let frame = format!(
                "<title>none</title><iframe src=\"measured.html\" style=\"width: {width}px; height: 800px\"></iframe>\
                 <script>onmessage = (event) => {{ document.title = event.data; }}</script>"
            );
            std::fs::write(page.join("frame.html"), frame).unwrap();
            let (document, _) = load(browser, &page.join("frame.html"), "");
            assert_eq!(title(&document), "{\"wide\":0,\"lines\":1}", "{width}");
        }
    }
}
