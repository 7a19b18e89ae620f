//! The initial state of a simulation as the only frame of a folder, without a run.

use super::means::Means;
use super::{Description, Drawing, OutputError, frames};
use crate::scene::{Field, FrameFormat};
use std::path::Path;
use stoss_solver::Simulation;

/// Writes the frame with these fields, and `run.json`.
pub(crate) fn write_start(
    folder: &Path,
    simulation: &Simulation,
    drawing: &Drawing,
    description: &Description,
    fields: &[Field],
) -> Result<(), OutputError> {
    let mut means = Means::default();
    if let Some(contact) = &simulation.initial_record().contact {
        means.add(contact, 0.0, simulation.is_static());
    }
    frames::Log::new(FrameFormat::Vtu).write(Some(folder), simulation, &means, Some(fields), drawing)?;
    description.write(folder)
}
