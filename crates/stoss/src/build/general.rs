//! General contact of a scene: the skin of its bodies, and who acts on whom.

use super::general_schemes::{Bond, connected, owner, sorted};
use super::general_table;
use super::interacting::{Classes, THICKNESS, facets, interactions, point, shortest_edge, without_joined_overlaps};
use super::joined::held_of;
use super::rigid_inset::{Frame, fits};
use super::separate;
use super::tie::Ties;
use super::{ContactPlan, FrictionPlan, Joined, Placed, Problems};
use crate::scene::{Edges, GeneralContact as Table, Kind, Parameter, Scene, split_set};
use crate::solver::{ContactPair, Coupling, Model};
use std::collections::{BTreeMap, BTreeSet};
use stoss_contact_barrier::{
    GeneralContact, GeneralOptions, Interactions, Relation, Skin, SkinFacet, first_look, mitre,
};
use stoss_mesh::BOUNDARY;

/// Name in messages and tables.
pub(super) const NAME: &str = "general";

/// Thinnest layer that is made, in parts of the shortest edge.
const THINNEST: f64 = 1e-4;

/// Distance in thicknesses below which bodies touch.
const TOUCH: f64 = 0.1;

/// Of distances of inset surfaces, relative.
const ROUND_OFF: f64 = 1e-6;

/// Speed of slip below which friction falls, in parts of the largest speed at the start.
const SLIP: f64 = 0.01;

/// What helps bodies that lie in each other.
const PART: &str = "move one of them, set `initial = \"separate\"`, or leave one of them out by `exclude`";

