//! Options of mortar contact.

use crate::{MultiplierSpace, TriangleRule};

/// Which integrals the weighted gaps of a step have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrals {
    /// Those of the positions: the weighted gap is a function of the positions alone.
    #[default]
    Moving,
    /// Those of the expected middle of the step, held in the step (thesis). What two steps have different gaps for is gained or lost. Not with
    /// [`stoss_contact::ContactRule::EndPoint`].
    Frozen,
}

/// Force of a pressure under [`stoss_contact::ContactRule::EndPoint`]. Neither has a resultant or a moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Force {
    /// The gradient of the weighted gap: the force of a constraint that does no work, and what dynamics wants.
    #[default]
    Gradient,
    /// The gradient at fixed weights: what statics wants. Where facets are large against the depth the other one has limit points, at which nodes slide out of
    /// the overlap instead of carrying.
    FixedWeights,
}

/// Options of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MortarOptions {
    /// Multiplier space of the pressures.
    pub space: MultiplierSpace,
    /// Rule of the integrals.
    pub rule: TriangleRule,
    /// Which integrals.
    pub integrals: Integrals,
    /// Where a surface has sharp edges: how much more near points count than far ones, [`crate::Factors::nearness`] times the length of a slave facet. Zero, the plain
    /// mean, lets edges sink in by a quarter of a facet, 12 by a ninth; but the integrand is no polynomial then, and where edges of both surfaces lie on each other
    /// its error has a kink that Newton may not pass.
    pub nearness: f64,
    /// Which force.
    pub force: Force,
    /// Pressure over penetration, a stress per length, if contact is not rigid; under [`stoss_contact::ContactRule::EndPoint`].
    pub overclosure: Option<f64>,
    /// Whether a penetration that a node has at the start of a step is kept, as dynamics wants it: to push it out would give energy.
    pub keeps_penetration: bool,
}
