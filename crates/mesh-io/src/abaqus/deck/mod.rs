//! An Abaqus or CalculiX input file with everything besides the mesh: materials, steps, loads, contacts.
//!
//! [`read_deck`] keeps it as it stands: names, numbers, places, in the units of the file. Nothing is computed, no name is looked up, and what it
//! means for a scene is not decided here. What is not kept is listed in [`Deck::left_out`], keyword by keyword and parameter by parameter.
//!
//! | keyword | in the deck |
//! |---|---|
//! | `*HEADING` | [`Deck::title`] |
//! | `*MATERIAL` with `*DENSITY`, `*ELASTIC` (isotropic), `*HYPERELASTIC`, `*PLASTIC` (isotropic hardening, kinematic hardening of two points), `*VISCOELASTIC, TIME=PRONY`, `*MULLINS EFFECT`, `*DAMPING` (`ALPHA`, `BETA`) | [`Material`] |
//! | `*SOLID SECTION` | [`SolidSection`] |
//! | `*TRANSFORM` (rectangular and cylindrical) | [`LocalAxes`] |
//! | `*AMPLITUDE` (tabular) | [`Amplitude`] |
//! | `*SURFACE INTERACTION` with `*FRICTION`, `*SURFACE BEHAVIOR`; `*CONTACT PAIR`; `*TIE` | [`Interaction`], [`ContactPair`], [`Tie`] |
//! | `*INITIAL CONDITIONS, TYPE=VELOCITY` | [`InitialVelocity`] |
//! | `*BOUNDARY`, `*CLOAD`, `*DLOAD`, `*DSLOAD` | [`DeckBoundary`], [`Force`], [`ElementLoad`], [`SurfacePressure`] |
//! | `*EQUATION`, `*MPC` | [`Equation`], [`MultiPoint`] |
//! | `*COUPLING` with `*KINEMATIC`, `*DISTRIBUTING`; `*DISTRIBUTING COUPLING`, `*RIGID BODY` | [`Coupling`] |
//! | `*PRE-TENSION SECTION` | [`Pretension`] |
//! | `*ELEMENT` of springs, dashpots, masses; `*SPRING`, `*DASHPOT`, `*MASS` | [`Connection`], [`ConnectionSection`] |
//! | `*STEP` with `*STATIC`, `*DYNAMIC` | [`DeckStep`] |
//! | `*CHANGE FRICTION`, `*CHANGE SURFACE BEHAVIOR`, `*MODEL CHANGE, TYPE=CONTACT PAIR` | [`Change`] |

mod connected;
mod fill;
mod joined;
mod rows;
mod steps;

pub use connected::{
    Change, ChangeKind, Connection, ConnectionSection, Coupling, Equation, EquationTerm, Followers, Following,
    MultiPoint, Pretension,
};

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::Contents;
use crate::include::Include;
use crate::place::FileLocation;
use crate::{MeshIoError, include};

/// A line of one of the files of a deck.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct DeckPlace {
    /// The file: 0, or the number of an included one in [`Deck::files`].
    pub file: usize,
    /// The line, from 1.
    pub line: usize,
}

impl From<FileLocation> for DeckPlace {
    fn from(place: FileLocation) -> DeckPlace {
        DeckPlace { file: place.file as usize, line: place.at as usize }
    }
}

/// Nodes or elements that a line names.
#[derive(Debug, Clone, PartialEq)]
pub enum Target {
    /// A node or element by its number in the file, of an instance if one is named.
    Number {
        /// The number.
        number: u64,
        /// The instance.
        instance: Option<String>,
    },
    /// A set by its name, as written.
    Set(String),
    /// All nodes or elements: the name is left blank.
    All,
}

/// A material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name of the material.
    pub name: String,
    /// Mass per volume.
    pub density: Option<f64>,
    /// Elasticity of `*ELASTIC, TYPE=ISOTROPIC`.
    pub elastic: Option<Elastic>,
    /// Law of `*HYPERELASTIC`.
    pub hyperelastic: Option<Hyperelastic>,
    /// Lines of `*PLASTIC` at its first temperature: equivalent plastic strain and yield stress (force per area) of each line; nothing without it.
    pub plastic: Vec<[f64; 2]>,
    /// Whether its hardening is kinematic, with two lines at most; else it is isotropic.
    pub is_kinematic: bool,
    /// Lines of `*VISCOELASTIC, TIME=PRONY`: share of the shear modulus, share of the bulk modulus and relaxation time of each line; nothing without it.
    pub prony: Vec<[f64; 3]>,
    /// Whether the moduli of its elastic law are those of fast strains (`MODULI=INSTANTANEOUS`); else they are those of the relaxed material.
    pub is_instantaneous: bool,
    /// Parameters of `*MULLINS EFFECT`: r, m (energy per volume) and beta.
    pub mullins: Option<[f64; 3]>,
    /// Damping of `*DAMPING`.
    pub damping: Option<Damping>,
    /// Place of the material.
    pub place: DeckPlace,
}

