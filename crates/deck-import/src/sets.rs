//! Names and numbers of the deck, looked up in the mesh.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh::Facet;
use stoss_mesh_io::deck::Target;
use stoss_mesh_io::{Contents, Solids};

/// The nodes, facets or elements that a line of the deck names, sorted; with the name that a scene can use if one set of the mesh is just that.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Selection<T> {
    pub name: Option<String>,
    pub members: Vec<T>,
}

/// Selections of some records that have a name, with it.
pub(crate) fn named<'m, T>(selections: &'m [Selection<T>], records: &BTreeSet<u32>) -> Vec<(&'m str, &'m [T])> {
    let own = records.iter().map(|&record| &selections[record as usize]);
    own.filter_map(|selection| Some((selection.name.as_deref()?, selection.members.as_slice()))).collect()
}

/// Sets of the mesh by their names in upper case, nodes and elements by their numbers.
pub(crate) struct Lookup<'a> {
    contents: &'a Contents,
    solids: &'a Solids,
    node_sets: BTreeMap<String, &'a String>,
    facet_sets: BTreeMap<String, &'a String>,
    element_sets: BTreeMap<String, &'a String>,
    nodes: BTreeMap<u64, Vec<u32>>,
    elements: BTreeMap<u64, Vec<u32>>,
}

/// Names in the spelling of the mesh by those in upper case.
fn by_upper<T>(sets: &BTreeMap<String, T>) -> BTreeMap<String, &String> {
    sets.keys().map(|name| (name.to_uppercase(), name)).collect()
}

fn by_number(numbers: &[u64]) -> BTreeMap<u64, Vec<u32>> {
    let mut all: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
    for (index, &number) in numbers.iter().enumerate() {
        all.entry(number).or_default().push(index as u32);
    }
    all
}

/// The set of a name; if there is none, the union of the sets of all instances that have it.
fn find<T: Copy + Ord>(
    names: &BTreeMap<String, &String>,
    sets: &BTreeMap<String, Vec<T>>,
    name: &str,
) -> Option<Selection<T>> {
    let upper = name.to_uppercase();
    if let Some(&own) = names.get(&upper) {
        return Some(Selection { name: Some(own.clone()), members: sorted(sets[own].iter().copied()) });
    }
    let ending = format!(".{upper}");
    let of_instances = names.iter().filter(|(other, _)| other.ends_with(&ending));
    let members = sorted(of_instances.flat_map(|(_, own)| sets[*own].iter().copied()));
    if members.is_empty() { None } else { Some(Selection { name: None, members }) }
}

fn sorted<T: Ord>(members: impl Iterator<Item = T>) -> Vec<T> {
    members.collect::<BTreeSet<T>>().into_iter().collect()
}

impl<'a> Lookup<'a> {
    pub fn new(contents: &'a Contents, solids: &'a Solids) -> Self {
        Self {
            contents,
            solids,
            node_sets: by_upper(&solids.mesh.node_sets),
            facet_sets: by_upper(&solids.mesh.facet_sets),
            element_sets: by_upper(&solids.mesh.element_sets),
            nodes: by_number(&solids.node_numbers),
            elements: by_number(&solids.element_numbers),
        }
    }

    /// Nodes that belong to elements which are read; nothing if there is no such set, or none of its nodes belongs to one.
    pub fn nodes(&self, target: &Target) -> Selection<u32> {
        match target {
            Target::All => Selection { name: None, members: (0..self.solids.mesh.nodes.len() as u32).collect() },
            Target::Set(name) => self.node_set(name).unwrap_or_default(),
            Target::Number { number, instance } => {
                let all = self.nodes.get(number).cloned().unwrap_or_default();
                let members = match self.instance(instance.as_deref()) {
                    None => all,
                    Some(elements) => {
                        let own = |e: &u32| self.solids.mesh.elements[*e as usize].iter().copied();
                        let own: BTreeSet<u32> = elements.members.iter().flat_map(own).collect();
                        all.into_iter().filter(|node| own.contains(node)).collect()
                    }
                };
                Selection { name: None, members }
            }
        }
    }

    /// The elements of an instance, if one is named that there is.
    fn instance(&self, name: Option<&str>) -> Option<Selection<u32>> {
        name.and_then(|name| self.element_set(name))
    }

    /// A name without the only instance, whose sets have none of it.
    fn own<'n>(&self, name: &'n str) -> &'n str {
        let after = |instance: &str| {
            let (before, after) = name.split_once('.')?;
            before.eq_ignore_ascii_case(instance).then_some(after)
        };
        self.contents.only_instance().and_then(after).unwrap_or(name)
    }

    pub fn node_set(&self, name: &str) -> Option<Selection<u32>> {
        find(&self.node_sets, &self.solids.mesh.node_sets, self.own(name))
    }

    /// How many nodes a set has, whether or not they belong to elements which are read.
    pub fn node_set_size(&self, name: &str) -> usize {
        let upper = name.to_uppercase();
        let ending = format!(".{upper}");
        let sizes = || self.contents.node_set_sizes().map(|(name, size)| (name.to_uppercase(), size));
        match sizes().find(|(name, _)| *name == upper) {
            Some((_, size)) => size,
            None => sizes().filter(|(name, _)| name.ends_with(&ending)).map(|(_, size)| size).sum(),
        }
    }

    pub fn elements(&self, target: &Target) -> Selection<u32> {
        match target {
            Target::All => Selection { name: None, members: (0..self.solids.mesh.elements.len() as u32).collect() },
            Target::Set(name) => self.element_set(name).unwrap_or_default(),
            Target::Number { number, instance } => {
                let all = self.elements.get(number).cloned().unwrap_or_default();
                let members = match self.instance(instance.as_deref()) {
                    None => all,
                    Some(own) => all.into_iter().filter(|e| own.members.binary_search(e).is_ok()).collect(),
                };
                Selection { name: None, members }
            }
        }
    }

    pub fn element_set(&self, name: &str) -> Option<Selection<u32>> {
        find(&self.element_sets, &self.solids.mesh.element_sets, self.own(name))
    }

    /// The elements of a set of a part: those of its instances.
    pub fn elements_of_part(&self, part: &str, set: &str) -> Vec<u32> {
        let own = self.contents.instances_of(part);
        let names = own.iter().map(|instance| format!("{instance}.{set}"));
        let found: Vec<u32> = names
            .filter_map(|name| self.element_sets.get(&name.to_uppercase()))
            .flat_map(|name| self.solids.mesh.element_sets[*name].iter().copied())
            .collect();
        // One instance has its sets without its name.
        if found.is_empty() { self.element_set(set).unwrap_or_default().members } else { sorted(found.into_iter()) }
    }

    /// The facets of a surface. A surface of nodes is the boundary facets all of whose corners belong to it; true then.
    pub fn surface(&self, name: &str) -> Option<(Selection<Facet>, bool)> {
        if let Some(facets) = find(&self.facet_sets, &self.solids.mesh.facet_sets, self.own(name)) {
            return Some((facets, false));
        }
        let nodes: BTreeSet<u32> = self.node_set(name)?.members.into_iter().collect();
        let boundary = self.solids.mesh.boundary_facets();
        let members: Vec<Facet> = boundary
            .into_iter()
            .filter(|facet| facet.nodes.corners().iter().all(|node| nodes.contains(node)))
            .collect();
        if members.is_empty() { None } else { Some((Selection { name: None, members }, true)) }
    }

    /// True if there is a set of nodes of this name.
    pub fn has_node_set(&self, name: &str) -> bool {
        self.node_set(name).is_some()
    }
}
