//! Writes a run into a folder.

use super::drift::Drifts;
use super::earlier::{self, Overwrite};
use super::identity::SceneIdentity;
use super::lock::FolderLock;
use super::means::Means;
use super::rows::{PROBES, Tables};
use super::settings::FolderSettings;
use super::table::CsvTable;
use super::watch::{self, RunWatch, Watched};
use super::{Memory, Outcome, OutputError, RankSummary, Summary, WatchSummary, frames};
use crate::error::RunError;
use crate::ranks::Ranks;
use crate::scene::OnFault;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use stoss_linalg::Traffic;
use stoss_solver::{
    Checkpoint, CheckpointError, DecisionKind, PhaseTime, Simulation, SimulationError, StepRecord, Table,
};

/// Attachment of a checkpoint that says of which scene it is.
const IDENTITY: &str = "scene";

/// Attachment of a checkpoint: what was set while the run went on.
const STEERED: &str = "steered";

/// What the folder remembers in a checkpoint.
#[derive(Debug, Serialize, Deserialize)]
struct Memo {
    lengths: BTreeMap<String, u64>,
    frames: frames::Log,
    drifts: Drifts,
    /// Stage of the last step.
    stage: u32,
    iterations: u64,
    max_iterations: u64,
    max_equations: u64,
    /// Frictional work so far of each contact of the model.
    friction_work: Vec<f64>,
    /// General contact since the last frame.
    means: Means,
}

/// An open folder of results. Of several ranks all have one and call the same methods in the same order, for what is written is made of what each of them has; the first one writes. An error of one is
/// returned on all.
#[derive(Debug)]
pub struct ResultFolder {
    path: PathBuf,
    settings: FolderSettings,
    memo: Memo,
    tables: Tables,
    watch: RunWatch,
    watched: CsvTable,
    started: Instant,
    cpu: cpu_time::ProcessTime,
    /// Lock of the folder; none once another run may have the folder, and on ranks that do not write.
    lock: Option<FolderLock>,
    /// What could not be written, until the other ranks know of it.
    unwritten: Option<OutputError>,
}

impl ResultFolder {
    /// Creates the folder (replacing the results of an earlier run, and more if `overwrite` allows it) and writes the initial state.
    ///
    /// # Errors
    /// [`OutputError`]; [`OutputError::NotOurs`], before anything is touched, if a file in the folder has the name of one of ours but
    /// was not written by this program.
    pub fn create(
        path: &Path,
        overwrite: Overwrite,
        settings: FolderSettings,
        simulation: &mut Simulation,
    ) -> Result<Self, OutputError> {
        let ranks = settings.ranks.clone();
        let memo = Memo {
            lengths: BTreeMap::new(),
            frames: frames::Log::new(settings.format),
            drifts: Drifts::start(simulation.balance()),
            stage: simulation.stage(),
            iterations: 0,
            max_iterations: 0,
            max_equations: simulation.equations() as u64,
            friction_work: vec![0.0; simulation.model().contacts.len()],
            means: Means::default(),
        };
        let watch = watch_of(&settings, simulation)?;
        let opened = || {
            if !ranks.is_first() {
                return Self::open(path, settings, simulation, memo, watch, None, |_, _| Ok(CsvTable::nowhere()));
            }
            let lock = FolderLock::take(path)?;
            earlier::remove(path, overwrite)?;
            let open = |name: &str, header: &str| CsvTable::create(&path.join(name), header);
            let folder = Self::open(path, settings, simulation, memo, watch, Some(lock), open)?;
            folder.memo.frames.remove_others(path)?;
            folder.watch.write_file(path)?;
            folder.settings.description.write(path)?;
            Ok(folder)
        };
        let mut folder: Self = ranks.agree(opened())?;
        let record = simulation.initial_record();
        folder.write(simulation, &record)?;
        // A run that is killed before its first regular checkpoint can be resumed from the start.
        folder.checkpoint(simulation)?;
        folder.summarise(simulation, Outcome::Running)?;
        Ok(folder)
    }

