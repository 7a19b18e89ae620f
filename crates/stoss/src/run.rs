//! Runs a scene file into a folder; checks a scene file. What the program `stoss` does, for programs.

mod estimate;
mod session;

use crate::build::{Built, OwnLaws, build_on};
use crate::diagnosis::{Cause, Confidence, DiagnosedRun, Diagnosis};
use crate::left_out;
#[cfg(doc)]
use crate::output::Outcome;
use crate::output::{Overwrite, Watched, judge_start};
use crate::ranks::Ranks;
use crate::scene::{LinearSolver, Scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use stoss_linalg::AutoSolver;
use stoss_solver::{Plan, StepRecord, digits};

pub use crate::error::RunError;
pub use crate::output::{Summary, judge_folder};
pub use session::Session;

/// Options of a run.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// Folder of the results.
    pub out: PathBuf,
    /// Stop at this time instead of the scene's end.
    pub until: Option<f64>,
    /// Continue from the checkpoint in the folder.
    pub resume: bool,
    /// Laws beside the catalogue that the scene may name.
    pub laws: OwnLaws,
    /// Writes so many linear systems, the first ones that are factorised, into the folder `systems` of the results
    /// ([`stoss_linalg::matrix_market`]). Zero: none.
    pub systems: u32,
    /// Which files in the folder a new run replaces.
    pub overwrite: Overwrite,
    /// Parameters of the scene with other values than it gives: names and expressions.
    pub set: Vec<(String, String)>,
    /// Loads and prescribed motions that the program sets between steps ([`Session::lead`]), by their names in the scene, or `load[0]`, `prescribe[1]` of those that have none.
    pub steered: Vec<String>,
    /// The ranks that run the scene together, each with the same options: the first one writes.
    pub ranks: Ranks,
    /// Once true, the run ends after the step that it is doing, with a checkpoint, and its outcome is [`Outcome::Interrupted`].
    pub stop: Arc<AtomicBool>,
}

/// What happens during a run.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// The run begins.
    Start {
        /// Title of the scene.
        title: &'a str,
        /// Folder of the results.
        out: &'a Path,
        /// End time.
        end: f64,
        /// Nominal step.
        step: f64,
        /// Whether it continues from a checkpoint.
        resumed: bool,
    },
    /// A warning: no error, but it needs attention.
    Warning(&'a str),
    /// A step was completed.
    Step {
        /// Record of the step.
        record: &'a StepRecord,
        /// End time.
        end: f64,
        /// What sums over the model are divided by ([`crate::build::Built::extent`]).
        extent: f64,
        /// The worst drift and the deepest penetration so far.
        watched: Watched,
    },
    /// The run stopped or came out wrong, and this is why; it is in the folder, too.
    Diagnosis(&'a Diagnosis),
}

/// Sets the number of threads of all element loops of this process. Results do not depend on it.
///
/// # Errors
/// If the pool was started before.
pub fn set_threads(threads: usize) -> Result<(), String> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(|e| e.to_string())
}

/// Text of a scene file.
pub(crate) fn read_text(path: &Path) -> Result<String, RunError> {
    let bytes = crate::regular::read(path).map_err(|source| RunError::Read { path: path.to_path_buf(), source })?;
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..good].iter().filter(|&&byte| byte == b'\n').count();
        RunError::Encoding { path: path.to_path_buf(), line }
    })
}

pub(crate) fn load(path: &Path, options: &RunOptions) -> Result<(Scene, Built), RunError> {
    let RunOptions { laws, set, ranks, .. } = options;
    let text = ranks.agree(read_text(path))?;
    let scene = crate::scene::parse_set(&text, &path.display().to_string(), &laws.names(), set);
    let scene = ranks.agree(scene.map_err(RunError::Scene))?;
    let mut built = build_on(&scene, scene_folder(path), laws, ranks).map_err(RunError::Scene)?;
    built.warnings.extend(left_out::warnings(&scene));
    Ok((scene, built))
}

fn scheme_name(scene: &Scene) -> String {
    // That of [time], or of the first stage that has one.
    let schemes = scene.time.integrator.iter().chain(scene.stages.iter().filter_map(|stage| stage.integrator.as_ref()));
    match schemes.into_iter().next().filter(|_| scene.is_dynamic()) {
        Some(integrator) => integrator.scheme.clone(),
        None => "quasi-static".to_owned(),
    }
}

/// Runs a scene file.
///
/// # Errors
/// Any [`RunError`]. After [`RunError::Simulation`] the folder holds every completed step, a summary that names the reason, and a
/// checkpoint of the last good state.
pub fn run_scene(path: &Path, options: &RunOptions, report: &mut dyn FnMut(Event<'_>)) -> Result<Summary, RunError> {
    let mut session = Session::start(path, options, report)?;
    while session.advance(report)?.is_some() {}
    session.finish(report)
}

/// The folder that mesh files of a scene are sought in.
pub(crate) fn scene_folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new("."))
}

