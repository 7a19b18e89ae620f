//! General contact: the sum over all pairs of a skin.
//!
//! Springs of pairs that stick are in `springs`, what is reported at the end of a step in `output`.

mod areas;
mod output;
mod springs;

use crate::proximity::{Candidate, Proximity};
use crate::slip::SlipLine;
use crate::{Friction, Interaction, Interactions, Layer, PairStart, Skin, StepForce, Stick, Tangent};
use nalgebra::Vector3;
use springs::Spring;
use stoss_contact::{
    BodyPair, ContactError, ContactRule, ContactWork, LocalContribution, Potential, Step, StepConfiguration,
    SurfaceForce, SurfaceNode,
};
use stoss_geometry::closest;

/// No start of a pair is known.
const NONE: u32 = u32::MAX;

/// Shear stiffness of the layer of a pair that sticks, in moduli over thicknesses.
const SHEAR: f64 = 3.0;

/// Iterations of a step with inertia in which motions are shortened because they pass very many facets; then the step is given up.
const MAX_SHORTENED: u32 = 3;

/// Settings of [`GeneralContact`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralOptions {
    /// Thickness of the layer, a length: at this distance forces begin.
    pub thickness: f64,
    /// Time of the viscous layer, not negative.
    pub damping: f64,
}

/// A pair that acts. It owns what it needs of its candidate: candidates are found anew on the way from one iterate to the next.
#[derive(Clone, Copy, Debug)]
struct Active {
    candidate: Candidate,
    /// Place in the list of pairs at the start of the step, if the rule asks for that.
    start: u32,
}

/// Contact of everything with everything: each point of integration of a skin against each triangle, each vertex against each triangle and each edge against each other with a small weight.
///
/// Under [`ContactRule::EnergyMomentum`] the force of a step does exactly the work `V(q_n) - V(q_np1)` and leaves both momenta, theory/barrier#gradient; under [`ContactRule::EndPoint`] it
/// is the gradient at the end. Nothing passes through anything as long as each iterate is reached from the last by a motion that [`Potential::longest_step`] admits. Without friction, and in dynamics, it has no history;
/// in statics pairs with friction hold like springs until they slide, and the stretch of these carries over from step to step.
#[derive(Debug)]
pub struct GeneralContact {
    name: String,
    skin: Skin,
    rules: Interactions,
    options: GeneralOptions,
    proximity: Proximity,
    rule: ContactRule,
    step_size: f64,
    has_rates: bool,
    /// Positions of the points at the start of the step and at the iterate.
    x_n: Vec<Vector3<f64>>,
    x: Vec<Vector3<f64>>,
    increment: Vec<Vector3<f64>>,
    /// For each candidate: whether it is in the layer at the start, and its place in `starts`.
    inside_n: Vec<bool>,
    start_of: Vec<u32>,
    /// Pairs at the start of the step; they grow only, for what acts refers to them.
    starts: Vec<PairStart>,
    /// What acts at the iterate that was seen last.
    active: Vec<Active>,
    /// Pairs of facets that had an active pair in the step: they grow only, so that stencils seldom change.
    groups: Vec<[u32; 2]>,
    /// Motions of the step that were shortened because they pass very many facets.
    shortened: u32,
    /// Friction along the motion that was set last.
    line: Vec<SlipLine>,
    /// Springs of pairs with friction at the start of the step, ascending.
    springs: Vec<Spring>,
    /// Those at the end of the step that was accepted last, until the next one begins.
    next_springs: Option<Vec<Spring>>,
}