/// Isotropic elasticity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus (force per area).
    pub modulus: f64,
    /// Poisson's ratio.
    pub ratio: f64,
}

/// Rayleigh damping.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Damping {
    /// `ALPHA`, of the mass (one over a time).
    pub alpha: f64,
    /// `BETA`, of the stiffness (a time).
    pub beta: f64,
}

/// Hyperelasticity with its coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Hyperelastic {
    /// The law in upper case without spaces: `NEOHOOKE`, `MOONEY-RIVLIN`, `YEOH`, `OGDEN`, ...; `POLYNOMIAL` if none is named.
    pub law: String,
    /// Number of terms (`N=`), 1 if it is not given.
    pub terms: usize,
    /// The numbers of its data lines in the order of the file.
    pub coefficients: Vec<f64>,
}

/// Which elements have which material.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidSection {
    /// The element set.
    pub elements: String,
    /// The material.
    pub material: String,
    /// The part that the section belongs to, if it is in one: the set is then one of its instances.
    pub part: Option<String>,
    /// The thickness of plane elements, a length, if it is given.
    pub thickness: Option<f64>,
    /// Place of the section.
    pub place: DeckPlace,
}

/// Nodes whose supports and forces have components in axes of their own (`*TRANSFORM`).
#[derive(Debug, Clone, PartialEq)]
pub struct LocalAxes {
    /// The node set.
    pub nodes: String,
    /// The axes; none of another kind than rectangular and cylindrical.
    pub axes: Option<Axes>,
    /// Place of the axes.
    pub place: DeckPlace,
}

/// Axes of `*TRANSFORM`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Axes {
    /// `TYPE=R`: the first axis along `a`, the second across it in the plane of `a` and `b`. Both have a length, and are not along one line.
    Rectangular {
        /// A vector along the first axis.
        a: [f64; 3],
        /// A vector in the plane of the first two axes.
        b: [f64; 3],
    },
    /// `TYPE=C`: of each node away from the line through two points, around it from the first point to the second, and along it.
    Cylindrical {
        /// A point of the line.
        a: [f64; 3],
        /// Another one.
        b: [f64; 3],
    },
}

/// A function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Amplitude {
    /// Name of the amplitude.
    pub name: String,
    /// True if its time begins with the first step, false if it begins with each step.
    pub is_total_time: bool,
    /// Times and values, linear in between.
    pub points: Vec<[f64; 2]>,
    /// Place of the amplitude.
    pub place: DeckPlace,
}

/// Properties of a contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Interaction {
    /// Name of the interaction.
    pub name: String,
    /// Friction of `*FRICTION`.
    pub friction: Option<Friction>,
    /// Pressure against overclosure of `*SURFACE BEHAVIOR`.
    pub behavior: Option<SurfaceBehavior>,
    /// Place of the interaction.
    pub place: DeckPlace,
}

/// Coulomb friction as a deck gives it (`*FRICTION`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Coefficient of friction; infinite for `ROUGH`.
    pub coefficient: f64,
    /// CalculiX' stick slope, the second number (force per volume).
    pub stick_slope: Option<f64>,
}

/// Pressure against overclosure.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceBehavior {
    /// `HARD`, `LINEAR`, `EXPONENTIAL`, `TABULAR`, `TIED`, ... in upper case.
    pub law: String,
    /// The numbers of its data lines.
    pub values: Vec<Vec<f64>>,
}

/// Two surfaces in contact.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPair {
    /// The slave surface (or node set).
    pub slave: String,
    /// The master surface; the slave again if none is named (contact of a surface with itself).
    pub master: String,
    /// The interaction.
    pub interaction: Option<String>,
    /// `NODE TO SURFACE`, `SURFACE TO SURFACE`, `MORTAR`, ... in upper case.
    pub kind: Option<String>,
    /// Value of `ADJUST=`: a distance or a set, as written.
    pub adjust: Option<String>,
    /// True with `SMALL SLIDING`.
    pub is_small_sliding: bool,
    /// Place of the pair.
    pub place: DeckPlace,
}

/// Two surfaces tied to each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// Name of the tie.
    pub name: Option<String>,
    /// The slave surface.
    pub slave: String,
    /// The master surface.
    pub master: String,
    /// Value of `POSITION TOLERANCE=` (a length).
    pub tolerance: Option<f64>,
    /// False with `ADJUST=NO`: nodes stay where they are.
    pub adjusts: bool,
    /// Place of the tie.
    pub place: DeckPlace,
}