    /// Continues a folder from its checkpoint: restores the simulation and cuts tables and frames back.
    ///
    /// # Errors
    /// [`OutputError`]; the checkpoint's own error if it is missing, damaged or of another scene.
    pub fn resume(path: &Path, settings: FolderSettings, simulation: &mut Simulation) -> Result<Self, RunError> {
        let file = path.join("checkpoint");
        let ranks = settings.ranks.clone();
        let (lock, bytes) = ranks.agree(if ranks.is_first() { read(path, &file) } else { Ok((None, Vec::new())) })?;
        let checkpoint = Checkpoint::from_bytes(&ranks.of_first(bytes), &file).map_err(OutputError::from)?;
        let before = checkpoint.attachments.get(IDENTITY).and_then(|bytes| serde_json::from_slice(bytes).ok());
        let changes = before.map(|before: SceneIdentity| settings.identity.changes(&before)).unwrap_or_default();
        if !changes.is_empty() {
            let reason = format!(
                "the scene has changed since it was written ({changes}); undo the changes, or run without --resume"
            );
            return Err(RunError::Resume { path: file, reason });
        }
        let tag = settings.identity.hash();
        // The loads of the state that is restored are what was set.
        let steered = checkpoint.attachments.get(STEERED).map(|bytes| serde_json::from_slice::<Vec<Table>>(bytes));
        let steered = steered.transpose().ok().flatten().unwrap_or_default();
        let unlike = |e: SimulationError| RunError::Resume { path: file.clone(), reason: e.to_string() };
        simulation.restore_steered(&steered).map_err(unlike)?;
        // A new simulation is in the first stage.
        let stage = settings.schedule.stage(checkpoint.stage.number).filter(|_| checkpoint.stage.number > 1);
        let restored = match stage {
            Some(stage) => simulation.restore_in(stage, checkpoint, &tag),
            None => simulation.restore(checkpoint, &tag),
        };
        let attachments = restored.map_err(|e| RunError::Resume { path: file.clone(), reason: e.to_string() })?;
        let damaged = |reason: String| OutputError::Damaged { path: file.clone(), reason };
        let bytes = attachments.get("folder").ok_or_else(|| damaged("it was not written by this program".into()))?;
        let memo: Memo = serde_json::from_slice(bytes).map_err(|e| damaged(e.to_string()))?;
        memo.frames.keep_format(settings.format).map_err(|reason| RunError::Resume { path: file.clone(), reason })?;
        let mut watch = watch_of(&settings, simulation)?;
        let [judged, positions] = ["watch", "watch-positions"].map(|name| attachments.get(name).map(Vec::as_slice));
        let (judged, positions) = (judged.unwrap_or_default(), positions.unwrap_or_default());
        watch.load(judged, positions, &simulation.state().q).map_err(damaged)?;
        let opened = || {
            if !ranks.is_first() {
                return Self::open(path, settings, simulation, memo, watch, None, |_, _| Ok(CsvTable::nowhere()));
            }
            let lengths = memo.lengths.clone();
            let table_of_probes = path.join(PROBES);
            let open = |name: &str, header: &str| match lengths.get(name) {
                Some(&length) if name == PROBES => CsvTable::resume_as(&table_of_probes, length, header),
                Some(&length) => CsvTable::resume(&path.join(name), length),
                None if name == PROBES => CsvTable::create(&table_of_probes, header),
                None => Err(damaged(format!("{name} is not in it"))),
            };
            let mut folder = Self::open(path, settings, simulation, memo, watch, lock, open)?;
            if !folder.tables.has_probes() && folder.memo.lengths.remove(PROBES).is_some() {
                std::fs::remove_file(&table_of_probes).map_err(OutputError::io(&table_of_probes))?;
            }
            folder.memo.frames.check(path)?;
            folder.memo.frames.remove_others(path)?;
            folder.settings.description.write(path)?;
            folder.memo.frames.write_collection(path)?;
            // The tables may have been written again, with other columns.
            folder.flush()?;
            Ok(folder)
        };
        let mut folder: Self = ranks.agree(opened())?;
        folder.checkpoint(simulation)?;
        Ok(folder)
    }

