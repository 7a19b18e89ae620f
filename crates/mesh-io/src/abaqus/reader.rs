//! The reader: a state that the keywords change.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::block::Block;
use super::keyword::{Item, Keyword, next};
use super::model::{DeckPart, Instance, Kind, Names};
use super::section::KeywordBlock;
use super::sets::Labels;
use super::types::SolidType;
use crate::include::Include;
use crate::lines::{Lines, unsupported};
use crate::place::FileLocation;
use crate::{Contents, FilePosition, MeshIoError};

/// Keywords that would change the mesh.
const REFUSED: [&str; 10] =
    ["NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "PARAMETER", "IMPORT", "ELEMENT RESPONSE"];
const REFUSED_REMEDY: &str =
    "this keyword changes the mesh and is not read: write all nodes, elements and sets out into one file";
/// Files within files, and files altogether: no file of a user has so many, but a circle by other names would.
const INCLUDE_DEPTH: usize = 32;
const INCLUDES: usize = 1000;
/// Nodes, elements and numbers in sets of all instances: copies of a part cost memory that the file does not show.
const COPIES: usize = 100_000_000;

/// What a name belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Scope {
    /// The part with this index; 0 is what stands outside of parts.
    Part(usize),
    Instance(usize),
    Assembly,
}

/// A type of elements that is not read.
pub(super) struct OtherType {
    pub name: String,
    pub count: usize,
    pub first: FileLocation,
}

pub(super) struct Reader<'a> {
    include: Include<'a>,
    /// Files that are being read, one within the other.
    open: Vec<PathBuf>,
    pub contents: Contents,
    /// The first is what stands outside of parts.
    pub parts: Vec<DeckPart>,
    pub instances: Vec<Instance>,
    pub assembly: Names,
    pub others: Vec<OtherType>,
    /// Types of elements that are read: how many, and the first.
    pub taken: BTreeMap<SolidType, (usize, FileLocation)>,
    scope: Scope,
    pub section: KeywordBlock,
    copies: usize,
    /// Keywords that are not those of the mesh, if they are wanted.
    blocks: Option<Vec<Block>>,
    /// Whether data lines belong to the last of them.
    is_kept: bool,
}

impl<'a> Reader<'a> {
    pub fn new(path: &Path, include: Include<'a>) -> Reader<'a> {
        let mut contents = Contents::new(path, "Abaqus input");
        contents.ignore_case = true;
        Reader {
            include,
            open: Vec::new(),
            contents,
            parts: vec![DeckPart::default()],
            instances: Vec::new(),
            assembly: Names::default(),
            others: Vec::new(),
            taken: BTreeMap::new(),
            scope: Scope::Part(0),
            section: KeywordBlock::Skip,
            copies: 0,
            blocks: None,
            is_kept: false,
        }
    }

    /// Keeps what is not read, with its data lines.
    pub fn keeping_blocks(mut self) -> Reader<'a> {
        self.blocks = Some(Vec::new());
        self
    }

    /// The mesh, and the keywords that are kept.
    pub fn read(mut self, path: &Path, text: &str) -> Result<(Contents, Vec<Block>), MeshIoError> {
        self.open.push(path.to_owned());
        let result = self.read_text(0, path, text).and_then(|()| self.section.close(&self.contents));
        self.count_others();
        if let Err(error) = result {
            // Elements of another type are the cause of whatever else may be wrong with the names of such a file.
            self.contents.refuse_others(None)?;
            return Err(error);
        }
        let blocks = self.blocks.take().unwrap_or_default();
        Ok((self.flatten()?, blocks))
    }

