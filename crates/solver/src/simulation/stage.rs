//! Stages of a run, and releases: changes of the model between two steps.

use super::{Simulation, at_rest, held_nodes};
use crate::assembly::System;
use crate::diagnosis::node_name;
use crate::run_state::{Ledger, NodalForces, SlotState, StageState};
use crate::stabilise::Stabilisation;
use crate::step::decision;
use crate::switches::Acting;
use crate::{
    Automatic, Balance, Clock, Decision, DecisionKind, Model, Release, SimulationError, Stabilise, StepControl,
    StepError, Switches,
};
use std::sync::Arc;
use stoss_integrators::{Scheme, State};
use stoss_linalg::AutoSolver;
use stoss_newton::NewtonOptions;
use stoss_term::{At, StepContext, Term};

/// A part of a run with one scheme, one step size and one set of things that act. It begins at the time and with the positions at which the one before ended.
#[derive(Debug)]
pub struct Stage {
    /// Name for messages.
    pub name: String,
    /// Time-stepping scheme; `None`: quasi-static.
    pub scheme: Option<Box<dyn Scheme>>,
    /// Nominal step size, a time. Cuts are those of the settings.
    pub step: f64,
    /// Automatic choice of the step size; `step` is then the largest one.
    pub automatic: Option<Automatic>,
    /// End of the stage, a time counted from the beginning of the run.
    pub end: f64,
    /// Things that are switched off.
    pub off: Switches,
    /// Stabilisation, if it is static.
    pub stabilise: Option<Stabilise>,
    /// Newton's settings.
    pub newton: NewtonOptions,
}

/// Checks that a scheme can integrate a model; the reason if not.
pub(super) fn check_scheme(scheme: &dyn Scheme, model: &Model) -> Result<(), String> {
    let name = scheme.name();
    if !model.contacts.is_empty() && !scheme.claims().constraints {
        return Err(format!("scheme {name} cannot integrate constraints, which contact, ties and joints need"));
    }
    // Momenta say nothing about the velocity of what has no mass.
    if scheme.rule(1.0).impulse.is_some()
        && let Some(part) = model.parts.iter().find(|part| has_massless_vector(&***part))
    {
        let part = part.name();
        return Err(format!(
            "scheme {name} cannot integrate {part}, which has coordinates without mass: it computes velocities from momenta"
        ));
    }
    Ok(())
}

fn has_massless_vector(part: &dyn Term) -> bool {
    let own = part.own_vectors();
    let mut massless = vec![true; own.len()];
    part.mass(&mut |i, j, m| {
        if i == j && m != 0.0 && own.contains(&i) {
            massless[(i - own.start) as usize] = false;
        }
    });
    massless.contains(&true)
}

/// State that is restored if a change fails.
struct Saved {
    acting: Acting,
    stage: StageState,
    /// The former system if it was replaced, without its solver.
    system: Option<System>,
    has_rates: bool,
    state: State,
    slots: SlotState,
    forces: NodalForces,
    ledger: Ledger,
    histories: Vec<Vec<u8>>,
}

