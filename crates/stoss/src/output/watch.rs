//! The watch of a run: it looks at accepted steps, keeps the verdict and writes `watch.csv`. What `stoss judge` needs beside the frames is
//! in `watch.json`.
//!
//! How often the geometry is checked follows from the sizes of the model alone, never from the clock, so that verdicts repeat.

use super::table::CsvTable;
use super::{OutputError, frame};
use crate::build::ContactPlan;
use crate::scene::{OnFault, Scene, Watch as WatchTable, split_set};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::{Duration, Instant};
use stoss_solver::{Balance, Model, Simulation, StepRecord};
use stoss_watch::{
    BalanceState, BalanceWatch, ContactPoint, ContactState, Judge, Limits, PointFriction, Promises, TiedPair, Verdict,
    Watch, WatchBody, WatchModel,
};

/// Columns of `watch.csv`. Depth in the scene's length, and over the edge length of the facet that the node passed.
pub(super) const COLUMNS: &str =
    "step,time,depth,relative_depth,node,body,into,nodes_inside,cutting_edges,tunnelled,verdict";

/// Name of the table.
pub(super) const TABLE: &str = "watch.csv";

/// Name of the file that says what the frames do not.
pub(super) const FILE: &str = "watch.json";

/// Part of the limit of `wrong` from which a depth is doubtful.
const DOUBTFUL: f64 = 1.0 / 6.0;

