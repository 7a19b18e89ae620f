//! What one run of a problem is made of, and the pieces of its scene.

use std::fmt::Write;

use crate::workspace::Outcome;

/// The scheme of runs without inertia.
pub const STATICS: &str = "statics";

/// A combination: all that may differ between two runs of a problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Name of an integrator, or [`STATICS`].
    pub scheme: &'static str,
    /// Discretisation of the contact, with its variant behind it: `nts`, `cat`, `mortar`, `mortar dual`, `general`; what a problem without contact writes is its own matter.
    pub method: &'static str,
    /// Kind of the cells, with `mixed` or `reduced` behind it.
    pub cell: &'static str,
    /// Elements along the length that the problem names.
    pub mesh: u32,
    /// Steps of the run, or increments of the load.
    pub steps: u32,
    /// `direct` or `iterative`.
    pub solver: &'static str,
    /// Relative tolerance of Newton's method.
    pub tolerance: f64,
}

impl Choice {
    /// A combination with the direct solver and the tolerance 1e-9.
    pub const fn direct(scheme: &'static str, method: &'static str, cell: &'static str, mesh: u32, steps: u32) -> Self {
        Self { scheme, method, cell, mesh, steps, solver: "direct", tolerance: 1e-9 }
    }

    /// Name of files of the run.
    pub fn slug(&self) -> String {
        let Self { scheme, method, cell, mesh, steps, solver, tolerance } = self;
        format!("{scheme}-{method}-{cell}-m{mesh}-s{steps}-{solver}-{tolerance:e}").replace(' ', "-")
    }

    /// The first word of the cell and of the method, and what is behind it.
    fn parted(text: &'static str) -> (&'static str, &'static str) {
        text.split_once(' ').unwrap_or((text, ""))
    }

    /// True without inertia.
    pub fn is_static(&self) -> bool {
        self.scheme == STATICS
    }

    /// The word of `[scene] kind`.
    pub fn kind(&self) -> &'static str {
        if self.is_static() { "quasi-static" } else { "dynamic" }
    }

    /// The tables `[scene]`, `[time]` and `[solver]` of a run that ends at `end`. Frames and checkpoints are left out but the last ones.
    pub fn head(&self, title: &str, end: f64) -> String {
        let step = end / f64::from(self.steps);
        let mut text = format!(
            "[scene]\ntitle = \"{title}\"\nkind = \"{}\"\n[time]\nend = {end:?}\nstep = {step:?}\n",
            self.kind()
        );
        if !self.is_static() {
            let _ = writeln!(text, "integrator = {{ scheme = \"{}\" }}", self.scheme);
        }
        let linear = if self.solver == "iterative" { "iterative" } else { "multifrontal" };
        let _ = write!(text, "[solver]\nlinear = \"{linear}\"\nrelative_tolerance = {:e}\n", self.tolerance);
        let _ = write!(text, "[output]\nevery = {0}\ncheckpoint_every = {0}\n", self.steps);
        text
    }

    /// Lines of a `[[body]]`: `cell`, `integration` and `volumetric`.
    pub fn cell_keys(&self) -> String {
        let (cell, form) = Self::parted(self.cell);
        let form = match form {
            "mixed" => "volumetric = \"mixed\"\n",
            "reduced" => "integration = \"reduced\"\n",
            _ => "",
        };
        format!("cell = \"{cell}\"\n{form}")
    }

    /// The contact of two surfaces by the chosen method; `rest` are further lines of a `[[contact]]`. General contact has no pairs: `rest` are lines of its own table then.
    pub fn contact(&self, slave: &str, master: &str, rest: &str) -> Outcome<String> {
        let (method, form) = Self::parted(self.method);
        let form = match (method, form) {
            ("general", "") => return Ok(format!("[general_contact]\n{rest}")),
            ("nts" | "cat" | "mortar", "") => String::new(),
            ("mortar", form) => format!("multipliers = \"{form}\"\n"),
            _ => return Err(format!("{} is no contact of two surfaces", self.method).into()),
        };
        Ok(format!("[[contact]]\nmethod = \"{method}\"\n{form}slave = \"{slave}\"\nmaster = \"{master}\"\n{rest}"))
    }
}
