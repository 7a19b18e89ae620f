//! General contact of a scene: the skin of its bodies, and who acts on whom.

use super::general_schemes::{Bond, connected, owner, sorted};
use super::general_table::{self, NAME};
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
    GeneralContact, GeneralOptions, Interactions, Relation, Skin, SkinFacet, check_initial, mitre,
};
use stoss_mesh::BOUNDARY;

/// Thinnest layer that is made, in parts of the shortest edge.
const THINNEST: f64 = 1e-4;

/// Distance in thicknesses below which bodies touch.
const TOUCH: f64 = 0.1;

/// Of distances of inset surfaces, relative.
const ROUND_OFF: f64 = 1e-6;

/// Overlap up to which bodies touch, in parts of the largest coordinate: what seven digits in a file leave.
const DIGITS: f64 = 2e-6;

/// The same in thicknesses; the smaller one counts.
const SLIGHT: f64 = 0.01;

/// Rounds of measuring the overlap of bodies that touch, by the distance of their inset surfaces.
const ROUNDS: usize = 4;

/// Speed of slip below which friction of two bodies falls, in parts of their largest relative speed at the start.
const SLIP: f64 = 0.01;

/// The same of bodies that do not move relative to each other: part of the thickness that they creep at most in the run, or in the first of its stages with inertia: those that follow do not change it.
const CREEP: f64 = 0.1;

/// Relative speeds that are round-off, in parts of the speeds.
const NO_SPEED: f64 = 1e-9;

/// Pairs of bodies that the plan tells one by one.
const MOST_NAMED: usize = 6;

/// How far, in natural coordinates, a vertex of a trace may lie outside of the element that it goes with: the height of a curved face over its chord, in half depths of the element.
const BEYOND: f64 = 0.3;

/// What helps bodies that overlap.
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
        let message = "general_contact: no two bodies can come into contact: see `include`, `exclude` and `self`, and which pairs [[contact]] and [[tie]] name";
        warnings.push(message.into());
    }
    let inner = inner_pairs(scene, placed);
    let (skin, thickness) = skin(table, placed, model, &rules, facets, inner, problems, warnings)?;
    let has_friction = rules.has_friction();
    let points = skin.point_count() as u64;
    let slip = slip_velocities(scene, table, &skin, &rules, model, thickness);
    let has_rates = scene.is_dynamic() || scene.stages.iter().any(|stage| stage.kind == Kind::Dynamic);
    let mut slips: BTreeMap<String, f64> = BTreeMap::new();
    rules.set_slip_velocities(|[a, b]| {
        let value = slip(a, b);
        let [a, b] = [a, b].map(|body| &placed[body as usize].name[..]);
        slips.insert(if a == b { format!("{a} with itself") } else { format!("{a} and {b}") }, value);
        value
    });
    let options = GeneralOptions { thickness, damping: table.damping };
    match GeneralContact::new(NAME, skin, rules.clone(), options) {
        Ok(contact) => {
            let method = Coupling::potential(contact);
            model.contacts.push(ContactPair { name: NAME.to_owned(), method, complementarity: 0.0, restitution: None });
        }
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
        restitution: None,
        is_assumed: false,
        friction: has_friction.then(|| FrictionPlan {
            law: "coulomb".to_owned(),
            parameters: coefficients,
            stiffness: None,
            default_stiffness: false,
            stick: has_statics(scene).then(|| "elastic".to_owned()),
            stepping: if has_rates { "step" } else { "end" }.to_owned(),
            slip: has_rates.then(|| described(&slips)),
        }),
    };
    Some((plan, rules))
}

