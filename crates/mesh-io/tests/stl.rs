//! STL: both kinds there and back, how they are distinguished, what errors say.

use stoss_mesh::surface::{Cone, Cuboid, Cylinder, RoundDivisions, Sphere};
use stoss_mesh::{MassProperties, MeshError, SurfaceMesh};
use stoss_mesh_io::{MeshIoError, read_surface, read_surface_counted, read_surface_from_bytes};

/// The triangles of a surface, quadrilaterals cut along a diagonal.
fn triangles(surface: &SurfaceMesh) -> Vec<[[f64; 3]; 3]> {
    let all = 0..surface.facets.len() as u32;
    all.flat_map(|f| {
        let x = surface.facet_coordinates(f);
        (1..x.len() - 1).map(|k| [x[0], x[k], x[k + 1]]).collect::<Vec<_>>()
    })
    .collect()
}

fn text(name: &str, triangles: &[[[f64; 3]; 3]]) -> String {
    let mut out = format!("solid {name}\n");
    for t in triangles {
        out += "  facet normal 0 0 0\n    outer loop\n";
        for [x, y, z] in t {
            out += &format!("      vertex {x:e} {y:e} {z:e}\n");
        }
        out += "    endloop\n  endfacet\n";
    }
    out + &format!("endsolid {name}\n")
}

fn binary(header: &[u8], triangles: &[[[f64; 3]; 3]]) -> Vec<u8> {
    let mut out = [0; 80];
    out[..header.len()].copy_from_slice(header);
    let mut out = out.to_vec();
    out.extend((triangles.len() as u32).to_le_bytes());
    for t in triangles {
        out.extend([0; 12]);
        t.as_flattened().iter().for_each(|&c| out.extend((c as f32).to_le_bytes()));
        out.extend([0; 2]);
    }
    out
}

/// Coordinates of the facets, in order: what a file must keep.
fn corners(surface: &SurfaceMesh) -> Vec<[[f64; 3]; 3]> {
    (0..surface.facets.len() as u32).map(|f| std::array::from_fn(|k| surface.facet_coordinates(f)[k])).collect()
}

fn shapes() -> Vec<SurfaceMesh> {
    let divisions = RoundDivisions { around: 9, along: 2, radial: 2 };
    vec![
        Sphere { radius: 0.7, divisions: 3 }.generate().unwrap(),
        Cuboid { size: [1.0, 2.0, 0.3], divisions: [2, 1, 3] }.generate().unwrap(),
        Cylinder { radius: 0.5, length: 1.1, divisions }.generate().unwrap(),
        Cone { radius: 0.5, height: 1.1, tip_radius: 0.0, divisions }.generate().unwrap(),
    ]
}

#[test]
fn there_and_back() {
    for shape in shapes() {
        let triangles = triangles(&shape);
        let count = triangles.len();

        let read = read_surface_counted("a.stl", text("thing", &triangles).as_bytes()).unwrap();
        assert_eq!(read.dropped, 0);
        assert_eq!(corners(&read.surface), triangles);
        assert_eq!(read.surface.nodes.len(), shape.nodes.len());
        assert!(read.surface.is_closed());
        assert_eq!(read.surface.facets_of("thing").unwrap(), (0..count as u32).collect::<Vec<_>>());

        let rounded: Vec<_> = triangles.iter().map(|t| t.map(|x| x.map(|c| f64::from(c as f32)))).collect();
        for header in [
            &b""[..],
            b"solid thing",
            b"solid thing                                                                     ",
        ] {
            let read = read_surface_counted("a.stl", &binary(header, &triangles)).unwrap();
            assert_eq!(read.dropped, 0);
            assert_eq!(corners(&read.surface), rounded);
            assert_eq!(read.surface.nodes.len(), shape.nodes.len());
            assert!(read.surface.is_closed());
            assert!(read.surface.facet_sets.is_empty());
            let (before, after) = (shape.volume().unwrap(), read.surface.volume().unwrap());
            // cutting quadrilaterals of the sphere that are not plane changes its volume, rounding to f32 hardly
            assert!((after / before - 1.0).abs() < 2e-2, "{before} {after}");
        }
    }
}

