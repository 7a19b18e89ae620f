//! Every kind of cell in every format.
//!
//! Orders of nodes are proved by places: a file in the order of its own program has every node at the natural coordinates that this program's
//! manual gives it, bent by a map that no permutation leaves as it is. `tests/data/cell-*.msh` were saved by Gmsh 4.15.2: a twelfth of a ring
//! (radii 1 and 2, height 0.5) of one layer, with the groups `ring`, `top` and `outer`. `tests/data/cells.vtu` was written by VTK 9.7.2: one
//! of each of its cells at its own parametric coordinates, moved by 3 along x each, and all its faces, marked by the array `side`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use stoss_mesh::{Elements, Facet, Mesh};
use stoss_mesh_io::{Contents, FilePosition, MeshIoError, read_contents_from_bytes, read_mesh, write_mesh};
use stoss_reference_element::{CellKind, FaceKind, Family};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn contents(name: &str, bytes: &[u8]) -> Result<Contents, MeshIoError> {
    read_contents_from_bytes(name, bytes, &mut |_| Err(std::io::ErrorKind::NotFound.into()))
}

fn read(name: &str, text: &str) -> Result<Mesh, MeshIoError> {
    contents(name, text.as_bytes())?.mesh(None)
}

/// A smooth map without symmetries that keeps volumes positive and moves nodes on edges off the middle.
fn bend([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x + 0.2 * y + 0.04 * y * z + 0.03 * x * x, 0.9 * y - 0.1 * z + 0.05 * x * z, 1.1 * z + 0.3 * x + 0.04 * x * y * z]
}

/// A mesh of one cell at its natural coordinates, bent.
fn single(kind: CellKind) -> Mesh {
    let table = kind.table();
    let nodes = table.nodes.iter().map(|&x| bend(x)).collect();
    Mesh::new(nodes, Elements::of_kind(kind, (0..table.nodes.len() as u32).collect())).unwrap()
}

/// One of each cell, tets twice, so that kinds alternate; with sets.
fn zoo() -> Mesh {
    let mut mesh = Mesh::default();
    for (i, kind) in CellKind::ALL.into_iter().chain([CellKind::Tet4, CellKind::Tet4]).enumerate() {
        let one = single(kind);
        let first = mesh.nodes.len() as u32;
        mesh.nodes.extend(one.nodes.iter().map(|&[x, y, z]| [x + 4.0 * i as f64, y, z]));
        mesh.elements.extend(&one.elements, |n| n + first);
    }
    let count = mesh.elements.len() as u32;
    for local in 0..4 {
        mesh.facet_sets.insert(format!("side {local}"), (0..count).map(|e| mesh.facet(e, local)).collect());
    }
    mesh.facet_sets.insert("boundary of all".into(), mesh.boundary_facets());
    mesh.element_sets.insert("odd".into(), (1..count).step_by(2).collect());
    mesh.element_sets.insert("every".into(), (0..count).collect());
    mesh.node_sets.insert("third".into(), (0..mesh.nodes.len() as u32).step_by(3).collect());
    assert_eq!(mesh.check(), Ok(()));
    mesh
}

/// A beam of a hexahedron and two wedges with common facets, linear or quadratic.
fn beam(hexahedron: CellKind, wedge: CellKind) -> Mesh {
    let mut places: Vec<[f64; 3]> = Vec::new();
    let mut mesh = Mesh::default();
    let corner = |[a, b, c, d, e, f]: [[f64; 2]; 6]| {
        let at = |[x, y]: [f64; 2], z: f64| [x, y, z];
        [at(a, 0.0), at(b, 0.0), at(c, 0.0), at(d, 1.0), at(e, 1.0), at(f, 1.0)]
    };
    let square = [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]];
    let wedges = [[0, 1, 2], [0, 2, 3]].map(|t| {
        let t = t.map(|i: usize| square[i]);
        (wedge, corner([t[0], t[1], t[2], t[0], t[1], t[2]]).to_vec())
    });
    let cube = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    for (kind, corners) in std::iter::once((hexahedron, cube)).chain(wedges) {
        let linear = kind.table().linear.table();
        let nodes: Vec<u32> = (kind.table().nodes.iter())
            .map(|&xi| {
                let n = (linear.shape)(xi);
                let x = std::array::from_fn(|i| corners.iter().zip(n).map(|(x, n)| n * x[i]).sum());
                let found = places.iter().position(|&y| y == x);
                found.unwrap_or_else(|| {
                    places.push(x);
                    places.len() - 1
                }) as u32
            })
            .collect();
        mesh.elements.push(kind, &nodes);
    }
    mesh.nodes = places.into_iter().map(bend).collect();
    mesh.facet_sets.insert("all".into(), mesh.boundary_facets());
    assert_eq!((mesh.check(), mesh.pieces()), (Ok(()), 1));
    mesh
}

