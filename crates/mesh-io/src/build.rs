//! From a file's own numbers, which may be arbitrary, to [`Contents`].

use std::collections::HashMap;

use stoss_reference_element::{CellKind, FacetKind, FacetNodes};

use crate::MeshIoError;
use crate::contents::{Contents, Source, entry};
use crate::place::Place;

/// Numbers of nodes and elements of one instance, or of a file without instances.
#[derive(Default)]
struct Numbers {
    nodes: HashMap<u64, u32>,
    elements: HashMap<u64, u32>,
    /// Elements by their nodes, to find those that a file lists once for each group.
    by_nodes: HashMap<Box<[u32]>, u32>,
}

/// Collects nodes, elements and sets. Numbers are unique within a scope; nodes and elements go into the last one.
pub(crate) struct Builder {
    pub contents: Contents,
    scopes: Vec<Numbers>,
}

impl Builder {
    /// A builder with the scope 0.
    pub fn new(contents: Contents) -> Builder {
        Builder { contents, scopes: vec![Numbers::default()] }
    }

    /// A new scope for what comes next.
    pub fn open_scope(&mut self) {
        self.scopes.push(Numbers::default());
    }

    fn last(&mut self) -> &mut Numbers {
        let last = self.scopes.len() - 1;
        // cannot fail: there is one from the beginning
        &mut self.scopes[last]
    }

    /// Adds a node. Saying the same twice is no error.
    pub fn node(&mut self, number: u64, x: [f64; 3], place: Place) -> Result<(), MeshIoError> {
        if let Some(&old) = self.last().nodes.get(&number) {
            if self.contents.nodes[old as usize] == x {
                return Ok(());
            }
            let first = self.contents.place_name(self.contents.node_source[old as usize].place);
            let remedy = format!("node {number} is already at another place in {first}: renumber one of them");
            return Err(self.contents.error(place, number, remedy));
        }
        let index = self.contents.nodes.len() as u32;
        self.last().nodes.insert(number, index);
        self.contents.nodes.push(x);
        self.contents.node_source.push(Source { number, place });
        Ok(())
    }

    /// Index of a node.
    pub fn node_number(&self, scope: usize, number: u64, place: Place) -> Result<u32, MeshIoError> {
        let found = self.scopes[scope].nodes.get(&number).copied();
        found.ok_or_else(|| self.contents.unknown("node", number, place))
    }

    /// Adds an element, its nodes in the order of its kind, and returns its index. One with the same nodes in the same order is the same
    /// element. `name` is what the format calls the type.
    pub fn element(
        &mut self,
        number: u64,
        kind: CellKind,
        nodes: &[u64],
        name: &str,
        place: Place,
    ) -> Result<u32, MeshIoError> {
        let scope = self.scopes.len() - 1;
        if nodes.len() != kind.node_count() {
            let remedy = format!("has {} nodes, but a {kind} needs {}", nodes.len(), kind.node_count());
            return Err(self.contents.error(place, format_args!("element {number}"), remedy));
        }
        let mut local = Vec::with_capacity(nodes.len());
        for (i, node) in nodes.iter().enumerate() {
            local.push(self.node_number(scope, *node, place)?);
            if nodes[..i].contains(node) {
                let remedy = format!(
                    "element {number} uses this node twice: collapsed elements are not supported, a {kind} has {} different nodes",
                    nodes.len()
                );
                return Err(self.contents.error(place, node, remedy));
            }
        }
        if let Some(&same) = self.last().by_nodes.get(local.as_slice()) {
            self.last().elements.insert(number, same);
            return Ok(same);
        }
        if let Some(&old) = self.last().elements.get(&number) {
            let first = self.contents.place_name(self.contents.element_source[old as usize].place);
            let remedy = format!("element {number} has other nodes in {first}: renumber one of them");
            return Err(self.contents.error(place, number, remedy));
        }
        let index = self.contents.element_source.len() as u32;
        self.contents.elements.push(kind, &local);
        self.last().elements.insert(number, index);
        self.last().by_nodes.insert(local.into(), index);
        self.contents.element_source.push(Source { number, place });
        self.contents.count_cell(name, place);
        Ok(index)
    }

    /// Index of an element, if Stoss computes with its type.
    pub fn element_number(&self, scope: usize, number: u64) -> Option<u32> {
        self.scopes[scope].elements.get(&number).copied()
    }

    /// All numbers of elements of a scope with their indices.
    pub fn element_numbers(&self, scope: usize) -> impl ExactSizeIterator<Item = (u64, u32)> {
        self.scopes[scope].elements.iter().map(|(&n, &i)| (n, i))
    }

    /// All numbers of nodes of a scope with their indices.
    pub fn node_numbers(&self, scope: usize) -> impl ExactSizeIterator<Item = (u64, u32)> {
        self.scopes[scope].nodes.iter().map(|(&n, &i)| (n, i))
    }

    /// Adds a node of scope 0.
    pub fn add_to_node_set(&mut self, name: &str, number: u64, place: Place) -> Result<(), MeshIoError> {
        let node = self.node_number(0, number, place)?;
        entry(&mut self.contents.node_sets, name).insert(node);
        Ok(())
    }

    pub fn add_to_element_set(&mut self, name: &str, element: u32) {
        entry(&mut self.contents.element_sets, name).insert(element);
    }

    /// Adds a face of scope 0 by its three or four corners, which must be those of a facet of an element.
    pub fn add_face(&mut self, name: &str, corners: &[u64], place: Place) -> Result<(), MeshIoError> {
        let mut local = [0; 4];
        for (local, &corner) in local.iter_mut().zip(corners) {
            *local = self.node_number(0, corner, place)?;
        }
        let kind = if corners.len() == 3 { FacetKind::Tri3 } else { FacetKind::Quad4 };
        entry(&mut self.contents.faces, name).push((FacetNodes::from_fn(kind, |k| local[k]), place));
        Ok(())
    }
}
