//! Stages and events of a scene: what acts when.

use super::{Probe, Problems, newton};
use crate::scene::{self, Integrator, Kind, Scene};
use crate::solver::{Automatic, Release, Simulation, Stabilise, Stage, Switches};
use std::collections::BTreeMap;
use stoss_newton::NewtonOptions;

/// What a name of the scene stands for in the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Named {
    Load(usize),
    Prescription(usize),
    /// Contact, joint or equation.
    Contact(usize),
    /// Spring.
    Part(usize),
}

/// The solver's form of increments that are chosen.
fn automatic(choice: &scene::Automatic, step: f64) -> Automatic {
    let [first, last] = choice.halvings(step);
    Automatic { first, last, easy: choice.easy, after: choice.after, hard: choice.hard() }
}

/// The solver's form of a stabilisation; one of the keys is there.
fn stabilise(choice: &scene::Stabilise) -> Option<Stabilise> {
    let fraction = choice.fraction.map(Stabilise::Fraction);
    fraction.or(choice.coefficient.map(Stabilise::Coefficient))
}

/// A part of the run between two moments at which something changes.
#[derive(Clone, Debug)]
struct Interval {
    name: String,
    /// `None`: statics.
    integrator: Option<Integrator>,
    step: f64,
    automatic: Option<Automatic>,
    stabilise: Option<Stabilise>,
    end: f64,
    newton: NewtonOptions,
    off: Switches,
    /// What is released at its beginning, with the event's name.
    releases: Vec<(String, Release)>,
}

/// A release that waits for a probe.
#[derive(Clone, Debug)]
struct Conditional {
    probe: usize,
    component: usize,
    bound: f64,
    /// Whether it takes place above the bound, or below it.
    above: bool,
    release: Release,
    /// Name of the event.
    event: String,
}

/// The stages of a run, cut where events take place at given times, and the events that depend on probes. One segment and no event for a scene without either.
#[derive(Clone, Debug)]
pub struct Schedule {
    segments: Vec<Interval>,
    conditional: Vec<Conditional>,
}

impl Schedule {
    /// The schedule of a scene whose names are resolved.
    pub(super) fn new(
        scene: &Scene,
        names: &BTreeMap<String, Named>,
        probes: &[Probe],
        problems: &mut Problems<'_>,
    ) -> Self {
        // If something else is wrong, names are not resolved.
        let is_resolved = problems.list.is_empty();
        let mut segments = Vec::new();
        let integrator = scene.time.integrator.clone().filter(|_| scene.header.kind == Kind::Dynamic);
        for (s, stage) in scene.stages.iter().enumerate() {
            let mut off = Switches::default();
            for (n, name) in stage.off.iter().enumerate() {
                match names.get(name) {
                    Some(Named::Load(l)) => off.loads.push(*l),
                    Some(Named::Prescription(p)) => off.prescriptions.push(*p),
                    Some(Named::Contact(c)) => off.contacts.push(*c),
                    Some(Named::Part(p)) => off.parts.push(*p),
                    None if !is_resolved => {}
                    None => {
                        let message =
                            "cannot be switched off: it is no joint, spring, contact, prescribed motion or load";
                        problems.add(format!("stage[{s}].off[{n}]"), name, message, "remove it from the list");
                    }
                }
            }
            segments.push(Interval {
                name: stage.name.clone(),
                integrator: match stage.kind {
                    Kind::QuasiStatic => None,
                    Kind::Dynamic => stage.integrator.clone().or_else(|| integrator.clone()),
                },
                step: stage.step.unwrap_or(scene.time.step),
                automatic: (stage.automatic.or(scene.time.automatic))
                    .map(|choice| automatic(&choice, stage.step.unwrap_or(scene.time.step))),
                stabilise: stage.stabilise.or(scene.time.stabilise).and_then(|choice| stabilise(&choice)),
                end: stage.until,
                newton: newton(scene, stage.kind),
                off,
                releases: Vec::new(),
            });
        }
        if segments.is_empty() {
            let (step, end) = (scene.time.step, scene.time.end);
            let (off, releases) = (Switches::default(), Vec::new());
            let automatic = scene.time.automatic.map(|choice| automatic(&choice, step));
            let stabilise = scene.time.stabilise.and_then(|choice| stabilise(&choice));
            let (name, newton) = ("run".into(), newton(scene, scene.header.kind));
            segments.push(Interval { name, integrator, step, automatic, stabilise, end, newton, off, releases });
        }
        let mut schedule = Self { segments, conditional: Vec::new() };
        for pretension in scene.joints.iter().filter_map(|joint| joint.pretension.as_ref()) {
            schedule.cut(pretension.lock, None);
        }
        for (e, event) in scene.events.iter().enumerate() {
            let release = match names.get(&event.release) {
                Some(Named::Contact(c)) => Release::Constraint(*c),
                Some(Named::Prescription(p)) => Release::Prescription(*p),
                Some(Named::Part(p)) => Release::Part(*p),
                _ if !is_resolved => continue,
                _ => {
                    let message = "cannot be released: it is no joint, spring or prescribed motion";
                    problems.add(format!("event[{e}].release"), &event.release, message, "name a joint");
                    continue;
                }
            };
            if let Some(time) = event.time {
                schedule.cut(time, Some((event.name.clone(), release)));
            }
            let Some(when) = &event.when else { continue };
            let Some(probe) = probes.iter().position(|probe| probe.name == when.probe) else { continue };
            schedule.conditional.push(Conditional {
                probe,
                component: when
                    .component
                    .and_then(|wanted| probes[probe].quantity.components().iter().position(|c| *c == wanted))
                    .unwrap_or_default(),
                bound: when.above.or(when.below).unwrap_or_default(),
                above: when.above.is_some(),
                release,
                event: event.name.clone(),
            });
        }
        schedule
    }

