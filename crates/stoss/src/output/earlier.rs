//! Results of an earlier run, which a new run into the same folder replaces.

use super::OutputError;
use std::io::Read;
use std::path::Path;

/// Every file that a run writes beside its frames, with what stands near its beginning if this program wrote it. An empty file is
/// a table that a kill left.
const FILES: [(&str, &str); 17] = [
    ("balance.csv", "step,time,dt,lx,"),
    ("newton.csv", "step,time,iteration,"),
    ("terms.csv", "step,time,"),
    ("contact.csv", "step,time,active,"),
    ("general.csv", "step,time,first,second,"),
    ("probes.csv", "step,time,"),
    ("joints.csv", "step,time,"),
    ("watch.csv", "step,time,depth,"),
    ("watch.json", "\"limits\""),
    ("run.json", "\"bodies\""),
    ("report.html", "<meta name=\"generator\" content=\"Stoss\">"),
    ("diagnosis.json", "\"findings\""),
    ("diagnosis.html", "<meta name=\"generator\" content=\"Stoss\">"),
    ("frames.pvd", "frames/frame_"),
    ("frames.vtkhdf", "HDF\r\n"),
    ("summary.json", "\"scene_hash\""),
    ("checkpoint", "STOSSCP"),
];

/// Where the marks of [`FILES`] are; a summary begins with the scene's title.
const BEGINNING: u64 = 1 << 16;

/// Which files that are in the way of a new run it replaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overwrite {
    /// Files of an earlier run; a file of the same name that this program did not write is an error.
    #[default]
    Own,
    /// All files that have the name of one of ours. Other files stay.
    Any,
}

/// Removes the files of an earlier run: all of them, or none if one is not ours and `overwrite` does not allow it.
pub(super) fn remove(folder: &Path, overwrite: Overwrite) -> Result<(), OutputError> {
    for (name, mark) in FILES {
        let path = folder.join(name);
        if overwrite == Overwrite::Own && path.exists() && !is_ours(&path, mark)? {
            return Err(OutputError::NotOurs { path });
        }
    }
    for (name, _) in FILES {
        let path = folder.join(name);
        if path.exists() {
            std::fs::remove_file(&path).map_err(OutputError::io(&path))?;
        }
    }
    Ok(())
}

fn is_ours(path: &Path, mark: &str) -> Result<bool, OutputError> {
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(OutputError::io(path))?;
    file.take(BEGINNING).read_to_end(&mut bytes).map_err(OutputError::io(path))?;
    Ok(bytes.is_empty() || String::from_utf8_lossy(&bytes).contains(mark))
}
