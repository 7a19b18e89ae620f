//! Abaqus input files.

use std::path::Path;

use stoss_mesh::Mesh;
use stoss_mesh_io::{Contents, MeshIoError, read_contents_from_bytes, read_mesh, read_mesh_from_str};
use stoss_reference_element::hex8;

fn read(text: &str) -> Result<Mesh, MeshIoError> {
    read_mesh_from_str("part.inp", text)
}

const CUBE: &str = "\
*heading
 a flat file
*NODE, NSET=everything
1, -1, -1, -1
2, 1, -1, -1
3, 1, 1, -1
4, -1, 1, -1
5, -1, -1, 1
6, 1, -1, 1
** a comment
7, 1, 1, 1
80, -1, 1, 1
*Element, Type=c3d8,
   elset = Body
7, 1, 2, 3, 4, 5, 6, 7, 80
";

#[test]
fn a_flat_file() {
    let mesh = read(CUBE).unwrap();
    assert_eq!(mesh.nodes, hex8::VERTICES);
    assert_eq!(mesh.elements, vec![[0, 1, 2, 3, 4, 5, 6, 7]].into());
    assert_eq!(mesh.nodes_of("everything").unwrap().len(), 8);
    assert_eq!(mesh.elements_of("Body").unwrap(), [0]);
}

/// The corners of the faces S1 to S6 as Abaqus' manual lists them for the 8-node brick.
#[test]
fn faces_are_numbered_as_abaqus_does() {
    let faces = [[1, 2, 3, 4], [5, 8, 7, 6], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 8, 4], [4, 8, 5, 1]];
    for (i, face) in faces.into_iter().enumerate() {
        for target in ["body", "7", "\"BODY\""] {
            let text = format!("{CUBE}*SURFACE, NAME=Side\n{target}, s{}\n", i + 1);
            let mesh = read(&text).unwrap();
            let facets = mesh.facets_of("Side").unwrap();
            assert_eq!((facets.len(), usize::from(facets[0].local)), (1, i));
            let mut expected = face.map(|n| n - 1);
            let mut nodes = facets[0].nodes.to_vec();
            expected.sort_unstable();
            nodes.sort_unstable();
            assert_eq!(nodes, expected, "S{}", i + 1);
        }
    }
}

#[test]
fn sets_of_all_kinds() {
    let text = format!(
        "{CUBE}*NSET, NSET=odd, GENERATE\n1, 7, 2\n*nset, nset=Some\n ODD, 2,\n 80\n*NSET, NSET=of elements, ELSET=body\n\
         *ELSET, ELSET=again\nBody\n*Surface, name=nodes, type=node\nodd\n 4, 1.0\n*SURFACE, NAME=skin\nBody,\n"
    );
    let mesh = read(&text).unwrap();
    assert_eq!(mesh.nodes_of("odd").unwrap(), [0, 2, 4, 6]);
    assert_eq!(mesh.nodes_of("Some").unwrap(), [0, 1, 2, 4, 6, 7]);
    assert_eq!(mesh.nodes_of("of elements").unwrap().len(), 8);
    assert_eq!(mesh.nodes_of("nodes").unwrap(), [0, 2, 3, 4, 6]);
    assert_eq!(mesh.elements_of("again").unwrap(), [0]);
    assert_eq!(mesh.facets_of("skin").unwrap(), mesh.facets_of("boundary").unwrap());
}

