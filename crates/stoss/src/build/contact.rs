//! Contacts of a scene: surfaces found and examined, the method made where its module is built in.

use super::condition::{prescribed, resolve};
use super::missing::not_built_in;
use super::pair::{PairInput, finer};
use super::tie::Ties;
use super::young;
use super::{ContactPlan, OwnLaws, Placed, Problems};
use crate::scene::{ContactMethod, Enforcement, Scene, split_set};
use crate::solver::Model;
use std::collections::BTreeSet;
use stoss_reference_element::{FacePiece, FacetNodes};

/// One side of a contact.
#[derive(Clone, Default, PartialEq)]
pub(super) struct Side {
    /// Its part.
    pub part: usize,
    /// Outward, of the trace where faces are quadratic; none of a beam or string.
    pub facets: Vec<FacetNodes>,
    /// The pieces of the faces.
    pub pieces: Vec<FacePiece>,
    /// Nodes of a beam or string in their order, with their lengths.
    pub line: Vec<(u32, f64)>,
}

impl Side {
    fn find(placed: &[Placed], key: &str, set: &str, problems: &mut Problems<'_>) -> Option<Self> {
        if let Some((name, set)) = split_set(set)
            && let Some(part) = super::placed::index(placed, name)
            && let Some(line) = placed[part].line_of(set)
        {
            return Some(Self { part, line, ..Self::default() });
        }
        let (part, facets) = resolve(placed, key, set, problems, Placed::facets_of)?;
        let (_, pieces) = resolve(placed, key, set, problems, Placed::pieces_of)?;
        Some(Self { part, facets, pieces, ..Self::default() })
    }

    pub fn is_line(&self) -> bool {
        !self.line.is_empty()
    }

    fn nodes(&self) -> impl Iterator<Item = u32> {
        let of_pieces = self.pieces.iter().flat_map(|piece| piece.facet());
        self.facets.iter().flatten().copied().chain(of_pieces).chain(self.line.iter().map(|&(node, _)| node))
    }
}

