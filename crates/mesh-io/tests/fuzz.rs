//! Damaged files: whatever is cut off, replaced, doubled or exchanged, a reader returns a checked mesh or an error that
//! names the file. It never panics and never hangs.

use proptest::prelude::*;
use stoss_mesh::Elements;
use stoss_mesh_io::{
    Field, VtuFrame, read_contents_from_bytes, read_mesh_from_str, read_surface_from_bytes, read_vtu_from_bytes,
    write_vtu_to,
};

const FILES: [(&str, &str); 9] = [
    ("a.msh", include_str!("data/ring-22.msh")),
    ("a.msh", include_str!("data/ring-41.msh")),
    ("a.inp", include_str!("data/assembly.inp")),
    ("a.vtu", ""),
    ("a.inp", include_str!("data/parts.inp")),
    ("a.msh", include_str!("data/cell-hex27.msh")),
    ("a.msh", include_str!("data/cell-tet10.msh")),
    ("a.msh", include_str!("data/cell-wedge15.msh")),
    ("a.inp", CELLS),
];

/// A quadratic tetrahedron, a wedge, and a surface of both.
const CELLS: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,.5,0,0\n6,.5,.5,0\n7,0,.5,0\n8,0,0,.5\n9,.5,0,.5\n10,0,.5,.5\n\
                     11,3,0,0\n12,4,0,0\n13,3,1,0\n14,3,0,1\n15,4,0,1\n16,3,1,1\n*ELEMENT, TYPE=C3D10M, ELSET=a\n\
                     1,1,2,3,4,5,6,\n7,8,9,10\n*ELEMENT, TYPE=C3D6, ELSET=a\n2,11,12,13,14,15,16\n*SURFACE, NAME=s\na,S4\n2,S5\n";

const BINARY: [&[u8]; 11] = [
    include_bytes!("data/two-22-binary.msh"),
    include_bytes!("data/two-41-binary.msh"),
    include_bytes!("data/two-41-parametric.msh"),
    include_bytes!("data/two-41-big-endian.msh"),
    include_bytes!("data/cell-tet10-binary.msh"),
    include_bytes!("data/cell-wedge15-binary.msh"),
    include_bytes!("data/grid-ascii.vtu"),
    include_bytes!("data/grid-binary.vtu"),
    include_bytes!("data/grid-zlib.vtu"),
    include_bytes!("data/grid-pieces.vtu"),
    include_bytes!("data/cells.vtu"),
];

fn vtu() -> String {
    let points = stoss_reference_element::hex8::VERTICES;
    let values = [1.0; 24];
    let elements = Elements::from(vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
    let frame = VtuFrame {
        points: &points,
        elements: elements.blocks(),
        facets: &[[0, 1, 2].into(), [4, 5, 6, 7].into()],
        lines: &[vec![0, 3, 6]],
        vertices: &[7],
        point_data: vec![Field { name: "u", components: 3, values: &values }],
        time: Some(0.5),
        ..VtuFrame::default()
    };
    let mut out = Vec::new();
    write_vtu_to(&mut out, &frame).unwrap();
    String::from_utf8(out).unwrap()
}

/// Two tetrahedra: as text with a solid each, in binary with a header that begins as a text does.
fn stl() -> (String, Vec<u8>) {
    let x = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0_f32]];
    let mut text = String::new();
    let mut bytes = format!("{:80}", "solid tetrahedra").into_bytes();
    bytes.extend(8_u32.to_le_bytes());
    for (solid, shift) in [("one", 0.0), ("two", 3.0)] {
        text += &format!("solid {solid}\n");
        for facet in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
            text += "facet normal 0 0 0\nouter loop\n";
            bytes.extend([0; 12]);
            for n in facet {
                let [a, b, c]: [f32; 3] = x[n].map(|c| c + shift);
                text += &format!("vertex {a} {b} {c}\n");
                [a, b, c].iter().for_each(|c| bytes.extend(c.to_le_bytes()));
            }
            text += "endloop\nendfacet\n";
            bytes.extend([0; 2]);
        }
        text += &format!("endsolid {solid}\n");
    }
    (text, bytes)
}