    fn read_text(&mut self, file: u32, path: &Path, text: &str) -> Result<(), MeshIoError> {
        let mut lines = Lines::new(path, text);
        lines.file = file;
        while let Some(item) = next(&mut lines) {
            match item {
                // The section goes on in the other file: it may hold nothing but data.
                Item::Keyword(keyword) if keyword.name == "INCLUDE" => {
                    let input = keyword.require(&lines, "INPUT")?;
                    self.include_file(&lines, &keyword, input)?;
                }
                Item::Keyword(keyword) => {
                    self.section.close(&self.contents)?;
                    self.section = self.keyword(&lines, &keyword)?;
                    let skips = matches!(self.section, KeywordBlock::Skip);
                    let mut reads_input = !skips;
                    // Numbers at the assembly are its own nodes, reference points.
                    let is_of_points =
                        self.at_assembly() && matches!(&self.section, KeywordBlock::Set { kind: Kind::Node, .. });
                    let is_other = is_of_points || matches!(self.section, KeywordBlock::OtherElement { .. });
                    self.is_kept = skips || is_other;
                    if let Some(blocks) = self.blocks.as_mut().filter(|_| skips || is_other) {
                        let block = Block { keyword: keyword.clone(), rows: Vec::new() };
                        reads_input = is_other || block.takes_input();
                        blocks.push(block);
                    }
                    if let Some(input) = keyword.value("INPUT").filter(|_| reads_input) {
                        self.include_file(&lines, &keyword, input)?;
                    }
                }
                Item::Data(data) => {
                    if let Some(block) =
                        self.blocks.as_mut().filter(|_| self.is_kept).and_then(|blocks| blocks.last_mut())
                    {
                        block.rows.push((data.to_owned(), lines.place()));
                    }
                    self.data(&lines, data)?;
                }
            }
        }
        Ok(())
    }

    fn include_file(&mut self, lines: &Lines, keyword: &Keyword, input: &str) -> Result<(), MeshIoError> {
        let error = |remedy: &str| {
            let value = format!("*{}, INPUT={input}", keyword.name);
            Err(unsupported(lines.path, keyword.place.at as usize, value, remedy))
        };
        let path = lines.path.parent().unwrap_or(Path::new("")).join(input);
        if self.open.contains(&path) {
            return error("this file is being read already: files must not include one another in a cycle");
        }
        if self.open.len() >= INCLUDE_DEPTH || self.contents.files.len() >= INCLUDES {
            return error("too many files within files: put some of them together");
        }
        let bytes = match (self.include)(&path) {
            Ok(bytes) => bytes,
            Err(problem) => {
                return error(&format!("{problem}; the name is relative to the folder of the file that includes it"));
            }
        };
        let file = self.contents.files.len() as u32;
        self.contents.files.push(path.clone());
        self.open.push(path.clone());
        self.read_text(file, &path, &String::from_utf8_lossy(&bytes))?;
        self.open.pop();
        Ok(())
    }

    /// Sets and surfaces of the present scope.
    pub fn names(&mut self) -> &mut Names {
        match self.scope {
            Scope::Part(p) => &mut self.parts[p].names,
            Scope::Instance(i) => &mut self.instances[i].part.names,
            Scope::Assembly => &mut self.assembly,
        }
    }

    /// The part that nodes and elements go into; none at the assembly, whose nodes are reference points.
    pub fn part(&mut self) -> Option<&mut DeckPart> {
        match self.scope {
            Scope::Part(p) => Some(&mut self.parts[p]),
            Scope::Instance(i) => Some(&mut self.instances[i].part),
            Scope::Assembly => None,
        }
    }

    pub fn at_assembly(&self) -> bool {
        self.scope == Scope::Assembly
    }

    pub fn instance(&self, name: &str) -> Option<usize> {
        self.instances.iter().position(|i| i.name.eq_ignore_ascii_case(name))
    }

