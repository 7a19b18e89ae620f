//! The gap that closed slots of a contact keep in place of zero (theory/constraints#reference-gap).
//!
//! `g_ref = s(t) g_0 + d(t)`: `g_0 <= 0` is the overlap of a slot where its contact begins to act, `s` says what becomes of it, and `d >= 0` is an interference that the
//! surfaces do not have as they are given. A method adds it to the gap that its closed slots have, and counts gaps beyond it.

use crate::StepContext;

/// What becomes of an overlap of the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlap {
    /// The overlap is closed in the first step.
    #[default]
    Sudden,
    /// The overlap is closed in proportion to time, until the end of the stage in which the contact begins to act.
    Ramp,
    /// The overlap stays: surfaces that overlap count as just touching.
    Keep,
}

/// Friction in steps in which an overlap or an interference closes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ClosingFriction {
    /// Friction as in all other steps.
    #[default]
    Full,
    /// A bound of friction that grows from zero in proportion to time.
    Grows,
    /// No friction; what closes ends without tangential tractions.
    None,
}

/// What a scene says of the reference gaps of a contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceGapOptions {
    /// What becomes of an overlap.
    pub overlap: Overlap,
    /// Whether an overlap that cannot be closed at once may be closed in proportion to time.
    pub may_ramp: bool,
    /// Ends of the stages, increasing: a ramp ends at one of them.
    pub ends: Vec<f64>,
    /// Interference as rows `[time, length]` with increasing times, linear between them and constant before and after; none if empty.
    pub interference: Vec<[f64; 2]>,
    /// Friction while something closes.
    pub friction: ClosingFriction,
}

impl ReferenceGapOptions {
    /// The interference at a time.
    pub fn interference_at(&self, time: f64) -> f64 {
        let rows = &self.interference;
        let after = rows.partition_point(|row| row[0] <= time);
        match (after.checked_sub(1).map(|before| rows[before]), rows.get(after)) {
            (Some([t0, d0]), Some([t1, d1])) => d0 + (time - t0) / (t1 - t0) * (d1 - d0),
            (Some([_, d]), None) | (None, Some(&[_, d])) => d,
            (None, None) => 0.0,
        }
    }

    /// Whether the interference is the same at all times of an interval.
    pub fn is_constant_in(&self, from: f64, to: f64) -> bool {
        let first = self.interference_at(from);
        let inside = self.interference.iter().map(|row| row[0]).filter(|&time| time > from && time < to);
        inside.chain([to]).all(|time| self.interference_at(time) == first)
    }

    /// The last time at which the interference changes.
    fn settled(&self) -> f64 {
        let changes = self.interference.windows(2).filter(|rows| rows[0][1] != rows[1][1]);
        changes.map(|rows| rows[1][0]).next_back().unwrap_or(f64::NEG_INFINITY)
    }
}

/// The reference gaps of the slots of a contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceGap {
    options: ReferenceGapOptions,
    /// Overlaps of the slots at `from`, at most zero; empty if nothing asks for them.
    start: Vec<f64>,
    /// Whether a step was accepted: `start` and `from` stay from then on.
    begun: bool,
    /// When the contact began to act, and the end of that stage.
    from: f64,
    until: f64,
    /// Whether an overlap that was to close at once closes in proportion to time.
    ramped: bool,
    /// The end of the present step.
    time: f64,
}

impl ReferenceGap {
    /// Takes what a scene says, before the first step.
    pub fn set(&mut self, options: ReferenceGapOptions) {
        *self = Self { options, ..Self::default() };
    }

    /// The options that were set.
    pub fn options(&self) -> &ReferenceGapOptions {
        &self.options
    }

    fn overlap(&self) -> Overlap {
        if self.ramped { Overlap::Ramp } else { self.options.overlap }
    }

    /// Begins a step. `gap` measures the slots at its start, if they are asked for: `None` without a partner.
    pub fn begin(&mut self, step: &StepContext<'_>, slots: usize, gap: impl Fn(usize) -> Option<f64>) {
        self.time = step.end;
        if self.begun {
            return;
        }
        self.from = step.time;
        self.until = self.options.ends.iter().copied().find(|&end| end > step.time).unwrap_or(step.time);
        self.start.clear();
        if self.overlap() != Overlap::Sudden {
            self.start.extend((0..slots).map(|slot| gap(slot).map_or(0.0, |gap| gap.min(0.0))));
        }
    }

    /// Tells that a step was accepted.
    pub fn commit(&mut self) {
        self.begun = true;
    }