#[test]
fn a_part_with_one_instance() {
    let mesh = read_mesh(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/assembly.inp")).unwrap();
    assert_eq!((mesh.elements.len(), mesh.nodes.len()), (2, 12));
    // moved by 10 along x, then turned by 90 degrees about the line x = 10 parallel to z: (2, 1, 1) goes to (9, 2, 1)
    let corner = mesh.nodes_of("Corner").unwrap();
    assert_eq!(corner.len(), 1);
    let x = mesh.nodes[corner[0] as usize];
    for (a, b) in x.into_iter().zip([9.0, 2.0, 1.0]) {
        assert!((a - b).abs() < 1e-14, "{x:?}");
    }
    let mut names: Vec<&str> = mesh.node_sets.keys().map(String::as_str).collect();
    // the reference point is no node of the mesh
    assert_eq!(names, ["Clamp", "Corner", "Feet", "Set-1"]);
    assert_eq!(mesh.nodes_of("Clamp").unwrap(), mesh.nodes_of("Feet").unwrap());
    assert_eq!(mesh.nodes_of("Clamp").unwrap().len(), 4);
    names = mesh.facet_sets.keys().map(String::as_str).collect();
    assert_eq!(names, ["Free side", "Top"]);
    assert_eq!(mesh.facets_of("Free side").unwrap().len(), 10);
    let top = mesh.nodes_of("Top").unwrap();
    assert_eq!(top.len(), 6);
    assert!(top.iter().all(|&n| (mesh.nodes[n as usize][2] - 1.0).abs() < 1e-14));
    assert_eq!(mesh.elements_of("Set-1").unwrap(), [0, 1]);
}

#[test]
fn errors_name_the_line() {
    // a cube as a part with a node set "a" and a surface "side", with one instance
    let as_part = |more: &str, placement: &str| {
        let text = CUBE.replace("*NODE, NSET", "*PART, NAME=p\n*NODE, NSET");
        format!(
            "{text}*NSET, NSET=a\n1\n*SURFACE, NAME=side\n7, S3\n*INSTANCE, NAME=i, PART=P\n{placement}\n*END INSTANCE\n{more}\n"
        )
    };
    let replaced = |from: &str, to: &str| {
        assert!(CUBE.contains(from));
        CUBE.replacen(from, to, 1)
    };
    let add = |more: &str| format!("{CUBE}{more}\n");
    let rows = [
        (replaced("2, 1, -1, -1", "2, 1, one, -1"), 5, "\"one\""),
        (replaced("2, 1, -1, -1", "2, 1, 1e999, -1"), 5, "finite"),
        (replaced("2, 1, -1, -1", "1, 1, -1, -1"), 5, "line 4"),
        (replaced("*NODE", "*NODE, SYSTEM=C"), 3, "Cartesian"),
        (replaced("*NODE", "*NODE, INPUT=a.txt"), 3, "a.txt"),
        (replaced("5, 6, 7, 80", "5, 6, 7"), 15, "has 7 nodes"),
        (replaced("5, 6, 7, 80", "5, 6, 7, 8"), 15, "no node 8"),
        (replaced("5, 6, 7, 80", "5, 6, 7, 80, 3"), 15, "more than 8 nodes"),
        (replaced("5, 6, 7, 80", "5, 6, 7, 7"), 15, "twice"),
        (replaced("7, 1, 2, 3, 4, 5", "7, 4, 3, 2, 1, 5"), 15, "element 7"),
        (replaced("Type=c3d8", "Type=C3D8P"), 13, "1 elements C3D8P"),
        (replaced("Type=c3d8", "Typ=c3d8"), 13, "needs the parameter TYPE"),
        (
            add("*ELEMENT, TYPE=C3D5\n1,1,2,3,4,5\n2,1,2,\n3,4,5"),
            16,
            "2 elements C3D5 (line 16): Stoss computes with C3D8, C3D20, C3D27, C3D4, C3D10, C3D6, C3D15; there are no pyramids",
        ),
        (add("*ELEMENT, TYPE=MASS\n1,1"), 16, "1 elements MASS"),
        // What refers to elements that are not read is a consequence: the type is named first, at its line, with all elements.
        (
            add(
                "*ELEMENT, TYPE=C3D10T, ELSET=Tets\n21,1,2,3,4,5,6,\n7,80,1,2\n*SURFACE, NAME=top\nTets, S2\n*ELSET, ELSET=all\nTets\n*ELEMENT, TYPE=C3D10T\n22,1,2,3,4,5,6,\n7,80,1,2",
            ),
            16,
            "2 elements C3D10T",
        ),
        (
            replaced("Type=c3d8", "Type=C3D8T") + "*SURFACE, NAME=top\nbody, S2\n*NSET, NSET=foot, ELSET=body\n",
            13,
            "1 elements C3D8T",
        ),
        (add("*ELEMENT, TYPE=S4, ELSET=shell\n30,1,2,3,4\n*SURFACE, NAME=top\nshell, SPOS"), 16, "1 elements S4"),
        (add("*ELEMENT, TYPE=S4\n30,1,2,3,4\n*SURFACE, NAME=top\nshell, S1"), 16, "1 elements S4"),
        (add("*INCLUDE, INPUT=more.inp"), 16, "a text in memory includes no files"),
        (add("*INCLUDE"), 16, "needs the parameter INPUT"),
        (add("*NODE, INPUT=part.inp"), 16, "in a cycle"),
        (add("*NGEN\n1,3"), 16, "*NGEN"),
        (add("*PART, NAME=a\n*END PART\n*PART, NAME=A"), 18, "there is a part of this name"),
        (
            add("*PART, NAME=p\n*INSTANCE, NAME=a, PART=p\n*INSTANCE, NAME=A, PART=P"),
            18,
            "there is an instance of this name",
        ),
        (add("*INSTANCE, NAME=a, PART=p"), 16, "no part p"),
        (add("*NSET, NSET=a\n1, 2\n*ASSEMBLY\n*NSET, NSET=b, INSTANCE=i\n1"), 19, "no instance i"),
        (add("*NSET\n1"), 16, "needs the parameter NSET"),
        (add("*NSET, NSET=a\n1, 9"), 17, "no node 9"),
        (add("*NSET, NSET=a\nb"), 17, "node set (or number) b"),
        (add("*NSET, NSET=a\n1.5"), 17, "1.5"),
        (add("*NSET, NSET=a, GENERATE\n5, 1, 1"), 17, "first <= last"),
        (add("*NSET, NSET=a, GENERATE\n1, 5, 0"), 17, "positive increment"),
        (add("*NSET, NSET=a, GENERATE\n100, 18446744073709551615"), 16, "no node"),
        (add("*ELSET, ELSET=a, GENERATE\n100, 200"), 16, "no element"),
        (add("*ELSET, ELSET=a\n1"), 17, "no element 1"),
        (add("*NSET, NSET=a, ELSET=none"), 16, "none"),
        (add("*SURFACE, NAME=a\nbody, S7"), 17, "S1 to S6"),
        (add("*SURFACE, NAME=a\nbody, SPOS"), 17, "element 7 is a hex8, whose faces are S1 to S6"),
        (add("*SURFACE, NAME=a\nnobody, S1"), 17, "nobody"),
        (add("*SURFACE, TYPE=ELEMENT\n1,S1"), 16, "NAME"),
        (as_part("*NSET, NSET=A, INSTANCE=i\n2", ""), 24, "other content"),
        (as_part("*SURFACE, NAME=Top\nbody, S2\n*SURFACE, NAME=side\nbody, S3", ""), 20, "both have a surface"),
        (as_part("", "1, 2, 3\n0, 0, 0, 1, 0, 90"), 23, "7 numbers"),
        (as_part("", "1, 2, 3\n0,0,0,0,0,0,90"), 23, "rotation axis"),
        (as_part("", "1, 2, 3\n0,0,0,0,0,1,90\n0"), 24, "at most a translation and a rotation"),
        (as_part("", "1, 2, x"), 22, "\"x\""),
    ];
    for (source, line, message) in rows {
        let error = read(&source).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("part.inp:{line}: ")) && error.contains(message),
            "{error}\nfor line {line}, {message}"
        );
    }
    assert!(matches!(read("*HEADING\n"), Err(MeshIoError::NoElements { .. })));
}

