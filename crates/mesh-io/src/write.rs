//! Writes meshes with their sets, for other programs and for the readers of this crate.
//!
//! | extension | nodes and elements | element sets | facet sets | node sets |
//! |---|---|---|---|---|
//! | `.msh` | Gmsh MSH 4.1, text | physical volumes | physical surfaces | physical points |
//! | `.inp` | Abaqus, a flat file, C3D8, C3D10 and so on | `*ELSET` | `*SURFACE, TYPE=ELEMENT` | `*NSET` |
//! | `.vtu` | VTK unstructured grid | array of the cells, 1 for a member | the same, on faces | array of the points |
//!
//! Elements of all kinds keep their order in the file.
//! Numbers have all their digits, so that what is read again is the same.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::Path;

use stoss_mesh::{Facet, Mesh};

use crate::atomic::{self, WriteError};
use crate::gmsh::{face_type, theirs};
use crate::{Field, MeshIoError, VtuFrame, write_vtu};

/// Writes a mesh in the format of the extension: `.msh`, `.inp` or `.vtu`. The file is written under another name first.
///
/// # Errors
/// [`MeshIoError::Output`] for another extension and for names of sets that the format cannot hold, [`MeshIoError::Io`].
pub fn write_mesh(path: impl AsRef<Path>, mesh: &Mesh) -> Result<(), MeshIoError> {
    let path = path.as_ref();
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "msh" => {
            check_names(mesh, &['"'], false)?;
            atomic::write(path, |out| write_msh(out, mesh).map_err(WriteError::Io))
        }
        "inp" => {
            check_names(mesh, &['"', ','], true)?;
            atomic::write(path, |out| write_inp(out, mesh).map_err(WriteError::Io))
        }
        "vtu" => write_grid(path, mesh),
        _ => Err(MeshIoError::Output {
            name: path.display().to_string(),
            problem: "the extension of a mesh file is .msh, .inp or .vtu".to_owned(),
        }),
    }
}

/// Names must not have these characters or line ends, or differ by case only where that is the same.
fn check_names(mesh: &Mesh, forbidden: &[char], ignores_case: bool) -> Result<(), MeshIoError> {
    let names: [Vec<&String>; 3] =
        [mesh.node_sets.keys().collect(), mesh.element_sets.keys().collect(), mesh.facet_sets.keys().collect()];
    for names in names {
        let mut seen = BTreeSet::new();
        for name in names {
            let is_bad = |c: char| c.is_control() || forbidden.contains(&c);
            let problem = if name.trim() != name || name.is_empty() || name.contains(is_bad) {
                "a set of this name cannot be written in this format: rename it"
            } else if ignores_case && !seen.insert(name.to_uppercase()) {
                "another set has this name but for upper and lower case: rename one of them"
            } else {
                continue;
            };
            return Err(MeshIoError::Output { name: name.clone(), problem: problem.to_owned() });
        }
    }
    Ok(())
}

/// Things by the combination of sets that they belong to.
struct Combinations {
    /// All combinations that occur, as numbers of sets.
    all: Vec<Vec<usize>>,
    /// Runs of things of one combination and one of Gmsh's types in their own order: combination, type, members.
    runs: Vec<(usize, u32, Vec<u32>)>,
}

impl Combinations {
    /// The combinations of `count` things of types; those in no set are kept or not.
    fn new<'m>(
        sets: impl Iterator<Item = &'m Vec<u32>>,
        count: usize,
        kind: impl Fn(usize) -> u32,
        keep_rest: bool,
    ) -> Combinations {
        let mut of = vec![Vec::new(); count];
        for (s, set) in sets.enumerate() {
            set.iter().for_each(|&i| of[i as usize].push(s));
        }
        let mut numbers: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
        let mut combinations = Combinations { all: Vec::new(), runs: Vec::new() };
        for (i, sets) in of.into_iter().enumerate().filter(|(_, sets)| keep_rest || !sets.is_empty()) {
            let number = *numbers.entry(sets.clone()).or_insert_with(|| {
                combinations.all.push(sets);
                combinations.all.len() - 1
            });
            let kind = kind(i);
            match combinations.runs.last_mut() {
                Some((last, of, run)) if (*last, *of) == (number, kind) => run.push(i as u32),
                _ => combinations.runs.push((number, kind, vec![i as u32])),
            }
        }
        combinations
    }
}

