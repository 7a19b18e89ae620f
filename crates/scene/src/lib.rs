//! The scene format: schema and validation, data only.
//!
//! [`parse`] turns the text of a scene (TOML) into a [`Scene`] or into *all* of its problems at once, each with file, line, column,
//! key, value, message and remedy. The types carry the documentation of every key; `json_schema` (feature `schema`) prints it for editors.
//!
//! [`Body`], [`Material`], [`Contact`], [`Friction`], [`Load`], [`Prescribe`], [`Joint`] and [`Stage`] are the main tables of a scene, [`SceneErrors`] and [`Problem`] what is
//! wrong with it.
//!
//! # What it is not
//! No mesh, no law, no simulation: whether a set exists, a file can be read or a mesh is inverted is for the facade, which reports
//! it through [`Problem::at`] in the same form.
//!
//! # How to add a key
//! A documented field in the type, and a malformed scene in `tests/malformed.rs`. The attribute `#[key(...)]` of the field says what values it takes, and the function that `#[table(check = ...)]` names, in the
//! same file, what other keys contradict it (`stoss_scene_derive::table` lists the options). A row of `CASES` in `tests/malformed.rs` is a wrong scene and the line and key of its one problem; `cargo xtask schema` writes schema and reference. Reader, error messages, schema, reference and completion follow. A
//! new scheme, quantity, field or contact method is one line in its enumeration or table. A key that is renamed or removed gets a line in `read/old.rs`, and [`FORMAT`] grows.
//!
#![doc = include_str!("../README.md")]

mod acting;
mod beam;
mod body;
mod catalogue;
mod chosen;
mod component;
mod contact;
mod contact_method;
mod coupling;
mod document;
mod equation;
mod event;
mod expect;
mod expression;
mod friction;
mod general;
mod general_contact;
mod gravity;
mod inelastic;
mod joint;
mod kind;
mod left_out;
mod load;
mod material;
mod mesh;
mod names;
mod one_or_many;
mod output;
mod part;
mod prescribe;
mod probe;
mod problem;
mod quantity;
mod read;
mod rigid;
#[cfg(test)]
mod samples;
#[cfg(feature = "schema")]
mod schema;
mod series;
mod set;
mod set_expression;
mod set_parser;
mod sets;
mod source;
mod spelling;
mod string;
mod support;
mod sweep;
mod tie;
mod units;
mod vector;
mod watch;
mod world;

pub use acting::{ActingOn, JointFriction, JointSpring, Motor, Pretension};
pub use beam::{Arc, Beam, CircleSection, RectangleSection, Section, SectionShape, SectionStiffness, TubeSection};
pub use body::{Body, Cell, Damping, Integration, Mass, Rotation, Rotations, RoundShape, RoundSurface, Volumetric};
pub use catalogue::{Parameter, given};
pub use chosen::{Chosen, Rows};
pub use component::Component;
pub use contact::{
    Closing, ClosingFriction, Constraint, Contact, Edges, Enforcement, GapAtClosing, Integrals, OverlapAtStart,
    Reduction, SurfaceMass,
};
pub use contact_method::{ContactMethod, METHODS, MethodEntry};
pub use coupling::{Coupling, SetCoupling};
pub use equation::{Equation, EquationTerm};
pub use event::{Event, EventCondition, Stage};
pub use expect::{Expect, ExpectedValue, Interval, Outcome};
pub use friction::{Friction, Slip, Stick, Sticking};
pub use general::{
    Automatic, FORMAT, Factors, Header, InsideOut, Integrator, LinearSolver, PlaneSection, Solver, Stabilise, Time,
};
pub use general_contact::{GeneralContact, GeneralFriction, GeneralPair, Initial};
pub use gravity::Gravity;
pub use inelastic::{Fibres, Moduli, Mullins, Plasticity, Rate};
pub use joint::{GROUND, Joint, JointKind, JointPoint, Spring};
pub use kind::Kind;
pub use left_out::{LeftOut, Omission};
pub use load::{Load, LoadKind};
pub use material::{Inelasticity, Material};
pub use mesh::{
    Ball, Block, Cylinder, Disc, Generator, Hexahedron, HollowBall, HollowTorus, Indenter, LShape, MeshFile,
    MeshSource, Portion, Rectangle, Refinement,
};
pub use one_or_many::OneOrMany;
pub use output::{FrameFormat, Frames, Output};
pub use part::{PartKind, split_set};
pub use prescribe::{Prescribe, PrescribedRotation};
pub use probe::Probe;
pub use problem::{Problem, SceneErrors};
pub use quantity::{Extremum, Field, ProbeComponent, Quantity};
pub use rigid::{BoxShape, ConeShape, CylinderShape, PlaneShape, Rigid, Shape, SphereShape, SurfaceFile};
#[cfg(feature = "schema")]
pub use schema::json_schema;
pub use series::{Series, SeriesTable};
pub use set::{BoxRegion, PlaneRegion, SetDefinition};
pub use set_expression::{Formula, RegionKind, Relation, SetExpression, SetRegion};
pub use source::Location;
pub use spelling::known;
pub use stoss_multibody::{CoordinateKind, Directions};
pub use string::{ElasticString, PointMass};
pub use support::{Support, SupportPer};
pub use sweep::{Sweep, SweepRange, SweepValues};
pub use tie::{Interface, Multipliers, Tie, TieForm};
pub use units::{Dimension, Units};
pub use watch::{OnFault, Verdict, Watch};

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Serialize;
use source::Source;
use std::collections::BTreeMap;

