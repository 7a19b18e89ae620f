//! Which combinations of a problem are run: lines, along each of which one thing is varied.

use super::choice::Choice;
use super::problem::Problem;

/// What is varied along a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Elements; the size is one over their number.
    Mesh,
    /// Steps; the size is one over their number.
    Steps,
    /// Tolerance of Newton's method.
    Tolerance,
}

impl Axis {
    /// The size to which an error belongs: of elements, of steps, of the tolerance.
    pub fn size(self, choice: &Choice) -> f64 {
        match self {
            Self::Mesh => 1.0 / f64::from(choice.mesh),
            Self::Steps => 1.0 / f64::from(choice.steps),
            Self::Tolerance => choice.tolerance,
        }
    }

    /// As a column is headed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh => "meshes",
            Self::Steps => "steps",
            Self::Tolerance => "tolerances",
        }
    }
}

/// Runs that differ in one thing.
#[derive(Clone, Debug)]
pub struct Line {
    /// `mesh`, `step`, `tolerance`, or what is chosen in place of the best.
    pub name: String,
    /// What is varied.
    pub axis: Axis,
    /// The runs, coarse to fine.
    pub choices: Vec<Choice>,
}

/// The lines of a problem: the best over meshes, steps and tolerances; every scheme with every method over steps, without inertia over meshes; every cell and every solver over meshes, or over steps
/// where meshes are not varied. A line of one run is none.
pub fn lines(problem: &Problem) -> Vec<Line> {
    let best = problem.best;
    let over_meshes = |name: String, of: Choice| Line {
        name,
        axis: Axis::Mesh,
        choices: problem.meshes.iter().map(|&mesh| Choice { mesh, ..of }).collect(),
    };
    let over_steps = |name: String, of: Choice| Line {
        name,
        axis: Axis::Steps,
        choices: problem.steps.iter().map(|&steps| Choice { steps, ..of }).collect(),
    };
    let first = |name: String, of: Choice| {
        if problem.meshes.len() > 1 { over_meshes(name, of) } else { over_steps(name, of) }
    };
    let mut lines = vec![over_meshes("mesh".into(), best), over_steps("step".into(), best)];
    for &scheme in problem.schemes {
        for &method in problem.methods {
            let of = Choice { scheme, method, ..best };
            if (scheme, method) == (best.scheme, best.method) {
                continue;
            }
            let name = match (problem.schemes.len(), problem.methods.len()) {
                (1, _) => method.to_owned(),
                (_, 1) => scheme.to_owned(),
                _ => format!("{scheme}, {method}"),
            };
            lines.push(if of.is_static() { first(name, of) } else { over_steps(name, of) });
        }
    }
    let others = |all: &'static [&'static str], best: &'static str| all.iter().copied().filter(move |one| *one != best);
    lines.extend(others(problem.cells, best.cell).map(|cell| first(cell.to_owned(), Choice { cell, ..best })));
    lines
        .extend(others(problem.solvers, best.solver).map(|solver| first(solver.to_owned(), Choice { solver, ..best })));
    let choices = problem.tolerances.iter().map(|&tolerance| Choice { tolerance, ..best }).collect();
    lines.push(Line { name: "tolerance".into(), axis: Axis::Tolerance, choices });
    lines.retain(|line| line.choices.len() > 1);
    lines
}

/// Every combination once, in the order of the lines.
pub fn combinations(lines: &[Line]) -> Vec<Choice> {
    let mut all: Vec<Choice> = Vec::new();
    for choice in lines.iter().flat_map(|line| &line.choices) {
        if !all.contains(choice) {
            all.push(*choice);
        }
    }
    all
}
