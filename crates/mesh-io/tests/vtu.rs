//! VTU and PVD: round trips bit by bit, structure, errors, atomic writing.

use proptest::prelude::*;
use std::fmt::Write;
use stoss_mesh::Elements;
use stoss_mesh::generate::Block;
use stoss_mesh_io::{Field, MeshIoError, PvdWriter, VtuFrame, read_vtu, read_vtu_from_bytes, write_vtu, write_vtu_to};
use stoss_reference_element::{CellKind, FaceKind, FaceNodes};

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
            elements: mesh.elements.blocks(),
            point_data: vec![
                Field { name: &name, components, values: &seed[..components * points] },
                Field { name: "gap\n".trim(), components: 1, values: &seed[..points] },
            ],
            cell_data: vec![Field { name: &name, components: 1, values: &seed[..cells] }],
            field_data: vec![Field { name: "step", components: 1, values: &seed[..3] }],
            time: Some(time),
            ..VtuFrame::default()
        };
        let text = to_string(&frame);
        prop_assert!(text.is_ascii());
        let data = read_vtu_from_bytes("frame.vtu", text.as_bytes()).unwrap();
        prop_assert_eq!(&data.points, &mesh.nodes);
        prop_assert_eq!(&data.elements, &mesh.elements);
        prop_assert_eq!(data.time.map(f64::to_bits), Some(time.to_bits()));
        for (read, written) in [
            (&data.point_data, &frame.point_data),
            (&data.cell_data, &frame.cell_data),
            (&data.field_data, &frame.field_data),
        ] {
            prop_assert_eq!(read.len(), written.len());
            for w in written {
                let r = &read[w.name];
                prop_assert_eq!(r.components, w.components);
                prop_assert_eq!(bits(&r.values), bits(w.values));
            }
        }
        prop_assert_eq!(data.point_data.get("gap").map(|f| f.values.len()), Some(points));
    }
}