impl Simulation {
    /// Begins the next stage at the present time with the present positions, whether or not the present stage is at its end. What `stage.off` names does not
    /// act; all else acts, but for what was released. Multipliers, contact state and history of friction carry over.
    ///
    /// * *Into dynamics:* from statics velocities are the initial ones of the model, from dynamics they stay; prescribed components have those of their tables.
    ///   What that changes in the kinetic energy is [`Balance::external_work`]. Accelerations and forces of the end point, if the scheme
    ///   carries them, are made again, so that an equilibrium stays at rest.
    /// * *From dynamics to statics:* velocities are dropped, and their energy is booked as [`Balance::dissipation`].
    /// * *Statics:* slave nodes that touch are closed, as at the start of a run.
    /// * *Loads, couplings and springs:* what their energies jump by when they are switched is [`Balance::external_work`].
    /// * *Prescriptions:* components of those that are off are free. One that is switched on demands what its table says at the end of the first step, wherever
    ///   its components are at present, or begins where they are ([`crate::Prescription::ramp_until`]).
    ///
    /// # Errors
    /// [`SimulationError::Stage`] if the stage does not fit the model or the time, [`SimulationError::Jump`] if something is switched on and is more than an edge
    /// length from where it has to be, [`SimulationError::Model`] if prescriptions contradict each other, [`SimulationError::Setup`] if the state cannot be
    /// evaluated. The simulation is then as it was.
    pub fn begin_stage(&mut self, stage: Stage) -> Result<(), SimulationError> {
        self.check_stage(&stage, Some(self.state.time))?;
        let fault = |reason| SimulationError::Stage { stage: stage.name.clone(), reason };
        let acting = self.model.acting(&stage.off, &self.stage.released).map_err(fault)?;
        let Stage { name, scheme, step, automatic, end, off, stabilise, newton } = stage;
        let was_dynamic = self.how.scheme.is_some();
        let reason = self.describe(&name, scheme.as_deref(), &off);
        let control = StepControl { step, automatic, end, ..self.how.control };
        let clock = std::mem::replace(&mut self.clock, Clock::starting_at(self.state.time, control));
        let scheme = std::mem::replace(&mut self.how.scheme, scheme);
        let mut saved = self.save();
        let stabilisation = self.system.present.stabilisation.take();
        let result = self.switch(acting, &mut saved).and_then(|()| {
            self.start_velocities(was_dynamic);
            self.settle(true)
        });
        if let Err(error) = result {
            (self.clock, self.how.scheme) = (clock, scheme);
            self.undo(saved);
            self.system.present.stabilisation = stabilisation;
            return Err(error);
        }
        (self.how.control, self.how.newton) = (control, newton);
        self.set_stabilisation(stabilise);
        self.stage.off = off;
        self.stage.from_motion = self.how.scheme.is_none() && (was_dynamic || self.stage.from_motion);
        self.stage.number += 1;
        self.note(DecisionKind::Stage, reason);
        Ok(())
    }

    /// Lets something stop acting, from the next step to the end of the run. A multiplier does no work, so the energy is continuous; energy that a constraint
    /// stores (friction in a joint), and that of a spring, goes to [`Balance::external_work`]. Nothing happens if it was released before.
    /// The decision in the record names the `event`.
    ///
    /// # Errors
    /// [`SimulationError::Release`] if there is no such thing or the coupling is not bilateral; [`SimulationError::Setup`] as for
    /// [`Self::begin_stage`]. The simulation is then as it was.
    pub fn release(&mut self, what: Release, event: Option<&str>) -> Result<(), SimulationError> {
        let words = match what {
            Release::Constraint(c) => match self.model.contacts.get(c) {
                Some(pair) if pair.always_holds() => format!("constraint {}", pair.name),
                Some(pair) => {
                    let reason = format!("{} is not a bilateral constraint, and cannot be released", pair.name);
                    return Err(SimulationError::Release(reason));
                }
                None => return Err(SimulationError::Release(format!("there is no constraint {c} to release"))),
            },
            Release::Prescription(p) => match self.model.prescriptions.get(p) {
                Some(prescription) => format!("prescribed motion {}", prescription.name),
                None => return Err(SimulationError::Release(format!("there is no prescription {p} to release"))),
            },
            Release::Part(p) => {
                self.model.parts.get(p).map_or_else(|| format!("part {p}"), |part| part.name().to_owned())
            }
        };
        if self.stage.released.contains(&what) {
            return Ok(());
        }
        let mut released = self.stage.released.clone();
        released.push(what);
        let acting = self.model.acting(&self.stage.off, &released).map_err(SimulationError::Release)?;
        let mut saved = self.save();
        if let Err(error) = self.switch(acting, &mut saved).and_then(|()| self.settle(false)) {
            self.undo(saved);
            return Err(error);
        }
        self.stage.released = released;
        let by = event.map_or(String::new(), |event| format!("event {event}: "));
        self.note(DecisionKind::Release, format!("{by}{words} no longer acts"));
        Ok(())
    }