/// All facets of facet sets, and each set by their numbers.
fn facets(mesh: &Mesh) -> (Vec<Facet>, Vec<Vec<u32>>) {
    let all: Vec<Facet> = mesh.facet_sets.values().flatten().copied().collect::<BTreeSet<_>>().into_iter().collect();
    let number = |f: &Facet| all.binary_search(f).ok().map(|i| i as u32);
    let sets = mesh.facet_sets.values().map(|set| set.iter().filter_map(number).collect()).collect();
    (all, sets)
}

/// One entity for each combination of sets that occurs, so that every node, facet and element is in the file once.
fn write_msh(out: &mut impl Write, mesh: &Mesh) -> io::Result<()> {
    let (facets, facet_sets) = facets(mesh);
    // A name that means nodes and something else by itself is written for the nodes with an addition, for a reader would have to guess.
    let above = |name: &String| mesh.facet_sets.contains_key(name) || mesh.element_sets.contains_key(name);
    let node_names: Vec<String> =
        mesh.node_sets.keys().map(|name| if above(name) { format!("{name} (nodes)") } else { name.clone() }).collect();
    let names: [Vec<&String>; 3] =
        [node_names.iter().collect(), mesh.facet_sets.keys().collect(), mesh.element_sets.keys().collect()];
    let entities = [
        Combinations::new(mesh.node_sets.values(), mesh.nodes.len(), |_| 15, false),
        Combinations::new(facet_sets.iter(), facets.len(), |i| face_type(facets[i].nodes.kind()), false),
        Combinations::new(
            mesh.element_sets.values(),
            mesh.elements.len(),
            |e| mesh.elements.kind(e).table().gmsh,
            true,
        ),
    ];
    // Of the dimensions 0, 2 and 3; physical groups are numbered through.
    let dimensions = [0, 2, 3];
    let first = [1, 1 + names[0].len(), 1 + names[0].len() + names[1].len()];
    writeln!(
        out,
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n{}",
        names.iter().map(Vec::len).sum::<usize>()
    )?;
    for k in 0..3 {
        for (i, name) in names[k].iter().enumerate() {
            writeln!(out, "{} {} \"{name}\"", dimensions[k], first[k] + i)?;
        }
    }
    let counts = entities.each_ref().map(|e| e.all.len());
    writeln!(out, "$EndPhysicalNames\n$Entities\n{} 0 {} {}", counts[0], counts[1], counts[2])?;
    let (low, high) = mesh.bounding_box();
    for k in 0..3 {
        for (e, sets) in entities[k].all.iter().enumerate() {
            let [x, y, z] = low;
            write!(out, "{} {x} {y} {z} ", e + 1)?;
            if k > 0 {
                let [x, y, z] = high;
                write!(out, "{x} {y} {z} ")?;
            }
            write!(out, "{}", sets.len())?;
            sets.iter().try_for_each(|s| write!(out, " {}", first[k] + s))?;
            writeln!(out, "{}", if k > 0 { " 0" } else { "" })?;
        }
    }
    let nodes = mesh.nodes.len();
    writeln!(out, "$EndEntities\n$Nodes\n1 {nodes} 1 {nodes}\n3 1 0 {nodes}")?;
    (1..=nodes).try_for_each(|n| writeln!(out, "{n}"))?;
    mesh.nodes.iter().try_for_each(|[x, y, z]| writeln!(out, "{x} {y} {z}"))?;
    let blocks: usize = entities.iter().map(|e| e.runs.len()).sum();
    let elements: usize = entities.iter().flat_map(|e| &e.runs).map(|(.., run)| run.len()).sum();
    writeln!(out, "$EndNodes\n$Elements\n{blocks} {elements} 1 {elements}")?;
    let mut number = 0;
    for k in 0..3 {
        for (e, kind, members) in &entities[k].runs {
            writeln!(out, "{} {} {} {}", dimensions[k], e + 1, kind, members.len())?;
            for &i in members {
                number += 1;
                write!(out, "{number}")?;
                let nodes = match k {
                    0 => vec![i],
                    1 => facets[i as usize].nodes.to_vec(),
                    _ => theirs(mesh.elements.kind(i as usize), &mesh.elements[i as usize]),
                };
                nodes.iter().try_for_each(|n| write!(out, " {}", n + 1))?;
                writeln!(out)?;
            }
        }
    }
    writeln!(out, "$EndElements")
}

