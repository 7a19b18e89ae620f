//! A folder of results as a run leaves it: frames, tables, and the files that say what they mean.
//!
//! Everything in it is optional, because runs are killed and folders are copied in part; only a folder with nothing of a run is refused.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::table::Table;
use crate::vtu::{self, Grid};
use crate::{Outcome, read};

/// The file with all frames of a run whose scene asks for it.
const ALL: &str = "frames.vtkhdf";
/// Why a run stopped or came out wrong; the page of that.
pub(crate) const DIAGNOSIS: &str = "diagnosis.json";
pub(crate) const DIAGNOSIS_PAGE: &str = "diagnosis.html";

/// A stored frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Time of the frame.
    pub time: f64,
    /// File of the frame.
    pub path: PathBuf,
    /// Place of the frame in a file that has all frames.
    pub place: Option<usize>,
}

/// An open folder.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
    /// Frames in the order of the collection.
    pub frames: Vec<Frame>,
    /// `summary.json`: how the run went.
    pub summary: Option<Value>,
    /// `run.json`: names of bodies, plan and scene.
    pub run: Option<Value>,
    /// `setup.json`: what a scene that has not run has where.
    pub setup: Option<Value>,
    /// Names of the bodies, by the number that the cell field `body` has.
    pub bodies: Vec<String>,
    /// What could not be read, file by file.
    pub notes: Vec<String>,
}

impl Folder {
    /// Opens a folder.
    ///
    /// # Errors
    /// If it has neither a summary nor frames nor a balance. A file that is there and cannot be read becomes a note.
    pub fn open(path: &Path) -> Outcome<Self> {
        let known = ["summary.json", "frames.pvd", ALL, "balance.csv"];
        if !known.iter().any(|name| path.join(name).is_file()) {
            return Err(
                format!("{}: no results of a run: none of {} is there", path.display(), known.join(", ")).into()
            );
        }
        let mut notes = Vec::new();
        let mut json = |name: &str| -> Option<Value> {
            let file = path.join(name);
            let text = file.is_file().then(|| read(&file))?;
            let value = text.and_then(|text| {
                serde_json::from_str(&text).map_err(|error| format!("{}: {error}", file.display()).into())
            });
            value.map_err(|error| notes.push(error.to_string())).ok()
        };
        let [summary, run, watch, setup] = ["summary.json", "run.json", "watch.json", "setup.json"].map(&mut json);
        let frames = frames(path).unwrap_or_else(|error| {
            notes.push(error.to_string());
            Vec::new()
        });
        let bodies = names(run.as_ref()).or_else(|| names(watch.as_ref())).unwrap_or_default();
        Ok(Self { path: path.to_path_buf(), frames, summary, run, setup, bodies, notes })
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The last part of its path.
    pub fn name(&self) -> String {
        let full = self.path.canonicalize().unwrap_or_else(|_| self.path.clone());
        full.file_name().map_or_else(|| full.display().to_string(), |name| name.to_string_lossy().into_owned())
    }

    /// Reads a frame.
    ///
    /// # Errors
    /// What is wrong with it, with its name.
    pub fn grid(&self, frame: usize) -> Outcome<Grid> {
        let Frame { path, place, .. } = &self.frames[frame];
        match place {
            Some(place) => vtu::load_part(path, *place),
            None => vtu::load(path),
        }
    }

    /// Reads a table; nothing if there is none of that name. A last row without a line feed is left out: it is being written.
    ///
    /// # Errors
    /// What is wrong with it, with its name.
    pub fn table(&self, name: &str) -> Outcome<Option<Table>> {
        let file = self.path.join(name);
        if !file.is_file() {
            return Ok(None);
        }
        let text = read(&file)?;
        let whole = text.rfind('\n').map_or(text.as_str(), |end| &text[..=end]);
        Ok(Some(Table::parse(whole).map_err(|error| format!("{}: {error}", file.display()))?))
    }
}

/// The frames of the one file that has all, or of `frames.pvd`; none without these files.
fn frames(folder: &Path) -> Outcome<Vec<Frame>> {
    let all = folder.join(ALL);
    if all.is_file() {
        let times = vtu::times(&all)?.into_iter().enumerate();
        return Ok(times.map(|(k, time)| Frame { time, path: all.clone(), place: Some(k) }).collect());
    }
    let file = folder.join("frames.pvd");
    if !file.is_file() {
        return Ok(Vec::new());
    }
    let entries = vtu::collection(&read(&file)?).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(entries.into_iter().map(|(time, name)| Frame { time, path: folder.join(name), place: None }).collect())
}

/// Names in the list `bodies` of a file: strings, or objects with a `name`.
fn names(file: Option<&Value>) -> Option<Vec<String>> {
    let name = |body: &Value| Some(body.as_str().or_else(|| body.get("name")?.as_str())?.to_owned());
    file?.get("bodies")?.as_array()?.iter().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_of_nothing_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let error = Folder::open(folder.path()).unwrap_err().to_string();
        assert!(error.contains(&folder.path().display().to_string()) && error.contains("frames.pvd"), "{error}");
    }

    #[test]
    fn names_come_from_the_run_or_from_the_watch() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("summary.json", "{");
        write("watch.json", r#"{"bodies":[{"name":"ball"}]}"#);
        let open = Folder::open(folder.path()).unwrap();
        assert_eq!((open.bodies, open.summary), (vec!["ball".to_owned()], None));
        assert!(open.notes.len() == 1 && open.notes[0].contains("summary.json"), "{:?}", open.notes);
        write("run.json", r#"{"bodies":["ball","rope"]}"#);
        assert_eq!(Folder::open(folder.path()).unwrap().bodies, ["ball", "rope"]);
    }

    #[test]
    fn a_broken_table_and_a_broken_collection_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("balance.csv", "step,time\n1\n");
        write("frames.pvd", "<DataSet file=\"a\"/>");
        let open = Folder::open(folder.path()).unwrap();
        assert!(open.frames.is_empty() && open.notes[0].contains("frames.pvd"), "{:?}", open.notes);
        assert!(open.table("balance.csv").unwrap_err().to_string().contains("balance.csv: line 2"));
        write("balance.csv", "step,time\n1,0.1\n2,0.");
        assert_eq!(open.table("balance.csv").unwrap().unwrap().rows(), 1);
        assert_eq!(open.table("probes.csv").unwrap(), None);
    }
}
