//! Rules for manifests and for what git keeps.

use super::Finding;
use crate::manifest::{self, Member};
use crate::workspace::{Outcome, Workspace, capture};

/// All findings of the members' manifests and of the proptest regressions.
pub fn check(workspace: &Workspace) -> Outcome<Vec<Finding>> {
    let mut findings: Vec<Finding> = manifest::members(workspace)?.iter().flat_map(member).collect();
    let list = ["ls-files", "-z", "--others", "--", "*proptest-regressions*"];
    let untracked = capture(workspace.process("git").args(list))?;
    let files = untracked.split('\0').filter(|file| !file.is_empty());
    findings.extend(files.map(|file| Finding::new(file, 0, "a proptest regression that git does not track")));
    Ok(findings)
}

fn member(member: &Member) -> Vec<Finding> {
    let file = format!("{}/Cargo.toml", member.folder);
    let missing = |key: &&str| !member.package.contains_key(*key);
    let keys = ["description", "license", "edition", "rust-version"];
    keys.iter().filter(|key| missing(key)).map(|key| Finding::new(&file, 0, format!("no `{key}`"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn description_and_licence_are_demanded() {
        let manifest =
            "[package]\nname = \"x\"\nedition = \"2024\"\nrust-version = \"1.90\"\nlicense.workspace = true\n";
        let found =
            |text: &str| member(&manifest::member("crates/x".into(), &text.parse().unwrap(), &toml::Table::new()));
        assert_eq!(found(manifest).len(), 1);
        assert!(found(&format!("{manifest}description = \"y\"\n")).is_empty());
    }
}