/// A velocity at the beginning.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialVelocity {
    /// The nodes.
    pub nodes: Target,
    /// Component of the velocity: 0, 1, 2.
    pub component: usize,
    /// Value of the component.
    pub value: f64,
    /// Place of the velocity.
    pub place: DeckPlace,
}

/// What a support prescribes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prescribed {
    /// Displacements.
    Displacement,
    /// Velocities.
    Velocity,
    /// Accelerations.
    Acceleration,
    /// Positions at the start of the step, kept with `FIXED`.
    Fixed,
}

/// Prescribed displacements, or their rates, as a deck gives them (`*BOUNDARY`); not springs to the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct DeckBoundary {
    /// The nodes.
    pub nodes: Target,
    /// The degrees of freedom that are prescribed: three displacements, three rotations.
    pub freedoms: [bool; 6],
    /// What the value is.
    pub prescribed: Prescribed,
    /// The value, to be multiplied by the amplitude.
    pub value: f64,
    /// The amplitude.
    pub amplitude: Option<String>,
    /// Place of the support.
    pub place: DeckPlace,
}

/// A force or moment on each of some nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Force {
    /// The nodes.
    pub nodes: Target,
    /// Degree of freedom of the force: 0, 1, 2 of a force, 3, 4, 5 of a moment.
    pub freedom: usize,
    /// The value, to be multiplied by the amplitude.
    pub value: f64,
    /// The amplitude.
    pub amplitude: Option<String>,
    /// Place of the force.
    pub place: DeckPlace,
}

/// What acts on elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadKind {
    /// `P1` to `P6`: pressure on a face, counted from 0; positive pushes inwards.
    Pressure {
        /// The face, a row of [`stoss_reference_element::CellKind::faces`].
        face: usize,
        /// The pressure (force per area).
        value: f64,
    },
    /// `GRAV`: an acceleration.
    Gravity {
        /// Magnitude of the acceleration.
        magnitude: f64,
        /// Direction of the acceleration, of any length.
        direction: [f64; 3],
    },
    /// `CENTRIF`: the force of a rotation.
    Centrifugal {
        /// The square of the angular velocity.
        squared: f64,
        /// A point of the axis.
        point: [f64; 3],
        /// Direction of the axis.
        axis: [f64; 3],
    },
    /// `BX`, `BY`, `BZ`: a force per volume.
    Body {
        /// Component of the force: 0, 1, 2.
        component: usize,
        /// Value of the component.
        value: f64,
    },
}

/// A load on elements.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementLoad {
    /// The elements.
    pub elements: Target,
    /// What acts on them, to be multiplied by the amplitude.
    pub kind: LoadKind,
    /// The amplitude.
    pub amplitude: Option<String>,
    /// Place of the load.
    pub place: DeckPlace,
}

/// A pressure on a surface; positive pushes inwards.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePressure {
    /// The surface.
    pub surface: String,
    /// The pressure (force per area), to be multiplied by the amplitude.
    pub value: f64,
    /// The amplitude.
    pub amplitude: Option<String>,
    /// Place of the pressure.
    pub place: DeckPlace,
}

/// Times of a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Times {
    /// The first increment.
    pub initial: Option<f64>,
    /// The length of the step.
    pub period: Option<f64>,
    /// The smallest increment.
    pub smallest: Option<f64>,
    /// The largest increment.
    pub largest: Option<f64>,
    /// True with `DIRECT`: the increments are those given.
    pub is_fixed: bool,
}

/// What a step computes.
#[derive(Debug, Clone, PartialEq)]
pub enum Procedure {
    /// `*STATIC`.
    Static(Times),
    /// `*DYNAMIC`.
    Dynamic {
        /// Times of the step.
        times: Times,
        /// Value of `ALPHA=`: numerical damping.
        alpha: Option<f64>,
        /// True with `EXPLICIT`.
        is_explicit: bool,
    },
    /// Another keyword, in upper case, as `FREQUENCY`.
    Other(String),
}

/// A step of a deck (`*STEP`): procedure, supports, loads, and what it changes.
#[derive(Debug, Clone, PartialEq)]
pub struct DeckStep {
    /// Name of the step.
    pub name: Option<String>,
    /// True with `NLGEOM`: large displacements.
    pub is_nonlinear: bool,
    /// True with `PERTURBATION`.
    pub is_perturbation: bool,
    /// True with `AMPLITUDE=STEP`: loads without an amplitude act at once, else they grow over the step.
    pub is_sudden: bool,
    /// Value of `INC=`.
    pub increments: Option<u64>,
    /// What it computes; none if no keyword says so.
    pub procedure: Option<Procedure>,
    /// Supports.
    pub supports: Vec<DeckBoundary>,
    /// Forces on nodes.
    pub forces: Vec<Force>,
    /// Loads on elements.
    pub loads: Vec<ElementLoad>,
    /// Pressures on surfaces.
    pub pressures: Vec<SurfacePressure>,
    /// What it changes.
    pub changes: Vec<Change>,
    /// Which keywords of the step have `OP=NEW`.
    pub op_new: OpNew,
    /// Place of the step.
    pub place: DeckPlace,
}

