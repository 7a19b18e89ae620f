//! The facade's feature sets: crates in the tree, and size of a program that uses all of the set.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::linked::Tree;
use super::{Bench, Bound, Check, Grid};
use crate::workspace::{Outcome, capture, write};

/// A choice of features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Set {
    /// What it is called.
    pub name: &'static str,
    /// Cargo features of the facade.
    pub features: &'static [&'static str],
}

/// All sets.
pub const SETS: &[Set] = &[
    Set { name: "none", features: &[] },
    Set { name: "scene", features: &["scene"] },
    Set { name: "scene+nts", features: &["scene", "nts"] },
    Set { name: "scene+mortar", features: &["scene", "mortar"] },
    Set { name: "scene+general", features: &["scene", "general"] },
    Set { name: "scene+multibody", features: &["scene", "multibody"] },
    Set { name: "mesh-files", features: &["mesh-files"] },
    Set { name: "decks", features: &["mesh-files", "decks"] },
    // `output` of the facade implies `scene`.
    Set { name: "output", features: &["scene", "output"] },
    Set {
        name: "all",
        features: &["scene", "nts", "mortar", "general", "multibody", "mesh-files", "decks", "output", "schema"],
    },
];

/// Crates that no model without scenes needs.
const NOT_IN_NONE: &[&str] = &["toml", "serde_json", "clap"];

/// What is known of a set.
#[derive(Clone, Debug, Default)]
struct Measured {
    /// Crates whose code may get into the program.
    linked: BTreeSet<String>,
    /// These, procedural macros and what only they use.
    compiled: BTreeSet<String>,
    /// Bytes of the stripped program; `None` in quick mode.
    size: Option<u64>,
}

/// Pairs of sets of which the second has all features of the first and more.
fn inclusions() -> impl Iterator<Item = (usize, usize)> {
    let within = |a: &Set, b: &Set| a != b && a.features.iter().all(|feature| b.features.contains(feature));
    (0..SETS.len()).flat_map(move |a| (0..SETS.len()).filter(move |&b| within(&SETS[a], &SETS[b])).map(move |b| (a, b)))
}

/// Checks, and the table of the sets.
pub fn measure(bench: &Bench) -> Outcome<(Vec<Check>, Grid)> {
    let mut measured = Vec::new();
    let programs = if bench.quick { None } else { Some(Programs::new(bench)?) };
    for set in SETS {
        let tree = Tree::of_facade(&bench.workspace, set.features)?;
        let owned = |names: BTreeSet<&str>| names.into_iter().map(str::to_owned).collect();
        let size = programs.as_ref().map(|programs| programs.size(set)).transpose()?;
        measured.push(Measured { linked: owned(tree.linked()), compiled: owned(tree.all()), size });
    }
    Ok((checks(&measured), grid(&measured)))
}

fn checks(measured: &[Measured]) -> Vec<Check> {
    let mut checks = Vec::new();
    let mut check = |set: &Set, quantity: String, value: f64, bound, note: String| {
        let row = format!("features {}", set.name);
        checks.push(Check::new(&row, quantity, value, bound).noted(note));
    };
    for (set, found) in SETS.iter().zip(measured) {
        let note = format!("{} with procedural macros", found.compiled.len());
        check(set, "crates linked".into(), found.linked.len() as f64, Bound::Unbounded, note);
        if let Some(size) = found.size {
            check(set, "stripped program, MB".into(), size as f64 / 1e6, Bound::Unbounded, String::new());
        }
        if set.features.is_empty() {
            let unwanted = named(&found.compiled, |name| NOT_IN_NONE.contains(&name));
            let quantity = format!("crates among {}", NOT_IN_NONE.join(", "));
            check(set, quantity, unwanted.len() as f64, Bound::AtMost(0.0), unwanted.join(", "));
        }
    }
    for (a, b) in inclusions() {
        let (small, large) = (&measured[a], &measured[b]);
        let extra = named(&small.compiled, |name| !large.compiled.contains(name));
        let quantity = format!("crates that {} does not have", SETS[b].name);
        check(&SETS[a], quantity, extra.len() as f64, Bound::AtMost(0.0), extra.join(", "));
        if let (Some(small), Some(large)) = (small.size, large.size) {
            let quantity = format!("size over that with {}", SETS[b].name);
            check(&SETS[a], quantity, small as f64 / large as f64, Bound::AtMost(1.0), String::new());
        }
    }
    checks
}

fn named(names: &BTreeSet<String>, keep: impl Fn(&str) -> bool) -> Vec<&str> {
    names.iter().map(String::as_str).filter(|name| keep(name)).collect()
}

fn grid(measured: &[Measured]) -> Grid {
    let none = measured.first().cloned().unwrap_or_default();
    let rows = SETS.iter().zip(measured).map(|(set, found)| {
        let more = named(&found.linked, |name| !none.linked.contains(name)).join(", ");
        let size = found.size.map_or("not measured".into(), |size| format!("{:.2} MB", size as f64 / 1e6));
        let (linked, compiled) = (found.linked.len().to_string(), found.compiled.len().to_string());
        vec![set.name.into(), linked, compiled, size, more]
    });
    Grid {
        caption: "Feature sets of the facade: crates in the dependency tree, and size of a stripped release program that uses \
                  all of the set (full mode only)"
            .into(),
        head: ["features", "crates linked", "crates compiled", "program", "linked beyond those of none"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    }
}

/// Builds the program of `program.rs` with one set after the other.
pub struct Programs<'a> {
    bench: &'a Bench,
    folder: PathBuf,
}

