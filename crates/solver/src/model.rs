//! The model: bodies, parts, prescribed motion, loads and contact.

use crate::switches::Acting;
use crate::{AxisRotation, Embedding, Load, Release, SimulationError, Switches, Table};
use std::collections::BTreeMap;
use std::ops::Range;

use stoss_fe_solid::{MassKind, MassMatrix, Massless, SolidBody};
use stoss_term::{Bilateral, HeldNodes, Hold, JointReport, Potential, SupportedNode, Term, Unilateral};

/// Mass- and stiffness-proportional damping of a body (Rayleigh): for small strains the force `(a M + b K) v`. Only where there is inertia.
///
/// The mass part resists rigid motions too, and takes momentum. The stiffness part is a viscous stress in the material frame
/// ([`stoss_fe_solid::SolidBody::add_viscous_force`]), which leaves rigid motions and both momenta alone. A mode with the angular frequency `w` has the damping ratio
/// `a / (2 w) + b w / 2`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// `a`, one over a time, not negative.
    pub mass: f64,
    /// `b`, a time, not negative.
    pub stiffness: f64,
}

impl Damping {
    /// Whether a coefficient is not zero.
    pub fn acts(&self) -> bool {
        self.mass > 0.0 || self.stiffness > 0.0
    }
}

/// A deformable body of a model: its elements with what the run knows of it beside them.
#[derive(Debug)]
pub struct Body {
    /// Elements and law.
    pub solid: SolidBody,
    /// Global numbers of its nodes.
    pub nodes: Range<u32>,
    /// Reference density; `None` in quasi-static models.
    pub density: Option<f64>,
    /// Consistent or lumped.
    pub mass_kind: MassKind,
    /// Damping; it acts in dynamic stages.
    pub damping: Damping,
    /// Nodes without mass of their own, if it has some.
    pub massless: Option<Massless>,
}

impl Body {
    /// The components of its nodes.
    pub(crate) fn components(&self) -> Range<usize> {
        3 * self.nodes.start as usize..3 * self.nodes.end as usize
    }

    /// The mass with a density.
    pub fn mass(&self, density: f64) -> MassMatrix {
        match &self.massless {
            Some(massless) => massless.mass(&self.solid, density, self.mass_kind),
            None => self.solid.mass(density, self.mass_kind),
        }
    }
}

/// Displacement components given as functions of time, or a rigid motion.
#[derive(Clone, Debug)]
pub struct Prescription {
    /// Name in messages.
    pub name: String,
    /// Global node numbers.
    pub nodes: Vec<u32>,
    /// Directors among the nodes: they rotate and are not translated. If there are any, all three components are prescribed.
    pub directions: Vec<u32>,
    /// Components (0, 1, 2), one a column of the table; with a rotation all three in this order.
    pub components: Vec<u8>,
    /// Displacement from the reference position, a length each; with a rotation the translation that follows it.
    pub displacement: Table,
    /// Rotation of the reference positions before the translation.
    pub rotation: Option<AxisRotation>,
    /// What a stage switches on begins where its nodes are then, and is where the table says from this time on: the difference falls linearly. It stays if the
    /// time is infinite. Without it the nodes are there at the end of the first step.
    pub ramp_until: Option<f64>,
}

impl Prescription {
    /// Whether two prescriptions of the same component have the same motion: then both may contain the same node.
    pub fn agrees(&self, other: &Self, component: u8) -> bool {
        let column = |p: &Self| p.components.iter().position(|&c| c == component);
        let (Some(own), Some(others)) = (column(self), column(other)) else { return false };
        let [turn, others_turn] = [self, other].map(|p| p.rotation.as_ref().filter(|turn| !turn.keeps(component)));
        turn == others_turn
            && self.ramp_until == other.ramp_until
            && self.displacement.is_same_function(own, &other.displacement, others)
    }

    /// Whether it may move a node.
    pub fn moves(&self) -> bool {
        !self.displacement.is_constant() || self.rotation.is_some() || self.ramp_until.is_some_and(f64::is_finite)
    }

    /// Position (a length) of component `column` of a node with this reference position: `X + u(t)`, with a rotation
    /// `c + R(t) (X - c) + u(t)`, without linearisation.
    pub fn position(&self, node: u32, reference: [f64; 3], time: f64, column: usize) -> f64 {
        let component = usize::from(self.components[column]);
        let turn = |rotation: &AxisRotation| self.seen(rotation, node).displacement(reference, time)[component];
        let turn = self.rotation.as_ref().map_or(0.0, turn);
        let moved = if self.directions.contains(&node) { 0.0 } else { self.displacement.value(time, column) };
        reference[component] + (turn + moved)
    }

