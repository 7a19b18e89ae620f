//! General contact of a scene: the skin of its bodies, and who acts on whom.

use super::general_schemes::{Bond, connected, owner, sorted};
use super::general_skin::{Bodies, skin};
use super::general_table::{self, NAME};
use super::interacting::{Classes, facets, interactions, without_joined_overlaps};
use super::joined::held_of;
use super::tie::Ties;
use super::{ContactPlan, FrictionPlan, Joined, Placed, Problems};
use crate::scene::{Edges, GeneralContact as Table, Kind, Parameter, Scene, split_set};
use crate::solver::{ContactPair, Coupling, Model};
use std::collections::{BTreeMap, BTreeSet};
use stoss_contact_barrier::{GeneralContact, GeneralOptions, Interactions, Skin};
use stoss_mesh::BOUNDARY;

/// Speed of slip below which friction of two bodies falls, in parts of their largest relative speed at the start.
const SLIP: f64 = 0.01;

/// The same of bodies that do not move relative to each other, in parts of the speed of a fall through the layer.
const OF_FALL: f64 = 1e-3;

/// The same without gravity: part of the thickness in a nominal step.
const OF_STEP: f64 = 1e-4;

/// Relative speeds that are round-off, in parts of the speeds.
const NO_SPEED: f64 = 1e-9;

/// Pairs of bodies that the plan tells one by one.
const MOST_NAMED: usize = 6;

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
    let (skin, thickness) = skin(table, &Bodies { placed, model, rules: &rules }, facets, inner, problems, warnings)?;
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
    warnings.extend(without_effect(scene, table, placed, has_rates, has_friction));
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
    let gravity =
        scene.gravity.as_ref().map_or(0.0, |gravity| gravity.acceleration.iter().map(|a| a * a).sum::<f64>().sqrt());
    let at_rest = match gravity > 0.0 {
        true => OF_FALL * (2.0 * gravity * thickness).sqrt(),
        false => OF_STEP * thickness / super::phase::first_dynamic_step(scene),
    };
    move |a: u32, b: u32| {
        given.unwrap_or_else(|| match relative(a, b) {
            0.0 => at_rest,
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
        // At rest against each other without gravity: 1e-4 of the thickness in a step.
        let three = told(&[slow, slow, rest], "self = false\n");
        assert!(three.contains("2.0000e-5 (a and b)") && three.contains("5.0000e-3 (a and c)"), "{three}");
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
            assert_eq!(told(&[v, v], "self = false\n"), "creeps below 2.0000e-5");
            // 1e-3 of the speed of a fall through the layer, the root of 2 * 9 * 0.02.
            let heavy = told(&[v, v], "self = false\n[gravity]\nacceleration = [0, 0, -9]\n");
            assert_eq!(heavy, "creeps below 6.0000e-4");
        }
    }
}
