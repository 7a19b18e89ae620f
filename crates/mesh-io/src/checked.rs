//! The checked mesh of a file, or of one of its groups.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh::{Elements, Facet, FacetIndex, Mesh, MeshError};
use stoss_reference_element::Family;

use crate::contents::{Source, entry};
use crate::{Contents, MeshIoError};

const UNUSED: u32 = u32::MAX;
/// The largest number of names in an error.
const NAMES: usize = 30;

/// What is kept of a file, by old and new numbers.
struct Kept {
    nodes: Vec<u32>,
    elements: Vec<u32>,
    /// Old numbers of the new ones.
    old_nodes: Vec<u32>,
    old_elements: Vec<u32>,
}

impl Contents {
    /// The group that a name means, in its own spelling.
    fn find_group(&self, name: &str) -> Result<String, MeshIoError> {
        let groups = self.groups();
        if groups.iter().any(|g| g == name) {
            return Ok(name.to_owned());
        }
        let same = |other: &str| self.ignore_case && other.eq_ignore_ascii_case(name);
        if let Some(found) = groups.iter().find(|g| same(g)) {
            return Ok(found.clone());
        }
        let is = |other: &String| other == name || same(other);
        let problem = if self.facet_sets.keys().chain(self.faces.keys()).chain(self.free_facets.keys()).any(is) {
            format!("{name:?} is a group of facets, and a body needs one of elements")
        } else if self.node_sets.keys().any(is) {
            format!("{name:?} is a group of nodes, and a body needs one of elements")
        } else {
            format!("there is no group {name:?}")
        };
        let known = match groups.len() {
            0 => "the file has no groups of elements: leave the group out".to_owned(),
            n => {
                let names: Vec<String> = groups.iter().take(NAMES).map(|g| format!("{g:?}")).collect();
                let more = if n > NAMES { format!(" and {} more", n - NAMES) } else { String::new() };
                format!("the groups of elements are {}{more}", names.join(", "))
            }
        };
        Err(MeshIoError::NoGroup { path: self.path().to_owned(), problem, known })
    }

    /// The checked mesh of the whole file, or of one group of elements: an instance or a set. Sets are restricted to it; of an
    /// instance its own sets have no prefix. Nodes that no element uses are dropped. Two nodes may lie at the same place
    /// ([`Mesh::coincident_nodes`]), but not two of one element.
    ///
    /// # Errors
    /// [`MeshIoError::NoGroup`]; [`MeshIoError::Unsupported`] for cells that Stoss does not compute with; everything that makes the
    /// mesh unusable, in the numbers of the file.
    pub fn mesh(&self, group: Option<&str>) -> Result<Mesh, MeshIoError> {
        self.mesh_of(group, false)
    }

    /// The mesh as [`Contents::mesh`], but groups of faces between two elements stay sets of facets, of one of the two elements each,
    /// for a mesh that is written again. A computation cannot use them: they have no outside.
    ///
    /// # Errors
    /// The errors of [`Contents::mesh`].
    pub fn mesh_with_inner_facets(&self, group: Option<&str>) -> Result<Mesh, MeshIoError> {
        self.mesh_of(group, true)
    }

    fn mesh_of(&self, group: Option<&str>, keeps_inner: bool) -> Result<Mesh, MeshIoError> {
        let group = group.map(|name| self.find_group(name)).transpose()?;
        let group = group.as_deref();
        self.refuse_others(group)?;
        let kept = self.keep_group(group);
        let mut mesh = self.unchecked(&kept, group.is_some(), keeps_inner)?;
        if let Some(instance) = group.filter(|name| self.instances.contains_key(*name)) {
            without_prefix(&mut mesh.node_sets, instance);
            without_prefix(&mut mesh.element_sets, instance);
            without_prefix(&mut mesh.facet_sets, instance);
        }
        mesh.check_allowing_coincident().map_err(|problem| self.in_file_numbers(problem, &mesh, &kept))?;
        Ok(mesh)
    }

    /// The elements that Stoss computes with, whatever else there is, not checked.
    pub(crate) fn usable(&self) -> Result<Mesh, MeshIoError> {
        self.unchecked(&self.keep(0..self.elements.len() as u32), true, false)
    }

    /// What is wrong with the elements that Stoss computes with, whatever else there is.
    pub(crate) fn check_usable(&self) -> Result<(), MeshIoError> {
        let kept = self.keep(0..self.elements.len() as u32);
        let mesh = self.unchecked(&kept, true, false)?;
        mesh.check_allowing_coincident().map_err(|problem| self.in_file_numbers(problem, &mesh, &kept))
    }

    /// The nodes and elements of the mesh of a group, by their indices here.
    pub(crate) fn kept_of(&self, group: Option<&str>) -> (Vec<u32>, Vec<u32>) {
        let group = group.and_then(|name| self.find_group(name).ok());
        let kept = self.keep_group(group.as_deref());
        (kept.old_nodes, kept.old_elements)
    }

