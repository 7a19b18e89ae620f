//! The elements of a body that one rank of several has. Not which these are: that takes all bodies, see [`stoss_term::bisect`].

use crate::{SolidBody, SolidError, Volumetric, own::Own};
use stoss_reference_element::CellKind;

impl SolidBody {
    /// Keeps the data of some elements only, those of one rank of several: a flag for each element of the body. Stencils, forces, tangents, energies, masses, states and what is made
    /// of them are then those of these elements, and their sums over all ranks are those of the body. Number of elements, volume, scales, loads, and numbers of elements
    /// in messages remain those of the whole body. Accepted states of these elements stay; a step has to begin again, and masses are to be made again. A body may be shared again, with states among fewer
    /// elements. Data of elements are made when something needs them first: of a body that is shared before a run those of other ranks are never made.
    ///
    /// # Errors
    /// [`SolidError::Length`] unless there is a flag for each element, [`SolidError::Indivisible`], [`SolidError::OnOtherRank`]; then nothing has changed.
    pub fn share(&mut self, mine: &[bool]) -> Result<(), SolidError> {
        let expected = self.element_count();
        if mine.len() != expected {
            let (name, what) = (self.name().to_string(), "the flags of the elements");
            return Err(SolidError::Length { name, what, found: mine.len(), expected });
        }
        if self.is_indivisible() && mine.iter().any(|flag| *flag != mine[0]) {
            return Err(SolidError::Indivisible { body: self.name().to_string() });
        }
        let missing = |element: &usize| self.has_history() && mine[*element] && !self.has_element(*element);
        if let Some(element) = (0..expected).find(missing) {
            return Err(SolidError::OnOtherRank { body: self.name().to_string(), element });
        }
        let own = Own::flagged(self.elements(), mine);
        // Of elements that nobody has asked for yet the data were never made.
        let mut states = Vec::new();
        if self.has_history() && self.has_blocks() {
            self.for_each_state_mut(|element, state| {
                if mine[element] {
                    states.extend_from_slice(state);
                }
            });
        }
        self.set_own(own);
        let mut rest = states.as_slice();
        if !rest.is_empty() {
            self.for_each_state_mut(|_, state| {
                let (of_element, others) = rest.split_at(state.len());
                state.copy_from_slice(of_element);
                rest = others;
            });
        }
        Ok(())
    }

    /// Whether the elements were shared out among ranks, so that what this body gives is to be added up over them. It is the same on all ranks.
    pub fn is_shared(&self) -> bool {
        self.own().is_share()
    }

    /// Whether the data of an element are here.
    pub fn has_element(&self, element: usize) -> bool {
        self.own().place(element).is_some()
    }

    /// Whether averages reach across elements, so that one rank has to have all of them: in mixed bodies of tet4.
    pub fn is_indivisible(&self) -> bool {
        let mut blocks = self.elements().blocks().iter();
        self.options().volumetric == Volumetric::Mixed && blocks.any(|cells| cells.kind() == CellKind::Tet4)
    }

    /// The mean reference position of the nodes of each element of the body, a length.
    pub fn element_centres(&self) -> impl Iterator<Item = [f64; 3]> {
        self.elements().iter().map(|nodes| {
            let sum = nodes.iter().fold([0.0; 3], |sum, &node| {
                let x = self.reference_position(node);
                std::array::from_fn(|i| sum[i] + x[i])
            });
            sum.map(|x| x / nodes.len() as f64)
        })
    }

    /// The history of the body, as one rank with all elements saves it, of those of all ranks. `owner`: the rank of each element.
    ///
    /// # Errors
    /// [`SolidError::Length`] unless there is an owner for each element and the history of each rank is that of its elements.
    pub fn merge_history(&self, parts: &[Vec<u8>], owner: &[u32]) -> Result<Vec<u8>, SolidError> {
        let length =
            |what, found, expected| Err(SolidError::Length { name: self.name().to_string(), what, found, expected });
        let lengths = self.state_lengths();
        if owner.len() != lengths.len() {
            return length("the owners of the elements", owner.len(), lengths.len());
        }
        let mut needed = vec![0; parts.len()];
        for (&rank, &numbers) in owner.iter().zip(&lengths) {
            let Some(needed) = needed.get_mut(rank as usize) else {
                return length("the histories of the ranks", parts.len(), rank as usize + 1);
            };
            *needed += numbers * size_of::<f64>();
        }
        if let Some((part, needed)) = parts.iter().zip(&needed).find(|(part, needed)| part.len() != **needed) {
            return length("the history of a rank", part.len(), *needed);
        }
        let mut rest: Vec<&[u8]> = parts.iter().map(Vec::as_slice).collect();
        let mut merged = Vec::with_capacity(needed.iter().sum());
        for (&rank, &numbers) in owner.iter().zip(&lengths) {
            let (of_element, others) = rest[rank as usize].split_at(numbers * size_of::<f64>());
            merged.extend_from_slice(of_element);
            rest[rank as usize] = others;
        }
        Ok(merged)
    }
}