/// Cuts, overwrites, removes or doubles bytes.
fn damage_bytes(bytes: &mut Vec<u8>, (kind, place, value): (u8, usize, [u8; 4])) {
    if bytes.is_empty() {
        return;
    }
    let place = place % bytes.len();
    let end = (place + 4).min(bytes.len());
    match kind {
        0 => bytes.truncate(place),
        1 => bytes[place..end].copy_from_slice(&value[..end - place]),
        2 => drop(bytes.drain(place..end)),
        3 => drop(bytes.splice(place..place, value)),
        4 => bytes[place] = value[0],
        _ => {
            let count = bytes.len().min(84);
            bytes[count.saturating_sub(4)..count].copy_from_slice(&value[..count.min(4)]);
        }
    }
}

#[derive(Debug, Clone)]
enum Damage {
    Truncate(usize),
    Token(usize, String),
    DeleteLine(usize),
    RepeatLine(usize),
    SwapLines(usize, usize),
    Insert(usize, String),
}

fn token() -> impl Strategy<Value = String> {
    prop_oneof![
        Just("0"),
        Just("-1"),
        Just("1"),
        Just("3"),
        Just("18446744073709551615"),
        Just("99999999999999999999999"),
        Just("1e308"),
        Just("nan"),
        Just("inf"),
        Just(""),
        Just("$End"),
        Just("*ELEMENT, TYPE=C3D8"),
        Just("*"),
        Just("\""),
        Just("=,="),
        Just("ä\u{0}"),
        Just("4294967296"),
        Just("-9223372036854775808"),
        Just("<DataArray"),
        Just("solid"),
        Just("facet"),
        Just("endsolid"),
        Just("*ASSEMBLY"),
        Just("="),
    ]
    .prop_map(str::to_owned)
}

fn damage() -> impl Strategy<Value = Damage> {
    let n = 0usize..100_000;
    prop_oneof![
        n.clone().prop_map(Damage::Truncate),
        (n.clone(), token()).prop_map(|(i, t)| Damage::Token(i, t)),
        (n.clone(), token()).prop_map(|(i, t)| Damage::Token(i, t)),
        n.clone().prop_map(Damage::DeleteLine),
        n.clone().prop_map(Damage::RepeatLine),
        (n.clone(), n.clone()).prop_map(|(i, j)| Damage::SwapLines(i, j)),
        (n, token()).prop_map(|(i, t)| Damage::Insert(i, t)),
    ]
}

