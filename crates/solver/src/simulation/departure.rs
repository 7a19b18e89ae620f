//! Prescriptions that begin where their nodes are when they are switched on.

use super::Simulation;
use crate::Departure;
use crate::switches::Acting;

impl Simulation {
    /// What is added at a time to the position that the table of a prescription has for a component (a length).
    pub(super) fn offset(&self, component: u32, prescription: u32, time: f64) -> f64 {
        let found = self.departure(component, prescription);
        found.map_or(0.0, |(departure, until)| departure.offset * departure.left(until, time))
    }

    /// Rate of the offset just after a time (a length per time).
    pub(super) fn rate_of_offset(&self, component: u32, prescription: u32, time: f64) -> f64 {
        let found = self.departure(component, prescription);
        found.map_or(0.0, |(departure, until)| departure.offset * departure.rate(until, time))
    }

    fn departure(&self, component: u32, prescription: u32) -> Option<(Departure, f64)> {
        let until = self.model.prescriptions[prescription as usize].ramp_until?;
        let key = (component, prescription);
        let k = self.stage.departures.binary_search_by_key(&key, |d| (d.component, d.prescription)).ok()?;
        Some((self.stage.departures[k], until))
    }

    /// Departures for what is to act at the present time and positions: the present ones of what acted `before` already, new ones of what did not.
    pub(super) fn departures_of(&self, acting: &Acting, before: Option<&Acting>) -> Vec<Departure> {
        let (time, q) = (self.state.time, &self.state.q);
        let mut list = Vec::new();
        for (p, prescription) in self.model.prescriptions.iter().enumerate().filter(|&(p, _)| acting.prescriptions[p]) {
            if prescription.ramp_until.is_none() {
                continue;
            }
            let own = p as u32;
            if before.is_some_and(|before| before.prescriptions[p]) {
                list.extend(self.stage.departures.iter().copied().filter(|departure| departure.prescription == own));
                continue;
            }
            for &node in &prescription.nodes {
                for (column, &i) in prescription.components.iter().enumerate() {
                    let component = 3 * node + u32::from(i);
                    let place = prescription.position(node, self.reference_of(component), time, column);
                    let offset = q[component as usize] - place;
                    list.push(Departure { component, prescription: own, time, offset });
                }
            }
        }
        list.sort_unstable_by_key(|departure| (departure.component, departure.prescription));
        list
    }
}
