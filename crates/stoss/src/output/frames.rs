//! Which steps have a frame, and the frames of a folder: one VTU file each, and the collection that names them.

use super::{Drawing, OutputError, frame};
use crate::scene::{Field, Frames};
use serde::{Deserialize, Serialize};
use std::path::Path;
use stoss_solver::Simulation;

/// A time is met by a step that ends this part of a step before it: times of steps are sums, with their round-off.
const SLACK: f64 = 1e-9;

/// What a run remembers of its frames, in its checkpoint.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Log {
    /// Time and step of every frame.
    written: Vec<(f64, u64)>,
    /// Times up to here have been met.
    met: Option<f64>,
}

impl Log {
    /// Whether a completed step, which ended at `time` after `dt`, has a frame; called once for each, in their order.
    pub fn is_due(&mut self, frames: &Frames, step: u64, time: f64, dt: f64) -> bool {
        let now = time + SLACK * dt;
        let before = self.met.replace(now);
        match frames {
            Frames::Every(steps) => step.is_multiple_of(u64::from(*steps).max(1)),
            Frames::Interval(interval) => {
                let multiple = |time: f64| (time / interval).floor();
                before.is_none_or(|before| multiple(now) > multiple(before))
            }
            Frames::Times(times) => times.iter().any(|&t| t <= now && before.is_none_or(|before| t > before)),
            Frames::Last => false,
        }
    }

    /// Whether this step has a frame already.
    pub fn has(&self, step: u64) -> bool {
        self.written.last().is_some_and(|&(_, last)| last == step)
    }

    /// Writes the frame of the present state, and the collection with it.
    pub fn write(
        &mut self,
        folder: &Path,
        simulation: &Simulation,
        fields: Option<&[Field]>,
        drawing: &Drawing,
    ) -> Result<(), OutputError> {
        let step = simulation.step();
        frame::write(&folder.join("frames").join(frame::name(step)), simulation, fields, drawing)?;
        self.written.push((simulation.state().time, step));
        self.write_collection(folder)
    }

    /// Writes the collection of all frames.
    pub fn write_collection(&self, folder: &Path) -> Result<(), OutputError> {
        let entry = |&(time, step): &(f64, u64)| (time, format!("frames/{}", frame::name(step)));
        frame::write_collection(&folder.join("frames.pvd"), &self.written.iter().map(entry).collect::<Vec<_>>())
    }

    /// Every frame of the run so far is there.
    pub fn check(&self, folder: &Path) -> Result<(), OutputError> {
        for &(_, step) in &self.written {
            let file = folder.join("frames").join(frame::name(step));
            if !file.is_file() {
                let reason = "this frame of the run so far is missing (put it back if you have it)".into();
                return Err(OutputError::Damaged { path: file, reason });
            }
        }
        Ok(())
    }

    /// Removes frames that do not belong to the run so far (of an earlier run, or written after the checkpoint).
    pub fn remove_others(&self, folder: &Path) -> Result<(), OutputError> {
        let folder = folder.join("frames");
        let ours: Vec<String> = self.written.iter().map(|&(_, step)| frame::name(step)).collect();
        for entry in std::fs::read_dir(&folder).map_err(OutputError::io(&folder))? {
            let entry = entry.map_err(OutputError::io(&folder))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if frame::step_of(&name).is_some() && !ours.contains(&name) {
                std::fs::remove_file(entry.path()).map_err(OutputError::io(&folder))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps with a frame among those that end at these times.
    fn due(frames: &Frames, times: &[f64]) -> Vec<u64> {
        let mut log = Log::default();
        let mut before = 0.0;
        let step = |(step, &time): (u64, &f64)| {
            let dt = time - std::mem::replace(&mut before, time);
            log.is_due(frames, step, time, dt).then_some(step)
        };
        (0..).zip(times).filter_map(step).collect()
    }

    #[test]
    fn frames_are_at_the_first_step_at_or_after_each_time() {
        // Sums of 0.1 miss its multiples by round-off: 0.30000000000000004, 0.7999999999999999.
        let mut sums = vec![0.0_f64];
        (0..10).for_each(|k| sums.push(sums[k] + 0.1));
        assert!(sums[8] < 0.8 && sums[3] > 0.3);
        assert_eq!(due(&Frames::Every(4), &sums), [0, 4, 8]);
        assert_eq!(due(&Frames::Interval(0.2), &sums), [0, 2, 4, 6, 8, 10]);
        assert_eq!(due(&Frames::Interval(0.25), &sums), [0, 3, 5, 8, 10]);
        assert_eq!(due(&Frames::Times(vec![0.8, 0.3, 0.31, 0.35]), &sums), [3, 4, 8]);
        assert_eq!(due(&Frames::Times(vec![0.0, 1.0]), &sums), [0, 10]);
        assert_eq!(due(&Frames::Last, &sums), [] as [u64; 0]);
        // One frame, not four, where a step passes several times; no time is met twice where step sizes change.
        assert_eq!(due(&Frames::Interval(0.1), &[0.0, 0.45, 0.5, 0.55, 0.6]), [0, 1, 2, 4]);
        assert_eq!(due(&Frames::Times(vec![0.5]), &[0.0, 0.5 - 1e-12, 0.5 + 1e-9, 0.6]), [1]);
    }
}
