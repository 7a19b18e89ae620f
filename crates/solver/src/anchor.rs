//! Springs that hold bodies in a static step until contact does (theory/constraints#anchored).

/// Springs of one stiffness from every free component to where it was when the springs began.
#[derive(Debug)]
pub(crate) struct Anchor {
    /// Part of the mean diagonal that the stiffness is.
    pub part: f64,
    /// Force over length; zero before the first tangent.
    pub stiffness: f64,
    /// Positions where they began.
    pub from: Vec<f64>,
}

impl Anchor {
    /// Energy of the springs at `q`, of these components.
    pub fn energy(&self, q: &[f64], free: &[u32]) -> f64 {
        let square = |&c: &u32| (q[c as usize] - self.from[c as usize]).powi(2);
        0.5 * self.stiffness * free.iter().map(square).sum::<f64>()
    }
}
