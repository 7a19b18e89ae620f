//! Rules for citations: what a comment or a document cites is in the repository.
//!
//! A place in the theory is `theory/PAGE#ANCHOR`, or `theory/PAGE` for a whole page; Markdown has links instead, see
//! `documents`. A work of others is a key of `docs/theory/references.bib` in brackets (in the theory also in backticks):
//! letters, a year from 1800 on, and possibly letters again. Other words in brackets are none, nor are the texts of links.

use std::collections::{BTreeMap, BTreeSet};

use super::source::Source;
use super::{Violation, documents};

/// Folder of the pages, from the root.
const FOLDER: &str = "docs/theory/";

/// What can be cited.
#[derive(Debug, Default)]
pub struct Theory {
    /// Anchors of each page.
    pages: BTreeMap<String, BTreeSet<String>>,
    /// Keys of the works of others.
    keys: BTreeSet<String>,
}

impl Theory {
    /// Takes in a file if it belongs to the theory.
    pub fn add(&mut self, file: &str, content: &str) {
        let Some(name) = file.strip_prefix(FOLDER) else { return };
        if let Some(page) = name.strip_suffix(".md") {
            self.pages.insert(page.to_owned(), documents::anchors(content));
        } else if name.ends_with(".bib") {
            let entries = content.lines().filter(|line| line.starts_with('@'));
            let keys = entries.filter_map(|line| line.split_once('{')).map(|(_, key)| key.trim_end_matches(','));
            self.keys.extend(keys.map(str::to_owned));
        }
    }

    /// All findings of one file.
    pub fn check(&self, file: &str, content: &str) -> Vec<Violation> {
        let lines = prose(file, content);
        let mut findings = Vec::new();
        for (number, line) in lines.iter().enumerate() {
            let mut tell = |message: String| findings.push(Violation::new(file, number + 1, message));
            for (page, rest) in places(line) {
                if rest.starts_with(".md") {
                    if !file.ends_with(".md") {
                        tell(format!("cites theory/{page}.md; write theory/{page}#ANCHOR"));
                    }
                    continue;
                }
                match (self.pages.get(page), anchor(rest)) {
                    (None, _) if rest.starts_with('.') => {}
                    (None, _) => tell(format!("cites theory/{page}, which is no page of {FOLDER}")),
                    (Some(anchors), Some(anchor)) if !anchors.contains(anchor) => {
                        tell(format!("cites theory/{page}#{anchor}, but the page has no such anchor"));
                    }
                    _ => {}
                }
            }
            let quoted = if file.starts_with(FOLDER) { documents::quoted(line) } else { Vec::new() };
            for key in bracketed(line).into_iter().chain(quoted).filter(|word| is_key(word)) {
                if !self.keys.contains(key) {
                    tell(format!("cites {key}, which is no key of {FOLDER}references.bib"));
                }
            }
        }
        findings
    }
}

/// The lines of a file in which something is cited: comments of sources and scenes, all of other texts.
fn prose(file: &str, content: &str) -> Vec<String> {
    if file.ends_with(".rs") {
        Source::new(content).comments
    } else if file.ends_with(".toml") {
        content.lines().map(|line| line.split_once('#').map_or("", |(_, comment)| comment).to_owned()).collect()
    } else if [".md", ".json", ".geo"].iter().any(|kind| file.ends_with(kind)) {
        content.lines().map(str::to_owned).collect()
    } else {
        Vec::new()
    }
}

/// Pages that a line names behind `theory/`, each with what follows it.
fn places(line: &str) -> Vec<(&str, &str)> {
    let starts = line.match_indices("theory/").filter(|(at, _)| !line[..*at].ends_with(char::is_alphanumeric));
    let split = starts.map(|(at, word)| {
        let rest = &line[at + word.len()..];
        rest.split_at(length(rest, |symbol| symbol.is_ascii_lowercase() || symbol == '-'))
    });
    split.filter(|(page, _)| !page.is_empty()).collect()
}

/// The anchor at the start of what follows a page.
fn anchor(rest: &str) -> Option<&str> {
    let rest = rest.strip_prefix('#')?;
    Some(&rest[..length(rest, |symbol| symbol.is_ascii_alphanumeric() || symbol == '-' || symbol == '_')])
}

/// Bytes up to the first symbol that is not `allowed`.
fn length(text: &str, allowed: impl Fn(char) -> bool) -> usize {
    text.find(|symbol| !allowed(symbol)).unwrap_or(text.len())
}

/// What stands in brackets, without backslashes; not the texts of links.
fn bracketed(line: &str) -> Vec<&str> {
    let words = line.split('[').skip(1).filter_map(|rest| rest.split_once(']'));
    words.filter(|(_, behind)| !behind.starts_with('(')).map(|(word, _)| word.trim_end_matches('\\')).collect()
}

/// True for letters, a year, and possibly letters.
fn is_key(word: &str) -> bool {
    let letters = length(word, |symbol| symbol.is_ascii_lowercase());
    let (_, rest) = word.split_at(letters);
    let digits = length(rest, |symbol| symbol.is_ascii_digit());
    let (year, more) = rest.split_at(digits);
    let recent = ["18", "19", "20"].iter().any(|century| year.starts_with(century));
    letters > 2 && digits == 4 && recent && more.chars().all(|symbol| symbol.is_ascii_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(file: &str, content: &str) -> Vec<usize> {
        let mut theory = Theory::default();
        theory.add("docs/theory/one.md", "# One\n<a id=\"eq-sum\"></a>\n## 2. The sum\n");
        theory.add(
            "docs/theory/references.bib",
            "% text\n@book{hughes1987,\n  year = {1987},\n}\n@article{puso2004friction,\n",
        );
        theory.add("docs/other.md", "# Other\n");
        theory.check(file, content).into_iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn pages_and_anchors_must_exist() {
        let good =
            "// theory/one#eq-sum, theory/one#2-the-sum: (theory/one). theory/one#eq-sum\nlet x = \"theory/two\";\n";
        assert!(lines("a.rs", good).is_empty());
        assert_eq!(lines("a.rs", "// theory/one#eq-sums\n\n/// theory/two\n//! docs/theory/one.md\n"), [1, 3, 4]);
        assert_eq!(lines("a.toml", "a = 1 # theory/other\nb = \"theory/two\"\n"), [1]);
        assert_eq!(lines("a.md", "[x](theory/one.md#eq-none) `theory/one#none`\ntheory/references.bib\n"), [1]);
        assert_eq!(lines("a.json", "\"as in theory/one#none\"\n"), [1]);
        assert!(lines("a.rs", "// In theory, theory/PAGE#ANCHOR and theory/.\n").is_empty());
    }

    #[test]
    fn keys_must_exist() {
        let good =
            "/// \\[hughes1987\\], [puso2004friction], [hex8], [a1987], [x198], [other2001](b.md), [hex2000a b]\n";
        assert!(lines("a.rs", good).is_empty());
        assert_eq!(lines("a.rs", "/// \\[hughes1988\\]\n// [puso2004]\nlet y = a[puso2004];\n"), [1, 2]);
        assert_eq!(lines("a.md", "see [nobody1999]\n"), [1]);
        assert_eq!(lines("docs/theory/one.md", "`hughes1987`, `nobody1999`\n"), [1]);
        assert!(lines("docs/guide/contact.md", "`nobody1999`\n").is_empty());
    }
}