fn contents(text: &str) -> Contents {
    read_contents_from_bytes("part.inp", text.as_bytes(), &mut |_| Err(std::io::ErrorKind::NotFound.into())).unwrap()
}

/// What is read otherwise than it is written is reported.
#[test]
fn notes() {
    let text = format!("{CUBE}*SURFACE, NAME=a, TYPE=SEGMENTS\n1,2\n").replace("c3d8", "c3d8r");
    let contents = contents(&text);
    let mesh = contents.mesh(None).unwrap();
    assert_eq!((mesh.elements.len(), mesh.facet_sets.len()), (1, 0));
    let notes = contents.notes().join("\n");
    assert!(
        notes.contains("C3D8R is read as hex8; it is fully integrated here")
            && notes.contains("(1 elements, first in line 15)"),
        "{notes}"
    );
    assert!(notes.contains("surface \"a\" (line 16) is left out: its type is SEGMENTS"), "{notes}");
}

/// Coordinates that are left out are zero, at the end of a line and within.
#[test]
fn blank_coordinates_are_zero() {
    let shift = |x: &str| CUBE.replace(" -1", " 0").replace("*NODE, NSET=everything\n1, 0, 0, 0", x);
    let mesh = read(&shift("*NODE\n1").replace("2, 1, 0, 0", "2, 1").replace("5, 0, 0, 1", "5,,,1")).unwrap();
    assert_eq!((mesh.nodes[0], mesh.nodes[1], mesh.nodes[4]), ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]));
}