#[test]
fn every_cell_is_written_and_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut meshes: Vec<Mesh> = CellKind::ALL.into_iter().map(single).collect();
    for mesh in &mut meshes {
        mesh.facet_sets.insert("all faces".into(), mesh.boundary_facets());
        mesh.facet_sets.insert("last".into(), vec![mesh.boundary_facets().pop().unwrap()]);
    }
    meshes.push(zoo());
    meshes.push(beam(CellKind::Hex8, CellKind::Wedge6));
    meshes.push(beam(CellKind::Hex20, CellKind::Wedge15));
    for mesh in meshes {
        for name in ["a.msh", "a.inp", "a.vtu"] {
            let path = folder.path().join(name);
            write_mesh(&path, &mesh).unwrap();
            let again = read_mesh(&path).unwrap();
            assert!(again == mesh, "{name} {:?}", mesh.elements.kinds());
        }
    }
}

/// Facets between two quadratic elements keep their nodes.
#[test]
fn facets_between_quadratic_elements() {
    let folder = tempfile::tempdir().unwrap();
    let mut mesh = beam(CellKind::Hex20, CellKind::Wedge15);
    mesh.facet_sets.insert("Mid".into(), vec![mesh.facet(0, 3), mesh.facet(1, 4)]);
    for name in ["a.msh", "a.vtu"] {
        let path = folder.path().join(name);
        write_mesh(&path, &mesh).unwrap();
        let again = stoss_mesh_io::read_contents(&path).unwrap();
        assert!(again.mesh_with_inner_facets(None).unwrap() == mesh, "{name}");
        let computed = again.mesh(None).unwrap();
        let mut nodes: Vec<u32> = mesh.facet_sets["Mid"].iter().flat_map(|f| f.nodes.to_vec()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        assert_eq!((computed.node_sets["Mid"].as_slice(), nodes.len()), (&nodes[..], 13));
    }
}

/// Natural coordinates of the nodes of a program's cell, from its corners, edges as pairs of corners, and centres of groups of corners.
fn places(family: Family, edges: &[[usize; 2]], centres: &[&[usize]]) -> Vec<[f64; 3]> {
    let mut nodes: Vec<[f64; 3]> = match family {
        Family::Hexahedron => [[-1, -1], [1, -1], [1, 1], [-1, 1]]
            .iter()
            .cycle()
            .take(8)
            .enumerate()
            .map(|(i, &[x, y])| [f64::from(x), f64::from(y), if i < 4 { -1.0 } else { 1.0 }])
            .collect(),
        Family::Tetrahedron => vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        Family::Wedge => [[0, 0], [1, 0], [0, 1]]
            .iter()
            .cycle()
            .take(6)
            .enumerate()
            .map(|(i, &[x, y])| [f64::from(x), f64::from(y), if i < 3 { -1.0 } else { 1.0 }])
            .collect(),
    };
    let corners = nodes.clone();
    let mean = |of: &[usize]| std::array::from_fn(|i| of.iter().map(|&n| corners[n][i]).sum::<f64>() / of.len() as f64);
    nodes.extend(edges.iter().map(|edge| mean(edge)));
    nodes.extend(centres.iter().map(|of| mean(of)));
    nodes
}

/// Gmsh's cells: type and nodes (reference manual, "Node ordering").
fn gmsh_cells() -> Vec<(CellKind, u32, Vec<[f64; 3]>)> {
    let hex = [[0, 1], [0, 3], [0, 4], [1, 2], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 7], [5, 6], [6, 7]];
    let centres: [&[usize]; 7] = [
        &[0, 3, 2, 1],
        &[0, 1, 5, 4],
        &[0, 4, 7, 3],
        &[1, 2, 6, 5],
        &[2, 3, 7, 6],
        &[4, 5, 6, 7],
        &[0, 1, 2, 3, 4, 5, 6, 7],
    ];
    let tet = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];
    let prism = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 4], [2, 5], [3, 4], [3, 5], [4, 5]];
    vec![
        (CellKind::Hex8, 5, places(Family::Hexahedron, &[], &[])),
        (CellKind::Hex20, 17, places(Family::Hexahedron, &hex, &[])),
        (CellKind::Hex27, 12, places(Family::Hexahedron, &hex, &centres)),
        (CellKind::Tet4, 4, places(Family::Tetrahedron, &[], &[])),
        (CellKind::Tet10, 11, places(Family::Tetrahedron, &tet, &[])),
        (CellKind::Wedge6, 6, places(Family::Wedge, &[], &[])),
        (CellKind::Wedge15, 18, places(Family::Wedge, &prism, &[])),
    ]
}

