//! Crates that the facade links, by feature, against what they are for.

use std::collections::{BTreeMap, BTreeSet};

use crate::workspace::{Outcome, Workspace, capture};

/// Dependency trees are taken for one platform, so that they are the same on every machine.
const PLATFORM: &str = "x86_64-unknown-linux-gnu";

/// What a scene may need of the facade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ability {
    /// A model with a law of the user's own is simulated. The solver's model names the traits of contact methods and of parts, so
    /// that the traits' crates and what they stand on are always there.
    Simulate,
    /// Scenes are read and built.
    Scenes,
    /// Node-to-surface contact.
    NodeToSurface,
    /// Mortar integrals and mesh ties.
    Mortar,
    /// General contact.
    GeneralContact,
    /// Rigid bodies, beams, joints; their crate is there with scenes anyway, which check their values by it.
    Multibody,
    /// Meshes come from files.
    MeshFiles,
    /// Scenes are made from decks of other programs.
    Decks,
    /// Folders of results are written and read.
    Results,
    /// Checkpoints are written and read.
    Checkpoints,
    /// The scene format is printed as a JSON schema.
    Schema,
    /// Command line, progress, pictures of errors.
    Program,
}

use Ability::{
    Checkpoints, Decks, GeneralContact, MeshFiles, Mortar, Multibody, NodeToSurface, Program, Results, Scenes, Schema,
    Simulate,
};

/// Crates with the abilities that they are for: all of ours, and of the others those that are for some abilities only.
/// A crate of ours that is not listed is for nothing.
const CRATES: &[(&str, &[Ability])] = &[
    ("stoss", &[Simulate]),
    ("stoss-registry", &[Simulate]),
    ("stoss-tensor", &[Simulate]),
    ("stoss-continuum", &[Simulate]),
    ("stoss-reference-element", &[Simulate]),
    ("stoss-mesh", &[Simulate]),
    ("stoss-linalg", &[Simulate]),
    ("stoss-newton", &[Simulate]),
    ("stoss-fe-solid", &[Simulate]),
    ("stoss-integrators", &[Simulate]),
    ("stoss-solver", &[Simulate]),
    ("stoss-contact", &[Simulate]),
    ("stoss-term", &[Simulate]),
    ("stoss-geometry", &[Simulate]),
    ("faer", &[Simulate]),
    ("stoss-scene", &[Scenes]),
    ("stoss-materials", &[Scenes]),
    ("stoss-multibody", &[Scenes, Multibody]),
    ("toml", &[Scenes]),
    ("stoss-contact-nts", &[NodeToSurface]),
    ("stoss-contact-barrier", &[GeneralContact]),
    ("stoss-contact-mortar", &[Mortar]),
    ("stoss-segmentation", &[Mortar]),
    ("stoss-mesh-io", &[MeshFiles, Results]),
    ("stoss-deck-import", &[Decks]),
    ("sha2", &[Results]),
    ("serde_json", &[Results, Schema]),
    ("postcard", &[Checkpoints]),
    ("tempfile", &[Checkpoints]),
    ("schemars", &[Schema]),
    ("clap", &[Program]),
    ("indicatif", &[Program]),
];

/// What a choice of the facade's features is for.
pub fn abilities(features: &[&str]) -> Vec<Ability> {
    let of = |feature: &str| -> &[Ability] {
        match feature {
            "scene" => &[Scenes],
            "nts" => &[NodeToSurface],
            "mortar" => &[Mortar],
            "general" => &[GeneralContact],
            "multibody" => &[Multibody],
            "mesh-files" => &[MeshFiles],
            "decks" => &[MeshFiles, Decks],
            "schema" => &[Scenes, Schema],
            "output" => &[Scenes, Results, Checkpoints],
            _ => &[],
        }
    };
    std::iter::once(Simulate).chain(features.iter().flat_map(|feature| of(feature).iter().copied())).collect()
}

/// Which crate uses which; nodes are names with versions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tree {
    root: String,
    uses: BTreeMap<String, BTreeSet<String>>,
    /// Procedural macros: they, and what they use, run in the compiler.
    macros: BTreeSet<String>,
}

impl Tree {
    /// The facade with these features.
    pub fn of_facade(workspace: &Workspace, features: &[&str]) -> Outcome<Self> {
        let tree = |offline: &[&str]| {
            let mut command = workspace.cargo();
            command.args(["tree", "--package", "stoss", "--no-default-features", "--features"]).arg(features.join(","));
            command.args(["--edges", "normal", "--prefix", "depth", "--target", PLATFORM]).args(offline);
            capture(&mut command)
        };
        // From a fresh checkout some crates may not be on the disk yet.
        let text = tree(&["--offline"]).or_else(|_| tree(&[]))?;
        Ok(Self::parse(&text)?)
    }

    /// Reads `cargo tree --prefix depth`. What is below a crate is printed where the crate appears first.
    fn parse(text: &str) -> Result<Self, String> {
        let mut tree = Self::default();
        let mut path: Vec<String> = Vec::new();
        for line in text.lines().filter(|line| !line.is_empty()) {
            let strange = || format!("cargo tree printed {line:?}");
            let digits = line.find(|symbol: char| !symbol.is_ascii_digit()).ok_or_else(strange)?;
            let depth: usize = line[..digits].parse().map_err(|_| strange())?;
            let mut words = line[digits..].split_whitespace();
            let (Some(name), Some(version)) = (words.next(), words.next()) else { return Err(strange()) };
            let node = format!("{name} {version}");
            if depth > path.len() {
                return Err(strange());
            }
            path.truncate(depth);
            match path.last() {
                Some(user) => {
                    tree.uses.entry(user.clone()).or_default().insert(node.clone());
                }
                None => tree.root.clone_from(&node),
            }
            tree.uses.entry(node.clone()).or_default();
            if words.any(|word| word == "(proc-macro)") {
                tree.macros.insert(node.clone());
            }
            path.push(node);
        }
        Ok(tree)
    }

