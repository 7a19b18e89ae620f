//! Loads and prescribed motions that a program sets while the run goes on.

use super::Simulation;
use crate::{Model, SimulationError, Table};
use std::collections::BTreeSet;

/// What a program sets between steps, by its number in the model. Its values are the columns of its table: the magnitudes of a load, or the displacements of a
/// prescription (a length each) and, if it rotates, the angle in degrees after them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Steered {
    /// A load, by its number in `Model::loads`.
    Load(usize),
    /// A prescription, by its number in `Model::prescriptions`.
    Prescription(usize),
}

impl Steered {
    /// Functions of time of what is steered; none if the model has no such thing.
    fn tables<'a>(&self, model: &'a Model) -> Vec<&'a Table> {
        match *self {
            Self::Load(l) => model.loads.get(l).map(|load| &load.magnitude).into_iter().collect(),
            Self::Prescription(p) => {
                let of = |p: &'a crate::Prescription| {
                    std::iter::once(&p.displacement).chain(p.rotation.as_ref().map(|rotation| rotation.degrees()))
                };
                model.prescriptions.get(p).into_iter().flat_map(of).collect()
            }
        }
    }

    fn tables_mut<'a>(&self, model: &'a mut Model) -> Vec<&'a mut Table> {
        match *self {
            Self::Load(l) => model.loads.get_mut(l).map(|load| &mut load.magnitude).into_iter().collect(),
            Self::Prescription(p) => {
                let of = |p: &'a mut crate::Prescription| {
                    let degrees = p.rotation.as_mut().map(|rotation| rotation.degrees_mut());
                    std::iter::once(&mut p.displacement).chain(degrees)
                };
                model.prescriptions.get_mut(p).into_iter().flat_map(of).collect()
            }
        }
    }

    /// Whether a component of a node has a second prescription, which would contradict this one.
    fn is_shared(&self, model: &Model) -> bool {
        let Self::Prescription(p) = *self else { return false };
        let own = &model.prescriptions[p];
        let nodes: BTreeSet<u32> = own.nodes.iter().copied().collect();
        let others = model.prescriptions.iter().enumerate().filter(|(other, _)| *other != p);
        others.map(|(_, other)| other).any(|other| {
            other.components.iter().any(|component| own.components.contains(component))
                && other.nodes.iter().any(|node| nodes.contains(node))
        })
    }
}

impl Simulation {
    /// Lets a load or a prescription be set while the run goes on ([`Self::lead`]). Before the first step: what is steered is not taken for constant, so that nothing is
    /// promised of the energy.
    ///
    /// # Errors
    /// [`SimulationError::Model`] if there is no such thing, or another prescription holds some of its nodes in the same direction.
    pub fn steer(&mut self, what: Steered) -> Result<(), SimulationError> {
        if what.tables(&self.model).is_empty() {
            return Err(SimulationError::Model(format!("{what:?} cannot be steered: the model has no such thing")));
        }
        if what.is_shared(&self.model) {
            return Err(SimulationError::Model(
                "it cannot be steered: another prescribed motion holds some of its nodes in the same direction; let their sets not overlap".into(),
            ));
        }
        what.tables_mut(&mut self.model).into_iter().for_each(Table::steer);
        Ok(())
    }

    /// The values of what is steered at a time; empty if there is no such thing.
    pub fn steered_values(&self, what: Steered, time: f64) -> Vec<f64> {
        let tables = what.tables(&self.model);
        tables.iter().flat_map(|table| (0..table.columns()).map(|column| table.value(time, column))).collect()
    }

    /// Sets what is steered: from its present values it goes linearly to `values` at the time `until`, or at the end of the next step unless that is cut, and stays
    /// there. It has no jump, so that every scheme sees the same function.
    ///
    /// # Errors
    /// [`SimulationError::Model`] if it is not steered, the number of values is another, one is not finite, or `until` is not after the present time.
    pub fn lead(&mut self, what: Steered, values: &[f64], until: Option<f64>) -> Result<(), SimulationError> {
        let refuse = |reason: String| Err(SimulationError::Model(reason));
        let tables = what.tables(&self.model);
        if tables.is_empty() || !tables.iter().all(|table| table.is_steered()) {
            return refuse("it is not steered: name it before the run starts".into());
        }
        let count: usize = tables.iter().map(|table| table.columns()).sum();
        if values.len() != count {
            return refuse(format!("{} values were given, and it has {count}", values.len()));
        }
        if let Some(value) = values.iter().find(|value| !value.is_finite()) {
            return refuse(format!("the value {value} is not finite"));
        }
        let now = self.state.time;
        let until = until.unwrap_or_else(|| match self.clock.finished() {
            // A stage may follow, or nothing.
            true => now + self.how.control.step,
            false => self.clock.next_time(),
        });
        if !(until.is_finite() && until > now) {
            return refuse(format!("its values are to be reached at t = {until}, which is not after t = {now}"));
        }
        let mut rest = values;
        for table in what.tables_mut(&mut self.model) {
            let (own, others) = rest.split_at(table.columns());
            table.lead(now, until, own);
            rest = others;
        }
        Ok(())
    }

    /// The functions of time of all that is steered, in the order of loads and prescriptions, for a checkpoint.
    pub fn steered_tables(&self) -> Vec<Table> {
        let all = all(&self.model).flat_map(|what| what.tables(&self.model));
        all.filter(|table| table.is_steered()).cloned().collect()
    }

    /// Takes back what [`Self::steered_tables`] gave, before the state is restored.
    ///
    /// # Errors
    /// [`SimulationError::Model`] if other things are steered.
    pub fn restore_steered(&mut self, saved: &[Table]) -> Result<(), SimulationError> {
        let mut saved = saved.iter();
        for what in all(&self.model).collect::<Vec<_>>() {
            for table in what.tables_mut(&mut self.model).into_iter().filter(|table| table.is_steered()) {
                match saved.next() {
                    Some(other) if other.columns() == table.columns() && other.is_steered() => table.clone_from(other),
                    _ => return Err(other_steered()),
                }
            }
        }
        if saved.next().is_some() { Err(other_steered()) } else { Ok(()) }
    }
}

fn other_steered() -> SimulationError {
    SimulationError::Model("other loads or prescribed motions were steered when the checkpoint was written".into())
}

fn all(model: &Model) -> impl Iterator<Item = Steered> + use<> {
    (0..model.loads.len()).map(Steered::Load).chain((0..model.prescriptions.len()).map(Steered::Prescription))
}
