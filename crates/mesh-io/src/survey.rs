//! What is in a file, and whether Stoss can use it.

use std::collections::BTreeMap;
use std::fmt;

use stoss_mesh::{Coincident, Mesh, QualityReport};

use crate::Contents;

/// A type of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct CellCount {
    /// What it is called in the format.
    pub name: String,
    /// Number of such cells.
    pub count: usize,
    /// Place of the first, as "line 7".
    pub first: String,
    /// Whether Stoss computes with it.
    pub read: bool,
}

/// What is known of the elements of a file or a group that Stoss computes with.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSurvey {
    /// Number of nodes.
    pub nodes: usize,
    /// Smallest and largest coordinates (lengths).
    pub bounding_box: ([f64; 3], [f64; 3]),
    /// Quality of the elements, which are reported by their numbers in the file.
    pub quality: QualityReport,
    /// Pieces of which no two have a node in common.
    pub pieces: usize,
    /// Nodes at the place of another one.
    pub coincident: Option<Coincident>,
    /// The numbers in the file of the first two such nodes.
    pub coincident_numbers: Option<[u64; 2]>,
    /// Sets with their number of elements.
    pub element_sets: BTreeMap<String, usize>,
    /// Sets with their number of facets.
    pub facet_sets: BTreeMap<String, usize>,
    /// Sets with their number of nodes.
    pub node_sets: BTreeMap<String, usize>,
}

/// What a file, or a group of it, has, and whether Stoss can use it; [`fmt::Display`] is what `stoss mesh info` prints.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// Name and version of the format.
    pub format: String,
    /// Files that the file includes.
    pub included: usize,
    /// The group that this is about; none is the whole file.
    pub group: Option<String>,
    /// Nodes of the file, those without an element too.
    pub nodes: usize,
    /// All types of cells of the file that have a volume or could be taken for one.
    pub cells: Vec<CellCount>,
    /// Instances of parts with their number of elements.
    pub instances: BTreeMap<String, usize>,
    /// Groups of elements that Stoss can use by themselves.
    pub usable_groups: Vec<String>,
    /// What a user should know.
    pub notes: Vec<String>,
    /// The mesh, if there is any.
    pub mesh: Option<MeshSurvey>,
    /// Why Stoss cannot use it; empty if it can.
    pub reasons: Vec<String>,
}

/// The largest number of groups that are tried by themselves if the whole file cannot be used.
const TRIED: usize = 200;

impl Contents {
    /// What the whole file or one group has, and whether Stoss can use it.
    pub fn survey(&self, group: Option<&str>) -> Survey {
        let mut cells: Vec<_> = self
            .cells
            .iter()
            .map(|(name, &(count, first))| {
                (first, CellCount { name: name.clone(), count, first: self.place_name(first), read: true })
            })
            .chain(self.others.iter().map(|o| {
                (
                    o.first,
                    CellCount { name: o.what.clone(), count: o.count, first: self.place_name(o.first), read: false },
                )
            }))
            .collect();
        cells.sort_by_key(|(first, _)| *first);
        let checked = self.mesh(group);
        let mut reasons: Vec<String> = checked.as_ref().err().map(ToString::to_string).into_iter().collect();
        // What the elements are like is reported even if there are others beside them.
        let mesh = match (&checked, group) {
            (Ok(mesh), _) => Some(self.survey_mesh(mesh, group)),
            (Err(_), None) => self.usable().ok().map(|mesh| self.survey_mesh(&mesh, None)),
            (Err(_), Some(_)) => None,
        };
        if checked.is_err()
            && !self.others.is_empty()
            && let Some(Err(error)) = (!self.elements.is_empty()).then(|| self.check_usable())
        {
            reasons.push(error.to_string());
        }
        let usable_groups = if checked.is_err() && group.is_none() {
            self.groups().into_iter().take(TRIED).filter(|name| self.mesh(Some(name)).is_ok()).collect()
        } else {
            Vec::new()
        };
        Survey {
            format: self.format.clone(),
            included: self.files.len() - 1,
            group: group.map(str::to_owned),
            nodes: self.nodes.len(),
            cells: cells.into_iter().map(|(_, cell)| cell).collect(),
            instances: self.instances.iter().map(|(name, set)| (name.clone(), set.len())).collect(),
            usable_groups,
            notes: self.notes.clone(),
            mesh,
            reasons,
        }
    }

