//! Gaps beside round quadratic faces.

use crate::NodeToSurface;
use stoss_contact::{arch, are_curved_alike};
use stoss_reference_element::FacePiece;
use stoss_term::Term as _;

/// Part of an overlap or an interference up to which gaps of nodes beside round faces may be wrong.
const ARCHES: f64 = 0.05;
/// Part of the height of arches below which an overlap is that of rounded coordinates.
const ROUND_OFF: f64 = 1.0e-3;
/// Part of that height from which on gaps differ because of arches.
const SHOWS: f64 = 0.1;

/// What the arches of quadratic faces do to gaps at the start; all lengths.
///
/// Vertices of the facets of quadratic faces lie beside the faces by a third of the height of their arches (theory/elements#contact). In the mean over a face that is nothing; between round faces that lie on each
/// other and do not match every gap is wrong by so much, and so is a press fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arches {
    /// How far vertices lie beside the faces of both sides.
    pub beside: f64,
    /// How far gaps differ from their mean.
    pub spread: f64,
    /// The deepest overlap.
    pub overlap: f64,
}

impl Arches {
    /// The arches of two surfaces that are curved alike, at the positions `reference` (`3 * nodes`); `None` of other ones.
    pub fn of(pieces: [&[FacePiece]; 2], contact: &NodeToSurface, reference: &[f64]) -> Option<Self> {
        let beside = pieces.iter().map(|pieces| arch(pieces, reference)).sum::<f64>() / 3.0;
        if beside == 0.0 || !are_curved_alike(pieces, reference) {
            return None;
        }
        // What cannot be reported is told elsewhere.
        let reports = contact.report(reference).unwrap_or_default();
        let gaps = || reports.iter().filter_map(|report| report.gap).filter(|gap| gap.abs() < 2.0 * beside);
        let overlap = gaps().fold(0.0, |deepest: f64, gap| deepest.max(-gap));
        // Of meshes that match all gaps are alike.
        let [low, high] = gaps().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], gap| [a.min(gap), b.max(gap)]);
        Some(Self { beside, spread: 0.5 * (high - low), overlap })
    }

    /// The arches that would decide on the pressures of an `interference` (0 if there is none) or, if that `overlaps`, of what overlaps at the start.
    pub fn spoil(
        pieces: [&[FacePiece]; 2],
        contact: &NodeToSurface,
        reference: &[f64],
        interference: f64,
        overlaps: bool,
    ) -> Option<Self> {
        let arches = Self::of(pieces, contact, reference)?;
        let Self { beside, spread, overlap } = arches;
        let size = if interference > 0.0 { interference } else { overlap };
        let counts = interference > 0.0 || overlaps && overlap > ROUND_OFF * beside;
        (counts && spread > ARCHES * size && spread > SHOWS * beside).then_some(arches)
    }
}
