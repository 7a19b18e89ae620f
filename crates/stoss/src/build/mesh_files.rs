//! The mesh files of a scene, each read once.

use std::path::{Path, PathBuf};
#[cfg(feature = "mesh-files")]
use {
    std::collections::{BTreeMap, btree_map::Entry},
    stoss_mesh_io::Contents,
};

/// What has been read so far while a scene is built.
#[derive(Debug, Default)]
pub(super) struct MeshFiles {
    /// Folder of the scene, which paths are relative to.
    #[cfg_attr(not(feature = "mesh-files"), expect(dead_code, reason = "nothing is read"))]
    folder: PathBuf,
    /// The bytes of every file, included ones too, in the order in which they were read: they belong to the identity of the run.
    pub bytes: Vec<Vec<u8>>,
    #[cfg(feature = "mesh-files")]
    contents: BTreeMap<String, Contents>,
}

impl MeshFiles {
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_path_buf(), ..Self::default() }
    }
}

#[cfg(feature = "mesh-files")]
impl MeshFiles {
    /// What a file says; many bodies may ask for the same one. The error has its remedy.
    pub fn contents(&mut self, file: &str) -> Result<&Contents, (String, &'static str)> {
        let entry = match self.contents.entry(file.to_owned()) {
            Entry::Occupied(entry) => return Ok(entry.into_mut()),
            Entry::Vacant(entry) => entry,
        };
        let path = self.folder.join(file);
        let bytes = read(&path)?;
        let bytes_of_all = &mut self.bytes;
        let mut include = |path: &Path| {
            let bytes = crate::regular::read(path)?;
            bytes_of_all.push(bytes.clone());
            Ok(bytes)
        };
        let contents = stoss_mesh_io::read_contents_from_bytes(&path, &bytes, &mut include);
        self.bytes.push(bytes);
        Ok(entry.insert(contents.map_err(|error| (error.to_string(), "correct the file or name another"))?))
    }

    /// Whether a file that was read has plane elements.
    pub fn is_plane(&self, file: &str) -> bool {
        self.contents.get(file).is_some_and(Contents::is_plane)
    }

    /// The surface in a file.
    pub fn surface(&mut self, file: &str) -> Result<stoss_mesh::SurfaceMesh, (String, &'static str)> {
        let path = self.folder.join(file);
        let bytes = read(&path)?;
        let surface = stoss_mesh_io::read_surface_from_bytes(&path, &bytes);
        self.bytes.push(bytes);
        surface.map_err(|error| (error.to_string(), "correct the file or name another"))
    }
}

#[cfg(feature = "mesh-files")]
fn read(path: &Path) -> Result<Vec<u8>, (String, &'static str)> {
    crate::regular::read(path).map_err(|error| (error.to_string(), "paths are relative to the scene's file"))
}
