//! VTU and PVD: round trips bit by bit, structure, errors, atomic writing.

use proptest::prelude::*;
use stoss_mesh::generate::Block;
use stoss_mesh_io::{Field, MeshIoError, PvdWriter, VtuFrame, read_vtu, read_vtu_from_str, write_vtu, write_vtu_to};

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

fn to_string(frame: &VtuFrame) -> String {
    let mut out = Vec::new();
    write_vtu_to(&mut out, frame).unwrap();
    String::from_utf8(out).unwrap()
}

/// Any bit pattern at all, NaN with payload and subnormal numbers too.
fn any_f64() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn a_frame_comes_back_bit_by_bit(
        n in prop::array::uniform3(1usize..4),
        components in 1usize..7,
        seed in prop::collection::vec(any_f64(), 7 * 64),
        time in any_f64(),
        name in "[ -~äσ]{1,12}",
    ) {
        let mesh = Block::with_size([1.0, 2.0, 3.0], n).generate().unwrap();
        let (points, cells) = (mesh.nodes.len(), mesh.elements.len());
        let frame = VtuFrame {
            points: &mesh.nodes,
            hexahedra: &mesh.elements,
            point_data: vec![
                Field { name: &name, components, values: &seed[..components * points] },
                Field { name: "gap\n".trim(), components: 1, values: &seed[..points] },
            ],
            cell_data: vec![Field { name: &name, components: 1, values: &seed[..cells] }],
            field_data: vec![Field { name: "step", components: 1, values: &seed[..3] }],
            time: Some(time),
        };
        let text = to_string(&frame);
        prop_assert!(text.is_ascii());
        let data = read_vtu_from_str("frame.vtu", &text).unwrap();
        prop_assert_eq!(&data.points, &mesh.nodes);
        prop_assert_eq!(&data.hexahedra, &mesh.elements);
        prop_assert_eq!(data.time.map(f64::to_bits), Some(time.to_bits()));
        for (read, written) in [
            (&data.point_data, &frame.point_data),
            (&data.cell_data, &frame.cell_data),
            (&data.field_data, &frame.field_data),
        ] {
            prop_assert_eq!(read.len(), written.len());
            for (r, w) in read.iter().zip(written) {
                prop_assert_eq!((r.name.as_str(), r.components), (w.name, w.components));
                prop_assert_eq!(bits(&r.values), bits(w.values));
            }
        }
        prop_assert_eq!(data.point_field("gap").map(|f| f.values.len()), Some(points));
    }
}

/// The layout that VTK's documentation of its XML formats demands.
#[test]
fn structure_of_the_file() {
    let mesh = Block::with_size([1.0; 3], [1; 3]).generate().unwrap();
    let frame = VtuFrame { points: &mesh.nodes, hexahedra: &mesh.elements, time: Some(1.5), ..VtuFrame::default() };
    let text = to_string(&frame);
    let order = [
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">",
        "<UnstructuredGrid>",
        "<FieldData>",
        "Name=\"TimeValue\" NumberOfComponents=\"1\" NumberOfTuples=\"1\"",
        "<Piece NumberOfPoints=\"8\" NumberOfCells=\"1\">",
        "<PointData>",
        "<CellData>",
        "<Points>",
        "<Cells>",
        "type=\"Int64\" Name=\"connectivity\"",
        "type=\"Int64\" Name=\"offsets\"",
        // length 1 as UInt64, then the byte 12: 01 00 00 00 00 00 00 00 0c
        "type=\"UInt8\" Name=\"types\" format=\"binary\">\nAQAAAAAAAAAM\n</DataArray>",
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
    ];
    let mut position = 0;
    for piece in order {
        let found = text[position..].find(piece);
        assert!(found.is_some(), "{piece} after {position} in\n{text}");
        position += found.unwrap_or_default() + piece.len();
    }
    assert_eq!(position, text.len());
    // 8 as UInt64, then 1.5 = 0x3ff8 and six zero bytes
    assert!(text.contains("\nCAAAAAAAAAAAAAAAAAD4Pw==\n"), "{text}");
}

