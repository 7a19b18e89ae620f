//! The verdict on a run.
//!
//! What holds for every scheme and every scene: files complete, all numbers finite, no element turned inside out, bodies not passed
//! through each other, friction dissipates; also for the steps before a named error. What a scheme claims must hold to round-off. What it does not claim may be off by
//! [`UNCLAIMED`] and is named otherwise.

use crate::verify::numbers::larger;
use std::collections::BTreeMap;

use super::super::super::balance::Balance;
use super::super::super::check::{Bound, number};
use super::super::super::launch::Launched;
use super::case::{Case, LOWER, Oracle, UPPER, Word};
use super::evidence::Evidence;
use super::geometry::Configuration;

/// Relative bound of what a scheme claims to conserve: Newton's tolerance (1e-9 of the forces in a step), which the last
/// correction undercuts.
const CLAIMED: f64 = 1e-9;

/// What springs of friction may give back in a step, by the energy: round-off.
const ROUND_OFF: f64 = 1e-15;

/// What a scheme does not claim may be off by so much and still be right: the accuracy that a coarse mesh deserves.
const UNCLAIMED: f64 = 1e-2;

/// Slave nodes may be so deep in an element of the master (1: its middle). A node keeps its facet until it is a hundredth of a
/// facet beyond the edge, and then stands on the facet's extension instead of the next facet.
const TOUCHING: f64 = 2e-2;

/// Beyond this a node is not just slightly inside but on its way through.
const TUNNELLING: f64 = 0.5;

/// Verdict, its figure and what that is.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// In one word.
    pub word: Word,
    /// The figure.
    pub figure: f64,
    /// Its bound.
    pub bound: Bound,
    /// What the figure is, or what is wrong.
    pub about: String,
}

impl Verdict {
    fn wrong(about: impl Into<String>) -> Self {
        Self { word: Word::Wrong, figure: f64::NAN, bound: Bound::AtMost(0.0), about: about.into() }
    }

    fn told(word: Word, figure: f64, about: impl Into<String>) -> Self {
        Self { word, figure, bound: Bound::Unbounded, about: about.into() }
    }

    fn right(figure: f64, bound: f64, about: impl Into<String>) -> Self {
        Self { word: Word::Right, figure, bound: Bound::AtMost(bound), about: about.into() }
    }
}

/// Last displacements by the name of the base.
pub type Bases = BTreeMap<String, Vec<f64>>;

/// Judges a run.
pub fn judge(case: &Case, launched: Launched, bases: &mut Bases) -> Verdict {
    match Evidence::read(&case.scene, case.touch.is_some(), launched) {
        Ok(evidence) => weigh(case, &evidence, bases).unwrap_or_else(Verdict::wrong),
        Err(reason) => Verdict::wrong(reason),
    }
}

fn weigh(case: &Case, evidence: &Evidence, bases: &mut Bases) -> Result<Verdict, String> {
    let depth = bodies(case, &evidence.frames)?;
    let drifts = Drifts::of(case, evidence)?;
    drifts.claims_hold()?;
    if !Bound::AtLeast(-ROUND_OFF).holds(evidence.least_dissipation) {
        return Err(format!("friction gives energy back: {}", number(evidence.least_dissipation)));
    }
    if !case.oracle.allows_the_end_of(evidence) {
        return Err("there is no solution, and yet the run ended well".into());
    }
    if let Some(error) = &evidence.error {
        return Ok(Verdict::told(Word::NamedError, evidence.balance.step.len() as f64 - 1.0, error.clone()));
    }
    match &case.oracle {
        Oracle::Same { base, length, bound } => return same(evidence, bases.get(base), *length, *bound),
        Oracle::Base => {
            bases.insert(case.combination.clone(), evidence.displacement.clone());
        }
        _ => {}
    }
    if let Some(verdict) = drifts.named(depth).filter(|_| case.free) {
        return Ok(verdict);
    }
    if depth > TOUCHING {
        let about = "depth of a slave node in the master's element, 1 in the middle";
        return Ok(Verdict::told(Word::Penetrates, depth, about));
    }
    let Oracle::Closed { about, error, bound, otherwise } = &case.oracle else { return Ok(drifts.verdict()) };
    let error = error(evidence).map_err(|error| error.to_string())?;
    if error <= *bound {
        Ok(Verdict::right(error, *bound, *about))
    } else {
        Ok(Verdict::told(*otherwise, error, *about))
    }
}

