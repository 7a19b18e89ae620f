//! Motions that take bodies that overlap apart.

use crate::{Interactions, Overlaps, Relation, Separation, Skin};

type Vector3 = nalgebra::Vector3<f64>;

/// A body is moved by no more than this part of the smallest extent of the box around it.
const FARTHEST: f64 = 0.25;

/// The gap that is left, in thicknesses of the layer: no force and no inset surfaces.
const GAP: f64 = 1.01;

/// Rounds of finding who lies in whom.
const ROUNDS: usize = 50;

/// Sweeps over the conditions of a round.
const SWEEPS: usize = 10_000;

/// Gaps are kept up to this part.
const TOLERANCE: f64 = 1e-9;

/// The surfaces of two bodies, one moved against the other, have to keep a distance along a direction.
struct Condition {
    bodies: [u32; 2],
    direction: Vector3,
    least: f64,
}

/// Why bodies cannot be taken apart.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SeparationFault {
    /// One of two bodies is wholly inside the other.
    Inside {
        /// The bodies.
        bodies: [u32; 2],
    },
    /// Two bodies overlap, and neither may be moved.
    Held {
        /// The bodies.
        bodies: [u32; 2],
    },
    /// Two bodies that no motion within what is allowed takes apart.
    TooDeep {
        /// The bodies.
        bodies: [u32; 2],
        /// Largest motion that each may make, lengths.
        most: [f64; 2],
    },
    /// Two bodies between what may not be moved, without room for them.
    NoRoom {
        /// The bodies.
        bodies: [u32; 2],
    },
    /// A body would have to be moved too far.
    TooFar {
        /// The body.
        body: u32,
        /// Motion that it would need, a length.
        by: f64,
        /// The most that is allowed, a length.
        most: f64,
    },
    /// Some bodies still overlap in the end.
    StillOverlap {
        /// Rounds that were made.
        rounds: usize,
    },
}

impl std::fmt::Display for SeparationFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "bodies cannot be taken apart: {self:?}")
    }
}

impl std::error::Error for SeparationFault {}

/// Motions of all bodies after which those that act on each other are a gap apart in which a layer of this `thickness` (a length) does not act: the least ones in the sense of the sum of squared motions over the `ease` of the bodies
/// (one over a volume, or a mass; 0 for those that may not be moved). No body is moved by more than a quarter of the smallest extent of the box around it. `reference`: positions, `3 * nodes` lengths.
///
/// # Errors
/// [`SeparationFault`].
pub fn separate(
    skin: &Skin,
    rules: &Interactions,
    reference: &[f64],
    ease: &[f64],
    thickness: f64,
) -> Result<Vec<Vector3>, SeparationFault> {
    let gap = GAP * thickness;
    let overlaps = Overlaps::new(skin, rules, reference);
    let farthest = |body: u32| match ease[body as usize] > 0.0 {
        true => FARTHEST * overlaps.extents(body)[1],
        false => 0.0,
    };
    let mut moves = vec![Vector3::zeros(); ease.len()];
    let mut conditions: Vec<Condition> = Vec::new();
    for _ in 0..ROUNDS {
        let known = conditions.len();
        for bodies in rules.body_pairs() {
            let [a, b] = bodies;
            let shift: Vector3 = moves[a as usize] - moves[b as usize];
            match overlaps.relation(bodies, &shift, gap / GAP) {
                Relation::Cross => {}
                // What was near each other and was not moved stays so.
                Relation::Apart(Some(_)) if shift != Vector3::zeros() => {}
                Relation::Apart(_) => continue,
                Relation::Inside => return Err(SeparationFault::Inside { bodies }),
            }
            if bodies.iter().all(|&body| ease[body as usize] == 0.0) {
                return Err(SeparationFault::Held { bodies });
            }
            let most = [a, b].map(farthest);
            let found = overlaps.separation(bodies, &shift, gap, most[0] + most[1]);
            let Some(Separation { direction, length }) = found else {
                return Err(SeparationFault::TooDeep { bodies, most });
            };
            conditions.push(Condition { bodies, direction, least: direction.dot(&shift) + length });
        }
        if conditions.len() == known {
            return Ok(moves);
        }
        if let Some(bodies) = least_motions(&conditions, ease, gap, &mut moves) {
            return Err(SeparationFault::NoRoom { bodies });
        }
        for (body, by) in (0..).zip(&moves) {
            let (by, most) = (by.norm(), farthest(body));
            if by > most * (1.0 + TOLERANCE) {
                return Err(SeparationFault::TooFar { body, by, most });
            }
        }
    }
    Err(SeparationFault::StillOverlap { rounds: ROUNDS })
}

/// The least motions that fulfil all conditions, by coordinate ascent in their multipliers (Hildreth); two bodies whose condition is not fulfilled, if they contradict each other.
fn least_motions(conditions: &[Condition], ease: &[f64], gap: f64, moves: &mut [Vector3]) -> Option<[u32; 2]> {
    moves.iter_mut().for_each(|by| *by = Vector3::zeros());
    let mut multipliers = vec![0.0_f64; conditions.len()];
    let mut worst = (0.0, None);
    for _ in 0..SWEEPS {
        worst = (0.0, None);
        for (condition, multiplier) in conditions.iter().zip(&mut multipliers) {
            let [a, b] = condition.bodies.map(|body| body as usize);
            let ease = [ease[a], ease[b]];
            let lack = condition.least - condition.direction.dot(&(moves[a] - moves[b]));
            let change = (lack / (ease[0] + ease[1])).max(-*multiplier);
            *multiplier += change;
            moves[a] += condition.direction * (change * ease[0]);
            moves[b] -= condition.direction * (change * ease[1]);
            let moved = (change * (ease[0] + ease[1])).abs();
            if moved > worst.0 {
                worst = (moved, Some(condition.bodies));
            }
        }
        if worst.0 <= TOLERANCE * gap {
            return None;
        }
    }
    worst.1
}
