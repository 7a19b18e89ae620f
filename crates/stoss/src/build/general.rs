//! General contact of a scene: the skin of its bodies, and who acts on whom.

use super::condition::resolve;
use super::tie::Ties;
use super::young;
use super::{Placed, Problems};
use crate::scene::{GeneralContact as Table, Scene};
use crate::solver::{ContactPair, Coupling, Model};
use std::collections::{BTreeMap, BTreeSet};
use stoss_contact_barrier::{GeneralContact, GeneralOptions, Interaction, Interactions, Skin, SkinFacet};
use stoss_mesh::BOUNDARY;
use stoss_reference_element::FacetNodes;

/// Name in messages and tables.
pub(super) const NAME: &str = "general";

/// Thickness of the layer in parts of the shortest edge, where the scene leaves it open.
const THICKNESS: f64 = 0.04;

/// Speed of slip below which friction falls, in parts of the speed of waves.
const SLIP: f64 = 1e-3;

/// Speed of waves in a bar of a body's material.
fn wave_speed(body: &crate::solver::Body) -> Option<f64> {
    Some((body.solid.law().small_strain_moduli().young_modulus() / body.density?).sqrt())
}

/// Adds general contact to the model if the scene has it.
pub(super) fn general(scene: &Scene, placed: &[Placed], ties: &Ties, model: &mut Model, problems: &mut Problems<'_>) {
    let Some(table) = &scene.general_contact else { return };
    let before = problems.list.len();
    let skins = facets(scene, placed, table, ties, problems);
    if problems.list.len() > before {
        return;
    }
    let Classes { facets, classes, apart } = skins;
    if facets.is_empty() {
        problems.add(
            "general_contact".into(),
            "",
            "there is no surface that takes part",
            "include a body, or remove the table",
        );
        return;
    }
    let Some(rules) = interactions(placed, table, model, &classes, &apart, problems) else { return };
    let skin = Skin::new(facets, &model.reference, &|_| None);
    let thickness = table.thickness.unwrap_or_else(|| THICKNESS * shortest_edge(&skin, &model.reference));
    let slowest = model.bodies.iter().filter_map(wave_speed).fold(f64::INFINITY, f64::min);
    let slip_velocity = table.slip_velocity.unwrap_or(SLIP * if slowest.is_finite() { slowest } else { 1.0 });
    let options = GeneralOptions { thickness, damping: table.damping, slip_velocity };
    match GeneralContact::new(NAME, skin, rules, options) {
        Ok(contact) => model.contacts.push(ContactPair {
            name: NAME.to_owned(),
            method: Coupling::potential(contact),
            complementarity: 0.0,
            restores: false,
        }),
        Err(error) => {
            problems.add("general_contact".into(), "", error.to_string(), "see docs/guide.md, [general_contact]")
        }
    }
}

fn shortest_edge(skin: &Skin, reference: &[f64]) -> f64 {
    let at = |node: u32, i: usize| reference[3 * node as usize + i];
    let length = |a: u32, b: u32| (0..3).map(|i| (at(a, i) - at(b, i)).powi(2)).sum::<f64>();
    let mut shortest = f64::INFINITY;
    for facet in skin.facets() {
        for &[i, j] in facet.nodes.kind().sides() {
            shortest = shortest.min(length(facet.nodes[i], facet.nodes[j]));
        }
    }
    shortest.sqrt()
}

/// Facets that take part, with classes: parts of bodies that named contacts and ties pair differently.
struct Classes {
    facets: Vec<SkinFacet>,
    /// Part of each class.
    classes: Vec<usize>,
    /// Classes that a named contact or a tie pairs.
    apart: BTreeSet<[u32; 2]>,
}

fn facets(scene: &Scene, placed: &[Placed], table: &Table, ties: &Ties, problems: &mut Problems<'_>) -> Classes {
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
    // Sides of named contacts and of ties, two by two.
    let mut sides: Vec<BTreeSet<FacetNodes>> = Vec::new();
    let mut ignored = Problems { scene, list: Vec::new() };
    for contact in &scene.contacts {
        for set in contact.surfaces() {
            let facets = resolve(placed, "", set, &mut ignored, Placed::facets_of);
            sides.push(facets.map(|(_, facets)| facets.into_iter().collect()).unwrap_or_default());
        }
    }
    sides.extend(ties.surfaces.iter().flatten().cloned());
    let mut known: BTreeMap<(usize, Vec<usize>), u32> = BTreeMap::new();
    let (mut list, mut classes) = (Vec::new(), Vec::new());
    for (p, part) in placed.iter().enumerate() {
        for nodes in part.facets_of(BOUNDARY).unwrap_or_default() {
            if !(table.include.is_empty() || included.contains(&nodes)) || excluded.contains(&nodes) {
                continue;
            }
            let on: Vec<usize> = (0..sides.len()).filter(|&s| sides[s].contains(&nodes)).collect();
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
            // The other side of the same contact or tie.
            if on.iter().any(|side| other.contains(&(side ^ 1))) {
                apart.insert([*a, *b]);
            }
        }
    }
    Classes { facets: list, classes, apart }
}

fn interactions(
    placed: &[Placed],
    table: &Table,
    model: &Model,
    classes: &[usize],
    apart: &BTreeSet<[u32; 2]>,
    problems: &mut Problems<'_>,
) -> Option<Interactions> {
    let is_rigid = |part: usize| placed[part].mesh().is_none();
    let bodies: Vec<(u32, bool)> = classes.iter().map(|&part| (part as u32, is_rigid(part))).collect();
    let mut rules = Interactions::none(&bodies);
    let before = problems.list.len();
    for (a, &p) in classes.iter().enumerate() {
        for (b, &q) in classes.iter().enumerate().skip(a) {
            let (a, b) = (a as u32, b as u32);
            if apart.contains(&[a, b]) || p == q && (!table.with_itself || is_rigid(p)) {
                continue;
            }
            let names = [&placed[p].name, &placed[q].name];
            let own = table.pairs.iter().find(|pair| {
                let [s, t] = &pair.between;
                [s, t] == names || [t, s] == names
            });
            let softer = young(model, p).min(young(model, q));
            let modulus = own.and_then(|own| own.modulus).unwrap_or(table.stiffness * softer);
            if !modulus.is_finite() {
                let message = format!(
                    "`{}` and `{}` are rigid: nothing tells how stiff the layer between them is",
                    names[0], names[1]
                );
                let remedy = format!(
                    "add to [general_contact]: pairs = [{{ between = [\"{}\", \"{}\"], modulus = 1e6 }}] with a pressure",
                    names[0], names[1]
                );
                problems.add("general_contact".into(), "", message, remedy);
                continue;
            }
            let friction = own.and_then(|own| own.friction).unwrap_or(table.friction);
            rules.set(a, b, Some(Interaction { modulus, friction }));
        }
    }
    (problems.list.len() == before).then_some(rules)
}
