//! The files below `docs/verification/work-precision`.

use std::path::PathBuf;

use super::peers::{self, Peer};
use super::problem::{Problem, Values};
use super::record::Records;
use crate::workspace::{Outcome, Workspace, read, write};

/// Where they are.
pub const HOME: &str = "docs/verification/work-precision";

/// The stored results.
pub struct Store<'a> {
    workspace: &'a Workspace,
}

impl<'a> Store<'a> {
    /// Of a checkout.
    pub fn new(workspace: &'a Workspace) -> Self {
        Self { workspace }
    }

    /// A file of the folder, or beside it: `name` is a path from the root of the repository.
    pub fn file(&self, name: &str) -> PathBuf {
        self.workspace.path(name)
    }

    fn of(&self, problem: &Problem, end: &str) -> PathBuf {
        self.file(&format!("{HOME}/{}{end}", problem.name))
    }

    /// Writes the runs.
    pub fn write_records(&self, problem: &Problem, records: &Records) -> Outcome<()> {
        write(&self.of(problem, ".csv"), &records.text(problem))
    }

    /// Reads the runs; an error names the file.
    pub fn records(&self, problem: &Problem) -> Outcome<Records> {
        let path = self.of(problem, ".csv");
        Records::parse(&read(&path)?, problem).map_err(|error| format!("{}: {error}", path.display()).into())
    }

    /// Runs of other programs; none if there is no file.
    pub fn peers(&self) -> Outcome<Vec<Peer>> {
        let path = self.file(&format!("{HOME}/peers.csv"));
        if path.exists() { peers::parse(&read(&path)?) } else { Ok(Vec::new()) }
    }

    /// Writes the values of a converged reference, a line a quantity.
    pub fn write_reference(&self, problem: &Problem, values: &Values) -> Outcome<()> {
        let line = |(name, values): (&&str, &Vec<f64>)| {
            let numbers: Vec<String> = values.iter().map(|value| format!("{value:e}")).collect();
            format!("{name},{}\n", numbers.join(","))
        };
        let text: String = problem.quantities.iter().zip(values).map(line).collect();
        write(&self.of(problem, "-reference.csv"), &text)
    }

    /// Reads them.
    pub fn reference(&self, problem: &Problem) -> Outcome<Values> {
        let path = self.of(problem, "-reference.csv");
        let numbers = |line: &str| line.split(',').skip(1).map(str::parse).collect::<Result<Vec<f64>, _>>();
        let values: Result<Values, _> = read(&path)?.lines().map(numbers).collect();
        values.map_err(|error| format!("{}: {error}", path.display()).into())
    }
}
