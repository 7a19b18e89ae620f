//! The way from a scene to a simulation: meshes, sets, laws, loads, contact. All problems are reported at once, at their places in
//! the scene's file.

#[cfg(feature = "nts")]
mod beside;
mod body;
mod condition;
#[cfg(any(feature = "nts", feature = "mortar"))]
mod contact;
mod drawing;
mod extreme;
mod fibres;
#[cfg(any(feature = "nts", feature = "mortar"))]
mod friction;
#[cfg(feature = "general")]
mod general;
pub(crate) mod general_schemes;
#[cfg(feature = "general")]
mod general_skin;
#[cfg(feature = "general")]
mod general_table;
#[cfg(feature = "general")]
mod interacting;
#[cfg(any(feature = "general", feature = "multibody"))]
mod joined;
mod law;
mod linear;
mod massless;
mod mesh_files;
#[cfg(any(feature = "nts", feature = "mortar"))]
mod methods;
#[cfg(not(any(feature = "nts", feature = "mortar")))]
mod missing;
#[cfg(feature = "mortar")]
mod mortar;
#[cfg(feature = "multibody")]
mod multibody;
#[cfg(not(feature = "multibody"))]
#[path = "no_multibody.rs"]
mod multibody;
#[cfg(feature = "nts")]
mod nts;
#[cfg(any(feature = "nts", feature = "mortar", feature = "general", feature = "multibody"))]
mod overlap;
#[cfg(any(feature = "nts", feature = "mortar"))]
mod pair;
#[cfg_attr(not(feature = "mortar"), allow(dead_code, reason = "for contacts and ties, which are not built in"))]
mod phase;
mod placed;
mod plan;
mod plausible;
mod probe;
#[cfg(any(feature = "nts", feature = "mortar"))]
mod reference_gap;
mod round;
mod schedule;
mod section;
#[cfg(feature = "general")]
mod separate;
mod sets;
mod sliding_support;
mod state_output;
mod supports;
mod symmetry;
mod tie;
mod trace;
mod unsupported;

#[cfg(any(feature = "nts", feature = "mortar"))]
use contact::contacts;
#[cfg(not(any(feature = "nts", feature = "mortar")))]
use missing::contacts;

pub use drawing::{Drawing, DrawnLine, DrawnPoint, DrawnSurface, Joined};
pub use extreme::Extreme;
pub use law::{FrictionLawResult, LawNameError, LawParameters, LawResult, OwnLaws, ParameterError};
pub use plan::{ContactPlan, FrictionPlan};
pub use probe::{Probe, ProbeTarget};
pub use schedule::Schedule;

use crate::ranks::Ranks;
use crate::scene::{InsideOut, Kind, Problem, Scene, SceneErrors};
use crate::solver::{FirstStage, InsideOutTreatment, Model, Settings, Simulation, Stage, StepControl};
#[cfg(feature = "output")]
pub(crate) use body::single_rows;
use mesh_files::MeshFiles;
pub(crate) use placed::Placed;
#[cfg(feature = "output")]
pub(crate) use plausible::{DENSITY, MODULUS};
use schedule::Named;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::Path;
use stoss_integrators::{SCHEMES, Scheme};
use stoss_linalg::LinearSolver;
use stoss_newton::{LineSearch, NewtonOptions};

/// A scene made ready to run.
#[derive(Debug)]
pub struct Built {
    /// The simulation at its initial state.
    pub simulation: Simulation,
    /// The scene's probes.
    pub probes: Vec<Probe>,
    /// What is no error but needs attention.
    pub warnings: Vec<String>,
    /// Contents of the mesh files, each once, for the hash of the run.
    pub mesh_files: Vec<Vec<u8>>,
    /// Names of all parts, as general contact counts bodies.
    pub parts: Vec<String>,
    /// One line a body: name, elements, law, implied moduli, quality.
    pub bodies: Vec<String>,
    /// One line an expression over sets: its numbers of nodes and of facets, and their area.
    pub sets: Vec<String>,
    /// Stages and events.
    pub schedule: Schedule,
    /// The joints in the order of the scene.
    pub joints: Vec<JointPlace>,
    /// What frames show beside the solids.
    pub drawing: Drawing,
    /// The contacts, with what the scene leaves to defaults.
    pub contacts: Vec<ContactPlan>,
    /// What is modelled of a scene of plane sections, in units of thickness or in radians: forces, areas, masses and energies of the simulation are those of the results times this. 1 without sections.
    pub extent: f64,
}

