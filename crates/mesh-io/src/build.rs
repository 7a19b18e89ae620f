//! From what a file says to a checked mesh.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

use stoss_mesh::{Facet, FacetIndex, Mesh, MeshError};

use crate::MeshIoError;
use crate::lines::syntax;

/// A node or an element: its number in the file and its line.
#[derive(Clone, Copy)]
struct Source {
    number: u64,
    line: usize,
}

/// Collects nodes, hexahedra and sets with the file's own numbers, which may be arbitrary.
pub(crate) struct Builder<'a> {
    path: &'a Path,
    nodes: Vec<[f64; 3]>,
    node_source: Vec<Source>,
    node_index: HashMap<u64, u32>,
    elements: Vec<[u32; 8]>,
    element_source: Vec<Source>,
    element_index: HashMap<u64, u32>,
    /// Elements by their nodes, to find those that a file lists once for each group.
    element_by_nodes: HashMap<[u32; 8], u32>,
    node_sets: BTreeMap<String, BTreeSet<u32>>,
    element_sets: BTreeMap<String, BTreeSet<u32>>,
    facet_sets: BTreeMap<String, BTreeSet<(u32, usize)>>,
    quads: BTreeMap<String, Vec<([u32; 4], usize)>>,
    free_facets: BTreeMap<String, BTreeSet<u32>>,
}

