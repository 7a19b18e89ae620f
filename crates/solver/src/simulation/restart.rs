//! Checkpoints of a run, and going on from them.

use super::{Simulation, Stage, held_nodes};
use crate::run_state::{Ledger, NodalForces};
use crate::{Checkpoint, CheckpointError, Clock, SimulationError, StepControl, StepError};
use std::collections::BTreeMap;
use stoss_term::Term;

impl Simulation {
    /// The present state as a checkpoint.
    pub fn checkpoint(&self, tag: &str, attachments: BTreeMap<String, Vec<u8>>) -> Checkpoint {
        Checkpoint {
            tag: tag.to_owned(),
            clock: self.clock,
            stage: self.stage.clone(),
            step: self.step,
            state: self.state.clone(),
            slots: self.slots.clone(),
            ledger: self.ledger.clone(),
            forces: self.forces.clone(),
            log: self.log.clone(),
            largest_rate: self.impacts.largest_rate,
            histories: self.histories(),
            attachments,
        }
    }

    /// What each term carries from step to step.
    pub(super) fn histories(&self) -> Vec<Vec<u8>> {
        let of =
            |(number, term): (usize, &dyn Term)| self.system.shares.history(&self.model, number, term.save_history());
        self.model.terms().enumerate().map(of).collect()
    }

    /// Continues from a checkpoint of the same scene in the present stage (of a new simulation: the first one), to the end of this simulation.
    ///
    /// # Errors
    /// [`CheckpointError::Mismatch`] if tag, stage or sizes differ, or if the end is such that no step leads there ([`Clock::take_end_of`]).
    pub fn restore(&mut self, checkpoint: Checkpoint, tag: &str) -> Result<BTreeMap<String, Vec<u8>>, SimulationError> {
        let (own, other) = (self.stage.number, checkpoint.stage.number);
        if own != other {
            let reason = format!("it is in stage {other}, this run in stage {own}");
            return Err(SimulationError::Checkpoint(CheckpointError::Mismatch { reason }));
        }
        self.load(checkpoint, tag, None)
    }

    /// Continues from a checkpoint of the same scene in the stage [`Checkpoint::stage`], which is `stage`. The simulation may be in any stage before; a new one
    /// will do.
    ///
    /// # Errors
    /// The errors of [`Self::restore`]; the same if `stage` switches other things off; [`SimulationError::Stage`] if it is no stage of this model.
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
        if checkpoint.state.q.len() != self.state.q.len()
            || checkpoint.histories.len() != self.model.terms().count()
            || sizes(&checkpoint.slots.pressures) != sizes(&self.slots.pressures)
        {
            return Err(mismatch("numbers of unknowns or of terms differ".into()));
        }
        let off = stage.as_ref().map_or(&self.stage.off, |stage| &stage.off);
        if *off != checkpoint.stage.off {
            return Err(mismatch("the list of what is switched off in the stage differs".into()));
        }
        let acting = self.model.acting(off, &checkpoint.stage.released).map_err(mismatch)?;
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
                checkpoint.state.time
            )));
        }
        let prescribed = self.model.prescribed_components(&acting)?;
        for (pair, &acts) in self.model.contacts.iter_mut().zip(&acting.contacts) {
            pair.acts = acts;
        }
        let held = held_nodes(&self.model, &acting);
        let stabilise = stage.as_ref().map(|stage| stage.stabilise);
        if let Some(stage) = stage {
            self.how.control =
                StepControl { step: stage.step, automatic: stage.automatic, end: stage.end, ..self.how.control };
            (self.how.scheme, self.how.newton) = (stage.scheme, stage.newton);
        }
        self.install(acting, prescribed)?;
        self.load_histories(&checkpoint.histories)?;
        let Checkpoint { stage, step, state, slots, ledger, forces, log, largest_rate, attachments, .. } = checkpoint;
        // What is not written is that of this process, or follows from the rest.
        let own = std::mem::replace(&mut self.stage, stage);
        self.stage.prescribed = own.prescribed;
        self.stage.held = held;
        self.stage.sudden = if step > 0 { Vec::new() } else { own.sudden };
        self.clock = clock;
        if let Some(how) = stabilise {
            self.set_stabilisation(how);
        }
        (self.step, self.state, self.slots) = (step, state, slots);
        let books = std::mem::take(&mut self.ledger.books);
        self.ledger = Ledger { books, energies: Vec::new(), ..ledger };
        let has_force = |node: &u32| forces.contact.get(3 * *node as usize..).is_some_and(|f| f[..3] != [0.0; 3]);
        let pushed = self.model.embedding.nodes().iter().copied().filter(has_force).collect();
        self.forces = NodalForces { pushed, moved: BTreeMap::new(), ..forces };
        self.log = log;
        self.impacts.largest_rate = largest_rate;
        Ok(attachments)
    }

    pub(super) fn load_histories(&mut self, histories: &[Vec<u8>]) -> Result<(), StepError> {
        for ((.., term), bytes) in self.model.terms_mut(&self.system.present.acting).zip(histories) {
            term.load_history(bytes)?;
        }
        Ok(())
    }
}
