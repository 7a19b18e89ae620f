//! The page of a run: one HTML file that needs neither a network nor another file.
//!
//! It shows the run as an animation, charts that follow its time, the verdict, the plan and the scene; of several runs
//! it lays the charts over each other and lists what differs. The browser's part is in `assets/`; `payload.rs` says what is handed to it.
//!
//! Not here: pictures without a browser ([`crate::picture`]).

pub mod coding;
mod fields;
mod payload;
mod shape;
mod tables;

pub(crate) use fields::Field;

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::folder::Folder;
use crate::{Outcome, read};

/// Name of the page in a folder of results.
pub const NAME: &str = "report.html";

/// What tells our pages from others.
const MARK: &str = "<meta name=\"generator\" content=\"Stoss\">";

const PAGE: &str = include_str!("assets/page.html");
const STYLE: &str = include_str!("assets/style.css");
/// Every part of the program, in the order in which they use each other.
const SCRIPTS: [&str; 8] = [
    include_str!("assets/payload.js"),
    include_str!("assets/linear.js"),
    include_str!("assets/viewer.js"),
    include_str!("assets/charts.js"),
    include_str!("assets/curves.js"),
    include_str!("assets/panels.js"),
    include_str!("assets/app.js"),
    include_str!("assets/selftest.js"),
];

/// A page and what is to be said about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// The text of the file.
    pub text: String,
    /// What could not be read or was left out, with the names of files.
    pub notes: Vec<String>,
}

/// The page of one run or of several that are compared.
///
/// # Errors
/// If a folder has no results at all.
pub fn page(folders: &[&Path]) -> Outcome<Page> {
    let (mut data, mut notes, mut titles) = (String::new(), Vec::new(), Vec::new());
    for path in folders {
        let folder = Folder::open(path)?;
        let (bytes, found) = payload::pack(&folder)?;
        notes.extend(found);
        titles.push(title(&folder));
        data += "<script type=\"text/plain\" class=\"run\">";
        STANDARD.encode_string(bytes, &mut data);
        data += "</script>\n";
    }
    // The page of the diagnosis is beside that of the first run, which the browser opens.
    let diagnosed = folders.len() == 1 && folders[0].join(crate::folder::DIAGNOSIS).is_file();
    let link = format!("<a href=\"{}\">why, and what to try</a>", crate::folder::DIAGNOSIS_PAGE);
    let diagnosis = if diagnosed { link.as_str() } else { "" };
    let script = SCRIPTS.join("\n");
    let title = escaped(&titles.join(" | "));
    let parts = [
        ("style", STYLE),
        ("title", title.as_str()),
        ("diagnosis", diagnosis),
        ("data", data.as_str()),
        ("script", script.as_str()),
    ];
    Ok(Page { text: filled(PAGE, &parts), notes })
}

/// Writes the page of these runs into the folder of the first; returns the notes.
///
/// # Errors
/// As [`page`], and what the system says about writing.
pub fn write(folders: &[&Path]) -> Outcome<Vec<String>> {
    let Some(first) = folders.first() else { return Err("no folder of results is named".into()) };
    let (path, scratch) = (first.join(NAME), first.join(".report.html.part"));
    if path.exists() && !read(&path)?.contains(MARK) {
        return Err(format!("{}: it was not written by Stoss; move it away", path.display()).into());
    }
    let Page { text, notes } = page(folders)?;
    std::fs::write(&scratch, text).map_err(|error| format!("{}: {error}", scratch.display()))?;
    std::fs::rename(&scratch, &path).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(notes)
}

/// Title of a run, or the name of its folder.
pub(crate) fn title(folder: &Folder) -> String {
    let title = folder.summary.as_ref().and_then(|summary| summary.get("title")?.as_str().map(str::to_owned));
    title.unwrap_or_else(|| folder.name())
}

/// Text as it stands in HTML and SVG.
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
        for name in ["style", "title", "diagnosis", "data", "script"] {
            assert_eq!(PAGE.matches(&format!("{{{{{name}}}}}")).count(), 1, "{name}");
        }
        assert!(SCRIPTS.iter().all(|script| !script.contains("</script") && !script.contains("<!--")));
        assert!(!STYLE.contains("</style"));
        for text in SCRIPTS.iter().chain([&PAGE, &STYLE]) {
            assert!(!text.contains("http") && !text.contains("url("));
        }
    }
}
