//! Mesh ties.

use super::Problems;
#[cfg(feature = "mortar")]
use super::condition::resolve;
use super::phase::Phases;
#[cfg(feature = "mortar")]
use super::placed::Discretisation;
use super::placed::Placed;
use crate::scene::Scene;
use crate::solver::{CouplingTerm, Model};
use std::collections::BTreeSet;
use stoss_reference_element::FacetNodes;
#[cfg(feature = "mortar")]
use stoss_term::HeldNodes;

/// A tie of a larger share of its slave surface leaves nothing free but round-off, and slivers of curved rims.
#[cfg(feature = "mortar")]
const WHOLLY_TIED: f64 = 0.999;

/// Ties of a scene, their surfaces (slave, master; of the trace where faces are quadratic), and the slave nodes that they hold.
#[derive(Default)]
#[cfg_attr(
    not(any(feature = "nts", feature = "mortar")),
    allow(dead_code, reason = "for contacts, which are not built in")
)]
pub(super) struct Ties {
    pub pairs: Vec<CouplingTerm>,
    pub surfaces: Vec<[BTreeSet<FacetNodes>; 2]>,
    pub tied: BTreeSet<u32>,
}

#[cfg(any(feature = "nts", feature = "mortar"))]
impl Ties {
    /// The tie that holds two surfaces together, whichever of them is its slave, if there is one.
    pub fn of(&self, surfaces: [&[FacetNodes]; 2]) -> Option<&str> {
        let within = |tie: [&BTreeSet<FacetNodes>; 2]| (0..2).all(|i| surfaces[i].iter().all(|f| tie[i].contains(f)));
        let holds = |[slave, master]: &[BTreeSet<FacetNodes>; 2]| within([slave, master]) || within([master, slave]);
        let mut found = self.pairs.iter().zip(&self.surfaces).filter(|(_, surfaces)| holds(surfaces));
        found.next().map(|(pair, _)| pair.name.as_str())
    }
}

