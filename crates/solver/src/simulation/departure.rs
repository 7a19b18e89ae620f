//! Prescriptions that begin where their nodes are when they are switched on.

use super::Simulation;
use crate::switches::Acting;
use serde::{Deserialize, Serialize};

/// Part of a time by which another one counts as the same.
const SAME_TIME: f64 = 1.0e-12;

/// Where a component was when its prescription was switched on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Departure {
    /// Component `3*node + i`.
    pub component: u32,
    /// Prescription, by its number in `Model::prescriptions`.
    pub prescription: u32,
    /// When.
    pub time: f64,
    /// How far it was beyond the place that the table has for it at that time (a length).
    pub offset: f64,
}

impl Departure {
    /// Part of the offset that is left at a time, if nothing of it is left from `until` on.
    fn left(&self, until: f64, time: f64) -> f64 {
        if until == f64::INFINITY || time <= self.time {
            1.0
        } else if time >= until {
            0.0
        } else {
            (until - time) / (until - self.time)
        }
    }

    /// Its rate just after a time, one over a time.
    fn rate(&self, until: f64, time: f64) -> f64 {
        // A time within round-off of the end is the end, as at a row of a table.
        if until == f64::INFINITY || time >= until - SAME_TIME * until.abs() { 0.0 } else { -1.0 / (until - self.time) }
    }
}

impl Simulation {
    /// What is added at a time to the position that the table of a prescription has for a component (a length).
    pub(super) fn offset(&self, component: u32, prescription: u32, time: f64) -> f64 {
        let found = self.departure(component, prescription);
        found.map_or(0.0, |(departure, until)| departure.offset * departure.left(until, time))
    }

    /// Its rate just after a time (a length per time).
    pub(super) fn rate_of_offset(&self, component: u32, prescription: u32, time: f64) -> f64 {
        let found = self.departure(component, prescription);
        found.map_or(0.0, |(departure, until)| departure.offset * departure.rate(until, time))
    }

    fn departure(&self, component: u32, prescription: u32) -> Option<(Departure, f64)> {
        let until = self.model.prescriptions[prescription as usize].ramp_until?;
        let key = (component, prescription);
        let k = self.departures.binary_search_by_key(&key, |d| (d.component, d.prescription)).ok()?;
        Some((self.departures[k], until))
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
                list.extend(self.departures.iter().copied().filter(|departure| departure.prescription == own));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_falls_linearly_or_stays() {
        let departure = Departure { component: 0, prescription: 0, time: 1.0, offset: 2.0 };
        assert_eq!([0.5, 1.0, 1.5, 3.0, 4.0].map(|time| departure.left(3.0, time)), [1.0, 1.0, 0.75, 0.0, 0.0]);
        assert_eq!([1.0, 2.0, 3.0 - 1e-15, 3.0].map(|time| departure.rate(3.0, time)), [-0.5, -0.5, 0.0, 0.0]);
        assert_eq!((departure.left(f64::INFINITY, 9.0), departure.rate(f64::INFINITY, 9.0)), (1.0, 0.0));
        // There is no time to get there: it is there at the end of the first step.
        assert_eq!((departure.left(1.0, 1.25), departure.rate(1.0, 1.0)), (0.0, 0.0));
    }
}
