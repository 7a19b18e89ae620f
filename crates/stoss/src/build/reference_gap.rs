//! The gaps that a contact of a scene keeps in place of zero: overlaps and interference.

use super::Problems;
use super::pair::PairInput;
use crate::scene::{ClosingFriction as Closing, OverlapAtStart};
use stoss_term::{ClosingFriction, Overlap, ReferenceGapOptions};

impl PairInput<'_> {
    /// What the scene says of them; reports what the stages in which the contact acts do not allow.
    pub fn reference_gap(&self, problems: &mut Problems<'_>) -> ReferenceGapOptions {
        let (scene, item) = (self.scene, self.item);
        let label = item.label();
        let until: Vec<f64> = match &scene.stages[..] {
            [] => vec![scene.time.end],
            stages => stages.iter().map(|stage| stage.until).collect(),
        };
        let options = ReferenceGapOptions {
            overlap: match item.overlap {
                Some(OverlapAtStart::Ramp) => Overlap::Ramp,
                Some(OverlapAtStart::Keep) => Overlap::Keep,
                Some(OverlapAtStart::Sudden) | None => Overlap::Sudden,
            },
            may_ramp: item.overlap.is_none(),
            interference: item.interference.iter().flat_map(|d| d.rows()).map(|row| [row[0], row[1]]).collect(),
            friction: match item.closing_friction {
                Some(Closing::Grows) => ClosingFriction::Grows,
                Some(Closing::None) => ClosingFriction::None,
                Some(Closing::Full) | None => ClosingFriction::Full,
            },
            ends: until.clone(),
        };
        let from = std::iter::once(0.0).chain(until.iter().copied());
        let spans = self.phases.all().zip(from.zip(&until));
        let mut acting = spans.filter(|(phase, _)| phase.acts(Some(&label))).peekable();
        let begins_in_statics = acting.peek().is_none_or(|(phase, _)| !phase.has_rates());
        let mut refuse = |key: &str, value: &str, message: &str, remedy: &str| {
            problems.add(format!("{}.{key}", self.key), value, message, remedy);
        };
        let remedy = "let the contact begin to act in a quasi-static [[stage]] before";
        if options.overlap == Overlap::Ramp && !begins_in_statics {
            let message =
                "closes surfaces in time, which in dynamics would do work on the bodies that no balance of energy has";
            refuse("overlap", "ramp", message, remedy);
        }
        if item.closing_friction.is_some() && !begins_in_statics {
            refuse("closing_friction", "", "is for statics, in which overlaps close without inertia", remedy);
        }
        if item.interference.is_some() && !begins_in_statics {
            let message = "presses surfaces apart that stand nearer to each other, which in dynamics would do work on the bodies that no balance of energy has";
            refuse("interference", "", message, remedy);
        } else if acting.any(|(phase, (from, &until))| phase.has_rates() && !options.is_constant_in(from, until)) {
            let message =
                "changes in a dynamic stage: a gap that moves does work on the bodies that no balance of energy has";
            refuse("interference", "", message, "let it change in quasi-static stages only");
        }
        options
    }
}
