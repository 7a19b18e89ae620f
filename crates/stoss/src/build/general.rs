//! General contact of a scene: the skin of its bodies, and who acts on whom.

use super::general_schemes::{Bond, connected, owner, sorted};
use super::general_skin::{PlacedParts, skin};
use super::general_table::{self, Frictions, NAME};
use super::interacting::{Classes, facets, interactions, without_joined_overlaps};
use super::joined::held_of;
use super::tie::Ties;
use super::{ContactPlan, FrictionPlan, Joined, OwnLaws, Placed, Problems};
use crate::scene::{Edges, GeneralContact as Table, Kind, Scene, split_set};
use crate::solver::{CouplingTerm, Model};
use std::collections::BTreeSet;
use stoss_contact_barrier::{GeneralContact, GeneralOptions, Interactions, ONE_SIDED, Start};
use stoss_mesh::BOUNDARY;

/// Adds general contact to the model if the scene has it. Where it acts between parts whose joints end, nothing is left in `joined`.
pub(super) fn general(
    scene: &Scene,
    placed: &[Placed],
    laws: &OwnLaws,
    ties: &Ties,
    joined: &mut Vec<Joined>,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<ContactPlan> {
    let table = &scene.general_contact()?;
    let before = problems.list.len();
    let made = contact(scene, table, placed, laws, ties, model, problems, warnings);
    if is_default(scene) {
        for problem in &mut problems.list[before..] {
            problem.message += " (general contact is on by default if there are several bodies and no pair is named)";
            problem.remedy += ", or switch it off: [general_contact] enabled = false";
        }
    }
    let (plan, rules) = made?;
    let part = |name: &String| super::placed::index(placed, name).map(|part| part as u32);
    let acts = |joined: &Joined| {
        let [a, b] = joined.parts.each_ref().map(part);
        a.zip(b).is_some_and(|(a, b)| rules.acts_between([a, b]))
    };
    let connected = connected(scene);
    joined.retain(|joined| {
        let names = sorted(joined.parts.each_ref().map(|name| &name[..]));
        connected.get(&names) != Some(&Bond::Ends) || !acts(joined)
    });
    // Facets around what a joint holds on to are left out.
    for joined in joined.iter_mut().filter(|joined| acts(joined)) {
        let held: BTreeSet<u32> = held_between(scene, placed, &joined.parts);
        let facets = joined.parts.iter().filter_map(|name| super::placed::index(placed, name));
        let facets = facets.flat_map(|part| placed[part].facets_of(BOUNDARY).unwrap_or_default());
        let around = facets.filter(|facet| facet.iter().any(|node| held.contains(node)));
        joined.nodes.extend(around.collect::<Vec<_>>().iter().flatten());
    }
    Some(plan)
}

/// Nodes that joints between two parts hold on to, but for those that hold all of a part.
fn held_between(scene: &Scene, placed: &[Placed], parts: &[String; 2]) -> BTreeSet<u32> {
    let names = sorted(parts.each_ref().map(|name| &name[..]));
    let joints = scene.joints.iter().filter(|joint| sorted(joint.between.each_ref().map(|side| owner(side))) == names);
    joints.flat_map(|joint| held_of(placed, &joint.between)).collect()
}

fn contact(
    scene: &Scene,
    table: &Table,
    placed: &[Placed],
    laws: &OwnLaws,
    ties: &Ties,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<(ContactPlan, Interactions)> {
    let before = problems.list.len();
    let skins = facets(scene, placed, table, ties, problems);
    if problems.list.len() > before {
        return None;
    }
    let Classes { facets, classes, apart } = skins;
    if facets.is_empty() {
        problems.add("general_contact".into(), "", "no surface takes part", "include a body, or remove the table");
        return None;
    }
    general_table::check(scene, placed, table, &classes.iter().copied().collect(), problems);
    let frictions = Frictions::of(scene, placed, table, laws, problems);
    if problems.list.len() > before {
        return None;
    }
    let warned = warnings.len();
    let mut rules = interactions(scene, placed, table, &frictions, model, &classes, &apart, warnings);
    warnings.extend(without_joined_overlaps(scene, placed, table, &facets, &model.reference, &mut rules));
    // Nobody has asked for bodies in contact with themselves alone.
    if is_default(scene) && !rules.acts_between_bodies() {
        return None;
    }
    if rules.is_empty() && warnings.len() == warned {
        let message = "general_contact: no two bodies can come into contact: see `include`, `exclude` and `self`, and which pairs [[contact]] and [[tie]] name";
        warnings.push(message.into());
    }
    let inner: Vec<[u32; 2]> = inner_pairs(scene, placed).collect();
    let parts = PlacedParts { placed, model };
    let Start { skin, thickness, one_sided, .. } = skin(table, &parts, &rules, facets, &inner, problems, warnings)?;
    one_sided_insets(&mut rules, placed, table, &one_sided);
    let has_friction = rules.has_friction();
    let points = skin.point_count() as u64;
    let has_rates = scene.is_dynamic() || scene.stages.iter().any(|stage| stage.kind == Kind::Dynamic);
    warnings.extend(without_effect(scene, table, placed, has_rates, has_friction));
    let options = GeneralOptions { thickness, damping: table.damping, slip_velocity: table.slip_velocity };
    match GeneralContact::new(NAME, skin, rules.clone(), options) {
        Ok(contact) => model.contacts.push(CouplingTerm::new(NAME, contact, 0.0)),
        Err(error) => {
            problems.add(
                "general_contact".into(),
                "",
                error.to_string(),
                "see general contact in docs/guide/contact.md",
            );
            return None;
        }
    }
    let (law, parameters) = frictions.said(placed, table);
    let plan = ContactPlan {
        name: NAME.to_owned(),
        slave: None,
        method: NAME.to_owned(),
        constraint: "barrier".to_owned(),
        enforcement: format!("layer of thickness {thickness:.4e}"),
        slots: points,
        unknowns_per_slot: 0,
        restitution: None,
        is_assumed: false,
        friction: has_friction.then(|| FrictionPlan {
            law,
            parameters,
            stiffness: None,
            default_stiffness: false,
            stick: (table.slip_velocity.is_none() || has_statics(scene)).then(|| "elastic".to_owned()),
            stepping: if has_rates { "step" } else { "end" }.to_owned(),
            slip: table.slip_velocity.filter(|_| has_rates).map(|speed| format!("creeps below {speed:.4e}")),
        }),
    };
    Some((plan, rules))
}

/// The layer is to give back what the inset takes, which is twice as much where one body alone goes inside (theory/barrier#modulus), unless the scene gives its modulus.
fn one_sided_insets(rules: &mut Interactions, placed: &[Placed], table: &Table, pairs: &[[u32; 2]]) {
    for &pair in pairs {
        let names = sorted(pair.map(|part| &placed[part as usize].name[..]));
        let is_given = |own: &crate::scene::GeneralPair| {
            own.modulus.is_some() && sorted([&own.between[0], &own.between[1]]) == names
        };
        let both_rigid = pair.iter().all(|&part| placed[part as usize].mesh().is_none());
        if !both_rigid && !table.pairs.iter().any(is_given) {
            rules.scale_modulus(pair, ONE_SIDED);
        }
    }
}

/// Keys that are given and change nothing.
fn without_effect(
    scene: &Scene,
    table: &Table,
    placed: &[Placed],
    has_rates: bool,
    has_friction: bool,
) -> impl Iterator<Item = String> {
    let rigid = placed.iter().filter(|part| part.mesh().is_none());
    let movable = rigid.clone().any(|part| !scene.rigids.iter().any(|r| r.name == part.name && r.fixed));
    let list = [
        (table.damping > 0.0 && !has_rates, "damping", "without inertia the layer has no rates"),
        (table.slip_velocity.is_some() && !has_rates, "slip_velocity", "without inertia friction sticks like a spring"),
        (table.slip_velocity.is_some() && has_rates && !has_friction, "slip_velocity", "there is no friction"),
        (
            table.modulus.is_some() && (rigid.count() < 2 || !movable),
            "modulus",
            "it is for two rigid bodies that act on each other",
        ),
    ];
    let told = list.into_iter().filter(|(has_none, ..)| *has_none);
    told.map(|(_, key, why)| format!("general_contact.{key} has no effect: {why}; remove it"))
}

/// Whether a part of the run is static.
fn has_statics(scene: &Scene) -> bool {
    if scene.stages.is_empty() {
        !scene.is_dynamic()
    } else {
        scene.stages.iter().any(|stage| stage.kind != Kind::Dynamic)
    }
}

/// Whether nobody has asked for general contact.
fn is_default(scene: &Scene) -> bool {
    scene.general_contact.is_none() && scene.contacts.is_empty()
}

/// Pairs of bodies whose contact leaves its edges to general contact: their surfaces go inside.
fn inner_pairs(scene: &Scene, placed: &[Placed]) -> impl Iterator<Item = [u32; 2]> {
    let contacts = scene.contacts.iter().filter(|contact| contact.edges == Edges::General);
    contacts.filter_map(|contact| {
        let part = |set: &str| super::placed::index(placed, split_set(set)?.0).map(|part| part as u32);
        let [a, b] = contact.surfaces();
        Some([part(a)?, part(b)?])
    })
}
