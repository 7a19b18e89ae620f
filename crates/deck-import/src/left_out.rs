//! The list of what a scene lacks of its deck.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

use stoss_mesh_io::deck::{Deck, DeckPlace};

use crate::keywords::{Meaning, meaning};
use crate::severity::Severity;
use crate::text::{count, string};

/// Something of a deck that the scene does not have, or has in another form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Meaning for the results.
    pub severity: Severity,
    /// "part.inp:12"; the file alone where it concerns no line.
    pub place: String,
    /// Keyword of what is left out, as "*PLASTIC".
    pub what: String,
    /// What that changes.
    pub consequence: String,
    /// What to do; empty if there is nothing to do.
    pub remedy: String,
}

impl LeftOut {
    /// What it changes and what to do, in one sentence.
    pub fn text(&self) -> String {
        if self.remedy.is_empty() { self.consequence.clone() } else { format!("{}; {}", self.consequence, self.remedy) }
    }

    /// Table `[[left_out]]` of the entry in a scene.
    pub(crate) fn table(&self) -> String {
        let [keyword, line, text] = [&self.what, &self.place, &self.text()].map(|text| string(text));
        let severity = string(self.severity.name());
        format!("[[left_out]]\nseverity = {severity}\nkeyword = {keyword}\nline = {line}\ntext = {text}\n")
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.place, self.what, self.text())
    }
}

/// Entries with their places, as they are found.
pub(crate) struct List {
    entries: Vec<(Option<DeckPlace>, LeftOut)>,
    file: String,
    /// Names of the files by their numbers.
    files: Vec<String>,
    /// Whether a material of the deck has thermal strains.
    expands: bool,
    /// Types of elements that are no solids and were mapped.
    pub handled_elements: BTreeSet<String>,
}

/// The last part of a path: readers know the folder of their deck.
fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

impl List {
    pub fn new(deck: &Deck) -> Self {
        let files: Vec<String> = deck.files().iter().map(|path| file_name(path)).collect();
        let expands = deck.expands;
        Self {
            entries: Vec::new(),
            file: file_name(deck.contents.path()),
            files,
            expands,
            handled_elements: BTreeSet::new(),
        }
    }

    /// "part.inp:12".
    pub fn place(&self, place: DeckPlace) -> String {
        format!("{}:{}", self.files.get(place.file).unwrap_or(&self.file), place.line)
    }

    /// Adds an entry.
    pub fn add(
        &mut self,
        severity: Severity,
        place: DeckPlace,
        what: impl Into<String>,
        consequence: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let (what, consequence, remedy) = (what.into(), consequence.into(), remedy.into());
        let entry = LeftOut { severity, place: self.place(place), what, consequence, remedy };
        if !self.entries.iter().any(|(_, other)| *other == entry) {
            self.entries.push((Some(place), entry));
        }
    }

    /// Adds an entry for something that is not read, with what the table of keywords says of it.
    pub fn add_unread(&mut self, place: DeckPlace, what: impl Into<String>) {
        let what = what.into();
        let Meaning { severity, consequence, remedy } = meaning(&what, self.expands);
        self.add(severity, place, what, consequence, remedy);
    }

    /// Adds an entry that concerns no line.
    pub fn add_general(
        &mut self,
        severity: Severity,
        what: impl Into<String>,
        consequence: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let entry = LeftOut {
            severity,
            place: self.file.clone(),
            what: what.into(),
            consequence: consequence.into(),
            remedy: remedy.into(),
        };
        self.entries.push((None, entry));
    }

    /// All entries with those of the reader, the worst first and then in the order of the deck.
    pub fn finish(mut self, deck: &Deck) -> Vec<LeftOut> {
        let is_handled =
            |what: &str| what.strip_prefix("elements ").is_some_and(|kind| self.handled_elements.contains(kind));
        let others: Vec<_> =
            deck.contents.other_elements().into_iter().filter(|other| !is_handled(&other.what)).collect();
        for other in others {
            let file = file_name(&other.path);
            let number = self.files.iter().position(|name| *name == file).unwrap_or(0);
            let what = match other.what.strip_prefix("elements ") {
                Some(kind) => format!("{} {kind}", count(other.count, "element", "elements")),
                None => format!("{} {}", other.count, other.what),
            };
            self.add(
                Severity::Missing,
                DeckPlace { file: number, line: other.line },
                what,
                "they are not in the scene: their stiffness and mass are missing",
                other.remedy,
            );
        }
        for note in deck.contents.notes().iter().filter(|note| !note.contains(" is read as ")) {
            self.add_general(Severity::Note, "mesh", note.clone(), "");
        }
        // Requests of output change no result.
        // The section of beams that are nothing but a pretension.
        let no_beams = self.handled_elements.contains("B31");
        let matters = |what: &str| !(no_beams && what == "*BEAM SECTION");
        for left in deck.left_out.iter().filter(|left| left.changes_results && matters(&left.what)) {
            self.add_unread(left.place, left.what.clone());
        }
        self.entries.sort_by_key(|(place, entry)| (entry.severity, *place));
        once(self.entries.into_iter().map(|(_, entry)| entry))
    }
}

/// Entries that say the same of many lines once, with their number.
fn once(entries: impl Iterator<Item = LeftOut>) -> Vec<LeftOut> {
    let mut all: Vec<(LeftOut, usize)> = Vec::new();
    let mut known = BTreeMap::new();
    for entry in entries {
        let text = (entry.severity, entry.what.clone(), entry.consequence.clone(), entry.remedy.clone());
        let index = *known.entry(text).or_insert(all.len());
        match all.get_mut(index) {
            Some((_, more)) => *more += 1,
            None => all.push((entry, 0)),
        }
    }
    let counted = |(entry, more): (LeftOut, usize)| match more {
        0 => entry,
        1 => LeftOut { what: format!("{} (and 1 more line)", entry.what), ..entry },
        n => LeftOut { what: format!("{} (and {n} more lines)", entry.what), ..entry },
    };
    all.into_iter().map(counted).collect()
}
