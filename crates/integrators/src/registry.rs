//! All schemes by name.

use crate::{EnergyMomentum, Midpoint, Scheme};

/// A row of the table of schemes.
#[derive(Clone, Copy, Debug)]
pub struct SchemeEntry {
    /// Name used in scenes.
    pub name: &'static str,
    /// Makes the scheme.
    pub make: fn() -> Box<dyn Scheme>,
}

/// Every scheme of this crate.
pub const SCHEMES: &[SchemeEntry] = &[
    SchemeEntry { name: "energy-momentum", make: || Box::new(EnergyMomentum) },
    SchemeEntry { name: "midpoint", make: || Box::new(Midpoint) },
];

/// The scheme of that name, if there is one.
pub fn scheme(name: &str) -> Option<Box<dyn Scheme>> {
    SCHEMES.iter().find(|entry| entry.name == name).map(|entry| (entry.make)())
}