#[test]
fn data_that_do_not_fit_are_refused() {
    let mesh = Block::with_size([1.0; 3], [1; 3]).generate().unwrap();
    let good = VtuFrame { points: &mesh.nodes, hexahedra: &mesh.elements, ..VtuFrame::default() };
    let values = [0.0; 24];
    let field = |name: &'static str, components, count: usize| Field { name, components, values: &values[..count] };
    let bad = [
        VtuFrame { hexahedra: &[[0, 1, 2, 3, 4, 5, 6, 8]], ..good.clone() },
        VtuFrame { point_data: vec![field("u", 3, 23)], ..good.clone() },
        VtuFrame { point_data: vec![field("u", 0, 0)], ..good.clone() },
        VtuFrame { point_data: vec![field("", 3, 24)], ..good.clone() },
        VtuFrame { point_data: vec![field("a\u{7}", 3, 24)], ..good.clone() },
        VtuFrame { point_data: vec![field("u", 3, 24), field("u", 1, 8)], ..good.clone() },
        VtuFrame { cell_data: vec![field("u", 3, 24)], ..good.clone() },
        VtuFrame { field_data: vec![field("TimeValue", 1, 1)], ..good.clone() },
    ];
    for frame in bad {
        assert!(matches!(write_vtu_to(&mut Vec::new(), &frame), Err(MeshIoError::Output { .. })), "{frame:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    let frame = VtuFrame { point_data: vec![field("u", 3, 23)], ..good.clone() };
    assert!(write_vtu(folder.path().join("bad.vtu"), &frame).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    let nowhere = write_vtu(folder.path().join("none/a.vtu"), &good);
    assert!(matches!(nowhere, Err(MeshIoError::Io { .. })));
}

/// Someone who has the old frame open keeps it, and nothing else is left in the folder.
#[test]
fn frames_are_replaced_by_renaming() {
    use std::io::Read;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.vtu");
    let write = |n| {
        let mesh = Block::with_size([1.0; 3], [n, 1, 1]).generate().unwrap();
        write_vtu(&path, &VtuFrame { points: &mesh.nodes, hexahedra: &mesh.elements, ..VtuFrame::default() }).unwrap();
    };
    write(1);
    let old = std::fs::read(&path).unwrap();
    let mut open = std::fs::File::open(&path).unwrap();
    write(5);
    let mut seen = Vec::new();
    open.read_to_end(&mut seen).unwrap();
    assert_eq!(seen, old);
    assert_eq!(read_vtu(&path).unwrap().hexahedra.len(), 5);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_collection_grows_and_resumes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.pvd");
    let mut writer = PvdWriter::create(&path).unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().ends_with("<Collection>\n</Collection>\n</VTKFile>\n"));
    for step in 0..5 {
        writer.push(0.1 * f64::from(step), format!("frames/a&b-{step}.vtu")).unwrap();
    }
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("<DataSet timestep=\"0.2\" group=\"\" part=\"0\" file=\"frames/a&amp;b-2.vtu\"/>"), "{text}");
    assert_eq!(PvdWriter::resume(&path, f64::INFINITY).unwrap(), writer);
    let mut shorter = PvdWriter::resume(&path, 0.2).unwrap();
    assert_eq!(shorter.entries(), &writer.entries()[..3]);
    shorter.push(0.25, "frames/x.vtu").unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap().matches("<DataSet").count(), 4);
    assert!(shorter.push(f64::NAN, "frames/y.vtu").is_err());
    assert!(shorter.push(1.0, "").is_err());
    assert_eq!(PvdWriter::resume(&path, 1.0).unwrap().entries().len(), 4);
    assert!(PvdWriter::resume(folder.path().join("new.pvd"), 1.0).unwrap().entries().is_empty());
    std::fs::write(&path, "<VTKFile>\n<DataSet timestep=\"x\" file=\"y\"/>").unwrap();
    assert!(PvdWriter::resume(&path, 1.0).unwrap_err().to_string().contains(".pvd:2: "));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