fn write_inp(out: &mut impl Write, mesh: &Mesh) -> io::Result<()> {
    writeln!(out, "*HEADING\nwritten by Stoss\n*NODE")?;
    for (n, [x, y, z]) in mesh.nodes.iter().enumerate() {
        writeln!(out, "{}, {x:?}, {y:?}, {z:?}", n + 1)?;
    }
    for block in mesh.elements.blocks() {
        let table = block.kind().table();
        writeln!(out, "*ELEMENT, TYPE={}", table.abaqus[0])?;
        let mut line = vec![0; 1 + table.nodes.len()];
        for (e, nodes) in block.iter().enumerate() {
            line[0] = block.first() as usize + e + 1;
            for (&n, &i) in nodes.iter().zip(table.from_abaqus) {
                line[1 + usize::from(i)] = n as usize + 1;
            }
            // Abaqus takes 16 numbers a line; a comma at the end says that there are more.
            for (part, numbers) in line.chunks(16).enumerate() {
                let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
                write!(out, "{}{}", if part > 0 { ",\n" } else { "" }, numbers.join(", "))?;
            }
            writeln!(out)?;
        }
    }
    for (keyword, sets) in [("NSET", &mesh.node_sets), ("ELSET", &mesh.element_sets)] {
        for (name, set) in sets {
            writeln!(out, "*{keyword}, {keyword}=\"{name}\"")?;
            for chunk in set.chunks(16) {
                let numbers: Vec<String> = chunk.iter().map(|i| (i + 1).to_string()).collect();
                writeln!(out, "{}", numbers.join(", "))?;
            }
        }
    }
    for (name, set) in &mesh.facet_sets {
        writeln!(out, "*SURFACE, TYPE=ELEMENT, NAME=\"{name}\"")?;
        set.iter().try_for_each(|f| writeln!(out, "{}, S{}", f.element + 1, f.local + 1))?;
    }
    Ok(())
}

fn write_grid(path: &Path, mesh: &Mesh) -> Result<(), MeshIoError> {
    let (facets, facet_sets) = facets(mesh);
    let count = mesh.elements.len() + facets.len();
    let mut cell_arrays: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let mut mark = |name, i: usize| cell_arrays.entry(name).or_insert_with(|| vec![0.0; count])[i] = 1.0;
    for (name, set) in &mesh.element_sets {
        set.iter().for_each(|&e| mark(name.as_str(), e as usize));
    }
    for (name, set) in mesh.facet_sets.keys().zip(&facet_sets) {
        set.iter().for_each(|&f| mark(name.as_str(), mesh.elements.len() + f as usize));
    }
    let point_arrays: Vec<(&str, Vec<f64>)> = mesh
        .node_sets
        .iter()
        .map(|(name, set)| {
            let mut values = vec![0.0; mesh.nodes.len()];
            set.iter().for_each(|&n| values[n as usize] = 1.0);
            (name.as_str(), values)
        })
        .collect();
    let facets: Vec<_> = facets.iter().map(|f| f.nodes).collect();
    let frame = VtuFrame {
        points: &mesh.nodes,
        elements: mesh.elements.blocks(),
        facets: &facets,
        point_data: point_arrays.iter().map(|(name, values)| Field { name, components: 1, values }).collect(),
        cell_data: cell_arrays.iter().map(|(name, values)| Field { name, components: 1, values }).collect(),
        ..VtuFrame::default()
    };
    write_vtu(path, &frame)
}