impl<'a> Builder<'a> {
    pub fn new(path: &'a Path) -> Builder<'a> {
        Builder {
            path,
            nodes: Vec::new(),
            node_source: Vec::new(),
            node_index: HashMap::new(),
            elements: Vec::new(),
            element_source: Vec::new(),
            element_index: HashMap::new(),
            element_by_nodes: HashMap::new(),
            node_sets: BTreeMap::new(),
            element_sets: BTreeMap::new(),
            facet_sets: BTreeMap::new(),
            quads: BTreeMap::new(),
            free_facets: BTreeMap::new(),
        }
    }

    /// Adds a node. Saying the same twice is no error.
    pub fn node(&mut self, number: u64, x: [f64; 3], line: usize) -> Result<(), MeshIoError> {
        if let Some(&old) = self.node_index.get(&number) {
            if self.nodes[old as usize] == x {
                return Ok(());
            }
            let first = self.node_source[old as usize].line;
            let remedy = format!("node {number} is already at another place in line {first}: renumber one of them");
            return Err(syntax(self.path, line, number, remedy));
        }
        self.node_index.insert(number, self.nodes.len() as u32);
        self.nodes.push(x);
        self.node_source.push(Source { number, line });
        Ok(())
    }

    fn node_number(&self, number: u64, line: usize) -> Result<u32, MeshIoError> {
        self.node_index.get(&number).copied().ok_or_else(|| self.unknown("node", number, line))
    }

    /// Adds a hexahedron and returns its index. An element with the same nodes in the same order is the same element.
    pub fn hexahedron(&mut self, number: u64, nodes: [u64; 8], line: usize) -> Result<u32, MeshIoError> {
        let mut local = [0; 8];
        for i in 0..8 {
            local[i] = self.node_number(nodes[i], line)?;
            if nodes[..i].contains(&nodes[i]) {
                let remedy = format!(
                    "element {number} uses this node twice: collapsed hexahedra are not supported, use 8 different nodes"
                );
                return Err(syntax(self.path, line, nodes[i], remedy));
            }
        }
        if let Some(&same) = self.element_by_nodes.get(&local) {
            self.element_index.insert(number, same);
            return Ok(same);
        }
        if let Some(&old) = self.element_index.get(&number) {
            let first = self.element_source[old as usize].line;
            let remedy = format!("element {number} has other nodes in line {first}: renumber one of them");
            return Err(syntax(self.path, line, number, remedy));
        }
        let index = self.elements.len() as u32;
        self.element_index.insert(number, index);
        self.element_by_nodes.insert(local, index);
        self.elements.push(local);
        self.element_source.push(Source { number, line });
        Ok(index)
    }

    /// Index of an element number.
    pub fn element_number(&self, number: u64, line: usize) -> Result<u32, MeshIoError> {
        self.element_index.get(&number).copied().ok_or_else(|| self.unknown("element", number, line))
    }

    /// All numbers of elements with their indices.
    pub fn element_numbers(&self) -> impl Iterator<Item = (u64, u32)> {
        self.element_index.iter().map(|(&n, &i)| (n, i))
    }

    /// All numbers of nodes.
    pub fn node_numbers(&self) -> impl Iterator<Item = u64> {
        self.node_index.keys().copied()
    }

    /// Nodes' numbers of an element by index.
    pub fn nodes_of_element(&self, element: u32) -> [u64; 8] {
        self.elements[element as usize].map(|n| self.node_source[n as usize].number)
    }

    pub fn add_to_node_set(&mut self, name: &str, number: u64, line: usize) -> Result<(), MeshIoError> {
        let node = self.node_number(number, line)?;
        entry(&mut self.node_sets, name).insert(node);
        Ok(())
    }

    pub fn add_to_element_set(&mut self, name: &str, element: u32) {
        entry(&mut self.element_sets, name).insert(element);
    }

    /// Adds facet `local` of an element by index.
    pub fn add_to_facet_set(&mut self, name: &str, element: u32, local: usize) {
        entry(&mut self.facet_sets, name).insert((element, local));
    }

    /// Adds the boundary facets of an element by index.
    pub fn add_free_facets(&mut self, name: &str, element: u32) {
        entry(&mut self.free_facets, name).insert(element);
    }

    /// Adds a quadrilateral that must be a facet of a hexahedron.
    pub fn add_quad(&mut self, name: &str, nodes: [u64; 4], line: usize) -> Result<(), MeshIoError> {
        let mut local = [0; 4];
        for i in 0..4 {
            local[i] = self.node_number(nodes[i], line)?;
        }
        entry(&mut self.quads, name).push((local, line));
        Ok(())
    }

    /// Moves all nodes.
    pub fn map_nodes(&mut self, map: impl Fn([f64; 3]) -> [f64; 3]) {
        self.nodes.iter_mut().for_each(|x| *x = map(*x));
    }

    fn unknown(&self, kind: &'static str, number: impl ToString, line: usize) -> MeshIoError {
        MeshIoError::Unknown { path: self.path.to_owned(), line, kind, number: number.to_string() }
    }

    /// The checked mesh.
    pub fn finish(mut self) -> Result<Mesh, MeshIoError> {
        if self.elements.is_empty() {
            return Err(MeshIoError::NoHexahedra { path: self.path.to_owned() });
        }
        const UNUSED: u32 = u32::MAX;
        let mut new = vec![UNUSED; self.nodes.len()];
        self.elements.as_flattened().iter().for_each(|&n| new[n as usize] = 0);
        let (mut nodes, mut source) = (Vec::new(), Vec::new());
        for n in 0..new.len() {
            if new[n] != UNUSED {
                new[n] = nodes.len() as u32;
                nodes.push(self.nodes[n]);
                source.push(self.node_source[n]);
            }
        }
        let elements: Vec<[u32; 8]> = self.elements.iter().map(|e| e.map(|n| new[n as usize])).collect();
        self.node_source = source;
        let wrap = |source| MeshIoError::Mesh { path: self.path.to_owned(), source };
        let mut mesh = Mesh::new(nodes, elements).map_err(wrap)?;

        for (name, set) in &self.node_sets {
            let nodes: Vec<u32> = set.iter().map(|&n| new[n as usize]).filter(|&n| n != UNUSED).collect();
            if !nodes.is_empty() {
                mesh.node_sets.insert(name.clone(), nodes);
            }
        }
        for (name, set) in &self.element_sets {
            mesh.element_sets.insert(name.clone(), set.iter().copied().collect());
        }
        let mut facets: BTreeMap<String, BTreeSet<Facet>> = BTreeMap::new();
        for (name, set) in &self.facet_sets {
            entry(&mut facets, name).extend(set.iter().map(|&(e, local)| mesh.facet(e, local)));
        }
        if !self.quads.is_empty() || !self.free_facets.is_empty() {
            let index = mesh.facet_index();
            self.match_quads(&index, &new, &mut mesh, &mut facets)?;
            let boundary = if self.free_facets.is_empty() { Vec::new() } else { index.boundary() };
            for (name, elements) in &self.free_facets {
                entry(&mut facets, name).extend(boundary.iter().filter(|f| elements.contains(&f.element)));
            }
        }
        mesh.facet_sets =
            facets.into_iter().filter(|(_, s)| !s.is_empty()).map(|(n, s)| (n, s.into_iter().collect())).collect();
        mesh.check().map_err(|problem| self.in_file_numbers(problem, &mesh))?;
        Ok(mesh)
    }

    /// Quadrilaterals to facets. A group that has a facet between two elements has no outside: it becomes a node set.
    fn match_quads(
        &self,
        index: &FacetIndex,
        new: &[u32],
        mesh: &mut Mesh,
        facets: &mut BTreeMap<String, BTreeSet<Facet>>,
    ) -> Result<(), MeshIoError> {
        for (name, quads) in &self.quads {
            let mut matched = BTreeSet::new();
            let mut inner = false;
            for &(nodes, line) in quads {
                let found = index.find(nodes.map(|n| new[n as usize]));
                if found.len() == 0 {
                    let numbers = nodes.map(|n| self.nodes_number_before_compression(n, new));
                    let remedy = format!(
                        "this quadrilateral of group \"{name}\" is no facet of a hexahedron: mesh the volume behind it with \
                         hexahedra, or take the surface out of its physical group"
                    );
                    return Err(syntax(self.path, line, format_args!("nodes {numbers:?}"), remedy));
                }
                inner |= found.len() > 1;
                matched.extend(found.copied());
            }
            if inner {
                let nodes: BTreeSet<u32> = matched.iter().flat_map(|f| f.nodes).collect();
                mesh.node_sets.insert(name.clone(), nodes.into_iter().collect());
            } else {
                entry(facets, name).extend(matched);
            }
        }
        Ok(())
    }

    /// The file's number of a node index from before unused nodes were dropped.
    fn nodes_number_before_compression(&self, node: u32, new: &[u32]) -> String {
        match new[node as usize] {
            u32::MAX => "(unused)".to_owned(),
            n => self.node_source[n as usize].number.to_string(),
        }
    }

    /// Problems of the mesh in the numbers of the file.
    fn in_file_numbers(&self, problem: MeshError, mesh: &Mesh) -> MeshIoError {
        let path = self.path.to_owned();
        match problem {
            MeshError::InvertedElement { element, jacobian, .. } => {
                let Source { number, line } = self.element_source[element as usize];
                let nodes = mesh.elements[element as usize].map(|n| self.node_source[n as usize].number);
                MeshIoError::InvertedElement { path, line, element: number, nodes, jacobian }
            }
            MeshError::DuplicateNodes { first, second, distance, .. } => {
                let (a, b) = (self.node_source[first as usize], self.node_source[second as usize]);
                MeshIoError::CoincidentNodes { path, line: b.line, first: a.number, second: b.number, distance }
            }
            MeshError::OverlappingElements { elements, .. } => {
                let [a, b] = elements.map(|e| self.element_source[e as usize]);
                MeshIoError::OverlappingElements { path, line: a.line.max(b.line), elements: [a.number, b.number] }
            }
            source => MeshIoError::Mesh { path, source },
        }
    }
}

fn entry<'m, T: Default>(map: &'m mut BTreeMap<String, T>, name: &str) -> &'m mut T {
    map.entry(name.to_owned()).or_default()
}
