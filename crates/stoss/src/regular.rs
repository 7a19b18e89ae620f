//! Reading files that a user names.

use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// The content of a regular file; a pipe or a device may have no end, and is an error.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>> {
    if std::fs::metadata(path)?.is_file() {
        return std::fs::read(path);
    }
    Err(Error::new(ErrorKind::InvalidInput, "it is not a regular file; save it as one and name that"))
}
