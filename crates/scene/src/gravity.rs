//! `[gravity]`.

#[cfg(feature = "schema")]
use crate::Dimension;
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
/// In a scene with gravity every body, beam and string, and every rigid body whose motion is not prescribed, needs a density or mass, also if the scene is
/// quasi-static. There zero is allowed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Gravity {
    /// Acceleration (length per time squared), not zero.
    #[cfg_attr(feature = "schema", schemars(extend("x-dimension" = Dimension::Acceleration)))]
    pub acceleration: [f64; 3],
}