    /// Whether each of [`Model::prescriptions`] acts: neither a stage nor a release switched it off.
    pub fn acting_prescriptions(&self) -> &[bool] {
        &self.system.present.acting.prescriptions
    }

    fn note(&mut self, kind: DecisionKind, reason: String) {
        let note: Decision = decision(self.step + 1, self.state.time, self.clock.dt(), kind, reason);
        self.log.decisions.push(note);
    }

    fn describe(&self, name: &str, scheme: Option<&dyn Scheme>, off: &Switches) -> String {
        let kind = scheme.map_or_else(|| "statics".to_owned(), |scheme| format!("dynamics ({})", scheme.name()));
        let mut names: Vec<String> = off.loads.iter().map(|&l| format!("load {}", self.model.loads[l].name)).collect();
        names.extend(
            off.prescriptions.iter().map(|&p| format!("prescribed motion {}", self.model.prescriptions[p].name)),
        );
        names.extend(off.contacts.iter().map(|&c| self.model.contacts[c].name.clone()));
        names.extend(off.parts.iter().map(|&p| self.model.parts[p].name().to_owned()));
        let off = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
        format!("stage {} ({name}) begins: {kind}, switched off: {off}", self.stage.number + 1)
    }

    /// Whether a stage fits the model, and the time at which it begins.
    pub(super) fn check_stage(&self, stage: &Stage, begin: Option<f64>) -> Result<(), SimulationError> {
        let fault = |reason: String| Err(SimulationError::Stage { stage: stage.name.clone(), reason });
        let Stage { scheme, step, end, .. } = stage;
        if !(*step > 0.0 && step.is_finite() && end.is_finite()) {
            return fault(format!("step size {step:e} and end {end:e} must be finite, the step size positive"));
        }
        if let Some(begin) = begin.filter(|begin| end <= begin) {
            return fault(format!("its end {end:e} is not after its beginning {begin:e}"));
        }
        if let Some(scheme) = scheme {
            if !self.system.inertia.exists {
                return fault("it is dynamic, and the simulation was made for statics alone".into());
            }
            check_scheme(&**scheme, &self.model).or_else(fault)?;
        }
        Ok(())
    }

    /// The stabilisation of a stage whose clock runs.
    pub(super) fn set_stabilisation(&mut self, how: Option<Stabilise>) {
        let how = how.filter(|_| self.how.scheme.is_none());
        self.system.present.stabilisation = how.map(|how| Stabilisation::new(&self.model, how, self.clock.length()));
    }

    fn save(&self) -> Saved {
        Saved {
            acting: self.system.present.acting.clone(),
            stage: self.stage.clone(),
            system: None,
            has_rates: self.system.present.has_rates,
            state: self.state.clone(),
            slots: self.slots.clone(),
            forces: self.forces.clone(),
            ledger: self.ledger.clone(),
            histories: self.histories(),
        }
    }

    fn undo(&mut self, saved: Saved) {
        if let Some(mut system) = saved.system {
            std::mem::swap(&mut system.solver, &mut self.system.solver);
            system.present.stabilisation = self.system.present.stabilisation.take();
            self.system = system;
        }
        for (pair, &acts) in self.model.contacts.iter_mut().zip(&saved.acting.contacts) {
            pair.acts = acts;
        }
        self.system.present.acting = saved.acting;
        self.set_has_rates(saved.has_rates);
        (self.stage, self.state, self.slots) = (saved.stage, saved.state, saved.slots);
        (self.forces, self.ledger) = (saved.forces, saved.ledger);
        // cannot fail: these methods wrote it themselves just before.
        self.load_histories(&saved.histories).unwrap_or(());
    }