    fn keep_group(&self, group: Option<&str>) -> Kept {
        match group {
            None => self.keep(0..self.elements.len() as u32),
            Some(name) => {
                let elements = self.instances.get(name).or_else(|| self.element_sets.get(name));
                self.keep(elements.into_iter().flatten().copied())
            }
        }
    }

    fn keep(&self, elements: impl Iterator<Item = u32>) -> Kept {
        let old_elements: Vec<u32> = elements.collect();
        let mut kept = Kept {
            nodes: vec![UNUSED; self.nodes.len()],
            elements: vec![UNUSED; self.elements.len()],
            old_nodes: Vec::new(),
            old_elements,
        };
        for (new, &e) in kept.old_elements.iter().enumerate() {
            kept.elements[e as usize] = new as u32;
            self.elements[e as usize].iter().for_each(|&n| kept.nodes[n as usize] = 0);
        }
        for (n, new) in kept.nodes.iter_mut().enumerate().filter(|(_, new)| **new != UNUSED) {
            *new = kept.old_nodes.len() as u32;
            kept.old_nodes.push(n as u32);
        }
        kept
    }

    fn unchecked(&self, kept: &Kept, is_part: bool, keeps_inner: bool) -> Result<Mesh, MeshIoError> {
        if kept.old_elements.is_empty() {
            return Err(MeshIoError::NoElements { path: self.path().to_owned() });
        }
        let nodes = kept.old_nodes.iter().map(|&n| self.nodes[n as usize]).collect();
        let mut elements = Elements::new();
        let mut renumbered = Vec::new();
        for &e in &kept.old_elements {
            renumbered.clear();
            renumbered.extend(self.elements[e as usize].iter().map(|&n| kept.nodes[n as usize]));
            elements.push(self.elements.kind(e as usize), &renumbered);
        }
        let mut mesh =
            Mesh::new(nodes, elements).map_err(|source| MeshIoError::Mesh { path: self.path().to_owned(), source })?;
        let restrict = |set: &BTreeSet<u32>, new: &[u32]| -> Vec<u32> {
            set.iter().map(|&i| new[i as usize]).filter(|&i| i != UNUSED).collect()
        };
        let sets = |sets: &BTreeMap<String, BTreeSet<u32>>, new: &[u32]| -> BTreeMap<String, Vec<u32>> {
            let restricted = sets.iter().map(|(name, set)| (name.clone(), restrict(set, new)));
            restricted.filter(|(_, set)| !set.is_empty()).collect()
        };
        mesh.node_sets = sets(&self.node_sets, &kept.nodes);
        mesh.element_sets = sets(&self.element_sets, &kept.elements);
        for (name, vectors) in &self.element_vectors {
            let of_kept = kept.old_elements.iter().map(|&e| vectors.get(e as usize).copied().unwrap_or([f64::NAN; 3]));
            mesh.element_vectors.insert(name.clone(), of_kept.collect());
        }
        for (name, set) in &self.instances {
            let elements = restrict(set, &kept.elements);
            if !elements.is_empty() {
                mesh.element_sets.entry(name.clone()).or_insert(elements);
            }
        }
        let mut facets: BTreeMap<String, BTreeSet<Facet>> = BTreeMap::new();
        for (name, set) in &self.facet_sets {
            let kept_facets = set.iter().map(|&(e, local)| (kept.elements[e as usize], local));
            let kept_facets = kept_facets.filter(|&(e, _)| e != UNUSED).map(|(e, local)| mesh.facet(e, local));
            entry(&mut facets, name).extend(kept_facets);
        }
        if !self.faces.is_empty() || !self.free_facets.is_empty() {
            let index = mesh.facet_index();
            self.match_faces(&index, &kept.nodes, is_part, keeps_inner, &mut mesh, &mut facets)?;
            let boundary = if self.free_facets.is_empty() { Vec::new() } else { index.boundary() };
            for (name, elements) in &self.free_facets {
                let of_set = |f: &&Facet| elements.contains(&kept.old_elements[f.element as usize]);
                entry(&mut facets, name).extend(boundary.iter().filter(of_set));
            }
        }
        mesh.facet_sets =
            facets.into_iter().filter(|(_, s)| !s.is_empty()).map(|(n, s)| (n, s.into_iter().collect())).collect();
        Ok(mesh)
    }

