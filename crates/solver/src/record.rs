//! Records of a completed step.

use crate::{Balance, Books};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stoss_term::{BodyPair, Coverage, SurfaceForce, SurfaceNode};

/// One row of the Newton history.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NewtonRow {
    /// Iteration within the step, from 0 (the predictor).
    pub iteration: u32,
    /// Relative residual: the larger of force residual over force scale and largest gap error over the surface's length.
    pub residual: f64,
    /// Norm of the displacement increment that led to it (0 for the predictor and after a change of constraints).
    pub increment: f64,
    /// Active constraints.
    pub active: usize,
    /// Constraints whose state or pairing changed just before this iteration.
    pub changes: usize,
}

/// A decision of the step control or the active set, for the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// Number of the step.
    pub step: u64,
    /// Time at its start.
    pub time: f64,
    /// Step size at that moment.
    pub dt: f64,
    /// Kind of the decision.
    pub kind: DecisionKind,
    /// Reason.
    pub reason: String,
}

/// Kinds of decisions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DecisionKind {
    /// The step was halved.
    Cut,
    /// The step was doubled again.
    Grow,
    /// The step succeeded after many iterations, and the next one was halved.
    Shrink,
    /// The predictor was dropped and the step was started in another way.
    Restart,
    /// The step failed from all its starts and was tried by smoothed complementarity (theory/constraints#smoothed).
    Smoothed,
    /// The step was accepted, but its result is doubtful.
    Warning,
    /// A stage began.
    Stage,
    /// A constraint, a prescription or a part was released.
    Release,
}

/// Contact of one step, all methods together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactSummary {
    /// Active slots at the end of the step.
    pub active: usize,
    /// Slots active now that were not at the end of the last step.
    pub closed: usize,
    /// Slots active at the end of the last step that are not now.
    pub released: usize,
    /// Changes of pairing in the step.
    pub repaired: usize,
    /// Smallest gap of all slots in reach (infinite if none).
    pub min_gap: f64,
    /// Largest pressure, per current area.
    pub max_pressure: f64,
    /// Coverage of the mortar segmentation: largest defect of all pairs, and the sum of the areas that are left out.
    pub coverage: Coverage,
    /// Sum over the contact pairs of the force that each exerts on its slave nodes.
    pub force_on_slave: [f64; 3],
    /// Each pair by itself, in the order of [`crate::Model::contacts`]: its own constraints only, also where nodes belong to several pairs. Zero for what
    /// is no contact (ties, joints), and while a pair is off.
    pub pairs: Vec<PairSummary>,
    /// Results of general contact by pairs of bodies in contact.
    pub bodies: Vec<BodyPair>,
    /// Results of general contact at surface nodes, in ascending order; nodes without forces and without a surface nearby may be missing.
    pub surface: Vec<SurfaceNode>,
    /// Differences between the contact forces on inset surfaces and those on the nodes that carry them, by node.
    pub moved: BTreeMap<u32, SurfaceForce>,
}

/// Results of one contact pair at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairSummary {
    /// Active slots.
    pub active: usize,
    /// Smallest gap of the slots in reach (infinite if none).
    pub min_gap: f64,
    /// Largest pressure, per current area.
    pub max_pressure: f64,
    /// Force on the slave nodes.
    pub force: [f64; 3],
    /// Moment of the same forces about the origin, at the positions at the end of the step.
    pub moment: [f64; 3],
    /// Current area of the active slots.
    pub area: f64,
    /// Work of the slip against the friction in the step; zero without friction.
    pub friction_work: f64,
}

impl Default for PairSummary {
    fn default() -> Self {
        Self {
            active: 0,
            min_gap: f64::INFINITY,
            max_pressure: 0.0,
            force: [0.0; 3],
            moment: [0.0; 3],
            area: 0.0,
            friction_work: 0.0,
        }
    }
}

/// A completed step.
#[derive(Clone, Debug)]
pub struct StepRecord {
    /// Number of the step, from 1 (0: the initial state).
    pub step: u64,
    /// Number of its stage, from 1.
    pub stage: u32,
    /// Time at its end.
    pub time: f64,
    /// Size of the step.
    pub dt: f64,
    /// True if its end is a multiple of the nominal step size.
    pub nominal: bool,
    /// Momenta, energies, work.
    pub balance: Balance,
    /// Newton history of the successful attempt.
    pub newton: Vec<NewtonRow>,
    /// Linear solves of the successful attempt, that of a linear predictor included.
    pub iterations: u32,
    /// Decisions since the last completed step.
    pub decisions: Vec<Decision>,
    /// Elements that are turned inside out at a vertex (see [`DecisionKind::Warning`]).
    pub inside_out: usize,
    /// Independent directions in which the energy falls at the end of a static step whose tangent is symmetric: negative eigenvalues of the tangent beyond those of constraints, without the
    /// negative curvature of layers of general contact. Zero for other steps,
    /// and where the linear solver does not count them.
    pub unstable: usize,
    /// Sums of the magnitudes of the components of nodal forces at the end of a stabilised static step: those of the stabilisation, and those of supports and
    /// loads.
    pub stabilising: Option<[f64; 2]>,
    /// Energy that closing gaps took in the step by the constraints themselves, in the order of [`crate::Model::contacts`]; empty in statics and of the initial state.
    pub closing: Vec<f64>,
    /// What each body, part, load and coupling did with the energy of the step; empty of the initial state.
    pub books: Books,
    /// Energy that the law of impact took in the step, in the same order; empty where it did not act.
    pub impact_losses: Vec<f64>,
    /// Contact, if the model has any.
    pub contact: Option<ContactSummary>,
}
