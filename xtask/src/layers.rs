//! `cargo xtask layers`: every crate's normal dependencies against `layers.toml`, no circles inside a crate, and the picture of them.

mod picture;

use std::collections::{BTreeMap, BTreeSet};

use toml::Table;

use crate::circles;
use crate::manifest::{self, Member};
use crate::workspace::{Outcome, Workspace, read, write};

/// Where the picture is committed.
const PAGE: &str = "docs/layers.md";

/// Dependencies that are allowed for one crate.
#[derive(Clone, Debug, Default)]
struct Layer {
    ours: BTreeSet<String>,
    external: BTreeSet<String>,
    dev_only: bool,
}

/// `layers.toml`.
#[derive(Clone, Debug, Default)]
struct Layers {
    crates: BTreeMap<String, Layer>,
    /// Crates of ours that a member outside of the stack may link.
    tools: BTreeMap<String, BTreeSet<String>>,
}

/// Findings of the check; notes do not fail it.
#[derive(Debug, Default, PartialEq)]
struct Findings {
    errors: Vec<String>,
    notes: Vec<String>,
}

/// Runs the check; false if an arrow is not allowed, or if the picture is not up to date and not to be written.
pub fn command(workspace: &Workspace, bless: bool) -> Outcome<bool> {
    let layers = parse(&workspace.read("layers.toml")?)?;
    let members = manifest::members(workspace)?;
    let mut findings = check(&layers, &members);
    for member in &members {
        let source = sources(workspace, &member.folder)?;
        let unused = member.dependencies.iter().filter(|dependency| !is_named(&source, dependency));
        findings.errors.extend(unused.map(|name| format!("{} depends on {name}, but never names it", member.folder)));
        findings.errors.extend(circles::check(workspace, member)?);
    }
    let page = picture::page(&members);
    if bless {
        write(&workspace.path(PAGE), &page)?;
    } else if read(&workspace.path(PAGE)).ok().as_deref() != Some(page.as_str()) {
        findings.errors.push(format!("{PAGE} is not up to date; run `cargo xtask layers --bless`"));
    }
    for note in &findings.notes {
        println!("layers: note: {note}");
    }
    for error in &findings.errors {
        println!("layers: error: {error}");
    }
    println!("layers: {} crates, {} errors, {} notes", members.len(), findings.errors.len(), findings.notes.len());
    Ok(findings.errors.is_empty())
}

fn parse(text: &str) -> Outcome<Layers> {
    let table: Table = text.parse().map_err(|error| format!("layers.toml: {error}"))?;
    let mut layers = Layers::default();
    for (section, known) in [("crate", ["ours", "external", "dev-only"].as_slice()), ("tool", &["ours"])] {
        for (name, entry) in manifest::table(&table, section) {
            let Some(entry) = entry.as_table() else { return Err(format!("layers.toml: {name} is no table").into()) };
            if let Some(key) = entry.keys().find(|key| !known.contains(&key.as_str())) {
                return Err(format!("layers.toml: unknown key {key} of {name}").into());
            }
            let set = |key: &str| manifest::strings(entry.get(key)).into_iter().collect();
            if section == "tool" {
                layers.tools.insert(name, set("ours"));
                continue;
            }
            let dev_only = entry.get("dev-only").and_then(|flag| flag.as_bool()).unwrap_or(false);
            layers.crates.insert(name, Layer { ours: set("ours"), external: set("external"), dev_only });
        }
    }
    Ok(layers)
}

