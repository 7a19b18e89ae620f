//! Rules for manifests and for what git keeps.

use super::Violation;
use crate::manifest::{self, Member};
use crate::workspace::{Outcome, Workspace, capture};

/// All findings of the members' manifests and of the proptest regressions.
pub fn check(workspace: &Workspace) -> Outcome<Vec<Violation>> {
    let members = manifest::members(workspace)?;
    let mut findings: Vec<Violation> = members.iter().flat_map(member).collect();
    for member in members.iter().filter(|member| member.is_published()) {
        let source = workspace.read(format!("{}/src/lib.rs", member.folder))?;
        findings.extend(front_page(&member.folder, &source));
    }
    // Packages that were unpacked to be verified are in the target folder.
    let list = ["ls-files", "-z", "--others", "--", "*proptest-regressions*", ":!target/"];
    let untracked = capture(workspace.process("git").args(list))?;
    let files = untracked.split('\0').filter(|file| !file.is_empty());
    findings.extend(files.map(|file| Violation::new(file, 0, "a proptest regression that git does not track")));
    Ok(findings)
}

/// Keys that every manifest has, and those that a published crate has besides.
const KEYS: [&str; 4] = ["description", "license", "edition", "rust-version"];
const PUBLISHED_KEYS: [&str; 5] = ["repository", "documentation", "readme", "keywords", "categories"];

/// Most keywords that crates.io takes.
const MOST_KEYWORDS: usize = 5;

fn member(member: &Member) -> Vec<Violation> {
    let file = format!("{}/Cargo.toml", member.folder);
    let published: &[&str] = if member.is_published() { &PUBLISHED_KEYS } else { &[] };
    let missing = KEYS.iter().chain(published).filter(|key| !member.package.contains_key(**key));
    let mut findings: Vec<Violation> = missing.map(|key| Violation::new(&file, 0, format!("no `{key}`"))).collect();
    if manifest::strings(member.package.get("keywords")).len() > MOST_KEYWORDS {
        findings.push(Violation::new(&file, 0, format!("more than {MOST_KEYWORDS} keywords")));
    }
    findings
}

/// The README of a published crate is a part of its front page: so its example compiles, and both say the same.
fn front_page(folder: &str, source: &str) -> Option<Violation> {
    let included =
        source.lines().any(|line| line.starts_with("#![") && line.contains("include_str!(\"../README.md\")"));
    let message = "does not include its README.md as documentation";
    (!included).then(|| Violation::new(&format!("{folder}/src/lib.rs"), 0, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> usize {
        member(&manifest::member("crates/x".into(), &text.parse().unwrap(), &toml::Table::new())).len()
    }

    #[test]
    fn description_and_licence_are_demanded() {
        let manifest = "[package]\nname = \"x\"\nedition = \"2024\"\nrust-version = \"1.90\"\nlicense.workspace = true\npublish = false\n";
        assert_eq!(found(manifest), 1);
        assert_eq!(found(&format!("{manifest}description = \"y\"\n")), 0);
    }

    #[test]
    fn what_is_published_says_more_of_itself() {
        let manifest = "[package]\nname = \"x\"\nedition = \"2024\"\nrust-version = \"1.90\"\nlicense = \"MIT\"\ndescription = \"y\"\n";
        assert_eq!(found(manifest), PUBLISHED_KEYS.len());
        let more = "repository = \"r\"\ndocumentation = \"d\"\nreadme = \"README.md\"\ncategories = []\n";
        assert_eq!(found(&format!("{manifest}{more}keywords = []\n")), 0);
        assert_eq!(found(&format!("{manifest}{more}keywords = [\"a\", \"b\", \"c\", \"d\", \"e\", \"f\"]\n")), 1);
    }

    #[test]
    fn the_readme_is_on_the_front_page() {
        assert!(front_page("crates/x", "//! X.\n#![doc = include_str!(\"../README.md\")]\n").is_none());
        assert!(front_page("crates/x", "//! X.\n").is_some());
    }
}
