//! `[gravity]`.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[gravity]`: a constant acceleration that acts on everything with mass.
///
/// ```toml
/// [gravity]
/// acceleration = [0, 0, -9.81]
/// ```
///
/// In a quasi-static scene with gravity every part needs its mass: bodies, beams, strings and rigid bodies that are not held need
/// their density or mass there, too. Zero is allowed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Gravity {
    /// Acceleration (length per square of time), not zero.
    pub acceleration: [f64; 3],
}
