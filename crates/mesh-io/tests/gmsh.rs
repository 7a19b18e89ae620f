//! Gmsh files. `tests/data/ring-*.msh` were saved by Gmsh 4: a quarter ring (radii 1 and 2, height 0.5) of two
//! volumes of 45 degrees with 2 x 3 x 2 hexahedra each, groups of all dimensions, one surface between the volumes.
//! `tests/data/two-*.msh`: two cubes of 2 x 2 x 2 hexahedra on one another with common nodes, saved by Gmsh 4.15 as text and binary;
//! those with other byte orders and sizes, which Gmsh does not write on this machine, were made from the text by a script of 40 lines.

use std::path::Path;

use stoss_mesh::{Mesh, MeshError};
use stoss_mesh_io::{
    FilePosition, MeshIoError, read_contents, read_contents_from_bytes, read_mesh, read_mesh_from_str,
};

fn data(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(data(name)).unwrap()
}

fn read(text: &str) -> Result<Mesh, MeshIoError> {
    read_mesh_from_str("part.msh", text)
}

/// One unit cube in MSH 2.2 with a line of extra elements.
fn cube(extra: &[&str]) -> String {
    let mut text = String::from(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"lid\"\n$EndPhysicalNames\n$Nodes\n8\n",
    );
    for (i, x) in stoss_reference_element::hex8::VERTICES.iter().enumerate() {
        text += &format!("{} {} {} {}\n", 10 * i + 5, x[0], x[1], x[2]);
    }
    text += &format!("$EndNodes\n$Elements\n{}\n3 5 2 0 1 5 15 25 35 45 55 65 75\n", 1 + extra.len());
    for line in extra {
        text += &format!("{line}\n");
    }
    text + "$EndElements\n"
}

fn radius(x: [f64; 3]) -> f64 {
    x[0].hypot(x[1])
}

#[test]
fn both_versions_give_the_ring_with_its_groups() {
    for name in ["ring-22.msh", "ring-41.msh"] {
        let mesh = read_mesh(data(name)).unwrap();
        assert_eq!((mesh.elements.len(), mesh.nodes.len()), (24, 3 * 7 * 3), "{name}");
        assert_eq!(mesh.elements_of("first half").unwrap().len(), 12);
        assert_eq!(mesh.elements_of("whole").unwrap().len(), 24);
        for e in mesh.elements_of("first half").unwrap() {
            assert!(mesh.element_coordinates(e).iter().all(|x| x[1] < x[0] + 1e-9));
        }
        for (group, count) in [("top", 12), ("outer", 12), ("surface-24", 12)] {
            let facets = mesh.facets_of(group).unwrap();
            assert_eq!(facets.len(), count, "{name} {group}");
            for f in facets {
                let x: Vec<[f64; 3]> = f.nodes.iter().map(|&n| mesh.nodes[n as usize]).collect();
                let d = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| x[a][i] - x[b][i]) };
                let (a, b) = (d(2, 0), d(3, 1));
                let n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
                let good = match group {
                    "top" => n[2] > 0.0 && x.iter().all(|x| (x[2] - 0.5).abs() < 1e-12),
                    "outer" => {
                        n[0] * x[0][0] + n[1] * x[0][1] > 0.0 && x.iter().all(|&x| (radius(x) - 2.0).abs() < 1e-12)
                    }
                    _ => n[2] < 0.0 && x.iter().all(|x| x[2].abs() < 1e-12),
                };
                assert!(good, "{name} {group}");
            }
        }
        // between two volumes: nodes, no facets
        let interface = mesh.nodes_of("interface").unwrap();
        assert_eq!(interface.len(), 9);
        assert!(interface.iter().all(|&n| (mesh.nodes[n as usize][0] - mesh.nodes[n as usize][1]).abs() < 1e-12));
        assert!(matches!(mesh.facets_of("interface"), Err(MeshError::WrongSetKind { .. })));
        let arc = mesh.nodes_of("arc").unwrap();
        assert_eq!(arc.len(), 4);
        assert!(arc.iter().all(|&n| (radius(mesh.nodes[n as usize]) - 1.0).abs() < 1e-12));
    }
    let volumes = ["ring-22.msh", "ring-41.msh"].map(|n| read_mesh(data(n)).unwrap().quality().volume);
    assert!((volumes[0] - volumes[1]).abs() < 1e-13);
    let chords = 6.0 * 0.5 * (std::f64::consts::PI / 12.0).sin() * 3.0 * 0.5;
    assert!((volumes[0] - chords).abs() < 1e-9, "{} {chords}", volumes[0]);
}

