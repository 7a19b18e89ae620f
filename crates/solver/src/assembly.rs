//! What a step needs, allocated once. What is computed with it is in [`crate::system`] and [`crate::problem`].

use crate::anchor::Anchor;
use crate::books::Works;
use crate::embedding::Transform;
use crate::inertia::{Inertia, Scales};
use crate::matrix::Matrix;
use crate::numbering::Numbering;
use crate::rows::Rows;
use crate::shares::Shares;
use crate::stabilise::Stabilisation;
use crate::switches::Acting;
use crate::{Load, Model, PhaseTime, StepError};
use std::ops::Range;
use std::sync::Arc;
use stoss_fe_solid::Volumetric;
use stoss_integrators::Buffers;
use stoss_linalg::LinearSolver;
use stoss_term::{Auxiliary, Term as _};

/// Part of what a mass moves in a step under a force.
const RIGID_COMPLIANCE: f64 = 1e-3;

/// What of the model is there at present.
#[derive(Debug)]
pub(crate) struct Present {
    pub acting: Acting,
    /// Whether the stage has inertia.
    pub has_rates: bool,
    /// Whether forces of dampers act on bodies.
    pub has_damping: bool,
    /// Stabilisation of a static stage.
    pub stabilisation: Option<Stabilisation>,
    /// Springs that hold what nothing holds yet.
    pub anchor: Option<Anchor>,
}

/// Forces of the loads.
#[derive(Debug)]
pub(crate) struct LoadForces {
    pub has_followers: bool,
    pub has_dead: bool,
    /// Embedded nodes that have loads, and the components that loads act at: theirs, and those with equations.
    pub embedded: Vec<u32>,
    pub support: Vec<Range<usize>>,
    /// Dead loads of the step, empty if there are none (those that depend on the configuration go to `follower`).
    pub dead: Vec<f64>,
    /// Follower pressures, moments, centrifugal loads; empty without.
    pub follower: Vec<f64>,
}

impl LoadForces {
    fn new(model: &Model, own: &[Range<usize>]) -> Self {
        let mut embedded: Vec<u32> = Vec::new();
        for load in &model.loads {
            load.stencils(&[], &mut |of, _| embedded.extend_from_slice(of));
        }
        embedded.retain(|&node| model.embedding.has(node));
        embedded.sort_unstable();
        embedded.dedup();
        let has_followers = model.loads.iter().any(Load::follows);
        let has_dead = model.loads.iter().any(|load| !load.follows());
        let vector = |exists: bool| vec![0.0; if exists { model.reference.len() } else { 0 }];
        let (dead, follower) = (vector(has_dead), vector(has_followers));
        Self { has_followers, has_dead, support: with_nodes(own, &embedded), embedded, dead, follower }
    }
}

/// What an evaluation leaves beside its vectors.
#[derive(Debug)]
pub(crate) struct Tally {
    /// Embedded nodes that have a force of contact.
    pub touched: Vec<u32>,
    /// Components that have forces of contact: those with equations and those of `touched`, ascending.
    pub support: Vec<Range<usize>>,
    /// Largest norm of the forces that were summed up.
    pub force_scale: f64,
    /// Largest constraint violation, relative to an edge length.
    pub gap_measure: f64,
    /// Sum of the squares of the auxiliaries' force rows.
    pub auxiliary_square: f64,
    /// Work of the forces.
    pub works: Works,
    /// Time of contact contributions since somebody took it.
    pub contact_time: PhaseTime,
    /// What contact contributions add to the linear equations only; empty as long as none did.
    pub shift: Vec<f64>,
    /// Whether rows of constraints in the last linear equations were written for the multipliers and not for their increments.
    pub shifts_rows: bool,
    /// Evaluations with a tangent since the step began.
    pub tangents: u32,
}

/// The iterate at which the linear equations were solved last, from which updates start, and increments that belong to their solution.
#[derive(Debug)]
pub(crate) struct Base {
    pub increment: Vec<f64>,
    pub pressures: Vec<Vec<f64>>,
    pub auxiliaries: Vec<Vec<f64>>,
    /// Positions of the iterate, if `has_linearised`; empty without mixed bodies.
    pub linearised: Vec<f64>,
    /// Whether there is one in this step.
    pub has_linearised: bool,
    /// Increments of condensed auxiliaries only.
    pub auxiliary_increment: Vec<Vec<f64>>,
    /// Increments of all components, for pairs with condensed auxiliaries and those that limit motions; else empty.
    pub full_increment: Vec<f64>,
}

impl Base {
    fn new(model: &Model) -> Self {
        let is_mixed = |body: &crate::Body| body.solid.options().volumetric == Volumetric::Mixed;
        let needs_full = has_condensed(model) || model.keeps_apart();
        Self {
            increment: vec![0.0; model.reference.len()],
            pressures: model.contacts.iter().map(|pair| vec![0.0; pair.term.slot_count()]).collect(),
            auxiliaries: no_auxiliaries(model),
            linearised: if model.bodies.iter().any(is_mixed) { model.reference.clone() } else { Vec::new() },
            has_linearised: false,
            auxiliary_increment: no_auxiliaries(model),
            full_increment: vec![0.0; if needs_full { model.reference.len() } else { 0 }],
        }
    }
}

/// Room for weighted local tangents, and for those of embedded nodes.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    pub weighted: Vec<f64>,
    pub transform: Transform,
    pub expanded: Vec<u32>,
}

