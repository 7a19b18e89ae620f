//! The model: bodies, parts, prescribed motion, loads and contact.

use crate::switches::Acting;
use crate::{AxisRotation, Embedding, Load, Release, SimulationError, Switches, Table};
use std::collections::BTreeMap;
use std::ops::Range;
use stoss_contact::{
    Auxiliary, Bilateral, BodyPair, Constraint, ContactError, ContactMethod, ContactWork, GradientRule, Hold,
    LocalContribution, Potential, PotentialConstraint, Report, SlotReport, Step, StepConfiguration, Support,
    SurfaceForce, SurfaceNode,
};
use stoss_fe_solid::{MassKind, MassMatrix, Massless, SolidBody};
use stoss_part::Part;

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

/// A deformable body.
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
    /// Those of the nodes that are directors: they rotate and are not translated. If there are any, all three components are prescribed.
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
        self.rotation == other.rotation
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

/// An interaction between nodes: contact, bilateral constraints (ties, joints), or forces with a potential.
#[derive(Debug)]
pub enum Coupling {
    /// Unilateral constraints, which open and close.
    Contact(Box<dyn ContactMethod>),
    /// Bilateral constraints: mesh ties, joints.
    Bilateral(Box<dyn Bilateral>),
    /// Forces with a potential: penalties, barriers.
    Potential(PotentialConstraint),
    /// One of the others, switched off.
    Off(SwitchedOff),
}

impl Coupling {
    /// A contact method.
    pub fn contact(method: impl ContactMethod + 'static) -> Self {
        Self::Contact(Box::new(method))
    }

    /// Bilateral constraints.
    pub fn bilateral(constraint: impl Bilateral + 'static) -> Self {
        Self::Bilateral(Box::new(constraint))
    }

    /// Forces with a potential.
    pub fn potential(potential: impl Potential + 'static) -> Self {
        Self::Potential(PotentialConstraint(Box::new(potential)))
    }

    /// The contact method, if the coupling is unilateral contact.
    pub fn as_contact(&self) -> Option<&dyn ContactMethod> {
        if let Self::Contact(method) = self { Some(&**method) } else { None }
    }

    /// As [`Self::as_contact`].
    pub fn as_contact_mut(&mut self) -> Option<&mut (dyn ContactMethod + 'static)> {
        if let Self::Contact(method) = self { Some(&mut **method) } else { None }
    }

    /// Contact results by pairs of bodies, of a potential at the end of a step.
    pub(crate) fn body_pairs(&self) -> Vec<BodyPair> {
        if let Self::Potential(of) = self { of.0.body_pairs() } else { Vec::new() }
    }

    /// Contact results at surface nodes, of a potential in the step to `q_np1`.
    pub(crate) fn surface_nodes(&self, q_np1: &[f64]) -> Vec<SurfaceNode> {
        if let Self::Potential(of) = self { of.0.surface_nodes(q_np1) } else { Vec::new() }
    }

    /// Forces at surface nodes, of a potential whose forces are applied to other nodes.
    pub(crate) fn surface_forces(&self) -> Vec<SurfaceForce> {
        if let Self::Potential(of) = self { of.0.surface_forces() } else { Vec::new() }
    }

    /// Whether it is contact with friction.
    pub fn has_friction(&self) -> bool {
        match self {
            Self::Contact(method) => method.has_friction(),
            Self::Bilateral(_) => false,
            Self::Potential(of) => of.0.has_friction(),
            Self::Off(silent) => silent.0.has_friction(),
        }
    }

    /// Its history variables, for checkpoints; empty if it has none.
    pub(crate) fn save_history(&self) -> Vec<u8> {
        match self {
            Self::Contact(method) => method.save_history(),
            Self::Bilateral(constraint) => constraint.save_history(),
            Self::Potential(of) => of.0.save_history(),
            Self::Off(silent) => silent.0.save_history(),
        }
    }

