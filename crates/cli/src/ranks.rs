//! Processes that a launcher such as `mpirun` has started together.

use std::process::ExitCode;
use stoss::ranks::Ranks;

/// What a launcher tells each process in its environment: the number of processes and the number of this one, by Open MPI; by MPICH, Intel MPI and Slurm's PMI-2; by Slurm with PMIx.
const TOLD: [[&str; 2]; 3] =
    [["OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"], ["PMI_SIZE", "PMI_RANK"], ["SLURM_STEP_NUM_TASKS", "PMIX_RANK"]];

/// A process among those that were started together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Launched {
    pub size: usize,
    pub rank: usize,
}

impl Launched {
    /// Rank and number of ranks of this process; one of one without a launcher.
    pub fn here() -> Self {
        Self::told(|name| std::env::var(name).ok())
    }

    fn told(variable: impl Fn(&str) -> Option<String>) -> Self {
        let number = |name: &str| variable(name)?.trim().parse().ok();
        let of = |[size, rank]: [&str; 2]| Some(Self { size: number(size)?, rank: number(rank)? });
        TOLD.into_iter().find_map(of).unwrap_or(Self { size: 1, rank: 0 })
    }

    pub fn is_alone(self) -> bool {
        self.size <= 1
    }

    /// Whether this is the process that speaks.
    pub fn is_first(self) -> bool {
        self.rank == 0
    }

    /// The ranks of a run: those that were started together, or one.
    ///
    /// # Errors
    /// If there are several, and the program was built without MPI or it does not start.
    pub fn ranks(self) -> Result<Ranks, String> {
        if self.is_alone() { Ok(Ranks::default()) } else { several(self) }
    }
}

#[cfg(feature = "mpi")]
fn several(launched: Launched) -> Result<Ranks, String> {
    let ranks = Ranks::mpi()?;
    // As if the launcher belonged to another MPI than the program.
    if ranks.count() == launched.size {
        return Ok(ranks);
    }
    Err(format!(
        "{} processes were started together, but MPI knows of {}: start them with the launcher of the MPI that the program was built with",
        launched.size,
        ranks.count()
    ))
}

#[cfg(not(feature = "mpi"))]
fn several(launched: Launched) -> Result<Ranks, String> {
    Err(format!(
        "{} processes were started together, but this build of Stoss has no MPI, and each would do the whole run: start it without a launcher, or build it with the cargo feature `mpi` (docs/guide/clusters.md)",
        launched.size
    ))
}

/// How a process ends that leaves errors to the first one: a code of its own would have the launcher end that before it has spoken.
pub const SILENT: ExitCode = ExitCode::SUCCESS;

/// Ends what [`Launched::ranks`] has started. The code of the first rank is that of the run.
pub fn end(ranks: &Ranks, code: u8) -> ExitCode {
    #[cfg(feature = "mpi")]
    Ranks::end();
    if ranks.is_first() { ExitCode::from(code) } else { SILENT }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn launchers_tell_how_many_they_have_started() {
        let of = |told: &[(&str, &str)]| {
            let told = told.to_vec();
            let find = |name: &str| told.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned());
            Launched::told(find)
        };
        assert_eq!(of(&[]), Launched { size: 1, rank: 0 });
        let open_mpi = [("OMPI_COMM_WORLD_SIZE", "4"), ("OMPI_COMM_WORLD_RANK", "3"), ("PMIX_RANK", "3")];
        assert_eq!(of(&open_mpi), Launched { size: 4, rank: 3 });
        assert_eq!(of(&[("PMI_RANK", "0"), ("PMI_SIZE", "2")]), Launched { size: 2, rank: 0 });
        assert_eq!(of(&[("SLURM_STEP_NUM_TASKS", "8"), ("PMIX_RANK", "1")]), Launched { size: 8, rank: 1 });
        // A job of Slurm without `srun` has no ranks.
        assert!(of(&[("SLURM_STEP_NUM_TASKS", "8"), ("SLURM_PROCID", "0")]).is_alone());
    }
}
