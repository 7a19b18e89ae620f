//! The list of what a scene lacks of its deck.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use stoss_mesh_io::deck::{Deck, DeckPlace};

/// Something of a deck that the scene does not have, or has in another way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// "part.inp:12"; the file alone where it concerns no line.
    pub place: String,
    /// As "*PLASTIC".
    pub what: String,
    /// What that changes.
    pub consequence: String,
    /// What to do; empty if there is nothing to do.
    pub remedy: String,
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.place, self.what, self.consequence)?;
        if self.remedy.is_empty() { Ok(()) } else { write!(f, "; {}", self.remedy) }
    }
}

/// Entries with their places, as they are found.
pub(crate) struct List {
    entries: Vec<(Option<DeckPlace>, LeftOut)>,
    file: String,
    /// Names of the files by their numbers.
    files: Vec<String>,
}

/// The last part of a path: the folder of a deck is no news.
fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

impl List {
    pub fn new(deck: &Deck) -> Self {
        let files: Vec<String> = deck.files().iter().map(|path| file_name(path)).collect();
        Self { entries: Vec::new(), file: file_name(deck.contents.path()), files }
    }

    /// "part.inp:12".
    pub fn place(&self, place: DeckPlace) -> String {
        format!("{}:{}", self.files.get(place.file).unwrap_or(&self.file), place.line)
    }

    /// Adds an entry.
    pub fn add(
        &mut self,
        place: DeckPlace,
        what: impl Into<String>,
        consequence: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let (what, consequence, remedy) = (what.into(), consequence.into(), remedy.into());
        let entry = LeftOut { place: self.place(place), what, consequence, remedy };
        if !self.entries.iter().any(|(_, other)| *other == entry) {
            self.entries.push((Some(place), entry));
        }
    }

    /// Adds an entry that concerns no line.
    pub fn add_general(&mut self, what: impl Into<String>, consequence: impl Into<String>, remedy: impl Into<String>) {
        let entry = LeftOut {
            place: self.file.clone(),
            what: what.into(),
            consequence: consequence.into(),
            remedy: remedy.into(),
        };
        self.entries.push((None, entry));
    }

    /// All entries with those of the reader, in the order of the deck.
    pub fn finish(mut self, deck: &Deck) -> Vec<LeftOut> {
        for other in deck.contents.other_elements() {
            let file = file_name(&other.path);
            let number = self.files.iter().position(|name| *name == file).unwrap_or(0);
            let what = format!("{} {}", other.count, other.what);
            self.add(
                DeckPlace { file: number, line: other.line },
                what,
                "they are not in the scene, with their stiffness and their mass",
                other.remedy,
            );
        }
        for note in deck.contents.notes().iter().filter(|note| !note.contains(" is read as ")) {
            self.add_general("mesh", note.clone(), "");
        }
        let mut output: Vec<&str> = Vec::new();
        for left in &deck.left_out {
            if !left.changes_results {
                output.push(&left.what);
                continue;
            }
            let (consequence, remedy) = meaning(&left.what);
            self.add(left.place, left.what.clone(), consequence, remedy);
        }
        output.sort_unstable();
        output.dedup();
        if !output.is_empty() {
            self.add_general(
                output.join(", "),
                "requests of output; every step has a frame with displacements, stresses and contact fields",
                "for values of nodes and points add [[probe]]",
            );
        }
        self.entries.sort_by_key(|(place, _)| *place);
        once(self.entries.into_iter().map(|(_, entry)| entry))
    }
}

/// Entries that say the same of many lines once, with their number.
fn once(entries: impl Iterator<Item = LeftOut>) -> Vec<LeftOut> {
    let mut all: Vec<(LeftOut, usize)> = Vec::new();
    let mut known = BTreeMap::new();
    for entry in entries {
        let text = (entry.what.clone(), entry.consequence.clone(), entry.remedy.clone());
        let index = *known.entry(text).or_insert(all.len());
        match all.get_mut(index) {
            Some((_, more)) => *more += 1,
            None => all.push((entry, 0)),
        }
    }
    let told = |(entry, more): (LeftOut, usize)| match more {
        0 => entry,
        1 => LeftOut { what: format!("{} (and 1 more line)", entry.what), ..entry },
        n => LeftOut { what: format!("{} (and {n} more lines)", entry.what), ..entry },
    };
    all.into_iter().map(told).collect()
}

