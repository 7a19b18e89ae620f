//! Gmsh MSH 2.2 and 4.1, text and binary of either byte order.
//!
//! | in the file | in the mesh |
//! |---|---|
//! | hexahedra (8, 20, 27 nodes), tetrahedra (4, 10), prisms (6, 15) | elements, their nodes in our order; those on edges stay where they are |
//! | physical volume | element set |
//! | physical surface | facet set, outward; node set if it lies between elements |
//! | physical curve or point | node set |
//! | triangles (3, 6 nodes), quadrilaterals (4, 8, 9) of a file without solid elements | a section: elements that are a layer on them; physical surfaces are element sets, curves facet sets |
//!
//! A group without a name is called `volume-7`, `surface-7`, `curve-7` or `point-7` after its number. Elements without a
//! physical group belong to no set. Points, curves and surfaces without a group are ignored; so are all sections but
//! `$PhysicalNames`, `$Entities`, `$Nodes`, `$Elements`. Partitioned meshes and other versions are refused.

mod binary;
mod binary_sections;
mod cells;
mod v2;
mod v4;

pub(crate) use cells::{face_type, theirs};

use std::collections::{HashMap, HashSet};
use std::path::Path;

use stoss_reference_element::FaceKind;

use crate::build::Builder;
use crate::include::Include;
use crate::lines::{Lines, unsupported};
use crate::place::FileLocation;
use crate::{Contents, MeshIoError};

/// Whether a text begins like an MSH file.
pub(crate) fn recognise(text: &str) -> bool {
    text.trim_start().starts_with("$MeshFormat")
}

const PARTITIONED: &str = "save it without partitions: Mesh.PartitionSaveTopology = 0, or gmsh -part 0";
const EMPTY: &str = "there is no $Elements section; mesh the volumes before saving";
const SAVE: &str = "save it as MSH 4.1 or 2.2: gmsh -3 -format msh41, or Mesh.MshFileVersion = 4.1";

/// What the sections of a file fill.
struct State {
    builder: Builder,
    /// Names of physical groups by dimension and number.
    names: HashMap<(usize, i64), String>,
    /// Physical groups of the entities (4.1) by dimension and number.
    groups: HashMap<(usize, i64), Vec<i64>>,
    /// Surfaces (by their corners) and node groups wait until all nodes are known: (dimension, group, nodes, place).
    lower: Vec<(usize, i64, Vec<u64>, FileLocation)>,
    /// Surface elements, with their groups: the mesh of a file without solid ones.
    surfaces: Vec<Surface>,
}

/// An element of a surface.
struct Surface {
    number: u64,
    kind: FaceKind,
    nodes: Vec<u64>,
    groups: Vec<i64>,
    place: FileLocation,
}

impl State {
    fn new(path: &Path, format: String) -> State {
        State {
            builder: Builder::new(Contents::new(path, format)),
            names: HashMap::new(),
            groups: HashMap::new(),
            lower: Vec::new(),
            surfaces: Vec::new(),
        }
    }

    fn group_name(&self, dimension: usize, group: i64) -> String {
        match self.names.get(&(dimension, group)) {
            Some(name) => name.clone(),
            None => format!("{}-{group}", ["point", "curve", "surface", "volume"][dimension.min(3)]),
        }
    }

