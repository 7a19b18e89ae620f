//! A problem: its scene, what is measured, what it is held against, and which combinations are run.

use super::choice::Choice;
use crate::verify::Run;
use crate::workspace::Outcome;

/// One vector a quantity.
pub type Values = Vec<Vec<f64>>;

/// What the values of a run are held against.
#[derive(Clone, Copy)]
pub enum Reference {
    /// Values that no run of the program gives.
    Closed {
        /// The formula and where it is from.
        source: &'static str,
        /// The values in place of those of a run; the run says where they are asked for.
        values: fn(&Run, &Choice) -> Outcome<Values>,
    },
    /// A finer run, mostly by another method. Its own error is its distance from `coarser`.
    Converged {
        /// The finest one.
        by: Choice,
        /// One that tells how far it is from its limit.
        coarser: Choice,
    },
}

/// An order that theory promises.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// Name of the line: `mesh`, `step`, or as [`lines`](super::lines::lines) calls it.
    pub line: &'static str,
    /// One of the quantities.
    pub quantity: &'static str,
    /// The order; less falls short.
    pub at_least: f64,
}

/// A problem of the campaign. From `best`, the full product of schemes and methods is run, and each other choice is varied alone.
pub struct Problem {
    /// Name of its files: lower-case words joined by hyphens.
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// Bodies, loads, units, and what is hard, in one or two sentences.
    pub about: &'static str,
    /// What errors are of; the first one makes the front.
    pub quantities: &'static [&'static str],
    /// What the values are held against.
    pub reference: Reference,
    /// The scene as TOML; an error says why the combination cannot be: it is listed and not run.
    pub scene: fn(&Choice) -> Outcome<String>,
    /// Names and texts of the files to which the scene refers; [`no_files`] if there are none. Runs go side by side: the names differ between choices.
    pub files: fn(&Choice) -> Vec<(String, String)>,
    /// The values of a run, read from its files. An error is `|a - b| / |b|`, `b` being the reference.
    pub measure: fn(&Run, &Choice) -> Outcome<Values>,
    /// What the others are varied from.
    pub best: Choice,
    /// `statics` or integrators.
    pub schemes: &'static [&'static str],
    /// Contact methods.
    pub methods: &'static [&'static str],
    /// Kinds of cells.
    pub cells: &'static [&'static str],
    /// Elements, coarse to fine.
    pub meshes: &'static [u32],
    /// Numbers of steps, few to many.
    pub steps: &'static [u32],
    /// Linear solvers.
    pub solvers: &'static [&'static str],
    /// Tolerances, loose to tight.
    pub tolerances: &'static [f64],
    /// Orders that theory promises.
    pub claims: &'static [Claim],
    /// How many runs of the lines over meshes and over steps, coarsest first, are repeated in quick mode.
    pub quick: usize,
}

/// [`Problem::files`] of a problem whose scenes refer to none.
pub fn no_files(_: &Choice) -> Vec<(String, String)> {
    Vec::new()
}
