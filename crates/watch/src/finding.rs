//! One thing that the watch found.

use serde::{Deserialize, Serialize};
use std::fmt;

/// How bad it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// Nothing was found.
    #[default]
    Sound,
    /// It deserves a look.
    Doubtful,
    /// The result must not be used.
    Wrong,
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Sound => "sound",
            Self::Doubtful => "doubtful",
            Self::Wrong => "wrong",
        })
    }
}

/// What kind of thing was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// A body inside another one, or in itself.
    Penetration,
    /// A node passed through a body between two states.
    Tunnelling,
    /// An element is inverted at a Gauss point.
    InvertedElement,
    /// An element is nearly inverted, or inverted at a corner.
    PoorElement,
    /// A position is no finite number.
    NotFinite,
    /// A position is far away from the model.
    FarAway,
    /// A momentum or the energy changes although the scheme promises that it does not.
    Balance,
    /// A contact reports what cannot be.
    Contact,
    /// A static equilibrium is unstable.
    Unstable,
}

/// One thing that was found, at its worst.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// How bad.
    pub level: Level,
    /// What kind.
    pub kind: FindingKind,
    /// The bodies that it is about; equal if there is one.
    pub bodies: Option<[usize; 2]>,
    /// The first step in which it was as bad as `level` says, and its time.
    pub step: u64,
    /// See `step`.
    pub time: f64,
    /// Time when it was worst, if that was later.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_time: Option<f64>,
    /// In words, when it was worst.
    pub sentence: String,
    /// Where, when it was worst.
    pub position: Option<[f64; 3]>,
    /// Depth in edge lengths, or what else is measured; larger is worse.
    pub figure: f64,
}
