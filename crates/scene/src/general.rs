//! The tables `[scene]`, `[time]` and `[solver]`.

#[cfg(feature = "schema")]
use crate::Dimension;
use crate::names::named;
use crate::read::{Node, Table, Value};
use crate::{Component, Kind, OneOrMany, Units};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::collections::BTreeMap;
use stoss_integrators::{SCHEMES, SchemeError};
use stoss_scene_derive::table;

named! {
    /// Solver for linear systems.
    #[derive(Default)]
    LinearSolver {
        /// Chosen by the number of equations: dense LU up to 50, multifrontal above, and by iteration where that is faster: from 3000 equations on, with multipliers of contact, ties or
        /// joints from 15 000 on if fewer than an eighth of the equations are theirs. What the iteration cannot solve is factorised.
        #[default]
        Auto = "auto",
        /// By iteration from 1000 equations on (smoothed aggregation) if less than half of them are those of multipliers, rigid bodies and beams. What it cannot solve is factorised.
        Iterative = "iterative",
        /// Multifrontal LU or LDL' for systems of any size.
        Multifrontal = "multifrontal",
        /// Sparse LU or Cholesky of the library faer for systems of any size: slower, with partial pivoting over whole columns.
        Faer = "faer",
        /// The library PETSc, on one rank or many, as `petsc` says. Only in programs that were built with it (guide/clusters). On several ranks `auto` is the same; a solver that is named is used
        /// by each rank for the whole matrix, which gains nothing.
        Petsc = "petsc",
    }
}

named! {
    /// Use of factorisations within a step.
    #[derive(Default)]
    Factors {
        /// The factors of an earlier iterate of the step precondition an iterative solution (GMRES), as long as that is faster than a new
        /// factorisation.
        #[default]
        Reused = "reused",
        /// A new factorisation in each Newton iteration.
        New = "new",
    }
}

named! {
    /// What the plane meshes of a scene are sections of (theory/elements#sections). Bodies are plane meshes then: files of plane elements, or the generators `rectangle` and `disc`.
    PlaneSection {
        /// Bodies of revolution about the y axis without torsion: x is the radius. Forces, areas, masses and energies of the scene and of its results are those of one radian.
        Axisymmetric = "axisymmetric",
        /// Long bodies that do not move along z. Forces and the like are those of a unit of thickness.
        PlaneStrain = "plane-strain",
        /// Thin plates with free faces. Forces and the like are those of a unit of thickness.
        PlaneStress = "plane-stress",
    }
}

/// `[scene]`: title, kind of analysis and units of the scene.
#[table]
pub struct Header {
    /// Title, for reports.
    #[key(example = "\"Ball on plate\"")]
    pub title: String,
    /// Kind of analysis: `dynamic` or `quasi-static`.
    #[key(example = "\"dynamic\"")]
    pub kind: Kind,
    /// What the meshes are sections of: `axisymmetric`, `plane-strain` or `plane-stress`; they are solids if left out.
    pub section: Option<PlaneSection>,
    /// Planes of symmetry of the whole model, `"x"` for x = 0, `"y"`, `"z"`, or a list of them: deformable bodies are held in them, and faces that lie there are cut faces, no surfaces. Results are those of what is
    /// modelled. None if left out.
    #[key(default, skip, by = planes)]
    pub symmetry: OneOrMany<Component>,
    /// System of units of all numbers in the scene: used for the labels of tables, charts and pictures, and for a warning where densities, moduli, sizes or gravity are unusual. Numbers are not
    /// converted. No labels if left out.
    pub units: Option<Units>,
    /// Version of the scene format for which the scene is written, at most [`FORMAT`]; the current one if left out.
    #[key(read = format)]
    pub format: Option<u32>,
}

/// Version of the scene format that this program reads. It is raised when a valid scene becomes invalid or changes its meaning (keys renamed or removed), not when
/// keys are added.
pub const FORMAT: u32 = 3;

