//! `*CONTACT PAIR` to `[[contact]]`, `*TIE` to `[[tie]]`; ties between bodies of different materials that share nodes.

use std::collections::BTreeSet;

use stoss_mesh::Facet;
use stoss_mesh_io::deck::{ContactPair, Deck, DeckPlace, Interaction};

use crate::bodies::Bodies;
use crate::cover::Cover;
use crate::left_out::List;
use crate::sets::{Lookup, Meant};
use crate::text::number;
use crate::timeline::Timeline;
use crate::write::Tables;

/// `ROUGH` of `*FRICTION`: a coefficient that nothing overcomes.
const ROUGH: f64 = 10.0;

/// The two surfaces of a pair or tie; nothing, with an entry, if one of them is not there.
fn surfaces(
    lookup: &Lookup<'_>,
    names: [&str; 2],
    what: &str,
    place: DeckPlace,
    list: &mut List,
) -> Option<[Meant<Facet>; 2]> {
    let mut found = names.map(|name| lookup.surface(name).map(|(surface, of_nodes)| (name, surface, of_nodes)));
    let mut take = |index: usize| {
        let Some((name, surface, of_nodes)) = found[index].take() else {
            let name = names[index];
            let why = if lookup.has_node_set(name) {
                "its nodes are those of no facet of the boundary"
            } else {
                "there is no surface of solid elements with this name"
            };
            list.add(
                place,
                what,
                format!("{name}: {why}: there is no contact between the two"),
                "give it a surface of element faces",
            );
            return None;
        };
        if of_nodes {
            let consequence =
                format!("{name} is a surface of nodes: it is taken for the boundary facets whose corners they are");
            list.add(place, what, consequence, "");
        }
        Some(surface)
    };
    let (slave, master) = (take(0), take(1));
    Some([slave?, master?])
}

/// The reference to the facets of a surface that belong to a body; nothing if there are none.
fn of_body(surface: &Meant<Facet>, body: usize, bodies: &Bodies, cover: &mut Cover<'_>, hint: &str) -> Option<String> {
    let own = surface.members.iter().copied();
    let own = own.filter(|facet| bodies.of_element(facet.element) == Some(body) && !bodies.is_inner(facet));
    let own: BTreeSet<Facet> = own.collect();
    if own.is_empty() {
        return None;
    }
    let known: Vec<(&str, &[Facet])> =
        surface.name.iter().map(|name| (name.as_str(), surface.members.as_slice())).collect();
    // One set or one new set: the whole of what is wanted.
    cover.facets(body, &own, &known, hint).pop()
}

/// All ties.
pub(crate) fn ties(
    deck: &Deck,
    bodies: &Bodies,
    lookup: &Lookup<'_>,
    cover: &mut Cover<'_>,
    scene: &mut Tables,
    list: &mut List,
) {
    for ((slave, master), facets) in &bodies.interfaces {
        let surface = Meant { name: None, members: facets.clone() };
        let hint = format!("{}+{}", bodies.name(*slave), bodies.name(*master));
        let slave = of_body(&surface, *slave, bodies, cover, &hint);
        let master = of_body(&surface, *master, bodies, cover, &hint);
        if let (Some(slave), Some(master)) = (slave, master) {
            scene.tie(&slave, &master, &[]);
        }
    }
    for tie in &deck.ties {
        let Some(pair) = surfaces(lookup, [&tie.slave, &tie.master], "*TIE", tie.place, list) else { continue };
        let mut keys = Vec::new();
        if let Some(reach) = tie.tolerance.filter(|reach| *reach > 0.0) {
            keys.push(format!("reach = {}", number(reach)));
        }
        if !tie.adjusts {
            keys.push("interface = \"keep\"".to_owned());
        }
        if !between(&pair, [&tie.slave, &tie.master], bodies, cover, true, |slave, master| {
            scene.tie(slave, master, &keys)
        }) {
            list.add(tie.place, "*TIE", "no two facets of bodies can be tied: the two surfaces are not joined", "");
        }
    }
}

/// Calls `add` for all pairs of bodies that two surfaces belong to; false if there are none.
fn between(
    [slave, master]: &[Meant<Facet>; 2],
    [slave_name, master_name]: [&str; 2],
    bodies: &Bodies,
    cover: &mut Cover<'_>,
    same_body: bool,
    mut add: impl FnMut(&str, &str),
) -> bool {
    let of = |surface: &Meant<Facet>| -> BTreeSet<usize> {
        surface.members.iter().filter_map(|facet| bodies.of_element(facet.element)).collect()
    };
    let mut any = false;
    for s in of(slave) {
        for m in of(master) {
            let shares_nodes = || {
                let own: BTreeSet<u32> = slave.members.iter().flat_map(|facet| facet.nodes.iter().copied()).collect();
                master.members.iter().any(|facet| facet.nodes.iter().any(|node| own.contains(node)))
            };
            if s == m && (!same_body || shares_nodes()) {
                continue;
            }
            let slave = of_body(slave, s, bodies, cover, slave_name);
            let master = of_body(master, m, bodies, cover, master_name);
            if let (Some(slave), Some(master)) = (slave, master) {
                add(&slave, &master);
                any = true;
            }
        }
    }
    any
}