/// Names of the bodies as the watch counts them.
fn watched_bodies(built: &Built) -> Vec<String> {
    let solids = built.simulation.model().bodies.iter().map(|body| body.solid.name().to_owned());
    solids.chain(built.drawing.surfaces.iter().map(|surface| surface.name.clone())).collect()
}

/// Looks for causes in a scene that has not run.
///
/// # Errors
/// The errors of [`check_scene`].
pub fn diagnose_scene(path: &Path, options: &RunOptions) -> Result<Diagnosis, RunError> {
    let (scene, built) = load(path, options)?;
    diagnose_start(path, options, &scene, &built)
}

fn diagnose_start(path: &Path, options: &RunOptions, scene: &Scene, built: &Built) -> Result<Diagnosis, RunError> {
    let start = judge_start(&built.simulation, scene, &built.drawing)?;
    let watched = watched_bodies(built);
    let folder = scene_folder(path);
    Ok(Diagnosis::of(&DiagnosedRun::new(scene, folder, &options.laws, &built.simulation, watched, &start, None)))
}

/// Numbers of pressures, further unknowns of contact and tie multipliers that there may be, in words.
fn constraint_unknowns(built: &Built, slots: usize) -> String {
    let pressures: u64 = built.contacts.iter().map(|contact| contact.slots * contact.unknowns_per_slot.min(1)).sum();
    let all: u64 = built.contacts.iter().map(|contact| contact.slots * contact.unknowns_per_slot).sum();
    let mut text = format!(", up to {pressures} contact pressures");
    if all > pressures {
        text += &format!(" and {} further unknowns of contact", all - pressures);
    }
    let ties = slots as u64 - pressures;
    if ties > 0 {
        text += &format!(", {ties} multipliers of ties, joints and rigidity");
    }
    text
}

/// The plan of a run, for people.
#[derive(Clone, Debug)]
pub struct PlanReport {
    lines: Vec<String>,
    plan: Plan,
}

impl PlanReport {
    /// A line with the memory that a run on so many ranks would need and the bytes that a rank would receive: an estimate.
    pub fn on_ranks(&self, ranks: u32) -> String {
        estimate::on_ranks(&self.plan, ranks)
    }
}

impl std::fmt::Display for PlanReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.lines.join("\n"))
    }
}

/// Checks a scene file and says what a run would use.
///
/// # Errors
/// All problems of the scene at once.
pub fn check_scene(path: &Path) -> Result<PlanReport, RunError> {
    check_scene_with(path, &OwnLaws::default())
}

/// The plan of a scene as of [`check_scene`] for a program with laws of its own.
///
/// # Errors
/// The errors of [`check_scene`].
pub fn check_scene_with(path: &Path, laws: &OwnLaws) -> Result<PlanReport, RunError> {
    check_scene_for(path, &RunOptions { laws: laws.clone(), ..RunOptions::default() })
}

/// The plan of a scene as of [`check_scene`] for a run with these options, of which laws and parameters are used.
///
/// # Errors
/// The errors of [`check_scene`].
pub fn check_scene_for(path: &Path, options: &RunOptions) -> Result<PlanReport, RunError> {
    let (scene, built) = load(path, options)?;
    Ok(PlanReport { lines: report_lines(path, options, &scene, &built)?, plan: built.simulation.plan() })
}

/// The plan of a scene that was built, and what is to be said about it.
pub(crate) fn report_lines(
    path: &Path,
    options: &RunOptions,
    scene: &Scene,
    built: &Built,
) -> Result<Vec<String>, RunError> {
    let mut lines = plan_lines(scene, built);
    lines.extend(left_out::notes(scene).into_iter().map(|note| format!("  {note}")));
    lines.extend(built.warnings.iter().map(|w| format!("  warning: {w}")));
    let start = judge_start(&built.simulation, scene, &built.drawing)?;
    lines.extend(start.reasons.iter().map(|found| format!("  warning: {}", found.sentence)));
    // Densities that are unusual in the units of the scene, and all other causes, have warnings of their own.
    let told = built.warnings.iter().any(|warning| warning.contains(crate::build::DENSITY.noun));
    for found in diagnose_start(path, options, scene, built)?.findings {
        if found.cause == Cause::Density && found.confidence >= Confidence::Medium && !told {
            let remedy = found.remedies.first().map(|remedy| format!("; {}", remedy.text)).unwrap_or_default();
            lines.push(format!("  warning: {}{remedy}", found.sentence));
        }
    }
    lines.push(match left_out::count(scene) {
        0 => "no problems found".to_owned(),
        n => format!(
            "the scene can run, but lacks {n} {} that its deck has ([[left_out]], severity \"missing\"): the verdict of a run is at best doubtful",
            if n == 1 { "thing" } else { "things" }
        ),
    });
    Ok(lines)
}

/// Whether PETSc iterates on a system of so many equations of nodes and so many others (`stoss_linalg_petsc::Method`).
fn iterates_in_petsc(scene: &Scene, equations: usize, others: usize) -> bool {
    others == 0
        && match scene.solver.petsc.as_deref() {
            None => equations >= AutoSolver::ITERATIVE,
            Some(choice) => choice == "multigrid",
        }
}

