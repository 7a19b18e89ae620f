//! Pictures of bodies: the surface of a frame, seen from a camera, coloured by a field.

mod bar;
mod camera;
mod colour;
mod picture;
mod surface;

pub use camera::Camera;
pub use picture::{Shot, Style, columns, draw};
pub(crate) use surface::deformed;
pub use surface::{Line, Surface, boundary};
