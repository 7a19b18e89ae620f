//! Rules for Markdown: paths that a document names exist, and so do the anchors of its links.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use super::Violation;

/// Folders at the root; a word that starts with one of them is meant as a path.
const FOLDERS: [&str; 6] = ["crates/", "docs/", "scenes/", "tests/", "xtask/", ".ci/"];

/// All findings of one document; `exists` and `anchors_of` (nothing for what is no text) answer for paths from the root.
pub fn check(
    file: &str,
    content: &str,
    exists: impl Fn(&Path) -> bool,
    anchors_of: impl Fn(&Path) -> Option<BTreeSet<String>>,
) -> Vec<Violation> {
    let mut findings = Vec::new();
    let mut known = BTreeMap::new();
    let mut fenced = false;
    for (number, line) in content.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
            continue;
        }
        let mut demand = |path: PathBuf| {
            if !exists(&path) {
                findings.push(Violation::new(
                    file,
                    number + 1,
                    format!("names {}, which does not exist", path.display()),
                ));
            }
        };
        for span in if fenced { vec![line] } else { quoted(line) } {
            span.split_whitespace().filter_map(path_from_root).for_each(&mut demand);
        }
        if !fenced {
            links(line).into_iter().filter_map(|link| resolve(file, link)).for_each(&mut demand);
            for (path, anchor) in links(line).into_iter().filter_map(|link| anchored(file, link)) {
                let found = known.entry(path.clone()).or_insert_with(|| anchors_of(&path));
                if found.as_ref().is_some_and(|found| !found.contains(anchor)) {
                    let message = format!("links to {}#{anchor}, which has no such anchor", path.display());
                    findings.push(Violation::new(file, number + 1, message));
                }
            }
        }
    }
    findings
}

/// Anchors of a document: those that it sets, and those that hosts give to its headings.
pub fn anchors(content: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut fenced = false;
    for line in content.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        }
        if fenced {
            continue;
        }
        let set = line.split("<a id=\"").skip(1).filter_map(|rest| rest.split_once('"'));
        found.extend(set.map(|(anchor, _)| anchor.to_owned()));
        let heading = line.trim_start_matches('#');
        if heading.len() < line.len() && heading.starts_with(' ') {
            let base = slug(heading.trim());
            let repeated = (1..).map(|count| format!("{base}-{count}"));
            found.extend(std::iter::once(base.clone()).chain(repeated).find(|slug| !found.contains(slug)));
        }
    }
    found
}

/// A heading as an anchor: lower case, hyphens for blanks, no other signs.
fn slug(heading: &str) -> String {
    let kept = heading.chars().filter(|symbol| symbol.is_alphanumeric() || [' ', '-', '_'].contains(symbol));
    kept.flat_map(char::to_lowercase).map(|symbol| if symbol == ' ' { '-' } else { symbol }).collect()
}

/// What stands between backticks.
pub fn quoted(line: &str) -> Vec<&str> {
    line.split('`').skip(1).step_by(2).collect()
}

/// The path that a word names, if it names one and is no pattern.
fn path_from_root(word: &str) -> Option<PathBuf> {
    let word = word.trim_matches(|symbol: char| "\"'(),;:".contains(symbol)).trim_end_matches('.');
    let word = word.split_once(':').map_or(word, |(path, _line)| path);
    let pattern = word.contains(['*', '<', '>', '{', '$', '…']) || word.contains("...");
    (FOLDERS.iter().any(|folder| word.starts_with(folder)) && !pattern).then(|| PathBuf::from(word))
}

/// Targets of links and pictures.
fn links(line: &str) -> Vec<&str> {
    line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target).collect()
}

/// Path from the root of a link in `file`; nothing for addresses and places in the same page.
fn resolve(file: &str, link: &str) -> Option<PathBuf> {
    let link = link.split('#').next().unwrap_or_default();
    if link.is_empty() || link.contains("://") || link.starts_with("mailto:") {
        return None;
    }
    let mut path = Path::new(file).parent().map(Path::to_path_buf).unwrap_or_default();
    for part in Path::new(link).components() {
        match part {
            Component::ParentDir => {
                path.pop();
            }
            Component::Normal(part) => path.push(part),
            _ => {}
        }
    }
    Some(path)
}

/// Path from the root and anchor of a link to a place in a document.
fn anchored<'a>(file: &str, link: &'a str) -> Option<(PathBuf, &'a str)> {
    let (path, anchor) = link.split_once('#')?;
    if path.is_empty() {
        return Some((PathBuf::from(file), anchor));
    }
    path.ends_with(".md").then(|| resolve(file, link)).flatten().map(|path| (path, anchor))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(content: &str) -> Vec<usize> {
        let known = ["docs/a.md", "docs", "scenes/b.toml", "crates/x/src"];
        let exists = |path: &Path| known.iter().any(|known| Path::new(known) == path);
        let anchors_of = |path: &Path| match path.to_str() {
            Some("docs/page.md") => Some(anchors(content)),
            Some("docs/a.md") => {
                Some(anchors("# A `[b]` c, 2\n<a id=\"place\"></a>\n```\n# none\n```\n## A [b] c 2\n"))
            }
            _ => None,
        };
        check("docs/page.md", content, exists, anchors_of).into_iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn paths_in_backticks_and_fences_must_exist() {
        assert!(lines("`docs/a.md` and `crates/x/src/`, `crates/x/src:12`, `stoss run scenes/b.toml`").is_empty());
        assert_eq!(lines("fine\n`docs/c.md`\n"), [2]);
        assert_eq!(lines("```\nstoss run scenes/c.toml\n```\n"), [2]);
        assert!(lines("docs/c.md without quotes, `crates/<x>/src`, `scenes/*.toml`, `other/c.md`").is_empty());
    }

    #[test]
    fn links_must_lead_somewhere() {
        assert!(
            lines("[a](a.md) [b](../scenes/b.toml) [c](https://example.org/x) [d](a.md) [e](a.md#place)").is_empty()
        );
        assert_eq!(lines("[a](c.md) ![b](../scenes/d.svg)"), [1, 1]);
    }

    #[test]
    fn anchors_of_links_must_exist() {
        assert!(lines("# Two words\n[a](#two-words) [b](a.md#a-b-c-2) [c](a.md#a-b-c-2-1) [d](a.md#place)").is_empty());
        assert_eq!(lines("# Two words\n[a](#three-words)\n[b](a.md#a-b-c)\n[c](a.md#none)\n"), [2, 3, 4]);
    }
}
