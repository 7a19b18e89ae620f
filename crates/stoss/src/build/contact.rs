//! Contacts of a scene: surfaces found and examined, the method made where its module is built in.

use super::condition::{facets, not_built_in, resolve};
use super::friction::gains_energy_in_impacts;
use super::tie::Ties;
use super::{ContactPlan, FrictionPlan, OwnLaws, Placed, Problems};
use crate::scene::{Constraint, ContactMethod, Enforcement, Scene};
use crate::solver::Model;
use std::collections::BTreeSet;
use stoss_contact::Auxiliary;
use stoss_mesh::Mesh;

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
    let mut seen: Vec<([Vec<[u32; 4]>; 2], &crate::scene::Contact)> = Vec::new();
    let held = held_nodes(scene, placed, model);
    for (c, item) in scene.contacts.iter().enumerate() {
        let key = format!("contact[{c}]");
        let ([first, second], keys) = (item.surfaces(), item.surface_keys());
        let first = resolve(scene, placed, &format!("{key}.{}", keys[0]), first, problems, facets);
        let second = resolve(scene, placed, &format!("{key}.{}", keys[1]), second, problems, facets);
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

/// One contact of a scene, its surfaces found.
pub(super) struct PairInput<'a> {
    pub scene: &'a Scene,
    pub placed: &'a [Placed],
    pub laws: &'a OwnLaws,
    pub key: String,
    pub item: &'a crate::scene::Contact,
    /// Slave and master.
    pub bodies: [usize; 2],
    pub facets: [&'a [[u32; 4]]; 2],
    /// The slave and why, where the scene leaves it open.
    pub chosen: Option<String>,
    /// Nodes whose motion may be determined without the friction of this contact.
    pub held: &'a BTreeSet<u32>,
    /// Slave nodes of ties.
    pub tied: &'a BTreeSet<u32>,
}

impl PairInput<'_> {
    /// Tells that the method cannot be made of these surfaces.
    pub fn refused(&self, error: &stoss_contact::ContactError, problems: &mut Problems<'_>) {
        let remedy = "choose two different, not degenerate surfaces of different bodies";
        problems.add(self.key.clone(), self.item.label(), error.to_string(), remedy);
    }

    /// What the contact will be computed with.
    pub fn plan(
        &self,
        method: &dyn stoss_contact::Constraint,
        constraint: Constraint,
        friction: Option<FrictionPlan>,
    ) -> ContactPlan {
        let item = self.item;
        ContactPlan {
            name: item.label(),
            slave: self.chosen.clone(),
            method: item.method.name().to_owned(),
            constraint: constraint.name().to_owned(),
            enforcement: match item.enforcement {
                Enforcement::Multiplier => "multiplier".to_owned(),
                Enforcement::Penalty(stiffness) => format!("penalty {stiffness:e}"),
                Enforcement::Augmented(stiffness) => format!("augmented Lagrangian {stiffness:e}"),
            },
            slots: method.slot_count() as u64,
            unknowns_per_slot: 1 + Auxiliary::equations(method.auxiliaries()) as u64,
            friction,
        }
    }

    /// Looks at the initial gaps; returns the factor of the complementarity function.
    pub fn prepare(
        &self,
        method: &mut dyn stoss_contact::ContactMethod,
        constraint: Constraint,
        model: &Model,
        problems: &mut Problems<'_>,
        warnings: &mut Vec<String>,
    ) -> f64 {
        let Self { scene, placed, key, item, bodies, .. } = self;
        match method.report(&model.reference) {
            Ok(reports) => {
                let tolerance = 1.0e-9 * method.length_scale();
                let inside = reports.iter().filter(|r| r.gap.is_some_and(|g| g < -tolerance)).count();
                let deepest = reports.iter().filter_map(|r| r.gap).fold(0.0, f64::min);
                if inside > 0 {
                    let keeps = constraint == Constraint::Modified
                        || (item.method == ContactMethod::Mortar && scene.time.integrator.is_some());
                    let then = if keeps {
                        "they keep that gap"
                    } else {
                        "the first step closes that gap and changes the energy"
                    };
                    warnings.push(format!(
                        "{}: {inside} slave nodes begin behind the master surface (deepest gap {deepest:.3e}); {then}",
                        item.label()
                    ));
                }
            }
            Err(error) => problems.add(key.clone(), item.label(), error.to_string(), "mend the surfaces"),
        }
        if !face_each_other(self.facets, &model.reference) {
            warnings.push(format!(
                "{}: no facet of the slave faces one of the master; there can be no contact before the bodies have turned. Name the sides that touch",
                item.label()
            ));
        }
        warnings.extend(overlap(&item.label(), bodies.map(|b| (&scene.bodies[b].name, &placed[b].mesh))));
        // The first frame shows the gaps of the nodes that are in reach, as later ones do.
        let speed = model.velocity.chunks_exact(3).map(|v| v[0].hypot(v[1]).hypot(v[2])).fold(0.0, f64::max);
        let reach = 2.0 * speed * scene.time.step + 0.5 * method.length_scale();
        if let Err(error) = method.begin_step(&model.reference, reach) {
            problems.add(key.clone(), item.label(), error.to_string(), "mend the surfaces");
        }
        // The softer body decides how the two terms of the complementarity function balance.
        let young = bodies
            .map(|b| model.bodies[b].solid.law().small_strain_moduli().young_modulus())
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        young / method.length_scale()
    }
}

