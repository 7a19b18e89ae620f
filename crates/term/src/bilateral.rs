//! The ability to hold at all times.

use crate::{Fault, JointReport, SupportedNode};

/// Constraints that always hold: joints, mesh ties, rigidity, sliding supports. Their slots are active from the first step to the last, whatever the sign of their multipliers.
pub trait Bilateral: Sync {
    /// What a slot is, for impacts.
    fn slot_kind(&self, _slot: usize) -> SlotKind {
        SlotKind::Equation
    }
    /// Whether it has limits: gaps of its own that close, though it always holds.
    fn has_limits(&self) -> bool {
        false
    }
    /// Whether it holds surfaces together that lie on each other, as mesh ties do: then their nodes may be a little inside the other body.
    fn holds_surfaces_together(&self) -> bool {
        false
    }
    /// Checks at the end of a converged step that equations without an active slot hold: those between things that cannot move, or move as prescribed.
    ///
    /// # Errors
    /// The prescribed motion contradicts them.
    fn verify_inactive(&self, _q_np1: &[f64], _active: &[bool]) -> Result<(), Fault> {
        Ok(())
    }
    /// What a joint does at the end of a step at `q`; `None` for everything else.
    fn joint(&self, _q: &[f64], _multipliers: &[f64]) -> Option<JointReport> {
        None
    }
    /// What a slot of a sliding support prescribes at a time; `None` for all other constraints.
    fn supported_node(&self, _slot: usize, _time: f64) -> Option<SupportedNode> {
        None
    }
}

/// What a slot of a bilateral constraint is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotKind {
    /// An equation between positions that holds at all times.
    Equation,
    /// An equation that depends on time: a drive, a moving support.
    Driven,
    /// A limit: it acts on one side, and opens and closes within its own row.
    Limit,
    /// A force with a law, such as friction: it takes no part in an impact.
    Force,
}
