//! General contact: points of a skin against patches of it, and edges that cross.
//!
//! Which contacts there are is in `contacts` and `begin`, patches that turn inward in `pieces`; what acts and its force in `act` and `joint`, how forces come to nodes in `scatter`; what goes on to the next step in `history`, and
//! what is reported at the end of a step in `output`.

mod act;
mod areas;
mod begin;
mod contacts;
mod history;
mod joint;
mod output;
mod pieces;
mod pressure;
mod scatter;

use crate::proximity::Proximity;
use crate::slip::SlipLine;
use crate::{Interactions, Skin};
use act::{ActForce, Acts};
use begin::Onset;
use contacts::Contacts;
use history::History;
use joint::Joint;
use nalgebra::Vector3;
use pieces::PieceList;
use scatter::Scatter;
use std::ops::Range;
use stoss_contact::{ContactError, in_order};
use stoss_term::{
    At, BodyPair, Fault, GradientRule, Local, Potential, Rule, Share, StepContext, SurfaceForce, SurfaceNode, Term,
    Work,
};

/// Iterations of a step with inertia in which motions are shortened because they pass very many facets; then the step is given up.
const MAX_SHORTENED: u32 = 3;

/// Part of a motion that is free, below which what stops it begins to act.
const BLOCKED: f64 = 0.5;

/// Room for the contribution of a group.
#[derive(Debug, Default)]
struct Room {
    local: Local,
    joint: Joint,
    scatter: Scatter,
}

/// Settings of [`GeneralContact`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralOptions {
    /// Thickness of the layer, a length: at this distance forces begin.
    pub thickness: f64,
    /// Time of the viscous layer, not negative.
    pub damping: f64,
    /// Speed of slip, positive, below which friction creeps in dynamics; `None`: it sticks, as it does without inertia.
    pub slip_velocity: Option<f64>,
}

/// Contact of everything with everything: points of integration and vertices of a skin against patches of its triangles, and edges that cross.
///
/// A contact begins, and ends, where its energy is zero; while it is in the layer it keeps its weight and its thickness, so the energy is continuous in time. Under [`GradientRule::DiscreteGradient`] the force of a step
/// does exactly the work `V(q_n) - V(q_np1)` and leaves both momenta, theory/barrier#gradient; under [`GradientRule::EndPoint`] it is the gradient at the end. Nothing passes through anything as long as each iterate is reached
/// from the last by a motion that [`Potential::longest_step`] admits. What carries over from step to step are the contacts in their layers, and the springs of those that stick.
///
/// [`Term::energy`] is that of the contacts of the step that was begun last: nothing before the first one.
#[derive(Debug)]
pub struct GeneralContact {
    name: String,
    skin: Skin,
    rules: Interactions,
    options: GeneralOptions,
    share: Share,
    proximity: Proximity,
    /// Whether forces are those of the end of the step, or between its two states.
    at_end: bool,
    step_size: f64,
    has_rates: bool,
    /// Positions of the points at the start of the step and at the iterate.
    x_n: Vec<Vector3<f64>>,
    x: Vec<Vector3<f64>>,
    increment: Vec<Vector3<f64>>,
    /// Positions of the points that the velocities at the start lead to.
    predicted: Vec<Vector3<f64>>,
    contacts: Contacts,
    /// What acts at the iterate that was seen last.
    acts: Acts,
    pieces: PieceList,
    /// Sets of facets that had something acting between them in the step: they grow only, so that stencils seldom change.
    groups: Vec<Box<[u32]>>,
    /// Motions of the step that were shortened because they pass very many facets.
    shortened: u32,
    /// Friction along the motion that was set last.
    line: Vec<SlipLine>,
    /// History at the start of the step.
    history: History,
    /// History at the end of the step that was accepted last, until the next one begins.
    next_history: Option<History>,
}

impl GeneralContact {
    /// Contact of a skin with the interactions of its classes.
    ///
    /// # Errors
    /// [`ContactError::EmptySurface`] if there is no facet, [`ContactError::OptionOutOfRange`] if the thickness is not positive.
    pub fn new(
        name: impl Into<String>,
        skin: Skin,
        rules: Interactions,
        options: GeneralOptions,
    ) -> Result<Self, ContactError> {
        if !(options.thickness > 0.0 && options.thickness.is_finite()) {
            let (option, range) = ("thickness", "a positive length");
            return Err(ContactError::OptionOutOfRange { option, value: options.thickness, range });
        }
        if skin.facets().is_empty() {
            return Err(ContactError::EmptySurface { side: "general" });
        }
        Ok(Self {
            name: name.into(),
            proximity: Proximity::new(&skin, options.thickness),
            skin,
            rules,
            options,
            share: Share::default(),
            at_end: true,
            step_size: 0.0,
            has_rates: false,
            x_n: Vec::new(),
            x: Vec::new(),
            increment: Vec::new(),
            predicted: Vec::new(),
            contacts: Contacts::default(),
            acts: Acts::default(),
            pieces: PieceList::default(),
            groups: Vec::new(),
            shortened: 0,
            line: Vec::new(),
            history: History::default(),
            next_history: None,
        })
    }