/// Speed of slip below which friction of two bodies falls.
///
/// It depends on the motion of the two relative to each other alone: not on a velocity that all have, nor on what others do.
fn slip_velocities(
    scene: &Scene,
    table: &Table,
    skin: &Skin,
    rules: &Interactions,
    model: &Model,
    thickness: f64,
) -> impl Fn(u32, u32) -> f64 + use<> {
    let given = table.slip_velocity;
    // Of a scene without velocities there are none; nodes of rigid bodies go with what carries them.
    let of = |node: u32, c: usize| model.velocity.get(3 * node as usize + c).copied().unwrap_or_default();
    let velocity = |node: u32, c: usize| match model.embedding.carriers(node) {
        Some(carriers) => carriers.iter().map(|&(carrier, weight)| weight * of(carrier, c)).sum(),
        None => of(node, c),
    };
    // Smallest and largest components of the velocities of each body.
    let mut ranges: BTreeMap<u32, [[f64; 2]; 3]> = BTreeMap::new();
    for facet in skin.facets() {
        let range = ranges.entry(rules.body(facet.class)).or_insert([[f64::INFINITY, f64::NEG_INFINITY]; 3]);
        for &node in facet.nodes.iter() {
            for (c, [low, high]) in range.iter_mut().enumerate() {
                let v: f64 = velocity(node, c);
                (*low, *high) = (low.min(v), high.max(v));
            }
        }
    }
    let relative = move |a: u32, b: u32| {
        let (Some(a), Some(b)) = (ranges.get(&a), ranges.get(&b)) else { return 0.0 };
        let largest = |[low, high]: &[f64; 2]| low.abs().max(high.abs());
        let components = a.iter().zip(b).map(|(a, b)| ((a[1] - b[0]).max(b[1] - a[0]), largest(a).max(largest(b))));
        let squares = components.fold((0.0, 0.0), |(v, all), (d, largest)| (v + d * d, all + largest * largest));
        let (speed, all) = (f64::sqrt(squares.0), f64::sqrt(squares.1));
        if speed <= NO_SPEED * all { 0.0 } else { speed }
    };
    let length = super::phase::first_dynamics(scene);
    move |a: u32, b: u32| {
        given.unwrap_or_else(|| match relative(a, b) {
            0.0 => CREEP * thickness / length,
            speed => SLIP * speed,
        })
    }
}

/// Whether a part of the run is static.
fn has_statics(scene: &Scene) -> bool {
    if scene.stages.is_empty() {
        !scene.is_dynamic()
    } else {
        scene.stages.iter().any(|stage| stage.kind != Kind::Dynamic)
    }
}

