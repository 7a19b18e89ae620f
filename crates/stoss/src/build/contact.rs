//! Contacts of a scene: surfaces found and examined, the method made where its module is built in.

use super::condition::resolve;
use super::methods::builder;
use super::pair::PairInput;
use super::phase::Phases;
use super::tie::Ties;
use super::young;
use super::{ContactPlan, OwnLaws, Placed, Problems};
use crate::scene::{Closing, Enforcement, Multipliers, Scene, split_set};
use crate::solver::Model;
use stoss_contact::{Candidate, KeptOut, Sinking, choose_slave};
use stoss_reference_element::{FacePiece, FacetNodes};
use stoss_term::HeldNodes;

/// One side of a contact.
#[derive(Clone, Default, PartialEq)]
pub(super) struct Side {
    /// Part that the side belongs to.
    pub part: usize,
    /// Facets, outward, of the trace where faces are quadratic; none of a beam or string.
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
    phases: &Phases,
    model: &mut Model,
    problems: &mut Problems<'_>,
    warnings: &mut Vec<String>,
) -> Vec<ContactPlan> {
    let mut plans = Vec::new();
    warnings.extend(impacts(scene, phases));
    let mut seen: Vec<([Side; 2], &crate::scene::Contact)> = Vec::new();
    for (c, item) in scene.contacts.iter().enumerate() {
        let key = format!("contact[{c}]");
        let ([first, second], keys) = (item.surfaces(), item.surface_keys());
        let first = Side::find(placed, &format!("{key}.{}", keys[0]), first, problems);
        let second = Side::find(placed, &format!("{key}.{}", keys[1]), second, problems);
        let (Some(first), Some(second)) = (first, second) else { continue };
        let (mut surfaces, mut chosen) = ([first, second], None);
        if item.between.is_some() {
            let support = phases.first_with(&item.label()).held_nodes(model);
            let candidates = surfaces.each_ref().map(|side| Candidate {
                facets: &side.facets,
                pieces: &side.pieces,
                is_prescribed: is_prescribed(&support, side),
                young: young(model, side.part),
            });
            let (slave, reason) = choose_slave(&candidates, &model.reference);
            chosen = Some(format!("{} ({reason})", item.surfaces()[slave]));
            surfaces.rotate_left(slave);
        }
        // Contacts that take turns, as one with another friction in a later stage.
        let meets = |other: &crate::scene::Contact| {
            let names = [item.label(), other.label()];
            phases.all().any(|phase| names.iter().all(|name| phase.acts(Some(name))))
        };
        if let Some((_, other)) = seen.iter().find(|(own, other)| *own == surfaces && meets(other)) {
            let message = format!("is the same contact as `{}`: its constraints would be redundant", other.label());
            problems.add(format!("{key}.name"), item.label(), message, "remove one of the two");
            continue;
        }
        let [slave, master] = &surfaces;
        warnings.extend(sinking(item, &phases.first_with(&item.label()).held_nodes(model), [slave, master], model));
        let is_exact = |contact: &crate::scene::Contact| !matches!(contact.enforcement, Enforcement::Penalty(_));
        if let Some((_, other)) = seen.iter().find(|([s, m], other)| s == master && m == slave && meets(other))
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
        let label = item.label();
        let mut acting = phases.with(&label).map(|phase| phase.held_nodes(model)).peekable();
        if acting.peek().is_some()
            && acting.all(|support| surfaces.iter().all(|surface| is_prescribed(&support, surface)))
        {
            let message =
                "every node of both surfaces is prescribed in all components: no contact force could move them";
            problems.add(key, item.label(), message, "remove the contact, or free one of the surfaces");
            continue;
        }
        let (bodies, facets) = ([slave.part, master.part], [&slave.facets[..], &master.facets[..]]);
        let pieces = [&slave.pieces[..], &master.pieces[..]];
        let (line, tied) = (&slave.line[..], &ties.tied);
        let is_massless = surfaces.iter().flat_map(Side::nodes).any(|node| model.is_massless(node));
        if is_massless && (item.restitution.is_some() || item.closing == Some(Closing::Impact)) {
            let message = "needs velocities that jump, and another contact has taken the mass of a surface of this one";
            let which = if item.restitution.is_some() { "restitution" } else { "closing" };
            problems.add(
                format!("{key}.{which}"),
                item.label(),
                message,
                "remove it, or that contact's `surface_mass`",
            );
            continue;
        }
        let pair = PairInput {
            scene,
            placed,
            laws,
            phases,
            key,
            item,
            bodies,
            facets,
            pieces,
            line,
            chosen,
            tied,
            is_massless,
        };
        if let Some(build) = builder(item.method, &pair.key, problems) {
            plans.extend(build(&pair, model, problems, warnings));
        }
        seen.push((surfaces, item));
    }
    plans
}

/// A warning if a scheme under which a contact acts is one that gains energy in impacts.
fn impacts(scene: &Scene, phases: &Phases) -> Option<String> {
    let labels: Vec<String> = scene.contacts.iter().map(crate::scene::Contact::label).collect();
    let mut integrators = labels.iter().flat_map(|label| phases.with(label)).filter_map(|phase| phase.integrator());
    let gains = |integrator: &&crate::scene::Integrator| {
        integrator.make().is_ok_and(|scheme| scheme.rule(1.0).gains_energy_in_impacts())
    };
    integrators.find(gains).map(|integrator| {
        format!(
            "time.integrator: `{}` gains energy in impacts, at every step size (docs/verification/stability.md): use `energy-momentum`, or \
             `backward-euler`, which loses some, if bodies collide",
            integrator.scheme
        )
    })
}

/// A warning if the master may sink in between the nodes of the slave.
fn sinking(
    item: &crate::scene::Contact,
    support: &HeldNodes,
    [slave, master]: [&Side; 2],
    model: &Model,
) -> Option<String> {
    if slave.is_line() {
        return None;
    }
    // A rigid or prescribed side is no slave of a soft one.
    let may_be_slave = young(model, master.part).is_finite() && !is_prescribed(support, master);
    let here = Sinking::of(&slave.pieces, &master.pieces, &model.reference);
    let exchanged = may_be_slave.then(|| Sinking::of(&master.pieces, &slave.pieces, &model.reference));
    let is_dual = item.multipliers.is_some_and(|multipliers| multipliers != Multipliers::Standard);
    let kept_out = match (item.method.integrates, is_dual) {
        (false, _) => KeptOut::Nodes,
        (true, false) => KeptOut::Means,
        (true, true) => KeptOut::DualMeans,
    };
    let depth = here.by(kept_out)?;
    let mut remedies = Vec::new();
    if exchanged.is_some_and(|exchanged| exchanged.depth < 0.5 * here.depth) {
        remedies.push("exchange slave and master");
    }
    remedies.push("refine the slave");
    if kept_out == KeptOut::Means {
        remedies.push("take `multipliers = \"dual\"`, with which it is half of it");
    }
    Some(format!(
        "{}: slave facets of {:.3} against a radius of {:.3}: the master may sink in between them by {depth:.3}; {}",
        item.label(),
        here.length,
        here.radius,
        remedies.join(", or ")
    ))
}

/// True if all components of all nodes of a side are prescribed.
fn is_prescribed(support: &HeldNodes, side: &Side) -> bool {
    side.nodes().all(|node| support.prescribed(node) == [true; 3])
}