    /// The rotation of a node; a director is rotated about the origin.
    fn seen<'a>(&self, rotation: &'a AxisRotation, node: u32) -> std::borrow::Cow<'a, AxisRotation> {
        if self.directions.contains(&node) {
            std::borrow::Cow::Owned(rotation.about_origin())
        } else {
            std::borrow::Cow::Borrowed(rotation)
        }
    }

    /// Velocity (a length per time) of the same component just after a time: `u'(t)`, with a rotation `+ n x R(t) (X - c) angle'(t)`.
    pub(crate) fn velocity(&self, node: u32, reference: [f64; 3], time: f64, column: usize) -> f64 {
        let component = usize::from(self.components[column]);
        let turn = |rotation: &AxisRotation| self.seen(rotation, node).velocity(reference, time)[component];
        let turn = self.rotation.as_ref().map_or(0.0, turn);
        let moved = if self.directions.contains(&node) { 0.0 } else { self.displacement.slope(time, column) };
        turn + moved
    }
}

/// A term that joins what others move (contact, a tie, a joint, a barrier), with what the run has to know of it beside the term.
#[derive(Debug)]
pub struct CouplingTerm {
    /// Name for reports, unique.
    pub name: String,
    /// The term.
    pub term: Box<dyn Term>,
    /// False while it is switched off: it keeps its slots and its history, and nobody asks it for anything.
    pub acts: bool,
    /// `c` of theory/constraints#eq-active-set: active if `p - c gap > 0`; about Young's modulus over the edge length.
    pub complementarity: f64,
    /// The coefficient of restitution, from 0 to 1, of the impact law that gives the velocities after a step in which slots closed, of contact and of limits of joints (theory/impacts). `None`: they
    /// are those of the step.
    pub restitution: Option<f64>,
}

impl CouplingTerm {
    /// A coupling that acts, with the factor of the complementarity function (zero if nothing opens and closes) and without a law of impact.
    pub fn new(name: impl Into<String>, term: impl Term + 'static, complementarity: f64) -> Self {
        Self { name: name.into(), term: Box::new(term), acts: true, complementarity, restitution: None }
    }

    /// Whether its constraints always hold (mesh ties, joints), also while it is switched off.
    pub fn always_holds(&self) -> bool {
        self.term.bilateral().is_some()
    }

    /// Whether it has no constraints but forces in their place, also while it is switched off.
    pub fn is_potential(&self) -> bool {
        self.term.potential().is_some()
    }

    /// The constraints that open and close, if the coupling has such and acts.
    pub fn unilateral(&self) -> Option<&dyn Unilateral> {
        self.term.unilateral().filter(|_| self.acts)
    }

    /// The constraints that open and close, to be changed.
    pub fn unilateral_mut(&mut self) -> Option<&mut dyn Unilateral> {
        let acts = self.acts;
        self.term.unilateral_mut().filter(|_| acts)
    }

    /// The constraints that always hold, if the coupling has such and acts.
    pub fn bilateral(&self) -> Option<&dyn Bilateral> {
        self.term.bilateral().filter(|_| self.acts)
    }

    /// The forces in the place of constraints, if the coupling has such and acts.
    pub fn potential(&self) -> Option<&dyn Potential> {
        self.term.potential().filter(|_| self.acts)
    }

    /// The forces in the place of constraints, to be changed.
    pub fn potential_mut(&mut self) -> Option<&mut dyn Potential> {
        let acts = self.acts;
        self.term.potential_mut().filter(|_| acts)
    }

    /// Whether surfaces must stay apart on the way from one iterate to the next.
    pub(crate) fn keeps_apart(&self) -> bool {
        self.potential().is_some_and(|of| of.keeps_apart())
    }

    /// What a joint does at the end of a step at `q`, if it is one and acts.
    pub fn joint(&self, q: &[f64], multipliers: &[f64]) -> Option<JointReport> {
        self.bilateral()?.joint(q, multipliers)
    }

    /// What a slot of a sliding support prescribes at a time, if it is one and acts.
    pub fn supported_node(&self, slot: usize, time: f64) -> Option<SupportedNode> {
        self.bilateral()?.supported_node(slot, time)
    }
}