fn check(layers: &Layers, members: &[Member]) -> Findings {
    let Layers { crates: layers, tools } = layers;
    let mut findings = Findings::default();
    let ours: BTreeMap<&str, &Member> = members.iter().map(|member| (member.name.as_str(), member)).collect();
    let crates: BTreeMap<&str, &Member> =
        members.iter().filter_map(|member| Some((member.crate_name()?, member))).collect();
    for name in layers.keys().filter(|name| !crates.contains_key(name.as_str())) {
        findings.errors.push(format!("layers.toml lists {name}, but there is no crates/{name}"));
    }
    for member in members {
        let Some(name) = member.crate_name() else {
            check_tool(&mut findings, member, tools.get(&member.folder), &ours);
            continue;
        };
        let package = expected_package(name);
        if member.name != package {
            findings.errors.push(format!("{}: package is named {}, not {package}", member.folder, member.name));
        }
        let Some(layer) = layers.get(name) else {
            findings.errors.push(format!("crates/{name} has no entry in layers.toml"));
            continue;
        };
        let mut used = BTreeSet::new();
        for dependency in &member.dependencies {
            let target = ours.get(dependency.as_str()).map(|member| member.crate_name().unwrap_or(&member.folder));
            let (kind, allowed, word) = match target {
                Some(target) => ("ours", &layer.ours, target),
                None => ("external", &layer.external, dependency.as_str()),
            };
            used.insert((kind, word));
            if !allowed.contains(word) {
                findings.errors.push(format!("{name} -> {word} is not among its `{kind}` in layers.toml"));
            }
            if layers.get(word).is_some_and(|other| other.dev_only) && kind == "ours" && !layer.dev_only {
                findings.errors.push(format!("{name} -> {word}: {word} may only be a dev-dependency"));
            }
        }
        for (kind, allowed) in [("ours", &layer.ours), ("external", &layer.external)] {
            let unused = allowed.iter().filter(|word| !used.contains(&(kind, word.as_str())));
            findings.notes.extend(unused.map(|word| format!("{name} -> {word} is listed but not used")));
        }
    }
    findings
}

/// A member outside of the stack links of ours what is listed for it, crates for tests too, and nothing if it is not.
fn check_tool(
    findings: &mut Findings,
    member: &Member,
    allowed: Option<&BTreeSet<String>>,
    ours: &BTreeMap<&str, &Member>,
) {
    let linked = member.dependencies.iter().filter_map(|dependency| ours.get(dependency.as_str()));
    let linked: BTreeSet<&str> = linked.map(|other| other.crate_name().unwrap_or(&other.folder)).collect();
    let (folder, none) = (&member.folder, BTreeSet::new());
    let allowed = allowed.unwrap_or(&none);
    for name in &linked {
        if !allowed.contains(*name) {
            findings.errors.push(format!("{folder} -> {name} is not among its `ours` in layers.toml"));
        }
    }
    let unused = allowed.iter().filter(|name| !linked.contains(name.as_str()));
    findings.notes.extend(unused.map(|name| format!("{folder} -> {name} is listed but not used")));
}

/// All sources of a member in one text; tests, benches and examples do not count.
fn sources(workspace: &Workspace, folder: &str) -> Outcome<String> {
    // Build dependencies are named by the build script.
    let (src, script) = (format!("{folder}/src"), format!("{folder}/build.rs"));
    let files = workspace.files()?.into_iter().filter(|file| file.starts_with(&src) || file.starts_with(&script));
    let sources = files.filter(|file| file.extension().is_some_and(|kind| kind == "rs"));
    sources.map(|file| workspace.read(file)).collect()
}

/// True if a source names a package as a path or in an attribute.
fn is_named(source: &str, package: &str) -> bool {
    let word = package.replace('-', "_");
    let part_of_name = |symbol: char| symbol.is_alphanumeric() || symbol == '_';
    source.lines().filter(|line| !line.trim_start().starts_with("//")).any(|line| {
        line.match_indices(&word)
            .any(|(at, _)| !line[..at].ends_with(part_of_name) && !line[at + word.len()..].starts_with(part_of_name))
    })
}

