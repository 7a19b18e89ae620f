//! Wall and CPU seconds by phase.

use cpu_time::ProcessTime;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Parts of a run whose time is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Contact search and pairing.
    Search,
    /// Contact elements and ties: integrals, forces, tangents and scatter, friction among them.
    Contact,
    /// Forces and tangents of solids and loads, inertia, scatter, patterns.
    Assembly,
    /// Symbolic and numeric factorisation.
    Factorisation,
    /// Triangular solves and refinement.
    Solve,
    /// Writing results (filled by whoever writes).
    Output,
}

/// Seconds of one phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseTime {
    /// Elapsed seconds.
    pub wall: f64,
    /// CPU seconds of the whole process (all threads).
    pub cpu: f64,
    /// How often it was entered; zero for what a run does not use.
    pub calls: u64,
}

/// Seconds of all phases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timings {
    /// Contact search and pairing.
    pub search: PhaseTime,
    /// Contact elements and ties: integrals, forces, tangents and scatter, friction among them.
    pub contact: PhaseTime,
    /// Forces and tangents of solids and loads, inertia, scatter, patterns; without `contact`.
    pub assembly: PhaseTime,
    /// Symbolic and numeric factorisation.
    pub factorisation: PhaseTime,
    /// Triangular solves and refinement.
    pub solve: PhaseTime,
    /// Writing results.
    pub output: PhaseTime,
    /// Whole steps, failed attempts included, and output: the phases above and whatever belongs to none of them.
    pub total: PhaseTime,
}

impl PhaseTime {
    /// Runs `work` and adds its time.
    pub fn measure<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (wall, cpu) = (Instant::now(), ProcessTime::now());
        let result = work();
        self.add(Self { wall: wall.elapsed().as_secs_f64(), cpu: cpu.elapsed().as_secs_f64(), calls: 1 });
        result
    }

    pub(crate) fn add(&mut self, other: Self) {
        self.wall += other.wall;
        self.cpu += other.cpu;
        self.calls += other.calls;
    }
}

impl Timings {
    /// Runs `work` and adds its time to a phase.
    pub fn measure<T>(&mut self, phase: Phase, work: impl FnOnce() -> T) -> T {
        self.slot(phase).measure(work)
    }

    fn slot(&mut self, phase: Phase) -> &mut PhaseTime {
        match phase {
            Phase::Search => &mut self.search,
            Phase::Contact => &mut self.contact,
            Phase::Assembly => &mut self.assembly,
            Phase::Factorisation => &mut self.factorisation,
            Phase::Solve => &mut self.solve,
            Phase::Output => &mut self.output,
        }
    }

    /// Counts for `part` what was measured as `part` within a measurement of `whole`.
    pub fn split(&mut self, whole: Phase, part: Phase, time: PhaseTime) {
        let slot = self.slot(whole);
        slot.wall -= time.wall;
        slot.cpu -= time.cpu;
        self.slot(part).add(time);
    }

    /// Adds the time of writing results, to the whole too.
    pub fn add_output(&mut self, time: PhaseTime) {
        self.output.add(time);
        self.total.add(PhaseTime { calls: 0, ..time });
    }

    /// Parts of the wall time of the whole by name, and `rest` for what is in no phase. All zero before the first step.
    pub fn shares(&self) -> [(&'static str, f64); 7] {
        let phases = [
            ("search", self.search),
            ("contact", self.contact),
            ("assembly", self.assembly),
            ("factorisation", self.factorisation),
            ("solve", self.solve),
            ("output", self.output),
        ];
        let whole = self.total.wall;
        let share = |seconds: f64| if whole > 0.0 { seconds / whole } else { 0.0 };
        let named: f64 = phases.iter().map(|(_, phase)| phase.wall).sum();
        let mut shares = [("rest", share(whole - named)); 7];
        for (out, (name, phase)) in shares.iter_mut().zip(phases) {
            *out = (name, share(phase.wall));
        }
        shares
    }

    /// The part of the wall time of the whole that contact takes: search and contact elements.
    pub fn contact_share(&self) -> f64 {
        let [(_, search), (_, contact), ..] = self.shares();
        search + contact
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(wall: f64) -> PhaseTime {
        PhaseTime { wall, cpu: 2.0 * wall, calls: 1 }
    }

    #[test]
    fn shares_of_the_whole_add_up_to_one() {
        let mut timings = Timings { assembly: time(4.0), search: time(0.5), total: time(9.0), ..Timings::default() };
        timings.split(Phase::Assembly, Phase::Contact, time(1.5));
        timings.add_output(time(1.0));
        let shares = timings.shares();
        let expected = [("search", 0.05), ("contact", 0.15), ("assembly", 0.25), ("factorisation", 0.0)];
        assert_eq!(shares[..4], expected);
        assert_eq!(shares[4..], [("solve", 0.0), ("output", 0.1), ("rest", 0.45)]);
        assert_eq!(timings.contact_share(), 0.2);
        assert_eq!([timings.assembly.cpu, timings.contact.cpu, timings.total.cpu], [5.0, 3.0, 20.0]);
        assert_eq!([timings.contact.calls, timings.output.calls, timings.total.calls], [1, 1, 1]);
        assert_eq!(Timings::default().contact_share(), 0.0);
    }

    #[test]
    fn every_phase_has_its_own_time() {
        let mut timings = Timings::default();
        let phases =
            [Phase::Search, Phase::Contact, Phase::Assembly, Phase::Factorisation, Phase::Solve, Phase::Output];
        for (k, phase) in phases.into_iter().enumerate() {
            (0..=k).for_each(|_| timings.measure(phase, || ()));
        }
        let Timings { search, contact, assembly, factorisation, solve, output, .. } = timings;
        assert_eq!([search, contact, assembly, factorisation, solve, output].map(|t| t.calls), [1, 2, 3, 4, 5, 6]);
    }
}