/// Whether systems of a run are solved by iteration: without multipliers, and with all that may be.
fn iterates(choice: LinearSolver, scene: &Scene, plan: &Plan) -> [bool; 2] {
    let other = plan.free_components - plan.elastic_components;
    [0, plan.slots].map(|slots| match choice {
        LinearSolver::Auto | LinearSolver::Iterative => {
            let prefers = choice == LinearSolver::Iterative;
            AutoSolver::iterates_on(prefers, plan.free_components + slots, other + slots)
        }
        LinearSolver::Multifrontal | LinearSolver::Faer => false,
        LinearSolver::Petsc => iterates_in_petsc(scene, plan.free_components, other + slots),
    })
}

/// The linear solver of a run, in words.
fn linear_solver(choice: LinearSolver, scene: &Scene, plan: &Plan) -> &'static str {
    match (choice, iterates(choice, scene, plan)) {
        (LinearSolver::Faer, _) => "factorisation by faer",
        (LinearSolver::Petsc, _) if scene.solver.petsc.as_ref().is_some_and(|text| text.starts_with('-')) => {
            "PETSc, with the options of the scene"
        }
        (LinearSolver::Petsc, [true, true]) => "multigrid of PETSc; what it cannot solve is factorised by MUMPS",
        (LinearSolver::Petsc, [true, false]) => {
            "multigrid of PETSc while no multipliers have equations; factorisation by MUMPS else"
        }
        (LinearSolver::Petsc, _) => "factorisation by MUMPS, through PETSc",
        (_, [true, true]) => "iteration with smoothed aggregation; what it cannot solve is factorised",
        (_, [true, false]) => {
            "iteration with smoothed aggregation while few multipliers have equations; multifrontal factorisation else"
        }
        (LinearSolver::Auto, _) if plan.free_components + plan.slots <= AutoSolver::DENSE_LIMIT => {
            "dense factorisation"
        }
        _ => "multifrontal factorisation",
    }
}

/// Bytes of the linear solver, roughly.
fn solver_memory(choice: LinearSolver, scene: &Scene, plan: &Plan) -> f64 {
    let entries = plan.matrix_entries as f64;
    if iterates(choice, scene, plan) == [true; 2] {
        // Blocks in both precisions, the prolongation and its transpose, some vectors.
        return 16.0 * entries;
    }
    // Factors of hexahedral meshes fill in about fifteen to sixty times; the estimate says the order of magnitude.
    20.0 * (plan.free_components as f64 / 3000.0).max(0.3).powf(0.33) * entries * 12.0
}

/// What a run uses: bodies, contacts, unknowns, time stepping, memory.
fn plan_lines(scene: &Scene, built: &Built) -> Vec<String> {
    let plan = built.simulation.plan();
    // On several ranks it is what `auto` means.
    let choice = match built.simulation.solver_name() {
        "petsc" => LinearSolver::Petsc,
        _ => scene.solver.linear,
    };
    let mut lines = vec![format!("{}: {}", scene.file(), scene.header.title)];
    lines.extend(built.bodies.iter().map(|line| format!("  body {line}")));
    lines.extend(built.sets.iter().map(|line| format!("  set {line}")));
    lines.extend(built.contacts.iter().map(|contact| format!("  contact {contact}")));
    for joint in &scene.joints {
        let [a, b] = &joint.between;
        lines.push(format!("  joint {}: {} between {a} and {b}", joint.name, joint.kind));
    }
    for tie in &scene.ties {
        lines.push(format!("  tie {}: {} form, {} multipliers", tie.label(), tie.form, tie.multipliers));
    }
    lines.push(format!(
        "  unknowns: {} free and {} prescribed displacement components{}",
        plan.free_components,
        plan.prescribed_components,
        constraint_unknowns(built, plan.slots)
    ));
    lines.push(format!("  matrix: {} entries without contact", plan.matrix_entries));
    let used = |yes: bool| if yes { "used" } else { "not used, not built" };
    lines.push(format!(
        "  time stepping: {}; mass matrix: {}; contact search and pressure rows: {}; prescribed motion: {}; loads: {}",
        scheme_name(scene),
        used(plan.mass_matrix),
        used(plan.contact_search),
        used(plan.prescribed_components > 0),
        used(!scene.loads.is_empty() || scene.gravity.is_some()),
    ));
    lines.push(format!("  linear solver: {}", linear_solver(choice, scene, &plan)));
    lines.push(format!(
        "  memory: {:.1} MB held, about {:.0} MB with the linear solver (estimate)",
        plan.memory_bytes as f64 / 1e6,
        (plan.memory_bytes as f64 + solver_memory(choice, scene, &plan)) / 1e6
    ));
    let steps = built.schedule.nominal_steps();
    if scene.stages.is_empty() {
        lines.push(format!("  steps: {steps} of {} to t = {}", digits(scene.time.step), digits(scene.time.end)));
    } else {
        lines.push(format!("  steps: {steps} in {} stages to t = {}", scene.stages.len(), digits(scene.time.end)));
    }
    lines
}