/// What it changes that a keyword is left out, and what to do.
fn meaning(what: &str) -> (&'static str, &'static str) {
    let name = what.trim_start_matches("parameter ").trim_start_matches("all lines of ");
    let keyword: String = name
        .split_once('*')
        .map_or(name, |(_, keyword)| keyword)
        .chars()
        .take_while(|c| *c != ',')
        .filter(|c| !c.is_whitespace())
        .collect();
    if what.starts_with("all lines of") {
        return ("the values of the first line hold at all temperatures", "put the line of your temperature first");
    }
    if what.starts_with("parameter ") {
        return match keyword.as_str() {
            "SOLIDSECTION" => ("directions of the section are not used: materials are isotropic", ""),
            "STEP" | "STATIC" | "DYNAMIC" => ("it has no counterpart; the step is as without it", ""),
            _ => ("the keyword is read as without it", "check what it stood for"),
        };
    }
    if what.starts_with("degree of freedom") {
        return (
            "nodes of solids have the components x, y and z only",
            "remove it, or see `[[joint]]` and `moment` of `[[load]]` for rotations",
        );
    }
    if what.starts_with("load ") {
        return ("this load does not act", "see [[load]] for the kinds that there are");
    }
    match keyword.as_str() {
        "PLASTIC" | "CYCLICHARDENING" | "DEFORMATIONPLASTICITY" | "DRUCKERPRAGER" => (
            "there is no plasticity: the body has the elastic part only, and stresses above the yield stress are wrong",
            "use the scene where the deck stays elastic",
        ),
        "CREEP" | "VISCO" | "VISCOELASTIC" => {
            ("nothing creeps or relaxes: materials are elastic", "use the scene for short times")
        }
        "EXPANSION" | "TEMPERATURE" | "CONDUCTIVITY" | "SPECIFICHEAT" | "CFLUX" | "DFLUX" | "FILM" | "RADIATE"
        | "GAPCONDUCTANCE" | "PHYSICALCONSTANTS" | "GAPHEATGENERATION" => {
            ("there are no temperatures, and no strains from them", "leave it, if the mechanical part is what you want")
        }
        "HEATTRANSFER" | "COUPLEDTEMPERATURE-DISPLACEMENT" | "UNCOUPLEDTEMPERATURE-DISPLACEMENT" => (
            "the step is left out: there are no temperatures",
            "give the step *STATIC if the mechanical part is what you want",
        ),
        "FREQUENCY"
        | "COMPLEXFREQUENCY"
        | "BUCKLE"
        | "MODALDYNAMIC"
        | "STEADYSTATEDYNAMICS"
        | "RANDOMRESPONSE"
        | "RESPONSESPECTRUM"
        | "SUBSTRUCTUREGENERATE"
        | "GREEN" => (
            "the step is left out: there are no modes and no linear perturbations",
            "give the step *STATIC or *DYNAMIC if a run over time is what you want",
        ),
        "MODALDAMPING" | "SELECTCYCLICSYMMETRYMODES" => ("there are no modes", ""),
        "DAMPING" => (
            "only *DAMPING, ALPHA=, BETA= of a material maps: nothing is damped by this",
            "give the body `damping = { mass = ALPHA, stiffness = BETA }`",
        ),
        "EQUATION" | "MPC" => (
            "the nodes move on their own: what the equations hold is free",
            "replace it by [[tie]], [[joint]] or [[prescribe]], or mesh the parts together",
        ),
        "COUPLING" | "KINEMATIC" | "DISTRIBUTING" | "DISTRIBUTINGCOUPLING" | "RIGIDBODY" => (
            "the nodes move on their own, and what acts on the reference node is lost",
            "see [[joint]], `moment` of [[load]], and `rotation` of [[prescribe]]",
        ),
        "TRANSFORM" => (
            "only rectangular and cylindrical axes of node sets map: supports and forces in these axes are left out, but for nodes of which all three components are fixed",
            "write them by hand, with `normal` of [[prescribe]]",
        ),
        "ORIENTATION" => ("materials are isotropic: directions are not used", ""),
        "PRE-TENSIONSECTION" => {
            ("the bolt has no pretension", "cut the bolt, and use a [[joint]] of kind `slider` with `pretension`")
        }
        "SPRING" | "DASHPOT" | "GAP" | "MASS" => ("it is not in the scene", "see [[spring]], [[support]] and [[mass]]"),
        "SHELLSECTION" | "BEAMSECTION" | "BEAMGENERALSECTION" | "MEMBRANESECTION" | "MEMBRANE" | "FLUIDSECTION"
        | "NODALTHICKNESS" => ("its elements are not in the scene", "see [[beam]] for beams"),
        "CYCLICSYMMETRYMODEL" => {
            ("the cut surfaces are free", "mesh the whole part, or prescribe the planes of symmetry")
        }
        "MODELCHANGE" => ("nothing is added or removed between steps", "see `off` of [[stage]] for contacts and loads"),
        "CHANGEFRICTION" | "CHANGESURFACEBEHAVIOR" | "CHANGEMATERIAL" | "CHANGEPLASTIC" | "CHANGESOLIDSECTION" => {
            ("it stays as it is at the start", "")
        }
        "INITIALCONDITIONS" => ("the bodies begin without it", ""),
        "ELASTIC" => ("only isotropic elasticity maps", "give isotropic constants"),
        "CONTROLS" => ("Stoss controls its steps by itself", "see [solver] and `automatic` of [time]"),
        "CONTACTDAMPING" => ("contact has no damping", ""),
        "CLEARANCE" => ("gaps are those of the mesh", ""),
        "AMPLITUDE" => ("what uses it is left out, too", "write a table of times and values"),
        "SUBMODEL" => ("displacements of another model are not read", "prescribe them with [[prescribe]]"),
        "USERMATERIAL" | "DEPVAR" => ("the material is unknown here", "see docs/how-to-add/material-law.md"),
        _ => ("it has no counterpart here", "check whether the scene does without it"),
    }
}
