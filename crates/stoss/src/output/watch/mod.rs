//! The watch of a run: it looks at accepted steps, keeps the verdict and writes `watch.csv`. What `stoss judge` needs beside the frames is
//! in `watch.json`.
//!
//! How often the geometry is checked follows from the sizes of the model alone, never from the clock, so that verdicts repeat.

mod file;
mod model;

pub use file::judge_folder;
pub(crate) use model::contact_bodies;

use super::table::CsvTable;
use super::{Drawing, OutputError};
use crate::build::ContactPlan;
use crate::left_out;
use crate::points::Points;
use crate::scene::{ContactMethod, OnFault, Scene, Watch as WatchTable};
use file::WatchFile;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};
use stoss_fe_solid::Volumetric;
use stoss_solver::{Balance, Simulation, StepRecord};
use stoss_watch::{
    BalanceState, BalanceWatch, ContactPoint, ContactState, Elasticity, Finding, FindingKind, Judge, KeptGaps, Limits,
    Meeting, PointFriction, Promises, Resolution, Severity, Verdict, Watch, WatchModel,
};

/// Columns of `watch.csv`. Depth in the scene's length, and over the edge length of the facet that the node passed.
pub(super) const COLUMNS: &str =
    "step,time,depth,relative_depth,node,body,into,nodes_inside,cutting_edges,tunnelled,verdict";

/// Name of the table.
pub(super) const TABLE: &str = "watch.csv";

/// Part of the limit of `wrong` from which a depth is doubtful.
const DOUBTFUL: f64 = 1.0 / 6.0;

/// What a checkpoint holds of the watch.
#[derive(Debug, Serialize, Deserialize)]
struct Memo {
    judge: Judge,
    balance: Option<BalanceWatch>,
    stage: u32,
    last: u64,
    #[serde(default)]
    deepest: [f64; 2],
    #[serde(default)]
    closed: Vec<f64>,
}

/// Two bodies that act on each other in a step.
struct Acting {
    bodies: [usize; 2],
    /// Force on the first.
    force: [f64; 3],
    has_friction: bool,
    /// Smallest distance of their surfaces, where contact knows it.
    distance: Option<f64>,
    /// Whether contact has true positions on the round surfaces of each.
    is_round: [bool; 2],
}

/// The worst that the watch has seen so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Watched {
    /// What drifts most of that which scheme, loads and supports leave constant, and by which part of its scale, in the present stage.
    pub drift: Option<(&'static str, f64)>,
    /// Deepest penetration, a length.
    pub depth: f64,
    /// Deepest penetration in edges of the facets there.
    pub relative_depth: f64,
}

/// How far a body may pass a plane of symmetry, in edges.
const PAST_PLANE: f64 = 0.05;

/// The watch on a running simulation.
#[derive(Debug)]
pub(super) struct RunWatch {
    watch: Watch,
    judge: Judge,
    balance: Option<BalanceWatch>,
    /// What each stage promises, and the stage that was seen last.
    promises: Vec<Option<Promises>>,
    stage: u32,
    mass: f64,
    file: WatchFile,
    points: Points,
    described: Vec<ContactPlan>,
    /// The bodies of each contact; `None` if one of them is a line.
    contacts: Vec<Option<[usize; 2]>>,
    /// The bodies that each prescription moves.
    driven: Vec<Vec<usize>>,
    /// Whether what is joined, tied or coupled to a body may drive it.
    has_links: bool,
    /// The watched body of each part, as general contact counts them.
    parts: Vec<Option<usize>>,
    /// The watched bodies with surfaces that the scene calls round.
    round: BTreeSet<usize>,
    /// Energy that closing gaps took since the start, by constraint of the model.
    closed: Vec<f64>,
    /// Names of the constraints.
    constraints: Vec<String>,
    every: u64,
    on_fault: OnFault,
    /// Positions that were looked at last, and their step.
    previous: Vec<f64>,
    last: Option<u64>,
    /// Depth and relative depth of the deepest penetration so far.
    deepest: [f64; 2],
    /// The finding that the scene lacks something of its deck.
    left_out: Option<Finding>,
    /// Axes across planes of symmetry, and the sides on which the bodies are.
    symmetry: Vec<(usize, f64)>,
    spent: Duration,
}

