//! Where something stands in a file.

/// A place in a file: a line of a text, a byte of a binary file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct FileLocation {
    /// Which of the files that were read: 0, or an included one.
    pub file: u32,
    /// The line, from 1, or the byte, from 0.
    pub at: u64,
}