fn apply(text: &str, damage: &Damage) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if lines.is_empty() {
        return text.to_owned();
    }
    let count = lines.len();
    match damage {
        Damage::Truncate(i) => {
            let mut end = i % (text.len() + 1);
            while !text.is_char_boundary(end) {
                end -= 1;
            }
            return text[..end].to_owned();
        }
        Damage::Token(i, token) => {
            let line = &mut lines[i % count];
            let separator = if line.contains(',') { "," } else { " " };
            let mut tokens: Vec<&str> = line.split(separator).collect();
            let place = (i / count) % tokens.len();
            tokens[place] = token;
            *line = tokens.join(separator);
        }
        Damage::DeleteLine(i) => drop(lines.remove(i % count)),
        Damage::RepeatLine(i) => lines.insert(i % count, lines[i % count].clone()),
        Damage::SwapLines(i, j) => lines.swap(i % count, j % count),
        Damage::Insert(i, token) => lines.insert(i % count, token.clone()),
    }
    lines.join("\n")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn damaged_files_give_a_good_mesh_or_an_error(file in 0..FILES.len(), list in prop::collection::vec(damage(), 1..4)) {
        let (name, text) = FILES[file];
        let original = if name == "a.vtu" { vtu() } else { text.to_owned() };
        let damaged = list.iter().fold(original, |text, d| apply(&text, d));
        let error = if name == "a.vtu" {
            match read_vtu_from_bytes(name, damaged.as_bytes()) {
                Ok(data) => {
                    let cells = data.elements.iter().flatten().chain(data.facets.iter().flat_map(|facet| facet.iter()));
                    let mut nodes = cells.chain(data.lines.iter().flatten()).chain(&data.vertices);
                    prop_assert!(nodes.all(|&n| (n as usize) < data.points.len()));
                    return Ok(());
                }
                Err(error) => error,
            }
        } else {
            match read_mesh_from_str(name, &damaged) {
                Ok(mesh) => {
                    prop_assert_eq!(mesh.check_allowing_coincident(), Ok(()));
                    return Ok(());
                }
                Err(error) => error,
            }
        };
        prop_assert!(error.to_string().starts_with(name), "{}", error);
    }

    #[test]
    fn damaged_surfaces_give_a_good_surface_or_an_error(list in prop::collection::vec(damage(), 1..4)) {
        let damaged = list.iter().fold(stl().0, |text, d| apply(&text, d));
        match read_surface_from_bytes("a.stl", damaged.as_bytes()) {
            Ok(surface) => prop_assert_eq!(surface.check(), Ok(())),
            Err(error) => prop_assert!(error.to_string().starts_with("a.stl"), "{}", error),
        }
    }

    #[test]
    fn damaged_binary_surfaces_give_a_good_surface_or_an_error(
        binary: bool,
        list in prop::collection::vec((0_u8..6, 0_usize..1000, any::<[u8; 4]>()), 1..4),
    ) {
        let (text, bytes) = stl();
        let mut damaged = if binary { bytes } else { text.into_bytes() };
        list.into_iter().for_each(|d| damage_bytes(&mut damaged, d));
        match read_surface_from_bytes("a.stl", &damaged) {
            Ok(surface) => prop_assert_eq!(surface.check(), Ok(())),
            Err(error) => prop_assert!(error.to_string().starts_with("a.stl"), "{}", error),
        }
    }

    #[test]
    fn damaged_binary_meshes_give_a_good_mesh_or_an_error(
        file in 0_usize..BINARY.len(),
        list in prop::collection::vec((0_u8..6, 0_usize..100_000, any::<[u8; 4]>()), 1..4),
    ) {
        let mut damaged = BINARY[file].to_vec();
        list.into_iter().for_each(|d| damage_bytes(&mut damaged, d));
        let name = if file < 6 { "a.msh" } else { "a.vtu" };
        let contents = read_contents_from_bytes(name, &damaged, &mut |_| Err(std::io::ErrorKind::NotFound.into()));
        match contents.and_then(|contents| { contents.survey(None); contents.mesh(None) }) {
            Ok(mesh) => prop_assert_eq!(mesh.check_allowing_coincident(), Ok(())),
            Err(error) => prop_assert!(error.to_string().starts_with(name), "{}", error),
        }
    }

    #[test]
    fn any_bytes_are_no_reason_to_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), facets in 0_u32..4) {
        prop_assert!(read_surface_from_bytes("a.stl", &bytes).is_err());
        // with a length that fits
        let mut file = bytes;
        file.resize(84 + 50 * facets as usize, 7);
        file[80..84].copy_from_slice(&facets.to_le_bytes());
        if let Ok(surface) = read_surface_from_bytes("a.stl", &file) {
            prop_assert_eq!(surface.check(), Ok(()));
        }
    }

    #[test]
    fn any_text_is_no_reason_to_panic(text in "(\\$MeshFormat\n(2.2|4.1) 0 8\n\\$EndMeshFormat\n)?([$*a-zA-Z0-9 ,.=\"<>/\n-]|\\$Nodes|\\$Elements){0,200}") {
        for name in ["a.msh", "a.inp", "a.vtu"] {
            prop_assert!(read_mesh_from_str(name, &text).is_err());
        }
        prop_assert!(read_vtu_from_bytes("a.vtu", text.as_bytes()).is_err());
        let solid = format!("solid {text}");
        prop_assert!(read_surface_from_bytes("a.stl", solid.as_bytes()).is_err());
    }
}

/// Every prefix of the files: a truncated file is an error, or (Abaqus has no end mark) a mesh without the sets at its end.
#[test]
fn every_truncation() {
    for (name, text) in FILES {
        let original = if name == "a.vtu" { vtu() } else { text.to_owned() };
        for end in (0..original.trim_end().len()).filter(|&e| original.is_char_boundary(e)).step_by(7) {
            let cut = &original[..end];
            match name {
                "a.vtu" => assert!(read_vtu_from_bytes(name, cut.as_bytes()).is_err(), "{end}"),
                "a.msh" => assert!(read_mesh_from_str(name, cut).is_err(), "{end}"),
                _ => {
                    if let Ok(mesh) = read_mesh_from_str(name, cut) {
                        assert_eq!(mesh.check_allowing_coincident(), Ok(()));
                    }
                }
            }
        }
    }
}