/// The format is found by content where the extension says nothing.
#[test]
fn content_decides_without_an_extension() {
    let mesh = read_mesh_from_str("part.mesh", &cube(&[])).unwrap();
    assert_eq!(mesh.elements, vec![[0, 1, 2, 3, 4, 5, 6, 7]].into());
    let error = read_mesh_from_str("part.stl", "solid x").unwrap_err().to_string();
    assert_eq!(
        error,
        "part.stl: unknown mesh format; known are Gmsh MSH 2.2 and 4.1 (.msh), Abaqus input (.inp), VTK unstructured grid (.vtu)"
    );
    assert!(matches!(read_mesh("no/such/file.msh"), Err(MeshIoError::Io { .. })));
}

#[test]
fn quads_become_outward_facets_whatever_their_own_sense() {
    for quad in ["1 3 2 7 1 45 55 65 75", "1 3 2 7 1 75 65 55 45", "1 3 2 7 1 65 75 45 55"] {
        let mesh = read(&cube(&[quad])).unwrap();
        let lid = mesh.facets_of("lid").unwrap();
        assert_eq!((lid.len(), &*lid[0].nodes), (1, &[4, 5, 6, 7][..]));
    }
}

#[test]
fn unused_nodes_are_dropped() {
    let with_unused = cube(&["9 15 2 3 1 99"]).replace("$Nodes\n8\n", "$Nodes\n9\n99 7 7 7\n");
    let mesh = read(&with_unused).unwrap();
    assert_eq!(mesh.nodes.len(), 8);
    assert!(!mesh.has_set("point-3"));
    let kept = read(&cube(&["9 15 2 3 1 25"])).unwrap();
    assert_eq!(kept.nodes_of("point-3").unwrap(), [2]);
}

#[test]
fn other_cells_are_counted_and_refused() {
    // Gmsh's second order without Mesh.SecondOrderIncomplete
    let error = read_mesh(data("cell-wedge18.msh")).unwrap_err();
    let MeshIoError::Unsupported { at: FilePosition::Line(line), value, remedy, .. } = &error else {
        panic!("{error}")
    };
    assert_eq!(value, &format!("2 18-node prisms (type 13) (line {line})"));
    assert!(remedy.contains("Mesh.SecondOrderIncomplete = 1"), "{error}");
    let source = text("cell-wedge18.msh");
    assert_eq!(source.lines().nth(line - 1).unwrap().split_whitespace().count(), 19);
    for (line, name, remedy) in [
        ("4 7 2 0 1 5 15 25 35 45", "1 pyramids (type 7)", "tie them"),
        ("4 19 2 0 1 5 15 25 35 45 5 5 5 5 5 5 5 5", "1 13-node pyramids (type 19)", "tie them"),
        (
            "4 29 2 0 1 5 5 5 5 5 5 5 5 5 5 5 5 5 5 5 5 5 5 5 5",
            "1 tetrahedra of higher order (type 29)",
            "ElementOrder",
        ),
        ("4 21 2 0 1 5 5 5 5 5 5 5 5 5 5", "1 triangles of higher order (type 21)", "ElementOrder"),
    ] {
        let error = read(&cube(&[line])).unwrap_err().to_string();
        assert!(error.starts_with("part.msh:22: ") && error.contains(name) && error.contains(remedy), "{error}");
    }
}

