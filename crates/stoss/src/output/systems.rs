//! Linear systems of a run as files.

use super::OutputError;
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use stoss_linalg::matrix_market::{SystemFileError, write_system};
use stoss_linalg::{MatrixKind, RecordingSolver};
use stoss_solver::Simulation;

/// Writes the first systems that a simulation factorises.
#[derive(Debug)]
pub(crate) struct SystemWriter(Receiver<SystemFileError>);

impl SystemWriter {
    /// Writes `count` systems, from now on, as `system-000001.mtx` and so on, symmetric ones as `system-000001-symmetric.mtx`, into a folder.
    pub fn attach(folder: &Path, count: u32, simulation: &mut Simulation) -> Result<Self, OutputError> {
        std::fs::create_dir_all(folder).map_err(OutputError::io(folder))?;
        remove_earlier(folder)?;
        let (sender, receiver) = channel();
        let folder = folder.to_path_buf();
        let mut number = 0;
        simulation.wrap_solver(|solver| {
            let recorder = Box::new(move |system: stoss_linalg::SolvedSystem<'_>| {
                number += 1;
                let end = if system.kind == MatrixKind::General { "" } else { "-symmetric" };
                let file = folder.join(format!("system-{number:06}{end}.mtx"));
                match write_system(&file, system.pattern, system.values, system.rhs) {
                    Ok(()) => number < count,
                    Err(error) => {
                        // A receiver that is gone wants to know nothing.
                        let _ = sender.send(error);
                        false
                    }
                }
            });
            Box::new(RecordingSolver::new(solver, recorder))
        });
        Ok(Self(receiver))
    }

    /// The first error, if there was one.
    pub fn check(&self) -> Result<(), OutputError> {
        self.0.try_recv().map_or(Ok(()), |error| Err(error.into()))
    }
}

/// Removes what an earlier run has written here: numbers begin with one again.
fn remove_earlier(folder: &Path) -> Result<(), OutputError> {
    for entry in std::fs::read_dir(folder).map_err(OutputError::io(folder))? {
        let path = entry.map_err(OutputError::io(folder))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("system-") && name.ends_with(".mtx") {
            std::fs::remove_file(&path).map_err(OutputError::io(&path))?;
        }
    }
    Ok(())
}
