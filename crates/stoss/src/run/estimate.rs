//! What a run on several ranks would need, from the numbers of nodes: sums, nothing is measured.

use stoss_solver::Plan;

/// Bytes of the program with MPI and PETSc.
const PROGRAM: f64 = 57e6;
/// Bytes a node of what each rank has of all of it: positions, velocities, multipliers, results (measured 2.6 to 3 kB).
const WHOLE: f64 = 3e3;
/// Bytes a node of what is shared out: elements, the matrix and its multigrid (measured 13 to 14 kB with hexahedra).
const SHARED: f64 = 14e3;
/// Bytes a node that a rank receives in an iteration of Newton's method: forces and increments, and in dynamics inertia; three numbers each.
const VECTOR: f64 = 24.0;

/// A line about a run on so many ranks.
pub(super) fn on_ranks(plan: &Plan, ranks: u32) -> String {
    let (nodes, count) = (plan.nodes as f64, f64::from(ranks.max(1)));
    let memory = PROGRAM + nodes * (WHOLE + SHARED / count);
    let vectors = if plan.mass_matrix { 3.0 } else { 2.0 };
    let received = if ranks > 1 { vectors * VECTOR * nodes } else { 0.0 };
    format!(
        "  on {ranks} ranks (estimate for solids that multigrid solves, every rank with all positions; factors come on top): {:.1} MB a rank, {:.1} MB altogether; each receives {} in an iteration of Newton's method",
        memory / 1e6,
        count * memory / 1e6,
        bytes(received)
    )
}

fn bytes(count: f64) -> String {
    if count >= 1e6 { format!("{:.1} MB", count / 1e6) } else { format!("{:.1} kB", count / 1e3) }
}