/// Each bad file, the line that its error must name, and a piece of the message.
#[test]
fn errors_name_the_line() {
    let good = cube(&["1 3 2 7 1 45 55 65 75"]);
    read(&good).unwrap();
    let replaced = |from: &str, to: &str| good.replacen(from, to, 1);
    let rows = [
        (replaced("2.2 0 8", "1.0 0 8"), 2, "MSH version 1.0"),
        (replaced("2.2 0 8", "4.0 0 8"), 2, "MSH version 4.0"),
        (replaced("2.2 0 8", "2.2 2 8"), 2, "1 for binary"),
        (replaced("$MeshFormat", "$NOD"), 1, "begins with $MeshFormat"),
        (replaced("2 7 \"lid\"", "2 7 lid"), 6, "in quotes"),
        (replaced("5 -1 -1 -1", "5 -1 x -1"), 10, "\"x\": expected a coordinate"),
        (replaced("5 -1 -1 -1", "5 -1 -1"), 10, "end of line"),
        (replaced("5 -1 -1 -1", "5 -1 nan -1"), 10, "finite"),
        (replaced("5 -1 -1 -1", "15 -1 -1 -1"), 11, "already at another place in line 10"),
        (replaced("$Nodes\n8", "$Nodes\n9"), 18, "\"$EndNodes\": expected a node number"),
        (replaced("$Nodes\n8", "$Nodes\n7"), 17, "expected $EndNodes"),
        (replaced("$Nodes\n8", "$Nodes\nmany"), 9, "number of nodes"),
        (replaced("5 15 25 35 45", "5 15 25 36 45"), 21, "no node 36"),
        (replaced("5 15 25 35 45", "5 15 25 25 45"), 21, "uses this node twice"),
        (replaced("5 15 25 35 45 55 65 75", "5 15 25 35 45 55 65"), 21, "8 nodes, not 7"),
        (replaced("5 15 25 35 45 55 65 75", "45 55 65 75 5 15 25 35"), 21, "element 3 (hex8) with nodes [45, 55"),
        (
            replaced("1 3 2 7 1 45 55 65 75", "1 3 2 7 1 45 55 65 35"),
            22,
            "this quadrilateral of group \"lid\" is no facet of an element",
        ),
        (replaced("1 3 2 7 1 45 55 65 75", "1 3 2 7 1 45 55 65 99"), 22, "no node 99"),
        (replaced("$Elements\n2", "$Elements\n3"), 23, "\"$EndElements\""),
        (replaced("$EndElements\n", ""), 22, "cut off"),
        (replaced("$Elements", "$Elephants").replace("$EndElements", "$EndElephants"), 23, "no $Elements section"),
        (replaced("$Nodes", "$NodeData").replace("$EndNodes", "$EndNodeData"), 19, "$Nodes must come before"),
        (replaced("$EndNodes\n", "$EndNodes\nhello\n"), 19, "beginning of a section"),
        (replaced("3 5 2 0 1", "3 13 2 0 1 5 5 5 5 5 5 5 5 5 5"), 21, "1 18-node prisms (type 13)"),
        (String::new(), 1, "expected $MeshFormat"),
        (
            cube(&["1 1 2 7 1 45 55"])
                .replace("2 7 \"lid\"", "1 7 \"lid\"")
                .replace("\n1\n1 7", "\n2\n2 8 \"lid\"\n1 7"),
            23,
            "rename",
        ),
    ];
    for (source, line, message) in rows {
        let error = read(&source).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("part.msh:{line}: ")) && error.contains(message),
            "{error}\nfor line {line}, {message}"
        );
    }
}

#[test]
fn problems_of_the_mesh_are_told_in_the_numbers_of_the_file() {
    // two cubes on one another with their own nodes each: two bodies that touch
    let mut two = cube(&["4 5 2 0 1 105 115 125 135 145 155 165 175"]).replace("$Nodes\n8", "$Nodes\n16");
    let mut extra = String::new();
    for (i, x) in stoss_reference_element::hex8::VERTICES.iter().enumerate() {
        extra += &format!("{} {} {} {}\n", 105 + 10 * i, x[0], x[1], x[2] + 2.0);
    }
    two = two.replace("$EndNodes", &format!("{extra}$EndNodes"));
    let mesh = read(&two).unwrap();
    let coincident = mesh.coincident_nodes().unwrap();
    assert_eq!((coincident.count, coincident.first, coincident.second, mesh.pieces()), (4, 4, 8, 2));
    let overlap = cube(&["8 5 2 0 1 15 25 35 5 55 65 75 45"]);
    let error = read(&overlap).unwrap_err();
    assert!(
        matches!(error, MeshIoError::OverlappingElements { elements: [3, 8], at: FilePosition::Line(22), .. }),
        "{error}"
    );
    let none = cube(&[]).replace("$Elements\n1\n3 5 2 0 1 5 15 25 35 45 55 65 75", "$Elements\n0");
    assert!(matches!(read(&none), Err(MeshIoError::NoElements { .. })));
}

/// An element that belongs to two groups stands in a 2.2 file twice.
#[test]
fn an_element_of_two_groups_is_one_element() {
    let mesh = read(&cube(&["4 5 2 8 1 5 15 25 35 45 55 65 75", "4 5 2 9 1 5 15 25 35 45 55 65 75"])).unwrap();
    assert_eq!(mesh.elements.len(), 1);
    assert_eq!((mesh.elements_of("volume-8").unwrap(), mesh.elements_of("volume-9").unwrap()), (vec![0], vec![0]));
}

const BINARY: [(&str, &str, &str); 6] = [
    ("two-22-binary.msh", "two-22-text.msh", "Gmsh MSH 2.2, binary, little-endian"),
    ("two-22-big-endian.msh", "two-22-text.msh", "Gmsh MSH 2.2, binary, big-endian"),
    ("two-41-binary.msh", "two-41-text.msh", "Gmsh MSH 4.1, binary, little-endian"),
    ("two-41-parametric.msh", "two-41-text.msh", "Gmsh MSH 4.1, binary, little-endian"),
    ("two-41-big-endian.msh", "two-41-text.msh", "Gmsh MSH 4.1, binary, big-endian"),
    ("two-41-size-4.msh", "two-41-text.msh", "Gmsh MSH 4.1, binary, little-endian"),
];

