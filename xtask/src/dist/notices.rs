//! Licences of the packages that the program links, which have to go along with it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::workspace::{Outcome, Workspace, capture};

/// A package that is linked.
#[derive(Clone, Debug, PartialEq)]
struct Package {
    /// Name and version.
    title: String,
    /// Expression of its manifest.
    licence: String,
    /// Texts of the files that it brings, sorted.
    texts: Vec<String>,
}

/// The list of packages, then every text once with the packages that have it.
pub fn text(workspace: &Workspace, target: &str) -> Outcome<String> {
    let linked = capture(workspace.cargo().args([
        "tree",
        "--package",
        "stoss-cli",
        "--edges",
        "normal",
        "--prefix",
        "none",
        "--format",
        "{p}",
        "--target",
        target,
    ]))?;
    let metadata = capture(workspace.cargo().args(["metadata", "--format-version", "1", "--filter-platform", target]))?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata)?;
    let mut packages = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let word = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
        let title = format!("{} {}", word("name"), word("version"));
        // Packages without a source are ours.
        if package["source"].is_null() || !is_linked(&linked, &title) {
            continue;
        }
        let folder = PathBuf::from(word("manifest_path"));
        let texts = licence_texts(folder.parent().unwrap_or(Path::new("")))?;
        packages.push(Package { title, licence: word("license"), texts });
    }
    packages.sort_by(|a, b| a.title.cmp(&b.title));
    Ok(document(&packages))
}

/// Whether the lines of `cargo tree` name a package.
fn is_linked(tree: &str, title: &str) -> bool {
    let Some((name, version)) = title.split_once(' ') else { return false };
    tree.lines().any(|line| {
        let mut words = line.split_whitespace();
        words.next() == Some(name) && words.next().and_then(|word| word.strip_prefix('v')) == Some(version)
    })
}

fn licence_texts(folder: &Path) -> Outcome<Vec<String>> {
    let mut texts = Vec::new();
    for file in std::fs::read_dir(folder)? {
        let path = file?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
        let begins = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE"].iter().any(|word| name.starts_with(word));
        if begins && path.is_file() {
            texts.push(String::from_utf8_lossy(&std::fs::read(&path)?).replace("\r\n", "\n").trim().to_owned());
        }
    }
    texts.sort();
    Ok(texts)
}

fn document(packages: &[Package]) -> String {
    let mut out = String::from("Packages that the program contains, and their licences.\n\n");
    let mut texts: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for package in packages {
        out += &format!("{}: {}\n", package.title, package.licence);
        for text in &package.texts {
            texts.entry(text).or_default().push(&package.title);
        }
    }
    for (text, of) in texts {
        out += &format!("\n{}\n{}\n\n{text}\n", "-".repeat(80), of.join(", "));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_texts_come_once_with_all_packages() {
        let package = |title: &str, texts: &[&str]| Package {
            title: title.into(),
            licence: "MIT".into(),
            texts: texts.iter().map(|text| (*text).to_owned()).collect(),
        };
        let text = document(&[package("a 1.0.0", &["same"]), package("b 2.0.0", &["other", "same"])]);
        assert_eq!(text.matches("same").count(), 1);
        assert!(text.contains("a 1.0.0, b 2.0.0\n\nsame\n") && text.contains("b 2.0.0\n\nother\n"));
    }

    #[test]
    fn only_what_the_tree_names_is_linked() {
        let tree = "stoss-cli v0.1.0 (/x)\nserde v1.0.0\nserde v1.0.0 (*)\n";
        assert!(is_linked(tree, "serde 1.0.0"));
        assert!(!is_linked(tree, "serde 2.0.0") && !is_linked(tree, "serde_json 1.0.0"));
    }
}