/// What `stoss judge` needs to know beside the frames.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct WatchFile {
    limits: Limits,
    bodies: Vec<NamedBody>,
    ties: Vec<Tied>,
    /// Pairs of bodies between which a contact is named.
    contacts: Vec<[usize; 2]>,
    /// The balance as it was at the beginning; none in statics.
    balance: Option<BalanceWatch>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct NamedBody {
    name: String,
    first_node: u32,
    nodes: u32,
    hexahedra: usize,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Tied {
    bodies: [usize; 2],
    nodes: Vec<u32>,
}

/// What a checkpoint holds of the watch.
#[derive(Debug, Serialize, Deserialize)]
struct Memo {
    judge: Judge,
    balance: Option<BalanceWatch>,
    last: u64,
}

/// The watch on a running simulation.
#[derive(Debug)]
pub(super) struct RunWatch {
    watch: Watch,
    judge: Judge,
    balance: Option<BalanceWatch>,
    limits: Limits,
    contacts: Vec<[usize; 2]>,
    described: Vec<ContactPlan>,
    every: u64,
    on_fault: OnFault,
    /// Positions that were looked at last, and their step.
    previous: Vec<f64>,
    last: Option<u64>,
    spent: Duration,
}

impl RunWatch {
    /// The watch on a simulation at its start, which has seen nothing yet.
    pub(super) fn new(
        simulation: &Simulation,
        settings: &WatchTable,
        contacts: Vec<[usize; 2]>,
        described: &[ContactPlan],
        promises: Option<Promises>,
    ) -> Result<Self, OutputError> {
        let balance = promises.map(|promises| {
            let radii = simulation.state().q.chunks_exact(3).map(|x| x.iter().map(|x| x * x).sum::<f64>().sqrt());
            BalanceWatch::new(promises, simulation.total_mass(), radii.fold(0.0, f64::max))
        });
        let model = model(simulation.model());
        let judge = judge(&model, contacts.clone(), settings);
        let watch = Watch::new(model)?;
        let every = settings.every.map_or_else(|| watch.default_every(), u64::from);
        Ok(Self {
            watch,
            judge,
            balance,
            limits: limits(settings),
            contacts,
            described: described.to_vec(),
            every,
            on_fault: settings.on_fault,
            previous: Vec::new(),
            last: None,
            spent: Duration::ZERO,
        })
    }

    /// Writes what `stoss judge` needs.
    pub(super) fn write_file(&self, folder: &Path, model: &Model) -> Result<(), OutputError> {
        let path = folder.join(FILE);
        let text =
            serde_json::to_string(&WatchFile::new(model, self.limits, self.contacts.clone(), self.balance.clone()))
                .map_err(|e| OutputError::Damaged { path: path.clone(), reason: e.to_string() })?;
        std::fs::write(&path, text + "\n").map_err(OutputError::io(&path))
    }

    /// Looks at a completed step, if it is due, and writes a row.
    pub(super) fn observe(
        &mut self,
        simulation: &Simulation,
        record: &StepRecord,
        table: &mut CsvTable,
    ) -> Result<(), OutputError> {
        if let Some(balance) = &mut self.balance {
            for finding in balance.observe(record.step, record.time, &balance_state(&record.balance)) {
                self.judge.add(finding);
            }
        }
        let due = record.step.is_multiple_of(self.every.max(1)) || simulation.finished();
        if !due || self.last == Some(record.step) {
            return Ok(());
        }
        let started = Instant::now();
        let q = &simulation.state().q;
        let previous = self.last.is_some().then_some(self.previous.as_slice());
        let seen = self.watch.geometry(q, previous);
        let solids = self.watch.solids(q);
        self.judge.observe(record.step, record.time, &seen, &solids);
        self.previous.clear();
        self.previous.extend_from_slice(q);
        self.last = Some(record.step);
        self.observe_contacts(simulation, record)?;
        self.spent += started.elapsed();
        let bodies = &simulation.model().bodies;
        table.integer(record.step).number(record.time);
        match seen.deepest() {
            Some(deepest) => {
                table.numbers(&[deepest.depth, deepest.relative]).integer(u64::from(deepest.node));
                table.text(bodies[deepest.body].solid.name()).text(bodies[deepest.into].solid.name());
            }
            None => {
                table.numbers(&[0.0, 0.0]).text("").text("").text("");
            }
        }
        for count in [seen.nodes_inside, seen.cutting, seen.tunnelled.len()] {
            table.integer(count as u64);
        }
        table.text(&self.judge.verdict().level.to_string()).end_row()
    }

    /// Takes note of what the contacts report.
    fn observe_contacts(&mut self, simulation: &Simulation, record: &StepRecord) -> Result<(), OutputError> {
        // The initial state has no pressures yet.
        if record.step == 0 {
            return Ok(());
        }
        let pairs = simulation.model().contacts.iter().enumerate().filter(|(_, pair)| !pair.method.is_bilateral());
        for ((c, pair), described) in pairs.zip(&self.described) {
            let (pressures, active) = (&simulation.pressures()[c], &simulation.active()[c]);
            let points: Vec<ContactPoint> = (simulation.contact_report(c)?.iter().enumerate())
                .map(|(slot, report)| ContactPoint {
                    node: report.node,
                    active: active[slot],
                    pressure: pressures[slot],
                    gap: report.gap,
                    reference_gap: report.reference_gap,
                    friction: report.friction.map(|friction| PointFriction {
                        traction: friction.traction,
                        slip: friction.slip,
                        bound: friction.bound,
                        sticks: friction.sticks,
                    }),
                })
                .collect();
            let edge = pair.method.length_scale();
            let contact = ContactState {
                name: &pair.name,
                bodies: self.contacts.get(c).copied(),
                stiffness: pair.complementarity * edge,
                edge,
                exact: described.enforcement == "multiplier",
                points: &points,
            };
            self.judge.observe_contact(record.step, record.time, &contact);
        }
        Ok(())
    }

    /// Verdict on what was seen so far.
    pub(super) fn verdict(&self) -> Verdict {
        self.judge.verdict()
    }

    /// Wall seconds that the watch took in this session.
    pub(super) fn seconds(&self) -> f64 {
        self.spent.as_secs_f64()
    }

    /// Steps between two looks at the geometry.
    pub(super) fn every(&self) -> u64 {
        self.every
    }

    /// What a verdict `wrong` does.
    pub(super) fn on_fault(&self) -> OnFault {
        self.on_fault
    }

    /// What a checkpoint holds of the watch: its judgement, and the positions that it saw last if they are not those of the checkpoint.
    pub(super) fn save(&self, step: u64) -> Result<[(String, Vec<u8>); 2], serde_json::Error> {
        let last = self.last.unwrap_or_default();
        let memo = serde_json::to_vec(&Memo { judge: self.judge.clone(), balance: self.balance.clone(), last })?;
        let positions = match last == step {
            true => Vec::new(),
            false => self.previous.iter().flat_map(|x| x.to_le_bytes()).collect(),
        };
        Ok([("watch".into(), memo), ("watch-positions".into(), positions)])
    }

    /// Continues from what [`Self::save`] gave, with the positions `q` of the checkpoint. The scene's own limit holds for what comes.
    pub(super) fn load(&mut self, memo: &[u8], positions: &[u8], q: &[f64]) -> Result<(), String> {
        let memo: Memo = serde_json::from_slice(memo).map_err(|e| e.to_string())?;
        self.previous = match positions.len() {
            0 => q.to_vec(),
            // cannot fail: chunks have eight bytes.
            _ => positions.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap_or_default())).collect(),
        };
        if self.previous.len() != q.len() {
            return Err(format!("{} positions for {}", self.previous.len(), q.len()));
        }
        self.judge = memo.judge;
        self.balance = memo.balance;
        self.last = Some(memo.last);
        Ok(())
    }
}