impl GeneralContact {
    /// Contact of a skin by rules for its classes.
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
            rule: ContactRule::EndPoint,
            step_size: 0.0,
            has_rates: false,
            x_n: Vec::new(),
            x: Vec::new(),
            increment: Vec::new(),
            inside_n: Vec::new(),
            start_of: Vec::new(),
            starts: Vec::new(),
            active: Vec::new(),
            groups: Vec::new(),
            shortened: 0,
            line: Vec::new(),
            springs: Vec::new(),
            next_springs: None,
        })
    }

    /// The skin.
    pub fn skin(&self) -> &Skin {
        &self.skin
    }

    fn layer(&self, candidate: &Candidate) -> Layer {
        let [a, b] = candidate.classes;
        let modulus = self.rules.between(a, b).map_or(0.0, |interaction| interaction.modulus);
        let layer = Layer::new(modulus, self.options.thickness);
        if self.has_rates && self.options.damping > 0.0 {
            layer.damped(self.options.damping / self.step_size)
        } else {
            layer
        }
    }

    fn friction(&self, candidate: &Candidate) -> Option<Friction> {
        let [a, b] = candidate.classes;
        let Interaction { modulus, friction, slip_velocity } = *self.rules.between(a, b)?;
        if friction <= 0.0 {
            return None;
        }
        let stick = if self.has_rates {
            Stick::Creep { slip_scale: slip_velocity * self.step_size }
        } else {
            let key = (candidate.term.kind, candidate.points);
            let known = self.springs.binary_search_by_key(&key, |spring| (spring.kind, spring.points));
            Stick::Spring {
                stiffness: SHEAR * modulus / self.options.thickness * candidate.term.weight,
                stretch: known.map_or_else(|_| Vector3::zeros(), |place| self.springs[place].stretch),
            }
        };
        Some(Friction { coefficient: friction, stick })
    }

    /// After the candidates changed: which are in the layer at the start.
    fn renew_starts(&mut self) {
        let Self { proximity, x_n, inside_n, start_of, options, .. } = self;
        inside_n.clear();
        inside_n.extend(proximity.candidates.iter().map(|c| is_inside(c, x_n, options.thickness)));
        start_of.clear();
        start_of.resize(proximity.candidates.len(), NONE);
    }

    /// Finds what acts at `x`; returns whether there are new pairs of facets.
    fn activate(&mut self) -> bool {
        let mut active = std::mem::take(&mut self.active);
        active.clear();
        let known = self.groups.len();
        for k in 0..self.proximity.candidates.len() {
            let candidate = self.proximity.candidates[k];
            if !self.inside_n[k] && !is_inside(&candidate, &self.x, self.options.thickness) {
                continue;
            }
            if self.start_of[k] == NONE && self.rule == ContactRule::EnergyMomentum {
                self.start_of[k] = self.starts.len() as u32;
                let start = PairStart::new(candidate.term, self.layer(&candidate), &candidate.of(&self.x_n));
                self.starts.push(start);
            }
            active.push(Active { candidate, start: self.start_of[k] });
            // Candidates come by facets.
            let is_new = self.groups.len() == known || self.groups.last() != Some(&candidate.facets);
            if is_new && self.groups[..known].binary_search(&candidate.facets).is_err() {
                self.groups.push(candidate.facets);
            }
        }
        self.active = active;
        let changed = self.groups.len() > known;
        self.groups.sort_unstable();
        changed
    }

    /// Force of an active candidate at the iterate.
    fn force(&self, Active { candidate, start }: &Active, tangent: Option<&mut Tangent>) -> StepForce {
        let (x, friction) = (candidate.of(&self.x), self.friction(candidate));
        match self.starts.get(*start as usize) {
            Some(start) => start.step(&x, friction.as_ref(), tangent),
            None => {
                candidate.term.at_end(&self.layer(candidate), &candidate.of(&self.x_n), &x, friction.as_ref(), tangent)
            }
        }
    }

    /// Nodes of two facets, ascending.
    fn nodes_of(&self, [f, g]: [u32; 2], nodes: &mut Vec<u32>) {
        nodes.clear();
        nodes.extend_from_slice(self.skin.nodes_of(f));
        nodes.extend_from_slice(self.skin.nodes_of(g));
        nodes.sort_unstable();
        nodes.dedup();
    }
}

/// Whether a pair is in the layer. Most are not, which their boxes tell.
fn is_inside(candidate: &Candidate, x: &[Vector3<f64>], thickness: f64) -> bool {
    let x = candidate.of(x);
    candidate.may_meet(&x, &[Vector3::zeros(); 4], thickness)
        && closest(candidate.term.kind, &x).distance_squared < thickness * thickness
}

