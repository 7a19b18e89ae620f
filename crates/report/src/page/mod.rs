//! The page of a run: one HTML file that needs neither a network nor another file.
//!
//! It shows the run as an animation, charts that follow its time, the verdict, the plan and the scene; of several runs
//! it lays the charts over each other and lists what differs. Of a scene before its run (`setup.json` of the facade) it shows what is where. The browser's part is in `assets/`; `payload.rs` says what is handed to it.
//!
//! Not here: pictures without a browser ([`crate::picture`]).

pub mod coding;
mod distance;
mod fields;
mod payload;
mod shape;
mod tables;

pub(crate) use fields::{Field, endings};

use std::collections::BTreeMap;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::folder::{DIAGNOSIS, DIAGNOSIS_PAGE, Folder};
use crate::sweep::{Sweep, label, values};
use crate::{Outcome, read};
use payload::{Cache, Packing};

/// Name of the page in a folder of results.
pub const NAME: &str = "report.html";

/// What tells our pages from others.
const MARK: &str = "<meta name=\"generator\" content=\"Stoss\">";

const PAGE: &str = include_str!("assets/page.html");
const STYLE: &str = include_str!("assets/style.css");
/// Every part of the program, in the order in which they use each other.
const SCRIPTS: [&str; 24] = [
    include_str!("assets/payload.js"),
    include_str!("assets/fields.js"),
    include_str!("assets/linear.js"),
    include_str!("assets/copies.js"),
    include_str!("assets/shape.js"),
    include_str!("assets/inside.js"),
    include_str!("assets/shaders.js"),
    include_str!("assets/arrows.js"),
    include_str!("assets/pick.js"),
    include_str!("assets/free.js"),
    include_str!("assets/viewer.js"),
    include_str!("assets/charts.js"),
    include_str!("assets/curves.js"),
    include_str!("assets/columns.js"),
    include_str!("assets/export.js"),
    include_str!("assets/sweep.js"),
    include_str!("assets/panels.js"),
    include_str!("assets/overlay.js"),
    include_str!("assets/layers.js"),
    include_str!("assets/path.js"),
    include_str!("assets/controls.js"),
    include_str!("assets/app.js"),
    include_str!("assets/follow.js"),
    include_str!("assets/start.js"),
];

/// A page and what is to be said about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// The text of the file.
    pub text: String,
    /// What could not be read or was left out, with the names of files.
    pub notes: Vec<String>,
}

/// What is put together to a page.
#[derive(Default)]
struct Parts {
    head: String,
    /// Whether there is a diagnosis to refer to.
    diagnosis: bool,
    data: String,
    notes: Vec<String>,
    titles: Vec<String>,
}

impl Parts {
    /// Adds one of so many runs.
    fn add(&mut self, path: &Path, runs: usize, is_fast: bool, cache: &mut Cache) -> Outcome<()> {
        let folder = Folder::open(path)?;
        let values: BTreeMap<String, f64> = values(path);
        let name = if values.is_empty() { folder.name() } else { label(&values) };
        let packing = Packing { name: &name, values: &values, runs, is_fast };
        let (bytes, notes) = payload::pack(&folder, &packing, cache)?;
        self.notes.extend(notes);
        let title = title(&folder);
        if !self.titles.contains(&title) {
            self.titles.push(title);
        }
        self.data += "<script type=\"text/plain\" class=\"run\">";
        STANDARD.encode_string(bytes, &mut self.data);
        self.data += "</script>\n";
        Ok(())
    }

    fn page(self) -> Page {
        let script = SCRIPTS.join("\n");
        let title = escaped(&self.titles.join(" | "));
        let link = format!("<a href=\"{DIAGNOSIS_PAGE}\">why, and what to try</a>");
        let parts = [
            ("diagnosis", if self.diagnosis { link.as_str() } else { "" }),
            ("head", self.head.as_str()),
            ("style", STYLE),
            ("title", title.as_str()),
            ("data", self.data.as_str()),
            ("script", script.as_str()),
        ];
        Page { text: filled(PAGE, &parts), notes: self.notes }
    }
}

/// The page of one run or of several that are compared.
///
/// # Errors
/// If a folder has no results at all.
pub fn page(folders: &[&Path]) -> Outcome<Page> {
    let mut parts = Parts::default();
    for path in folders {
        parts.add(path, folders.len(), false, &mut Cache::default())?;
    }
    // The page of the diagnosis is beside that of the run.
    parts.diagnosis = folders.len() == 1 && folders[0].join(DIAGNOSIS).is_file();
    Ok(parts.page())
}