/// A scene, as [`parse`] returns it: complete, and consistent as far as that can be checked without meshes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// `[parameters]`: named numbers for expressions. Every number of a scene, parameters included, may be a string with an expression in them,
    /// for instance `"2*radius"`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = "as where it is used")))]
    pub parameters: BTreeMap<String, f64>,
    /// `[sweep]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<Sweep>,
    /// `[scene]`.
    #[serde(rename = "scene")]
    pub header: Header,
    /// `[time]`.
    pub time: Time,
    /// `[solver]`.
    #[serde(default)]
    pub solver: Solver,
    /// `[gravity]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Gravity>,
    /// `[[body]]`. A scene has at least one part: a body, rigid body, beam, string or point mass.
    #[serde(default, rename = "body", skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<Body>,
    /// `[[rigid]]`.
    #[serde(default, rename = "rigid", skip_serializing_if = "Vec::is_empty")]
    pub rigids: Vec<Rigid>,
    /// `[[beam]]`.
    #[serde(default, rename = "beam", skip_serializing_if = "Vec::is_empty")]
    pub beams: Vec<Beam>,
    /// `[[string]]`.
    #[serde(default, rename = "string", skip_serializing_if = "Vec::is_empty")]
    pub strings: Vec<ElasticString>,
    /// `[[mass]]`.
    #[serde(default, rename = "mass", skip_serializing_if = "Vec::is_empty")]
    pub masses: Vec<PointMass>,
    /// `[[set]]`.
    #[serde(default, rename = "set", skip_serializing_if = "Vec::is_empty")]
    pub sets: Vec<SetDefinition>,
    /// `[sets]`: named expressions of sets, for instance `left = "block.all & x < 0.5"`. Such a name can be used wherever a set is
    /// expected, by itself or as `part.name`, and in other expressions.
    #[serde(default, rename = "sets", skip_serializing_if = "BTreeMap::is_empty")]
    pub named_sets: BTreeMap<String, String>,
    /// `[[contact]]`.
    #[serde(default, rename = "contact", skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<Contact>,
    /// `[general_contact]`; see [`Scene::general_contact`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub general_contact: Option<GeneralContact>,
    /// `[[tie]]`.
    #[serde(default, rename = "tie", skip_serializing_if = "Vec::is_empty")]
    pub ties: Vec<Tie>,
    /// `[[joint]]`.
    #[serde(default, rename = "joint", skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<Joint>,
    /// `[[coupling]]`.
    #[serde(default, rename = "coupling", skip_serializing_if = "Vec::is_empty")]
    pub couplings: Vec<SetCoupling>,
    /// `[[equation]]`.
    #[serde(default, rename = "equation", skip_serializing_if = "Vec::is_empty")]
    pub equations: Vec<Equation>,
    /// `[[spring]]`.
    #[serde(default, rename = "spring", skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<Spring>,
    /// `[[prescribe]]`.
    #[serde(default, rename = "prescribe", skip_serializing_if = "Vec::is_empty")]
    pub prescriptions: Vec<Prescribe>,
    /// `[[load]]`.
    #[serde(default, rename = "load", skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<Load>,
    /// `[[support]]`.
    #[serde(default, rename = "support", skip_serializing_if = "Vec::is_empty")]
    pub supports: Vec<Support>,
    /// `[[event]]`.
    #[serde(default, rename = "event", skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<Event>,
    /// `[[stage]]`, in the order of time; none for a run of one stage.
    #[serde(default, rename = "stage", skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<Stage>,
    /// `[[probe]]`.
    #[serde(default, rename = "probe", skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Probe>,
    /// `[output]`.
    #[serde(default)]
    pub output: Output,
    /// `[watch]`.
    #[serde(default)]
    pub watch: Watch,
    /// `[expect]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expect: Option<Expect>,
    /// `[[left_out]]`.
    #[serde(default, rename = "left_out", skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<LeftOut>,
    #[serde(skip)]
    source: Source,
}