    fn open(
        path: &Path,
        settings: FolderSettings,
        simulation: &Simulation,
        memo: Memo,
        watch: RunWatch,
        lock: Option<FolderLock>,
        open: impl Fn(&str, &str) -> Result<CsvTable, OutputError>,
    ) -> Result<Self, OutputError> {
        Ok(Self {
            tables: Tables::open(&settings, simulation, &open)?,
            watch,
            watched: open(watch::TABLE, watch::COLUMNS)?,
            path: path.to_path_buf(),
            settings,
            memo,
            started: Instant::now(),
            cpu: cpu_time::ProcessTime::now(),
            lock,
            unwritten: None,
        })
    }

    /// Writes something if this is the rank that writes and nothing has failed before. The other ranks go on meanwhile, and so does this one: [`Self::agree`] tells all of a failure.
    fn put(&mut self, write: impl FnOnce(&mut Self) -> Result<(), OutputError>) {
        if self.settings.ranks.is_first() && self.unwritten.is_none() {
            self.unwritten = write(self).err();
        }
    }

    /// What could not be written, on all ranks.
    fn agree(&mut self) -> Result<(), OutputError> {
        let written = self.unwritten.take().map_or(Ok(()), Err);
        self.settings.ranks.agree(written)
    }

    /// Writes a completed step: its rows, a frame and a checkpoint if they are due.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write(&mut self, simulation: &mut Simulation, record: &StepRecord) -> Result<(), OutputError> {
        let mut time = PhaseTime::default();
        time.measure(|| -> Result<(), OutputError> {
            self.watch.observe(simulation, record, &mut self.watched)?;
            if let Some(contact) = &record.contact {
                self.memo.means.add(contact, record.dt, simulation.is_static());
            }
            let is_due = self.memo.frames.is_due(&self.settings.frames, record.step, record.time, record.dt)
                || simulation.finished();
            self.write_rows(simulation, record, is_due);
            if is_due {
                self.write_frame(simulation);
                self.memo.means.clear();
            }
            Ok(())
        })?;
        // Before the checkpoint, in which the seconds are: its own are counted nowhere.
        simulation.timings_mut().add_output(time);
        if record.step > 0
            && (record.step.is_multiple_of(self.settings.checkpoint_every.max(1)) || simulation.finished())
        {
            self.write_checkpoint(simulation);
        }
        self.agree()
    }

    fn write_rows(&mut self, simulation: &Simulation, record: &StepRecord, has_frame: bool) {
        let Memo { friction_work, means, .. } = &mut self.memo;
        self.tables.write(&self.settings, simulation, record, friction_work, means, has_frame);
        let b = &record.balance;
        // What one scheme loses is no drift of the next.
        let promised = |stage: u32| self.settings.promises.get(stage as usize - 1);
        if promised(record.stage) != promised(self.memo.stage) {
            self.memo.drifts = Drifts::start(b);
        }
        self.memo.stage = record.stage;
        self.memo.drifts.follow(b);
        self.memo.iterations += u64::from(record.iterations);
        self.memo.max_iterations = self.memo.max_iterations.max(u64::from(record.iterations));
        self.memo.max_equations = self.memo.max_equations.max(simulation.equations() as u64);
        self.put(Self::flush);
    }

    fn flush(&mut self) -> Result<(), OutputError> {
        self.tables.flush(&mut self.memo.lengths)?;
        self.memo.lengths.insert(watch::TABLE.into(), self.watched.flush()?);
        Ok(())
    }

    fn write_frame(&mut self, simulation: &Simulation) {
        let Memo { frames, means, .. } = &mut self.memo;
        let folder = (self.settings.ranks.is_first() && self.unwritten.is_none()).then_some(&*self.path);
        let fields = self.settings.fields.as_deref();
        // Computed by all ranks, and only then written.
        let written = frames.write(folder, simulation, means, fields, &self.settings.drawing);
        self.unwritten = self.unwritten.take().or(written.err());
    }

    /// Whether the watch has found that the run is wrong, in a run that is to stop then.
    pub fn must_stop(&self) -> bool {
        self.watch.on_fault() == OnFault::Stop && self.watch.verdict().level == stoss_watch::Severity::Wrong
    }

    /// The worst drift and the deepest penetration so far.
    pub fn worst(&self) -> Watched {
        self.watch.worst()
    }

    /// What sums over the model are divided by.
    pub fn extent(&self) -> f64 {
        self.settings.extent
    }

    /// Ends a session: a checkpoint, and a frame of the last completed step if it has none. That frame is not in the checkpoint, so that
    /// a run that goes on has frames where a run without a break has them.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn close(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        self.write_checkpoint(simulation);
        if !self.memo.frames.has(simulation.step()) {
            self.write_frame(simulation);
        }
        self.agree()
    }

    /// Lets other runs have the folder; nothing is to be written after it.
    pub(crate) fn release(&mut self) {
        drop(self.lock.take());
    }

    /// Writes the checkpoint of the last completed step.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn checkpoint(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        self.write_checkpoint(simulation);
        self.agree()
    }

    fn write_checkpoint(&mut self, simulation: &Simulation) {
        // States of elements are with all ranks.
        let mut checkpoint = simulation.checkpoint(&self.settings.identity.hash(), BTreeMap::new());
        self.put(|folder| {
            checkpoint.attachments = folder.attachments(simulation)?;
            Ok(checkpoint.write(&folder.path.join("checkpoint"))?)
        });
    }

    /// What a checkpoint has beside the state of the simulation.
    fn attachments(&self, simulation: &Simulation) -> Result<BTreeMap<String, Vec<u8>>, OutputError> {
        let unwritable = |e: serde_json::Error| OutputError::Damaged { path: self.path.clone(), reason: e.to_string() };
        let memo = serde_json::to_vec(&self.memo).map_err(unwritable)?;
        let identity = serde_json::to_vec(&self.settings.identity).map_err(unwritable)?;
        let mut attachments = BTreeMap::from([("folder".to_owned(), memo), (IDENTITY.to_owned(), identity)]);
        let steered = simulation.steered_tables();
        if !steered.is_empty() {
            attachments.insert(STEERED.to_owned(), serde_json::to_vec(&steered).map_err(unwritable)?);
        }
        attachments.extend(self.watch.save(simulation.step()).map_err(unwritable)?);
        Ok(attachments)
    }

    /// Writes `summary.json` and returns it.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn summarise(&mut self, simulation: &Simulation, outcome: Outcome) -> Result<Summary, OutputError> {
        let plan = simulation.plan();
        let steps = simulation.step();
        let counts = simulation.solver_statistics();
        let [linear, angular, energy] = self.memo.drifts.report(self.settings.scales, &self.settings.changed_by);
        let map = |rows: &[(&str, u64)]| rows.iter().map(|&(k, v)| (k.to_owned(), v)).collect::<BTreeMap<_, _>>();
        let summary = Summary {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            title: self.settings.title.clone(),
            scene_hash: self.settings.identity.hash(),
            scheme: self.settings.scheme.clone(),
            unknowns: map(&[
                ("bodies", simulation.model().bodies.len() as u64),
                ("nodes", plan.nodes as u64),
                ("elements", plan.elements as u64),
                ("free_components", plan.free_components as u64),
                ("contact_slots", plan.slots as u64),
                ("largest_number_of_equations", self.memo.max_equations),
            ]),
            parts: BTreeMap::from([
                ("mass_matrix".to_owned(), plan.mass_matrix),
                ("contact_search".to_owned(), plan.contact_search),
            ]),
            contacts: self.settings.contacts.clone(),
            linear_solver: simulation.solver_name().to_owned(),
            linear_solver_counts: map(&[
                ("analyses", counts.analyses),
                ("factorisations", counts.factorisations),
                ("solves", counts.solves),
                ("refinement_steps", counts.refinement_steps),
                ("nearby_solves", counts.nearby_solves),
                ("nearby_iterations", counts.nearby_iterations),
                ("nearby_given_up", counts.nearby_given_up),
                ("indefinite_fallbacks", counts.indefinite_fallbacks),
                ("symmetric", counts.symmetric),
                ("pivoting_fallbacks", counts.pivoting_fallbacks),
                ("iterative_solves", counts.iterative_solves),
                ("iterations", counts.iterations),
                ("set_ups", counts.set_ups),
                ("handed_over", counts.handed_over),
            ]),
            steps,
            cuts: simulation.decisions().iter().filter(|d| d.kind == DecisionKind::Cut).count() as u64,
            mean_iterations: self.memo.iterations as f64 / steps.max(1) as f64,
            max_iterations: self.memo.max_iterations,
            time: simulation.state().time,
            seconds: *simulation.timings(),
            shares: simulation.timings().shares().into_iter().map(|(k, share)| (k.to_owned(), share)).collect(),
            contact_share: simulation.timings().contact_share(),
            wall_seconds: self.started.elapsed().as_secs_f64(),
            cpu_seconds: self.cpu.elapsed().as_secs_f64(),
            memory: Memory { peak_resident_bytes: peak_resident_bytes(), system_bytes: plan.memory_bytes },
            ranks: of_ranks(&self.settings.ranks),
            drift: BTreeMap::from([
                ("linear_momentum".to_owned(), linear),
                ("angular_momentum".to_owned(), angular),
                ("energy".to_owned(), energy),
            ]),
            decisions: simulation.decisions().to_vec(),
            verdict: self.watch.verdict(),
            watch: WatchSummary {
                every: self.watch.every(),
                on_fault: self.watch.on_fault(),
                seconds: self.watch.seconds(),
            },
            page_seconds: None,
            outcome,
        };
        self.put(|folder| summary.write(&folder.path));
        self.agree()?;
        Ok(summary)
    }
}

