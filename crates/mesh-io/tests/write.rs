//! Meshes written and read again.

use std::path::Path;

use stoss_mesh::Mesh;
use stoss_mesh::generate::{Block, HollowBall};
use stoss_mesh_io::{MeshIoError, read_contents, read_mesh, write_mesh};

fn ball() -> Mesh {
    let mut mesh = HollowBall { inner_diameter: 0.8, outer_diameter: 1.0, divisions: [3, 2] }.generate().unwrap();
    mesh.element_sets.insert("first second".into(), vec![0, 1]);
    mesh.element_sets.insert("second".into(), vec![1, 2]);
    mesh.node_sets.insert("some".into(), vec![0, 5, 7]);
    mesh.node_sets.insert("others".into(), vec![5, 6]);
    mesh
}

#[test]
fn what_is_written_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let block = Block::with_size([1.0, 0.1, 3.0], [3, 2, 2]).generate().unwrap();
    for mesh in [ball(), block] {
        for name in ["a.msh", "a.inp", "a.vtu"] {
            let path = folder.path().join(name);
            write_mesh(&path, &mesh).unwrap();
            let again = read_mesh(&path).unwrap();
            assert!(again == mesh, "{name}");
        }
    }
}

/// From format to format, and a group of it.
#[test]
fn conversions() {
    let folder = tempfile::tempdir().unwrap();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/two-41-binary.msh");
    let lower = read_contents(source).unwrap().mesh(Some("Lower")).unwrap();
    let mut path = folder.path().join("a.inp");
    write_mesh(&path, &lower).unwrap();
    for next in ["b.vtu", "c.msh", "d.inp"] {
        let mesh = read_mesh(&path).unwrap();
        path = folder.path().join(next);
        write_mesh(&path, &mesh).unwrap();
    }
    assert!(read_mesh(&path).unwrap() == lower);
}

/// Facets between two elements stay facets in every format; whoever computes with the mesh gets their nodes.
#[test]
fn facets_between_elements_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut mesh = Block::with_size([1.0, 1.0, 2.0], [1, 1, 2]).generate().unwrap();
    mesh.facet_sets.insert("Mid".into(), vec![mesh.facet(0, 1)]);
    let mut path = folder.path().join("a.msh");
    write_mesh(&path, &mesh).unwrap();
    for next in ["b.inp", "c.vtu", "d.msh", "e.vtu"] {
        let again = read_contents(&path).unwrap().mesh_with_inner_facets(None).unwrap();
        assert!(again == mesh, "{}: {:?}", path.display(), again.facet_sets.get("Mid"));
        path = folder.path().join(next);
        write_mesh(&path, &again).unwrap();
    }
    let computed = read_mesh(&path).unwrap();
    assert!(!computed.facet_sets.contains_key("Mid"));
    assert_eq!(computed.node_sets["Mid"].len(), 4);
}

#[test]
fn names_that_a_format_cannot_hold() {
    let folder = tempfile::tempdir().unwrap();
    let with = |names: &[&str]| {
        let mut mesh = ball();
        names.iter().for_each(|&name| drop(mesh.node_sets.insert(name.into(), vec![1])));
        mesh
    };
    for (file, names) in [
        ("a.msh", ["a\"b"].as_slice()),
        ("a.msh", &["a\nb"]),
        ("a.inp", &["a,b"]),
        ("a.inp", &["Top", "top"]),
        ("a.vtu", &["a\u{1}"]),
        ("a.stl", &[]),
    ] {
        let error = write_mesh(folder.path().join(file), &with(names)).unwrap_err();
        assert!(matches!(error, MeshIoError::Output { .. }), "{error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    // a name of nodes and of facets: both are kept
    let mut mesh = ball();
    mesh.node_sets.insert("outer".into(), vec![3]);
    let path = folder.path().join("a.msh");
    write_mesh(&path, &mesh).unwrap();
    let again = read_mesh(&path).unwrap();
    assert_eq!(
        (again.node_sets["outer (nodes)"].as_slice(), again.facets_of("outer")),
        (&[3][..], mesh.facets_of("outer"))
    );
}
