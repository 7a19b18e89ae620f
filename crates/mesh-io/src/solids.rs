//! The elements of a file that Stoss computes with, whatever else is in it, with their numbers there.

use std::path::PathBuf;

use stoss_mesh::Mesh;

use crate::{Contents, MeshIoError};

/// All elements of a file that Stoss computes with, as one mesh, for a reader who makes several bodies of it.
#[derive(Debug, Clone)]
pub struct Solids {
    /// The mesh with its sets, not checked: [`Contents::check_solids`] does that. Instances are sets of elements.
    pub mesh: Mesh,
    /// The numbers of the nodes in the file. Several instances may have the same ones.
    pub node_numbers: Vec<u64>,
    /// The numbers of the elements in the file.
    pub element_numbers: Vec<u64>,
    /// The types of the elements, as `C3D20R`; none for formats that have no variants of a cell.
    pub element_types: Vec<&'static str>,
}

/// Elements of a type that Stoss does not compute with.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherElements {
    /// Name of the type, as "elements S4R".
    pub what: String,
    /// Number of such elements.
    pub count: usize,
    /// The file of the first.
    pub path: PathBuf,
    /// Line of the first.
    pub line: usize,
    /// Remedy: what to do instead.
    pub remedy: String,
}

/// A node that no element has which Stoss computes with.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherNode {
    /// Number of the node.
    pub number: u64,
    /// Coordinates of the node.
    pub at: [f64; 3],
    /// The sets of nodes that it belongs to.
    pub sets: Vec<String>,
}

impl Contents {
    /// The elements that Stoss computes with, whatever other elements there are.
    ///
    /// # Errors
    /// [`MeshIoError::Unsupported`] for what would change the mesh and is not read; [`MeshIoError::NoElements`].
    pub fn solids(&self) -> Result<Solids, MeshIoError> {
        if let Some(other) = self.others.iter().find(|o| o.groups.is_none()) {
            return Err(self.error(other.first, format_args!("{} {}", other.count, other.what), &other.remedy));
        }
        let (nodes, elements) = self.kept_of(None);
        Ok(Solids {
            mesh: self.usable()?,
            node_numbers: nodes.iter().map(|&n| self.node_source[n as usize].number).collect(),
            element_numbers: elements.iter().map(|&e| self.element_source[e as usize].number).collect(),
            element_types: self.element_types.clone(),
        })
    }

    /// What is wrong with the elements that Stoss computes with, in the numbers of the file.
    ///
    /// # Errors
    /// Inverted and overlapping elements, facets that do not fit.
    pub fn check_solids(&self) -> Result<(), MeshIoError> {
        self.check_usable()
    }

    /// Elements of types that Stoss does not compute with, in the order of the file.
    pub fn other_elements(&self) -> Vec<OtherElements> {
        let others = self.others.iter().filter(|other| other.groups.is_some());
        let path = |file: u32| self.files.get(file as usize).cloned().unwrap_or_else(|| self.path().to_owned());
        let mut list: Vec<OtherElements> = others
            .map(|other| OtherElements {
                what: other.what.clone(),
                count: other.count,
                path: path(other.first.file),
                line: other.first.at as usize,
                remedy: other.remedy.clone(),
            })
            .collect();
        list.sort_by_key(|other| other.line);
        list
    }

    /// The sets of nodes, with the numbers of their nodes: also of those that no element has, such as reference nodes.
    pub fn node_set_sizes(&self) -> impl Iterator<Item = (&str, usize)> {
        self.node_sets.iter().map(|(name, nodes)| (name.as_str(), nodes.len()))
    }

    /// Nodes that no element has which Stoss computes with, such as reference nodes, in the order of the file.
    pub fn other_nodes(&self) -> Vec<OtherNode> {
        let mut is_used = vec![false; self.nodes.len()];
        (0..self.elements.len()).for_each(|e| self.elements[e].iter().for_each(|&node| is_used[node as usize] = true));
        let sets_of = |node: u32| {
            let own = self.node_sets.iter().filter(|(_, nodes)| nodes.contains(&node));
            own.map(|(name, _)| name.clone()).collect()
        };
        let free = (0..self.nodes.len()).filter(|&node| !is_used[node]);
        free.map(|node| OtherNode {
            number: self.node_source[node].number,
            at: self.nodes[node],
            sets: sets_of(node as u32),
        })
        .collect()
    }

    /// The instance of a file that has one.
    pub fn only_instance(&self) -> Option<&str> {
        self.instances.keys().next().filter(|_| self.instances.len() == 1).map(String::as_str)
    }

    /// The instances of a part, by their names; names compare without regard to case.
    pub fn instances_of(&self, part: &str) -> Vec<&str> {
        let own = self.parts.iter().filter(|(_, of)| of.eq_ignore_ascii_case(part));
        own.map(|(instance, _)| instance.as_str()).collect()
    }
}