/// What the watch looks at of a balance.
fn balance_state(balance: &Balance) -> BalanceState {
    BalanceState {
        linear: balance.linear_momentum,
        angular: balance.angular_momentum,
        energy: balance.kinetic + balance.strain,
        total: balance.total(),
        closing_loss: balance.closing_loss - balance.restored,
    }
}

fn limits(settings: &WatchTable) -> Limits {
    Limits { doubtful: DOUBTFUL * settings.limit, wrong: settings.limit }
}

fn judge(model: &WatchModel, contacts: Vec<[usize; 2]>, settings: &WatchTable) -> Judge {
    Judge::new(model.bodies.iter().map(|body| (body.name.clone(), body.nodes.start)), contacts, limits(settings))
}

/// The pairs of bodies between which the scene names a contact.
pub(crate) fn contact_bodies(scene: &Scene) -> Vec<[usize; 2]> {
    let body = |set: &str| split_set(set).and_then(|(body, _)| scene.body_index(body));
    scene
        .contacts
        .iter()
        .filter_map(|contact| {
            let [a, b] = contact.surfaces();
            Some([body(a)?, body(b)?])
        })
        .collect()
}

/// Bodies, elements and ties; contacts are none of its business.
fn model(model: &Model) -> WatchModel {
    let bodies = model.bodies.iter().map(|body| WatchBody {
        name: body.solid.name().to_owned(),
        nodes: body.nodes.clone(),
        hexahedra: body.solid.connectivity().to_vec(),
    });
    WatchModel { bodies: bodies.collect(), reference: model.reference.clone(), ties: ties(model) }
}

/// The nodes that a tie holds together, by pairs of bodies.
fn ties(model: &Model) -> Vec<TiedPair> {
    let body_of = |node: u32| model.bodies.iter().position(|body| body.nodes.contains(&node)).unwrap_or_default();
    let mut ties: Vec<TiedPair> = Vec::new();
    for pair in model.contacts.iter().filter(|pair| pair.method.is_bilateral()) {
        // A constraint may hand out its nodes one by one.
        let mut nodes_of_slot: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        pair.method.stencils(&vec![true; pair.method.slot_count()], &mut |nodes, slots| {
            for &slot in slots {
                nodes_of_slot.entry(slot).or_default().extend(nodes);
            }
        });
        for nodes in nodes_of_slot.values() {
            let bodies: BTreeSet<usize> = nodes.iter().map(|&node| body_of(node)).collect();
            for &a in &bodies {
                for &b in bodies.range(a + 1..) {
                    let known = ties.iter().position(|tie| tie.bodies == [a, b]);
                    let tie = known.unwrap_or_else(|| {
                        ties.push(TiedPair { nodes: Vec::new(), bodies: [a, b] });
                        ties.len() - 1
                    });
                    ties[tie].nodes.extend(nodes.iter().filter(|&&node| [a, b].contains(&body_of(node))));
                }
            }
        }
    }
    for tie in &mut ties {
        tie.nodes.sort_unstable();
        tie.nodes.dedup();
    }
    ties
}

impl WatchFile {
    fn new(solver: &Model, limits: Limits, contacts: Vec<[usize; 2]>, balance: Option<BalanceWatch>) -> Self {
        let bodies = solver.bodies.iter().map(|body| NamedBody {
            name: body.solid.name().to_owned(),
            first_node: body.nodes.start,
            nodes: body.nodes.len() as u32,
            hexahedra: body.solid.element_count(),
        });
        let ties = ties(solver).into_iter().map(|tie| Tied { bodies: tie.bodies, nodes: tie.nodes });
        Self { bodies: bodies.collect(), ties: ties.collect(), limits, contacts, balance }
    }
}

/// Verdict on the start of a simulation: bodies that lie in each other, bad elements.
pub(crate) fn judge_start(simulation: &Simulation, scene: &Scene) -> Result<Verdict, OutputError> {
    let model = model(simulation.model());
    let mut judge = judge(&model, contact_bodies(scene), &scene.watch);
    let mut watch = Watch::new(model)?;
    let state = simulation.state();
    let seen = watch.geometry(&state.q, None);
    judge.observe(0, state.time, &seen, &watch.solids(&state.q));
    Ok(judge.verdict())
}