    /// Faces to facets, by their corners. A group that has a facet between two elements has no outside: it becomes a node set unless `keeps_inner`.
    /// Of a part of a file the faces of the other parts are left out.
    fn match_faces(
        &self,
        index: &FacetIndex,
        new: &[u32],
        is_part: bool,
        keeps_inner: bool,
        mesh: &mut Mesh,
        facets: &mut BTreeMap<String, BTreeSet<Facet>>,
    ) -> Result<(), MeshIoError> {
        for (name, faces) in &self.faces {
            let mut matched = BTreeSet::new();
            let mut inner = false;
            for (corners, place) in faces {
                // A corner of another part has no number here, and the index has triangles by three.
                let own = corners.map(|n| new[n as usize]);
                let found: Vec<Facet> =
                    if own.contains(&UNUSED) { Vec::new() } else { index.find(&own).copied().collect() };
                if found.is_empty() && !is_part {
                    let numbers = corners.map(|n| self.node_source[n as usize].number);
                    let shape = if corners.len() == 3 { "triangle" } else { "quadrilateral" };
                    let remedy = format!(
                        "this {shape} of group \"{name}\" is no facet of an element: mesh the volume behind it, or take the surface out of \
                         its physical group"
                    );
                    return Err(self.error(*place, format_args!("nodes {:?}", &*numbers), remedy));
                }
                let sides = if keeps_inner { 1 } else { found.len() };
                inner |= !keeps_inner && found.len() > 1;
                matched.extend(found.into_iter().take(sides));
            }
            if inner {
                let nodes: BTreeSet<u32> = matched.iter().flat_map(|f| f.nodes.iter().copied()).collect();
                mesh.node_sets.insert(name.clone(), nodes.into_iter().collect());
            } else {
                entry(facets, name).extend(matched);
            }
        }
        Ok(())
    }

    /// Problems of the mesh in the numbers of the file.
    fn in_file_numbers(&self, problem: MeshError, mesh: &Mesh, kept: &Kept) -> MeshIoError {
        let element = |e: u32| self.element_source[kept.old_elements[e as usize] as usize];
        let numbers = |elements: [u32; 2]| elements.map(|e| element(e).number);
        // Of the later one of two elements.
        let place_of = |elements: [u32; 2]| {
            let [a, b] = elements.map(|e| element(e).place);
            (self.file(a.max(b)).to_owned(), self.position(a.max(b)))
        };
        match problem {
            MeshError::InvertedElement { element: e, nodes, point, jacobian } => {
                let Source { number, place } = element(e);
                MeshIoError::InvertedElement {
                    path: self.file(place).into(),
                    at: self.position(place),
                    element: number,
                    kind: mesh.elements.kind(e as usize),
                    nodes: nodes
                        .iter()
                        .map(|&n| self.node_source[kept.old_nodes[n as usize] as usize].number)
                        .collect(),
                    point: Box::new(point),
                    jacobian,
                    remedy: remedy(mesh, e),
                }
            }
            MeshError::NonMatchingFacet { elements, kinds, .. } => {
                let (path, at) = place_of(elements);
                MeshIoError::NonMatchingFacet { path, at, elements: numbers(elements), kinds }
            }
            MeshError::NonConformingFacet { elements, kinds, centre, count } => {
                let (path, at) = place_of(elements);
                MeshIoError::NonConformingFacet { path, at, elements: numbers(elements), kinds, centre, count }
            }
            MeshError::OverlappingElements { elements, .. } => {
                let (path, at) = place_of(elements);
                MeshIoError::OverlappingElements { path, at, elements: numbers(elements) }
            }
            source => MeshIoError::Mesh { path: self.path().to_owned(), source },
        }
    }
}

/// What to do about an element with `det J <= 0`: are its corners to blame, or its other nodes?
fn remedy(mesh: &Mesh, element: u32) -> &'static str {
    let x = mesh.element_coordinates(element);
    let straight = x.kind().table().linear;
    let corners = x[..straight.node_count()].to_vec();
    let nodes = Elements::of_kind(straight, (0..corners.len() as u32).collect());
    let quality = Mesh::new(corners, nodes).map(|mesh| mesh.quality());
    if x.kind().is_quadratic() && quality.is_ok_and(|quality| quality.inverted_elements == 0) {
        return "its corners are in order: move the nodes on its edges nearer to their middles, or make cells at curved surfaces smaller (in Gmsh \
                Mesh.MeshSizeFromCurvature = 16, or Mesh.HighOrderOptimize = 2)";
    }
    match straight.table().family {
        Family::Tetrahedron => "number the first three nodes counter-clockwise seen from the fourth",
        Family::Hexahedron | Family::Wedge => "number the bottom counter-clockwise seen from the top, then the top",
    }
}

/// Sets of an instance lose its name, unless the shorter name is taken.
fn without_prefix<T>(sets: &mut BTreeMap<String, T>, instance: &str) {
    let prefix = format!("{instance}.");
    let names: Vec<String> = sets.keys().filter(|name| name.starts_with(&prefix)).cloned().collect();
    for name in names {
        let short = name[prefix.len()..].to_owned();
        if !sets.contains_key(&short)
            && let Some(set) = sets.remove(&name)
        {
            sets.insert(short, set);
        }
    }
}
