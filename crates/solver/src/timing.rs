//! Wall and CPU seconds by phase.

use cpu_time::ProcessTime;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Parts of a run whose time is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Contact search and pairing.
    Search,
    /// Forces, tangents, scatter, patterns.
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
    /// Forces, tangents, scatter, patterns.
    pub assembly: PhaseTime,
    /// Symbolic and numeric factorisation.
    pub factorisation: PhaseTime,
    /// Triangular solves and refinement.
    pub solve: PhaseTime,
    /// Writing results.
    pub output: PhaseTime,
}

impl Timings {
    /// Runs `work` and adds its time to a phase.
    pub fn measure<T>(&mut self, phase: Phase, work: impl FnOnce() -> T) -> T {
        let (wall, cpu) = (Instant::now(), ProcessTime::now());
        let result = work();
        let slot = match phase {
            Phase::Search => &mut self.search,
            Phase::Assembly => &mut self.assembly,
            Phase::Factorisation => &mut self.factorisation,
            Phase::Solve => &mut self.solve,
            Phase::Output => &mut self.output,
        };
        slot.wall += wall.elapsed().as_secs_f64();
        slot.cpu += cpu.elapsed().as_secs_f64();
        slot.calls += 1;
        result
    }
}
