//! What a file says: nodes, elements, sets, what is not read, and where it stands.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use stoss_mesh::Elements;
use stoss_reference_element::FacetNodes;

use crate::lines::syntax;
use crate::place::FileLocation;
use crate::{FilePosition, MeshIoError};

/// A node or an element: its number in the file and its place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Source {
    pub number: u64,
    pub place: FileLocation,
}

/// Something in a file that Stoss does not compute with.
#[derive(Debug, Clone)]
pub(crate) struct Other {
    /// Name of the thing as in "3 pyramids (type 7)", without the number.
    pub what: String,
    pub count: usize,
    pub first: FileLocation,
    /// The groups of elements that it belongs to; `None` if it concerns the whole file.
    pub groups: Option<BTreeSet<String>>,
    /// Remedy: what to do instead.
    pub remedy: String,
}

/// Nodes, elements and sets of a mesh file, before a group is chosen and the mesh is checked.
///
/// [`Contents::mesh`] gives the mesh of the whole file or of one group of elements; [`Contents::survey`] an overview of the file.
#[derive(Debug, Clone, Default)]
pub struct Contents {
    /// Name and version of the format.
    pub(crate) format: String,
    /// The file and those that it includes.
    pub(crate) files: Vec<PathBuf>,
    /// Whether places are bytes.
    pub(crate) binary: bool,
    pub(crate) nodes: Vec<[f64; 3]>,
    pub(crate) node_source: Vec<Source>,
    pub(crate) elements: Elements,
    /// Whether there are plane elements among them, each a layer from z = -1 to z = 1.
    pub(crate) is_plane: bool,
    pub(crate) element_source: Vec<Source>,
    /// The type of each element by its name in the format, where the format has variants of a cell.
    pub(crate) element_types: Vec<&'static str>,
    /// Types of the cells that are read: how many, and the first.
    pub(crate) cells: BTreeMap<String, (usize, FileLocation)>,
    pub(crate) others: Vec<Other>,
    /// What a user should know.
    pub(crate) notes: Vec<String>,
    /// Instances of parts, by name.
    pub(crate) instances: BTreeMap<String, BTreeSet<u32>>,
    /// The parts of the instances.
    pub(crate) parts: BTreeMap<String, String>,
    pub(crate) node_sets: BTreeMap<String, BTreeSet<u32>>,
    pub(crate) element_sets: BTreeMap<String, BTreeSet<u32>>,
    /// Vectors of the elements, as many as elements; not a number where an element has none.
    pub(crate) element_vectors: BTreeMap<String, Vec<[f64; 3]>>,
    pub(crate) facet_sets: BTreeMap<String, BTreeSet<(u32, usize)>>,
    /// Faces, by their corners, that must be facets of elements.
    pub(crate) faces: BTreeMap<String, Vec<(FacetNodes, FileLocation)>>,
    /// All boundary facets of these elements.
    pub(crate) free_facets: BTreeMap<String, BTreeSet<u32>>,
    /// Names compare without regard to case.
    pub(crate) ignore_case: bool,
}

impl Contents {
    pub(crate) fn new(path: &Path, format: impl Into<String>) -> Contents {
        Contents { format: format.into(), files: vec![path.to_owned()], ..Contents::default() }
    }

    /// The file that was read.
    pub fn path(&self) -> &Path {
        // cannot fail: `new` gives the first one
        &self.files[0]
    }

    /// Name and version of the format.
    pub fn format(&self) -> &str {
        &self.format
    }

    /// Whether there are plane elements: each is a layer of its plane from z = -1 to z = 1 here.
    pub fn is_plane(&self) -> bool {
        self.is_plane
    }

    /// What a user should know: elements that are taken for others, groups that are left out.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The names that [`Contents::mesh`] takes: instances and sets of elements, sorted.
    pub fn groups(&self) -> Vec<String> {
        let others = self.others.iter().filter_map(|o| o.groups.as_ref()).flatten();
        let names: BTreeSet<&String> = self.instances.keys().chain(self.element_sets.keys()).chain(others).collect();
        names.into_iter().cloned().collect()
    }

    /// The file of a place.
    pub(crate) fn file(&self, place: FileLocation) -> &Path {
        self.files.get(place.file as usize).map_or_else(|| self.path(), PathBuf::as_path)
    }

    /// "line 3", "byte 3", with the file if it is an included one.
    pub(crate) fn place_name(&self, place: FileLocation) -> String {
        let unit = if self.binary { "byte" } else { "line" };
        if place.file == 0 {
            format!("{unit} {}", place.at)
        } else {
            format!("{unit} {} of {}", place.at, self.file(place).display())
        }
    }

    /// A place for an error.
    pub(crate) fn position(&self, place: FileLocation) -> FilePosition {
        if self.binary { FilePosition::Byte(place.at) } else { FilePosition::Line(place.at as usize) }
    }

    /// An error at a place.
    pub(crate) fn error(&self, place: FileLocation, value: impl ToString, remedy: impl ToString) -> MeshIoError {
        let (value, remedy) = (value.to_string(), remedy.to_string());
        match self.position(place) {
            FilePosition::Line(line) => syntax(self.file(place), line, value, remedy),
            FilePosition::Byte(offset) => {
                MeshIoError::Binary { path: self.file(place).to_owned(), offset, value, remedy }
            }
        }
    }

    /// The error that something does not exist.
    pub(crate) fn unknown(&self, kind: &'static str, number: impl ToString, place: FileLocation) -> MeshIoError {
        let (path, at) = (self.file(place).to_owned(), self.position(place));
        MeshIoError::Unknown { path, at, kind, number: number.to_string() }
    }

    /// Counts what Stoss does not compute with; `groups` are the groups of elements that it belongs to.
    pub(crate) fn count_other(&mut self, what: &str, remedy: &str, groups: Option<&[String]>, place: FileLocation) {
        let index = self.others.iter().position(|o| o.what == what).unwrap_or_else(|| {
            self.others.push(Other {
                what: what.to_owned(),
                count: 0,
                first: place,
                groups: groups.map(|_| BTreeSet::new()),
                remedy: remedy.to_owned(),
            });
            self.others.len() - 1
        });
        let other = &mut self.others[index];
        other.count += 1;
        if let (Some(all), Some(groups)) = (&mut other.groups, groups) {
            all.extend(groups.iter().cloned());
        }
    }

    /// Counts a cell that is read.
    pub(crate) fn count_cell(&mut self, kind: &str, place: FileLocation) {
        match self.cells.get_mut(kind) {
            Some(cell) => cell.0 += 1,
            None => drop(self.cells.insert(kind.to_owned(), (1, place))),
        }
    }

    /// An error if a group, or the file, has what Stoss does not compute with.
    pub(crate) fn refuse_others(&self, group: Option<&str>) -> Result<(), MeshIoError> {
        let concerned: Vec<&Other> = self
            .others
            .iter()
            .filter(|o| match (&o.groups, group) {
                (Some(groups), Some(group)) => groups.contains(group),
                _ => true,
            })
            .collect();
        let Some(first) = concerned.iter().min_by_key(|o| o.first) else { return Ok(()) };
        let list: Vec<String> =
            concerned.iter().map(|o| format!("{} {} ({})", o.count, o.what, self.place_name(o.first))).collect();
        let (path, at) = (self.file(first.first).to_owned(), self.position(first.first));
        Err(MeshIoError::Unsupported { path, at, value: list.join(", "), remedy: first.remedy.clone() })
    }
}

pub(crate) fn entry<'m, T: Default>(map: &'m mut BTreeMap<String, T>, name: &str) -> &'m mut T {
    map.entry(name.to_owned()).or_default()
}
