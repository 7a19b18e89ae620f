//! `[gravity]`.

use stoss_scene_derive::table;

/// `[gravity]`: a constant acceleration that acts on everything with mass.
///
/// ```toml
/// [gravity]
/// acceleration = [0, 0, -9.81]
/// ```
///
/// In a scene with gravity every body, beam and string, and every rigid body whose motion is not prescribed, needs a density or mass, also if the scene is
/// quasi-static. There zero is allowed.
#[table(example = "{ acceleration = [0, 0, -9.81] }")]
#[derive(Copy)]
pub struct Gravity {
    /// Acceleration (length per time squared), not zero.
    #[key(dimension = Acceleration, example = "[0, 0, -9.81]", direction)]
    pub acceleration: [f64; 3],
}