/// Files with one cell: MSH 2.2 and 4.1, each as text and binary.
fn gmsh_files(kind: u32, nodes: &[[f64; 3]]) -> [Vec<u8>; 4] {
    let n = nodes.len();
    let number = |i: usize| 100 + 7 * i;
    let numbers: String = (0..n).map(|i| format!(" {}", number(i))).collect();
    let coordinates = |i: usize| nodes[i].map(|c| c.to_string()).join(" ");
    let lines = |line: &dyn Fn(usize) -> String| (0..n).map(|i| line(i) + "\n").collect::<String>();
    let old = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{n}\n{}$EndNodes\n$Elements\n1\n3 {kind} 2 8 1{numbers}\n$EndElements\n",
        lines(&|i| format!("{} {}", number(i), coordinates(i)))
    );
    let new = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 8 0\n$EndEntities\n\
         $Nodes\n1 {n} 1 999\n3 1 0 {n}\n{}{}$EndNodes\n$Elements\n1 1 3 3\n3 1 {kind} 1\n3{numbers}\n$EndElements\n",
        lines(&|i| number(i).to_string()),
        lines(&coordinates)
    );
    let head = |version: &str| {
        [format!("$MeshFormat\n{version} 1 8\n").as_bytes(), &1_i32.to_le_bytes(), b"\n$EndMeshFormat\n"].concat()
    };
    let int = |i: usize| (i as i32).to_le_bytes();
    let size = |i: usize| (i as u64).to_le_bytes();
    let doubles = |x: &[f64]| x.iter().flat_map(|c| c.to_le_bytes()).collect::<Vec<u8>>();
    let mut old_binary = [&head("2.2"), format!("$Nodes\n{n}\n").as_bytes()].concat();
    for i in 0..n {
        old_binary.extend([&int(number(i))[..], &doubles(&nodes[i])].concat());
    }
    old_binary.extend(b"\n$EndNodes\n$Elements\n1\n");
    old_binary.extend([kind as usize, 1, 2, 3, 8, 1].into_iter().chain((0..n).map(number)).flat_map(int));
    old_binary.extend(b"\n$EndElements\n");
    let mut new_binary = [&head("4.1"), &b"$Entities\n"[..]].concat();
    new_binary.extend([0, 0, 0, 1].into_iter().flat_map(size));
    new_binary.extend([&int(1)[..], &doubles(&[0.0; 6]), &size(1), &int(8), &size(0)].concat());
    new_binary.extend(b"\n$EndEntities\n$Nodes\n");
    new_binary.extend([1, n, 1, 999].into_iter().flat_map(size));
    new_binary.extend([3, 1, 0].into_iter().flat_map(int).chain(size(n)));
    new_binary.extend((0..n).map(number).flat_map(size).chain(doubles(nodes.as_flattened())));
    new_binary.extend(b"\n$EndNodes\n$Elements\n");
    new_binary.extend([1, 1, 3, 3].into_iter().flat_map(size));
    new_binary.extend([3, 1, kind as usize].into_iter().flat_map(int));
    new_binary.extend([1, 3].into_iter().chain((0..n).map(number)).flat_map(size));
    new_binary.extend(b"\n$EndElements\n");
    [old.into_bytes(), new.into_bytes(), old_binary, new_binary]
}

