//! Mortar.