impl RunWatch {
    /// The watch on a simulation at its start, which has seen nothing yet.
    pub(super) fn new(
        simulation: &Simulation,
        settings: &WatchTable,
        contacts: Vec<Option<[usize; 2]>>,
        described: &[ContactPlan],
        promises: Vec<Option<Promises>>,
        (drawing, parts): (&Drawing, &[String]),
        left_out: Option<Finding>,
    ) -> Result<Self, OutputError> {
        let points = Points::of(simulation.model());
        let (stage, mass) = (simulation.stage(), simulation.total_mass());
        let radius = points.largest(&simulation.state().q);
        let balance = promised(&promises, stage).map(|promises| balance_watch(promises, simulation, mass, radius));
        let model = model::model(simulation.model(), &points, &drawing.of_points(&points));
        // What is stored does not tell stages from each other.
        let is_one = promises.iter().all(|of| *of == promised(&promises, stage));
        let stored = balance.clone().filter(|_| is_one);
        let between: Vec<[usize; 2]> = contacts.iter().flatten().copied().collect();
        let file = WatchFile::new(
            &model,
            limits(settings),
            (between.clone(), kept_gaps(simulation, &contacts)),
            stored,
            left_out.clone(),
        );
        let judge = judge(&model, between, settings);
        let place = |name: &String| model.bodies.iter().position(|body| body.name == *name);
        let parts = parts.iter().map(place).collect();
        let round = drawing.round.iter().filter_map(place).collect();
        let driven = simulation.model().prescriptions.iter().map(|prescription| {
            let moved: BTreeSet<u32> = prescription.nodes.iter().copied().collect();
            // The surface of a rigid body is carried by nodes of its own.
            let embedding = &simulation.model().embedding;
            let is_carried =
                |node| embedding.carriers(node).is_some_and(|all| all.iter().any(|(n, _)| moved.contains(n)));
            let has = |k: &usize| {
                let mut nodes = model.bodies[*k].nodes.clone().map(|place| points.node(place));
                nodes.any(|node| moved.contains(&node) || is_carried(node))
            };
            if prescription.moves() { (0..model.bodies.len()).filter(has).collect() } else { Vec::new() }
        });
        let driven: Vec<Vec<usize>> = driven.collect();
        let watch = Watch::new(model)?;
        let every = settings.every.map_or_else(|| watch.default_every(), u64::from);
        Ok(Self {
            watch,
            judge,
            balance,
            promises,
            stage,
            mass,
            file,
            points,
            described: described.to_vec(),
            contacts,
            driven,
            has_links: simulation.model().contacts.iter().any(|pair| pair.always_holds()),
            parts,
            round,
            closed: vec![0.0; simulation.model().contacts.len()],
            constraints: simulation.model().contacts.iter().map(|pair| pair.name.clone()).collect(),
            every,
            on_fault: settings.on_fault,
            previous: Vec::new(),
            last: None,
            deepest: [0.0; 2],
            left_out,
            symmetry: drawing.symmetry.clone(),
            spent: Duration::ZERO,
        })
    }

    /// Writes what `stoss judge` needs.
    pub(super) fn write_file(&self, folder: &Path) -> Result<(), OutputError> {
        self.file.write(folder)
    }

    /// Looks at a completed step, if it is due, and writes a row.
    pub(super) fn observe(
        &mut self,
        simulation: &Simulation,
        record: &StepRecord,
        table: &mut CsvTable,
    ) -> Result<(), OutputError> {
        let [before, now] = [self.stage, record.stage].map(|stage| promised(&self.promises, stage));
        if before != now {
            let radius = self.points.largest(&simulation.state().q);
            self.judge.add_all(self.of_energy());
            self.balance = now.map(|promises| balance_watch(promises, simulation, self.mass, radius));
        }
        self.stage = record.stage;
        if let Some(balance) = &mut self.balance {
            for finding in balance.observe(record.step, record.time, &balance_state(&record.balance)) {
                self.judge.add(finding);
            }
        }
        self.closed.iter_mut().zip(&record.closing).for_each(|(sum, closing)| *sum += closing);
        self.closed.iter_mut().zip(&record.impact_losses).for_each(|(sum, loss)| *sum += loss);
        if let Some([force, others]) = record.stabilising {
            self.judge.observe_stabilisation(record.step, record.time, force, others);
        }
        if record.unstable > 0 {
            self.judge.observe_unstable(record.step, record.time, record.unstable);
        }
        let due = record.step.is_multiple_of(self.every.max(1)) || simulation.finished();
        if !due || self.last == Some(record.step) {
            return Ok(());
        }
        let started = Instant::now();
        let q = self.points.of_all(&simulation.state().q, 3);
        let previous = self.last.is_some().then_some(self.previous.as_slice());
        let kept = kept_gaps(simulation, &self.contacts);
        let seen = self.watch.geometry(&q, previous).beyond(&kept, record.time);
        let solids = self.watch.solids(&q);
        let meetings: Vec<Meeting> = self.observe_acting(simulation, record);
        let meetings: Vec<Meeting> = meetings.into_iter().map(|meeting| meeting.beyond(&kept, record.time)).collect();
        self.judge.observe_driven(record.step, record.time, &seen, &solids, &meetings);
        self.observe_planes(simulation, record);
        self.observe_strains(simulation, record, &q);
        self.previous.clear();
        self.previous.extend_from_slice(&q);
        self.last = Some(record.step);
        self.observe_contacts(simulation, record)?;
        self.spent += started.elapsed();
        table.integer(record.step).number(record.time);
        match seen.deepest() {
            Some(deepest) => {
                if deepest.relative > self.deepest[1] {
                    self.deepest = [deepest.depth, deepest.relative];
                }
                table.numbers(&[deepest.depth, deepest.relative]).integer(u64::from(deepest.node));
                table.text(self.file.name(deepest.body)).text(self.file.name(deepest.into));
            }
            None => {
                table.numbers(&[0.0, 0.0]).text("").text("").text("");
            }
        }
        for count in [seen.nodes_inside, seen.cutting, seen.tunnelled.len()] {
            table.integer(count as u64);
        }
        table.text(&self.verdict().level.to_string()).end_row();
        Ok(())
    }

