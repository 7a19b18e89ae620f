//! Where prescriptions begin whose nodes are elsewhere when they are switched on.

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
    /// Time at which it was switched on.
    pub time: f64,
    /// Position of the component less the place that the table has for it at that time (a length).
    pub offset: f64,
}

impl Departure {
    /// Part of the offset that is left at a time, if nothing of it is left from `until` on.
    pub(crate) fn left(&self, until: f64, time: f64) -> f64 {
        if until == f64::INFINITY || time <= self.time {
            1.0
        } else if time >= until {
            0.0
        } else {
            (until - time) / (until - self.time)
        }
    }

    /// Rate of the part that is left just after a time, one over a time.
    pub(crate) fn rate(&self, until: f64, time: f64) -> f64 {
        // A time within round-off of the end is the end, as at a row of a table.
        if until == f64::INFINITY || time >= until - SAME_TIME * until.abs() { 0.0 } else { -1.0 / (until - self.time) }
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