/// The page of a sweep: its cases are compared, and its table is shown.
///
/// # Errors
/// If no case has results.
pub fn sweep_page(path: &Path, mut sweep: Sweep) -> Outcome<Page> {
    let has_results = |folder: &Path| Folder::open(folder).is_ok();
    let runs = sweep.cases.iter().filter(|case| has_results(&case.folder)).count();
    if runs == 0 {
        return Err(format!("{}: no case of the sweep has results", path.display()).into());
    }
    let mut parts = Parts::default();
    for (run, case) in sweep.cases.iter_mut().filter(|case| has_results(&case.folder)).enumerate() {
        parts.add(&case.folder, runs, false, &mut Cache::default())?;
        case.run = Some(run);
    }
    // Nothing in it may look like the end of a script.
    let table = serde_json::to_string(&sweep)?.replace('<', "\\u003c");
    parts.data += &format!("<script type=\"application/json\" id=\"sweep\">{table}</script>\n");
    Ok(parts.page())
}

/// Writes the page of these runs into the folder of the first, or that of a sweep into its folder; returns the notes.
///
/// # Errors
/// The errors of [`page`] and [`sweep_page`], and what the system says about writing.
pub fn write(folders: &[&Path]) -> Outcome<Vec<String>> {
    let Some(first) = folders.first() else { return Err("no folder of results is named".into()) };
    let file = first.join(NAME);
    must_be_ours(&file)?;
    if let (Some(sweep), 1) = (Sweep::open(first)?, folders.len()) {
        return save(&file, sweep_page(first, sweep)?);
    }
    save(&file, page(folders)?)
}

/// Writes the page of a folder into a file of another place; returns the notes.
///
/// # Errors
/// The errors of [`write()`].
pub fn write_as(folder: &Path, file: &Path) -> Outcome<Vec<String>> {
    must_be_ours(file)?;
    save(file, page(&[folder])?)
}

/// Writes the page of a run that goes on, again and again: frames that were read once are not read again.
#[derive(Debug, Default)]
pub struct Follower(Cache);

impl Follower {
    /// Writes the page of a folder, which loads itself again after so many seconds, or does not; returns the notes.
    ///
    /// # Errors
    /// The errors of [`write()`].
    pub fn write(&mut self, path: &Path, reload: Option<f64>) -> Outcome<Vec<String>> {
        let file = path.join(NAME);
        must_be_ours(&file)?;
        let mut parts = Parts::default();
        parts.add(path, 1, reload.is_some(), &mut self.0)?;
        parts.diagnosis = path.join(DIAGNOSIS).is_file();
        if let Some(seconds) = reload {
            parts.head = format!("<meta name=\"stoss-reload\" content=\"{seconds}\">");
        }
        save(&file, parts.page())
    }
}

fn must_be_ours(file: &Path) -> Outcome<()> {
    match file.exists() && !read(file)?.contains(MARK) {
        true => Err(format!("{}: it was not written by Stoss; move it away", file.display()).into()),
        false => Ok(()),
    }
}

/// Puts a page into its place; the run and who follows it may do so at the same time.
fn save(file: &Path, Page { text, notes }: Page) -> Outcome<Vec<String>> {
    let scratch = file.with_file_name(format!(".report.{}.part", std::process::id()));
    std::fs::write(&scratch, text).map_err(|error| format!("{}: {error}", scratch.display()))?;
    std::fs::rename(&scratch, file).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(notes)
}

/// Title of a run or of a scene, or the name of its folder.
pub(crate) fn title(folder: &Folder) -> String {
    let titled = [&folder.summary, &folder.setup].into_iter().flatten();
    let title = titled.filter_map(|found| found.get("title")?.as_str().map(str::to_owned)).next();
    title.unwrap_or_else(|| folder.name())
}

/// Text as it stands in HTML.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

/// The template with texts in the places `{{name}}`; what was put in is not looked at again.
fn filled(template: &str, parts: &[(&str, &str)]) -> String {
    let mut text = String::with_capacity(template.len() + parts.iter().map(|(_, part)| part.len()).sum::<usize>());
    let mut pieces = template.split("{{");
    text += pieces.next().unwrap_or_default();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").unwrap_or((piece, ""));
        text += parts.iter().find(|(part, _)| *part == name).map_or("", |(_, part)| part);
        text += rest;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_filled_once() {
        let parts = [("a", "$& {{b}} </p>"), ("b", "two")];
        assert_eq!(filled("<{{a}}|{{b}}|{{c}}>", &parts), "<$& {{b}} </p>|two|>");
    }

    #[test]
    fn the_template_has_every_place_and_scripts_do_not_end_early() {
        assert!(PAGE.contains(MARK));
        for name in ["head", "style", "title", "diagnosis", "data", "script"] {
            assert_eq!(PAGE.matches(&format!("{{{{{name}}}}}")).count(), 1, "{name}");
        }
        assert!(SCRIPTS.iter().all(|script| !script.contains("</script") && !script.contains("<!--")));
        assert!(!STYLE.contains("</style"));
        for text in SCRIPTS.iter().chain([&PAGE, &STYLE]) {
            assert!(!text.contains("http") && !text.contains("url("));
        }
    }
}