#[test]
fn binary_files_say_what_text_says() {
    for (binary, text, format) in BINARY {
        let contents = read_contents(data(binary)).unwrap();
        assert_eq!(contents.format(), format, "{binary}");
        let of_text = read_contents(data(text)).unwrap();
        for group in [None, Some("Lower"), Some("Upper"), Some("Both")] {
            let (a, b) = (contents.mesh(group).unwrap(), of_text.mesh(group).unwrap());
            // Gmsh writes 16 digits: coordinates of this mesh are halves
            assert_eq!(a, b, "{binary}, {group:?}");
        }
    }
}

/// A body from a physical volume has the sets of the file where it has part of them; a surface between two volumes is a surface of each.
#[test]
fn a_body_from_a_group() {
    for name in ["two-22-text.msh", "two-41-binary.msh"] {
        let contents = read_contents(data(name)).unwrap();
        let whole = contents.mesh(None).unwrap();
        assert!(matches!(whole.facets_of("lower contact"), Err(MeshError::WrongSetKind { .. })));
        for (group, z, other) in [("Lower", [0.0, 1.0], "top"), ("Upper", [1.0, 2.0], "bottom")] {
            let mesh = contents.mesh(Some(group)).unwrap();
            assert_eq!((mesh.elements.len(), mesh.nodes.len()), (8, 27));
            assert!((mesh.quality().volume - 1.0).abs() < 1e-12);
            assert_eq!((mesh.bounding_box().0[2], mesh.bounding_box().1[2]), (z[0], z[1]));
            let contact = mesh.facets_of("lower contact").unwrap();
            assert!(
                contact.len() == 4
                    && contact.iter().flat_map(|f| f.nodes.to_vec()).all(|n| mesh.nodes[n as usize][2] == 1.0)
            );
            assert!(!mesh.has_set(other));
        }
        let error = contents.mesh(Some("lower")).unwrap_err().to_string();
        assert!(
            error.contains("there is no group \"lower\"; the groups of elements are \"Both\", \"Lower\", \"Upper\""),
            "{error}"
        );
        let error = contents.mesh(Some("top")).unwrap_err().to_string();
        assert!(error.contains("is a group of facets"), "{error}");
    }
}

#[test]
fn errors_of_binary_files_name_the_byte() {
    let read = |bytes: &[u8]| {
        read_contents_from_bytes("part.msh", bytes, &mut |_| unreachable!()).and_then(|contents| contents.mesh(None))
    };
    let good = std::fs::read(data("two-22-binary.msh")).unwrap();
    let place = |text: &str| good.windows(text.len()).position(|w| w == text.as_bytes()).unwrap();
    let first_node = place("$Nodes\n45\n") + 10;
    let changed = |offset: usize, bytes: &[u8]| {
        let mut file = good.clone();
        file[offset..offset + bytes.len()].copy_from_slice(bytes);
        read(&file).unwrap_err().to_string()
    };
    assert_eq!(changed(20, b"\x07").split(':').nth(1), Some(" byte 20"));
    assert!(changed(20, b"\x07").contains("byte order"));
    let error = changed(first_node + 4, &f64::NAN.to_le_bytes());
    assert!(error.starts_with(&format!("part.msh: byte {}: NaN", first_node + 4)), "{error}");
    let error = changed(first_node, &(-1_i32).to_le_bytes());
    assert!(error.starts_with(&format!("part.msh: byte {first_node}: -1")), "{error}");
    let error = changed(first_node + 28, &1_i32.to_le_bytes());
    assert!(error.starts_with(&format!("part.msh: byte {}: 1: node 1 is already", first_node + 28)), "{error}");
    let many = [&good[..first_node - 3], b"9999999999", &good[first_node - 1..]].concat();
    let error = read(&many).unwrap_err().to_string();
    assert!(error.contains(&format!("byte {}: 9999999999: more nodes than", first_node - 3)), "{error}");
    let error = changed(first_node - 3, b"44");
    assert!(error.contains("expected $EndNodes"), "{error}");
    let error = changed(place("2.2 1 8"), b"3.2");
    assert!(error.contains("MSH version 3.2"), "{error}");
    // every prefix but for the last line feed
    for name in BINARY.map(|b| b.0) {
        let good = std::fs::read(data(name)).unwrap();
        for end in 0..good.len() - 1 {
            let error = read(&good[..end]).unwrap_err().to_string();
            assert!(error.starts_with("part.msh"), "{error}");
        }
    }
}
