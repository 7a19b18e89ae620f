//! The public items of the crates against those of the last release, where cargo-semver-checks is installed.

use crate::workspace::{Outcome, Workspace, capture, show};

/// Fails if a change breaks more than the version says; nothing but a note without the tool, or before the first release.
pub fn check(workspace: &Workspace) -> Outcome<()> {
    if capture(workspace.cargo().args(["semver-checks", "--version"])).is_err() {
        println!("dist: public items are not compared: cargo-semver-checks is not installed");
        return Ok(());
    }
    // The commit that is released may have its tag already.
    let Ok(tag) = capture(workspace.process("git").args(["describe", "--tags", "--abbrev=0", "HEAD^"])) else {
        println!("dist: public items are not compared: there is no release before this one");
        return Ok(());
    };
    let mut command = workspace.cargo();
    command.args(["semver-checks", "--workspace", "--baseline-rev", tag.trim()]);
    match command.status()?.success() {
        true => Ok(()),
        false => Err(format!("`{}` found changes that the version does not allow", show(&command)).into()),
    }
}