impl Potential for GeneralContact {
    fn name(&self) -> &str {
        &self.name
    }

    fn length_scale(&self) -> f64 {
        self.options.thickness
    }

    fn is_symmetric(&self, rule: ContactRule) -> bool {
        rule == ContactRule::EndPoint && !self.rules.has_friction()
    }

    fn has_energy(&self, rule: ContactRule) -> bool {
        rule == ContactRule::EndPoint
    }

    fn set_line(&mut self, increment: &[f64]) {
        self.line.clear();
        if !self.rules.has_friction() {
            return;
        }
        let mut d = std::mem::take(&mut self.increment);
        self.skin.place(increment, &mut d);
        let along = |Active { candidate, .. }: &Active| {
            let points = [candidate.of(&self.x_n), candidate.of(&self.x), candidate.of(&d)];
            candidate.term.slip_along(&self.layer(candidate), points.each_ref(), &self.friction(candidate)?)
        };
        let line = self.active.iter().filter_map(along).collect();
        (self.line, self.increment) = (line, d);
    }

    fn friction_along(&self, part: f64) -> f64 {
        self.line.iter().map(|line| line.energy(part)).sum()
    }

    fn begin(&mut self, step: &Step<'_>) -> Result<(), ContactError> {
        let Step { q_n, v_n, .. } = *step;
        (self.rule, self.step_size, self.has_rates) = (step.rule, step.dt, step.rates);
        if !matches!(self.rule, ContactRule::EnergyMomentum | ContactRule::EndPoint) {
            return Err(ContactError::RuleUnavailable { method: "general", rule: format!("{:?}", self.rule) });
        }
        if let Some(springs) = self.next_springs.take() {
            self.springs = springs;
        }
        let Self { skin, rules, proximity, x_n, x, step_size, .. } = self;
        skin.place(q_n, x_n);
        x.clone_from(x_n);
        let motion = |p: u32| if v_n.is_empty() { Vector3::zeros() } else { skin.at(p, v_n) * *step_size };
        proximity.begin(skin, rules, x_n, motion);
        self.starts.clear();
        self.renew_starts();
        self.proximity.keep(&self.inside_n);
        self.groups.clear();
        self.shortened = 0;
        self.activate();
        Ok(())
    }