    /// Changes what acts.
    fn switch(&mut self, acting: Acting, saved: &mut Saved) -> Result<(), SimulationError> {
        let prescribed = self.model.prescribed_components(&acting)?;
        self.stage.sudden = self.sudden_loads(&acting, Some(&self.system.present.acting));
        self.stage.departures = self.departures_of(&acting, Some(&self.system.present.acting));
        self.check_jump(&prescribed)?;
        let changed: Vec<usize> =
            (0..acting.contacts.len()).filter(|&c| acting.contacts[c] != self.model.contacts[c].acts).collect();
        changed.iter().for_each(|&c| self.model.contacts[c].acts = acting.contacts[c]);
        self.stage.held = held_nodes(&self.model, &acting);
        for c in changed {
            let acts = acting.contacts[c];
            self.slots.pressures[c].fill(0.0);
            self.slots.mean_pressures.get_mut(c).into_iter().for_each(|pressures| pressures.fill(0.0));
            self.slots.active[c].fill(acts && self.model.contacts[c].always_holds());
            self.ledger.stored[c] = [0.0; 2];
            if acts {
                self.begin_coupling(c)?;
            }
        }
        saved.system = self.install(acting, prescribed)?;
        self.set_bilateral()?;
        Ok(())
    }

    /// A coupling that was off acts again.
    fn begin_coupling(&mut self, c: usize) -> Result<(), SimulationError> {
        let pair = &mut self.model.contacts[c];
        let q = &self.state.q;
        let length = pair.term.length_scale();
        let rates = self.how.scheme.is_some();
        let begins =
            StepContext { rates, reach: length, held: &self.stage.held, ..at_rest(&self.state, self.clock.dt()) };
        let term = &mut pair.term;
        if term.unilateral().is_some() {
            // What slid before has no meaning where the surfaces are now.
            term.begin(&begins).map_err(StepError::from)?;
            term.commit(&At::end(q, &self.slots.pressures[c], &self.slots.active[c]));
        }
        if term.bilateral().is_some() {
            term.begin(&begins).map_err(StepError::from)?;
            let mut farthest = (0.0, None);
            let weights: Vec<f64> = (0..term.slot_count()).map(|slot| term.slot_weight(slot)).collect();
            term.assemble(&At::end(q, &self.slots.pressures[c], &self.slots.active[c]), false, &mut |local| {
                let rows = &local.residual[3 * local.nodes.len()..];
                for (&slot, row) in local.slots.iter().zip(rows) {
                    let distance = (row / weights[slot as usize]).abs();
                    if distance > farthest.0 {
                        farthest = (distance, local.nodes.first().copied());
                    }
                }
            })
            .map_err(StepError::from)?;
            if let (distance, Some(node)) = farthest
                && distance > length
            {
                let (what, place) = (format!("constraint {}", pair.name), node_name(&self.model, node, q));
                return Err(SimulationError::Jump { what, place, distance, length });
            }
        } else if term.potential().is_some() {
            // Springs that were stretched before have no meaning where the surfaces are now.
            term.load_history(&[]).map_err(StepError::from)?;
            self.ledger.stored[c][0] = term.energy(q).map_err(StepError::from)?;
        }
        Ok(())
    }

    /// Equations for what acts, with the same linear solver. Returns the system that was there before, if the numbering changed, with a solver that is not its own.
    pub(super) fn install(
        &mut self,
        acting: Acting,
        prescribed: Vec<(u32, u32, u32)>,
    ) -> Result<Option<System>, SimulationError> {
        let mut before = None;
        if acting.prescriptions == self.system.present.acting.prescriptions {
            self.system.present.acting = acting;
        } else {
            let has_mass = self.system.inertia.exists;
            let (solver, shares) = (Box::new(AutoSolver::new()), Arc::clone(&self.system.shares));
            let mut system = System::new(&self.model, acting, has_mass, solver, shares)?;
            std::mem::swap(&mut system.solver, &mut self.system.solver);
            // It goes on after a release.
            system.present.stabilisation = self.system.present.stabilisation.take();
            before = Some(std::mem::replace(&mut self.system, system));
        }
        self.set_has_rates(self.how.scheme.is_some());
        let mut reactions = vec![0.0; self.forces.reactions.len()];
        for &(component, ..) in &prescribed {
            reactions[component as usize] = self.forces.reactions[component as usize];
        }
        self.forces.reactions = reactions;
        self.stage.prescribed = prescribed;
        Ok(before)
    }