/// Package name of a folder under `crates/`.
pub fn expected_package(folder: &str) -> String {
    if folder == "stoss" { folder.to_owned() } else { format!("stoss-{folder}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYERS: &str = r#"
        [crate.tensor]
        ours = []
        external = ["nalgebra"]
        [crate.continuum]
        ours = ["tensor"]
        external = ["thiserror"]
        [crate.testkit]
        dev-only = true
        ours = ["tensor"]
        external = []
        [tool.xtask]
        ours = ["continuum"]
    "#;

    fn member(folder: &str, name: &str, dependencies: &[&str]) -> Member {
        Member {
            folder: folder.into(),
            name: name.into(),
            dependencies: dependencies.iter().map(|name| (*name).to_owned()).collect(),
            features: Vec::new(),
            package: Table::new(),
        }
    }

    fn stack() -> Vec<Member> {
        vec![
            member("crates/continuum", "stoss-continuum", &["stoss-tensor", "thiserror"]),
            member("crates/tensor", "stoss-tensor", &["nalgebra"]),
            member("crates/testkit", "stoss-testkit", &["stoss-tensor"]),
            member("xtask", "xtask", &["toml", "stoss-continuum"]),
            member("tests", "tests", &[]),
        ]
    }

    fn errors(members: &[Member]) -> Vec<String> {
        check(&parse(LAYERS).unwrap(), members).errors
    }

    #[test]
    fn the_allowed_stack_passes() {
        assert_eq!(check(&parse(LAYERS).unwrap(), &stack()), Findings::default());
    }

    #[test]
    fn forbidden_arrows_are_found() {
        let mut members = stack();
        members[1].dependencies.push("stoss-continuum".into());
        members[1].dependencies.push("serde".into());
        assert_eq!(
            errors(&members),
            [
                "tensor -> continuum is not among its `ours` in layers.toml",
                "tensor -> serde is not among its `external` in layers.toml"
            ]
        );
    }

    #[test]
    fn dev_only_crates_are_never_linked() {
        let mut members = stack();
        members[0].dependencies.push("stoss-testkit".into());
        assert!(errors(&members).iter().any(|error| error.contains("may only be a dev-dependency")));
        let mut members = stack();
        members[3].dependencies.push("stoss-tensor".into());
        assert_eq!(errors(&members), ["xtask -> tensor is not among its `ours` in layers.toml"]);
    }

    #[test]
    fn tools_link_what_is_listed_for_them() {
        let mut members = stack();
        members[4].dependencies.push("stoss-continuum".into());
        assert_eq!(errors(&members), ["tests -> continuum is not among its `ours` in layers.toml"]);
        let mut members = stack();
        members[3].dependencies.pop();
        let notes = check(&parse(LAYERS).unwrap(), &members).notes;
        assert_eq!(notes, ["xtask -> continuum is listed but not used"]);
        let with_testkit = LAYERS.replace("ours = [\"continuum\"]", "ours = [\"continuum\", \"testkit\"]");
        let mut members = stack();
        members[3].dependencies.push("stoss-testkit".into());
        assert_eq!(check(&parse(&with_testkit).unwrap(), &members), Findings::default());
        assert!(parse("[tool.xtask]\nexternal = []").is_err());
    }

    #[test]
    fn missing_entries_wrong_names_and_ghosts_are_found() {
        let mut members = stack();
        members.push(member("crates/new", "new", &[]));
        members.remove(1);
        let errors = errors(&members);
        for expected in ["lists tensor", "named new, not stoss-new", "crates/new has no entry"] {
            assert!(errors.iter().any(|error| error.contains(expected)), "{expected}: {errors:?}");
        }
    }

    #[test]
    fn unused_arrows_are_notes() {
        let mut members = stack();
        members[0].dependencies.retain(|name| name != "thiserror");
        let findings = check(&parse(LAYERS).unwrap(), &members);
        assert_eq!(findings.notes, ["continuum -> thiserror is listed but not used"]);
        assert!(findings.errors.is_empty());
    }

    #[test]
    fn a_dependency_must_be_named_in_code() {
        assert!(is_named("use a_b::c;", "a-b") && is_named("    #[derive(a_b::C)]", "a-b"));
        assert!(!is_named("// a_b\nuse a_bc::d; use xa_b::e;", "a-b"));
    }

    #[test]
    fn unknown_keys_of_the_table_are_refused() {
        assert!(parse("[crate.a]\nour = []").is_err());
    }
}