    /// One element of the file, with as many nodes as its type has, and its physical groups.
    fn element(
        &mut self,
        number: u64,
        kind: u32,
        groups: &[i64],
        nodes: &[u64],
        place: FileLocation,
    ) -> Result<(), MeshIoError> {
        let mut keep = |dimension, nodes: &[u64]| {
            self.lower.extend(groups.iter().map(|&group| (dimension, group, nodes.to_vec(), place)));
        };
        match cells::role(kind) {
            cells::Role::Cell(cell) => {
                let (nodes, name) = (cells::ours(cell, nodes), cells::cell_name(cell));
                let element = self.builder.element(number, cell, &nodes, &name, place)?;
                for &group in groups {
                    let name = self.group_name(3, group);
                    self.builder.add_to_element_set(&name, element);
                }
            }
            cells::Role::Face(face) => {
                keep(2, &nodes[..face.corner_count()]);
                if self.builder.contents.elements.is_empty() {
                    let (nodes, groups) = (nodes.to_vec(), groups.to_vec());
                    self.surfaces.push(Surface { number, kind: face, nodes, groups, place });
                }
            }
            cells::Role::Nodes { dimension } => keep(dimension, nodes),
            cells::Role::Other => {
                let (what, remedy) = cells::other(kind);
                let volume = cells::is_volume(kind);
                let names: Vec<String> =
                    groups.iter().filter(|_| volume).map(|&group| self.group_name(3, group)).collect();
                self.builder.contents.count_other(&what, remedy, Some(&names), place);
            }
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Contents, MeshIoError> {
        let contents = &self.builder.contents;
        let is_plane = contents.elements.is_empty() && contents.others.is_empty() && !self.surfaces.is_empty();
        if is_plane {
            self.plane_elements()?;
        }
        self.refuse_ambiguous_names(if is_plane { 1 } else { 2 })?;
        for (dimension, group, nodes, place) in std::mem::take(&mut self.lower) {
            let name = self.group_name(dimension, group);
            if is_plane && dimension == 1 {
                self.builder.add_edge(&name, &nodes, place)?;
            } else if dimension == 2 {
                self.builder.add_face(&name, &nodes, place)?;
            } else {
                nodes.iter().try_for_each(|&n| self.builder.add_to_node_set(&name, n, place))?;
            }
        }
        Ok(self.builder.finish())
    }

    /// The surfaces of a file without solid elements are the elements.
    fn plane_elements(&mut self) -> Result<(), MeshIoError> {
        for Surface { number, kind, nodes, groups, place } in std::mem::take(&mut self.surfaces) {
            let name = format!("{kind} (type {})", face_type(kind));
            let element = self.builder.plane_element(number, kind, &nodes, &name, place)?;
            for group in groups {
                let name = self.group_name(2, group);
                self.builder.add_to_element_set(&name, element);
            }
        }
        self.lower.retain(|(dimension, ..)| *dimension < 2);
        Ok(())
    }

    /// A curve or a point must not share its name with a surface or a volume: which nodes the name means would be a guess.
    /// In a plane mesh the same holds of points and curves: groups below dimension `sides` are nodes.
    fn refuse_ambiguous_names(&self, sides: usize) -> Result<(), MeshIoError> {
        let above: HashSet<&String> =
            self.names.iter().filter(|((d, _), _)| *d >= sides).map(|(_, name)| name).collect();
        for &(dimension, group, _, place) in self.lower.iter().filter(|l| l.0 < sides) {
            let name = self.group_name(dimension, group);
            if above.contains(&name) {
                let remedy = "this name is also that of a group of more dimensions: rename one of the groups";
                return Err(self.builder.contents.error(place, name, remedy));
            }
        }
        Ok(())
    }
}

/// Reads a file of either version, text or binary.
pub(crate) fn read(path: &Path, bytes: &[u8], _: Include<'_>) -> Result<Contents, MeshIoError> {
    if binary::is_binary(bytes) {
        return binary_sections::read(path, bytes);
    }
    // Names of groups may be in any encoding; everything else is ASCII.
    read_text(path, &String::from_utf8_lossy(bytes))
}

fn read_text(path: &Path, text: &str) -> Result<Contents, MeshIoError> {
    let mut lines = Lines::new(path, text);
    if lines.expect("$MeshFormat")? != "$MeshFormat" {
        return Err(lines.error(
            text.trim_start().lines().next().unwrap_or_default(),
            "a Gmsh file begins with $MeshFormat; save it with Gmsh as MSH 4.1 or 2.2",
        ));
    }
    let format = lines.expect("version, file type and data size")?;
    let mut tokens = format.split_whitespace();
    let version = tokens.next().unwrap_or_default();
    let Some(new) = is_new(version) else {
        return Err(unsupported(path, lines.number, format!("MSH version {version}"), SAVE));
    };
    if tokens.next() != Some("0") {
        return Err(lines.error(format, "expected version, file type (0 for text, 1 for binary) and data size"));
    }
    end(&mut lines, "MeshFormat")?;

    let mut state = State::new(path, format!("Gmsh MSH {version}, text"));
    let (mut nodes, mut elements) = (false, false);
    while let Some(line) = lines.next() {
        let Some(section) = line.strip_prefix('$') else {
            return Err(lines.error(line, "expected the beginning of a section, such as $Nodes"));
        };
        match section {
            "PhysicalNames" => physical_names(&mut lines, &mut state)?,
            "Entities" if new => v4::entities(&mut lines, &mut state)?,
            "PartitionedEntities" => {
                return Err(unsupported(path, lines.number, "a partitioned mesh", PARTITIONED));
            }
            "Nodes" => {
                nodes = true;
                if new { v4::nodes(&mut lines, &mut state)? } else { v2::nodes(&mut lines, &mut state)? }
            }
            "Elements" => {
                if !nodes {
                    return Err(lines.error("$Elements", "$Nodes must come before $Elements"));
                }
                elements = true;
                if new { v4::elements(&mut lines, &mut state)? } else { v2::elements(&mut lines, &mut state)? }
            }
            _ => {
                let stop = format!("$End{section}");
                while lines.expect(&stop)? != stop {}
                continue;
            }
        }
        end(&mut lines, section)?;
    }
    if !elements {
        return Err(lines.error("end of file", EMPTY));
    }
    state.finish()
}

/// True for the version 4.1, false for 2.2; `None` for others.
fn is_new(version: &str) -> Option<bool> {
    match version {
        "2.2" | "2.1" | "2" => Some(false),
        "4.1" => Some(true),
        _ => None,
    }
}

/// The end of a section.
fn end(lines: &mut Lines, section: &str) -> Result<(), MeshIoError> {
    let stop = format!("$End{section}");
    let line = lines.expect(&stop)?;
    if line == stop {
        Ok(())
    } else {
        Err(lines.error(line, format!("expected {stop}; does the count at its beginning fit?")))
    }
}

fn physical_names(lines: &mut Lines, state: &mut State) -> Result<(), MeshIoError> {
    let line = lines.expect("the number of names")?;
    let count: usize = lines.parse(Some(line), "the number of names")?;
    for _ in 0..count {
        let line = lines.expect("dimension, number and name of a physical group")?;
        match physical_name(line) {
            Some((dimension, group, name)) => drop(state.names.insert((dimension, group), name)),
            None => return Err(lines.error(line, PHYSICAL_NAME)),
        }
    }
    Ok(())
}

const PHYSICAL_NAME: &str = "expected a dimension (0 to 3), a number and a name in quotes";

/// Dimension, number and name of a physical group.
fn physical_name(line: &str) -> Option<(usize, i64, String)> {
    let mut tokens = line.split_whitespace();
    let dimension = tokens.next()?.parse().ok()?;
    let group = tokens.next()?.parse().ok()?;
    let name = line.split_once('"')?.1.rsplit_once('"')?.0.trim();
    (!name.is_empty() && dimension <= 3).then(|| (dimension, group, name.to_owned()))
}