    /// Names of all crates.
    pub fn all(&self) -> BTreeSet<&str> {
        self.uses.keys().map(|node| name(node)).collect()
    }

    /// Names of the crates whose code may get into a program: without procedural macros and what only they use.
    pub fn linked(&self) -> BTreeSet<&str> {
        self.reached(|_| false).into_iter().map(name).collect()
    }

    /// Linked nodes that can be reached from the root without those whose name is `left_out`.
    fn reached(&self, left_out: impl Fn(&str) -> bool) -> BTreeSet<&str> {
        let mut found = BTreeSet::new();
        let mut open = vec![self.root.as_str()];
        while let Some(node) = open.pop() {
            if !self.macros.contains(node) && !left_out(name(node)) && found.insert(node) {
                open.extend(self.uses.get(node).into_iter().flatten().map(String::as_str));
            }
        }
        found
    }

    /// Crates that nobody asked for, and crates below them that nothing else needs; then crates that were asked for and
    /// are not there.
    pub fn against(&self, asked: &[Ability]) -> Deviations<'_> {
        let is_for = |name: &str| CRATES.iter().find(|(known, _)| *known == name).map(|(_, abilities)| *abilities);
        let wanted = |abilities: &[Ability]| abilities.iter().any(|ability| asked.contains(ability));
        let unasked = |name: &str| match is_for(name) {
            Some(abilities) => !wanted(abilities),
            None => name.starts_with("stoss"),
        };
        let names = self.linked();
        let needed: BTreeSet<&str> = self.reached(unasked).into_iter().map(name).collect();
        let (roots, below): (Vec<&str>, Vec<&str>) =
            names.iter().filter(|name| !needed.contains(*name)).partition(|name| unasked(name));
        let missing = CRATES.iter().filter(|(name, _)| !names.contains(name));
        let missing = missing.filter(|(_, abilities)| wanted(abilities)).map(|(name, _)| *name).collect();
        Deviations { unused: roots, below, missing }
    }
}

/// How what is linked differs from what was asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deviations<'a> {
    /// Crates for abilities that nobody asked for.
    pub unused: Vec<&'a str>,
    /// Crates that only those need.
    pub below: Vec<&'a str>,
    /// Crates that were asked for and are not there.
    pub missing: Vec<&'a str>,
}

impl Deviations<'_> {
    /// Number of crates.
    pub fn count(&self) -> usize {
        self.unused.len() + self.below.len() + self.missing.len()
    }

    /// In words; empty if there are none.
    pub fn words(&self) -> String {
        let part = |title: &str, names: &[&str]| match names {
            [] => None,
            names => Some(format!("{title}: {}", names.join(", "))),
        };
        let parts = [part("unused", &self.unused), part("only for these", &self.below), part("missing", &self.missing)];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}

fn name(node: &str) -> &str {
    node.split_once(' ').map_or(node, |(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `stoss` uses the solver, which uses `postcard`, which alone uses `cobs`; `serde` is used by both.
    const TREE: &str = "0stoss v0.1.0 (/x)\n1stoss-solver v0.1.0 (/x)\n2postcard v1.1.0\n3cobs v0.3.0\n3serde v1.0.0\n\
                        2serde v1.0.0\n1stoss-scene v0.1.0 (/x)\n2toml v1.2.0\n3serde v1.0.0\n\
                        4serde_derive v1.0.0 (proc-macro)\n5syn v2.0.0\n1stoss-strange v0.1.0\n";

    #[test]
    fn a_tree_is_read_by_depth() {
        let tree = Tree::parse(TREE).unwrap();
        assert_eq!(tree.root, "stoss v0.1.0");
        assert_eq!(tree.all().len(), 10);
        // Without `serde_derive` and what it uses.
        assert_eq!(tree.linked().len(), 8);
        let users = |node: &str| tree.uses.values().filter(|used| used.contains(node)).count();
        assert_eq!((users("serde v1.0.0"), users("cobs v0.3.0")), (3, 1));
        assert!(Tree::parse("0a v1\n2b v1\n").is_err());
        assert!(Tree::parse("a v1\n").is_err());
    }

    #[test]
    fn what_only_an_unasked_crate_needs_is_unused_too() {
        let tree = Tree::parse(TREE).unwrap();
        let found = tree.against(&[Scenes]);
        // `stoss` itself is for simulations, which were not asked for: nothing is reached.
        assert_eq!(found.count() - found.missing.len(), 8);
        let found = tree.against(&[Simulate, Scenes]);
        assert_eq!(found.unused, ["postcard", "stoss-strange"]);
        assert_eq!(found.below, ["cobs"]);
        assert!(found.missing.contains(&"stoss-materials") && !found.missing.contains(&"toml"));
        let found = tree.against(&[Simulate, Scenes, Checkpoints]);
        assert_eq!((found.unused, found.below), (vec!["stoss-strange"], vec![]));
        assert!(found.missing.contains(&"tempfile"));
    }

    #[test]
    fn features_are_for_abilities_that_have_crates() {
        let all = abilities(&["scene", "nts", "mortar", "mesh-files", "output"]);
        for ability in &all {
            assert!(CRATES.iter().any(|(_, abilities)| abilities.contains(ability)), "{ability:?}");
        }
        assert!(!all.contains(&Schema) && !all.contains(&Program));
        assert_eq!(abilities(&["nonsense"]), [Simulate]);
    }
}
