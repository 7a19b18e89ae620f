//! States of the Gauss points of a body whose law has some: the end of a step, what it lost, and the states as numbers for restarts and output.

use crate::{MaterialPoint, OutputPlace, SolidBody, SolidError, StepEnd, recovery};
use stoss_continuum::{Material, Mechanisms, StateEntry};

impl SolidBody {
    /// Whether the law has a state.
    pub fn has_history(&self) -> bool {
        self.history().is_some()
    }

    /// Which ways of losing energy the law has; none of an elastic one.
    pub fn mechanisms(&self) -> Mechanisms {
        self.history().map_or_else(Mechanisms::default, |material| material.mechanisms())
    }

    pub(crate) fn history(&self) -> Option<&dyn Material> {
        self.material().law.history()
    }

    /// What the step that has begun did if it ends at `q_np1`: what is stored then and what was lost; `None` of an elastic law. Changes nothing.
    ///
    /// # Errors
    /// Those of [`Self::strain_energy`], [`SolidError::StepNotBegun`].
    pub fn step_end(&self, q_np1: &[f64]) -> Result<Option<StepEnd>, SolidError> {
        if !self.has_history() {
            return Ok(None);
        }
        self.check_length("the positions q_np1", q_np1)?;
        if !self.has_begun() {
            return Err(SolidError::StepNotBegun { body: self.name().to_string() });
        }
        let mut end = StepEnd::default();
        self.for_each_block(|block, cells| block.add_step_end(self.material(), cells.nodes(), q_np1, &mut end))?;
        Ok(Some(end))
    }

    /// What hardening has stored in the accepted states.
    pub fn hardening_energy(&self) -> f64 {
        let mut total = 0.0;
        self.blocks().iter().for_each(|block| block.add_hardening_energy(self.material(), &mut total));
        total
    }

    /// The step that has begun was accepted with this end: the states at its end are those at the begin of the next one. Nothing happens to an elastic law.
    ///
    /// # Errors
    /// Those of [`Self::step_end`], which is to be asked before: states of some elements may have changed.
    pub fn end_step(&mut self, q_np1: &[f64]) -> Result<(), SolidError> {
        if !self.has_history() {
            return Ok(());
        }
        self.check_length("the positions q_np1", q_np1)?;
        if !self.has_begun() {
            return Err(SolidError::StepNotBegun { body: self.name().to_string() });
        }
        let mut failed = None;
        let (material, blocks) = self.blocks_with_material();
        for (cells, block) in blocks {
            if let Err((element, failure)) = block.commit(material, cells.nodes(), q_np1) {
                failed = failed.or(Some((cells.first() as usize + element, failure)));
            }
        }
        match failed {
            None => Ok(()),
            Some((element, failure)) => Err(self.error(element, failure)),
        }
    }

    /// The numbers of the state of a point; none of an elastic law.
    pub fn state_entries(&self) -> &[StateEntry] {
        self.history().map_or(&[], |material| material.state())
    }

    /// The numbers of an output at a material point: the functions through the Gauss points of its element, as for stresses; means of the element of what jumps.
    ///
    /// # Errors
    /// [`SolidError::InvertedElement`], [`SolidError::CollapsedElement`], [`SolidError::Length`].
    pub fn state_output_at(
        &self,
        point: &MaterialPoint,
        q: &[f64],
        place: OutputPlace,
    ) -> Result<Vec<f64>, SolidError> {
        self.check_length("the positions", q)?;
        let (cells, block, local) = self.locate(point.element);
        let weights = recovery::to_places(cells.kind(), block.rule(), &[point.natural], place.jumps);
        let (mut values, mut all) = (vec![0.0; place.len], vec![0.0; place.all]);
        block
            .visit_points(self.material(), cells.nodes(), local, q, &mut |at| {
                self.write_outputs(at.before, at.state, &mut all);
                let numbers = &all[place.first..place.first + place.len];
                values.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += weights[at.gauss_point] * number);
                Ok(())
            })
            .map_err(|failure| self.error(point.element, failure))?;
        Ok(values)
    }

    /// Sets an entry of the accepted states to the same numbers at all points of an element: `[element][number]`, for constants of the material that differ from element to
    /// element, as directions of fibres. Nothing else is touched.
    ///
    /// # Errors
    /// [`SolidError::Length`] if there is no such entry, or another count of numbers.
    pub fn set_state_of_elements(&mut self, name: &str, numbers: &[f64]) -> Result<(), SolidError> {
        let (mut len, mut found) = (0, None);
        for entry in self.state_entries() {
            if entry.name == name {
                found = Some(len..len + entry.len);
            }
            len += entry.len;
        }
        let place = found.unwrap_or(0..0);
        let expected = place.len() * self.element_count();
        if numbers.len() != expected || expected == 0 {
            let (name, what) = (self.name().to_string(), "the numbers of the elements");
            return Err(SolidError::Length { name, what, found: numbers.len(), expected });
        }
        let mut of_elements = numbers.chunks_exact(place.len());
        for block in self.blocks_mut() {
            let points = len * block.rule().len();
            for (states, own) in block.states_mut().chunks_exact_mut(points).zip(&mut of_elements) {
                states.chunks_exact_mut(len).for_each(|state| state[place.clone()].copy_from_slice(own));
            }
        }
        Ok(())
    }

    /// The accepted states of all Gauss points, `[element][point][number]`, the elements in their order; empty of an elastic law.
    pub fn states(&self) -> impl Iterator<Item = &[f64]> {
        self.blocks().iter().map(|block| block.states())
    }

    /// Takes accepted states, as many as [`Self::states`] gives.
    ///
    /// # Errors
    /// [`SolidError::Length`] if they are of another mesh or law.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), SolidError> {
        let expected: usize = self.states().map(<[f64]>::len).sum();
        if states.len() != expected {
            return Err(SolidError::Length {
                name: self.name().to_string(),
                what: "the states of the Gauss points",
                found: states.len(),
                expected,
            });
        }
        let mut rest = states;
        for block in self.blocks_mut() {
            let (own, others) = rest.split_at(block.states().len());
            block.states_mut().copy_from_slice(own);
            rest = others;
        }
        Ok(())
    }
}
