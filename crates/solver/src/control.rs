//! The clock with its step control: nominal steps that can be halved and grown again.

use serde::{Deserialize, Serialize};

/// Settings of the step control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepControl {
    /// Nominal step size, a time.
    pub step: f64,
    /// End of the run or of the stage, a time.
    pub end: f64,
    /// Largest number of successive cutbacks (halvings) of a step.
    pub max_cuts: u32,
    /// Successful steps before a halved step is doubled again.
    pub grow_after: u32,
    /// Automatic choice of the step size; `step` is then the largest one.
    pub automatic: Option<Automatic>,
}

/// Automatic step size: starts small, doubles after easy steps, and halves after a
/// hard step and after a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Automatic {
    /// Number of halvings of the largest step that give the first one.
    pub first: u32,
    /// Number of halvings of the largest step that give the smallest one; at least `first`, and instead of [`StepControl::max_cuts`].
    pub last: u32,
    /// Largest number of Newton iterations of an easy step.
    pub easy: u32,
    /// Number of successive easy steps after which the step is doubled.
    pub after: u32,
    /// Number of Newton iterations above which the next step is halved, but not below the first one, which only failures do.
    pub hard: u32,
}

/// Change of the step size after a successful step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepChange {
    /// The step size is kept.
    None,
    /// The step size is doubled.
    Doubled,
    /// The step size is halved.
    Halved,
}

/// Where the run is on the grid of nominal steps.
///
/// Time is counted in ticks of `step / 2^max_cuts`, so that the times of nominal steps are met exactly after any sequence of
/// halvings, and a resumed run has the same bits. The last nominal step ends at `end`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Time of tick zero.
    start: f64,
    step: f64,
    end: f64,
    max_cuts: u32,
    grow_after: u32,
    /// Largest number of iterations of a step that counts as a success for growing.
    easy: Option<u32>,
    /// Largest number of iterations of a step after which the next one is not halved, and how often the first step is halved.
    hard: Option<(u32, u32)>,
    /// Ticks completed.
    tick: u64,
    /// Present number of halvings.
    level: u32,
    /// Successful steps since the last change of level.
    successes: u32,
}

impl Clock {
    /// The clock at time zero. `control` must have a positive finite `step` and `end`; `max_cuts` is limited to 30.
    pub fn new(control: StepControl) -> Self {
        Self::starting_at(0.0, control)
    }

    /// The clock at the time `start`, before the `end` of `control`.
    pub fn starting_at(start: f64, control: StepControl) -> Self {
        let automatic = control.automatic;
        let max_cuts = automatic.map_or(control.max_cuts, |automatic| automatic.last).min(30);
        Self {
            start,
            step: control.step,
            end: control.end,
            max_cuts,
            grow_after: automatic.map_or(control.grow_after, |automatic| automatic.after).max(1),
            easy: automatic.map(|automatic| automatic.easy),
            hard: automatic.map(|automatic| (automatic.hard, automatic.first.min(max_cuts))),
            tick: 0,
            level: automatic.map_or(0, |automatic| automatic.first).min(max_cuts),
            successes: 0,
        }
    }

    fn ticks_per_step(&self) -> u64 {
        1 << self.max_cuts
    }

    /// Number of nominal steps.
    pub fn nominal_steps(&self) -> u64 {
        // A remainder below 1e-9 of a step is round-off of the division, not a step.
        ((self.end - self.start) / self.step - 1.0e-9).ceil().max(1.0) as u64
    }

    fn time_at(&self, tick: u64) -> f64 {
        let last = self.nominal_steps() * self.ticks_per_step();
        if tick >= last {
            return self.end;
        }
        (self.start + tick as f64 / self.ticks_per_step() as f64 * self.step).min(self.end)
    }

    /// Present time.
    pub fn time(&self) -> f64 {
        self.time_at(self.tick)
    }

    /// Time at the end of the step to come.
    pub fn next_time(&self) -> f64 {
        self.time_at(self.tick + self.stride())
    }

    /// Size of the step to come.
    pub fn dt(&self) -> f64 {
        self.next_time() - self.time()
    }

    fn stride(&self) -> u64 {
        self.ticks_per_step() >> self.level
    }

    /// Present number of halvings.
    pub fn level(&self) -> u32 {
        self.level
    }

    /// True at the end.
    pub fn finished(&self) -> bool {
        self.time() >= self.end
    }

    /// True if the present time is a multiple of the nominal step after the start (or the end).
    pub fn on_nominal_grid(&self) -> bool {
        self.tick.is_multiple_of(self.ticks_per_step()) || self.finished()
    }

    /// Moves the end to that of another clock, for a run that goes on with a new end. False, and nothing is changed, if the present time
    /// is beyond it, or is the end of a step that was shortened to meet the old end.
    pub fn take_end_of(&mut self, other: &Self) -> bool {
        let moved = Self { end: other.end, ..*self };
        let fits = moved.time() == self.time();
        if fits {
            *self = moved;
        }
        fits
    }

    /// Part of the stage that is done at a time, 0 at its start and 1 at its end.
    pub fn part_done(&self, time: f64) -> f64 {
        (time - self.start) / (self.end - self.start)
    }

    /// Length of the stage.
    pub fn length(&self) -> f64 {
        self.end - self.start
    }

