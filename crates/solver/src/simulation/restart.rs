//! Checkpoints of a run, and going on from them.

use super::{Simulation, Stage, support};
use crate::{Checkpoint, CheckpointError, Clock, SimulationError, StepControl, StepError};
use std::collections::BTreeMap;
use stoss_integrators::State;

impl Simulation {
    /// The present state as a checkpoint.
    pub fn checkpoint(&self, tag: &str, attachments: BTreeMap<String, Vec<u8>>) -> Checkpoint {
        Checkpoint {
            tag: tag.to_owned(),
            clock: self.clock,
            stage: self.stage.number,
            off: self.stage.off.clone(),
            released: self.stage.released.clone(),
            departures: self.stage.departures.clone(),
            stored: self.ledger.stored.clone(),
            step: self.step,
            time: self.state.time,
            q: self.state.q.clone(),
            v: self.state.v.clone(),
            a: self.state.a.clone(),
            history: self.state.history.clone(),
            pressures: self.slots.pressures.clone(),
            mean_pressures: self.slots.mean_pressures.clone(),
            active: self.slots.active.clone(),
            histories: self.histories(),
            reactions: self.forces.reactions.clone(),
            contact_force: self.forces.contact.clone(),
            balance: self.ledger.balance,
            timings: self.log.timings,
            decisions: self.log.decisions.clone(),
            solves: self.log.solves,
            largest_rate: self.impacts.largest_rate,
            attachments,
        }
    }

    /// What each term carries from step to step.
    pub(super) fn histories(&self) -> Vec<Vec<u8>> {
        self.model.terms().map(|term| term.save_history()).collect()
    }

    /// Continues from a checkpoint of the same scene in the present stage (of a new simulation: the first one), to the end of this simulation.
    ///
    /// # Errors
    /// [`CheckpointError::Mismatch`] if tag, stage or sizes differ, or if the end is such that no step leads there ([`Clock::take_end_of`]).
    pub fn restore(&mut self, checkpoint: Checkpoint, tag: &str) -> Result<BTreeMap<String, Vec<u8>>, SimulationError> {
        if checkpoint.stage != self.stage.number {
            let reason = format!("it is in stage {}, this run in stage {}", checkpoint.stage, self.stage.number);
            return Err(SimulationError::Checkpoint(CheckpointError::Mismatch { reason }));
        }
        self.load(checkpoint, tag, None)
    }

    /// Continues from a checkpoint of the same scene in the stage [`Checkpoint::stage`], which is `stage`. The simulation may be in any stage before; a new one
    /// will do.
    ///
    /// # Errors
    /// As [`Self::restore`]; the same if `stage` switches other things off; [`SimulationError::Stage`] if it is no stage of this model.
    pub fn restore_in(
        &mut self,
        stage: Stage,
        checkpoint: Checkpoint,
        tag: &str,
    ) -> Result<BTreeMap<String, Vec<u8>>, SimulationError> {
        self.load(checkpoint, tag, Some(stage))
    }

    fn load(
        &mut self,
        checkpoint: Checkpoint,
        tag: &str,
        stage: Option<Stage>,
    ) -> Result<BTreeMap<String, Vec<u8>>, SimulationError> {
        let mismatch = |reason: String| SimulationError::Checkpoint(CheckpointError::Mismatch { reason });
        if checkpoint.tag != tag {
            return Err(mismatch(format!("it was written for {}, but this is {tag}", checkpoint.tag)));
        }
        let sizes = |p: &[Vec<f64>]| p.iter().map(Vec::len).collect::<Vec<_>>();
        if checkpoint.q.len() != self.state.q.len()
            || checkpoint.histories.len() != self.model.terms().count()
            || sizes(&checkpoint.pressures) != sizes(&self.slots.pressures)
        {
            return Err(mismatch("numbers of unknowns or of terms differ".into()));
        }
        let off = stage.as_ref().map_or(&self.stage.off, |stage| &stage.off);
        if *off != checkpoint.off {
            return Err(mismatch("the list of what is switched off in the stage differs".into()));
        }
        let acting = self.model.acting(off, &checkpoint.released).map_err(mismatch)?;
        let mut clock = checkpoint.clock;
        let end = match &stage {
            Some(stage) => {
                self.check_stage(stage, None)?;
                let Stage { step, automatic, end, .. } = *stage;
                Clock::new(StepControl { step, automatic, end, ..self.how.control })
            }
            None => self.clock,
        };
        if !clock.take_end_of(&end) {
            return Err(mismatch(format!(
                "it is at t = {}, which is after the new end of the run, or the end of a step that was shortened to meet the old one",
                checkpoint.time
            )));
        }
        let prescribed = self.model.prescribed_components(&acting)?;
        for (pair, &acts) in self.model.contacts.iter_mut().zip(&acting.contacts) {
            pair.acts = acts;
        }
        self.stage.support = support(&self.model, &acting);
        let stabilise = stage.as_ref().map(|stage| stage.stabilise);
        if let Some(stage) = stage {
            self.how.control =
                StepControl { step: stage.step, automatic: stage.automatic, end: stage.end, ..self.how.control };
            (self.how.scheme, self.how.newton) = (stage.scheme, stage.newton);
        }
        self.install(acting, prescribed)?;
        self.load_histories(&checkpoint.histories)?;
        self.stage.number = checkpoint.stage;
        self.stage.off = checkpoint.off;
        self.stage.released = checkpoint.released;
        self.ledger.stored = checkpoint.stored;
        self.ledger.energies.clear();
        self.stage.departures = checkpoint.departures;
        self.clock = clock;
        if let Some(how) = stabilise {
            self.set_stabilisation(how);
        }
        self.step = checkpoint.step;
        if self.step > 0 {
            self.stage.sudden.clear();
        }
        self.state = State {
            time: checkpoint.time,
            q: checkpoint.q,
            v: checkpoint.v,
            a: checkpoint.a,
            history: checkpoint.history,
        };
        self.slots.pressures = checkpoint.pressures;
        self.slots.mean_pressures = checkpoint.mean_pressures;
        self.slots.active = checkpoint.active;
        self.forces.reactions = checkpoint.reactions;
        self.forces.contact = checkpoint.contact_force;
        let has_force = |node: &u32| self.forces.contact[3 * *node as usize..][..3] != [0.0; 3];
        let embedded = self.model.embedding.nodes().iter().copied();
        self.forces.pushed =
            if self.forces.contact.is_empty() { Vec::new() } else { embedded.filter(has_force).collect() };
        self.ledger.balance = checkpoint.balance;
        self.log.timings = checkpoint.timings;
        self.log.decisions = checkpoint.decisions;
        self.log.solves = checkpoint.solves;
        self.impacts.largest_rate = checkpoint.largest_rate;
        Ok(checkpoint.attachments)
    }

    pub(super) fn load_histories(&mut self, histories: &[Vec<u8>]) -> Result<(), StepError> {
        for ((.., term), bytes) in self.model.terms_mut(&self.system.present.acting).zip(histories) {
            term.load_history(bytes)?;
        }
        Ok(())
    }
}