/// A part with two instances, moved and turned, and a part of its own: groups, and sets with the names of their instances.
const PARTS: &str = include_str!("data/parts.inp");

#[test]
fn instances_are_groups() {
    let contents = contents(PARTS);
    assert_eq!(contents.groups(), ["Both", "Lower", "Lower.whole", "Point", "Upper", "Upper.whole"]);
    // the whole file has a pyramid
    let error = contents.mesh(None).unwrap_err().to_string();
    assert!(error.starts_with("part.inp:25: 1 elements C3D5 (line 25): "), "{error}");
    let error = contents.mesh(Some("Point")).unwrap_err().to_string();
    assert!(error.contains("1 elements C3D5"), "{error}");

    let lower = contents.mesh(Some("Lower")).unwrap();
    assert_eq!((lower.nodes[6], lower.elements.len()), ([1.0; 3], 1));
    assert_eq!(lower.nodes_of("foot").unwrap(), [0, 1, 2, 3]);
    assert_eq!(lower.nodes_of("Feet").unwrap(), [0, 1, 2, 3]);
    assert_eq!(*lower.facets_of("Top").unwrap()[0].nodes, [4, 5, 6, 7]);
    assert!(!lower.has_set("Contact") && !lower.has_set("Upper.Top"));

    // up by 1, then by 90 degrees about the z-axis: (1, 1, 1) -> (1, 1, 2) -> (-1, 1, 2)
    let upper = contents.mesh(Some("upper")).unwrap();
    assert_eq!(upper.nodes_of("Feet").unwrap(), [6]);
    for (a, b) in upper.nodes[6].into_iter().zip([-1.0, 1.0, 2.0]) {
        assert!((a - b).abs() < 1e-14);
    }
    let contact = upper.facets_of("Contact").unwrap();
    assert!(contact.len() == 1 && contact[0].nodes.iter().all(|&n| upper.nodes[n as usize][2] == 1.0));
    let both = contents.mesh(Some("Both")).unwrap();
    assert_eq!((both.elements.len(), both.nodes.len(), both.pieces()), (2, 16, 2));
    assert_eq!(both.facets_of("Upper.Top").unwrap().len(), 1);
    // the top of the one and the bottom of the other, turned, have the edge from (0, 0, 1) to (0, 1, 1) in common
    assert_eq!(both.coincident_nodes().unwrap().count, 2);

    let error = contents.mesh(Some("Middle")).unwrap_err().to_string();
    assert!(error.contains("no group \"Middle\"") && error.contains("\"Lower\""), "{error}");
    let error = contents.mesh(Some("contact")).unwrap_err().to_string();
    assert!(error.contains("is a group of facets"), "{error}");
    let error = contents.mesh(Some("Feet")).unwrap_err().to_string();
    assert!(error.contains("is a group of nodes"), "{error}");

    let survey = contents.survey(None);
    assert_eq!(survey.usable_groups, ["Both", "Lower", "Lower.whole", "Upper", "Upper.whole"]);
    assert_eq!(survey.reasons.len(), 1);
    let cells: Vec<_> = survey.cells.iter().map(|c| (c.name.as_str(), c.count, c.first.as_str(), c.read)).collect();
    // the brick stands in the file once and in the assembly twice
    assert_eq!(cells, [("C3D8", 2, "line 12", true), ("elements C3D5", 1, "line 25", false)]);
    assert!(contents.survey(Some("Lower")).reasons.is_empty());
}

