//! `*COUPLING`, `*DISTRIBUTING COUPLING` and `*RIGID BODY` to `[[rigid]]` and `[[coupling]]`.

use std::collections::BTreeSet;

use stoss_mesh::Facet;
use stoss_mesh_io::deck::{Coupling, Followers, Following, Force, Target};

use crate::context::Context;
use crate::references::Role;
use crate::severity::Severity;
use crate::text::text;

/// Adds all couplings.
pub(crate) fn couplings(context: &mut Context<'_>) {
    let deck = context.deck;
    for item in &deck.couplings {
        if let Err(consequence) = context.coupling(item) {
            let remedy = "see [[coupling]], [[joint]] and [[equation]]";
            context.list.add(Severity::Missing, item.place, item.keyword, consequence, remedy);
        }
    }
}

/// Tells what scenes of sections have no place for.
pub(crate) fn left_out_of_sections(context: &mut Context<'_>) {
    let remedy = "model the whole in space without `section`";
    for coupling in &context.deck.couplings {
        let text = "sections have no couplings: its nodes are not coupled";
        context.list.add(Severity::Missing, coupling.place, coupling.keyword, text, remedy);
    }
    for connection in &context.deck.connections {
        let text = "sections have no springs, dashpots and masses: these elements are not in the scene";
        context.list.add(Severity::Missing, connection.place, "*ELEMENT", text, remedy);
    }
}

impl Context<'_> {
    fn coupling(&mut self, item: &Coupling) -> Result<(), String> {
        let kind = match item.following {
            Some(Following::Kinematic) => "kinematic",
            Some(Following::Distributing) => "distributing",
            None => return Err("no *KINEMATIC or *DISTRIBUTING follows: its nodes are not coupled".to_owned()),
        };
        if item.freedoms[..3] != [true; 3] {
            return Err("its nodes are not coupled: it names only some of the three displacements".to_owned());
        }
        if kind == "distributing" && item.freedoms[3..] != [true; 3] && item.freedoms[3..] != [false; 3] {
            return Err("its nodes are not coupled: it names only some of the three rotations".to_owned());
        }
        let sets = self.followers(&item.followers, kind)?;
        let Some(body) = self.reference(&item.node, Role::Body) else {
            return Err(format!("its nodes are not coupled: {} is no node", text(&item.node)));
        };
        if let Some(rotations) = &item.rotations
            && self.reference(rotations, Role::RotationsOf(body)).is_none()
        {
            return Err(format!("its nodes are not coupled: {} is no node", text(rotations)));
        }
        let turns = |force: &Force| force.freedom > 2 && self.references.of(&force.nodes).contains(&body);
        let has_moment = self.deck.steps.iter().flat_map(|step| &step.forces).any(turns);
        if kind == "distributing" && item.freedoms[3..] == [false; 3] && has_moment {
            let text =
                "the moment on its reference node acts on its nodes: in the deck their rotations are not coupled";
            let remedy = "remove the moment from the scene";
            self.list.add(Severity::Missing, item.place, item.keyword, text, remedy);
        }
        let name = self.references.all[body].name.clone();
        sets.iter().for_each(|set| self.scene.coupling(kind, set, &name));
        Ok(())
    }

    /// The reference node that a line names.
    pub(crate) fn reference(&mut self, target: &Target, role: Role) -> Option<usize> {
        let own = self.lookup.nodes(target).members;
        self.references.make_named(target, &own, role)
    }

    /// References to the sets of nodes that follow.
    fn followers(&mut self, followers: &Followers, kind: &str) -> Result<Vec<String>, String> {
        const NONE: &str = "it has no node of a body: nothing is coupled";
        if let (Followers::Surface(name), "distributing") = (followers, kind)
            && let Some((surface, false)) = self.lookup.surface(name)
        {
            let facets: BTreeSet<Facet> =
                surface.members.iter().copied().filter(|facet| !self.bodies.is_inner(facet)).collect();
            let known: Vec<(&str, &[Facet])> =
                surface.name.iter().map(|name| (name.as_str(), surface.members.as_slice())).collect();
            let bodies: BTreeSet<usize> =
                facets.iter().filter_map(|facet| self.bodies.of_element(facet.element)).collect();
            let [body] = bodies.iter().copied().collect::<Vec<_>>()[..] else {
                return Err("it couples nodes of several bodies in the mean: they are not coupled".to_owned());
            };
            return Ok(self.sets.facets(body, &facets, &known, "coupled"));
        }
        let nodes: BTreeSet<u32> = match followers {
            Followers::Surface(name) => match self.lookup.surface(name) {
                Some((surface, _)) => surface.members.iter().flat_map(|facet| facet.nodes.iter().copied()).collect(),
                None => return Err(format!("there is no surface {name}: its nodes are not coupled")),
            },
            Followers::Elements(name) => {
                let elements = self.lookup.element_set(name).unwrap_or_default().members;
                let mesh = self.sets.mesh();
                elements.iter().flat_map(|&e| mesh.elements[e as usize].iter().copied()).collect()
            }
            Followers::Nodes(list) => {
                if list.iter().any(|(_, weight)| *weight != list[0].1) {
                    return Err("its nodes have different weights: they are not coupled".to_owned());
                }
                list.iter().flat_map(|(target, _)| self.lookup.nodes(target).members).collect()
            }
        };
        let mut sets = Vec::new();
        let mut count = 0;
        for b in 0..self.bodies.all.len() {
            let own: BTreeSet<u32> = nodes.iter().copied().filter(|&node| self.bodies.owner(node) == Some(b)).collect();
            if !own.is_empty() {
                count += 1;
                sets.extend(self.sets.nodes(b, &own, &[], "coupled"));
            }
        }
        match (sets.is_empty(), kind == "distributing" && count > 1) {
            (true, _) => Err(NONE.to_owned()),
            (_, true) => Err("it couples nodes of several bodies in the mean: they are not coupled".to_owned()),
            _ => Ok(sets),
        }
    }
}
