//! Bodies: one for each material and connected piece.

use std::collections::{BTreeMap, BTreeSet};

use stoss_mesh::Facet;
use stoss_mesh_io::Solids;
use stoss_mesh_io::deck::{Damping, Deck};
use stoss_reference_element::{CellKind, Integration};

use crate::ImportError;
use crate::left_out::List;
use crate::material::{self, Law};
use crate::sets::Lookup;
use crate::severity::Severity;
use crate::text::count;

/// A body of the scene.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub name: String,
    /// Name of its material in the deck.
    pub material: String,
    pub law: Law,
    pub density: Option<f64>,
    /// `damping`.
    pub damping: Option<Damping>,
    /// `integration = "reduced"`.
    pub is_reduced: bool,
    /// `volumetric`, if the scene has to say it.
    pub volumetric: Option<&'static str>,
    /// Sorted.
    pub elements: Vec<u32>,
    pub nodes: BTreeSet<u32>,
}

/// All bodies, and what is known of nodes and facets.
pub(crate) struct Bodies {
    pub all: Vec<Body>,
    /// The body of an element.
    of_element: Vec<Option<u32>>,
    /// Facets between two elements of one body.
    inner: BTreeSet<(u32, u8)>,
    /// Facets between two bodies that share nodes: (slave, master) with the facets of both.
    pub interfaces: BTreeMap<(usize, usize), Vec<Facet>>,
    /// A node that several bodies share belongs to the first of them.
    owner: BTreeMap<u32, usize>,
}

impl Bodies {
    pub fn of_element(&self, element: u32) -> Option<usize> {
        self.of_element[element as usize].map(|body| body as usize)
    }

    /// The body that gets the force on a node: of several that share it only one.
    pub fn owner(&self, node: u32) -> Option<usize> {
        self.owner.get(&node).copied()
    }

    /// Whether a facet lies inside of its body.
    pub fn is_inner(&self, facet: &Facet) -> bool {
        self.inner.contains(&(facet.element, facet.local))
    }

    pub fn name(&self, body: usize) -> &str {
        &self.all[body].name
    }
}

/// A name of letters, digits, `-` and `_`, as a scene demands, that no other thing has.
pub(crate) fn unique_name(name: &str, taken: &mut BTreeSet<String>) -> String {
    const WORDS: [&str; 6] = ["x", "y", "z", "nearest", "normal", "ground"];
    let good = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let mut name: String = name.chars().map(|c| if good(c) { c } else { '-' }).collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) || WORDS.contains(&name.as_str()) {
        name = format!("body-{name}");
    }
    let name = name.trim_end_matches('-').to_owned();
    let mut unique = name.clone();
    let mut number = 2;
    while !taken.insert(unique.to_uppercase()) {
        unique = format!("{name}-{number}");
        number += 1;
    }
    unique
}

/// Treatment of element types that exist with several quadrature rules and with pressures as unknowns.
struct Variants {
    is_reduced: bool,
    is_hybrid: bool,
    /// C3D20R alone: few enough points that displacement elements follow plastic flow, which keeps the volume.
    follows_flow: bool,
    notes: Vec<(String, String)>,
}

/// `yields`: the material has `*PLASTIC`, which fully integrated elements take with an average of the change of volume.
fn variants(solids: &Solids, elements: &[u32], yields: bool) -> Variants {
    let mut types: BTreeMap<&str, (u32, usize)> = BTreeMap::new();
    for &e in elements {
        if let Some(&name) = solids.element_types.get(e as usize) {
            types.entry(name).or_insert((e, 0)).1 += 1;
        }
    }
    let kind = |name: &str| solids.mesh.elements.kind(types[name].0 as usize);
    let letters = |name: &str| {
        // Behind the family, C3D, CAX, CPE or CPS, and the number of nodes.
        name.get(3..).unwrap_or_default().trim_start_matches(|c: char| c.is_ascii_digit()).to_owned()
    };
    let can_reduce = |name: &str| kind(name).rule(Integration::Reduced).is_some();
    let reducible: Vec<&str> = types.keys().copied().filter(|name| can_reduce(name)).collect();
    let reduced: Vec<&str> = reducible.iter().copied().filter(|name| letters(name).contains('R')).collect();
    let is_reduced = !reduced.is_empty() && reduced.len() == reducible.len();
    let hybrid: Vec<&str> = types.keys().copied().filter(|name| letters(name).contains('H')).collect();
    let mut notes = Vec::new();
    if !reduced.is_empty() && !is_reduced {
        notes.push((
            format!(
                "a body has one rule of integration, and not all of {} have the reduced one: {} are fully integrated",
                reducible.join(", "),
                reduced.join(", ")
            ),
            "for the reduced rule in all of them set `integration = \"reduced\"`".to_owned(),
        ));
    }
    if !hybrid.is_empty() && hybrid.len() < types.len() {
        notes.push((
            "only some elements of the body have an independent pressure in the deck, and all of them have one here"
                .to_owned(),
            String::new(),
        ));
    }
    for (name, (_, number)) in &types {
        let kind = kind(name);
        let letters = letters(name);
        let bends = if kind.is_quadratic() { "" } else { "for bending add `cell = \"quadratic\"` to the body" };
        let of_type = format!("{} {name}", count(*number, "element", "elements"));
        let mut add = |here: String, remedy: &str| notes.push((format!("{of_type}: {here}"), remedy.to_owned()));
        if *name == "C3D8" && !yields {
            let here = "CalculiX averages the change of volume in C3D8; without that it is stiffer here in bending and where the material is nearly incompressible";
            add(here.to_owned(), bends);
        }
        if letters.contains('R') && !can_reduce(name) {
            add("it is fully integrated here, without hourglass modes: stiffer in bending".to_owned(), bends);
        }
        if letters.contains('I') && !kind.is_quadratic() {
            add("it has no incompatible modes here: stiffer in bending".to_owned(), bends);
        }
        if letters.contains('M') {
            let standard =
                format!("its modified shape functions and mass are not used: it is the standard {kind} here");
            add(standard, "compare with a finer mesh where the pressure matters");
        }
        if letters.contains("HS") || letters.contains('I') && kind.is_quadratic() {
            add("its extrapolation of stresses to the surface is not used".to_owned(), "");
        }
        if letters.contains('H') {
            let (here, remedy) = pressure(kind);
            add(format!("its independent pressure is `volumetric = \"mixed\"`: {here}"), remedy);
        }
    }
    let follows_flow = types.keys().all(|name| kind(name) == CellKind::Hex20 && letters(name).contains('R'));
    Variants { is_reduced, is_hybrid: !hybrid.is_empty(), follows_flow, notes }
}