#[test]
fn mass_of_a_cube_by_hand() {
    // twelve triangles of the unit cube, outward, written as CAD programs do: capitals, tabs, CRLF, a comment after the name
    let quads = [
        [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
        [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
        [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
        [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
        [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
        [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],
    ];
    let mut file = String::from("\u{feff}  SOLID Würfel\tmade by hand \r\n");
    for q in quads {
        for t in [[q[0], q[1], q[2]], [q[0], q[2], q[3]]] {
            file += "FACET NORMAL nan nan nan\r\n\tOUTER  LOOP\r\n";
            for (k, [x, y, z]) in t.into_iter().enumerate() {
                // both zeros are the same place
                file +=
                    &format!("\t\tVERTEX {} {y}.0E+00 {z}\r\n", if x == 1 { "1D0" } else { ["0", "-0.0", "-0e5"][k] });
            }
            file += "\tENDLOOP\r\nENDFACET\r\n\r\n";
        }
    }
    file += "ENDSOLID";
    let surface = read_surface_from_bytes("cube.stl", file.as_bytes()).unwrap();
    assert_eq!((surface.nodes.len(), surface.facets.len()), (8, 12));
    assert_eq!(surface.set_names(), ["Würfel\tmade by hand", "all", "boundary"]);
    let mass = MassProperties::of_surface(&surface, 2.0).unwrap();
    assert!((mass.mass - 2.0).abs() < 1e-15);
    for i in 0..3 {
        assert!((mass.centre[i] - 0.5).abs() < 1e-15);
        for j in 0..3 {
            assert!((mass.euler[i][j] - if i == j { 2.0 / 12.0 } else { 0.0 }).abs() < 1e-15);
        }
    }
    // the same from disk
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cube.stl");
    std::fs::write(&path, &file).unwrap();
    assert_eq!(read_surface(&path).unwrap(), surface);
    assert!(matches!(read_surface(folder.path().join("no.stl")), Err(MeshIoError::Io { .. })));
}

#[test]
fn several_solids_and_degenerate_facets() {
    let [a, b, c, d] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let file = text("floor", &[[a, c, b], [a, a, b], [a, b, [2.0, 0.0, 0.0]]])
        + &text("", &[[a, b, d]])
        + &text("walls", &[[b, c, d]])
        + &text("flat", &[[a, b, b]])
        + &text("empty", &[])
        + &text("walls", &[[c, a, d]]);
    let read = read_surface_counted("a.stl", file.as_bytes()).unwrap();
    assert_eq!(read.dropped, 3);
    assert_eq!(corners(&read.surface), [[a, c, b], [a, b, d], [b, c, d], [c, a, d]]);
    assert_eq!(read.surface.facet_sets, [("floor".to_owned(), vec![0]), ("walls".to_owned(), vec![2, 3])].into());
    // the place (2, 0, 0) belonged to a dropped facet alone
    assert_eq!(read.surface.nodes.len(), 4);
    assert!(read.surface.is_closed());
    assert!((read.surface.volume().unwrap() - 1.0 / 6.0).abs() < 1e-16);

    let file = text("empty", &[]) + &text("one", &[[a, c, b]]);
    assert_eq!(read_surface_from_bytes("a.stl", file.as_bytes()).unwrap().set_names(), ["all", "boundary", "one"]);
    let read = read_surface_counted("a.stl", &binary(b"", &[[a, c, b], [a, a, b], [a, b, d]])).unwrap();
    assert_eq!((read.dropped, read.surface.facets.len()), (1, 2));
    for nothing in
        [text("x", &[]).into_bytes(), text("x", &[[a, a, b]]).into_bytes(), binary(b"", &[]), binary(b"", &[[a, a, b]])]
    {
        let error = read_surface_from_bytes("a.stl", &nothing).unwrap_err();
        assert!(matches!(error, MeshIoError::Mesh { source: MeshError::NoFacets, .. }), "{error}");
    }
}

#[test]
fn errors_of_texts_name_the_line() {
    let good = text("x", &[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
    read_surface_from_bytes("a.stl", good.as_bytes()).unwrap();
    let line_of = |file: &str| match read_surface_from_bytes("a.stl", file.as_bytes()) {
        Err(MeshIoError::Syntax { line, value, remedy, .. }) => (line, value, remedy),
        other => panic!("{other:?}\n{file}"),
    };
    let lines: Vec<&str> = good.lines().collect();
    assert_eq!(lines.len(), 9);
    // a line that is missing is noticed where it should stand
    for (missing, noticed) in [(1, 2), (2, 3), (3, 6), (4, 6), (5, 6), (6, 7), (7, 8), (8, 8)] {
        let mut rest = lines.clone();
        rest.remove(missing);
        assert_eq!(line_of(&rest.join("\n")).0, noticed, "without {:?}", lines[missing]);
    }
    for (old, new, line, value) in [
        ("1e0 0e0 0e0", "1e0 0e0", 5, "end of line"),
        ("1e0 0e0 0e0", "1e0 0e0 nan", 5, "nan"),
        ("1e0 0e0 0e0", "1e0 inf 0", 5, "inf"),
        ("1e0 0e0 0e0", "1e999 0 0", 5, "1e999"),
        ("1e0 0e0 0e0", "1,0 0 0", 5, "1,0"),
        ("1e0 0e0 0e0", "1 0 0 0", 5, "0"),
        ("    outer loop", "    outer loop loop", 3, "outer loop loop"),
        ("  facet", "  face", 2, "face normal 0 0 0"),
        ("endsolid x", "endsolid x\nend", 10, "end"),
    ] {
        let (at, what, _) = line_of(&good.replacen(old, new, 1));
        assert_eq!((at, what.as_str()), (line, value));
    }
    // four vertices
    let vertex = "      vertex 0e0 1e0 0e0\n";
    let (line, _, remedy) = line_of(&good.replace(vertex, &vertex.repeat(2)));
    assert_eq!(line, 7);
    assert!(remedy.contains("triangles"), "{remedy}");
}

#[test]
fn errors_of_binaries_name_the_place() {
    let shape = triangles(&shapes()[0]);
    for header in [&b""[..], b"solid of a kind"] {
        let good = binary(header, &shape);
        let place = |bytes: &[u8]| match read_surface_from_bytes("a.stl", bytes) {
            Err(MeshIoError::Binary { offset, value, .. }) => (offset, value),
            other => panic!("{other:?}"),
        };
        // too short, too long, and a count that would need 200 GB
        for bytes in [&good[..good.len() - 1], &good[..84], &[&good[..], b"\n"].concat()] {
            assert_eq!(place(bytes), (80, "108 facets".into()));
        }
        let mut bytes = good.clone();
        bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        if header.is_empty() {
            assert_eq!(place(&bytes), (80, "4294967295 facets".into()));
        }
        let mut bytes = good.clone();
        // second facet, third vertex, y
        let offset = 84 + 50 + 12 + 24 + 4;
        for (value, name) in [(f32::NAN, "NaN"), (f32::NEG_INFINITY, "-inf")] {
            bytes[offset..offset + 4].copy_from_slice(&value.to_le_bytes());
            assert_eq!(place(&bytes), (offset as u64, name.into()));
        }
        // normals are not used
        let mut bytes = good.clone();
        bytes[84..88].copy_from_slice(&f32::NAN.to_le_bytes());
        assert_eq!(read_surface_from_bytes("a.stl", &bytes).unwrap(), read_surface_from_bytes("a.stl", &good).unwrap());
    }
    for other in [&b""[..], b"sol", b"v 0 0 0\nf 1 2 3\n"] {
        assert!(matches!(read_surface_from_bytes("a.stl", other), Err(MeshIoError::UnknownFormat { .. })));
    }
}

/// Nothing shorter than the whole is taken for the whole.
#[test]
fn every_truncation() {
    let triangles = triangles(&shapes()[1]);
    let (text, plain, solid) = (text("x", &triangles), binary(b"", &triangles), binary(b"solid x", &triangles));
    let end = text.trim_end().len() - "x".len() - 1;
    for cut in 0..end {
        assert!(read_surface_from_bytes("a.stl", &text.as_bytes()[..cut]).is_err(), "{cut}");
    }
    for bytes in [plain, solid] {
        for cut in 0..bytes.len() {
            assert!(read_surface_from_bytes("a.stl", &bytes[..cut]).is_err(), "{cut}");
        }
    }
}