/// A joint of a scene in its model.
#[derive(Clone, Debug, PartialEq)]
pub struct JointPlace {
    /// Name of the joint.
    pub name: String,
    /// Place of the joint in the model's contacts.
    pub place: usize,
    /// Number of coordinates of the joint.
    pub coordinates: usize,
}

/// Problems found so far.
pub(crate) struct Problems<'a> {
    pub scene: &'a Scene,
    pub list: Vec<Problem>,
}

impl Problems<'_> {
    pub fn add(&mut self, key: String, value: impl Display, message: impl Into<String>, remedy: impl Into<String>) {
        self.list.push(Problem::at(self.scene, key, value, message, remedy));
    }
}

/// Builds the simulation of a scene; mesh files are sought relative to `folder`.
///
/// # Errors
/// Every problem that needs the meshes to be found: unreadable or bad meshes, parameters that are no material, unknown or
/// empty sets, components prescribed twice with different values, contact of a body with itself.
pub fn build(scene: &Scene, folder: &Path) -> Result<Built, SceneErrors> {
    build_with(scene, folder, &OwnLaws::default())
}

/// The model of a scene as of [`build`] with laws beside the catalogue, whose names the scene was parsed with ([`crate::scene::parse_with`]).
///
/// # Errors
/// The errors of [`build`].
pub fn build_with(scene: &Scene, folder: &Path, laws: &OwnLaws) -> Result<Built, SceneErrors> {
    build_on(scene, folder, laws, &Ranks::default())
}