/// What takes the place of the pressure of a hybrid element, and what to do for a better one.
fn pressure(kind: CellKind) -> (&'static str, &'static str) {
    match kind {
        CellKind::Hex8 => ("one value an element, as in the deck", ""),
        CellKind::Hex27 => ("linear in the element, as in the deck", ""),
        CellKind::Tet4 => {
            ("averages over the elements at each node", "add `cell = \"quadratic\"` to the body for smooth pressures")
        }
        CellKind::Wedge6 => ("one value an element, and wedge6 still locks", "add `cell = \"quadratic\"` to the body"),
        CellKind::Hex20 => (
            "one value an element, where Abaqus has a linear pressure: coarser pressures, and too soft in bending in a single row of elements",
            "add `cell = \"hex27\"` for linear pressures if the mesh is linear, or take two elements through the thickness",
        ),
        _ => (
            "one value an element, where Abaqus has a linear pressure: coarser pressures",
            "compare with a finer mesh where the pressure matters",
        ),
    }
}

/// The bodies of a deck.
pub(crate) fn bodies(
    deck: &Deck,
    solids: &Solids,
    lookup: &Lookup<'_>,
    list: &mut List,
) -> Result<Bodies, ImportError> {
    let mesh = &solids.mesh;
    let count = mesh.elements.len();
    let find = |name: &str| deck.materials.iter().position(|m| m.name.eq_ignore_ascii_case(name));
    // The section of each element: the last that names it.
    let mut section_of: Vec<Option<usize>> = vec![None; count];
    let mut reasons = Vec::new();
    for (s, section) in deck.sections.iter().enumerate() {
        let elements = match &section.part {
            Some(part) => lookup.elements_of_part(part, &section.elements),
            None => lookup.element_set(&section.elements).unwrap_or_default().members,
        };
        elements.iter().for_each(|&e| section_of[e as usize] = Some(s));
    }
    let mut of_material: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    let mut bare = 0;
    for (e, section) in section_of.iter().enumerate() {
        let Some(section) = section.map(|s| &deck.sections[s]) else {
            bare += 1;
            continue;
        };
        match find(&section.material) {
            Some(material) => of_material.entry(material).or_default().push(e as u32),
            None => {
                let reason = format!("{}: there is no material {}", list.place(section.place), section.material);
                if !reasons.contains(&reason) {
                    list.add(
                        Severity::Missing,
                        section.place,
                        "*SOLID SECTION",
                        format!("there is no material {}: its elements are not in the scene", section.material),
                        "name a material of the deck",
                    );
                    reasons.push(reason);
                }
            }
        }
    }
    if bare > 0 {
        reasons.push(format!("{bare} elements have no *SOLID SECTION"));
        list.add_general(
            Severity::Missing,
            format!("{bare} elements without *SOLID SECTION"),
            "they are not in the scene",
            "give them a section with a material",
        );
    }
    let mut all = Vec::new();
    let mut taken = BTreeSet::new();
    for (&m, elements) in &of_material {
        let material = &deck.materials[m];
        let yields = material::yields(material);
        let variants = variants(solids, elements, yields);
        let is_mixed = |law: &Law| variants.is_hybrid || law.is_incompressible && material.hyperelastic.is_some();
        let law = match material::law(material, variants.is_hybrid) {
            Ok(law) => law,
            Err(reason) => {
                reasons.push(format!("{}: {reason}", list.place(material.place)));
                let consequence = format!("{reason}: its {} elements are not in the scene", elements.len());
                list.add(
                    Severity::Missing,
                    material.place,
                    "*MATERIAL",
                    consequence,
                    "give it *ELASTIC or *HYPERELASTIC constants that can be imported",
                );
                continue;
            }
        };
        let notes = law.notes.iter().chain(&variants.notes);
        notes.for_each(|(note, remedy)| {
            list.add(Severity::Changed, material.place, format!("material {}", material.name), note, remedy);
        });
        if law.is_incompressible && !is_mixed(&law) && !yields {
            list.add(
                Severity::Changed,
                material.place,
                format!("material {}", material.name),
                "it is nearly incompressible, and its elements lock",
                "choose `law = \"neo-hooke\"` and `volumetric = \"mixed\"`",
            );
        }
        let piece_of = mesh.piece_of_elements(elements);
        let number = piece_of.iter().max().map_or(0, |last| last + 1);
        let mut own: Vec<Vec<u32>> = vec![Vec::new(); number];
        elements.iter().zip(&piece_of).for_each(|(&e, &piece)| own[piece].push(e));
        for (piece, elements) in own.into_iter().enumerate() {
            // Pieces of one material may have elements of different types.
            let types = self::variants(solids, &elements, yields);
            let nodes = elements.iter().flat_map(|&e| mesh.elements[e as usize].iter().copied()).collect();
            let set = mesh.element_sets.iter().find(|(_, set)| **set == elements).map(|(name, _)| name.clone());
            let section = section_of[elements[0] as usize].map_or(&material.name, |s| &deck.sections[s].elements);
            let numbered = if number > 1 { format!("{section}-{}", piece + 1) } else { section.clone() };
            let name = unique_name(&set.unwrap_or(numbered), &mut taken);
            all.push(Body {
                name,
                material: material.name.clone(),
                law: law.clone(),
                density: material.density,
                damping: material.damping.filter(|damping| *damping != Damping::default()),
                is_reduced: types.is_reduced,
                volumetric: if is_mixed(&law) {
                    Some("mixed")
                } else {
                    (yields && types.follows_flow).then_some("displacement")
                },
                elements,
                nodes,
            });
        }
    }
    if all.is_empty() {
        let reasons = if reasons.is_empty() { "there is no *SOLID SECTION".to_owned() } else { reasons.join("; ") };
        return Err(ImportError::NoBody { file: deck.contents.path().display().to_string(), reasons });
    }
    Ok(join(all, solids, list))
}

