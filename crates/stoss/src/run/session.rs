//! A run step by step, with its folder of results.

use super::{Event, RunError, RunOptions, Summary, load, plan_lines, scene_folder, scheme_name, watched_bodies};
use crate::build::{Built, Probe, Schedule};
use crate::diagnosis::{DiagnosedRun, Diagnosis};
use crate::exact_stick::CutsOfStick;
use crate::left_out;
use crate::output::{
    Description, FolderSettings, Outcome, ResultFolder, SceneIdentity, SystemWriter, UnitLabels, changed_by,
    contact_bodies, promises,
};
use crate::points::Points;
use crate::ranks::Ranks;
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use stoss_solver::{Simulation, SimulationError, Steered, StepRecord, digits};

/// A run between two of its steps. [`super::run_scene`] is one that nobody looks into. On several ranks each has one, with the same options; all call the same methods in the same order.
///
/// ```no_run
/// use stoss::run::{RunOptions, Session};
///
/// let options = RunOptions { out: "drop.out".into(), ..RunOptions::default() };
/// let mut session = Session::start("drop.toml".as_ref(), &options, &mut |_| {})?;
/// while let Some(record) = session.advance(&mut |_| {})? {
///     println!("{} {:?}", record.time, &session.simulation().state().q[..3]);
/// }
/// println!("{}", session.finish(&mut |_| {})?);
/// # Ok::<(), stoss::run::RunError>(())
/// ```
#[derive(Debug)]
pub struct Session {
    scene: Scene,
    place: PathBuf,
    options: RunOptions,
    simulation: Simulation,
    schedule: Schedule,
    probes: Vec<Probe>,
    /// Names of the bodies as the watch counts them.
    watched: Vec<String>,
    /// What the program sets, by the names that the options give.
    steered: BTreeMap<String, Steered>,
    folder: ResultFolder,
    systems: Option<SystemWriter>,
    cuts_of_stick: CutsOfStick,
    end: f64,
    /// Outcome of the change of stages after the last step: whether the run goes on. An error of it is told by the next step.
    change: Result<bool, SimulationError>,
    state: Progress,
}

/// Progress of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progress {
    /// A session in which there may be another step.
    Running,
    /// The flag [`RunOptions::stop`] was found raised.
    Interrupted,
    /// A session in which no step follows: the end, or the watch has stopped it.
    Done,
    /// The summary is written.
    Told,
}

