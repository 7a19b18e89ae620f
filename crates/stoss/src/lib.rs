//! Stoss: large-deformation contact elastodynamics.
