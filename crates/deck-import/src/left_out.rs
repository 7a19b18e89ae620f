//! The list of what a scene lacks of its deck.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use stoss_mesh_io::deck::{Deck, DeckPlace};

use crate::text::count;

/// Something of a deck that the scene does not have, or has in another form.
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

/// The last part of a path: readers know the folder of their deck.
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
            let what = match other.what.strip_prefix("elements ") {
                Some(kind) => format!("{} {kind}", count(other.count, "element", "elements")),
                None => format!("{} {}", other.count, other.what),
            };
            self.add(
                DeckPlace { file: number, line: other.line },
                what,
                "they are not in the scene: their stiffness and mass are missing",
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
                "requests of output are not used: results of every step have displacements, stresses and contact fields",
                "for values at nodes and points over time add [[probe]]",
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
    let counted = |(entry, more): (LeftOut, usize)| match more {
        0 => entry,
        1 => LeftOut { what: format!("{} (and 1 more line)", entry.what), ..entry },
        n => LeftOut { what: format!("{} (and {n} more lines)", entry.what), ..entry },
    };
    all.into_iter().map(counted).collect()
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
        return ("the values of its first line are used at all temperatures", "put the line of your temperature first");
    }
    if what.starts_with("parameter ") {
        return match keyword.as_str() {
            "SOLIDSECTION" => ("directions of the section are not used: materials are isotropic", ""),
            "STEP" | "STATIC" | "DYNAMIC" => ("it is ignored: Stoss has no such option for a step", ""),
            _ => (
                "it is ignored: the keyword is read as if it were not there",
                "check that the results do not depend on it",
            ),
        };
    }
    if what.starts_with("degree of freedom") {
        return (
            "it is ignored: nodes of solids have the components x, y and z only",
            "remove it; for rotations see [[joint]] and `moment` of [[load]]",
        );
    }
    if what.starts_with("load ") {
        return ("this load does not act", "see [[load]] for the kinds of loads of Stoss");
    }
    match keyword.as_str() {
        "PLASTIC" | "CYCLICHARDENING" | "DEFORMATIONPLASTICITY" | "DRUCKERPRAGER" => (
            "there is no plasticity: the body has the elastic part only, and stresses above the yield stress are wrong",
            "use the scene only where the deck stays elastic",
        ),
        "CREEP" | "VISCOELASTIC" => {
            ("there is no creep and no relaxation: the material is elastic", "use the scene only for short times")
        }
        "EXPANSION" | "TEMPERATURE" | "CONDUCTIVITY" | "SPECIFICHEAT" | "CFLUX" | "DFLUX" | "FILM" | "RADIATE"
        | "GAPCONDUCTANCE" | "PHYSICALCONSTANTS" | "GAPHEATGENERATION" => (
            "temperatures and thermal strains are not computed",
            "no change is needed if they do not matter for the mechanical results",
        ),
        "HEATTRANSFER"
        | "COUPLEDTEMPERATURE-DISPLACEMENT"
        | "UNCOUPLEDTEMPERATURE-DISPLACEMENT"
        | "DYNAMICTEMPERATURE-DISPLACEMENT" => (
            "the step is left out: temperatures are not computed",
            "make it *STATIC or *DYNAMIC for its mechanical part",
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
            "the step is left out: Stoss computes no modes and no linear perturbations",
            "make it *STATIC or *DYNAMIC for a computation over time",
        ),
        "VISCO" | "GEOSTATIC" | "CFD" | "ELECTROMAGNETICS" | "SENSITIVITY" | "NOANALYSIS" | "MASSDIFFUSION" => (
            "the step is left out: Stoss computes *STATIC and *DYNAMIC steps only",
            "make it *STATIC or *DYNAMIC for its mechanical part",
        ),
        "MODALDAMPING" | "SELECTCYCLICSYMMETRYMODES" => ("Stoss computes no modes", ""),
        "DAMPING" => (
            "it damps nothing: only *DAMPING, ALPHA=, BETA= of a material is imported",
            "give the body `damping = { mass = ALPHA, stiffness = BETA }`",
        ),
        "EQUATION" | "MPC" => (
            "its equations are left out: the nodes are not coupled",
            "use [[tie]], [[joint]] or [[prescribe]] in its place, or mesh the parts together",
        ),
        "COUPLING" | "KINEMATIC" | "DISTRIBUTING" | "DISTRIBUTINGCOUPLING" | "RIGIDBODY" => (
            "its nodes are not coupled to the reference node, and loads and supports of the reference node are left out",
            "see [[joint]], `moment` of [[load]], and `rotation` of [[prescribe]]",
        ),
        "TRANSFORM" => (
            "only rectangular and cylindrical axes of node sets are read: supports and forces in these axes are left out, except where all three components of a node are fixed",
            "write them into the scene, with `normal` of [[prescribe]]",
        ),
        "ORIENTATION" => ("its directions are not used: materials are isotropic", ""),
        "PRE-TENSIONSECTION" => {
            ("the bolt has no pretension", "cut the bolt, and use a [[joint]] of kind `slider` with `pretension`")
        }
        "SPRING" | "DASHPOT" | "GAP" | "MASS" => ("it is not in the scene", "see [[spring]], [[support]] and [[mass]]"),
        "SHELLSECTION" | "BEAMSECTION" | "BEAMGENERALSECTION" | "MEMBRANESECTION" | "MEMBRANE" | "FLUIDSECTION"
        | "NODALTHICKNESS" => ("its elements are not in the scene", "for beams see [[beam]]"),
        "CYCLICSYMMETRYMODEL" => ("the cut surfaces are free", "mesh the whole part, or prescribe planes of symmetry"),
        "MODELCHANGE" => ("nothing is added or removed between steps", "for contacts and loads see `off` of [[stage]]"),
        "CHANGEFRICTION" | "CHANGESURFACEBEHAVIOR" | "CHANGEMATERIAL" | "CHANGEPLASTIC" | "CHANGESOLIDSECTION" => {
            ("it changes nothing: properties stay as they are at the start", "")
        }
        "INITIALCONDITIONS" => {
            ("these initial conditions are left out", "check that the results do not depend on them")
        }
        "ELASTIC" => ("only isotropic elasticity is imported", "give isotropic constants"),
        "CONTROLS" => ("Stoss has step control and tolerances of its own", "see [solver] and `automatic` of [time]"),
        "CONTACTDAMPING" => ("contact has no damping", ""),
        "CLEARANCE" => ("gaps are those of the mesh", ""),
        "AMPLITUDE" => {
            ("loads and displacements with this amplitude are left out", "define it by a table of times and values")
        }
        "SUBMODEL" => ("displacements of the other model are not read", "prescribe them by [[prescribe]]"),
        "USERMATERIAL" | "DEPVAR" => {
            ("the law of the material is not known to Stoss", "see docs/how-to-add/material-law.md")
        }
        _ => ("it is left out: Stoss has nothing like it", "check that the results do not depend on it"),
    }
}

#[cfg(test)]
mod tests {
    use super::meaning;

    #[test]
    fn what_keywords_change() {
        // A step that is left out is called so, whatever it computes.
        for procedure in
            ["*VISCO", "*BUCKLE", "*HEAT TRANSFER", "*MASS DIFFUSION, TYPE=A", "*DYNAMIC TEMPERATURE-DISPLACEMENT"]
        {
            assert!(meaning(procedure).0.starts_with("the step is left out"), "{procedure}");
        }
        assert!(meaning("all lines of *ELASTIC but the first").0.contains("first line"));
        assert!(meaning("parameter ORIENTATION of *SOLID SECTION").0.contains("isotropic"));
        assert!(meaning("*AMPLITUDE, DEFINITION=SMOOTH STEP").0.contains("with this amplitude"));
        assert!(meaning("*UNHEARD OF").0.starts_with("it is left out"));
    }
}