    /// The bodies that contact brings together in a step.
    fn acting(&self, simulation: &Simulation, record: &StepRecord) -> Vec<Acting> {
        let Some(summary) = &record.contact else { return Vec::new() };
        let pairs = simulation.model().contacts.iter().enumerate().filter(|(_, pair)| !pair.always_holds());
        let mut found = Vec::new();
        for (k, (c, pair)) in pairs.enumerate() {
            let has_friction = pair.term.has_friction();
            let of_pair = &summary.pairs[c];
            let is_mortar = self
                .described
                .get(k)
                .is_some_and(|plan| ContactMethod::from_name(&plan.method).is_some_and(|method| method.integrates));
            let is_round = |bodies: [usize; 2]| bodies.map(|body| !is_mortar && self.round.contains(&body));
            if pair.is_potential() {
                let part = |body: u32| self.parts.get(body as usize).copied().flatten();
                let acting = summary.bodies.iter().filter(|of| of.active > 0 && of.bodies[0] != of.bodies[1]);
                found.extend(acting.filter_map(|of| {
                    let bodies = [part(of.bodies[0])?, part(of.bodies[1])?];
                    Some(Acting {
                        bodies,
                        force: of.force,
                        has_friction,
                        distance: Some(of.distance),
                        is_round: is_round(bodies),
                    })
                }));
            } else if let Some(bodies) = self.contacts.get(k).copied().flatten()
                && of_pair.active > 0
                && bodies[0] != bodies[1]
            {
                found.push(Acting {
                    bodies,
                    force: of_pair.force,
                    has_friction,
                    distance: None,
                    is_round: is_round(bodies),
                });
            }
        }
        found
    }

    /// Whether a prescribed motion that acts at present moves one of these bodies, or may do so through what joins it to others.
    fn is_driven(&self, simulation: &Simulation, bodies: [usize; 2]) -> bool {
        let acting = self
            .driven
            .iter()
            .zip(simulation.acting_prescriptions())
            .filter(|(moved, acts)| **acts && !moved.is_empty());
        acting.into_iter().any(|(moved, _)| self.has_links || bodies.iter().any(|body| moved.contains(body)))
    }

    /// Looks at the bodies that act on each other: directions of forces without friction, and in statics what drives them into each other.
    fn observe_acting(&mut self, simulation: &Simulation, record: &StepRecord) -> Vec<Meeting> {
        let mut meetings = Vec::new();
        for Acting { bodies, force, has_friction, distance, is_round } in self.acting(simulation, record) {
            let pushes = !has_friction && force.iter().any(|f| *f != 0.0);
            if let Some(beside) = pushes.then(|| self.watch.side_force(bodies, force, distance)).flatten() {
                self.judge.observe_push(bodies, force, beside, (record.step, record.time), record.dt);
            }
            if promised(&self.promises, record.stage).is_none() {
                let by_loads = !self.is_driven(simulation, bodies) && self.watch.gap_in_reference(bodies) >= 0.0;
                meetings.extend(self.watch.meeting(bodies, force, distance, is_round, by_loads));
            }
        }
        meetings
    }

