//! A diagnosis in words: a short form for the terminal.

use super::{Cause, Confidence, Diagnosis, LikelyCause};
use std::fmt;

/// Most causes beside the first that the short form names, and most remedies.
const MOST_OTHERS: usize = 2;
const MOST_REMEDIES: usize = 3;

impl Cause {
    /// The cause in few words.
    pub fn title(self) -> &'static str {
        match self {
            Self::NoSupport => "the body is not supported",
            Self::FreeRotation => "a rigid rotation is free",
            Self::OverlapAtStart => "bodies overlap at the start",
            Self::SurfacesFaceAway => "contact surfaces face away from each other",
            Self::MissingContact => "a contact is missing",
            Self::Density => "the density does not match the modulus",
            Self::Sliver => "a sliver element",
            Self::FrictionLocks => "friction locks a wedge",
            Self::StepTooLarge => "the step is too large",
            Self::Incompressible => "nearly incompressible material",
            Self::ExactStick => "no state of exact stick is found",
            Self::OpenRim => "contact jumps at an open rim",
            Self::ToleranceNotReached => "the tolerance is not reached",
            Self::SlowConvergence => "the iteration converges slowly",
            Self::ContactCycles => "contact points open and close without end",
            Self::LoadAtOnce => "a load is applied in full at the start",
            Self::ZeroEnergyModes => "elements with zero-energy modes",
            Self::RedundantConstraints => "redundant constraints",
            Self::LoadTooLarge => "the load is too large",
            Self::SchemeGainsEnergy => "the scheme adds energy",
            Self::Unknown => "the cause is not known",
        }
    }
}

impl fmt::Display for Confidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::High => "almost certain",
            Self::Medium => "likely",
            Self::Low => "possible",
        })
    }
}

impl LikelyCause {
    /// Title of the cause and how certain it is.
    pub fn title(&self) -> String {
        match self.cause {
            Cause::Unknown => self.cause.title().to_owned(),
            _ => format!("{} ({})", self.cause.title(), self.confidence),
        }
    }
}

/// The diagnosis in at most twelve lines.
impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((first, others)) = self.findings.split_first() else {
            return f.write_str("diagnosis: nothing was found");
        };
        writeln!(f, "diagnosis: {}", first.title())?;
        if !first.place.text.is_empty() {
            writeln!(f, "  where:  {}", first.place.text)?;
        }
        if !self.what.is_empty() {
            writeln!(f, "  what:   {}", line(&self.what, WHAT))?;
        }
        if !self.changes.is_empty() {
            writeln!(f, "  new:    {}", line(&self.changes.join("; "), LONGEST))?;
        }
        write!(f, "  cause:  {}", line(&first.sentence, LONGEST))?;
        for (k, remedy) in first.remedies.iter().take(MOST_REMEDIES).enumerate() {
            write!(f, "\n  {} {}. {}", if k == 0 { "try:   " } else { "       " }, k + 1, line(&remedy.text, LONGEST))?;
        }
        for other in others.iter().filter(|other| other.confidence > Confidence::Low).take(MOST_OTHERS) {
            write!(f, "\n  or:     {}, {}", other.title(), other.place.text)?;
        }
        Ok(())
    }
}

/// Most characters of a line, and of the error, which was told before.
const LONGEST: usize = 400;
const WHAT: usize = 140;

fn line(text: &str, longest: usize) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(longest) {
        Some((at, _)) => format!("{}...", &line[..at]),
        None => line,
    }
}
