//! Writes a run into a folder.

use super::drift::Drifts;
use super::earlier::{self, Overwrite};
use super::identity::SceneIdentity;
use super::lock::FolderLock;
use super::table::CsvTable;
use super::watch::{self, RunWatch, Watched};
use super::{Memory, Outcome, OutputError, Summary, WatchSummary, frames};
use crate::build::{ContactPlan, JointPlace, Probe};
use crate::error::RunError;
use crate::scene::{Field, FrameFormat, Frames, OnFault, Watch as WatchTable};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use stoss_solver::{Checkpoint, DecisionKind, PhaseTime, Simulation, StepRecord};
use stoss_watch::Promises;

const BALANCE: &str = "step,time,dt,lx,ly,lz,jx,jy,jz,kinetic,strain,potential,contact,dissipation,external_work,total";
/// Columns that follow where there is contact.
const CLOSING: &str = "closing_loss,contact_remainder,restored";
/// Columns that follow where there is friction.
const FRICTION: &str = "friction_work,friction_stored";
/// Column that follows where a body is damped.
const DAMPING: &str = "damping";
/// Column that follows where a stage of statics is stabilised.
const STABILISATION: &str = "stabilisation";
const NEWTON: &str = "step,time,iteration,residual,increment,active,changes";
const CONTACT: &str = "step,time,active,closed,released,repaired,min_gap,max_pressure,\
contact_force_x,contact_force_y,contact_force_z,coverage_defect";
/// Columns of each contact pair in the same table, after its name and a point.
const PAIR: [&str; 10] =
    ["active", "min_gap", "max_pressure", "force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z", "area"];
/// Column of a pair with friction, after these.
const PAIR_FRICTION: &str = "friction_work";

/// Table of the joints: forces and moments on the second side, angle in degrees or displacement, what acts along that.
const JOINTS: &str = "joints.csv";
/// Columns of each joint.
const JOINT: [&str; 12] =
    ["fx", "fy", "fz", "mx", "my", "mz", "coordinate", "friction", "viscous", "spring", "motor", "limit"];
/// Further columns of a joint with two coordinates.
const SECOND: [&str; 6] =
    ["second", "second_friction", "second_viscous", "second_spring", "second_motor", "second_limit"];

/// Table of the probes, whose columns the scene names.
const PROBES: &str = "probes.csv";
/// Attachment of a checkpoint that says of which scene it is.
const IDENTITY: &str = "scene";

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
}

/// A contact pair with columns of its own.
#[derive(Clone, Copy, Debug)]
struct PairPlace {
    /// Its number among the contacts of the model.
    place: usize,
    has_friction: bool,
}

/// An open folder of results.
#[derive(Debug)]
pub struct ResultFolder {
    path: PathBuf,
    settings: FolderSettings,
    memo: Memo,
    balance: CsvTable,
    newton: CsvTable,
    probes: Option<CsvTable>,
    contact: Option<CsvTable>,
    pairs: Vec<PairPlace>,
    joints: Option<CsvTable>,
    watch: RunWatch,
    watched: CsvTable,
    started: Instant,
    cpu: cpu_time::ProcessTime,
    _lock: FolderLock,
}

/// What a folder needs to know of the scene.
#[derive(Clone, Debug)]
pub struct FolderSettings {
    /// The joints.
    pub joints: Vec<JointPlace>,
    /// Stages of the run.
    pub schedule: crate::build::Schedule,
    /// What frames show beside the solids.
    pub drawing: super::Drawing,
    /// Title of the scene.
    pub title: String,
    /// Names of bodies, plan and text of the scene.
    pub description: super::Description,
    /// What the results depend on.
    pub identity: SceneIdentity,
    /// Scheme, or "quasi-static".
    pub scheme: String,
    /// Which steps have a frame, beside the last one.
    pub frames: Frames,
    /// In which files frames are.
    pub format: FrameFormat,
    /// A checkpoint every so many steps.
    pub checkpoint_every: u64,
    /// Fields of the frames; `None`: all.
    pub fields: Option<Vec<Field>>,
    /// Probes.
    pub probes: Vec<Probe>,
    /// What drifts of linear momentum, angular momentum and energy are relative to; `None`: the largest magnitude in the run.
    pub scales: [Option<f64>; 3],
    /// Of linear momentum, angular momentum and energy what changes them, if anything does: then there is no drift to report.
    pub changed_by: [Option<String>; 3],
    /// Contacts, for the summary.
    pub contacts: Vec<ContactPlan>,
    /// Pairs of bodies between which a contact is named.
    pub contact_bodies: Vec<Option<[usize; 2]>>,
    /// What must not change, stage by stage.
    pub promises: Vec<Option<Promises>>,
    /// What is checked, and what a verdict `wrong` does.
    pub watch: WatchTable,
}

