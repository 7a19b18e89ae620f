//! Gmsh MSH 2.2 and 4.1, text.
//!
//! | in the file | in the mesh |
//! |---|---|
//! | physical volume | element set |
//! | physical surface | facet set, outward; node set if it lies between elements |
//! | physical curve or point | node set |
//!
//! A group without a name is called `volume-7`, `surface-7`, `curve-7` or `point-7` after its number. Elements without a
//! physical group belong to no set. Points, curves and surfaces without a group are ignored; so are all sections but
//! `$PhysicalNames`, `$Entities`, `$Nodes`, `$Elements`. Partitioned meshes, binary files and older versions are refused.

mod cells;
mod v2;
mod v4;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use stoss_mesh::Mesh;

use crate::MeshIoError;
use crate::build::Builder;
use crate::lines::{Lines, syntax, unsupported};
use cells::OtherCells;

/// Does a text begin like an MSH file?
pub(crate) fn recognise(text: &str) -> bool {
    text.trim_start().starts_with("$MeshFormat")
}

/// What the sections of a file fill.
struct State<'a> {
    builder: Builder<'a>,
    /// Names of physical groups by dimension and number.
    names: HashMap<(usize, i64), String>,
    /// Physical groups of the entities (4.1) by dimension and number.
    groups: HashMap<(usize, i64), Vec<i64>>,
    others: OtherCells,
    /// Surfaces and node groups wait until all nodes are known: (dimension, group, nodes, line).
    lower: Vec<(usize, i64, Vec<u64>, usize)>,
}

impl State<'_> {
    fn group_name(&self, dimension: usize, group: i64) -> String {
        match self.names.get(&(dimension, group)) {
            Some(name) => name.clone(),
            None => format!("{}-{group}", ["point", "curve", "surface", "volume"][dimension.min(3)]),
        }
    }

    /// One element of the file with its physical groups.
    fn element(
        &mut self,
        lines: &Lines,
        number: u64,
        kind: u32,
        groups: &[i64],
        nodes: &[u64],
    ) -> Result<(), MeshIoError> {
        match (kind, nodes) {
            (cells::HEXAHEDRON, nodes) => {
                let nodes = nodes.try_into().map_err(|_| lines.error(number, "a hexahedron needs 8 nodes"))?;
                let element = self.builder.hexahedron(number, nodes, lines.number)?;
                for &group in groups {
                    let name = self.group_name(3, group);
                    self.builder.add_to_element_set(&name, element);
                }
            }
            (cells::QUADRILATERAL | cells::LINE | cells::POINT, nodes) => {
                let dimension = match kind {
                    cells::QUADRILATERAL => 2,
                    cells::LINE => 1,
                    _ => 0,
                };
                for &group in groups {
                    self.lower.push((dimension, group, nodes.to_vec(), lines.number));
                }
            }
            _ => self.others.count(kind, lines.number),
        }
        Ok(())
    }

    fn finish(mut self, path: &Path) -> Result<Mesh, MeshIoError> {
        self.others.refuse(path)?;
        self.refuse_ambiguous_names(path)?;
        for (dimension, group, nodes, line) in std::mem::take(&mut self.lower) {
            let name = self.group_name(dimension, group);
            match <[u64; 4]>::try_from(nodes.as_slice()) {
                Ok(quad) if dimension == 2 => self.builder.add_quad(&name, quad, line)?,
                _ => nodes.iter().try_for_each(|&n| self.builder.add_to_node_set(&name, n, line))?,
            }
        }
        self.builder.finish()
    }
}

impl State<'_> {
    /// A curve or a point must not share its name with a surface or a volume: which nodes the name means would be a guess.
    fn refuse_ambiguous_names(&self, path: &Path) -> Result<(), MeshIoError> {
        let above: HashSet<&String> = self.names.iter().filter(|((d, _), _)| *d >= 2).map(|(_, name)| name).collect();
        for &(dimension, group, _, line) in self.lower.iter().filter(|l| l.0 < 2) {
            let name = self.group_name(dimension, group);
            if above.contains(&name) {
                return Err(syntax(
                    path,
                    line,
                    name,
                    "this name is also that of a surface or a volume: rename one of the groups",
                ));
            }
        }
        Ok(())
    }
}

/// Reads a file of either version.
pub(crate) fn read(path: &Path, text: &str) -> Result<Mesh, MeshIoError> {
    let mut lines = Lines::new(path, text);
    if lines.expect("$MeshFormat")? != "$MeshFormat" {
        return Err(lines.error(
            text.trim_start().lines().next().unwrap_or_default(),
            "a Gmsh file begins with $MeshFormat; save it with Gmsh as MSH 4.1 or 2.2, text",
        ));
    }
    let format = lines.expect("version, file type and data size")?;
    let mut tokens = format.split_whitespace();
    let version = tokens.next().unwrap_or_default();
    let kind = tokens.next();
    let save = "save it as MSH 4.1 or 2.2: gmsh -3 -format msh41, or Mesh.MshFileVersion = 4.1";
    let new = match version {
        "2.2" | "2.1" | "2" => false,
        "4.1" => true,
        _ => return Err(unsupported(path, lines.number, format!("MSH version {version}"), save)),
    };
    match kind {
        Some("0") => {}
        Some("1") => {
            return Err(unsupported(
                path,
                lines.number,
                "a binary file",
                "save it as text: Mesh.Binary = 0, or gmsh without -bin",
            ));
        }
        _ => return Err(lines.error(format, "expected version, file type (0 for text) and data size")),
    }
    end(&mut lines, "MeshFormat")?;

    let mut state = State {
        builder: Builder::new(path),
        names: HashMap::new(),
        groups: HashMap::new(),
        others: OtherCells::default(),
        lower: Vec::new(),
    };
    let (mut nodes, mut elements) = (false, false);
    while let Some(line) = lines.next() {
        let Some(section) = line.strip_prefix('$') else {
            return Err(lines.error(line, "expected the beginning of a section, such as $Nodes"));
        };
        match section {
            "PhysicalNames" => physical_names(&mut lines, &mut state)?,
            "Entities" if new => v4::entities(&mut lines, &mut state)?,
            "PartitionedEntities" => {
                let remedy = "save it without partitions: Mesh.PartitionSaveTopology = 0, or gmsh -part 0";
                return Err(unsupported(path, lines.number, "a partitioned mesh", remedy));
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
        return Err(lines.error("end of file", "there is no $Elements section; mesh the volumes before saving"));
    }
    state.finish(path)
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
        let mut tokens = line.split_whitespace();
        let dimension: usize = lines.parse(tokens.next(), "a dimension")?;
        let group: i64 = lines.parse(tokens.next(), "the number of a physical group")?;
        let name = line.split_once('"').and_then(|(_, rest)| rest.rsplit_once('"')).map(|(name, _)| name.trim());
        match name {
            Some(name) if !name.is_empty() && dimension <= 3 => {
                state.names.insert((dimension, group), name.to_owned());
            }
            _ => return Err(lines.error(line, "expected a dimension (0 to 3), a number and a name in quotes")),
        }
    }
    Ok(())
}