/// Bodies, prescribed motion, loads and contact. Global nodes are numbered body after body.
#[derive(Debug, Default)]
pub struct Model {
    /// Reference positions, `3 * nodes`, node-major, a length each.
    pub reference: Vec<f64>,
    /// Initial velocities, `3 * nodes`; ignored in quasi-static runs.
    pub velocity: Vec<f64>,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// Parts other than solids: rigid bodies, beams, strings, springs. Their vectors are nodes of the model like those of the bodies.
    pub parts: Vec<Box<dyn Term>>,
    /// Nodes without equations, whose positions follow from other nodes.
    pub embedding: Embedding,
    /// Embedded nodes that are vertices of what contact sees of a quadratic face: of its trace (theory/elements#contact), each with the node in whose place it is, if
    /// there is one, and in the middle of a face without a node there. Frames show the node and not the vertex.
    pub traces: BTreeMap<u32, Option<u32>>,
    /// Prescribed motion.
    pub prescriptions: Vec<Prescription>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Contacts, ties, joints and potentials.
    pub contacts: Vec<CouplingTerm>,
}

impl Model {
    /// The couplings that act, with their numbers.
    pub fn couplings(&self) -> impl Iterator<Item = (usize, &CouplingTerm)> {
        self.contacts.iter().enumerate().filter(|(_, pair)| pair.acts)
    }

    /// The couplings that act, with their numbers, to be changed.
    pub(crate) fn couplings_mut(&mut self) -> impl Iterator<Item = (usize, &mut CouplingTerm)> {
        self.contacts.iter_mut().enumerate().filter(|(_, pair)| pair.acts)
    }

    /// Whether each term is in the list that asks it for what it does (forces follow another rule of the scheme than constraints and what acts in their place), and acts on nodes that can move.
    pub(crate) fn check_places(&self) -> Result<(), String> {
        let is_force = |term: &dyn Term| {
            term.slot_count() == 0
                && term.bilateral().is_none()
                && term.unilateral().is_none()
                && term.potential().is_none()
        };
        if let Some(part) = self.parts.iter().find(|part| !is_force(&***part)) {
            return Err(format!(
                "{} has constraints or acts in their place: it belongs in `Model::contacts`, not in `Model::parts`",
                part.name()
            ));
        }
        if let Some(pair) = self.contacts.iter().find(|pair| is_force(&*pair.term)) {
            return Err(format!(
                "{} has neither constraints nor acts in their place: it belongs in `Model::parts`, not in `Model::contacts`",
                pair.name
            ));
        }
        let owned = self.owned_nodes();
        for part in &self.parts {
            let mut wrong = None;
            part.stencils(&[], &mut |nodes, _| {
                wrong = wrong.or_else(|| nodes.iter().copied().find(|&node| owned.get(node as usize) != Some(&true)));
            });
            let Some(node) = wrong else { continue };
            let name = part.name();
            return Err(if node as usize >= owned.len() {
                format!("{name} acts on node {node}, but the model has {} nodes", owned.len())
            } else if self.embedding.has(node) {
                format!("{name} acts on node {node}, which others carry: it must act on these, with their weights")
            } else {
                format!(
                    "{name} acts on node {node}, which belongs to no body and to no term with vectors of its own, so that it cannot move"
                )
            });
        }
        Ok(())
    }

    /// Which nodes have equations, or had them if they were not prescribed: those of elements and those that terms own.
    fn owned_nodes(&self) -> Vec<bool> {
        let mut owned = vec![false; self.node_count()];
        let of_bodies = self.bodies.iter().flat_map(|body| body.solid.elements().iter().flatten().copied());
        for node in of_bodies.chain(self.parts.iter().flat_map(|part| part.own_vectors())) {
            if let Some(owned) = owned.get_mut(node as usize) {
                *owned = true;
            }
        }
        for prescription in &self.prescriptions {
            prescription
                .nodes
                .iter()
                .filter_map(|&node| owned.get_mut(node as usize).map(|of| *of = true))
                .for_each(drop);
        }
        owned
    }

    /// Part of the motion of all nodes from `q` by `increment` on which surfaces stay apart that must; 1 without such.
    pub(crate) fn longest_step(&mut self, q: &[f64], increment: &[f64]) -> f64 {
        self.contacts
            .iter_mut()
            .filter_map(|pair| Some(pair.potential_mut()?.longest_step(q, increment)))
            .fold(1.0, f64::min)
    }

    /// Whether surfaces must stay apart on the way from one iterate to the next.
    pub(crate) fn keeps_apart(&self) -> bool {
        self.contacts.iter().any(|pair| pair.keeps_apart())
    }

    /// Whether a node is a vertex whose place follows from those of the other vertices of its face, so that a multiplier of its own would say
    /// nothing new: the middle of a face without a node there.
    pub fn follows_its_face(&self, node: u32) -> bool {
        self.traces.get(&node).is_some_and(Option::is_none)
    }

