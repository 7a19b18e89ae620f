//! How much it matters that something is left out.

/// What it means for the results that something of a deck is not in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// A load, a support, a constraint, a contact or a part is missing: the scene is another problem than the deck.
    Missing,
    /// A law, an element or a setting of the solution is another one.
    Changed,
    /// The results do not differ by it, as far as can be said.
    Note,
}

impl Severity {
    /// All severities, the worst first.
    pub const ALL: [Self; 3] = [Self::Missing, Self::Changed, Self::Note];

    /// Name of the severity in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Missing => "missing",
            Self::Changed => "changed",
            Self::Note => "note",
        }
    }
}