/// Everything of fixed size that a step needs, allocated once (contact parts: once a change of the contact pattern).
#[derive(Debug)]
pub(crate) struct System {
    /// The share of this rank: vectors are whole, patterns and values are those of its contributions.
    pub shares: Arc<Shares>,
    pub matrix: Matrix,
    pub inertia: Inertia,
    pub scales: Scales,
    pub present: Present,
    pub loads: LoadForces,
    pub solver: Box<dyn LinearSolver>,
    /// How rows of unilateral contact are scattered.
    pub rows: Rows,
    /// Components of nodes that are not embedded, in ascending runs.
    pub own: Vec<Range<usize>>,
    /// Residual and its terms, `3 * nodes` each. Those of embedded nodes are zero, but for the forces of contact on the nodes in `tally.touched`.
    pub buffers: Buffers,
    pub tally: Tally,
    pub scratch: Scratch,
    // Vectors of equations.
    pub rhs: Vec<f64>,
    pub increment: Vec<f64>,
    pub base: Base,
    /// Negative eigenvalues of the tangent of a static step that was factorised last, beyond those of its constraints.
    pub excess: usize,
}

/// Ascending ranges of components, and those of nodes that are in none of them.
pub(crate) fn with_nodes(ranges: &[Range<usize>], nodes: &[u32]) -> Vec<Range<usize>> {
    let of_nodes = nodes.iter().map(|&node| 3 * node as usize..3 * node as usize + 3);
    let mut all: Vec<Range<usize>> = ranges.iter().cloned().chain(of_nodes).collect();
    all.sort_unstable_by_key(|range| range.start);
    all
}

/// Zero for every auxiliary of every slot of every contact pair.
pub(crate) fn no_auxiliaries(model: &Model) -> Vec<Vec<f64>> {
    model.contacts.iter().map(|c| vec![0.0; c.term.slot_count() * c.term.auxiliaries().len()]).collect()
}

/// Whether a pair has auxiliaries without equations.
pub(crate) fn has_condensed(model: &Model) -> bool {
    model.contacts.iter().any(|c| c.term.auxiliaries().contains(&Auxiliary::Condensed))
}

impl System {
    /// The system of a model, with a mass matrix if `dynamic`, whether or not the present stage needs it.
    pub fn new(
        model: &Model,
        acting: Acting,
        dynamic: bool,
        solver: Box<dyn LinearSolver>,
        shares: Arc<Shares>,
    ) -> Result<Self, StepError> {
        let inertia = Inertia::new(model, dynamic, &shares);
        let matrix = Matrix::new(model, Numbering::of(model, &acting), &inertia)?;
        let components = model.reference.len();
        let own = model.embedding.own(components);
        let n = matrix.free();
        let has_couplings = !model.contacts.is_empty();
        let tally = Tally {
            touched: Vec::new(),
            support: if has_couplings { own.clone() } else { Vec::new() },
            force_scale: 0.0,
            gap_measure: 0.0,
            auxiliary_square: 0.0,
            works: Works::new(model.bodies.len() + model.parts.len(), model.contacts.len()),
            contact_time: PhaseTime::default(),
            shift: Vec::new(),
            shifts_rows: false,
            tangents: 0,
        };
        Ok(Self {
            scales: Scales::new(model, &inertia.masses),
            present: Present { acting, has_rates: dynamic, has_damping: false, stabilisation: None, anchor: None },
            loads: LoadForces::new(model, &own),
            solver,
            rows: Rows::default(),
            buffers: Buffers::with_own(components, own.clone(), dynamic, has_couplings),
            own,
            tally,
            scratch: Scratch::default(),
            rhs: vec![0.0; n],
            increment: vec![0.0; n],
            base: Base::new(model),
            excess: 0,
            shares,
            matrix,
            inertia,
        })
    }

    /// Compliance of contact between rigid bodies, a length over a force. More nodes touch than three, and their multipliers are not determined: with this on the diagonals of
    /// the tangent, and not in the residual, the gaps close exactly and the multipliers are those of least norm (theory/multibody#redundancy). It is measured against the lightest body
    /// in dynamics, in statics against the present forces: they move an iterate by a small part of the `length` of an edge.
    pub fn rigid_compliance(&self, dt: f64, length: f64) -> f64 {
        let stiffness = if self.present.has_rates && dt > 0.0 && self.inertia.smallest > 0.0 {
            self.inertia.smallest / (dt * dt)
        } else {
            // Without forces what they would be; without anything elastic either there are none.
            let force = if self.tally.force_scale > 0.0 { self.tally.force_scale } else { self.scales.force };
            if force > 0.0 { force / length } else { 1.0 }
        };
        RIGID_COMPLIANCE / stiffness
    }

    /// Number of equations at present: free components, active pressures with their auxiliaries.
    pub fn equations(&self) -> usize {
        self.matrix.pattern.n()
    }

    /// Bytes of the arrays held here and by the solver.
    pub fn memory_bytes(&self) -> usize {
        let floats = self.loads.dead.capacity()
            + self.loads.follower.capacity()
            + self.base.increment.capacity()
            + self.base.linearised.capacity()
            + 2 * self.rhs.capacity();
        8 * floats + self.buffers.memory_bytes() + self.matrix.memory_bytes() + self.solver.memory_bytes()
    }

    /// Begins the pattern of a step, see [`Matrix::begin_pattern`].
    pub fn begin_pattern(&mut self, model: &Model, active: &[Vec<bool>]) -> Result<(), StepError> {
        self.tally.tangents = 0;
        self.matrix.begin_pattern(model, active)?;
        self.fit();
        Ok(())
    }

    /// Renews the pattern, see [`Matrix::renew_pattern`].
    pub fn renew_pattern(&mut self, model: &Model, active: &[Vec<bool>]) -> Result<(), StepError> {
        self.matrix.renew_pattern(model, active)?;
        self.fit();
        Ok(())
    }

    /// Vectors as long as there are equations.
    fn fit(&mut self) {
        self.rhs.resize(self.matrix.pattern.n(), 0.0);
        self.increment.resize(self.matrix.pattern.n(), 0.0);
    }
}
