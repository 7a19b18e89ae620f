//! Simulations inside of this process, for figures that no file has: stresses at integration points.

use stoss::build::build;
use stoss::solver::Simulation;

use crate::workspace::Outcome;

/// The simulation of a scene without mesh files.
pub fn simulation(text: &str) -> Outcome<Simulation> {
    let scene = stoss::scene::parse(text, "verify.toml").map_err(|error| error.to_string())?;
    Ok(build(&scene, std::path::Path::new(".")).map_err(|error| error.to_string())?.simulation)
}

/// What became of a simulation that was run to its end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Effort {
    /// Completed steps.
    pub steps: u32,
    /// Largest number of iterations of a step.
    pub most: u32,
    /// Step cuts.
    pub cuts: usize,
}

/// Runs to the end.
pub fn run(simulation: &mut Simulation) -> Outcome<Effort> {
    let mut effort = Effort::default();
    while !simulation.finished() {
        let record = simulation.advance()?;
        effort.steps += 1;
        effort.most = effort.most.max(record.iterations);
    }
    let cut = |decision: &&stoss::solver::Decision| decision.kind == stoss::solver::DecisionKind::Cut;
    effort.cuts = simulation.decisions().iter().filter(cut).count();
    Ok(effort)
}

/// Cauchy stresses at all integration points.
pub fn stresses(simulation: &Simulation) -> Outcome<Vec<[f64; 6]>> {
    let q = &simulation.state().q;
    let mut all = Vec::new();
    for body in &simulation.model().bodies {
        all.extend(body.solid.gauss_point_state(q)?.into_iter().flatten().map(|point| point.cauchy));
    }
    Ok(all)
}
