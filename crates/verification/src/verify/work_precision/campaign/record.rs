//! The results of runs as rows of a CSV file.

use super::choice::Choice;
use super::problem::Problem;
use crate::workspace::Outcome;

/// A run that came to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// Equations.
    pub unknowns: u64,
    /// Steps that were cut.
    pub cuts: u64,
    /// Newton iterations of all steps.
    pub iterations: u64,
    /// CPU seconds of the program, one thread.
    pub cpu_seconds: f64,
    /// Peak of the resident memory in MB.
    pub memory: f64,
    /// What the watch says: `sound`, `doubtful`, `wrong`.
    pub verdict: String,
    /// Relative error of each quantity.
    pub errors: Vec<f64>,
}

/// A combination and what became of it: figures, or why there are none.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The combination, in the words of its columns.
    pub choice: [String; 7],
    /// See [`Figures`].
    pub result: Result<Figures, String>,
}

/// All runs of a problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Records {
    /// The reference's own error for each quantity; 0 of a closed form.
    pub reference_errors: Vec<f64>,
    /// The runs.
    pub rows: Vec<Record>,
}

/// Columns before the errors.
const COLUMNS: [&str; 14] = [
    "scheme",
    "method",
    "cell",
    "mesh",
    "steps",
    "solver",
    "tolerance",
    "ending",
    "unknowns",
    "cuts",
    "iterations",
    "cpu_seconds",
    "memory_mb",
    "verdict",
];

/// The first word of the row with the reference's own errors.
const REFERENCE: &str = "reference";

/// The combination in the words of its columns.
pub fn words(choice: &Choice) -> [String; 7] {
    let Choice { scheme, method, cell, mesh, steps, solver, tolerance } = *choice;
    [
        scheme.into(),
        method.into(),
        cell.into(),
        mesh.to_string(),
        steps.to_string(),
        solver.into(),
        format!("{tolerance:e}"),
    ]
}

/// One line, without what separates columns.
fn plain(text: &str) -> String {
    text.replace(['\n', '\r'], " ").replace(',', ";").replace('"', "'")
}

impl Records {
    /// The run of a combination.
    pub fn of(&self, choice: &Choice) -> Option<&Record> {
        let words = words(choice);
        self.rows.iter().find(|row| row.choice == words)
    }

    /// Figures of a combination that came to its end.
    pub fn figures(&self, choice: &Choice) -> Option<&Figures> {
        self.of(choice)?.result.as_ref().ok()
    }

    /// The file.
    pub fn text(&self, problem: &Problem) -> String {
        let errors = |errors: &[f64]| errors.iter().map(|error| format!("{error:.4e}")).collect::<Vec<_>>();
        let head = COLUMNS
            .iter()
            .map(|name| (*name).to_owned())
            .chain(problem.quantities.iter().map(|name| format!("error of {name}")));
        let mut lines = vec![head.collect::<Vec<_>>()];
        let mut own = vec![REFERENCE.to_owned()];
        own.resize(COLUMNS.len(), String::new());
        own.extend(errors(&self.reference_errors));
        lines.push(own);
        for Record { choice, result } in &self.rows {
            let mut line = choice.to_vec();
            match result {
                Ok(found) => {
                    let Figures { unknowns, cuts, iterations, cpu_seconds, memory, verdict, .. } = found;
                    line.push("ok".into());
                    line.extend([unknowns, cuts, iterations].map(u64::to_string));
                    line.extend([format!("{cpu_seconds:.3e}"), format!("{memory:.1}"), verdict.clone()]);
                    line.extend(errors(&found.errors));
                }
                Err(reason) => {
                    line.push(plain(reason));
                    line.resize(COLUMNS.len() + problem.quantities.len(), String::new());
                }
            }
            lines.push(line);
        }
        lines.iter().map(|line| line.join(",") + "\n").collect()
    }

    /// Reads what [`Records::text`] wrote; an error names the line.
    pub fn parse(text: &str, problem: &Problem) -> Outcome<Self> {
        let mut records = Self { reference_errors: Vec::new(), rows: Vec::new() };
        for (number, line) in text.lines().enumerate().skip(1) {
            let fault = |what: &str| format!("line {}: {what}", number + 1);
            let cells: Vec<&str> = line.split(',').collect();
            if cells.len() != COLUMNS.len() + problem.quantities.len() {
                return Err(fault("another number of columns than the head").into());
            }
            let float = |cell: &str| cell.parse::<f64>().map_err(|_| fault(&format!("{cell:?} is no number")));
            let whole = |cell: &str| cell.parse::<u64>().map_err(|_| fault(&format!("{cell:?} is no whole number")));
            let errors = || cells[COLUMNS.len()..].iter().map(|cell| float(cell)).collect::<Result<Vec<f64>, String>>();
            if cells[0] == REFERENCE {
                records.reference_errors = errors()?;
                continue;
            }
            let result = if cells[7] == "ok" {
                Ok(Figures {
                    unknowns: whole(cells[8])?,
                    cuts: whole(cells[9])?,
                    iterations: whole(cells[10])?,
                    cpu_seconds: float(cells[11])?,
                    memory: float(cells[12])?,
                    verdict: cells[13].to_owned(),
                    errors: errors()?,
                })
            } else {
                Err(cells[7].to_owned())
            };
            records.rows.push(Record { choice: std::array::from_fn(|k| cells[k].to_owned()), result });
        }
        if records.reference_errors.len() != problem.quantities.len() {
            return Err("no row with the errors of the reference".into());
        }
        Ok(records)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::work_precision::problems::PROBLEMS;

    #[test]
    fn what_is_written_is_read_again() {
        let problem = PROBLEMS[0];
        let errors = vec![1.5e-3; problem.quantities.len()];
        let figures = Figures {
            unknowns: 12,
            cuts: 1,
            iterations: 34,
            cpu_seconds: 0.25,
            memory: 30.5,
            verdict: "sound".into(),
            errors: errors.clone(),
        };
        let other = Choice { mesh: 77, ..problem.best };
        let failed = Record { choice: words(&other), result: Err("no; 'this' fails".into()) };
        let rows = vec![Record { choice: words(&problem.best), result: Ok(figures) }, failed];
        let records = Records { reference_errors: errors, rows };
        let text = records.text(problem);
        assert_eq!(Records::parse(&text, problem).unwrap(), records);
        assert_eq!(records.figures(&problem.best).unwrap().iterations, 34);
        assert_eq!((records.figures(&other), plain("a, \"b\"")), (None, "a; 'b'".to_owned()));
        let damaged = text.replacen(",12,", ",x,", 1);
        assert!(Records::parse(&damaged, problem).unwrap_err().to_string().starts_with("line 3"));
    }
}
