//! Files within files.

use std::io;
use std::path::Path;

/// How a reader gets at the files that a file includes.
pub type Include<'a> = &'a mut dyn FnMut(&Path) -> io::Result<Vec<u8>>;

/// The content of a regular file; a pipe or a device may have no end.
pub(crate) fn regular(path: &Path) -> io::Result<Vec<u8>> {
    if std::fs::metadata(path)?.is_file() {
        return std::fs::read(path);
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file; save it as one and name that"))
}