fn has_damping(simulation: &Simulation) -> bool {
    simulation.model().bodies.iter().any(|body| body.damping.acts())
}

impl FolderSettings {
    fn has_friction(&self) -> bool {
        self.contacts.iter().any(|contact| contact.friction.is_some())
    }
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
        let lock = FolderLock::take(path)?;
        earlier::remove(path, overwrite)?;
        let memo = Memo {
            lengths: BTreeMap::new(),
            frames: frames::Log::new(settings.format),
            drifts: Drifts::start(simulation.balance()),
            stage: simulation.stage(),
            iterations: 0,
            max_iterations: 0,
            max_equations: simulation.equations() as u64,
            friction_work: vec![0.0; simulation.model().contacts.len()],
        };
        let open = |name: &str, header: &str| CsvTable::create(&path.join(name), header);
        let mut folder = Self::open(path, settings, simulation, memo, lock, open)?;
        folder.memo.frames.remove_others(path)?;
        folder.watch.write_file(path)?;
        folder.settings.description.write(path)?;
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
        if !file.is_file() {
            let reason = "there is no checkpoint in this folder: name the folder of an earlier run with --out, or run without --resume";
            return Err(RunError::Resume { path: file, reason: reason.into() });
        }
        let lock = FolderLock::take(path)?;
        let checkpoint = Checkpoint::read(&file).map_err(OutputError::from)?;
        let before = checkpoint.attachments.get(IDENTITY).and_then(|bytes| serde_json::from_slice(bytes).ok());
        let changes = before.map(|before: SceneIdentity| settings.identity.changes(&before)).unwrap_or_default();
        if !changes.is_empty() {
            let reason = format!(
                "the scene has changed since it was written ({changes}); undo the changes, or run without --resume"
            );
            return Err(RunError::Resume { path: file, reason });
        }
        let tag = settings.identity.hash();
        // A new simulation is in the first stage.
        let stage = settings.schedule.stage(checkpoint.stage).filter(|_| checkpoint.stage > 1);
        let restored = match stage {
            Some(stage) => simulation.restore_in(stage, checkpoint, &tag),
            None => simulation.restore(checkpoint, &tag),
        };
        let attachments = restored.map_err(|e| RunError::Resume { path: file.clone(), reason: e.to_string() })?;
        let damaged = |reason: String| OutputError::Damaged { path: file.clone(), reason };
        let bytes = attachments.get("folder").ok_or_else(|| damaged("it was not written by this program".into()))?;
        let memo: Memo = serde_json::from_slice(bytes).map_err(|e| damaged(e.to_string()))?;
        memo.frames.keep_format(settings.format).map_err(|reason| RunError::Resume { path: file.clone(), reason })?;
        let lengths = memo.lengths.clone();
        let table_of_probes = path.join(PROBES);
        let open = |name: &str, header: &str| match lengths.get(name) {
            Some(&length) if name == PROBES => CsvTable::resume_as(&table_of_probes, length, header),
            Some(&length) => CsvTable::resume(&path.join(name), length),
            None if name == PROBES => CsvTable::create(&table_of_probes, header),
            None => Err(damaged(format!("{name} is not in it"))),
        };
        let mut folder = Self::open(path, settings, simulation, memo, lock, open)?;
        if folder.probes.is_none() && folder.memo.lengths.remove(PROBES).is_some() {
            std::fs::remove_file(&table_of_probes).map_err(OutputError::io(&table_of_probes))?;
        }
        let [judged, positions] = ["watch", "watch-positions"].map(|name| attachments.get(name).map(Vec::as_slice));
        let (judged, positions) = (judged.unwrap_or_default(), positions.unwrap_or_default());
        folder.watch.load(judged, positions, &simulation.state().q).map_err(damaged)?;
        folder.memo.frames.check(path)?;
        folder.memo.frames.remove_others(path)?;
        folder.settings.description.write(path)?;
        folder.memo.frames.write_collection(path)?;
        // The tables may have been written anew, with other columns.
        folder.flush()?;
        folder.checkpoint(simulation)?;
        Ok(folder)
    }

    fn open(
        path: &Path,
        settings: FolderSettings,
        simulation: &Simulation,
        memo: Memo,
        lock: FolderLock,
        open: impl Fn(&str, &str) -> Result<CsvTable, OutputError>,
    ) -> Result<Self, OutputError> {
        let heads: Vec<String> = settings.probes.iter().flat_map(Probe::columns).collect();
        let probe_header = format!("step,time,{}", heads.join(","));
        let contacts = &simulation.model().contacts;
        let with_friction = |name: &str| settings.contacts.iter().any(|c| c.name == name && c.friction.is_some());
        let pairs: Vec<PairPlace> = (0..contacts.len())
            .filter(|&place| !contacts[place].method.is_bilateral())
            .map(|place| PairPlace { place, has_friction: with_friction(&contacts[place].name) })
            .collect();
        let has_contact = simulation.model().has_contact_pairs();
        let has_friction = settings.has_friction();
        let more = [
            (has_contact, CLOSING),
            (has_friction, FRICTION),
            (has_damping(simulation), DAMPING),
            (settings.schedule.is_stabilised(), STABILISATION),
        ];
        let more = more.iter().filter(|(has, _)| *has).map(|(_, columns)| *columns);
        let balance_header = std::iter::once(BALANCE).chain(more).collect::<Vec<_>>().join(",");
        Ok(Self {
            balance: open("balance.csv", &balance_header)?,
            newton: open("newton.csv", NEWTON)?,
            probes: if heads.is_empty() { None } else { Some(open(PROBES, &probe_header)?) },
            contact: if has_contact {
                let heads = pairs.iter().flat_map(|pair| {
                    let of_friction = pair.has_friction.then_some(PAIR_FRICTION);
                    let name = &contacts[pair.place].name;
                    PAIR.into_iter().chain(of_friction).map(move |column| format!("{name}.{column}"))
                });
                let heads: Vec<String> = std::iter::once(CONTACT.to_owned()).chain(heads).collect();
                Some(open("contact.csv", &heads.join(","))?)
            } else {
                None
            },
            pairs,
            joints: if settings.joints.is_empty() {
                None
            } else {
                let heads = settings.joints.iter().flat_map(|joint| {
                    let more = if joint.coordinates > 1 { &SECOND[..] } else { &[] };
                    JOINT.iter().chain(more).map(|column| format!("{}.{column}", joint.name))
                });
                Some(open(JOINTS, &format!("step,time,{}", heads.collect::<Vec<_>>().join(",")))?)
            },
            watch: RunWatch::new(
                simulation,
                &settings.watch,
                settings.contact_bodies.clone(),
                &settings.contacts,
                settings.promises.clone(),
                &settings.drawing,
            )?,
            watched: open(watch::TABLE, watch::COLUMNS)?,
            path: path.to_path_buf(),
            settings,
            memo,
            started: Instant::now(),
            cpu: cpu_time::ProcessTime::now(),
            _lock: lock,
        })
    }

    /// Writes a completed step: its rows, a frame and a checkpoint if they are due.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write(&mut self, simulation: &mut Simulation, record: &StepRecord) -> Result<(), OutputError> {
        let mut time = PhaseTime::default();
        time.measure(|| -> Result<(), OutputError> {
            self.watch.observe(simulation, record, &mut self.watched)?;
            self.write_rows(simulation, record)?;
            if self.memo.frames.is_due(&self.settings.frames, record.step, record.time, record.dt)
                || simulation.finished()
            {
                self.write_frame(simulation)?;
            }
            Ok(())
        })?;
        // Before the checkpoint, in which the seconds are: its own are counted nowhere.
        simulation.timings_mut().add_output(time);
        if record.step > 0
            && (record.step.is_multiple_of(self.settings.checkpoint_every.max(1)) || simulation.finished())
        {
            self.checkpoint(simulation)?;
        }
        Ok(())
    }

    fn write_rows(&mut self, simulation: &Simulation, record: &StepRecord) -> Result<(), OutputError> {
        let b = &record.balance;
        self.balance
            .integer(record.step)
            .numbers(&[record.time, record.dt])
            .numbers(&b.linear_momentum)
            .numbers(&b.angular_momentum)
            .numbers(&[b.kinetic, b.strain, b.potential, b.contact, b.dissipation, b.external_work, b.total()]);
        if self.contact.is_some() {
            self.balance.numbers(&[b.closing_loss, b.contact_remainder, b.restored]);
        }
        if self.settings.has_friction() {
            self.balance.numbers(&[b.friction_work, b.friction_stored]);
        }
        if has_damping(simulation) {
            self.balance.number(b.damping);
        }
        if self.settings.schedule.is_stabilised() {
            self.balance.number(b.stabilisation);
        }
        self.balance.end_row()?;
        for row in &record.newton {
            self.newton
                .integer(record.step)
                .number(record.time)
                .integer(u64::from(row.iteration))
                .numbers(&[row.residual, row.increment])
                .integer(row.active as u64)
                .integer(row.changes as u64)
                .end_row()?;
        }
        if let Some(table) = &mut self.probes {
            table.integer(record.step).number(record.time);
            for probe in &self.settings.probes {
                table.numbers(&probe.values(simulation));
            }
            table.end_row()?;
        }
        if let (Some(table), Some(c)) = (&mut self.contact, &record.contact) {
            table.integer(record.step).number(record.time);
            for count in [c.active, c.closed, c.released, c.repaired] {
                table.integer(count as u64);
            }
            table.numbers(&[c.min_gap, c.max_pressure]).numbers(&c.force_on_slave).number(c.coverage.defect);
            for &PairPlace { place, has_friction } in &self.pairs {
                let pair = &c.pairs[place];
                let work = &mut self.memo.friction_work[place];
                *work += pair.friction_work;
                table.integer(pair.active as u64).numbers(&[pair.min_gap, pair.max_pressure]);
                table.numbers(&pair.force).numbers(&pair.moment).number(pair.area);
                if has_friction {
                    table.number(*work);
                }
            }
            table.end_row()?;
        }
        if let Some(table) = &mut self.joints {
            table.integer(record.step).number(record.time);
            for &JointPlace { place, coordinates, .. } in &self.settings.joints {
                // Two columns are there also of a joint without any.
                let coordinates = coordinates.max(1);
                let pair = &simulation.model().contacts[place];
                match pair.method.joint(&simulation.state().q, &simulation.pressures()[place]) {
                    Some(joint) => {
                        table.numbers(&joint.force).numbers(&joint.moment);
                        for k in 0..coordinates {
                            let of = joint.coordinates.get(k);
                            let value =
                                of.map_or(f64::NAN, |c| if c.is_angle { 1f64.to_degrees() } else { 1.0 } * c.value);
                            let t = of.map(|c| c.torques).unwrap_or_default();
                            table.numbers(&[value, t.friction, t.viscous, t.spring, t.motor, t.limit]);
                        }
                    }
                    // Released or switched off.
                    None => {
                        table.numbers(&[0.0; 6]);
                        (0..coordinates).for_each(|_| {
                            table.number(f64::NAN).numbers(&[0.0; 5]);
                        });
                    }
                }
            }
            table.end_row()?;
        }
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
        self.flush()
    }

    fn flush(&mut self) -> Result<(), OutputError> {
        let lengths = &mut self.memo.lengths;
        lengths.insert("balance.csv".into(), self.balance.flush()?);
        lengths.insert("newton.csv".into(), self.newton.flush()?);
        if let Some(table) = &mut self.probes {
            lengths.insert(PROBES.into(), table.flush()?);
        }
        lengths.insert(watch::TABLE.into(), self.watched.flush()?);
        if let Some(table) = &mut self.joints {
            lengths.insert(JOINTS.into(), table.flush()?);
        }
        if let Some(table) = &mut self.contact {
            lengths.insert("contact.csv".into(), table.flush()?);
        }
        Ok(())
    }

    fn write_frame(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        self.memo.frames.write(&self.path, simulation, self.settings.fields.as_deref(), &self.settings.drawing)
    }

    /// Whether the watch has found that the run is wrong, in a run that is to stop then.
    pub fn must_stop(&self) -> bool {
        self.watch.on_fault() == OnFault::Stop && self.watch.verdict().level == stoss_watch::Level::Wrong
    }

    /// The worst drift and the deepest penetration so far.
    pub fn worst(&self) -> Watched {
        self.watch.worst()
    }

    /// Ends a session: a checkpoint, and a frame of the last completed step if it has none. That frame is not in the checkpoint, so that
    /// a run that goes on has frames where a run without a break has them.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn close(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        self.checkpoint(simulation)?;
        if !self.memo.frames.has(simulation.step()) {
            self.write_frame(simulation)?;
        }
        Ok(())
    }

    /// Writes the checkpoint of the last completed step.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn checkpoint(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        let unwritable = |e: serde_json::Error| OutputError::Damaged { path: self.path.clone(), reason: e.to_string() };
        let memo = serde_json::to_vec(&self.memo).map_err(unwritable)?;
        let identity = serde_json::to_vec(&self.settings.identity).map_err(unwritable)?;
        let mut attachments = BTreeMap::from([("folder".to_owned(), memo), (IDENTITY.to_owned(), identity)]);
        attachments.extend(self.watch.save(simulation.step()).map_err(unwritable)?);
        simulation.checkpoint(&self.settings.identity.hash(), attachments).write(&self.path.join("checkpoint"))?;
        Ok(())
    }

    /// Writes `summary.json` and returns it.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn summarise(&self, simulation: &Simulation, outcome: Outcome) -> Result<Summary, OutputError> {
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
        summary.write(&self.path)?;
        Ok(summary)
    }
}

/// Largest resident set of this process, where `/proc` tells.
fn peak_resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok().map(|kb| 1024 * kb)
}