/// Compares the last displacements with those of the base.
fn same(evidence: &Evidence, base: Option<&Vec<f64>>, length: f64, bound: f64) -> Result<Verdict, String> {
    let base = base.ok_or("the base was not run")?;
    if base.len() != evidence.displacement.len() {
        return Err("another number of nodes than the base".into());
    }
    let largest = base.iter().fold(0.0_f64, |largest, u| largest.max(u.abs()));
    let pairs = base.iter().zip(&evidence.displacement);
    let difference = pairs.map(|(a, b)| (a - b / length).abs()).fold(0.0, larger) / largest;
    let about = "largest difference of a displacement, over the largest displacement";
    if difference <= bound {
        return Ok(Verdict::right(difference, bound, about));
    }
    Err(format!("{about}: {}", number(difference)))
}

/// Bodies are whole and in their order; returns the depth of the deepest slave node.
fn bodies(case: &Case, frames: &[Configuration]) -> Result<f64, String> {
    let mut deepest = 0.0_f64;
    for (place, frame) in frames.iter().enumerate() {
        let least = frame.least_vertex_volume();
        if least.is_nan() || least <= 0.0 {
            return Err(format!(
                "an element is inside out at a vertex in frame {place} (volume ratio {})",
                number(least)
            ));
        }
        let Some(touch) = case.touch else { continue };
        if frame.height(UPPER) <= frame.height(LOWER) {
            return Err(format!("the upper body is below the lower one in frame {place}"));
        }
        let master = if touch.slave == UPPER { LOWER } else { UPPER };
        let depth = frame.penetration(touch.slave, touch.side, master);
        if depth > TUNNELLING {
            return Err(format!("tunnels: a slave node is {} inside the master in frame {place}", number(depth)));
        }
        deepest = deepest.max(depth);
    }
    Ok(deepest)
}

/// Changes of what a free system conserves, relative to the scales of the scene.
#[derive(Clone, Copy, Debug, Default)]
struct Drifts {
    linear: f64,
    angular: f64,
    gain: f64,
    loss: f64,
    /// Largest gain of a step.
    rise: f64,
    /// Largest drift of the energy in stretches of steps in which no node closes.
    between: f64,
    /// What the round-off of positions makes of velocities, over the speed.
    round_off: f64,
    claims: [bool; 3],
    /// The scheme keeps the energy but for steps in which a node closes.
    but_for_closings: bool,
    /// The scheme keeps the energy and the contact gives none.
    never_rises: bool,
}

impl Drifts {
    fn of(case: &Case, evidence: &Evidence) -> Result<Self, String> {
        let (Some(claims), true) = (case.claims(), case.free) else { return Ok(Self::default()) };
        let (balance, scene) = (&evidence.balance, &case.scene);
        let momentum = scene.mass * scene.speed.max(f64::MIN_POSITIVE);
        let start = balance.total.first().copied().unwrap_or(0.0);
        let scale = case.energy.unwrap_or(start);
        let largest = balance.total.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = balance.total.iter().copied().fold(f64::INFINITY, f64::min);
        let standard = case.touch.is_some() && !case.modified;
        let between = if standard {
            let closings = evidence.run.closings(balance).map_err(|error| error.to_string())?;
            between(balance, &closings) / scale
        } else {
            balance.energy_drift(Some(scale))
        };
        Ok(Self {
            linear: balance.linear_drift(Some(momentum)),
            angular: balance.angular_drift(Some(momentum * scene.extent)),
            gain: (largest - start) / scale,
            loss: (start - least) / scale,
            rise: balance.total.windows(2).map(|pair| (pair[1] - pair[0]) / scale).fold(0.0, larger),
            between,
            // Velocities are differences of positions over the step.
            round_off: if scene.speed > 0.0 {
                16.0 * f64::EPSILON * scene.extent / (evidence.least_step * scene.speed)
            } else {
                0.0
            },
            claims: [claims.linear_momentum, claims.angular_momentum, claims.energy && !case.renews_integrals],
            but_for_closings: standard,
            never_rises: claims.energy && case.true_gap,
        })
    }

