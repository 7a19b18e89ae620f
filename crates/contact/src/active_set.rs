//! The primal-dual active set: which constraints are closed (formulation §9.1-9.2).
//!
//! Pure data and rules; when to ask (at every iterate, or after the inner iteration) is the solver's choice. The rule holds for the standard and
//! for the modified constraint: only the meaning of `gaps` differs (formulation §9.3).

/// What [`ActiveSetControl::propose`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActiveSetOutcome {
    /// The set satisfies the rule.
    Unchanged,
    /// The set was changed.
    Changed {
        /// Slots that became active.
        activated: usize,
        /// Slots that became inactive.
        released: usize,
    },
    /// A set came back, and the union of the sets since then was taken. It may be the present set or one that was there before: solve for it as
    /// accurately as possible before asking again, for a slot whose pressure or gap is nearly zero flips with the error of the solution.
    Union {
        /// Slots that became active.
        activated: usize,
        /// Slots that became inactive.
        released: usize,
    },
    /// A set came back again after the union: the set is left as it was, [`ActiveSetControl::flipping`] tells which slots
    /// flip. Halve the step.
    Cycling,
}

/// Thresholds of the rule, both of the size of round-off.
///
/// A slot opens if `p - c gamma <= 0` exactly, but closes only if `gamma < -(gap + pressure * max|p_s / c_s|)`. A node that barely touches
/// (true pressure zero) has a computed pressure of either sign, `|dp|`; once released its gap is of the order `dp / c`. The second part of
/// the threshold is above that, so that such a node is released at most once and stays open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveSetTolerance {
    /// A length below which a penetration is no penetration; `1e-12` times the length scale of the surface is apt.
    pub gap: f64,
    /// Relative accuracy of the pressures.
    pub pressure: f64,
}

impl ActiveSetTolerance {
    /// Tolerances for a surface with a length scale `h`.
    pub fn for_length_scale(length_scale: f64) -> Self {
        Self { gap: 1e-12 * length_scale, pressure: 1e-10 }
    }

    /// The gap below which an open slot closes, at given pressures.
    fn closing_gap(&self, active: &[bool], pressures: &[f64], c: &[f64]) -> f64 {
        let largest = active
            .iter()
            .zip(pressures.iter().zip(c))
            .filter(|(active, _)| **active)
            .map(|(_, (p, c))| (p / c).abs())
            .filter(|length| length.is_finite())
            .fold(0.0, f64::max);
        -(self.gap + self.pressure * largest)
    }
}

/// The bare rule: writes the set that follows from `active` into `proposed`, returns how many slots closed and opened.
///
/// * an open slot closes iff its gap is below zero (by more than the tolerance);
/// * a closed slot opens iff `p - c gamma <= 0`.
///
/// All slices have one entry a slot: `pressures` (a stress), `gaps` (`gamma`, a length; infinite without a partner), `c > 0` (stress per
/// length). A closed slot without a partner opens.
pub fn update(
    active: &[bool],
    pressures: &[f64],
    gaps: &[f64],
    c: &[f64],
    tolerance: ActiveSetTolerance,
    proposed: &mut [bool],
) -> (usize, usize) {
    debug_assert!([pressures.len(), gaps.len(), c.len(), proposed.len()].iter().all(|&n| n == active.len()));
    let closing = tolerance.closing_gap(active, pressures, c);
    let (mut closed, mut opened) = (0, 0);
    for slot in 0..active.len() {
        proposed[slot] = if active[slot] {
            let opens = pressures[slot] - c[slot] * gaps[slot] <= 0.0;
            opened += usize::from(opens);
            !opens
        } else {
            let closes = gaps[slot] < closing;
            closed += usize::from(closes);
            closes
        };
    }
    (closed, opened)
}

/// The rule with a memory of the sets of this step, against cycling (formulation §9.2).
///
/// If a proposed set was there before, the union of all sets since then is taken ([`ActiveSetOutcome::Union`]) and the memory is cleared. If
/// a set comes back once more, the answer is [`ActiveSetOutcome::Cycling`].
///
/// Sets can be compared only as long as the constraints are the same: after a change of pairings (other than those of slots that
/// have just been activated) call [`Self::reset`].
#[derive(Clone, Debug)]
pub struct ActiveSetControl {
    tolerance: ActiveSetTolerance,
    /// Sets that were solved for, one after the other, `slots` entries each.
    history: Vec<bool>,
    proposed: Vec<bool>,
    flipping: Vec<usize>,
    union_taken: bool,
}

impl ActiveSetControl {
    /// A control without history.
    pub fn new(tolerance: ActiveSetTolerance) -> Self {
        Self { tolerance, history: Vec::new(), proposed: Vec::new(), flipping: Vec::new(), union_taken: false }
    }

    /// Forgets the sets: at the start of each step and of each repetition of one, and when pairings changed.
    pub fn reset(&mut self) {
        self.history.clear();
        self.flipping.clear();
        self.union_taken = false;
    }

    /// Number of sets solved for since [`ActiveSetControl::reset`] or the union, that of the last proposal not counted.
    pub fn tried(&self) -> usize {
        self.history.len().checked_div(self.proposed.len()).unwrap_or(0)
    }

    /// Slots that are active in some and inactive in others of the sets that came back last; empty before.
    pub fn flipping(&self) -> &[usize] {
        &self.flipping
    }

    /// Applies the rule ([`update`]) to an iterate that is no solution yet; returns how many slots changed. Such sets are not remembered: they may
    /// come back.
    pub fn follow(&mut self, active: &mut [bool], pressures: &[f64], gaps: &[f64], c: &[f64]) -> usize {
        self.proposed.resize(active.len(), false);
        let (closed, opened) = update(active, pressures, gaps, c, self.tolerance, &mut self.proposed);
        active.copy_from_slice(&self.proposed);
        closed + opened
    }

    /// Applies the rule ([`update`]) to the converged values of the present set and changes `active` in place.
    pub fn propose(&mut self, active: &mut [bool], pressures: &[f64], gaps: &[f64], c: &[f64]) -> ActiveSetOutcome {
        let slots = active.len();
        self.proposed.resize(slots, false);
        let (activated, released) = update(active, pressures, gaps, c, self.tolerance, &mut self.proposed);
        if activated + released == 0 {
            return ActiveSetOutcome::Unchanged;
        }
        self.history.extend_from_slice(active);
        let first = self.history.chunks_exact(slots).position(|set| set == self.proposed);
        if let Some(first) = first {
            self.flipping.clear();
            for slot in 0..slots {
                let sets = || self.history.chunks_exact(slots).skip(first);
                let (any, all) = (sets().any(|set| set[slot]), sets().all(|set| set[slot]));
                if any && !all {
                    self.flipping.push(slot);
                }
                self.proposed[slot] = any;
            }
            if self.union_taken {
                return ActiveSetOutcome::Cycling;
            }
            self.union_taken = true;
            self.history.clear();
        }
        let (mut activated, mut released) = (0, 0);
        for (now, &new) in active.iter_mut().zip(&self.proposed) {
            activated += usize::from(new && !*now);
            released += usize::from(*now && !new);
            *now = new;
        }
        match first {
            Some(_) => ActiveSetOutcome::Union { activated, released },
            None => ActiveSetOutcome::Changed { activated, released },
        }
    }
}
