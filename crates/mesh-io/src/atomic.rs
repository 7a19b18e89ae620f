//! Files that are there completely or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::MeshIoError;

/// Writes a file under a temporary name in the same folder and renames it. A process that is killed leaves the old file,
/// or none, and perhaps a `.part` file, which the next write of the same file replaces. Not synchronised to the disk: it
/// protects from a killed process, not from a power failure.
pub(crate) fn write(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> Result<(), WriteError>,
) -> Result<(), MeshIoError> {
    let temporary = temporary_name(path);
    let io = |source| MeshIoError::Io { path: path.to_owned(), source };
    let result = (|| {
        let mut out = BufWriter::with_capacity(1 << 18, File::create(&temporary)?);
        content(&mut out)?;
        out.flush()?;
        drop(out);
        fs::rename(&temporary, path)?;
        Ok(())
    })();
    result.map_err(|error| {
        // the error of the write counts, not whether the rest can be removed
        let _ = fs::remove_file(&temporary);
        match error {
            WriteError::Io(source) => io(source),
            WriteError::Output(error) => error,
        }
    })
}

/// Writes as [`write`] a file that `content` writes by its name.
#[cfg(feature = "vtkhdf")]
pub(crate) fn through(path: &Path, content: impl FnOnce(&Path) -> Result<(), MeshIoError>) -> Result<(), MeshIoError> {
    let temporary = temporary_name(path);
    let io = |source| MeshIoError::Io { path: path.to_owned(), source };
    let result = content(&temporary).and_then(|()| fs::rename(&temporary, path).map_err(io));
    if result.is_err() {
        // the error of the write counts, not whether the rest can be removed
        let _ = fs::remove_file(&temporary);
    }
    result
}

/// Why content could not be written.
pub(crate) enum WriteError {
    Io(io::Error),
    Output(MeshIoError),
}

impl From<io::Error> for WriteError {
    fn from(error: io::Error) -> WriteError {
        WriteError::Io(error)
    }
}

impl From<MeshIoError> for WriteError {
    fn from(error: MeshIoError) -> WriteError {
        WriteError::Output(error)
    }
}

fn temporary_name(path: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".part");
    path.with_file_name(name)
}
