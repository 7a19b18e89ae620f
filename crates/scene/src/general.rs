//! The tables `[scene]`, `[time]` and `[solver]`.

use crate::names::named;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

named! {
    /// What kind of analysis it is.
    Kind {
        /// With inertia: needs `[time] integrator` and the density of every body.
        Dynamic = "dynamic",
        /// Without inertia: a sequence of equilibria while loads and prescribed displacements follow their tables.
        QuasiStatic = "quasi-static",
    }
}

named! {
    /// Time-stepping scheme.
    Scheme {
        /// Conserves energy, linear and angular momentum for every law and step size (formulation §11, (3.2)).
        EnergyMomentum = "energy-momentum",
        /// Implicit midpoint rule: conserves both momenta, but not the energy.
        Midpoint = "midpoint",
    }
}

named! {
    /// How linear systems are solved.
    #[derive(Default)]
    LinearSolver {
        /// The direct solver that suits the system.
        #[default]
        Auto = "auto",
    }
}

/// `[scene]`: what the scene is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Title for reports.
    pub title: String,
    /// Dynamic or quasi-static.
    pub kind: Kind,
}

/// `[time]`: interval, step size, scheme and step control. Runs start at time zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// End of the run, positive.
    pub end: f64,
    /// Nominal step size, positive, at most `end`. The last step is shortened to meet `end`.
    pub step: f64,
    /// Time-stepping scheme; required in dynamic scenes, an error in quasi-static ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integrator: Option<Integrator>,
    /// How often a failing step may be halved in a row before the run stops (0 to 30): the smallest step is
    /// `step / 2^max_cuts`.
    #[serde(default = "Time::default_max_cuts")]
    pub max_cuts: u32,
    /// After so many successful steps a halved step is doubled again (at least 1).
    #[serde(default = "Time::default_grow_after")]
    pub grow_after: u32,
}

impl Time {
    /// Halvings allowed by default: a thousandth of the nominal step.
    pub const DEFAULT_MAX_CUTS: u32 = 10;
    /// Successes before regrowth by default: fewer make a step that is too large fail again and again.
    pub const DEFAULT_GROW_AFTER: u32 = 4;

    fn default_max_cuts() -> u32 {
        Self::DEFAULT_MAX_CUTS
    }

    fn default_grow_after() -> u32 {
        Self::DEFAULT_GROW_AFTER
    }
}

/// Time-stepping scheme with its parameters, for instance `{ scheme = "energy-momentum" }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Integrator {
    /// Name of the scheme.
    pub scheme: Scheme,
}

/// `[solver]`: the nonlinear and the linear solver. What is left out takes the program's default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Newton has converged when `residual <= absolute_tolerance + relative_tolerance * scale`, where the scale is the
    /// largest of the forces whose balance is sought. In (0, 1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_tolerance: Option<f64>,
    /// See `relative_tolerance`; a force, not negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub absolute_tolerance: Option<f64>,
    /// Largest number of Newton iterations a step, at least 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_iterations: Option<u32>,
    /// How linear systems are solved.
    #[serde(default)]
    pub linear: LinearSolver,
}
