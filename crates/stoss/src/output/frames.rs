//! Which steps have a frame, and the frames of a folder: one VTU file each and the collection that names them, or all in one VTKHDF file.

use super::means::Means;
use super::{Drawing, OutputError, frame, hdf};
use crate::scene::{Field, FrameFormat, Frames};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use stoss_mesh_io::VtuData;
use stoss_solver::Simulation;

/// A time is met by a step that ends this part of a step before it: times of steps are sums, with their round-off.
const SLACK: f64 = 1e-9;
/// The file with all frames.
const ALL: &str = "frames.vtkhdf";

/// What a run remembers of its frames, in its checkpoint.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Log {
    format: FrameFormat,
    /// Time and step of every frame.
    written: Vec<(f64, u64)>,
    /// Times up to here have been met.
    met: Option<f64>,
}

impl Log {
    /// The log of a run that has no frames yet.
    pub fn new(format: FrameFormat) -> Self {
        Self { format, written: Vec::new(), met: None }
    }

    /// Refuses a scene that asks for another format than the frames so far have, in words.
    pub fn keep_format(&self, format: FrameFormat) -> Result<(), String> {
        let before = self.format;
        let reason = || format!("the frames so far are in the format {before}: keep [output] format = \"{before}\"");
        if format == before { Ok(()) } else { Err(reason()) }
    }

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

    /// Makes the frame of the present state and, in `folder`, writes it and the collection with it. All ranks call it, and give no folder if they do not write.
    pub fn write(
        &mut self,
        folder: Option<&Path>,
        simulation: &Simulation,
        means: &Means,
        fields: Option<&[Field]>,
        drawing: &Drawing,
    ) -> Result<(), OutputError> {
        let step = simulation.step();
        let Some(folder) = folder else {
            frame::with(simulation, means, fields, drawing, |_| Ok(()))?;
            self.written.push((simulation.state().time, step));
            return Ok(());
        };
        match self.format {
            FrameFormat::Vtu => {
                let file = folder.join("frames").join(frame::name(step));
                // With all ranks, thus before anything that may fail on this one.
                frame::with(simulation, means, fields, drawing, |frame| frame::store(&file, frame))?;
            }
            FrameFormat::Vtkhdf => {
                let file = folder.join(ALL);
                let store = if self.written.is_empty() { hdf::create } else { hdf::append };
                frame::with(simulation, means, fields, drawing, |frame| Ok(store(&file, frame, step)?))?;
            }
        }
        self.written.push((simulation.state().time, step));
        self.write_collection(folder)
    }

    /// Writes the collection of all frames; the one file needs none.
    pub fn write_collection(&self, folder: &Path) -> Result<(), OutputError> {
        if self.format == FrameFormat::Vtkhdf {
            return Ok(());
        }
        let entry = |&(time, step): &(f64, u64)| (time, format!("frames/{}", frame::name(step)));
        frame::write_collection(&folder.join("frames.pvd"), &self.written.iter().map(entry).collect::<Vec<_>>())
    }

    /// Every frame of the run so far is there.
    pub fn check(&self, folder: &Path) -> Result<(), OutputError> {
        let missing = |file: PathBuf, what: &str| {
            let reason = format!("{what} of the run so far is missing (put it back if you have it)");
            Err(OutputError::Damaged { path: file, reason })
        };
        if self.format == FrameFormat::Vtkhdf && !self.written.is_empty() {
            let file = folder.join(ALL);
            let found = hdf::steps(&file)?;
            let is_there = |(k, &(_, step)): (usize, &(f64, u64))| found.get(k) == Some(&step);
            return if self.written.iter().enumerate().all(is_there) { Ok(()) } else { missing(file, "a frame") };
        }
        for &(_, step) in &self.written {
            let file = folder.join("frames").join(frame::name(step));
            if !file.is_file() {
                return missing(file, "this frame");
            }
        }
        Ok(())
    }

    /// Removes frames that do not belong to the run so far (of an earlier run, or written after the checkpoint).
    pub fn remove_others(&self, folder: &Path) -> Result<(), OutputError> {
        let steps: Vec<u64> = match self.format {
            FrameFormat::Vtu => self.written.iter().map(|&(_, step)| step).collect(),
            FrameFormat::Vtkhdf => Vec::new(),
        };
        for (step, file) in files(folder)? {
            if !steps.contains(&step) {
                std::fs::remove_file(&file).map_err(OutputError::io(&file))?;
            }
        }
        if self.format == FrameFormat::Vtkhdf && !self.written.is_empty() {
            hdf::keep(&folder.join(ALL), self.written.len())?;
        }
        Ok(())
    }
}

/// Steps and VTU files of the frames in a folder of results, in the order of the steps.
fn files(folder: &Path) -> Result<Vec<(u64, PathBuf)>, OutputError> {
    let folder = folder.join("frames");
    let mut files = Vec::new();
    if !folder.is_dir() {
        return Ok(files);
    }
    for entry in std::fs::read_dir(&folder).map_err(OutputError::io(&folder))? {
        let entry = entry.map_err(OutputError::io(&folder))?;
        files.extend(frame::step_of(&entry.file_name().to_string_lossy()).map(|step| (step, entry.path())));
    }
    files.sort();
    Ok(files)
}

/// A stored frame.
pub(super) struct Stored {
    /// Step of the frame.
    pub step: u64,
    file: PathBuf,
    /// Place of the frame in the one file of all frames.
    place: Option<usize>,
}

impl Stored {
    /// The file it is in.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Reads it.
    pub fn read(&self) -> Result<VtuData, OutputError> {
        match self.place {
            Some(place) => Ok(hdf::read(&self.file, place)?),
            None => Ok(stoss_mesh_io::read_vtu(&self.file)?),
        }
    }
}

/// The frames of a folder of results, in the order of the steps.
pub(super) fn stored(folder: &Path) -> Result<Vec<Stored>, OutputError> {
    let all = folder.join(ALL);
    if all.is_file() {
        let steps = hdf::steps(&all)?.into_iter().enumerate();
        return Ok(steps.map(|(k, step)| Stored { step, file: all.clone(), place: Some(k) }).collect());
    }
    Ok(files(folder)?.into_iter().map(|(step, file)| Stored { step, file, place: None }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps with a frame among those that end at these times.
    fn due(frames: &Frames, times: &[f64]) -> Vec<u64> {
        let mut log = Log::new(FrameFormat::Vtu);
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