    /// What is known of the motion of nodes without asking the equations, from the prescriptions of which `acts` says that they act and the couplings that are not switched off.
    pub fn held_nodes(&self, acts: impl Fn(usize) -> bool) -> HeldNodes {
        let mut held = HeldNodes::new(self.node_count());
        for (_, prescription) in self.prescriptions.iter().enumerate().filter(|(p, _)| acts(*p)) {
            for &node in &prescription.nodes {
                prescription.components.iter().for_each(|&c| held.prescribe(node, usize::from(c)));
            }
        }
        // A node that others carry is where they are.
        for &node in self.embedding.nodes() {
            let carriers = self.embedding.carriers(node).unwrap_or_default();
            for component in 0..3 {
                if carriers.iter().all(|&(carrier, _)| held.prescribed(carrier)[component]) {
                    held.prescribe(node, component);
                }
            }
        }
        self.traces.keys().filter(|&&node| self.follows_its_face(node)).for_each(|&node| held.hold(node, Hold::Wholly));
        for (_, pair) in self.couplings() {
            pair.term.holds(&mut |node, how| held.hold(node, how));
        }
        held
    }

    /// Whether all of these nodes are carried by rigid parts: embedded, and no vertices of traces, which deform with their faces.
    pub(crate) fn are_rigid(&self, nodes: &[u32]) -> bool {
        self.embedding.has_all(nodes)
            && (self.traces.is_empty() || !nodes.iter().any(|node| self.traces.contains_key(node)))
    }

    /// Whether a node has no mass of its own, or moves with one that has none.
    pub fn is_massless(&self, node: u32) -> bool {
        let is_own =
            |node: u32| self.bodies.iter().any(|body| body.massless.as_ref().is_some_and(|m| m.contains(node)));
        is_own(node) || self.embedding.carriers(node).is_some_and(|list| list.iter().any(|&(node, _)| is_own(node)))
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.reference.len() / 3
    }

    /// What acts if `off` is switched off and `released` is released; an error message for indices that do not exist.
    pub(crate) fn acting(&self, off: &Switches, released: &[Release]) -> Result<Acting, String> {
        let counts = [self.loads.len(), self.prescriptions.len(), self.contacts.len(), self.parts.len()];
        let acting = Acting::new(counts, off, released)?;
        match self.parts.iter().zip(&acting.parts).find(|(part, acts)| !**acts && !part.own_vectors().is_empty()) {
            Some((part, _)) => {
                Err(format!("{} has degrees of freedom of its own and cannot be switched off", part.name()))
            }
            None => Ok(acting),
        }
    }

    /// True if there is contact by constraints that open and close or by potentials (mesh ties alone are none), also while it is switched off.
    pub fn has_contact_pairs(&self) -> bool {
        self.contacts.iter().any(|pair| !pair.always_holds())
    }

    /// True if something can close: contact, also while it is switched off, or a limit of a joint.
    pub fn has_gaps(&self) -> bool {
        self.has_contact_pairs()
            || self.contacts.iter().any(|pair| pair.term.bilateral().is_some_and(|of| of.has_limits()))
    }

    /// Whether constraints that open and close act at present. Potentials have none.
    pub fn has_unilateral_contact(&self) -> bool {
        self.contacts.iter().any(|pair| pair.unilateral().is_some())
    }

    /// Components that are prescribed: (component index `3*node + i`, prescription, column), each once. Several prescriptions of a
    /// component must agree. Only prescriptions that act count.
    pub(crate) fn prescribed_components(&self, acting: &Acting) -> Result<Vec<(u32, u32, u32)>, SimulationError> {
        let mut list = Vec::new();
        let mut first: Vec<Option<usize>> = vec![None; self.reference.len()];
        for (p, prescription) in self.prescriptions.iter().enumerate().filter(|&(p, _)| acting.prescriptions[p]) {
            if prescription.displacement.columns() != prescription.components.len()
                || prescription.rotation.is_some() && prescription.components != [0, 1, 2]
            {
                return Err(SimulationError::Model(format!(
                    "prescription {p} needs one column a component, and with a rotation the components 0, 1, 2"
                )));
            }
            for &node in &prescription.nodes {
                for (column, &component) in prescription.components.iter().enumerate() {
                    let index = 3 * node as usize + component as usize;
                    let Some(owner) = first.get_mut(index) else {
                        return Err(SimulationError::Model(format!(
                            "prescription {p} names node {node} component {component}, which does not exist"
                        )));
                    };
                    if let Some(other) = *owner {
                        if self.prescriptions[other].agrees(prescription, component) {
                            continue;
                        }
                        return Err(SimulationError::Model(format!(
                            "component {component} of node {node} is prescribed twice, by different values"
                        )));
                    }
                    *owner = Some(p);
                    list.push((index as u32, p as u32, column as u32));
                }
            }
        }
        list.sort_unstable();
        Ok(list)
    }
}