/// Adds general contact to the model if the scene has it. Where it acts between parts whose joints end, nothing is left in `joined`.
pub(super) fn general(
    scene: &Scene,
    placed: &[Placed],
    ties: &Ties,
    joined: &mut Vec<Joined>,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<ContactPlan> {
    let table = &scene.general_contact()?;
    let before = problems.list.len();
    let made = contact(scene, table, placed, ties, model, problems, warnings);
    if is_default(scene) {
        for problem in &mut problems.list[before..] {
            problem.message +=
                " (general contact is on by default where several bodies are there and no pair is named)";
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
        problems.add(
            "general_contact".into(),
            "",
            "there is no surface that takes part",
            "include a body, or remove the table",
        );
        return None;
    }
    general_table::check(scene, placed, table, &classes.iter().copied().collect(), problems);
    if problems.list.len() > before {
        return None;
    }
    let warned = warnings.len();
    let mut rules = interactions(scene, placed, table, model, &classes, &apart, warnings);
    warnings.extend(without_joined_overlaps(scene, placed, table, &facets, &model.reference, &mut rules));
    // Nobody has asked for bodies in contact with themselves alone.
    if is_default(scene) && !rules.acts_between_bodies() {
        return None;
    }
    if rules.is_empty() && warnings.len() == warned {
        let message = "general_contact: nothing acts on anything: see `include`, `exclude` and `self`, and which pairs [[contact]] and [[tie]] name";
        warnings.push(message.into());
    }
    let inner = inner_pairs(scene, placed);
    let (skin, thickness) = skin(table, placed, model, &rules, facets, inner, problems, warnings)?;
    let has_friction = rules.has_friction();
    let points = skin.point_count() as u64;
    let fastest = model.velocity.chunks_exact(3).map(|v| v.iter().map(|v| v * v).sum::<f64>()).fold(0.0, f64::max);
    let slip_velocity = table.slip_velocity.unwrap_or(SLIP * fastest.sqrt());
    let has_rates = scene.is_dynamic() || scene.stages.iter().any(|stage| stage.kind == Kind::Dynamic);
    if has_friction && has_rates && slip_velocity == 0.0 {
        let message =
            "friction acts from some speed of slip on, and nothing moves at the start that would tell which is small";
        let remedy = "add `slip_velocity`, about a hundredth of the speed at which bodies will slide";
        // Of the contacts whose edges are left to general contact, if it has none of its own.
        let (key, value) = match table.friction > 0.0 {
            true => ("general_contact.friction", table.friction.to_string()),
            false => ("general_contact", String::new()),
        };
        problems.add(key.into(), value, message, remedy);
        return None;
    }
    let options = GeneralOptions { thickness, damping: table.damping, slip_velocity };
    match GeneralContact::new(NAME, skin, rules.clone(), options) {
        Ok(contact) => {
            let method = Coupling::potential(contact);
            model.contacts.push(ContactPair { name: NAME.to_owned(), method, complementarity: 0.0, restores: false });
        }
        Err(error) => {
            problems.add("general_contact".into(), "", error.to_string(), "see docs/guide.md, [general_contact]");
            return None;
        }
    }
    let of_pairs =
        table.pairs.iter().filter_map(|pair| Some((format!("mu of {}", pair.between.join(" and ")), pair.friction?)));
    let of_contacts = general_table::of_contacts(scene, placed, &mut Vec::new());
    let of_contacts = of_contacts.into_iter().map(|([a, b], mu)| {
        let [a, b] = [a, b].map(|part| &placed[part].name);
        (format!("mu of {a} and {b}"), mu)
    });
    // What `pairs` says replaces what contacts say.
    let coefficients = [("mu".to_owned(), table.friction)].into_iter().chain(of_contacts).chain(of_pairs);
    let coefficients = coefficients.map(|(name, mu)| (name, Parameter::Number(mu))).collect();
    let plan = ContactPlan {
        name: NAME.to_owned(),
        slave: None,
        method: NAME.to_owned(),
        constraint: "barrier".to_owned(),
        enforcement: format!("layer of thickness {thickness:.4e}"),
        slots: points,
        unknowns_per_slot: 0,
        friction: has_friction.then(|| FrictionPlan {
            law: "coulomb".to_owned(),
            parameters: coefficients,
            stiffness: None,
            default_stiffness: false,
            stick: None,
            stepping: "step".to_owned(),
            slip: None,
        }),
    };
    Some((plan, rules))
}

/// Whether nobody has asked for general contact.
fn is_default(scene: &Scene) -> bool {
    scene.general_contact.is_none() && scene.contacts.is_empty()
}

/// The skin, inset where bodies are nearer than the layer is thick, and that thickness.
fn skin(
    table: &Table,
    placed: &[Placed],
    model: &Model,
    rules: &Interactions,
    facets: Vec<SkinFacet>,
    inner: impl Iterator<Item = [u32; 2]>,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Option<(Skin, f64)> {
    let key = || "general_contact".to_owned();
    let name = |body: u32| &placed[body as usize].name;
    let skin = Skin::new(facets.clone(), &model.reference, &|_| None);
    let edge = shortest_edge(&skin, rules, placed, &model.reference);
    let default = THICKNESS * edge;
    if let Some(thickness) = table.thickness.filter(|&thickness| thickness < THINNEST * edge) {
        let message = format!(
            "is less than {THINNEST:e} of the shortest edge, {edge:.3e}: no step is short enough for so thin a layer"
        );
        let remedy = format!("choose at least {:.3e}; if it is left out it is {default:.3e}", THINNEST * edge);
        problems.add("general_contact.thickness".into(), format!("{thickness:e}"), message, remedy);
        return None;
    }
    let look = first_look(&skin, rules, &model.reference, table.thickness.unwrap_or(default).max(2.0 * default));
    if let Some(&([f, g], place)) = look.crossings.first() {
        let [a, b] = [f, g].map(|facet| rules.body(skin.facets()[facet as usize].class));
        let (what, deep, remedy) = if a == b {
            let what = format!("the surface of `{}` goes through itself", name(a));
            (what, None, "mend the mesh, or set `self = false`")
        } else {
            let what = format!("`{}` and `{}` lie in each other", name(a), name(b));
            (what, separate::depth(&skin, rules, model, placed, [a, b]), PART)
        };
        let deep = deep.map_or(String::new(), |deep| format!(", {deep}"));
        let (place, count) = (point(place, edge), look.crossings.len());
        let message = format!("{what} at the start, near {place}{deep}; {count} pairs of facets cross");
        problems.add(key(), "", message, remedy);
        return None;
    }
    if let Some(([a, b], relation)) = separate::inside(&skin, rules, model) {
        let (message, remedy) = match separate::depth(&skin, rules, model, placed, [a, b]) {
            Some(deep) if relation == Relation::Cross => {
                (format!("`{}` and `{}` lie in each other at the start, {deep}", name(a), name(b)), PART)
            }
            _ => {
                let message = format!("one of `{}` and `{}` lies inside the other at the start", name(a), name(b));
                (message, "move one of them, or leave one of them out by `exclude`")
            }
        };
        problems.add(key(), "", message, remedy);
        return None;
    }
    if let Some([a, b]) = separate::enclosed(placed, rules, model) {
        let message = format!("one of `{}` and `{}` lies inside the other at the start", name(a), name(b));
        problems.add(key(), "", message, "move one of them, or leave one of them out by `exclude`");
        return None;
    }
    let itself = look.nearest.iter().filter(|([a, b], _)| a == b);
    let itself = itself.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
    let mut thickness = table.thickness.unwrap_or(default);
    if let Some(([body, _], nearest)) = itself {
        if table.thickness.is_none() {
            thickness = thickness.min(0.5 * nearest.distance);
        }
        if nearest.distance <= thickness || thickness < THINNEST * edge {
            let message = format!(
                "two parts of the surface of `{}` that are no neighbours are only {:.3e} apart near {}: there the layer would act all the time",
                name(*body),
                nearest.distance,
                point(nearest.place, edge)
            );
            problems.add(key(), "", message, "make `thickness` smaller, mend the mesh there, or set `self = false`");
            return None;
        }
    }
    // Bodies that are near each other but do not touch get a thinner layer, which costs nothing but smaller steps at contact; those that touch are inset.
    let between: Vec<_> = look.nearest.iter().filter(|([a, b], _)| a != b).collect();
    if table.thickness.is_none() {
        let apart = between.iter().map(|(_, nearest)| nearest.distance).filter(|&d| d >= TOUCH * thickness);
        thickness = apart.fold(thickness, f64::min);
    }
    let touching = between.iter().filter(|(_, nearest)| nearest.distance < thickness);
    // Only a thickness that the scene gives is larger than the gap of bodies that are apart.
    for ([a, b], nearest) in touching.clone().filter(|(_, nearest)| nearest.distance >= TOUCH * thickness) {
        warnings.push(format!(
            "general_contact: `{}` and `{}` start {:.3e} apart near {}, less than the thickness {thickness:.3e}: surfaces are put inside them as if they touched, forces begin \
             where the bodies touch, and they may overlap by up to the thickness; make `thickness` smaller than the gap, or leave it out",
            name(*a),
            name(*b),
            nearest.distance,
            point(nearest.place, edge)
        ));
    }
    let mut depth: BTreeMap<u32, f64> = BTreeMap::new();
    let mut frames: BTreeMap<u32, Option<Frame>> = BTreeMap::new();
    for pair in touching.map(|(pair, _)| **pair).chain(inner) {
        // Without points below the surface.
        let flat = pair.map(|body| {
            let frame = || Frame::of(&facets_of(&facets, rules, body), &model.reference);
            placed[body as usize].mesh().is_none() && frames.entry(body).or_insert_with(frame).is_none()
        });
        if flat == [true; 2] {
            let message = format!(
                "the rigid bodies `{}` and `{}` touch at the start, and neither has an inside into which its surface could be put: they are flat or not closed",
                name(pair[0]),
                name(pair[1]),
            );
            problems.add(key(), "", message, format!("leave a gap of {thickness:.3e} between them"));
            return None;
        }
        for (k, body) in pair.into_iter().enumerate().filter(|(k, _)| !flat[*k]) {
            // Opposite a flat one the other body goes all of the way.
            let part = if flat[1 - k] { 1.0 } else { 0.5 };
            let depth = depth.entry(body).or_insert(0.0);
            *depth = depth.max(part * thickness);
        }
    }
    if depth.is_empty() {
        return Some((skin, thickness));
    }
    let mut places = BTreeMap::new();
    for (&body, &depth) in &depth {
        let part = &placed[body as usize];
        let frame = frames.get(&body).and_then(Option::as_ref);
        if let Err((node, reason)) = inset(&skin, rules, model, body, frame, depth, &mut places) {
            let at = std::array::from_fn(|i| model.reference[3 * node as usize + i]);
            let message = format!(
                "`{}` touches another body at the start, and its surface cannot be put {depth:.3e} inside near {}: {reason}",
                part.name,
                point(at, edge)
            );
            problems.add(
                key(),
                "",
                message,
                format!("leave a gap of {thickness:.3e}, make `thickness` smaller, or leave the body out by `exclude`"),
            );
            return None;
        }
    }
    let skin = Skin::new(facets, &model.reference, &|node| places.get(&node).cloned());
    let look = first_look(&skin, rules, &model.reference, thickness);
    let near = look.nearest.iter().find(|(_, nearest)| nearest.distance < (1.0 - ROUND_OFF) * thickness);
    // What only touched is farther apart by now.
    if let Some(([a, b], nearest)) = near.filter(|(_, nearest)| nearest.distance < ROUND_OFF * thickness) {
        let message = format!(
            "`{}` and `{}` lie in each other at the start, near {}",
            name(*a),
            name(*b),
            point(nearest.place, edge)
        );
        problems.add(key(), "", message, PART);
        return None;
    }
    if let Some(([a, b], nearest)) = near {
        let message = format!(
            "surfaces of `{}` and `{}` that were put inside because bodies touch at the start are {:.3e} apart near {}, less than the thickness {thickness:.3e}",
            name(*a),
            name(*b),
            nearest.distance,
            point(nearest.place, edge)
        );
        problems.add(key(), "", message, "make `thickness` smaller, or leave a gap between the bodies");
        return None;
    }
    Some((skin, thickness))
}

/// Nodes and weights of the vertices of a body, at a depth below its surface; a node and the reason where there are none.
fn inset(
    skin: &Skin,
    rules: &Interactions,
    model: &Model,
    body: u32,
    frame: Option<&Frame>,
    depth: f64,
    places: &mut BTreeMap<u32, Vec<(u32, f64)>>,
) -> Result<(), (u32, String)> {
    let x = |v: u32| skin.at(v, &model.reference);
    let mut normals: BTreeMap<u32, Vec<_>> = BTreeMap::new();
    for (t, triangle) in skin.triangles().iter().enumerate() {
        let facet = &skin.facets()[skin.facet_of_triangle(t as u32) as usize];
        if rules.body(facet.class) != body {
            continue;
        }
        let [a, b, c] = triangle.map(x);
        let normal = (b - a).cross(&(c - a)).normalize();
        for &v in triangle {
            if let [(node, _)] = skin.terms(v) {
                normals.entry(*node).or_default().push(normal);
            }
        }
    }
    let first = normals.keys().next().copied();
    for (node, normals) in normals {
        let m = mitre(&normals).ok_or_else(|| (node, "facets there face each other".to_owned()))?;
        let k = 3 * node as usize;
        let at = std::array::from_fn(|i| model.reference[k + i] - depth * m[i]);
        let outside = || (node, "the body is too thin there".to_owned());
        if let Some(frame) = frame {
            places.insert(node, frame.terms(at));
            continue;
        }
        let solid = &model.bodies[body as usize].solid;
        let point = solid.material_point(&model.reference, at).ok_or_else(outside)?;
        let shape = stoss_reference_element::hex8::shape(point.natural);
        let corners = &solid.connectivity()[point.element];
        places.insert(node, corners.iter().copied().zip(shape).collect());
    }
    let place = |node: u32| places.get(&node).cloned();
    match first {
        Some(node)
            if frame.is_some() && !fits(&facets_of(skin.facets(), rules, body), &model.reference, depth, &place) =>
        {
            Err((node, "the body is too thin".to_owned()))
        }
        _ => Ok(()),
    }
}

fn facets_of(facets: &[SkinFacet], rules: &Interactions, body: u32) -> Vec<SkinFacet> {
    facets.iter().filter(|facet| rules.body(facet.class) == body).copied().collect()
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