    /// Lets a segment end at a time and the next one begin, with the release of an event if there is one.
    fn cut(&mut self, time: f64, release: Option<(String, Release)>) {
        if time <= 0.0 {
            return;
        }
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs().max(b.abs());
        let Some(k) = self.segments.iter().position(|segment| time <= segment.end || near(time, segment.end)) else {
            return;
        };
        if near(time, self.segments[k].end) {
            if let Some(next) = self.segments.get_mut(k + 1) {
                next.releases.extend(release);
            }
            return;
        }
        let mut rest = self.segments[k].clone();
        rest.releases = release.into_iter().collect();
        self.segments[k].end = time;
        self.segments.insert(k + 1, rest);
    }

    /// Number of segments.
    pub fn len(&self) -> usize {
        self.segments.len()
    }

    /// Never: there is one at least.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// Nominal steps of all segments.
    pub fn nominal_steps(&self) -> u64 {
        let mut start = 0.0;
        let steps = self.segments.iter().map(|segment| {
            let steps = ((segment.end - start) / segment.step - 1e-9).ceil().max(1.0) as u64;
            start = segment.end;
            steps
        });
        steps.sum()
    }

    /// Whether a segment of statics is stabilised.
    pub fn is_stabilised(&self) -> bool {
        self.segments.iter().any(|segment| segment.integrator.is_none() && segment.stabilise.is_some())
    }

    /// Whether a segment after the first one has inertia.
    pub(super) fn has_later_dynamics(&self) -> bool {
        self.segments[1..].iter().any(|segment| segment.integrator.is_some())
    }

    /// Segment `number`, counted from 1 as [`Simulation::stage`].
    pub(crate) fn stage(&self, number: u32) -> Option<Stage> {
        let segment = self.segments.get(number.checked_sub(1)? as usize)?;
        Some(Stage {
            name: segment.name.clone(),
            // Schemes that cannot be made are refused when the scene is built.
            scheme: segment.integrator.as_ref().and_then(|integrator| integrator.make().ok()),
            step: segment.step,
            automatic: segment.automatic,
            end: segment.end,
            off: segment.off.clone(),
            stabilise: segment.stabilise,
            newton: segment.newton,
        })
    }

    /// Begins the next segment at the end of one, with its releases; false if there is none.
    ///
    /// # Errors
    /// The errors of [`Simulation::begin_stage`] and [`Simulation::release`].
    pub fn advance(&self, simulation: &mut Simulation) -> Result<bool, crate::solver::SimulationError> {
        let number = simulation.stage() + 1;
        let Some(stage) = self.stage(number) else { return Ok(false) };
        simulation.begin_stage(stage)?;
        for (event, release) in &self.segments[number as usize - 1].releases {
            simulation.release(*release, Some(event))?;
        }
        Ok(true)
    }

    /// Carries out the events whose condition holds at the end of the last step.
    ///
    /// # Errors
    /// The errors of [`Simulation::release`].
    pub fn events(&self, simulation: &mut Simulation, probes: &[Probe]) -> Result<(), crate::solver::SimulationError> {
        for event in &self.conditional {
            if simulation.released().contains(&event.release) {
                continue;
            }
            let value = probes[event.probe].values(simulation).get(event.component).copied().unwrap_or(f64::NAN);
            if if event.above { value > event.bound } else { value < event.bound } {
                simulation.release(event.release, Some(&event.event))?;
            }
        }
        Ok(())
    }
}