    /// The part of the overlap that is left at a time.
    fn left(&self, time: f64) -> f64 {
        match self.overlap() {
            Overlap::Keep => 1.0,
            Overlap::Ramp if time < self.until => (self.until - time) / (self.until - self.from),
            Overlap::Sudden | Overlap::Ramp => 0.0,
        }
    }

    /// The reference gap of a slot at the end of the present step, a length.
    pub fn of(&self, slot: usize) -> f64 {
        let overlap = self.start.get(slot).map_or(0.0, |overlap| self.left(self.time) * overlap);
        overlap + self.options.interference_at(self.time)
    }

    /// The smallest reference gap of all slots, and the largest, at a time.
    pub fn range(&self, time: f64) -> [f64; 2] {
        let (_, deepest) = self.overlaps();
        let most = self.options.interference_at(time);
        [most - self.left(time) * deepest, most]
    }

    /// Smallest and largest reference gap at the end of the present step.
    pub fn present_range(&self) -> [f64; 2] {
        self.range(self.time)
    }

    /// Times between which [`Self::range`] is linear, and before and after which it stays what it is.
    pub fn times(&self) -> Vec<f64> {
        let ramp = [self.from, self.until].into_iter().filter(|_| self.overlap() == Overlap::Ramp);
        let mut times: Vec<f64> = ramp.chain(self.options.interference.iter().map(|row| row[0])).collect();
        if times.is_empty() {
            times.push(self.from);
        }
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Factor on the bound of friction in a step.
    pub fn friction_factor(&self, step: &StepContext<'_>) -> f64 {
        let of_ramp = if self.overlap() == Overlap::Ramp { self.until } else { f64::NEG_INFINITY };
        let closed = of_ramp.max(self.options.settled());
        // What closes at once does so in the first step.
        let closes = step.time < closed || step.time <= self.from;
        match self.options.friction {
            ClosingFriction::None if closes => 0.0,
            ClosingFriction::Grows if step.end < closed => (step.end - self.from) / (closed - self.from),
            ClosingFriction::Full | ClosingFriction::Grows | ClosingFriction::None => 1.0,
        }
    }

    /// Closes an overlap that was to close at once in the step that begins at `time` in proportion to time, from the next [`Self::begin`] on. False if that is not for this step or this contact.
    pub fn ramp(&mut self, time: f64) -> bool {
        let first = self.from == time && self.options.overlap == Overlap::Sudden;
        if !(first && self.options.may_ramp && !self.ramped) {
            return false;
        }
        (self.ramped, self.begun) = (true, false);
        true
    }

    /// Takes [`Self::ramp`] back.
    pub fn do_not_ramp(&mut self) {
        (self.ramped, self.begun) = (false, true);
        self.start.clear();
    }

    /// How many slots overlapped at the start, and how deep the deepest; of those that were measured.
    pub fn overlaps(&self) -> (usize, f64) {
        let deep = self.start.iter().filter(|overlap| **overlap < 0.0);
        (deep.clone().count(), deep.fold(0.0, |deepest, overlap| f64::max(deepest, -overlap)))
    }

    /// Appends what goes from step to step.
    pub fn save(&self, out: &mut Vec<u8>) {
        out.extend((self.start.len() as u32).to_le_bytes());
        out.extend([u8::from(self.begun), u8::from(self.ramped)]);
        let numbers = [self.from, self.until, self.time].into_iter().chain(self.start.iter().copied());
        out.extend(numbers.flat_map(f64::to_le_bytes));
    }

    /// Restores what [`Self::save`] wrote at the beginning of `bytes`; returns the rest. `None` if there are not enough bytes for so many slots.
    pub fn load<'b>(&mut self, bytes: &'b [u8], slots: usize) -> Option<&'b [u8]> {
        let (count, rest) = bytes.split_first_chunk::<4>()?;
        let (flags, rest) = rest.split_first_chunk::<2>()?;
        let count = u32::from_le_bytes(*count) as usize;
        if count != 0 && count != slots {
            return None;
        }
        let (numbers, rest) = rest.split_at_checked(8 * (3 + count))?;
        let mut numbers = numbers.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
        (self.begun, self.ramped) = (flags[0] != 0, flags[1] != 0);
        let mut next = || numbers.next().unwrap_or_default();
        (self.from, self.until, self.time) = (next(), next(), next());
        self.start = (0..count).map(|_| next()).collect();
        Some(rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(time: f64, end: f64) -> StepContext<'static> {
        StepContext { time, end, ..StepContext::quasi_static(&[], end - time) }
    }

    fn of(options: ReferenceGapOptions) -> ReferenceGap {
        let mut gap = ReferenceGap::default();
        gap.set(ReferenceGapOptions { ends: vec![1.0, 3.0], ..options });
        gap
    }

