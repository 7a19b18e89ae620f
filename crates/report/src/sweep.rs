//! A folder of a sweep: its table `sweep.csv`, and the folders of its cases.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;

use crate::table::cells;
use crate::{Outcome, read};

/// Name of the table.
const TABLE: &str = "sweep.csv";

/// A sweep as its table tells it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sweep {
    /// Names of the parameters.
    pub parameters: Vec<String>,
    /// Names of the columns of results.
    pub results: Vec<String>,
    /// The cases, in order.
    pub cases: Vec<Case>,
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Number of the case, from 1.
    pub number: usize,
    /// Values of the parameters.
    pub parameters: Vec<Option<f64>>,
    /// How the case ended, what the watch says, and why.
    pub outcome: String,
    /// `sound`, `doubtful`, `wrong`, or nothing.
    pub verdict: String,
    /// Why it failed or is not sound.
    pub reason: String,
    /// Values of the columns of results.
    pub results: Vec<Option<f64>>,
    /// Place of the case among the runs of a page.
    pub run: Option<usize>,
    /// Folder of the case.
    #[serde(skip)]
    pub folder: PathBuf,
}

impl Sweep {
    /// Opens a folder; nothing if it is not that of a sweep.
    ///
    /// # Errors
    /// What is wrong with the table, with its name.
    pub fn open(path: &Path) -> Outcome<Option<Self>> {
        let file = path.join(TABLE);
        if !file.is_file() {
            return Ok(None);
        }
        let sweep = Self::parse(&read(&file)?, path).map_err(|error| format!("{}: {error}", file.display()))?;
        Ok(Some(sweep))
    }

    fn parse(text: &str, path: &Path) -> Result<Self, String> {
        let mut lines = text.lines().filter(|line| !line.is_empty()).map(cells);
        let head = lines.next().ok_or("the file is empty")?;
        let place = |name: &str| {
            head.iter().position(|found| found == name).ok_or_else(|| format!("no column {name:?} among {head:?}"))
        };
        let [case, outcome, verdict, reason] = ["case", "outcome", "verdict", "reason"].map(place);
        let (case, outcome, verdict, reason) = (case?, outcome?, verdict?, reason?);
        if case > outcome || outcome > reason {
            return Err("its columns are in another order".into());
        }
        let (parameters, results) = (case + 1..outcome, reason + 1..head.len());
        let row = |(k, row): (usize, Vec<String>)| {
            if row.len() != head.len() {
                return Err(format!("line {} has {} entries, not {}", k + 2, row.len(), head.len()));
            }
            let numbers = |cells: &[String]| cells.iter().map(|cell| cell.parse().ok()).collect();
            let number = row[case].parse().map_err(|_| format!("line {}: {:?} is no case", k + 2, row[case]))?;
            Ok(Case {
                number,
                parameters: numbers(&row[parameters.clone()]),
                outcome: row[outcome].clone(),
                verdict: row[verdict].clone(),
                reason: row[reason].clone(),
                results: numbers(&row[results.clone()]),
                run: None,
                folder: path.join("cases").join(format!("{number:04}")),
            })
        };
        let cases = lines.enumerate().map(row).collect::<Result<_, String>>()?;
        Ok(Self { parameters: head[parameters.clone()].to_vec(), results: head[results.clone()].to_vec(), cases })
    }
}

/// Values of the parameters of a run, if it is a case of a sweep: they stand in a file beside its folder.
pub fn values(folder: &Path) -> BTreeMap<String, f64> {
    let file = folder.with_extension("json");
    let text = if file.is_file() { read(&file).unwrap_or_default() } else { String::new() };
    let mark: Value = serde_json::from_str(&text).unwrap_or_default();
    let values = mark.get("values").and_then(Value::as_object).into_iter().flatten();
    values.filter_map(|(name, value)| Some((name.clone(), value.as_f64()?))).collect()
}

/// Values in words: `mu = 0.1, radius = 2`.
pub fn label(values: &BTreeMap<String, f64>) -> String {
    values.iter().map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_with_quotes_is_read() {
        let text = "case,mu,outcome,verdict,reason,time,last.way\n1,1e-1,completed,sound,,2e0,3e0\n\
                    2,2e-1,failed,,\"step 3, it says \"\"no\"\"\",,\n";
        let sweep = Sweep::parse(text, Path::new("out")).unwrap();
        assert_eq!(
            (&sweep.parameters[..], &sweep.results[..]),
            (&["mu".to_owned()][..], &["time".to_owned(), "last.way".into()][..])
        );
        assert_eq!((sweep.cases[0].parameters[0], sweep.cases[0].results[1]), (Some(0.1), Some(3.0)));
        assert_eq!((sweep.cases[1].reason.as_str(), sweep.cases[1].results[0]), ("step 3, it says \"no\"", None));
        assert_eq!(sweep.cases[1].folder, Path::new("out/cases/0002"));
        for broken in ["", "case,mu\n", "case,outcome,verdict,reason\n1,a\n", "outcome,verdict,reason,case\n"] {
            assert!(Sweep::parse(broken, Path::new("out")).is_err(), "{broken}");
        }
    }

    #[test]
    fn values_stand_beside_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let case = folder.path().join("0001");
        assert!(values(&case).is_empty());
        std::fs::write(folder.path().join("0001.json"), r#"{"scene":"x","values":{"mu":0.25,"radius":2.0}}"#).unwrap();
        assert_eq!(label(&values(&case)), "mu = 0.25, radius = 2");
    }
}
