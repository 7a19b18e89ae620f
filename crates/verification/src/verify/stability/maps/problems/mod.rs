//! The problems of the maps, each a scene of a few elements with a closed form.

pub mod cantilever;
pub mod fit;
pub mod flight;
pub mod impact;
pub mod press;
pub mod rest;
pub mod slide;

/// Young's modulus of all problems, in which nothing else has a stress.
pub const YOUNG: f64 = 1e3;

/// Speed of waves in a bar of this modulus and a density, `sqrt(E / rho)`.
pub fn bar_speed(young: f64, density: f64) -> f64 {
    (young / density).sqrt()
}