/// Speeds of slip below which friction creeps in dynamics.
fn described(slips: &BTreeMap<String, f64>) -> String {
    let (low, high) = slips.values().fold((f64::INFINITY, 0.0_f64), |(l, h), &v| (l.min(v), h.max(v)));
    if low == high {
        return format!("creeps below {low:.4e}");
    }
    if slips.len() > MOST_NAMED {
        return format!("creeps below {low:.4e} to {high:.4e}, pair by pair");
    }
    let list: Vec<String> = slips.iter().map(|(names, v)| format!("{v:.4e} ({names})")).collect();
    format!("creeps below {}", list.join(", "))
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
            "is less than {THINNEST:e} of the shortest edge, {edge:.3e}: no step size is small enough for so thin a layer"
        );
        let remedy = format!("choose at least {:.3e}; if it is left out it is {default:.3e}", THINNEST * edge);
        problems.add("general_contact.thickness".into(), format!("{thickness:e}"), message, remedy);
        return None;
    }
    let mut thickness = table.thickness.unwrap_or(default);
    let look = check_initial(&skin, rules, &model.reference, thickness.max(2.0 * default));
    let largest = model.reference.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let slight = (SLIGHT * thickness).min(DIGITS * largest);
    let is_slight = separate::slight(&skin, rules, model, slight);
    let bodies_of = |facets: [u32; 2]| facets.map(|facet| rules.body(skin.facets()[facet as usize].class));
    let overlaps = |facets: [u32; 2]| !is_slight(bodies_of(facets));
    if let Some(&(facets, place)) = look.crossings.iter().find(|(facets, _)| overlaps(*facets)) {
        let [a, b] = bodies_of(facets);
        let (what, deep, remedy) = if a == b {
            let what = format!("the surface of `{}` intersects itself", name(a));
            (what, None, "correct the mesh, or set `self = false`")
        } else {
            let what = format!("`{}` and `{}` overlap", name(a), name(b));
            (what, separate::depth(&skin, rules, model, placed, [a, b]), PART)
        };
        let deep = deep.map_or(String::new(), |deep| format!(", {deep}"));
        let (place, count) = (point(place, edge), look.crossings.len());
        let message = format!("{what} at the start, near {place}{deep}; {count} pairs of facets cross");
        problems.add(key(), "", message, remedy);
        return None;
    }
    if let Some(([a, b], relation)) = separate::inside(&skin, rules, model, &is_slight) {
        let (message, remedy) = match separate::depth(&skin, rules, model, placed, [a, b]) {
            Some(deep) if relation == Relation::Cross => {
                (format!("`{}` and `{}` overlap at the start, {deep}", name(a), name(b)), PART)
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
    if let Some(([body, _], nearest)) = itself {
        if table.thickness.is_none() {
            thickness = thickness.min(0.5 * nearest.distance);
        }
        if nearest.distance <= thickness || thickness < THINNEST * edge {
            let message = format!(
                "two parts of the surface of `{}` that are not adjacent are only {:.3e} apart near {}, so that the contact layer would act there all the time",
                name(*body),
                nearest.distance,
                point(nearest.place, edge)
            );
            let remedy = if nearest.distance > 2.0 * THINNEST * edge {
                "make `thickness` smaller, correct the mesh there, or set `self = false`"
            } else {
                "correct the mesh there, or set `self = false`: no layer is thin enough, as between the faces of a closed crack"
            };
            problems.add(key(), "", message, remedy);
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
            "general_contact: `{}` and `{}` start {:.3e} apart near {}, less than the thickness {thickness:.3e}: their surfaces are inset as if they touched, forces begin \
             where the bodies touch, and the bodies may overlap by up to the thickness; make `thickness` smaller than the gap, or leave it out",
            name(*a),
            name(*b),
            nearest.distance,
            point(nearest.place, edge)
        ));
    }
    let mut frames: BTreeMap<u32, Option<Frame>> = BTreeMap::new();
    // Pairs of bodies that touch, and the part of the inset that each takes.
    let mut insets: Vec<([u32; 2], [f64; 2])> = Vec::new();
    let inner = inner.map(|[a, b]| [a.min(b), a.max(b)]);
    for pair in touching.map(|(pair, _)| **pair).chain(inner) {
        // Without points below the surface.
        let flat = pair.map(|body| {
            let frame = || Frame::of(&facets_of(&facets, rules, body), &model.reference);
            placed[body as usize].mesh().is_none() && frames.entry(body).or_insert_with(frame).is_none()
        });
        let parts = match flat {
            [false, false] => [0.5, 0.5],
            // Opposite a flat one the other body goes all of the way.
            [true, false] => [0.0, 1.0],
            [false, true] => [1.0, 0.0],
            [true, true] => {
                let message = format!(
                    "the rigid bodies `{}` and `{}` touch at the start, and neither surface can be inset: both are flat or not closed",
                    name(pair[0]),
                    name(pair[1]),
                );
                problems.add(key(), "", message, format!("leave a gap of {thickness:.3e} between them"));
                return None;
            }
        };
        insets.push((pair, parts));
    }
    if insets.is_empty() {
        return Some((skin, thickness));
    }
    let mut overlap: BTreeMap<[u32; 2], f64> = BTreeMap::new();
    for _ in 0..ROUNDS {
        let mut depth: BTreeMap<u32, f64> = BTreeMap::new();
        for (pair, parts) in &insets {
            let distance = thickness + overlap.get(pair).copied().unwrap_or_default();
            for (&body, &part) in pair.iter().zip(parts).filter(|(_, part)| **part > 0.0) {
                let depth = depth.entry(body).or_insert(0.0);
                *depth = depth.max(part * distance);
            }
        }
        let mut places = BTreeMap::new();
        for (&body, &depth) in &depth {
            let part = &placed[body as usize];
            let frame = frames.get(&body).and_then(Option::as_ref);
            if let Err((node, reason)) = inset(&skin, rules, model, body, frame, depth, &mut places) {
                let at = std::array::from_fn(|i| model.reference[3 * node as usize + i]);
                let message = format!(
                    "`{}` touches another body at the start, and its surface cannot be inset by {depth:.3e} near {}: {reason}",
                    part.name,
                    point(at, edge)
                );
                problems.add(
                    key(),
                    "",
                    message,
                    format!(
                        "leave a gap of {thickness:.3e}, make `thickness` smaller, or leave the body out by `exclude`"
                    ),
                );
                return None;
            }
        }
        let skin = Skin::new(facets.clone(), &model.reference, &|node| places.get(&node).cloned());
        let look = check_initial(&skin, rules, &model.reference, thickness);
        let near = || look.nearest.iter().filter(|(_, nearest)| nearest.distance < (1.0 - ROUND_OFF) * thickness);
        if near().next().is_none() {
            return Some((skin, thickness));
        }
        // What only touched is farther apart by now.
        let too_near = near().find(|(pair, nearest)| {
            let lack = thickness - nearest.distance;
            lack > slight || !insets.iter().any(|(touching, _)| touching == *pair)
        });
        let Some(([a, b], nearest)) = too_near else {
            near().for_each(|(pair, nearest)| *overlap.entry(*pair).or_default() += thickness - nearest.distance);
            continue;
        };
        if nearest.distance < ROUND_OFF * thickness {
            let message =
                format!("`{}` and `{}` overlap at the start, near {}", name(*a), name(*b), point(nearest.place, edge));
            problems.add(key(), "", message, PART);
        } else {
            let message = format!(
                "inset surfaces of `{}` and `{}`, which touch at the start, are {:.3e} apart near {}, less than the thickness {thickness:.3e}",
                name(*a),
                name(*b),
                nearest.distance,
                point(nearest.place, edge)
            );
            problems.add(key(), "", message, "make `thickness` smaller, or leave a gap between the bodies");
        }
        return None;
    }
    let message = format!("inset surfaces of bodies that touch do not keep the thickness {thickness:.3e}");
    problems.add(key(), "", message, "leave a gap between the bodies");
    None
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
        // Vertices of traces of curved faces need not lie in an element: the nearest one goes on beyond its faces.
        let beyond = if model.embedding.carriers(node).is_some() { BEYOND } else { 0.0 };
        let point = solid.material_point_near(&model.reference, at, beyond).ok_or_else(outside)?;
        let (kind, nodes) = (solid.elements().kind(point.element), &solid.elements()[point.element]);
        places.insert(node, nodes.iter().copied().zip((kind.table().shape)(point.natural)).collect());
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

#[cfg(test)]
mod tests {
    use crate::build::build;
    use crate::scene::parse;
    use std::path::Path;

    /// What `stoss check` tells of the friction of bodies with these velocities; the last one may be far away.
    fn told(velocities: &[[f64; 3]], more: &str) -> String {
        let mut text = "[scene]\ntitle = \"t\"\nkind = \"dynamic\"\n[time]\nend = 4\nstep = 0.1\nintegrator = { scheme = \"energy-momentum\" }\n\
                        [general_contact]\nfriction = 0.3\nthickness = 0.02\n"
            .to_owned()
            + more;
        for (k, velocity) in velocities.iter().enumerate() {
            let z = 2 * k;
            text += &format!(
                "[[body]]\nname = \"{}\"\nmesh = {{ generator = \"block\", min = [0, 0, {z}], max = [1, 1, {}], divisions = [1, 1, 1] }}\n\
                 material = {{ law = \"neo-hooke\", young = 1, poisson = 0.3 }}\ndensity = 1\nvelocity = {velocity:?}\n",
                ["a", "b", "c"][k],
                z + 1
            );
        }
        let scene = parse(&text, "t.toml").unwrap_or_else(|e| panic!("{e}"));
        match build(&scene, Path::new(".")) {
            Ok(built) => built.contacts[0].friction.as_ref().unwrap().slip.clone().unwrap(),
            Err(error) => error.to_string(),
        }
    }

    /// The speed of slip that counts as small follows from what two bodies do to each other: neither from a common velocity nor from what others do.
    #[test]
    fn creep_follows_from_relative_motion() {
        let (rest, slow) = ([0.0; 3], [0.3, 0.0, -0.4]);
        let two = told(&[rest, slow], "self = false\n");
        assert_eq!(two, "creeps below 5.0000e-3");
        let fast = [1e6, -1e6, 3e6];
        let with = |v: [f64; 3]| std::array::from_fn(|c| v[c] + fast[c]);
        assert!(told(&[fast, with(slow)], "self = false\n").starts_with("creeps below 5.0000e-3"));
        let three = told(&[rest, slow, fast], "self = false\n");
        assert!(three.contains("5.0000e-3 (a and b)") && three.contains("3.3166e4 (a and c)"), "{three}");
        // At rest against each other: a tenth of the thickness in the time of the run.
        let three = told(&[slow, slow, rest], "self = false\n");
        assert!(three.contains("5.0000e-4 (a and b)") && three.contains("5.0000e-3 (a and c)"), "{three}");
        assert_eq!(told(&[rest, slow], "self = false\nslip_velocity = 0.7\n"), "creeps below 7.0000e-1");
        // A rigid body moves, or spins.
        let rigid = |motion: &str| {
            told(
                &[rest],
                &format!(
                    "self = false\n[[rigid]]\nname = \"r\"\nshape = {{ kind = \"cylinder\", radius = 0.5, length = 1, divisions = [8, 1, 1] }}\nposition = [0, 0, -3]\ndensity = 1\n{motion}\n"
                ),
            )
        };
        assert_eq!(rigid("velocity = [0, 0, 2]"), "creeps below 2.0000e-2");
        assert_eq!(rigid("angular_velocity = [0, 0, 4]"), "creeps below 2.8284e-2");
        // Where nothing moves at the start, every pair is such a pair.
        for v in [rest, slow] {
            assert_eq!(told(&[v, v], "self = false\n"), "creeps below 5.0000e-4");
        }
    }
}