#[test]
fn nodes_of_gmsh_stand_where_they_belong() {
    for (kind, number, places) in gmsh_cells() {
        let nodes: Vec<[f64; 3]> = places.into_iter().map(bend).collect();
        for (f, file) in gmsh_files(number, &nodes).into_iter().enumerate() {
            let mesh = contents("part.msh", &file).unwrap().mesh(None).unwrap();
            in_place(&mesh, kind, &format!("Gmsh, file {f}"));
            assert_eq!(mesh.elements_of("volume-8").unwrap(), [0]);
        }
    }
}

/// The only element is of this kind, and its nodes are at their natural coordinates, bent.
fn in_place(mesh: &Mesh, kind: CellKind, what: &str) {
    assert_eq!((mesh.elements.len(), mesh.elements.kind(0)), (1, kind), "{what}");
    for (i, (x, &xi)) in mesh.element_coordinates(0).iter().zip(kind.table().nodes).enumerate() {
        for (a, b) in x.iter().zip(bend(xi)) {
            assert!((a - b).abs() < 1e-14, "{what}: node {i} of {kind} is at {x:?}, not at {:?}", bend(xi));
        }
    }
}

/// Abaqus' cells: type, nodes, corners of the faces S1, S2 and so on (Abaqus' manual, "Solid element library").
fn abaqus_cells() -> Vec<(CellKind, &'static str, Vec<[f64; 3]>, Vec<Vec<usize>>)> {
    let hex = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];
    let hex_faces = vec![
        vec![0, 1, 2, 3],
        vec![4, 7, 6, 5],
        vec![0, 4, 5, 1],
        vec![1, 5, 6, 2],
        vec![2, 6, 7, 3],
        vec![3, 7, 4, 0],
    ];
    let tet = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
    let tet_faces = vec![vec![0, 1, 2], vec![0, 3, 1], vec![1, 3, 2], vec![2, 3, 0]];
    let wedge = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];
    let wedge_faces = vec![vec![0, 1, 2], vec![3, 5, 4], vec![0, 3, 4, 1], vec![1, 4, 5, 2], vec![2, 5, 3, 0]];
    let all: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7];
    // The node in the middle comes before those of the faces.
    let centres: Vec<&[usize]> = std::iter::once(all).chain(hex_faces.iter().map(Vec::as_slice)).collect();
    vec![
        (CellKind::Hex8, "C3D8", places(Family::Hexahedron, &[], &[]), hex_faces.clone()),
        (CellKind::Hex20, "C3D20", places(Family::Hexahedron, &hex, &[]), hex_faces.clone()),
        (CellKind::Hex27, "C3D27", places(Family::Hexahedron, &hex, &centres), hex_faces.clone()),
        (CellKind::Tet4, "C3D4", places(Family::Tetrahedron, &[], &[]), tet_faces.clone()),
        (CellKind::Tet10, "C3D10", places(Family::Tetrahedron, &tet, &[]), tet_faces),
        (CellKind::Wedge6, "C3D6", places(Family::Wedge, &[], &[]), wedge_faces.clone()),
        (CellKind::Wedge15, "C3D15", places(Family::Wedge, &wedge, &[]), wedge_faces),
    ]
}

