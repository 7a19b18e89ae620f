//! The state that a scheme carries from step to step.

/// Positions and velocities at one time; node-major vectors of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Time.
    pub time: f64,
    /// Positions, a length each.
    pub q: Vec<f64>,
    /// Velocities [length/time].
    pub v: Vec<f64>,
}

impl State {
    /// State at rest at time zero.
    pub fn at_rest(q: Vec<f64>) -> Self {
        let v = vec![0.0; q.len()];
        Self { time: 0.0, q, v }
    }
}
