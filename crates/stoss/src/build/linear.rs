//! The linear solver of a scene on the ranks of its run.

use crate::ranks::Ranks;
use crate::scene::{Factors, LinearSolver as Choice, Solver};
use stoss_linalg::{AutoSolver, FaerSolver, LinearSolver, MultifrontalSolver, SolverOptions};

/// The solver that a scene asks for.
///
/// # Errors
/// Why PETSc does not start.
pub(super) fn solver(scene: &Solver, ranks: &Ranks) -> Result<Box<dyn LinearSolver>, String> {
    let default = SolverOptions::default();
    let max_nearby_iterations = match scene.factors {
        Factors::Reused => default.max_nearby_iterations,
        Factors::New => 0,
    };
    let options = SolverOptions { max_nearby_iterations, ..default };
    let of_one_rank: Box<dyn LinearSolver> = match scene.linear {
        Choice::Petsc => return petsc::solver(scene.petsc.as_deref(), ranks),
        Choice::Auto if ranks.have_petsc() => return petsc::solver(scene.petsc.as_deref(), ranks),
        Choice::Auto => Box::new(AutoSolver::with_options(options)),
        Choice::Iterative => Box::new(AutoSolver::preferring_iteration(options)),
        Choice::Multifrontal => Box::new(MultifrontalSolver::with_options(options)),
        Choice::Faer => Box::new(FaerSolver::with_options(options)),
    };
    Ok(ranks.spread(of_one_rank))
}

#[cfg(feature = "mpi")]
mod petsc {
    use crate::ranks::Ranks;
    use stoss_linalg::LinearSolver;
    use stoss_linalg_petsc::{Method, Mpi, PetscSolver};

    pub(super) fn solver(choice: Option<&str>, ranks: &Ranks) -> Result<Box<dyn LinearSolver>, String> {
        let method = match choice {
            None => Method::Auto,
            Some("direct") => Method::Direct,
            Some("multigrid") => Method::Multigrid,
            Some(options) => Method::Options(options.to_owned()),
        };
        let solver = Box::new(PetscSolver::new(Mpi::start()?, method));
        Ok(if ranks.have_petsc() { solver } else { ranks.spread(solver) })
    }
}

#[cfg(not(feature = "mpi"))]
mod petsc {
    use crate::ranks::Ranks;
    use stoss_linalg::LinearSolver;

    /// Scenes that ask for it are refused before.
    pub(super) fn solver(_: Option<&str>, _: &Ranks) -> Result<Box<dyn LinearSolver>, String> {
        Err(super::super::unsupported::NO_PETSC.to_owned())
    }
}
