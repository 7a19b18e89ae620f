//! Files within files.

use std::io;
use std::path::Path;

/// How a reader gets at the files that a file includes.
pub type Include<'a> = &'a mut dyn FnMut(&Path) -> io::Result<Vec<u8>>;
