//! The reader: a state that the keywords change.

use std::collections::BTreeMap;
use std::path::Path;

use stoss_mesh::{Mesh, Rotation};

use super::data::{Kind, find, number, range, reals};
use super::keyword::{Item, Keyword, fields, next};
use super::sets::{Labels, Level, Sets};
use crate::MeshIoError;
use crate::build::Builder;
use crate::lines::{Lines, syntax, unsupported};

/// Keywords that would change the mesh.
const REFUSED: [&str; 11] = [
    "INCLUDE",
    "NGEN",
    "NFILL",
    "NCOPY",
    "NMAP",
    "ELGEN",
    "ELCOPY",
    "SYSTEM",
    "PARAMETER",
    "IMPORT",
    "ELEMENT RESPONSE",
];

/// What the data lines that come next belong to.
enum Section {
    Skip,
    Node {
        set: Option<String>,
    },
    Element {
        set: Option<String>,
        pending: Vec<u64>,
        line: usize,
    },
    /// Data lines of elements of another type: counted; true within a continued line.
    OtherElement {
        kind: String,
        continued: bool,
    },
    Set {
        kind: Kind,
        name: String,
        generate: bool,
        known: bool,
    },
    Surface {
        name: String,
        nodes: bool,
    },
    Instance {
        lines: usize,
    },
}

/// A piece of a surface: elements and a face, 1 to 6, or `None` for all free faces.
struct Piece {
    labels: Labels,
    face: Option<usize>,
    line: usize,
}

pub(super) struct Reader<'a> {
    path: &'a Path,
    builder: Builder<'a>,
    node_sets: Sets,
    element_sets: Sets,
    /// By name in upper case: name as written, pieces.
    surfaces: BTreeMap<(String, Level), (String, Vec<Piece>)>,
    /// Node sets that get the nodes of elements.
    nodes_of_elements: Vec<(String, Labels)>,
    others: BTreeMap<String, (usize, usize)>,
    section: Section,
    parts: usize,
    instances: usize,
    in_assembly: bool,
    in_instance: bool,
    translation: [f64; 3],
    rotation: Option<Rotation>,
}

