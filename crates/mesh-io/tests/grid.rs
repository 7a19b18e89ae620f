//! VTU files as meshes. `tests/data/grid-{ascii,binary,zlib}.vtu` were written by meshio 5.3.5: two unit cubes in a row along x with
//! 12 points, arrays `body` (1, 2), `left` (1 on the quadrilateral at x = 0) and `stress` of the cells, `corner` of the points.
//! `grid-pieces.vtu` was written by a script: the same cubes as two pieces, big-endian, appended as raw bytes, the second a voxel.

use std::path::Path;

use stoss_mesh::Mesh;
use stoss_mesh_io::{Contents, MeshIoError, read_contents, read_contents_from_bytes, read_vtu};

fn data(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn read(bytes: &[u8]) -> Result<Contents, MeshIoError> {
    read_contents_from_bytes("part.vtu", bytes, &mut |_| unreachable!())
}

fn cubes(mesh: &Mesh) {
    assert_eq!(mesh.elements.len(), 2);
    for e in 0..2 {
        let x = mesh.element_coordinates(e);
        let bottom = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        for (n, &x) in x.iter().enumerate() {
            let [a, b] = bottom[n % 4];
            assert_eq!(x, [a + f64::from(e), b, if n < 4 { 0.0 } else { 1.0 }]);
        }
    }
}

#[test]
fn encodings_of_meshio() {
    for name in ["grid-ascii.vtu", "grid-binary.vtu", "grid-zlib.vtu"] {
        let contents = read_contents(data(name)).unwrap();
        assert_eq!(contents.groups(), ["body=1", "body=2", "left=0"], "{name}");
        let mesh = contents.mesh(None).unwrap();
        cubes(&mesh);
        assert_eq!(mesh.nodes.len(), 12);
        assert_eq!(mesh.nodes_of("corner").unwrap(), [0]);
        let left = mesh.facets_of("left").unwrap();
        assert!(left.len() == 1 && left[0].nodes.iter().all(|&n| mesh.nodes[n as usize][0] == 0.0));
        let second = contents.mesh(Some("body=2")).unwrap();
        assert_eq!((second.elements.len(), second.nodes.len()), (1, 8));
        assert!(second.nodes.iter().all(|x| x[0] >= 1.0) && !second.has_set("left"));
        // The same as a frame.
        let frame = read_vtu(data(name)).unwrap();
        assert_eq!((frame.points.len(), frame.elements.len(), frame.facets.len()), (12, 2, 1), "{name}");
        assert_eq!(frame.cell_data["body"].values[..2], [1.0, 2.0], "{name}");
    }
}

#[test]
fn pieces_voxels_and_raw_bytes() {
    let contents = read_contents(data("grid-pieces.vtu")).unwrap();
    let mesh = contents.mesh(None).unwrap();
    // the points stand in the order of a voxel; the first piece says so by its connectivity
    assert_eq!((mesh.nodes.len(), mesh.pieces()), (16, 2));
    assert_eq!(mesh.coincident_nodes().unwrap().count, 4);
    cubes(&mesh);
    assert_eq!(contents.mesh(Some("body=2")).unwrap().nodes.len(), 8);
}

#[test]
fn every_truncation_is_an_error() {
    for name in ["grid-ascii.vtu", "grid-binary.vtu", "grid-zlib.vtu", "grid-pieces.vtu"] {
        let good = std::fs::read(data(name)).unwrap();
        // what is missing behind the piece is not missed, but appended data are
        let end = good.windows(8).rposition(|w| w == b"</Piece>").unwrap();
        let end = if name == "grid-pieces.vtu" { good.len() - 30 } else { end };
        for cut in 0..end {
            let error = read(&good[..cut]).and_then(|contents| contents.mesh(None)).unwrap_err().to_string();
            assert!(error.starts_with("part.vtu"), "{name} {cut}: {error}");
        }
    }
}

#[test]
fn errors_say_what_is_wrong() {
    let text = std::fs::read_to_string(data("grid-ascii.vtu")).unwrap();
    for (from, to, message) in [
        ("UnstructuredGrid\"", "PolyData\"", "only files of type UnstructuredGrid"),
        ("byte_order=\"LittleEndian\"", "byte_order=\"LittleEndian\" compressor=\"vtkLZ4DataCompressor\"", "only zlib"),
        ("NumberOfPoints=\"12\"", "NumberOfPoints=\"13\"", "expected 13"),
        ("NumberOfCells=\"3\"", "NumberOfCells=\"2\"", "expected 2"),
        ("NumberOfCells=\"3\"", "", "numbers of points and cells"),
        ("format=\"ascii\"", "format=\"appended\"", "needs an offset"),
        ("</Piece>", "", "complete piece"),
    ] {
        let error = read(text.replacen(from, to, 1).as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with("part.vtu:") && error.contains(message), "{error}\nfor {message}");
    }
    // another type with the points of the second cube
    let types = |kind: &str| {
        let start = text.find("Name=\"types\"").unwrap();
        format!("{}{}", &text[..start], text[start..].replacen("12\n12\n9", &format!("12\n{kind}\n9"), 1))
    };
    let error = read(types("10").as_bytes()).unwrap_err().to_string();
    assert!(error.contains("cell 1\": tetrahedra (type 10) need 4 points each, and it has 8"), "{error}");
    let contents = read(types("14").as_bytes()).unwrap();
    let error = contents.mesh(None).unwrap_err().to_string();
    assert!(error.contains("1 pyramids (type 14)") && error.contains("tie them"), "{error}");
    assert_eq!(contents.mesh(Some("body=1")).unwrap().elements.len(), 1);
    assert!(contents.mesh(Some("body=2")).is_err());
}
