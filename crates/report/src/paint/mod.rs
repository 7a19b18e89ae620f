//! Pictures of bodies: the surface of a frame, seen from a camera, coloured by a field, as SVG text or as pixels.

mod bar;
mod camera;
mod canvas;
mod colour;
mod letters;
mod picture;
mod raster;
mod surface;
mod svg;
mod visible;

pub use camera::Camera;
pub use canvas::Colour;
pub use colour::colour;
pub use picture::{Layout, Shot, Style, columns, draw, draw_raster, draw_svg, value_range, window};
pub use raster::Raster;
pub(crate) use surface::deformed;
pub use surface::{Line, Primitives, boundary};
pub use visible::Finish;