    /// Restores what [`Self::save_history`] wrote.
    pub(crate) fn load_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        match self {
            Self::Contact(method) => method.load_history(bytes),
            Self::Bilateral(constraint) => constraint.load_history(bytes),
            Self::Potential(of) => of.0.load_history(bytes),
            Self::Off(silent) => silent.0.load_history(bytes),
        }
    }

    /// True for bilateral constraints: while they are not switched off all their slots are active.
    pub fn is_bilateral(&self) -> bool {
        match self {
            Self::Bilateral(_) => true,
            Self::Off(silent) => silent.0.is_bilateral(),
            _ => false,
        }
    }

    /// True for forces with a potential, also while they are switched off.
    pub fn is_potential(&self) -> bool {
        match self {
            Self::Potential(_) => true,
            Self::Off(silent) => silent.0.is_potential(),
            _ => false,
        }
    }

    /// True if it is switched off.
    pub fn is_off(&self) -> bool {
        matches!(self, Self::Off(_))
    }

    /// Contributions that may come in the step, see [`ContactMethod::candidates`].
    pub(crate) fn candidates(&self, active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        match self {
            Self::Contact(method) => method.candidates(active, visit),
            Self::Potential(of) => of.0.candidates(&mut |nodes| visit(nodes, &[])),
            Self::Bilateral(_) | Self::Off(_) => {}
        }
    }

    /// Whether it is a potential that acts, see [`Potential::acts`].
    pub(crate) fn acts(&self) -> bool {
        matches!(self, Self::Potential(of) if of.0.acts())
    }

    /// Whether it limits motions, see [`Potential::keeps_apart`].
    pub(crate) fn keeps_apart(&self) -> bool {
        matches!(self, Self::Potential(of) if of.0.keeps_apart())
    }

    /// Part of a motion of all nodes that it admits.
    pub(crate) fn longest_step(&mut self, q: &[f64], increment: &[f64]) -> f64 {
        match self {
            Self::Potential(of) => of.0.longest_step(q, increment),
            _ => 1.0,
        }
    }

    /// Whether its forces are the gradient of an energy, but for friction, as far as no multiplier acts; see [`Potential::has_energy`].
    pub(crate) fn has_energy(&self, rule: GradientRule) -> bool {
        match self {
            Self::Potential(of) => of.0.has_energy(rule),
            _ => true,
        }
    }

    /// See [`Potential::set_line`].
    pub(crate) fn set_line(&mut self, increment: &[f64]) {
        if let Self::Potential(of) = self {
            of.0.set_line(increment);
        }
    }

    /// See [`Potential::friction_along`].
    pub(crate) fn friction_along(&self, part: f64) -> f64 {
        match self {
            Self::Potential(of) => of.0.friction_along(part),
            _ => 0.0,
        }
    }

    /// Energy at the start of a run, at `q`: of a potential, of springs in joints.
    pub(crate) fn energy_at_start(&self, q: &[f64]) -> Result<f64, ContactError> {
        match self {
            Self::Contact(_) | Self::Off(_) => Ok(0.0),
            Self::Bilateral(constraint) => Ok(constraint.stored_at_start(q)),
            Self::Potential(of) => of.0.energy(q),
        }
    }

    /// Energy stored and dissipated by the step that ends at `q_np1`.
    pub(crate) fn work(&self, q_np1: &[f64], pressures: &[f64], active: &[bool]) -> Result<ContactWork, ContactError> {
        match self {
            Self::Contact(method) => method.work(q_np1, pressures, active),
            Self::Bilateral(constraint) => constraint.work(q_np1, pressures, active),
            Self::Potential(of) => of.0.work(q_np1),
            Self::Off(_) => Ok(ContactWork::default()),
        }
    }

    /// The step that ends at `q_np1` was accepted.
    pub(crate) fn commit(&mut self, q_np1: &[f64], pressures: &[f64], active: &[bool]) {
        match self {
            Self::Contact(method) => method.commit(q_np1, pressures, active),
            Self::Bilateral(constraint) => constraint.commit(q_np1, pressures, active),
            Self::Potential(of) => of.0.commit(q_np1),
            Self::Off(_) => {}
        }
    }
}

impl std::ops::Deref for Coupling {
    type Target = dyn Constraint;
    fn deref(&self) -> &Self::Target {
        match self {
            Self::Contact(method) => &**method,
            Self::Bilateral(constraint) => &**constraint,
            Self::Potential(of) => of,
            Self::Off(silent) => silent,
        }
    }
}

impl std::ops::DerefMut for Coupling {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Contact(method) => &mut **method,
            Self::Bilateral(constraint) => &mut **constraint,
            Self::Potential(of) => of,
            Self::Off(silent) => silent,
        }
    }
}

/// A coupling that is switched off: it keeps its slots and its history, and exerts no forces.
#[derive(Debug)]
pub struct SwitchedOff(pub(crate) Box<Coupling>);

impl Report for SwitchedOff {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn length_scale(&self) -> f64 {
        self.0.length_scale()
    }
    fn has_limits(&self) -> bool {
        self.0.has_limits()
    }
    fn report(&self, _q: &[f64]) -> Result<Vec<SlotReport>, ContactError> {
        Ok(Vec::new())
    }
}

