//! PVD: the collection of frames over time that ParaView opens.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::atomic::{self, WriteError};
use crate::lines::syntax;
use crate::{MeshIoError, xml};

/// One frame of a collection.
#[derive(Debug, Clone, PartialEq)]
pub struct PvdEntry {
    /// Time of the frame.
    pub time: f64,
    /// The file, relative to the folder of the collection, with `/` between folders.
    pub file: String,
}

impl PvdEntry {
    fn check(&self) -> Result<(), MeshIoError> {
        let PvdEntry { time, file } = self;
        if !time.is_finite() || file.is_empty() || xml::escape(file).is_none() {
            let problem = format!("time {time} must be finite, and the name must be one that XML can hold");
            return Err(MeshIoError::Output { name: file.clone(), problem });
        }
        Ok(())
    }
}

/// A collection that grows. After each [`PvdWriter::push`] the file is complete; it is replaced by renaming, so that a reader
/// and a killed program never see half of it.
#[derive(Debug, Clone, PartialEq)]
pub struct PvdWriter {
    path: PathBuf,
    entries: Vec<PvdEntry>,
}

impl PvdWriter {
    /// A new, empty collection; an existing file is replaced.
    ///
    /// # Errors
    /// [`MeshIoError::Io`].
    pub fn create(path: impl Into<PathBuf>) -> Result<PvdWriter, MeshIoError> {
        let writer = PvdWriter { path: path.into(), entries: Vec::new() };
        writer.write()?;
        Ok(writer)
    }

    /// Continues a collection: keeps its frames up to `last_time`. A file that does not exist counts as empty. The file
    /// is written with the next push.
    ///
    /// # Errors
    /// [`MeshIoError::Io`], [`MeshIoError::Syntax`].
    pub fn resume(path: impl Into<PathBuf>, last_time: f64) -> Result<PvdWriter, MeshIoError> {
        let path = path.into();
        let mut entries = match read(&path) {
            Err(MeshIoError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            other => other?,
        };
        entries.retain(|e| e.time <= last_time);
        Ok(PvdWriter { path, entries })
    }

    /// Writes a collection of given frames, replacing an existing file.
    ///
    /// # Errors
    /// The errors of [`Self::push`].
    pub fn replace(path: impl Into<PathBuf>, frames: &[(f64, String)]) -> Result<(), MeshIoError> {
        let entries: Vec<PvdEntry> =
            frames.iter().map(|(time, file)| PvdEntry { time: *time, file: file.clone() }).collect();
        entries.iter().try_for_each(PvdEntry::check)?;
        PvdWriter { path: path.into(), entries }.write()
    }

    /// The frames so far.
    pub fn entries(&self) -> &[PvdEntry] {
        &self.entries
    }

    /// Adds a frame and writes the collection.
    ///
    /// # Errors
    /// [`MeshIoError::Output`] if the time is not finite or the name is not possible in XML, [`MeshIoError::Io`].
    pub fn push(&mut self, time: f64, file: impl Into<String>) -> Result<(), MeshIoError> {
        let entry = PvdEntry { time, file: file.into() };
        entry.check()?;
        self.entries.push(entry);
        self.write()
    }

    fn write(&self) -> Result<(), MeshIoError> {
        atomic::write(&self.path, |out| {
            writeln!(out, "<?xml version=\"1.0\"?>")?;
            writeln!(out, "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>")?;
            for PvdEntry { time, file } in &self.entries {
                let file = xml::escape(file).unwrap_or_default(); // checked in push
                writeln!(out, "<DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>")?;
            }
            writeln!(out, "</Collection>\n</VTKFile>").map_err(WriteError::Io)
        })
    }
}

fn read(path: &Path) -> Result<Vec<PvdEntry>, MeshIoError> {
    let bytes = std::fs::read(path).map_err(|source| MeshIoError::Io { path: path.to_owned(), source })?;
    read_pvd_from_str(path, &String::from_utf8_lossy(&bytes))
}

/// The frames of a collection in memory; `path` is used in messages only.
///
/// # Errors
/// [`MeshIoError::Syntax`].
pub fn read_pvd_from_str(path: impl AsRef<Path>, text: &str) -> Result<Vec<PvdEntry>, MeshIoError> {
    let path = path.as_ref();
    let (mut entries, mut position) = (Vec::new(), 0);
    while let Some(tag) = xml::next_tag(text, position) {
        position = tag.end;
        if tag.name() == "DataSet" {
            let time = tag.attribute("timestep").and_then(|t| t.parse().ok());
            let file = tag.attribute("file").and_then(xml::unescape);
            let (Some(time), Some(file)) = (time, file) else {
                let line = text[..position].matches('\n').count() + 1;
                return Err(syntax(path, line, tag.text, "expected a frame with timestep and file"));
            };
            entries.push(PvdEntry { time, file });
        }
    }
    Ok(entries)
}
