//! The primal-dual active set: which constraints are closed (theory/constraints#complementarity).
//!
//! Pure data and functions; when to ask (at every iterate, or after the inner iteration) is the solver's choice. The condition holds for the standard and
//! for the modified constraint: only the meaning of `gaps` differs (theory/constraints#eq-modified).

/// What [`ActiveSetControl::propose`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActiveSetOutcome {
    /// The set satisfies the complementarity condition.
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
    /// A set came back again after the union, and again while slots were turned one at a time: the set is left as it was, [`ActiveSetControl::flipping`] tells
    /// which slots flip. Halve the step.
    Cycling,
}

/// Thresholds of the complementarity condition, both of the size of round-off.
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

/// One update of the active set: writes the set that follows from `active` into `proposed`, returns how many slots closed and opened.
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

/// Updates of the active set with a memory of the sets of this step, against cycling (theory/constraints#cycling).
///
/// If a proposed set was there before, the union of all sets since then is taken ([`ActiveSetOutcome::Union`]) and the memory is cleared. If
/// a set comes back once more, slots are turned one at a time from then on, first the one that is most wrong, after another return the first one in their order.
/// If a set comes back even then, the answer is [`ActiveSetOutcome::Cycling`].
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
    pace: Pace,
}

/// Choice of the slots that are turned at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pace {
    /// All slots that are wrong.
    Together,
    /// All slots that are wrong, after the union of sets was taken once.
    AfterUnion,
    /// The slot that is most wrong.
    Worst,
    /// The first slot that is wrong (Murty 1974): with a matrix all of whose principal minors are positive no set comes back.
    First,
}

impl ActiveSetControl {
    /// A control without history.
    pub fn new(tolerance: ActiveSetTolerance) -> Self {
        Self { tolerance, history: Vec::new(), proposed: Vec::new(), flipping: Vec::new(), pace: Pace::Together }
    }

    /// Forgets the sets: at the start of each step and of each repetition of one, and when pairings changed.
    pub fn reset(&mut self) {
        self.history.clear();
        self.flipping.clear();
        self.pace = Pace::Together;
    }

    /// Number of sets solved for since [`ActiveSetControl::reset`] or the union, that of the last proposal not counted.
    pub fn tried(&self) -> usize {
        self.history.len().checked_div(self.proposed.len()).unwrap_or(0)
    }

    /// Slots that are active in some and inactive in others of the sets that came back last; empty before.
    pub fn flipping(&self) -> &[usize] {
        &self.flipping
    }

    /// Updates the set ([`update`]) at an iterate that is no solution yet; returns how many slots changed. Such sets are not remembered: they may
    /// come back.
    pub fn follow(&mut self, active: &mut [bool], pressures: &[f64], gaps: &[f64], c: &[f64]) -> usize {
        self.proposed.resize(active.len(), false);
        let (closed, opened) = update(active, pressures, gaps, c, self.tolerance, &mut self.proposed);
        active.copy_from_slice(&self.proposed);
        closed + opened
    }

    /// Updates the set ([`update`]) by the converged values of the present one and changes `active` in place.
    pub fn propose(&mut self, active: &mut [bool], pressures: &[f64], gaps: &[f64], c: &[f64]) -> ActiveSetOutcome {
        let slots = active.len();
        self.proposed.resize(slots, false);
        let (activated, released) = update(active, pressures, gaps, c, self.tolerance, &mut self.proposed);
        if activated + released == 0 {
            return ActiveSetOutcome::Unchanged;
        }
        self.history.extend_from_slice(active);
        let one_by_one = |pace: Pace, proposed: &mut [bool]| {
            let wrong = (0..slots).filter(|&slot| active[slot] != proposed[slot]);
            // How far a slot is on the wrong side, a length.
            let error = |slot: usize| {
                if active[slot] { -(pressures[slot] / c[slot]) + gaps[slot].max(0.0) } else { -gaps[slot] }
            };
            let turned = match pace {
                Pace::First => wrong.min(),
                _ => wrong.max_by(|&a, &b| error(a).total_cmp(&error(b))),
            };
            proposed.copy_from_slice(active);
            turned.into_iter().for_each(|slot| proposed[slot] = !proposed[slot]);
        };
        if matches!(self.pace, Pace::Worst | Pace::First) {
            one_by_one(self.pace, &mut self.proposed);
        }
        let first = self.history.chunks_exact(slots).position(|set| set == self.proposed);
        if let Some(first) = first {
            let sets = || self.history.chunks_exact(slots).skip(first);
            let seen = |slot: usize| (sets().any(|set| set[slot]), sets().all(|set| set[slot]));
            self.flipping.clear();
            self.flipping.extend((0..slots).filter(|&slot| {
                let (any, all) = seen(slot);
                any && !all
            }));
            self.pace = match self.pace {
                Pace::Together => {
                    let union: Vec<bool> = (0..slots).map(|slot| seen(slot).0).collect();
                    self.proposed.copy_from_slice(&union);
                    Pace::AfterUnion
                }
                Pace::AfterUnion => {
                    one_by_one(Pace::Worst, &mut self.proposed);
                    Pace::Worst
                }
                Pace::Worst => {
                    update(active, pressures, gaps, c, self.tolerance, &mut self.proposed);
                    one_by_one(Pace::First, &mut self.proposed);
                    Pace::First
                }
                Pace::First => return ActiveSetOutcome::Cycling,
            };
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
