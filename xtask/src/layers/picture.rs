//! `docs/layers.md`: which crate stands on which, drawn from the manifests.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::manifest::Member;

/// The page: the crates in layers, and a table of what each depends on directly.
pub fn page(members: &[Member]) -> String {
    let names: BTreeMap<&str, &str> =
        members.iter().filter_map(|member| Some((member.name.as_str(), member.crate_name()?))).collect();
    let crates: Vec<(&str, &Member, BTreeSet<&str>)> = members
        .iter()
        .filter_map(|member| {
            let ours = member.dependencies.iter().filter_map(|name| names.get(name.as_str()).copied()).collect();
            Some((member.crate_name()?, member, ours))
        })
        .collect();
    let below: BTreeMap<&str, &BTreeSet<&str>> = crates.iter().map(|(name, _, ours)| (*name, ours)).collect();
    let mut text = String::from(
        "# The crates in their layers\n\n\
         Drawn by `cargo xtask layers --bless` from the manifests; `layers.toml` says which arrows are allowed. An arrow goes to what a crate uses; \
         arrows that follow from others are left out of the picture, not of the table. What each crate is for, and what not, is in the \
         [architecture](ARCHITECTURE.md#1-the-layers).\n\n```mermaid\nflowchart TD\n",
    );
    for (name, _, ours) in &crates {
        let indirect = |other: &&str| ours.iter().any(|via| via != other && reaches(via, other, &below));
        let direct: Vec<&str> = ours.iter().filter(|other| !indirect(other)).copied().collect();
        if direct.is_empty() {
            writeln!(text, "  {name}").unwrap();
        }
        for other in direct {
            writeln!(text, "  {name} --> {other}").unwrap();
        }
    }
    text.push_str("```\n\n| layer | crate | | uses of ours |\n|---|---|---|---|\n");
    let mut rows: Vec<_> =
        crates.iter().map(|(name, member, ours)| (height(name, &below), *name, *member, ours)).collect();
    rows.sort_by_key(|(height, name, ..)| (std::cmp::Reverse(*height), *name));
    for (height, name, member, ours) in rows {
        let description = member.package.get("description").and_then(|text| text.as_str()).unwrap_or_default();
        let used: Vec<String> = ours.iter().map(|name| format!("`{name}`")).collect();
        writeln!(text, "| {height} | [`{name}`](../crates/{name}) | {description} | {} |", used.join(", ")).unwrap();
    }
    text
}

/// True if `other` is below `name`, at any depth.
fn reaches(name: &str, other: &str, below: &BTreeMap<&str, &BTreeSet<&str>>) -> bool {
    below.get(name).is_some_and(|ours| ours.iter().any(|via| *via == other || reaches(via, other, below)))
}

/// Number of crates of the longest chain down from `name`, itself included.
fn height(name: &str, below: &BTreeMap<&str, &BTreeSet<&str>>) -> usize {
    1 + below.get(name).into_iter().flat_map(|ours| ours.iter()).map(|via| height(via, below)).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_that_follow_from_others_are_not_drawn() {
        let member = |name: &str, dependencies: &[&str]| Member {
            folder: format!("crates/{name}"),
            name: format!("stoss-{name}"),
            dependencies: dependencies.iter().map(|name| format!("stoss-{name}")).collect(),
            features: Vec::new(),
            package: format!("description = \"The {name}.\"").parse().unwrap(),
        };
        let page = page(&[member("top", &["middle", "base"]), member("middle", &["base"]), member("base", &[])]);
        assert!(
            page.contains("  top --> middle\n") && page.contains("  middle --> base\n") && page.contains("\n  base\n")
        );
        assert!(!page.contains("top --> base"));
        assert!(page.contains("| 3 | [`top`](../crates/top) | The top. | `base`, `middle` |"));
    }
}