impl PairInput<'_> {
    /// Mass per area of the elements behind the surfaces: the larger one, zero in statics.
    pub fn inertia(&self, model: &Model, length: f64) -> f64 {
        self.bodies.iter().filter_map(|&b| model.bodies[b].density).fold(0.0, f64::max) * length
    }
}

/// Sizes of facets that differ by less than this part are the same.
const SAME_SIZE: f64 = 0.05;

/// Which of two surfaces (body and facets) becomes the slave, and why: one whose motion is not prescribed, the finer one by the mean area of its facets, the softer
/// one by Young's modulus.
fn choose_slave(model: &Model, sides: &[(usize, Vec<[u32; 4]>); 2]) -> (usize, &'static str) {
    let prescribed = [0, 1].map(|k| is_prescribed(model, &sides[k].1));
    let size = sides.each_ref().map(|(_, facets)| {
        let areas = facets.iter().map(|facet| area_vector(facet, &model.reference));
        areas.map(|a| 0.5 * a.iter().map(|a| a * a).sum::<f64>().sqrt()).sum::<f64>() / facets.len() as f64
    });
    let young = sides.each_ref().map(|(b, _)| model.bodies[*b].solid.law().small_strain_moduli().young_modulus());
    if prescribed[0] != prescribed[1] {
        return (usize::from(prescribed[0]), "the other one is prescribed");
    }
    if (size[0] - size[1]).abs() > SAME_SIZE * size[0].max(size[1]) {
        return (usize::from(size[1] < size[0]), "finer");
    }
    match young[0].total_cmp(&young[1]) {
        std::cmp::Ordering::Less => (0, "softer"),
        std::cmp::Ordering::Greater => (1, "softer"),
        std::cmp::Ordering::Equal => (0, "both are alike"),
    }
}

/// Twice the area vector of a facet.
fn area_vector(facet: &[u32; 4], reference: &[f64]) -> [f64; 3] {
    let x = facet.map(|node| -> [f64; 3] { std::array::from_fn(|i| reference[3 * node as usize + i]) });
    let diagonal = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| x[b][i] - x[a][i]) };
    let (a, b) = (diagonal(0, 2), diagonal(1, 3));
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Cosine beyond a right angle from which on two facets see each other better than edge-on: 15 degrees.
const EDGE_ON: f64 = 0.25;

/// Whether a facet of the slave faces one of the master in the reference configuration, however far away.
fn face_each_other([slave, master]: [&[[u32; 4]]; 2], reference: &[f64]) -> bool {
    let normals = |facets: &[[u32; 4]]| -> Vec<[f64; 3]> {
        let normal = |facet: &[u32; 4]| {
            let n = area_vector(facet, reference);
            let length = n.iter().map(|n| n * n).sum::<f64>().sqrt();
            n.map(|n| if length > 0.0 { n / length } else { 0.0 })
        };
        facets.iter().map(normal).collect()
    };
    let (slave, master) = (normals(slave), normals(master));
    let sees = |n: &[f64; 3], m: &[f64; 3]| n.iter().zip(m).map(|(n, m)| n * m).sum::<f64>() < -EDGE_ON;
    slave.iter().any(|n| master.iter().any(|m| sees(n, m)))
}

/// A warning if two bodies lie in each other: what is deeper behind a surface than the search looks has no partner there.
fn overlap(label: &str, [(slave, slave_mesh), (master, master_mesh)]: [(&String, &Mesh); 2]) -> Option<String> {
    use super::overlap::Locator;
    let in_master = Locator::new(master_mesh).centres_of(slave_mesh);
    let in_slave = Locator::new(slave_mesh).centres_of(master_mesh);
    (in_master + in_slave > 0).then(|| {
        format!(
            "{label}: the bodies lie in each other: {in_master} elements of `{slave}` have their centre inside `{master}`, {in_slave} \
             of `{master}` inside `{slave}`; a node deeper behind a surface than the length of a facet finds no partner and is not \
             kept out: move one of the bodies"
        )
    })
}

/// Nodes with a prescribed component, and those on the surfaces of more than one contact or tie: there stick may repeat what is known already.
fn held_nodes(scene: &Scene, placed: &[Placed], model: &Model) -> BTreeSet<u32> {
    // Sets that are not there are reported where contacts and ties are made.
    let mut ignored = Problems { scene, list: Vec::new() };
    let surfaces = scene.contacts.iter().map(crate::scene::Contact::surfaces);
    let surfaces = surfaces.chain(scene.ties.iter().map(|item| [&item.slave[..], &item.master[..]]));
    let mut held: BTreeSet<u32> = model.prescriptions.iter().flat_map(|p| p.nodes.iter().copied()).collect();
    let mut seen = BTreeSet::new();
    for surface in surfaces {
        let resolved = surface.iter().filter_map(|set| resolve(scene, placed, "", set, &mut ignored, facets));
        let nodes: BTreeSet<u32> = resolved.flat_map(|(_, facets)| facets.into_iter().flatten()).collect();
        held.extend(nodes.intersection(&seen));
        seen.extend(nodes);
    }
    held
}

/// True if all components of all nodes of a surface are prescribed.
fn is_prescribed(model: &Model, facets: &[[u32; 4]]) -> bool {
    let mut prescribed = BTreeSet::new();
    for prescription in &model.prescriptions {
        for &node in &prescription.nodes {
            prescribed.extend(prescription.components.iter().map(|&component| (node, component)));
        }
    }
    facets.iter().flatten().all(|&node| (0..3).all(|component| prescribed.contains(&(node, component))))
}