    fn renew(&mut self, q_np1: &[f64]) -> Result<bool, ContactError> {
        if self.has_rates && self.shortened >= MAX_SHORTENED {
            return Err(ContactError::TooFar { contact: self.name.clone(), iterations: self.shortened });
        }
        let Self { skin, rules, proximity, x, .. } = self;
        skin.place(q_np1, x);
        if let Some(point) = x.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
            // A point has a node at least.
            let node = skin.terms(point as u32).first().map_or(u32::MAX, |term| term.0);
            return Err(ContactError::NotFinite { node });
        }
        if proximity.hold(skin, rules, x, None).1 {
            self.renew_starts();
        }
        Ok(self.activate())
    }

    fn longest_step(&mut self, q: &[f64], increment: &[f64]) -> f64 {
        let Self { skin, rules, proximity, x, increment: d, .. } = self;
        skin.place(q, x);
        skin.place(increment, d);
        let (part, changed) = proximity.hold(skin, rules, x, Some(d));
        if part < 1.0 {
            d.iter_mut().for_each(|d| *d *= part);
        }
        let fraction = part * proximity.safe_fraction(x, d);
        if changed {
            self.renew_starts();
        }
        self.shortened += u32::from(part < 1.0);
        fraction
    }

    fn acts(&self) -> bool {
        !self.active.is_empty()
    }

    fn keeps_apart(&self) -> bool {
        true
    }

    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        let mut nodes = Vec::new();
        for &facets in &self.groups {
            self.nodes_of(facets, &mut nodes);
            visit(&nodes);
        }
    }

    fn candidates(&self, visit: &mut dyn FnMut(&[u32])) {
        let mut nodes = Vec::new();
        let mut last = None;
        for candidate in &self.proximity.candidates {
            if last != Some(candidate.facets) && self.proximity.expects(candidate) {
                last = Some(candidate.facets);
                self.nodes_of(candidate.facets, &mut nodes);
                visit(&nodes);
            }
        }
    }

    fn assemble(
        &self,
        _step: StepConfiguration<'_>,
        want_tangent: bool,
        visit: &mut dyn FnMut(&LocalContribution),
    ) -> Result<(), ContactError> {
        let mut local = LocalContribution::default();
        let mut tangent: Tangent = [[0.0; 12]; 12];
        let mut terms: Vec<(usize, f64)> = Vec::new();
        let mut next = 0;
        for &facets in &self.groups {
            self.nodes_of(facets, &mut local.nodes);
            local.reset(want_tangent);
            let n = local.dim();
            while let Some(active) = self.active.get(next) {
                let candidate = &active.candidate;
                if candidate.facets != facets {
                    break;
                }
                next += 1;
                let force = self.force(active, want_tangent.then_some(&mut tangent));
                // Places of the nodes of the four points in the contribution.
                terms.clear();
                let mut ends = [0; 5];
                for (i, &point) in candidate.points.iter().enumerate() {
                    // cannot fail: the points of a pair are points of its facets.
                    let place = |node: u32| local.nodes.binary_search(&node).unwrap_or_default();
                    terms.extend(self.skin.terms(point).iter().map(|&(node, w)| (3 * place(node), w)));
                    ends[i + 1] = terms.len();
                }
                for i in 0..4 {
                    for &(row, w) in &terms[ends[i]..ends[i + 1]] {
                        for c in 0..3 {
                            local.residual[row + c] +=
                                w * (force.barrier.gradient[i][c] + force.friction.gradient[i][c]);
                        }
                        if !want_tangent {
                            continue;
                        }
                        for j in 0..4 {
                            for &(column, v) in &terms[ends[j]..ends[j + 1]] {
                                for c in 0..3 {
                                    let entries = &mut local.tangent[(row + c) * n + column..][..3];
                                    let block = &tangent[3 * i + c][3 * j..3 * j + 3];
                                    entries.iter_mut().zip(block).for_each(|(t, b)| *t += w * v * b);
                                }
                            }
                        }
                    }
                }
            }
            visit(&local);
        }
        Ok(())
    }

    fn energy(&self, q: &[f64]) -> Result<f64, ContactError> {
        let mut x = Vec::new();
        self.skin.place(q, &mut x);
        let mut proximity = Proximity::new(&self.skin, self.options.thickness);
        proximity.begin(&self.skin, &self.rules, &x, |_| Vector3::zeros());
        let energy = |c: &Candidate| c.term.at_state(&self.layer(c), &c.of(&x), None).energy;
        Ok(proximity.candidates.iter().map(energy).sum())
    }

    fn work(&self, _q_np1: &[f64]) -> Result<ContactWork, ContactError> {
        let mut work = ContactWork::default();
        for active in &self.active {
            let StepForce { barrier, friction } = self.force(active, None);
            work.stored += barrier.energy + friction.stored;
            work.friction_stored += friction.stored;
            work.friction_work += friction.work;
            work.damped += barrier.dissipated;
        }
        // Springs whose pairs have gone lose their energy.
        let before: f64 = self.springs.iter().map(|spring| spring.stored).sum();
        work.dissipated = work.damped + (work.friction_work + before - work.friction_stored).max(0.0);
        Ok(work)
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

    fn has_friction(&self) -> bool {
        self.rules.has_friction()
    }

    fn commit(&mut self, _q_np1: &[f64]) {
        // What the step did is asked for afterwards, so its start is left as it is until the next one begins.
        if self.next_springs.is_none() {
            self.next_springs = Some(self.stretched());
        }
    }

    fn save_history(&self) -> Vec<u8> {
        springs::save(self.next_springs.as_ref().unwrap_or(&self.springs))
    }

    fn load_history(&mut self, bytes: &[u8]) -> Result<(), ContactError> {
        self.springs = springs::load(bytes, self.skin.point_count())?;
        self.next_springs = None;
        Ok(())
    }
}
