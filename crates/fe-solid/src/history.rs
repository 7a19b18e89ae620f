//! States of the Gauss points of a body whose law has some: the end of a step, what it lost, and the states as numbers for restarts and output.

use crate::{MaterialPoint, OutputPlace, SolidBody, SolidError, StepEnd, recovery};
use std::iter::repeat_n;
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

    /// What the step that has begun did if it ends at `q_np1`: what is stored then and what was lost; `None` of an elastic law. Changes nothing. Of a share what its elements did.
    ///
    /// # Errors
    /// The errors of [`Self::strain_energy`], [`SolidError::StepNotBegun`].
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

    /// What hardening has stored in the accepted states; of a share in those of its elements.
    pub fn hardening_energy(&self) -> f64 {
        let mut total = 0.0;
        self.blocks().iter().for_each(|block| block.add_hardening_energy(self.material(), &mut total));
        total
    }

    /// The step that has begun was accepted with this end: the states at its end are those at the begin of the next one. Nothing happens to an elastic law.
    ///
    /// # Errors
    /// The errors of [`Self::step_end`], which is to be asked before: states of some elements may have changed.
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
            Some((element, failure)) => Err(self.error(self.own().number(element), failure)),
        }
    }

    /// The numbers of the state of a point; none of an elastic law.
    pub fn state_entries(&self) -> &[StateEntry] {
        self.history().map_or(&[], |material| material.state())
    }

    /// The numbers of an output at a material point: the functions through the Gauss points of its element, as for stresses; means of the element of what jumps. Zeros where another
    /// rank has the element, so that the sum over all ranks is the value.
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
        let Some((cells, block, local)) = self.locate(point.element) else { return Ok(vec![0.0; place.len]) };
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
    /// element, as directions of fibres. Nothing else is touched. A share takes the numbers of all elements of the body, too.
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
        self.for_each_state_mut(|element, states| {
            let own = &numbers[place.len() * element..place.len() * (element + 1)];
            states.chunks_exact_mut(len).for_each(|state| state[place.clone()].copy_from_slice(own));
        });
        Ok(())
    }

    /// Calls with the number in the body of each element that is here, and with the states of its points.
    pub(crate) fn for_each_state_mut(&mut self, mut call: impl FnMut(usize, &mut [f64])) {
        let (own, len) = (self.own().clone(), self.state_len());
        let mut elements = 0..;
        for block in self.blocks_mut() {
            let of_element = (len * block.rule().len()).max(1);
            for (states, element) in block.states_mut().chunks_exact_mut(of_element).zip(&mut elements) {
                call(own.number(element), states);
            }
        }
    }

    /// Numbers of the state of a point.
    pub(crate) fn state_len(&self) -> usize {
        self.history().map_or(0, |material| material.state_len())
    }

    /// The accepted states of the Gauss points, `[element][point][number]`, the elements in their order; empty of an elastic law. Of a share those of its elements:
    /// [`Self::merge_history`] makes those of the body of them.
    pub fn states(&self) -> impl Iterator<Item = &[f64]> {
        self.blocks().iter().map(|block| block.states())
    }

    /// Takes accepted states of all elements of the body; a share keeps those of its own.
    ///
    /// # Errors
    /// [`SolidError::Length`] if they are of another mesh or law.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), SolidError> {
        let lengths = self.state_lengths();
        let expected: usize = lengths.iter().sum();
        if states.len() != expected {
            return Err(SolidError::Length {
                name: self.name().to_string(),
                what: "the states of the Gauss points",
                found: states.len(),
                expected,
            });
        }
        let (mut next, mut start) = (0, 0);
        self.for_each_state_mut(|element, own| {
            start += lengths[next..element].iter().sum::<usize>();
            own.copy_from_slice(&states[start..start + own.len()]);
            (next, start) = (element + 1, start + own.len());
        });
        Ok(())
    }

    /// How many numbers the states of each element of the body are.
    pub(crate) fn state_lengths(&self) -> Vec<usize> {
        let (len, options) = (self.state_len(), self.options());
        let blocks = self.elements().blocks().iter();
        blocks.flat_map(|cells| repeat_n(len * options.rule(cells.kind()).len(), cells.len())).collect()
    }
}
