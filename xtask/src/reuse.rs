//! `cargo xtask reuse`: each published crate builds alone and pulls in what its committed list says, nothing more.

use std::collections::BTreeSet;
use std::path::PathBuf;

use crate::layers::expected_package;
use crate::manifest::{self, Member};
use crate::workspace::{Outcome, Workspace, capture, read, show, write};

/// Lists are made for one platform, so that they are the same on every machine.
const PLATFORM: &str = "x86_64-unknown-linux-gnu";

/// Checks (or, with `bless`, writes) the lists, then builds each leaf and each feature of the facade alone.
pub fn command(workspace: &Workspace, bless: bool) -> Outcome<bool> {
    let mut good = true;
    let members = manifest::members(workspace)?;
    let leaves = published(&members);
    let is_list =
        |file: &&PathBuf| file.starts_with("docs/reuse") && file.extension().is_some_and(|kind| kind == "txt");
    for file in workspace.files()?.iter().filter(is_list) {
        if !leaves.iter().any(|leaf| file.file_stem().is_some_and(|stem| stem == *leaf)) {
            println!("reuse: error: {} belongs to no published crate", file.display());
            good = false;
        }
    }
    for leaf in leaves {
        let package = expected_package(leaf);
        let found = dependencies(workspace, &package)?;
        let file = workspace.path(format!("docs/reuse/{leaf}.txt"));
        if bless {
            write(&file, &lines(&found))?;
            println!("reuse: wrote docs/reuse/{leaf}.txt ({} packages)", found.len());
            continue;
        }
        let committed: BTreeSet<String> = read(&file)?.lines().map(str::to_owned).collect();
        for difference in differences(&committed, &found) {
            println!("reuse: error: {leaf}: {difference}");
            good = false;
        }
        good &= builds(workspace, &["-p", &package])?;
    }
    if bless {
        return Ok(true);
    }
    good &= builds(workspace, &["-p", "stoss", "--no-default-features"])?;
    for facade in members.iter().filter(|member| member.name == "stoss") {
        for feature in &facade.features {
            good &= builds(workspace, &["-p", "stoss", "--no-default-features", "--features", feature])?;
        }
    }
    println!("reuse: {}", if good { "every leaf stands alone" } else { "see above; --bless accepts new lists" });
    Ok(good)
}

/// Folders under `crates/` of what others may want without the rest of Stoss, and of the facade: all that may be published.
fn published(members: &[Member]) -> Vec<&str> {
    members.iter().filter(|member| member.is_published()).filter_map(Member::crate_name).collect()
}

/// Names of all packages below `package`, without itself.
fn dependencies(workspace: &Workspace, package: &str) -> Outcome<BTreeSet<String>> {
    let text = capture(workspace.cargo().args([
        "tree",
        "--package",
        package,
        "--edges",
        "normal",
        "--prefix",
        "none",
        "--target",
        PLATFORM,
    ]))?;
    Ok(names(&text, package))
}

/// First word of every line but the package itself.
fn names(tree: &str, package: &str) -> BTreeSet<String> {
    let words = tree.lines().filter_map(|line| line.split_whitespace().next());
    words.filter(|name| *name != package).map(str::to_owned).collect()
}

fn lines(names: &BTreeSet<String>) -> String {
    names.iter().map(|name| format!("{name}\n")).collect()
}

fn differences(committed: &BTreeSet<String>, found: &BTreeSet<String>) -> Vec<String> {
    let added = found.difference(committed).map(|name| format!("now pulls in {name}"));
    let removed = committed.difference(found).map(|name| format!("no longer pulls in {name}"));
    added.chain(removed).collect()
}

fn builds(workspace: &Workspace, arguments: &[&str]) -> Outcome<bool> {
    let mut command = workspace.cargo();
    command.args(["check", "--quiet"]).args(arguments);
    let good = command.status()?.success();
    println!("reuse: {} {}", if good { "ok   " } else { "error" }, show(&command));
    Ok(good)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TREE: &str = "stoss-continuum v0.1.0 (/some/where)\nstoss-tensor v0.1.0 (/x)\nnalgebra v0.35.0\n\
                        nalgebra v0.35.0 (*)\nsyn v2.0.1 (proc-macro)\n";

    #[test]
    fn names_are_unique_and_without_the_package_itself() {
        let names: Vec<_> = names(TREE, "stoss-continuum").into_iter().collect();
        assert_eq!(names, ["nalgebra", "stoss-tensor", "syn"]);
    }

    #[test]
    fn both_directions_of_difference_are_told() {
        let set = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>();
        let told = differences(&set(&["a", "b"]), &set(&["b", "c"]));
        assert_eq!(told, ["now pulls in c", "no longer pulls in a"]);
        assert!(differences(&set(&["a"]), &set(&["a"])).is_empty());
    }
}