/// The layout that VTK's documentation of its XML formats demands.
#[test]
fn structure_of_the_file() {
    let mesh = Block::with_size([1.0; 3], [1; 3]).generate().unwrap();
    let frame =
        VtuFrame { points: &mesh.nodes, elements: mesh.elements.blocks(), time: Some(1.5), ..VtuFrame::default() };
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

/// An array as VTK's documentation has it: base64 (RFC 4648) of the length and the bytes.
fn data_array(attributes: &str, bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bytes = [&(bytes.len() as u64).to_le_bytes(), bytes].concat();
    let mut text = format!("<DataArray {attributes} format=\"binary\">\n");
    for group in bytes.chunks(3) {
        let word = (0..3).fold(0_u32, |word, i| word << 8 | u32::from(*group.get(i).unwrap_or(&0)));
        for i in 0..4 {
            text.push(if i > group.len() { '=' } else { char::from(DIGITS[(word >> (18 - 6 * i) & 63) as usize]) });
        }
    }
    text + "\n</DataArray>\n"
}

/// The whole file of given cells, each a type and its points, with a field on points and one on cells.
fn file(points: &[[f64; 3]], cells: &[(u8, &[i64])], field: &[f64], body: &[f64]) -> String {
    let floats = |values: &[f64]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
    let ends = cells.iter().scan(0, |end, (_, nodes)| {
        *end += nodes.len() as i64;
        Some(*end)
    });
    let nodes: Vec<u8> = cells.iter().flat_map(|(_, nodes)| nodes.iter()).flat_map(|n| n.to_le_bytes()).collect();
    let kinds: Vec<u8> = cells.iter().map(|(kind, _)| *kind).collect();
    let mut text = String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" ");
    text += "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n";
    text += &data_array(
        "type=\"Float64\" Name=\"TimeValue\" NumberOfComponents=\"1\" NumberOfTuples=\"1\"",
        &floats(&[0.25]),
    );
    let _ = write!(
        text,
        "</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<PointData>\n",
        points.len(),
        cells.len()
    );
    text += &data_array("type=\"Float64\" Name=\"u\" NumberOfComponents=\"1\"", &floats(field));
    text += "</PointData>\n<CellData>\n";
    text += &data_array("type=\"Float64\" Name=\"body\" NumberOfComponents=\"1\"", &floats(body));
    text += "</CellData>\n<Points>\n";
    text += &data_array("type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"", &floats(points.as_flattened()));
    text += "</Points>\n<Cells>\n";
    text += &data_array("type=\"Int64\" Name=\"connectivity\"", &nodes);
    text += &data_array("type=\"Int64\" Name=\"offsets\"", &ends.flat_map(i64::to_le_bytes).collect::<Vec<_>>());
    text += &data_array("type=\"UInt8\" Name=\"types\"", &kinds);
    text + "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
}

/// Hexahedra alone, and with cells of all other kinds: the file byte by byte, and back.
#[test]
fn cells_of_all_kinds_are_written_and_read() {
    let mesh = Block::with_size([1.0, 2.0, 3.0], [2, 1, 1]).generate().unwrap();
    let field: Vec<f64> = (0..12).map(|k| f64::from(k) / 3.0).collect();
    let hexahedra: Vec<Vec<i64>> =
        mesh.elements.iter().map(|nodes| nodes.iter().map(|&n| i64::from(n)).collect()).collect();
    let mut cells: Vec<(u8, &[i64])> = hexahedra.iter().map(|nodes| (12, nodes.as_slice())).collect();
    let body = [0.0, 1.0, 2.0, 2.0, 3.0, 4.0, 5.0];
    let frame = |body| VtuFrame {
        points: &mesh.nodes,
        elements: mesh.elements.blocks(),
        point_data: vec![Field { name: "u", components: 1, values: &field }],
        cell_data: vec![Field { name: "body", components: 1, values: body }],
        time: Some(0.25),
        ..VtuFrame::default()
    };
    assert_eq!(to_string(&frame(&body[..2])), file(&mesh.nodes, &cells, &field, &body[..2]));

    let facets: [FaceNodes; 2] = [[4, 5, 6].into(), [7, 6, 5, 11].into()];
    let (lines, vertices) = ([vec![0, 3, 8], vec![9, 10]], [11]);
    let all = VtuFrame { facets: &facets, lines: &lines, vertices: &vertices, ..frame(&body) };
    cells.extend([(5, [4, 5, 6].as_slice()), (9, &[7, 6, 5, 11]), (4, &[0, 3, 8]), (4, &[9, 10]), (1, &[11])]);
    let text = to_string(&all);
    assert_eq!(text, file(&mesh.nodes, &cells, &field, &body));
    let data = read_vtu_from_bytes("frame.vtu", text.as_bytes()).unwrap();
    assert_eq!((&data.elements, data.facets.as_slice()), (&mesh.elements, facets.as_slice()));
    assert_eq!((data.lines.as_slice(), data.vertices.as_slice()), (lines.as_slice(), vertices.as_slice()));
    assert_eq!(data.cell_data["body"].values, body);

    // Another order, another kind, a number of points that does not fit, points that do not exist.
    cells.swap(0, 2);
    let read =
        |cells: &[(u8, &[i64])]| read_vtu_from_bytes("a.vtu", file(&mesh.nodes, cells, &field, &body).as_bytes());
    assert!(read(&cells).is_err());
    cells.swap(0, 2);
    assert!(read(&cells).is_ok());
    for bad in
        [(14, [0, 1, 2, 3, 4].as_slice()), (5, &[0, 1, 2, 3]), (9, &[0, 1, 2]), (4, &[0]), (1, &[0, 1]), (4, &[0, 12])]
    {
        let last = std::mem::replace(&mut cells[6], bad);
        assert!(read(&cells).is_err(), "{bad:?}");
        cells[6] = last;
    }
    for bad in [
        VtuFrame { facets: &[[0, 1, 12].into(), facets[1]], ..all.clone() },
        VtuFrame { lines: &[vec![0, 1], vec![1]], ..all.clone() },
        VtuFrame { vertices: &[12], ..all.clone() },
        VtuFrame { vertices: &[], ..all.clone() },
    ] {
        assert!(matches!(write_vtu_to(&mut Vec::new(), &bad), Err(MeshIoError::Output { .. })), "{bad:?}");
    }
}

/// Elements and faces of all kinds, those of one kind apart from each other too: VTK's types, and back.
#[test]
fn elements_of_all_kinds_are_written_and_read() {
    let points: Vec<[f64; 3]> = (0..40).map(|k| [f64::from(k), 0.5, -1.0]).collect();
    let (mut elements, mut cells): (Elements, Vec<(u8, Vec<i64>)>) = Default::default();
    let types = [(8, 12), (20, 25), (27, 29), (4, 10), (10, 24), (6, 13), (15, 26), (4, 10), (8, 12)];
    for (first, (count, vtk)) in (0_u32..).zip(types) {
        let kind = CellKind::ALL.into_iter().find(|kind| kind.node_count() == count).unwrap();
        let nodes: Vec<u32> = (first..first + count as u32).collect();
        elements.push(kind, &nodes);
        cells.push((vtk, nodes.into_iter().map(i64::from).collect()));
    }
    let mut facets = Vec::new();
    for (first, (corners, count, vtk)) in (0_u32..).zip([(4, 9, 28), (3, 3, 5), (4, 4, 9), (3, 6, 22), (4, 8, 23)]) {
        let kind = FaceKind::with_nodes(corners, count).unwrap();
        facets.push(FaceNodes::from_fn(kind, |k| first + 2 * k as u32));
        cells.push((vtk, facets[first as usize].iter().map(|&n| i64::from(n)).collect()));
    }
    let values: Vec<f64> = (0..40).map(f64::from).collect();
    let frame = VtuFrame {
        points: &points,
        elements: elements.blocks(),
        facets: &facets,
        point_data: vec![Field { name: "u", components: 1, values: &values }],
        cell_data: vec![Field { name: "body", components: 1, values: &values[..14] }],
        time: Some(0.25),
        ..VtuFrame::default()
    };
    assert_eq!(frame.cell_count(), 14);
    let cells: Vec<(u8, &[i64])> = cells.iter().map(|(vtk, nodes)| (*vtk, nodes.as_slice())).collect();
    let text = to_string(&frame);
    assert_eq!(text, file(&points, &cells, &values, &values[..14]));
    let data = read_vtu_from_bytes("frame.vtu", text.as_bytes()).unwrap();
    assert_eq!((&data.elements, &data.facets), (&elements, &facets));
    // a number of points that does not fit the type; an element behind a facet; pyramids
    for (place, bad) in [(4, (24, &[0, 1, 2, 3][..])), (13, (10, &[0, 1, 2, 3])), (0, (14, &[0, 1, 2, 3, 4]))] {
        let mut cells = cells.clone();
        cells[place] = bad;
        assert!(
            read_vtu_from_bytes("a.vtu", file(&points, &cells, &values, &values[..14]).as_bytes()).is_err(),
            "{bad:?}"
        );
    }
}

#[test]
fn data_that_do_not_fit_are_refused() {
    let mesh = Block::with_size([1.0; 3], [1; 3]).generate().unwrap();
    let good = VtuFrame { points: &mesh.nodes, elements: mesh.elements.blocks(), ..VtuFrame::default() };
    let values = [0.0; 24];
    let field = |name: &'static str, components, count: usize| Field { name, components, values: &values[..count] };
    let out_of_range = Elements::from(vec![[0, 1, 2, 3, 4, 5, 6, 8]]);
    let bad = [
        VtuFrame { elements: out_of_range.blocks(), ..good.clone() },
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
        write_vtu(&path, &VtuFrame { points: &mesh.nodes, elements: mesh.elements.blocks(), ..VtuFrame::default() })
            .unwrap();
    };
    write(1);
    let old = std::fs::read(&path).unwrap();
    let mut open = std::fs::File::open(&path).unwrap();
    write(5);
    let mut seen = Vec::new();
    open.read_to_end(&mut seen).unwrap();
    assert_eq!(seen, old);
    assert_eq!(read_vtu(&path).unwrap().elements.len(), 5);
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