/// One element of Abaqus; at most 16 numbers a line.
fn deck(name: &str, nodes: &[[f64; 3]]) -> String {
    let mut text = String::from("*NODE\n");
    for (i, [x, y, z]) in nodes.iter().enumerate() {
        text += &format!("{}, {x}, {y}, {z}\n", 100 + 7 * i);
    }
    let numbers: Vec<String> =
        std::iter::once(5).chain((0..nodes.len()).map(|i| 100 + 7 * i)).map(|n| n.to_string()).collect();
    let lines: Vec<String> = numbers.chunks(16).map(|line| line.join(", ")).collect();
    text + &format!("*ELEMENT, TYPE={name}, ELSET=Body\n{}\n", lines.join(",\n"))
}

#[test]
fn nodes_and_faces_of_abaqus_stand_where_they_belong() {
    for (kind, name, places, faces) in abaqus_cells() {
        let nodes: Vec<[f64; 3]> = places.iter().copied().map(bend).collect();
        let text = deck(name, &nodes);
        in_place(&read("part.inp", &text).unwrap(), kind, name);
        for (s, face) in faces.iter().enumerate() {
            let mesh = read("part.inp", &format!("{text}*SURFACE, NAME=side\nbody, S{}\n", s + 1)).unwrap();
            let facets = mesh.facets_of("side").unwrap();
            assert_eq!((facets.len(), usize::from(facets[0].local)), (1, s));
            let mut found: Vec<[f64; 3]> = facets[0].nodes.corners().iter().map(|&n| mesh.nodes[n as usize]).collect();
            let mut expected: Vec<[f64; 3]> = face.iter().map(|&n| nodes[n]).collect();
            for list in [&mut found, &mut expected] {
                list.sort_by(|a, b| a.partial_cmp(b).unwrap());
            }
            assert_eq!(found, expected, "S{} of {name}", s + 1);
            assert!(outward(&mesh, &facets[0]), "S{} of {name}", s + 1);
        }
        let error = read("part.inp", &format!("{text}*SURFACE, NAME=side\nbody, S{}\n", faces.len() + 1)).unwrap_err();
        let expected = format!("element 5 is a {kind}, whose faces are S1 to S{}", faces.len());
        assert!(error.to_string().contains(&expected), "{error}");
    }
}

/// Does the normal in the middle of a facet point away from the middle of its element?
fn outward(mesh: &Mesh, facet: &Facet) -> bool {
    let kind = facet.nodes.kind();
    let xi = if kind.corner_count() == 3 { [1.0 / 3.0; 2] } else { [0.0; 2] };
    let (n, dn) = (kind.shape(xi), kind.shape_gradient(xi));
    let x: Vec<[f64; 3]> = facet.nodes.iter().map(|&n| mesh.nodes[n as usize]).collect();
    let place: [f64; 3] = std::array::from_fn(|i| x.iter().zip(n).map(|(x, n)| n * x[i]).sum());
    let [a, b]: [[f64; 3]; 2] =
        std::array::from_fn(|k| std::array::from_fn(|i| x.iter().zip(dn).map(|(x, dn)| dn[k] * x[i]).sum()));
    let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let element = mesh.element_coordinates(facet.element);
    let middle = element.at(element.kind().table().family.centre());
    (0..3).map(|i| normal[i] * (place[i] - middle[i])).sum::<f64>() > 0.0
}

