//! Abaqus input files.

use std::path::Path;

use stoss_mesh::Mesh;
use stoss_mesh_io::{MeshIoError, read_mesh, read_mesh_from_str};
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
    assert_eq!(mesh.elements, [[0, 1, 2, 3, 4, 5, 6, 7]]);
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
            let mut nodes = facets[0].nodes;
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
    let replaced = |from: &str, to: &str| {
        assert!(CUBE.contains(from));
        CUBE.replacen(from, to, 1)
    };
    let add = |more: &str| format!("{CUBE}{more}\n");
    let rows = [
        (replaced("2, 1, -1, -1", "2, 1, -1"), 5, "end of line"),
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
        (replaced("Type=c3d8", "Type=C3D8R"), 13, "1 elements C3D8R"),
        (replaced("Type=c3d8", "Typ=c3d8"), 13, "needs the parameter TYPE"),
        (add("*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n2,1,2,\n3,4"), 16, "2 elements C3D4"),
        (add("*ELEMENT, TYPE=MASS\n1,1"), 16, "1 elements MASS"),
        // What refers to elements that are not read is a consequence: the type is named first, at its line, with all elements.
        (
            add(
                "*ELEMENT, TYPE=C3D10, ELSET=Tets\n21,1,2,3,4,5,6,\n7,80,1,2\n*SURFACE, NAME=top\nTets, S2\n*ELSET, ELSET=all\nTets\n*ELEMENT, TYPE=C3D10\n22,1,2,3,4,5,6,\n7,80,1,2",
            ),
            16,
            "2 elements C3D10",
        ),
        (
            replaced("Type=c3d8", "Type=C3D8R") + "*SURFACE, NAME=top\nbody, S2\n*NSET, NSET=foot, ELSET=body\n",
            13,
            "1 elements C3D8R",
        ),
        (add("*ELEMENT, TYPE=S4, ELSET=shell\n30,1,2,3,4\n*SURFACE, NAME=top\nshell, SPOS"), 16, "1 elements S4"),
        (add("*ELEMENT, TYPE=S4\n30,1,2,3,4\n*SURFACE, NAME=top\nshell, S1"), 16, "1 elements S4"),
        (add("*INCLUDE, INPUT=more.inp"), 16, "*INCLUDE"),
        (add("*NGEN\n1,3"), 16, "*NGEN"),
        (add("*PART, NAME=a\n*PART, NAME=b"), 17, "a second *PART"),
        (add("*INSTANCE, NAME=a, PART=p\n*END INSTANCE\n*INSTANCE, NAME=b, PART=p"), 18, "a second *INSTANCE"),
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
        (add("*SURFACE, NAME=a\nbody, SPOS"), 17, "S1 to S6"),
        (add("*SURFACE, NAME=a\nnobody, S1"), 17, "nobody"),
        (add("*SURFACE, NAME=a, TYPE=SEGMENTS\n1,2"), 16, "SEGMENTS"),
        (add("*SURFACE, TYPE=ELEMENT\n1,S1"), 16, "NAME"),
        (add("*NSET, NSET=a\n1\n*ASSEMBLY\n*NSET, NSET=A, INSTANCE=i\n2"), 19, "other content"),
        (add("*INSTANCE, NAME=i, PART=p\n1, 2"), 17, "placement"),
    ];
    for (source, line, message) in rows {
        let error = read(&source).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("part.inp:{line}: ")) && error.contains(message),
            "{error}\nfor line {line}, {message}"
        );
    }
    assert!(matches!(read("*HEADING\n"), Err(MeshIoError::NoHexahedra { .. })));
    let rotated = add("*INSTANCE, NAME=i, PART=p\n1, 2, 3\n0,0,0,0,0,0,90");
    assert!(read(&rotated).unwrap_err().to_string().contains("rotation axis"));
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