    fn survey_mesh(&self, mesh: &Mesh, group: Option<&str>) -> MeshSurvey {
        let coincident = mesh.coincident_nodes();
        // Elements and nodes are reported by their numbers in the file.
        let (nodes, elements) = self.kept_of(group);
        let number = |n: u32| nodes.get(n as usize).map(|&old| self.node_source[old as usize].number);
        let in_file =
            |e: u32| elements.get(e as usize).map_or(e, |&old| self.element_source[old as usize].number as u32);
        let mut quality = mesh.quality();
        quality.worst_element = in_file(quality.worst_element);
        quality.least_valid_element = in_file(quality.least_valid_element);
        quality.slenderest_element = in_file(quality.slenderest_element);
        MeshSurvey {
            nodes: mesh.nodes.len(),
            bounding_box: mesh.bounding_box(),
            quality,
            pieces: mesh.pieces(),
            coincident,
            coincident_numbers: coincident.and_then(|c| Some([number(c.first)?, number(c.second)?])),
            element_sets: mesh.element_sets.iter().map(|(name, set)| (name.clone(), set.len())).collect(),
            facet_sets: mesh.facet_sets.iter().map(|(name, set)| (name.clone(), set.len())).collect(),
            node_sets: mesh.node_sets.iter().map(|(name, set)| (name.clone(), set.len())).collect(),
        }
    }
}

fn sets(f: &mut fmt::Formatter<'_>, title: &str, sets: &BTreeMap<String, usize>) -> fmt::Result {
    if sets.is_empty() {
        return Ok(());
    }
    writeln!(f, "{title}:")?;
    sets.iter().try_for_each(|(name, count)| writeln!(f, "  {name:?}: {count}"))
}

impl fmt::Display for Survey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "format: {}", self.format)?;
        if self.included > 0 {
            write!(f, ", with {} included files", self.included)?;
        }
        writeln!(f, "\nnodes: {}", self.nodes)?;
        writeln!(f, "cells:")?;
        for cell in &self.cells {
            let read = if cell.read { "read" } else { "not read" };
            writeln!(f, "  {} {}: {read} (first in {})", cell.count, cell.name, cell.first)?;
        }
        sets(f, "instances (elements)", &self.instances)?;
        if let Some(group) = &self.group {
            writeln!(f, "of group {group:?}:")?;
        }
        if let Some(mesh) = &self.mesh {
            sets(f, "sets of elements", &mesh.element_sets)?;
            sets(f, "sets of facets", &mesh.facet_sets)?;
            sets(f, "sets of nodes", &mesh.node_sets)?;
            let (low, high) = mesh.bounding_box;
            writeln!(f, "bounding box: {low:?} to {high:?}")?;
            writeln!(f, "quality: {}", mesh.quality)?;
            if let Some(warning) = mesh.quality.warning() {
                writeln!(f, "warning: {warning}")?;
            }
            if mesh.pieces > 1 {
                writeln!(f, "pieces without a common node: {}", mesh.pieces)?;
            }
            if let Some(coincident) = mesh.coincident {
                let first = match mesh.coincident_numbers {
                    Some([a, b]) => format!(", the first {b} at that of {a}"),
                    None => String::new(),
                };
                writeln!(
                    f,
                    "coincident nodes: {} at the place of another one{first}; elements that do not share nodes are not joined there",
                    coincident.count
                )?;
            }
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "note: {note}"))?;
        if self.reasons.is_empty() {
            return writeln!(f, "Stoss can use it.");
        }
        writeln!(f, "Stoss cannot use it{}:", if self.group.is_none() { " as a whole" } else { "" })?;
        self.reasons.iter().try_for_each(|reason| writeln!(f, "  {reason}"))?;
        if !self.usable_groups.is_empty() {
            let names: Vec<String> = self.usable_groups.iter().map(|g| format!("{g:?}")).collect();
            writeln!(f, "Each of these groups can be a body: {}", names.join(", "))?;
        }
        Ok(())
    }
}
