//! The tests of the crate in one binary: linking one for each file takes longer than running them.

#[cfg(all(feature = "scene", feature = "multibody"))]
mod equations;
#[cfg(all(feature = "output", feature = "nts", feature = "mortar", feature = "multibody"))]
mod setup;
#[cfg(all(feature = "scene", feature = "mortar", feature = "mesh-files"))]
mod sliding_supports;
#[cfg(all(feature = "scene", feature = "nts"))]
mod warnings;
