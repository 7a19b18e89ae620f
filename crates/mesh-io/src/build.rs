//! The way from a file's own numbers, which may be arbitrary, to [`Contents`].

use std::collections::HashMap;

use stoss_reference_element::{CellKind, FaceKind, FacetKind, FacetNodes};

use crate::MeshIoError;
use crate::contents::{Contents, Source, entry};
use crate::place::FileLocation;

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
    /// Copies of the nodes of plane elements in the middle of the layer and on its other side.
    copies: HashMap<u32, [Option<u32>; 2]>,
}

impl Builder {
    /// A builder with the scope 0.
    pub fn new(contents: Contents) -> Builder {
        Builder { contents, scopes: vec![Numbers::default()], copies: HashMap::new() }
    }

    /// What was collected. Plane elements are a layer from z = -1 to z = 1, and sets of their nodes have all copies of them.
    pub fn finish(mut self) -> Contents {
        if self.contents.is_plane {
            self.contents.notes.push("a section: its plane elements are a layer from z = -1 to z = 1 here".to_owned());
        }
        for (&node, copies) in &self.copies {
            self.contents.nodes[node as usize][2] = -1.0;
            for (copy, z) in copies.iter().zip([0.0, 1.0]) {
                if let Some(copy) = copy {
                    self.contents.nodes[*copy as usize][2] = z;
                }
            }
        }
        for set in self.contents.node_sets.values_mut() {
            let more: Vec<u32> =
                set.iter().filter_map(|node| self.copies.get(node)).flatten().flatten().copied().collect();
            set.extend(more);
        }
        self.contents
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
    pub fn node(&mut self, number: u64, x: [f64; 3], place: FileLocation) -> Result<(), MeshIoError> {
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
    pub fn node_number(&self, scope: usize, number: u64, place: FileLocation) -> Result<u32, MeshIoError> {
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
        place: FileLocation,
    ) -> Result<u32, MeshIoError> {
        let local = self.nodes_of(number, kind.name(), kind.node_count(), nodes, place)?;
        if self.contents.is_plane {
            return Err(self.mixed(number, place));
        }
        self.push(number, kind, &local, name, place)
    }

    /// Indices of the nodes of an element, `count` different ones.
    fn nodes_of(
        &mut self,
        number: u64,
        kind: &str,
        count: usize,
        nodes: &[u64],
        place: FileLocation,
    ) -> Result<Vec<u32>, MeshIoError> {
        let scope = self.scopes.len() - 1;
        if nodes.len() != count {
            let remedy = format!("has {} nodes, but a {kind} needs {count}", nodes.len());
            return Err(self.contents.error(place, format_args!("element {number}"), remedy));
        }
        let mut local = Vec::with_capacity(nodes.len());
        for (i, node) in nodes.iter().enumerate() {
            local.push(self.node_number(scope, *node, place)?);
            if nodes[..i].contains(node) {
                let remedy = format!(
                    "element {number} uses this node twice: collapsed elements are not supported, a {kind} has {count} different nodes"
                );
                return Err(self.contents.error(place, node, remedy));
            }
        }
        Ok(local)
    }

    /// Adds an element of these nodes.
    fn push(
        &mut self,
        number: u64,
        kind: CellKind,
        local: &[u32],
        name: &str,
        place: FileLocation,
    ) -> Result<u32, MeshIoError> {
        if let Some(&same) = self.last().by_nodes.get(local) {
            self.last().elements.insert(number, same);
            return Ok(same);
        }
        if let Some(&old) = self.last().elements.get(&number) {
            let first = self.contents.place_name(self.contents.element_source[old as usize].place);
            let remedy = format!("element {number} has other nodes in {first}: renumber one of them");
            return Err(self.contents.error(place, number, remedy));
        }
        let index = self.contents.element_source.len() as u32;
        self.contents.elements.push(kind, local);
        self.last().elements.insert(number, index);
        self.last().by_nodes.insert(local.into(), index);
        self.contents.element_source.push(Source { number, place });
        self.contents.count_cell(name, place);
        Ok(index)
    }

    /// Adds a plane element of the plane z = 0 as a layer ([`FaceKind::layer`]), its nodes in the order of its kind, counter-clockwise about z.
    pub fn plane_element(
        &mut self,
        number: u64,
        kind: FaceKind,
        nodes: &[u64],
        name: &str,
        place: FileLocation,
    ) -> Result<u32, MeshIoError> {
        let plane = self.nodes_of(number, kind.name(), kind.node_count(), nodes, place)?;
        if !(self.contents.is_plane || self.contents.elements.is_empty()) {
            return Err(self.mixed(number, place));
        }
        let x = |k: usize| self.contents.nodes[plane[k] as usize];
        if let Some(off) = (0..plane.len()).find(|&k| x(k)[2] != 0.0) {
            let remedy = format!(
                "a file without solid elements is a section in the plane z = 0, but this node is at z = {}: draw it there, or mesh the volumes",
                x(off)[2]
            );
            let value = format_args!("node {} of element {number}", nodes[off]).to_string();
            return Err(self.contents.error(place, value, remedy));
        }
        let corners = kind.corner_count();
        let twice_the_area: f64 =
            (0..corners).map(|k| (x(k), x((k + 1) % corners))).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
        if twice_the_area < 0.0 {
            let remedy = "its nodes go clockwise about z: turn the surface over";
            return Err(self.contents.error(place, format_args!("element {number}"), remedy));
        }
        let layer: Vec<u32> = kind.layer_nodes().map(|(k, zeta)| self.copy(plane[k], zeta)).collect();
        let element = self.push(number, kind.layer(), &layer, name, place)?;
        self.contents.is_plane = true;
        Ok(element)
    }

    fn mixed(&self, number: u64, place: FileLocation) -> MeshIoError {
        let remedy = "the file has plane elements and solid ones: write them to two files";
        self.contents.error(place, format_args!("element {number}"), remedy)
    }

    /// A node of the layer, above a node of plane elements, which is itself the one below.
    fn copy(&mut self, node: u32, zeta: f64) -> u32 {
        let copies = self.copies.entry(node).or_default();
        if zeta < 0.0 {
            return node;
        }
        *copies[usize::from(zeta > 0.0)].get_or_insert_with(|| {
            let index = self.contents.nodes.len() as u32;
            self.contents.nodes.push(self.contents.nodes[node as usize]);
            self.contents.node_source.push(self.contents.node_source[node as usize]);
            index
        })
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
    pub fn add_to_node_set(&mut self, name: &str, number: u64, place: FileLocation) -> Result<(), MeshIoError> {
        let node = self.node_number(0, number, place)?;
        entry(&mut self.contents.node_sets, name).insert(node);
        Ok(())
    }

    pub fn add_to_element_set(&mut self, name: &str, element: u32) {
        entry(&mut self.contents.element_sets, name).insert(element);
    }

    /// Adds an edge of plane elements of scope 0 by its ends: a face of their layer.
    pub fn add_edge(&mut self, name: &str, ends: &[u64], place: FileLocation) -> Result<(), MeshIoError> {
        let mut corners = [0; 4];
        for k in 0..2 {
            let node = self.node_number(0, ends[k], place)?;
            (corners[k], corners[3 - k]) = (node, self.copy(node, 1.0));
        }
        let edge = FacetNodes::from_fn(FacetKind::Quad4, |k| corners[k]);
        entry(&mut self.contents.faces, name).push((edge, place));
        Ok(())
    }

    /// Adds a face of scope 0 by its three or four corners, which must be those of a facet of an element.
    pub fn add_face(&mut self, name: &str, corners: &[u64], place: FileLocation) -> Result<(), MeshIoError> {
        let mut local = [0; 4];
        for (local, &corner) in local.iter_mut().zip(corners) {
            *local = self.node_number(0, corner, place)?;
        }
        let kind = if corners.len() == 3 { FacetKind::Tri3 } else { FacetKind::Quad4 };
        entry(&mut self.contents.faces, name).push((FacetNodes::from_fn(kind, |k| local[k]), place));
        Ok(())
    }
}