    /// Observes what elements force on the deformable bodies, in statics.
    fn observe_strains(&mut self, simulation: &Simulation, record: &StepRecord, q: &[f64]) {
        if promised(&self.promises, record.stage).is_some() {
            return;
        }
        for (k, body) in simulation.model().bodies.iter().enumerate() {
            let moduli = body.solid.law().small_strain_moduli();
            let is_mixed = body.solid.options().volumetric == Volumetric::Mixed;
            let elasticity = Elasticity { shear: moduli.shear, bulk: moduli.bulk, is_mixed };
            let energies = self.watch.strain_energies(k, q, &elasticity);
            self.judge.observe_strains(record.step, record.time, k, &energies);
        }
    }

    /// Bodies that have passed a plane of symmetry, where they would meet their mirror images.
    fn observe_planes(&mut self, simulation: &Simulation, record: &StepRecord) {
        let q = &simulation.state().q;
        for (k, body) in simulation.model().bodies.iter().enumerate() {
            let edge = body.solid.characteristic_length();
            for &(axis, side) in &self.symmetry {
                let beyond = |node: u32| -side * q[3 * node as usize + axis];
                let Some(node) = body.nodes.clone().max_by(|a, b| beyond(*a).total_cmp(&beyond(*b))) else { continue };
                let depth = beyond(node) / edge;
                if depth < PAST_PLANE {
                    continue;
                }
                let name = ["x", "y", "z"][axis];
                self.judge.add(Finding {
                    level: Severity::Wrong,
                    kind: FindingKind::Penetration,
                    bodies: Some([k; 2]),
                    step: record.step,
                    time: record.time,
                    worst_time: None,
                    sentence: format!(
                        "`{}` has passed the plane of symmetry {name} = 0 by {depth:.2} of an edge: it would meet its mirror image there, and no contact holds it. Put a fixed tool in the plane, or model the whole",
                        body.solid.name()
                    ),
                    position: Some([0, 1, 2].map(|i| q[3 * node as usize + i])),
                    figure: depth,
                });
            }
        }
    }

    /// Findings about the energy in the present stage beside the largest so far.
    fn of_energy(&self) -> Vec<Finding> {
        let most = self.closed.iter().zip(&self.constraints).max_by(|a, b| a.0.total_cmp(b.0));
        let name = most.filter(|(closed, _)| **closed > 0.0).map(|(_, name)| name.as_str());
        self.balance.as_ref().map(|balance| balance.standing(name)).unwrap_or_default()
    }

    /// Takes note of what the contacts report.
    fn observe_contacts(&mut self, simulation: &Simulation, record: &StepRecord) -> Result<(), OutputError> {
        // The initial state has no pressures yet.
        if record.step == 0 {
            return Ok(());
        }
        let pairs = simulation.model().contacts.iter().enumerate().filter(|(_, pair)| !pair.always_holds());
        for (k, ((c, pair), described)) in pairs.zip(&self.described).enumerate() {
            let (pressures, active) = (&simulation.pressures()[c], &simulation.active()[c]);
            let points: Vec<ContactPoint> = (simulation.contact_report(c)?.iter().enumerate())
                .map(|(slot, report)| ContactPoint {
                    node: self.points.place(report.node),
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
            let edge = pair.term.length_scale();
            let contact = ContactState {
                name: &pair.name,
                bodies: self.contacts.get(k).copied().flatten(),
                stiffness: pair.complementarity * edge,
                edge,
                exact: described.enforcement == "multiplier",
                points: &points,
            };
            self.judge.observe_contact(record.step, record.time, &contact);
        }
        Ok(())
    }

    /// The worst so far.
    pub(super) fn worst(&self) -> Watched {
        let [depth, relative_depth] = self.deepest;
        Watched { drift: self.balance.as_ref().and_then(BalanceWatch::worst_drift), depth, relative_depth }
    }

    /// Verdict on what was seen so far, and on what the scene lacks of its deck.
    pub(super) fn verdict(&self) -> Verdict {
        left_out::with(self.judge.verdict_with(self.of_energy()), self.left_out.as_ref())
    }

    /// Wall seconds that the watch took in this session.
    pub(super) fn seconds(&self) -> f64 {
        self.spent.as_secs_f64()
    }

    /// Steps between two checks at the geometry.
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
        let (judge, balance, stage) = (self.judge.clone(), self.balance.clone(), self.stage);
        let memo = serde_json::to_vec(&Memo {
            judge,
            balance,
            stage,
            last,
            deepest: self.deepest,
            closed: self.closed.clone(),
        })?;
        let positions = match last == step {
            true => Vec::new(),
            false => self.previous.iter().flat_map(|x| x.to_le_bytes()).collect(),
        };
        Ok([("watch".into(), memo), ("watch-positions".into(), positions)])
    }

    /// Continues from what [`Self::save`] gave, with the positions `q` of the checkpoint. The scene's own limit holds for what comes.
    pub(super) fn load(&mut self, memo: &[u8], positions: &[u8], q: &[f64]) -> Result<(), String> {
        let memo: Memo = serde_json::from_slice(memo).map_err(|e| e.to_string())?;
        let q = self.points.of_all(q, 3);
        let count = q.len();
        self.previous = match positions.len() {
            0 => q.into_owned(),
            // cannot fail: chunks have eight bytes.
            _ => positions.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap_or_default())).collect(),
        };
        if self.previous.len() != count {
            return Err(format!("{} positions for {count}", self.previous.len()));
        }
        self.judge = memo.judge;
        self.balance = memo.balance;
        self.stage = memo.stage;
        self.last = Some(memo.last);
        self.deepest = memo.deepest;
        if memo.closed.len() == self.closed.len() {
            self.closed = memo.closed;
        }
        Ok(())
    }
}

