//! Contacts of a scene: surfaces found and examined, the method made where its module is built in.

use super::condition::{prescribed, resolve};
use super::friction::gains_energy_in_impacts;
use super::missing::not_built_in;
use super::pair::{PairInput, area_vector, young};
use super::tie::Ties;
use super::{ContactPlan, OwnLaws, Placed, Problems};
use crate::scene::{ContactMethod, Enforcement, Scene};
use crate::solver::Model;
use std::collections::BTreeSet;
use stoss_reference_element::FacetNodes;

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
    let mut seen: Vec<([Vec<FacetNodes>; 2], &crate::scene::Contact)> = Vec::new();
    let held = held_nodes(scene, placed, model);
    for (c, item) in scene.contacts.iter().enumerate() {
        let key = format!("contact[{c}]");
        let ([first, second], keys) = (item.surfaces(), item.surface_keys());
        let first = resolve(placed, &format!("{key}.{}", keys[0]), first, problems, Placed::facets_of);
        let second = resolve(placed, &format!("{key}.{}", keys[1]), second, problems, Placed::facets_of);
        let (Some(first), Some(second)) = (first, second) else { continue };
        let (mut sides, mut chosen) = ([first, second], None);
        if item.between.is_some() {
            let (slave, reason) = choose_slave(model, &sides);
            chosen = Some(format!("{} ({reason})", item.surfaces()[slave]));
            sides.rotate_left(slave);
        }
        let [(slave_body, slave), (master_body, master)] = sides;
        let surfaces = [slave, master];
        if let Some((_, other)) = seen.iter().find(|(other, _)| *other == surfaces) {
            let message = format!("is the same contact as `{}`: its constraints would be there twice", other.label());
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
        if let Some(tie) = ties.of([slave, master]) {
            let message =
                format!("is between surfaces that `{tie}` ties together: they cannot part, nor touch any further");
            problems.add(key, item.label(), message, "remove the contact or the tie, or choose other surfaces");
            continue;
        }
        if surfaces.iter().all(|surface| is_prescribed(model, surface)) {
            let message =
                "every node of both surfaces is prescribed in all components: no contact force could move them";
            problems.add(key, item.label(), message, "remove the contact, or free one of the surfaces");
            continue;
        }
        let (bodies, facets) = ([slave_body, master_body], [&slave[..], &master[..]]);
        let pair = PairInput { scene, placed, laws, key, item, bodies, facets, chosen, held: &held, tied: &ties.tied };
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
    gains_energy_in_impacts(&*scheme).then(|| {
        format!(
            "time.integrator: `{}` gains energy in impacts, at every step size (docs/verification/stability.md): use `energy-momentum`, or \
             `backward-euler`, which loses some, if bodies collide",
            integrator.scheme
        )
    })
}

/// Sizes of facets that differ by less than this part are the same.
const SAME_SIZE: f64 = 0.05;

/// Which of two surfaces (body and facets) becomes the slave, and why: one whose motion is not prescribed, the finer one by the mean area of its facets, the softer
/// one by Young's modulus.
fn choose_slave(model: &Model, sides: &[(usize, Vec<FacetNodes>); 2]) -> (usize, &'static str) {
    let prescribed = [0, 1].map(|k| is_prescribed(model, &sides[k].1));
    let size = sides.each_ref().map(|(_, facets)| {
        let areas = facets.iter().map(|facet| area_vector(facet, &model.reference));
        areas.map(|a| 0.5 * a.iter().map(|a| a * a).sum::<f64>().sqrt()).sum::<f64>() / facets.len() as f64
    });
    let moduli = sides.each_ref().map(|(b, _)| young(model, *b));
    if prescribed[0] != prescribed[1] {
        return (usize::from(prescribed[0]), "the other one is prescribed");
    }
    if (size[0] - size[1]).abs() > SAME_SIZE * size[0].max(size[1]) {
        return (usize::from(size[1] < size[0]), "finer");
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
    let mut seen = BTreeSet::new();
    for surface in surfaces {
        let resolved = surface.iter().filter_map(|set| resolve(placed, "", set, &mut ignored, Placed::facets_of));
        let nodes: BTreeSet<u32> = resolved.flat_map(|(_, facets)| facets.into_iter().flatten()).collect();
        held.extend(nodes.intersection(&seen));
        seen.extend(nodes);
    }
    held
}

/// True if all components of all nodes of a surface are prescribed.
fn is_prescribed(model: &Model, facets: &[FacetNodes]) -> bool {
    let prescribed = prescribed(model);
    facets.iter().flatten().all(|&node| (0..3).all(|component| prescribed[3 * node as usize + component]))
}
