//! Scenes with known answers, and oracles, that tests and the suites of `cargo xtask verify` share.
//!
//! * [`facets`]: random pairs of facets and the area that they have in common;
//! * [`patch`]: blocks whose meshes do not match under a load with uniform stress;
//! * [`blocks`]: a block that falls on a larger one;
//! * [`cantilever`]: a beam of one body or of two that are tied;
//! * [`impacts`]: closed forms of a bar on a wall, a body that bounces, a corner;
//! * [`mapped`]: meshes of hexahedra that are images of a cube, such as tubes;
//! * [`multibody`]: closed forms and minimal coordinates of tops, pendulums, mechanisms, beams and strings.
//!
//! Texts and formulas only: whoever uses them builds and runs them.

pub mod blocks;
pub mod cantilever;
pub mod facets;
pub mod impacts;
pub mod mapped;
pub mod multibody;
pub mod patch;