    /// Refuses components that are newly prescribed and far from where they have to be.
    fn check_jump(&self, prescribed: &[(u32, u32, u32)]) -> Result<(), SimulationError> {
        let time = self.state.time;
        for &(component, p, column) in prescribed {
            if self.stage.prescribed.binary_search_by_key(&component, |&(known, ..)| known).is_ok() {
                continue;
            }
            let node = component / 3;
            let wanted = self.model.prescriptions[p as usize].position(
                node,
                self.reference_of(component),
                time,
                column as usize,
            ) + self.offset(component, p, time);
            let distance = (wanted - self.state.q[component as usize]).abs();
            let length = self.edge_length(node);
            if distance > length {
                let place = format!("component {} of {}", component % 3, node_name(&self.model, node, &self.state.q));
                return Err(SimulationError::Jump {
                    what: format!("prescribed motion {}", self.model.prescriptions[p as usize].name),
                    place,
                    distance,
                    length,
                });
            }
        }
        Ok(())
    }

    /// Length of an edge of the body, or of the part, that a node belongs to.
    fn edge_length(&self, node: u32) -> f64 {
        let body = self.model.bodies.iter().find(|body| body.nodes.contains(&node));
        let part = self.model.parts.iter().find(|part| part.own_vectors().contains(&node));
        match (body, part) {
            (Some(body), _) => body.solid.characteristic_length(),
            (None, Some(part)) => part.length_scale(),
            // A node without equations cannot be far from anything.
            (None, None) => f64::INFINITY,
        }
    }

    fn start_velocities(&mut self, was_dynamic: bool) {
        let mut v = std::mem::take(&mut self.state.v);
        if self.how.scheme.is_none() {
            v.fill(0.0);
        } else {
            if !was_dynamic {
                v.copy_from_slice(&self.model.velocity);
                self.model.embedding.follow(&mut v);
            }
            self.set_prescribed_velocities(self.state.time, &mut v);
            self.meet_held_directions(self.state.time, |held| held.rate, &mut v);
            self.model.embedding.follow(&mut v);
        }
        self.state.v = v;
    }

    /// What follows from positions, velocities and what acts: accelerations, closed slots, the balance.
    fn settle(&mut self, new_stage: bool) -> Result<(), SimulationError> {
        self.state.a.clear();
        self.state.history.clear();
        if self.how.scheme.is_some() {
            self.complete_state()?;
        } else if new_stage {
            self.close_touching()?;
        } else {
            self.state.v.fill(0.0);
        }
        let before = self.ledger.balance;
        // Of the same positions; springs may have been switched.
        self.ledger.energies.clear();
        let strain = self.strain_energy(&self.state.q)?;
        let now = self.measure_balance(strain, before.external_work);
        let (contact, friction_stored) = self
            .ledger
            .stored
            .iter()
            .fold((0.0, 0.0), |(all, friction), stored| (all + stored[0], friction + stored[1]));
        let kinetic = now.kinetic - before.kinetic;
        let switched = (now.potential - before.potential) + (contact - before.contact) + (strain - before.strain);
        let given = if self.how.scheme.is_some() { kinetic } else { 0.0 };
        let dropped = if self.how.scheme.is_some() { 0.0 } else { -kinetic };
        self.ledger.balance = Balance {
            linear_momentum: now.linear_momentum,
            angular_momentum: now.angular_momentum,
            kinetic: now.kinetic,
            strain,
            potential: now.potential,
            contact,
            friction_stored,
            external_work: before.external_work + switched + given,
            dissipation: before.dissipation + dropped,
            largest_energy: now.largest_energy,
            ..before
        };
        Ok(())
    }
}