impl Session {
    /// Reads and builds a scene, and opens its folder: nothing has been computed yet but the initial state.
    ///
    /// # Errors
    /// Any [`RunError`].
    pub fn start(path: &Path, options: &RunOptions, report: &mut dyn FnMut(Event<'_>)) -> Result<Self, RunError> {
        let (scene, mut built) = load(path, options)?;
        let watched = watched_bodies(&built);
        let end = options.until.unwrap_or(scene.time.end);
        if !(end.is_finite() && end > 0.0 && end <= scene.time.end) {
            return Err(RunError::Option(format!(
                "--until {end}: give a time above 0 and up to the scene's end {}",
                digits(scene.time.end)
            )));
        }
        for warning in &built.warnings {
            report(Event::Warning(warning));
        }
        let steered = steer(&scene, &mut built.simulation, &options.steered)?;
        let settings = settings(&scene, &built, &options.ranks)?;
        let is_one = options.ranks.count() == 1;
        let told = format!("{} {end} {} {:?}", settings.identity.hash(), options.resume, options.steered);
        if !is_one && !options.ranks.are_equal(told.as_bytes()) {
            let reason = "the ranks have read different scenes or mesh files, or were given different options: give all of them the same";
            return Err(RunError::Option(reason.to_owned()));
        }
        if !is_one && options.systems > 0 {
            let reason = "--systems: the matrices of several ranks are in parts; write those of a run on one rank";
            return Err(RunError::Option(reason.to_owned()));
        }
        let Built { mut simulation, schedule, probes, .. } = built;
        report(Event::Start {
            title: &scene.header.title,
            out: &options.out,
            end,
            step: scene.time.step,
            resumed: options.resume,
        });
        let folder = if options.resume {
            ResultFolder::resume(&options.out, settings, &mut simulation)?
        } else {
            ResultFolder::create(&options.out, options.overwrite, settings, &mut simulation)?
        };
        let systems = match options.systems {
            0 => None,
            count => Some(SystemWriter::attach(&options.out.join("systems"), count, &mut simulation)?),
        };
        let change = schedule.events(&mut simulation, &probes).and_then(|()| next_stage(&schedule, &mut simulation));
        Ok(Self {
            place: scene_folder(path).to_path_buf(),
            options: options.clone(),
            cuts_of_stick: CutsOfStick::default(),
            state: Progress::Running,
            scene,
            simulation,
            schedule,
            probes,
            watched,
            steered,
            folder,
            systems,
            end,
            change,
        })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The simulation after the last completed step.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Numbers of the points of the frames among the nodes of the model: all but directors of rigid bodies and beams, and what stands for the middle of a face.
    pub fn points(&self) -> Vec<u32> {
        Points::of(self.simulation.model()).into_nodes()
    }

    /// The scene's probes.
    pub fn probes(&self) -> &[Probe] {
        &self.probes
    }

    /// The present values of what is steered ([`RunOptions::steered`]): magnitudes of a load, displacements of a prescribed motion (a length each) and its angle in degrees.
    ///
    /// # Errors
    /// [`RunError::Option`] if nothing of this name is steered.
    pub fn steered_values(&self, name: &str) -> Result<Vec<f64>, RunError> {
        Ok(self.simulation.steered_values(self.steered(name)?, self.simulation.state().time))
    }

    /// Sets what is steered: it goes linearly from its present values to these, which it has at the time `until` (at the end of the next step without it), and stays there.
    ///
    /// # Errors
    /// [`RunError::Option`] if nothing of this name is steered, or the values do not fit ([`Simulation::lead`]).
    pub fn lead(&mut self, name: &str, values: &[f64], until: Option<f64>) -> Result<(), RunError> {
        let what = self.steered(name)?;
        let refused = |error: SimulationError| RunError::Option(format!("{name}: {error}"));
        self.simulation.lead(what, values, until).map_err(refused)
    }

    fn steered(&self, name: &str) -> Result<Steered, RunError> {
        let names = || self.steered.keys().cloned().collect::<Vec<_>>().join(", ");
        let known =
            || if self.steered.is_empty() { "nothing is".to_owned() } else { format!("steered are: {}", names()) };
        let unknown = || RunError::Option(format!("{name} is not steered; {}: name it before the run starts", known()));
        self.steered.get(name).copied().ok_or_else(unknown)
    }

    /// The time at which the run ends.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Does a step and writes what is due of it; nothing once the run has ended or [`RunOptions::stop`] is true.
    ///
    /// # Errors
    /// Any [`RunError`]. After [`RunError::Simulation`] the folder is complete, and there is no other step.
    pub fn advance(&mut self, report: &mut dyn FnMut(Event<'_>)) -> Result<Option<StepRecord>, RunError> {
        // The grid of steps is the scene's; stopping early only stops.
        if self.state != Progress::Running || self.simulation.state().time >= self.end * (1.0 - 1.0e-12) {
            return Ok(None);
        }
        // A signal reaches the ranks in different steps.
        if self.change.is_ok() && self.options.ranks.communicator().any(self.options.stop.load(Ordering::Relaxed)) {
            self.state = Progress::Interrupted;
            return Ok(None);
        }
        let goes_on = std::mem::replace(&mut self.change, Ok(true));
        if matches!(goes_on, Ok(false)) {
            self.state = Progress::Done;
            return Ok(None);
        }
        let record = match goes_on.and_then(|_| self.simulation.advance()) {
            Ok(record) => record,
            Err(source) => return Err(self.fail(source, report)?),
        };
        self.folder.write(&mut self.simulation, &record)?;
        self.cuts_of_stick.look(&self.scene, &mut self.simulation, &record);
        if let Some(systems) = &self.systems {
            systems.check()?;
        }
        let (extent, watched) = (self.folder.extent(), self.folder.worst());
        report(Event::Step { record: &record, end: self.end, extent, watched });
        if self.folder.must_stop() {
            self.state = Progress::Done;
        } else {
            let events = self.schedule.events(&mut self.simulation, &self.probes);
            self.change = events.and_then(|()| next_stage(&self.schedule, &mut self.simulation));
        }
        Ok(Some(record))
    }

    /// Ends the folder of a run whose step has failed.
    fn fail(&mut self, source: SimulationError, report: &mut dyn FnMut(Event<'_>)) -> Result<RunError, RunError> {
        self.state = Progress::Told;
        let (last_step, last_time) = (self.simulation.step(), self.simulation.state().time);
        let reason = source.to_string();
        let summary =
            self.tell(Outcome::Failed { reason: reason.clone(), last_step, last_time }, Some(reason), report)?;
        Ok(RunError::Simulation {
            source: Box::new(source),
            last_step,
            last_time,
            verdict: Box::new(summary.verdict),
            out: self.options.out.clone(),
        })
    }

    /// Ends the run after the last completed step: its last frame, a checkpoint and the summary; other runs may have the folder then. Before its end the outcome is
    /// [`Outcome::Interrupted`] if [`RunOptions::stop`] is the reason, else [`Outcome::Stopped`].
    ///
    /// # Errors
    /// Any [`RunError`].
    pub fn finish(&mut self, report: &mut dyn FnMut(Event<'_>)) -> Result<Summary, RunError> {
        let is_at_end = self.simulation.finished() && self.simulation.stage() as usize == self.schedule.len();
        let (last_step, last_time) = (self.simulation.step(), self.simulation.state().time);
        let outcome = match self.state {
            _ if is_at_end => Outcome::Completed,
            Progress::Interrupted => Outcome::Interrupted { last_step, last_time },
            _ => Outcome::Stopped { last_step, last_time },
        };
        self.state = Progress::Told;
        self.tell(outcome, None, report)
    }

    fn tell(
        &mut self,
        outcome: Outcome,
        error: Option<String>,
        report: &mut dyn FnMut(Event<'_>),
    ) -> Result<Summary, RunError> {
        self.folder.close(&self.simulation)?;
        let summary = self.folder.summarise(&self.simulation, outcome)?;
        // A cause is looked for of what happened in the run.
        let verdict = left_out::without(&summary.verdict);
        let (place, laws, watched) = (&self.place, &self.options.laws, self.watched.clone());
        let diagnosis =
            Diagnosis::of(&DiagnosedRun::new(&self.scene, place, laws, &self.simulation, watched, &verdict, error));
        let (ranks, out) = (&self.options.ranks, &self.options.out);
        let written = || {
            Diagnosis::remove(out)?;
            if diagnosis.is_worth_reading() { diagnosis.write(out) } else { Ok(()) }
        };
        ranks.agree(if ranks.is_first() { written() } else { Ok(()) })?;
        if diagnosis.is_worth_reading() {
            report(Event::Diagnosis(&diagnosis));
        }
        // The simulation can still be looked at; its folder is done.
        self.folder.release();
        Ok(summary)
    }
}

/// Lets loads and prescribed motions of these names be set.
fn steer(scene: &Scene, simulation: &mut Simulation, names: &[String]) -> Result<BTreeMap<String, Steered>, RunError> {
    let of_scene = scene
        .loads
        .iter()
        .map(|load| load.name.clone())
        .chain(scene.gravity.iter().map(|_| Some("gravity".to_owned())));
    let loads = of_scene.enumerate().map(|(l, name)| (name.unwrap_or_else(|| format!("load[{l}]")), Steered::Load(l)));
    let motions = simulation.model().prescriptions.iter().enumerate();
    let motions = motions.map(|(p, item)| (item.name.clone(), Steered::Prescription(p)));
    let known: BTreeMap<String, Steered> = loads.chain(motions).collect();
    let mut steered = BTreeMap::new();
    for name in names {
        let Some(&what) = known.get(name) else {
            let list = known.keys().cloned().collect::<Vec<_>>().join(", ");
            let list = if list.is_empty() { "the scene has none".to_owned() } else { format!("known are: {list}") };
            return Err(RunError::Option(format!(
                "{name} is no load and no prescribed motion that can be steered; {list}"
            )));
        };
        simulation.steer(what).map_err(|error| RunError::Option(format!("{name}: {error}")))?;
        steered.insert(name.clone(), what);
    }
    Ok(steered)
}

/// What the folder of a run has to know of its scene.
fn settings(scene: &Scene, built: &Built, ranks: &Ranks) -> Result<FolderSettings, RunError> {
    let Built { simulation, schedule, joints, probes, contacts, mesh_files, drawing, parts, .. } = built;
    let description = Description {
        plan: plan_lines(scene, built),
        file: scene.file().to_owned(),
        scene: scene.text().to_owned(),
        section: scene.header.section.map(|section| section.name().to_owned()),
        units: UnitLabels::new(scene, probes),
        ..Description::new(simulation.model(), drawing)
    };
    let identity = SceneIdentity::new(scene, mesh_files)
        .map_err(|error| RunError::Option(format!("the scene cannot be written as JSON: {error}")))?;
    Ok(FolderSettings {
        ranks: ranks.clone(),
        title: scene.header.title.clone(),
        description,
        identity,
        scheme: scheme_name(scene),
        frames: scene.output.frames(),
        format: scene.output.format,
        checkpoint_every: u64::from(scene.output.checkpoint_every),
        fields: scene.output.fields.clone(),
        probes: probes.clone(),
        scales: scene.expect.as_ref().map_or([None; 3], |expect| {
            let scales = [expect.linear_momentum_scale, expect.angular_momentum_scale, expect.energy_scale];
            scales.map(|scale| Some(scale? * built.extent))
        }),
        extent: built.extent,
        contact_bodies: contact_bodies(scene, drawing),
        parts: parts.clone(),
        promises: (1..=schedule.len() as u32)
            .map(|number| schedule.stage(number).and_then(|stage| promises(scene, simulation, stage.scheme.as_deref())))
            .collect(),
        changed_by: changed_by(scene, simulation.model()),
        contacts: contacts.clone(),
        watch: scene.watch.clone(),
        left_out: left_out::finding(scene),
        drawing: drawing.clone(),
        joints: joints.clone(),
        schedule: schedule.clone(),
    })
}

/// Begins the next stage at the end of one; false at the end of the last.
fn next_stage(schedule: &Schedule, simulation: &mut Simulation) -> Result<bool, SimulationError> {
    if simulation.finished() { schedule.advance(simulation) } else { Ok(true) }
}