/// Name of the generated package.
const PACKAGE: &str = "stoss-lean";

impl<'a> Programs<'a> {
    /// Writes the package: a workspace of its own, with the lock file and the release profile of the repository.
    pub fn new(bench: &'a Bench) -> Outcome<Self> {
        let folder = bench.folder.join("lean").join("program");
        let root: toml::Table = bench.workspace.read("Cargo.toml")?.parse()?;
        let facade = bench.workspace.path("crates/stoss");
        write(&folder.join("Cargo.toml"), &toml::to_string(&manifest(&root, &facade.display().to_string())?)?)?;
        write(&folder.join("Cargo.lock"), &bench.workspace.read("Cargo.lock")?)?;
        write(&folder.join("src/main.rs"), include_str!("program.rs"))?;
        Ok(Self { bench, folder })
    }

    /// Bytes of the program with a set, after it has run.
    fn size(&self, set: &Set) -> Outcome<u64> {
        let target = self.folder.join("target");
        let mut command = self.bench.workspace.cargo();
        command.args(["build", "--release", "--quiet", "--offline", "--manifest-path"]);
        command.arg(self.folder.join("Cargo.toml")).env("CARGO_TARGET_DIR", &target);
        command.args(["--features", &set.features.join(",")]);
        println!("verify: building a program with the features {}", set.name);
        capture(&mut command)?;
        let program = target.join("release").join(format!("{PACKAGE}{}", std::env::consts::EXE_SUFFIX));
        // It must not only link, but work.
        capture(self.bench.workspace.process(&program).arg(self.folder.join("out")))?;
        Ok(std::fs::metadata(&program)?.len())
    }
}

/// Manifest of the generated package; every feature is that of the facade.
fn manifest(root: &toml::Table, facade: &str) -> Outcome<toml::Table> {
    let mut manifest: toml::Table = format!(
        "workspace = {{}}\n[package]\nname = \"{PACKAGE}\"\nversion = \"0.0.0\"\nedition = \"2024\"\npublish = false\n\
         [dependencies]\nstoss = {{ default-features = false }}\n"
    )
    .parse()?;
    let all = SETS.iter().flat_map(|set| set.features).collect::<BTreeSet<_>>();
    let features = all.iter().map(|feature| ((**feature).to_owned(), vec![format!("stoss/{feature}")].into()));
    manifest.insert("features".into(), toml::Table::from_iter(features).into());
    manifest["dependencies"]["stoss"]
        .as_table_mut()
        .ok_or("the dependency is no table")?
        .insert("path".into(), facade.into());
    let mut release = crate::manifest::table(&crate::manifest::table(root, "profile"), "release");
    release.insert("strip".into(), true.into());
    manifest.insert("profile".into(), toml::Table::from_iter([("release".to_owned(), release.into())]).into());
    Ok(manifest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(names: &[&str]) -> BTreeSet<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn every_set_is_within_all_and_around_none() {
        let pairs: Vec<(&str, &str)> = inclusions().map(|(a, b)| (SETS[a].name, SETS[b].name)).collect();
        for other in SETS {
            assert_eq!(pairs.contains(&("none", other.name)), other.name != "none");
            assert_eq!(pairs.contains(&(other.name, "all")), other.name != "all");
        }
        assert!(pairs.contains(&("scene", "output")) && pairs.contains(&("scene", "scene+nts")));
        assert!(!pairs.contains(&("scene+nts", "output")) && !pairs.contains(&("scene", "mesh-files")));
    }

    #[test]
    fn what_a_smaller_set_has_alone_falls_short() {
        let mut measured = vec![Measured { compiled: set(&["a", "toml"]), ..Measured::default() }; SETS.len()];
        measured[0].compiled.insert("b".into());
        let short: Vec<Check> = checks(&measured).into_iter().filter(|check| !check.holds()).collect();
        // Against each of the other sets, and `toml` in the first.
        assert_eq!(short.len(), SETS.len());
        assert!(short[1..].iter().all(|check| check.note == "b"));
        assert_eq!(short[0].note, "toml");
    }

    #[test]
    fn sizes_grow_with_the_features() {
        let mut measured = vec![Measured { size: Some(10), ..Measured::default() }; SETS.len()];
        assert!(checks(&measured).iter().all(Check::holds));
        measured[0].size = Some(11);
        assert_eq!(checks(&measured).iter().filter(|check| !check.holds()).count(), SETS.len() - 1);
    }

    #[test]
    fn the_manifest_stands_alone() {
        let root: toml::Table = "[profile.release]\nlto = \"thin\"\n".parse().unwrap();
        let manifest = manifest(&root, "/a \"b\"").unwrap();
        assert!(manifest["workspace"].as_table().unwrap().is_empty());
        assert_eq!(manifest["dependencies"]["stoss"]["path"].as_str(), Some("/a \"b\""));
        assert_eq!(manifest["dependencies"]["stoss"]["default-features"].as_bool(), Some(false));
        assert_eq!(manifest["features"]["output"][0].as_str(), Some("stoss/output"));
        let release = &manifest["profile"]["release"];
        assert_eq!((release["lto"].as_str(), release["strip"].as_bool()), (Some("thin"), Some(true)));
    }
}
