//! All terms of a model as one list. What every term is told in a step goes through here.

use crate::switches::Acting;
use crate::{Load, Model};
use stoss_term::Term;

/// The line of the residual that a term adds to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Line {
    /// The line of the forces: a body, a part, a load.
    Force,
    /// The line of the constraints: the coupling of this number.
    Constraint(usize),
}

impl Model {
    /// Bodies and parts, in this order, each with whether it acts: what stores energy beside the couplings.
    pub(crate) fn forces<'a>(&'a self, acting: &'a Acting) -> impl Iterator<Item = (&'a dyn Term, bool)> {
        let bodies = self.bodies.iter().map(|body| (&body.solid as &dyn Term, true));
        bodies.chain(self.parts.iter().map(|part| &**part as &dyn Term).zip(acting.parts.iter().copied()))
    }

    /// Loads that are not switched off.
    pub(crate) fn acting_loads<'a>(&'a self, acting: &'a Acting) -> impl Iterator<Item = &'a Load> {
        self.loads.iter().zip(&acting.loads).filter(|(_, acts)| **acts).map(|(load, _)| load)
    }

    /// Every term: bodies, parts, loads, couplings, in this order.
    pub(crate) fn terms(&self) -> impl Iterator<Item = &dyn Term> {
        let bodies = self.bodies.iter().map(|body| &body.solid as &dyn Term);
        let parts = self.parts.iter().map(|part| &**part as &dyn Term);
        let loads = self.loads.iter().map(|load| load as &dyn Term);
        bodies.chain(parts).chain(loads).chain(self.contacts.iter().map(|pair| &*pair.term as &dyn Term))
    }

    /// The terms as of [`Self::terms`], each with its line and whether it acts, to be changed.
    pub(crate) fn terms_mut<'a>(
        &'a mut self,
        acting: &'a Acting,
    ) -> impl Iterator<Item = (Line, bool, &'a mut dyn Term)> {
        let bodies = self.bodies.iter_mut().map(|body| (Line::Force, true, &mut body.solid as &mut dyn Term));
        let parts = self.parts.iter_mut().zip(&acting.parts);
        let parts = parts.map(|(part, &acts)| (Line::Force, acts, &mut **part as &mut dyn Term));
        let loads = self.loads.iter_mut().zip(&acting.loads);
        let loads = loads.map(|(load, &acts)| (Line::Force, acts, load as &mut dyn Term));
        let pairs = self.contacts.iter_mut().enumerate();
        let pairs = pairs.map(|(c, pair)| (Line::Constraint(c), pair.acts, &mut *pair.term as &mut dyn Term));
        bodies.chain(parts).chain(loads).chain(pairs)
    }
}