#[test]
fn files_within_files() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    let (nodes, rest) = CUBE.split_once("** a comment\n").unwrap();
    let (last_nodes, elements) = rest.split_once("*Element").unwrap();
    write("main.inp", "*include, input=sub/nodes.inp\n*INCLUDE, INPUT=\"sub/rest.inp\"\n");
    write("sub/nodes.inp", &format!("{nodes}*INCLUDE,\n INPUT = more nodes.inp\n"));
    write("sub/more nodes.inp", last_nodes);
    write("sub/rest.inp", &format!("*Element{elements}*NSET, NSET=far\n7, 80\n"));
    let mesh = read_mesh(folder.path().join("main.inp")).unwrap();
    assert_eq!(mesh, read(&format!("{CUBE}*NSET, NSET=far\n7, 80\n")).unwrap());

    // data of a keyword in a file of its own
    write("main.inp", &format!("*NODE, NSET=everything, INPUT=data.inp\n*Element{elements}"));
    write("data.inp", &CUBE.lines().filter(|l| l.starts_with(char::is_numeric)).take(8).collect::<Vec<_>>().join("\n"));
    assert_eq!(read_mesh(folder.path().join("main.inp")).unwrap(), read(CUBE).unwrap());

    let error = |text: &str| {
        write("main.inp", text);
        read_mesh(folder.path().join("main.inp")).unwrap_err().to_string()
    };
    let absent = error("*HEADING\n*INCLUDE, INPUT=none.inp\n");
    assert!(absent.contains("main.inp:2: *INCLUDE, INPUT=none.inp: ") && absent.contains("relative"), "{absent}");
    write("sub/circle.inp", "\n*INCLUDE, INPUT=circle.inp\n");
    let circle = error("*INCLUDE, INPUT=sub/circle.inp\n");
    assert!(circle.contains("circle.inp:2: ") && circle.contains("circle"), "{circle}");
    // a circle by ever longer names
    write("sub/longer.inp", "*INCLUDE, INPUT=../sub/longer.inp\n");
    let longer = error("*INCLUDE, INPUT=sub/longer.inp\n");
    assert!(longer.contains("too many files"), "{longer}");
    write("sub/bad.inp", "*NODE\n1, x\n");
    let bad = error("*INCLUDE, INPUT=sub/bad.inp\n");
    assert!(bad.contains("bad.inp:2: \"x\""), "{bad}");
    assert!(error("*INCLUDE, INPUT=sub\n").contains("not a regular file"));
}

/// Sets of sets cannot explode.
#[test]
fn sets_of_sets_stay_small() {
    let mut text = format!("{CUBE}*NSET, NSET=s0\n1,2,3\n");
    for i in 1..200 {
        let s = format!("s{},", i - 1).repeat(16);
        text += &format!("*NSET, NSET=s{i}\n{s}\n");
    }
    assert_eq!(read(&text).unwrap().nodes_of("s199").unwrap(), [0, 1, 2]);
}
