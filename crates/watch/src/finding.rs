//! One finding of the watch.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Severity of a finding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// A result in which nothing was found.
    #[default]
    Sound,
    /// A result that should be examined.
    Doubtful,
    /// A result that must not be used.
    Wrong,
}

impl fmt::Display for Severity {
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
    /// A position is NaN or infinite.
    NotFinite,
    /// A position is more than a thousand model sizes away.
    FarAway,
    /// A momentum or the energy changes although it must be conserved.
    Balance,
    /// The energy grows without work from outside, which scheme and contact do not exclude.
    EnergyGain,
    /// Closing gaps take energy though the scheme keeps it, or nodes of lines meet a surface.
    ClosingLoss,
    /// Steps do not resolve an impact: the law of impact would have added energy.
    Impact,
    /// Contact without friction acts along the surfaces.
    SideForce,
    /// The stabilisation of statics carries a part of the load.
    Stabilisation,
    /// A depth, a distance that contact keeps, or the arch of facets is not small against what drives the bodies into each other.
    Indentation,
    /// Elements force strains on a body in statics, or do not resist changes of its volume, that are a good part of its strain energy.
    Locking,
    /// A contact reports an inadmissible state: tension, pressure at an open gap, friction beyond its bound.
    Contact,
    /// A static equilibrium is unstable.
    Unstable,
    /// A load, a support, a constraint, a contact or a part of the deck is not in the scene that was imported from it. No check of the watch finds this; the scene says so.
    LeftOut,
}

/// One finding, at its worst.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Severity of the finding.
    pub level: Severity,
    /// Kind of the finding.
    pub kind: FindingKind,
    /// Numbers of the bodies concerned; equal if it is one body.
    pub bodies: Option<[usize; 2]>,
    /// Number of the first step in which it had this `level`.
    pub step: u64,
    /// Time at the end of that step.
    pub time: f64,
    /// Time when it was worst, if that was later.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_time: Option<f64>,
    /// The finding in a sentence, at its worst.
    pub sentence: String,
    /// Position (three lengths), at its worst.
    pub position: Option<[f64; 3]>,
    /// Depth in edge lengths, or the relative error of a balance, or another measure of the kind; larger is worse.
    pub figure: f64,
}

impl Finding {
    /// A finding at the end of a step, without bodies and position.
    pub(crate) fn new(
        level: Severity,
        kind: FindingKind,
        (step, time): (u64, f64),
        sentence: String,
        figure: f64,
    ) -> Self {
        Self { level, kind, bodies: None, step, time, worst_time: None, sentence, position: None, figure }
    }
}