    /// The labels of a set that a name means in the present scope, at a place.
    pub fn find(&self, lines: &Lines, name: &str, kind: Kind) -> Result<Labels, MeshIoError> {
        let found = match self.scope {
            Scope::Part(p) => self.parts[p].names.sets(kind).find(name).map(|s| s.labels.clone()),
            Scope::Instance(i) => self.instances[i].part.names.sets(kind).find(name).map(|s| s.labels.clone()),
            Scope::Assembly => self.find_at_assembly(name, kind),
        };
        found.ok_or_else(|| MeshIoError::Unknown {
            path: lines.path.to_owned(),
            at: FilePosition::Line(lines.number),
            kind: if kind == Kind::Node { "node set (or number)" } else { "element set (or number)" },
            number: name.to_owned(),
        })
    }

    /// An own set of the assembly, `instance.set`, or a set of the only instance.
    fn find_at_assembly(&self, name: &str, kind: Kind) -> Option<Labels> {
        if let Some(set) = self.assembly.sets(kind).find(name) {
            return Some(set.labels.clone());
        }
        let of = |i: usize, name: &str| {
            self.instances[i].part.names.sets(kind).find(name).map(|set| set.labels.of_instance(i))
        };
        let dotted = name.match_indices('.').find_map(|(dot, _)| of(self.instance(&name[..dot])?, &name[dot + 1..]));
        dotted.or_else(|| if self.instances.len() == 1 { of(0, name) } else { None })
    }

    fn keyword(&mut self, lines: &Lines, keyword: &Keyword) -> Result<KeywordBlock, MeshIoError> {
        match keyword.name.as_str() {
            "PART" => {
                let name = keyword.require(lines, "NAME")?;
                if self.parts[1..].iter().any(|p| p.name.eq_ignore_ascii_case(name)) {
                    return Err(self.contents.error(
                        keyword.place,
                        name,
                        "there is a part of this name: rename one of them",
                    ));
                }
                self.parts.push(DeckPart { name: name.to_owned(), ..DeckPart::default() });
                self.scope = Scope::Part(self.parts.len() - 1);
            }
            "END PART" => self.scope = Scope::Part(0),
            // What comes after an assembly (steps) means it too.
            "ASSEMBLY" => self.scope = Scope::Assembly,
            "INSTANCE" => {
                self.open_instance(lines, keyword)?;
                return Ok(KeywordBlock::Instance { lines: 0 });
            }
            "END INSTANCE" => self.scope = Scope::Assembly,
            "NODE" => return self.node_keyword(keyword),
            "ELEMENT" => return self.element_keyword(lines, keyword),
            "NSET" => return self.set_keyword(lines, keyword, Kind::Node, "NSET"),
            "ELSET" => return self.set_keyword(lines, keyword, Kind::Element, "ELSET"),
            "SURFACE" => return self.surface_keyword(lines, keyword),
            name if REFUSED.contains(&name) => {
                self.contents.count_other(&format!("*{name}"), REFUSED_REMEDY, None, keyword.place);
            }
            _ => {}
        }
        Ok(KeywordBlock::Skip)
    }

    fn open_instance(&mut self, lines: &Lines, keyword: &Keyword) -> Result<(), MeshIoError> {
        let name = keyword.require(lines, "NAME")?;
        if self.instance(name).is_some() {
            return Err(self.contents.error(
                keyword.place,
                name,
                "there is an instance of this name: rename one of them",
            ));
        }
        let part = match keyword.value("PART") {
            // An instance may bring its own mesh.
            None => DeckPart::default(),
            Some(part) => match self.parts[1..].iter().find(|p| p.name.eq_ignore_ascii_case(part)) {
                None => return Err(self.contents.unknown("part", part, keyword.place)),
                Some(found) => {
                    self.copies += found.size();
                    if self.copies > COPIES {
                        let remedy = "the instances have too many nodes, elements and numbers in sets altogether";
                        return Err(self.contents.error(keyword.place, name, remedy));
                    }
                    found.clone()
                }
            },
        };
        self.instances.push(Instance { name: name.to_owned(), part, translation: [0.0; 3], rotation: None });
        self.scope = Scope::Instance(self.instances.len() - 1);
        Ok(())
    }

