//! Which facets take part in general contact, in classes, and who acts on whom.

use super::condition::resolve;
use super::general_schemes::{Bond, connected, owner, sorted};
use super::general_table::Frictions;
use super::joined::held;
use super::tie::Ties;
use super::young;
use super::{Placed, Problems};
use crate::scene::{Edges, GeneralContact as Table, Scene};
use crate::solver::{Model, short};
use std::collections::{BTreeMap, BTreeSet};
use stoss_contact_barrier::{Interaction, Interactions, Overlaps, Relation, Skin, SkinFacet};
use stoss_mesh::BOUNDARY;
use stoss_reference_element::FacetNodes;
use stoss_tensor::Vector3;

/// A place, with the digits that an edge of this length has.
pub(super) fn point(x: [f64; 3], edge: f64) -> String {
    let [x, y, z] = x.map(|x| short(x, edge));
    format!("({x}, {y}, {z})")
}

/// Facets that take part, with classes: parts of bodies that named contacts, ties and joints pair differently.
pub(super) struct Classes {
    pub facets: Vec<SkinFacet>,
    /// Part of each class.
    pub classes: Vec<usize>,
    /// Classes that a named contact, a tie or a joint pairs.
    pub apart: BTreeSet<[u32; 2]>,
}

pub(super) fn facets(
    scene: &Scene,
    placed: &[Placed],
    table: &Table,
    ties: &Ties,
    problems: &mut Problems<'_>,
) -> Classes {
    let mut find = |key: &str, sets: &[String]| -> BTreeSet<FacetNodes> {
        let mut found = BTreeSet::new();
        for (k, name) in sets.iter().enumerate() {
            let whole = super::placed::index(placed, name);
            let set = whole.map_or(name.clone(), |part| format!("{}.{BOUNDARY}", placed[part].name));
            let key = format!("general_contact.{key}[{k}]");
            if let Some((_, facets)) = resolve(placed, &key, &set, problems, Placed::facets_of) {
                found.extend(facets);
            }
        }
        found
    };
    let (included, excluded) = (find("include", &table.include), find("exclude", &table.exclude));
    let sides = sides(scene, placed, ties);
    let mut known: BTreeMap<(usize, Vec<usize>), u32> = BTreeMap::new();
    let (mut list, mut classes) = (Vec::new(), Vec::new());
    for (p, part) in placed.iter().enumerate() {
        for nodes in part.facets_of(BOUNDARY).unwrap_or_default() {
            if !(table.include.is_empty() || included.contains(&nodes)) || excluded.contains(&nodes) {
                continue;
            }
            let on: Vec<usize> = (0..sides.len()).filter(|&s| sides[s].has(&nodes)).collect();
            let next = classes.len() as u32;
            let class = *known.entry((p, on)).or_insert(next);
            if class == next {
                classes.push(p);
            }
            list.push(SkinFacet { nodes, class });
        }
    }
    let mut apart = BTreeSet::new();
    for ((_, on), a) in &known {
        for ((_, other), b) in &known {
            // The other side of the same contact, tie or joint.
            if on.iter().any(|side| other.contains(&(side ^ 1))) {
                apart.insert([*a, *b]);
            }
        }
    }
    Classes { facets: list, classes, apart }
}

/// A side of a named contact, or of a tie or a joint.
enum Side {
    Contact(BTreeSet<FacetNodes>),
    /// Facets around it meet those around the other side, without end: they belong to it as well, told by their nodes.
    Joined(BTreeSet<u32>),
}

impl Side {
    fn has(&self, facet: &FacetNodes) -> bool {
        match self {
            Self::Contact(facets) => facets.contains(facet),
            Self::Joined(nodes) => facet.iter().any(|node| nodes.contains(node)),
        }
    }
}