/// What bodies have in common.
fn join(all: Vec<Body>, solids: &Solids, list: &mut List) -> Bodies {
    let mesh = &solids.mesh;
    let mut of_element = vec![None; mesh.elements.len()];
    let mut owner = BTreeMap::new();
    let mut shared: BTreeMap<(usize, usize), BTreeSet<u32>> = BTreeMap::new();
    for (b, body) in all.iter().enumerate() {
        body.elements.iter().for_each(|&e| of_element[e as usize] = Some(b as u32));
        for &node in &body.nodes {
            let first = *owner.entry(node).or_insert(b);
            if first != b {
                shared.entry((b, first)).or_default().insert(node);
            }
        }
    }
    let index = mesh.facet_index();
    let mut inner = BTreeSet::new();
    let mut interfaces: BTreeMap<(usize, usize), Vec<Facet>> = BTreeMap::new();
    for (element, of) in of_element.iter().enumerate() {
        let kind = mesh.elements.kind(element);
        for local in 0..kind.faces().len() {
            let facet = mesh.facet(element as u32, local);
            let mut others = index.find(facet.nodes.corners()).filter(|other| other.element != facet.element);
            let Some(other) = others.next() else { continue };
            match (of, of_element[other.element as usize]) {
                (Some(a), Some(b)) if *a == b => {
                    inner.insert((facet.element, facet.local));
                }
                (Some(a), Some(b)) => {
                    let pair = ((*a).max(b) as usize, (*a).min(b) as usize);
                    interfaces.entry(pair).or_default().push(facet);
                }
                _ => {}
            }
        }
    }
    for ((b, a), nodes) in &shared {
        if !interfaces.contains_key(&(*b, *a)) {
            list.add_general(
                Severity::Missing,
                format!("bodies {} and {}", all[*a].name, all[*b].name),
                format!(
                    "they have different materials and share {} nodes but no facet: they are not joined at these nodes",
                    nodes.len()
                ),
                "give them the same material, or let them share facets",
            );
        }
    }
    if !interfaces.is_empty() {
        list.add_general(
            Severity::Note,
            "bodies of different materials that share nodes",
            "they are joined by ties: displacements agree in the mean of each facet, not at each node",
            "",
        );
    }
    Bodies { all, of_element, inner, interfaces, owner }
}