/// The watch on the run of a folder.
fn watch_of(settings: &FolderSettings, simulation: &Simulation) -> Result<RunWatch, OutputError> {
    RunWatch::new(
        simulation,
        &settings.watch,
        settings.contact_bodies.clone(),
        &settings.contacts,
        settings.promises.clone(),
        (&settings.drawing, &settings.parts),
        settings.left_out.clone(),
    )
}

/// The lock of a folder and the bytes of its checkpoint.
fn read(folder: &Path, file: &Path) -> Result<(Option<FolderLock>, Vec<u8>), RunError> {
    if !file.is_file() {
        let reason = "there is no checkpoint in this folder: name the folder of an earlier run with --out, or run without --resume";
        return Err(RunError::Resume { path: file.to_path_buf(), reason: reason.into() });
    }
    let lock = FolderLock::take(folder)?;
    let unreadable = |source| CheckpointError::Io { path: file.to_path_buf(), source };
    let bytes = std::fs::read(file).map_err(unreadable).map_err(OutputError::from)?;
    Ok((Some(lock), bytes))
}

/// What each of several ranks has needed. Collective.
fn of_ranks(ranks: &Ranks) -> Vec<RankSummary> {
    if ranks.count() == 1 {
        return Vec::new();
    }
    let communicator = ranks.communicator();
    let Traffic { operations, messages, bytes } = communicator.traffic();
    let mine = [operations, messages, bytes, peak_resident_bytes().unwrap_or(0)];
    let all = communicator.gather_bytes(&mine.map(u64::to_le_bytes).concat());
    let of_rank = |bytes: &Vec<u8>| {
        let number = |k: usize| bytes.as_chunks().0.get(k).map_or(0, |bytes| u64::from_le_bytes(*bytes));
        RankSummary {
            peak_resident_bytes: Some(number(3)).filter(|&bytes| bytes > 0),
            operations: number(0),
            messages: number(1),
            received_bytes: number(2),
        }
    };
    all.iter().map(of_rank).collect()
}

/// Largest resident set of this process, where `/proc` tells.
fn peak_resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok().map(|kb| 1024 * kb)
}