/// Both sides of contacts that are not left to general contact, of ties, and of joints that hold on to a set, two by two.
fn sides(scene: &Scene, placed: &[Placed], ties: &Ties) -> Vec<Side> {
    let mut ignored = Problems { scene, list: Vec::new() };
    let mut sides = Vec::new();
    for contact in scene.contacts.iter().filter(|contact| contact.edges == Edges::Method) {
        for set in contact.surfaces() {
            let facets = resolve(placed, "", set, &mut ignored, Placed::facets_of);
            sides.push(Side::Contact(facets.map(|(_, facets)| facets.into_iter().collect()).unwrap_or_default()));
        }
    }
    let nodes = |facets: &BTreeSet<FacetNodes>| Side::Joined(facets.iter().flatten().copied().collect());
    sides.extend(ties.surfaces.iter().flatten().map(nodes));
    // How near each other the sides of a joint come is its business: those of a cut bolt overlap by what the pretension shortens it. Where it holds on to two whole parts, a scene that
    // names them as a pair means their surfaces.
    let connected = connected(scene);
    let ends = |parts| connected.get(&sorted(parts)).is_some_and(|bond| *bond == Bond::Ends);
    for joint in scene.joints.iter().filter(|joint| !ends(joint.between.each_ref().map(|side| owner(side)))) {
        let held = joint.between.each_ref().map(|side| held(placed, side));
        if held.iter().any(|(_, is_whole)| !is_whole) {
            sides.extend(held.map(|(nodes, _)| Side::Joined(nodes)));
        }
    }
    sides
}

/// Interactions of the parts of a scene.
pub(super) fn interactions(
    scene: &Scene,
    placed: &[Placed],
    table: &Table,
    frictions: &Frictions,
    model: &Model,
    classes: &[usize],
    apart: &BTreeSet<[u32; 2]>,
    warnings: &mut Vec<String>,
) -> Interactions {
    let is_rigid = |part: usize| placed[part].mesh().is_none();
    let is_held = |part: usize| is_rigid(part) && scene.rigids.iter().any(|r| r.name == placed[part].name && r.fixed);
    let connected = connected(scene);
    let bodies: Vec<(u32, f64)> = classes.iter().map(|&part| (part as u32, young(model, part))).collect();
    let mut rules = Interactions::none(&bodies);
    let by_weight = |parts: &[usize; 2]| {
        let movable = parts.iter().copied().filter(|&part| !is_held(part));
        let known = movable.filter_map(|part| weight_and_area(scene, &placed[part], model));
        let [weight, area] = known.min_by(|a, b| a[0].total_cmp(&b[0]))?;
        Some(Interaction::modulus_by_weight(weight, area))
    };
    let (mut unknown, mut left_out) = (BTreeSet::new(), BTreeSet::new());
    for (a, &p) in classes.iter().enumerate() {
        for (b, &q) in classes.iter().enumerate().skip(a) {
            let (a, b) = (a as u32, b as u32);
            if apart.contains(&[a, b]) || p == q && (!table.with_itself || is_rigid(p)) {
                continue;
            }
            let names = [&placed[p].name[..], &placed[q].name[..]];
            let number =
                table.pairs.iter().position(|pair| sorted([&pair.between[0], &pair.between[1]]) == sorted(names));
            let own = number.map(|k| &table.pairs[k]);
            let bond = connected.get(&sorted(names)).filter(|_| own.is_none());
            if let Some(&bond) = bond.filter(|bond| **bond != Bond::Ends) {
                if bond == Bond::Lasts && !(is_held(p) && is_held(q)) {
                    left_out.insert(sorted(names));
                }
                continue;
            }
            let in_series = Interaction::modulus_of_layer(table.stiffness, [p, q].map(|part| young(model, part)));
            let of_table =
                || if in_series.is_finite() { Some(in_series) } else { table.modulus.or_else(|| by_weight(&[p, q])) };
            let modulus = own.and_then(|own| own.modulus).or_else(of_table).unwrap_or(f64::INFINITY);
            if modulus.is_finite() {
                let friction = frictions.between(number, [p, q]);
                rules.set(a, b, Some(Interaction { modulus, friction }));
            } else if !(is_held(p) && is_held(q)) {
                unknown.insert(sorted(names));
            }
        }
    }
    for [a, b] in unknown {
        warnings.push(format!(
            "general_contact: the rigid bodies `{a}` and `{b}` pass through each other, because the stiffness of the layer between them is not given, and does not follow from a weight; add to [general_contact]: \
             modulus = 1e6 (a pressure), or for these two alone pairs = [{{ between = [\"{a}\", \"{b}\"], modulus = 1e6 }}]"
        ));
    }
    warnings.extend(joined_pairs(&left_out));
    rules
}

