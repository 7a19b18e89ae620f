//! Values along lines and on planes: against the functions that the frames were made of.

use std::path::Path;
use stoss_mesh_io::{Field, VtuFrame, write_vtu};
use stoss_reference_element::CellKind;
use stoss_report::picture::{Unfit, Which};
use stoss_report::values::{Configuration, Options, SamplePoints, values};
use tempfile::TempDir;

/// Linear in the reference position.
fn temperature(x: [f64; 3]) -> f64 {
    3.0 + 0.5 * x[0] - 2.0 * x[1] + 0.25 * x[2]
}

/// Affine displacement.
fn displacement(x: [f64; 3]) -> [f64; 3] {
    [0.1 + 0.2 * x[0] + 0.1 * x[1], 0.05 * x[2], -0.3 * x[2]]
}

/// Two bodies of 3x3x3 distorted cells, [0,1]^3 and [0,1]^2 x [1,2], that touch at z = 1 with nodes of their own; a plate beside.
fn folder() -> TempDir {
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    for body in 0..2_u32 {
        let first = points.len() as u32;
        for k in 0..64_u32 {
            let grid = [k % 4, k / 4 % 4, k / 16];
            let inner = grid.iter().all(|&i| i == 1 || i == 2);
            // Nodes inside are moved: cells are no boxes.
            let shift = if inner { [0.05, -0.04, 0.03].map(|s| s * (f64::from(k % 5) - 2.0) / 2.0) } else { [0.0; 3] };
            let x: [f64; 3] = std::array::from_fn(|i| f64::from(grid[i]) / 3.0 + shift[i]);
            points.push([x[0], x[1], x[2] + f64::from(body)]);
        }
        for k in 0..27_u32 {
            let at = |a: u32, b: u32, c: u32| first + (k % 3 + a) + 4 * (k / 3 % 3 + b) + 16 * (k / 9 + c);
            cells.push([
                at(0, 0, 0),
                at(1, 0, 0),
                at(1, 1, 0),
                at(0, 1, 0),
                at(0, 0, 1),
                at(1, 0, 1),
                at(1, 1, 1),
                at(0, 1, 1),
            ]);
        }
    }
    let plate = points.len() as u32;
    points.extend([[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [6.0, 1.0, 0.0]]);
    let of_points = |value: &dyn Fn([f64; 3]) -> Vec<f64>| points.iter().flat_map(|&x| value(x)).collect::<Vec<_>>();
    let way = of_points(&|x| displacement(x).to_vec());
    let hot = of_points(&|x| vec![temperature(x)]);
    let tensor = of_points(&|x| (0..9).map(|k| f64::from(k) * temperature(x)).collect());
    // The second body is a number higher; gaps are known at the bottom only.
    let level: Vec<f64> = (0..points.len()).map(|n| if n < 64 { 1.0 } else { 2.0 }).collect();
    let gap: Vec<f64> = points.iter().map(|x| if x[2] == 0.0 { 0.5 } else { f64::NAN }).collect();
    let body: Vec<f64> = (0..55).map(|cell| f64::from(cell / 27)).collect();
    let folder = tempfile::tempdir().unwrap();
    let field = |name, components, values| Field { name, components, values };
    let elements = stoss_mesh::Elements::from(cells);
    let frame = VtuFrame {
        points: &points,
        elements: elements.blocks(),
        facets: &[[plate, plate + 1, plate + 2].into()],
        point_data: vec![
            field("displacement", 3, &way),
            field("temperature", 1, &hot),
            field("deformation_gradient", 9, &tensor),
            field("level", 1, &level),
            field("gap", 1, &gap),
        ],
        cell_data: vec![field("body", 1, &body)],
        ..VtuFrame::default()
    };
    write_vtu(folder.path().join("a.vtu"), &frame).unwrap();
    let collection = "<VTKFile><Collection><DataSet timestep=\"0.5\" file=\"a.vtu\"/></Collection></VTKFile>";
    std::fs::write(folder.path().join("frames.pvd"), collection).unwrap();
    std::fs::write(folder.path().join("run.json"), r#"{"bodies":["lower","upper","plate"]}"#).unwrap();
    folder
}

fn line(from: [f64; 3], to: [f64; 3], points: usize, configuration: Configuration, fields: &[&str]) -> Options {
    let place = SamplePoints::Line { ends: [from, to], points };
    let fields = fields.iter().map(|&field| field.to_owned()).collect();
    Options { frame: Which::Last, place, fields, configuration }
}

fn plane(point: [f64; 3], normal: [f64; 3], spacing: Option<f64>) -> Options {
    let place = SamplePoints::Plane { point, normal, spacing };
    Options { frame: Which::Last, place, fields: vec!["temperature".into()], configuration: Configuration::Reference }
}

/// Header and rows.
fn rows(folder: &Path, options: &Options) -> (Vec<String>, Vec<Vec<String>>) {
    let text = values(folder, options).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let rows: Vec<Vec<String>> = lines.collect();
    assert!(rows.iter().all(|row| row.len() == header.len()));
    (header, rows)
}

fn numbers(row: &[String]) -> Vec<f64> {
    row.iter().map(|entry| entry.parse().unwrap()).collect()
}

#[test]
fn a_linear_field_is_found_again_along_a_line() {
    let folder = folder();
    let (from, to) = ([0.05, 0.9, 0.1], [0.95, 0.2, 1.9]);
    let options = line(from, to, 38, Configuration::Reference, &["temperature", "deformation_gradient"]);
    let (header, found) = rows(folder.path(), &options);
    assert_eq!(header[..7], ["distance", "x", "y", "z", "inside", "body", "temperature"]);
    assert_eq!(header[7..10], ["deformation_gradient_xx", "deformation_gradient_xy", "deformation_gradient_xz"]);
    assert_eq!((header.len(), found.len()), (16, 38));
    for (k, row) in found.iter().enumerate() {
        let part = k as f64 / 37.0;
        let x: [f64; 3] = std::array::from_fn(|i| from[i] + part * (to[i] - from[i]));
        let [distance, place @ .., inside] = numbers(&row[..5]).try_into().unwrap_or([f64::NAN; 5]);
        assert!((distance - part * (0.81_f64 + 0.49 + 3.24).sqrt()).abs() < 1e-14 && inside == 1.0);
        assert!((0..3).all(|i| (place[i] - x[i]).abs() < 1e-15));
        assert_eq!(row[5], if x[2] < 1.0 { "lower" } else { "upper" });
        let values = numbers(&row[6..]);
        assert!((values[0] - temperature(x)).abs() < 1e-14);
        assert!((0..9).all(|i| (values[1 + i] - i as f64 * temperature(x)).abs() < 1e-13), "{values:?}");
    }
}

/// Contact fields are those of surfaces: inside of a body, and on a face between cells, they are empty, whatever the nodes there have.
#[test]
fn contact_fields_are_empty_inside() {
    let folder = tempfile::tempdir().unwrap();
    let points: Vec<[f64; 3]> = (0..12).map(|k| [f64::from(k % 2), f64::from(k / 2 % 2), f64::from(k / 4)]).collect();
    let cell = |first: u32| [0, 1, 3, 2, 4, 5, 7, 6].map(|k| first + k);
    let pressure: Vec<f64> = points.iter().map(|x| if x[2] == 0.0 { 8.0 } else { 0.0 }).collect();
    let status: Vec<f64> = points.iter().map(|x| if x[2] == 0.0 { 2.0 * x[0] } else { 0.0 }).collect();
    let point_data = vec![
        Field { name: "contact_pressure", components: 1, values: &pressure },
        Field { name: "contact_status", components: 1, values: &status },
    ];
    let cell_data = vec![Field { name: "body", components: 1, values: &[0.0, 0.0] }];
    let elements = stoss_mesh::Elements::from(vec![cell(0), cell(4)]);
    let frame = VtuFrame { points: &points, elements: elements.blocks(), point_data, cell_data, ..VtuFrame::default() };
    write_vtu(folder.path().join("a.vtu"), &frame).unwrap();
    let collection = "<VTKFile><Collection><DataSet timestep=\"0.5\" file=\"a.vtu\"/></Collection></VTKFile>";
    std::fs::write(folder.path().join("frames.pvd"), collection).unwrap();
    let up =
        line([0.7, 0.5, 0.0], [0.7, 0.5, 2.0], 5, Configuration::Reference, &["contact_pressure", "contact_status"]);
    let (_, found) = rows(folder.path(), &up);
    let values: Vec<&[String]> = found.iter().map(|row| &row[6..]).collect();
    assert_eq!(values, [&["8e0", "2e0"][..], &["", ""], &["", ""], &["", ""], &["0e0", "0e0"]]);
}

#[test]
fn current_positions_are_those_of_the_deformed_bodies() {
    let folder = folder();
    let reference = [0.4, 0.3, 0.6];
    let u = displacement(reference);
    let current: [f64; 3] = std::array::from_fn(|i| reference[i] + u[i]);
    let options = line(current, [9.0, 9.0, 9.0], 2, Configuration::Current, &["temperature", "displacement"]);
    let (_, found) = rows(folder.path(), &options);
    let values = numbers(&found[0][6..]);
    assert!((values[0] - temperature(reference)).abs() < 1e-14);
    assert!((0..3).all(|i| (values[1 + i] - u[i]).abs() < 1e-14));
    // The end is in no body: the row says so, and has no values.
    assert_eq!(found[1][4..], ["0", "", "", "", "", ""]);
}

#[test]
fn a_point_in_two_bodies_has_a_row_for_each_and_a_field_without_number_is_empty() {
    let folder = folder();
    // The middle of the line is on the common face; it passes the plane z = 0, where gaps are known, at its beginning.
    let options = line([0.5, 0.5, 0.0], [0.5, 0.5, 2.0], 3, Configuration::Reference, &["level", "gap"]);
    let (_, found) = rows(folder.path(), &options);
    let tail: Vec<&[String]> = found.iter().map(|row| &row[4..]).collect();
    assert_eq!(tail.len(), 4);
    assert_eq!(
        (tail[0], tail[1]),
        (&["1", "lower", "1e0", "5e-1"].map(String::from)[..], &["1", "lower", "1e0", ""].map(String::from)[..])
    );
    assert_eq!(tail[2], ["1", "upper", "2e0", ""]);
    assert_eq!(found[1][..4], found[2][..4]);
}

#[test]
fn a_plane_has_a_square_grid_of_points_inside() {
    let folder = folder();
    let (header, found) = rows(folder.path(), &plane([0.5, 0.5, 0.6], [0.0, 0.0, -2.0], Some(0.1)));
    assert_eq!(header[..7], ["u", "v", "x", "y", "z", "inside", "body"]);
    // -0.5 to 0.5 in both directions, ends included.
    assert_eq!(found.len(), 121);
    for row in &found {
        let [u, v, x, y, z, inside] = numbers(&row[..6]).try_into().unwrap_or([f64::NAN; 6]);
        assert!((x - 0.5 - u).abs() < 1e-14 && (y - 0.5 + v).abs() < 1e-14 && z == 0.6 && inside == 1.0);
        assert!((numbers(&row[7..])[0] - temperature([x, y, z])).abs() < 1e-14 && row[6] == "lower");
    }
    // An inclined one: as many points as fit, each on the plane; the section is sqrt(2) by 2 large, less what is cut off.
    let (_, found) = rows(folder.path(), &plane([0.5, 0.5, 1.0], [1.0, 1.0, 0.0], None));
    let area = found.len() as f64 * (2.0_f64 / 50.0).powi(2);
    assert!((area - 2.0 * 2.0_f64.sqrt()).abs() < 0.2, "{area}");
    for row in &found {
        let [_, _, x, y, z, _] = numbers(&row[..6]).try_into().unwrap_or([f64::NAN; 6]);
        assert!((x + y - 1.0).abs() < 1e-14);
        assert!((numbers(&row[7..])[0] - temperature([x, y, z])).abs() < 1e-13);
    }
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let folder = folder();
    let unknown = line([0.0; 3], [1.0; 3], 3, Configuration::Current, &["stress"]);
    for (options, part) in [
        (unknown, "temperature"),
        (line([0.0; 3], [0.0; 3], 3, Configuration::Current, &[]), "--line"),
        (line([0.0; 3], [1.0; 3], 1, Configuration::Current, &[]), "--points"),
        (plane([0.0, 0.0, 7.0], [0.0, 0.0, 1.0], None), "cuts no"),
        (plane([0.0; 3], [0.0; 3], None), "normal"),
        (plane([0.5; 3], [0.0, 0.0, 1.0], Some(-1.0)), "--spacing -1"),
        (plane([0.5; 3], [0.0, 0.0, 1.0], Some(1e-9)), "larger"),
        (plane([0.5; 3], [0.0, 0.0, 1.0], Some(50.0)), "smaller"),
        (Options { frame: Which::Number(4), ..plane([0.5; 3], [0.0, 0.0, 1.0], None) }, "--frame 4"),
    ] {
        match values(folder.path(), &options) {
            // A grid always has its own point, which is inside here.
            Ok(text) => assert!(part == "smaller" && text.lines().count() == 2, "{text}"),
            Err(error) => assert!(error.is::<Unfit>() && error.to_string().contains(part), "{error}"),
        }
    }
}

/// On faces of quadratic cells contact fields are piecewise linear between the nodes: no value is beyond those of the nodes around, as functions of the cell would make them.
#[test]
fn contact_fields_do_not_overshoot_on_quadratic_faces() {
    for kind in CellKind::ALL {
        let table = kind.table();
        let face = &kind.faces()[0];
        let corners = face.kind.corner_count();
        let at = |k: usize| table.nodes[usize::from(face.nodes[k])];
        // Something at the first corner alone, something in the middle of the first edge alone, and a linear field.
        let peak = |k: usize| -> Vec<f64> {
            let place = face.nodes.get(k).map(|&n| usize::from(n));
            (0..table.nodes.len()).map(|n| if Some(n) == place { 6.0 } else { 0.0 }).collect()
        };
        let (corner, middle) = (peak(0), peak(corners));
        let linear: Vec<f64> = table.nodes.iter().map(|&x| temperature(x)).collect();
        let field = |name, values| Field { name, components: 1, values };
        let point_data =
            vec![field("contact_pressure", &corner[..]), field("slip", &middle[..]), field("gap", &linear[..])];
        let cell_data = vec![Field { name: "body", components: 1, values: &[0.0] }];
        let elements = stoss_mesh::Elements::of_kind(kind, (0..table.nodes.len() as u32).collect());
        let frame =
            VtuFrame { points: table.nodes, elements: elements.blocks(), point_data, cell_data, ..VtuFrame::default() };
        let folder = tempfile::tempdir().unwrap();
        write_vtu(folder.path().join("a.vtu"), &frame).unwrap();
        let collection = "<VTKFile><Collection><DataSet timestep=\"0.5\" file=\"a.vtu\"/></Collection></VTKFile>";
        std::fs::write(folder.path().join("frames.pvd"), collection).unwrap();
        let table_of = |from: [f64; 3], to: [f64; 3]| -> Vec<([f64; 3], [f64; 3])> {
            let options = line(from, to, 9, Configuration::Reference, &["contact_pressure", "slip", "gap"]);
            let row = |row: &Vec<String>| {
                let (place, values) = (numbers(&row[1..4]), numbers(&row[6..]));
                (std::array::from_fn(|i| place[i]), std::array::from_fn(|i| values[i]))
            };
            rows(folder.path(), &options).1.iter().map(row).collect()
        };
        // From each corner to a point between two others.
        for a in 0..corners {
            let [p, q] = [1, 2].map(|k| at((a + k) % corners));
            for (x, [corner, middle, linear]) in table_of(at(a), std::array::from_fn(|i| 0.4 * p[i] + 0.6 * q[i])) {
                assert!((linear - temperature(x)).abs() < 1e-13, "{kind}");
                assert!(
                    [corner, middle].iter().all(|v| (-1e-13..=6.0 + 1e-13).contains(v)),
                    "{kind}: {corner} {middle}"
                );
            }
        }
        // Linear along each half of the first edge.
        if face.kind.is_quadratic() {
            for (k, (_, [corner, middle, _])) in table_of(at(0), at(1)).into_iter().enumerate() {
                let k = k as f64;
                assert!((corner - (6.0 - 1.5 * k).max(0.0)).abs() < 1e-13, "{kind}: {k} {corner}");
                assert!((middle - (6.0 - 1.5 * (k - 4.0).abs())).abs() < 1e-13, "{kind}: {k} {middle}");
            }
        }
    }
}