/// What VTK 9.7.2 wrote: nodes at VTK's own parametric coordinates, faces as VTK has them.
#[test]
fn cells_of_vtk_stand_where_they_belong() {
    let contents = stoss_mesh_io::read_contents(data("cells.vtu")).unwrap();
    let mesh = contents.mesh(None).unwrap();
    let order = [
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Hex27,
        CellKind::Tet4,
        CellKind::Tet10,
        CellKind::Wedge6,
        CellKind::Wedge15,
    ];
    assert!(mesh.elements.cells().map(|(kind, _)| kind).eq(order));
    for (e, kind) in order.into_iter().enumerate() {
        for (x, xi) in mesh.element_coordinates(e as u32).iter().zip(kind.table().nodes) {
            let parametric = match kind.table().family {
                Family::Hexahedron => xi.map(|c| 0.5 * (1.0 + c)),
                Family::Tetrahedron => *xi,
                Family::Wedge => [xi[0], xi[1], 0.5 * (1.0 + xi[2])],
            };
            let shifted = [x[0] - 3.0 * e as f64, x[1], x[2]];
            for (a, b) in shifted.into_iter().zip(parametric) {
                assert!((a - b).abs() < 1e-6, "{kind}: {shifted:?}, not {parametric:?}");
            }
        }
        assert_eq!(mesh.elements_of(&format!("cell={e}")).unwrap(), [e as u32]);
    }
    // All faces are facets, outward, with the nodes that VTK gives them.
    let side = mesh.facets_of("side").unwrap();
    assert_eq!(side, mesh.boundary_facets());
    assert!(side.iter().all(|facet| outward(&mesh, facet)));
    let mut kinds: BTreeMap<FaceKind, usize> = BTreeMap::new();
    side.iter().for_each(|facet| *kinds.entry(facet.nodes.kind()).or_default() += 1);
    assert_eq!(
        kinds.into_iter().collect::<Vec<_>>(),
        [(FaceKind::Tri3, 6), (FaceKind::Quad4, 9), (FaceKind::Tri6, 6), (FaceKind::Quad8, 9), (FaceKind::Quad9, 6)]
    );
    let cells = contents.survey(None).cells;
    assert!(
        cells.iter().any(|c| c.name == "8-node quadrilaterals of facet sets (type 23)" && c.count == 9),
        "{cells:?}"
    );
}

/// What Gmsh 4.15.2 wrote, text and binary of both versions: volumes, and nodes of curved edges on the arc.
#[test]
fn rings_of_gmsh() {
    let radius = |x: &[f64; 3]| x[0].hypot(x[1]);
    for (name, kind, elements) in [
        ("cell-hex8.msh", CellKind::Hex8, 1),
        ("cell-hex20.msh", CellKind::Hex20, 1),
        ("cell-hex27.msh", CellKind::Hex27, 1),
        ("cell-tet4.msh", CellKind::Tet4, 6),
        ("cell-tet10.msh", CellKind::Tet10, 6),
        ("cell-tet10-binary.msh", CellKind::Tet10, 6),
        ("cell-wedge6.msh", CellKind::Wedge6, 2),
        ("cell-wedge15.msh", CellKind::Wedge15, 2),
        ("cell-wedge15-binary.msh", CellKind::Wedge15, 2),
    ] {
        let mesh = read_mesh(data(name)).unwrap();
        assert_eq!((mesh.elements.kinds(), mesh.elements.len()), (vec![kind], elements), "{name}");
        assert_eq!(mesh.elements_of("ring").unwrap().len(), elements);
        // of a linear mesh the chords, of a quadratic one nearly the arcs
        let (exact, near) = if kind.is_quadratic() { (std::f64::consts::PI / 8.0, 1e-4) } else { (0.375, 1e-9) };
        assert!((mesh.quality().volume - exact).abs() < near, "{name}: {}", mesh.quality().volume);
        for (set, on) in [
            ("outer", &(|x: &[f64; 3]| (radius(x) - 2.0).abs() < 1e-9) as &dyn Fn(&[f64; 3]) -> bool),
            ("top", &|x: &[f64; 3]| (x[2] - 0.5).abs() < 1e-9),
        ] {
            let facets = mesh.facets_of(set).unwrap();
            assert!(!facets.is_empty());
            for facet in facets {
                assert!(facet.nodes.iter().all(|&n| on(&mesh.nodes[n as usize])), "{name} {set}");
                assert!(outward(&mesh, &facet), "{name} {set}");
            }
        }
        for e in 0..elements as u32 {
            let x = mesh.element_coordinates(e);
            for &[a, b, m] in kind.table().edges {
                let [a, b, m] = [a, b, m].map(|n| &x[usize::from(n)]);
                let length = (0..3).map(|i| (b[i] - a[i]).powi(2)).sum::<f64>().sqrt();
                let offset = (0..3).map(|i| (m[i] - 0.5 * (a[i] + b[i])).powi(2)).sum::<f64>().sqrt();
                assert!(offset < 0.1 * length, "{name}: {m:?} is not between {a:?} and {b:?}");
                let is_arc = a[2] == b[2] && (radius(a) - radius(b)).abs() < 1e-12;
                assert!(!is_arc || ((radius(m) - radius(a)).abs() < 1e-9 && offset > 0.01), "{name}: {m:?}");
            }
        }
    }
}

