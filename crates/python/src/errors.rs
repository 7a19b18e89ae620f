//! Errors of the library as exceptions of the Python module `stoss._errors`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stoss::run::RunError;

/// What is to be raised: the name of a class, the message, and what the exception has beside it.
pub struct Refused {
    class: &'static str,
    message: String,
    problems: Vec<Problem>,
    stopped: Option<Stopped>,
}

struct Problem {
    file: String,
    line: usize,
    column: usize,
    key: String,
    value: String,
    message: String,
    remedy: String,
}

struct Stopped {
    step: u64,
    time: f64,
    verdict: String,
    out: std::path::PathBuf,
}

impl Refused {
    fn new(class: &'static str, message: &str) -> Self {
        Self { class, message: message.to_owned(), problems: Vec::new(), stopped: None }
    }

    /// A scene that cannot be read.
    pub fn scene(message: &str) -> Self {
        Self::new("SceneError", message)
    }

    /// An argument that does not fit.
    pub fn option(message: &str) -> Self {
        Self::new("OptionError", message)
    }

    /// Files.
    pub fn output(message: &str) -> Self {
        Self::new("OutputError", message)
    }

    /// An error of a run.
    pub fn of(error: &RunError) -> Self {
        let class = match error {
            RunError::Scene(_) | RunError::Encoding { .. } => "SceneError",
            RunError::Option(_) => "OptionError",
            RunError::Resume { .. } => "ResumeError",
            RunError::Simulation { .. } => "SimulationError",
            _ => "OutputError",
        };
        let mut refused = Self::new(class, &error.to_string());
        match error {
            RunError::Scene(errors) => {
                refused.problems.extend(errors.problems().iter().map(|problem| Problem {
                    file: problem.file.clone(),
                    line: problem.line,
                    column: problem.column,
                    key: problem.key.clone(),
                    value: problem.value.clone(),
                    message: problem.message.clone(),
                    remedy: problem.remedy.clone(),
                }));
            }
            RunError::Simulation { last_step, last_time, verdict, out, .. } => {
                let verdict = verdict.to_string();
                refused.stopped = Some(Stopped { step: *last_step, time: *last_time, verdict, out: out.clone() });
            }
            _ => {}
        }
        refused
    }

    /// The exception.
    pub fn raise(self, py: Python<'_>) -> PyErr {
        self.make(py, None).unwrap_or_else(|error| error)
    }

    /// The exception, with what the diagnosis of a run says.
    pub fn raise_with(self, py: Python<'_>, diagnosis: Option<&str>) -> PyErr {
        self.make(py, diagnosis).unwrap_or_else(|error| error)
    }

    fn make(self, py: Python<'_>, diagnosis: Option<&str>) -> PyResult<PyErr> {
        let class = py.import("stoss._errors")?.getattr(self.class)?;
        let extra = PyDict::new(py);
        if !self.problems.is_empty() {
            let problem = py.import("stoss._errors")?.getattr("Problem")?;
            let made: PyResult<Vec<_>> = self
                .problems
                .into_iter()
                .map(|p| problem.call1((p.file, p.line, p.column, p.key, p.value, p.message, p.remedy)))
                .collect();
            extra.set_item("problems", made?)?;
        }
        if let Some(stopped) = self.stopped {
            extra.set_item("last_step", stopped.step)?;
            extra.set_item("last_time", stopped.time)?;
            extra.set_item("verdict", stopped.verdict)?;
            extra.set_item("out", stopped.out)?;
            extra.set_item("diagnosis", diagnosis)?;
        }
        Ok(PyErr::from_value(class.call((self.message,), Some(&extra))?))
    }
}
