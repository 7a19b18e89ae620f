//! Which facets take part in general contact, in classes, and who acts on whom.

use super::condition::resolve;
use super::general_schemes::{connected, sorted};
use super::tie::Ties;
use super::young;
use super::{Placed, Problems};
use crate::scene::{Edges, GeneralContact as Table, Scene};
use crate::solver::{Model, short};
use std::collections::{BTreeMap, BTreeSet};
use stoss_contact_barrier::{Interaction, Interactions, Skin, SkinFacet};
use stoss_mesh::BOUNDARY;
use stoss_reference_element::FacetNodes;

/// Thickness of the layer in parts of the shortest edge, where the scene leaves it open.
pub(super) const THICKNESS: f64 = 0.04;

/// A place, with the digits that an edge of this length has.
pub(super) fn point(x: [f64; 3], edge: f64) -> String {
    let [x, y, z] = x.map(|x| short(x, edge));
    format!("({x}, {y}, {z})")
}

/// The shortest edge of facets of deformable bodies. Facets of rigid ones may be slivers, and much smaller than what they touch: they count only where there is nothing else.
pub(super) fn shortest_edge(skin: &Skin, rules: &Interactions, placed: &[Placed], reference: &[f64]) -> f64 {
    let at = |node: u32, i: usize| reference[3 * node as usize + i];
    let length = |a: u32, b: u32| (0..3).map(|i| (at(a, i) - at(b, i)).powi(2)).sum::<f64>();
    let mut shortest = [f64::INFINITY; 2];
    for facet in skin.facets() {
        let rigid = usize::from(placed[rules.body(facet.class) as usize].mesh().is_none());
        for &[i, j] in facet.nodes.kind().sides() {
            shortest[rigid] = shortest[rigid].min(length(facet.nodes[i], facet.nodes[j]));
        }
    }
    let [deformable, rigid] = shortest;
    if deformable.is_finite() { deformable.sqrt() } else { rigid.sqrt() }
}

/// Facets that take part, with classes: parts of bodies that named contacts and ties pair differently.
pub(super) struct Classes {
    pub facets: Vec<SkinFacet>,
    /// Part of each class.
    pub classes: Vec<usize>,
    /// Classes that a named contact or a tie pairs.
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
            // The other side of the same contact or tie.
            if on.iter().any(|side| other.contains(&(side ^ 1))) {
                apart.insert([*a, *b]);
            }
        }
    }
    Classes { facets: list, classes, apart }
}

/// A side of a named contact or of a tie.
enum Side {
    Contact(BTreeSet<FacetNodes>),
    /// Facets around it meet those around the other side, for ever: they belong to it as well, told by their nodes.
    Tie(BTreeSet<u32>),
}

impl Side {
    fn has(&self, facet: &FacetNodes) -> bool {
        match self {
            Self::Contact(facets) => facets.contains(facet),
            Self::Tie(nodes) => facet.iter().any(|node| nodes.contains(node)),
        }
    }
}

/// Both sides of contacts that are not left to general contact, and of ties, two by two.
fn sides(scene: &Scene, placed: &[Placed], ties: &Ties) -> Vec<Side> {
    let mut ignored = Problems { scene, list: Vec::new() };
    let mut sides = Vec::new();
    for contact in scene.contacts.iter().filter(|contact| contact.edges == Edges::Method) {
        for set in contact.surfaces() {
            let facets = resolve(placed, "", set, &mut ignored, Placed::facets_of);
            sides.push(Side::Contact(facets.map(|(_, facets)| facets.into_iter().collect()).unwrap_or_default()));
        }
    }
    let nodes = |facets: &BTreeSet<FacetNodes>| Side::Tie(facets.iter().flatten().copied().collect());
    sides.extend(ties.surfaces.iter().flatten().map(nodes));
    sides
}

/// Who acts on whom, and how.
pub(super) fn interactions(
    scene: &Scene,
    placed: &[Placed],
    table: &Table,
    model: &Model,
    classes: &[usize],
    apart: &BTreeSet<[u32; 2]>,
    warnings: &mut Vec<String>,
) -> Interactions {
    let is_rigid = |part: usize| placed[part].mesh().is_none();
    let is_held = |part: usize| is_rigid(part) && scene.rigids.iter().any(|r| r.name == placed[part].name && r.fixed);
    let connected = connected(scene);
    let bodies: Vec<(u32, bool)> = classes.iter().map(|&part| (part as u32, is_rigid(part))).collect();
    let mut rules = Interactions::none(&bodies);
    let mut unknown = BTreeSet::new();
    for (a, &p) in classes.iter().enumerate() {
        for (b, &q) in classes.iter().enumerate().skip(a) {
            let (a, b) = (a as u32, b as u32);
            if apart.contains(&[a, b]) || p == q && (!table.with_itself || is_rigid(p)) {
                continue;
            }
            let names = [&placed[p].name[..], &placed[q].name[..]];
            let own = table.pairs.iter().find(|pair| sorted([&pair.between[0], &pair.between[1]]) == sorted(names));
            if own.is_none() && connected.contains(&sorted(names)) {
                continue;
            }
            let softer = young(model, p).min(young(model, q));
            let modulus = own.and_then(|own| own.modulus).unwrap_or(table.stiffness * softer);
            if modulus.is_finite() {
                let friction = own.and_then(|own| own.friction).unwrap_or(table.friction);
                rules.set(a, b, Some(Interaction { modulus, friction, slip_velocity: f64::INFINITY }));
            } else if !(is_held(p) && is_held(q)) {
                unknown.insert(sorted(names));
            }
        }
    }
    for [a, b] in unknown {
        warnings.push(format!(
            "general_contact: the rigid bodies `{a}` and `{b}` pass through each other, because nothing tells how stiff the layer between them is; add to [general_contact]: \
             pairs = [{{ between = [\"{a}\", \"{b}\"], modulus = 1e6 }}] with a pressure"
        ));
    }
    rules
}