impl Constraint for SwitchedOff {
    fn slot_count(&self) -> usize {
        self.0.slot_count()
    }
    fn slot_weight(&self, slot: usize) -> f64 {
        self.0.slot_weight(slot)
    }
    fn is_symmetric(&self, _rule: GradientRule) -> bool {
        true
    }
    fn stencils(&self, _active: &[bool], _visit: &mut dyn FnMut(&[u32], &[u32])) {}
    fn assemble(
        &self,
        _step: StepConfiguration<'_>,
        _pressures: &[f64],
        _active: &[bool],
        _want_tangent: bool,
        _visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        Ok(())
    }
    fn auxiliaries(&self) -> &[Auxiliary] {
        self.0.auxiliaries()
    }
}

impl Coupling {
    /// Switches it on or off.
    pub(crate) fn set_acting(&mut self, acting: bool) {
        if acting != self.is_off() {
            return;
        }
        // A potential of nothing takes its place for a moment; it holds no memory.
        let old = std::mem::replace(self, Self::potential(Nothing));
        *self = match old {
            Self::Off(silent) => *silent.0,
            other => Self::Off(SwitchedOff(Box::new(other))),
        };
    }
}

/// A potential without forces.
#[derive(Debug)]
struct Nothing;

impl Potential for Nothing {
    fn name(&self) -> &str {
        "nothing"
    }
    fn length_scale(&self) -> f64 {
        1.0
    }
    fn begin(&mut self, _step: &Step<'_>) -> Result<(), ContactError> {
        Ok(())
    }
    fn stencils(&self, _visit: &mut dyn FnMut(&[u32])) {}
    fn assemble(
        &self,
        _step: StepConfiguration<'_>,
        _want_tangent: bool,
        _visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        Ok(())
    }
    fn energy(&self, _q: &[f64]) -> Result<f64, ContactError> {
        Ok(0.0)
    }
}

/// A coupling with its name, and the factor of its complementarity function.
#[derive(Debug)]
pub struct ContactPair {
    /// Name for reports, unique.
    pub name: String,
    /// The method.
    pub method: Coupling,
    /// `c` of theory/constraints#eq-active-set: active if `p - c gap > 0`; about Young's modulus over the edge length.
    pub complementarity: f64,
    /// The coefficient of restitution, from 0 to 1, of the impact law that gives the velocities after a step in which slots closed, of contact and of limits of joints (theory/impacts). `None`: they
    /// are those of the step.
    pub restitution: Option<f64>,
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
    pub parts: Vec<Box<dyn Part>>,
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
    pub contacts: Vec<ContactPair>,
}

impl Model {
    /// Part of the motion of all nodes from `q` by `increment` on which surfaces stay apart that must; 1 without such.
    pub(crate) fn longest_step(&mut self, q: &[f64], increment: &[f64]) -> f64 {
        self.contacts.iter_mut().map(|pair| pair.method.longest_step(q, increment)).fold(1.0, f64::min)
    }

    /// Whether surfaces must stay apart on the way from one iterate to the next.
    pub(crate) fn keeps_apart(&self) -> bool {
        self.contacts.iter().any(|pair| pair.method.keeps_apart())
    }

    /// Whether a node is a vertex whose place follows from those of the other vertices of its face, so that a multiplier of its own would say
    /// nothing new: the middle of a face without a node there.
    pub fn follows_its_face(&self, node: u32) -> bool {
        self.traces.get(&node).is_some_and(Option::is_none)
    }

    /// What is known of the motion of nodes without asking the equations, from the prescriptions of which `acts` says that they act and the couplings that are not switched off.
    pub fn support(&self, acts: impl Fn(usize) -> bool) -> Support {
        let mut support = Support::new(self.node_count());
        for (_, prescription) in self.prescriptions.iter().enumerate().filter(|(p, _)| acts(*p)) {
            for &node in &prescription.nodes {
                prescription.components.iter().for_each(|&c| support.prescribe(node, usize::from(c)));
            }
        }
        // A node that others carry is where they are.
        for &node in self.embedding.nodes() {
            let carriers = self.embedding.carriers(node).unwrap_or_default();
            for component in 0..3 {
                if carriers.iter().all(|&(carrier, _)| support.prescribed(carrier)[component]) {
                    support.prescribe(node, component);
                }
            }
        }
        self.traces
            .keys()
            .filter(|&&node| self.follows_its_face(node))
            .for_each(|&node| support.hold(node, Hold::Wholly));
        for pair in &self.contacts {
            pair.method.holds(&mut |node, how| support.hold(node, how));
        }
        support
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
        self.contacts.iter().any(|pair| !pair.method.is_bilateral())
    }

    /// True if something can close: contact, also while it is switched off, or a limit of a joint.
    pub fn has_gaps(&self) -> bool {
        self.has_contact_pairs() || self.contacts.iter().any(|pair| pair.method.has_limits())
    }

    /// Whether constraints that open and close act at present. Potentials have none.
    pub fn has_unilateral_contact(&self) -> bool {
        self.contacts.iter().any(|pair| pair.method.as_contact().is_some())
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