/// Gaps that the contacts that act keep in place of zero, of those with bodies on both sides.
fn kept_gaps(simulation: &Simulation, bodies: &[Option<[usize; 2]>]) -> Vec<KeptGaps> {
    let pairs = simulation.model().contacts.iter().filter(|pair| !pair.always_holds());
    let of = pairs.zip(bodies).filter_map(|(pair, bodies)| {
        let gap = pair.unilateral()?.reference_gap()?;
        let rows: Vec<[f64; 3]> = (gap.times().into_iter())
            .map(|time| {
                let [least, most] = gap.range(time);
                [time, least, most]
            })
            .collect();
        let keeps = rows.iter().any(|[_, least, most]| (*least, *most) != (0.0, 0.0));
        keeps.then_some(KeptGaps { bodies: (*bodies)?, rows })
    });
    of.collect()
}

/// The watch on the balance of a simulation whose nodes are at most `radius` from the origin.
fn balance_watch(promises: Promises, simulation: &Simulation, mass: f64, radius: f64) -> BalanceWatch {
    let [force, inertia] = simulation.unresolved_forces();
    let node_mass = mass * 3.0 / simulation.state().q.len().max(1) as f64;
    BalanceWatch::new(promises, mass, radius, simulation.unresolved_energy()).with_resolution(Resolution {
        force,
        inertia,
        node_mass,
    })
}

/// What a stage, counted from 1, promises.
fn promised(promises: &[Option<Promises>], stage: u32) -> Option<Promises> {
    promises.get((stage as usize).checked_sub(1)?).copied().flatten()
}

/// What the watch looks at of a balance.
fn balance_state(balance: &Balance) -> BalanceState {
    BalanceState {
        linear: balance.linear_momentum,
        angular: balance.angular_momentum,
        energy: balance.kinetic + balance.strain,
        total: balance.total(),
        closing_loss: balance.closing_loss,
        impact_loss: balance.impact_loss,
        impact_deformable: balance.impact_deformable,
        impact_capped: balance.impact_capped,
        damping: balance.dissipated_in_bodies(),
    }
}

fn limits(settings: &WatchTable) -> Limits {
    Limits { doubtful: DOUBTFUL * settings.limit, wrong: settings.limit }
}

fn judge(model: &WatchModel, contacts: Vec<[usize; 2]>, settings: &WatchTable) -> Judge {
    Judge::new(model.bodies.iter().map(|body| (body.name.clone(), body.nodes.clone())), contacts, limits(settings))
}

/// Verdict on the start of a simulation: bodies that overlap, bad elements.
pub(crate) fn judge_start(simulation: &Simulation, scene: &Scene, drawing: &Drawing) -> Result<Verdict, OutputError> {
    let points = Points::of(simulation.model());
    let model = model::model(simulation.model(), &points, &drawing.of_points(&points));
    let mut judge = judge(&model, contact_bodies(scene, drawing).into_iter().flatten().collect(), &scene.watch);
    let mut watch = Watch::new(model)?;
    let state = simulation.state();
    let q = points.of_all(&state.q, 3);
    let seen = watch.geometry(&q, None);
    judge.observe(0, state.time, &seen, &watch.solids(&q));
    Ok(judge.verdict())
}
