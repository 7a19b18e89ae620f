//! Options of node-to-surface contact.

use stoss_contact::{Enforcement, SearchOptions};

/// What is kept zero while a node is closed (theory/constraints#eq-modified).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ConstraintForm {
    /// `g_np1 = 0`: energy changes in the step in which a node closes.
    #[default]
    Standard,
    /// `g_np1 = g_n`: energy is exact, nodes float at the gap that they had and bounce.
    Modified,
}

/// Options of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NodeToSurfaceOptions {
    /// Constraint while closed.
    pub constraint: ConstraintForm,
    /// How it is enforced; a penalty needs the standard form.
    pub enforcement: Enforcement,
    /// Whether a gap is held where it is in a step in which it closes and velocities come from the law of impact (theory/impacts#hold), and after how many steps without a break it comes down.
    pub hold: Option<u32>,
    /// Tolerances of the search.
    pub search: SearchOptions,
}
