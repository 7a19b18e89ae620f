//! The state that a scheme carries from step to step.

/// Positions, velocities and what some schemes keep in addition, at one time; vectors over all coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Time.
    pub time: f64,
    /// Positions, a length each.
    pub q: Vec<f64>,
    /// Velocities, a length over time each.
    pub v: Vec<f64>,
    /// Accelerations; empty for schemes that carry none.
    pub a: Vec<f64>,
    /// Forces `H` of the last end point ([`crate::HistoryTerm`]); empty for schemes that need none.
    pub history: Vec<f64>,
}

impl State {
    /// State at time zero, before [`crate::start`].
    pub fn new(q: Vec<f64>, v: Vec<f64>) -> Self {
        Self { time: 0.0, q, v, a: Vec::new(), history: Vec::new() }
    }

    /// State at rest at time zero.
    pub fn at_rest(q: Vec<f64>) -> Self {
        let v = vec![0.0; q.len()];
        Self::new(q, v)
    }
}