/// `[time]`: interval, step size, scheme and step control. Runs start at time zero.
#[table(context(Clock), check = time)]
pub struct Time {
    /// End of the run (time), positive.
    #[key(dimension = Time, example = "1.0", positive)]
    pub end: f64,
    /// Nominal step size (time), positive, at most `end`. The last step is shortened to meet `end`. With `automatic` it is the largest step.
    #[key(dimension = Time, example = "0.01", positive)]
    pub step: f64,
    /// Time-stepping scheme with its parameters; required in dynamic scenes, unless every dynamic stage has its own, not allowed in quasi-static ones.
    pub integrator: Option<Integrator>,
    /// Largest number of successive cutbacks (halvings) of a step that fails, 0 to 30, before the run stops: the smallest step is
    /// `step / 2^max_cuts`.
    #[key(default = Self::DEFAULT_MAX_CUTS, range = 0..=30)]
    pub max_cuts: u32,
    /// Number of successful steps after which a halved step is doubled again, at least 1.
    #[key(default = Self::DEFAULT_GROW_AFTER)]
    pub grow_after: u32,
    /// Largest increment of the equivalent plastic strain that a point may have in a step, positive; for scenes with a material that yields. A step with more is halved like one that fails, and one with more than half of it is
    /// not followed by a larger one. No limit if left out.
    #[key(dimension = Number, positive)]
    pub max_plastic_increment: Option<f64>,
    /// Automatic choice of the increments in a quasi-static scene; off if left out. Stages may have their own.
    #[key(with = |node, _, keys| Automatic::below(node, keys.step))]
    pub automatic: Option<Automatic>,
    /// Viscous stabilisation of a quasi-static scene, which vanishes at its end; none if left out. Stages may have their own.
    pub stabilise: Option<Stabilise>,
}

/// Automatic increments of a static run or stage, between `smallest` and `step`: the first one is `initial`; it is doubled after `after` successive easy increments, and halved after
/// an increment of more than `hard` iterations and after a failure. All increments are `step` over a power of two.
#[table(example = "{ initial = 0.01, smallest = 1e-5 }", check = automatic)]
#[derive(Copy)]
pub struct Automatic {
    /// Upper bound of the first increment (time), at most `step`: the first increment is the largest `step` over a power of two below it.
    #[key(dimension = Time, example = "0.01", positive)]
    pub initial: f64,
    /// Smallest increment (time); if it fails the run stops. The first increment over 2^10 if left out.
    #[key(dimension = Time, positive)]
    pub smallest: Option<f64>,
    /// Largest number of Newton iterations of an easy increment, at least 1.
    #[key(default = Self::DEFAULT_EASY)]
    pub easy: u32,
    /// Number of successive easy increments after which the next one is doubled, at least 1.
    #[key(default = Self::DEFAULT_AFTER)]
    pub after: u32,
    /// Number of Newton iterations above which the next increment is halved, but not below the first one. At least `easy`; 10, or `easy` if that is larger, if left out.
    pub hard: Option<u32>,
}

impl Automatic {
    /// An iteration or two to settle contact, and three to four that converge.
    pub const DEFAULT_EASY: u32 = 6;
    /// One easy increment may be chance.
    pub const DEFAULT_AFTER: u32 = 2;
    /// Abaqus has the same limit.
    pub const DEFAULT_HARD: u32 = 10;

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

/// Viscous stabilisation of a static run or stage: a viscous force on the nodes of bodies whose coefficient decreases linearly to zero at the end, so that the last equilibrium is not affected.
/// Exactly one of the two keys.
#[table(example = "{ fraction = 2e-4 }", check = stabilise)]
#[derive(Copy)]
pub struct Stabilise {
    /// Viscous dissipation relative to the strain energy of a bar of the size of the body that is stretched at a constant rate over the run or stage, in (0, 1]; for instance 2e-4.
    #[key(dimension = Number, read = fraction)]
    pub fraction: Option<f64>,
    /// Viscous coefficient at the start, positive: a force per volume and velocity.
    #[key(dimension = ForcePerVolumeVelocity, positive)]
    pub coefficient: Option<f64>,
}

impl Time {
    /// Cutbacks allowed by default: down to a thousandth of the nominal step.
    pub const DEFAULT_MAX_CUTS: u32 = 10;
    /// Successes before regrowth by default: fewer make a step that is too large fail again and again.
    pub const DEFAULT_GROW_AFTER: u32 = 4;
}

/// Time-stepping scheme with its parameters, for instance `{ scheme = "generalised-alpha", rho_inf = 0.8 }`. Schemes and their
/// parameters are those of the table `stoss_integrators::SCHEMES`.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
                        "x-dimension": Dimension::Number,
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
    /// Treatment of elements that are inverted at a corner, but not at their Gauss points.
    #[derive(Default)]
    InsideOut {
        /// The step fails, and is repeated with a smaller step size.
        #[default]
        Refuse = "refuse",
        /// A warning; the number of such elements is in the records.
        Warn = "warn",
    }
}