/// Keywords of a step with `OP=NEW`, which ends what former steps said by the same keyword.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct OpNew {
    /// `*BOUNDARY, OP=NEW`: supports.
    pub supports: bool,
    /// `*CLOAD, OP=NEW`: forces on nodes.
    pub forces: bool,
    /// `*DLOAD, OP=NEW`: loads on elements.
    pub loads: bool,
    /// `*DSLOAD, OP=NEW`: pressures on surfaces.
    pub pressures: bool,
}

/// Something of the file that [`Deck`] does not keep.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOut {
    /// Name of what is left out, as "*PLASTIC", or "parameter ORIENTATION of *SOLID SECTION".
    pub what: String,
    /// False for what asks for output only.
    pub changes_results: bool,
    /// Place of what is left out.
    pub place: DeckPlace,
}

/// An input file. See the [module](self).
#[derive(Debug, Clone, Default)]
pub struct Deck {
    /// The mesh and its sets.
    pub contents: Contents,
    /// The first line of the heading.
    pub title: Option<String>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Sections.
    pub sections: Vec<SolidSection>,
    /// Nodes with axes of their own. Those without [`LocalAxes::axes`] are in [`Deck::left_out`], too.
    pub local_axes: Vec<LocalAxes>,
    /// Amplitudes.
    pub amplitudes: Vec<Amplitude>,
    /// Properties of contacts.
    pub interactions: Vec<Interaction>,
    /// Contacts.
    pub pairs: Vec<ContactPair>,
    /// Ties.
    pub ties: Vec<Tie>,
    /// Nodes of the assembly: number and place.
    pub reference_nodes: Vec<(u64, [f64; 3])>,
    /// Sets of these nodes, by their names in upper case.
    pub reference_sets: BTreeMap<String, Vec<u64>>,
    /// Equations between degrees of freedom.
    pub equations: Vec<Equation>,
    /// Multi-point constraints with a law of their own.
    pub multi_points: Vec<MultiPoint>,
    /// Nodes that follow a reference node.
    pub couplings: Vec<Coupling>,
    /// Sections of bolts that are tightened.
    pub pretensions: Vec<Pretension>,
    /// Springs, dashpots, masses and beams outside of parts.
    pub connections: Vec<Connection>,
    /// What they are.
    pub sections_of_connections: Vec<ConnectionSection>,
    /// Whether a material has thermal strains: an `*EXPANSION` that is not zero.
    pub expands: bool,
    /// Velocities at the beginning.
    pub velocities: Vec<InitialVelocity>,
    /// Supports of all steps.
    pub supports: Vec<DeckBoundary>,
    /// Steps in their order.
    pub steps: Vec<DeckStep>,
    /// What is not kept, in the order of the file.
    pub left_out: Vec<LeftOut>,
}

impl Deck {
    /// The file and those that it includes.
    pub fn files(&self) -> &[PathBuf] {
        &self.contents.files
    }

    /// "part.inp:12".
    pub fn place_name(&self, place: DeckPlace) -> String {
        let file = self.files().get(place.file).map_or_else(|| self.contents.path(), PathBuf::as_path);
        format!("{}:{}", file.display(), place.line)
    }
}

/// Reads an input file with everything besides the mesh.
///
/// # Errors
/// The errors of [`crate::read_contents`]; also numbers and names of materials, steps and so on that are missing or no numbers.
pub fn read_deck(path: impl AsRef<Path>) -> Result<Deck, MeshIoError> {
    let path = path.as_ref();
    let bytes = include::regular(path).map_err(|source| MeshIoError::Io { path: path.to_owned(), source })?;
    read_deck_from_bytes(path, &bytes, &mut include::regular)
}

/// [`read_deck`] for bytes in memory; `path` is used in messages, `include` gives the files that the file includes.
///
/// # Errors
/// The errors of [`read_deck`].
pub fn read_deck_from_bytes(path: impl AsRef<Path>, bytes: &[u8], include: Include<'_>) -> Result<Deck, MeshIoError> {
    let path = path.as_ref();
    let (contents, blocks) =
        super::reader::Reader::new(path, include).keeping_blocks().read(path, &String::from_utf8_lossy(bytes))?;
    fill::deck(contents, &blocks)
}
