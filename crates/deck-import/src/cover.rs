//! Names of sets for nodes and facets of a body: those of the deck where they say it, new ones else.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh::{Facet, Mesh};
use stoss_mesh_io::Solids;
use stoss_mesh_io::deck::Deck;

use crate::FileNames;
use crate::bodies::{Bodies, clean};

/// The mesh of a body as the scene names it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Source {
    pub file: String,
    pub group: Option<String>,
}

/// Chooses sets, and keeps the new ones.
pub(crate) struct Cover<'a> {
    bodies: &'a Bodies,
    names: &'a FileNames,
    /// The mesh of the deck with further sets.
    mesh: Mesh,
    /// Names of all sets in upper case.
    taken: BTreeSet<String>,
    /// True if the deck itself cannot be the mesh of the scene.
    needs_mesh: bool,
    /// The meshes that the scene would read of the deck, by the groups.
    direct: Vec<Option<(Option<String>, Mesh)>>,
    /// New sets by their content.
    new_nodes: BTreeMap<Vec<u32>, String>,
    new_facets: BTreeMap<Vec<(u32, u8)>, String>,
}

/// How a set is called within a reference; nothing if no reference can name it.
fn quoted(name: &str) -> Option<String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    if name.is_empty() || name.contains(['\'', '"', ',']) || name.chars().any(char::is_control) {
        None
    } else if name.chars().all(plain) && !name.starts_with(['-', '.']) {
        Some(name.to_owned())
    } else {
        Some(format!("'{name}'"))
    }
}

impl<'a> Cover<'a> {
    pub fn new(deck: &Deck, solids: &Solids, bodies: &'a Bodies, names: &'a FileNames) -> Self {
        let mesh = solids.mesh.clone();
        let keys = mesh.node_sets.keys().chain(mesh.facet_sets.keys()).chain(mesh.element_sets.keys());
        let mut taken: BTreeSet<String> = keys.map(|name| name.to_uppercase()).collect();
        taken.extend(["ALL".to_owned(), "BOUNDARY".to_owned()]);
        let direct: Vec<Option<(Option<String>, Mesh)>> = bodies
            .all
            .iter()
            .map(|body| {
                let is_all = body.elements.len() == mesh.elements.len();
                let mut groups = mesh
                    .element_sets
                    .iter()
                    .filter(|(_, set)| **set == body.elements)
                    .map(|(name, _)| Some(name.clone()));
                let group = if is_all && deck.contents.other_elements().is_empty() { None } else { groups.next()? };
                let own = deck.contents.mesh(group.as_deref()).ok()?;
                Some((group, own))
            })
            .collect();
        let needs_mesh = direct.iter().any(Option::is_none) || !names.deck.to_lowercase().ends_with(".inp");
        let (new_nodes, new_facets) = Default::default();
        Self { bodies, names, mesh, taken, needs_mesh, direct, new_nodes, new_facets }
    }

