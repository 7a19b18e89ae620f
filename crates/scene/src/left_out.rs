//! `[[left_out]]`: what a deck has, and the scene that was made from it has not.

use crate::names::named;
use stoss_scene_derive::table;

named! {
    /// What it means for the results that the scene does not have something of its deck.
    Omission {
        /// A load, a support, a constraint, a contact or a part is missing: the verdict of a run is at best `doubtful`.
        Missing = "missing",
        /// A law, an element or a setting of the solution is not that of the deck.
        Changed = "changed",
        /// The results of the deck and of the scene do not differ by it, as far as the import can say.
        Note = "note",
    }
}

/// `[[left_out]]`: something that a deck has and the scene has not, written by `stoss import`. `stoss check` and `stoss run` repeat it. Remove an entry when the scene has what it names.
#[table]
pub struct LeftOut {
    /// Consequence for the results: `missing`, `changed` or `note`.
    #[key(example = "\"missing\"")]
    pub severity: Omission,
    /// Keyword of the deck, for instance `*COUPLING`.
    #[key(example = "\"*COUPLING\"")]
    pub keyword: String,
    /// File and line of the deck, for instance `part.inp:12`.
    pub line: Option<String>,
    /// What it changes, and what to do.
    #[key(example = "\"its nodes are not coupled\"")]
    pub text: String,
}

impl std::fmt::Display for LeftOut {
    /// In a line: keyword, place and text.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.keyword)?;
        if let Some(line) = &self.line {
            write!(f, " ({line})")?;
        }
        write!(f, ": {}", self.text)
    }
}
