//! The tables `[scene]`, `[time]` and `[solver]`.

use crate::Units;
use crate::names::named;
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::collections::BTreeMap;
#[cfg(feature = "schema")]
use stoss_integrators::SCHEMES;
use stoss_integrators::SchemeError;

named! {
    /// What kind of analysis a scene or a stage is.
    Kind {
        /// With inertia: needs `[time] integrator` and the density of every body.
        Dynamic = "dynamic",
        /// Without inertia: a sequence of equilibria while loads and prescribed displacements follow their tables.
        QuasiStatic = "quasi-static",
    }
}

named! {
    /// How linear systems are solved.
    #[derive(Default)]
    LinearSolver {
        /// The direct solver that suits the system: dense LU up to 50 equations, multifrontal above.
        #[default]
        Auto = "auto",
        /// Multifrontal LU or LDL' of any size.
        Multifrontal = "multifrontal",
        /// Sparse LU or Cholesky of the library faer, of any size: slower, with pivots from whole columns.
        Faer = "faer",
    }
}

named! {
    /// How often matrices are factorised.
    #[derive(Default)]
    Factors {
        /// Within a step the factors of an earlier iterate serve as long as that is faster than new ones: linear systems are then solved by an
        /// iteration that they precondition.
        #[default]
        Reused = "reused",
        /// A factorisation in each Newton iteration.
        New = "new",
    }
}

/// `[scene]`: what the scene is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Title for reports.
    pub title: String,
    /// Dynamic or quasi-static.
    pub kind: Kind,
    /// What the numbers are measured in: labels of tables, charts and pictures, and a warning where densities, moduli, sizes or gravity are unusual. Nothing is
    /// converted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<Units>,
    /// Version of the scene format that the scene is written for, at most [`FORMAT`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub format: Option<u32>,
}

/// Version of the scene format that this program reads. It grows when a scene that was right means something else or is wrong: renamed and removed keys; not when
/// keys are added.
pub const FORMAT: u32 = 2;

/// `[time]`: interval, step size, scheme and step control. Runs start at time zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// End of the run, positive.
    pub end: f64,
    /// Nominal step size, positive, at most `end`. The last step is shortened to meet `end`. With `automatic` it is the largest step.
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
    /// Of a quasi-static scene: the run chooses its increments. Stages may have their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub automatic: Option<Automatic>,
    /// Of a quasi-static scene: viscous stabilisation that vanishes. Stages may have their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stabilise: Option<Stabilise>,
}

/// Increments that a static run or stage chooses between `smallest` and `step`: it begins with `initial`, doubles it after `after` easy increments in a row, and halves it after
/// an increment of more than `hard` iterations and after a failure. All are `step` over a power of two.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Automatic {
    /// The first increment is `step` over a power of two, and not larger than this. At most `step`.
    pub initial: f64,
    /// No increment is smaller than this; the run stops instead. By default a thousandth (over 2^10) of the first one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smallest: Option<f64>,
    /// An increment is easy if it took so many Newton iterations at most (at least 1).
    #[serde(default = "Automatic::default_easy")]
    pub easy: u32,
    /// So many easy increments in a row double the next one (at least 1).
    #[serde(default = "Automatic::default_after")]
    pub after: u32,
    /// An increment that took more iterations than this halves the next one, but not below the first one. At least `easy`; by default 10, or `easy` if that is larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hard: Option<u32>,
}

impl Automatic {
    /// An iteration or two to settle contact, and three to four that converge.
    pub const DEFAULT_EASY: u32 = 6;
    /// One easy increment may be chance.
    pub const DEFAULT_AFTER: u32 = 2;
    /// Abaqus has the same limit.
    pub const DEFAULT_HARD: u32 = 10;

    fn default_easy() -> u32 {
        Self::DEFAULT_EASY
    }

    fn default_after() -> u32 {
        Self::DEFAULT_AFTER
    }

    /// Iterations of an increment that do not yet halve the next one.
    pub fn hard(&self) -> u32 {
        self.hard.unwrap_or(Self::DEFAULT_HARD.max(self.easy))
    }