/// `[solver]`: settings of the nonlinear and the linear solver.
#[table(check = solver)]
pub struct Solver {
    /// Relative tolerance of Newton's method, in (0, 1): converged when `residual <= absolute_tolerance + relative_tolerance * scale`, where the scale is the
    /// largest norm of inertial, internal, external and contact forces. 1e-9 if left out.
    #[key(dimension = Number, read = relative_tolerance)]
    pub relative_tolerance: Option<f64>,
    /// Absolute tolerance of Newton's method (a force), not negative, see `relative_tolerance`; 0 if left out.
    #[key(dimension = Force, not_negative)]
    pub absolute_tolerance: Option<f64>,
    /// Largest number of Newton iterations for one solution, at least 1; 25 if left out, 40 with general contact.
    pub max_iterations: Option<u32>,
    /// `true`: one more Newton iteration follows after convergence if it can still reduce the residual, because momenta and energy are conserved only to the accuracy of
    /// the residual. If left out, `true` in dynamics and `false` in statics, where nothing adds up from step to step.
    pub polish: Option<bool>,
    /// Solver for linear systems: `auto` if left out.
    #[key(default)]
    pub linear: LinearSolver,
    /// What PETSc does, where it solves (`linear = "petsc"`, or `auto` on several ranks): `"direct"` (factorisation by MUMPS), `"multigrid"` (iteration with smoothed aggregation; systems with
    /// multipliers, rigid bodies or beams, and what it cannot solve, are factorised), or options as PETSc writes them, such as `"-ksp_type gmres -pc_type asm -sub_pc_type ilu"`. If left out, multigrid from
    /// 3000 equations on where all of them are of nodes of bodies, else direct.
    #[key(read = petsc)]
    pub petsc: Option<String>,
    /// Use of factorisations within a step: `reused` if left out.
    #[key(default)]
    pub factors: Factors,
    /// Treatment of elements that are inverted at a corner at the end of a step: `refuse` if left out.
    #[key(default)]
    pub inside_out: InsideOut,
}

fn planes<C>(node: &Node<'_>, context: &C) -> Option<OneOrMany<Component>> {
    let planes = OneOrMany::<Component>::read(node, context)?;
    let all = planes.as_slice();
    if let Some(k) = (1..all.len()).find(|&k| all[..k].contains(&all[k])) {
        return node.fail(format!("has {} twice", all[k]), "write each plane once");
    }
    Some(planes)
}

fn format(node: &Node<'_>) -> Option<u32> {
    let format = node.count()?;
    if format > FORMAT {
        let message = format!("is newer than this program, which reads scenes of the format {FORMAT}");
        return node.fail(message, "use a newer version of Stoss, or write the scene for this format");
    }
    Some(format)
}

/// What `[time]` must know of the scene.
pub(crate) struct Clock {
    pub(crate) kind: Option<Kind>,
    /// Whether there are stages, none of which takes the scheme of `[time]`.
    pub(crate) own_schemes: bool,
}

/// More steps than this are a mistake in `step` or `end`.
pub(crate) const MAX_STEPS: f64 = 1e9;

/// The clock has so many ticks in a step at most.
const SMALLEST: f64 = 1e9;

fn time(keys: &TimeKeys, table: &Table<'_>, clock: &Clock) -> Option<()> {
    let integrator = match clock.kind {
        Some(Kind::Dynamic) if !clock.own_schemes && !table.has("integrator") => {
            table.missing("integrator", "integrator = { scheme = \"energy-momentum\" }")
        }
        Some(Kind::QuasiStatic) if table.has("integrator") => table.fail(
            "integrator",
            "a quasi-static scene has no integrator",
            "remove it, or set [scene] kind = \"dynamic\"",
        ),
        _ => Some(()),
    };
    let mut statics = Some(());
    for key in ["automatic", "stabilise"].into_iter().filter(|&key| table.has(key)) {
        if clock.kind == Some(Kind::Dynamic) {
            statics = table.fail(key, "is for statics", "remove it, or move it into a static [[stage]]");
        } else if let ("automatic", Some(other)) = (key, ["max_cuts", "grow_after"].into_iter().find(|&k| table.has(k)))
        {
            let remedy = "remove it; see `smallest` and `after` of `automatic`";
            statics = table.fail(other, "cannot be combined with `automatic`", remedy);
        }
    }
    let (end, step) = (keys.end?, keys.step?);
    if step > end {
        let message = format!("must not exceed the end of the run, {end}");
        return table.fail("step", message, "choose a smaller step or a later end");
    }
    if end / step > MAX_STEPS {
        return table.fail("step", format!("gives {:.1e} steps", end / step), "choose a larger step or an earlier end");
    }
    integrator.and(statics)
}