    fn measured(slot: usize) -> Option<f64> {
        [Some(-0.2), Some(0.1), None].get(slot).copied().flatten()
    }

    #[test]
    fn an_overlap_closes_until_the_end_of_the_stage_in_which_it_begins() {
        let mut gap = of(ReferenceGapOptions { overlap: Overlap::Ramp, ..ReferenceGapOptions::default() });
        for (time, end, left) in [(1.0, 1.5, 0.75), (1.5, 2.0, 0.5), (2.0, 3.0, 0.0), (3.0, 4.0, 0.0)] {
            // A step that is tried again measures nothing new once one was accepted.
            gap.begin(&step(time, end), 3, if time > 1.0 { |_| None } else { measured });
            assert_eq!([0, 1, 2].map(|slot| gap.of(slot)), [-0.2 * left, 0.0, 0.0], "{time}");
            gap.commit();
        }
        assert_eq!(gap.overlaps(), (1, 0.2));
    }

    #[test]
    fn interference_adds_to_what_is_kept() {
        let rows = vec![[0.0, 0.0], [2.0, 0.5]];
        let options =
            ReferenceGapOptions { overlap: Overlap::Keep, interference: rows, ..ReferenceGapOptions::default() };
        assert!(options.is_constant_in(2.0, 9.0) && !options.is_constant_in(1.0, 9.0));
        let mut gap = of(options);
        gap.begin(&step(0.0, 1.0), 3, measured);
        assert_eq!([0, 1, 2].map(|slot| gap.of(slot)), [0.25 - 0.2, 0.25, 0.25]);
        gap.begin(&step(5.0, 6.0), 3, measured);
        assert_eq!(gap.of(1), 0.5);
        assert_eq!((gap.present_range(), gap.times()), ([0.5 - 0.2, 0.5], vec![0.0, 2.0]));
    }

    #[test]
    fn friction_while_something_closes() {
        let ramp = |friction| {
            let mut gap =
                of(ReferenceGapOptions { overlap: Overlap::Ramp, friction, ..ReferenceGapOptions::default() });
            [(0.0, 0.25), (0.5, 1.0), (1.0, 2.0)].map(|(time, end)| {
                gap.begin(&step(time, end), 3, measured);
                gap.commit();
                gap.friction_factor(&step(time, end))
            })
        };
        assert_eq!(ramp(ClosingFriction::Full), [1.0; 3]);
        assert_eq!(ramp(ClosingFriction::Grows), [0.25, 1.0, 1.0]);
        assert_eq!(ramp(ClosingFriction::None), [0.0, 0.0, 1.0]);
        let mut sudden = of(ReferenceGapOptions { friction: ClosingFriction::None, ..ReferenceGapOptions::default() });
        sudden.begin(&step(0.0, 0.5), 3, measured);
        assert_eq!(sudden.friction_factor(&step(0.0, 0.5)), 0.0);
        sudden.commit();
        sudden.begin(&step(0.5, 1.0), 3, measured);
        assert_eq!(sudden.friction_factor(&step(0.5, 1.0)), 1.0);
    }

    #[test]
    fn what_was_to_close_at_once_may_become_a_ramp_in_its_first_step() {
        let mut gap = of(ReferenceGapOptions { may_ramp: true, ..ReferenceGapOptions::default() });
        gap.begin(&step(0.0, 0.5), 3, measured);
        assert_eq!((gap.of(0), gap.overlaps()), (0.0, (0, 0.0)));
        gap.commit();
        assert!(gap.ramp(0.0) && !gap.ramp(0.0));
        gap.begin(&step(0.0, 0.5), 3, measured);
        assert_eq!((gap.of(0), gap.overlaps()), (-0.1, (1, 0.2)));
        gap.do_not_ramp();
        gap.begin(&step(0.0, 0.5), 3, measured);
        assert!(gap.of(0) == 0.0 && !gap.ramp(0.5));
    }

    #[test]
    fn history_is_restored_to_the_bit() {
        let mut gap = of(ReferenceGapOptions { overlap: Overlap::Ramp, ..ReferenceGapOptions::default() });
        gap.begin(&step(0.0, 0.3), 3, measured);
        gap.commit();
        let mut bytes = Vec::new();
        gap.save(&mut bytes);
        bytes.push(7);
        let mut other = of(gap.options().clone());
        assert_eq!(other.load(&bytes, 3).unwrap(), &[7]);
        assert_eq!(other, gap);
        assert!(other.load(&bytes, 4).is_none() && other.load(&bytes[..20], 3).is_none());
    }
}