    fn claimed(&self) -> f64 {
        CLAIMED + self.round_off
    }

    fn unclaimed(&self) -> f64 {
        UNCLAIMED + self.round_off
    }

    /// An error names the claim that does not hold.
    fn claims_hold(&self) -> Result<(), String> {
        let bound = self.claimed();
        let [linear, angular, energy] = self.claims;
        let rows = [
            ("linear momentum", linear, self.linear),
            ("angular momentum", angular, self.angular),
            ("energy", energy, self.between),
            ("gain of energy", energy, self.gain),
            ("gain of energy in a step", self.never_rises, self.rise),
        ];
        match rows.iter().find(|(_, claimed, drift)| *claimed && !Bound::AtMost(bound).holds(*drift)) {
            Some((name, _, drift)) => Err(format!("{name}: {} against {}", number(*drift), number(bound))),
            None => Ok(()),
        }
    }

    /// The first drift that is worth a name.
    fn named(&self, depth: f64) -> Option<Verdict> {
        let also = if depth > TOUCHING { format!("; a slave node is {} inside", number(depth)) } else { String::new() };
        let rows = [
            (Word::GainsEnergy, self.gain, "largest gain, over the energy at the start"),
            (Word::Dissipates, self.loss, "largest loss, over the energy at the start"),
            (Word::Drifts, self.angular, "angular momentum, over mass, speed and size"),
        ];
        let named = rows.into_iter().find(|(_, drift, _)| !Bound::AtMost(self.unclaimed()).holds(*drift));
        named.map(|(word, drift, about)| Verdict::told(word, drift, format!("{about}{also}")))
    }

    /// Of a run without drifts worth a name.
    fn verdict(&self) -> Verdict {
        if self.claims[2] && !self.but_for_closings {
            let worst = self.linear.max(self.angular).max(self.between);
            return Verdict::right(worst, self.claimed(), "largest drift of momenta and energy");
        }
        let worst = self.angular.max(self.gain).max(self.loss);
        Verdict::right(worst, self.unclaimed(), "largest drift of angular momentum and energy")
    }
}

/// As [`Balance::energy_drift_between`], but not relative.
fn between(balance: &Balance, closings: &[bool]) -> f64 {
    let largest = balance.total.iter().fold(0.0_f64, |largest, energy| largest.max(energy.abs()));
    balance.energy_drift_between(closings) * largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claim_that_does_not_hold_is_named() {
        let good = Drifts { claims: [true; 3], ..Drifts::default() };
        assert!(good.claims_hold().is_ok());
        let bad = Drifts { between: 1e-6, ..good };
        assert!(bad.claims_hold().unwrap_err().starts_with("energy"));
        assert!(Drifts { claims: [true, true, false], ..bad }.claims_hold().is_ok());
        assert!(Drifts { angular: f64::NAN, ..good }.claims_hold().unwrap_err().starts_with("angular"));
        assert!(Drifts { round_off: 1e-5, ..bad }.claims_hold().is_ok());
        assert!(Drifts { rise: 1e-6, ..good }.claims_hold().is_ok());
        let rising = Drifts { rise: 1e-6, never_rises: true, ..good };
        assert!(rising.claims_hold().unwrap_err().starts_with("gain of energy in a step"));
    }

    #[test]
    fn drifts_between_closings_keep_their_unit() {
        let balance = Balance { total: vec![10.0, 10.0, 8.0, 8.5], ..Balance::default() };
        assert!((between(&balance, &[false, false, true, false]) - 0.5).abs() < 1e-14);
    }
}