    /// The skin.
    pub fn skin(&self) -> &Skin {
        &self.skin
    }

    /// Nodes of some facets, ascending.
    fn nodes_of(&self, facets: &[u32], nodes: &mut Vec<u32>) {
        nodes.clear();
        facets.iter().for_each(|&f| nodes.extend_from_slice(self.skin.nodes_of(f)));
        nodes.sort_unstable();
        nodes.dedup();
    }

    /// What acts on the facets of a group.
    fn contribution(&self, (facets, acts): (&[u32], Range<usize>), want_tangent: bool, room: &mut Room) {
        let Room { local, joint, scatter } = room;
        self.nodes_of(facets, &mut local.nodes);
        if !self.share.has(&local.nodes) {
            local.set_elsewhere();
            return;
        }
        local.reset(want_tangent);
        scatter.begin(&self.skin, facets, want_tangent);
        for act in acts.filter_map(|k| self.acts.get(k)) {
            self.force(act, joint, want_tangent);
            scatter.add(&self.skin, joint);
        }
        scatter.finish(&self.skin, local);
    }

    /// What decides which contacts begin.
    fn onset(&self) -> Onset<'_> {
        let Self { skin, rules, proximity, x_n, predicted, .. } = self;
        Onset {
            skin,
            rules,
            candidates: &proximity.candidates,
            x_n,
            predicted,
            springs: &self.history.springs,
            thickness: self.options.thickness,
            between_states: !self.at_end,
        }
    }

    /// Makes the contacts of the step, after the candidates changed.
    fn regroup(&mut self) {
        let mut contacts = std::mem::take(&mut self.contacts);
        contacts.regroup(&self.onset());
        self.contacts = contacts;
    }
}

