//! Names of sets for nodes and facets of a body: those of the deck where it has such sets, else new ones.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh::{Facet, Mesh};
use stoss_mesh_io::Solids;
use stoss_mesh_io::deck::Deck;

use crate::FileNames;
use crate::adjust::{Moved, Which, adjust};
use crate::bodies::{Bodies, unique_name};

/// The mesh of a body as the scene names it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Source {
    pub file: String,
    pub group: Option<String>,
}

/// Chooses names, and keeps the new sets.
pub(crate) struct SetNames<'a> {
    bodies: &'a Bodies,
    names: &'a FileNames,
    /// The mesh of the deck with further sets.
    mesh: Mesh,
    /// Names of all sets in upper case.
    taken: BTreeSet<String>,
    /// True if the deck itself cannot be the mesh of the scene.
    needs_mesh: bool,
    /// Group of the deck that is the mesh of each body, and that mesh as the scene would read it; none if there is no such group.
    direct: Vec<Option<(Option<String>, Mesh)>>,
    /// New sets by their content.
    new_nodes: BTreeMap<Vec<u32>, String>,
    new_facets: BTreeMap<Vec<Facet>, String>,
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

impl<'a> SetNames<'a> {
    /// `is_cut`: the mesh is another one than that of the deck.
    pub fn new(deck: &Deck, solids: &Solids, bodies: &'a Bodies, names: &'a FileNames, is_cut: bool) -> Self {
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
                let own = deck.contents.mesh(group.as_deref()).ok().filter(|_| !is_cut)?;
                Some((group, own))
            })
            .collect();
        let needs_mesh = direct.iter().any(Option::is_none) || !names.deck.to_lowercase().ends_with(".inp");
        let (new_nodes, new_facets) = (BTreeMap::new(), BTreeMap::new());
        Self { bodies, names, mesh, taken, needs_mesh, direct, new_nodes, new_facets }
    }

    /// The mesh of the deck.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Moves nodes of the mesh, which is then written beside the scene if any is moved.
    pub fn adjust(&mut self, slave: &[Facet], master: &[Facet], which: Which<'_>) -> Moved {
        let moved = adjust(&mut self.mesh.nodes, slave, master, which);
        self.needs_mesh |= moved.count > 0;
        moved
    }

    fn reference(&self, body: usize, set: &str) -> String {
        format!("{}.{set}", self.bodies.name(body))
    }

    /// References to sets that hold just these nodes of a body. `known` are sets of nodes of the deck, some of them or all.
    pub fn nodes(&mut self, body: usize, wanted: &BTreeSet<u32>, known: &[(&str, &[u32])], hint: &str) -> Vec<String> {
        let own = &self.bodies.all[body].nodes;
        let count = |mesh: &Mesh, name: &str| mesh.node_sets.get(name).map_or(0, Vec::len);
        let (mut names, rest) = self.known_sets(body, wanted, known, |node| own.contains(node), count);
        if !rest.is_empty() {
            let name = self.new_nodes.get(&rest).cloned().unwrap_or_else(|| unique_name(hint, &mut self.taken));
            names.push(self.reference(body, &name));
            self.mesh.node_sets.insert(name.clone(), rest.clone());
            self.new_nodes.insert(rest, name);
        }
        names
    }

    /// References to sets that hold just these facets of a body, as of [`Self::nodes`].
    pub fn facets(
        &mut self,
        body: usize,
        wanted: &BTreeSet<Facet>,
        known: &[(&str, &[Facet])],
        hint: &str,
    ) -> Vec<String> {
        let bodies = self.bodies;
        let count = |mesh: &Mesh, name: &str| mesh.facet_sets.get(name).map_or(0, Vec::len);
        let is_own = |facet: &Facet| bodies.of_element(facet.element) == Some(body);
        let (mut names, rest) = self.known_sets(body, wanted, known, is_own, count);
        if !rest.is_empty() {
            let name = self.new_facets.get(&rest).cloned().unwrap_or_else(|| unique_name(hint, &mut self.taken));
            names.push(self.reference(body, &name));
            self.mesh.facet_sets.insert(name.clone(), rest.clone());
            self.new_facets.insert(rest, name);
        }
        names
    }

    /// References to those known sets of which all that belongs to the body is wanted, and what is left. `count`: how many members a set has in the mesh that the
    /// scene reads of the deck.
    fn known_sets<T: Copy + Ord>(
        &mut self,
        body: usize,
        wanted: &BTreeSet<T>,
        known: &[(&str, &[T])],
        is_own: impl Fn(&T) -> bool,
        count: impl Fn(&Mesh, &str) -> usize,
    ) -> (Vec<String>, Vec<T>) {
        let mut rest = wanted.clone();
        let mut names = Vec::new();
        for (name, members) in known {
            let Some(text) = quoted(name) else { continue };
            let own: Vec<T> = members.iter().copied().filter(&is_own).collect();
            let adds = own.iter().any(|member| rest.contains(member));
            if !adds || !own.iter().all(|member| wanted.contains(member)) {
                continue;
            }
            for member in &own {
                rest.remove(member);
            }
            let is_whole = self.direct[body].as_ref().is_some_and(|(_, mesh)| count(mesh, name) == own.len());
            self.needs_mesh |= !is_whole;
            names.push(self.reference(body, &text));
        }
        self.needs_mesh |= !rest.is_empty();
        (names, rest.into_iter().collect())
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
                    let name = unique_name(&body.name, &mut self.taken);
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
