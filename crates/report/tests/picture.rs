//! Pictures of a frame: what is drawn, with which colours, and what is refused.

use stoss_mesh_io::{Field, VtuFrame, write_vtu};
use stoss_report::picture::{Options, Unfit, Which, picture};
use tempfile::TempDir;

/// A cube of one element, a plate of one facet below it, two points of a rope.
const POINTS: [[f64; 3]; 14] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, -1.0, -1.0],
    [2.0, -1.0, -1.0],
    [2.0, 2.0, -1.0],
    [-1.0, 2.0, -1.0],
    [2.0, 0.0, 0.5],
    [3.0, 0.5, 0.5],
];

/// Three frames at times 0, 0.1 and 0.2 with displacements of length 0, 1 and 2 everywhere, and a stress on the cube.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("frames")).unwrap();
    let mut collection = String::from("<VTKFile><Collection>");
    for frame in 0..3 {
        let way: Vec<f64> = POINTS.iter().flat_map(|_| [f64::from(frame), 0.0, 0.0]).collect();
        let stress: Vec<f64> = (0..14)
            .flat_map(|k| [if k < 8 { 1.0 + f64::from(k / 4) * 2.0 } else { f64::NAN }, 0.0, 0.0, 0.0, 0.0, 0.0])
            .collect();
        let point_data = vec![
            Field { name: "displacement", components: 3, values: &way },
            Field { name: "cauchy_stress", components: 6, values: &stress },
        ];
        let cube = stoss_mesh::Elements::from(vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
        let data = VtuFrame {
            points: &POINTS,
            elements: cube.blocks(),
            facets: &[[8, 9, 10, 11].into()],
            lines: &[vec![12, 13]],
            point_data,
            cell_data: vec![Field { name: "body", components: 1, values: &[0.0, 1.0, 2.0] }],
            ..VtuFrame::default()
        };
        write_vtu(folder.path().join(format!("frames/{frame}.vtu")), &data).unwrap();
        collection += &format!("<DataSet timestep=\"{}\" file=\"frames/{frame}.vtu\"/>", f64::from(frame) / 10.0);
    }
    std::fs::write(folder.path().join("frames.pvd"), collection + "</Collection></VTKFile>").unwrap();
    std::fs::write(folder.path().join("run.json"), r#"{"bodies":["cube","plate","rope"]}"#).unwrap();
    std::fs::write(folder.path().join("summary.json"), r#"{"title":"<cube> & plate"}"#).unwrap();
    folder
}

fn of(bodies: &[&str]) -> Options {
    Options { bodies: bodies.iter().map(|&body| body.to_owned()).collect(), ..Options::default() }
}

/// Message of an option that does not fit.
fn refusal(folder: &TempDir, options: &Options) -> String {
    let error = picture(folder.path(), options).unwrap_err();
    assert!(error.is::<Unfit>(), "{error}");
    let text = error.to_string();
    assert!(text.contains(&folder.path().display().to_string()), "{text}");
    text
}

#[test]
fn only_the_chosen_bodies_are_drawn() {
    let folder = folder();
    let counts = |bodies: &[&str]| {
        let svg = picture(folder.path(), &of(bodies)).unwrap();
        // Outlines that are closed in one go are faces; a facet of the plate is divided, its edges are drawn piece by piece.
        let edges = svg.matches("<path stroke=\"#222222\" d=").count();
        (edges, svg.contains("stroke-linecap=\"round\""))
    };
    // Three sides of a cube are seen from a corner.
    assert_eq!(counts(&["cube"]), (3, false));
    assert_eq!(counts(&["rope"]), (0, true));
    assert_eq!(counts(&["cube", "rope"]), (3, true));
    let (plate, has_line) = counts(&["plate"]);
    assert!(plate > 4 && !has_line);
    assert!(counts(&[]).0 > 3 && counts(&[]).1);
}

/// The system of units of the run is that of the colour bar and of the time; runs without one have plain numbers.
#[test]
fn the_units_of_the_run_are_written() {
    let folder = folder();
    let run = r#"{"bodies":["cube","plate","rope"],"units":{"labels":{"time":"ms","length":"mm","stress":"GPa"}}}"#;
    std::fs::write(folder.path().join("run.json"), run).unwrap();
    let svg =
        |field: &str| picture(folder.path(), &Options { field: Some(field.to_owned()), ..Options::default() }).unwrap();
    for (field, label) in [
        ("displacement", ">displacement [mm]<"),
        ("largest_principal_cauchy_stress", ">largest principal cauchy stress [GPa]<"),
        ("pressure_of_cauchy_stress", ">pressure of cauchy stress [GPa]<"),
    ] {
        let svg = svg(field);
        assert!(svg.contains(label) && svg.contains(">time 0.2 ms, frame 2<"), "{label}: {svg}");
    }
}

#[test]
fn the_range_is_kept() {
    let folder = folder();
    // The rope has the displacement 2; lines are not shaded, and the bar has neither end of the map as a colour.
    let svg = |range| picture(folder.path(), &Options { range: Some(range), ..of(&["rope"]) }).unwrap();
    let [above, below] = [svg([-10.0, 2.0]), svg([2.0, 10.0])];
    assert!(above.contains("#581254") && !above.contains("#e9edf2"));
    assert!(below.contains("#e9edf2") && !below.contains("#581254"));
    for number in [">-10.0<", ">-4.00<", ">2.00<"] {
        assert!(above.contains(number), "{number}");
    }
    for range in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
        assert!(refusal(&folder, &Options { range: Some(range), ..Options::default() }).contains("--range"));
    }
}

#[test]
fn title_time_and_field_are_written() {
    let folder = folder();
    let svg = |frame| picture(folder.path(), &Options { frame, ..of(&["cube"]) }).unwrap();
    let last = svg(Which::Last);
    for text in ["&lt;cube> &amp; plate: cube<", ">time 0.2, frame 2<", ">displacement<"] {
        assert!(last.contains(text), "{text}");
    }
    let doubled = Options { deformation: Some(2.0), ..of(&["cube"]) };
    assert!(picture(folder.path(), &doubled).unwrap().contains(">time 0.2, frame 2, displacements times 2<"));
    let wrong = Options { deformation: Some(f64::NAN), ..Options::default() };
    assert!(refusal(&folder, &wrong).contains("--deformation"));
    assert!(svg(Which::Nearest(0.14)).contains(">time 0.1, frame 1<"));
    assert!(svg(Which::Nearest(-7.0)).contains(">time 0, frame 0<"));
    assert_eq!(svg(Which::Number(1)), svg(Which::Nearest(0.1)));
    let field = Some("largest_principal_cauchy_stress".to_owned());
    let stress = picture(folder.path(), &Options { field, ..Options::default() }).unwrap();
    assert!([">largest principal cauchy stress<", ">1.00<", ">3.00<"].iter().all(|text| stress.contains(text)));
}

/// What is drawn without displacements says so.
#[test]
fn a_frame_without_displacement_says_that_it_is_undeformed() {
    let folder = folder();
    let undeformed = "undeformed: no displacement is stored";
    assert!(!picture(folder.path(), &of(&["cube"])).unwrap().contains(undeformed));
    for frame in 0..3 {
        let stress = [1.0; 14];
        let cube = stoss_mesh::Elements::from(vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
        let data = VtuFrame {
            points: &POINTS,
            elements: cube.blocks(),
            point_data: vec![Field { name: "von_mises", components: 1, values: &stress }],
            cell_data: vec![Field { name: "body", components: 1, values: &[0.0] }],
            ..VtuFrame::default()
        };
        write_vtu(folder.path().join(format!("frames/{frame}.vtu")), &data).unwrap();
    }
    let svg = picture(folder.path(), &of(&["cube"])).unwrap();
    assert!(svg.contains(&format!(">time 0.2, frame 2, {undeformed}<")), "{svg}");
    let page = stoss_report::page::page(&[folder.path()]).unwrap();
    assert!(page.notes.iter().any(|note| note.contains("no displacement")), "{:?}", page.notes);
}

#[test]
fn what_there_is_not_is_refused_with_what_there_is() {
    let folder = folder();
    let frame = refusal(&folder, &Options { frame: Which::Number(3), ..Options::default() });
    assert!(frame.contains("--frame 3") && frame.contains("0 to 2"), "{frame}");
    let body = refusal(&folder, &of(&["cube", "ball"]));
    assert!(body.contains("--body ball") && body.contains("cube, plate, rope"), "{body}");
    let field = refusal(&folder, &Options { field: Some("speed".into()), ..Options::default() });
    for text in ["--field speed", "pressure_of_cauchy_stress", "displacement"] {
        assert!(field.contains(text), "{field}");
    }
    let empty = Options { field: Some("pressure_of_cauchy_stress".into()), ..of(&["plate"]) };
    assert!(refusal(&folder, &empty).contains("no values"));
    assert!(refusal(&folder, &Options { frame: Which::Nearest(f64::NAN), ..Options::default() }).contains("--time"));
    assert!(refusal(&folder, &Options { view: Some([0.0; 3]), ..Options::default() }).contains("--view"));
    std::fs::remove_file(folder.path().join("frames.pvd")).unwrap();
    let error = picture(folder.path(), &Options::default()).unwrap_err();
    assert!(!error.is::<Unfit>() && error.to_string().contains("no frames"), "{error}");
}

#[test]
fn a_body_without_width_is_drawn_in_a_picture_of_some_width() {
    let folder = folder();
    // Along the rope, which is then a point; and the plate from its edge.
    let rope = Options { view: Some([1.0, 0.5, 0.0]), ..of(&["rope"]) };
    let plate = Options { view: Some([1.0, 0.0, 0.0]), ..of(&["plate"]) };
    for options in [rope, plate] {
        let svg = picture(folder.path(), &options).unwrap();
        assert!(svg.len() < 20_000 && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}

/// Without a view a section is seen along z, and anything else from the side.
#[test]
fn a_section_is_seen_along_z() {
    let folder = folder();
    let seen = |view| picture(folder.path(), &Options { view, ..Options::default() }).unwrap();
    assert_ne!(seen(None), seen(Some([0.0, 0.0, 1.0])));
    std::fs::write(folder.path().join("run.json"), r#"{"bodies":["cube","plate","rope"],"section":"plane-strain"}"#)
        .unwrap();
    assert_eq!(seen(None), seen(Some([0.0, 0.0, 1.0])));
}