/// All contact pairs.
pub(crate) fn pairs(
    deck: &Deck,
    bodies: &Bodies,
    lookup: &Lookup<'_>,
    timeline: &Timeline,
    cover: &mut Cover<'_>,
    scene: &mut Tables,
    list: &mut List,
) {
    for pair in &deck.pairs {
        if pair.slave.eq_ignore_ascii_case(&pair.master) {
            list.add(
                pair.place,
                "*CONTACT PAIR",
                "contact of a surface with itself is left out",
                "see [general_contact]",
            );
            continue;
        }
        let names = [pair.slave.as_str(), pair.master.as_str()];
        let Some(surfaces) = surfaces(lookup, names, "*CONTACT PAIR", pair.place, list) else { continue };
        let interaction = pair.interaction.as_ref().and_then(|name| {
            let found = deck.interactions.iter().find(|i| i.name.eq_ignore_ascii_case(name));
            if found.is_none() {
                let consequence = format!("there is no interaction {name}: the contact is hard and has no friction");
                list.add(pair.place, "*CONTACT PAIR", consequence, "");
            }
            found
        });
        if interaction.and_then(|i| i.behavior.as_ref()).is_some_and(|behavior| behavior.law == "TIED") {
            between(&surfaces, names, bodies, cover, true, |slave, master| scene.tie(slave, master, &[]));
            continue;
        }
        let keys = keys(pair, interaction, timeline, list);
        if !between(&surfaces, names, bodies, cover, false, |slave, master| scene.contact(slave, master, &keys)) {
            list.add(
                pair.place,
                "*CONTACT PAIR",
                "both surfaces belong to one connected body: the contact is left out",
                "see [general_contact], which takes a body with itself",
            );
        }
    }
}

/// Keys of a contact but for the surfaces.
fn keys(pair: &ContactPair, interaction: Option<&Interaction>, timeline: &Timeline, list: &mut List) -> Vec<String> {
    let mut keys = Vec::new();
    if let Some(adjust) = &pair.adjust {
        let consequence = format!("ADJUST={adjust}: nodes are not moved, gaps are those of the mesh");
        list.add(pair.place, "*CONTACT PAIR", consequence, "");
    }
    if pair.is_small_sliding {
        list.add(pair.place, "*CONTACT PAIR", "SMALL SLIDING: surfaces may slide as far as they do", "");
    }
    let Some(interaction) = interaction else { return keys };
    if let Some(behavior) = &interaction.behavior {
        let slope = behavior.values.first().and_then(|row| row.first()).copied().filter(|slope| *slope > 0.0);
        match (behavior.law.as_str(), slope) {
            ("HARD", _) => {}
            ("LINEAR", Some(slope)) if !timeline.is_dynamic() => {
                keys.push(format!("enforcement = {{ penalty = {} }}", number(slope)));
            }
            ("LINEAR", Some(slope)) => {
                let consequence = format!(
                    "*SURFACE BEHAVIOR, LINEAR with the slope {}: the contact is hard, so that energy is kept",
                    number(slope)
                );
                list.add(
                    interaction.place,
                    "*SURFACE INTERACTION",
                    consequence,
                    "see `enforcement` of [[contact]] for springs",
                );
            }
            (law, _) => {
                let consequence = format!("*SURFACE BEHAVIOR, {law}: the contact is hard");
                list.add(
                    interaction.place,
                    "*SURFACE INTERACTION",
                    consequence,
                    "see `enforcement` of [[contact]] for springs",
                );
            }
        }
    }
    if let Some(friction) = interaction.friction {
        let mu = if friction.coefficient.is_finite() { friction.coefficient } else { ROUGH };
        if !friction.coefficient.is_finite() {
            let consequence =
                format!("ROUGH: the coefficient of friction is {ROUGH}, and closed surfaces may still open");
            list.add(interaction.place, "*FRICTION", consequence, "");
        }
        if friction.stick_slope.is_some() {
            list.add(
                interaction.place,
                "*FRICTION",
                "the stick slope is not used: sticking nodes do not slip at all",
                "see `stick` of friction",
            );
        }
        if mu > 0.0 {
            keys.push(format!("friction = {{ law = \"coulomb\", mu = {} }}", number(mu)));
        }
    }
    keys
}
