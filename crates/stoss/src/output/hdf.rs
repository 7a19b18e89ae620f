//! All frames in one VTKHDF file, where that is built in. A scene that asks for it where it is not is refused before.

#[cfg(feature = "vtkhdf")]
pub(super) use with::*;
#[cfg(not(feature = "vtkhdf"))]
pub(super) use without::*;

#[cfg(feature = "vtkhdf")]
mod with {
    use std::path::Path;
    use stoss_mesh_io::{MeshIoError, VtkhdfFile, VtuData};
    pub use stoss_mesh_io::{append_vtkhdf as append, create_vtkhdf as create};

    /// Removes all frames but the first, `count` of them.
    pub fn keep(path: &Path, count: usize) -> Result<(), MeshIoError> {
        stoss_mesh_io::keep_vtkhdf(path, count)
    }

    /// Steps of the frames of a file.
    pub fn steps(path: &Path) -> Result<Vec<u64>, MeshIoError> {
        Ok(VtkhdfFile::open(path)?.frames().iter().map(|&(step, _)| step).collect())
    }

    /// A frame of a file.
    pub fn read(path: &Path, place: usize) -> Result<VtuData, MeshIoError> {
        VtkhdfFile::open(path)?.read(place)
    }
}

#[cfg(not(feature = "vtkhdf"))]
mod without {
    use std::path::Path;
    use stoss_mesh_io::{MeshIoError, VtuData, VtuFrame};

    fn absent<T>(path: &Path) -> Result<T, MeshIoError> {
        let reason = "this build of Stoss has no VTKHDF (cargo feature `vtkhdf`)";
        Err(MeshIoError::Io { path: path.to_owned(), source: std::io::Error::other(reason) })
    }
    pub fn create(path: &Path, _: &VtuFrame, _: u64) -> Result<(), MeshIoError> {
        absent(path)
    }
    pub fn append(path: &Path, _: &VtuFrame, _: u64) -> Result<(), MeshIoError> {
        absent(path)
    }
    pub fn keep(path: &Path, _: usize) -> Result<(), MeshIoError> {
        absent(path)
    }
    pub fn steps(path: &Path) -> Result<Vec<u64>, MeshIoError> {
        absent(path)
    }
    pub fn read(path: &Path, _: usize) -> Result<VtuData, MeshIoError> {
        absent(path)
    }
}