/// Rows of a stored `balance.csv`: step, time and what the watch looks at.
fn stored_balance(folder: &Path) -> Result<Vec<(u64, f64, BalanceState)>, OutputError> {
    let path = folder.join("balance.csv");
    let text = std::fs::read_to_string(&path).map_err(OutputError::io(&path))?;
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let mut rows = Vec::new();
    for (number, line) in lines.enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        let value =
            |name: &str| -> Option<f64> { cells.get(heads.iter().position(|head| *head == name)?)?.parse().ok() };
        let three = |names: [&str; 3]| -> Option<[f64; 3]> {
            let [x, y, z] = names.map(value);
            Some([x?, y?, z?])
        };
        let row = || {
            let state = BalanceState {
                linear: three(["lx", "ly", "lz"])?,
                angular: three(["jx", "jy", "jz"])?,
                energy: value("kinetic")? + value("strain")?,
                total: value("total")?,
                // A scene without contact has no such column.
                closing_loss: value("closing_loss").unwrap_or(0.0) - value("restored").unwrap_or(0.0),
            };
            Some((value("step")? as u64, value("time")?, state))
        };
        let reason = || format!("line {} has no number where one is expected", number + 2);
        rows.push(row().ok_or_else(|| OutputError::Unreadable { path: path.clone(), reason: reason() })?);
    }
    Ok(rows)
}

/// Verdict on the balance and on the stored frames of a run. Between frames that are several steps apart a body may pass through another unseen.
///
/// # Errors
/// [`OutputError`] if files are missing, cannot be read or do not fit each other.
pub fn judge_folder(folder: &Path) -> Result<Verdict, OutputError> {
    let path = folder.join(FILE);
    let damaged = |path: &Path, reason: String| OutputError::Unreadable { path: path.to_path_buf(), reason };
    let text = std::fs::read_to_string(&path).map_err(OutputError::io(&path))?;
    let file: WatchFile = serde_json::from_str(&text).map_err(|e| damaged(&path, e.to_string()))?;
    let bodies = file.bodies.iter().map(|body| (body.name.clone(), body.first_node));
    let mut judge = Judge::new(bodies, file.contacts.clone(), file.limits);
    let mut watch: Option<Watch> = None;
    let mut previous: Option<Vec<f64>> = None;
    for (step, path) in frame::stored(folder)? {
        let data = stoss_mesh_io::read_vtu(&path)?;
        let displacement = data.point_field("displacement").filter(|field| field.components == 3);
        let Some(displacement) = displacement else {
            let reason = "it has no field `displacement`: run again with it in [output] fields".into();
            return Err(damaged(&path, reason));
        };
        let reference: Vec<f64> = data.points.iter().flatten().copied().collect();
        let elements: usize = file.bodies.iter().map(|body| body.hexahedra).sum();
        if displacement.values.len() != reference.len() || data.hexahedra.len() != elements {
            return Err(damaged(&path, format!("its sizes do not fit {FILE}")));
        }
        let q: Vec<f64> = reference.iter().zip(&displacement.values).map(|(x, u)| x + u).collect();
        let watch = match &mut watch {
            Some(watch) => watch,
            none => none.insert(Watch::new(file.model(reference, &data.hexahedra))?),
        };
        let seen = watch.geometry(&q, previous.as_deref());
        judge.observe(step, data.time.unwrap_or(f64::NAN), &seen, &watch.solids(&q));
        previous = Some(q);
    }
    if let Some(mut balance) = file.balance {
        for (step, time, state) in stored_balance(folder)? {
            for finding in balance.observe(step, time, &state) {
                judge.add(finding);
            }
        }
    }
    if watch.is_none() {
        return Err(damaged(folder, "there are no frames".into()));
    }
    Ok(judge.verdict())
}

impl WatchFile {
    /// The bodies of a frame, whose elements stand body after body.
    fn model(&self, reference: Vec<f64>, hexahedra: &[[u32; 8]]) -> WatchModel {
        let mut rest = hexahedra;
        let bodies = self.bodies.iter().map(|body| {
            let (own, others) = rest.split_at(body.hexahedra.min(rest.len()));
            rest = others;
            WatchBody {
                name: body.name.clone(),
                nodes: body.first_node..body.first_node + body.nodes,
                hexahedra: own.to_vec(),
            }
        });
        let bodies = bodies.collect();
        let ties = self.ties.iter().map(|tie| TiedPair { nodes: tie.nodes.clone(), bodies: tie.bodies });
        WatchModel { bodies, reference, ties: ties.collect() }
    }
}