impl Term for GeneralContact {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.options.thickness
    }

    fn is_symmetric(&self, rule: Rule) -> bool {
        rule == Rule::Constraint(GradientRule::EndPoint) && !self.rules.has_friction()
    }

    fn set_share(&mut self, share: Share) -> Option<Share> {
        self.share = share;
        Some(self.share.clone())
    }

    fn begin(&mut self, step: &StepContext<'_>) -> Result<(), Fault> {
        let StepContext { q_n, v_n, .. } = *step;
        (self.step_size, self.has_rates) = (step.dt, step.rates);
        self.at_end = match step.rule {
            GradientRule::EndPoint => true,
            GradientRule::DiscreteGradient => false,
            GradientRule::StartPoint | GradientRule::Midpoint | GradientRule::EndPointMean => {
                let rule = format!("{:?}", step.rule);
                return Err(ContactError::RuleUnavailable { method: "general", rule }.into());
            }
        };
        if let Some(history) = self.next_history.take() {
            self.history = history;
        }
        let Self { skin, rules, proximity, x_n, x, predicted, step_size, .. } = self;
        skin.place(q_n, x_n);
        x.clone_from(x_n);
        let motion = |p: u32| if v_n.is_empty() { Vector3::zeros() } else { skin.at(p, v_n) * *step_size };
        predicted.clear();
        predicted.extend(x_n.iter().zip(0..).map(|(x, p)| x + motion(p)));
        proximity.begin(skin, rules, x_n, motion);
        self.contacts.begin(&self.history.held);
        self.regroup();
        self.proximity.keep();
        self.groups.clear();
        self.shortened = 0;
        self.activate();
        Ok(())
    }

    fn renew(&mut self, at: &At<'_>, _want_tangent: bool) -> Result<bool, Fault> {
        if self.has_rates && self.shortened >= MAX_SHORTENED {
            return Err(ContactError::TooFar { contact: self.name.clone(), iterations: self.shortened }.into());
        }
        let Self { skin, rules, proximity, x, .. } = self;
        skin.place(at.q_np1, x);
        if let Some(point) = x.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
            // A point has a node at least.
            let node = skin.terms(point as u32).first().map_or(u32::MAX, |term| term.0);
            return Err(ContactError::NotFinite { node }.into());
        }
        if proximity.hold(skin, rules, x, None).1 {
            self.regroup();
        }
        Ok(self.activate())
    }

    fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        let mut nodes = Vec::new();
        for facets in &self.groups {
            self.nodes_of(facets, &mut nodes);
            visit(&nodes, &[]);
        }
    }

    fn candidates(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
        let mut nodes = Vec::new();
        let mut last = None;
        for candidate in &self.proximity.candidates {
            if last != Some(candidate.facets) && self.proximity.expects(candidate) {
                last = Some(candidate.facets);
                self.nodes_of(&candidate.facets, &mut nodes);
                visit(&nodes, &[]);
            }
        }
    }

    fn assemble(&self, at: &At<'_>, want_tangent: bool, visit: &mut (dyn FnMut(&Local) + Send)) -> Result<(), Fault> {
        if at.rule.constraint().is_none() {
            return Ok(());
        }
        // Groups and what acts have one order: that of the facets.
        let mut next = 0;
        let of_groups = self.groups.iter().map(|facets| -> (&[u32], Range<usize>) {
            let first = next;
            while self.acts.get(next).is_some_and(|act| self.acts.facets(act) == &**facets) {
                next += 1;
            }
            (facets, first..next)
        });
        let of_groups: Vec<_> = of_groups.collect();
        let compute = |group: &(&[u32], Range<usize>), room: &mut Room| {
            self.contribution(group.clone(), want_tangent, room);
            Ok(())
        };
        in_order(&of_groups, compute, |_, room| visit(&room.local))
    }

    fn energy(&self, q: &[f64]) -> Result<f64, Fault> {
        let mut x = Vec::new();
        self.skin.place(q, &mut x);
        Ok(self.energy_at(&x))
    }

    fn work(&self, _at: &At<'_>) -> Result<Work, Fault> {
        let (mut work, mut joint) = (Work::default(), Joint::default());
        for act in &self.acts {
            let ActForce { energy, dissipated, work: by_friction, rubbed, .. } = self.force(act, &mut joint, false);
            work.stored += energy + rubbed.stored;
            work.friction_stored += rubbed.stored;
            work.friction_work += by_friction;
            work.damped += dissipated;
        }
        // Springs whose contacts have gone lose their energy.
        let before: f64 = self.history.springs.iter().map(|spring| spring.rubbed.stored).sum();
        work.dissipated = work.damped + (work.friction_work + before - work.friction_stored).max(0.0);
        Ok(work)
    }

    fn has_friction(&self) -> bool {
        self.rules.has_friction()
    }

    fn commit(&mut self, _at: &At<'_>) {
        // What the step did is asked for afterwards, so its start is left as it is until the next one begins.
        if self.next_history.is_none() {
            self.next_history = Some(self.history_at_end());
        }
    }

    fn save_history(&self) -> Vec<u8> {
        self.next_history.as_ref().unwrap_or(&self.history).save()
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        self.history = History::load(bytes, self.skin.point_count())?;
        self.next_history = None;
        // What the last step knew has no meaning any more.
        self.contacts = Contacts::default();
        self.acts = Acts::default();
        Ok(())
    }

    fn potential(&self) -> Option<&dyn Potential> {
        Some(self)
    }

    fn potential_mut(&mut self) -> Option<&mut dyn Potential> {
        Some(self)
    }
}

impl Potential for GeneralContact {
    fn has_energy(&self, rule: GradientRule) -> bool {
        rule == GradientRule::EndPoint
    }

    fn set_line(&mut self, increment: &[f64]) {
        self.line.clear();
        if !self.rules.has_friction() {
            return;
        }
        let mut d = std::mem::take(&mut self.increment);
        self.skin.place(increment, &mut d);
        let mut joint = Joint::default();
        let line = (&self.acts).into_iter().filter_map(|act| self.slip_along(act, &d, &mut joint)).collect();
        (self.line, self.increment) = (line, d);
    }

    fn friction_along(&self, part: f64) -> f64 {
        self.line.iter().map(|line| line.energy(part)).sum()
    }

    fn longest_step(&mut self, q: &[f64], increment: &[f64]) -> f64 {
        let Self { skin, rules, proximity, x, increment: d, .. } = self;
        skin.place(q, x);
        skin.place(increment, d);
        let (part, changed) = proximity.hold(skin, rules, x, Some(d));
        if part < 1.0 {
            d.iter_mut().for_each(|d| *d *= part);
        }
        let (free, nearest) = proximity.safe_fraction(x, d);
        let fraction = part * free;
        let begins = nearest.is_some_and(|c| free < BLOCKED && self.contacts.block(c));
        if changed || begins {
            self.regroup();
        }
        self.shortened += u32::from(part < 1.0);
        fraction
    }

    fn acts(&self) -> bool {
        !self.acts.is_empty()
    }

    fn keeps_apart(&self) -> bool {
        true
    }

    fn body_pairs(&self) -> Vec<BodyPair> {
        self.pairs_of_bodies()
    }

    fn surface_forces(&self) -> Vec<SurfaceForce> {
        self.forces_at_surface_nodes()
    }

    fn surface_nodes(&self, q_np1: &[f64]) -> Vec<SurfaceNode> {
        self.tractions_at_surface_nodes(q_np1)
    }
}
