//! Which of PETSc's solvers is used, as sets of its options.

use stoss_linalg::{AutoSolver, MatrixKind};

/// Method by which systems are solved.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// [`Method::Multigrid`] from [`Method::MULTIGRID`] equations on if all of them are of nodes of bodies, else [`Method::Direct`].
    #[default]
    Auto,
    /// Factorisation by MUMPS: LU, or `L D L'` of symmetric matrices, whose negative pivots are counted.
    Direct,
    /// Iteration with smoothed aggregation (GAMG) that knows the rigid motions, by conjugate gradients or, for unsymmetric matrices, GMRES. What it cannot solve, or has equations of multipliers and parts,
    /// is factorised by MUMPS.
    Multigrid,
    /// Options as PETSc writes them, such as `-ksp_type gmres -pc_type lu -pc_factor_mat_solver_type superlu_dist`.
    Options(String),
}

/// MUMPS with what PETSc's defaults lack: room for pivots that were not foreseen (ICNTL 14, per cent), a search for pivots that are zero (ICNTL 24) up to CNTL 3 of the scaled matrix, without which a
/// body that nothing holds is not detected; the last front on one rank (ICNTL 13), where pivots can be counted.
const MUMPS: &str = "-ksp_type preonly -pc_factor_mat_solver_type mumps -mat_mumps_icntl_14 80 -mat_mumps_icntl_24 1 -mat_mumps_cntl_3 1e-14 -mat_mumps_icntl_13 1";

/// Aggregates of all neighbours, whatever their coupling; smoothing by Chebyshev's polynomial of third degree on the diagonal; the residual that is measured is the true one.
const GAMG: &str = "-ksp_norm_type unpreconditioned -ksp_max_it 200 -pc_type gamg -pc_gamg_threshold 0.0 -mg_levels_ksp_type chebyshev -mg_levels_pc_type jacobi -mg_levels_ksp_max_it 3";

impl Method {
    /// Equations of the smallest system that is iterated on if the method is chosen by size.
    pub const MULTIGRID: usize = AutoSolver::ITERATIVE;

    /// Options of the solver that factorises.
    pub(crate) fn direct(&self, kind: MatrixKind) -> String {
        match self {
            // PETSc's own tolerance, 1e-5, is not enough for Newton's method.
            Self::Options(text) => format!("-ksp_rtol 1e-8 {text}"),
            _ if kind == MatrixKind::General => format!("{MUMPS} -pc_type lu"),
            _ => format!("{MUMPS} -pc_type cholesky"),
        }
    }

    /// Whether an option, with its dash, is one that the user has written.
    pub(crate) fn names(&self, option: &str) -> bool {
        matches!(self, Self::Options(text) if text.split_whitespace().any(|word| word == option))
    }

    /// Options of the solver that iterates on so many equations, if one does; `others`: how many are not of nodes of bodies.
    pub(crate) fn iterative(&self, kind: MatrixKind, equations: usize, others: usize) -> Option<String> {
        let iterates = match self {
            Self::Auto => equations >= Self::MULTIGRID,
            Self::Multigrid => true,
            Self::Direct | Self::Options(_) => false,
        };
        (iterates && others == 0).then(|| match kind {
            MatrixKind::General => format!("{GAMG} -ksp_type gmres -ksp_pc_side right -ksp_gmres_restart 200"),
            _ => format!("{GAMG} -ksp_type cg"),
        })
    }
}

/// The options with a prefix before each name, so that they are those of one solver only.
pub(crate) fn prefixed(options: &str, prefix: &str) -> String {
    let word = |word: &str| match word.strip_prefix('-') {
        // A number may be negative.
        Some(name) if name.starts_with(char::is_alphabetic) => format!("-{prefix}{name}"),
        _ => word.to_owned(),
    };
    options.split_whitespace().map(word).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_iterates_on_large_systems_of_nodes_only() {
        let iterates = |method: Method, n, others| method.iterative(MatrixKind::General, n, others).is_some();
        assert!(iterates(Method::Auto, 3000, 0) && !iterates(Method::Auto, 2999, 0));
        assert!(!iterates(Method::Auto, 9000, 1) && !iterates(Method::Multigrid, 9000, 1));
        assert!(iterates(Method::Multigrid, 30, 0) && !iterates(Method::Direct, 9000, 0));
        assert!(!iterates(Method::Options("-pc_type gamg".into()), 9000, 0));
    }

    #[test]
    fn names_have_the_prefix_and_values_do_not() {
        assert_eq!(prefixed("-ksp_rtol  1e-8 -mat_x -2 -a", "s1_"), "-s1_ksp_rtol 1e-8 -s1_mat_x -2 -s1_a");
    }
}