#[test]
fn variants_of_abaqus_are_told() {
    let solid = |name: &str| {
        let (_, _, places, _) = abaqus_cells()
            .into_iter()
            .filter(|(_, plain, ..)| name.starts_with(plain))
            .max_by_key(|c| c.1.len())
            .unwrap();
        contents("part.inp", deck(name, &places).as_bytes()).unwrap()
    };
    for (name, note) in [
        (
            "C3D20R",
            "C3D20R is read as hex20; use integration = \"reduced\" for its rule (1 elements, first in line 23)",
        ),
        ("C3D10H", "C3D10H is read as tet10; use volumetric = \"mixed\" for its independent pressure"),
        ("C3D10M", "C3D10M is read as tet10; its modified shape functions"),
        ("C3D8RH", "use volumetric = \"mixed\""),
    ] {
        let contents = solid(name);
        assert!(contents.notes().iter().any(|n| n.contains(note)), "{:?}", contents.notes());
        assert_eq!(contents.survey(None).notes, contents.notes());
        assert_eq!(contents.survey(None).cells[0].name, name);
    }
    assert!(solid("C3D20").notes().is_empty());
}

/// Faces of cells of several kinds in one set; a face that one of them does not have is an error.
#[test]
fn surfaces_over_mixed_cells() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("zoo.inp");
    write_mesh(&path, &zoo()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let mesh =
        read("part.inp", &format!("{text}*SURFACE, NAME=fourth\nevery, S4\n*SURFACE, NAME=skin\nevery,\n")).unwrap();
    let fourth = mesh.facets_of("fourth").unwrap();
    assert_eq!(fourth.len(), 9);
    assert!(fourth.iter().all(|facet| facet.local == 3 && outward(&mesh, facet)));
    assert_eq!(mesh.facets_of("skin").unwrap(), mesh.boundary_facets());
    let error = read("part.inp", &format!("{text}*SURFACE, NAME=fifth\nevery, S5\n")).unwrap_err().to_string();
    assert!(error.contains("\"S5\": element 4 is a tet4, whose faces are S1 to S4"), "{error}");
}