    /// Accepts a step that took this number of Newton iterations; returns how the step size changes.
    pub fn accept(&mut self, iterations: u32) -> StepChange {
        self.tick += self.stride();
        if self.hard.is_some_and(|(hard, first)| iterations > hard && self.level < first) {
            self.level += 1;
            self.successes = 0;
            return StepChange::Halved;
        }
        self.successes = if self.easy.is_some_and(|easy| iterations > easy) { 0 } else { self.successes + 1 };
        let larger = self.stride() * 2;
        if self.level > 0 && self.successes >= self.grow_after && self.tick.is_multiple_of(larger) {
            self.level -= 1;
            self.successes = 0;
            return StepChange::Doubled;
        }
        StepChange::None
    }

    /// Accepts a step after which the next one must not be larger; it is as if none before it had succeeded.
    pub fn stay(&mut self) {
        self.tick += self.stride();
        self.successes = 0;
    }

    /// Cuts back after a failed step; returns false if the step cannot be halved further.
    pub fn cut(&mut self) -> bool {
        self.successes = 0;
        if self.level == self.max_cuts {
            return false;
        }
        self.level += 1;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn control(step: f64, end: f64) -> StepControl {
        StepControl { step, end, max_cuts: 6, grow_after: 2, automatic: None }
    }

    #[test]
    fn nominal_steps_meet_the_end() {
        let mut clock = Clock::new(control(0.1, 1.0));
        let mut steps = 0;
        while !clock.finished() {
            clock.accept(0);
            steps += 1;
        }
        assert_eq!(steps, 10);
        assert_eq!(clock.time(), 1.0);
        assert_eq!(Clock::new(control(0.3, 1.0)).nominal_steps(), 4);
    }

    #[test]
    fn cuts_have_an_end() {
        let mut clock = Clock::new(control(0.1, 1.0));
        for _ in 0..6 {
            assert!(clock.cut());
        }
        assert!(!clock.cut());
    }

    #[test]
    fn automatic_steps_begin_small_grow_when_it_is_easy_and_halve_after_failures() {
        let automatic = Automatic { first: 3, last: 5, easy: 6, after: 2, hard: 10 };
        let mut clock = Clock::new(StepControl { automatic: Some(automatic), ..control(0.4, 2.0) });
        assert_eq!(clock.dt(), 0.05);
        assert_eq!([6, 6].map(|n| clock.accept(n)), [StepChange::None, StepChange::Doubled]);
        assert!((clock.dt() - 0.1).abs() < 1e-15);
        // A hard step begins the count again.
        assert_eq!([6, 7, 1].map(|n| clock.accept(n)), [StepChange::None; 3]);
        // And a larger step begins at a multiple of itself: 40 ticks are none of 16.
        assert_eq!([1, 1].map(|n| clock.accept(n)), [StepChange::None, StepChange::Doubled]);
        assert!((clock.dt() - 0.2).abs() < 1e-15);
        assert!(clock.cut() && clock.cut() && clock.cut() && clock.cut() && !clock.cut());
        assert!((clock.dt() - 0.4 / 32.0).abs() < 1e-15);
        let mut steps = 0;
        while !clock.finished() {
            clock.accept(1);
            assert!(clock.finished() || clock.dt() <= 0.4 * (1.0 + 1e-12));
            steps += 1;
        }
        assert!(clock.time() == 2.0 && steps < 20, "{steps}");
    }

    /// An increment of more than `hard` iterations makes the next one smaller although it converged, as in Abaqus.
    #[test]
    fn a_hard_step_halves_the_next_one_but_not_below_the_first() {
        let automatic = Automatic { first: 2, last: 5, easy: 6, after: 1, hard: 10 };
        let mut clock = Clock::new(StepControl { automatic: Some(automatic), ..control(0.4, 20.0) });
        let mut step = |iterations| (clock.accept(iterations), (clock.dt() / 0.1).round() as u32);
        assert_eq!([1, 1].map(&mut step), [(StepChange::None, 1), (StepChange::Doubled, 2)]);
        assert_eq!(step(1), (StepChange::Doubled, 4));
        assert_eq!([10, 11].map(&mut step), [(StepChange::None, 4), (StepChange::Halved, 2)]);
        assert_eq!(
            [11, 11, 99].map(&mut step),
            [(StepChange::Halved, 1), (StepChange::None, 1), (StepChange::None, 1)]
        );
        // A step that failures have made smaller than the first one is not halved further.
        assert!(clock.cut());
        assert_eq!((clock.accept(99), (clock.dt() / 0.05).round()), (StepChange::None, 1.0));
        // Steps that are not chosen stay what they are.
        assert_eq!(Clock::new(control(0.1, 1.0)).accept(1000), StepChange::None);
    }

    proptest! {
        #[test]
        fn any_history_meets_nominal_times_and_ends(failures in proptest::collection::vec(any::<bool>(), 0..60)) {
            let mut clock = Clock::new(control(0.07, 1.0));
            let mut failures = failures.into_iter();
            let mut last = -1.0;
            for _ in 0..100_000 {
                if clock.finished() { break; }
                if failures.next().unwrap_or(false) && clock.cut() { continue; }
                prop_assert!(clock.dt() > 0.0);
                clock.accept(0);
                prop_assert!(clock.time() > last);
                last = clock.time();
            }
            prop_assert!(clock.finished());
            prop_assert_eq!(clock.time(), 1.0);
            prop_assert!(clock.on_nominal_grid());
        }
    }
}