pub(super) fn contacts(
    scene: &Scene,
    placed: &[Placed],
    laws: &OwnLaws,
    ties: &Ties,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Vec<ContactPlan> {
    let mut plans = Vec::new();
    warnings.extend(impacts(scene));
    let mut seen: Vec<([Side; 2], &crate::scene::Contact)> = Vec::new();
    let held = held_nodes(scene, placed, model);
    for (c, item) in scene.contacts.iter().enumerate() {
        let key = format!("contact[{c}]");
        let ([first, second], keys) = (item.surfaces(), item.surface_keys());
        let first = Side::find(placed, &format!("{key}.{}", keys[0]), first, problems);
        let second = Side::find(placed, &format!("{key}.{}", keys[1]), second, problems);
        let (Some(first), Some(second)) = (first, second) else { continue };
        let (mut surfaces, mut chosen) = ([first, second], None);
        if item.between.is_some() {
            let (slave, reason) = choose_slave(model, &surfaces);
            chosen = Some(format!("{} ({reason})", item.surfaces()[slave]));
            surfaces.rotate_left(slave);
        }
        if let Some((_, other)) = seen.iter().find(|(other, _)| *other == surfaces) {
            let message = format!("is the same contact as `{}`: its constraints would be redundant", other.label());
            problems.add(format!("{key}.name"), item.label(), message, "remove one of the two");
            continue;
        }
        let [slave, master] = &surfaces;
        let is_exact = |contact: &crate::scene::Contact| !matches!(contact.enforcement, Enforcement::Penalty(_));
        if let Some((_, other)) = seen.iter().find(|([s, m], _)| s == master && m == slave)
            && is_exact(item)
            && is_exact(other)
        {
            warnings.push(format!(
                "{} is {} with slave and master exchanged: the nodes of both cannot all be kept out exactly, and pressures may not be determined. Remove \
                 one of the two; `nts` may have both with penalties",
                item.label(),
                other.label()
            ));
        }
        if !slave.is_line()
            && let Some(tie) = ties.of([&slave.facets, &master.facets])
        {
            let message =
                format!("is between surfaces that `{tie}` ties together, so that contact cannot have an effect");
            problems.add(key, item.label(), message, "remove the contact or the tie, or choose other surfaces");
            continue;
        }
        if surfaces.iter().all(|surface| is_prescribed(model, surface)) {
            let message =
                "every node of both surfaces is prescribed in all components: no contact force could move them";
            problems.add(key, item.label(), message, "remove the contact, or free one of the surfaces");
            continue;
        }
        let (bodies, facets) = ([slave.part, master.part], [&slave.facets[..], &master.facets[..]]);
        let pieces = [&slave.pieces[..], &master.pieces[..]];
        let (line, tied) = (&slave.line[..], &ties.tied);
        let pair =
            PairInput { scene, placed, laws, key, item, bodies, facets, pieces, line, chosen, held: &held, tied };
        plans.extend(match item.method {
            #[cfg(feature = "nts")]
            ContactMethod::Nts | ContactMethod::Cat => super::nts::contact(&pair, model, problems, warnings),
            #[cfg(feature = "mortar")]
            ContactMethod::Mortar => super::mortar::contact(&pair, model, problems, warnings),
            #[allow(unreachable_patterns, reason = "which methods are built in depends on the features")]
            _ => {
                not_built_in(pair.key, item, problems);
                None
            }
        });
        seen.push((surfaces, item));
    }
    plans
}

/// A warning if the scheme is one that gains energy in impacts.
fn impacts(scene: &Scene) -> Option<String> {
    let integrator = scene.time.integrator.as_ref().filter(|_| !scene.contacts.is_empty())?;
    let scheme = integrator.make().ok()?;
    scheme.rule(1.0).gains_energy_in_impacts().then(|| {
        format!(
            "time.integrator: `{}` gains energy in impacts, at every step size (docs/verification/stability.md): use `energy-momentum`, or \
             `backward-euler`, which loses some, if bodies collide",
            integrator.scheme
        )
    })
}

/// Which of two sides becomes the slave, and why: a beam or string, one whose motion is not prescribed, the finer one by the mean area of its facets, the softer
/// one by Young's modulus.
fn choose_slave(model: &Model, sides: &[Side; 2]) -> (usize, &'static str) {
    if let Some(line) = sides.iter().position(Side::is_line) {
        return (line, "it has no facets");
    }
    let prescribed = [0, 1].map(|k| is_prescribed(model, &sides[k]));
    let moduli = sides.each_ref().map(|side| young(model, side.part));
    if prescribed[0] != prescribed[1] {
        return (usize::from(prescribed[0]), "the other one is prescribed");
    }
    if let Some(finer) = finer(sides.each_ref().map(|side| &side.facets[..]), &model.reference) {
        return (finer, "finer");
    }
    match moduli[0].total_cmp(&moduli[1]) {
        std::cmp::Ordering::Less => (0, "softer"),
        std::cmp::Ordering::Greater => (1, "softer"),
        std::cmp::Ordering::Equal => (0, "both are alike"),
    }
}

/// Nodes with a prescribed component, and those on the surfaces of more than one contact or tie: there stick may repeat what is known already.
fn held_nodes(scene: &Scene, placed: &[Placed], model: &Model) -> BTreeSet<u32> {
    // Sets that are not there are reported where contacts and ties are made.
    let mut ignored = Problems { scene, list: Vec::new() };
    let surfaces = scene.contacts.iter().map(crate::scene::Contact::surfaces);
    let surfaces = surfaces.chain(scene.ties.iter().map(|item| [&item.slave[..], &item.master[..]]));
    let held = prescribed(model);
    let is_held = |node: u32| (0..3).any(|i| held[3 * node as usize + i]);
    let mut held: BTreeSet<u32> = (0..model.node_count() as u32).filter(|&node| is_held(node)).collect();
    let inclined = scene.prescriptions.iter().filter(|item| item.is_inclined()).filter_map(|item| item.set.as_deref());
    for set in inclined {
        held.extend(resolve(placed, "", set, &mut ignored, Placed::nodes_of).into_iter().flat_map(|(_, nodes)| nodes));
    }
    let mut seen = BTreeSet::new();
    for surface in surfaces {
        let sides = surface.iter().filter_map(|set| Side::find(placed, "", set, &mut ignored));
        let nodes: BTreeSet<u32> = sides.flat_map(|side| side.nodes().collect::<Vec<_>>()).collect();
        held.extend(nodes.intersection(&seen));
        seen.extend(nodes);
    }
    held
}

/// True if all components of all nodes of a side are prescribed.
fn is_prescribed(model: &Model, side: &Side) -> bool {
    let prescribed = prescribed(model);
    side.nodes().all(|node| (0..3).all(|component| prescribed[3 * node as usize + component]))
}
