//! `*CONTACT PAIR` to `[[contact]]`, `*TIE` to `[[tie]]`; ties between bodies of different materials that share nodes.

use std::collections::BTreeSet;

use stoss_mesh::Facet;
use stoss_mesh_io::deck::{ChangeKind, ContactPair, DeckPlace, Interaction};

use crate::adjust::{Moved, Which};
use crate::context::Context;
use crate::sets::Selection;
use crate::severity::Severity;
use crate::text::{count, number};

/// The coefficient in place of `ROUGH` of `*FRICTION`.
const ROUGH: f64 = 10.0;

/// Adds all ties.
pub(crate) fn ties(context: &mut Context<'_>) {
    context.ties_of_interfaces();
    context.ties();
}

/// Adds all contacts.
pub(crate) fn pairs(context: &mut Context<'_>) {
    context.contact_pairs();
}

impl Context<'_> {
    /// The two surfaces of a pair or tie; nothing, with an entry, if one of them is not there.
    fn surfaces(&mut self, names: [&str; 2], keyword: &str, place: DeckPlace) -> Option<[Selection<Facet>; 2]> {
        let surfaces = names.map(|name| self.surface(name, keyword, place));
        let [slave, master] = surfaces;
        Some([slave?, master?])
    }

    fn surface(&mut self, name: &str, keyword: &str, place: DeckPlace) -> Option<Selection<Facet>> {
        let Some((surface, is_of_nodes)) = self.lookup.surface(name) else {
            let why = if self.lookup.has_node_set(name) {
                "no facet of the boundary has all its corners in this node set"
            } else {
                "there is no surface of solid elements with this name"
            };
            let consequence = format!("{name}: {why}: the two surfaces do not act on each other");
            self.list.add(Severity::Missing, place, keyword, consequence, "give it a surface of element faces");
            return None;
        };
        if is_of_nodes {
            let consequence = format!(
                "{name} is a surface of nodes: it is replaced by the facets of the boundary that have all their corners in it"
            );
            self.list.add(Severity::Changed, place, keyword, consequence, "");
        }
        Some(surface)
    }

    /// The reference to the facets of a surface that belong to a body; nothing if there are none.
    fn facets_of_body(&mut self, surface: &Selection<Facet>, body: usize, hint: &str) -> Option<String> {
        let own = surface.members.iter().copied();
        let own =
            own.filter(|facet| self.bodies.of_element(facet.element) == Some(body) && !self.bodies.is_inner(facet));
        let own: BTreeSet<Facet> = own.collect();
        if own.is_empty() {
            return None;
        }
        let known: Vec<(&str, &[Facet])> =
            surface.name.iter().map(|name| (name.as_str(), surface.members.as_slice())).collect();
        // One set or one new set: the whole of what is wanted.
        self.sets.facets(body, &own, &known, hint).pop()
    }

    /// Ties where bodies of different materials share facets.
    fn ties_of_interfaces(&mut self) {
        let bodies = self.bodies;
        for ((slave, master), facets) in &bodies.interfaces {
            let surface = Selection { name: None, members: facets.clone() };
            let hint = format!("{}+{}", bodies.name(*slave), bodies.name(*master));
            let slave = self.facets_of_body(&surface, *slave, &hint);
            let master = self.facets_of_body(&surface, *master, &hint);
            if let (Some(slave), Some(master)) = (slave, master) {
                self.scene.tie(&slave, &master, &[]);
            }
        }
    }

    fn ties(&mut self) {
        let deck = self.deck;
        for tie in &deck.ties {
            let names = [tie.slave.as_str(), tie.master.as_str()];
            let Some(surfaces) = self.surfaces(names, "*TIE", tie.place) else { continue };
            let mut keys = Vec::new();
            if let Some(reach) = tie.tolerance.filter(|reach| *reach > 0.0) {
                keys.push(format!("reach = {}", number(reach)));
            }
            if !tie.adjusts {
                keys.push("interface = \"keep\"".to_owned());
            }
            let pairs = self.between_bodies(&surfaces, names, true);
            if pairs.is_empty() {
                let consequence = "no two of their facets belong to bodies that can be tied: they are not joined";
                self.list.add(Severity::Missing, tie.place, "*TIE", consequence, "");
            }
            pairs.iter().for_each(|[slave, master]| self.scene.tie(slave, master, &keys));
        }
    }

    /// References to the two surfaces for each pair of bodies that they belong to. `same_body`: also of one body, if the surfaces share no node.
    fn between_bodies(
        &mut self,
        [slave, master]: &[Selection<Facet>; 2],
        [slave_name, master_name]: [&str; 2],
        same_body: bool,
    ) -> Vec<[String; 2]> {
        let bodies = self.bodies;
        let of = |surface: &Selection<Facet>| -> BTreeSet<usize> {
            surface.members.iter().filter_map(|facet| bodies.of_element(facet.element)).collect()
        };
        let shares_nodes = || {
            let own: BTreeSet<u32> = slave.members.iter().flat_map(|facet| facet.nodes.iter().copied()).collect();
            master.members.iter().any(|facet| facet.nodes.iter().any(|node| own.contains(node)))
        };
        let mut pairs = Vec::new();
        for s in of(slave) {
            for m in of(master) {
                if s == m && (!same_body || shares_nodes()) {
                    continue;
                }
                let slave = self.facets_of_body(slave, s, slave_name);
                let master = self.facets_of_body(master, m, master_name);
                if let (Some(slave), Some(master)) = (slave, master) {
                    pairs.push([slave, master]);
                }
            }
        }
        pairs
    }

    fn contact_pairs(&mut self) {
        let deck = self.deck;
        for pair in &deck.pairs {
            if pair.slave.eq_ignore_ascii_case(&pair.master) {
                let consequence = "contact of a surface with itself is left out";
                self.list.add(Severity::Missing, pair.place, "*CONTACT PAIR", consequence, "see [general_contact]");
                continue;
            }
            let names = [pair.slave.as_str(), pair.master.as_str()];
            let Some(surfaces) = self.surfaces(names, "*CONTACT PAIR", pair.place) else { continue };
            let interaction = pair.interaction.as_ref().and_then(|name| {
                let found = deck.interactions.iter().find(|i| i.name.eq_ignore_ascii_case(name));
                if found.is_none() {
                    let consequence =
                        format!("there is no interaction {name}: the contact is hard and has no friction");
                    self.list.add(Severity::Changed, pair.place, "*CONTACT PAIR", consequence, "");
                }
                found
            });
            if interaction.and_then(|i| i.behavior.as_ref()).is_some_and(|behavior| behavior.law == "TIED") {
                let pairs = self.between_bodies(&surfaces, names, true);
                if pairs.is_empty() {
                    let consequence = "no two of its facets belong to bodies that can be tied: they are not joined";
                    self.list.add(Severity::Missing, pair.place, "*CONTACT PAIR", consequence, "");
                }
                pairs.iter().for_each(|[slave, master]| self.scene.tie(slave, master, &[]));
                self.report_changes_of_tie(pair);
                continue;
            }
            self.adjust(pair, &surfaces);
            let variants = self.variants(pair, interaction);
            let pairs = self.between_bodies(&surfaces, names, false);
            if pairs.is_empty() {
                let consequence = "both surfaces belong to one connected body: the contact is left out";
                let remedy = "see [general_contact], which includes contact of a body with itself";
                self.list.add(Severity::Missing, pair.place, "*CONTACT PAIR", consequence, remedy);
            }
            for (keys, active) in &variants {
                pairs.iter().for_each(|[slave, master]| self.scene.contact(slave, master, keys, active));
            }
        }
    }

    /// Entries for changes of a pair that is tied: a tie acts at all times.
    fn report_changes_of_tie(&mut self, pair: &ContactPair) {
        let deck = self.deck;
        for change in deck.steps.iter().flat_map(|step| &step.changes) {
            let is_own = match &change.kind {
                ChangeKind::Friction(..) => false,
                ChangeKind::Behavior(name, _) => {
                    pair.interaction.as_ref().is_some_and(|own| own.eq_ignore_ascii_case(name))
                }
                ChangeKind::Contact { slave, master, .. } => {
                    slave.eq_ignore_ascii_case(&pair.slave) && master.eq_ignore_ascii_case(&pair.master)
                }
            };
            if is_own {
                let consequence = "the surfaces are tied, and a [[tie]] acts at all times: nothing changes";
                self.list.add(
                    Severity::Missing,
                    change.place,
                    "change of a tied contact pair",
                    consequence,
                    "use a [[contact]] in place of the tie",
                );
            }
        }
    }

    /// The keys of a contact in the stages in which it acts with them: one contact for each of what steps make of it.
    fn variants(&mut self, pair: &ContactPair, interaction: Option<&Interaction>) -> Vec<(Vec<String>, Vec<bool>)> {
        let mut own = interaction.cloned();
        let mut acts = true;
        let mut by_stage = Vec::new();
        let deck = self.deck;
        let mut stages = self.timeline.stages.iter().filter_map(|stage| stage.step).peekable();
        for (s, step) in deck.steps.iter().enumerate() {
            for change in &step.changes {
                let is_own = |name: &str| pair.interaction.as_ref().is_some_and(|own| own.eq_ignore_ascii_case(name));
                match (&change.kind, &mut own) {
                    (ChangeKind::Friction(name, friction), Some(own)) if is_own(name) => own.friction = Some(*friction),
                    (ChangeKind::Behavior(name, behavior), Some(own)) if is_own(name) => {
                        own.behavior = Some(behavior.clone());
                    }
                    (ChangeKind::Contact { slave, master, acts: now }, _)
                        if slave.eq_ignore_ascii_case(&pair.slave) && master.eq_ignore_ascii_case(&pair.master) =>
                    {
                        acts = *now;
                    }
                    _ => {}
                }
            }
            if stages.next_if_eq(&s).is_some() {
                by_stage.push((acts, own.clone()));
            }
        }
        if by_stage.is_empty() {
            by_stage = vec![(acts, own); self.timeline.stages.len()];
        }
        let count = by_stage.len();
        let mut all: Vec<(Option<Interaction>, Vec<bool>)> = Vec::new();
        for (stage, (acts, own)) in by_stage.into_iter().enumerate().filter(|(_, (acts, _))| *acts) {
            let known = all.iter().position(|(other, _)| *other == own).unwrap_or_else(|| {
                all.push((own, vec![false; count]));
                all.len() - 1
            });
            all[known].1[stage] = acts;
        }
        all.into_iter().map(|(own, active)| (self.contact_keys(pair, own.as_ref()), active)).collect()
    }

    /// Moves slave nodes onto the master surface, as `ADJUST` says.
    fn adjust(&mut self, pair: &ContactPair, [slave, master]: &[Selection<Facet>; 2]) {
        const WHAT: &str = "*CONTACT PAIR, ADJUST";
        let Some(adjust) = &pair.adjust else { return };
        let set;
        let which = match adjust.trim().parse::<f64>() {
            Ok(distance) if distance >= 0.0 => Which::Within(distance),
            Ok(_) => {
                let consequence =
                    format!("ADJUST={adjust} is negative: nodes are not moved, gaps are those of the mesh");
                self.list.add(Severity::Missing, pair.place, WHAT, consequence, "give a distance that is not negative");
                return;
            }
            Err(_) => match self.lookup.node_set(adjust) {
                Some(found) => {
                    set = found.members;
                    Which::Of(&set)
                }
                None => {
                    let consequence = format!(
                        "there is no node set {adjust} with nodes of solids: nodes are not moved, gaps are those of the mesh"
                    );
                    self.list.add(
                        Severity::Missing,
                        pair.place,
                        WHAT,
                        consequence,
                        "name a set of slave nodes, or a distance",
                    );
                    return;
                }
            },
        };
        let bodies = self.bodies;
        let of_bodies = |surface: &Selection<Facet>| -> Vec<Facet> {
            let own = surface.members.iter().copied();
            own.filter(|facet| bodies.of_element(facet.element).is_some() && !bodies.is_inner(facet)).collect()
        };
        let Moved { count: number, farthest, too_deep } =
            self.sets.adjust(&of_bodies(slave), &of_bodies(master), which);
        if number > 0 {
            let consequence = format!(
                "{} of {} moved onto {} without strain, by at most {farthest:.3e}, in the mesh beside the scene",
                count(number, "node", "nodes"),
                pair.slave,
                pair.master
            );
            self.list.add(Severity::Note, pair.place, WHAT, consequence, "");
        }
        if too_deep > 0 {
            let consequence = format!(
                "{} of {} behind {} by more than one of its edges: not moved",
                count(too_deep, "node is", "nodes are"),
                pair.slave,
                pair.master
            );
            self.list.add(Severity::Changed, pair.place, WHAT, consequence, "name surfaces that face each other");
        }
    }

    /// Keys of a contact but for the surfaces.
    fn contact_keys(&mut self, pair: &ContactPair, interaction: Option<&Interaction>) -> Vec<String> {
        let mut keys = Vec::new();
        if let Some(kind) = pair.kind.as_ref().filter(|kind| !kind.ends_with("MORTAR")) {
            self.list.add_unread(pair.place, format!("parameter TYPE of *CONTACT PAIR, {kind}"));
        }
        if pair.is_small_sliding {
            let consequence = "SMALL SLIDING is not used: surfaces may slide by any distance";
            self.list.add(Severity::Note, pair.place, "*CONTACT PAIR", consequence, "");
        }
        let Some(interaction) = interaction else { return keys };
        keys.extend(self.contact_stiffness(interaction));
        let Some(friction) = interaction.friction else { return keys };
        let mu = if friction.coefficient.is_finite() { friction.coefficient } else { ROUGH };
        if !friction.coefficient.is_finite() {
            let consequence =
                format!("ROUGH: the coefficient of friction is {ROUGH}, and closed surfaces may still open");
            self.list.add(Severity::Changed, interaction.place, "*FRICTION", consequence, "");
        }
        let slope = friction.stick_slope.filter(|slope| *slope > 0.0);
        let stick = match slope.filter(|_| !self.timeline.is_dynamic()) {
            Some(slope) => format!(", stick = \"penalty\", penalty = {}", number(slope)),
            None => String::new(),
        };
        if slope.is_some() && stick.is_empty() {
            let consequence = "the stick slope is not used: points that stick do not slide at all";
            let remedy = "for a stiffness see `stick` of `friction`";
            self.list.add(Severity::Changed, interaction.place, "*FRICTION", consequence, remedy);
        }
        if mu > 0.0 {
            keys.push(format!("friction = {{ law = \"coulomb\", mu = {}{stick} }}", number(mu)));
        }
        keys
    }

    /// The key of a contact that is not hard.
    fn contact_stiffness(&mut self, interaction: &Interaction) -> Option<String> {
        let behavior = interaction.behavior.as_ref()?;
        let slope = behavior.values.first().and_then(|row| row.first()).copied().filter(|slope| *slope > 0.0);
        let consequence = match (behavior.law.as_str(), slope) {
            ("HARD", _) => return None,
            ("LINEAR", Some(slope)) if !self.timeline.is_dynamic() => {
                return Some(format!("enforcement = {{ penalty = {} }}", number(slope)));
            }
            ("LINEAR", Some(slope)) => format!(
                "*SURFACE BEHAVIOR, LINEAR with the slope {}: the contact is hard, so that energy is kept",
                number(slope)
            ),
            (law, _) => format!("*SURFACE BEHAVIOR, {law}: the contact is hard"),
        };
        let remedy = "for a penalty stiffness see `enforcement` of [[contact]]";
        self.list.add(Severity::Changed, interaction.place, "*SURFACE INTERACTION", consequence, remedy);
        None
    }
}