/// The model of a scene as of [`build_with`] for a run on these ranks, all of which build the same scene.
///
/// # Errors
/// The errors of [`build`], on all ranks if on one.
pub fn build_on(scene: &Scene, folder: &Path, laws: &OwnLaws, ranks: &Ranks) -> Result<Built, SceneErrors> {
    if let Some(errors) = SceneErrors::new(unsupported::unsupported(scene).into_iter().collect(), scene.text()) {
        return Err(errors);
    }
    let mut problems = Problems { scene, list: Vec::new() };
    let mut model = Model::default();
    let mut mesh_files = MeshFiles::new(folder);
    let mut warnings = Vec::new();
    let (mut placed, mut bodies, section) =
        body::bodies(scene, laws, &mut model, &mut mesh_files, &mut problems, &mut warnings);
    let own_prescriptions = scene.prescriptions.len();
    let supports = [section::supports(scene, &placed), symmetry::supports(scene, &placed, &mut problems)].concat();
    let mut supported = Cow::Borrowed(scene);
    if !supports.is_empty() {
        supported.to_mut().prescriptions.extend(supports);
    }
    let scene = supported.as_ref();
    let mut parts = multibody::parts(scene, &mut model, &mut mesh_files, &mut problems);
    placed.append(&mut parts.placed);
    bodies.append(&mut parts.lines);
    let (mut probes, mut plans, mut names) = (Vec::new(), Vec::new(), BTreeMap::new());
    let mut set_lines = Vec::new();
    // Sets can be resolved only if every body has its mesh: otherwise missing sets would be reported for the wrong reason.
    section::tools(scene, &placed, &mut problems);
    if problems.list.is_empty() {
        set_lines = sets::add(scene, &mut placed, &mut problems);
    }
    if problems.list.is_empty() {
        multibody::fix(scene, &parts, &mut model);
        let rigid = |item: &crate::scene::Prescribe| multibody::prescribe_rigid(item, &parts);
        let (places, inclined) = condition::prescriptions(scene, &placed, &rigid, &mut model, &mut problems);
        let phases = phase::Phases::new(scene, &places);
        let mut ties = tie::ties(scene, &mut placed, &phases, &mut model, &mut problems, &mut warnings);
        #[cfg(feature = "general")]
        let apart =
            separate::separate(scene, &mut placed, &ties, phases.first(), &mut model, &mut problems, &mut bodies);
        massless::surfaces(scene, &placed, &phases, &mut model, &mut problems, &mut warnings);
        condition::loads(scene, &placed, section.extent(), &mut model, &mut problems);
        condition::gravity(scene, &mut model, &mut problems);
        plans = contacts(scene, &placed, laws, &ties, &phases, &mut model, &mut problems, &mut warnings);
        model.contacts.append(&mut ties.pairs);
        let inclined = section::without_tied(inclined, own_prescriptions, &ties.tied);
        let supports =
            sliding_support::add(scene, inclined, own_prescriptions, &places, &ties.tied, &mut model, &mut problems);
        parts.drawing.symmetry = symmetry::sides(scene, &placed);
        parts.drawing.extent = scene.header.section.map(|_| section.extent());
        #[cfg(any(feature = "general", feature = "multibody"))]
        parts.drawing.joined.extend(joined::surroundings(scene, &placed, &model.reference));
        let round = scene.bodies.iter().filter(|body| !body.round.is_empty());
        parts.drawing.round = round.map(|body| body.name.clone()).collect();
        #[cfg(feature = "general")]
        if apart {
            let joined = &mut parts.drawing.joined;
            plans.extend(general::general(
                scene,
                &placed,
                laws,
                &ties,
                joined,
                &mut model,
                &mut problems,
                &mut warnings,
            ));
        }
        multibody::constraints(scene, &placed, &phases, &mut parts, &mut model, &mut problems, &mut warnings);
        if problems.list.is_empty() {
            condition::moments(scene, |set, coupling| parts.reference_body(set, coupling), &mut model);
        }
        warnings.extend(plausible::warnings(scene, &model));
        warnings.extend(round::warnings(scene));
        warnings.extend(supports::warnings(scene, &placed, &model));
        warnings.extend(condition::warnings(scene));
        probes = probe::probes(scene, &placed, &parts, &model, section.extent(), &mut problems);
        state_output::check_fields(scene, &model, &mut problems);
        state_output::check_limit(scene, &model, &mut problems);
        warnings.extend(probe::warnings(scene, &placed, &probes));
        // Places in the model are known only if nothing was left out.
        if problems.list.is_empty() {
            let places = places.iter().enumerate().filter_map(|(p, place)| Some((p, Named::Prescription((*place)?))));
            names = named(scene, &places.chain(supports).collect(), &parts);
        }
    }
    let schedule = Schedule::new(scene, &names, &probes, &mut problems);
    let scheme = scheme(scene, &mut problems);
    general_schemes::check(scene, &placed, &mut problems, &mut warnings);
    let solver = linear::solver(&scene.solver, ranks);
    if let Err(error) = &solver {
        problems.add("solver.linear".into(), scene.solver.linear, error, "see docs/guide/clusters.md");
    }
    let list = &problems.list;
    let failed = (!list.is_empty()).then(|| list.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "));
    // A rank may be on a machine that lacks a mesh file.
    if let Some(text) = ranks.elsewhere(failed.as_ref().map(|text| text as &dyn Display)) {
        problems.add("scene".into(), "", text.to_string(), "give all machines the same files");
    }
    let solver = match (SceneErrors::new(problems.list, scene.text()), solver) {
        (Some(errors), _) => return Err(errors),
        (None, Ok(solver)) => solver,
        (None, Err(error)) => unreachable!("that there is no solver is a problem: {error}"),
    };
    let mut settings = settings(scene, scheme, solver);
    let mut first = FirstStage { later_dynamics: schedule.has_later_dynamics(), ..FirstStage::default() };
    if let Some(stage) = schedule.stage(1) {
        let Stage { step, end, automatic, newton, .. } = stage;
        settings.control = StepControl { step, end, automatic, ..settings.control };
        settings.newton = newton;
        settings.scheme = stage.scheme;
        first.stabilise = stage.stabilise;
        first.off = stage.off;
    }
    match Simulation::staged(model, settings, first) {
        Ok(simulation) => Ok(Built {
            simulation,
            schedule,
            probes,
            warnings,
            mesh_files: mesh_files.bytes,
            parts: placed.iter().map(|part| part.name.clone()).collect(),
            bodies,
            sets: set_lines,
            drawing: parts.drawing,
            joints: joints(scene, &parts.joints),
            contacts: plans,
            extent: section.extent(),
        }),
        Err(error) => {
            let remedy = "correct the scene; with several prescriptions, let each component of a node appear once";
            let problem = Problem::at(scene, "scene", "", error.to_string(), remedy);
            match SceneErrors::new(vec![problem], scene.text()) {
                Some(errors) => Err(errors),
                // cannot fail: the list has one entry.
                None => unreachable!("a list of one problem is not empty"),
            }
        }
    }
}

/// The parts of a scene that was built before, in their places and with the same numbers of nodes, for whoever wants to look at their sets.
#[cfg(feature = "output")]
pub(crate) fn placed_parts(scene: &Scene, folder: &Path, laws: &OwnLaws) -> Vec<Placed> {
    let mut problems = Problems { scene, list: Vec::new() };
    let (mut model, mut files) = (Model::default(), MeshFiles::new(folder));
    let (mut placed, ..) = body::bodies(scene, laws, &mut model, &mut files, &mut problems, &mut Vec::new());
    placed.append(&mut multibody::parts(scene, &mut model, &mut files, &mut problems).placed);
    placed
}

/// The parts as of [`placed_parts`], with the sets that the scene defines by expressions.
#[cfg(feature = "output")]
pub(crate) fn named_parts(scene: &Scene, folder: &Path, laws: &OwnLaws) -> Vec<Placed> {
    let mut placed = placed_parts(scene, folder, laws);
    sets::add(scene, &mut placed, &mut Problems { scene, list: Vec::new() });
    placed
}

/// What the names of a scene are in the model: loads and contacts as in the scene, prescriptions where they were put.
fn named(scene: &Scene, prescribed: &BTreeMap<usize, Named>, parts: &multibody::Parts) -> BTreeMap<String, Named> {
    let loads = scene.loads.iter().enumerate().filter_map(|(l, load)| Some((load.name.clone()?, Named::Load(l))));
    let prescriptions = scene.prescriptions.iter().enumerate();
    let prescriptions = prescriptions.filter_map(|(p, item)| Some((item.name.clone()?, *prescribed.get(&p)?)));
    let contacts = scene.contacts.iter().enumerate().map(|(c, item)| (item.label(), Named::Contact(c)));
    let joints = scene.joints.iter().zip(&parts.joints);
    let joints = joints.filter_map(|(item, place)| Some((item.name.clone(), Named::Contact((*place)?))));
    let equations = scene.equations.iter().zip(&parts.equations);
    let equations = equations.filter_map(|(item, place)| Some((item.name.clone(), Named::Contact((*place)?))));
    let springs = scene.springs.iter().zip(&parts.springs);
    let springs = springs.filter_map(|(item, place)| Some((item.name.clone(), Named::Part((*place)?))));
    let gravity = scene.gravity.iter().map(|_| ("gravity".to_owned(), Named::Load(scene.loads.len())));
    loads.chain(prescriptions).chain(contacts).chain(joints).chain(equations).chain(springs).chain(gravity).collect()
}

/// Joints by name and place in the model's contacts.
fn joints(scene: &Scene, places: &[Option<usize>]) -> Vec<JointPlace> {
    let joint = |(item, place): (&crate::scene::Joint, &Option<usize>)| {
        let coordinates = item.kind.coordinates.len();
        Some(JointPlace { name: item.name.clone(), place: (*place)?, coordinates })
    };
    scene.joints.iter().zip(places).filter_map(joint).collect()
}

/// The scheme of a dynamic scene, and whether it can do what the scene asks for.
fn scheme(scene: &Scene, problems: &mut Problems<'_>) -> Option<Box<dyn Scheme>> {
    let integrator = scene.time.integrator.as_ref()?;
    match integrator.make() {
        Ok(scheme) => {
            let free = scene.contacts.is_empty()
                && scene.ties.is_empty()
                && scene.joints.is_empty()
                && scene.couplings.is_empty()
                && scene.equations.is_empty()
                && scene.rigids.is_empty()
                && !scene.has_sliding_supports()
                && scene.beams.is_empty();
            if !(scheme.claims().constraints || free) {
                let constrained: Vec<&str> = SCHEMES
                    .iter()
                    .filter(|entry| entry.with([]).is_ok_and(|s| s.claims().constraints))
                    .map(|entry| entry.name)
                    .collect();
                problems.add(
                    "time.integrator.scheme".into(),
                    &integrator.scheme,
                    "does not support constraints, but the scene has contact, ties, joints, equations, rigid bodies, beams, or a prescribed motion along a normal that is no axis of space",
                    format!("choose one of {}, or remove them", constrained.join(", ")),
                );
            }
            Some(scheme)
        }
        Err(error) => {
            problems.add("time.integrator".into(), &integrator.scheme, error.to_string(), "see docs/guide/time.md");
            None
        }
    }
}

fn settings(scene: &Scene, scheme: Option<Box<dyn Scheme>>, linear: Box<dyn LinearSolver>) -> Settings {
    let solver = &scene.solver;
    Settings {
        control: StepControl {
            step: scene.time.step,
            end: scene.time.end,
            max_cuts: scene.time.max_cuts,
            grow_after: scene.time.grow_after,
            automatic: None,
        },
        scheme: match scene.header.kind {
            Kind::QuasiStatic => None,
            Kind::Dynamic => scheme,
        },
        newton: newton(scene, scene.header.kind),
        max_plastic_increment: scene.time.max_plastic_increment,
        inside_out: match solver.inside_out {
            InsideOut::Refuse => InsideOutTreatment::Refuse,
            InsideOut::Warn => InsideOutTreatment::Warn,
        },
        solver: linear,
    }
}

/// Newton's settings of stages of this kind.
fn newton(scene: &Scene, kind: Kind) -> NewtonOptions {
    let default = NewtonOptions::default();
    let solver = &scene.solver;
    let tolerance = solver.relative_tolerance.unwrap_or(DEFAULT_TOLERANCE);
    NewtonOptions {
        relative_tolerance: tolerance,
        absolute_tolerance: solver.absolute_tolerance.unwrap_or(default.absolute_tolerance),
        max_iterations: solver.max_iterations.unwrap_or(match general_contact(scene) {
            Some(_) => GENERAL_ITERATIONS,
            None => default.max_iterations,
        }),
        // Statics has no balances that add up step after step.
        polish: if solver.polish.unwrap_or(kind == Kind::Dynamic) { default.polish } else { 0 },
        line_search: match (kind, LineSearch::backtracking()) {
            (Kind::Dynamic, LineSearch::Backtracking { max_growth, reduction, max_reductions, .. }) => {
                LineSearch::Backtracking { max_growth, small: SMALL_RESIDUAL, reduction, max_reductions }
            }
            (_, search) => search,
        },
        ..default
    }
}

/// General contact of a scene, where it is built in.
pub(crate) fn general_contact(scene: &Scene) -> Option<crate::scene::GeneralContact> {
    scene.general_contact().filter(|_| cfg!(feature = "general"))
}

/// Relative residual at which Newton stops. In dynamics one more iteration follows if it still pays (`NewtonOptions::polish`), which
/// brings the residual to round-off: balances are exact only as far as the residual is.
pub const DEFAULT_TOLERANCE: f64 = 1.0e-9;

/// Residual of a dynamic step, in multiples of the scale, from which the line search lets any other grow tenfold.
const SMALL_RESIDUAL: f64 = 0.1;

/// Young's modulus of a deformable body at small strains; infinite for a rigid one.
#[cfg(any(feature = "nts", feature = "mortar", feature = "general"))]
fn young(model: &Model, body: usize) -> f64 {
    let modulus = |body: &crate::solver::Body| body.solid.law().small_strain_moduli().young_modulus();
    model.bodies.get(body).map_or(f64::INFINITY, modulus)
}

/// Iterations of a step with general contact: corners that slide past each other take many short ones, and a shorter step would take more altogether.
const GENERAL_ITERATIONS: u32 = 40;
