//! VTKHDF files: what was written is read again, whatever happened in between.
use std::path::Path;
use stoss_mesh::Elements;
use stoss_mesh_io::{
    Field, MeshIoError, VtkhdfFile, VtuData, VtuFrame, append_vtkhdf, create_vtkhdf, keep_vtkhdf, read_vtu_from_bytes,
    write_vtu_to,
};
use stoss_reference_element::{CellKind, FaceKind, FaceNodes};

const POINTS: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
    [5.0, 5.0, 5.0],
    [6.0, 5.0, 5.0],
];

/// The values of frame `k`.
struct Values {
    way: Vec<f64>,
    gap: Vec<f64>,
    tensor: Vec<f64>,
}

impl Values {
    fn new(k: usize) -> Self {
        let number = |i: usize| (1 + k) as f64 * 0.1 + i as f64;
        Self {
            way: (0..30).map(number).collect(),
            gap: (0..10).map(|i| if i % 3 == 0 { f64::NAN } else { number(i) }).collect(),
            tensor: (0..90).map(|i| number(i) * 1e-7).collect(),
        }
    }

    fn write(&self, time: f64, then: impl FnOnce(&VtuFrame) -> Result<(), MeshIoError>) -> Result<(), MeshIoError> {
        let elements = Elements::from(vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
        then(&VtuFrame {
            points: &POINTS,
            elements: elements.blocks(),
            facets: &[[0, 1, 2].into(), [4, 5, 6, 7].into()],
            lines: &[vec![8, 9, 1]],
            vertices: &[8],
            point_data: vec![
                Field { name: "deformation_gradient", components: 9, values: &self.tensor },
                Field { name: "displacement", components: 3, values: &self.way },
                Field { name: "gap", components: 1, values: &self.gap },
            ],
            cell_data: vec![Field { name: "body", components: 1, values: &[0.0, 1.0, 1.0, 2.0, 3.0] }],
            time: Some(time),
            ..VtuFrame::default()
        })
    }
}

/// Writes frames from the number `from` on: step `3 k` at time `k/8`.
fn write(path: &Path, frames: std::ops::Range<usize>) {
    for k in frames {
        let write = |frame: &VtuFrame| match k {
            0 => create_vtkhdf(path, frame, 0),
            _ => append_vtkhdf(path, frame, 3 * k as u64),
        };
        Values::new(k).write(k as f64 / 8.0, write).unwrap();
    }
}

/// The frame by way of a VTU file.
fn vtu(k: usize) -> VtuData {
    let mut text = Vec::new();
    Values::new(k).write(k as f64 / 8.0, |frame| write_vtu_to(&mut text, frame)).unwrap();
    read_vtu_from_bytes("frame", &text).unwrap()
}

/// Equal, bit for bit: NaN is no number.
fn check(path: &Path, count: usize) {
    let file = VtkhdfFile::open(path).unwrap();
    let expected: Vec<(u64, f64)> = (0..count).map(|k| (3 * k as u64, k as f64 / 8.0)).collect();
    assert_eq!(file.frames(), expected);
    for k in 0..count {
        assert_eq!(format!("{:?}", file.read(k).unwrap()), format!("{:?}", vtu(k)), "frame {k}");
    }
    assert!(file.read(count).is_err());
}

#[test]
fn frames_are_those_of_vtu_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.vtkhdf");
    // More than two chunks of the arrays with a number a frame.
    write(&path, 0..37);
    check(&path, 37);
    // One frame after the other, in sessions of their own; the file does not grow by more than what is in the frames.
    let one = std::fs::metadata(&path).unwrap().len() / 37;
    assert!(one < 8000, "{one} bytes a frame of 1040 bytes");
}

/// Elements and faces of all kinds.
#[test]
fn all_kinds_of_cells() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.vtkhdf");
    let points = [[0.5; 3]; 30];
    let mut elements = Elements::new();
    for kind in CellKind::ALL.into_iter().chain([CellKind::Tet4]) {
        let nodes: Vec<u32> = (0..kind.node_count() as u32).map(|n| n + 2).collect();
        elements.push(kind, &nodes);
    }
    let facets: Vec<FaceNodes> =
        FaceKind::ALL.into_iter().map(|kind| FaceNodes::from_fn(kind, |k| 20 - k as u32)).collect();
    let frame = VtuFrame {
        points: &points,
        elements: elements.blocks(),
        facets: &facets,
        time: Some(1.0),
        ..VtuFrame::default()
    };
    create_vtkhdf(&path, &frame, 0).unwrap();
    append_vtkhdf(&path, &frame, 1).unwrap();
    let file = VtkhdfFile::open(&path).unwrap();
    for k in 0..2 {
        let data = file.read(k).unwrap();
        assert_eq!((&data.elements, &data.facets), (&elements, &facets));
    }
}

#[test]
fn a_file_that_is_cut_back_goes_on_as_a_shorter_one() {
    let folder = tempfile::tempdir().unwrap();
    let [long, short] = ["long", "short"].map(|name| folder.path().join(format!("{name}.vtkhdf")));
    write(&long, 0..21);
    keep_vtkhdf(&long, 5).unwrap();
    check(&long, 5);
    write(&short, 0..5);
    check(&short, 5);
    write(&long, 5..19);
    check(&long, 19);
    assert!(keep_vtkhdf(&long, 20).unwrap_err().to_string().contains("19 frames, 20 of them cannot be kept"));
    check(&long, 19);
}

#[test]
fn frames_that_differ_and_files_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.vtkhdf");
    write(&path, 0..2);
    let values = Values::new(2);
    let other = |change: &dyn Fn(&mut VtuFrame)| {
        let append = |frame: &VtuFrame| {
            let mut frame = frame.clone();
            change(&mut frame);
            append_vtkhdf(&path, &frame, 6)
        };
        assert!(matches!(values.write(0.25, append), Err(MeshIoError::Output { .. })));
        check(&path, 2);
    };
    other(&|frame| frame.time = None);
    other(&|frame| frame.field_data = vec![Field { name: "all", components: 1, values: &[1.0] }]);
    other(&|frame| frame.vertices = &[]);
    other(&|frame| frame.point_data.truncate(2));
    other(&|frame| frame.point_data[2].name = "gaps");
    let text = folder.path().join("text.vtkhdf");
    std::fs::write(&text, "no HDF5").unwrap();
    let error = VtkhdfFile::open(&text).unwrap_err().to_string();
    assert!(error.contains("text.vtkhdf"), "{error}");
    // A file that ends too early is an error and no panic, wherever it ends.
    let bytes = std::fs::read(&path).unwrap();
    for length in (0..bytes.len()).step_by(97) {
        std::fs::write(&text, &bytes[..length]).unwrap();
        if let Ok(file) = VtkhdfFile::open(&text) {
            (0..2).for_each(|k| drop(file.read(k)));
        }
    }
}