/// Makes the ties of a scene; moves slave nodes of the meshes and of the model where surfaces do not fit.
///
/// Prescribed components, and slave nodes of earlier ties, have no multipliers. If a tie moves nodes of the surfaces of an earlier one, that one is made
/// again.
#[cfg(feature = "mortar")]
pub(super) fn ties(
    scene: &Scene,
    placed: &mut [Placed],
    phases: &Phases,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Ties {
    let before = problems.list.len();
    for _ in 0..scene.ties.len() {
        let (ties, is_stale) = made(scene, placed, phases, model, problems, warnings);
        if !is_stale || problems.list.len() > before {
            return ties;
        }
    }
    if !scene.ties.is_empty() {
        let message = "the ties move nodes of each other's surfaces in a cycle";
        let remedy = "set `interface` to \"keep\" or \"close\" in one of them";
        problems.add("tie[0].interface".into(), "move", message, remedy);
    }
    Ties::default()
}

/// All ties, and whether one has moved nodes of the surfaces of an earlier one.
#[cfg(feature = "mortar")]
fn made(
    scene: &Scene,
    placed: &mut [Placed],
    phases: &Phases,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> (Ties, bool) {
    use crate::scene::{Interface as SceneInterface, Multipliers, TieForm as SceneForm};
    use stoss_contact_mortar::tie::{Interface, MeshTie, TieForm, TieOptions};
    use stoss_contact_mortar::{MortarError, MultiplierSpace};
    let mut ties = Ties::default();
    let (mut surfaces, mut is_stale) = (BTreeSet::new(), false);
    // Prescribed in the first stage, and from the beginning to the end; components of slave nodes of ties.
    let prescribed = |support: HeldNodes| -> Vec<bool> {
        (0..model.node_count() as u32).flat_map(|node| support.prescribed(node)).collect()
    };
    let mut supports = phases.all().map(|phase| prescribed(phase.held_nodes(model)));
    let (first, always) = (supports.next().unwrap_or_default(), prescribed(phases.lasting(model)));
    let varies = always != first || supports.any(|other| other != first);
    let mut tied = vec![false; first.len()];
    for (t, item) in scene.ties.iter().enumerate() {
        let key = format!("tie[{t}]");
        let slave = resolve(placed, &format!("{key}.slave"), &item.slave, problems, Placed::pieces_of);
        let master = resolve(placed, &format!("{key}.master"), &item.master, problems, Placed::pieces_of);
        let (Some((body, slave)), Some((_, master))) = (slave, master) else { continue };
        let options = TieOptions {
            form: match item.form {
                SceneForm::Constant => TieForm::Constant,
                SceneForm::FrameInvariant => TieForm::FrameInvariant,
            },
            space: match item.multipliers {
                Multipliers::Standard => MultiplierSpace::Standard,
                // The reader refuses `centred`, which is for contact; on what is tied as a whole it is dual.
                Multipliers::Dual | Multipliers::Centred => MultiplierSpace::Dual,
            },
            interface: match item.interface {
                SceneInterface::Move => Interface::Move,
                SceneInterface::Keep => Interface::Keep,
                SceneInterface::Close => Interface::Close,
            },
            reach: item.reach,
        };
        let is_given = |c: usize| tied[c] || model.follows_its_face(c as u32 / 3);
        let (is_fixed, is_always_fixed) = (|c: usize| first[c] || is_given(c), |c: usize| always[c] || is_given(c));
        let (label, q) = (item.label(), &model.reference);
        let made = if varies {
            MeshTie::in_stages(&label, &slave, &master, q, is_fixed, is_always_fixed, options)
        } else {
            MeshTie::new(&label, &slave, &master, q, is_fixed, options)
        };
        let tie = match made {
            Ok(tie) => tie,
            Err(error) => {
                let remedy = match &error {
                    MortarError::AllFixed => "exchange slave and master, or remove the prescription or the tie",
                    MortarError::Apart { .. } => "set `reach` to a larger distance, or move the bodies together",
                    MortarError::Fit { .. } => "set `interface` to \"keep\" or \"close\", or exchange slave and master",
                    MortarError::Coverage { .. } => "set `reach` to a smaller distance, or choose smaller surfaces",
                    _ => "choose two different, not degenerate surfaces",
                };
                problems.add(key, item.label(), error.to_string(), remedy);
                continue;
            }
        };
        for node in tie.tied_nodes() {
            tied[3 * node as usize..3 * node as usize + 3].fill(true);
            ties.tied.insert(node);
        }
        is_stale |= tie.moved().iter().any(|(node, _)| surfaces.contains(node));
        surfaces.extend(slave.iter().chain(&master).flat_map(|piece| piece.facet()));
        if !tie.moved().is_empty() {
            if let Err(error) = move_nodes(scene, body, &mut placed[body], tie.moved(), model) {
                let message = format!("the interface cannot be moved: {error}");
                let remedy =
                    "set `interface` to \"keep\" or \"close\", exchange slave and master, or correct the meshes";
                problems.add(key, item.label(), message, remedy);
                continue;
            }
            warnings.push(format!(
                "{}: {} slave nodes were moved because the surfaces did not fit (largest gap {:.3e})",
                item.label(),
                tie.moved().len(),
                tie.largest_initial_gap()
            ));
        }
        if tie.tied_share() < WHOLLY_TIED {
            warnings.push(format!(
                "{}: {:.1} % of the slave surface lie opposite the master and are tied, the rest is free; if more was intended, set `reach` or choose other surfaces",
                item.label(),
                100.0 * tie.tied_share()
            ));
        }
        let traced = |set: &str, problems: &mut Problems<'_>| {
            let found = resolve(placed, &key, set, problems, Placed::facets_of);
            found.map(|(_, facets)| facets.into_iter().collect()).unwrap_or_default()
        };
        ties.surfaces.push([traced(&item.slave, problems), traced(&item.master, problems)]);
        ties.pairs.push(CouplingTerm {
            name: item.label(),
            acts: true,
            term: Box::new(tie),
            complementarity: 1.0,
            restitution: None,
        });
    }
    (ties, is_stale)
}

/// Gives nodes of a body new places, in its mesh and in the model.
#[cfg(feature = "mortar")]
fn move_nodes(
    scene: &Scene,
    body: usize,
    placed: &mut Placed,
    moved: &[(u32, [f64; 3])],
    model: &mut Model,
) -> Result<(), Box<dyn std::error::Error>> {
    let Discretisation::Solid { mesh, law, .. } = &mut placed.shape else {
        return Err("the slave is the surface of a rigid body, whose nodes keep their places in it".into());
    };
    let item = &scene.bodies[body];
    for &(node, x) in moved {
        mesh.nodes[(node - placed.first_node) as usize] = x;
        let at = 3 * node as usize;
        model.reference[at..at + 3].copy_from_slice(&x);
        if scene.is_dynamic() {
            model.velocity[at..at + 3].copy_from_slice(&item.initial_velocity(x));
        }
    }
    model.embedding.follow(&mut model.reference);
    model.embedding.follow(&mut model.velocity);
    mesh.check()?;
    let law = std::sync::Arc::clone(law);
    model.bodies[body].solid =
        stoss_fe_solid::SolidBody::with_options(&item.name, mesh, placed.first_node, law, super::body::options(item))?;
    Ok(())
}

#[cfg(not(feature = "mortar"))]
pub(super) fn ties(
    scene: &Scene,
    _: &mut [Placed],
    _: &Phases,
    _: &mut Model,
    problems: &mut Problems<'_>,
    _: &mut Vec<String>,
) -> Ties {
    for (t, item) in scene.ties.iter().enumerate() {
        let message = "this build of Stoss has no mesh ties";
        problems.add(format!("tie[{t}]"), item.label(), message, "build it with the cargo feature `mortar`");
    }
    Ties::default()
}
