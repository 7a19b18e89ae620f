//! Going through a binary MSH file, whose sections begin and end with lines of text.

use std::path::Path;

use crate::MeshIoError;
use crate::place::FileLocation;

/// Whether this is the beginning of a binary file: its second line says `version 1 size`.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let mut lines = bytes.get(..bytes.len().min(200)).unwrap_or_default().split(|&b| b == b'\n');
    let is_format = lines.next().is_some_and(|line| line.trim_ascii() == b"$MeshFormat");
    is_format && lines.next().is_some_and(|line| line.split(|&b| b == b' ').nth(1) == Some(b"1"))
}

/// A cursor over bytes.
pub(super) struct Bytes<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    position: usize,
    pub big_endian: bool,
    /// Bytes of a count or a number of MSH 4.1: 4 or 8.
    pub size: usize,
}

impl<'a> Bytes<'a> {
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Bytes<'a> {
        Bytes { path, bytes, position: 0, big_endian: false, size: 8 }
    }

    pub fn place(&self) -> FileLocation {
        FileLocation { file: 0, at: self.position as u64 }
    }

    pub fn error(&self, place: FileLocation, value: impl ToString, remedy: impl ToString) -> MeshIoError {
        MeshIoError::Binary {
            path: self.path.to_owned(),
            offset: place.at,
            value: value.to_string(),
            remedy: remedy.to_string(),
        }
    }

    fn cut_off(&self, what: &str) -> MeshIoError {
        self.error(self.place(), "end of file", format!("expected {what}; the file is cut off, write it again"))
    }

    /// The next line without white space at its ends, blank ones skipped; `None` at the end of the file.
    pub fn line(&mut self) -> Option<String> {
        while self.position < self.bytes.len() {
            let rest = &self.bytes[self.position..];
            let length = rest.iter().position(|&b| b == b'\n');
            self.position += length.map_or(rest.len(), |l| l + 1);
            let line = rest[..length.unwrap_or(rest.len())].trim_ascii();
            if !line.is_empty() {
                return Some(String::from_utf8_lossy(line).into_owned());
            }
        }
        None
    }

    /// The next line, or an error at the end of the file.
    pub fn expect(&mut self, what: &str) -> Result<String, MeshIoError> {
        self.line().ok_or_else(|| self.cut_off(what))
    }

    /// The line that ends a section.
    pub fn end(&mut self, section: &str) -> Result<(), MeshIoError> {
        let place = self.place();
        let stop = format!("$End{section}");
        let line = self.expect(&stop)?;
        if line == stop {
            return Ok(());
        }
        let line: String = line.chars().take(20).collect();
        Err(self.error(place, format!("{line:?}"), format!("expected {stop}; does the count at its beginning fit?")))
    }

    /// Goes behind the end of a section that is not read.
    pub fn skip(&mut self, section: &str) -> Result<(), MeshIoError> {
        let stop = format!("$End{section}");
        let found = self.bytes[self.position..].windows(stop.len()).position(|w| w == stop.as_bytes());
        match found {
            Some(offset) => self.position += offset + stop.len(),
            None => {
                self.position = self.bytes.len();
                return Err(self.cut_off(&stop));
            }
        }
        Ok(())
    }

    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], MeshIoError> {
        let Some(&chunk) = self.bytes[self.position..].first_chunk::<N>() else { return Err(self.cut_off(what)) };
        self.position += N;
        Ok(chunk)
    }

    pub fn int(&mut self, what: &str) -> Result<i32, MeshIoError> {
        let bytes = self.take(what)?;
        Ok(if self.big_endian { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) })
    }

    /// An int that is not negative.
    pub fn natural(&mut self, what: &str) -> Result<u64, MeshIoError> {
        let place = self.place();
        let value = self.int(what)?;
        u64::try_from(value).map_err(|_| self.error(place, value, format!("expected {what}, not negative")))
    }

    pub fn double(&mut self, what: &str) -> Result<f64, MeshIoError> {
        let place = self.place();
        let bytes = self.take(what)?;
        let value = if self.big_endian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) };
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.error(place, value, format!("expected {what}, a finite number")))
    }

    /// A `size_t` of MSH 4.1.
    pub fn size(&mut self, what: &str) -> Result<u64, MeshIoError> {
        if self.size == 4 {
            let bytes = self.take(what)?;
            return Ok(u64::from(if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }));
        }
        let bytes = self.take(what)?;
        Ok(if self.big_endian { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }

    /// Checks that `count` items of `bytes` bytes can follow, so that a wrong count is reported before a long loop.
    pub fn room(&self, place: FileLocation, count: u64, bytes: usize, what: &str) -> Result<(), MeshIoError> {
        let left = (self.bytes.len() - self.position) as u64;
        if count.checked_mul(bytes as u64).is_some_and(|needed| needed <= left) {
            return Ok(());
        }
        let remedy = format!("more {what} than the file can hold: it is cut off or damaged, write it again");
        Err(self.error(place, count, remedy))
    }
}