/// The weight of a rigid body (a force), and the smallest side of the box around its surface (an area); nothing without gravity or mass, or if it is flat.
fn weight_and_area(scene: &Scene, part: &Placed, model: &Model) -> Option<[f64; 2]> {
    let acceleration = scene.gravity.as_ref()?.acceleration;
    let body = model.parts.iter().find(|known| known.name() == part.name)?;
    let mut force = Vector3::zeros();
    body.weight(acceleration, &mut |vector, own| {
        if !body.is_direction(vector) {
            force += Vector3::from(own);
        }
    });
    let x = |node: u32| Vector3::from_column_slice(&model.reference[3 * node as usize..3 * node as usize + 3]);
    let none = [Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)];
    let facets = part.facets_of(BOUNDARY).ok()?;
    let [low, high] = facets.iter().flatten().fold(none, |[low, high], &n| [low.inf(&x(n)), high.sup(&x(n))]);
    let mut extents: [f64; 3] = (high - low).into();
    extents.sort_by(f64::total_cmp);
    let found = [force.norm(), extents[0] * extents[1]];
    found.iter().all(|value| *value > 0.0 && value.is_finite()).then_some(found)
}

/// Names of pairs in a message; more than these are counted.
const LISTED: usize = 8;

/// What becomes of pairs that joints connect.
fn joined_pairs(pairs: &BTreeSet<[&str; 2]>) -> Option<String> {
    let [a, b] = pairs.first()?;
    let listed: Vec<String> = pairs.iter().take(LISTED).map(|[a, b]| format!("`{a}` and `{b}`")).collect();
    let more = pairs.len().saturating_sub(LISTED);
    let more = if more > 0 { format!(", and {more} more pairs") } else { String::new() };
    Some(format!(
        "general_contact: joints connect {}{more}: there is no contact between them, at the joint or elsewhere; name those that may come into contact in [general_contact]: \
         pairs = [{{ between = [\"{a}\", \"{b}\"] }}] (of two rigid bodies with a `modulus`, a pressure)",
        listed.join("; ")
    ))
}

/// Takes pairs whose joints end later, and which overlap at the start, from the interactions.
pub(super) fn without_joined_overlaps(
    scene: &Scene,
    placed: &[Placed],
    table: &Table,
    facets: &[SkinFacet],
    reference: &[f64],
    rules: &mut Interactions,
) -> Vec<String> {
    let is_named =
        |names: [&str; 2]| table.pairs.iter().any(|pair| sorted([&pair.between[0], &pair.between[1]]) == sorted(names));
    let ends = connected(scene).into_iter().filter(|(names, bond)| *bond == Bond::Ends && !is_named(*names));
    let known = ends.filter_map(|(names, _)| {
        let [a, b] = names.map(|name| super::placed::index(placed, name));
        Some((names, [a? as u32, b? as u32]))
    });
    let acting: Vec<_> = known.filter(|(_, pair)| rules.acts_between(*pair)).collect();
    if acting.is_empty() {
        return Vec::new();
    }
    let skin = Skin::new(facets.to_vec(), reference, &|_| None);
    let overlaps = Overlaps::new(&skin, rules, reference);
    let lies_in = |pair| !matches!(overlaps.relation(pair, &Vector3::zeros(), 0.0), Relation::Apart(_));
    let out: Vec<_> = acting.into_iter().filter(|(_, pair)| lies_in(*pair)).collect();
    for (_, pair) in &out {
        rules.exclude(*pair);
    }
    let message = |[a, b]: [&str; 2]| {
        format!(
            "general_contact: a joint that ends later connects `{a}` and `{b}`, which overlap at the start: there is no contact between them, then either, and they pass through each other; \
             move one of them"
        )
    };
    out.into_iter().map(|(names, _)| message(names)).collect()
}