    /// Halvings of `step` that give the first and the smallest increment.
    pub fn halvings(&self, step: f64) -> [u32; 2] {
        // A remainder below 1e-9 is round-off of the division.
        let first = (step / self.initial).log2();
        let first = (first - 1e-9).ceil().clamp(0.0, 30.0) as u32;
        let last = self.smallest.map(|smallest| ((step / smallest).log2() + 1e-9).floor().clamp(0.0, 30.0) as u32);
        [first, last.unwrap_or(first + 10).clamp(first, 30.max(first))]
    }
}

/// Viscous stabilisation of a static run or stage: nodes of bodies resist motion, with a factor that falls linearly to zero at the end, so that the last equilibrium is free of it.
/// Exactly one of the two keys.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Stabilise {
    /// Part of the strain energy that a bar of the body's size would lose if it were stretched steadily all the time, in (0, 1]; for instance 2e-4.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fraction: Option<f64>,
    /// The factor itself at the start, positive: a force per volume and velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coefficient: Option<f64>,
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

/// Time-stepping scheme with its parameters, for instance `{ scheme = "generalised-alpha", rho_inf = 0.8 }`. Schemes and their
/// parameters are those of the table `stoss_integrators::SCHEMES`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Integrator {
    /// Name of the scheme.
    pub scheme: String,
    /// Its parameters; those left out take their default.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, f64>,
}

impl Integrator {
    /// The scheme, ready to use.
    ///
    /// # Errors
    /// Names or values that reading a scene would have refused.
    pub fn make(&self) -> Result<Box<dyn stoss_integrators::Scheme>, SchemeError> {
        let entry =
            stoss_integrators::entry(&self.scheme).ok_or_else(|| SchemeError::Unknown { name: self.scheme.clone() })?;
        entry.with(self.parameters.iter().map(|(name, value)| (name.as_str(), *value)))
    }

    /// Whether general contact can be integrated with the scheme; false for one that is unknown.
    pub fn carries_general_contact(&self) -> bool {
        self.make().is_ok_and(|scheme| scheme.rule(1.0).carries_barriers())
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Integrator {
    fn schema_name() -> Cow<'static, str> {
        "Integrator".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let variants: Vec<_> = SCHEMES
            .iter()
            .map(|entry| {
                let mut properties = serde_json::Map::new();
                properties.insert("scheme".into(), serde_json::json!({ "const": entry.name }));
                for p in entry.parameters {
                    let (minimum, maximum) = p.range;
                    let parameter = serde_json::json!({
                        "type": "number", "minimum": minimum, "maximum": maximum,
                        "default": p.default, "description": p.about,
                    });
                    properties.insert(p.name.into(), parameter);
                }
                serde_json::json!({
                    "description": entry.about, "type": "object", "properties": properties,
                    "required": ["scheme"], "additionalProperties": false,
                })
            })
            .collect();
        json_schema!({
            "description": "Time-stepping scheme with its parameters, for instance `{ scheme = \"energy-momentum\" }`.",
            "oneOf": variants,
        })
    }
}

named! {
    /// What happens if an element is turned inside out at a corner while it is not at its integration points.
    #[derive(Default)]
    InsideOut {
        /// The step fails; it is tried again with a smaller step size.
        #[default]
        Refuse = "refuse",
        /// A warning and the number of such elements in the records.
        Warn = "warn",
    }
}

/// `[solver]`: the nonlinear and the linear solver. What is left out takes the program's default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
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
    /// Whether one iteration more follows when Newton has converged, where that still pays; default: true. Balances are exact only as far as
    /// the residual is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polish: Option<bool>,
    /// How linear systems are solved.
    #[serde(default)]
    pub linear: LinearSolver,
    /// How often matrices are factorised.
    #[serde(default)]
    pub factors: Factors,
    /// What happens if an element is turned inside out at a corner at the end of a step.
    #[serde(default)]
    pub inside_out: InsideOut,
}