    fn node_keyword(&mut self, keyword: &Keyword) -> Result<KeywordBlock, MeshIoError> {
        if self.at_assembly() {
            return Ok(KeywordBlock::Skip); // reference points: no element can use them
        }
        if let Some(system) = keyword.value("SYSTEM").filter(|s| !s.eq_ignore_ascii_case("R")) {
            let what = format!("*NODE, SYSTEM={}", system.to_uppercase());
            let remedy = "only Cartesian coordinates (SYSTEM=R) are read";
            self.contents.count_other(&what, remedy, None, keyword.place);
        }
        let set = keyword.value("NSET").map(str::to_owned);
        if let Some(name) = &set {
            self.names().nodes.open(name, keyword.place, false);
        }
        Ok(KeywordBlock::Node { set })
    }

    fn element_keyword(&mut self, lines: &Lines, keyword: &Keyword) -> Result<KeywordBlock, MeshIoError> {
        let kind = keyword.require(lines, "TYPE")?.to_uppercase();
        let set = keyword.value("ELSET").map(str::to_owned);
        if let Some(name) = &set {
            self.names().elements.open(name, keyword.place, false);
        }
        if let (false, Some(kind)) = (self.at_assembly(), SolidType::find(&kind)) {
            let pending = Vec::with_capacity(1 + kind.node_count());
            return Ok(KeywordBlock::Element { kind, set, pending, place: keyword.place });
        }
        // To the end of the file, so that all of them are counted: what refers to their sets finds them.
        let kind = self.others.iter().position(|o| o.name == kind).unwrap_or_else(|| {
            self.others.push(OtherType { name: kind, count: 0, first: keyword.place });
            self.others.len() - 1
        });
        Ok(KeywordBlock::OtherElement { kind, set, continued: false })
    }

    fn set_keyword(
        &mut self,
        lines: &Lines,
        keyword: &Keyword,
        kind: Kind,
        parameter: &str,
    ) -> Result<KeywordBlock, MeshIoError> {
        let name = keyword.require(lines, parameter)?.to_owned();
        let internal = keyword.flag("INTERNAL");
        self.names().sets_mut(kind).open(&name, keyword.place, internal);
        let instance = match keyword.value("INSTANCE") {
            Some(instance) if self.at_assembly() => match self.instance(instance) {
                None => return Err(self.contents.unknown("instance", instance, keyword.place)),
                found => found,
            },
            _ => None,
        };
        if kind == Kind::Node
            && let Some(elements) = keyword.value("ELSET")
        {
            let labels = self.find(lines, elements, Kind::Element)?;
            self.names().nodes_of_elements.push((name.clone(), labels));
        }
        Ok(KeywordBlock::Set { kind, name, generate: keyword.flag("GENERATE"), instance })
    }

    fn surface_keyword(&mut self, lines: &Lines, keyword: &Keyword) -> Result<KeywordBlock, MeshIoError> {
        let name = keyword.require(lines, "NAME")?.to_owned();
        let left_out = |what: &str| {
            format!(
                "surface {name:?} (line {}) is left out: {what}; only TYPE=ELEMENT and TYPE=NODE with lists of elements and faces or of nodes \
                 are read",
                keyword.place.at
            )
        };
        if keyword.flag("COMBINE") || keyword.flag("CROP") {
            self.contents.notes.push(left_out("it is a combination of others"));
            return Ok(KeywordBlock::Skip);
        }
        let nodes = match keyword.value("TYPE").unwrap_or("ELEMENT").to_uppercase().as_str() {
            "ELEMENT" => false,
            "NODE" => true,
            other => {
                self.contents.notes.push(left_out(&format!("its type is {other}")));
                return Ok(KeywordBlock::Skip);
            }
        };
        if nodes {
            self.names().nodes.open(&name, keyword.place, false);
        } else {
            self.names().surfaces.entry(name.to_uppercase()).or_insert_with(|| (name.clone(), Vec::new()));
        }
        Ok(KeywordBlock::Surface { name, nodes })
    }
}
