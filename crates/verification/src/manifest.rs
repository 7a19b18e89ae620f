//! What the checks need of the workspace's `Cargo.toml` files.

use std::collections::BTreeMap;

use toml::Table;

use crate::workspace::{Outcome, Workspace};

/// One member of the workspace.
#[derive(Clone, Debug)]
pub struct Member {
    /// Folder relative to the root, e.g. `crates/tensor`.
    pub folder: String,
    /// Package name.
    pub name: String,
    /// Package names of normal and build dependencies, optional and target-specific ones included, sorted.
    pub dependencies: Vec<String>,
    /// Names of the features other than `default`, sorted.
    pub features: Vec<String>,
    /// The `[package]` table.
    pub package: Table,
}

impl Member {
    /// Name of the folder under `crates/`, if it is there.
    pub fn crate_name(&self) -> Option<&str> {
        self.folder.strip_prefix("crates/")
    }

    /// False if it says `publish = false`.
    pub fn is_published(&self) -> bool {
        self.package.get("publish").and_then(|flag| flag.as_bool()) != Some(false)
    }
}

/// All members, sorted by folder.
pub fn members(workspace: &Workspace) -> Outcome<Vec<Member>> {
    let root: Table = workspace.read("Cargo.toml")?.parse()?;
    let section = table(&root, "workspace");
    let shared = table(&section, "dependencies");
    let mut found = Vec::new();
    for pattern in strings(section.get("members")) {
        for folder in expand(workspace, &pattern)? {
            let text = workspace.read(format!("{folder}/Cargo.toml"))?;
            let manifest: Table = text.parse().map_err(|error| format!("{folder}/Cargo.toml: {error}"))?;
            found.push(member(folder, &manifest, &shared));
        }
    }
    found.sort_by(|a, b| a.folder.cmp(&b.folder));
    Ok(found)
}

fn expand(workspace: &Workspace, pattern: &str) -> Outcome<Vec<String>> {
    let Some(parent) = pattern.strip_suffix("/*") else { return Ok(vec![pattern.to_owned()]) };
    let mut folders = Vec::new();
    for entry in std::fs::read_dir(workspace.path(parent))? {
        let entry = entry?;
        if entry.path().join("Cargo.toml").is_file() {
            folders.push(format!("{parent}/{}", entry.file_name().to_string_lossy()));
        }
    }
    Ok(folders)
}

/// Reads one manifest; `shared` is the root's `[workspace.dependencies]`.
pub fn member(folder: String, manifest: &Table, shared: &Table) -> Member {
    let package = table(manifest, "package");
    let mut dependencies = Vec::new();
    let targets: BTreeMap<_, _> = table(manifest, "target").into_iter().collect();
    let sections = std::iter::once(manifest).chain(targets.values().filter_map(|target| target.as_table()));
    for section in sections {
        for kind in ["dependencies", "build-dependencies"] {
            dependencies.extend(packages(&table(section, kind), shared));
        }
    }
    dependencies.sort();
    dependencies.dedup();
    let mut features: Vec<String> = table(manifest, "features").keys().cloned().collect();
    features.retain(|feature| feature != "default");
    features.sort();
    let name = package.get("name").and_then(|name| name.as_str()).unwrap_or_default().to_owned();
    Member { folder, name, dependencies, features, package }
}

/// Package names behind the keys of a dependency table, renames resolved.
fn packages(dependencies: &Table, shared: &Table) -> Vec<String> {
    let renamed = |entry: &toml::Value| entry.get("package").and_then(|name| name.as_str()).map(str::to_owned);
    dependencies
        .iter()
        .map(|(key, entry)| renamed(entry).or_else(|| shared.get(key).and_then(renamed)).unwrap_or_else(|| key.clone()))
        .collect()
}

/// The sub-table of that name; empty if there is none.
pub fn table(parent: &Table, key: &str) -> Table {
    parent.get(key).and_then(|value| value.as_table()).cloned().unwrap_or_default()
}

/// The strings of an array; empty if there is none.
pub fn strings(value: Option<&toml::Value>) -> Vec<String> {
    let array = value.and_then(|value| value.as_array());
    array.into_iter().flatten().filter_map(|entry| entry.as_str()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_but_dev_dependencies_count() {
        let shared: Table = "alias = { package = \"real\", version = \"1\" }".parse().unwrap();
        let manifest: Table = r#"
            [package]
            name = "x"
            [features]
            default = ["a"]
            a = []
            [dependencies]
            plain = "1"
            alias.workspace = true
            maybe = { version = "1", optional = true }
            local = { package = "other", version = "1" }
            [build-dependencies]
            builder = "1"
            [target.'cfg(unix)'.dependencies]
            unixy = "1"
            [dev-dependencies]
            tester = "1"
        "#
        .parse()
        .unwrap();
        let member = member("crates/x".into(), &manifest, &shared);
        assert_eq!(member.dependencies, ["builder", "maybe", "other", "plain", "real", "unixy"]);
        assert_eq!(member.features, ["a"]);
        assert_eq!((member.name.as_str(), member.crate_name()), ("x", Some("x")));
    }
}
