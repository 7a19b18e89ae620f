//! Readers of Gmsh, Abaqus and VTU meshes and of STL surfaces, writers of meshes, of VTU frames and PVD collections.
//!
//! * [`read_contents`]: what a mesh file of any format of the registry [`FORMATS`] says; [`Contents::mesh`]: the mesh of the file or of
//!   one of its groups, checked and ready to compute with; [`Contents::survey`]: what is in it, and whether it can be used;
//! * [`read_mesh`]: both at once for a whole file;
//! * [`write_mesh`]: a mesh with its sets as a Gmsh, Abaqus or VTU file;
//! * [`read_surface`]: the surface of a rigid body from an STL file, text or binary;
//! * [`VtuFrame`], [`write_vtu`], [`read_vtu`]: one frame of results for ParaView;
//! * [`PvdWriter`]: the collection of frames over time;
//! * with the feature `vtkhdf`: all frames in one HDF5 file.
//!
//! Every error names the file, the line (of a binary file the byte), the value and what to do about it. No content of a
//! file makes a reader panic. Files are written under a temporary name in the same folder and then renamed, so that a
//! reader never sees half of one.
//!
//! # What it is not
//! Nothing here knows what a result means. What an Abaqus file says of materials, steps and boundary conditions is kept ([`deck`]), not interpreted.
//!
//! # How to add a format
//! See `docs/how-to-add/mesh-format.md`: a reader that fills [`Contents`], a row of [`FORMATS`], files to `tests/data`, and a line to the
//! mutation tests in `tests/fuzz.rs`.
//!
#![doc = include_str!("../README.md")]

mod abaqus;
mod atomic;
mod base64;
mod build;
mod checked;
mod contents;
mod error;
mod gmsh;
mod include;
mod lines;
mod place;
mod pvd;
mod registry;
mod solids;
mod stl;
mod survey;
#[cfg(feature = "vtkhdf")]
mod vtkhdf;
mod vtu;
mod vtu_cells;
mod vtu_file;
mod vtu_mesh;
mod vtu_read;
mod write;
mod xml;

pub use abaqus::deck;
pub use contents::Contents;
pub use error::{FilePosition, MeshIoError};
pub use include::Include;
pub use pvd::{PvdEntry, PvdWriter, read_pvd_from_str};
pub use registry::{FORMATS, Format, read_contents, read_contents_from_bytes, read_mesh, read_mesh_from_str};
pub use solids::{OtherElements, OtherNode, Solids};
pub use stl::{SurfaceFile, read_surface, read_surface_counted, read_surface_from_bytes};
pub use survey::{CellCount, MeshSurvey, Survey};
#[cfg(feature = "vtkhdf")]
pub use vtkhdf::{VtkhdfFile, append_vtkhdf, create_vtkhdf, keep_vtkhdf};
pub use vtu::{Field, VtuFrame, write_vtu, write_vtu_to};
pub use vtu_read::{Array, VtuData, read_vtu, read_vtu_from_bytes};
pub use write::write_mesh;
