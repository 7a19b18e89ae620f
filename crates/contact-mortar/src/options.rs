//! Options of mortar contact.

use crate::MultiplierSpace;

/// [`crate::Factors::nearness`] of statics times the length of a slave facet, where a surface has sharp edges. Zero, the plain mean, lets edges sink in by a quarter of a facet, 12 by a ninth; but the
/// integrand is no polynomial then, and where edges of both surfaces lie on each other its error has a kink that Newton may not pass. So dynamics has the plain mean: its force would have the kinks of its
/// weights.
pub(crate) const NEARNESS: f64 = 12.0;

/// Which integrals the weighted gaps of a step have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrals {
    /// Integrals of the positions: the weighted gap is a function of the positions alone.
    #[default]
    Moving,
    /// Integrals of the expected middle of the step, held in the step (thesis). What two steps have different gaps for is gained or lost. Not with
    /// [`stoss_term::GradientRule::EndPoint`].
    Frozen,
}

/// Options of the method: how it measures. What differs between statics and dynamics it takes from the step ([`crate::MortarContact`]).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MortarOptions {
    /// Multiplier space of the pressures.
    pub space: MultiplierSpace,
    /// Which integrals.
    pub integrals: Integrals,
    /// Whether a weighted gap is held where it is in a step in which it closes and velocities come from the law of impact (theory/impacts#hold), and after how many steps without a break it
    /// comes down. Not with frozen integrals.
    pub hold: Option<u32>,
    /// Pressure over penetration, a stress per length, if contact is not rigid; under [`stoss_term::GradientRule::EndPoint`].
    pub overclosure: Option<f64>,
}
