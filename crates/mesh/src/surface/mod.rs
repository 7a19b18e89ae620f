//! Surfaces of rigid bodies: facets without elements behind them, generators, mass properties.
//!
//! A rigid body has no mesh of its volume. It needs a surface for contact ([`SurfaceMesh`]) and six numbers of inertia
//! beside its mass ([`MassProperties`]), which follow from a closed surface, from a mesh or from a closed form.
//!
//! Each generator is a struct of its parameters. `validate` checks these, and `generate` returns a surface with outward
//! facets:
//!
//! | generator | place | sets |
//! |---|---|---|
//! | [`Plane`] | centred, in z = 0, normal +z; not closed | |
//! | [`Sphere`] | centred | |
//! | [`Cuboid`] | centred | `left` (x-), `right` (x+), `front` (y-), `back` (y+), `bottom` (z-), `top` (z+) |
//! | [`Cylinder`] | centred, axis z | `side`, `bottom` (z-), `top` (z+) |
//! | [`Cone`] | tip in the origin, axis z, base at z = height | `side`, `base`, and `tip` if it is flat |
//!
//! All nodes of a round shape lie on it. So the polyhedron lies inside of it, and volume and moments differ from the
//! shape's by the order of the squared size of the facets.
//!
//! # What it is not
//! No motion and no contact; files of surfaces are read by `stoss-mesh-io`. Hexahedral bodies of the same shapes:
//! [`crate::generate`].
//!
//! # How to add a generator
//! Write a struct with `validate` and `generate`; a shape with an axis is a profile for `revolve` in `revolution.rs`.
//! Finish with [`SurfaceMesh::check`], and add a line to the table above and a row to the battery in
//! `tests/surfaces.rs`.

mod check;
mod data;
mod edges;
mod mass;
mod revolution;
mod shapes;

pub use data::SurfaceMesh;
pub use mass::MassProperties;
pub use revolution::{Cone, Cylinder, RoundDivisions};
pub use shapes::{Cuboid, Plane, Sphere};