impl Automatic {
    /// The increments, not above the largest one, if that is known.
    pub(crate) fn below(node: &Node<'_>, step: Option<f64>) -> Option<Self> {
        let table = node.table_like("{ initial = 0.01, smallest = 1e-5 }")?;
        let automatic = Self::from_table(&table, &())?;
        match step {
            Some(step) if automatic.initial > step * (1.0 + 1e-12) => {
                let message = format!("must not exceed the largest increment, `step` = {step}");
                table.fail("initial", message, "choose a smaller one")
            }
            Some(step) if step / automatic.initial > SMALLEST => {
                let message = format!("is more than {SMALLEST:e} times smaller than `step` = {step}");
                table.fail("initial", message, "choose a larger one, or a smaller step")
            }
            _ => Some(automatic),
        }
    }
}

fn automatic<C>(keys: &AutomaticKeys, table: &Table<'_>, _: &C) -> Option<()> {
    let smallest = match (keys.smallest.flatten(), keys.initial) {
        (Some(smallest), Some(initial)) if smallest > initial => {
            table.fail("smallest", format!("must not exceed `initial` = {initial}"), "choose a smaller one")
        }
        _ => Some(()),
    };
    match (keys.hard.flatten(), keys.easy) {
        (Some(hard), Some(easy)) if hard < easy => {
            table.fail("hard", format!("must not be less than `easy` = {easy}"), "choose a larger one")
        }
        _ => smallest,
    }
}

fn fraction(node: &Node<'_>) -> Option<f64> {
    let fraction = node.positive()?;
    if fraction > 1.0 {
        return node.fail("must not be larger than 1", "write for instance 2e-4");
    }
    Some(fraction)
}

fn stabilise<C>(_: &StabiliseKeys, table: &Table<'_>, _: &C) -> Option<()> {
    match ["fraction", "coefficient"].map(|key| table.has(key)) {
        [true, true] => {
            table.fail("coefficient", "cannot be combined with `fraction`", "give either `fraction` or `coefficient`")
        }
        [false, false] => table.missing("fraction", "fraction = 2e-4"),
        _ => Some(()),
    }
}

impl<C> Value<C> for Integrator {
    fn read(node: &Node<'_>, _: &C) -> Option<Self> {
        let table = node.table()?;
        let names: Vec<&str> = SCHEMES.iter().map(|entry| entry.name).collect();
        let entry =
            table.required("scheme", "scheme = \"energy-momentum\"", |n| n.choice(&names, stoss_integrators::entry));
        let Some(entry) = entry else {
            // Which parameters there are is not known: nothing to say about them.
            return None;
        };
        let mut parameters = BTreeMap::new();
        let mut good = true;
        for parameter in entry.parameters {
            let (low, high) = parameter.range;
            let value = table.optional(parameter.name, |n| {
                let value = n.number()?;
                if value < low || value > high {
                    return n.fail(format!("is outside [{low}, {high}]"), format!("it is the {}", parameter.about));
                }
                Some(value)
            });
            good &= value.is_some();
            parameters.extend(value.flatten().map(|value| (parameter.name.to_owned(), value)));
        }
        table.finish();
        good.then(|| Self { scheme: entry.name.to_owned(), parameters })
    }
}

fn relative_tolerance(node: &Node<'_>) -> Option<f64> {
    let value = node.positive()?;
    if value >= 1.0 {
        return node.fail("must be smaller than 1", "write for instance 1e-9");
    }
    Some(value)
}

fn petsc(node: &Node<'_>) -> Option<String> {
    let text = node.string()?;
    if !(["direct", "multigrid"].contains(&text.as_str()) || text.starts_with('-')) {
        let remedy =
            "write \"direct\", \"multigrid\", or options that begin with -, such as \"-ksp_type gmres -pc_type asm\"";
        return node.fail("is neither a set of options of PETSc nor such options", remedy);
    }
    Some(text)
}

fn solver<C>(keys: &SolverKeys, table: &Table<'_>, _: &C) -> Option<()> {
    let is_other = keys.linear.is_some_and(|linear| !matches!(linear, LinearSolver::Auto | LinearSolver::Petsc));
    if is_other && matches!(keys.petsc, Some(Some(_))) {
        return table.fail(
            "petsc",
            "has no effect with another solver than PETSc",
            "remove it, or write linear = \"petsc\"",
        );
    }
    Some(())
}