impl Scene {
    /// General contact, if it is on: as given in the scene; with its defaults if a contact has `edges = "general"`, or if there is no `[[contact]]`, several parts have surfaces, some of them
    /// deformable, and all schemes support it.
    pub fn general_contact(&self) -> Option<GeneralContact> {
        if self.header.section.is_some() {
            return None;
        }
        if let Some(table) = &self.general_contact {
            return table.enabled.then(|| table.clone());
        }
        let has_surface = |rigid: &&Rigid| rigid.shape.is_some() || rigid.mesh.is_some() || rigid.surface.is_some();
        let surfaces = self.bodies.len() + self.rigids.iter().filter(has_surface).count();
        let schemes = self.time.integrator.iter().chain(self.stages.iter().filter_map(|s| s.integrator.as_ref()));
        let is_on = self.contacts.iter().any(|contact| contact.edges == Edges::General)
            || general_contact::is_default(!self.contacts.is_empty(), surfaces, self.bodies.len(), schemes);
        is_on.then(GeneralContact::default)
    }

    /// Name of the file, as it was given to [`parse`].
    pub fn file(&self) -> &str {
        &self.source.file
    }

    /// The text from which the scene was read.
    pub fn text(&self) -> &str {
        &self.source.text
    }

    /// Place of the value of a key in the file, for instance of `body[0].material`; `None` if the key is not there.
    pub fn locate(&self, key: &str) -> Option<Location> {
        self.source.locate(key)
    }

    /// Place of the value of a key as of [`Self::locate`], or else of the nearest table around the key, or else the start of the file.
    pub fn locate_nearest(&self, key: &str) -> Location {
        self.source.locate_nearest(key)
    }

    /// The expressions over sets that the scene uses, in the order of the file but each after those that it uses. Only a scene that was
    /// read by [`parse`] has them.
    pub fn set_expressions(&self) -> &[SetExpression] {
        &self.source.expressions
    }

    /// Position of a body in [`Self::bodies`].
    pub fn body_index(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body.name == name)
    }

    /// Whether a prescribed motion is along a `normal` that is not a coordinate axis: it is then a constraint with multipliers.
    pub fn has_sliding_supports(&self) -> bool {
        self.prescriptions.iter().any(Prescribe::is_inclined)
    }

    /// True for a dynamic scene.
    pub fn is_dynamic(&self) -> bool {
        self.header.kind == Kind::Dynamic
    }
}

/// Reads a scene.
///
/// `file` is the name of the file in messages; nothing is read from disk.
///
/// # Errors
/// All problems of the scene: those of TOML's syntax if there are any, otherwise unknown keys, wrong types, missing keys, values
/// out of range and contradictions.
pub fn parse(text: &str, file: &str) -> Result<Scene, SceneErrors> {
    document::scene(text, file, &OwnNames::default(), &[])
}

/// Names of a user's own laws.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnNames<'a> {
    /// Hyperelastic laws.
    pub materials: Vec<&'a str>,
    /// Laws of friction.
    pub friction: Vec<&'a str>,
}

/// The scene as of [`parse`] for a program with laws of its own: `material = { law = "mine", ... }` with a name from `own_laws` is read as
/// a [`Material`] of that name, with any keys whose values are numbers or lists of numbers; so is `friction = { law = "mine", ... }` as
/// a [`Friction`] of that name. A name of the catalogue keeps its meaning.
///
/// # Errors
/// The errors of [`parse`].
pub fn parse_with(text: &str, file: &str, own_laws: &OwnNames<'_>) -> Result<Scene, SceneErrors> {
    document::scene(text, file, own_laws, &[])
}

/// The scene as of [`parse_with`], with other values for some parameters: names and expressions in the parameters, as in
/// `--set radius=2*width`. If a name occurs twice the last value is used.
///
/// # Errors
/// The errors of [`parse`]; a name that is no parameter of the scene is a problem of its table `[parameters]`.
pub fn parse_set(
    text: &str,
    file: &str,
    own_laws: &OwnNames<'_>,
    overrides: &[(String, String)],
) -> Result<Scene, SceneErrors> {
    document::scene(text, file, own_laws, overrides)
}