impl<'a> Reader<'a> {
    pub fn new(path: &'a Path) -> Reader<'a> {
        Reader {
            path,
            builder: Builder::new(path),
            node_sets: Sets::default(),
            element_sets: Sets::default(),
            surfaces: BTreeMap::new(),
            nodes_of_elements: Vec::new(),
            others: BTreeMap::new(),
            section: Section::Skip,
            parts: 0,
            instances: 0,
            in_assembly: false,
            in_instance: false,
            translation: [0.0; 3],
            rotation: None,
        }
    }

    pub fn read(mut self, text: &str) -> Result<Mesh, MeshIoError> {
        let result = self.read_lines(text);
        // Elements of another type are the cause of whatever else may be wrong with the names of such a file.
        self.refuse_others()?;
        result?;
        self.finish()
    }

    fn read_lines(&mut self, text: &str) -> Result<(), MeshIoError> {
        let mut lines = Lines::new(self.path, text);
        while let Some(item) = next(&mut lines) {
            match item {
                Item::Keyword(keyword) => {
                    self.close_section()?;
                    self.section = self.keyword(&lines, &keyword)?;
                }
                Item::Data(data) => self.data(&lines, data)?,
            }
        }
        self.close_section()
    }

    /// Names at the assembly outside of an instance are the assembly's own.
    fn level(&self) -> Level {
        if self.in_assembly && !self.in_instance { Level::Assembly } else { Level::Part }
    }

    fn close_section(&self) -> Result<(), MeshIoError> {
        match &self.section {
            Section::Element { pending, line, .. } if !pending.is_empty() => Err(syntax(
                self.path,
                *line,
                format_args!("element {}", pending[0]),
                format_args!("has {} nodes, but C3D8 needs 8", pending.len() - 1),
            )),
            _ => Ok(()),
        }
    }

    fn keyword(&mut self, lines: &Lines, keyword: &Keyword) -> Result<Section, MeshIoError> {
        let several = |what: &str| {
            Err(unsupported(
                self.path,
                keyword.line,
                format!("a second {what}"),
                "write one file for each body, with one part each",
            ))
        };
        match keyword.name.as_str() {
            "PART" => {
                self.parts += 1;
                if self.parts > 1 {
                    return several("*PART");
                }
            }
            "ASSEMBLY" => self.in_assembly = true,
            "END ASSEMBLY" => self.in_assembly = false,
            "INSTANCE" => {
                self.instances += 1;
                if self.instances > 1 {
                    return several("*INSTANCE");
                }
                self.in_instance = true;
                return Ok(Section::Instance { lines: 0 });
            }
            "END INSTANCE" => self.in_instance = false,
            "NODE" => return self.node_keyword(keyword),
            "ELEMENT" => return self.element_keyword(lines, keyword),
            "NSET" => return self.set_keyword(lines, keyword, Kind::Node, "NSET"),
            "ELSET" => return self.set_keyword(lines, keyword, Kind::Element, "ELSET"),
            "SURFACE" => return self.surface_keyword(lines, keyword),
            name if REFUSED.contains(&name) => {
                let remedy = "this keyword changes the mesh and is not read: write all nodes, elements and sets out into one file";
                return Err(unsupported(self.path, keyword.line, format!("*{name}"), remedy));
            }
            _ => {}
        }
        Ok(Section::Skip)
    }

    fn node_keyword(&mut self, keyword: &Keyword) -> Result<Section, MeshIoError> {
        if self.level() == Level::Assembly {
            return Ok(Section::Skip); // reference points: no element can use them
        }
        if let Some(system) = keyword.value("SYSTEM").filter(|s| !s.eq_ignore_ascii_case("R")) {
            let remedy = "only Cartesian coordinates (SYSTEM=R) are read";
            return Err(unsupported(self.path, keyword.line, format!("*NODE, SYSTEM={system}"), remedy));
        }
        self.refuse_input(keyword)?;
        let set = keyword.value("NSET").map(str::to_owned);
        if let Some(name) = &set {
            self.node_sets.open(name, Level::Part, keyword.line, false);
        }
        Ok(Section::Node { set })
    }

    fn element_keyword(&mut self, lines: &Lines, keyword: &Keyword) -> Result<Section, MeshIoError> {
        self.refuse_input(keyword)?;
        let kind = keyword.require(lines, "TYPE")?.to_uppercase();
        let set = keyword.value("ELSET").map(str::to_owned);
        if let Some(name) = &set {
            self.element_sets.open(name, Level::Part, keyword.line, false);
        }
        if kind != "C3D8" {
            self.others.entry(kind.clone()).or_insert((0, keyword.line));
            // To the end of the file, so that all of them are counted: what refers to their sets finds them.
            return Ok(Section::OtherElement { kind, continued: false });
        }
        Ok(Section::Element { set, pending: Vec::with_capacity(9), line: keyword.line })
    }

    fn refuse_input(&self, keyword: &Keyword) -> Result<(), MeshIoError> {
        match keyword.value("INPUT") {
            None => Ok(()),
            Some(file) => Err(unsupported(
                self.path,
                keyword.line,
                format!("*{}, INPUT={file}", keyword.name),
                "data in other files are not read: put them into this file",
            )),
        }
    }

    fn set_keyword(
        &mut self,
        lines: &Lines,
        keyword: &Keyword,
        kind: Kind,
        parameter: &str,
    ) -> Result<Section, MeshIoError> {
        let level = self.level();
        let name = keyword.require(lines, parameter)?.to_owned();
        let internal = keyword.flag("INTERNAL");
        let sets = if kind == Kind::Node { &mut self.node_sets } else { &mut self.element_sets };
        sets.open(&name, level, keyword.line, internal);
        if kind == Kind::Node
            && let Some(elements) = keyword.value("ELSET")
        {
            let labels = find(self.path, &self.element_sets, elements, level, keyword.line, Kind::Element)?.clone();
            self.nodes_of_elements.push((name.clone(), labels));
        }
        // numbers at the assembly mean the assembly's own nodes unless an instance is named
        let known = level == Level::Part || keyword.flag("INSTANCE");
        Ok(Section::Set { kind, name, generate: keyword.flag("GENERATE"), known })
    }

    fn surface_keyword(&mut self, lines: &Lines, keyword: &Keyword) -> Result<Section, MeshIoError> {
        let name = keyword.require(lines, "NAME")?.to_owned();
        let refuse = |what: String| {
            Err(unsupported(
                self.path,
                keyword.line,
                what,
                "only TYPE=ELEMENT and TYPE=NODE are read: list elements and faces",
            ))
        };
        if keyword.flag("COMBINE") || keyword.flag("CROP") {
            return refuse("*SURFACE, COMBINE or CROP".to_owned());
        }
        let nodes = match keyword.value("TYPE").unwrap_or("ELEMENT").to_uppercase().as_str() {
            "ELEMENT" => false,
            "NODE" => true,
            other => return refuse(format!("*SURFACE, TYPE={other}")),
        };
        let level = self.level();
        if nodes {
            self.node_sets.open(&name, level, keyword.line, false);
        } else {
            self.surfaces.entry((name.to_uppercase(), level)).or_insert_with(|| (name.clone(), Vec::new()));
        }
        Ok(Section::Surface { name, nodes })
    }

    fn data(&mut self, lines: &Lines, data: &str) -> Result<(), MeshIoError> {
        let level = self.level();
        match &mut self.section {
            Section::Skip => Ok(()),
            Section::Node { set } => {
                let mut fields = fields(data);
                let number = lines.parse(fields.next(), "a node number")?;
                let mut x = [0.0; 3];
                for c in &mut x {
                    *c = lines.parse_real(fields.next(), "a coordinate (give x, y and z)")?;
                }
                self.builder.node(number, x, lines.number)?;
                if let Some(name) = set {
                    let labels = &mut self.node_sets.open(name, Level::Part, lines.number, false).labels;
                    labels.numbers.entry(number).or_insert(lines.number);
                }
                Ok(())
            }
            Section::Element { set, pending, line } => {
                for field in fields(data.strip_suffix(',').unwrap_or(data)) {
                    if pending.is_empty() {
                        *line = lines.number;
                    }
                    if pending.len() == 9 {
                        return Err(lines.error(field, format_args!("element {} has more than 8 nodes", pending[0])));
                    }
                    pending.push(lines.parse(Some(field), "an element or node number")?);
                }
                if let [number, nodes @ ..] = pending.as_slice()
                    && let Ok(nodes) = <[u64; 8]>::try_from(nodes)
                {
                    self.builder.hexahedron(*number, nodes, *line)?;
                    if let Some(name) = set {
                        let labels = &mut self.element_sets.open(name, Level::Part, *line, false).labels;
                        labels.numbers.entry(*number).or_insert(*line);
                    }
                    pending.clear();
                }
                Ok(())
            }
            Section::OtherElement { kind, continued } => {
                if !*continued && let Some(count) = self.others.get_mut(kind) {
                    count.0 += 1;
                }
                *continued = data.ends_with(',');
                Ok(())
            }
            Section::Set { kind, name, generate, known } => {
                let sets = if *kind == Kind::Node { &mut self.node_sets } else { &mut self.element_sets };
                let mut labels = Labels::default();
                if *generate {
                    let range = range(lines, data)?;
                    if *known {
                        labels.ranges.insert(range, lines.number);
                    }
                } else {
                    for field in fields(data).filter(|f| !f.is_empty()) {
                        match number(field) {
                            Some((number, named)) if *known || named => {
                                labels.numbers.entry(number).or_insert(lines.number);
                            }
                            Some(_) => {}
                            None => labels.extend(find(self.path, sets, field, level, lines.number, *kind)?),
                        }
                    }
                }
                sets.open(name, level, lines.number, false).labels.extend(&labels);
                Ok(())
            }
            Section::Surface { name, nodes } => {
                let mut fields = fields(data);
                let target = fields.next().unwrap_or_default();
                let kind = if *nodes { Kind::Node } else { Kind::Element };
                let sets = if *nodes { &self.node_sets } else { &self.element_sets };
                let labels = match number(target) {
                    Some((number, _)) => Labels { numbers: [(number, lines.number)].into(), ..Labels::default() },
                    None => find(self.path, sets, target, level, lines.number, kind)?.clone(),
                };
                if *nodes {
                    self.node_sets.open(name, level, lines.number, false).labels.extend(&labels);
                    return Ok(());
                }
                let face = match fields.next().unwrap_or_default() {
                    "" => None,
                    face => {
                        match ["S1", "S2", "S3", "S4", "S5", "S6"].iter().position(|s| face.eq_ignore_ascii_case(s)) {
                            Some(local) => Some(local),
                            None => return Err(lines.error(face, "a face of C3D8 is one of S1 to S6")),
                        }
                    }
                };
                if let Some((_, pieces)) = self.surfaces.get_mut(&(name.to_uppercase(), level)) {
                    pieces.push(Piece { labels, face, line: lines.number });
                }
                Ok(())
            }
            Section::Instance { lines: count } => {
                *count += 1;
                match *count {
                    1 => self.translation = reals(lines, data)?,
                    2 => {
                        let [ax, ay, az, bx, by, bz, degrees] = reals(lines, data)?;
                        let axis = [bx - ax, by - ay, bz - az];
                        self.rotation = Some(Rotation { axis, degrees, about: [ax, ay, az] });
                    }
                    _ => return Err(lines.error(data, "an instance has at most a translation and a rotation")),
                }
                Ok(())
            }
        }
    }

    fn finish(mut self) -> Result<Mesh, MeshIoError> {
        self.place()?;
        let path = self.path;
        let conflict = |a: &super::sets::Set, b: &super::sets::Set| {
            let remedy = format!("the set of this name in line {} has other content: rename one of them", a.line);
            syntax(path, b.line, &b.name, remedy)
        };
        for set in self.node_sets.result().map_err(|(a, b)| conflict(a, b))? {
            for (&number, &line) in &set.labels.numbers {
                self.builder.add_to_node_set(&set.name, number, line)?;
            }
            if !set.labels.ranges.is_empty() {
                let inside: Vec<u64> = self.builder.node_numbers().filter(|&n| set.labels.in_ranges(n)).collect();
                if inside.is_empty() {
                    return Err(syntax(path, set.line, &set.name, "the ranges of this set have no node: correct them"));
                }
                for number in inside {
                    self.builder.add_to_node_set(&set.name, number, set.line)?;
                }
            }
        }
        for set in self.element_sets.result().map_err(|(a, b)| conflict(a, b))? {
            let members = elements(&self.builder, &set.labels)?;
            if members.is_empty() && !set.labels.ranges.is_empty() {
                return Err(syntax(path, set.line, &set.name, "the ranges of this set have no element: correct them"));
            }
            for element in members {
                self.builder.add_to_element_set(&set.name, element);
            }
        }
        for (name, labels) in &self.nodes_of_elements {
            let name = self.node_sets.find(name, Level::Assembly).map_or(name.as_str(), |set| &set.name);
            for element in elements(&self.builder, labels)? {
                for node in self.builder.nodes_of_element(element) {
                    self.builder.add_to_node_set(name, node, 0)?; // the element's nodes exist
                }
            }
        }
        let mut seen: BTreeMap<&String, Level> = BTreeMap::new();
        for ((upper, level), (name, pieces)) in &self.surfaces {
            if seen.insert(upper, *level).is_some() {
                let line = pieces.first().map_or(0, |p| p.line);
                return Err(syntax(
                    path,
                    line,
                    name,
                    "part and assembly both have a surface of this name: rename one of them",
                ));
            }
            for piece in pieces {
                for element in elements(&self.builder, &piece.labels)? {
                    match piece.face {
                        Some(local) => self.builder.add_to_facet_set(name, element, local),
                        None => self.builder.add_free_facets(name, element),
                    }
                }
            }
        }
        self.builder.finish()
    }

    fn refuse_others(&self) -> Result<(), MeshIoError> {
        let Some((kind, &(_, line))) = self.others.iter().min_by_key(|(_, (_, line))| *line) else {
            return Ok(());
        };
        let list: Vec<String> =
            self.others.iter().map(|(kind, (count, _))| format!("{count} elements {kind}")).collect();
        let advice = if ["C3D8R", "C3D8I", "C3D8H", "C3D8RH", "C3D8IH", "C3D8S", "C3D8T"].contains(&kind.as_str()) {
            "the element of Stoss is the fully integrated C3D8: change the type to C3D8 if that is what you want"
        } else if kind.starts_with("C3D20") || kind.starts_with("C3D27") {
            "use linear elements (in the mesh module: Element Type, Geometric Order: Linear), type C3D8"
        } else if kind.starts_with("C3D") {
            "mesh the part with hexahedra (in the mesh module: Mesh Controls, Element Shape: Hex), type C3D8"
        } else {
            "remove these elements (from Gmsh: save as .msh instead); loads, masses and constraints belong into the scene"
        };
        Err(unsupported(
            self.path,
            line,
            list.join(", "),
            format!("Stoss computes with 8-node hexahedra (C3D8); {advice}"),
        ))
    }

    /// Applies the placement of the instance: translation, then rotation.
    fn place(&mut self) -> Result<(), MeshIoError> {
        let t = self.translation;
        let (r, p) = match &self.rotation {
            None => ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]),
            Some(rotation) => {
                let wrap = |source| MeshIoError::Mesh { path: self.path.to_owned(), source };
                (rotation.matrix().map_err(wrap)?, rotation.about)
            }
        };
        if self.rotation.is_none() && t == [0.0; 3] {
            return Ok(());
        }
        let rotate = self.rotation.is_some();
        self.builder.map_nodes(|x| {
            let y: [f64; 3] = std::array::from_fn(|i| x[i] + t[i]);
            if !rotate {
                return y;
            }
            std::array::from_fn(|i| p[i] + (0..3).map(|j| r[i][j] * (y[j] - p[j])).sum::<f64>())
        });
        Ok(())
    }
}

/// Indices of the elements that labels mean.
fn elements(builder: &Builder, labels: &Labels) -> Result<Vec<u32>, MeshIoError> {
    let mut indices = Vec::new();
    for (&number, &line) in &labels.numbers {
        indices.push(builder.element_number(number, line)?);
    }
    if !labels.ranges.is_empty() {
        indices.extend(builder.element_numbers().filter(|&(n, _)| labels.in_ranges(n)).map(|(_, index)| index));
    }
    Ok(indices)
}