    /// The mesh of the deck.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn reference(&self, body: usize, set: &str) -> String {
        format!("{}.{set}", self.bodies.name(body))
    }

    /// Notes that a set is used, with the number of members that it must have; `count` finds those that it has when the scene reads the deck.
    fn uses(&mut self, body: usize, size: usize, count: impl Fn(&Mesh) -> usize) {
        let fits = self.direct[body].as_ref().is_some_and(|(_, mesh)| count(mesh) == size);
        self.needs_mesh |= !fits;
    }

    /// References to sets that hold just these nodes of a body. `known` are sets of nodes of the deck, some of them or all.
    pub fn nodes(&mut self, body: usize, wanted: &BTreeSet<u32>, known: &[(&str, &[u32])], hint: &str) -> Vec<String> {
        let mut rest = wanted.clone();
        let mut names = Vec::new();
        for (name, members) in known {
            let Some(text) = quoted(name) else { continue };
            let own: Vec<u32> = members.iter().copied().filter(|n| self.bodies.all[body].nodes.contains(n)).collect();
            if own.is_empty() || !own.iter().all(|n| wanted.contains(n)) || !own.iter().any(|n| rest.contains(n)) {
                continue;
            }
            rest.retain(|n| own.binary_search(n).is_err());
            self.uses(body, own.len(), |mesh| mesh.node_sets.get(*name).map_or(0, Vec::len));
            names.push(self.reference(body, &text));
        }
        if !rest.is_empty() {
            self.needs_mesh = true;
            let content: Vec<u32> = rest.into_iter().collect();
            let name = match self.new_nodes.get(&content) {
                Some(name) => name.clone(),
                None => {
                    let name = clean(hint, &mut self.taken);
                    self.mesh.node_sets.insert(name.clone(), content.clone());
                    self.new_nodes.insert(content, name.clone());
                    name
                }
            };
            names.push(self.reference(body, &name));
        }
        names
    }

    /// As [`Self::nodes`] for facets.
    pub fn facets(
        &mut self,
        body: usize,
        wanted: &BTreeSet<Facet>,
        known: &[(&str, &[Facet])],
        hint: &str,
    ) -> Vec<String> {
        let mut rest = wanted.clone();
        let mut names = Vec::new();
        for (name, members) in known {
            let Some(text) = quoted(name) else { continue };
            let own = members.iter().filter(|facet| self.bodies.of_element(facet.element) == Some(body));
            let own: Vec<Facet> = own.copied().collect();
            if own.is_empty() || !own.iter().all(|f| wanted.contains(f)) || !own.iter().any(|f| rest.contains(f)) {
                continue;
            }
            rest.retain(|f| own.binary_search(f).is_err());
            self.uses(body, own.len(), |mesh| mesh.facet_sets.get(*name).map_or(0, Vec::len));
            names.push(self.reference(body, &text));
        }
        if !rest.is_empty() {
            self.needs_mesh = true;
            let content: Vec<(u32, u8)> = rest.iter().map(|facet| (facet.element, facet.local)).collect();
            let name = match self.new_facets.get(&content) {
                Some(name) => name.clone(),
                None => {
                    let name = clean(hint, &mut self.taken);
                    self.mesh.facet_sets.insert(name.clone(), rest.into_iter().collect());
                    self.new_facets.insert(content, name.clone());
                    name
                }
            };
            names.push(self.reference(body, &name));
        }
        names
    }

    /// The meshes of the bodies, and the mesh that must be written for them.
    pub fn finish(mut self) -> (Vec<Source>, Option<Mesh>) {
        if !self.needs_mesh {
            let file = &self.names.deck;
            let sources = self.direct.into_iter().flatten().map(|(group, _)| Source { file: file.clone(), group });
            return (sources.collect(), None);
        }
        // Names that the file cannot hold; nothing refers to them.
        let good = |name: &String| quoted(name).is_some() && name.trim() == name;
        self.mesh.node_sets.retain(|name, _| good(name));
        self.mesh.facet_sets.retain(|name, _| good(name));
        self.mesh.element_sets.retain(|name, _| good(name));
        let mut sources = Vec::new();
        for body in &self.bodies.all {
            let known = self.mesh.element_sets.iter().find(|(_, set)| **set == body.elements);
            let group = match known.map(|(name, _)| name.clone()) {
                Some(name) => name,
                None => {
                    let name = clean(&body.name, &mut self.taken);
                    self.mesh.element_sets.insert(name.clone(), body.elements.clone());
                    name
                }
            };
            sources.push(Source { file: self.names.mesh.clone(), group: Some(group) });
        }
        (sources, Some(self.mesh))
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn names_are_quoted_where_needed() {
        assert_eq!(quoted("top_1.x").as_deref(), Some("top_1.x"));
        assert_eq!(quoted("top (1)").as_deref(), Some("'top (1)'"));
        assert_eq!(quoted("-a").as_deref(), Some("'-a'"));
        for bad in ["", "it's", "a\"b", "a,b", "a\nb"] {
            assert_eq!(quoted(bad), None, "{bad:?}");
        }
    }
}
