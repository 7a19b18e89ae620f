//! The methods of `[[contact]]` as rows: what a scene can say of each. What builds them is the facade's.

use crate::chosen::{Chosen, Rows, of_which};

/// A row of the table of contact methods.
#[derive(Debug)]
pub struct MethodEntry {
    /// Name in scenes.
    pub name: &'static str,
    /// What it is, in a sentence or two.
    pub about: &'static str,
    /// Keys of `[[contact]]` and of its friction that it has, of those that not every method has.
    pub keys: &'static [&'static str],
    /// Ways of `enforcement` that it has beside multipliers.
    pub enforcements: &'static [&'static str],
    /// Whether the slave may be a beam or string, which has nodes and no facets.
    pub takes_lines: bool,
    /// Whether it integrates over the faces as they are; otherwise it takes nodes and linear facets.
    pub integrates: bool,
    /// Whether velocities follow the law of impact where a scene does not say; gaps may be held then in the step in which they close.
    pub has_impact: bool,
}

impl MethodEntry {
    /// What is wrong with a key that it has not.
    pub(crate) fn lacks(&self, key: &str) -> String {
        let methods = of_which::<Self>(|method| method.has(key));
        format!("is for contact by {methods}, not by `{}`", self.name)
    }

    /// Whether it has a key that not every method has.
    pub fn has(&self, key: &str) -> bool {
        self.keys.contains(&key)
    }
}

/// Contact discretisation: a row of [`METHODS`].
///
/// # How to add one
/// A row of that table, and one of the table of what builds them in the facade (`build/methods.rs`).
pub type ContactMethod = Chosen<MethodEntry>;

/// Every method of `[[contact]]`.
pub const METHODS: &[MethodEntry] = &[
    MethodEntry {
        name: "nts",
        about: "Node to surface: each slave node against the facets of the master. The element follows from the scheme: with `energy-momentum` the energy-momentum element \
                (theory/node-to-surface#element), otherwise the direct one (theory/node-to-surface#residual).",
        keys: &["constraint", "surface_velocity", "surface_mass"],
        enforcements: &["penalty"],
        takes_lines: true,
        integrates: false,
        has_impact: true,
    },
    MethodEntry {
        name: "cat",
        about: "Node to surface by coordinate augmentation (theory/coordinate-augmentation): the convective coordinates of the projection are unknowns of each contact. For statics, backward Euler, \
                generalised-alpha and midpoint; with `energy-momentum` the solids conserve energy, and the contact follows the midpoint rule.",
        keys: &["constraint", "reduction"],
        enforcements: &[],
        takes_lines: false,
        integrates: false,
        has_impact: false,
    },
    MethodEntry {
        name: "mortar",
        about: "Mortar: weighted gaps and pressures on the overlap of the facets (theory/mortar#eq-gap), whose integrals move with the positions.",
        keys: &["surface_velocity", "surface_mass", "multipliers", "integrals", "slip"],
        enforcements: &["penalty"],
        takes_lines: false,
        integrates: true,
        has_impact: true,
    },
];

impl Rows for MethodEntry {
    const ROWS: &'static [Self] = METHODS;
    const TITLE: [&'static str; 2] = ["ContactMethod", "Contact discretisation."];

    fn name(&self) -> &'static str {
        self.name
    }

    fn about(&self) -> String {
        let mut about = self.about.to_owned();
        if !self.keys.is_empty() {
            let keys: Vec<String> = self.keys.iter().map(|key| format!("`{key}`")).collect();
            about += &format!(" Of the keys that not every method has it has {}.", keys.join(", "));
        }
        about
    }
}