#[test]
fn errors_of_cells() {
    // Gmsh: an inverted tetrahedron, an edge's node near a corner, a triangle that is no facet
    let tet10 = gmsh_cells().swap_remove(4);
    let file = |nodes: &[[f64; 3]]| String::from_utf8(gmsh_files(11, nodes)[0].clone()).unwrap();
    let mut nodes = tet10.2.clone();
    nodes.swap(0, 1);
    let error = read("part.msh", &file(&nodes)).unwrap_err();
    assert!(
        matches!(
            &error,
            MeshIoError::InvertedElement { at: FilePosition::Line(19), element: 3, kind: CellKind::Tet10, .. }
        ),
        "{error}"
    );
    nodes = tet10.2.clone();
    nodes[4] = [0.1, 0.0, 0.0];
    let error = read("part.msh", &file(&nodes)).unwrap_err().to_string();
    assert!(error.contains("its corners are in order: move the nodes on its edges"), "{error}");
    let text = file(&tet10.2).replace("$Elements\n1\n", "$Elements\n2\n9 2 2 4 1 100 107 149\n");
    let error = read("part.msh", &text).unwrap_err().to_string();
    assert!(
        error.contains("nodes [100, 107, 149]\": this triangle of group \"surface-4\" is no facet of an element"),
        "{error}"
    );
    let linear = gmsh_cells().swap_remove(3);
    let mut swapped = linear.2.clone();
    swapped.swap(1, 2);
    let error =
        read("part.msh", &String::from_utf8(gmsh_files(4, &swapped)[0].clone()).unwrap()).unwrap_err().to_string();
    assert!(error.contains("counter-clockwise seen from the fourth"), "{error}");
    let error = contents("part.msh", &gmsh_files(4, &swapped)[2]).unwrap().mesh(None).unwrap_err().to_string();
    assert!(error.starts_with("part.msh: byte ") && error.contains("(tet4)"), "{error}");

    // Abaqus: numbers of nodes that do not fit the type
    let (_, name, places, _) = abaqus_cells().swap_remove(4);
    let error = read("part.inp", &deck("C3D15", &places)).unwrap_err().to_string();
    assert!(error.contains("has 10 nodes, but C3D15 needs 15"), "{error}");
    let error = read("part.inp", &deck("C3D4", &places)).unwrap_err().to_string();
    assert!(error.contains("more than 4 nodes, and C3D4 has 4"), "{error}");
    let twice = deck(name, &places).replace("163\n", "100\n");
    let error = read("part.inp", &twice).unwrap_err().to_string();
    assert!(error.contains("uses this node twice: collapsed elements are not supported, a tet10 has 10"), "{error}");

    // a linear element beside a quadratic one
    let mut mesh = beam(CellKind::Hex20, CellKind::Wedge15);
    let wedge: Vec<u32> = mesh.elements[2][..6].to_vec();
    let quadratic = std::mem::take(&mut mesh.elements);
    mesh.elements.push(CellKind::Hex20, &quadratic[0]);
    mesh.elements.push(CellKind::Wedge6, &wedge);
    mesh.facet_sets.clear();
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.inp", "a.msh", "a.vtu"] {
        let path = folder.path().join(name);
        write_mesh(&path, &mesh).unwrap();
        let error = read_mesh(&path).unwrap_err();
        assert!(matches!(&error, MeshIoError::NonMatchingFacet { kinds, .. } if kinds == "hex20, wedge6"), "{error}");
        assert!(error.to_string().contains("use linear elements on both sides, or quadratic ones on both"), "{error}");
    }
}

/// A quadrilateral on triangles is reported with the numbers of the file; the parts alone can be read.
#[test]
fn hexahedra_beside_tetrahedra_are_refused() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n\
                9 0.5 0.3 2\n$EndNodes\n$Elements\n3\n11 5 2 1 1 1 2 3 4 5 6 7 8\n12 4 2 2 1 5 6 7 9\n13 4 2 2 1 5 7 8 9\n$EndElements\n";
    let error = read("part.msh", text).unwrap_err();
    assert!(
        matches!(&error, MeshIoError::NonConformingFacet { elements: [11, 12], kinds, count: 1, at: FilePosition::Line(19), .. } if kinds == "hex8, tet4"),
        "{error}"
    );
    let told = error.to_string();
    assert!(
        told.starts_with("part.msh:19: elements 11 and 12 (hex8, tet4) lie on each other at the facet of the first around [0.5, 0.5, 1.0]"),
        "{told}"
    );
    assert!(told.contains("join these by [[tie]]"), "{told}");
    let contents = contents("part.msh", text.as_bytes()).unwrap();
    assert!(contents.mesh(Some("volume-1")).is_ok() && contents.mesh(Some("volume-2")).is_ok());
}

/// A face of a part that is not taken must not be mistaken for a triangle of its other corners.
#[test]
fn faces_of_other_parts_are_left_out() {
    // a tetrahedron on three corners of the top of a cube, and a group with the whole top
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n\
                9 0.5 0.3 2\n$EndNodes\n$Elements\n3\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 4 2 2 1 5 6 7 9\n3 3 2 3 1 5 6 7 8\n$EndElements\n";
    let contents = contents("part.msh", text.as_bytes()).unwrap();
    let facets = |group| contents.mesh(Some(group)).unwrap().facet_sets.get("surface-3").map(Vec::len);
    assert_eq!((facets("volume-1"), facets("volume-2")), (Some(1), None));
}
